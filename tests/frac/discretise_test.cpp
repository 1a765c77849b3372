// SPDX-License-Identifier: BSD-3-Clause
#include "frac/digital/discretise.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <limits>
#include <numbers>

#include "digital/z_plane.hpp"
#include "frac/grunwald_letnikov.hpp"
#include "support/expect_invalid_argument.hpp"

namespace {

using frac::digital_power;
using frac::DigitalPower;
using frac::Discretisation;
using frac::PoleCount;
using frac::Tolerance;
using Complex = std::complex<double>;

constexpr double pi = std::numbers::pi;
constexpr double time_step = 1e-3;
constexpr double sampling = 2 * pi / time_step;  // rad/s

Complex exact(double order, double omega) {
  return std::pow(Complex(0, omega), order);
}

// From the coefficients in plain z-form, in long double: independent of the library's delta arithmetic.
Complex of_parallel(const DigitalPower& power, double omega) {
  using C = std::complex<long double>;
  const C z = std::polar(1.0L, static_cast<long double>(omega * power.sample_time));
  C value = power.parallel.direct;
  for (std::size_t i = 0; i < power.parallel.rates.size(); ++i) {
    const C section = 1.0L / (z - 1.0L + static_cast<long double>(power.parallel.rates[i]));
    value += static_cast<long double>(power.parallel.weights[i]) *
             (power.parallel.output == frac::SectionOutput::state ? section : (z - 1.0L) * section);
  }
  C taps = 0;
  for (std::size_t k = power.taps.size(); k-- > 0;) taps = taps / z + static_cast<long double>(power.taps[k]);
  value *= taps;
  const auto T = static_cast<long double>(power.sample_time);
  for (int i = 0; i < power.differences; ++i) value *= (1.0L - 1.0L / z) / T;
  for (int i = 0; i < power.integrators; ++i) value *= T / 2 * (z + 1.0L) / (z - 1.0L);
  return Complex(value);
}

TEST(Discretise, TustinIsTheBilinearRule) {
  const frac::ZeroPoleGain system{.zeros = {-3, -200}, .poles = {-1, -40}, .gain = 2};
  const auto sections = frac::discretise(system, time_step);
  for (const double omega : {1e-3, 1.0, 100.0, 3000.0}) {
    const Complex s(0, 2 / time_step * std::tan(omega * time_step / 2));
    const Complex expected = 2.0 * (s + 3.0) * (s + 200.0) / ((s + 1.0) * (s + 40.0));
    const Complex delta = frac::detail::delta_at(omega, time_step);
    Complex cascade = sections.cascade.gain;
    for (const auto& section : sections.cascade.sections) cascade *= 1.0 + section.feed / (delta + section.rate);
    EXPECT_LT(std::abs(cascade / expected - 1.0), 1e-14);
    EXPECT_LT(std::abs(sections.parallel.response(delta) / expected - 1.0), 1e-14);
  }
}

// At omega the bilinear rule has the response of the prototype at W = (2/T) tan(omega T/2).  Here the largest gain
// beyond the band is sought over W in even steps of 1/200 e-fold, 16 decades up: the gain turns within a factor of W of
// about 2, so that the steps miss less than 1e-4 of it, and the power of omega that stands below is flat up there.
TEST(Discretise, AmplificationOfTheBilinearRuleIsFoundUpToTheLastFrequency) {
  for (const double order : {0.3, 0.9, 1.6, -0.5, -1.2}) {
    for (const double share : {0.01, 0.1, 0.3}) {
      for (const PoleCount poles : {PoleCount{4}, PoleCount{11}}) {
        const double upper = share * sampling;
        const auto power = digital_power(order, {upper / 1e3, upper}, poles, time_step, Discretisation::tustin);
        const double edge = std::tan(upper * time_step / 2);
        double largest = 0;
        for (int i = 0; i < 200 * 37; ++i) {
          const double tangent = edge * std::exp(i / 200.0);
          const double omega = 2 / time_step * std::atan(tangent);
          double gain = std::abs(power.prototype.system.response(2 / time_step * tangent));
          // Whole differences are 2 sin(omega T/2)/T each, trapezoidal integrators T/2 over the tangent.
          gain *= std::pow(2 / time_step * std::sin(omega * time_step / 2), power.differences);
          gain *= std::pow(time_step / 2 / tangent, power.integrators);
          largest = std::max(largest, gain / std::pow(order < 0 ? upper : omega, order));
        }
        EXPECT_NEAR(power.most_amplification / largest, 1, 2e-4) << order << " " << share << " " << poles.poles;
      }
    }
  }
}

TEST(Discretise, AlAlaouiIsItsRule) {
  const frac::ZeroPoleGain system{.zeros = {-3}, .poles = {-500}, .gain = 2};
  const auto sections = frac::discretise(system, time_step, Discretisation::al_alaoui);
  for (const double omega : {1.0, 3000.0}) {
    const Complex z = std::polar(1.0, omega * time_step);
    const Complex s = 8.0 / (7 * time_step) * (z - 1.0) / (z + 1.0 / 7);
    const Complex expected = 2.0 * (s + 3.0) / (s + 500.0);
    EXPECT_LT(std::abs(sections.parallel.response(frac::detail::delta_at(omega, time_step)) / expected - 1.0), 1e-13);
  }
}

TEST(Discretise, TustinErrorOfAPowerIsPureGain) {
  for (const double order : {0.5, -0.3, 0.9}) {
    const auto power = digital_power(order, {1, sampling / 4}, Tolerance{1e-5}, time_step, Discretisation::tustin);
    for (const double share : {0.01, 0.1, 0.2}) {
      const double omega = share * sampling;
      const double x = pi * share;
      const Complex ratio = power.response(omega) / exact(order, omega);
      EXPECT_NEAR(std::abs(ratio), std::pow(std::tan(x) / x, order), 2e-5);
      EXPECT_NEAR(std::arg(ratio), 0, 2e-5);
    }
    // 1.7 % at a tenth of the sampling frequency for order 1/2.
    if (order == 0.5) {
      EXPECT_NEAR(std::abs(power.response(0.1 * sampling) / exact(0.5, 0.1 * sampling)), 1.0170, 1e-4);
    }
  }
}

TEST(Discretise, PrewarpedIsExactAtTheUpperEdge) {
  for (const double order : {0.5, -1.4}) {
    const double upper = sampling / 5;
    const auto power = digital_power(order, {1, upper}, Tolerance{1e-6}, time_step, Discretisation::tustin_prewarped);
    EXPECT_LT(std::abs(power.response(upper) / exact(order, upper) - 1.0), 2e-6);
  }
}

// What the direct design is for: at a quarter of the sampling frequency a tenth of the bilinear rule's error or less,
// paid with gain beyond that stays within its bound, where the bilinear rule's grows without one.
TEST(Discretise, DirectDesignRemovesTheGainErrorUpToAQuarterOfTheSamplingFrequency) {
  for (const double order : {0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.99, -0.1, -0.3, -0.5, -0.7, -0.9}) {
    const auto to_quarter = digital_power(order, {1, sampling / 4}, Tolerance{1e-3}, time_step);
    const auto tustin = digital_power(order, {1, sampling / 4}, Tolerance{1e-3}, time_step, Discretisation::tustin);
    EXPECT_LT(to_quarter.error.max_relative, 0.1 * tustin.error.max_relative) << order;
    EXPECT_LT(to_quarter.most_amplification, 5.25) << order;  // 5 on the points of the design, 5 % more between
    const auto to_tenth = digital_power(order, {1, sampling / 10}, Tolerance{1e-3}, time_step);
    EXPECT_EQ(to_tenth.status, frac::ApproximationStatus::met) << order << " " << to_tenth.message;
  }
}

TEST(Discretise, DirectDesignKeepsItsToleranceOnNarrowWideAndLowBands) {
  for (const double order : {1e-6, 0.5, 1 - 1e-6, 1.0, -0.5, -1.5, 0.0}) {
    for (const double decades : {0.1, 4.0, 12.0}) {
      for (const double share : {1e-6, 1e-2, 0.1}) {
        const double upper = share * sampling;
        const auto power = digital_power(order, {upper * std::pow(10, -decades), upper}, Tolerance{1e-3}, time_step);
        EXPECT_EQ(power.status, frac::ApproximationStatus::met) << order << " " << decades << " " << power.message;
      }
    }
  }
}

TEST(Discretise, AmplificationBoundTradesAccuracyAtTheEdge) {
  double last = 1;
  for (const double bound : {1.2, 1.5, 2.0, 4.0}) {
    const auto power = digital_power(0.7, {1, sampling / 6}, Tolerance{1e-4}, time_step, Discretisation::direct,
                                     frac::ApproximationMethod::ladder, 1, bound);
    EXPECT_LT(power.most_amplification, 1.05 * bound);
    EXPECT_LT(power.error.max_relative, last);
    last = power.error.max_relative;
  }
  support::expect_invalid_argument(
      [] {
        (void)digital_power(0.7, {1, 100}, Tolerance{1e-4}, time_step, Discretisation::direct,
                            frac::ApproximationMethod::ladder, 1, 1.0);
      },
      {"most_amplification = 1", "1.1 to 1000"});
}

TEST(Discretise, StatedErrorHoldsOffTheGridAndFormsAgree) {
  for (const auto method : {Discretisation::direct, Discretisation::tustin, Discretisation::al_alaoui}) {
    for (const double order : {0.5, -0.5, 1.3, -1.7}) {
      const auto power = digital_power(order, {1, sampling / 8}, Tolerance{1e-3}, time_step, method);
      double largest = 0;
      for (int i = 0; i <= 3333; ++i) {
        // Off the grid, but for the edge, which is part of the band and where the error is steepest.
        const double omega = i == 3333 ? sampling / 8 : std::pow(sampling / 8, (i + 0.37) / 3333);
        const Complex value = of_parallel(power, omega);
        largest = std::max(largest, std::abs(value / exact(order, omega) - 1.0));
        // omega T is rounded to 1e-16 of itself, and z - 1 in long double to 1e-19/1e-3 at the lower end; taps of both
        // signs sum up to three or four times their result.
        ASSERT_LT(std::abs(value / power.response(omega) - 1.0), 1e-14);
      }
      EXPECT_NEAR(largest / power.error.max_relative, 1, 0.01) << to_string(method) << " " << order;
    }
  }
}

TEST(Discretise, AllPolesAreInsideTheCircle) {
  for (const double order : {0.01, 0.5, 0.99, -0.99, 2.5, -2.5}) {
    for (const double lower : {1e-9, 1.0, 300.0}) {
      for (const double share : {0.02, 0.1, 0.25}) {
        if (lower >= share * sampling) continue;
        const auto power = digital_power(order, {lower, share * sampling}, PoleCount{12}, time_step);
        EXPECT_EQ(power.cascade.sections.size(), 12);
        for (const double rate : power.parallel.rates) {
          EXPECT_GT(rate, 0);
          EXPECT_LT(rate, 2);
        }
        for (const auto& section : power.cascade.sections) {
          EXPECT_GT(section.rate, 0);
          EXPECT_LT(section.rate, 2);
        }
      }
    }
  }
}

TEST(Discretise, WholeOrdersTakeNoSectionsButCorrections) {
  const auto derivative = digital_power(1, {1, 100}, PoleCount{5}, time_step, Discretisation::tustin);
  EXPECT_EQ(derivative.differences, 1);
  EXPECT_TRUE(derivative.parallel.rates.empty());
  const auto integral = digital_power(-2, {1, 100}, PoleCount{5}, time_step, Discretisation::tustin);
  EXPECT_EQ(integral.integrators, 2);
  EXPECT_TRUE(integral.cascade.sections.empty());
  const auto corrected = digital_power(1, {1, 600}, Tolerance{1e-3}, time_step);
  EXPECT_EQ(corrected.status, frac::ApproximationStatus::met) << corrected.message;
}

TEST(Discretise, GrunwaldLetnikovHasTheResponseOfItsWeights) {
  const auto power = digital_power(0.5, {10, 100}, PoleCount{1}, time_step, Discretisation::grunwald_letnikov,
                                   frac::ApproximationMethod::ladder, 500);
  EXPECT_EQ(power.taps.size(), 501);
  for (const double omega : {10.0, 500.0}) {
    const Complex expected = frac::grunwald_letnikov_response(0.5, time_step, 500, omega);
    EXPECT_LT(std::abs(power.response(omega) / expected - 1.0), 1e-12);
  }
  support::expect_invalid_argument(
      [] {
        (void)digital_power(0.5, {10, 100}, PoleCount{1}, time_step, Discretisation::grunwald_letnikov,
                            frac::ApproximationMethod::ladder, 0);
      },
      {"memory_length = 0"});
}

TEST(Discretise, BandMeetingNyquistIsRefusedWithTheLimit) {
  support::expect_invalid_argument(
      [] {
        (void)digital_power(0.5, {1, 1600}, Tolerance{1e-3}, time_step);
      },
      {"1 to 1600 rad/s", "pi/(2 T) = 1570.79", "T = 0.001 s"});
  EXPECT_NO_THROW((void)digital_power(0.5, {1, 1600}, Tolerance{1e-3}, time_step, Discretisation::tustin));
  support::expect_invalid_argument(
      [] {
        (void)digital_power(0.5, {1, 3200}, Tolerance{1e-3}, time_step, Discretisation::tustin);
      },
      {"3200", "pi/T = 3141.59"});
}

TEST(Discretise, SaysWhatIsWrong) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const frac::ZeroPoleGain good{.zeros = {-1}, .poles = {-2}};
  const auto refused = [](const frac::ZeroPoleGain& system, double step, const std::string& part) {
    support::expect_invalid_argument([&] { (void)frac::discretise(system, step); }, {part});
  };
  refused(good, 0, "sample_time = 0 s");
  refused(good, nan, "sample_time = nan s");
  refused({.zeros = {-1}, .poles = {}}, 1, "1 zeros and 0 poles");
  refused({.zeros = {1}, .poles = {-2}}, 1, "zeros[0] = 1 rad/s");
  refused({.zeros = {-1}, .poles = {0}}, 1, "poles[0] = 0 rad/s");
  refused({.zeros = {-1, -3}, .poles = {-2, -2}}, 1, "pole -2 rad/s occurs twice");
  refused({.zeros = {-1}, .poles = {-2}, .gain = 1, .integer_order = 1}, 1, "integer_order = 1");
  support::expect_invalid_argument([&] { (void)frac::discretise(good, 1, Discretisation::direct); }, {"direct"});
  support::expect_invalid_argument([] { (void)digital_power(9, {1, 2}, PoleCount{3}, 1e-3); }, {"order = 9"});
  support::expect_invalid_argument([&] { (void)digital_power(nan, {1, 2}, PoleCount{3}, 1e-3); }, {"order = nan"});
  support::expect_invalid_argument([] { (void)digital_power(.5, {1, 2}, PoleCount{3}, -1); }, {"sample_time = -1"});
  support::expect_invalid_argument(
      [] {
        (void)digital_power(0.2, {0.1, 10}, PoleCount{7}, 1e-3, Discretisation::direct,
                            frac::ApproximationMethod::carlson);
      },
      {"complex zeros or poles"});
}

TEST(Discretise, NamesReadBack) {
  for (const auto method : frac::discretisations())
    EXPECT_EQ(frac::discretisation_from_string(to_string(method)), method);
  support::expect_invalid_argument([] { (void)frac::discretisation_from_string("euler"); },
                                   {"euler", "tustin-prewarped"});
}

}  // namespace
