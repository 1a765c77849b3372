// SPDX-License-Identifier: BSD-3-Clause
#include "backlash/loss_factor.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <boost/math/quadrature/gauss.hpp>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <optional>
#include <vector>

#include "backlash/describing_function.hpp"
#include "backlash/impact_simulation.hpp"
#include "backlash/jump_frequency.hpp"
#include "backlash/minus_inverse.hpp"
#include "backlash/static_backlash.hpp"
#include "support/expect_invalid_argument.hpp"
#include "support/random.hpp"

namespace {

using backlash::TwoMassSystem;
using Complex = std::complex<double>;

constexpr double pi = std::numbers::pi;

// A closed orbit of u'' = gamma cos tau between walls at 0 and 1, found by letting the motion run: of its impacts the
// phases, the walls and the speeds before and after.
struct Orbit {
  struct Contact {
    double phase;  // tau, rising, over all of the orbit's periods
    bool near;     // at u = 0
    double before, after;
  };
  double gamma, restitution;
  int period;  // force periods
  std::vector<Contact> impacts;

  [[nodiscard]] double impacts_per_period() const {
    return static_cast<double>(impacts.size()) / static_cast<double>(period);
  }

  // Loss factor from the phasor of u, by quadrature of the flights: neither energy nor impacts enter.
  [[nodiscard]] double by_quadrature() const {
    Complex phasor = 0;
    for (std::size_t k = 0; k < impacts.size(); ++k) {
      const Contact& impact = impacts[k];
      const double next = k + 1 < impacts.size() ? impacts[k + 1].phase : impacts[0].phase + 2 * pi * period;
      const double u0 = impact.near ? 0 : 1;
      const double v0 = impact.near ? impact.after : -impact.after;
      const auto part = [&](double (*wave)(double)) {
        // u e^(-j tau) is entire; 20 nodes reach rounding on pieces no longer than a radian.
        const auto pieces = static_cast<int>(std::ceil(next - impact.phase));
        const double step = (next - impact.phase) / pieces;
        double sum = 0;
        for (int i = 0; i < pieces; ++i)
          sum += boost::math::quadrature::gauss<double, 20>::integrate(
              [&](double tau) {
                const double since = tau - impact.phase;
                return (u0 + (v0 - gamma * std::sin(impact.phase)) * since -
                        gamma * (std::cos(tau) - std::cos(impact.phase))) *
                       wave(tau);
              },
              impact.phase + i * step, impact.phase + (i + 1) * step);
        return sum;
      };
      phasor += Complex(part([](double t) { return std::cos(t); }), -part([](double t) { return std::sin(t); }));
    }
    phasor /= pi * period;
    return std::imag(1.0 / (1.0 + phasor / gamma));
  }

  // The law, with sums per force period.
  [[nodiscard]] double by_impacts() const {
    double squares = 0;
    Complex sum = 0;
    for (const Contact& impact : impacts) {
      squares += impact.before * impact.before;
      sum += (impact.near ? 1 : -1) * impact.before * std::polar(1.0, -impact.phase);
    }
    return pi / 2 * (1 - restitution) / (1 + restitution) * period * squares / std::norm(sum);
  }

  // Two impacts, half a period apart.
  [[nodiscard]] bool symmetric() const {
    return period == 1 && impacts.size() == 2 && impacts[0].near != impacts[1].near &&
           std::abs(impacts[1].phase - impacts[0].phase - pi) < 1e-9;
  }
};

// How closely an orbit repeats: what the law loses where it does not.
constexpr double closure = 1e-11;

std::optional<Orbit> settled_orbit(double gamma, double restitution, double start) {
  constexpr int periods = 300, longest = 6;
  // Masses, clearance and frequency of 1: F = gamma, and times are radians.
  const TwoMassSystem system(1, 1, 1, restitution);
  const auto history = simulate_impacts(system, gamma, 1, {start, 0}, periods, 100'000);
  if (!history.complete || !history.rests.empty()) return std::nullopt;
  std::vector<Orbit::Contact> all;
  for (const auto& impact : history.impacts)
    all.push_back({impact.time, impact.wall == backlash::Wall::near,
                   std::abs(impact.before.mass2 - impact.before.mass1),
                   std::abs(impact.after.mass2 - impact.after.mass1)});
  const double end = 2 * pi * periods;
  for (int period = 1; period <= longest; ++period) {
    const auto from = [&](int back) {
      return std::find_if(all.begin(), all.end(),
                          [&](const auto& each) { return each.phase >= end - 2 * pi * period * back; });
    };
    const auto last = from(1), before = from(2);
    const auto count = all.end() - last;
    if (count == 0 || last - before != count) continue;
    bool repeats = true;
    for (auto a = last, b = before; a != all.end(); ++a, ++b)
      repeats = repeats && a->near == b->near && std::abs(a->before - b->before) < closure * a->before &&
                // The clock of the simulation has rounding of its own.
                std::abs(a->phase - b->phase - 2 * pi * period) < closure + 4e-16 * end;
    if (!repeats) continue;
    Orbit orbit{gamma, restitution, period, {last, all.end()}};
    for (auto& impact : orbit.impacts) impact.phase -= end - 2 * pi * period;
    return orbit;
  }
  return std::nullopt;
}

// 10^3 orbits of random scenes.  The law is exact on a closed orbit.  An orbit here is closed to 1e-11, and what it
// gains or loses by that stands against losses of the share 1-e.
TEST(LossFactor, OfClosedOrbitsIsThatOfTheirImpacts) {
  support::Random random(32);
  int orbits = 0, symmetric = 0, of_many = 0, longer = 0;
  for (int tried = 0; tried < 4000 && orbits < 1000; ++tried) {
    const double restitution = random.uniform(0.05, 0.9);
    const auto orbit = settled_orbit(random.log_uniform(0.05, 0.8), restitution, random.unit());
    if (!orbit) continue;
    ++orbits;
    const double tolerance = closure / (1 - restitution);
    const double found = orbit->by_quadrature();
    const double least = backlash::least_loss_factor(restitution, orbit->impacts_per_period());
    const auto scene = [&] {
      return "gamma " + std::to_string(orbit->gamma) + ", restitution " + std::to_string(restitution) + ", " +
             std::to_string(orbit->impacts.size()) + " impacts in " + std::to_string(orbit->period) + " periods";
    };
    EXPECT_NEAR(found / orbit->by_impacts(), 1, tolerance) << scene();
    EXPECT_GE(found, least * (1 - tolerance)) << scene();
    of_many += orbit->impacts.size() > 2 ? 1 : 0;
    longer += orbit->period > 1 ? 1 : 0;
    if (!orbit->symmetric()) continue;
    ++symmetric;
    EXPECT_NEAR(found / backlash::symmetric_loss_factor(restitution), 1, tolerance) << scene();
  }
  // The population holds all kinds that the law speaks of.
  EXPECT_EQ(orbits, 1000);
  EXPECT_GE(symmetric, 100);
  EXPECT_GE(of_many, 100);
  EXPECT_GE(longer, 20);
}

// Slope of ln y over ln x by least squares, about the mean of x.
double slope_of(const std::vector<double>& log_x, const std::vector<double>& log_y) {
  double mean = 0, sxy = 0, sxx = 0;
  for (const double x : log_x) mean += x / static_cast<double>(log_x.size());
  for (std::size_t i = 0; i < log_x.size(); ++i) {
    sxy += (log_x[i] - mean) * log_y[i];
    sxx += (log_x[i] - mean) * (log_x[i] - mean);
  }
  return sxy / sxx;
}

// Over the symmetric band of 100 random scenes Im(-1/N1) is (pi/4) (1-e)/(1+e) (M1+M2) omega^2.  N and -1/N are each
// rounded a few times, to a part in 10^15; Im N, which is small beside Re N at restitutions near 1, has up to a hundred
// times that: below the 1e-12 asked of the coefficient.  A slope over a band of width ln(1.05) or more is then good to
// some 1e-12/0.05/sqrt(points), below the 1e-9 asked of it.
TEST(LossFactor, InTheSymmetricBandRisesWithTheSquareOfFrequencyExactly) {
  support::Random random(101);
  for (int scene = 0; scene < 100; ++scene) {
    const double restitution = random.uniform(0.1, 0.97);
    const TwoMassSystem system(random.log_uniform(0.1, 10), random.log_uniform(0.1, 10), random.log_uniform(1e-3, 1),
                               restitution);
    const double force = random.log_uniform(0.1, 1000);
    const auto from = jump_frequency(system, force, backlash::JumpCriterion::symmetry_loss);
    const auto to = jump_frequency(system, force, backlash::JumpCriterion::saddle_node);
    ASSERT_TRUE(from && to);
    std::vector<double> omega;
    for (int i = 0; i < 40; ++i) omega.push_back(*from * std::pow(*to / *from, (i + 0.5) / 40));
    backlash::SweepOptions options;
    options.protocol = backlash::Protocol::two_impact;
    const auto sweep = describing_function_sweep(system, force, omega, options);
    std::vector<double> log_omega, log_imaginary;
    for (const auto& point : sweep.points) {
      ASSERT_EQ(point.regime, backlash::Regime::symmetric);
      const auto inverse = backlash::minus_inverse(point).value();
      EXPECT_NEAR(
          backlash::loss_factor(system, inverse.value, point.omega) / backlash::symmetric_loss_factor(restitution), 1,
          1e-12)
          << restitution << " at " << point.omega;
      log_omega.push_back(std::log(point.omega));
      log_imaginary.push_back(std::log(inverse.value.imag()));
    }
    EXPECT_NEAR(slope_of(log_omega, log_imaginary), 2, 1e-9) << restitution;
  }
}

// Im U tends to K gamma^(-1/3) in size (tools/docs/methods/loss-factor.md), so that Im(-1/N1) rises with omega^(2 +
// 8/3). The next term falls with gamma^(-2/3): at frequencies a thousandth of the jump and lower, gamma > 10^6, it is
// of the order of 1e-4 and moves the slope over a decade by less than the 1e-3 asked.
TEST(LossFactor, AtLowFrequencyRisesWithTheFractionalPower) {
  for (const double restitution : {0.0, 0.2, 0.4, 0.6, 0.8}) {
    const TwoMassSystem system(1.3, 0.7, 0.2, restitution);
    const double force = 25;
    const double unit = std::sqrt(force / (system.mass2() * system.clearance()));
    const auto sweep = describing_function_sweep(system, force, {1e-5 * unit, 1e-4 * unit, 1e-3 * unit});
    for (std::size_t i = 1; i < sweep.points.size(); ++i) {
      const auto imaginary = [&](std::size_t k) {
        return backlash::minus_inverse(sweep.points[k]).value().value.imag();
      };
      EXPECT_NEAR(std::log10(imaginary(i) / imaginary(i - 1)), 14.0 / 3, 1e-3)
          << "restitution " << restitution << ", decade below " << sweep.points[i].omega;
    }
  }
}

// N_static = -N_b/((M1+M2) omega^2) with Im N_b -> -2 Delta/(pi X) as X = F/((M1+M2) omega^2) grows, so that y tends
// to (2/pi) (M1+M2) Delta omega^2/F, and Im(-1/N) rises with omega^4.  The next term is smaller by Delta/(2 X).
TEST(LossFactor, OfStaticBacklashRisesWithTheFourthPower) {
  const TwoMassSystem system(1.3, 0.7, 0.2, 0.5);
  const double force = 25;
  const std::vector<double> omega{1e-3, 1e-2};
  const auto n = backlash::static_describing_function(1.3, 0.7, 0.2, force, omega);
  std::vector<double> y;
  for (std::size_t i = 0; i < omega.size(); ++i)
    y.push_back(backlash::loss_factor(system, backlash::minus_inverse(n[i], 0).value().value, omega[i]));
  for (std::size_t i = 0; i < omega.size(); ++i) {
    const double over_amplitude = 2.0 * 0.2 * omega[i] * omega[i] / force;  // Delta/X
    EXPECT_NEAR(y[i] / (2 / pi * over_amplitude), 1, 2 * over_amplitude + 1e-9);
  }
}

TEST(LossFactor, IsOneFunctionOfTheFrequencyRatio) {
  support::Random random(7);
  const TwoMassSystem plain(1, 1, 1, 0.6);
  for (const double ratio : {0.01, 0.1, 0.3, 1.7, 2.5}) {
    const auto loss = [&](const TwoMassSystem& system, double force) {
      const double omega = ratio * std::sqrt(force / (system.mass2() * system.clearance()));
      EXPECT_NEAR(backlash::frequency_ratio(system, force, omega), ratio, 1e-15 * ratio);
      // Above 2 a motion that starts between the walls does not meet them.
      backlash::SweepOptions options;
      options.protocol = backlash::Protocol::two_impact;
      const auto sweep = describing_function_sweep(system, force, {omega}, options);
      return backlash::loss_factor(system, backlash::minus_inverse(sweep.points[0]).value().value, omega);
    };
    const double reference = loss(plain, 1);
    for (int i = 0; i < 20; ++i) {
      const TwoMassSystem system(random.log_uniform(0.1, 10), random.log_uniform(0.1, 10), random.log_uniform(1e-3, 1),
                                 0.6);
      // gamma is rounded a few times; the closed orbit is closed to 1e-10.
      EXPECT_NEAR(loss(system, random.log_uniform(0.1, 1000)) / reference, 1, 1e-9) << ratio;
    }
  }
  EXPECT_EQ(backlash::frequency_ratio(TwoMassSystem(1, 1, 0, 0.5), 1, 3), 0);
}

TEST(LossFactor, TellsTheRestitutionOfASymmetricOrbit) {
  for (double restitution = 0; restitution <= 1; restitution += 0.125) {
    // (1-q)/(1+q) undoes itself; q = 1 at restitution 0 may be missed by a rounding.
    const auto found = backlash::restitution_from_loss_factor(backlash::symmetric_loss_factor(restitution));
    ASSERT_TRUE(found) << restitution;
    EXPECT_NEAR(*found, restitution, 4e-16);
  }
  EXPECT_FALSE(backlash::restitution_from_loss_factor(-1e-9));
  EXPECT_FALSE(backlash::restitution_from_loss_factor(pi / 4 * (1 + 1e-9)));
  EXPECT_FALSE(backlash::restitution_from_loss_factor(std::numeric_limits<double>::quiet_NaN()));
}

TEST(LossFactor, KnowsItsHardCases) {
  EXPECT_EQ(backlash::symmetric_loss_factor(1), 0);
  EXPECT_DOUBLE_EQ(backlash::symmetric_loss_factor(0), pi / 4);
  EXPECT_EQ(backlash::least_loss_factor(0.5, std::numeric_limits<double>::infinity()), 0);
  support::expect_invalid_argument([] { static_cast<void>(backlash::least_loss_factor(0.5, 0)); },
                                   {"impacts per period is 0"});
  support::expect_invalid_argument([] { static_cast<void>(backlash::symmetric_loss_factor(1.5)); },
                                   {"restitution is 1.5", "[0, 1]"});
}

}  // namespace
