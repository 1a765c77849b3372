#include "frac/stability.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <string>

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

FractionalTransferFunction model(const char* formula) {
  return FractionalTransferFunction::parse(formula);
}

Stability stability(const char* formula) {
  return frac::analyse_stability(model(formula)).stability;
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

// 1/(s^2 + 2 z s + 1): 1/(2 z sqrt(1 - z^2)) at sqrt(1 - 2 z^2), and 1/sqrt(4 z).
TEST(Stability, NormsOfTheOscillator) {
  for (const double z : {1e-6, 1e-3, 0.1, 0.5, 0.9}) {
    const FractionalTransferFunction oscillator({{1, 0}}, {{1, 2}, {2 * z, 1}, {1, 0}});
    const frac::PeakGain peak = frac::h_infinity_norm(oscillator);
    const bool resonant = 2 * z * z < 1;
    // At z = 1e-6 the rounding of omega^2 - 1 is 1e-10 of 2 z omega.
    EXPECT_NEAR(peak.gain / (resonant ? 1 / (2 * z * std::sqrt(1 - z * z)) : 1), 1, 1e-9) << z;
    if (resonant) {
      EXPECT_NEAR(peak.omega, std::sqrt(1 - 2 * z * z), 1e-6 * z + 1e-7) << z;
    } else {
      EXPECT_EQ(peak.omega, 0);
    }
    EXPECT_NEAR(frac::h2_norm(oscillator) * std::sqrt(4 * z), 1, z < 1e-4 ? 1e-9 : 1e-12) << z;
  }
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

TEST(Stability, HardSystems) {
  for (const std::string& formula : support::hard_systems()) {
    const auto analysis = frac::analyse_stability(FractionalTransferFunction::parse(formula));
    EXPECT_NE(analysis.stability, Stability::undetermined) << formula;
    const bool grows = formula == "1/(s^1.2 - 2)" || formula == "1/(s^3.5 + 1)";
    EXPECT_EQ(analysis.stability == Stability::unstable, grows) << formula;
  }
}
