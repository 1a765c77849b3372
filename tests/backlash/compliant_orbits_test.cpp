// SPDX-License-Identifier: BSD-3-Clause
#include "backlash/compliant/compliant_orbits.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <optional>
#include <vector>

#include "backlash/compliant/compliant_history.hpp"
#include "backlash/compliant/compliant_jump.hpp"
#include "compliant/symmetric_compliant_orbit.hpp"
#include "steady_state/two_impact_orbit.hpp"
#include "support/compliant_integration.hpp"
#include "support/expect_invalid_argument.hpp"
#include "support/random.hpp"

namespace {

using backlash::Bifurcation;
using backlash::BifurcationPoint;
using backlash::BranchEnd;
using backlash::CompliantBodies;
using backlash::CompliantContact;
using backlash::OrbitBranch;
using backlash::OrbitDiagram;
using backlash::OrbitParameter;
using backlash::PeriodicOrbit;
using compliant_test::Integration;
using compliant_test::Machine;

constexpr double restitution = 0.6;

CompliantBodies free_bodies(double frequency, const backlash::CoulombFriction& friction = {}, double of = restitution) {
  return {backlash::free_mass(1), backlash::free_mass(1), 1,
          CompliantContact::from_frequency(frequency, backlash::damping_ratio_of_restitution(of), 1, 1), friction};
}

const OrbitBranch* two_contacts(const OrbitDiagram& diagram) {
  for (const OrbitBranch& branch : diagram.branches)
    if (branch.symmetric && branch.period == 1 && branch.impacts == 2) return &branch;
  return nullptr;
}

const PeriodicOrbit* at_event(const OrbitBranch& branch, Bifurcation kind) {
  for (const BifurcationPoint& point : branch.bifurcations)
    if (point.kind == kind) return &point.orbit;
  return nullptr;
}

// The closed form of the orbit of two contacts ends where its multiplier passes 1 or a wall presses once more, both by
// other equations in other unknowns; compliant_jump() finds its ends to 1e-13, events here are refined to 1e-9.
TEST(CompliantOrbits, OfTwoContactsEndWhereTheClosedFormDoes) {
  for (const double frequency : {8.0, 20.0, 60.0}) {
    const OrbitDiagram diagram = orbit_diagram(free_bodies(frequency), 1, 1, OrbitParameter::omega, 1.3, 3.7,
                                               {.longest_period = 1, .most_impacts = 4});
    const OrbitBranch* branch = two_contacts(diagram);
    ASSERT_NE(branch, nullptr);
    const double ratio = backlash::damping_ratio_of_restitution(restitution);
    const double lambda = frequency * frequency;
    const auto high = backlash::compliant_jump(lambda, ratio, backlash::JumpCriterion::saddle_node);
    const PeriodicOrbit* fold = at_event(*branch, Bifurcation::saddle_node);
    ASSERT_TRUE(fold && high.similarity_constant) << frequency;
    EXPECT_NEAR(fold->omega / *high.similarity_constant, 1, 1e-8);
    EXPECT_NEAR(std::abs(fold->multipliers[0] - 1.0), 0, 1e-3);
    // Stable or not, its multipliers and contacts are those of the closed form.
    int compared = 0;
    for (const PeriodicOrbit& orbit : branch->orbits) {
      const auto closed = backlash::detail::symmetric_compliant_orbit_from_hard(
          {1 / (orbit.omega * orbit.omega), frequency / orbit.omega, ratio});
      // Above the frequency of the pitchfork there may be a second one, which the fold leads to.
      if (!closed || std::abs(closed->speed * orbit.omega / orbit.impacts.front().speed - 1) > 1e-3) continue;
      ++compared;
      EXPECT_NEAR(closed->speed * orbit.omega / orbit.impacts.front().speed, 1, 1e-9);
      EXPECT_NEAR(closed->largest_multiplier / std::abs(orbit.multipliers[0]), 1, 1e-7);
    }
    EXPECT_GT(compared, 10);
    const auto low = backlash::compliant_jump(lambda, ratio, backlash::JumpCriterion::symmetry_loss);
    const PeriodicOrbit* breaking = at_event(*branch, Bifurcation::symmetry_breaking);
    ASSERT_TRUE(breaking && low.similarity_constant) << frequency;
    EXPECT_NEAR(breaking->omega / *low.similarity_constant, 1, 1e-8);
    EXPECT_NEAR(std::abs(breaking->multipliers[0] - 1.0), 0, 1e-6);
  }
}

// First order in 1/wc, whose term 2 f(2 wc) - f(wc) removes.
TEST(CompliantOrbits, EndsTendToThoseOfARestitutionInFirstOrder) {
  const double exact = 1 / std::sqrt(backlash::detail::saddle_node_gamma(restitution));
  std::vector<double> off;
  std::vector<double> extrapolated;
  for (const double frequency : {50.0, 100.0, 200.0, 400.0}) {
    const OrbitDiagram diagram = orbit_diagram(free_bodies(frequency), 1, 1, OrbitParameter::omega, 3, 3.7,
                                               {.longest_period = 1, .most_impacts = 2});
    const OrbitBranch* branch = two_contacts(diagram);
    ASSERT_NE(branch, nullptr);
    const PeriodicOrbit* fold = at_event(*branch, Bifurcation::saddle_node);
    ASSERT_NE(fold, nullptr);
    off.push_back(fold->omega - exact);
  }
  for (std::size_t i = 0; i + 1 < off.size(); ++i) {
    // The second order is of the size of the first one squared.
    EXPECT_NEAR(off[i] / off[i + 1], 2, 4 * std::abs(off[i]));
    extrapolated.push_back(2 * off[i + 1] - off[i]);
  }
  // With a third order of b times the second one the ratio is 4 (1 + b)/(1 + b/2), less than 4 + 2 b; b = 50/wc.
  for (std::size_t i = 0; i + 1 < extrapolated.size(); ++i)
    EXPECT_NEAR(extrapolated[i] / extrapolated[i + 1], 4, 2 / std::ldexp(1, static_cast<int>(i))) << i;
}

// Orbits of the diagram at the upper end of its range, one of which a motion in small steps must have come to.
double distance_from(const OrbitDiagram& diagram, std::complex<double> value) {
  double least = std::numeric_limits<double>::infinity();
  for (const OrbitBranch& branch : diagram.branches)
    for (const PeriodicOrbit& orbit : branch.orbits)
      if (std::abs(orbit.parameter / diagram.to - 1) < 1e-9 && orbit.stable)
        least = std::min(least, std::abs(orbit.value - value) / std::abs(value));
  return least;
}

// An integration in small steps, with and without dry friction, over each parameter, ends on an orbit of the diagram.
TEST(CompliantOrbits, StableOnesAreWhatAnIntegrationSettlesOn) {
  support::Random random(11);
  int compared = 0;
  for (int i = 0; i < 8; ++i) {
    Machine m;
    m.mass2 = random.uniform(0.5, 2);
    m.force = m.clearance = 1;
    m.omega = random.uniform(1.2, 2);
    const CompliantContact contact =
        CompliantContact::from_frequency(random.uniform(6, 20), random.uniform(0.1, 0.5), m.mass1, m.mass2);
    m.stiffness = contact.stiffness();
    m.damping = contact.damping();
    if (i % 2 != 0) m.coulomb1 = random.uniform(0.01, 0.2);
    if (i % 4 == 3) m.coulomb2 = random.uniform(0.01, 0.1);
    Integration motion(m, {0, 0, random.uniform(-0.4, 0.4), 0});
    const long double period = 2 * std::numbers::pi_v<long double> / m.omega;
    motion.advance(300 * period);
    static_cast<void>(motion.take_value(1));
    motion.advance(312 * period);
    const std::complex<double> value = motion.take_value(12);
    motion.advance(324 * period);
    // What has settled on up to 12 periods, and not on free flight.
    if (std::abs(motion.take_value(12) - value) > 1e-10 * std::abs(value) || std::abs(value) < 1e-3) continue;
    const double frequency = std::sqrt(contact.stiffness() * (1 / m.mass1 + 1 / m.mass2));
    const OrbitParameter parameter = backlash::orbit_parameters()[static_cast<std::size_t>(i % 3)];
    const bool is_frequency = i % 8 == 7;
    const double at = is_frequency ? frequency : parameter == OrbitParameter::omega ? m.omega : 1.0;
    const OrbitDiagram diagram =
        orbit_diagram(m.bodies(), m.force, m.omega, is_frequency ? OrbitParameter::contact_frequency : parameter,
                      0.97 * at, at, {.longest_period = 12, .most_impacts = 60});
    ++compared;
    EXPECT_LT(distance_from(diagram, value), 1e-9) << i;
  }
  EXPECT_GE(compared, 5);
}

// At a kink the orbit is the same from both sides. The wall that is just touched pushes with c d' at once, whatever its
// depth: multipliers jump, their product, e^(-c/m times the time of contact), does not.
TEST(CompliantOrbits, GoOnPastGrazings) {
  const OrbitDiagram diagram =
      orbit_diagram(free_bodies(12), 1, 1, OrbitParameter::omega, 1.1, 1.4, {.longest_period = 2, .most_impacts = 8});
  int kinks = 0;
  for (const OrbitBranch& one : diagram.branches) {
    for (const auto& [end, orbit] :
         {std::pair{one.begin, &one.orbits.front()}, std::pair{one.end, &one.orbits.back()}}) {
      if (end != BranchEnd::grazing) continue;
      for (const OrbitBranch& other : diagram.branches) {
        if (other.impacts <= one.impacts || other.period != one.period) continue;
        for (const auto& [begin, beyond] :
             {std::pair{other.begin, &other.orbits.front()}, std::pair{other.end, &other.orbits.back()}}) {
          if (begin != BranchEnd::grazing || std::abs(beyond->omega - orbit->omega) > 1e-6) continue;
          if (std::abs(beyond->value - orbit->value) > 1e-6 * std::abs(orbit->value)) continue;
          ++kinks;
          const auto product = [](const PeriodicOrbit& of) { return (of.multipliers[0] * of.multipliers[1]).real(); };
          // A contact as deep as the kink is wide, 1e-6 at most, lasts 1e-3.
          EXPECT_NEAR(product(*beyond) / product(*orbit), 1, 0.1);
          EXPECT_GT(std::abs(beyond->multipliers[0] - orbit->multipliers[0]), 0.1);
        }
      }
    }
  }
  EXPECT_GE(kinks, 2);
}

TEST(CompliantOrbits, RefuseWhatHasNoMeaning) {
  const CompliantBodies bodies = free_bodies(20);
  support::expect_invalid_argument(
      [&] { static_cast<void>(orbit_diagram(bodies, 1, 1.5, OrbitParameter::restitution, 0.1, 0.9)); },
      {"contact-frequency"});
  support::expect_invalid_argument(
      [&] {
        static_cast<void>(backlash::orbit_diagram({1, 1, 1, 0.6}, 1, 1.5, OrbitParameter::contact_frequency, 10, 20));
      },
      {"contact-frequency"});
  support::expect_invalid_argument(
      [&] { static_cast<void>(orbit_diagram(bodies, 1, 1.5, OrbitParameter::contact_frequency, 10, 1e8)); }, {"1e6"});
}

}  // namespace
