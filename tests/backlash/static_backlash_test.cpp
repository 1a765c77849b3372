// SPDX-License-Identifier: BSD-3-Clause
#include "backlash/static_backlash.hpp"

#include <gtest/gtest.h>

#include <boost/math/quadrature/gauss_kronrod.hpp>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>

#include "support/expect_invalid_argument.hpp"

namespace {

using support::expect_invalid_argument;

constexpr double pi = std::numbers::pi;
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

// Output of a play of width `clearance` driven by X cos(theta), steady state: at rest while the input crosses the play
// after a turn.
double play_output(double gain, double clearance, double amplitude, double theta) {
  const double half = clearance / 2;
  const double input = amplitude * std::cos(theta);
  return theta < pi ? gain * std::min(amplitude - half, std::max(input + half, -(amplitude - half)))
                    : gain * std::max(-(amplitude - half), std::min(input - half, amplitude - half));
}

std::complex<double> by_quadrature(double gain, double clearance, double amplitude) {
  using Quadrature = boost::math::quadrature::gauss_kronrod<double, 31>;
  // Smooth pieces: the output stands still from each turn until the input has crossed the play.
  const double crossing = std::acos(1 - clearance / amplitude);
  const double ends[] = {0, crossing, pi, pi + crossing, 2 * pi};
  std::complex<double> sum = 0;
  for (int i = 0; i < 4; ++i) {
    const auto part = [&](auto weight) {
      return Quadrature::integrate([&](double t) { return play_output(gain, clearance, amplitude, t) * weight(t); },
                                   ends[i], ends[i + 1], 15, 1e-14);
    };
    sum +=
        std::complex<double>(part([](double t) { return std::cos(t); }), -part([](double t) { return std::sin(t); }));
  }
  return sum / (pi * amplitude);
}

TEST(StaticBacklash, EqualsTheFourierIntegralOfThePlay) {
  for (const double gain : {0.2, 1.0, 7.0}) {
    for (const double ratio : {0.5001, 0.51, 0.6, 0.75, 1.0, 1.7, 5.0, 1e3}) {
      const double clearance = 0.3;
      const std::complex<double> value = backlash::static_backlash(gain, clearance, ratio * clearance);
      // Quadrature of smooth pieces to 1e-14 of values below the gain.
      EXPECT_LT(std::abs(value - by_quadrature(gain, clearance, ratio * clearance)), 1e-13 * gain) << ratio;
    }
  }
}

TEST(StaticBacklash, VanishesWithinThePlayAndBecomesTheGainFarOutside) {
  EXPECT_EQ(backlash::static_backlash(2, 0.3, 0.15), 0.0);
  EXPECT_EQ(backlash::static_backlash(2, 0.3, 1e-6), 0.0);
  EXPECT_EQ(backlash::static_backlash(2, 0, 1e-6), 2.0);
  // Large X: Re -> k, Im -> -2 k clearance/(pi X) to first order in clearance/X = 1e-9.
  const std::complex<double> far = backlash::static_backlash(2, 1e-9, 1);
  EXPECT_NEAR(far.real(), 2, 1e-12);
  EXPECT_NEAR(far.imag() / (-4e-9 / pi), 1, 1e-9);
}

TEST(StaticBacklash, FollowsItsExpansionWhereTheOutputOnlyJustMoves) {
  // X = (1/2 + d) clearance, d -> 0: 1 + u = 4 d, Re -> (4 sqrt 2/3) (1 + u)^(3/2)/pi and Im -> -8 d/pi; the next terms
  // are smaller by a few d, and Re is left over from terms larger by 1/d.
  const double d = 0x1p-30;
  const std::complex<double> value = backlash::static_backlash(1, 1, 0.5 + d);
  EXPECT_NEAR(value.imag() / (-8 * d / pi), 1, 10 * d);
  EXPECT_NEAR(value.real() / (32 * std::sqrt(2.0) / 3 / pi * std::pow(d, 1.5)), 1, 1e-4);
}

TEST(StaticBacklash, NamesWhatIsOutOfRange) {
  expect_invalid_argument([] { (void)backlash::static_backlash(0, 0.3, 1); }, {"gain"});
  expect_invalid_argument([] { (void)backlash::static_backlash(nan, 0.3, 1); }, {"gain"});
  expect_invalid_argument([] { (void)backlash::static_backlash(1, -0.3, 1); }, {"clearance", "-0.3"});
  expect_invalid_argument([] { (void)backlash::static_backlash(1, 0.3, 0); }, {"amplitude"});
  expect_invalid_argument([] { (void)backlash::static_backlash(1, 0.3, nan); }, {"amplitude"});
}

TEST(StaticDescribingFunction, IsThePlayInSeriesWithTheRigidMass) {
  const std::vector<double> omega = {1, 3, 8};
  const auto value = backlash::static_describing_function(1, 3, 0.3, 40, omega);
  for (std::size_t i = 0; i < omega.size(); ++i) {
    const double inertia = 4 * omega[i] * omega[i];
    const std::complex<double> expected = -by_quadrature(1, 0.3, 40 / inertia) / inertia;
    EXPECT_LT(std::abs(value[i] - expected), 1e-13 / inertia);
  }
}

TEST(StaticDescribingFunction, ImaginaryPartIsFlatAtLowFrequencyAndTheInverseRisesWith80DecibelsPerDecade) {
  // X = F/(M w^2) >> clearance: Im N -> 2 clearance/(pi F), so Im(-1/N) = Im N/|N|^2 -> M^2 w^4 Im N; next term
  // relative clearance/X.
  const double clearance = 0.3;
  const auto value = backlash::static_describing_function(1, 1, clearance, 40, {1e-3, 1e-2});
  EXPECT_NEAR(value[0].imag(), 2 * clearance / (pi * 40), 1e-7 * clearance);
  const double slope = std::log10((-1.0 / value[1]).imag() / (-1.0 / value[0]).imag());
  EXPECT_NEAR(slope, 4, 1e-5);
}

TEST(StaticDescribingFunction, NamesWhatIsOutOfRange) {
  const auto call = [](double m1, double m2, double clearance, double force, const std::vector<double>& omega) {
    return [=] { (void)backlash::static_describing_function(m1, m2, clearance, force, omega); };
  };
  expect_invalid_argument(call(0, 1, 0.3, 1, {1}), {"mass1"});
  expect_invalid_argument(call(1, -1, 0.3, 1, {1}), {"mass2"});
  expect_invalid_argument(call(1, 1, nan, 1, {1}), {"clearance"});
  expect_invalid_argument(call(1, 1, 0.3, 0, {1}), {"force_amplitude"});
  expect_invalid_argument(call(1, 1, 0.3, 1, {}), {"omega", "empty"});
  expect_invalid_argument(call(1, 1, 0.3, 1, {0, 1}), {"omega[0]", "positive"});
  expect_invalid_argument(call(1, 1, 0.3, 1, {1, 3, 2}), {"omega[2]", "omega[1]"});
}

}  // namespace
