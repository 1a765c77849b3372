// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "frac/identification/identify.hpp"
#include "frac/identification/model_choice.hpp"
#include "identification/data/residual_rule.hpp"
#include "identification/rational/family_members.hpp"
#include "identification/rational/rational_growth.hpp"
#include "support/both_parts.hpp"
#include "support/noisy_response.hpp"
#include "support/periodic_records.hpp"

namespace {

struct System {
  const char* name;  // of the family that contains it
  const char* formula;
};

// Real poles near each other and decades apart, resonances, a pole in the right half plane, an integrator, dead time, a
// resonance beside a rise.
const std::vector<System> systems = {
    {"rational:1/1", "(0.2 s + 3)/(s + 1)"},
    {"rational:3/3", "1/((s + 1) (2 s + 1) (0.3 s + 1))"},
    {"rational:4/4", "0.2 + 1/(0.03 s + 1) + 1/(0.3 s + 1) + 1/(3 s + 1) + 1/(30 s + 1)"},
    {"rational:4/4", "1/(s^2 + 0.04 s + 1) + 0.3/(0.04 s^2 + 0.01 s + 1)"},
    {"rational:2/2", "(s + 3)/((s - 1) (s + 10))"},
    {"rational:3/2", "0.1 + 0.02 s + 1/(0.3 s + 1) + 1/(10 s)"},
    {"rational:2/2+delay", "2 exp(-0.02 s)/((s + 1) (3 s + 1))"},
    {"rational", "6 + 0.16 s + 0.1 s/(s^2 + 0.1 s + 1)"},
};

frac::FitResult fitted(const frac::FrequencyResponseData& data, const char* name, frac::Component component) {
  frac::FitOptions options;
  options.component = component;
  options.weight = frac::Weight::relative;
  const frac::NamedModel model = frac::resolved_model(data, frac::find_model(name), options);
  options.constraints = model.constraints;
  options.global_start = false;
  return frac::fit(data, frac::Structure(model.formula), options);
}

/// Sum of squared relative distances of the data from the system that made them.
double cost_of_truth(const System& system, const frac::FrequencyResponseData& data, frac::Component component) {
  const frac::Structure structure(system.formula);
  double cost = 0;
  for (std::size_t i = 0; i < data.size(); ++i) {
    const auto distance = (structure.response({}, data.omega()[i]) - data.value()[i]) / std::abs(data.value()[i]);
    cost += distance.imag() * distance.imag();
    if (component == frac::Component::both) cost += distance.real() * distance.real();
  }
  return cost;
}

class RationalFamily : public testing::TestWithParam<System> {};

// The family contains the truth, so its least cost cannot exceed that of the truth: a search that ends above it has
// ended in another minimum.  A tenth of a per cent is left to where solvers stop.
TEST_P(RationalFamily, FollowsTheDataAsCloselyAsTheSystemThatMadeThem) {
  for (unsigned seed = 1; seed <= 3; ++seed) {
    const auto data = support::noisy_response(GetParam().formula, {}, 0.01, seed);
    const auto result = fitted(data, GetParam().name, frac::Component::both);
    EXPECT_LE(result.cost, 1.001 * cost_of_truth(GetParam(), data, frac::Component::both))
        << seed << ": " << result.model;
  }
}

TEST_P(RationalFamily, FollowsTheImaginaryPartAlone) {
  const auto data = support::noisy_response(GetParam().formula, {}, 0.01, 4u);
  const auto result = fitted(data, GetParam().name, frac::Component::imaginary);
  EXPECT_LE(result.cost, 1.001 * cost_of_truth(GetParam(), data, frac::Component::imaginary)) << result.model;
}

INSTANTIATE_TEST_SUITE_P(Systems, RationalFamily, testing::ValuesIn(systems));

// Without noise the model is met to rounding: relative residuals of 1e-9 leave five decades for the conditioning of
// the poles.
TEST(Rational, MeetsDataWithoutNoise) {
  for (const System& system : systems) {
    const auto data = support::noisy_response(system.formula, {}, 0, 1u);
    EXPECT_LT(fitted(data, system.name, frac::Component::both).rms, 1e-9) << system.formula;
  }
}

TEST(Rational, FindsThePoles) {
  const auto data = support::noisy_response("1/((s+1) (2 s+1) (0.3 s+1))", {}, 0.01, 2u);
  const auto result = fitted(data, "rational:0/3", frac::Component::both);
  const std::vector<double> truth{1, 0.5, 1, 1 / 0.3};
  ASSERT_EQ(result.parameters.size(), truth.size());
  for (std::size_t i = 0; i < truth.size(); ++i) {
    // Five standard errors: a chance of 6e-7 each.
    EXPECT_NEAR(result.parameters[i].value, truth[i], 5 * result.parameters[i].standard_error)
        << result.parameters[i].name;
  }
}

TEST(Rational, GrowsToTheOrderOfTheSystemAndNoFurther) {
  const auto data =
      support::noisy_response("0.2 + 1/(0.03 s + 1) + 1/(0.3 s + 1) + 1/(3 s + 1) + 1/(30 s + 1)", {}, 0.01, 5u);
  const auto growth = frac::grow(data, frac::GrowthFamily::rational, support::both_parts());
  EXPECT_EQ(growth.models.at(growth.chosen).name, "rational:4/4") << growth.reason;
  EXPECT_EQ(growth.models.size(), growth.fits.size());
}

// Beyond the third pole there is noise alone.  Another real pole with its zero pays if it lowers n ln(cost) by more
// than 2 ln 120 + 2 ln 12, a chi-squared with two degrees of freedom at each of some twelve places: in 0.8 % of the
// records. A pair pays in fewer.  Of 40 records 4 or more then have it with a chance of 3e-4.
TEST(Rational, PaysForTheSearchOfPlacesSoThatCancellingPairsAreLeft) {
  int larger = 0;
  for (unsigned seed = 1; seed <= 40; ++seed) {
    const auto data = support::noisy_response("1/((s + 1) (2 s + 1) (0.3 s + 1))", {}, 0.01, seed);
    const frac::NamedModel model = frac::resolved_model(data, frac::find_model("rational"), support::both_parts());
    const std::size_t poles = std::stoul(model.name.substr(model.name.find('/') + 1));
    EXPECT_GE(poles, 3u) << "seed " << seed;
    larger += poles > 3 ? 1 : 0;
  }
  EXPECT_LE(larger, 3);
}

TEST(Rational, FamiliesAreReadFromTheirNames) {
  const auto range = frac::find_model("rational:1..8+delay").rational;
  ASSERT_TRUE(range.has_value());
  EXPECT_EQ(range->fewest_poles, 1u);
  EXPECT_EQ(range->most_poles, 8u);
  EXPECT_TRUE(range->dead_time);
  EXPECT_FALSE(range->zeros.has_value());
  const auto one = frac::find_model("rational:3/4").rational;
  ASSERT_TRUE(one.has_value());
  EXPECT_EQ(one->zeros, 3u);
  EXPECT_EQ(one->most_poles, 4u);
  EXPECT_EQ(frac::find_model("rational").model_class, frac::ModelClass::integer_order);
  for (const char* wrong :
       {"rational:", "rational:13", "rational:4..2", "rational:5/3", "rational:2/x", "rational:3 "}) {
    EXPECT_THROW((void)frac::find_model(wrong), std::invalid_argument) << wrong;
  }
}

// Families that start from the same ratios grow them once; which of them asks first must not show.
TEST(Rational, FamiliesThatShareTheirRatiosFindWhatEachFindsAlone) {
  const auto data = support::noisy_response("1/((s + 1) (2 s + 1) (0.3 s + 1))", {}, 0.01, 4);
  frac::FitOptions options;
  options.component = frac::Component::both;
  std::vector<std::string> names{"commensurate+delay", "rational", "commensurate", "rational+delay"};
  for (int order = 0; order < 2; ++order) {
    frac::detail::RatioGrowths shared;
    for (const std::string& name : names) {
      const frac::NamedModel& family = frac::find_model(name);
      const frac::NamedModel together = frac::detail::best_member(data, family, options, shared).models.front();
      const frac::NamedModel alone = frac::resolved_model(data, family, options);
      EXPECT_EQ(together.formula, alone.formula);
      ASSERT_EQ(together.constraints.size(), alone.constraints.size());
      for (std::size_t i = 0; i < alone.constraints.size(); ++i) {
        EXPECT_EQ(together.constraints[i].start, alone.constraints[i].start) << name << " " << i;
      }
    }
    std::reverse(names.begin(), names.end());
  }
}

// What has grown to tell the noise floor serves the families that come after it.
TEST(Rational, ARatioGrownForItsResponseIsTheMemberOfItsFamily) {
  const auto data = support::noisy_response("1/((s + 1) (2 s + 1) (0.3 s + 1))", {}, 0.01, 4);
  frac::FitOptions options;
  options.component = frac::Component::both;
  frac::detail::RatioGrowths shared;
  const auto response = frac::detail::ratio_response(data, options, shared);
  const frac::NamedModel family = frac::find_model("rational");
  const frac::NamedModel after = frac::detail::best_member(data, family, options, shared).models.front();
  const frac::NamedModel alone = frac::resolved_model(data, family, options);
  ASSERT_EQ(after.formula, alone.formula);
  std::vector<double> parameters;
  const frac::Structure structure(alone.formula);
  for (const std::string& name : structure.parameter_names()) {
    const auto own = [&](const auto& constraint) { return constraint.name == name; };
    const auto found = std::find_if(alone.constraints.begin(), alone.constraints.end(), own);
    ASSERT_EQ(std::find_if(after.constraints.begin(), after.constraints.end(), own)->start, found->start) << name;
    parameters.push_back(*found->start);
  }
  // The formula is another expansion of the same ratio, of three poles within a decade: some digits of 16 are lost.
  for (std::size_t i = 0; i < data.size(); ++i) {
    EXPECT_LE(std::abs(structure.response(parameters, data.omega()[i]) / response[i] - 1.0), 1e-10);
  }
}

// A factor more and as many zeros add the partial fractions of the factor to the space of the columns, so that the cost
// of both together is the least of all combinations of them.  Both ways are reflections or projections of columns of
// length 1, of which at least 1e-4 lies outside the space of the others here: 1e-16 times 400 rows over 1e-4 is what
// rounding makes of a cost, as a share of the data.
TEST(Rational, PartialFractionsOfAFactorAddWhatTheFactorDoes) {
  using frac::detail::PoleFactor;
  const auto data = support::noisy_response("1/(s^0.7 + 0.3 s^1.6 + 1)", {}, 0.1, 7);
  for (const auto component : {frac::Component::both, frac::Component::imaginary}) {
    const auto rule = frac::detail::residual_rule(data, component, frac::Weight::relative);
    const frac::detail::RationalProblem problem(data, rule);
    for (const bool delayed : {false, true}) {
      for (const double order : {1.0, 0.7}) {
        for (const PoleFactor& factor : {PoleFactor{false, 0.9, 0, 1}, PoleFactor{false, -2, 0, -1},
                                         PoleFactor{true, 0.4, 0.3, 1}, PoleFactor{true, 2, 0.02, 1}}) {
          frac::detail::RationalShape shape;
          shape.factors = {{false, -1.3, 0, 1}, {true, 1.1, 0.5, 1}};
          shape.degree = 3;
          shape.delayed = delayed;
          shape.delay = 0.2;
          shape.free_order = true;
          shape.order = order;
          frac::detail::RationalProblem::Linear linear;
          ASSERT_TRUE(problem.solve(problem.columns(shape), linear));
          const double beside = problem.cost_with(linear, problem.columns_of(factor, shape));
          shape.factors.push_back(factor);
          shape.degree += factor.pair ? 2 : 1;
          EXPECT_NEAR(beside, problem.at(shape).cost, 4e-10 * problem.data_power());
          EXPECT_LT(beside, linear.cost * (1 - 1e-5));
        }
      }
    }
  }
}

// Derivatives by dead time and order, the last two, at fixed coefficients against central differences of the columns;
// those by places leave out what lies in the space of the columns.  The error of a difference is a sixth of the step
// squared times a third derivative, which is the model times at most (15 e-folds)^3, and rounding of 1e-14 over the
// step.
TEST(Rational, DerivativesByDeadTimeAndOrderAreThoseOfDifferences) {
  const auto data = support::noisy_response("1/(s^0.7 + 0.3 s^1.6 + 1)", {}, 0.1, 7);
  const auto rule = frac::detail::residual_rule(data, frac::Component::both, frac::Weight::relative);
  const frac::detail::RationalProblem problem(data, rule);
  for (const std::size_t integrators : {0u, 2u}) {
    for (const std::size_t degree : {1u, 2u, 4u, 6u}) {
      frac::detail::RationalShape shape;
      shape.factors = {{false, -1.3, 0, 1}, {false, 0.2, 0, -1}, {true, 1.1, 0.5, 1}};
      shape.integrators = integrators;
      shape.low = 1;
      shape.degree = degree;
      shape.delayed = true;
      shape.delay = 0.2;
      shape.free_order = true;
      shape.order = 0.8;
      frac::detail::RationalProblem::Linear linear;
      ASSERT_TRUE(problem.solve(problem.columns(shape), linear));
      const Eigen::MatrixXcd derivatives = problem.derivatives(shape, linear);
      const auto count = static_cast<Eigen::Index>(shape.nonlinear());
      ASSERT_EQ(derivatives.cols(), count);
      const Eigen::VectorXcd coefficients = linear.coefficients.cast<std::complex<double>>();
      double size = 0;  // of the terms that the model is the sum of
      const Eigen::MatrixXcd columns = problem.columns(shape);
      for (Eigen::Index k = 0; k < columns.cols(); ++k) {
        size = std::max(size, (columns.col(k) * coefficients[k]).cwiseAbs().maxCoeff());
      }
      for (Eigen::Index k = count - 2; k < count; ++k) {
        constexpr double step = 1e-5;
        const Eigen::VectorXd change = step * Eigen::VectorXd::Unit(count, k);
        const Eigen::VectorXcd difference =
            (problem.columns(problem.stepped(shape, change)) - problem.columns(problem.stepped(shape, -change))) *
            coefficients / (2 * step);
        // 15^3/6 step^2 and 1e-14/step are 6e-8 and 1e-9 of the terms.
        EXPECT_LT((derivatives.col(k) - difference).cwiseAbs().maxCoeff(), 1e-7 * size) << degree << ", " << k;
      }
    }
  }
}

// Verdicts need the intervals of orders; those of a grown model's coefficients would cost more than all the rest.
TEST(Rational, IdentifyFollowsTheCostForTheOrdersOfGrownModelsAlone) {
  const auto data = support::noisy_response("2/(0.5 s^0.7 + 1)", {}, 0.1, 6, 24);
  frac::FitOptions options;
  options.component = frac::Component::both;
  const auto result = frac::identify(data, {frac::find_model("commensurate")}, {}, options, 1);
  const frac::RankedFit& grown = result.ranking.front();
  const auto profiled = [](const frac::FitResult& fit, frac::ParameterRole role) {
    const frac::Structure structure(fit.model);
    int count = 0;
    for (std::size_t i = 0; i < fit.parameters.size(); ++i) {
      const bool counts = structure.parameter_roles()[i] == role;
      count += counts && fit.parameters[i].interval == frac::IntervalKind::profile ? 1 : 0;
    }
    return count;
  };
  options.constraints = grown.model.constraints;
  options.global_start = false;
  const frac::FitResult alone = frac::fit(data, frac::Structure(grown.model.formula), options);
  ASSERT_GT(profiled(alone, frac::ParameterRole::coefficient), 0);
  EXPECT_EQ(profiled(grown.fit, frac::ParameterRole::coefficient), 0);
  EXPECT_EQ(profiled(grown.fit, frac::ParameterRole::order), profiled(alone, frac::ParameterRole::order));
}

// Six lags in a row under relative noise, of which five are worth no more than a constant.  The true structure is among
// the members, so the chosen one is as good by Schwarz's criterion as that, fitted from the truth, or as much worse as
// the growth prices the place of a pole, 2 ln of 9.2 + 2.4 e-folds.
TEST(Rational, SteepResponsesGrowWithoutZeros) {
  const char* const truth = "1/((T1 s + 1) (T2 s + 1) (T3 s + 1) (T4 s + 1) (T5 s + 1) (T6 s + 1))";
  const std::vector<double> times = {9.2, 3.8, 1.56, 0.64, 0.26, 0.11};
  frac::FitOptions options;
  options.component = frac::Component::both;
  const auto schwarz = [](const frac::FitResult& fit) {
    const auto n = static_cast<double>(fit.residuals);
    return n * std::log(fit.cost / n) + static_cast<double>(fit.free_parameters) * std::log(n);
  };
  for (unsigned seed = 1; seed <= 8; ++seed) {
    const auto data = support::noisy_response(truth, times, 0.02, seed, 20);
    frac::FitOptions from_truth = options;
    from_truth.global_start = false;
    for (std::size_t i = 0; i < times.size(); ++i) {
      from_truth.constraints.push_back({"T" + std::to_string(i + 1), {}, {}, {}, times[i]});
    }
    const auto family = frac::find_model("rational");
    const auto grown = frac::identify(data, {family}, {}, options, 1).ranking.front().fit;
    EXPECT_LE(schwarz(grown), schwarz(frac::fit(data, frac::Structure(truth), from_truth)) + 4.9)
        << seed << ": " << grown.model;
  }
}

TEST(Rational, MagnitudesAloneAreRefused) {
  const auto data = support::noisy_response("1/(s + 1)", {}, 0.01, 1u);
  frac::FitOptions options;
  options.component = frac::Component::magnitude;
  EXPECT_THROW((void)frac::resolved_model(data, frac::find_model("rational:1"), options), std::invalid_argument);
}

/// Samples of an input of steps, held as told, and what a formula answers to it without noise.
frac::TimeResponseData record_of(const char* formula, frac::Hold hold, bool even) {
  support::Random random(5);
  std::vector<double> time, input;
  for (int i = 0; i < 300; ++i) {
    time.push_back(0.1 * (i + (even ? 0 : 0.8 * random.unit())));
    input.push_back(i % 7 == 0 ? random.normal() : input.back());
  }
  std::vector<double> output = frac::respond(frac::FractionalTransferFunction::parse(formula),
                                             frac::SampledInput{time, input, hold}, time, 1e-12)
                                   .output;
  return {time, input, std::move(output), {}, hold};
}

// What a shape answers to a record is what respond() makes of the same formula by its sum of exponentials.  Simulations
// are good to 1e-10 of their parts, which cancel by up to a factor of 100 here.
TEST(Rational, OfARecordAnswersAsTheFormulaDoes) {
  for (const auto hold : {frac::Hold::zero_order, frac::Hold::first_order}) {
    for (const bool even : {true, false}) {
      for (const bool delayed : {false, true}) {
        for (const std::string a : {"1", "0.8"}) {
          const std::string formula = std::string(delayed ? "exp(-0.73 s) " : "") + "(1 + 0.4 s^" + a + ")/(s^" + a +
                                      " ((s/0.4)^" + a + " + 1) ((s/3)^(2*" + a + ") + 0.3 (s/3)^" + a +
                                      " + 1) ((s/5)^" + a + " + 1)^2)";
          const frac::detail::RationalProblem problem(record_of(formula.c_str(), hold, even), {});
          const double centre = problem.centre_omega();
          frac::detail::RationalShape shape;
          // ((s/5)^a + 1)^2 as a pair: 2 sinh(damping) = 2.
          shape.factors = {{false, std::log(0.4 / centre), 0, 1},
                           {true, std::log(3 / centre), std::asinh(0.15), 1},
                           {true, std::log(5 / centre), std::asinh(1.0), 1}};
          shape.integrators = 1;
          shape.degree = 1;
          shape.delayed = delayed;
          shape.delay = 0.73 * centre;
          shape.order = std::stod(a);
          shape.free_order = shape.order != 1;
          EXPECT_LT(problem.at(shape).cost, 1e-16 * problem.data_power()) << formula << even;
        }
      }
    }
  }
}

// As above for a record: central differences against derivatives by all that acts nonlinearly.  Simulations of 1e-10
// over the step add 1e-5 of the terms.
TEST(Rational, DerivativesOfARecordAreThoseOfDifferences) {
  const auto data = record_of("(1 + 0.4 s)/((s/0.4 + 1) (s^2/9 + 0.1 s + 1))", frac::Hold::zero_order, true);
  frac::TimeFitOptions options;
  for (const auto& [earlier, free_order] : {std::pair{false, false}, {true, false}, {false, true}, {true, true}}) {
    options.earlier_input = earlier;
    const frac::detail::RationalProblem problem(data, options);
    frac::detail::RationalShape shape;
    shape.factors = {{false, -1.3, 0, 1}, {false, -0.5, 0, 1}, {true, 0.1, 0.5, 1}};
    shape.degree = 3;
    shape.delayed = true;
    shape.delay = 0.2;
    shape.free_order = free_order;
    shape.order = free_order ? 0.8 : 1;
    frac::detail::RationalProblem::Linear linear;
    ASSERT_TRUE(problem.solve(problem.columns(shape), linear));
    const Eigen::MatrixXcd derivatives = problem.derivatives(shape, linear);
    const Eigen::Index count = free_order ? 6 : 5;
    ASSERT_EQ(derivatives.cols(), count);
    const Eigen::VectorXcd coefficients = linear.coefficients.cast<std::complex<double>>();
    // The space of the columns is what differences by poles are known up to.
    const auto outside = [&](const Eigen::VectorXcd& change) {
      Eigen::VectorXd column(linear.residual.size());
      problem.put(change, column);
      return Eigen::VectorXd(column - linear.orthonormal * (linear.orthonormal.transpose() * column));
    };
    for (Eigen::Index k = 0; k < count; ++k) {
      constexpr double step = 1e-4;
      const Eigen::VectorXd change = step * Eigen::VectorXd::Unit(count, k);
      const Eigen::VectorXcd difference =
          (problem.columns(problem.stepped(shape, change)) - problem.columns(problem.stepped(shape, -change))) *
          coefficients / (2 * step);
      const Eigen::VectorXd derivative = outside(derivatives.col(k));
      EXPECT_LT((derivative - outside(difference)).norm(), 1e-4 * derivative.norm()) << k << earlier;
      EXPECT_GT(derivative.norm(), 1e-3);
    }
  }
}

}  // namespace
