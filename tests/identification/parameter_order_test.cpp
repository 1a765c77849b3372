// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "frac/identification/fit.hpp"
#include "frac/identification/joint_fit.hpp"
#include "frac/identification/statistics.hpp"
#include "frac/identification/uncertainty.hpp"
#include "identification/residuals/parameter_map.hpp"
#include "support/expect_invalid_argument.hpp"
#include "support/noisy_response.hpp"

namespace {

using namespace frac;

ParameterConstraint above(const std::string& greater, const std::string& lesser) {
  ParameterConstraint constraint{greater, {}, {}, {}, {}};
  constraint.above = lesser;
  return constraint;
}

FitOptions plain(std::vector<ParameterConstraint> constraints) {
  FitOptions options;
  options.component = Component::both;
  options.weight = Weight::absolute;
  options.constraints = std::move(constraints);
  return options;
}

/// A + j omega B with noise, in which the real part tells A alone and the imaginary part B alone.
struct Line {
  FrequencyResponseData data;
  double mean_a, mean_b;        // by least squares of their own
  double squares_a, squares_b;  // sums of squares of the derivatives
  double least;                 // cost there
  [[nodiscard]] double cost(double a, double b) const {
    return least + squares_a * (a - mean_a) * (a - mean_a) + squares_b * (b - mean_b) * (b - mean_b);
  }
};
Line line(double a, double b, std::uint64_t seed) {
  std::mt19937_64 generator(seed);
  std::normal_distribution<double> noise(0, 0.1);
  std::vector<double> omega;
  std::vector<std::complex<double>> value;
  double sum = 0, product = 0, squares = 0;
  for (int i = 1; i <= 20; ++i) {
    omega.push_back(0.1 * i);
    const double real = a + noise(generator), imaginary = b * omega.back() + noise(generator);
    value.emplace_back(real, imaginary);
    sum += real;
    product += omega.back() * imaginary;
    squares += omega.back() * omega.back();
  }
  double cost = 0;
  for (std::size_t i = 0; i < 20; ++i)
    cost += std::norm(value[i] - std::complex<double>(sum / 20, product / squares * omega[i]));
  return {{omega, value}, sum / 20, product / squares, 20, squares, cost};
}

// The derivatives by theta against differences, and the way there and back, for every form an order takes.
TEST(ParameterOrder, MapsBackAndHasTheDerivativesOfDifferences) {
  struct Case {
    const char* formula;
    std::vector<ParameterConstraint> constraints;
    std::vector<double> parameters;
  };
  ParameterConstraint below_ten = above("C", "B");
  below_ten.upper = 10;
  ParameterConstraint any_a{"A", {}, -10, {}, {}}, any_b = above("B", "A");
  any_b.upper = 20;
  for (const Case& test :
       {Case{"A + B s + C s^2", {above("B", "A"), below_ten}, {1, 2, 5}}, Case{"A + B s", {any_a, any_b}, {-1, 2}},
        Case{"A + B s", {{"A", {}, -10, {}, {}}, above("B", "A")}, {-1, 2}},
        Case{"K1 s^a1 + K2 s^a2", {above("a2", "a1"), above("K1", "K2")}, {3, 0.3, 2, 0.8}},
        Case{"R1/(1 + R1 Q1 s^n1) + R2/(1 + R2 Q2 s^n2)",
             {above("n1", "n2"), above("Q2", "Q1"), above("R1", "R2")},
             {5, 0.1, 0.9, 2, 0.4, 0.7}},
        Case{"exp(-L1 s) + K exp(-L2 s)", {above("L2", "L1")}, {0.1, 2, 0.3}}}) {
    const Structure structure(test.formula);
    const detail::ParameterMap map(structure, test.constraints, {3, 0.1, 50, 7, 0.1, 100});
    const std::vector<double> theta = map.to_theta(test.parameters);
    const std::vector<double> back = map.to_user(theta);
    for (std::size_t i = 0; i < back.size(); ++i)
      EXPECT_NEAR(back[i], test.parameters[i], 1e-13 * std::abs(test.parameters[i])) << test.formula;
    const Eigen::MatrixXd jacobian = map.jacobian(back);
    for (std::size_t k = 0; k < theta.size(); ++k) {
      std::vector<double> left = theta, right = theta;
      constexpr double step = 1e-5;
      left[k] -= step;
      right[k] += step;
      const std::vector<double> before = map.to_user(left), after = map.to_user(right);
      for (std::size_t i = 0; i < back.size(); ++i)
        EXPECT_NEAR(jacobian(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k)),
                    (after[i] - before[i]) / (2 * step), 1e-7 * (1 + std::abs(back[i])))
            << test.formula << ", " << i << " by " << k;
    }
  }
}

TEST(ParameterOrder, ChangesNothingWhereTheDataHaveIt) {
  const Line data = line(1, 2, 1);
  const FitResult with = fit(data.data, Structure("A + B s"), plain({above("B", "A")}));
  const FitResult without = fit(data.data, Structure("A + B s"), plain({}));
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_NEAR(with.parameters[i].value, without.parameters[i].value, 1e-7);
    EXPECT_NEAR(with.parameters[i].standard_error, without.parameters[i].standard_error, 1e-7);
    EXPECT_NEAR(with.parameters[i].centre_standard_error, without.parameters[i].centre_standard_error, 1e-7);
    EXPECT_FALSE(with.parameters[i].at_bound);
  }
}

// Least squares under A <= B where the data want A > B: both at the mean by their weights.
TEST(ParameterOrder, HoldsBothAtTheirMeanWhereTheDataWantTheOtherOrder) {
  const Line data = line(2, 1, 2);
  const FitOptions options = plain({above("B", "A")});
  const FitResult result = fit(data.data, Structure("A + B s"), options);
  ASSERT_TRUE(result.usable()) << result.message;
  const double mean = (data.squares_a * data.mean_a + data.squares_b * data.mean_b) / (data.squares_a + data.squares_b);
  EXPECT_NEAR(result.parameters[0].value, mean, 1e-6);
  EXPECT_NEAR(result.parameters[1].value, mean, 1e-6);
  EXPECT_NEAR(result.cost, data.cost(mean, mean), 1e-8);
  EXPECT_TRUE(result.parameters[1].at_bound);
  EXPECT_TRUE(std::isnan(result.parameters[1].standard_error));
  // The other one's interval takes them as equal.
  const double variance = result.cost / 38;
  EXPECT_NEAR(result.parameters[0].standard_error / result.parameters[0].widening,
              std::sqrt(variance / (data.squares_a + data.squares_b)), 1e-6);
  EXPECT_NE(result.message.find("At a bound: B"), std::string::npos) << result.message;
  EXPECT_NE(result.message.find("order"), std::string::npos) << result.message;
}

// With A held the least cost is that of B at its own best, or at A where that is higher: the ends of the profile are
// where this reaches what the interval allows.
TEST(ParameterOrder, ProfilesRunAlongTheOrder) {
  const Line data = line(2.0, 2.0, 3);
  ASSERT_LT(data.mean_a, data.mean_b);  // in order, but so near that the order cuts the interval
  const FitOptions options = plain({above("B", "A")});
  const FitResult result = fit(data.data, Structure("A + B s"), options);
  const auto least = [&](double a) { return data.cost(a, std::max(a, data.mean_b)); };
  const double t = student_t_95(38) * result.parameters[0].widening;
  const double allowed = result.cost + t * t * result.cost / 38;
  const auto root = [&](double inside, double outside) {
    for (int step = 0; step < 60; ++step) {
      const double middle = (inside + outside) / 2;
      (least(middle) < allowed ? inside : outside) = middle;
    }
    return inside;
  };
  const ProfileInterval profile = profile_interval(data.data, options, result, "A");
  const double width = data.mean_a - root(data.mean_a, data.mean_a - 1);
  EXPECT_NEAR(profile.lower, data.mean_a - width, 1e-4 * width);
  EXPECT_NEAR(profile.upper, root(data.mean_a, data.mean_a + 1), 1e-4 * width);
  EXPECT_LT(profile.upper - data.mean_a, 0.99 * width);
}

// Two arcs named so that the rising times which labels have by default are against the order.
TEST(ParameterOrder, DecidesWhichPartHasWhichName) {
  std::mt19937_64 generator(4);
  const char* arcs = "R1/(1 + R1 Q1 s^n1) + R2/(1 + R2 Q2 s^n2)";
  const FrequencyResponseData data = support::noisy_response(arcs, {10, 0.5, 0.8, 4, 0.001, 0.9}, 0.005, generator, 60);
  FitOptions options;
  options.component = Component::both;
  options.constraints = {above("Q2", "Q1")};
  const FitResult up = fit(data, Structure(arcs), options);
  options.constraints = {above("Q1", "Q2")};
  const FitResult down = fit(data, Structure(arcs), options);
  ASSERT_TRUE(up.usable() && down.usable());
  EXPECT_NEAR(up.cost, down.cost, 1e-6 * up.cost);
  EXPECT_LT(up.parameters[1].value, up.parameters[4].value);
  for (std::size_t i = 0; i < 3; ++i)
    EXPECT_NEAR(up.parameters[i].value, down.parameters[i + 3].value, 1e-4 * std::abs(up.parameters[i].value));
}

TEST(ParameterOrder, OfCurvesFittedTogetherIsKept) {
  // A and B of all three: the data want A > B in each.
  std::vector<JointCurve> curves;
  std::vector<Line> lines;
  for (const std::uint64_t seed : {5u, 6u, 7u}) lines.push_back(line(2, 1, seed));
  for (const Line& each : lines) curves.push_back({"curve", each.data});
  JointFitOptions options;
  options.fit = plain({above("B", "A")});
  options.shared = {"A", "B"};
  const JointFitResult shared = joint_fit(curves, Structure("A + B s"), options);
  ASSERT_TRUE(shared.usable()) << shared.message;
  double sum = 0, weight = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    const double variance = std::pow(shared.curves[c].noise, 2);
    sum += (lines[c].squares_a * lines[c].mean_a + lines[c].squares_b * lines[c].mean_b) / variance;
    weight += (lines[c].squares_a + lines[c].squares_b) / variance;
  }
  EXPECT_NEAR(shared.shared[0].value, sum / weight, 1e-6);
  EXPECT_NEAR(shared.shared[1].value, sum / weight, 1e-6);
  EXPECT_TRUE(shared.shared[0].at_bound != shared.shared[1].at_bound);

  // A shared, B above it in each curve: as far as the data want it, and no further down.
  lines[0] = line(2, 3, 8);
  curves[0].data = lines[0].data;
  options.shared = {"A"};
  const JointFitResult own = joint_fit(curves, Structure("A + B s"), options);
  ASSERT_TRUE(own.usable()) << own.message;
  EXPECT_NEAR(own.curves[0].parameters[1].value, lines[0].mean_b, 1e-6);
  EXPECT_FALSE(own.curves[0].parameters[1].at_bound);
  sum = weight = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    const double variance = std::pow(own.curves[c].noise, 2);
    sum += lines[c].squares_a * lines[c].mean_a / variance;
    weight += lines[c].squares_a / variance;
    if (c == 0) continue;
    sum += lines[c].squares_b * lines[c].mean_b / variance;
    weight += lines[c].squares_b / variance;
    EXPECT_TRUE(own.curves[c].parameters[1].at_bound);
  }
  EXPECT_NEAR(own.shared[0].value, sum / weight, 1e-6);
  EXPECT_NEAR(own.curves[1].parameters[1].value, sum / weight, 1e-6);
}

TEST(ParameterOrder, IsRefusedWhereItMakesNoSense) {
  const Line data = line(1, 2, 9);
  const auto refused = [&](const char* formula, std::vector<ParameterConstraint> constraints, const char* text) {
    support::expect_invalid_argument(
        [&] { static_cast<void>(fit(data.data, Structure(formula), plain(std::move(constraints)))); }, {text});
  };
  refused("A + B s", {above("B", "A"), above("A", "B")}, "circle");
  refused("A + B s^n", {above("n", "A")}, "another kind");
  refused("A + B s", {above("B", "C")}, "C");
  ParameterConstraint limited = above("B", "A");
  limited.lower = 1;
  refused("A + B s", {limited}, "needs a lower limit");
  ParameterConstraint held = above("B", "A");
  held.fixed = 1;
  refused("A + B s", {{"A", 2, {}, {}, {}}, held}, "is fixed below");
  refused("A + B s",
          {{"A", {}, 3, {}, {}},
           [] {
             ParameterConstraint each = above("B", "A");
             each.upper = 2;
             return each;
           }()},
          "no value");
}

}  // namespace
