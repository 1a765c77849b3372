// SPDX-License-Identifier: BSD-3-Clause
#include "backlash/regime_map.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <vector>

#include "steady_state/steady_state.hpp"
#include "support/expect_invalid_argument.hpp"
#include "support/random.hpp"
#include "support/relative_error.hpp"

namespace {

using backlash::map_options;
using backlash::Protocol;
using backlash::Regime;
using backlash::regime_map;
using backlash::RegimeMap;
using backlash::SweepOptions;
using backlash::detail::find_steady_state;
using backlash::detail::GapMotion;
using backlash::detail::MeanGoal;
using backlash::detail::state_at_peak;
using backlash::detail::SteadyState;
using backlash::detail::Transients;
using support::expect_invalid_argument;
using support::log_grid;

TEST(RegimeMap, RowsAreSweeps) {
  const std::vector<double> restitution = {0, 0.3, 0.6, 1};
  const std::vector<double> omega = log_grid(3, 40, 25);
  SweepOptions options = map_options();
  options.protocol = Protocol::sweep_down;
  frac::Progress progress;
  const RegimeMap map = regime_map({2, 1.5, 0.3, 40}, restitution, omega, options, &progress);
  EXPECT_EQ(progress.done, 100u);
  EXPECT_EQ(progress.total, 100u);
  ASSERT_EQ(map.points.size(), 100u);
  for (std::size_t i = 0; i < restitution.size(); ++i) {
    const auto sweep = describing_function_sweep({2, 1.5, 0.3, restitution[i]}, 40, omega, options);
    for (std::size_t j = 0; j < omega.size(); ++j) {
      EXPECT_EQ(map.at(i, j).omega, omega[j]);
      EXPECT_EQ(map.at(i, j).value, sweep.points[j].value);
      EXPECT_EQ(map.at(i, j).regime, sweep.points[j].regime);
    }
  }
}

TEST(RegimeMap, IsTheSameOnAnyNumberOfThreads) {
  const std::vector<double> restitution = {0.1, 0.5, 0.7, 0.9, 0.99};
  const std::vector<double> omega = log_grid(0.5, 4, 20);
  SweepOptions options = map_options();
  options.threads = 1;
  const RegimeMap one = regime_map({}, restitution, omega, options);
  options.threads = 3;
  const RegimeMap three = regime_map({}, restitution, omega, options);
  for (std::size_t i = 0; i < one.points.size(); ++i) EXPECT_EQ(one.points[i].value, three.points[i].value);
}

// Means that end early change nothing for a closed orbit: in the band of the symmetric orbit each point is the closed
// form v, Im N1 = (1 - e^2) v^2/(pi gamma^2 (M1 + M2) w^2), v the larger root of the quadratic of the two flights.
TEST(RegimeMap, GivesTheClosedFormInTheBandOfTheSymmetricOrbit) {
  const std::vector<double> restitution = {0.5, 0.7, 0.9};
  const std::vector<double> omega = log_grid(1.8, 2.1, 10);
  SweepOptions options = map_options();
  options.protocol = Protocol::two_impact;
  const RegimeMap map = regime_map({}, restitution, omega, options);
  constexpr double pi = std::numbers::pi;
  for (std::size_t i = 0; i < restitution.size(); ++i) {
    for (std::size_t j = 0; j < omega.size(); ++j) {
      const double e = restitution[i];
      const double gamma = 1 / (omega[j] * omega[j]);
      const double a = std::pow(1 - e, 2) + std::pow(pi * (1 + e) / 2, 2);
      const double b = pi * (1 + e);
      const double v = (b + std::sqrt(b * b - 4 * a * (1 - 4 * gamma * gamma))) / (2 * a);
      const double expected = (1 - e * e) * v * v / (pi * gamma * gamma * 2 * omega[j] * omega[j]);
      EXPECT_EQ(map.at(i, j).regime, Regime::symmetric);
      // A dozen roundings, the difference under the root at worst three digits.
      EXPECT_NEAR(map.at(i, j).value.imag() / expected, 1, 1e-13);
    }
  }
}

// 200 starts each; the mean of a hundred full windows stands for the true one, good to a fifth of the half width of a
// mean that ended at 1 %.  On another processor rounding makes other motions of the same starts, so the limits leave
// five standard deviations to the scatter of the counts: of 1000 intervals of 95 % that is 0.7 %, of 200 1.6 % (and 1.5
// % are left to the differences between scenes). Nor may intervals hold because they are wide: errors of a 95 %
// interval have an rms of 1/1.96 of its half width along a line and more in the plane.  The wider of two estimates and
// the drift that is added may double the width, no more; an rms of 200 scatters by 5 %.
constexpr MeanGoal usual_window{0, 0, Transients::ignored};

TEST(RegimeMap, IntervalsOfMeansThatEndEarlyHoldTheirShareOfRepeats) {
  const int starts = 200;
  int held = 0;
  int all = 0;
  const std::vector<std::pair<double, double>> scenes = {{0.4, 1.0}, {0.6, 1.1}, {0.8, 0.9}, {0.9, 1.0}, {0.9, 5.0}};
  for (const auto& [restitution, gamma] : scenes) {
    SCOPED_TRACE(testing::Message() << "restitution " << restitution << ", gamma " << gamma);
    const GapMotion motion(gamma, restitution);
    support::Random random(29);
    const auto start = [&] { return state_at_peak(random.unit(), random.uniform(-0.5, 0.5)); };
    std::complex<double> mean = 0;
    const int full = 100;
    for (int i = 0; i < full; ++i) {
      const SteadyState steady = find_steady_state(motion, start(), 1e-10, usual_window);
      ASSERT_EQ(steady.regime, Regime::averaged);
      mean += steady.harmonics.u[0] / static_cast<double>(full);
    }
    const MeanGoal goal{0.01, -gamma};
    int held_here = 0;
    double squared_error = 0;
    double squared_width = 0;
    for (int i = 0; i < starts; ++i) {
      const SteadyState steady = find_steady_state(motion, start(), 1e-10, goal);
      ASSERT_EQ(steady.regime, Regime::averaged);
      // Met, or the whole window followed.
      EXPECT_LT(steady.uncertainty, 0.05 * std::abs(mean + gamma));
      const double error = std::abs(steady.harmonics.u[0] - mean);
      held_here += error <= steady.uncertainty ? 1 : 0;
      squared_error += error * error;
      squared_width += steady.uncertainty * steady.uncertainty;
    }
    EXPECT_GE(held_here, 0.855 * starts);
    EXPECT_GT(std::sqrt(squared_error / squared_width), 0.25);
    held += held_here;
    all += starts;
  }
  EXPECT_GE(held, 0.915 * all);
}

// What a mean that ends early may not do: pass a slow transient for chaos.  Every orbit that the full window closes
// must be one still.
TEST(RegimeMap, EndingEarlyKeepsTheRegimes) {
  support::Random random(31);
  int orbits = 0;
  int averaged = 0;
  for (int i = 0; i < 1000; ++i) {
    const double gamma = random.log_uniform(0.1, 30);
    const double restitution = random.uniform(0.2, 0.999);
    const GapMotion motion(gamma, restitution);
    const auto start = state_at_peak(random.unit(), random.uniform(-0.5, 0.5));
    const SteadyState full = find_steady_state(motion, start, 1e-10, usual_window);
    const SteadyState quick = find_steady_state(motion, start, 1e-10, {0.01, -gamma});
    (full.regime == Regime::averaged ? averaged : orbits) += 1;
    if (full.regime == Regime::averaged) continue;
    // Transient chaos, which settles on an orbit after a long while, is the one exception.
    if (quick.regime == Regime::averaged) {
      EXPECT_GT(quick.lyapunov, 0.05) << gamma << ' ' << restitution;
    } else {
      EXPECT_EQ(quick.harmonics.u[0], full.harmonics.u[0]);
    }
  }
  EXPECT_GT(orbits, 300);
  EXPECT_GT(averaged, 100);
}

TEST(RegimeMap, NamesWhatIsOutOfRange) {
  const auto call = [](const std::vector<double>& restitution, const std::vector<double>& omega, double goal = 0.01) {
    return [=] {
      SweepOptions options = map_options();
      options.mean_tolerance = goal;
      (void)regime_map({}, restitution, omega, options);
    };
  };
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  expect_invalid_argument(call({}, {1}), {"restitution is empty"});
  expect_invalid_argument(call({0.1, 1.1}, {1}), {"restitution[1] is 1.1", "[0, 1]"});
  expect_invalid_argument(call({nan}, {1}), {"restitution[0] is nan"});
  expect_invalid_argument(call({0.2, 0.2}, {1}), {"restitution[1] is 0.2", "restitution[0]", "increase"});
  expect_invalid_argument(call({0.2}, {}), {"omega is empty"});
  for (const double bad : {-0.1, 1.0, nan})
    expect_invalid_argument(call({0.2}, {1}, bad), {"mean_tolerance", "[0, 1)"});
}

}  // namespace
