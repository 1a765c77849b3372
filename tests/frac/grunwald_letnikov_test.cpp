// SPDX-License-Identifier: BSD-3-Clause
#include "frac/grunwald_letnikov.hpp"

#include <gtest/gtest.h>

#include <boost/multiprecision/cpp_bin_float.hpp>
#include <cmath>
#include <limits>
#include <numbers>

#include "support/exact_derivative_sums.hpp"
#include "support/expect_invalid_argument.hpp"
#include "support/observed_order.hpp"
#include "support/random.hpp"
#include "support/reference_table.hpp"
#include "support/relative_error.hpp"

namespace {

using support::expect_invalid_argument;
using support::relative_error;
using Complex = std::complex<double>;
using Real50 = boost::multiprecision::cpp_bin_float_50;

constexpr double eps = 2.2e-16;

// sum_{k=0}^{M} w_k e^{-jkx} h^-order as it stands, in 50 digits: cancellation costs at most 40 of them here.
Complex reference_sum(double order, double sample_time, std::size_t memory_length, double omega) {
  const Real50 x = Real50(omega * sample_time);  // the rounded product is what the double routine works with
  const Real50 c = cos(x);
  const Real50 s = -sin(x);
  Real50 weight = 1;
  Real50 re = 1;
  Real50 im = 0;
  Real50 sum_re = 1;
  Real50 sum_im = 0;
  for (std::size_t k = 1; k <= memory_length; ++k) {
    weight *= (Real50(k) - 1 - Real50(order)) / Real50(k);
    const Real50 turned = re * c - im * s;
    im = re * s + im * c;
    re = turned;
    sum_re += weight * re;
    sum_im += weight * im;
  }
  const Real50 scale = pow(Real50(sample_time), Real50(-order));
  return {static_cast<double>(scale * sum_re), static_cast<double>(scale * sum_im)};
}

TEST(GrunwaldLetnikov, WeightsAgreeWithTheTable) {
  const auto rows = support::reference_table("gl_weights.csv");
  ASSERT_GT(rows.size(), 100u);
  double order = std::numeric_limits<double>::quiet_NaN();
  std::vector<double> weights;
  for (const auto& row : rows) {
    if (row[1] > 1e7) continue;  // 1e9 weights would need 8 GB
    if (row[0] != order) {
      order = row[0];
      weights = frac::grunwald_letnikov_weights(order, 10'000'000);
    }
    const auto k = static_cast<std::size_t>(row[1]);
    // The bound that the header states; the table holds 17 digits.
    const double bound = 4 * eps * (1 + std::abs(order)) * (10 + std::log(row[1] + 1));
    EXPECT_NEAR(weights[k], row[2], bound * std::abs(row[2])) << "order " << order << ", k = " << k;
  }
}

// To index 1e9, where 16 digits of the logarithm cost (1 + |order|) 20 eps.
TEST(GrunwaldLetnikov, AnyOneWeightAgreesWithTheTable) {
  for (const auto& row : support::reference_table("gl_weights.csv")) {
    const double bound = 4 * eps * (1 + std::abs(row[0])) * (10 + std::log(row[1] + 1));
    EXPECT_NEAR(frac::grunwald_letnikov_weight(row[0], static_cast<std::uint64_t>(row[1])), row[2],
                bound * std::abs(row[2]))
        << "order " << row[0] << ", k = " << row[1];
  }
}

// At the ends of the range of orders, where the expansion converges slowest, both ways at once.
TEST(GrunwaldLetnikov, WeightsByExpansionJoinThoseByRecurrence) {
  for (const double order : {-20.0, -12.3, -1.0, 1e-6, 0.5, 3.0, 19.9}) {
    const std::vector<double> weights = frac::grunwald_letnikov_weights(order, 3000);
    for (const std::size_t k : {999u, 1000u, 1001u, 3000u}) {
      const double bound = 8 * eps * (1 + std::abs(order)) * (10 + std::log(k));
      EXPECT_NEAR(frac::grunwald_letnikov_weight(order, k), weights[k], bound * std::abs(weights[k])) << order << k;
    }
  }
}

TEST(GrunwaldLetnikov, WholeOrdersGiveBinomialCoefficients) {
  EXPECT_EQ(frac::grunwald_letnikov_weights(0, 3), (std::vector<double>{1, 0, 0, 0}));
  EXPECT_EQ(frac::grunwald_letnikov_weights(3, 5), (std::vector<double>{1, -3, 3, -1, 0, 0}));
  EXPECT_EQ(frac::grunwald_letnikov_weights(-1, 4), (std::vector<double>{1, 1, 1, 1, 1}));
}

TEST(GrunwaldLetnikov, FullMemoryResponseIsThePowerOfTheBackwardDifference) {
  for (const double order : {-1.5, -0.3, 0.5, 0.9, 1.0, 2.2}) {
    for (const double x : {1e-12, 1e-6, 1e-2, 1.0, 3.0, std::numbers::pi}) {
      const double h = 1e-3;
      const double omega = x / h;
      // In long double 1 - e^{-jx} is taken from sin^2, so that small x keeps its digits.
      const long double half = static_cast<long double>(omega * h) / 2;
      const std::complex<long double> difference(2 * std::sin(half) * std::sin(half), std::sin(2 * half));
      const std::complex<long double> reference =
          std::exp(static_cast<long double>(order) * std::log(difference / static_cast<long double>(h)));
      // The magnitude carries |order| ln|...| <= 2.2 * 21 roundings at worst, the angle a few.
      EXPECT_LT(relative_error(frac::grunwald_letnikov_response(order, h, 0, omega), Complex(reference)), 100 * eps)
          << order << " " << x;
    }
  }
}

struct MemoryCase {
  double order;
  std::size_t memory_length;
};

class GrunwaldLetnikovWithMemory : public testing::TestWithParam<MemoryCase> {};

// The value rests on O(M/64) partial sums of terms that do not cancel, times the phase of z^M, exact to a rounding: the
// bound is 100 eps with the few whole orders split off.
TEST_P(GrunwaldLetnikovWithMemory, ResponseAgreesWithTheSumInFiftyDigits) {
  const auto [order, memory_length] = GetParam();
  const double h = 1e-2;
  for (const double x : {1e-9, 1e-6, 1e-3, 0.02, 0.5, 2.0, 3.14}) {
    const double omega = x / h;
    const Complex value = frac::grunwald_letnikov_response(order, h, memory_length, omega);
    EXPECT_LT(relative_error(value, reference_sum(order, h, memory_length, omega)), 100 * eps)
        << "order " << order << ", memory " << memory_length << ", x = " << x;
  }
}

INSTANTIATE_TEST_SUITE_P(Cases, GrunwaldLetnikovWithMemory,
                         testing::Values(MemoryCase{0.1, 1000}, MemoryCase{0.5, 1}, MemoryCase{0.5, 63},
                                         MemoryCase{0.5, 64}, MemoryCase{0.5, 20000}, MemoryCase{0.99, 1000},
                                         MemoryCase{1, 500}, MemoryCase{2.0, 500}, MemoryCase{1.5, 1000},
                                         MemoryCase{2.7, 1000}, MemoryCase{0, 100}, MemoryCase{-0.5, 1000},
                                         MemoryCase{-0.97, 5000}, MemoryCase{-1, 1000}, MemoryCase{-1.6, 1000}));

// What is cut off, sum_{k>M} w_k e^{-jkx}, is below |w_M|/|sin(x/2)| because the |w_k| fall monotonically.
TEST(GrunwaldLetnikov, LongMemoryTendsToFullMemory) {
  const double h = 1;
  const double omega = 0.3;
  const Complex full = frac::grunwald_letnikov_response(0.5, h, 0, omega);
  for (const std::size_t memory_length : {100u, 10'000u, 1'000'000u}) {
    const double cut = std::abs(frac::grunwald_letnikov_weights(0.5, memory_length).back()) / std::sin(omega / 2);
    const double difference = std::abs(frac::grunwald_letnikov_response(0.5, h, memory_length, omega) - full);
    EXPECT_LT(difference, cut + 100 * eps);
    EXPECT_GT(difference, 0.1 * cut) << "the memory is not cut where it should be";
  }
}

double power_derivative_error(double order, double exponent, double time, int steps, double exact) {
  const double h = time / steps;
  std::vector<double> samples;
  for (int k = 0; k <= steps; ++k) samples.push_back(std::pow(k * h, exponent));
  return frac::grunwald_letnikov_derivative(samples, order, h).back() - exact;
}

// D^q t^m = Gamma(m+1)/Gamma(m+1-q) t^(m-q).  The method is of first order in the step at fixed t.  For m = 1/2 the
// next term is h^(m+1), so the observed order at 1024 and 2048 steps is within 0.05 of 1; where the first-order term
// vanishes (m whole and below q, or Gamma at a pole) the order is higher.
TEST(GrunwaldLetnikov, DerivativeOfPowersConvergesToTheTableWithFirstOrder) {
  const auto rows = support::reference_table("power_derivative.csv");
  ASSERT_GT(rows.size(), 100u);
  int orders_seen = 0;
  for (const auto& row : rows) {
    const double coarse = power_derivative_error(row[0], row[1], row[2], 512, row[3]);
    const double fine = power_derivative_error(row[0], row[1], row[2], 1024, row[3]);
    const double size = std::abs(row[3]) + std::pow(row[2], row[1] - row[0]);
    // First-order constant: q (m - q) C / 2 with C of order m^2 in these rows, so 10/1024 covers it with a margin of 2.
    EXPECT_LT(std::abs(fine), 10 * size / 1024) << row[0] << " " << row[1] << " " << row[2];
    // Extrapolated to step 0 what is left is of order h^min(2, m+1), at worst 1024^-1.5 = 3e-5.
    EXPECT_LT(std::abs(2 * fine - coarse), 2e-4 * size) << row[0] << " " << row[1] << " " << row[2];
    if (std::abs(fine) > 1e-4 * size) {
      EXPECT_NEAR(support::observed_order(std::abs(coarse), std::abs(fine)), 1, 0.05) << row[0] << " " << row[1];
      ++orders_seen;
    }
  }
  EXPECT_GT(orders_seen, 50);
}

TEST(GrunwaldLetnikov, DerivativeAgreesWithTheExactSum) {
  const auto sums = support::exact_derivative_sums();
  ASSERT_EQ(sums.size(), 48u);
  for (const auto& sum : sums) {
    EXPECT_NEAR(frac::grunwald_letnikov_derivative(sum.samples, sum.order, sum.step).back(), sum.value, sum.rounding)
        << sum.order << " " << sum.step << " " << sum.samples.size();
  }
}

// The sum over the kept samples as the definition has it; 8 eps of the sum of absolute terms.
TEST(GrunwaldLetnikov, DerivativeWithFiniteMemoryIsTheTruncatedSum) {
  const double h = 0.1;
  std::vector<double> samples;
  for (int k = 0; k < 60; ++k) samples.push_back(std::sin(0.3 * k) + 2);
  for (const double order : {-1.4, -0.5, 0.0, 0.5, 1.0, 1.7, 2.3}) {
    for (const std::size_t memory_length : {1u, 7u, 59u, 200u}) {
      const std::vector<double> weights = frac::grunwald_letnikov_weights(order, memory_length);
      const std::vector<double> result = frac::grunwald_letnikov_derivative(samples, order, h, memory_length);
      for (std::size_t n = 0; n < samples.size(); ++n) {
        double sum = 0;
        double absolute = 0;
        for (std::size_t k = 0; k <= std::min(n, memory_length); ++k) {
          sum += weights[k] * samples[n - k];
          absolute += std::abs(weights[k] * samples[n - k]);
        }
        const double scale = std::pow(h, -order);
        EXPECT_NEAR(result[n], scale * sum, 64 * eps * scale * absolute) << order << " " << memory_length << " " << n;
      }
    }
  }
}

TEST(GrunwaldLetnikov, DerivativeOfNothingIsNothing) {
  EXPECT_TRUE(frac::grunwald_letnikov_derivative({}, 0.5, 1).empty());
}

TEST(GrunwaldLetnikov, RefusesWhatIsOutOfRange) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  expect_invalid_argument([&] { (void)frac::grunwald_letnikov_weights(nan, 3); }, {"order = nan"});
  expect_invalid_argument([] { (void)frac::grunwald_letnikov_weight(0.5, (1ULL << 53) + 1); },
                          {"index = 9007199254740993"});
  expect_invalid_argument([&] { (void)frac::grunwald_letnikov_weights(-21, 3); }, {"order = -21"});
  expect_invalid_argument([&] { (void)frac::grunwald_letnikov_weights(0.5, 10'000'001); },
                          {"memory_length = 10000001"});
  expect_invalid_argument([&] { (void)frac::grunwald_letnikov_response(0.5, 0, 3, 1); }, {"sample_time = 0 s"});
  expect_invalid_argument([&] { (void)frac::grunwald_letnikov_response(0.5, 0.1, 3, 0); }, {"omega = 0"});
  expect_invalid_argument([&] { (void)frac::grunwald_letnikov_response(0.5, 0.1, 3, 32); },
                          {"omega = 32", "pi/sample_time = 31.4"});
  expect_invalid_argument([&] { (void)frac::grunwald_letnikov_response(25, 0.1, 3, 1); }, {"order = 25"});
  expect_invalid_argument([&] { (void)frac::grunwald_letnikov_derivative({1, nan}, 0.5, 1); }, {"samples[1] = nan"});
  expect_invalid_argument([&] { (void)frac::grunwald_letnikov_derivative({1}, 0.5, -1); }, {"sample_time = -1"});
  expect_invalid_argument([&] { (void)frac::grunwald_letnikov_derivative({1}, 20, 1e-300); }, {"sample_time = 1e-300"});
}

}  // namespace
