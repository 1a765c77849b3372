// SPDX-License-Identifier: BSD-3-Clause
#include "motion/ordinary_flight.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

#include "motion/harmonics.hpp"
#include "steady_state/two_impact_orbit.hpp"
#include "support/count_allocations.hpp"
#include "support/random.hpp"

namespace {

using backlash::detail::advance_phase;
using backlash::detail::Flight;
using backlash::detail::GapMotion;
using backlash::detail::GapState;
using backlash::detail::reduced_sincos;
using backlash::detail::SinCos;
using backlash::detail::sincos_of_small;
using backlash::detail::state_at_peak;

constexpr long double pi_l = std::numbers::pi_v<long double>;
constexpr double ulp = 0x1p-52;

// Beyond pi/4 both come from r = pi/2 - |x|, and in relative terms u = 2^-53 bounds each rounding: sin r has r cot r of
// r's rounding, one of its last addition, and five in r - sin r, its correction: u (r cot r + 1 + 5 (r/sin r - 1)),
// with 2^-5 u of the polynomial.  That is 2 u at r = 0 and grows to 2.4 u at pi/4, thus 1.2 of 2^-52.
TEST(ReducedSincos, IsGoodToThreeRoundingsWithFullRelativePrecisionAtItsZeros) {
  constexpr double bound = 1.2 * ulp;
  support::Random random(1);
  for (int i = 0; i < 200'000; ++i) {
    const double x = i % 2 == 0 ? random.uniform(-std::numbers::pi / 2, std::numbers::pi / 2)
                                : (i % 4 == 1 ? 1 : -1) * random.log_uniform(1e-300, 1.57);
    const SinCos found = reduced_sincos(x);
    const long double sine = std::sin(static_cast<long double>(x));
    const long double cosine = std::cos(static_cast<long double>(x));
    ASSERT_LE(std::abs(found.sin - sine), bound * std::abs(sine)) << x;
    ASSERT_LE(std::abs(found.cos - cosine), bound * std::abs(cosine)) << x;
    if (std::abs(x) > std::numbers::pi / 4) continue;
    const SinCos small = sincos_of_small(x);
    ASSERT_EQ(small.sin, found.sin);
    ASSERT_EQ(small.cos, found.cos);
  }
  EXPECT_EQ(reduced_sincos(0).sin, 0);
  EXPECT_EQ(reduced_sincos(0).cos, 1);
}

// The next contact in extended precision, by bisection on the pieces between turning points, none of which may hide two
// contacts.
constexpr int followed_turns = 60;
struct Contact {
  bool crosses;
  long double duration;
  long double speed;
};
std::optional<Contact> next_contact(const GapState& start, double gamma) {
  const long double strength = start.parity() * static_cast<long double>(gamma);
  const long double sine = std::sin(static_cast<long double>(start.s));
  const long double cosine = std::cos(static_cast<long double>(start.s));
  const auto one_minus_cos = [](long double h) { return 2 * std::sin(h / 2) * std::sin(h / 2); };
  const auto distance = [&](long double h) {
    const long double h_minus_sin =
        h < 1e-2L ? h * h * h / 6 * (1 - h * h / 20 * (1 - h * h / 42 * (1 - h * h / 72))) : h - std::sin(h);
    return start.distance + start.velocity * h + strength * (sine * one_minus_cos(h) + cosine * h_minus_sin);
  };
  const auto velocity = [&](long double h) {
    return start.velocity + strength * (sine * std::sin(h) + cosine * one_minus_cos(h));
  };
  std::vector<long double> ends{0};
  const long double level = cosine + start.velocity / strength;
  for (int turn = -1; turn < followed_turns; ++turn) {
    for (const long double theta : {std::acos(level), -std::acos(level)}) {
      const long double h = theta + 2 * pi_l * turn - start.s;
      if (std::abs(level) <= 1 && h > 0) ends.push_back(h);
    }
    ends.push_back(2 * pi_l * (turn + 2));
  }
  std::sort(ends.begin(), ends.end());
  for (std::size_t i = 1; i < ends.size(); ++i) {
    const bool above = distance(ends[i]) >= 1;
    if (!above && !(distance(ends[i]) < 0)) continue;
    long double before = ends[i - 1];
    long double after = ends[i];
    for (int halving = 0; halving < 80; ++halving) {
      const long double middle = (before + after) / 2;
      ((above ? distance(middle) >= 1 : distance(middle) < 0) ? after : before) = middle;
    }
    return Contact{above, after, std::abs(velocity(after))};
  }
  return std::nullopt;
}

// The distance is a sum of terms of up to 1 + gamma (1 + h), in flights below 1/2 of 1 + gamma h^2, each rounded a few
// times; over the speed at the contact that is an error of the time, and gamma times it one of the speed.
double contact_time_error(double gamma, const Flight& flight) {
  const double h = flight.duration;
  return 16 * ulp * ((1 + gamma * std::min(1.0, 5 * h * h) * (1 + h)) / flight.speed + h);
}

TEST(OrdinaryFlight, ContactsAreThoseOfExtendedPrecision) {
  support::Random random(3);
  int ordinary = 0;
  const int flights = 30'000;
  for (int i = 0; i < flights; ++i) {
    const double gamma = random.log_uniform(0.01, 1e4);
    GapState start;
    start.half_period = static_cast<int>(random.below(2));
    start.wall = static_cast<int>(random.below(2));
    advance_phase(start, random.uniform(-std::numbers::pi / 2, std::numbers::pi / 2));
    start.distance = random.below(3) == 0 ? random.unit() : 0;
    start.velocity = 2 * random.unit() * random.unit() * std::sqrt(gamma);
    const GapMotion motion(gamma, 0.5);
    if (motion.rests(start)) continue;
    Flight quick;
    quick.push = start.parity() * gamma * start.sin_s;
    quick.pull = start.parity() * gamma * start.cos_s;
    if (!ordinary_flight(start, gamma, 1 / gamma, quick)) continue;
    ++ordinary;
    const auto expected = next_contact(start, gamma);
    SCOPED_TRACE(testing::Message() << "gamma " << gamma << ", s " << start.s << ", parity " << start.parity()
                                    << ", distance " << start.distance << ", velocity " << start.velocity);
    ASSERT_TRUE(expected);
    ASSERT_EQ(quick.crosses, expected->crosses);
    // The distance is a sum of terms of up to gamma (1 + h) + 1, each rounded a few times; over the speed at the
    // contact that is an error of the time, and gamma times it one of the speed.
    const double term = 1 + gamma * std::min(1.0, quick.duration * quick.duration) * (1 + quick.duration);
    const double time_error = 16 * ulp * (term / quick.speed + quick.duration);
    ASSERT_LE(std::abs(quick.duration - expected->duration), time_error);
    ASSERT_LE(std::abs(quick.speed - expected->speed), gamma * time_error + 16 * ulp * (quick.speed + gamma));
    if (!quick.has_end) continue;
    const long double phase = start.half_period * pi_l + start.s + expected->duration;
    ASSERT_LE(std::abs(quick.end_half_period * pi_l + quick.end_s - phase), time_error + 8 * ulp * std::abs(phase));
    ASSERT_LE(std::abs(quick.end_s), std::numbers::pi / 2 * (1 + ulp));
    ASSERT_NEAR(quick.end_sin, std::sin(quick.end_s), 4 * ulp);
    ASSERT_NEAR(quick.end_cos, std::cos(quick.end_s), 4 * ulp);
  }
  // Or the general search would do all the work.
  EXPECT_GT(ordinary, 0.8 * flights);
}

TEST(OrdinaryFlight, NextFlightGivesTheSameContactWhereTheFlightIsNoOrdinaryOne) {
  support::Random random(4);
  for (int i = 0; i < 8'000; ++i) {
    const double gamma = random.log_uniform(0.02, 1e4);
    GapState start = state_at_peak(random.unit(), random.uniform(-2, 2));
    const GapMotion motion(gamma, 0.7);
    for (int impact = 0; impact < 4 && !motion.rests(start); ++impact) {
      const Flight flight = motion.next_flight(start);
      const auto expected = next_contact(start, gamma);
      if (!expected) {
        ASSERT_TRUE(!flight.hits || flight.duration > 2 * std::numbers::pi * followed_turns);
        break;
      }
      ASSERT_TRUE(flight.hits);
      SCOPED_TRACE(testing::Message() << "gamma " << gamma << ", s " << start.s << ", distance " << start.distance
                                      << ", velocity " << start.velocity);
      // A touch of the wall within rounding may be seen or not.
      if (flight.speed < 1e-6 * std::sqrt(gamma)) break;
      ASSERT_EQ(flight.crosses, expected->crosses);
      ASSERT_LE(std::abs(flight.duration - expected->duration), contact_time_error(gamma, flight));
      start = motion.after_impact(start, flight);
    }
  }
}

TEST(OrdinaryFlight, AnImpactAllocatesNothing) {
  for (const double gamma : {0.3, 0.85, 2.2, 50.0}) {
    const GapMotion motion(gamma, 0.6);
    GapState state = state_at_peak(0.5, 0);
    backlash::detail::JumpSum jumps;
    backlash::detail::FlightSum flights;
    const long before = support::allocations;
    for (int i = 0; i < 1000; ++i) {
      if (motion.rests(state) || motion.chatter_tail(state).negligible(1e-13)) state = motion.release_after(state);
      const Flight flight = motion.next_flight(state);
      const GapState next = motion.after_impact(state, flight);
      jumps.add(next, flight.speed);
      flights.add_flight(state, flight);
      state = next;
    }
    EXPECT_EQ(support::allocations, before);
  }
  const long before = support::allocations;
  ::operator delete(::operator new(1));
  EXPECT_EQ(support::allocations, before + 1);  // the count counts
}

// Without dissipation the symmetric orbit meets its walls exactly where the force is at its peaks.
TEST(PeakState, AContactAtThePeakItselfIsOver) {
  for (const double gamma : {0.1, 0.2, 0.3}) {
    for (const double restitution : {1.0, 1 - 1e-16, 1 - 1e-15, 1 - 1e-12}) {
      const auto orbit = backlash::detail::symmetric_two_impact_orbit(gamma, restitution).value();
      const GapMotion motion(gamma, restitution);
      GapState state = orbit.start;
      for (int i = 0; i < 50; ++i) {
        state = backlash::detail::state_at_next_peak(motion, state, 0);
        EXPECT_FALSE(state.distance == 0 && state.velocity < 0);
        EXPECT_NEAR(std::abs(state.velocity) / orbit.speed, 1, 1e-9);
      }
    }
  }
}

}  // namespace
