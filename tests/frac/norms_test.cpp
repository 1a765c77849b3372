// SPDX-License-Identifier: BSD-3-Clause
// Norms of lightly damped models against residues and closed forms in a hundred digits.
#include <gtest/gtest.h>

#include <boost/math/constants/constants.hpp>
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <boost/multiprecision/cpp_complex.hpp>
#include <cmath>
#include <string>
#include <vector>

#include "frac/model/fractional_transfer_function.hpp"
#include "frac/stability.hpp"
#include "support/random.hpp"

namespace {

using frac::FractionalTransferFunction;
using frac::PowerFactor;
using Long = boost::multiprecision::cpp_bin_float_100;
using LongComplex = boost::multiprecision::cpp_complex_100;
using support::Random;

/// s^2 + first s + constant.
struct Quadratic {
  double first;
  double constant;
};

/// (lead s + 1)/product of the quadratics.
struct Resonances {
  double lead;
  std::vector<Quadratic> quadratics;

  [[nodiscard]] FractionalTransferFunction model() const {
    std::vector<PowerFactor> bottom;
    for (const auto& [first, constant] : quadratics) bottom.push_back({{{1, 2}, {first, 1}, {constant, 0}}, 1});
    return FractionalTransferFunction::from_factors({{{{lead, 1}, {1, 0}}, 1}}, bottom);
  }
};

// (1/2 pi) int |G|^2 over the whole axis is the sum of the residues of G(s) G(-s) at the poles of G.
Long square_norm(const Resonances& model) {
  const auto quadratic = [](const Quadratic& each, const LongComplex& s) {
    return LongComplex(s * s + Long(each.first) * s + Long(each.constant));
  };
  const auto numerator = [&](const LongComplex& s) { return LongComplex(Long(model.lead) * s + 1); };
  Long sum = 0;
  for (std::size_t i = 0; i < model.quadratics.size(); ++i) {
    const Long half = Long(model.quadratics[i].first) / 2;
    const LongComplex pole(-half, sqrt(Long(model.quadratics[i].constant) - half * half));
    LongComplex slope = 2 * pole + Long(model.quadratics[i].first);
    LongComplex mirrored = 1;
    for (std::size_t k = 0; k < model.quadratics.size(); ++k) {
      if (k != i) slope *= quadratic(model.quadratics[k], pole);
      mirrored *= quadratic(model.quadratics[k], LongComplex(-pole));
    }
    sum += 2 * LongComplex(numerator(pole) * numerator(LongComplex(-pole)) / (slope * mirrored)).real();
  }
  return sum;
}

// Up to four resonances with damping ratios down to the 1e-9 at which a pole begins to count as one on the axis, some
// of them next to each other.
Resonances random_resonances(Random& random) {
  Resonances result{random.log_uniform(1e-2, 1e2), {}};
  const std::size_t count = 1 + random.below(4);
  for (std::size_t i = 0; i < count; ++i) {
    const double damping = random.log_uniform(2e-9, 0.3);
    double frequency = random.log_uniform(0.03, 30);
    if (i > 0 && random.below(2) == 0) {
      const double apart = random.log_uniform(1e-6, 0.1);
      frequency = std::sqrt(result.quadratics.back().constant) * (1 + apart);
    }
    result.quadratics.push_back({2 * damping * frequency, frequency * frequency});
  }
  return result;
}

// 1e-12 is what the header states.
TEST(Norms, SquareNormOfRandomResonancesIsTheSumOfResidues) {
  Random random(71204);
  for (int trial = 0; trial < 120; ++trial) {
    const Resonances resonances = random_resonances(random);
    const auto model = resonances.model();
    const double exact = static_cast<double>(sqrt(square_norm(resonances)));
    EXPECT_NEAR(frac::h2_norm(model) / exact, 1, 1e-12) << model.formula();
  }
}

// 1/(s^a + 1) with a = 2 - x has the damping ratio pi x/4 to first order, and
// (1/pi) int_0^inf |G|^2 = sin((1 - 1/a) a pi/2)/(a sin(a pi/2) sin(pi/a)).
TEST(Norms, SquareNormOfAnOrderJustBelowTwo) {
  const Long pi = boost::math::constants::pi<Long>();
  for (const double below : {1e-8, 3.3e-7, 1e-5, 1e-3, 0.1}) {
    const double order = 2 - below;
    const FractionalTransferFunction model({{1, 0}}, {{1, order}, {1, 0}});
    const Long a = order;
    const Long square = sin((1 - 1 / a) * a * pi / 2) / (a * sin(a * pi / 2) * sin(pi / a));
    EXPECT_NEAR(frac::h2_norm(model) / static_cast<double>(sqrt(square)), 1, 1e-12) << below;
  }
}

// 1/(2 z sqrt(1 - z^2)) at sqrt(1 - 2 z^2); the square norm is 1/(4 z).
TEST(Norms, OfAnOscillatorAtAnyDamping) {
  for (const double z : {0x1p-28, 0x1p-24, 0x1p-17, 0x1p-10, 0x1p-4, 0.5}) {
    const FractionalTransferFunction oscillator({{1, 0}}, {{1, 2}, {2 * z, 1}, {1, 0}});
    EXPECT_NEAR(frac::h2_norm(oscillator) * std::sqrt(4 * z), 1, 1e-14) << z;
    // The place of the peak is known to the rounding of omega, which over the width 2 z is squared.
    const double tolerance = 1e-14 + std::pow(1e-15 / z, 2);
    EXPECT_NEAR(frac::h_infinity_norm(oscillator).gain * 2 * z * std::sqrt(1 - z * z), 1, tolerance) << z;
  }
}

// G(s 2^k) has the peak gain of G at 2^-k of its frequency.  Orders are sixteenths and k a multiple of 16, so that the
// coefficients are scaled without rounding, and both sides differ by the rounding of ln omega alone: 14 to 28 of 2^-53,
// which over the distance of a pole from the axis, a hundredth here, and squared is 1e-23, beside that of the sums.
TEST(Norms, PeakGainDoesNotDependOnWhereTheModelLies) {
  Random random(390501);
  int beyond = 0;
  for (int trial = 0; trial < 60; ++trial) {
    const auto sixteenths = [&](std::size_t from, std::size_t to) {
      return static_cast<double>(from + random.below(to - from)) / 16;
    };
    const double high = sixteenths(17, 31), low = high - sixteenths(1, 16);
    const double lead = random.log_uniform(0.01, 10), b1 = random.uniform(0.3, 3), b2 = random.log_uniform(0.1, 3);
    const double above = sixteenths(1, 16);
    const auto at = [&](int k) {
      return FractionalTransferFunction({{std::ldexp(lead, static_cast<int>(k * above)), above}, {1, 0}},
                                        {{std::ldexp(b1, static_cast<int>(k * high)), high},
                                         {std::ldexp(b2, static_cast<int>(k * low)), low},
                                         {1, 0}});
    };
    const frac::PeakGain here = frac::h_infinity_norm(at(0));
    const int k = 16 * (trial % 2 == 0 ? 1 : -1) * static_cast<int>(13 + random.below(16));
    const frac::PeakGain there = frac::h_infinity_norm(at(k));
    if (!std::isfinite(here.gain)) continue;
    EXPECT_NEAR(there.gain / here.gain, 1, 1e-13) << at(0).formula() << ", k = " << k;
    if (here.omega == 0 || !std::isfinite(here.omega)) continue;
    // The place of a smooth maximum is known to the square root of rounding times its width, and to that of ln omega.
    EXPECT_NEAR(std::log(there.omega / here.omega) + k * std::log(2.0), 0, 1e-6);
    beyond += std::abs(std::log10(there.omega)) > 60;
  }
  EXPECT_GE(beyond, 15) << "peaks beyond 1e-60 or 1e60 rad/s are among them";
}

}  // namespace
