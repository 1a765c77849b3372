// SPDX-License-Identifier: BSD-3-Clause
#include "steady_state/steady_state.hpp"

#include <gtest/gtest.h>

#include <array>
#include <boost/math/distributions/fisher_f.hpp>
#include <boost/math/quadrature/gauss.hpp>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <tuple>
#include <vector>

#include "backlash/chatter_reference.hpp"
#include "backlash/extended_motion.hpp"
#include "steady_state/closed_orbit.hpp"
#include "steady_state/two_impact_orbit.hpp"
#include "support/honest_scenes.hpp"
#include "support/random.hpp"
#include "support/reference_table.hpp"
#include "support/relative_error.hpp"

namespace {

using backlash::Regime;
using backlash::detail::ClosedOrbit;
using backlash::detail::find_steady_state;
using backlash::detail::Flight;
using backlash::detail::GapMotion;
using backlash::detail::GapState;
using backlash::detail::state_at_peak;
using backlash::detail::SteadyState;
using support::relative_error;
using Complex = std::complex<double>;

constexpr double pi = std::numbers::pi;

// Means over the usual window: enough where the scatter of many of them is what is tested.
constexpr backlash::detail::MeanGoal usual_window{0, 0, backlash::detail::Transients::ignored};

GapState mid_gap() {
  return state_at_peak(0.5, 0);
}

TEST(SteadyState, AgreesWithQuadruplePrecisionToTheLastDigits) {
  const auto rows = support::reference_table("df_orbits.csv");
  ASSERT_EQ(rows.size(), 9u);
  for (const auto& row : rows) {
    const double restitution = row[0];
    const double gamma = row[1];
    const SteadyState steady = find_steady_state(GapMotion(gamma, restitution), mid_gap(), 1e-10);
    SCOPED_TRACE(testing::Message() << "restitution " << restitution << ", gamma " << gamma);
    // Rounding of a period of up to 62 impacts, amplified by 1/(1 - spectral radius) < 3: 1e-13 of the fundamental. The
    // fifth harmonic comes from the same sums and is 30 to 300 times smaller.
    EXPECT_LT(relative_error(steady.harmonics.u[0], {row[2], row[3]}), 1e-13);
    EXPECT_LT(std::abs(steady.harmonics.u[1] - Complex(row[4], row[5])), 1e-13);
    EXPECT_LT(std::abs(steady.harmonics.u[2] - Complex(row[6], row[7])), 1e-13);
    // The reported uncertainty holds.
    EXPECT_LE(std::abs(steady.harmonics.u[0] - Complex(row[2], row[3])), steady.uncertainty);
    EXPECT_LT(steady.uncertainty, 1e-12);
    EXPECT_EQ(steady.period, 1);
    // Rows with dozens of impacts are complete chatter, cut off by the table.
    if (row[8] > 10) {
      EXPECT_EQ(steady.regime, Regime::chatter);
      EXPECT_TRUE(std::isinf(steady.impacts_per_period));
    } else {
      EXPECT_EQ(steady.regime, Regime::periodic);
      EXPECT_EQ(steady.impacts_per_period, row[8]);
    }
  }
}

// Scenes drawn at random, followed in extended precision for 400 periods from mid-gap at rest: where both settle on an
// orbit without rests, its harmonics agree.
TEST(SteadyState, RandomOrbitsAgreeWithExtendedPrecision) {
  using reference::ExtendedMotion;
  support::Random random(61);
  int orbits = 0;
  int elsewhere = 0;
  for (int scene = 0; scene < 120; ++scene) {
    const double restitution = random.uniform(0.15, 0.9);
    const double gamma = random.log_uniform(0.26, 2.5);
    const SteadyState steady = find_steady_state(GapMotion(gamma, restitution), mid_gap(), 1e-10);
    // 400 periods leave less than 1e-17 of what was there at the beginning.
    if (!(steady.spectral_radius > 0 && std::pow(steady.spectral_radius, 400.0 / steady.period) < 1e-17)) continue;
    ExtendedMotion motion(gamma, restitution, 0.5L, 0);
    const int impacts = static_cast<int>(std::lround(steady.impacts_per_period * steady.period));
    int followed = 0;
    std::array<std::complex<long double>, 3> sums{};
    bool settled = true;
    while (followed < impacts && settled) {
      const auto contact = motion.next_contact();
      settled = contact && contact->speed > 1e-9L;  // or it chatters on its way
      if (!settled) break;
      motion.pass(*contact);
      if (motion.turns() < 400) continue;
      ++followed;
      const long double jump = (contact->far ? -1 : 1) * (1 + static_cast<long double>(restitution)) * contact->speed;
      for (std::size_t i = 0; i < sums.size(); ++i) {
        const int k = 2 * static_cast<int>(i) + 1;
        sums[i] += jump * std::polar(1.0L, -k * motion.phase());
      }
    }
    if (!settled) continue;
    SCOPED_TRACE(testing::Message() << "restitution " << restitution << ", gamma " << gamma);
    ++orbits;
    for (std::size_t i = 0; i < sums.size(); ++i) {
      const long double k = 2 * static_cast<long double>(i) + 1;
      // Two integrations by parts leave the velocity jumps: U_k = -sum/(pi k^2 periods), less gamma for k = 1.
      std::complex<long double> expected = -sums[i] / (ExtendedMotion::pi * k * k * steady.period);
      if (i == 0) expected -= gamma;
      const Complex value(static_cast<double>(expected.real()), static_cast<double>(expected.imag()));
      if (i == 0 && std::abs(value - steady.harmonics.u[0]) > 1e-6) {
        // A chaotic transient amplifies rounding and may lead to another orbit.
        ++elsewhere;
        break;
      }
      EXPECT_LT(std::abs(value - steady.harmonics.u[i]), 1e-12) << "harmonic " << k;
      if (i == 0) {
        EXPECT_LE(std::abs(value - steady.harmonics.u[0]), steady.uncertainty);
      }
    }
  }
  EXPECT_GT(orbits, 40);
  EXPECT_LT(elsewhere, orbits / 10);
}

TEST(SteadyState, StickingOrbitsAgreeWithFiftyDigitsUpToStrongForces) {
  for (const double restitution : {0.0, 1e-12, 0.1, 0.3, 0.6, 0.9}) {
    for (const double gamma : {100.0, 1e4, 1e6, 1e9}) {
      if (restitution == 0.9 && gamma < 1e4) continue;  // chatter is not complete before the force reverses
      const SteadyState steady = find_steady_state(GapMotion(gamma, restitution), mid_gap(), 1e-10);
      const Complex expected = reference::sticking_orbit_harmonic(gamma, restitution);
      SCOPED_TRACE(testing::Message() << "restitution " << restitution << ", gamma " << gamma);
      EXPECT_EQ(steady.regime, restitution == 0 ? Regime::periodic : Regime::chatter);
      EXPECT_LT(relative_error(steady.harmonics.u[0], expected), 1e-14);
      // Im U falls like gamma^(-1/3); chatter is cut off at 1e-13 of that.
      EXPECT_NEAR(steady.harmonics.u[0].imag() / expected.imag(), 1, 1e-12);
      EXPECT_LE(std::abs(steady.harmonics.u[0] - expected), steady.uncertainty);
    }
  }
}

TEST(SteadyState, LowFrequencyLimitFollowsTheTwoThirdsLaw) {
  // |Im U| gamma^(1/3) -> K(restitution), printed to six digits; the next term is of relative order gamma^(-2/3).
  const double rows[][2] = {{0, .867611}, {.2, .871860}, {.4, .900510}, {.6, .985674}, {.8, 1.229968}};
  for (const auto& [restitution, k] : rows) {
    const SteadyState steady = find_steady_state(GapMotion(1e12, restitution), mid_gap(), 1e-10);
    EXPECT_NEAR(-steady.harmonics.u[0].imag() * 1e4, k, 5.1e-7 + 1e-7);
  }
  EXPECT_NEAR(-find_steady_state(GapMotion(1e12, 0), mid_gap(), 1e-10).harmonics.u[0].imag() * 1e4,
              std::pow(6.0, 4.0 / 3) / (4 * pi), 1e-7);
}

TEST(SteadyState, WithoutRestitutionTheOrbitIsExactForAnyForceAboveOneOverPi) {
  // s - sin s = 1/gamma, v = gamma (1 - cos s), Im U = -v^2/(pi gamma).
  for (const double gamma : {0.32, 0.5, 1.0, 3.0, 1e3}) {
    double s = std::cbrt(6 / gamma);
    for (int i = 0; i < 50; ++i) s -= (s - std::sin(s) - 1 / gamma) / (1 - std::cos(s));
    const double v = gamma * (1 - std::cos(s));
    const SteadyState steady = find_steady_state(GapMotion(gamma, 0), mid_gap(), 1e-10);
    // s - sin s cancels at large gamma, here at most to s^2/6 = 1e-3 of s.
    EXPECT_NEAR(steady.harmonics.u[0].imag() / (-v * v / (pi * gamma)), 1, 1e-12) << gamma;
    EXPECT_EQ(steady.regime, Regime::periodic);
    EXPECT_EQ(steady.impacts_per_period, 2);
  }
  const SteadyState steady = find_steady_state(GapMotion(1, 0), mid_gap(), 1e-10);
  EXPECT_LT(std::abs(steady.harmonics.u[0] - Complex(.0850136087, -.5851127401)), 1e-10);
}

// Harmonic k of the motion over `periods`, by Gauss-Legendre quadrature of u itself on pieces of each flight.
Complex by_quadrature(const GapMotion& motion, GapState state, int impacts, int k, double half_periods) {
  Complex sum = 0;
  for (int i = 0; i < impacts; ++i) {
    const Flight flight = motion.next_flight(state);
    const double begin = static_cast<double>(state.half_period) * pi - pi / 2 + state.s;
    const int pieces = 8;
    for (int piece = 0; piece < pieces; ++piece) {
      const double from = flight.duration * piece / pieces;
      const double to = flight.duration * (piece + 1) / pieces;
      const auto part = [&](auto weight) {
        return boost::math::quadrature::gauss<double, 20>::integrate(
            [&](double h) {
              const double distance = motion.along(state, flight, h).distance;
              return (state.wall == 0 ? distance : 1 - distance) * weight(k * (begin + h));
            },
            from, to);
      };
      sum += Complex(part([](double x) { return std::cos(x); }), -part([](double x) { return std::sin(x); }));
    }
    state = motion.after_impact(state, flight);
  }
  return sum * 2.0 / (pi * half_periods);
}

// Closed orbits of several kinds, found from mid-gap at rest.
std::vector<std::pair<GapMotion, ClosedOrbit>> closed_orbits() {
  std::vector<std::pair<GapMotion, ClosedOrbit>> orbits;
  const double scenes[][4] = {// gamma, restitution, impacts, periods
                              {0.3, 0.6, 2, 1},    {0.45, 0.6, 2, 1}, {0.82493, 0.6, 3, 1}, {1.1756, 0.6, 4, 1},
                              {0.6419, 0.6, 6, 2}, {0.48, 0.3, 2, 1}, {2.702, 0.6, 6, 1}};
  for (const auto& [gamma, restitution, impacts, periods] : scenes) {
    const GapMotion motion(gamma, restitution);
    GapState state = mid_gap();
    for (int i = 0; i < 2000; ++i) {
      const Flight flight = motion.next_flight(state);
      state = motion.after_impact(state, flight);
    }
    state.half_period &= 1;  // phases of an orbit are counted from its beginning
    const auto orbit =
        backlash::detail::close_orbit(motion, state, static_cast<int>(impacts), 2 * static_cast<int>(periods), 1e-10);
    if (orbit) orbits.emplace_back(motion, *orbit);
  }
  return orbits;
}

TEST(ClosedOrbit, HarmonicsEqualQuadratureAndBothClosedFormsAgree) {
  const auto orbits = closed_orbits();
  ASSERT_GE(orbits.size(), 6u);
  for (const auto& [motion, orbit] : orbits) {
    const auto half_periods = static_cast<double>(orbit.half_periods);
    const backlash::detail::Harmonics by_jumps = backlash::detail::orbit_harmonics(motion, orbit);
    backlash::detail::FlightSum flights;
    GapState state = orbit.start;
    for (int i = 0; i < orbit.impacts; ++i) {
      const Flight flight = motion.next_flight(state);
      const GapState next = motion.after_impact(state, flight);
      flights.add_flight(state, flight);
      if (flight.crosses) flights.add_crossing(next);
      state = next;
    }
    const backlash::detail::Harmonics by_flights = flights.harmonics(motion.gamma(), half_periods);
    for (std::size_t i = 0; i < backlash::detail::harmonic_orders.size(); ++i) {
      const int k = backlash::detail::harmonic_orders[i];
      // Smooth integrands on pieces below pi/4: the quadrature is exact to rounding, as are the sums of some ten terms
      // below 3; the orbit itself is closed to 1e-14.
      const Complex expected = by_quadrature(motion, orbit.start, orbit.impacts, k, half_periods);
      EXPECT_LT(std::abs(by_jumps.u[i] - expected), 1e-13) << motion.gamma() << ", " << k;
      EXPECT_LT(std::abs(by_flights.u[i] - expected), 1e-13) << motion.gamma() << ", " << k;
    }
    EXPECT_LT(std::abs(by_jumps.u1_plus_gamma - (by_jumps.u[0] + motion.gamma())), 1e-14);
  }
}

TEST(ClosedOrbit, MultipliersHaveTheProductOfRestitutionAndAgreeWithFiniteDifferences) {
  for (const auto& [motion, orbit] : closed_orbits()) {
    SCOPED_TRACE(testing::Message() << "gamma " << motion.gamma());
    const double expected = std::pow(motion.restitution(), 2.0 * orbit.impacts);
    EXPECT_NEAR(orbit.jacobian.determinant() / expected, 1, 1e-9);

    const auto image = [&](double phase_step, double velocity_step) {
      GapState state = orbit.start;
      backlash::detail::advance_phase(state, phase_step);
      state.velocity += velocity_step;
      for (int i = 0; i < orbit.impacts; ++i) {
        const Flight flight = motion.next_flight(state);
        state = motion.after_impact(state, flight);
      }
      return std::pair{state.s, state.velocity};
    };
    // Central differences: rounding 1e-15/step against step^2 times third derivatives of up to 1e3.
    const double step = 1e-6;
    const double tolerance = 1e-7;
    const auto phase_plus = image(step, 0);
    const auto phase_minus = image(-step, 0);
    const auto velocity_plus = image(0, step);
    const auto velocity_minus = image(0, -step);
    EXPECT_NEAR(orbit.jacobian.phase_phase, (phase_plus.first - phase_minus.first) / (2 * step), tolerance);
    EXPECT_NEAR(orbit.jacobian.velocity_phase, (phase_plus.second - phase_minus.second) / (2 * step), tolerance);
    EXPECT_NEAR(orbit.jacobian.phase_velocity, (velocity_plus.first - velocity_minus.first) / (2 * step), tolerance);
    EXPECT_NEAR(orbit.jacobian.velocity_velocity, (velocity_plus.second - velocity_minus.second) / (2 * step),
                tolerance);
  }
}

TEST(ClosedOrbit, NewtonReachesTheClosedFormOfTheSymmetricOrbitFromNearby) {
  const double restitution = 0.6;
  const auto exact = backlash::detail::symmetric_two_impact_orbit(0.3, restitution).value();
  GapState guess = exact.start;
  backlash::detail::advance_phase(guess, 0.02);
  guess.velocity *= 1.03;
  const auto orbit = backlash::detail::close_orbit(GapMotion(0.3, restitution), guess, 2, 2, 1e-10);
  ASSERT_TRUE(orbit);
  EXPECT_NEAR(orbit->start.s, exact.start.s, 1e-14);
  EXPECT_NEAR(orbit->start.velocity, exact.start.velocity, 1e-14);
}

TEST(SteadyState, FindsLongPeriodsBeyondTheFirst) {
  // Period of force periods and impacts per period at restitution 0.6, reached by sweeping up; the label must be the
  // least period.
  const SteadyState steady = find_steady_state(GapMotion(0.6419, 0.6), mid_gap(), 1e-10);
  ASSERT_EQ(steady.regime, Regime::periodic);
  GapState state = steady.end;
  const GapMotion motion(0.6419, 0.6);
  // The state repeats after `period` periods and not earlier.
  const double position = state.position();
  const double rate = state.position_rate();
  for (int period = 1; period <= steady.period; ++period) {
    GapState moved = state;
    moved.half_period = 1;
    state = backlash::detail::state_at_next_peak(motion, moved, 0);
    const double distance = std::abs(state.position() - position) + std::abs(state.position_rate() - rate);
    if (period < steady.period) {
      EXPECT_GT(distance, 1e-6);
    } else {
      EXPECT_LT(distance, 1e-12);
    }
  }
}

TEST(SteadyState, WhatClosesWithinSixtyFourPeriodsIsAnOrbitAllElseAMean) {
  // At small restitution and weak force the mass sticks now and then, once in hundreds of periods: no orbit to rely on.
  support::Random random(9);
  int means = 0;
  for (int i = 0; i < 3000; ++i) {
    const double restitution = random.uniform(0, 0.3);
    const double gamma = random.log_uniform(0.1, 1.2);
    const SteadyState steady =
        find_steady_state(GapMotion(gamma, restitution), state_at_peak(random.unit(), random.uniform(-1, 1)), 1e-10);
    SCOPED_TRACE(testing::Message() << "gamma " << gamma << ", restitution " << restitution);
    ASSERT_LE(steady.period, 64);
    ASSERT_EQ(steady.period == 0, steady.regime == Regime::averaged);
    if (steady.regime != Regime::averaged) continue;
    ++means;
    EXPECT_TRUE(std::isfinite(steady.impacts_per_period));
    EXPECT_GT(steady.uncertainty, 0);
  }
  EXPECT_GT(means, 100);
}

// Between sticks that are many periods apart the motion amplifies rounding, as a last digit of gamma shows.
TEST(SteadyState, UncertaintyOfOrbitsThatSeldomStickHoldsWhatRoundingMakesOfThem) {
  support::Random random(77);
  int orbits = 0;
  double largest = 0;
  for (int i = 0; i < 4000; ++i) {
    const double restitution = random.uniform(0, 0.45);
    const double gamma = random.log_uniform(0.1, 0.25);
    const GapState start = state_at_peak(random.unit(), random.uniform(-1, 1));
    const SteadyState one = find_steady_state(GapMotion(gamma, restitution), start, 1e-10);
    if (one.spectral_radius != 0 || one.period < 5) continue;
    const SteadyState two = find_steady_state(GapMotion(std::nextafter(gamma, 1.0), restitution), start, 1e-10);
    if (two.period != one.period) continue;  // lost in chaos on its way, or averaged
    ++orbits;
    const double apart = std::abs(one.harmonics.u[0] - two.harmonics.u[0]);
    if (apart > 1e-6) continue;  // another orbit of that period
    largest = std::max(largest, apart);
    EXPECT_LE(apart, one.uncertainty + two.uncertainty) << "gamma " << gamma << ", restitution " << restitution;
    EXPECT_LT(one.uncertainty, 1e-6);
  }
  EXPECT_GT(orbits, 20);
  EXPECT_GT(largest, 1e-13);  // far above the rounding of one period
}

// Where the sticks are so far apart that a last digit of gamma makes another orbit, the half width of 95 % is that of
// the difference of two such means; one in twenty may be further apart, one in ten of 200 has a chance below 0.1 %.
TEST(SteadyState, UncertaintyOfOrbitsLostToRoundingHoldsTheirScatter) {
  support::Random random(5);
  constexpr int enough = 200;
  int means = 0, apart = 0;
  while (means < enough) {
    const double restitution = random.uniform(0, 0.7);
    const double gamma = random.log_uniform(0.05, 0.2);
    const GapState start = state_at_peak(random.unit(), random.uniform(-1, 1));
    const SteadyState one = find_steady_state(GapMotion(gamma, restitution), start, 1e-10);
    const SteadyState two = find_steady_state(GapMotion(std::nextafter(gamma, 1.0), restitution), start, 1e-10);
    if (one.regime != Regime::averaged || two.regime != Regime::averaged) continue;
    ++means;
    EXPECT_LE(one.uncertainty, 4 / pi) << "gamma " << gamma << ", restitution " << restitution;
    apart += std::abs(one.harmonics.u[0] - two.harmonics.u[0]) > std::hypot(one.uncertainty, two.uncertainty);
  }
  EXPECT_LT(apart, enough / 10);
}

// The same motions followed at a force a few last digits larger.  The sensitivity adds up what every impact makes of a
// disturbance without regard to sign, so it lies above what a change of the force does, by a factor of 5 to 1000 in 25
// such scenes; one in ten may be so far apart that the difference is no longer proportional to the change.
TEST(SteadyState, SensitivityOfOrbitsLostToRoundingIsThatToTheForce) {
  support::Random random(9);
  const double change = 8 * std::numeric_limits<double>::epsilon();
  int scenes = 0, above = 0, seen = 0;
  while (scenes < 10) {
    const double restitution = random.uniform(0, 0.7);
    const double gamma = random.log_uniform(0.05, 0.2);
    const GapMotion motion(gamma, restitution);
    const SteadyState steady = find_steady_state(motion, state_at_peak(random.unit(), 0), 1e-10);
    if (!(steady.force_sensitivity > 6e8 && steady.force_sensitivity < 1e11)) continue;
    ++scenes;
    const Complex one = support::long_run(motion, steady.end, 0, 1600).u1;
    const Complex two = support::long_run(GapMotion(gamma * (1 + change), restitution), steady.end, 0, 1600).u1;
    const double observed = std::abs(two - one) / change;
    above += observed > steady.force_sensitivity ? 1 : 0;
    seen += observed > 1e-4 * steady.force_sensitivity ? 1 : 0;
  }
  EXPECT_LE(above, 2);
  EXPECT_GE(seen, 8);
}

TEST(SteadyState, LongTimeMeanAgreesWithAnotherStartWithinItsUncertainty) {
  // A chaotic response: two starts give two independent means.  Each half width holds 95 % of the time, so five times
  // their sum is never left by normally distributed means (10 standard deviations of a difference).
  int averaged = 0;
  for (const double gamma : {0.85, 0.9, 1.0, 1.1, 2.0, 2.2}) {
    const GapMotion motion(gamma, 0.6);
    const SteadyState one = find_steady_state(motion, mid_gap(), 1e-10);
    const SteadyState two = find_steady_state(motion, state_at_peak(0.1, 0.3), 1e-10);
    if (one.regime != Regime::averaged || two.regime != Regime::averaged) continue;
    ++averaged;
    EXPECT_EQ(one.period, 0);
    EXPECT_GT(one.uncertainty, 1e-6);
    EXPECT_LT(one.uncertainty, 0.05);
    EXPECT_LT(std::abs(one.harmonics.u[0] - two.harmonics.u[0]), 5 * (one.uncertainty + two.uncertainty)) << gamma;
  }
  EXPECT_GE(averaged, 3);
}

TEST(SteadyState, EnergyBalanceHoldsInEveryRegime) {
  // A passive motion takes energy from the force: Im U <= 0; and |U| <= 2/pi for a motion between walls.
  support::Random random(5);
  for (int i = 0; i < 300; ++i) {
    const double gamma = random.log_uniform(0.02, 1e4);
    const double restitution = i % 10 == 0 ? 0 : random.unit();
    const SteadyState steady =
        find_steady_state(GapMotion(gamma, restitution), state_at_peak(random.unit(), random.uniform(-1, 1)), 1e-10);
    SCOPED_TRACE(testing::Message() << "gamma " << gamma << ", restitution " << restitution);
    EXPECT_LE(steady.harmonics.u[0].imag(), steady.uncertainty);
    EXPECT_LE(std::abs(steady.harmonics.u[0]), 2 / pi + steady.uncertainty);
    EXPECT_TRUE(std::isfinite(steady.uncertainty));
    if (steady.regime != Regime::averaged && steady.regime != Regime::free) {
      EXPECT_GE(steady.period, 1);
      EXPECT_LE(steady.spectral_radius, 1);
    }
  }
}

// 252 points of at most 7e5 impacts each; a hang would meet the time limit of the test runner.
TEST(SteadyState, HardCasesEnd) {
  for (const double restitution : {0.0, 1e-12, 0.9, 0.99, 0.999, 1 - 1e-12, 1.0}) {
    for (const double gamma : {1e-9, 0.25, 0.5, 1 / pi, 1.0, 10.0, 1e3, 1e5, 1e9}) {
      for (const GapState& start : {mid_gap(), state_at_peak(0, 0), state_at_peak(1, 0), state_at_peak(0, 1e-12)}) {
        // One start of each scene outlasts the transients.
        const backlash::detail::MeanGoal goal = start.distance == 0.5 ? backlash::detail::MeanGoal{} : usual_window;
        const SteadyState steady = find_steady_state(GapMotion(gamma, restitution), start, 1e-10, goal);
        SCOPED_TRACE(testing::Message() << "gamma " << gamma << ", restitution " << restitution);
        EXPECT_TRUE(std::isfinite(std::abs(steady.harmonics.u[0])));
        EXPECT_TRUE(std::isfinite(steady.uncertainty));
        EXPECT_LE(std::abs(steady.harmonics.u[0]), 2 / pi + 1e-12 + steady.uncertainty);
      }
    }
  }
}

TEST(SteadyState, TooShortAMeanSaysSo) {
  // Without dissipation a strong force makes more impacts in a few periods than are followed: the bound of |U| is all
  // that is known.
  const SteadyState steady = find_steady_state(GapMotion(1e9, 1), mid_gap(), 1e-10);
  EXPECT_EQ(steady.regime, Regime::averaged);
  EXPECT_NEAR(steady.uncertainty, 4 / pi, 1e-12);
}

TEST(SteadyState, QuantilesAreThoseOfTheVarianceRatio) {
  // The widths of the mean use tabled 95 % quantiles F(1, n) and F(2, 2n).
  for (const auto& [degrees, line, plane] :
       {std::tuple{15, 4.543077165217305, 3.3158295010135213}, {7, 5.5914478512207371, 3.7388918324407374}}) {
    EXPECT_NEAR(boost::math::quantile(boost::math::fisher_f(1, degrees), 0.95), line, 1e-10);
    EXPECT_NEAR(boost::math::quantile(boost::math::fisher_f(2, 2 * degrees), 0.95), plane, 1e-10);
  }
}

TEST(SteadyState, IntervalsOfTheMeanHoldTheirShareOfRepeats) {
  // 200 starts for each of six chaotic responses; the mean of all of them stands for the true one, good to 1/14 of the
  // scatter of one.  Of the 95 % intervals of a scene 90 to 99 % must hold; the shares themselves scatter by 1.5 % at
  // 95 %, so three standard deviations are allowed below and none are needed for all scenes together.
  const int starts = 200;
  int held_in_all = 0;
  const std::vector<std::pair<double, double>> scenes = {{0.4, 1.0}, {0.6, 0.85}, {0.6, 1.1},
                                                         {0.8, 0.9}, {0.8, 1.1},  {0.9, 1.0}};
  for (const auto& [restitution, gamma] : scenes) {
    SCOPED_TRACE(testing::Message() << "restitution " << restitution << ", gamma " << gamma);
    support::Random random(17);
    std::vector<SteadyState> repeats;
    Complex mean = 0;
    for (int i = 0; i < starts; ++i) {
      const GapState start = state_at_peak(random.unit(), random.uniform(-0.5, 0.5));
      repeats.push_back(find_steady_state(GapMotion(gamma, restitution), start, 1e-10, usual_window));
      ASSERT_EQ(repeats.back().regime, Regime::averaged);
      mean += repeats.back().harmonics.u[0] / static_cast<double>(starts);
    }
    int held = 0;
    for (const SteadyState& one : repeats) held += std::abs(one.harmonics.u[0] - mean) <= one.uncertainty ? 1 : 0;
    EXPECT_GE(held, 0.855 * starts);
    held_in_all += held;
  }
  EXPECT_GE(held_in_all, 0.90 * starts * static_cast<double>(scenes.size()));
  EXPECT_LE(held_in_all, 0.99 * starts * static_cast<double>(scenes.size()));
}

// Growth rate per period of the distance of two neighbouring motions, brought back to 1e-9 every few impacts.
double growth_of_distance(const GapMotion& motion, GapState one) {
  const double small = 1e-9;
  for (int i = 0; i < 500; ++i) {
    const Flight flight = motion.next_flight(one);
    one = motion.after_impact(one, flight);
  }
  GapState two = one;
  two.velocity += small;
  double growth = 0;
  double begin = static_cast<double>(one.half_period) / 2;
  double periods = 0;
  for (int round = 0; round < 3000; ++round) {
    for (int i = 0; i < 3; ++i) {
      const Flight first = motion.next_flight(one);
      one = motion.after_impact(one, first);
      const Flight second = motion.next_flight(two);
      two = motion.after_impact(two, second);
    }
    const double phase = static_cast<double>(two.half_period - one.half_period) * pi + two.s - one.s;
    const double velocity = two.velocity - one.velocity;
    const double distance = std::abs(phase) + std::abs(velocity);
    const double now = static_cast<double>(one.half_period) / 2;
    const bool together = one.wall == two.wall && distance < 1e-4 && distance > 0;
    two = one;
    if (together) {
      growth += std::log(distance / small);
      backlash::detail::advance_phase(two, phase * small / distance);
      two.velocity += velocity * small / distance;
      if (two.velocity < 0) two.velocity = one.velocity;
      periods += now - begin;
    } else {
      two.velocity += small;
    }
    begin = now;
  }
  return growth / periods;
}

TEST(SteadyState, LyapunovExponentTellsChaosFromOrbitsAndSlowTransients) {
  for (const auto& [restitution, gamma] : {std::pair{0.6, 0.85}, {0.6, 1.1}, {0.8, 0.85}, {0.4, 1.0}}) {
    SCOPED_TRACE(testing::Message() << "restitution " << restitution << ", gamma " << gamma);
    const SteadyState chaotic = find_steady_state(GapMotion(gamma, restitution), mid_gap(), 1e-10);
    ASSERT_EQ(chaotic.regime, Regime::averaged);
    EXPECT_GT(chaotic.lyapunov, 0.2);
  }
  for (const double gamma : {0.3, 0.45, 0.82493}) {
    const SteadyState orbit = find_steady_state(GapMotion(gamma, 0.6), mid_gap(), 1e-10);
    ASSERT_GE(orbit.period, 1);
    EXPECT_NEAR(orbit.lyapunov, std::log(orbit.spectral_radius) / orbit.period, 1e-14);
    EXPECT_LT(orbit.lyapunov, 0);
  }
  EXPECT_EQ(find_steady_state(GapMotion(1e4, 0.6), mid_gap(), 1e-10).lyapunov,
            -std::numeric_limits<double>::infinity());
  // Nearly without dissipation next to the two-impact orbit: its multipliers have modulus e^2, so nothing has settled
  // after a thousand periods, but nothing grows either; a disturbance turns around with a shear that grows like the
  // logarithm of the time over the time, below ln(1e3 periods)/1e3 = 0.007.
  for (const double restitution : {1 - 1e-7, 1.0}) {
    const auto orbit = backlash::detail::symmetric_two_impact_orbit(0.3, restitution).value();
    GapState start = backlash::detail::state_at_next_peak(GapMotion(0.3, restitution), orbit.start, 0);
    start.velocity += 1e-3;
    const SteadyState slow = find_steady_state(GapMotion(0.3, restitution), start, 1e-10);
    EXPECT_LT(std::abs(slow.lyapunov), 0.02) << restitution;
  }
}

TEST(SteadyState, LyapunovExponentIsTheGrowthOfADistance) {
  for (const auto& [restitution, gamma] : {std::pair{0.6, 0.85}, {0.6, 1.1}}) {
    const GapMotion motion(gamma, restitution);
    const SteadyState chaotic = find_steady_state(motion, mid_gap(), 1e-10);
    // Two means over some thousand periods, each known to about 5 % (their spread over starts).
    EXPECT_NEAR(chaotic.lyapunov / growth_of_distance(motion, mid_gap()), 1, 0.2) << gamma;
  }
}

TEST(SteadyState, WorkOfTheForceEqualsTheLossesInEveryRegime) {
  support::Random random(23);
  int averaged = 0;
  for (int i = 0; i < 400; ++i) {
    const double gamma = random.log_uniform(0.05, i % 2 == 0 ? 3 : 1e6);
    const double restitution = i % 10 == 0 ? 0 : i % 17 == 0 ? 1 : random.unit();
    const SteadyState steady =
        find_steady_state(GapMotion(gamma, restitution), state_at_peak(random.unit(), random.uniform(-1, 1)), 1e-10);
    averaged += steady.regime == Regime::averaged ? 1 : 0;
    if (std::isnan(steady.energy_defect)) continue;  // not one period could be followed
    // Roundings of sums of velocity jumps, which exceed their result at strong forces by gamma^(2/3) or so, and the
    // closure of the orbit to tolerance/1000 where a chatter is cut off, in units of |U| ~ gamma^(-1/3).
    EXPECT_LT(steady.energy_defect, 1e-10)
        << "gamma " << gamma << ", restitution " << restitution << " " << to_string(steady.regime);
  }
  EXPECT_GT(averaged, 20);
}

TEST(SteadyState, FreeMotionIsRecognised) {
  const SteadyState steady = find_steady_state(GapMotion(0.2, 0.6), mid_gap(), 1e-10);
  EXPECT_EQ(steady.regime, Regime::free);
  EXPECT_EQ(steady.harmonics.u[0], -0.2);
  EXPECT_EQ(steady.harmonics.u1_plus_gamma, 0.0);
  EXPECT_EQ(steady.impacts_per_period, 0);
}

// Chaotic transients at high restitution, which last up to 10^5 force periods.  An interval of 95 % may miss; of twelve
// scenes, of which a third at least are on closed orbits, more than one does with a probability of 2 %.
TEST(SteadyState, StatedIntervalsHoldTheMotionAfterAHundredThousandPeriods) {
  for (const bool early : {false, true}) {
    const support::Tally tally = support::transients(12, 5, early);
    EXPECT_LE(tally.missed, 1) << early;
    EXPECT_GE(tally.closed, 3) << early;
  }
}

// Scenes of transients of some thousand periods, found by following them: the value is that of the orbit they end on.
// Those of the first scene last 4800 periods in the mean and are followed for 9056, so that each start outlasts that
// with a probability of e^-1.9 = 0.15: more than 8 of 20 do in one case of 300.  A window of 1024 periods would call 16
// of 20 averaged.
TEST(SteadyState, TransientChaosEndsOnItsOrbit) {
  for (const auto& [restitution, gamma] : {std::pair{0.83567, 1 / (1.07504 * 1.07504)},
                                           {0.95209, 1 / (0.65087 * 0.65087)},
                                           {0.97404, 1 / (1.1619 * 1.1619)}}) {
    const GapMotion motion(gamma, restitution);
    support::Random random(3);
    int averaged = 0;
    for (int i = 0; i < 20; ++i) {
      averaged += find_steady_state(motion, state_at_peak(random.unit(), 0), 1e-10).regime == Regime::averaged ? 1 : 0;
    }
    EXPECT_LE(averaged, 8) << restitution;
    const SteadyState quick = find_steady_state(motion, mid_gap(), 1e-10, {0.05, -gamma});
    EXPECT_TRUE(quick.regime != Regime::averaged || quick.transient_possible) << restitution;
  }
}

// Beside a pitchfork the orbit attracts as the cube of the distance: what Newton's iteration finds there is compared
// with the closed form.  1e-12: the closed form's own rounding, amplified where the two branches meet.
TEST(SteadyState, OrbitsBesideAPitchforkAreClosed) {
  const support::Tally tally = support::pitchforks(200, 11);
  EXPECT_EQ(tally.averaged, 0);
  EXPECT_EQ(tally.missed, 0);
  EXPECT_GT(tally.scenes, 150);
}

// From mid-gap at rest the wall is just reached at gamma = 1/4.  Just above, the first impact is slow and the flight
// after it outlasts any window: what follows it is the steady state, as from any other start.
TEST(SteadyState, AFlightAsLongAsTheWindowIsPartOfTheTransient) {
  for (const double restitution : {0.3, 0.55, 0.7}) {
    for (const double above : {1e-13, 3e-12, 1e-11, 1e-10}) {
      const double gamma = 0.25 * (1 + above);
      const GapMotion motion(gamma, restitution);
      GapState state = mid_gap();
      double longest = 0;
      for (int i = 0; i < 8; ++i) {
        const Flight flight = motion.next_flight(state);
        ASSERT_TRUE(flight.hits);
        longest = std::max(longest, flight.duration);
        state = motion.after_impact(state, flight);
      }
      EXPECT_GT(longest, 2 * pi * 1000);
      const SteadyState steady = find_steady_state(motion, mid_gap(), 1e-10);
      const support::LongRun truth = support::long_run(motion, state, 2000, 1600);
      EXPECT_GT(steady.impacts_per_period, 0);
      // A mean over 1600 periods of an orbit keeps its ends, of the order of one over them.
      EXPECT_LT(std::abs(steady.harmonics.u[0] - truth.u1), steady.uncertainty + truth.uncertainty + 1e-3)
          << restitution << ' ' << above;
    }
  }
}

// A chaotic transient of 1370 periods that ends in a rest, just where the window of a mean would be complete: a window
// that took in the rest, which velocity jumps do not describe, would miss the energy balance by 1e-4.  The answer is
// the orbit from stick to stick; the value of the long run keeps the ends of its 1600 periods.
TEST(SteadyState, ARestThatWouldCompleteTheWindowIsNotAveraged) {
  const GapMotion motion(0.052740162622693779, 0.65607500384894935);
  const GapState start = motion.peak_state(0, {0.19124678008476992, -0.74617883688218312});
  const SteadyState steady = find_steady_state(motion, start, 1e-10, {0.01, -motion.gamma()});
  EXPECT_EQ(steady.regime, Regime::chatter);
  EXPECT_EQ(steady.period, 7);
  EXPECT_LT(steady.energy_defect, 1e-10);
  const support::LongRun truth = support::long_run(motion, start, 2000, 1600);
  EXPECT_LT(std::abs(steady.harmonics.u[0] - truth.u1), steady.uncertainty + truth.uncertainty + 1e-3);
}

}  // namespace
