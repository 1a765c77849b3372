// SPDX-License-Identifier: BSD-3-Clause
// Products of factors to whole powers: multiplicities, and responses against partial fractions in a hundred digits.
#include <gtest/gtest.h>

#include <algorithm>
#include <boost/math/special_functions/gamma.hpp>
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <boost/multiprecision/cpp_complex.hpp>
#include <cmath>
#include <complex>
#include <string>
#include <vector>

#include "frac/digital/digital_filter.hpp"
#include "frac/model/fractional_transfer_function.hpp"
#include "frac/stability.hpp"
#include "frac/state_space.hpp"
#include "frac/time_response/reference_response.hpp"
#include "frac/time_response/respond.hpp"
#include "frac/time_response/response_methods.hpp"
#include "support/random.hpp"

namespace {

using frac::FractionalTransferFunction;
using frac::PowerFactor;
using Long = boost::multiprecision::cpp_bin_float_100;
using LongComplex = boost::multiprecision::cpp_complex_100;
using support::Random;

/// A root lambda of order `multiplicity` of a polynomial in lambda = s^order.
struct Root {
  std::complex<double> lambda;
  int multiplicity;
};

/// gain/product of (lambda - root)^multiplicity, complex roots with their conjugates.
struct Product {
  double order;
  std::vector<Root> roots;

  [[nodiscard]] FractionalTransferFunction model() const {
    std::vector<PowerFactor> bottom;
    for (const auto& [lambda, multiplicity] : roots) {
      if (lambda.imag() == 0) {
        bottom.push_back({{{1, order}, {-lambda.real(), 0}}, multiplicity});
      } else {
        bottom.push_back({{{1, 2 * order}, {-2 * lambda.real(), order}, {std::norm(lambda), 0}}, multiplicity});
      }
    }
    return FractionalTransferFunction::from_factors({{{{1, 0}}, 1}}, bottom);
  }
};

struct Fraction {
  LongComplex root;
  std::vector<LongComplex> coefficient;  // of 1/(lambda - root)^(j + 1)
};

// The roots as the coefficients of the model, which are doubles, make them.
std::vector<std::pair<LongComplex, int>> exact_roots(const Product& product) {
  std::vector<std::pair<LongComplex, int>> roots;
  for (const auto& [lambda, multiplicity] : product.roots) {
    if (lambda.imag() == 0) {
      roots.emplace_back(LongComplex(Long(lambda.real())), multiplicity);
      continue;
    }
    const Long half = Long(2 * lambda.real()) / 2;
    const Long height = sqrt(Long(std::norm(lambda)) - half * half);
    roots.emplace_back(LongComplex(half, height), multiplicity);
    roots.emplace_back(LongComplex(half, -height), multiplicity);
  }
  return roots;
}

// Of 1/product, from the Taylor series of the other factors about each root.
std::vector<Fraction> partial_fractions(const std::vector<std::pair<LongComplex, int>>& roots) {
  std::vector<Fraction> result;
  for (const auto& [root, multiplicity] : roots) {
    const auto count = static_cast<std::size_t>(multiplicity);
    std::vector<LongComplex> series(count, LongComplex(0));
    series[0] = 1;
    for (const auto& [other, times] : roots) {
      if (other == root) continue;
      const LongComplex gap = root - other;
      for (int i = 0; i < times; ++i) {  // over gap + x
        for (std::size_t k = 0; k < count; ++k) {
          if (k > 0) series[k] -= series[k - 1];
          series[k] /= gap;
        }
      }
    }
    std::reverse(series.begin(), series.end());
    result.push_back({root, series});
  }
  return result;
}

// The step response at t: of 1/(s^a - root)^j it is t^(a j) E^j_(a, a j + 1)(root t^a), by its power series.
double step_response(const Product& product, double t) {
  const Long order = product.order;
  const Long x = pow(Long(t), order);
  Long sum = 0;
  for (const Fraction& fraction : partial_fractions(exact_roots(product))) {
    for (std::size_t i = 0; i < fraction.coefficient.size(); ++i) {
      const Long j = static_cast<double>(i + 1);
      LongComplex term = pow(x, j);  // (j)_k/k! root^k x^(k + j)
      LongComplex value = 0;
      for (int k = 0; k < 2000; ++k) {
        const LongComplex part = term / boost::math::tgamma(Long(order * (j + k) + 1));
        value += part;
        if (k > 10 && abs(part) < Long("1e-95")) break;
        term *= fraction.root * x * (j + k) / (k + 1);
      }
      sum += LongComplex(fraction.coefficient[i] * value).real();
    }
  }
  return static_cast<double>(sum);
}

// Up to twelve poles, each up to eight times, about 1 in modulus: within the reach of the power series.
Product random_product(Random& random, bool fractional) {
  Product product{fractional ? random.uniform(0.3, 1.2) : 1, {}};
  std::size_t left = 1 + random.below(12);
  while (left > 0) {
    const std::size_t wanted = std::min<std::size_t>(left, 1 + random.below(8));
    // Some next to the one before, down to a part in ten thousand.
    const bool is_crowded = !product.roots.empty() && random.below(4) == 0;
    const double size = is_crowded ? std::abs(product.roots.back().lambda) * (1 + random.log_uniform(1e-4, 1e-2))
                                   : random.log_uniform(0.4, 1.6);
    if (random.below(3) == 0 && wanted >= 2) {
      const double angle = random.uniform(0.6, 0.95) * 3.14159;
      product.roots.push_back({std::polar(size, angle), static_cast<int>(wanted / 2)});
      left -= 2 * (wanted / 2);
    } else {
      product.roots.push_back({-size, static_cast<int>(wanted)});
      left -= wanted;
    }
  }
  return product;
}

// The bar is 1e-9 of the final value; what is lost to rounding by a product of twelve is far below.  The error that is
// stated is that of the method: the rounding of the result, some units of the largest of up to a dozen parts, comes on
// top.
TEST(EqualPoles, ReferenceIsThePartialFractionExpansion) {
  Random random(20261);
  for (int trial = 0; trial < 24; ++trial) {
    const Product product = random_product(random, trial % 2 == 1);
    const auto model = product.model();
    const double final = std::abs(model.numerator().back().coefficient / model.denominator().back().coefficient);
    for (const double t : {0.3, 3.0, 12.0}) {
      const double exact = step_response(product, t);
      const auto value = frac::reference_response(model, {}, std::vector<double>{t})[0];
      EXPECT_LE(std::abs(value.value - exact), 1e-9 * std::max(final, std::abs(exact)))
          << model.formula() << " at " << t << " s";
      EXPECT_LE(std::abs(value.value - exact), value.error_estimate + 1e-14 * final) << model.formula() << ' ' << t;
    }
  }
}

TEST(EqualPoles, FilterIsThePartialFractionExpansion) {
  Random random(20262);
  for (int trial = 0; trial < 16; ++trial) {
    const Product product = random_product(random, trial % 2 == 1);
    const auto model = product.model();
    const std::vector<double> output = frac::respond(model, std::vector<double>(41, 1.0), 0.3, 1e-11);
    double largest = 0;
    for (const double each : output) largest = std::max(largest, std::abs(each));
    for (const std::size_t n : {3u, 12u, 40u}) {
      const double exact = step_response(product, 0.3 * static_cast<double>(n));
      EXPECT_LE(std::abs(output[n] - exact), 1e-9 * largest) << model.formula() << " sample " << n;
    }
  }
}

// Instants that are not even have a sum of exponentials of their own.
TEST(EqualPoles, ResponseAtSingleInstantsIsThePartialFractionExpansion) {
  Random random(20264);
  for (int trial = 0; trial < 16; ++trial) {
    const Product product = random_product(random, trial % 2 == 1);
    const auto model = product.model();
    const std::vector<double> time{0.4, 1.7, 5, 11};
    const auto response = frac::respond(model, frac::ResponseInput{frac::ResponseInput::Kind::step, 0}, time, 1e-9,
                                        frac::ResponseMethod::exponential_sum);
    const double final = std::abs(model.numerator().back().coefficient / model.denominator().back().coefficient);
    for (std::size_t n = 0; n < time.size(); ++n) {
      const double exact = step_response(product, time[n]);
      EXPECT_LE(std::abs(response.output[n] - exact), 1e-9 * std::max(final, std::abs(exact)))
          << model.formula() << " at " << time[n] << " s";
    }
  }
}

// Records that end long before the poles show: partial fractions cancel there, so that another method has to be found.
TEST(EqualPoles, RecordsThatEndEarlyAreThePartialFractionExpansion) {
  Random random(20271);
  for (int trial = 0; trial < 12; ++trial) {
    const Product product = random_product(random, trial % 2 == 1);
    const auto model = product.model();
    const double last = random.log_uniform(0.02, 2);
    std::vector<double> time;
    for (int n = 0; n <= 40; ++n) time.push_back(last * n / 40);
    const auto response = frac::respond(model, frac::ResponseInput{frac::ResponseInput::Kind::step, 0}, time, 1e-9);
    EXPECT_TRUE(response.meets_tolerance) << model.formula() << " to " << last << " s";
    for (const std::size_t n : {3u, 17u, 40u}) {
      const double exact = step_response(product, time[n]);
      EXPECT_LE(std::abs(response.output[n] - exact), 1e-9 * std::abs(response.output.back()))
          << model.formula() << " at " << time[n] << " s";
    }
  }
}

// A cut past a pole of high order: what is stated holds however early it is, where the value is far below its parts.
TEST(EqualPoles, StatedErrorsOfEarlyReferenceValuesHold) {
  Random random(20272);
  for (int trial = 0; trial < 12; ++trial) {
    const Product product = random_product(random, trial % 2 == 1);
    const auto model = product.model();
    for (const double t : {0.01, 0.1, 0.7}) {
      const double exact = step_response(product, t);
      const auto value = frac::reference_response(model, {}, std::vector<double>{t})[0];
      EXPECT_LE(std::abs(value.value - exact), value.error_estimate + 1e-14 * std::abs(exact))
          << model.formula() << " at " << t << " s";
      EXPECT_EQ(value.status, frac::ResponseStatus::exact) << model.formula() << " at " << t << " s";
    }
  }
}

TEST(EqualPoles, DigitalFilterIsThePartialFractionExpansion) {
  Random random(20265);
  for (int trial = 0; trial < 16; ++trial) {
    const Product product = random_product(random, trial % 2 == 1);
    const auto model = product.model();
    frac::DigitalFilter<double> filter(frac::filter_design(model, 0.25, 1e-10, 1e3));
    std::vector<double> output(61);
    filter.run(std::vector<double>(61, 1.0), output);
    double largest = 0;
    for (const double each : output) largest = std::max(largest, std::abs(each));
    for (const std::size_t n : {4u, 20u, 60u}) {
      const double exact = step_response(product, 0.25 * static_cast<double>(n));
      EXPECT_LE(std::abs(output[n] - exact), 1e-9 * largest) << model.formula() << " sample " << n;
    }
  }
}

// The state space as it is used, against the product of the factors; its own rounding is far below the tolerance.
TEST(EqualPoles, RealisationKeepsItsTolerance) {
  Random random(20266);
  constexpr double tolerance = 1e-6;
  for (int trial = 0; trial < 12; ++trial) {
    const Product product = random_product(random, trial % 2 == 1);
    const auto model = product.model();
    const frac::RationalModel result = frac::realise(model, {1e-2, 1e2}, tolerance);
    EXPECT_EQ(result.status, frac::RationalModelStatus::met) << model.formula() << ' ' << result.message;
    EXPECT_TRUE(result.stable);
    const frac::StateSpace form = frac::modal_form(result);
    ASSERT_EQ(form.states, result.states);
    for (double omega = 1e-2; omega <= 1e2; omega *= 1.9) {
      const std::complex<double> lambda = std::pow(std::complex<double>(0, omega), product.order);
      std::complex<double> exact = 1;
      for (const auto& [root, multiplicity] : product.roots) {
        for (int i = 0; i < multiplicity; ++i) {
          exact /= lambda - root;
          if (root.imag() != 0) exact /= lambda - std::conj(root);
        }
      }
      EXPECT_LE(std::abs(form.response(omega) / exact - 1.0), 1.01 * tolerance) << model.formula() << ' ' << omega;
    }
  }
}

// Poles of several factors next to each other, with integrators, zeros and powers of s.
TEST(EqualPoles, RealisationOfMixedProductsKeepsItsTolerance) {
  for (const char* formula : {"1/((s + 1)^4 (s + 1.01)^4 (s + 3)^4)", "1/((s + 1)^4 (s^0.7 + 2)^3)",
                              "(s + 2)^2 s^0.5/((s + 1)^4 (s^0.7 + 2)^3)", "3/(s^2.4 (s + 1)^5 (s^0.5 + 1)^2)",
                              "1/((s^2 + 2 s + 1.0001)^4 (s + 1)^3)", "(s^0.5 + 4)^2/((s + 1)^4 (s + 1.02)^3)"}) {
    const auto model = FractionalTransferFunction::parse(formula);
    const frac::RationalModel result = frac::realise(model, {1e-2, 1e2}, 1e-6);
    EXPECT_EQ(result.status, frac::RationalModelStatus::met) << formula << ' ' << result.message;
    const frac::StateSpace form = frac::modal_form(result);
    for (double omega = 1e-2; omega <= 1e2; omega *= 1.9) {
      EXPECT_LE(std::abs(form.response(omega) / model.response(omega) - 1.0), 1.01e-6) << formula << ' ' << omega;
    }
  }
}

// Each root s = lambda^(1/a) with |arg| <= pi, as often as it was given.
TEST(EqualPoles, MultiplicitiesAreThosePutIn) {
  Random random(20263);
  for (int trial = 0; trial < 200; ++trial) {
    const Product product = random_product(random, trial % 2 == 1);
    const auto model = product.model();
    const auto analysis = frac::analyse_stability(model);
    EXPECT_NE(analysis.stability, frac::Stability::undetermined) << model.formula();
    std::size_t expected = 0;
    constexpr double pi = 3.14159265358979324;
    for (const auto& [lambda, multiplicity] : product.roots) {
      // The conjugate root comes round to the upper half for orders above 1.
      for (const double turned : {std::arg(lambda), 2 * pi - std::arg(lambda)}) {
        const double argument = turned / product.order;
        if (argument > pi * (1 + 1e-15) || (lambda.imag() == 0 && turned > pi)) continue;
        ++expected;
        const std::complex<double> s = std::polar(std::pow(std::abs(lambda), 1 / product.order), argument);
        const bool found = std::any_of(analysis.poles.begin(), analysis.poles.end(), [&](const frac::Pole& pole) {
          return std::abs(pole.value - s) < 1e-12 * std::abs(s) && pole.multiplicity == multiplicity;
        });
        EXPECT_TRUE(found) << model.formula();
        if (lambda.imag() == 0) break;
      }
    }
    EXPECT_EQ(analysis.poles.size(), expected) << model.formula();
  }
}

TEST(EqualPoles, AreClustersOfAnExpandedPolynomialToo) {
  for (int multiplicity = 2; multiplicity <= 8; ++multiplicity) {
    // Binomial coefficients are exact.
    std::vector<frac::PowerTerm> terms;
    double binomial = 1;
    for (int k = 0; k <= multiplicity; ++k) {
      terms.push_back({binomial, static_cast<double>(k)});
      binomial = binomial * (multiplicity - k) / (k + 1);
    }
    const auto analysis = frac::analyse_stability(FractionalTransferFunction({{1, 0}}, terms));
    EXPECT_EQ(analysis.stability, frac::Stability::stable);
    ASSERT_EQ(analysis.poles.size(), 1u) << multiplicity;
    EXPECT_EQ(analysis.poles[0].multiplicity, multiplicity);
    // The middle is a simple root of a derivative.
    EXPECT_NEAR(analysis.poles[0].value.real(), -1, 1e-12);
  }
}

TEST(EqualPoles, NormsOfALagToAPower) {
  for (int power = 1; power <= 8; ++power) {
    const auto model = FractionalTransferFunction::parse("1/(s + 1)^" + std::to_string(power));
    EXPECT_DOUBLE_EQ(frac::h_infinity_norm(model).gain, 1);
    // int_0^inf (1 + w^2)^-n dw = sqrt(pi) Gamma(n - 1/2)/(2 Gamma(n)).
    const double square = std::tgamma(power - 0.5) / (2 * std::sqrt(3.141592653589793) * std::tgamma(power));
    EXPECT_NEAR(frac::h2_norm(model) / std::sqrt(square), 1, 1e-12) << power;
  }
}

TEST(EqualPoles, FormulasKeepTheirFactors) {
  const auto text = [](const char* formula) { return FractionalTransferFunction::parse(formula).formula(); };
  EXPECT_EQ(text("1/(s + 1)^4"), "1/((s + 1)^4)");
  EXPECT_EQ(text("2/((s + 1) (s + 1) (s + 2))"), "2/((s + 1)^2 (s + 2))");
  EXPECT_EQ(text("1/(s + 1)^3 + 2/(s + 1)"), "(2 s^2 + 4 s + 3)/((s + 1)^3)");
  EXPECT_EQ(text("exp(-0.5 s) * 3 s^0.5 (s + 1)^2/(4 (s + 2)^3)"),
            text("exp(-0.5 s) * 0.75 s^0.5 (s + 1)^2/((s + 2)^3)"));
  EXPECT_EQ(text("(s^0.5 + 1)/(s^2 + s)"), "(s^0.5 + 1)/(s^2 + s)");
  for (const char* formula : {"-2 s^0.3 (s + 1)^2/(s^1.3 (s + 2) (s^0.5 + 3)^3)", "exp(-s) (s + 2)^2",
                              "5/(s (s + 1)^2)", "1/((s - 1)^2 + 1)^3", "(1/(s + 1) + 2/(s + 3))^2"}) {
    const auto model = FractionalTransferFunction::parse(formula);
    EXPECT_EQ(FractionalTransferFunction::parse(model.formula()), model) << model.formula();
  }
}

// What cancels a pole must vanish as often as the pole.
TEST(EqualPoles, AZeroCancelsOnlyItsOwnMultiplicity) {
  const auto stability = [](const char* formula) {
    return frac::analyse_stability(FractionalTransferFunction::parse(formula)).stability;
  };
  EXPECT_EQ(stability("(s - 1)/((s - 1)^2 (s + 1))"), frac::Stability::unstable);
  EXPECT_EQ(stability("(s - 1)^2/((s - 1)^2 (s + 1))"), frac::Stability::stable);
  EXPECT_EQ(stability("(s - 1)/((s - 1) (s + 1))"), frac::Stability::stable);
}

}  // namespace
