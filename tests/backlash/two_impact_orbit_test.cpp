// SPDX-License-Identifier: BSD-3-Clause
#include "steady_state/two_impact_orbit.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "steady_state/closed_orbit.hpp"
#include "steady_state/symmetric_orbits.hpp"
#include "support/honest_scenes.hpp"
#include "support/random.hpp"

namespace {

using backlash::detail::asymmetric_two_impact_orbit;
using backlash::detail::ClosedOrbit;
using backlash::detail::GapMotion;
using backlash::detail::symmetric_two_impact_orbit;
using backlash::detail::TwoImpactEnd;
using backlash::detail::TwoImpactOrbit;

constexpr double pi = std::numbers::pi;

double phase(const TwoImpactOrbit& orbit) {
  return static_cast<double>(orbit.start.half_period) * pi - pi / 2 + orbit.start.s;
}

// Tables of an independent derivation, printed to 10 and 8 digits.
TEST(TwoImpactOrbit, BranchEndsAgreeWithTheTables) {
  const double rows[][3] = {{0.2, 0.1953415268, 0.4933797345},
                            {0.4, 0.1316079872, 0.4107553974},
                            {0.6, 0.0785883627, 0.3660699362},
                            {0.8, 0.0352796142, 0.3458892783}};
  for (const auto& [restitution, node, breaking] : rows) {
    EXPECT_NEAR(backlash::detail::saddle_node_gamma(restitution), node, 5.1e-11);
    EXPECT_NEAR(backlash::detail::symmetry_breaking_gamma(restitution), breaking, 5.1e-11);
  }
}

TEST(TwoImpactOrbit, SymmetricOrbitAgreesWithTheTable) {
  const double rows[][5] = {{0.2, .67192634, -2.03113570, -.07195918, -.45987885},
                            {0.4, .65975920, -2.42109438, .14188509, -.38795295},
                            {0.6, .61558954, -2.71870764, .27179811, -.25733052},
                            {0.8, .56212573, -2.95310328, .33273974, -.12069751}};
  for (const auto& [restitution, speed, phi, real, imaginary] : rows) {
    const TwoImpactOrbit orbit = symmetric_two_impact_orbit(0.3, restitution).value();
    EXPECT_NEAR(orbit.speed, speed, 5.1e-9);
    EXPECT_NEAR(phase(orbit), phi, 5.1e-9);
    const auto u = backlash::detail::two_impact_harmonics(orbit, restitution).u;
    EXPECT_NEAR(u[0].real(), real, 5.1e-9);
    EXPECT_NEAR(u[0].imag(), imaginary, 5.1e-9);
    // Energy balance: what the impacts lose, 2 (1 - e^2) v^2/2, the force supplies, -pi gamma Im U.
    EXPECT_NEAR(u[0].imag(), -(1 - restitution * restitution) * orbit.speed * orbit.speed / (pi * 0.3), 1e-15);
  }
}

TEST(TwoImpactOrbit, SymmetricOrbitExistsFromTheSaddleNodeOn) {
  for (const double restitution : {0.0, 0.3, 0.7, 0.99}) {
    const double node = backlash::detail::saddle_node_gamma(restitution);
    EXPECT_FALSE(symmetric_two_impact_orbit(node * (1 - 1e-12), restitution));
    const TwoImpactOrbit orbit = symmetric_two_impact_orbit(node * (1 + 1e-12), restitution).value();
    // At a saddle-node an eigenvalue of the period map is 1; near it the distance goes with the square root of that in
    // gamma.
    const auto stability = backlash::detail::two_impact_stability(orbit, restitution);
    ASSERT_TRUE(stability.admissible);
    EXPECT_NEAR(1 - stability.trace + stability.determinant, 0, 1e-4);
    EXPECT_TRUE(stability.stable());
  }
}

TEST(TwoImpactOrbit, TraceAndDeterminantOfTheHalfPeriodMapAreTheClosedOnes) {
  for (const double restitution : {0.1, 0.5, 0.9, 1.0}) {
    for (const double gamma : {0.28, 0.3, 0.33}) {
      const TwoImpactOrbit orbit = symmetric_two_impact_orbit(gamma, restitution).value();
      const auto stability = backlash::detail::two_impact_stability(orbit, restitution);
      ASSERT_TRUE(stability.admissible);
      // One half period has determinant e^2 and this trace T; two have T^2 - 2 e^2 and e^4.
      const double trace = 2 * restitution + (1 + restitution) * pi * gamma * std::cos(phase(orbit)) / orbit.speed;
      EXPECT_NEAR(stability.trace, trace * trace - 2 * restitution * restitution, 1e-13);
      EXPECT_EQ(stability.determinant, std::pow(restitution, 4));
    }
  }
}

TEST(TwoImpactOrbit, AsymmetricFamilyClosesUnderTheMotion) {
  for (const double restitution : {0.15, 0.4, 0.6, 0.8, 0.95}) {
    const double end = backlash::detail::two_impact_loss(restitution).gamma;
    const double begin = backlash::detail::symmetry_breaking_gamma(restitution);
    for (const double share : {0.1, 0.5, 0.99}) {
      const double gamma = begin + share * (end - begin);
      const TwoImpactOrbit orbit = backlash::detail::stable_two_impact_orbit(gamma, restitution).value();
      EXPECT_FALSE(orbit.symmetric());
      EXPECT_NEAR(orbit.gamma, gamma, 1e-14);
      // The simulation returns to it: error of two impacts, each a few roundings.
      const std::optional<ClosedOrbit> closed =
          backlash::detail::close_orbit(GapMotion(gamma, restitution), orbit.start, 2, 2, 1e-10);
      ASSERT_TRUE(closed);
      const double radius = 1 - std::abs(closed->jacobian.trace()) + std::pow(restitution, 4);
      EXPECT_NEAR(closed->start.s, orbit.start.s, 1e-13 / std::max(1e-3, std::abs(radius)));
      EXPECT_NEAR(closed->start.velocity, orbit.start.velocity, 1e-13 / std::max(1e-3, std::abs(radius)));
    }
  }
}

// Grazing ends are tabled to all digits.  The two period doublings are tabled to 5e-6 only; the sharper values come
// from a Newton iteration with numerical derivatives on the two-impact map, written apart from this library.
TEST(TwoImpactOrbit, StableOrbitEndsWhereTabled) {
  const auto loss = [](double restitution) { return backlash::detail::two_impact_loss(restitution); };
  EXPECT_NEAR(loss(0.2).gamma, .523269, 5.1e-7);
  EXPECT_EQ(loss(0.2).end, TwoImpactEnd::grazing);
  EXPECT_NEAR(loss(0.4).gamma, .533023, 5.1e-7);
  EXPECT_EQ(loss(0.4).end, TwoImpactEnd::grazing);
  EXPECT_NEAR(loss(0.6).gamma, .504250, 6e-6);
  EXPECT_NEAR(loss(0.6).gamma, .5042444674, 1e-9);
  EXPECT_EQ(loss(0.6).end, TwoImpactEnd::period_doubling);
  EXPECT_NEAR(loss(0.8).gamma, .462760, 6e-6);
  EXPECT_NEAR(loss(0.8).gamma, .4627560031, 1e-9);
  EXPECT_EQ(loss(0.8).end, TwoImpactEnd::period_doubling);
}

TEST(TwoImpactOrbit, AnExtraImpactEndsTheSymmetricOrbitOnlyAtSmallRestitution) {
  for (const double restitution : {1e-6, 0.02, 0.05, 0.086}) {
    const auto loss = backlash::detail::symmetry_loss(restitution);
    EXPECT_TRUE(loss.grazing) << restitution;
    EXPECT_LT(loss.gamma, backlash::detail::symmetry_breaking_gamma(restitution));
  }
  for (const double restitution : {0.0875, 0.1, 0.5, 1.0}) {
    EXPECT_FALSE(backlash::detail::symmetry_loss(restitution).grazing) << restitution;
  }
  // As restitution -> 0 it ends where a sticking mass would first not leave at once, gamma = 1/pi; the distance goes
  // with the square root of the restitution.
  EXPECT_NEAR(backlash::detail::symmetry_loss(1e-8).gamma, 1 / pi, 1e-4);
}

TEST(TwoImpactOrbit, SmallDisturbancesDieOutInsideTheStableRangeAndGrowOutside) {
  const double restitution = 0.6;
  const auto growth = [&](double gamma, const TwoImpactOrbit& orbit) {
    const GapMotion motion(gamma, restitution);
    backlash::detail::GapState state = orbit.start;
    state.velocity += 1e-7;
    for (int i = 0; i < 100; ++i) {
      const backlash::detail::Flight flight = motion.next_flight(state);
      state = motion.after_impact(state, flight);
    }
    return std::abs(state.velocity - orbit.start.velocity) + std::abs(state.s - orbit.start.s);
  };
  const double breaking = backlash::detail::symmetry_breaking_gamma(restitution);
  const double below = breaking * 0.97;
  const double above = breaking * 1.03;
  EXPECT_LT(growth(below, symmetric_two_impact_orbit(below, restitution).value()), 1e-8);
  EXPECT_GT(growth(above, symmetric_two_impact_orbit(above, restitution).value()), 1e-6);
  const TwoImpactOrbit asymmetric = backlash::detail::stable_two_impact_orbit(above, restitution).value();
  EXPECT_LT(growth(above, asymmetric), 1e-8);
}

// The closed form of a whole sweep against the orbit followed impact by impact.
TEST(SymmetricOrbits, AgreeWithTheOrbitFollowedByEvents) {
  support::Random random(7);
  for (int scene = 0; scene < 60; ++scene) {
    const double restitution = scene < 3 ? 0.04 * scene : random.unit();
    const backlash::detail::SymmetricOrbits orbits(restitution);
    const double node = backlash::detail::saddle_node_gamma(restitution);
    for (int i = 0; i < 30; ++i) {
      const double gamma = random.uniform(0.5 * node, 0.6);
      SCOPED_TRACE(testing::Message() << "restitution " << restitution << ", gamma " << gamma);
      const auto followed = backlash::detail::stable_two_impact_orbit(gamma, restitution);
      ASSERT_EQ(orbits.contains(gamma), followed && followed->symmetric());
      if (!orbits.contains(gamma)) continue;
      const auto closed = orbits.at(gamma);
      const auto expected = backlash::detail::two_impact_steady_state(*followed, restitution);
      // Both are a few dozen roundings; the phase of the orbit is lost like the square root of rounding at the
      // saddle-node, which random numbers keep away from by 1e-4.
      for (std::size_t k = 0; k < closed.harmonics.u.size(); ++k) {
        ASSERT_LT(std::abs(closed.harmonics.u[k] - expected.harmonics.u[k]), 1e-13);
      }
      ASSERT_LT(std::abs(closed.harmonics.u1_plus_gamma - expected.harmonics.u1_plus_gamma), 1e-13);
      // The trace of the impact map followed has the rounding of its flights over the speeds.
      ASSERT_NEAR(closed.spectral_radius, expected.spectral_radius, 1e-6);
      ASSERT_LT(closed.energy_defect, 1e-13);
      const auto end = orbits.end_state(gamma);
      ASSERT_NEAR(end.position(), expected.end.position(), 1e-13);
      ASSERT_NEAR(end.position_rate(), expected.end.position_rate(), 1e-13);
    }
  }
}

TEST(SymmetricOrbits, RangeEndsAtTheSaddleNodeAndAtThePitchforkOrGrazing) {
  for (const double restitution : {0.0, 0.05, 0.2, 0.6, 0.9}) {
    const backlash::detail::SymmetricOrbits orbits(restitution);
    const double node = backlash::detail::saddle_node_gamma(restitution);
    const double end = backlash::detail::symmetry_loss(restitution).gamma;
    EXPECT_TRUE(orbits.contains(node * (1 + 1e-12)) && !orbits.contains(node * (1 - 1e-12)));
    EXPECT_TRUE(orbits.contains(end * (1 - 1e-12)) && !orbits.contains(end * (1 + 1e-12)));
    // At the saddle-node and at the pitchfork a multiplier is 1 (of the period; the map of half a period has +-1).
    EXPECT_NEAR(orbits.at(node * (1 + 1e-14)).spectral_radius, 1, 1e-6);
    if (!backlash::detail::symmetry_loss(restitution).grazing) {
      EXPECT_NEAR(orbits.at(end).spectral_radius, 1, 1e-9);
    }
  }
  // Without restitution an extra impact ends it at gamma = 1/pi.
  EXPECT_NEAR(backlash::detail::symmetry_loss(0).gamma, 1 / std::numbers::pi, 1e-15);
}

TEST(TwoImpactOrbit, UncertaintyHoldsNearTheSaddleNode) {
  const support::Tally tally = support::saddle_nodes(2000, 19);
  EXPECT_GT(tally.scenes, 1500);
  EXPECT_EQ(tally.missed, 0);
}

}  // namespace
