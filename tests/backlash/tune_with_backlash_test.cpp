// SPDX-License-Identifier: BSD-3-Clause
#include "backlash/design/tune_with_backlash.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <stdexcept>
#include <vector>

#include "support/compliant_integration.hpp"
#include "support/simulated_swing.hpp"

namespace {

using support::demands;
using support::drawn_plant;
using support::shown_swing;
using support::TunedPlant;
using support::viscous;

constexpr double pi = std::numbers::pi;

// For kp + kd s of free masses all is known: the demands fix kp = M wc^2 cos(margin) and kd = M wc sin(margin), the
// cycle has omega = (pi/2) kd (1 + eps)/(M (1 - eps)), and the load moves on a triangular wave.
TEST(TuneWithBacklash, MeetsTheClosedFormOfThePdLaw) {
  const double mass1 = 1.2, mass2 = 0.7, clearance = 0.02, restitution = 0.4, crossover = 3;
  frac::TuningOptions options;
  options.structure = frac::ControllerStructure::pd;
  options.mu = {1, 1};
  const auto asked = demands(crossover, 50);
  const auto result =
      backlash::tune_with_backlash({backlash::TwoMassSystem(mass1, mass2, clearance, restitution)}, asked, options);
  ASSERT_TRUE(result.usable()) << result.message;
  const double mass = mass1 + mass2, kp = mass * crossover * crossover * std::cos(*asked.phase_margin),
               kd = mass * crossover * std::sin(*asked.phase_margin);
  EXPECT_NEAR(result.linear.gains.kp, kp, 1e-9 * kp);
  EXPECT_NEAR(result.linear.gains.kd, kd, 1e-9 * kd);
  const double omega = pi / 2 * kd * (1 + restitution) / (mass * (1 - restitution));
  ASSERT_EQ(result.persistent.cycles.size(), 1U);
  EXPECT_NEAR(result.persistent.cycles[0].omega, omega, 1e-9 * omega);
  const double sum = -(1 / mass1 + 1 / mass2) * pi * pi / (8 * omega * omega) +
                     kp * std::pow(omega, -4) * std::pow(pi, 4) / 96 / (mass1 * mass2);
  const double impulse = -(clearance / 2) * pi / (2 * omega * sum);
  // From peak to peak half a period at the speed impulse/(2 M1).
  const double swing = impulse / (2 * mass1) * pi / omega / 2;
  EXPECT_NEAR(result.persistent.swing, swing, 1e-9 * swing);
  EXPECT_EQ(result.persistent.omega, result.persistent.cycles[0].omega);
  EXPECT_TRUE(result.persistent.verified) << result.message;
  EXPECT_NE(result.message.find("mu held"), std::string::npos) << result.message;
}

// A cycle of kp + kd s with plastic impacts: half a period is a flight and a rest in contact.  The load flies straight
// from x with kp x = -kd v, where the contact has ceased to press, and the drive by a cubic, until the gap has been
// crossed; the common speed decays as the rigid loop does, until the contact ceases to press again.
struct PlasticCycle {
  double half_period;
  double end_speed;  // -v where the motion is symmetric
  double swing;
};
PlasticCycle plastic_cycle(double mass1, double mass2, double clearance, double kp, double kd, double v) {
  const double mass = mass1 + mass2;
  const double flight = std::cbrt(6 * mass2 * clearance / (kp * v));
  const double landed = -kd * v / kp + v * flight;
  const double speed = v * (1 - kp * flight * flight / (2 * mass));
  const double rate = -kd / (2 * mass), omega = std::sqrt(kp / mass - rate * rate);
  // x = e^(rate t)(c cos(omega t) + s sin(omega t)) and its derivatives.
  struct Wave {
    double c, s;
  };
  const auto derivative = [&](Wave wave) {
    return Wave{rate * wave.c + omega * wave.s, rate * wave.s - omega * wave.c};
  };
  const Wave position{landed, (speed - rate * landed) / omega};
  const Wave rated = derivative(position), bend = derivative(rated);
  double turned = std::atan2(-bend.c, bend.s);
  if (turned < 0) turned += pi;
  const double rest = turned / omega;
  const auto at = [&](Wave wave) {
    return std::exp(rate * rest) * (wave.c * std::cos(turned) + wave.s * std::sin(turned));
  };
  return {flight + rest, at(rated), landed};
}

TEST(TuneWithBacklash, TellsACycleThatRestsInContact) {
  const double mass1 = 1.3, mass2 = 0.8, clearance = 0.5, crossover = 2;
  frac::TuningOptions options;
  options.structure = frac::ControllerStructure::pd;
  options.mu = {1, 1};
  const auto result = backlash::tune_with_backlash({backlash::TwoMassSystem(mass1, mass2, clearance, 0)},
                                                   demands(crossover, 42), options);
  ASSERT_TRUE(result.usable()) << result.message;
  const frac::FractionalPidGains& gains = result.linear.gains;
  const auto cycle_at = [&](double v) { return plastic_cycle(mass1, mass2, clearance, gains.kp, gains.kd, v); };
  double slow = 0.2 * crossover * clearance, fast = 2 * crossover * clearance;
  ASSERT_LT(cycle_at(slow).end_speed + slow, 0);
  ASSERT_GT(cycle_at(fast).end_speed + fast, 0);
  for (int i = 0; i < 60; ++i) {
    const double middle = (slow + fast) / 2;
    (cycle_at(middle).end_speed + middle < 0 ? slow : fast) = middle;
  }
  const PlasticCycle truth = cycle_at(slow);
  ASSERT_EQ(result.persistent.further.size(), 1U);
  EXPECT_EQ(result.persistent.further[0].rests.size(), 2U);
  EXPECT_NEAR(result.persistent.omega, pi / truth.half_period, 1e-9 * result.persistent.omega);
  // The load turns at the impact, a corner.  The force of the contact jumps there, so that harmonics fall as k^-3
  // beside what the corner has: those above 200 add up to 1/(2 200^2) of the first at most.
  EXPECT_NEAR(result.persistent.swing, truth.swing, 2e-5 * truth.swing);
  EXPECT_TRUE(result.persistent.verified) << result.message;
}

// A receptance with a numerator, which no simulation in steps follows: motions from impact to impact verify the cycle.
TEST(TuneWithBacklash, VerifiesAnyReceptanceFromImpactToImpact) {
  const backlash::LinearBodies bodies(frac::FractionalTransferFunction::parse("(s + 3)/(s^3 + 3 s^2 + 0.2 s)"),
                                      backlash::free_mass(1), 0.1, 0.5);
  frac::TuningOptions options;
  options.structure = frac::ControllerStructure::pd;
  options.mu = {1, 1};
  const auto result = backlash::tune_with_backlash({bodies}, demands(2, 45), options);
  ASSERT_TRUE(result.usable()) << result.message;
  ASSERT_FALSE(result.persistent.cycles.empty());
  EXPECT_TRUE(result.persistent.verified) << result.message;
  const auto& simulated = result.persistent.simulations.back();
  EXPECT_NEAR(simulated.swing, result.persistent.swing, 0.01 * result.persistent.swing);
}

// What is said to persist is what two other simulations show: of free masses the exact one with the whole memory, of
// bodies with friction one with exact flights and direct sums.  A swing that is told by steps of the library's own
// simulation may be off by their share of a period, 1 % to 2 %, and so may the other's; a motion that has not quite
// come to rest on its cycle adds as much: 6 % together.  The benchmark tune_with_backlash_rates has more plants.
TEST(TuneWithBacklash, WhatPersistsIsWhatOtherSimulationsShow) {
  int without = 0, smaller = 0;
  for (unsigned seed = 0; seed < 6; ++seed) {
    const TunedPlant drawn = drawn_plant(seed);
    const auto result = backlash::tune_with_backlash(drawn.plant, drawn.asked, drawn.options);
    ASSERT_TRUE(result.usable()) << seed << ": " << result.message;
    EXPECT_NEAR(result.linear.crossover, *drawn.asked.crossover, 1e-6 * *drawn.asked.crossover);
    EXPECT_NEAR(result.linear.phase_margin, *drawn.asked.phase_margin, 1e-4 * pi / 180);
    const double swing = result.persistent.swing;
    EXPECT_LE(swing, result.of_regardless.swing);
    without += swing == 0;
    smaller += swing < 0.98 * result.of_regardless.swing;
    const double shown = shown_swing(drawn, result);
    if (swing == 0) {
      EXPECT_LT(shown, 0.03 * drawn.plant.bodies.system().clearance()) << seed << ": " << result.message;
    } else {
      EXPECT_NEAR(shown, swing, 0.06 * swing) << seed << ": " << result.message;
    }
  }
  EXPECT_GE(without, 1);
  EXPECT_GE(smaller, 2);
}

// A clearance that matters is named as the constraint that it is, and one that does not is not.
TEST(TuneWithBacklash, SaysWhichConstraintsAreActive) {
  const auto constraint = [](const backlash::BacklashTuning& result, const std::string& name) {
    const auto found = std::find_if(result.constraints.begin(), result.constraints.end(),
                                    [&](const backlash::TuningConstraint& each) { return each.name == name; });
    EXPECT_NE(found, result.constraints.end()) << name;
    return found == result.constraints.end() ? backlash::TuningConstraint{} : *found;
  };
  auto asked = demands(2, 45);
  asked.max_sensitivity = 50;
  const auto held = backlash::tune_with_backlash({backlash::TwoMassSystem(1, 1, 0.01, 0.6)}, asked);
  ASSERT_TRUE(held.usable()) << held.message;
  EXPECT_TRUE(constraint(held, "no limit cycle").active);
  EXPECT_TRUE(constraint(held, "phase margin, deg").active);
  EXPECT_FALSE(constraint(held, "max |S|").active);
  EXPECT_GT(held.persistent.swing, 0);
  // Measured on the driven body, heavy friction on the load: nothing persists anyway.
  const auto free = backlash::tune_with_backlash({viscous(1, 3, 1, 1, 0.01, 0.3), backlash::Output::x2}, asked);
  ASSERT_TRUE(free.usable()) << free.message;
  EXPECT_EQ(free.persistent.swing, 0) << free.message;
  EXPECT_FALSE(constraint(free, "no limit cycle").active);
}

/// Half of peak to peak of the measured body in the last tenth of an integration in small steps.
double integrated_swing(const compliant_test::Machine& machine, double speed, double duration, double every) {
  compliant_test::Integration motion(machine, {0, 0, 0, speed});
  const bool is_drive = machine.control->follows_drive;
  double low = INFINITY, high = -INFINITY;
  for (double time = 0.9 * duration; time < duration; time += every) {
    motion.advance(time);
    const auto& state = motion.state();
    const auto at =
        static_cast<double>(state[is_drive ? compliant_test::Integration::x2 : compliant_test::Integration::x1]);
    low = std::min(low, at);
    high = std::max(high, at);
  }
  return (high - low) / 2;
}

TEST(TuneWithBacklash, OfContactsThatTakeTimeWhatPersistsIsWhatAnIntegrationShows) {
  struct Case {
    double friction1, friction2, frequency, restitution;
    backlash::Output measured;
  };
  int with = 0, without = 0;
  for (const Case& c : {Case{0, 0, 60, 0.5, backlash::Output::x1}, Case{0.001, 0, 40, 0.3, backlash::Output::x1},
                        Case{0.02, 0.01, 60, 0.5, backlash::Output::x2}}) {
    compliant_test::Machine machine;
    machine.clearance = 0.01;
    const auto contact = backlash::CompliantContact::from_frequency(
        c.frequency, backlash::damping_ratio_of_restitution(c.restitution), machine.mass1, machine.mass2);
    machine.stiffness = contact.stiffness();
    machine.damping = contact.damping();
    machine.coulomb1 = c.friction1;
    machine.coulomb2 = c.friction2;
    frac::TuningOptions options;
    options.structure = frac::ControllerStructure::pd;
    options.mu = {1, 1};
    const auto result =
        backlash::tune_with_backlash({machine.bodies().hard(), c.measured, machine.bodies()}, demands(2, 50), options);
    ASSERT_TRUE(result.usable()) << result.message;
    machine.control = {result.linear.gains.kp, 0, result.linear.gains.kd};
    machine.control->follows_drive = c.measured == backlash::Output::x2;
    double shown = 0;
    for (const double speed : {0.002, 0.2}) shown = std::max(shown, integrated_swing(machine, speed, 50, 0.004));
    const double swing = result.persistent.swing;
    (swing > 0 ? with : without) += 1;
    // Samples miss the peak of a motion of 10 rad/s by (0.04)^2/8 of it; transients of a hundred contacts leave less.
    if (swing > 0)
      EXPECT_NEAR(shown, swing, 1e-3 * swing) << result.message;
    else
      EXPECT_LT(shown, 0.01 * machine.clearance) << result.message;
  }
  EXPECT_GE(with, 1);
  EXPECT_GE(without, 1);
}

// As contacts get faster at one restitution the swing tends in first order of 1/wc to that of the closed form above.
TEST(TuneWithBacklash, OfContactsThatTakeTimeTendsToThatOfARestitution) {
  frac::TuningOptions options;
  options.structure = frac::ControllerStructure::pd;
  options.mu = {1, 1};
  const auto swing_at = [&](double frequency) {
    const auto contact =
        backlash::CompliantContact::from_frequency(frequency, backlash::damping_ratio_of_restitution(0.4), 1.2, 0.7);
    const backlash::CompliantBodies bodies(backlash::free_mass(1.2), backlash::free_mass(0.7), 0.02, contact);
    return backlash::tune_with_backlash({bodies.hard(), backlash::Output::x1, bodies}, demands(3, 50), options)
        .persistent.swing;
  };
  const double hard =
      backlash::tune_with_backlash({backlash::TwoMassSystem(1.2, 0.7, 0.02, 0.4)}, demands(3, 50), options)
          .persistent.swing;
  const double soft = std::abs(swing_at(300) - hard) / hard, stiff = std::abs(swing_at(600) - hard) / hard;
  EXPECT_GT(soft, 1e-4);
  EXPECT_NEAR(soft / stiff, 2, 10 * soft);
}

TEST(TuneWithBacklash, NeedsACrossover) {
  frac::LoopSpecification asked;
  asked.max_sensitivity = 2;
  EXPECT_THROW(static_cast<void>(backlash::tune_with_backlash({backlash::TwoMassSystem(1, 1, 1, 0.5)}, asked)),
               std::invalid_argument);
}

}  // namespace
