// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <boost/multiprecision/complex_adaptor.hpp>
#include <cmath>
#include <numbers>
#include <numeric>
#include <stdexcept>

#include "approximation/multiprecision.hpp"
#include "approximation/unit_design.hpp"
#include "base/number_text.hpp"
#include "base/polynomial.hpp"

namespace frac::detail {
namespace {

using MultiprecisionComplex =
    boost::multiprecision::number<boost::multiprecision::complex_adaptor<Multiprecision::backend_type>,
                                  boost::multiprecision::et_off>;

constexpr int most_denominator = 10;
constexpr int most_root = 42;  // 6/7 = 1/2 + 1/3 + 1/42 needs it
constexpr int most_poles = 100;

// Distinct roots q with order = sum 1/q: one, else two, else three, the smallest sum of them.  For m > 1 the iteration
// for x^q = s^m itself is of no use: at s = j omega the argument of s^m passes pi, and x runs to another branch.
std::vector<int> roots_that_make(double order) {
  for (int denominator = 2; denominator <= most_denominator; ++denominator) {
    const int numerator = static_cast<int>(std::nearbyint(order * denominator));
    // A decimal such as 0.3 is its fraction to half an ulp.
    if (numerator < 1 || numerator >= denominator || std::abs(order * denominator - numerator) > 4e-16 * denominator) {
      continue;
    }
    if (numerator == 1) return {denominator};
    std::vector<int> best;
    const auto consider = [&](const std::vector<int>& roots) {
      if (best.empty() ||
          std::accumulate(roots.begin(), roots.end(), 0) < std::accumulate(best.begin(), best.end(), 0)) {
        best = roots;
      }
    };
    for (int p = 2; p <= most_root; ++p) {
      for (int q = p + 1; q <= most_root; ++q) {
        if (denominator * (p + q) == numerator * p * q) consider({p, q});
      }
    }
    if (!best.empty()) return best;
    for (int p = 2; p <= most_root; ++p) {
      for (int q = p + 1; q <= most_root; ++q) {
        for (int r = q + 1; r <= most_root; ++r) {
          if (denominator * (p * q + q * r + r * p) == numerator * p * q * r) consider({p, q, r});
        }
      }
    }
    return best;
  }
  throw std::invalid_argument("carlson: the fractional part " + number_text(order) +
                              " of the order is not m/q with q <= " + std::to_string(most_denominator));
}

Polynomial power(const Polynomial& base, int exponent) {
  Polynomial result{1};
  for (int i = 0; i < exponent; ++i) result = polynomial_product(result, base);
  return result;
}

// first a + second s b.
Polynomial combination(int first, const Polynomial& a, int second, const Polynomial& b) {
  Polynomial result(std::max(a.size(), b.size() + 1));
  for (std::size_t i = 0; i < a.size(); ++i) result[i] += first * a[i];
  for (std::size_t i = 0; i < b.size(); ++i) result[i + 1] += second * b[i];
  return result;
}

MultiprecisionComplex value_of(const Polynomial& polynomial, const MultiprecisionComplex& s,
                               MultiprecisionComplex& slope) {
  MultiprecisionComplex value = 0;
  slope = 0;
  for (std::size_t k = polynomial.size(); k-- > 0;) {
    slope = slope * s + value;
    value = value * s + MultiprecisionComplex(polynomial[k]);
  }
  return value;
}

// Roots by the simultaneous iteration of Aberth (1973), started on the radii that the upper convex hull of
// ln |coefficient| suggests (Bini 1996).
std::vector<MultiprecisionComplex> roots_of(const Polynomial& polynomial) {
  const std::size_t degree = polynomial.size() - 1;
  std::vector<std::size_t> hull;
  std::vector<double> height;
  for (const Multiprecision& coefficient : polynomial) {
    height.push_back(static_cast<double>(Multiprecision(log(abs(coefficient)))));
  }
  for (std::size_t i = 0; i <= degree; ++i) {
    const auto slope = [&](std::size_t from, std::size_t to) {
      return (height[to] - height[from]) / static_cast<double>(to - from);
    };
    while (hull.size() >= 2 && slope(hull[hull.size() - 2], hull.back()) <= slope(hull.back(), i)) hull.pop_back();
    hull.push_back(i);
  }
  std::vector<MultiprecisionComplex> root;
  for (std::size_t piece = 0; piece + 1 < hull.size(); ++piece) {
    const std::size_t from = hull[piece];
    const std::size_t to = hull[piece + 1];
    const double radius = std::exp((height[from] - height[to]) / static_cast<double>(to - from));
    for (std::size_t k = from; k < to; ++k) {
      const double angle =
          2 * std::numbers::pi * (static_cast<double>(k - from) + 0.3) / static_cast<double>(to - from) +
          0.7 * static_cast<double>(piece);
      root.emplace_back(radius * std::cos(angle), radius * std::sin(angle));
    }
  }
  const Multiprecision close = 1e-30;
  for (int iteration = 0; iteration < 300; ++iteration) {
    bool settled = true;
    for (std::size_t i = 0; i < degree; ++i) {
      MultiprecisionComplex slope;
      const MultiprecisionComplex value = value_of(polynomial, root[i], slope);
      MultiprecisionComplex repulsion = 0;
      for (std::size_t k = 0; k < degree; ++k) {
        if (k != i) repulsion += MultiprecisionComplex(1) / (root[i] - root[k]);
      }
      const MultiprecisionComplex step = value / (slope - value * repulsion);
      root[i] -= step;
      if (Multiprecision(abs(step)) > close * Multiprecision(abs(root[i]))) settled = false;
    }
    if (settled) break;
  }
  return root;
}

void split(const std::vector<MultiprecisionComplex>& roots, std::vector<long double>& negative,
           std::vector<std::complex<long double>>& pairs) {
  for (const MultiprecisionComplex& root : roots) {
    const Multiprecision real = root.real();
    const Multiprecision imaginary = root.imag();
    if (abs(imaginary) <= Multiprecision(1e-25) * abs(real)) {
      negative.push_back(-static_cast<long double>(real));
    } else if (imaginary < 0) {
      pairs.emplace_back(-static_cast<long double>(real), -static_cast<long double>(imaginary));
    }
  }
}

int count_after(int iterations, int root) {
  int count = 0;
  for (int i = 0; i < iterations && count <= most_poles; ++i) count = count * (root + 1) + 1;
  return count;
}

int count_after(int iterations, const std::vector<int>& roots) {
  int count = 0;
  for (const int root : roots) count += count_after(iterations, root);
  return count;
}

// x <- x ((q - 1) x^q + (q + 1) s)/((q + 1) x^q + (q - 1) s), Halley's iteration for x^q = s, from x = 1, with x = P/Q;
// appended to the design.
void append_root(UnitDesign& design, int q, int iterations) {
  Polynomial numerator{1};
  Polynomial denominator{1};
  for (int i = 0; i < iterations; ++i) {
    const Polynomial upper = power(numerator, q);
    const Polynomial lower = power(denominator, q);
    numerator = polynomial_product(numerator, combination(q - 1, upper, q + 1, lower));
    denominator = polynomial_product(denominator, combination(q + 1, upper, q - 1, lower));
  }
  split(roots_of(numerator), design.zeros, design.zero_pairs);
  split(roots_of(denominator), design.poles, design.pole_pairs);
  design.gain *= static_cast<long double>(Multiprecision(numerator.back() / denominator.back()));
}

}  // namespace

std::vector<int> carlson_pole_counts(double order) {
  const std::vector<int> roots = roots_that_make(order);
  std::vector<int> counts;
  for (int iterations = 1; count_after(iterations, roots) <= most_poles; ++iterations) {
    counts.push_back(count_after(iterations, roots));
  }
  return counts;
}

// Carlson, Halijak (1964) for the roots s^(1/q); other fractions are products of those.
UnitDesign carlson_design(const UnitProblem& problem, int poles) {
  const std::vector<int> roots = roots_that_make(problem.order);
  int iterations = 1;
  while (count_after(iterations, roots) < poles) ++iterations;
  UnitDesign design;
  for (const int root : roots) {
    append_root(design, root, iterations);
    design.parameters.emplace_back("root_" + std::to_string(design.parameters.size() + 1), root);
  }
  design.parameters.emplace_back("iterations", iterations);
  const auto by_size = [](const auto& a, const auto& b) { return std::abs(a) < std::abs(b); };
  std::sort(design.zeros.begin(), design.zeros.end());
  std::sort(design.poles.begin(), design.poles.end());
  std::sort(design.zero_pairs.begin(), design.zero_pairs.end(), by_size);
  std::sort(design.pole_pairs.begin(), design.pole_pairs.end(), by_size);
  return design;
}

}  // namespace frac::detail
