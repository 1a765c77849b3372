// SPDX-License-Identifier: BSD-3-Clause
#include "backlash/compliant/compliant_loop.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "support/compliant_integration.hpp"
#include "support/expect_invalid_argument.hpp"
#include "support/random.hpp"

namespace {

using backlash::CompliantContact;
using backlash::CompliantLoop;
using backlash::CompliantLoopHistory;
using backlash::LoopSimulationOptions;
using backlash::LoopStart;
using backlash::Output;
using compliant_test::Integration;
using compliant_test::Machine;

constexpr double unbounded = std::numeric_limits<double>::infinity();

CompliantLoop loop_of(const Machine& m) {
  const Machine::Control& c = *m.control;
  std::vector<frac::PowerTerm> top{{c.kp, 0}};
  if (c.kd != 0) top.insert(top.begin(), {c.kd, 1});
  std::vector<frac::PowerTerm> bottom{{1, 0}};
  if (c.ki != 0) {
    for (frac::PowerTerm& term : top) term.order += 1;
    top.push_back({c.ki, 0});
    bottom = {{1, 1}};
  }
  return {m.bodies(), frac::FractionalTransferFunction(top, bottom), c.follows_drive ? Output::x2 : Output::x1};
}

/// Loops whose rigid one is a damped oscillation of about 1 rad/s, with the load or the drive measured; every second
/// has an integral, every third a limit of the force, and the kinds of friction come in turn.
Machine random_loop(support::Random& random, std::size_t i) {
  Machine m;
  m.mass1 = random.log_uniform(0.4, 3);
  m.mass2 = random.log_uniform(0.4, 3);
  m.clearance = random.log_uniform(0.02, 0.5);
  const CompliantContact contact =
      CompliantContact::from_frequency(random.log_uniform(5, 80), random.log_uniform(0.03, 1.5), m.mass1, m.mass2);
  m.stiffness = contact.stiffness();
  m.damping = contact.damping();
  const double mass = m.mass1 + m.mass2;
  Machine::Control control;
  control.kp = mass * random.uniform(0.7, 1.5);
  control.kd = mass * random.uniform(0.2, 0.9);
  if (i % 2 == 1) control.ki = 0.1 * control.kd;
  control.follows_drive = i % 4 < 2;
  if (i % 3 == 0) control.limit = 0.5 * control.kp * m.clearance;
  // A derivative that meets a step kicks the drive, but where its force is limited; that is another test.
  if (i % 3 == 0) control.set_point.step = m.clearance * random.uniform(0.5, 3);
  if (i % 5 == 0) control.set_point.ramp = m.clearance * random.uniform(-0.3, 0.3);
  if (i % 3 != 0) {
    control.set_point.sine_amplitude = m.clearance * random.uniform(0.3, 2);
    control.set_point.sine_omega = random.uniform(0.3, 2);
  }
  m.control = control;
  if (i % 7 < 3) m.viscous1 = mass * random.uniform(0.02, 0.2);
  if (i % 7 == 1) m.spring1 = mass * random.uniform(0.02, 0.2);
  const double force = control.kp * m.clearance;
  if (i % 4 == 1 || i % 4 == 2) m.coulomb1 = force * random.uniform(0.02, 0.2);
  if (i % 4 >= 2) m.coulomb2 = force * random.uniform(0.02, 0.2);
  return m;
}

CompliantLoopHistory history_of(const Machine& m, const LoopStart& start) {
  LoopSimulationOptions options;
  options.duration = 12;
  options.sample_time = 0.25;
  options.rows_at_impacts = false;
  options.force_limit = m.control->limit;
  options.disturbance = m.control->disturbance;
  return simulate_loop(loop_of(m), start, m.control->set_point, options);
}

double largest_difference(const CompliantLoopHistory& one, const CompliantLoopHistory& other) {
  double largest = 0;
  for (std::size_t i = 0; i < one.rows.size(); ++i)
    largest =
        std::max({largest, std::abs(one.rows[i].x1 - other.rows[i].x1), std::abs(one.rows[i].x2 - other.rows[i].x2)});
  return largest;
}

/// The same with a position controller around a speed controller, and forces that disturb.
Machine random_cascade(support::Random& random, std::size_t i) {
  Machine m = random_loop(random, i);
  Machine::Control& control = *m.control;
  control.set_point.lag = 1 / random.uniform(0.5, 2);
  control.ki = i % 2 == 1 ? 0.1 * control.kd / control.set_point.lag : 0;
  control.kp = control.kd / control.set_point.lag + control.ki * control.set_point.lag;
  if (i % 3 != 1) control.disturbance.body1 = control.kp * m.clearance * random.uniform(-0.5, 0.5);
  if (i % 3 != 2) control.disturbance.body2 = control.kp * m.clearance * random.uniform(-0.5, 0.5);
  return m;
}

// The integration steps through the same equations, with events bisected and no matrix exponential; of a cascade it
// follows its two controllers.
void compare_with_an_integration(Machine (*machine)(support::Random&, std::size_t)) {
  support::Random random(36);
  std::size_t contacts = 0;
  for (std::size_t i = 0; i < 24; ++i) {
    const Machine m = machine(random, i);
    LoopStart start{0, 0.3 * m.clearance * random.uniform(-1, 1), 0.4 * m.clearance * random.uniform(-1, 1),
                    m.clearance * random.uniform(-2, 2)};
    // The integral of the speed is the position less where it began.
    if (m.control->set_point.lag > 0) start.x2 = 0;
    const CompliantLoopHistory history = history_of(m, start);
    ASSERT_EQ(history.end, backlash::LoopEnd::duration);
    ASSERT_EQ(history.rows.size(), 49U);
    contacts += history.contacts;
    Integration motion(m, start);
    double difference = 0;
    for (const auto& row : history.rows) {
      motion.advance(static_cast<compliant_test::Real>(row.time));
      const auto& z = motion.state();
      difference = std::max({difference, std::abs(row.x1 - static_cast<double>(z[Integration::x1])),
                             std::abs(row.x2 - static_cast<double>(z[Integration::x2]))});
    }
    constexpr double change = 1e-9;
    LoopStart beside = start;
    beside.x2 += change * m.clearance;
    const double growth = std::max(1.0, largest_difference(history, history_of(m, beside)) / (change * m.clearance));
    // Roundings of positions and of the contact's frequency, some hundred flights of each, and what the motion makes of
    // a rounding.
    EXPECT_LT(difference / m.clearance, 1e-11 + 1e-14 * growth) << "loop " << i;
  }
  EXPECT_GT(contacts, 100U);
}

TEST(CompliantLoop, MotionsAreThoseOfAnIntegration) {
  compare_with_an_integration(random_loop);
}

TEST(CompliantLoop, CascadesAndDisturbancesAreThoseOfAnIntegration) {
  compare_with_an_integration(random_cascade);
}

// At one damping ratio the motion tends to that of the restitution in first order of 1/wc: up to the second impact, as
// later ones are shifted.
TEST(CompliantLoop, TendsToTheLoopOfARestitution) {
  Machine m;
  m.control = Machine::Control{2, 0, 1};
  m.clearance = 1;
  std::vector<double> errors;
  for (const double frequency : {200.0, 400.0, 800.0, 1600.0}) {
    const CompliantContact contact = CompliantContact::from_frequency(frequency, 0.18, 1, 1);
    m.stiffness = contact.stiffness();
    m.damping = contact.damping();
    const CompliantLoop loop = loop_of(m);
    const LoopStart start{0, 0, 0, 1};
    LoopSimulationOptions options;
    options.duration = 10;
    options.sample_time = 10;
    options.rows_at_impacts = false;
    const auto soft = simulate_loop(loop, start, {}, options);
    const auto hard = backlash::simulate_loop(loop.hard(), start, {}, options);
    EXPECT_GE(soft.contacts, 3U);
    errors.push_back(soft.rows.back().x1 - hard.rows.back().x1);
  }
  // The rest is of second order, which halves with each doubling.
  for (std::size_t i = 1; i < errors.size(); ++i)
    EXPECT_NEAR(errors[i - 1] / errors[i], 2, 0.4 / std::exp2(static_cast<double>(i))) << i;
}

// A proportional controller on the drive alone against dry friction, without contact: each half swing of an oscillation
// about +-Fc/kp loses 2 Fc/kp, until the turn lies within it.
TEST(CompliantLoop, SticksWhereDryFrictionHoldsIt) {
  Machine m;
  m.clearance = 10;
  m.coulomb2 = 0.3;
  m.control = Machine::Control{4, 0, 0};
  m.control->follows_drive = true;
  m.control->set_point.step = 1;
  const double reach = m.coulomb2 / m.control->kp;
  const auto history = history_of(m, {});
  // From 0 with the set-point at 1 it turns at 2 - 2 reach, 4 reach, 2 - 6 reach, ...; half swings take pi/2.
  double turn = 1;
  int swings = 0;
  for (; std::abs(turn) > reach; ++swings) turn = -(turn - std::copysign(2 * reach, turn));
  EXPECT_EQ(swings, 7);
  for (const auto& row : history.rows) {
    if (row.time < swings * std::acos(-1) / 2) continue;
    // Positions are rounded at 1e-16 in each of some dozen flights.
    EXPECT_NEAR(row.x2, 1 - turn, 1e-13);
    EXPECT_EQ(row.v2, 0);
  }
  const auto range = backlash::rest_range(loop_of(m), 1);
  // Ends are held to 1e-14 of the forces.
  EXPECT_NEAR(range.from, 1 - reach, 1e-13);
  EXPECT_NEAR(range.to, 1 + reach, 1e-13);
  EXPECT_GE(1 - turn, range.from);
  EXPECT_LE(1 - turn, range.to);
}

// Without contact the loop is linear: the answer to a line with corners is the sum of those to ramps from its corners.
TEST(CompliantLoop, FollowsALineWithCorners) {
  Machine m;
  m.clearance = 1000;
  m.control = Machine::Control{3, 0.4, 2};
  m.control->follows_drive = true;
  m.control->set_point.ramp = 1;
  const auto ramp = history_of(m, {});
  m.control->set_point = {};
  m.control->set_point.knots = {{0, 0}, {1, 0.5}, {3, -0.5}, {4, -0.5}};
  const auto line = history_of(m, {});
  ASSERT_EQ(line.rows.size(), ramp.rows.size());
  const std::size_t second = 4;  // rows
  const auto at = [&](std::size_t row, std::size_t begin) { return row < begin ? 0.0 : ramp.rows[row - begin].x2; };
  for (std::size_t i = 0; i < line.rows.size(); ++i) {
    const double sum = 0.5 * at(i, 0) - at(i, second) + 0.5 * at(i, 3 * second);
    EXPECT_NEAR(line.rows[i].x2, sum, 1e-13 * (1 + std::abs(sum)));
  }
}

// While the load flies freely, s^1/2 x1 of x1 = v t is v t^(1/2)/Gamma(3/2), and M2 x2'' = -k s^1/2 x1.
TEST(CompliantLoop, FollowsFractionalPowersToTheirTolerance) {
  const Machine m;
  const double speed = 0.2, gain = 1.5;
  const backlash::CompliantBodies far(backlash::free_mass(m.mass1), backlash::free_mass(m.mass2), 2,
                                      CompliantContact(m.stiffness, m.damping));
  const CompliantLoop loop(far, frac::FractionalTransferFunction({{gain, 0.5}}, {{1, 0}}));
  LoopSimulationOptions options;
  options.duration = 2.41;
  options.sample_time = 0.2;
  const auto history = simulate_loop(loop, {0, speed, 0, speed}, {}, options);
  ASSERT_EQ(history.rows.size(), 13U);
  EXPECT_LT(history.realisation_error, 2e-8);
  for (const auto& row : history.rows) {
    const double fall = gain * speed / m.mass2 * std::pow(row.time, 2.5) / std::tgamma(3.5);
    // Modes are told apart at the loss of up to six digits in each of some flights.
    EXPECT_NEAR(row.x1, speed * row.time, 1e-8);
    // The tolerance holds on the band of the motion, whose slowest part lies below it.
    EXPECT_NEAR(row.x2, speed * row.time - fall, 1e-6 * (fall + 1e-6)) << row.time;
  }
}

// Random rests by trial: a grid of the load's positions and of contact forces or places in the gap, each held where the
// forces on each body are within its friction.
TEST(CompliantLoop, RestsWithinTheRangeOfItsForces) {
  support::Random random(8);
  int ends = 0;
  for (std::size_t i = 0; i < 30; ++i) {
    Machine m = random_loop(random, i);
    m.control->ki = 0;
    m.coulomb1 = m.control->kp * m.clearance * random.uniform(0.05, 0.5);
    m.coulomb2 = m.control->kp * m.clearance * random.uniform(0.05, 0.5);
    const double wanted = m.clearance * random.uniform(-1, 1);
    const auto range = backlash::rest_range(loop_of(m), wanted);
    constexpr int steps = 400;
    const double width = 3 * m.clearance, hardest = 2 * (m.coulomb1 + m.coulomb2), half = 0.5 * m.clearance;
    double from = unbounded, to = -unbounded;
    for (int a = -steps; a <= steps; ++a) {
      for (int b = -steps; b <= steps; ++b) {
        const double first = wanted + width * a / steps, place = 2.0 * b / steps;
        const double press = std::copysign(std::max(0.0, std::abs(place) - 1) * hardest, place);
        const double gap = std::clamp(place, -1.0, 1.0) * half + press / m.stiffness;
        const double second = first + gap;
        const double measured = m.control->follows_drive ? second : first;
        if (std::abs(press - m.spring1 * first) > m.coulomb1) continue;
        if (std::abs(m.control->kp * (wanted - measured) - press) > m.coulomb2) continue;
        from = std::min(from, measured);
        to = std::max(to, measured);
      }
    }
    // Every rest lies in the range, and the grid comes as near to its ends as some of its steps, in the corner of two
    // forces.
    const double step = width / steps + 2 * half / steps + 2 * hardest / steps / m.control->kp;
    EXPECT_GE(from, range.from - 1e-12) << i;
    EXPECT_LE(to, range.to + 1e-12) << i;
    for (const double missed : {range.to < wanted + width ? range.to - to : unbounded,
                                range.from > wanted - width ? from - range.from : unbounded}) {
      if (missed == unbounded) continue;
      ++ends;
      EXPECT_LT(missed, 4 * step) << i;
    }
  }
  EXPECT_GT(ends, 30);
}

// Free bodies in contact: the load holds its friction against the drive, so that the motor has both against it.
TEST(CompliantLoop, RestRangeOfFreeBodiesIsThatOfBothFrictions) {
  Machine m;
  m.coulomb1 = 0.2;
  m.coulomb2 = 0.5;
  m.control = Machine::Control{7, 0, 1};
  const auto of_load = backlash::rest_range(loop_of(m), 3);
  EXPECT_NEAR(of_load.to, 3 + 0.7 / 7, 1e-13);
  EXPECT_NEAR(of_load.from, 3 - 0.7 / 7, 1e-13);
  m.control->ki = 1;
  EXPECT_EQ(backlash::rest_range(loop_of(m), 3).to, 3);
  m.control = Machine::Control{0, 0, 1};
  const CompliantLoop damped(m.bodies(), frac::FractionalTransferFunction({{1, 1}}, {{1, 0}}), Output::x1);
  EXPECT_EQ(backlash::rest_range(damped, 3).to, unbounded);
}

// From sample to sample the bodies move under a constant force, which an integration begins anew at each row: what
// contact and slide go on there it decides from positions, velocities and forces.
TEST(SampledCompliantLoop, MovesBetweenSamplesAsAnIntegrationDoes) {
  support::Random random(363);
  int contacts = 0, rests = 0;
  for (std::size_t i = 0; i < 12; ++i) {
    Machine m = random_loop(random, i);
    const Machine::Control control = *m.control;
    backlash::SampledLoopOptions options;
    options.sample_time = 0.04;
    options.duration = 8;
    options.force_limit = control.limit;
    options.velocity1 = 0.4 * m.clearance;
    options.velocity2 = -m.clearance;
    options.set_point.step = control.set_point.step;
    options.set_point.ramp = control.set_point.ramp;
    if (i % 2 == 0) options.disturbance = {0.1 * control.kp * m.clearance, -0.2 * control.kp * m.clearance};
    const CompliantLoopHistory history = simulate_sampled_loop(loop_of(m), options);
    ASSERT_EQ(history.end, backlash::LoopEnd::duration);
    ASSERT_EQ(history.rows.size(), 201U);
    contacts += static_cast<int>(history.contacts);
    m.control = Machine::Control{};
    for (std::size_t n = 0; n + 1 < history.rows.size(); ++n) {
      const auto &row = history.rows[n], &next = history.rows[n + 1];
      rests += row.v1 == 0 || row.v2 == 0 ? 1 : 0;
      m.control->disturbance = {options.disturbance.body1, options.disturbance.body2 + row.force};
      Integration motion(m, {row.x1, row.v1, row.x2, row.v2});
      motion.advance(static_cast<compliant_test::Real>(options.sample_time));
      const auto& z = motion.state();
      // Roundings of positions that grow to a hundred gaps, and of a force over the least mass.
      const double size = m.clearance + std::abs(row.x1) + std::abs(row.x2);
      ASSERT_NEAR(next.x1, static_cast<double>(z[Integration::x1]), 1e-13 * size) << "loop " << i << ", row " << n;
      ASSERT_NEAR(next.x2, static_cast<double>(z[Integration::x2]), 1e-13 * size) << "loop " << i << ", row " << n;
    }
  }
  EXPECT_GT(contacts, 24);
  EXPECT_GT(rests, 50);
}

// A held force and a difference quotient are of first order in the sample time: the error against the continuous loop
// halves with it.  With dry friction, contacts and a constant force on each body.
TEST(SampledCompliantLoop, TendsToTheContinuousOne) {
  Machine m;
  m.clearance = 0.2;
  const CompliantContact contact = CompliantContact::from_frequency(40, 0.2, 1, 1);
  m.stiffness = contact.stiffness();
  m.damping = contact.damping();
  m.coulomb1 = 0.05;
  m.coulomb2 = 0.1;
  m.control = Machine::Control{3, 0, 3};
  m.control->follows_drive = true;
  m.control->set_point = {1, 0, 0, 0, {}, 1};
  const CompliantLoop loop = loop_of(m);
  LoopSimulationOptions exact;
  exact.duration = 2;
  exact.sample_time = 2;
  exact.rows_at_impacts = false;
  exact.disturbance = {-0.1, 0.05};
  const double wanted = simulate_loop(loop, {}, m.control->set_point, exact).rows.back().x2;
  std::vector<double> errors;
  for (const double sample_time : {2e-3, 1e-3, 5e-4}) {
    backlash::SampledLoopOptions options;
    options.sample_time = sample_time;
    options.duration = 2;
    options.set_point = m.control->set_point;
    options.disturbance = exact.disturbance;
    const auto history = simulate_sampled_loop(loop, options);
    EXPECT_GT(history.contacts, 1U);
    errors.push_back(history.rows.back().x2 - wanted);
  }
  EXPECT_NEAR(errors[0] / errors[1], 2, .2);
  EXPECT_NEAR(errors[1] / errors[2], 2, .1);
  EXPECT_LT(std::abs(errors[2]), 2e-3);
}

// A dead time is rounded to whole samples, which the force waits for.
TEST(SampledCompliantLoop, WaitsForItsDeadTime) {
  const Machine m;
  const CompliantLoop loop(m.bodies(), frac::FractionalTransferFunction({{2, 0}}, {{1, 0}}, 0.05), Output::x2);
  backlash::SampledLoopOptions options;
  options.sample_time = 0.01;
  options.duration = 0.2;
  options.set_point.step = 1;
  const auto rows = simulate_sampled_loop(loop, options).rows;
  for (std::size_t n = 0; n < 5; ++n) EXPECT_EQ(rows[n].force, 0);
  for (std::size_t n = 5; n < rows.size(); ++n) EXPECT_NEAR(rows[n].force, 2 * (1 - rows[n - 5].x2), 1e-14);
}

TEST(CompliantLoop, RefusesWhatItDoesNotFollow) {
  const Machine m;
  const frac::FractionalTransferFunction late({{1, 0}}, {{1, 0}}, 0.1);
  support::expect_invalid_argument([&] { (void)simulate_loop(CompliantLoop(m.bodies(), late), {}, {}, {}); },
                                   {"dead time of 0.1 s"});
  const CompliantLoop loop(m.bodies(), frac::FractionalTransferFunction({{1, 1}, {1, 0}}, {{1, 0}}));
  LoopSimulationOptions options;
  options.whole_memory = true;
  support::expect_invalid_argument([&] { (void)simulate_loop(loop, {}, {}, options); }, {"whole memory"});
  Machine stiff;
  stiff.stiffness = 1e20;
  const CompliantLoop fast(stiff.bodies(), loop.controller());
  support::expect_invalid_argument([&] { (void)simulate_loop(fast, {}, {}, {}); }, {"crossover"});
}

}  // namespace
