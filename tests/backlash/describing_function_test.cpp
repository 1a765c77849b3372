// SPDX-License-Identifier: BSD-3-Clause
#include "backlash/describing_function.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <limits>
#include <numbers>

#include "backlash/static_backlash.hpp"
#include "support/expect_invalid_argument.hpp"
#include "support/random.hpp"
#include "support/reference_table.hpp"
#include "support/relative_error.hpp"

namespace {

using backlash::describing_function_sweep;
using backlash::describing_function_sweeps;
using backlash::DescribingFunctionPoint;
using backlash::DescribingFunctionSweep;
using backlash::Output;
using backlash::Protocol;
using backlash::Regime;
using backlash::SweepOptions;
using backlash::TwoMassSystem;
using support::expect_invalid_argument;
using support::log_grid;
using support::relative_error;
using Complex = std::complex<double>;

constexpr double pi = std::numbers::pi;
constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();

bool same(const DescribingFunctionPoint& a, const DescribingFunctionPoint& b) {
  const auto equal = [](double x, double y) { return x == y || (std::isnan(x) && std::isnan(y)); };
  return a.omega == b.omega && a.value == b.value && a.regime == b.regime && a.period == b.period &&
         equal(a.impacts_per_period, b.impacts_per_period) && equal(a.uncertainty, b.uncertainty) &&
         equal(a.third_harmonic_ratio, b.third_harmonic_ratio);
}

TEST(DescribingFunction, AgreesWithTheReferenceOrbitsForBothOutputsAndAnyMasses) {
  support::Random random(2);
  for (const auto& row : support::reference_table("df_orbits.csv")) {
    for (int i = 0; i < 5; ++i) {
      const TwoMassSystem system(random.log_uniform(0.1, 10), random.log_uniform(0.1, 10), random.log_uniform(1e-3, 10),
                                 row[0]);
      const double force = random.log_uniform(1e-2, 1e3);
      const double gamma = row[1];
      const double omega = std::sqrt(force / (system.mass2() * system.clearance() * gamma));
      const double inertia = (system.mass1() + system.mass2()) * omega * omega;
      const Complex u(row[2], row[3]);
      for (const Output output : {Output::x1, Output::x2}) {
        SweepOptions options;
        options.protocol = Protocol::mid_gap_at_rest;
        options.output = output;
        const DescribingFunctionPoint point = describing_function_sweep(system, force, {omega}, options).points.front();
        const double share = output == Output::x1 ? -1 : system.mass1() / system.mass2();
        const Complex expected = (-1.0 + share * u / gamma) / inertia;
        // gamma is rounded here, and its change moves U by at most a few times as much.
        EXPECT_LT(relative_error(point.value, expected), 1e-12) << row[0] << ", " << gamma;
        EXPECT_LE(std::abs(point.value - expected), point.uncertainty + 1e-14 * std::abs(expected));
        const double third = std::abs(share * Complex(row[4], row[5]) / gamma) / (std::abs(expected) * inertia);
        EXPECT_NEAR(point.third_harmonic_ratio, third, 1e-11 * (1 + std::abs(share) / (std::abs(expected) * inertia)));
      }
    }
  }
}

TEST(DescribingFunction, IsPassive) {
  // Im N1 >= 0 >= Im N2, and the masses exchange what flows: Im N1 = -(M2/M1) Im N2.
  const TwoMassSystem system(2, 0.5, 0.3, 0.6);
  SweepOptions options;
  const std::vector<double> omega = log_grid(0.5, 60, 150);
  const auto first = describing_function_sweep(system, 40, omega, options).points;
  options.output = Output::x2;
  const auto second = describing_function_sweep(system, 40, omega, options).points;
  for (std::size_t i = 0; i < omega.size(); ++i) {
    EXPECT_GE(first[i].value.imag(), -first[i].uncertainty);
    EXPECT_LE(second[i].value.imag(), second[i].uncertainty);
    // The same motion seen twice, in two formulas that round apart.
    EXPECT_NEAR(first[i].value.imag(), -0.25 * second[i].value.imag(), 1e-14 * std::abs(second[i].value));
  }
}

TEST(DescribingFunction, CollapsesUnderSimilarity) {
  // (M1 + M2) omega^2 N depends on gamma and restitution only.  Powers of two scale without rounding, so a whole sweep,
  // chaotic points included, agrees to the last bit.
  const std::vector<double> unit = log_grid(0.3, 4, 80);
  const auto scaled_sweep = [&](double mass, double clearance, double force) {
    const double scale = std::sqrt(force / (mass * clearance));
    std::vector<double> omega;
    for (const double c : unit) omega.push_back(c * scale);
    return describing_function_sweep({mass, mass, clearance, 0.6}, force, omega).points;
  };
  const auto reference = scaled_sweep(1, 1, 1);
  const auto scaled = scaled_sweep(4, 0.25, 16);
  for (std::size_t i = 0; i < unit.size(); ++i) {
    const auto collapsed = [](const DescribingFunctionPoint& point, double mass) {
      return 2 * mass * point.omega * point.omega * point.value;
    };
    EXPECT_EQ(collapsed(reference[i], 1), collapsed(scaled[i], 4)) << i;
    EXPECT_EQ(reference[i].regime, scaled[i].regime) << i;
  }
}

TEST(DescribingFunction, RandomScenesWithOneGammaGiveOneResponse) {
  support::Random random(21);
  for (int i = 0; i < 60; ++i) {
    const double gamma = random.log_uniform(0.1, 1e3);
    const double restitution = random.unit();
    SweepOptions options;
    options.protocol = i % 2 == 0 ? Protocol::mid_gap_at_rest : Protocol::contact_at_rest;
    Complex first = 0;
    double first_uncertainty = 0;
    for (int scene = 0; scene < 3; ++scene) {
      const double mass1 = random.log_uniform(0.1, 10);
      const double mass2 = random.log_uniform(0.1, 10);
      const double clearance = random.log_uniform(1e-6, 10);
      const double force = random.log_uniform(1e-3, 1e3);
      const double omega = std::sqrt(force / mass2 / clearance / gamma);
      const auto point =
          describing_function_sweep({mass1, mass2, clearance, restitution}, force, {omega}, options).points.front();
      if (point.period == 0) break;  // chaos amplifies the rounding of gamma
      const double inertia = (mass1 + mass2) * omega * omega;
      const Complex collapsed = point.value * inertia;
      const double uncertainty = point.uncertainty * inertia;
      if (scene == 0) {
        first = collapsed;
        first_uncertainty = uncertainty;
      } else {
        // gamma itself differs by a few roundings, which move the response as much as the state.
        EXPECT_LE(std::abs(collapsed - first), 2 * (uncertainty + first_uncertainty) + 1e-13)
            << gamma << ", " << restitution;
      }
    }
  }
}

TEST(DescribingFunction, DoesNotDependOnTheNumberOfThreads) {
  const std::vector<double> omega = log_grid(5, 35, 40);
  std::vector<backlash::SweepScene> scenes;
  for (const double restitution : {0.0, 0.2, 0.6, 0.8, 1.0})
    scenes.push_back({TwoMassSystem(1, 1, 0.3, restitution), 40});
  for (const Protocol protocol : {Protocol::sweep_up, Protocol::sweep_down, Protocol::contact_at_rest,
                                  Protocol::mid_gap_at_rest, Protocol::two_impact}) {
    SweepOptions options;
    options.protocol = protocol;
    options.threads = 1;
    const auto serial = describing_function_sweeps(scenes, omega, options);
    for (const int threads : {0, 2, 3, 7}) {
      options.threads = threads;
      const auto parallel = describing_function_sweeps(scenes, omega, options);
      ASSERT_EQ(parallel.size(), serial.size());
      for (std::size_t i = 0; i < serial.size(); ++i) {
        for (std::size_t j = 0; j < omega.size(); ++j) {
          EXPECT_TRUE(same(serial[i].points[j], parallel[i].points[j])) << to_string(protocol) << ' ' << i << ' ' << j;
        }
      }
    }
    // A family is its curves.
    const auto alone = describing_function_sweep(scenes[2].system, 40, omega, options);
    for (std::size_t j = 0; j < omega.size(); ++j) EXPECT_TRUE(same(alone.points[j], serial[2].points[j]));
  }
}

TEST(DescribingFunction, CountsItsProgress) {
  frac::Progress progress;
  const std::vector<double> omega = log_grid(5, 35, 12);
  (void)describing_function_sweeps({{TwoMassSystem(1, 1, 0.3, 0.6), 40}, {TwoMassSystem(1, 1, 0.3, 0.2), 40}}, omega,
                                   {}, &progress);
  EXPECT_EQ(progress.done, 24u);
  EXPECT_EQ(progress.total, 24u);
}

TEST(DescribingFunction, RigidAndFreeLimitsAreExact) {
  const auto rigid = describing_function_sweep({1, 3, 0, 0.6}, 40, {1, 10}).points;
  for (const auto& point : rigid) {
    EXPECT_EQ(point.regime, Regime::rigid);
    EXPECT_DOUBLE_EQ(point.value.real(), -1 / (4 * point.omega * point.omega));
    EXPECT_EQ(point.value.imag(), 0);
    EXPECT_EQ(point.third_harmonic_ratio, 0);
  }
  SweepOptions options;
  options.protocol = Protocol::mid_gap_at_rest;
  auto free = describing_function_sweep({1, 3, 0.3, 0.6}, 40, {1e3}, options).points.front();
  EXPECT_EQ(free.regime, Regime::free);
  EXPECT_EQ(free.value, 0.0);
  // Tables would show the sign as -0.
  EXPECT_FALSE(std::signbit(free.value.real()) || std::signbit(free.value.imag()));
  EXPECT_TRUE(std::isnan(free.third_harmonic_ratio));
  options.output = Output::x2;
  free = describing_function_sweep({1, 3, 0.3, 0.6}, 40, {1e3}, options).points.front();
  EXPECT_NEAR(free.value.real() * 3e6, -1, 1e-15);
  EXPECT_EQ(free.third_harmonic_ratio, 0);
}

TEST(DescribingFunction, ThresholdsOfTheRestProtocolsAreExact) {
  // From contact at rest impacts begin below w_L = sqrt 2, from mid-gap at rest below 2, in units of sqrt(F/(M2
  // clearance)).
  const TwoMassSystem system(1, 1, 1, 0.6);
  SweepOptions options;
  options.protocol = Protocol::contact_at_rest;
  auto points =
      describing_function_sweep(system, 1, {std::sqrt(2.0) * (1 - 1e-9), std::sqrt(2.0) * (1 + 1e-9), 3}, options)
          .points;
  EXPECT_NE(points[0].regime, Regime::free);
  EXPECT_EQ(points[1].regime, Regime::free);
  EXPECT_EQ(points[2].regime, Regime::free);
  options.protocol = Protocol::mid_gap_at_rest;
  points = describing_function_sweep(system, 1, {2 * (1 - 1e-9), 2 * (1 + 1e-9)}, options).points;
  EXPECT_NE(points[0].regime, Regime::free);
  EXPECT_EQ(points[1].regime, Regime::free);
}

TEST(DescribingFunction, LowFrequencyResponseHasTheTwoThirdsAndFourteenThirdsSlopes) {
  const TwoMassSystem system(1, 1, 0.3, 0.6);
  const auto points = describing_function_sweep(system, 40, {1e-4, 1e-3}).points;
  const double slope = std::log10(points[1].value.imag() / points[0].value.imag());
  const auto inverse = [](Complex value) { return (-1.0 / value).imag(); };
  // The correction is of relative order gamma^(-2/3) = 1e-5.
  EXPECT_NEAR(slope, 2.0 / 3, 2e-5);
  EXPECT_NEAR(std::log10(inverse(points[1].value) / inverse(points[0].value)), 14.0 / 3, 2e-5);
}

TEST(DescribingFunction, SweepsInBothDirectionsDifferOnlyWhereTheMotionIsBistable) {
  const TwoMassSystem system(1, 1, 0.3, 0.6);
  const double unit = std::sqrt(40 / 0.3);
  SweepOptions options;
  const auto omega = log_grid(1.2 * unit, 1.7 * unit, 120);
  const auto up = describing_function_sweep(system, 40, omega, options).points;
  options.protocol = Protocol::sweep_down;
  const auto down = describing_function_sweep(system, 40, omega, options).points;
  bool differs = false;
  for (std::size_t i = 0; i < omega.size(); ++i) {
    const double c = omega[i] / unit;
    const bool different = std::abs(up[i].value - down[i].value) > 1e-3 * std::abs(up[i].value);
    differs = differs || different;
    if (c > 1.45) {
      EXPECT_EQ(up[i].impacts_per_period, 2) << c;
      EXPECT_FALSE(different) << c;
    }
  }
  EXPECT_TRUE(differs);
  EXPECT_EQ(up.back().regime, Regime::symmetric);
}

TEST(DescribingFunction, TwoImpactProtocolFollowsTheOrbitUpToTheSaddleNode) {
  const TwoMassSystem system(1, 1, 1, 0.4);
  SweepOptions options;
  options.protocol = Protocol::two_impact;
  // c_sn = 2.75651, c_sb = 1.56030, loss at 1.36971.
  const auto points = describing_function_sweep(system, 1, {1.369, 1.3700, 1.55, 1.57, 2.7565, 2.757}, options).points;
  EXPECT_NE(points[0].impacts_per_period, 2);
  EXPECT_EQ(points[1].regime, Regime::periodic);
  EXPECT_EQ(points[1].impacts_per_period, 2);
  EXPECT_EQ(points[2].regime, Regime::periodic);
  EXPECT_EQ(points[3].regime, Regime::symmetric);
  EXPECT_EQ(points[4].regime, Regime::symmetric);
  EXPECT_NE(points[5].regime, Regime::symmetric);
  // A sweep that follows its own state meets the same orbit or its mirror twin, which has the same |U_1|.
  options.protocol = Protocol::sweep_down;
  const auto followed = describing_function_sweep(system, 1, {1.45, 1.5, 1.55, 1.6, 1.7}, options).points;
  options.protocol = Protocol::two_impact;
  const auto orbit = describing_function_sweep(system, 1, {1.45, 1.5, 1.55, 1.6, 1.7}, options).points;
  for (std::size_t i = 0; i < orbit.size(); ++i) EXPECT_LT(relative_error(followed[i].value, orbit[i].value), 1e-11);
}

TEST(DescribingFunction, LooserTolerancesStayWithinThem) {
  for (const double tolerance : {1e-3, 1e-5, 1e-7, 1e-13}) {
    for (const auto& row : support::reference_table("df_orbits.csv")) {
      const double omega = 1 / std::sqrt(row[1]);
      SweepOptions options;
      options.protocol = Protocol::mid_gap_at_rest;
      options.tolerance = tolerance;
      const auto point = describing_function_sweep({1, 1, 1, row[0]}, 1, {omega}, options).points.front();
      const Complex expected = -(1.0 + Complex(row[2], row[3]) / row[1]) / (2 * omega * omega);
      EXPECT_LE(std::abs(point.value - expected), 10 * tolerance * std::abs(expected) + 1e-13)
          << row[1] << ' ' << tolerance;
    }
  }
}

TEST(DescribingFunction, HardScenesGiveFiniteValues) {
  for (const double clearance : {1e-12, 1.0, 1e6}) {
    for (const double ratio : {1e-9, 1.0, 1e9}) {
      for (const double omega : {1e-9, 1.0, 1e9}) {
        for (const double restitution : {0.0, 1e-12, 0.6, 1.0}) {
          for (const Output output : {Output::x1, Output::x2}) {
            SweepOptions options;
            options.output = output;
            const auto point =
                describing_function_sweep({ratio, 1, clearance, restitution}, 40, {omega}, options).points.front();
            SCOPED_TRACE(testing::Message() << clearance << ' ' << ratio << ' ' << omega << ' ' << restitution);
            EXPECT_TRUE(std::isfinite(point.value.real()) && std::isfinite(point.value.imag()));
            EXPECT_TRUE(std::isfinite(point.uncertainty));
            EXPECT_GE(output == Output::x1 ? point.value.imag() : -point.value.imag(), -point.uncertainty);
          }
        }
      }
    }
  }
}

TEST(DescribingFunction, SweepIsAFrequencyResponse) {
  const std::vector<double> omega = {5, 6, 7};
  const DescribingFunctionSweep sweep = describing_function_sweep({1, 1, 0.3, 0.6}, 40, omega);
  const frac::FrequencyResponseData data = sweep.data();
  ASSERT_EQ(data.size(), 3u);
  EXPECT_EQ(data.omega(), omega);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(data.value()[i], sweep.points[i].value);
}

TEST(DescribingFunction, NamesWhatIsOutOfRange) {
  const TwoMassSystem system(1, 1, 0.3, 0.6);
  const auto call = [&](double force, const std::vector<double>& omega, const SweepOptions& options = {}) {
    return [=] { (void)describing_function_sweep(system, force, omega, options); };
  };
  for (const double bad : {0.0, -1.0, nan, infinity}) {
    expect_invalid_argument(call(bad, {1}), {"force_amplitude", "positive"});
    expect_invalid_argument(call(40, {1, bad}), {"omega[1]", "positive", "rad/s"});
  }
  expect_invalid_argument(call(40, {}), {"omega is empty"});
  expect_invalid_argument(call(40, {1, 2, 2}), {"omega[2] is 2", "omega[1] = 2"});
  expect_invalid_argument(call(40, {1, 3, 2}), {"omega[2] is 2", "omega[1] = 3"});
  SweepOptions options;
  for (const double bad : {0.0, -1e-3, 0.1, nan}) {
    options.tolerance = bad;
    expect_invalid_argument(call(40, {1}, options), {"tolerance", "0.01"});
  }
  options = {};
  options.threads = -1;
  expect_invalid_argument(call(40, {1}, options), {"threads", "-1"});
  expect_invalid_argument(
      [&] {
        (void)describing_function_sweeps({{system, 40}, {system, -1}}, {1});
      },
      {"scene 1", "force_amplitude", "-1"});
  EXPECT_TRUE(describing_function_sweeps({}, {1}).empty());
}

TEST(DescribingFunction, SpellingsRoundTrip) {
  for (const Protocol protocol : {Protocol::sweep_up, Protocol::sweep_down, Protocol::contact_at_rest,
                                  Protocol::mid_gap_at_rest, Protocol::two_impact}) {
    EXPECT_EQ(backlash::protocol_from_string(to_string(protocol)), protocol);
  }
  for (const Regime regime :
       {Regime::rigid, Regime::free, Regime::symmetric, Regime::periodic, Regime::chatter, Regime::averaged}) {
    EXPECT_EQ(backlash::regime_from_string(to_string(regime)), regime);
  }
  for (const Output output : {Output::x1, Output::x2})
    EXPECT_EQ(backlash::output_from_string(to_string(output)), output);
  expect_invalid_argument([] { (void)backlash::protocol_from_string("upwards"); }, {"protocol", "upwards", "sweep-up"});
  expect_invalid_argument([] { (void)backlash::regime_from_string(""); }, {"regime", "chatter"});
  expect_invalid_argument([] { (void)backlash::output_from_string("x3"); }, {"output", "x3", "x1, x2"});
}

// Just below the frequency from which nothing is ever met the mass drifts between rare impacts; its mean must not pass
// for a response. Passivity makes Im N1 >= 0 there, to within what the point says of itself.
TEST(DescribingFunction, DriftBetweenRareImpactsIsPartOfTheUncertainty) {
  std::vector<double> omega;
  for (int i = 0; i < 200; ++i) omega.push_back(5 * std::pow(1000.0, i / 199.0));
  const auto sweep = backlash::describing_function_sweep({1, 1, 0.3, 0.2}, 40, omega);
  for (const auto& point : sweep.points) EXPECT_GE(point.value.imag(), -point.uncertainty) << point.omega;
}

// Without losses and pressed so hard that no period ends within the budget of impacts: the position is unknown within
// the gap, N within its uncertainty of that of the rigid pair, -1/((M1 + M2) omega^2).
TEST(DescribingFunction, AWindowWithoutAPeriodKeepsTheRigidPart) {
  const auto point = backlash::describing_function_sweep({1, 1, 0.3, 1}, 40, {1e-4}).points.front();
  EXPECT_EQ(point.regime, backlash::Regime::averaged);
  EXPECT_NEAR(point.value.real(), -0.5e8, point.uncertainty + 1e-15 * 0.5e8);
}

TEST(DescribingFunction, NegativeZeroClearanceIsNoClearance) {
  EXPECT_EQ(backlash::describing_function_sweep({1, 1, -0.0, 0.5}, 40, {1}).points.front().regime,
            backlash::Regime::rigid);
}

}  // namespace
