// SPDX-License-Identifier: BSD-3-Clause
// The steps of the searches that grow ratios and sums of terms.
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <random>

#include "base/draws.hpp"
#include "identification/rational/rational_problem.hpp"
#include "identification/search/thinned.hpp"
#include "support/noisy_response.hpp"

namespace {

using Eigen::Index;

// The conditions of Karush, Kuhn and Tucker, which a convex problem has at its minimum alone: the cost is level along
// what is inside its bounds, and falls only outwards along what is at one.  Each entry of the slope is a sum of terms
// of at most `size`, so rounding leaves 1e-16 times their number; the solve with a matrix of condition 1e6 (columns of
// 1e-3 to 1) leaves 1e-10 of them.
TEST(GrowthSteps, AreTheMinimumInTheBox) {
  std::mt19937_64 generator(5);
  const auto normal = [&] { return frac::detail::normal_draw(generator); };
  int held = 0, inside = 0;
  for (int round = 0; round < 300; ++round) {
    const Index count = 1 + round % 15;
    Eigen::MatrixXd jacobian(3 * count, count);
    Eigen::VectorXd residual(3 * count), lower(count), upper(count);
    for (Index k = 0; k < count; ++k) {
      const double scale = std::pow(10.0, -3 * frac::detail::uniform_draw(generator));
      for (Index i = 0; i < jacobian.rows(); ++i) jacobian(i, k) = scale * normal();
      // Some have no room either way.
      lower[k] = -std::max(0.0, normal() + 1);
      upper[k] = std::max(0.0, normal() + 1);
    }
    for (double& each : residual) each = normal();
    const frac::detail::NormalEquations normal_equations{jacobian.transpose() * jacobian,
                                                         jacobian.transpose() * residual};
    const Eigen::VectorXd step = normal_equations.step(lower, upper);
    const Eigen::VectorXd slope = normal_equations.gradient + normal_equations.matrix * step;
    const double size = normal_equations.matrix.cwiseAbs().maxCoeff() * (1 + step.cwiseAbs().maxCoeff());
    for (Index k = 0; k < count; ++k) {
      ASSERT_GE(step[k], lower[k]);
      ASSERT_LE(step[k], upper[k]);
      const bool is_inside = step[k] > lower[k] && step[k] < upper[k];
      (is_inside ? inside : held) += 1;
      if (step[k] > lower[k]) {
        EXPECT_LE(slope[k], 1e-9 * size);
      }
      if (step[k] < upper[k]) {
        EXPECT_GE(slope[k], -1e-9 * size);
      }
    }
    const double before = residual.squaredNorm(), after = (residual + jacobian * step).squaredNorm();
    EXPECT_NEAR(normal_equations.gain(step), before - after, 1e-12 * (before + after));
  }
  EXPECT_GT(held, 300);
  EXPECT_GT(inside, 300);
}

// One pole of two is cancelled by the zero wherever it is, so that the data say nothing of its place.  The other has
// three e-folds to go, of which a step takes two at most: the cost of the true one has to be there after a few.  Steps
// that shrink as a whole where a part of them goes far stay where they start.
TEST(GrowthSteps, AreNotHeldUpByWhatTheDataDoNotSee) {
  const auto data = support::noisy_response("1/(s + 1)", {}, 0.0, 1u);
  const auto rule = frac::detail::residual_rule(data, frac::Component::both, frac::Weight::relative);
  const frac::detail::RationalProblem problem(data, rule);
  frac::detail::RationalShape shape;
  shape.factors = {{false, 3 - std::log(problem.centre_omega()), 0, 1}, {false, problem.log_upper() + 1, 0, 1}};
  shape.degree = 1;
  const double before = problem.at(shape).cost;
  const double after = problem.refine(shape, frac::detail::scouting).cost;
  EXPECT_GT(before, 1e-3 * problem.data_power());
  EXPECT_LT(after, 1e-18 * problem.data_power());
}

TEST(GrowthSteps, FewPointsHaveTheEndsAndTheResonance) {
  const auto data = support::noisy_response("1/(s + 1) + 0.02/(s^2 + 0.002 s + 1)", {}, 0.0, 1u, 1201);
  const auto rule = frac::detail::residual_rule(data, frac::Component::both, frac::Weight::relative);
  const auto few = frac::detail::thinned(data, rule, 80);
  EXPECT_LE(few.data.size(), 82u);
  EXPECT_EQ(few.data.omega().front(), data.omega().front());
  EXPECT_EQ(few.data.omega().back(), data.omega().back());
  ASSERT_EQ(few.rule.weight.size(), few.data.size());
  const auto near = [](const frac::FrequencyResponseData& of) {
    return std::count_if(of.omega().begin(), of.omega().end(), [](double w) { return std::abs(w - 1) < 0.005; });
  };
  // All points at which the mode stands above a third of its peak, of which an even choice would keep one in fifteen.
  EXPECT_GE(near(few.data), near(data) / 2);
  for (std::size_t i = 0; i < few.data.size(); ++i) {
    const auto found = std::find(data.omega().begin(), data.omega().end(), few.data.omega()[i]);
    ASSERT_NE(found, data.omega().end());
    const auto at = static_cast<std::size_t>(found - data.omega().begin());
    EXPECT_EQ(few.data.value()[i], data.value()[at]);
    EXPECT_EQ(few.rule.weight[i], rule.weight[at]);
  }
  const auto all = frac::detail::thinned(data, rule, data.size());
  EXPECT_EQ(all.data.omega(), data.omega());
}

}  // namespace
