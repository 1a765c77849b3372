// SPDX-License-Identifier: BSD-3-Clause
#include "backlash/basins.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "backlash/orbit_continuation.hpp"
#include "support/expect_invalid_argument.hpp"
#include "support/relative_error.hpp"

namespace {

using backlash::BasinMap;
using backlash::basins;
using backlash::Regime;
using backlash::TwoMassSystem;
using support::linear_grid;

// Between the pitchfork (c = 1.653) and the loss of the two-impact orbit (1.408) lives an asymmetric one with its
// mirror twin, here beside one of three impacts and its twin.
TEST(Basins, MirrorTwinsAreTwoAttractorsOfOneDescribingFunction) {
  const TwoMassSystem system(1, 1, 1, 0.6);
  const BasinMap map = basins(system, 1, 1.41, linear_grid(0, 1, 15), linear_grid(-1, 1, 15));
  ASSERT_EQ(map.attractors.size(), 4u);
  ASSERT_EQ(map.attractor.size(), 225u);
  std::size_t starts = 0;
  int of_two = 0;
  for (const auto& attractor : map.attractors) {
    EXPECT_FALSE(attractor.symmetric);
    EXPECT_EQ(attractor.point.regime, Regime::periodic);
    of_two += attractor.point.impacts_per_period == 2 ? 1 : 0;
    starts += attractor.starts;
    int twins = 0;
    for (const auto& other : map.attractors) {
      if (std::abs(other.point.value - attractor.point.value) < 1e-12) ++twins;
    }
    EXPECT_EQ(twins, 2);  // itself and its mirror image
  }
  EXPECT_EQ(of_two, 2);
  EXPECT_EQ(starts, 225u);
}

// Every stable orbit of few impacts that continuation finds attracts some start of a fine grid, and no other is found.
TEST(Basins, AttractorsAreTheStableOrbitsOfTheContinuation) {
  for (const double omega : {1.41, 1.5, 1.8}) {
    const TwoMassSystem system(1, 1, 1, 0.6);
    const BasinMap map = basins(system, 1, omega, linear_grid(0, 1, 25), linear_grid(-1.5, 1.5, 25));
    const auto diagram = backlash::orbit_diagram(system, 1, omega * (1 - 1e-4), omega * (1 + 1e-4));
    for (const auto& attractor : map.attractors) {
      if (attractor.point.regime == Regime::free || attractor.point.regime == Regime::averaged) continue;
      bool known = false;
      for (const auto& branch : diagram.branches) {
        for (const auto& orbit : branch.orbits) {
          // N moves along a branch by its slope, below 10/omega here, times the half width of the interval.
          known = known || (orbit.stable && branch.period == attractor.point.period &&
                            std::abs(orbit.value - attractor.point.value) < 2e-3);
        }
      }
      EXPECT_TRUE(known) << omega << ": period " << attractor.point.period << ", impacts per period "
                         << attractor.point.impacts_per_period;
    }
  }
}

TEST(Basins, FreeMotionChatterAndMeansAreOneAttractorEach) {
  // At rest at the peak the mass swings between y and y + 2 F/(M2 omega^2) = y + 1/8 without drift.
  const BasinMap free = basins({1, 1, 1, 0.6}, 1, 4, linear_grid(0.01, 0.87, 7), {0});
  ASSERT_EQ(free.attractors.size(), 1u);
  EXPECT_EQ(free.attractors[0].point.regime, Regime::free);
  const BasinMap sticking = basins({1, 1, 1, 0.6}, 1, 0.1, linear_grid(0, 1, 7), linear_grid(-0.5, 0.5, 7));
  ASSERT_EQ(sticking.attractors.size(), 1u);
  EXPECT_EQ(sticking.attractors[0].point.regime, Regime::chatter);
  EXPECT_TRUE(sticking.attractors[0].symmetric);
}

// Of a scene whose chaos lasts for some thousand periods and then ends on orbits, only these are attractors.
TEST(Basins, TransientChaosIsNoAttractor) {
  for (const auto& [restitution, omega] : {std::pair{0.85067, 0.9743}, {0.94158, 0.99444}}) {
    const auto map =
        basins({1, 1, 1, restitution}, 1, omega, support::linear_grid(0.05, 0.95, 6), support::linear_grid(-1, 1, 6));
    for (const auto& attractor : map.attractors) {
      EXPECT_NE(attractor.point.regime, Regime::averaged) << restitution;
      EXPECT_LT(attractor.point.lyapunov_exponent, 0) << restitution;
    }
  }
}

TEST(Basins, IsTheSameOnAnyNumberOfThreadsAndCountsProgress) {
  backlash::SweepOptions options;
  options.threads = 1;
  const BasinMap one = basins({1, 1, 1, 0.4}, 1, 1.38, linear_grid(0, 1, 9), linear_grid(-1, 1, 9), options);
  options.threads = 3;
  frac::Progress progress;
  const BasinMap three =
      basins({1, 1, 1, 0.4}, 1, 1.38, linear_grid(0, 1, 9), linear_grid(-1, 1, 9), options, &progress);
  EXPECT_EQ(one.attractor, three.attractor);
  EXPECT_EQ(progress.done, 81u);
  EXPECT_EQ(&three.at(8, 3), &three.attractors[three.attractor[8 * 9 + 3]]);
}

TEST(Basins, NamesWhatIsOutOfRange) {
  using support::expect_invalid_argument;
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  const TwoMassSystem system(1, 1, 0.3, 0.6);
  expect_invalid_argument([&] { (void)basins(system, 40, 20, {}, {0}); }, {"position is empty"});
  expect_invalid_argument([&] { (void)basins(system, 40, 20, {0.1}, {}); }, {"velocity is empty"});
  expect_invalid_argument([&] { (void)basins(system, 40, 20, {0.1, 0.4}, {0}); }, {"position[1] is 0.4", "0.3"});
  expect_invalid_argument([&] { (void)basins(system, 40, 20, {0.1}, {nan}); }, {"velocity[0] is nan"});
  expect_invalid_argument([&] { (void)basins({1, 1, 0, 0.6}, 40, 20, {0}, {0}); }, {"clearance"});
  expect_invalid_argument([&] { (void)basins(system, 40, 1e-20, {0}, {0}); }, {"F/(M2 clearance omega^2)"});
}

}  // namespace
