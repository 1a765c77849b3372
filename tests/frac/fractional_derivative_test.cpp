// SPDX-License-Identifier: BSD-3-Clause
#include "frac/fractional_derivative.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "frac/grunwald_letnikov.hpp"
#include "support/exact_derivative_sums.hpp"
#include "support/expect_invalid_argument.hpp"
#include "support/random.hpp"
#include "support/reference_table.hpp"

namespace {

using frac::FractionalDerivative;
using support::expect_invalid_argument;

constexpr double eps = 2.2e-16;

std::vector<double> derivative(const std::vector<double>& samples, double order, double sample_time,
                               double tolerance = 1e-12, double horizon = 1e6) {
  FractionalDerivative<double> stream(order, sample_time, tolerance, horizon);
  std::vector<double> output(samples.size());
  stream.run(samples, output);
  return output;
}

// The definition in extended precision, and the sum of absolute terms: of the differences where the order is positive,
// because these are what the operator sums.
struct Sum {
  long double value = 0;
  long double absolute = 0;
};
Sum exact_sum(const std::vector<double>& samples, double order, double sample_time, std::size_t n) {
  const int differences = order > 0 ? static_cast<int>(std::ceil(order)) : 0;
  std::vector<long double> input(samples.begin(), samples.begin() + static_cast<std::ptrdiff_t>(n + 1));
  for (int i = 0; i < differences; ++i) {
    for (std::size_t k = n; k > 0; --k) input[k] -= input[k - 1];
  }
  const std::vector<double> weights = frac::grunwald_letnikov_weights(order - differences, n);
  Sum sum;
  for (std::size_t k = 0; k <= n; ++k) {
    const long double term = static_cast<long double>(weights[k]) * input[n - k];
    sum.value += term;
    sum.absolute += std::abs(term);
  }
  const long double scale = std::pow(static_cast<long double>(sample_time), -static_cast<long double>(order));
  return {scale * sum.value, scale * sum.absolute};
}

// To a unit step the sum is w_n of order q - 1 and to a unit pulse w_n of order q, known for every n.  The operator's
// own tolerance, plus roundings: of the weights compared with (80 eps), and of 50 states carried over n/32 blocks.
class WeightsThroughTheStream : public testing::TestWithParam<double> {};

TEST_P(WeightsThroughTheStream, EveryOneOfAMillionIsWithinTheBound) {
  const double order = GetParam();
  constexpr std::size_t count = 1'000'000;
  for (const double tolerance : {1e-6, 1e-9, 1e-12}) {
    const std::vector<double> step(count, 1.0);
    const std::vector<double> output = derivative(step, order, 1, tolerance, count);
    const std::vector<double> weights = frac::grunwald_letnikov_weights(order - 1, count - 1);
    double worst = 0;
    for (std::size_t n = 0; n < count; ++n) worst = std::max(worst, std::abs(output[n] / weights[n] - 1));
    const double bound = FractionalDerivative<double>(order, 1, tolerance, count).error_bound();
    EXPECT_LE(bound, tolerance);
    EXPECT_LT(worst, bound + 300 * eps) << "tolerance " << tolerance;
  }
}

INSTANTIATE_TEST_SUITE_P(Orders, WeightsThroughTheStream, testing::Values(1e-6, 0.1, 0.5, 0.9, 1 - 1e-6));

TEST(FractionalDerivative, NeedsFewExponentials) {
  for (int tenths = 1; tenths <= 9; ++tenths) {
    const double order = tenths / 10.0;
    EXPECT_LE(FractionalDerivative<double>(order, 1, 1e-6, 1e6).exponentials(), 28u) << order;
    EXPECT_LE(FractionalDerivative<double>(order, 1, 1e-9, 1e6).exponentials(), 40u) << order;
    EXPECT_LE(FractionalDerivative<double>(order, 1, 1e-12, 1e6).exponentials(), 52u) << order;
  }
}

// Samples of several shapes; every sample within the tolerance of the sum of absolute terms, plus roundings as above.
TEST(FractionalDerivative, AgreesWithTheSumAtAnyOrder) {
  constexpr std::size_t count = 3000;
  support::Random random(3);
  std::vector<std::vector<double>> shapes(4, std::vector<double>(count));
  for (std::size_t n = 0; n < count; ++n) {
    const auto t = static_cast<double>(n);
    shapes[0][n] = random.normal();
    shapes[1][n] = std::sin(0.01 * t) + 0.3 * std::cos(1.7 * t);
    shapes[2][n] = std::pow(t / count, 2.5);
    shapes[3][n] = n == 700 ? 1e300 : n > 900 && n < 2000 ? 1 : 0;
  }
  for (const double order : {-2.7, -1.0, -0.5, -1e-6, 0.0, 1e-6, 0.5, 1.0, 1.5, 2.0, 2.7}) {
    for (const auto& samples : shapes) {
      const std::vector<double> output = derivative(samples, order, 0.01);
      for (std::size_t n = 0; n < count; n += 1 + n / 9) {
        const Sum exact = exact_sum(samples, order, 0.01, n);
        // Second and third differences of rounded samples are exact here and in the judge.
        ASSERT_NEAR(output[n], static_cast<double>(exact.value),
                    static_cast<double>(exact.absolute) * (1e-12 + 300 * eps))
            << "order " << order << ", n = " << n << ", shape " << &samples - shapes.data();
      }
    }
  }
}

TEST(FractionalDerivative, AgreesWithTheExactSum) {
  const auto sums = support::exact_derivative_sums();
  ASSERT_EQ(sums.size(), 48u);
  for (const auto& sum : sums) {
    EXPECT_NEAR(derivative(sum.samples, sum.order, sum.step).back(), sum.value,
                sum.rounding + 1e-12 * std::abs(sum.value))
        << sum.order;
  }
}

// D^q t^m by Gruenwald-Letnikov is off by q (m - q) h/(2 t) relative to first order (Podlubny 1999); at 10^5 steps the
// next order is below 1e-8.  Rounded samples: as in the test above.
TEST(FractionalDerivative, AgreesWithTheDerivativeOfPowersUpToTheOrderOfTheMethod) {
  constexpr std::size_t count = 100'000;
  int rows_used = 0;
  for (const auto& row : support::reference_table("power_derivative.csv")) {
    const double order = row[0];
    const double m = row[1];
    if (m < 1 || row[3] == 0) continue;
    ++rows_used;
    const double h = row[2] / count;
    std::vector<double> samples;
    for (std::size_t k = 0; k <= count; ++k) samples.push_back(std::pow(static_cast<double>(k) * h, m));
    const double ratio = derivative(samples, order, h).back() / row[3];
    const double first_order = -order * (m - order) / (2.0 * count);
    const double rounding = (m + 1) * eps * std::pow(2, order + 1) * std::pow(h, -order) * samples.back() / row[3];
    EXPECT_NEAR(ratio, 1 + first_order, 1e-4 * std::abs(first_order) + 1e-7 + std::abs(rounding))
        << order << " " << m << " " << row[2];
  }
  EXPECT_GT(rows_used, 50);
}

// What single samples give and what blocks give differ by rounding: 60 terms, plus the sums carried over 100 blocks.
TEST(FractionalDerivative, DoesNotDependOnHowSamplesAreDividedIntoCalls) {
  support::Random random(5);
  std::vector<double> samples(3000);
  for (double& each : samples) each = random.normal();
  for (const double order : {-1.3, 0.5, 1.0, 1.7}) {
    const std::vector<double> whole = derivative(samples, order, 1);
    FractionalDerivative<double> stream(order, 1, 1e-12, 1e6);
    std::vector<double> output(samples.size());
    for (std::size_t n = 0; n < samples.size();) {
      const std::size_t length = std::min<std::size_t>(random.below(100), samples.size() - n);
      if (length == 1) {
        output[n] = stream.step(samples[n]);
      } else {
        stream.run(std::span(samples).subspan(n, length), std::span(output).subspan(n, length));
      }
      n += length;
    }
    double largest = 0;
    for (const double each : whole) largest = std::max(largest, std::abs(each));
    for (std::size_t n = 0; n < samples.size(); ++n) {
      ASSERT_NEAR(output[n], whole[n], 200 * eps * largest) << "order " << order << ", n = " << n;
    }
  }
}

// 64 weights of 24 bits and 27 exponentials to 1e-6; roundings of 2^-24 of some 90 terms.
TEST(FractionalDerivative, InSinglePrecisionKeepsSixDigits) {
  constexpr std::size_t count = 100'000;
  for (const double order : {-0.5, 0.3, 0.5, 0.9}) {
    FractionalDerivative<float> stream(order, 1, 1e-6, count);
    const std::vector<float> step(count, 1.0F);
    std::vector<float> output(count);
    stream.run(step, output);
    const std::vector<double> weights = frac::grunwald_letnikov_weights(order - 1, count - 1);
    for (std::size_t n = 0; n < count; ++n) {
      ASSERT_NEAR(output[n], weights[n], (stream.error_bound() + 20 * 6e-8) * weights[n]) << order << " " << n;
    }
  }
}

TEST(FractionalDerivative, ScalesWithSamplesOfAnySize) {
  std::vector<double> samples;
  for (int n = 0; n < 1000; ++n) samples.push_back(std::sin(0.1 * n) + (n == 300 ? 50 : 0));
  const std::vector<double> base = derivative(samples, 0.5, 1);
  // 2^990 and, near the smallest normal number, 2^-1000: scaled exactly.
  for (const int exponent : {990, -900}) {
    std::vector<double> scaled = samples;
    for (double& each : scaled) each = std::ldexp(each, exponent);
    const std::vector<double> output = derivative(scaled, 0.5, 1);
    for (std::size_t n = 0; n < base.size(); ++n) ASSERT_EQ(output[n], std::ldexp(base[n], exponent)) << n;
  }
  // Denormal samples: as accurate as their spacing of 2^-1074 allows, some 60 terms and 30 blocks of it.
  std::vector<double> tiny = samples;
  for (double& each : tiny) each = std::ldexp(std::round(each * 0x1p30), -1074);
  const std::vector<double> output = derivative(tiny, 0.5, 1);
  for (std::size_t n = 0; n < base.size(); ++n) {
    ASSERT_NEAR(output[n] * 0x1p1000 * 0x1p44, base[n], 200 * 0x1p-30 + 1e-9) << n;
  }
}

TEST(FractionalDerivative, HoldsTheLastSampleForOneThatIsNoNumber) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinite = std::numeric_limits<double>::infinity();
  std::vector<double> good(200);
  for (std::size_t n = 0; n < good.size(); ++n) good[n] = 1 + std::sin(0.2 * static_cast<double>(n));
  std::vector<double> bad = good;
  for (const std::size_t n : {40u, 41u, 77u}) good[n] = good[n - 1];
  bad[40] = nan;
  bad[41] = infinite;
  bad[77] = -1.1e300;
  for (const double order : {-0.5, 0.5, 1.5}) {
    FractionalDerivative<double> stream(order, 1);
    std::vector<double> output(bad.size());
    stream.run(bad, output);
    EXPECT_EQ(output, derivative(good, order, 1, 1e-12, 1e9));
    EXPECT_EQ(stream.rejected(), 3u);
    stream.reset();
    EXPECT_EQ(stream.rejected(), 0u);
    stream.run(good, output);
    EXPECT_EQ(output, derivative(good, order, 1, 1e-12, 1e9)) << "reset leaves something behind";
  }
}

// A constant input of 10^7 samples: the sum is w_n of order q - 1 for ever.  What a state loses to rounding it carries
// along, so nothing grows with the 312 500 blocks.
TEST(FractionalDerivative, DoesNotDrift) {
  FractionalDerivative<double> derivative_of(0.5, 1, 1e-12, 1e8);
  FractionalDerivative<double> integral_of(-0.5, 1, 1e-12, 1e8);
  const std::vector<double> step(100'000, 1.0);
  std::vector<double> output(step.size());
  for (int part = 1; part <= 100; ++part) {
    const auto last = static_cast<std::uint64_t>(part) * step.size() - 1;
    derivative_of.run(step, output);
    EXPECT_NEAR(output.back() / frac::grunwald_letnikov_weight(-0.5, last), 1, 1e-12);
    integral_of.run(step, output);
    EXPECT_NEAR(output.back() / frac::grunwald_letnikov_weight(-1.5, last), 1, 1e-12);
  }
}

// A ramp f_n = n + 1 of 10^8 samples, all exact: each difference is 1, so that the sum is that of w_k of order q - 1 up
// to k = n, which is w_n of order q - 2.  Every sample counts alike, for ever.
TEST(FractionalDerivative, StaysExactOverAHundredMillionSamples) {
  constexpr std::size_t part = 4096;
  constexpr std::size_t samples = 100'000'000;
  FractionalDerivative<double> derivative_of(0.5, 1, 1e-12, static_cast<double>(samples));
  std::vector<double> ramp(part), output(part);
  std::size_t seen = 0, judged = 1 << 16;
  while (seen < samples) {
    const std::size_t count = std::min(part, samples - seen);
    for (std::size_t i = 0; i < count; ++i) ramp[i] = static_cast<double>(seen + i + 1);
    derivative_of.run(std::span(ramp).first(count), std::span(output).first(count));
    seen += count;
    if (seen >= judged || seen == samples) {
      judged *= 2;
      const double exact = frac::grunwald_letnikov_weight(-1.5, seen - 1);
      EXPECT_NEAR(output[count - 1] / exact, 1, 1e-12) << seen;
    }
  }
}

TEST(FractionalDerivative, WholeOrdersAreDifferencesAndSums) {
  const std::vector<double> samples{1, 4, 9, 16, 25, 1e16, 0.5};
  EXPECT_EQ(derivative(samples, 0, 2), samples);
  EXPECT_EQ(derivative(samples, 1, 0.5), (std::vector<double>{2, 6, 10, 14, 18, 2 * (1e16 - 25), 2 * (0.5 - 1e16)}));
  // 0.5 - 2e16 + 25 is exact in twofold precision and rounded once.
  EXPECT_EQ(derivative(samples, 2, 1), (std::vector<double>{1, 2, 2, 2, 2, 1e16 - 34, -2e16 + 25.5}));
  EXPECT_EQ(derivative(samples, -1, 1), (std::vector<double>{1, 5, 14, 30, 55, 1e16 + 55, 1e16 + 55.5}));
  EXPECT_EQ(FractionalDerivative<double>(2, 1).exponentials(), 0u);
}

TEST(FractionalDerivative, CopiesAreIndependent) {
  FractionalDerivative<double> first(0.5, 1);
  for (int n = 0; n < 45; ++n) (void)first.step(n);
  FractionalDerivative<double> second = first;
  for (int n = 0; n < 45; ++n) (void)second.step(-n);
  FractionalDerivative<double> third(0.5, 1);
  for (int n = 0; n < 45; ++n) (void)third.step(n);
  EXPECT_EQ(first.step(7), third.step(7));
  first = second;
  EXPECT_EQ(first.step(7), second.step(7));
}

TEST(FractionalDerivative, ConvolutionByFftAgreesWithTheSum) {
  support::Random random(9);
  std::vector<double> samples(5000);
  for (double& each : samples) each = random.normal();
  for (const double order : {-0.5, 0.5, 1.5}) {
    const std::vector<double> direct = frac::grunwald_letnikov_derivative(samples, order, 0.1);
    const std::vector<double> fft = frac::grunwald_letnikov_derivative_by_fft(samples, order, 0.1);
    // Ten roundings of the norms of weights (below 60) and differences (4 per sample).
    const double bound = 10 * eps * 60 * 4 * std::sqrt(5000.0) * std::pow(0.1, -order);
    for (std::size_t n = 0; n < samples.size(); ++n) ASSERT_NEAR(fft[n], direct[n], bound) << n;
  }
  EXPECT_TRUE(frac::grunwald_letnikov_derivative_by_fft({}, 0.5, 1).empty());
  EXPECT_NEAR(frac::grunwald_letnikov_derivative_by_fft({3}, 0.5, 1)[0], 3, 10 * eps);
}

TEST(FractionalDerivative, SaysWhatIsWrong) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  expect_invalid_argument([] { FractionalDerivative<double>(21, 1); }, {"order = 21", "-20 to 20"});
  expect_invalid_argument([&] { FractionalDerivative<double>(nan, 1); }, {"order = nan"});
  expect_invalid_argument([] { FractionalDerivative<double>(0.5, 0); }, {"sample_time = 0 s"});
  expect_invalid_argument([] { FractionalDerivative<double>(0.5, 1, 1e-14); }, {"tolerance = 1e-14", "1e-13"});
  expect_invalid_argument([] { FractionalDerivative<float>(0.5, 1, 1e-7); }, {"tolerance = 1e-07", "1e-06"});
  expect_invalid_argument([] { FractionalDerivative<double>(0.5, 1, 1e-9, 0); }, {"horizon = 0 samples"});
  expect_invalid_argument([] { FractionalDerivative<float>(10, 1e-5); }, {"sample_time = 1e-05 s to the power -10"});
  expect_invalid_argument(
      [] {
        const std::vector<double> three(3);
        std::vector<double> two(2);
        FractionalDerivative<double>(0.5, 1).run(three, two);
      },
      {"3 samples but room for 2"});
}

}  // namespace
