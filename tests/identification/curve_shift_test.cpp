// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <complex>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "frac/identification/joint_fit.hpp"
#include "frac/identification/statistics.hpp"
#include "support/expect_invalid_argument.hpp"

namespace {

using namespace frac;

constexpr const char* solid = "E0 + E1 (T s)^a/(1 + (T s)^a)";
const std::vector<double> truth{1, 99, 0.01, 0.6};  // E0, E1, T, a

/// Shift factors of a polymer of the universal constants, 20 K above 0 to 60 K above 0, 1 at the third.
double logarithm_of_shift(int curve) {
  const double kelvin = 10.0 * (curve - 2);
  return -std::log(10.0) * 17.44 * kelvin / (51.6 + 20 + kelvin) / 4;
}

/// A modulus over two decades at five temperatures, which together cover a good five.
std::vector<JointCurve> temperatures(double noise, std::uint64_t seed, bool vertical, const char* formula = solid,
                                     int points = 25) {
  std::mt19937_64 generator(seed);
  std::normal_distribution<double> normal(0, noise);
  std::vector<JointCurve> curves;
  for (int c = 0; c < 5; ++c) {
    const double along = std::exp(logarithm_of_shift(c)), up = vertical ? 1 + 0.05 * (c - 2) : 1;
    std::vector<double> omega;
    std::vector<std::complex<double>> value;
    for (int i = 0; i < points; ++i) {
      omega.push_back(std::pow(100.0, static_cast<double>(i) / (points - 1)));
      const std::complex<double> exact = up * Structure(formula).response(truth, along * omega.back());
      const double real = normal(generator), imaginary = normal(generator);
      value.push_back(exact * std::complex<double>(1 + real, imaginary));
    }
    curves.push_back(
        {std::to_string(10 * (c - 2)) + " K", FrequencyResponseData(omega, value), {{"kelvin", 10.0 * (c - 2)}}});
  }
  return curves;
}

JointFitOptions shifting(bool vertical) {
  JointFitOptions options;
  options.fit.component = Component::both;
  options.fit.weight = Weight::relative;
  options.shared = {"E0", "E1", "T", "a"};
  options.shift = CurveShift{2, vertical};
  return options;
}

const ParameterEstimate& named(const JointCurveResult& curve, std::string_view name) {
  for (const ParameterEstimate& each : curve.parameters)
    if (each.name == name) return each;
  throw std::logic_error("no " + std::string(name));
}

TEST(CurveShift, PutsTheFactorsBesideEachS) {
  EXPECT_EQ(shifted(Structure("K/(T s^a + 1)"), {0, false}).formula(), "K/(T (aT s)^a + 1)");
  const std::vector<double> omega{0.3, 2};
  for (const char* formula : {"K exp(-L s)/(2 s^2.2 + 1.5e0 s + s1)", "R1/(1 + R1 Q1 s^n1) + 1/s", solid,
                              "R0 + R1 tanh(sqrt(T s))/sqrt(T s)"}) {
    const Structure master(formula), moved = shifted(master, {0, true});
    std::vector<double> all, plain;
    for (const std::string& name : moved.parameter_names()) all.push_back(name == "aT" ? 3 : name == "bT" ? 2 : 0.7);
    plain.assign(master.parameter_names().size(), 0.7);
    for (const double each : omega)
      EXPECT_LT(std::abs(moved.response(all, each) - 2.0 * master.response(plain, 3 * each)), 1e-13) << formula;
  }
}

// Far below its glass transition a polymer shows a plateau, and any shift factor lays it on the master curve: the law
// follows the other curves alone.  Two laws are searched for, of which the vertical one may be known.
TEST(CurveShift, ACurveOnAPlateauLeadsNoLaw) {
  const Structure master("E0 + E1 (T s)^a/(1 + (T s)^a)");
  const double c1 = 12, c2 = 80;
  std::mt19937_64 generator(4711);
  std::normal_distribution<double> normal(0, 0.02);
  std::vector<JointCurve> curves;
  for (const double kelvin : {-40.0, -20.0, 0.0, 20.0, 40.0}) {
    const double along = std::pow(10, -c1 * kelvin / (c2 + kelvin)), up = 1 + kelvin / 293;
    std::vector<double> omega;
    std::vector<std::complex<double>> value;
    for (int i = 0; i < 25; ++i) {
      omega.push_back(std::pow(10.0, -1 + i / 8.0));
      const double real = normal(generator), imaginary = normal(generator);
      value.push_back(up * master.response(std::vector<double>{1e6, 2e9, 0.01, 0.4}, along * omega.back()) *
                      std::complex<double>(1 + real, imaginary));
    }
    curves.push_back({std::to_string(kelvin), FrequencyResponseData(omega, value), {{"kelvin", kelvin}}});
  }
  for (const bool vertical_is_known : {false, true}) {
    JointFitOptions options = shifting(true);
    options.laws = {"aT = 10^(-C1 kelvin/(C2 + kelvin))"};
    if (vertical_is_known) options.laws.emplace_back("bT = 1 + kelvin/293");
    const JointFitResult result = joint_fit(curves, master, options);
    ASSERT_TRUE(result.usable()) << result.message;
    EXPECT_GT(result.sharing_p_value, 1e-3) << result.message;
    for (const JointCurveResult& curve : result.curves) EXPECT_LT(curve.rms, 0.03) << curve.name;
    // Of normal estimates one in 370 is farther off than three standard errors.
    for (const auto& [name, drawn] : {std::pair{"C1", c1}, {"C2", c2}, {"a", 0.4}}) {
      const auto found =
          std::find_if(result.shared.begin(), result.shared.end(),
                       [&, wanted = std::string(name)](const auto& each) { return each.name == wanted; });
      ASSERT_NE(found, result.shared.end()) << name;
      EXPECT_NEAR(found->value, drawn, 3 * found->standard_error) << name;
    }
    // A factor over twelve decades has an interval of factors.
    EXPECT_GT(named(result.curves.front(), "aT").ci95_lower, 0);
  }
}

TEST(CurveShift, RecoversFactorsOfExactCurves) {
  for (const bool vertical : {false, true}) {
    const JointFitResult result = joint_fit(temperatures(0, 1, vertical), Structure(solid), shifting(vertical));
    ASSERT_TRUE(result.usable()) << result.message;
    for (std::size_t k = 0; k < 4; ++k) EXPECT_NEAR(result.shared[k].value, truth[k], 1e-5 * truth[k]);
    for (int c = 0; c < 5; ++c) {
      const JointCurveResult& curve = result.curves[static_cast<std::size_t>(c)];
      EXPECT_NEAR(std::log(named(curve, "aT").value), logarithm_of_shift(c), 1e-5);
      if (vertical) {
        EXPECT_NEAR(named(curve, "bT").value, 1 + 0.05 * (c - 2), 1e-5);
      }
      EXPECT_EQ(named(curve, "aT").fixed, c == 2);
    }
    EXPECT_EQ(result.free_parameters, vertical ? 12u : 8u);
  }
}

// The errors against the inverse of the whole normal matrix, with derivatives by differences.
TEST(CurveShift, ErrorsAreThoseOfTheWholeNormalMatrix) {
  const auto curves = temperatures(0.01, 2, false);
  const JointFitResult result = joint_fit(curves, Structure(solid), shifting(false));
  ASSERT_TRUE(result.usable()) << result.message;
  Eigen::VectorXd values(8);  // ln E0, ln E1, ln T, a, ln aT of all but the third
  const auto slot = [](std::size_t c) { return static_cast<Eigen::Index>(c < 2 ? 4 + c : 3 + c); };
  for (Eigen::Index k = 0; k < 4; ++k) {
    const double value = result.shared[static_cast<std::size_t>(k)].value;
    values[k] = k == 3 ? value : std::log(value);
  }
  for (const std::size_t c : {0u, 1u, 3u, 4u}) values[slot(c)] = std::log(named(result.curves[c], "aT").value);
  const auto residuals = [&](const Eigen::VectorXd& at) {
    Eigen::VectorXd all(5 * 50);
    Eigen::Index row = 0;
    for (std::size_t c = 0; c < 5; ++c) {
      const std::vector<double> parameters{std::exp(at[0]), std::exp(at[1]), std::exp(at[2]), at[3]};
      const double along = c == 2 ? 1 : std::exp(at[slot(c)]);
      for (std::size_t i = 0; i < 25; ++i) {
        const std::complex<double> data = curves[c].response()->value()[i];
        const std::complex<double> rest =
            (Structure(solid).response(parameters, along * curves[c].response()->omega()[i]) - data) / std::abs(data) /
            result.curves[c].noise;
        all[row++] = rest.real();
        all[row++] = rest.imag();
      }
    }
    return all;
  };
  Eigen::MatrixXd jacobian(250, 8);
  for (Eigen::Index k = 0; k < 8; ++k) {
    Eigen::VectorXd left = values, right = values;
    left[k] -= 1e-5;
    right[k] += 1e-5;
    jacobian.col(k) = (residuals(right) - residuals(left)) / 2e-5;
  }
  // At the minimum the residuals are at right angles to every derivative.
  EXPECT_LT((jacobian.transpose() * residuals(values)).norm(), 1e-3 * jacobian.norm());
  const Eigen::MatrixXd covariance =
      (jacobian.transpose() * jacobian).inverse() * residuals(values).squaredNorm() / (250 - 8);
  for (Eigen::Index k = 0; k < 4; ++k) {
    const ParameterEstimate& each = result.shared[static_cast<std::size_t>(k)];
    const double unit = k == 3 ? 1 : each.value;
    EXPECT_NEAR(each.standard_error / each.widening / unit / std::sqrt(covariance(k, k)), 1, 1e-3);
  }
  for (const std::size_t c : {0u, 1u, 3u, 4u}) {
    const ParameterEstimate& each = named(result.curves[c], "aT");
    EXPECT_NEAR(each.standard_error / each.widening / each.value / std::sqrt(covariance(slot(c), slot(c))), 1, 1e-3);
  }
}

TEST(CurveShift, FactorsMayFollowALaw) {
  JointFitOptions options = shifting(false);
  options.laws = {"aT = exp(-C kelvin/(D + kelvin))"};
  options.fit.constraints.push_back({"D", {}, 30, 500, 60});
  const JointFitResult result = joint_fit(temperatures(0, 3, false), Structure(solid), options);
  ASSERT_TRUE(result.usable()) << result.message;
  const auto shared = [&](const std::string& name) {
    for (const ParameterEstimate& each : result.shared)
      if (each.name == name) return each.value;
    return 0.0;
  };
  EXPECT_NEAR(shared("C"), std::log(10.0) * 17.44 / 4, 1e-4);
  EXPECT_NEAR(shared("D"), 71.6, 1e-3);
  EXPECT_NEAR(shared("T"), 0.01, 1e-6);
}

// The law is 1 at the third curve, which is not the reference: the structure is that of the third curve all the same.
// Five standard errors of four parameters in four cases leave a chance of 1e-5, and so does the F test at 1e-5.
TEST(CurveShift, ALawSaysWhichCurveIsTheMasterCurve) {
  for (const std::size_t reference : {0u, 4u}) {
    for (const std::uint64_t seed : {41u, 42u}) {
      JointFitOptions options = shifting(false);
      options.shift->reference = reference;
      options.laws = {"aT = exp(-C kelvin/(D + kelvin))"};
      const JointFitResult result = joint_fit(temperatures(0.01, seed, false), Structure(solid), options);
      ASSERT_TRUE(result.usable()) << result.message;
      for (std::size_t k = 0; k < 4; ++k)
        EXPECT_LT(std::abs(result.shared[k].value - truth[k]), 5 * result.shared[k].standard_error) << k;
      EXPECT_LT(result.shared[2].standard_error, 0.1 * truth[2]);
      EXPECT_GT(result.sharing_p_value, 1e-5);
    }
  }
}

/// Few temperatures over one or two decades each, of a solid that relaxes slower than that: curves that are nearly
/// straight lines, and a law that is nearly one over them.
struct ShortCurves {
  std::vector<JointCurve> curves;
  std::vector<std::pair<std::string, double>> drawn;
  std::size_t reference;
};
ShortCurves short_curves(std::uint64_t seed) {
  std::mt19937_64 generator(seed);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::normal_distribution<double> normal;
  const auto draw = [&](double from, double to) { return from + (to - from) * uniform(generator); };
  ShortCurves made;
  const double c1 = draw(5, 20), c2 = draw(50, 150), step = draw(5, 12), a = draw(0.3, 0.8);
  const double noise = std::pow(10, draw(-3, -1.5)), time = std::pow(10, draw(0, 2)), decades = draw(1, 2);
  const int count = static_cast<int>(draw(4, 8)), points = static_cast<int>(draw(12, 32));
  made.reference = static_cast<std::size_t>(std::min(draw(0, count), 0.6 * c2 / step));
  made.drawn = {{"E0", 1}, {"E1", 99}, {"T", time}, {"a", a}, {"C1", c1}, {"C2", c2}};
  for (int c = 0; c < count; ++c) {
    const double kelvin = step * (c - static_cast<double>(made.reference));
    const double along = std::pow(10, -c1 * kelvin / (c2 + kelvin));
    std::vector<double> omega;
    std::vector<std::complex<double>> value;
    for (int i = 0; i < points; ++i) {
      omega.push_back(std::pow(10, decades * i / (points - 1)));
      const double real = noise * normal(generator), imaginary = noise * normal(generator);
      value.push_back(Structure(solid).response(std::vector<double>{1, 99, time, a}, along * omega.back()) *
                      std::complex<double>(1 + real, imaginary));
    }
    made.curves.push_back({std::to_string(c), FrequencyResponseData(omega, value), {{"kelvin", kelvin}}});
  }
  return made;
}

/// Where the search with the law ends without a start, and where it ends from the truth.
struct Ends {
  JointFitResult found, from_truth;
};
Ends ends_with_law(const ShortCurves& made) {
  JointFitOptions options = shifting(false);
  options.shift->reference = made.reference;
  options.laws = {"aT = 10^(-C1 kelvin/(C2 + kelvin))"};
  JointFitResult found = joint_fit(made.curves, Structure(solid), options);
  for (const auto& [name, value] : made.drawn) options.fit.constraints.push_back({name, {}, {}, {}, value});
  return {std::move(found), joint_fit(made.curves, Structure(solid), options)};
}

// A hyperbola that becomes a line follows the factors almost as well, and a search of it does not end; and where few
// curves tell their factor, a law may turn between two temperatures.  The search from the truth ends no lower: costs
// settle to 1e-7.
TEST(CurveShift, ALawThatIsNearlyALineIsFound) {
  for (const std::uint64_t seed : {27U, 46U, 58U, 71U, 1109U}) {
    const auto [result, from_truth] = ends_with_law(short_curves(seed));
    EXPECT_TRUE(result.usable()) << seed << ": " << result.message;
    EXPECT_LE(result.cost, from_truth.cost * (1 + 1e-5)) << seed;
  }
}

/// Curves over 1.5 to 4 decades of a solid that is on a plateau at some of the temperatures, with 1 to 5 % noise, and a
/// law that is 1 at any of them.
ShortCurves curves_on_plateaus(std::uint64_t seed) {
  std::mt19937_64 generator(seed * 7919 + 13);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::normal_distribution<double> normal;
  const auto draw = [&](double from, double to) { return from + (to - from) * uniform(generator); };
  ShortCurves made;
  draw(0, 1);
  const int count = static_cast<int>(draw(4, 9)), points = static_cast<int>(draw(10, 30));
  const double noise = draw(0.01, 0.05), decades = draw(1.5, 4), a = draw(0.3, 0.8),
               modulus = std::pow(10, draw(1, 3.5));
  const double c1 = draw(5, 20), c2 = draw(40, 160), step = draw(5, 20);
  draw(0, 1);
  draw(0, 1);
  made.reference = static_cast<std::size_t>(draw(0, count));
  const double first = -std::min(step * draw(0, count), 0.7 * c2), time = std::pow(10, draw(-3, 2));
  made.drawn = {{"E0", 1}, {"E1", modulus}, {"T", time}, {"a", a}, {"C1", c1}, {"C2", c2}};
  for (int c = 0; c < count; ++c) {
    const double kelvin = first + step * c, along = std::pow(10, -c1 * kelvin / (c2 + kelvin));
    std::vector<double> omega;
    std::vector<std::complex<double>> value;
    for (int i = 0; i < points; ++i) {
      omega.push_back(std::pow(10, -1 + decades * i / (points - 1)));
      const double real = noise * normal(generator), imaginary = noise * normal(generator);
      value.push_back(Structure(solid).response(std::vector<double>{1, modulus, time, a}, along * omega.back()) *
                      std::complex<double>(1 + real, imaginary));
    }
    made.curves.push_back({std::to_string(c), FrequencyResponseData(omega, value), {{"kelvin", kelvin}}});
  }
  return made;
}

double sum_of_squares(const JointFitResult& result) {
  double sum = 0;
  for (const JointCurveResult& each : result.curves) sum += each.rms * each.rms * static_cast<double>(each.residuals);
  return sum;
}

// One curve laid in a wrong place takes all beyond it along, and a law that follows them leaves ten times the squares
// of the search from the truth.  Ends that are as likely differ by less than a thousandth.
TEST(CurveShift, ALawIsFoundWhereCurvesAreLaidWrongly) {
  for (const std::uint64_t seed : {10U, 74U, 2043U}) {
    const auto [result, from_truth] = ends_with_law(curves_on_plateaus(seed));
    EXPECT_TRUE(result.usable()) << seed << ": " << result.message;
    EXPECT_LE(sum_of_squares(result), sum_of_squares(from_truth) * 1.001) << seed;
  }
}

// ln aT bends by more than 1 away from every straight line, which moves the modulus by far more than its noise.
TEST(CurveShift, ALawThatTheFactorsDoNotFollowIsNamed) {
  JointFitOptions options = shifting(false);
  options.laws = {"aT = exp(-C kelvin)"};
  const JointFitResult result = joint_fit(temperatures(0.01, 43, false), Structure(solid), options);
  EXPECT_LT(result.sharing_p_value, 1e-10);
  EXPECT_NE(result.message.find("do not follow their law"), std::string::npos) << result.message;
}

// Factors settle to 1e-6, a thousandth of a standard error or less.
TEST(CurveShift, OrderOfTheCurvesTellsNothing) {
  for (const std::uint64_t seed : {51u, 52u, 53u}) {
    const auto curves = temperatures(0.01, seed, false);
    std::vector<double> first;
    for (const std::vector<std::size_t>& order :
         std::vector<std::vector<std::size_t>>{{0, 1, 2, 3, 4}, {4, 3, 2, 1, 0}, {4, 0, 2, 3, 1}, {1, 0, 2, 4, 3}}) {
      std::vector<JointCurve> ordered;
      for (const std::size_t c : order) ordered.push_back(curves[c]);
      JointFitOptions options = shifting(false);
      options.fit.weight = Weight::learned;
      const JointFitResult result = joint_fit(ordered, Structure(solid), options);
      ASSERT_TRUE(result.usable()) << result.message;
      for (std::size_t k = 0; k < 4; ++k) {
        if (first.size() < 4)
          first.push_back(result.shared[k].value);
        else
          EXPECT_NEAR(result.shared[k].value, first[k], 2e-3 * result.shared[k].standard_error) << seed;
      }
    }
  }
}

// Curves in any order of the reference, and of noise that hides neighbours' slopes.
TEST(CurveShift, FindsThePlaceOfNoisyCurves) {
  for (std::uint64_t seed = 10; seed < 30; ++seed) {
    JointFitOptions options = shifting(seed % 2 == 0);
    options.shift->reference = seed % 5;
    const JointFitResult result = joint_fit(temperatures(0.03, seed, true), Structure(solid), options);
    ASSERT_TRUE(result.usable()) << result.message;
    for (int c = 0; c < 5; ++c) {
      const double expected = logarithm_of_shift(c) - logarithm_of_shift(static_cast<int>(seed % 5));
      EXPECT_NEAR(std::log(named(result.curves[static_cast<std::size_t>(c)], "aT").value), expected, 0.6) << seed;
    }
  }
}

TEST(CurveShift, SaysWhatItCannotTake) {
  const auto curves = temperatures(0, 4, false);
  const auto refused = [&](JointFitOptions options, const char* formula, const char* text) {
    support::expect_invalid_argument([&] { static_cast<void>(joint_fit(curves, Structure(formula), options)); },
                                     {text});
  };
  JointFitOptions options = shifting(false);
  options.shared = {"aT"};
  refused(options, "aT s", "'aT'");
  options = shifting(false);
  options.shift->reference = 5;
  refused(options, solid, "reference");
  options = shifting(false);
  options.fit.weight = Weight::repeats;
  refused(options, solid, "repeats");
}

}  // namespace
