// SPDX-License-Identifier: BSD-3-Clause
#include "frac/mittag_leffler.hpp"

#include <gtest/gtest.h>

#include <boost/math/special_functions/gamma.hpp>
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <cmath>
#include <complex>
#include <fstream>
#include <limits>
#include <numbers>
#include <sstream>

#include "support/expect_invalid_argument.hpp"
#include "support/random.hpp"

namespace {

using Complex = std::complex<double>;
using support::expect_invalid_argument;
using support::Random;
constexpr double pi = std::numbers::pi;
constexpr double infinity = std::numeric_limits<double>::infinity();

// The error that the header allows.
double allowed(Complex value, double condition) {
  return 1e-14 * (1 + std::abs(value)) * std::max(1.0, condition);
}

struct Row {
  double alpha, beta;
  Complex z, value;
  double condition;
};

std::vector<Row> table() {
  std::ifstream file(std::string(FRACFIT_SOURCE_DIR) + "/data/reference/mittag_leffler.csv");
  std::vector<Row> rows;
  std::string line;
  std::getline(file, line);
  while (std::getline(file, line)) {
    std::vector<std::string> cell;
    std::stringstream stream(line);
    for (std::string text; std::getline(stream, text, ',');) cell.push_back(text);
    rows.push_back({std::stod(cell[0]),
                    std::stod(cell[1]),
                    {std::stod(cell[3]), std::stod(cell[4])},
                    {std::stod(cell[5]), std::stod(cell[6])},
                    std::stod(cell[10])});
  }
  return rows;
}

// The defining series in 60 digits, coefficients kept for all z: good to 1e-25 while the largest term, about
// e^{|z|^(1/alpha)}, stays below e^30.
class SeriesReference {
 public:
  using Real = boost::multiprecision::number<boost::multiprecision::cpp_bin_float<60>>;
  SeriesReference(double alpha, double beta, double gamma, double largest_root) {
    Real factor = 1;
    const Real log_radius = alpha * log(Real(largest_root));
    for (int k = 0;; ++k) {
      if (k > 0) factor *= (Real(gamma) + (k - 1)) / k;
      const Real x = Real(alpha) * k + Real(beta);
      const bool is_pole = x <= 0 && floor(x) == x;
      coefficient_.push_back(is_pole ? Real(0) : Real(factor / boost::math::tgamma(x)));
      if (x > 3 * largest_root + 3 && log(abs(coefficient_.back())) + k * log_radius < -70) break;
    }
  }
  struct Value {
    Complex value, derivative;
    double condition, derivative_condition;
  };
  [[nodiscard]] Value operator()(Complex z) const {
    Real re = 1, im = 0;  // z^k
    Real sum[3][2] = {};  // k-th derivative times z^k
    for (std::size_t k = 0; k < coefficient_.size(); ++k) {
      const auto n = static_cast<double>(k);
      const double factor[3] = {1, n, n * (n - 1)};
      for (int d = 0; d < 3; ++d) {
        sum[d][0] += factor[d] * coefficient_[k] * re;
        sum[d][1] += factor[d] * coefficient_[k] * im;
      }
      const Real next = re * z.real() - im * z.imag();
      im = re * z.imag() + im * z.real();
      re = next;
    }
    const auto rounded = [&](int d) { return Complex(sum[d][0].convert_to<double>(), sum[d][1].convert_to<double>()); };
    return {rounded(0), rounded(1) / z, std::abs(rounded(1) / rounded(0)), std::abs(rounded(2) / rounded(1))};
  }

 private:
  std::vector<Real> coefficient_;
};

struct Orders {
  double alpha, beta;
};
constexpr Orders many_orders[] = {{0.15, 1},  {0.3, 0.3},   {0.5, 1},     {0.5, 0.5}, {0.62, 2.3}, {0.8, -0.7},
                                  {0.8, -2},  {0.9, 4},     {0.97, 0.97}, {1, 0.4},   {1, 3},      {1.2, 1},
                                  {1.5, 0},   {1.5, 9.5},   {1.7, 1.7},   {1.93, 2},  {2, 1.5},    {2.2, 0.9},
                                  {2.5, 2.5}, {3, 1},       {3.7, -1.5},  {6, 2},     {0.3, -4.3}, {0.6, -9.4},
                                  {1, -12},   {1.4, -20.5}, {1.8, -30},   {3, -7.3},  {2.6, -20.2}};

double root_limit(double alpha) {
  return alpha < 0.2 ? 8 : 20;
}

}  // namespace

TEST(MittagLeffler, AgreesWithTheTable) {
  const std::vector<Row> rows = table();
  ASSERT_EQ(rows.size(), 844u);
  for (const Row& row : rows) {
    const Complex value = frac::mittag_leffler(row.alpha, row.beta, row.z);
    EXPECT_LE(std::abs(value - row.value), allowed(row.value, row.condition)) << row.alpha << row.beta << row.z;
    if (row.z.imag() == 0 && row.z.real() < 0 && row.alpha < 1) {
      EXPECT_LE(std::abs(value - row.value), 1e-13 * std::abs(row.value)) << row.alpha << row.beta << row.z;
    }
  }
}

TEST(MittagLeffler, AgreesWithTheSeriesInHighPrecision) {
  Random random(1);
  for (const auto& [alpha, beta] : many_orders) {
    const double largest = root_limit(alpha);
    const SeriesReference reference(alpha, beta, 1, largest);
    for (int i = 0; i < 60; ++i) {
      const double radius = std::pow(random.log_uniform(1e-3, largest), alpha);
      // A third real, a third near the Stokes lines |arg z| = alpha pi and alpha pi/2, a third anywhere.
      double angle = random.uniform(-pi, pi);
      if (i % 3 == 0) angle = i % 2 == 0 ? 0 : pi;
      if (i % 3 == 1) angle = std::min(pi, alpha * pi / (1 + i % 2) * (1 + 0.02 * random.normal()));
      const Complex z = angle == 0 ? radius : (angle == pi ? -radius : std::polar(radius, angle));
      const auto exact = reference(z);
      const Complex value = frac::mittag_leffler(alpha, beta, z);
      EXPECT_LE(std::abs(value - exact.value), allowed(exact.value, exact.condition)) << alpha << " " << beta << z;
      const Complex slope = frac::mittag_leffler_derivative(alpha, beta, z);
      EXPECT_LE(std::abs(slope - exact.derivative), 10 * allowed(exact.derivative, exact.derivative_condition))
          << alpha << " " << beta << z << slope << exact.derivative;
    }
  }
}

// Values by the defining series in 400 digits (mpmath).
TEST(MittagLeffler, OfSecondOrderFarBelowZeroAgreesWithTheTable) {
  std::ifstream file(std::string(FRACFIT_SOURCE_DIR) + "/data/reference/mittag_leffler_negative_beta.csv");
  std::string line;
  std::getline(file, line);
  int rows = 0;
  for (; std::getline(file, line); ++rows) {
    std::stringstream stream(line);
    double cell[5] = {};
    for (double& number : cell) {
      std::string text;
      std::getline(stream, text, ',');
      number = std::stod(text);
    }
    const auto [alpha, beta, z, exact, slope] = cell;
    EXPECT_LE(std::abs(frac::mittag_leffler(alpha, beta, z) - exact), allowed(exact, std::abs(z * slope / exact)))
        << line;
    // 1 bounds |z E''/E'| from below.
    EXPECT_LE(std::abs(frac::mittag_leffler_derivative(alpha, beta, z) - slope), 10 * allowed(slope, 1)) << line;
    const std::vector<double> batch = frac::mittag_leffler(alpha, beta, std::vector<double>{z, z});
    EXPECT_EQ(batch[1], frac::mittag_leffler(alpha, beta, z)) << line;
  }
  EXPECT_EQ(rows, 108);
}

// Poles on and beside every node of the rule, where a term and the residue are both infinite.
TEST(MittagLeffler, IsSmoothWhereAPoleMeetsANode) {
  Random random(2);
  for (const auto& [alpha, beta] : {Orders{0.5, 1}, {0.8, 0.8}, {1.3, 1}, {1.9, 2}}) {
    const SeriesReference reference(alpha, beta, 1, 20);
    for (int i = 0; i < 200; ++i) {
      const Complex w(1.6 + 0.3 * random.normal() * (i % 2), random.uniform(0, 2.5));
      const Complex z = std::pow(w, 2 * alpha);
      const auto exact = reference(z);
      EXPECT_LE(std::abs(frac::mittag_leffler(alpha, beta, z) - exact.value), allowed(exact.value, exact.condition))
          << alpha << " " << beta << z;
    }
    // Nodes are the multiples of half a step, step = 2 pi 1.6/40.
    for (int k = 0; k < 12; ++k) {
      const Complex z = std::pow(Complex(1.6, k * pi * 1.6 / 40), 2 * alpha);
      const auto exact = reference(z);
      EXPECT_LE(std::abs(frac::mittag_leffler(alpha, beta, z) - exact.value), allowed(exact.value, exact.condition))
          << alpha << " " << beta << z;
    }
  }
}

TEST(MittagLeffler, IsElementaryAtOrdersOneAndTwo) {
  for (const double z : {-700.0, -30.0, -1.0, -1e-9, 1e-9, 1.0, 30.0, 700.0}) {
    EXPECT_DOUBLE_EQ(frac::mittag_leffler(1, 1, z), std::exp(z));
    EXPECT_DOUBLE_EQ(frac::mittag_leffler(1, 2, z), std::expm1(z) / z);
    EXPECT_DOUBLE_EQ(frac::mittag_leffler(2, 1, -z * z), std::cos(std::abs(z)));
    EXPECT_DOUBLE_EQ(frac::mittag_leffler(2, 1, z * z), std::cosh(std::abs(z)));
    EXPECT_DOUBLE_EQ(frac::mittag_leffler(2, 2, -z * z), std::sin(z) / z);
    EXPECT_DOUBLE_EQ(frac::mittag_leffler(2, 3, -z * z), 2 * std::pow(std::sin(z / 2) / z, 2));
  }
  const Complex z(-2.5, 4);
  EXPECT_LE(std::abs(frac::mittag_leffler(1, 1, z) / std::exp(z) - 1.0), 1e-15);
  EXPECT_LE(std::abs(frac::mittag_leffler(2, 1, z) / std::cosh(std::sqrt(z)) - 1.0), 1e-15);
}

// E_{1/2}(z) = exp(z^2) erfc(-z); far out on the left, where erfc underflows, the first terms of
// -1/(z sqrt(pi)) sum (-1)^k (2k-1)!!/(2 z^2)^k.
TEST(MittagLeffler, OfOrderOneHalfIsTheScaledErrorFunction) {
  for (double z = -25; z < 5; z += 0.37) {
    const double exact = std::exp(z * z) * std::erfc(-z);
    // exp(z^2) carries the rounding of z^2, 1.1e-16 z^2.
    EXPECT_NEAR(frac::mittag_leffler(0.5, 1, z) / exact, 1, 1e-14 + 3e-16 * z * z) << z;
  }
  for (const double z : {-30.0, -100.0, -1e4, -1e7, -1e9, -1e100, -1e300}) {
    const double x = 1 / (2 * z * z);
    const double exact = -1 / (z * std::sqrt(pi)) * (1 - x * (1 - 3 * x * (1 - 5 * x * (1 - 7 * x * (1 - 9 * x)))));
    // The next term is 10395 x^6 < 3e-16 at z = -30.
    EXPECT_NEAR(frac::mittag_leffler(0.5, 1, z) / exact, 1, 1e-13) << z;
  }
}

// Completely monotone for 0 < alpha <= 1, beta >= alpha (Schneider 1996): positive and increasing on z < 0.
TEST(MittagLeffler, IsPositiveAndMonotoneOnTheNegativeAxis) {
  for (const auto& [alpha, beta] : {Orders{0.2, 0.2}, {0.5, 1}, {0.9, 0.9}, {0.99, 0.99}, {0.99, 1}, {0.7, 3}}) {
    double previous = 0;
    for (double exponent = 12; exponent > -4; exponent -= 0.01) {
      const double value = frac::mittag_leffler(alpha, beta, -std::pow(10.0, exponent));
      EXPECT_GT(value, previous) << alpha << " " << beta << " 1e" << exponent;
      previous = value;
    }
  }
}

// E_{alpha,beta} = 1/Gamma(beta) + z E_{alpha,beta+alpha}: three evaluations on different lines.
TEST(MittagLeffler, FulfilsItsRecurrence) {
  Random random(3);
  for (int i = 0; i < 3000; ++i) {
    const double alpha = random.uniform(0.05, 5);
    const double beta = random.uniform(0.1, 5);
    const Complex z = std::polar(random.log_uniform(1e-3, 1e3), random.uniform(-pi, pi));
    const Complex left = frac::mittag_leffler(alpha, beta, z);
    const Complex right = frac::mittag_leffler(alpha, beta + alpha, z);
    if (!(std::abs(left) < 1e300)) continue;
    const double condition = std::abs(z * frac::mittag_leffler_derivative(alpha, beta, z)) / std::abs(left) +
                             std::abs(z * frac::mittag_leffler_derivative(alpha, beta + alpha, z)) / std::abs(right);
    EXPECT_LE(std::abs(left - 1 / std::tgamma(beta) - z * right),
              allowed(left, condition) + std::abs(z) * allowed(right, condition))
        << alpha << " " << beta << z;
  }
}

TEST(MittagLeffler, BatchGivesTheSameValues) {
  Random random(4);
  for (const auto& [alpha, beta] : {Orders{0.6, 1}, {0.7, 0.7}, {1.4, 1}, {0.98, 0.98}, {0.5, -1}}) {
    std::vector<double> z;
    std::vector<Complex> complex_z;
    for (int i = 0; i < 501; ++i) {
      z.push_back((i % 7 == 0 ? 1 : -1) * random.log_uniform(1e-5, i % 7 == 0 ? 3 : 1e12));
      complex_z.emplace_back(z.back(), random.normal());
    }
    const std::vector<double> value = frac::mittag_leffler(alpha, beta, std::span<const double>(z));
    const auto complex_value = frac::mittag_leffler(alpha, beta, std::span<const Complex>(complex_z));
    for (std::size_t i = 0; i < z.size(); ++i) {
      EXPECT_EQ(value[i], frac::mittag_leffler(alpha, beta, z[i])) << z[i];
      EXPECT_EQ(complex_value[i], frac::mittag_leffler(alpha, beta, complex_z[i])) << complex_z[i];
    }
  }
  EXPECT_TRUE(frac::mittag_leffler(0.5, 1, std::span<const double>()).empty());
}

TEST(MittagLeffler, ExtremeArgumentsGiveNumbersOrInfinities) {
  for (const double alpha : {1e-3, 0.1, 0.5, 1.0, 1.5, 2.0, 3.5, 10.0, 100.0}) {
    for (const double beta : {-50.0, -3.0, 0.0, 0.5, 1.0, 1.5, 20.0, 50.0}) {
      for (const double radius :
           {0.0, 5e-324, 1e-300, 1e-20, 0.0100001, 0.999, 1.0, 50.0, 9.9e7, 1.1e8, 1e150, 1.7e308}) {
        for (double angle = -pi; angle <= pi; angle += pi / 12) {
          const Complex z = std::polar(radius, angle);
          for (const Complex value :
               {frac::mittag_leffler(alpha, beta, z), frac::mittag_leffler_derivative(alpha, beta, z)}) {
            EXPECT_FALSE(std::isnan(value.real()) || std::isnan(value.imag())) << alpha << " " << beta << z;
          }
        }
        EXPECT_FALSE(std::isnan(frac::mittag_leffler(alpha, beta, -radius))) << alpha << " " << beta << " " << radius;
      }
    }
  }
  EXPECT_EQ(frac::mittag_leffler(0.5, 1, 27.0), infinity);
  EXPECT_EQ(frac::mittag_leffler(0.1, 1, 1e300), infinity);
  // z E'/E = 2 z^2 = 1352 there.
  EXPECT_NEAR(frac::mittag_leffler(0.5, 1, 26.0) / (2 * std::exp(676.0)), 1, 1352e-14);
  EXPECT_EQ(frac::mittag_leffler(0.5, -1, 0.0), 0);
  EXPECT_DOUBLE_EQ(frac::mittag_leffler(0.5, 3, 0.0), 0.5);
}

TEST(Prabhakar, AgreesWithTheSeriesInHighPrecision) {
  Random random(5);
  for (const auto& [alpha, beta] : {Orders{0.4, 1}, {0.7, 0.7}, {0.9, 3}, {1, 1.5}, {1.6, 0.5}, {2, 2}}) {
    for (const double gamma : {0.3, 1.0, 1.5, 2.0, 4.0, 9.5}) {
      const SeriesReference reference(alpha, beta, gamma, 12);
      for (int i = 0; i < 15; ++i) {
        const double radius = std::pow(random.log_uniform(1e-2, 12), alpha);
        const Complex z = i % 3 == 0 ? -radius : std::polar(radius, random.uniform(-pi, pi));
        const auto exact = reference(z);
        EXPECT_LE(std::abs(frac::prabhakar(alpha, beta, gamma, z) - exact.value),
                  100 * allowed(exact.value, exact.condition))
            << alpha << " " << beta << " " << gamma << z;
      }
    }
  }
}

// The bound of the header over all that it covers.
TEST(Prabhakar, KeepsItsBoundAtRandomOrders) {
  Random random(11);
  for (int orders = 0; orders < 100; ++orders) {
    const double alpha = random.uniform(0.2, 2);
    const double beta = random.uniform(-10, 10);
    const double gamma = random.uniform(0.05, 10);
    const double largest = alpha < 0.4 ? 8 : 20;
    const SeriesReference reference(alpha, beta, gamma, largest);
    for (int i = 0; i < 16; ++i) {
      const double radius = std::pow(random.log_uniform(1e-2, largest), alpha);
      const Complex z = i % 4 == 0 ? -radius : std::polar(radius, random.uniform(-pi, pi));
      const auto exact = reference(z);
      EXPECT_LE(std::abs(frac::prabhakar(alpha, beta, gamma, z) - exact.value),
                100 * allowed(exact.value, exact.condition))
          << alpha << " " << beta << " " << gamma << z;
    }
  }
  // A root close to the path's corner, where the power multiplies roundings most.
  const SeriesReference reference(0.58, 1, 8.5, 25);
  for (const double angle : {-1.2, -1.1, 0.9, 1.3}) {
    const Complex z = std::polar(std::pow(25, 0.58), angle);
    const auto exact = reference(z);
    EXPECT_LE(std::abs(frac::prabhakar(0.58, 1, 8.5, z) - exact.value), 100 * allowed(exact.value, exact.condition))
        << z;
  }
}

// d/dz E^g_{a,b} = g E^{g+1}_{a,b+a}, and for a = 1: E^g_{1,g}(z) = e^z/Gamma(g).
TEST(Prabhakar, ReducesToTheExponential) {
  for (const double gamma : {0.5, 1.0, 2.0, 3.5}) {
    for (const double z : {-5.0, -0.5, 1e-12, 2.0, 20.0}) {
      const double exact = std::exp(z) / std::tgamma(gamma);
      EXPECT_NEAR(frac::prabhakar(1, gamma, gamma, z), exact, 1e-12 * (1 + exact) * std::max(1.0, std::abs(z)));
    }
  }
}

TEST(MittagLeffler, RefusesWhatItCannotEvaluate) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  expect_invalid_argument([] { (void)frac::mittag_leffler(0, 1, 1.0); }, {"alpha = 0", "above 0 to 100"});
  expect_invalid_argument([] { (void)frac::mittag_leffler(-0.5, 1, 1.0); }, {"alpha = -0.5"});
  expect_invalid_argument([&] { (void)frac::mittag_leffler(nan, 1, 1.0); }, {"alpha = nan"});
  expect_invalid_argument([] { (void)frac::mittag_leffler(0.5, 51, 1.0); }, {"beta = 51", "-50 to 50"});
  expect_invalid_argument([] { (void)frac::mittag_leffler(0.5, 1, infinity); }, {"z = inf"});
  expect_invalid_argument([&] { (void)frac::mittag_leffler(0.5, 1, Complex(0, nan)); }, {"z = 0 + nan i"});
  const std::vector<double> z{-1, -2, nan};
  expect_invalid_argument([&] { (void)frac::mittag_leffler(0.5, 1, std::span<const double>(z)); }, {"z[2] = nan"});
  std::vector<double> room(2);
  expect_invalid_argument([&] { frac::mittag_leffler(0.5, 1, z, room); }, {"3 arguments", "2 values"});
  expect_invalid_argument([] { (void)frac::prabhakar(2.5, 1, 1, 1.0); }, {"alpha = 2.5"});
  expect_invalid_argument([] { (void)frac::prabhakar(0.5, 1, 0, 1.0); }, {"gamma = 0"});
  expect_invalid_argument([] { (void)frac::prabhakar(0.5, 1, 1.5, Complex(0, 1e4)); }, {"root", "up to 1000"});
}
