// SPDX-License-Identifier: BSD-3-Clause
#include "frac/stability.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include "frac/loop_stability.hpp"
#include "frac/model/algebra.hpp"
#include "support/dense_maximum.hpp"
#include "support/expect_invalid_argument.hpp"
#include "support/random.hpp"
#include "support/relative_error.hpp"
#include "support/step_systems.hpp"

namespace {

using Complex = std::complex<double>;
using frac::FractionalTransferFunction;
using frac::Stability;
constexpr double pi = std::numbers::pi;
constexpr double infinity = std::numeric_limits<double>::infinity();

FractionalTransferFunction model(const std::string& formula) {
  return FractionalTransferFunction::parse(formula);
}

Stability stability(const char* formula) {
  return frac::analyse_stability(model(formula)).stability;
}

// The roots of s^n = -1 lie 2 pi/n apart.  Up to n = 2000 they are told apart, half of them in the upper half-plane.
void expect_roots_of_minus_one(int order) {
  const frac::StabilityAnalysis far = frac::analyse_stability(model("1/(s^" + std::to_string(order) + " + 1)"));
  EXPECT_EQ(far.stability, Stability::unstable);
  EXPECT_EQ(far.poles.size(), static_cast<std::size_t>(order / 2));
  for (const auto& pole : far.poles) EXPECT_NEAR(std::abs(pole.value), 1, 1e-12);
}

TEST(Stability, PolesOfHighOrders) {
  expect_roots_of_minus_one(200);
}

TEST(Stability, PolesOfTheHighestOrders) {
  expect_roots_of_minus_one(2000);
}

TEST(Stability, OrdersThatLieTooFarApartAreToldAtOnce) {
  for (const char* formula : {"1/(s^2001 + 1)", "1/(s^1e5 + s^0.5 + 1)", "(s^1e9 + 2)/(s^1e9 + s^1.5 + 1)"}) {
    const frac::StabilityAnalysis result = frac::analyse_stability(model(formula));
    EXPECT_EQ(result.stability, Stability::undetermined) << formula;
    EXPECT_NE(result.remark.find("more than 2000 apart"), std::string::npos) << result.remark;
  }
}

TEST(Stability, AMultiplePoleIsListedOnceAndToRounding) {
  const auto poles_of = [](const char* formula) {
    return frac::analyse_stability(frac::FractionalTransferFunction::parse(formula)).poles;
  };
  for (const char* formula : {"1/(s + 1)^2", "1/(s + 1)^3", "1/((s + 1)^2 (s^0.5 + 2))"}) {
    const auto poles = poles_of(formula);
    ASSERT_EQ(poles.size(), 1u) << formula;
    EXPECT_EQ(poles[0].multiplicity, std::string(formula).find("^3") == std::string::npos ? 2 : 3);
    // Rounded coefficients move the members of a multiple pole apart, but hardly their middle.
    EXPECT_NEAR(poles[0].value.real(), -1, 1e-12) << formula;
    EXPECT_EQ(poles[0].value.imag(), 0) << formula;
  }
}

}  // namespace

// 15 and 10 digits are known.
TEST(Stability, NormsAndPolesOfTheFurnace) {
  const auto furnace = model("1/(0.8 s^2.2 + 0.5 s^0.9 + 1)");
  EXPECT_NEAR(frac::h2_norm(furnace), 1.5345842681944, 2e-13);
  const frac::PeakGain peak = frac::h_infinity_norm(furnace);
  EXPECT_NEAR(peak.gain, 4.6208373031928, 1e-13);
  EXPECT_NEAR(peak.omega, 1.190543709, 1e-9);
  const auto analysis = frac::analyse_stability(furnace);
  EXPECT_EQ(analysis.stability, Stability::stable);
  ASSERT_EQ(analysis.poles.size(), 1u);
  EXPECT_LE(support::relative_error(analysis.poles[0].value, {-0.10841680291289, 1.19699224474627}), 1e-13);
  EXPECT_DOUBLE_EQ(analysis.commensurate_order.value(), 0.1);
}

// An oscillator at 1e300 rad/s, damping 1/2: the ratio of its coefficients, 1e600, is no double.
TEST(Stability, CoefficientsMayLieFartherApartThanADoubleReaches) {
  const FractionalTransferFunction oscillator({{1, 0}}, {{1e-300, 2}, {1, 1}, {1e300, 0}});
  const frac::StabilityAnalysis analysis = frac::analyse_stability(oscillator);
  EXPECT_EQ(analysis.stability, frac::Stability::stable);
  ASSERT_EQ(analysis.poles.size(), 1U);
  // Rounding of ln omega = 691 makes 1e-13 of omega.
  EXPECT_NEAR(analysis.poles[0].value.real() / -5e299, 1, 1e-12);
  EXPECT_NEAR(analysis.poles[0].value.imag() / (std::sqrt(0.75) * 1e300), 1, 1e-12);
  const frac::PeakGain peak = frac::h_infinity_norm(oscillator);
  EXPECT_NEAR(peak.gain / (1e-300 / std::sqrt(0.75)), 1, 1e-12);
  EXPECT_NEAR(frac::h2_norm(oscillator) / (std::sqrt(0.5) * 1e-150), 1, 1e-12);
  EXPECT_EQ(frac::analyse_closed_loop(oscillator).stability, frac::Stability::stable);
}

// 1/(s^2 + 2 z s + 1): 1/(2 z sqrt(1 - z^2)) at sqrt(1 - 2 z^2), and 1/sqrt(4 z).
TEST(Stability, NormsOfTheOscillator) {
  for (const double z : {1e-6, 1e-3, 0.1, 0.5, 0.9}) {
    const FractionalTransferFunction oscillator({{1, 0}}, {{1, 2}, {2 * z, 1}, {1, 0}});
    const frac::PeakGain peak = frac::h_infinity_norm(oscillator);
    const bool resonant = 2 * z * z < 1;
    EXPECT_NEAR(peak.gain / (resonant ? 1 / (2 * z * std::sqrt(1 - z * z)) : 1), 1, 1e-13) << z;
    if (resonant) {
      EXPECT_NEAR(peak.omega, std::sqrt(1 - 2 * z * z), 1e-6 * z + 1e-7) << z;
    } else {
      EXPECT_EQ(peak.omega, 0);
    }
    EXPECT_NEAR(frac::h2_norm(oscillator) * std::sqrt(4 * z), 1, 1e-12) << z;
  }
}

// With k = s^0.22 and x = s^0.5 alone, |G| rises from its limit at 0 to 136.2706 at 2.4e-6 rad/s: the value of a dense
// search in 40 digits.
TEST(Stability, ThePeakMayLieFarBelowTheCorners) {
  const auto peak = frac::h_infinity_norm(model("(0.4678 s^0.22 + 13.5991)/(0.064 s^1.1 + 0.0751 s^0.5 + 0.0999)"));
  EXPECT_NEAR(peak.gain, 136.27056984, 1e-8);
  EXPECT_NEAR(peak.omega, 2.4175e-6, 1e-10);
}

// Against a dense search from 1e-30 to 1e30 rad/s and the limit at zero frequency.
TEST(Stability, ThePeakIsThatOfADenseSearch) {
  support::Random random(4711);
  int stable = 0;
  for (int trial = 0; trial < 150; ++trial) {
    const double low = random.uniform(0.2, 0.8);
    const FractionalTransferFunction system(
        {{random.log_uniform(0.01, 20), random.uniform(0.1, 0.6)}, {random.log_uniform(0.01, 20), 0}},
        {{random.log_uniform(0.01, 20), low + random.uniform(0.1, 1)},
         {random.log_uniform(0.01, 20), low},
         {random.log_uniform(0.01, 20), 0}});
    if (frac::analyse_stability(system).stability != Stability::stable) continue;
    ++stable;
    const double at_zero = std::abs(system.numerator().back().coefficient / system.denominator().back().coefficient);
    const auto gain_at = [&](double omega) { return std::abs(system.response(omega)); };
    const double largest = std::max(at_zero, support::dense_maximum(gain_at, 1e-30, 1e30, 0.023));
    // Peaks of orders below 1.8 have a quality below 10: the second grid misses less than 3e-8 of them.
    const double gain = frac::h_infinity_norm(system).gain;
    EXPECT_GE(gain, largest * (1 - 1e-13)) << system.formula();
    EXPECT_LE(gain, largest * (1 + 1e-7)) << system.formula();
  }
  EXPECT_GT(stable, 100);
}

// Near 0 the phase of -1/(1 - a s^0.5) e^{-L s} leaves -180 degrees upwards and dead time brings it back.
TEST(Stability, APhaseCrossoverFarBelowTheCorners) {
  const auto loop = model("exp(-5.1236 s) * 0.504/(0.1082 s^1.5 + 0.0622 s^0.5 - 11.835)");
  const auto crossovers = frac::margins(loop).gain;
  ASSERT_GE(crossovers.size(), 2u);
  EXPECT_EQ(crossovers[0].omega, 0);
  // L w = a sin(pi/4) w^0.5 with a = 0.0622/11.835 to first order.
  const double root = 0.0622 / 11.835 * std::sqrt(0.5) / 5.1236;
  EXPECT_NEAR(crossovers[1].omega / (root * root), 1, 2e-3);
}

// |1/(s^a + 1)|^2 = 1/(w^2a + 2 c w^a + 1), c = cos(pi a/2): the integral over w is, with x = w^a and t = acos c = pi
// a/2, (pi/a) sin((1 - 1/a) t) / (sin t sin(pi/a)) (Gradshteyn, Ryzhik 3.252.12), for a > 1/2.
TEST(Stability, SquareNormOfOneFractionalPole) {
  for (const double a : {0.6, 0.75, 0.9, 1.3, 1.7, 1.95}) {
    const double t = pi * a / 2;
    const double integral = pi / a * std::sin((1 - 1 / a) * t) / (std::sin(t) * std::sin(pi / a));
    const FractionalTransferFunction transfer({{1, 0}}, {{1, a}, {1, 0}});
    EXPECT_NEAR(frac::h2_norm(transfer) / std::sqrt(integral / pi), 1, 1e-12) << a;
  }
  EXPECT_EQ(frac::h2_norm(model("1/(s^0.5 + 1)")), infinity);
  EXPECT_EQ(frac::h2_norm(model("1/(s - 1)")), infinity);
}

// s^q lambda: the roots -1 of lambda^k + 1 have arg pi/k; stable for |arg lambda| > q pi/2 (Matignon 1996).
TEST(Stability, FollowsMatignon) {
  EXPECT_EQ(stability("1/(s^1.9 + 1)"), Stability::stable);
  EXPECT_EQ(stability("1/(s^2 + 1)"), Stability::marginal);
  EXPECT_EQ(stability("1/(s^2.1 + 1)"), Stability::unstable);
  EXPECT_EQ(stability("1/(s^0.5 - 1)"), Stability::unstable);
  EXPECT_EQ(stability("1/(s - 2 s^0.5 + 1.99)"), Stability::unstable);
  EXPECT_EQ(stability("1/(s - 1.3 s^0.5 + 1)"), Stability::stable);
  EXPECT_EQ(stability("1/(s - 1.5 s^0.5 + 1)"), Stability::unstable);
  EXPECT_EQ(stability("1/(s^1.5 + s^0.5)"), Stability::integrating);
  EXPECT_EQ(stability("s^0.5/1"), Stability::differentiating);
  EXPECT_EQ(stability("(s - 1)/(s^2 - 1)"), Stability::stable);
  support::Random random(1);
  int unstable = 0;
  for (int i = 0; i < 200; ++i) {
    const double q = 0.1 * static_cast<double>(1 + random.below(9));
    std::vector<frac::PowerTerm> sum{{1, 0}};
    for (int k = 1; k <= 4; ++k) sum.push_back({random.normal(), k * q});
    const auto analysis = frac::analyse_stability(FractionalTransferFunction({{1, 0}}, sum));
    bool all_stable = true;
    std::size_t principal = 0;
    for (const frac::SheetRoot& root : analysis.sheet_roots) {
      all_stable = all_stable && root.stable;
      if (!root.on_principal_sheet) continue;
      ++principal;
      double nearest = 1;
      for (const frac::Pole& pole : analysis.poles) {
        nearest = std::min(nearest, support::relative_error(std::pow(root.lambda, 1 / q), pole.value));
      }
      EXPECT_LE(nearest, 1e-9) << i;
    }
    EXPECT_EQ(principal, analysis.poles.size());
    EXPECT_EQ(analysis.stability == Stability::stable, all_stable) << i;
    unstable += all_stable ? 0 : 1;
  }
  EXPECT_GT(unstable, 20);
  EXPECT_LT(unstable, 180);
}

TEST(Stability, CommensurateOrders) {
  const auto order = [](const char* formula) { return frac::analyse_stability(model(formula)).commensurate_order; };
  EXPECT_DOUBLE_EQ(order("1/(s^1.8 + s^0.9 + 1)").value(), 0.9);
  EXPECT_DOUBLE_EQ(order("(s^0.5 + 1)/(s^0.75 + 1)").value(), 0.25);
  EXPECT_DOUBLE_EQ(order("1/(s^2 + s + 1)").value(), 1);
  EXPECT_FALSE(order("1/(s^1.4142135623730951 + s + 1)").has_value());
  EXPECT_EQ(stability("1/(s^1.4142135623730951 + s + 1)"), Stability::stable);
}

// K e^{-L s}/s: stable for K L < pi/2; K e^{-s}/(s + 1): up to K = sqrt(1 + w^2), w + atan w = pi.
// K/(s^a (s + 1)): phase -a pi/2 - atan w.
TEST(Stability, OfLoopsWithDeadTime) {
  const auto closed = [](std::vector<frac::PowerTerm> top, std::vector<frac::PowerTerm> bottom, double delay) {
    return frac::analyse_closed_loop({std::move(top), std::move(bottom), delay});
  };
  EXPECT_EQ(closed({{1.57, 0}}, {{1, 1}}, 1).stability, Stability::stable);
  EXPECT_EQ(closed({{1.572, 0}}, {{1, 1}}, 1).unstable_poles, 2);
  // Pairs cross at K L = pi/2 + 2 pi k.
  EXPECT_EQ(closed({{20, 0}}, {{1, 1}}, 1).unstable_poles, 6);
  double w = 2;
  for (int i = 0; i < 100; ++i) w = pi - std::atan(w);
  const double limit = std::sqrt(1 + w * w);
  EXPECT_EQ(closed({{0.999 * limit, 0}}, {{1, 1}, {1, 0}}, 1).stability, Stability::stable);
  EXPECT_EQ(closed({{1.001 * limit, 0}}, {{1, 1}, {1, 0}}, 1).unstable_poles, 2);
  // w = tan(pi - a pi/2) for a > 1: K = w^a sqrt(1 + w^2).
  const double a = 1.4;
  const double crossing = std::tan(pi - a * pi / 2);
  const double critical = std::pow(crossing, a) * std::sqrt(1 + crossing * crossing);
  EXPECT_EQ(closed({{0.999 * critical, 0}}, {{1, 1 + a}, {1, a}}, 0).stability, Stability::stable);
  EXPECT_EQ(closed({{1.001 * critical, 0}}, {{1, 1 + a}, {1, a}}, 0).unstable_poles, 2);
  support::expect_invalid_argument([&] { (void)closed({{2, 0}}, {{1, 0}}, 1); }, {"tends to 2"});
}

// s^2 + 0.01 s + 1e4 + 10 e^{-L s}: only about 100 rad/s does the last term exceed the others.  There the delay turns
// it by -100 L, a quarter turn takes 10/100 from the damping of 0.01 and three quarters add it.
// 1 + K e^{-Ts}/s^a has its first root on the axis at omega T = pi (1 - a/2), where K = omega^a.  s - 1 + K e^{-Ts} has
// one at 0 for K = 1 and the next where atan(omega) = omega T, K = sqrt(1 + omega^2).
TEST(Stability, OfClosedLoopsWithDeadTime) {
  const auto stability = [](const std::string& forward, const std::string& loop) {
    const frac::DelayedLoop closed{frac::FractionalTransferFunction::parse(forward),
                                   frac::FractionalTransferFunction::parse(loop)};
    return frac::analyse_closed_loop(closed).stability;
  };
  const double delay = 0.7;
  for (const double order : {0.5, 0.9, 1.0, 1.4}) {
    const double limit = std::pow(std::numbers::pi * (1 - order / 2) / delay, order);
    for (const auto& [gain, expected] :
         {std::pair{0.999 * limit, frac::Stability::stable}, std::pair{1.001 * limit, frac::Stability::unstable}}) {
      const std::string power = "s^" + std::to_string(order);
      const std::string loop = std::to_string(gain) + " exp(-0.7 s)/" + power;
      EXPECT_EQ(stability(loop, loop), expected) << loop;
      EXPECT_EQ(stability("1/" + power, loop), expected) << loop;  // a disturbance behind the controller
      EXPECT_EQ(stability("1/(s + 1)", loop), expected) << loop;   // a filter in front
      EXPECT_EQ(stability("s " + power + "/" + power, loop),
                expected == frac::Stability::stable ? frac::Stability::differentiating : expected)
          << loop;
    }
  }
  double omega = 14;  // of atan(omega) = 0.1 omega
  for (int i = 0; i < 100; ++i) omega = 10 * std::atan(omega);
  const double limit = std::sqrt(1 + omega * omega);
  for (const double gain : {0.99, 1.01, 0.99 * limit, 1.01 * limit}) {
    const std::string loop = std::to_string(gain) + " exp(-0.1 s)/(s - 1)";
    const auto expected = gain > 1 && gain < limit ? frac::Stability::stable : frac::Stability::unstable;
    EXPECT_EQ(stability("1/(s - 1)", loop), expected) << loop;
    EXPECT_EQ(stability("(s + 3)/(s - 1)^2", loop), frac::Stability::unstable)
        << loop;  // one more pole than the loop has
  }
  // What stands in front of a loop stays: nothing in the loop moves it.
  EXPECT_EQ(stability("1/(s - 1)", "exp(-s)/(s + 2)"), frac::Stability::unstable);
  EXPECT_EQ(stability("1/(s^2 + 1)", "exp(-s)/(s + 2)"), frac::Stability::marginal);
  EXPECT_EQ(stability("1/s", "exp(-s)/(s + 2)"), frac::Stability::integrating);
  EXPECT_EQ(stability("1/(s + 5)", "exp(-s)/(s + 2)"), frac::Stability::stable);
}

TEST(Stability, OfALoopThatExceedsOneAtAResonanceOnly) {
  const auto closed = [](double delay) {
    return frac::analyse_closed_loop({{{10, 0}}, {{1, 2}, {0.01, 1}, {1e4, 0}}, delay});
  };
  EXPECT_EQ(closed(0).stability, Stability::stable);
  EXPECT_EQ(closed(pi / 200).unstable_poles, 2);
  EXPECT_EQ(closed(3 * pi / 200).stability, Stability::stable);
}

// K e^{-L s}/s^a: a pair of roots for each omega_k = (pi - a pi/2 + 2 pi k)/L with omega_k^a < K.
TEST(Stability, OfSlowlyFallingLoopsWithDeadTime) {
  for (const double a : {0.2, 0.25, 0.3}) {
    for (const double delay : {0.1, 1.0, 3.0}) {
      for (const int k : {0, 1, 5}) {
        const double critical = std::pow((pi - a * pi / 2 + 2 * pi * k) / delay, a);
        const auto below = frac::analyse_closed_loop({{{0.999 * critical, 0}}, {{1, a}}, delay});
        EXPECT_EQ(below.unstable_poles, 2 * k) << a << " " << delay;
        EXPECT_EQ(below.stability, k == 0 ? Stability::stable : Stability::unstable) << a << " " << delay;
        const auto above = frac::analyse_closed_loop({{{1.001 * critical, 0}}, {{1, a}}, delay});
        EXPECT_EQ(above.unstable_poles, 2 * k + 2) << a << " " << delay;
      }
    }
  }
  // |L| is 1 at 1e15 rad/s.
  EXPECT_EQ(frac::analyse_closed_loop(model("1000 exp(-1 s)/s^0.2")).stability, Stability::undetermined);
}

// s^(1 + e) + s + 1 + K is s (1 + s^e) + 1 + K, for small e nearly 2 s + 1 + K.  s^e = -3 has no root on the principal
// sheet.
TEST(Stability, OfLoopsWhereTwoOrdersNearlyCoincide) {
  for (const double e : {1e-3, 1e-5, 1e-7, 1e-9, 1e-11}) {
    EXPECT_EQ(frac::analyse_closed_loop({{{1, 0}}, {{1, 1 + e}, {1, 1}, {1, 0}}}).stability, Stability::stable) << e;
    EXPECT_EQ(frac::analyse_closed_loop({{{-2, 0}}, {{1, 1 + e}, {1, 1}, {1, 0}}}).unstable_poles, 1) << e;
    EXPECT_EQ(frac::analyse_closed_loop({{{1, 0}}, {{1, 1 + e}, {1, 1}, {1, 0}}, 0.1}).stability, Stability::stable)
        << e;
  }
  EXPECT_EQ(frac::analyse_closed_loop(model("3/s^0.001")).stability, Stability::stable);
}

// K e^{-L s}/s^a: |L| = 1 at omega_c = K^(1/a) with phase -a pi/2 - L omega_c; real and negative at omega_k = (pi - a
// pi/2 + 2 pi k)/L with factor omega_k^a/K.
TEST(Stability, MarginsOfAPowerWithDeadTime) {
  struct Loop {
    double gain, delay, order;
  };
  for (const Loop& loop : {Loop{1, 0.1, 0.25}, Loop{1, 1, 0.2}, Loop{2, 1, 0.2}, Loop{5, 0.5, 0.3}, Loop{10, 1, 0.3},
                           Loop{10, 1, 0.2}, Loop{30, 2, 0.25}, Loop{1e-3, 1, 1}, Loop{3, 20, 0.1}}) {
    const std::string name =
        std::to_string(loop.gain) + " " + std::to_string(loop.delay) + " " + std::to_string(loop.order);
    const frac::Margins found = frac::margins({{{loop.gain, 0}}, {{1, loop.order}}, loop.delay});
    const double crossover = std::pow(loop.gain, 1 / loop.order);
    ASSERT_EQ(found.phase.size(), 1u) << name;
    // ln omega is found to a few roundings of ln K over a.
    const double accuracy = 1e-14 * (1 + std::abs(std::log(loop.gain))) / loop.order;
    EXPECT_NEAR(found.phase[0].omega / crossover, 1, accuracy) << name;
    const double exact_phase = std::remainder(pi - loop.order * pi / 2 - loop.delay * crossover, 2 * pi);
    EXPECT_NEAR(found.phase[0].margin, exact_phase, 1e-14 + accuracy * loop.delay * crossover) << name;
    EXPECT_DOUBLE_EQ(found.phase_margin, std::abs(found.phase[0].margin)) << name;
    const double first = pi - loop.order * pi / 2;
    const double k = std::max(0.0, std::ceil((loop.delay * crossover - first) / (2 * pi)));
    const auto factor = [&](double turns) {
      return std::pow((first + 2 * pi * turns) / loop.delay, loop.order) / loop.gain;
    };
    EXPECT_NEAR(found.gain_margin / factor(k), 1, 1e-12) << name;
    EXPECT_NEAR(found.gain_reduction, k > 0 ? factor(k - 1) : 0, 1e-12) << name;
    // Those that decide are in the list, which begins with the first.
    std::size_t deciding = 0;
    for (const frac::Crossover& listed : found.gain) {
      deciding += listed.margin == found.gain_margin || listed.margin == found.gain_reduction ? 1 : 0;
    }
    EXPECT_EQ(deciding, k > 0 ? 2u : 1u) << name;
    EXPECT_LE(found.gain.size(), 1100u) << name;
    EXPECT_EQ(found.remark.empty(), loop.order == 1) << name << found.remark;
  }
  // Rounding of 1e20 rad leaves no phase, but a gain margin of 1.
  const frac::Margins blurred = frac::margins({{{10, 0}}, {{1, 0.05}}, 1});
  EXPECT_TRUE(std::isnan(blurred.phase_margin));
  EXPECT_NE(blurred.remark.find("not determined"), std::string::npos) << blurred.remark;
  EXPECT_NEAR(blurred.gain_margin, 1, 1e-10);
  EXPECT_NEAR(blurred.gain_reduction, 1, 1e-10);
}

// K e^{-s}/(s^0.2 + 1) with x = omega^0.2, c = cos(0.1 pi): |L| = 1 where x^2 + 2 c x + 1 = K^2, and the phase is
// -omega - atan2(x sin(0.1 pi), 1 + x c), whose second part hardly changes: omega_k by fixed-point iteration.
TEST(Stability, MarginsOfASlowLagWithDeadTime) {
  const double c = std::cos(0.1 * pi);
  const auto lag = [&](double omega) {
    const double x = std::pow(omega, 0.2);
    return std::atan2(x * std::sin(0.1 * pi), 1 + x * c);
  };
  for (const double gain : {0.5, 1.0, 2.5, 4.0, 8.0}) {
    const frac::Margins found = frac::margins({{{gain, 0}}, {{1, 0.2}, {1, 0}}, 1});
    const double crossover = gain > 1 ? std::pow(std::sqrt(c * c + gain * gain - 1) - c, 5) : 0;
    ASSERT_EQ(found.phase.size(), gain > 1 ? 1u : 0u) << gain;
    if (gain > 1) {
      // A rounding of |L| moves omega by about 5 to 50 of its own.
      EXPECT_NEAR(found.phase[0].omega / crossover, 1, 1e-13) << gain;
      EXPECT_NEAR(found.phase[0].margin, std::remainder(pi - crossover - lag(crossover), 2 * pi),
                  1e-13 * (1 + crossover))
          << gain;
    } else {
      EXPECT_EQ(found.phase_margin, infinity) << gain;
    }
    double above = infinity;
    double below = 0;
    for (int k = 0; above == infinity; ++k) {
      double omega = pi * (1 + 2 * k);
      for (int i = 0; i < 60; ++i) omega = pi * (1 + 2 * k) - lag(omega);
      const double x = std::pow(omega, 0.2);
      const double factor = std::sqrt(x * x + 2 * c * x + 1) / gain;
      (factor < 1 ? below : above) = factor;
    }
    EXPECT_NEAR(found.gain_margin, above, 1e-12) << gain;
    EXPECT_NEAR(found.gain_reduction, below, 1e-12) << gain;
  }
}

TEST(Stability, MarginsAreTheRoots) {
  // 1/(s (s + 1)^2): phase -pi at 1, gain 1/2.
  const frac::Margins third = frac::margins(model("1/(s^3 + 2 s^2 + s)"));
  ASSERT_EQ(third.gain.size(), 1u);
  EXPECT_NEAR(third.gain[0].omega, 1, 1e-12);
  EXPECT_NEAR(third.gain_margin, 2, 1e-12);
  EXPECT_EQ(third.gain_reduction, 0);
  // w (1 + w^2) = 1.
  const double w = 0.6823278038280193;
  ASSERT_EQ(third.phase.size(), 1u);
  EXPECT_NEAR(third.phase[0].omega, w, 1e-12);
  EXPECT_NEAR(third.phase_margin, pi / 2 - 2 * std::atan(w), 1e-12);
  EXPECT_NEAR(third.delay_margin, third.phase_margin / w, 1e-12);

  // K/s^a: phase margin pi (1 - a/2) at K^(1/a), no gain margin.
  const frac::Margins power = frac::margins(model("5/s^1.3"));
  EXPECT_NEAR(power.phase_margin, pi * 0.35, 1e-12);
  EXPECT_NEAR(power.phase.at(0).omega, std::pow(5, 1 / 1.3), 1e-11);
  EXPECT_EQ(power.gain_margin, infinity);

  // e^{-s}/s: real and negative at pi/2 + 2 pi k with |L| = 1/w.
  const frac::Margins late = frac::margins(model("exp(-1 s)/s"));
  EXPECT_NEAR(late.gain_margin, pi / 2, 1e-12);
  EXPECT_NEAR(late.phase_margin, pi / 2 - 1, 1e-12);
  ASSERT_GE(late.gain.size(), 100u);
  for (std::size_t k = 0; k < 100; ++k) {
    EXPECT_NEAR(late.gain[k].omega, pi / 2 + 2 * pi * static_cast<double>(k), 1e-9);
  }

  // Conditionally stable: real and negative twice, once below and once above 1.
  const frac::Margins conditional = frac::margins(model("(300 s^2 + 600 s + 300)/(s^5 + 20 s^4 + 100 s^3)"));
  EXPECT_GT(conditional.gain_margin, 1);
  EXPECT_LT(conditional.gain_reduction, 1);
  EXPECT_GT(conditional.gain_reduction, 0);
}

// (s^2 + a s + b)/(s^2 + c s + d) has |L| = 1 where w^2 (a^2 - 2 b - c^2 + 2 d) = d^2 - b^2, here a hundred times above
// its corners, where |L|^2 - 1 changes by 6e-8 per e-fold of w: rounding of |L| moves the crossover by some 1e-8.
TEST(Stability, AGainCrossoverFarAboveTheCorners) {
  const double b = 1, c = 3, d = 2, crossover = 100;
  const double a = std::sqrt(2 * b + c * c - 2 * d + (d * d - b * b) / (crossover * crossover));
  const frac::Margins margins = frac::margins({{{1, 2}, {a, 1}, {b, 0}}, {{1, 2}, {c, 1}, {d, 0}}});
  ASSERT_EQ(margins.phase.size(), 1u);
  EXPECT_NEAR(margins.phase[0].omega, crossover, 1e-7 * crossover);
}

// A zero one part in 10^4 beside a pole cancels nothing.
TEST(Stability, OnlyAZeroOnThePoleCancelsIt) {
  const auto cancelled = [](const char* formula) {
    for (const frac::Pole& pole : frac::analyse_stability(model(formula)).poles)
      if (std::abs(pole.value + 1.0) < 1e-9) return pole.cancelled;
    ADD_FAILURE() << formula << ": no pole at -1";
    return false;
  };
  EXPECT_TRUE(cancelled("(s + 1)/(s^2 + 3 s + 2)"));
  EXPECT_FALSE(cancelled("(s + 1.0001)/(s^2 + 3 s + 2)"));
}

// N + D is s, s^0.5 or s (s + 3): a root at s = 0 and no other right of the axis.
TEST(Stability, APoleOfTheClosedLoopAtTheOriginIsMarginal) {
  for (const char* formula :
       {"1/(s - 1)", "-1/(s + 1)", "1/(s^0.5 - 1)", "-1/(s^0.5 + 1)", "(s - 1)/(s + 1)^2", "0.3/(s - 0.1 - 0.2)",
        "-s/(s^2 + s)", "exp(-0.1 s)*1/(s - 1)", "exp(-0.1 s)*(s - 1)/(s + 1)^2", "exp(-1 s)*(-1)/(s^0.5 + 1)"}) {
    const auto found = frac::analyse_closed_loop(model(formula));
    EXPECT_EQ(found.stability, Stability::marginal) << formula;
    EXPECT_EQ(found.unstable_poles, 0) << formula;
  }
  // All of N + D cancels to rounding.
  support::expect_invalid_argument(
      [] {
        (void)frac::analyse_closed_loop({{{-1 + 4e-16, 0}}, {{1, 0}}});
      },
      {"allowed is below 1"});
  // s (s - 1), and e^{-T s} + s - 1 = s (1 - T + T^2 s/2 - ...), which grows from -0 to infinity for T > 1.
  for (const char* formula : {"1/(s^2 - s - 1)", "exp(-1.1 s)*1/(s - 1)", "exp(-2 s)*1/(s - 1)"}) {
    const auto found = frac::analyse_closed_loop(model(formula));
    EXPECT_EQ(found.stability, Stability::unstable) << formula;
    EXPECT_EQ(found.unstable_poles, 1) << formula;
  }
}

// K e^{-T s}/(s^a - 1) without or with a short dead time has one root, near (1 - K)^(1/a) or (1 - K)/(1 - T): right of
// the axis for K < 1.
TEST(Stability, OfClosedLoopsWithAPoleNextToTheOrigin) {
  for (const double order : {0.5, 1.0}) {
    for (const double delay : {0.0, 0.1}) {
      for (const double distance : {1e-2, 1e-4, 1e-8, 1e-12}) {
        const auto closed = [&](double gain) {
          return frac::analyse_closed_loop({{{gain, 0}}, {{1, order}, {-1, 0}}, delay});
        };
        EXPECT_EQ(closed(1 - distance).unstable_poles, 1) << order << " " << delay << " " << distance;
        EXPECT_EQ(closed(1 - distance).stability, Stability::unstable) << order << " " << delay << " " << distance;
        EXPECT_EQ(closed(1 + distance).stability, Stability::stable) << order << " " << delay << " " << distance;
      }
    }
  }
}

// The factor 1/|L(0)| puts a root of D + K N at s = 0.  On the way through it the number of roots right of the axis
// changes by one.
TEST(Stability, ANegativeLimitAtTheOriginIsAPhaseCrossover) {
  struct Loop {
    const char* formula;
    double factor;
    bool stable_above;
  };
  for (const Loop& loop :
       {Loop{"2/(s - 1)", 0.5, true}, Loop{"1/(s - 0.5)", 0.5, true}, Loop{"4/(s - 1)", 0.25, true},
        Loop{"exp(-0.1 s)*2/(s - 1)", 0.5, true}, Loop{"2/(s^0.5 - 1)", 0.5, true}, Loop{"-0.5/(s + 1)", 2, false},
        Loop{"0.5 (s - 1)/(s + 1)^2", 2, false}, Loop{"-2/(s + 1)", 0.5, false}, Loop{"-0.5/(s^0.5 + 1)", 2, false}}) {
    const auto transfer = model(loop.formula);
    const frac::Margins found = frac::margins(transfer);
    ASSERT_FALSE(found.gain.empty()) << loop.formula;
    EXPECT_EQ(found.gain.front().omega, 0) << loop.formula;
    // 1/|L(0)| takes two divisions.
    EXPECT_DOUBLE_EQ(found.gain.front().margin, loop.factor) << loop.formula;
    EXPECT_DOUBLE_EQ(loop.factor < 1 ? found.gain_reduction : found.gain_margin, loop.factor) << loop.formula;
    const auto closed = [&](double gain) { return frac::analyse_closed_loop(gain * transfer); };
    const auto below = closed(0.999 * loop.factor);
    const auto above = closed(1.001 * loop.factor);
    EXPECT_EQ(closed(loop.factor).stability, Stability::marginal) << loop.formula;
    EXPECT_EQ(below.stability, loop.stable_above ? Stability::unstable : Stability::stable) << loop.formula;
    EXPECT_EQ(above.stability, loop.stable_above ? Stability::stable : Stability::unstable) << loop.formula;
    EXPECT_EQ(below.unstable_poles + above.unstable_poles, 1) << loop.formula;
  }
  // The other margin of the one with dead time: its phase -pi + atan w - 0.1 w is -pi again at w = 10 atan w.
  double w = 15;
  for (int i = 0; i < 200; ++i) w = 10 * std::atan(w);
  EXPECT_NEAR(frac::margins(model("exp(-0.1 s)*2/(s - 1)")).gain_margin, std::sqrt(1 + w * w) / 2, 1e-12);
  // At factor 1 the loop is on the margin; a positive limit is none.
  EXPECT_EQ(frac::margins(model("1/(s - 1)")).gain_margin, 1);
  EXPECT_TRUE(frac::margins(model("0.5/(s + 1)")).gain.empty());
  EXPECT_TRUE(frac::margins(model("-1/s")).gain.empty());
}

// s + 2 - K (s + 1)/2: the root -(2 - K/2)/(1 - K/2) passes through infinity at K = 2 and through 0 at 4.
// The phase of (0.549 - 1.962 jw)/(0.372 - 2.988 w^2) lies in (-90, 0) degrees below the pole and in (90, 180) above.
TEST(Stability, AnUndampedPoleIsNoPhaseCrossover) {
  const frac::Margins found = frac::margins(model("(0.549 - 1.962 s)/(2.988 s^2 + 0.372)"));
  EXPECT_TRUE(found.gain.empty());
  EXPECT_EQ(found.gain_margin, infinity);
  EXPECT_EQ(found.gain_reduction, 0);
  // With a damping ratio of 1e-6 the phase passes -180 degrees next to the pole of 2/(s^2 + 2e-6 s + 1)/(s + 1): where
  // its imaginary part 2e-6 w + w (1 - w^2) is 0, w^2 = 1 + 2e-6.
  const frac::Margins damped = frac::margins(model("2/((s^2 + 2e-6 s + 1) (s + 1))"));
  ASSERT_EQ(damped.gain.size(), 1u);
  EXPECT_NEAR(damped.gain[0].omega, std::sqrt(1 + 2e-6), 1e-12);
}

TEST(Stability, ANegativeLimitAtInfinityIsAPhaseCrossover) {
  const auto transfer = model("-0.5 (s + 1)/(s + 2)");
  const frac::Margins found = frac::margins(transfer);
  ASSERT_EQ(found.gain.size(), 2u);
  EXPECT_EQ(found.gain[0].omega, 0);
  EXPECT_DOUBLE_EQ(found.gain[0].margin, 4);
  EXPECT_EQ(found.gain[1].omega, infinity);
  EXPECT_DOUBLE_EQ(found.gain[1].margin, 2);
  EXPECT_DOUBLE_EQ(found.gain_margin, 2);
  EXPECT_EQ(found.gain_reduction, 0);
  EXPECT_EQ(frac::analyse_closed_loop(0.999 * 2 * transfer).stability, Stability::stable);
  // Above, |L| does not fall below 1.
  const auto closed = [&](double gain) {
    return frac::analyse_stability(frac::feedback(gain * transfer, FractionalTransferFunction({{1, 0}}, {{1, 0}})))
        .stability;
  };
  EXPECT_EQ(closed(1.999), Stability::stable);
  EXPECT_EQ(closed(2.001), Stability::unstable);
  EXPECT_EQ(closed(3.999), Stability::unstable);
  EXPECT_EQ(closed(4.001), Stability::stable);
}

TEST(Stability, HardSystems) {
  for (const std::string& formula : support::hard_systems()) {
    const auto analysis = frac::analyse_stability(FractionalTransferFunction::parse(formula));
    EXPECT_NE(analysis.stability, Stability::undetermined) << formula;
    const bool grows = formula == "1/(s^1.2 - 2)" || formula == "1/(s^3.5 + 1)";
    EXPECT_EQ(analysis.stability == Stability::unstable, grows) << formula;
  }
}
