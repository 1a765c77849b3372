// SPDX-License-Identifier: BSD-3-Clause
#include "backlash/time_history.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "support/expect_invalid_argument.hpp"
#include "support/random.hpp"

namespace {

using backlash::HistoryEvent;
using backlash::HistoryRow;
using backlash::simulate_impacts;
using backlash::time_history;
using backlash::TimeHistory;
using backlash::TwoMassSystem;
using backlash::Wall;

constexpr double pi = std::numbers::pi;
constexpr double ulp = std::numeric_limits<double>::epsilon();

struct Scene {
  TwoMassSystem system;
  double force;
  double omega;
  backlash::RelativeState start;
};

Scene random_scene(support::Random& random) {
  const double clearance = random.log_uniform(1e-3, 10);
  const TwoMassSystem system(random.log_uniform(0.1, 10), random.log_uniform(0.1, 10), clearance, random.unit());
  const double force = random.log_uniform(0.1, 100);
  const double omega = std::sqrt(force / system.mass2() / clearance / random.log_uniform(0.1, 30));
  return {system, force, omega, {clearance * random.unit(), clearance * omega * random.uniform(-1, 1)}};
}

// Nothing but contacts acts on mass 1, and the force alone on mass 2: between events v1 is constant, x1 linear, and m2
// (v2 - its last value) the impulse of the force.
TEST(TimeHistory, EachMassObeysNewtonBetweenEvents) {
  support::Random random(41);
  for (int i = 0; i < 200; ++i) {
    const auto [system, force, omega, start] = random_scene(random);
    const TimeHistory history = time_history(system, force, omega, start, 6, 17);
    ASSERT_TRUE(history.complete);
    const double m2 = system.mass2();
    for (std::size_t k = 1; k < history.rows.size(); ++k) {
      const HistoryRow& from = history.rows[k - 1];
      const HistoryRow& to = history.rows[k];
      const double step = to.time - from.time;
      ASSERT_GE(step, 0);
      // Rounding of the largest numbers at play, and of the phase omega t over the velocities.
      const double phase = omega * to.time;
      const double speed =
          std::abs(from.v1) + std::abs(from.v2) + std::abs(to.v1) + std::abs(to.v2) + force / m2 / omega;
      const double length = std::abs(from.x1) + std::abs(from.x2) + speed / omega;
      const double rounding = 40 * ulp * (1 + phase);
      if (to.event == HistoryEvent::after_impact) {
        ASSERT_EQ(step, 0);
        ASSERT_EQ(from.event, HistoryEvent::before_impact);
        continue;
      }
      const bool resting = from.event == HistoryEvent::rest_begin ||
                           (from.wall && from.event == HistoryEvent::sample && to.event != HistoryEvent::rest_begin);
      if (resting) {
        ASSERT_NEAR(to.v1, to.v2, rounding * speed);
        continue;
      }
      if (to.event == HistoryEvent::rest_begin) continue;  // after the last listed impact the rest is summed
      ASSERT_NEAR(to.v1, from.v1, rounding * speed);
      ASSERT_NEAR(to.x1 - from.x1, from.v1 * step, rounding * length);
      const double impulse = force / omega * (std::sin(omega * to.time) - std::sin(omega * from.time));
      ASSERT_NEAR(m2 * (to.v2 - from.v2), impulse, m2 * rounding * speed);
    }
  }
}

TEST(TimeHistory, ImpactsKeepMomentumObeyRestitutionAndLieOnAWall) {
  support::Random random(43);
  int impacts = 0;
  for (int i = 0; i < 200; ++i) {
    const auto [system, force, omega, start] = random_scene(random);
    const TimeHistory history = time_history(system, force, omega, start, 6, 3);
    const auto listed = simulate_impacts(system, force, omega, start, 6);
    std::size_t next = 0;
    for (std::size_t k = 1; k < history.rows.size(); ++k) {
      const HistoryRow& after = history.rows[k];
      const HistoryRow& before = history.rows[k - 1];
      const double length = std::abs(after.x1) + std::abs(after.x2);
      const double gap = after.x2 - after.x1;
      ASSERT_GE(gap, -4 * ulp * length);
      ASSERT_LE(gap, system.clearance() + 4 * ulp * (length + system.clearance()));
      if (after.wall) {
        ASSERT_NEAR(gap, *after.wall == Wall::near ? 0 : system.clearance(), 4 * ulp * (length + system.clearance()));
      }
      if (after.event != HistoryEvent::after_impact) continue;
      ASSERT_LT(next, listed.impacts.size());
      ASSERT_EQ(after.time, listed.impacts[next].time);
      ASSERT_EQ(*after.wall, listed.impacts[next].wall);
      ++next;
      ++impacts;
      const double speed = std::abs(before.v1) + std::abs(before.v2) + std::abs(after.v1) + std::abs(after.v2);
      const double m1 = system.mass1();
      const double m2 = system.mass2();
      ASSERT_NEAR(m1 * after.v1 + m2 * after.v2, m1 * before.v1 + m2 * before.v2, 8 * ulp * (m1 + m2) * speed);
      ASSERT_NEAR(after.v2 - after.v1, -system.restitution() * (before.v2 - before.v1), 8 * ulp * speed);
    }
    ASSERT_EQ(next, listed.impacts.size());
    ASSERT_NEAR(history.end.position, listed.end.position, 1e-13 * system.clearance());
  }
  EXPECT_GT(impacts, 2000);
}

TEST(TimeHistory, SamplesAreEvenAndHitBothEnds) {
  const TimeHistory history = time_history({1, 1, 0.3, 0.6}, 40, 20, {0.15, 0}, 3, 8);
  std::vector<double> times;
  for (const HistoryRow& row : history.rows)
    if (row.event == HistoryEvent::sample) times.push_back(row.time);
  ASSERT_EQ(times.size(), 25u);
  for (std::size_t i = 0; i < times.size(); ++i) EXPECT_NEAR(times[i], 2 * pi / 20 * static_cast<double>(i) / 8, 1e-15);
  // The centre of mass swings as -F/((M1 + M2) omega^2) cos(omega t).
  for (const HistoryRow& row : history.rows) {
    EXPECT_NEAR((row.x1 + row.x2) / 2, -40.0 / 2 / 400 * std::cos(20 * row.time), 1e-15);
    EXPECT_NEAR((row.v1 + row.v2) / 2, 40.0 / 2 / 20 * std::sin(20 * row.time), 1e-13);
  }
}

TEST(TimeHistory, RestsBeginAndEndWithRows) {
  // Strong force: the mass chatters and sticks twice a period, and is let go where the force reverses.
  const TimeHistory history = time_history({1, 1, 0.3, 0.6}, 40, 0.5, {0, 0}, 3, 20);
  int rests = 0;
  for (const HistoryRow& row : history.rows) {
    if (row.event == HistoryEvent::rest_begin) ++rests;
    if (row.event != HistoryEvent::release) continue;
    EXPECT_NEAR(std::cos(0.5 * row.time), 0, 1e-14);
    EXPECT_EQ(row.v1, row.v2);
  }
  EXPECT_GE(rests, 6);
}

TEST(TimeHistory, NamesWhatIsOutOfRange) {
  const TwoMassSystem system(1, 1, 0.3, 0.6);
  using support::expect_invalid_argument;
  expect_invalid_argument([&] { (void)time_history(system, 40, 20, {0.15, 0}, 3, 0); }, {"samples is 0"});
  expect_invalid_argument([&] { (void)time_history(system, 40, 20, {0.15, 0}, 0, 5); }, {"periods is 0"});
  expect_invalid_argument([&] { (void)time_history(system, 40, 20, {0.15, 0}, 100'000, 1000); }, {"samples is 1000"});
  expect_invalid_argument([&] { (void)time_history(system, 40, 20, {0.5, 0}, 1, 5); }, {"start.position is 0.5"});
  expect_invalid_argument([&] { (void)time_history({1, 1, 0, 0.6}, 40, 20, {0, 0}, 1, 5); }, {"clearance is 0"});
}

TEST(TimeHistory, EndsEarlyAtTheLastImpactAllowed) {
  const TimeHistory history = time_history({1, 1, 0.3, 0.6}, 40, 20, {0.15, 0}, 100, 1, 5);
  EXPECT_FALSE(history.complete);
  EXPECT_EQ(history.rows.back().event, HistoryEvent::after_impact);
  EXPECT_EQ(std::count_if(history.rows.begin(), history.rows.end(),
                          [](const HistoryRow& row) { return row.event == HistoryEvent::after_impact; }),
            5);
}

// Newton's law does not know of frequencies: mass 1 is free between events and m2 takes the impulse of the force, also
// across the peaks where its frequency changes.
TEST(SteppedSineHistory, EachMassObeysNewtonAcrossAllFrequencies) {
  support::Random random(47);
  std::size_t events = 0;
  for (int i = 0; i < 100; ++i) {
    const auto [system, force, first, start] = random_scene(random);
    const std::vector<double> omega{first, first * random.uniform(0.5, 2), first * random.uniform(0.5, 2)};
    constexpr int periods = 4;
    const TimeHistory history = backlash::stepped_sine_history(system, force, omega, start, periods, 17);
    ASSERT_TRUE(history.complete);
    std::vector<double> begins{0};
    for (const double w : omega) begins.push_back(begins.back() + periods * 2 * pi / w);
    ASSERT_NEAR(history.rows.back().time, begins.back(), 8 * ulp * begins.back());
    // Impulse of F cos(phase) from 0 on: whole periods give none.
    const auto impulse_at = [&](double time) {
      std::size_t k = 0;
      while (k + 1 < omega.size() && time > begins[k + 1]) ++k;
      return force / omega[k] * std::sin(omega[k] * (time - begins[k]));
    };
    const double slowest = *std::min_element(omega.begin(), omega.end()), m2 = system.mass2();
    for (std::size_t k = 1; k < history.rows.size(); ++k) {
      const HistoryRow& from = history.rows[k - 1];
      const HistoryRow& to = history.rows[k];
      const double step = to.time - from.time;
      ASSERT_GE(step, 0);
      // Rounding as above; the centre of mass is shifted by up to 2 F/((M1 + M2) omega^2).
      const double speed =
          std::abs(from.v1) + std::abs(from.v2) + std::abs(to.v1) + std::abs(to.v2) + force / m2 / slowest;
      const double length = std::abs(from.x1) + std::abs(from.x2) + speed / slowest;
      const double rounding = 40 * ulp * (1 + 2 * first * to.time);
      if (to.event == HistoryEvent::after_impact) {
        ++events;
        ASSERT_EQ(step, 0);
        ASSERT_NEAR(to.x1, from.x1, rounding * length);
        continue;
      }
      const bool resting = from.event == HistoryEvent::rest_begin ||
                           (from.wall && from.event == HistoryEvent::sample && to.event != HistoryEvent::rest_begin);
      if (resting || to.event == HistoryEvent::rest_begin) continue;
      ASSERT_NEAR(to.v1, from.v1, rounding * speed);
      ASSERT_NEAR(to.x1 - from.x1, from.v1 * step, rounding * length);
      ASSERT_NEAR(m2 * (to.v2 - from.v2), impulse_at(to.time) - impulse_at(from.time), m2 * rounding * speed);
    }
  }
  EXPECT_GT(events, 1000U);
}

TEST(SteppedSineHistory, RefusesWhatIsNoPlan) {
  const TwoMassSystem system(1, 1, 0.3, 0.6);
  support::expect_invalid_argument(
      [&] {
        return backlash::stepped_sine_history(system, 40, {}, {0.1, 0}, 3, 8);
      },
      {"omega is empty"});
  support::expect_invalid_argument(
      [&] {
        return backlash::stepped_sine_history(system, 40, {20, -1}, {0.1, 0}, 3, 8);
      },
      {"omega", "-1"});
  support::expect_invalid_argument(
      [&] {
        return backlash::stepped_sine_history(system, 40, {20, 21}, {0.1, 0}, 3000, 2000);
      },
      {"samples is 2000", "2 frequencies of 3000 periods", "at most 10000000"});
}

}  // namespace
