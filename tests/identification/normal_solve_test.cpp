// SPDX-License-Identifier: BSD-3-Clause
#include "identification/search/normal_solve.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <cstddef>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "identification/residuals/frequency_problem.hpp"
#include "identification/statistics/curvature_fit.hpp"
#include "support/noisy_response.hpp"

namespace {

using frac::FrequencyResponseData;
using frac::detail::FrequencyProblem;
using frac::detail::LocalOptions;
using frac::detail::LocalSolution;

constexpr double infinity = std::numeric_limits<double>::infinity();

/// A fit of both parts with equal weights.
struct Fit {
  Fit(const FrequencyResponseData& data, const char* formula, std::vector<frac::ParameterConstraint> constraints = {})
      : structure(formula), problem(data, structure, options_with(std::move(constraints))) {}

  [[nodiscard]] LocalSolution from(const std::vector<double>& start, double tolerance = 1e-9, int iterations = 200) {
    LocalOptions options;
    options.iterations = iterations;
    options.cost_tolerance = tolerance;
    return frac::detail::normal_solve(problem.residuals(), problem.map.to_theta(start), options);
  }
  [[nodiscard]] double first_of(const LocalSolution& found) const { return problem.map.to_user(found.theta)[0]; }

  frac::Structure structure;
  FrequencyProblem problem;

 private:
  [[nodiscard]] static frac::FitOptions options_with(std::vector<frac::ParameterConstraint> constraints) {
    frac::FitOptions options;
    options.component = frac::Component::both;
    options.weight = frac::Weight::absolute;
    options.constraints = std::move(constraints);
    return options;
  }
};

// Ceres goes on until a step gains 1e-14 of the cost.  Solves of 1e-9 end at the same minimum: near it each step leaves
// a share of what the one before has left, well below a half with noise of 1 %, so what is left is below the tolerance.
TEST(NormalSolve, EndsWhereCeresEnds) {
  const struct {
    const char* formula;
    std::vector<double> truth, start;
  } cases[] = {{"K/(T s^a + 1)", {2, 0.5, 0.8}, {1, 1, 1.2}},
               {"K exp(-L s)/(T s + 1)", {-1.5, 0.01, 0.5}, {-1, 0.001, 1}},
               {"R0 + R1/(1 + (T s)^a)", {0.1, 1, 2, 0.7}, {0.5, 0.5, 1, 1}},
               {"(b0 + b1 s)/(s^2 + a1 s + a0)", {1, -0.3, 0.4, 2}, {0.5, 0.1, 1, 1}}};
  for (const auto& [formula, truth, start] : cases) {
    for (unsigned seed = 1; seed <= 5; ++seed) {
      const FrequencyResponseData data = support::noisy_response(formula, truth, 0.01, seed);
      Fit fit(data, formula);
      const LocalSolution found = fit.from(start);
      const LocalSolution lowest =
          frac::detail::local_solve(fit.problem.residuals(), fit.problem.map.to_theta(start), LocalOptions());
      EXPECT_TRUE(found.converged) << formula << seed;
      EXPECT_NEAR(found.cost, lowest.cost, 1e-9 * lowest.cost) << formula << seed;
      EXPECT_EQ(found.cost, found.objective);
      EXPECT_NEAR(found.cost, fit.problem.residuals().cost(found.theta), 1e-13 * found.cost);
    }
  }
}

// Dead time and order press against their bounds, and all of the model moves with them.  Refits end when a step gains
// 1e-8 of the cost; a share of 1e-5 is a hundredth of what noise makes of the sum of 120 squares along one direction.
TEST(LocalSolve, RefitsComeToRestBesideABound) {
  const struct {
    const char *formula, *truth;
    std::vector<frac::ParameterConstraint> constraints;
    std::vector<double> start;
  } cases[] = {{"K exp(-L s)/(T s + 1)", "(0.05 s + 1)/(0.5 s + 1)", {}, {1, 0, 0.5}},
               {"K/(1 + (T s)^a)", "1/(1 + (0.5 s)^1.03)", {{"a", {}, 0, 1, {}}}, {1, 0.5, 1}}};
  for (const auto& [formula, truth, constraints, start] : cases) {
    for (unsigned seed = 1; seed <= 10; ++seed) {
      const FrequencyResponseData data = support::noisy_response(truth, {}, 0.01, seed);
      Fit fit(data, formula, constraints);
      const std::vector<double> theta = fit.problem.map.to_theta(start);
      LocalOptions refit;
      refit.cost_tolerance = frac::detail::settled_refit;
      const LocalSolution found = frac::detail::local_solve(fit.problem.residuals(), theta, refit),
                          lowest = frac::detail::local_solve(fit.problem.residuals(), theta, LocalOptions());
      EXPECT_NEAR(found.cost, lowest.cost, 1e-5 * lowest.cost) << formula << seed;
    }
  }
}

/// 1 + i over any frequencies, and 3 + i at the last.
FrequencyResponseData ones_and_a_three() {
  return {{1, 2, 4, 8}, {{1, 1}, {1, 1}, {1, 1}, {3, 1}}};
}

// Of a constant the residuals are linear but for the imaginary part, which it does not reach: its mean of 3/2 has the
// least cost, 3/4 + 9/4 + 4 in squares of the unit.  Of the distance damping leaves 1e-4, and of that the next step
// less.
TEST(NormalSolve, OfALinearModelIsTheMean) {
  const FrequencyResponseData data = ones_and_a_three();
  Fit fit(data, "K", {{"K", {}, -infinity, {}, {}}});
  const LocalSolution found = fit.from({-4});
  EXPECT_TRUE(found.converged);
  EXPECT_NEAR(fit.first_of(found), 1.5, 1e-4);
  EXPECT_NEAR(found.cost, 7.0 / (fit.problem.unit * fit.problem.unit), 1e-8);
}

// Beyond 1.2 the mean is out of reach: the cost at the bound, (3 x .04 + 3.24 + 4), is the least.
TEST(NormalSolve, StaysWithinBounds) {
  const FrequencyResponseData data = ones_and_a_three();
  Fit fit(data, "K", {{"K", {}, -infinity, 1.2, {}}});
  const LocalSolution found = fit.from({-4});
  EXPECT_TRUE(found.converged);
  EXPECT_DOUBLE_EQ(fit.first_of(found), 1.2);
  EXPECT_NEAR(found.cost, 7.36 / (fit.problem.unit * fit.problem.unit), 1e-13);
}

// A prior counts as one more datum: precisions add up.  Of nine to go the first step leaves a damping of 1e-4, the
// second one of a third of that.
TEST(NormalSolve, HeedsPriors) {
  const FrequencyResponseData data = ones_and_a_three();
  frac::ParameterConstraint known{"K", {}, -infinity, {}, {}};
  known.prior = frac::ParameterPrior{5, 0.2, false};
  Fit fit(data, "K", {known});
  const double noise = fit.problem.residuals().prior_weight();
  const double of_data = 4 / (fit.problem.unit * fit.problem.unit), of_prior = noise * noise / (0.2 * 0.2);
  const LocalSolution found = fit.from({-4}, 1e-12, 2);
  EXPECT_NEAR(fit.first_of(found), (of_data * 1.5 + of_prior * 5) / (of_data + of_prior), 1e-5);
  EXPECT_NEAR(found.cost, fit.problem.residuals().cost(found.theta), 1e-14 * found.cost);
}

TEST(NormalSolve, SaysThatItCannotStart) {
  const FrequencyResponseData data = ones_and_a_three();
  Fit fit(data, "K s^n");
  LocalOptions options;
  const std::vector<double> start(2, std::numeric_limits<double>::quiet_NaN());
  const LocalSolution found = frac::detail::normal_solve(fit.problem.residuals(), start, options);
  EXPECT_EQ(found.cost, infinity);
  EXPECT_FALSE(found.converged);
}

// One of two gains in parallel can be anything as long as the other makes up for it: curvature is 0 along that way.
TEST(NormalSolve, GoesStraightWhereTheDataDoNotSee) {
  const FrequencyResponseData data = support::noisy_response("1/(s + 1)", {}, 0.01, 3u);
  Fit both(data, "(A + B)/(s + 1)", {{"A", {}, -infinity, {}, {}}, {"B", {}, -infinity, {}, {}}});
  Fit single(data, "A/(s + 1)", {{"A", {}, -infinity, {}, {}}});
  const LocalSolution found = both.from({5, -1}), alone = single.from({5});
  EXPECT_TRUE(found.converged);
  EXPECT_NEAR(found.cost, alone.cost, 1e-9 * alone.cost);
}

// A gain of 0 hides what comes behind it: the first step is that of the gain alone.
TEST(NormalSolve, LeavesAPlaceWhereAParameterHasNoInfluence) {
  const FrequencyResponseData data = support::noisy_response("2/(0.5 s + 1)", {}, 0.01, 3u);
  Fit fit(data, "K/(T s + 1)");
  const LocalSolution found = fit.from({0, 1}), other = fit.from({1, 1});
  EXPECT_TRUE(found.converged);
  EXPECT_NEAR(found.cost, other.cost, 1e-9 * other.cost);
}

/// ln((3 - 2 x)/1), which is 0 at 1 and does not exist from 3/2 on.
class Logarithm final : public frac::detail::Residuals {
 public:
  explicit Logarithm(const frac::detail::ParameterMap& map) : Residuals(map) {}
  [[nodiscard]] std::size_t points() const noexcept override { return 1; }
  [[nodiscard]] std::size_t per_point() const noexcept override { return 1; }
  bool evaluate(std::span<const double> theta, double* residual, double* jacobian) const override {
    const double distance = 3 - 2 * theta[0];
    residual[0] = std::log(distance);
    if (jacobian) jacobian[0] = -2 / distance;
    return distance > 0;
  }
  [[nodiscard]] BestFactor best_factor(std::span<const double>) const override { return {}; }
};

// From -10 the undamped step goes to -10 + 23/2 ln 23 = 26.
TEST(NormalSolve, StepsBackFromWhereTheModelIsNotFinite) {
  const frac::detail::ParameterMap map(frac::Structure("K"), {{"K", {}, -infinity, {}, {}}}, {1, 1, 1, 1, 1, 1});
  const Logarithm residuals(map);
  const LocalSolution found = frac::detail::normal_solve(residuals, {-10}, LocalOptions());
  EXPECT_NEAR(found.theta[0], 1, 1e-6);
}

}  // namespace
