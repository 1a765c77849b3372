// SPDX-License-Identifier: BSD-3-Clause
// Commands that answer one question in different ways agree, over random scenes, plants and models.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdint>
#include <cstdlib>
#include <numbers>
#include <string>
#include <vector>

#include "backlash/basins.hpp"
#include "backlash/describing_function.hpp"
#include "backlash/orbit_continuation.hpp"
#include "frac/identification/tune.hpp"
#include "frac/laplace_value.hpp"
#include "frac/model/algebra.hpp"
#include "frac/stability.hpp"
#include "frac/state_space.hpp"
#include "frac/time_response/reference_response.hpp"
#include "support/dense_maximum.hpp"
#include "support/honest_scenes.hpp"
#include "support/random.hpp"

namespace {

using Complex = std::complex<double>;
using frac::FractionalTransferFunction;

constexpr double pi = std::numbers::pi;
constexpr double degree = pi / 180;

std::uint64_t number_in_environment(const char* name, std::uint64_t otherwise) {
  const char* const text = std::getenv(name);
  return text == nullptr ? otherwise : std::strtoull(text, nullptr, 10);
}

int cases(int usual) {
  return usual * static_cast<int>(number_in_environment("FRACFIT_PROPERTY_FACTOR", 1));
}
support::Random random_of(std::uint64_t property) {
  return support::Random(1000 * number_in_environment("FRACFIT_PROPERTY_SEED", 1) + property);
}

// What basins finds orbits follows where asked, and a sweep that begins at one of the starts is on the attractor of
// that start.  Intervals of means hold their value with 95 % each, so that one pair in ten may differ by more than
// both; a motion that wanders long may settle in one command and not in the other, which then says so.
TEST(CommandsAgree, OrbitsAndSimulateFindWhatBasinsFinds) {
  support::Random random = random_of(1);
  int closed = 0, missed = 0, averaged = 0, apart = 0;
  for (int scene = 0; scene < cases(4); ++scene) {
    const double restitution = random.uniform(0.2, 0.9);
    const double omega = random.log_uniform(0.9, 4);
    const backlash::TwoMassSystem system(random.log_uniform(0.1, 10), 1, 1, restitution);
    SCOPED_TRACE("restitution " + std::to_string(restitution) + ", omega " + std::to_string(omega));
    // Every fourth of the starts that orbits takes from basins, in either direction.
    std::vector<double> position, velocity;
    for (int i = 0; i <= 10; ++i) {
      position.push_back(i / 10.0);
      velocity.push_back(omega * (i / 5.0 - 1));
    }
    const backlash::BasinMap map = backlash::basins(system, 1, omega, position, velocity);
    backlash::OrbitContinuationOptions options;
    options.basins_at = {omega};
    const auto diagram = backlash::orbit_diagram(system, 1, omega / 1.03, omega * 1.03, options);
    for (const backlash::Attractor& attractor : map.attractors) {
      const auto& point = attractor.point;
      const bool without_rests =
          point.regime == backlash::Regime::periodic || point.regime == backlash::Regime::symmetric;
      const int impacts = static_cast<int>(std::lround(point.impacts_per_period * point.period));
      if (!without_rests || point.period > options.longest_period || impacts > options.most_impacts) continue;
      ++closed;
      if (!support::lists(diagram, omega, {point.period, impacts, {}, {}}, point.value)) ++missed;
    }
    backlash::SweepOptions from_mid_gap;
    from_mid_gap.protocol = backlash::Protocol::mid_gap_at_rest;
    const auto point = backlash::describing_function_sweep(system, 1, {omega}, from_mid_gap).points.front();
    const auto& same = map.at(5, 5).point;
    if (point.regime == backlash::Regime::averaged || same.regime == backlash::Regime::averaged) {
      ++averaged;
      if (!point.transient_possible && std::abs(point.value - same.value) > point.uncertainty + same.uncertainty)
        ++apart;
    } else {
      EXPECT_EQ(point.regime, same.regime);
      EXPECT_EQ(point.period, same.period);
      // Orbits of one attractor agree to 1e-6 in their phasors, here of the order of N times mass times omega squared.
      EXPECT_LE(std::abs(point.value - same.value), point.uncertainty + same.uncertainty + 1e-6 * std::abs(same.value));
    }
  }
  EXPECT_GE(closed, cases(3));
  EXPECT_LE(missed, closed / 100);
  EXPECT_LE(apart, 1 + averaged / 10);
}

FractionalTransferFunction random_plant(support::Random& random) {
  const auto number = [&](double from, double to) { return std::to_string(random.log_uniform(from, to)); };
  std::string formula = number(0.2, 5);
  if (random.unit() < 0.4) formula += " exp(-" + number(0.01, 0.5) + " s)";
  formula += "/((" + number(0.2, 5) + " s^" + number(0.5, 1.5) + " + 1)";
  if (random.unit() < 0.5) formula += " (" + number(0.05, 1) + " s + 1)";
  return FractionalTransferFunction::parse(formula + ")");
}

// What tune says of its loop, against analyse's roots and against the response of the loop evaluated from the gains.
TEST(CommandsAgree, TuneDescribesItsLoopAsAnalyseDoes) {
  support::Random random = random_of(2);
  int met = 0;
  for (int i = 0; i < cases(6); ++i) {
    const FractionalTransferFunction plant = random_plant(random);
    const double crossover = random.log_uniform(0.3, 3);
    const double margin = random.uniform(40, 75) * degree;
    SCOPED_TRACE(plant.formula() + ", crossover " + std::to_string(crossover) + ", margin " + std::to_string(margin));
    const frac::TuningResult result = frac::tune(plant, {.crossover = crossover, .phase_margin = margin});
    const FractionalTransferFunction loop = plant * frac::controller_transfer_function(result.gains);
    const frac::Margins exact = frac::margins(loop);
    if (exact.remark.empty()) {
      EXPECT_EQ(result.gain_margin, exact.gain_margin);
      EXPECT_EQ(result.other_crossovers.size() + 1, exact.phase.size());
    }
    EXPECT_EQ(result.closed_loop, frac::analyse_closed_loop(loop).stability);
    if (result.status != frac::TuningStatus::met) continue;
    ++met;
    EXPECT_EQ(result.closed_loop, frac::Stability::stable);
    const auto at = [&](double omega) {
      const Complex s(0, omega);
      const frac::FractionalPidGains& g = result.gains;
      return plant.response(omega) * (g.kp + g.ki * std::pow(s, -g.lambda) + g.kd * std::pow(s, g.mu));
    };
    // Rounding of powers and of the linear equations for the gains.
    EXPECT_NEAR(std::abs(at(result.crossover)), 1, 1e-9);
    EXPECT_NEAR(std::remainder(std::arg(at(result.crossover)) + pi - result.phase_margin, 2 * pi), 0, 1e-9);
    // A term of less than 1e-9 of the loop is left out; it moves the crossover by that over the slope of |L| against
    // log w, and the phase there by its own slope times as much: both slopes are of the order of 1.
    EXPECT_NEAR(result.crossover / crossover, 1, 1e-8);
    EXPECT_NEAR(result.phase_margin, margin, 1e-8);
    const double s =
        support::dense_maximum([&](double omega) { return 1 / std::abs(1.0 + at(omega)); }, 1e-4, 1e4, 0.001);
    const double t =
        support::dense_maximum([&](double omega) { return std::abs(at(omega) / (1.0 + at(omega))); }, 1e-4, 1e4, 0.001);
    // The grid misses less than 1e-6 of a peak of a quality below 1000; suprema at its ends lie beyond it.
    EXPECT_LE(s, result.max_sensitivity * (1 + 1e-9));
    EXPECT_LE(t, result.max_complementary_sensitivity * (1 + 1e-9));
    const auto is_within = [](double omega) { return omega > 1e-4 && omega < 1e4; };
    if (is_within(result.omega_max_sensitivity)) {
      EXPECT_GE(s, result.max_sensitivity * (1 - 1e-6));
    }
    if (is_within(result.omega_max_complementary_sensitivity)) {
      EXPECT_GE(t, result.max_complementary_sensitivity * (1 - 1e-6));
    }
  }
  EXPECT_GE(met, cases(3));
}

// Response of sum r/(s - p) to a unit step.
double step_response(const frac::RationalModel& system, double t) {
  Complex sum = system.direct;
  for (const frac::Mode& mode : system.modes) {
    const Complex part = mode.residues.front() * (std::exp(mode.pole * t) - 1.0) / mode.pole;
    sum += mode.pole.imag() == 0 ? part : 2 * part.real();
  }
  return sum.real();
}

// A realised model H keeps the error that it states between the points of its grid, and its step response that of G as
// nearly as follows.  The difference at t is the integral of (H - G) e^{st}/s along Re s = 1/t.  There |H/G - 1| is at
// most 1.2 times what it is on the band, from 1e-5 to 1e7: log |H/G - 1| lies below the harmonic function with the same
// values on the axis, of which the rest of the axis holds a share of 0.007 at |s| < 1e5, and that raises even 1e-9 by
// no more than a fifth.  Beyond 1e5 |H| is less than 2 |G| but for the constant H(infinity), whose step is itself.
TEST(CommandsAgree, RealisedModelsRespondAsTheModelDoesWithinTheStatedError) {
  support::Random random = random_of(3);
  constexpr double most = 1e5;
  int compared = 0;
  for (int i = 0; i < cases(6); ++i) {
    const auto number = [&](double from, double to) { return std::to_string(random.log_uniform(from, to)); };
    std::string formula = number(0.2, 5);
    if (random.unit() < 0.5) {
      const double order = random.uniform(0.2, 0.8);
      formula += " (" + number(0.1, 3) + " s^" + std::to_string(order) + " + 1)/(" + number(0.2, 5) + " s^" +
                 std::to_string(order + random.uniform(0.8, 1)) + " + " + number(0.2, 5) + " s^" +
                 std::to_string(0.9 * order) + " + 1)";
    } else {
      formula += "/(" + number(0.2, 5) + " s^" + number(0.8, 1.6) + " + 1)";
    }
    SCOPED_TRACE(formula);
    const FractionalTransferFunction model = FractionalTransferFunction::parse(formula);
    const frac::RationalModel system = frac::realise(model, {1e-5, 1e7}, random.log_uniform(1e-3, 3e-2));
    if (!system.usable() || !system.stable || !system.series.empty()) continue;
    if (std::ranges::any_of(system.modes, [](const frac::Mode& mode) { return mode.residues.size() > 1; })) continue;
    ++compared;
    const double stated = system.max_relative_error;
    for (int k = 0; k < 200; ++k) {
      const double omega = random.log_uniform(1e-5, 1e7);
      ASSERT_LE(std::abs(system.response(omega) / model.response(omega) - 1.0), 1.01 * stated) << omega;
    }
    const frac::ReferenceResponse exact(model);
    for (const double t : {0.1, 1.0, 7.0}) {
      // Trapezoids in ln omega, a hundred to a decade, of a smooth function.
      double sum = 0;
      const double step = std::log(10.0) / 100;
      for (double omega = 1e-3 / t; omega < most; omega *= std::exp(step)) {
        const Complex s(1 / t, omega);
        sum += step * omega * std::abs(frac::laplace_value(model, s) / s);
      }
      // Falls at least as s^-0.8 there.
      const double beyond = 3 * std::abs(model.response(most)) / 0.8;
      const double bound = std::numbers::e / pi * (1.2 * stated * sum + beyond) + std::abs(system.direct);
      EXPECT_NEAR(step_response(system, t), exact(t).value, 1.01 * bound) << t;
      EXPECT_LT(bound, 0.3 * std::abs(exact(t).value) + 100 * stated);
    }
  }
  EXPECT_GE(compared, cases(4));
}

}  // namespace
