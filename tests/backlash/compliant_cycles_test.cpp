// SPDX-License-Identifier: BSD-3-Clause
#include "backlash/compliant/compliant_cycles.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <cstddef>
#include <numbers>
#include <vector>

#include "backlash/loops/predicted_cycles.hpp"
#include "support/compliant_integration.hpp"
#include "support/expect_invalid_argument.hpp"
#include "support/random.hpp"

namespace {

using backlash::CompliantContact;
using backlash::CompliantCycle;
using backlash::CompliantCycleOptions;
using backlash::CompliantLoop;
using backlash::LoopStart;
using compliant_test::Integration;
using compliant_test::Machine;
using compliant_test::Real;

using State = std::array<double, 4>;  // x1, v1, x2, v2

CompliantLoop loop_of(const Machine& m) {
  return {m.bodies(), frac::FractionalTransferFunction({{m.control->kd, 1}, {m.control->kp, 0}}, {{1, 0}})};
}

/// Loops of a proportional and derivative action on the load, whose rigid one turns at about 1 rad/s with little
/// damping; contacts of 4 to 60 times that, every second without dry friction.
Machine random_loop(support::Random& random, std::size_t i) {
  Machine m;
  m.mass1 = random.log_uniform(0.4, 2.5);
  m.mass2 = random.log_uniform(0.4, 2.5);
  m.clearance = random.log_uniform(0.05, 1);
  const CompliantContact contact =
      CompliantContact::from_frequency(random.log_uniform(4, 60), random.log_uniform(0.03, 0.6), m.mass1, m.mass2);
  m.stiffness = contact.stiffness();
  m.damping = contact.damping();
  Machine::Control control;
  control.kp = m.mass1 + m.mass2;
  control.kd = control.kp * random.uniform(0.05, 0.5);
  if (i % 4 == 1 || i % 4 == 3) m.coulomb1 = control.kp * m.clearance * random.log_uniform(0.003, 0.03);
  if (i % 4 == 2 || i % 4 == 3) m.coulomb2 = control.kp * m.clearance * random.log_uniform(0.003, 0.03);
  m.control = control;
  return m;
}

State integrated(const Machine& m, const State& from, Real time) {
  Integration motion(m, {from[0], from[1], from[2], from[3]});
  motion.advance(time);
  const auto& z = motion.state();
  return {static_cast<double>(z[Integration::x1]), static_cast<double>(z[Integration::v1]),
          static_cast<double>(z[Integration::x2]), static_cast<double>(z[Integration::v2])};
}

/// Multipliers by central differences of the integration over a half period or a period, from a time at which both
/// bodies move, without the one of a shift in time, which is nearest to 1.  Empty where none is found.
std::vector<std::complex<double>> multipliers_of(const Machine& m, const CompliantCycle& cycle) {
  const Real length = 2 * std::numbers::pi_v<Real> / cycle.omega / (cycle.symmetric ? 2 : 1);
  const State first{cycle.start.x1, cycle.start.v1, cycle.start.x2, cycle.start.v2};
  const std::array<double, 4> sizes = {m.clearance, m.clearance, m.clearance, m.clearance};
  for (const Real share : {Real(0.137), Real(0.311), Real(0.523), Real(0.777)}) {
    const State at = integrated(m, first, share * length);
    // Within a difference of an event the map has a kink.
    constexpr double change = 1e-6;
    if (std::min(std::abs(at[1]), std::abs(at[3])) < 0.02 * m.clearance) continue;
    if (std::abs(std::abs(at[2] - at[0]) - 0.5 * m.clearance) < 1e-3 * m.clearance) continue;
    Eigen::Matrix4d map;
    for (std::size_t k = 0; k < 4; ++k) {
      State more = at, less = at;
      more[k] += change * sizes[k];
      less[k] -= change * sizes[k];
      const State above = integrated(m, more, length), below = integrated(m, less, length);
      for (std::size_t i = 0; i < 4; ++i)
        map(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k)) =
            (cycle.symmetric ? -1 : 1) * (above[i] - below[i]) / (2 * change * sizes[k]);
    }
    const Eigen::Vector4cd all = map.eigenvalues();
    std::vector<std::complex<double>> multipliers(all.data(), all.data() + 4);
    const auto shift = std::min_element(multipliers.begin(), multipliers.end(), [](const auto& a, const auto& b) {
      return std::abs(a - 1.0) < std::abs(b - 1.0);
    });
    multipliers.erase(shift);
    return multipliers;
  }
  return {};
}

void expect_cycles_of_an_integration(std::size_t count, std::uint64_t seed) {
  support::Random random(seed);
  std::size_t cycles = 0, with_friction = 0, unstable = 0, compared = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const Machine m = random_loop(random, i);
    CompliantCycleOptions options;
    options.starts = 2;
    for (const CompliantCycle& cycle : compliant_cycles(loop_of(m), options).cycles) {
      ++cycles;
      with_friction += m.coulomb1 + m.coulomb2 > 0;
      unstable += !cycle.stability.stable;
      const State first{cycle.start.x1, cycle.start.v1, cycle.start.x2, cycle.start.v2};
      const Real length = 2 * std::numbers::pi_v<Real> / cycle.omega / (cycle.symmetric ? 2 : 1);
      const State last = integrated(m, first, length);
      double miss = 0;
      for (std::size_t k = 0; k < 4; ++k)
        miss = std::max(miss, std::abs(last[k] - (cycle.symmetric ? -1 : 1) * first[k]));
      // The start is rounded, the motion magnifies that by its multipliers, and speeds at the contact's frequency.
      EXPECT_LT(miss / m.clearance, 1e-11 * (1 + std::abs(cycle.stability.dominant))) << "loop " << i;
      const auto multipliers = multipliers_of(m, cycle);
      if (multipliers.empty()) continue;
      ++compared;
      double largest = 0;
      for (const auto& each : multipliers) largest = std::max(largest, std::abs(each));
      // Differences of 1e-6 err by their square times the curvature of contacts, and by the integration over them.
      EXPECT_NEAR(std::abs(cycle.stability.dominant), largest, 1e-4 * (1 + largest)) << "loop " << i;
      if (std::abs(largest - 1) > 1e-3) {
        EXPECT_EQ(cycle.stability.stable, largest < 1) << "loop " << i;
      }
    }
  }
  testing::Test::RecordProperty("cycles", static_cast<int>(cycles));
  testing::Test::RecordProperty("compared", static_cast<int>(compared));
  testing::Test::RecordProperty("unstable", static_cast<int>(unstable));
  EXPECT_GT(cycles, count / 2);
  EXPECT_GT(with_friction, cycles / 4);
  EXPECT_GT(compared, cycles / 2);
}

TEST(CompliantCycles, AreThoseOfAnIntegration) {
  expect_cycles_of_an_integration(12, 1);
}

TEST(CompliantCycles, OfSixtyRandomLoopsAreThoseOfAnIntegration) {
  expect_cycles_of_an_integration(60, 2);
}

// At one damping ratio the frequency tends to that of the hard loop, and the prediction to its prediction, in first
// order of 1/wc: 2 f(2 wc) - f(wc) is in second order.
TEST(CompliantCycles, TendToHardOnesInFirstOrder) {
  // Of 1 + s^(1/2), whose orbits under a sine force attract where it predicts them.
  const frac::FractionalTransferFunction controller({{1, 0.5}, {1, 0}}, {{1, 0}});
  std::vector<double> exact, predicted;
  double hard = 0, hard_prediction = 0;
  for (const double frequency : {100.0, 200.0, 400.0, 800.0}) {
    const auto contact = CompliantContact::from_frequency(frequency, 0.18085830836414354, 1, 1);
    const CompliantLoop loop(backlash::CompliantBodies(backlash::free_mass(1), backlash::free_mass(1), 1, contact),
                             controller);
    CompliantCycleOptions options;
    options.starts = 0;
    const auto found = compliant_cycles(loop, options);
    ASSERT_EQ(found.cycles.size(), 1U);
    EXPECT_TRUE(found.cycles.front().symmetric);
    EXPECT_TRUE(found.cycles.front().stability.stable);
    ASSERT_TRUE(found.cycles.front().predicted.has_value());
    EXPECT_TRUE(found.cycles.front().predicted->stable);
    exact.push_back(found.cycles.front().omega);
    predicted.push_back(found.cycles.front().predicted->omega);
    hard = symmetric_cycles(loop.hard()).cycles.front().omega;
    for (const auto& each : predicted_limit_cycles(loop.hard()))
      if (std::abs(each.omega - predicted.back()) < std::abs(hard_prediction - predicted.back()))
        hard_prediction = each.omega;
  }
  // What comes after the first order: s^(1/2) that acts for the time of a contact is of order 3/2, with terms half an
  // order apart behind it; predictions see the fundamental alone, and have whole orders.  A ratio of 2 or 4 instead of
  // 2^(3/2) would be another order.
  struct Row {
    std::vector<double> values;
    double limit, ratio, tolerance;
  };
  for (const auto& [values, limit, ratio, tolerance] :
       {Row{exact, hard, std::exp2(1.5), 0.8}, Row{predicted, hard_prediction, 4, 8}}) {
    for (std::size_t i = 1; i < 4; ++i) {
      const double halved = std::exp2(static_cast<double>(i));
      EXPECT_NEAR((values[i - 1] - limit) / (values[i] - limit), 2, 0.8 / halved) << i;
      if (i == 1) continue;
      const double before = 2 * values[i - 1] - values[i - 2] - limit, after = 2 * values[i] - values[i - 1] - limit;
      EXPECT_NEAR(before / after, ratio, tolerance / halved) << i;
    }
  }
}

// Contacts five hundred times as fast as the motion make a fractional controller remember through poles up to 1e9 of
// its pace.  Sums of other poles, as close or closer, have the same cycle: the frequency moves by the stated errors
// times how it hangs on the controller, d ln(omega)/d ln(C) below 10 here.
TEST(CompliantCycles, DoNotHangOnTheRealisation) {
  const frac::FractionalTransferFunction controller({{1, 0.5}, {1, 0}}, {{1, 0}});
  std::vector<CompliantCycle> found;
  for (const auto& [frequency, tolerance] :
       {std::pair{800.0, 1e-9}, std::pair{800.0 * (1 + 1e-13), 1e-9}, std::pair{800.0, 1e-11}}) {
    const auto contact = CompliantContact::from_frequency(frequency, 0.18, 1, 1);
    CompliantCycleOptions options;
    options.starts = 0;
    options.tolerance = tolerance;
    const auto cycles = compliant_cycles(
        CompliantLoop(backlash::CompliantBodies(backlash::free_mass(1), backlash::free_mass(1), 1, contact),
                      controller),
        options);
    ASSERT_EQ(cycles.cycles.size(), 1U);
    found.push_back(cycles.cycles.front());
  }
  for (const CompliantCycle& other : {found[1], found[2]}) {
    EXPECT_NEAR(other.omega / found[0].omega, 1, 1e-8);
    EXPECT_NEAR(std::abs(other.stability.dominant - found[0].stability.dominant), 0, 1e-7);
  }
}

// What motions settle on over time, without any orbit: the time from meeting to meeting.
TEST(CompliantCycles, AreWhatMotionsSettleOn) {
  const auto contact = CompliantContact::from_frequency(20, 0.2, 1, 1.5);
  for (const double order : {1.0, 0.7}) {
    const CompliantLoop loop(
        backlash::CompliantBodies(backlash::free_mass(1), backlash::free_mass(1.5), 1, contact, {0.01, 0.005}),
        frac::FractionalTransferFunction({{0.5, order}, {1.5, 0}}, {{1, 0}}));
    CompliantCycleOptions seeded;
    seeded.starts = order == 1 ? 3 : 1;
    const auto found = compliant_cycles(loop, seeded);
    ASSERT_FALSE(found.cycles.empty());
    for (const auto& motion : found.motions) {
      if (!motion.cycle) continue;
      const CompliantCycle& cycle = found.cycles[*motion.cycle];
      backlash::LoopSimulationOptions options;
      options.duration = order == 1 ? 800 : 200;
      options.most_impacts = 100000;
      options.tolerance = 1e-9;
      const auto history = simulate_loop(loop, motion.start, {}, options);
      std::vector<double> meetings;
      for (const auto& row : history.rows)
        if (row.event == backlash::CompliantEvent::contact) meetings.push_back(row.time);
      const auto per_period = static_cast<std::size_t>(cycle.contacts);
      ASSERT_GT(meetings.size(), 2 * per_period);
      const double period = meetings.back() - meetings[meetings.size() - 1 - per_period];
      // Transients of whole powers have died out; memories of fractional ones fade as a power of time.
      EXPECT_NEAR(period * cycle.omega / (2 * std::numbers::pi), 1, order == 1 ? 1e-9 : 1e-4);
    }
  }
}

TEST(CompliantCycles, RefuseCountsThatAreNone) {
  Machine m;
  m.control = Machine::Control{1, 0, 1};
  CompliantCycleOptions options;
  options.range = backlash::FrequencyRange{2, 1};
  support::expect_invalid_argument([&] { (void)compliant_cycles(loop_of(m), options); }, {"range is 2 to 1"});
  options = {};
  options.starts = -1;
  support::expect_invalid_argument([&] { (void)compliant_cycles(loop_of(m), options); }, {"starts is -1"});
  options = {};
  options.contacts = 0;
  support::expect_invalid_argument([&] { (void)compliant_cycles(loop_of(m), options); }, {"contacts is 0"});
  options = {};
  options.harmonics = 0;
  support::expect_invalid_argument([&] { (void)compliant_cycles(loop_of(m), options); }, {"harmonics is 0"});
}

}  // namespace
