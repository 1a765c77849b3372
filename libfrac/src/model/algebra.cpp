// SPDX-License-Identifier: BSD-3-Clause
#include "frac/model/algebra.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <utility>

#include "base/number_text.hpp"
#include "formula/power_sum.hpp"
#include "frac/no_ratio.hpp"

namespace frac {
namespace {

using Terms = std::vector<PowerTerm>;
constexpr double eps = std::numeric_limits<double>::epsilon();

// Without the power of s that both share.
FractionalTransferFunction without_common_power(Terms numerator, Terms denominator, double delay) {
  const double common = std::min(numerator.back().order, denominator.back().order);
  if (common > 0) {
    numerator = detail::scaled(std::move(numerator), 1, -common);
    denominator = detail::scaled(std::move(denominator), 1, -common);
  }
  return {std::move(numerator), std::move(denominator), delay};
}

using Factors = std::vector<PowerFactor>;

bool is_factored(const FractionalTransferFunction& a) {
  return !a.denominator_factors().empty();
}

Factors numerator_factors(const FractionalTransferFunction& a) {
  if (is_factored(a)) return a.numerator_factors();
  return {{a.numerator(), 1}};
}

Factors denominator_factors(const FractionalTransferFunction& a) {
  if (is_factored(a)) return a.denominator_factors();
  return {{a.denominator(), 1}};
}

Factors joined(Factors a, const Factors& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

struct Fraction {
  long numerator, denominator;
};

// Fraction of least denominator within the tolerance: convergents of the continued fraction and the fractions between
// them, in the order of their denominators.
std::optional<Fraction> nearest_fraction(double value, double tolerance, long most_denominator) {
  long before_top = 1, before_bottom = 0;
  long top = static_cast<long>(std::floor(value)), bottom = 1;
  double rest = value - std::floor(value);
  const auto fits = [&](long n, long d) {
    return std::abs(value - static_cast<double>(n) / static_cast<double>(d)) <= tolerance;
  };
  for (int step = 0; step < 64; ++step) {
    if (fits(top, bottom)) return Fraction{top, bottom};
    if (rest < 1e-15) return std::nullopt;
    const double inverse = 1 / rest;
    const double whole = std::min(std::floor(inverse), static_cast<double>(most_denominator) + 1);
    rest = inverse - std::floor(inverse);
    for (long k = 1; k <= static_cast<long>(whole); ++k) {
      const long n = k * top + before_top;
      const long d = k * bottom + before_bottom;
      if (d > most_denominator) return std::nullopt;
      if (fits(n, d)) return Fraction{n, d};
    }
    const long next_top = static_cast<long>(whole) * top + before_top;
    const long next_bottom = static_cast<long>(whole) * bottom + before_bottom;
    before_top = std::exchange(top, next_top);
    before_bottom = std::exchange(bottom, next_bottom);
  }
  return std::nullopt;
}

constexpr double order_rounding = 1e-12;

// Copy whose orders start at 0, those within rounding of a short fraction made that fraction.
Terms cleaned(const Terms& terms, double lowest) {
  Terms result = detail::scaled(terms, 1, -lowest);
  for (PowerTerm& term : result) {
    const auto fraction = nearest_fraction(term.order, order_rounding * std::max(1.0, std::abs(term.order)), 1000);
    if (fraction) term.order = static_cast<double>(fraction->numerator) / static_cast<double>(fraction->denominator);
  }
  return detail::collected(std::move(result));
}

struct Division {
  Terms quotient, remainder;
  double size;  // of the largest coefficient that the remainder was formed from
};

// Long division by falling orders, which need not be whole.  Orders without a common divisor make ever more terms; so
// many tell no factor, as rounding is then larger than what they leave.
Division divided(const Terms& dividend, const Terms& divisor) {
  constexpr int most_steps = 400;
  const std::size_t most_terms = std::max<std::size_t>(most_steps, dividend.size());
  Division result{{}, dividend, 0};
  for (const PowerTerm& term : dividend) result.size = std::max(result.size, std::abs(term.coefficient));
  for (int step = 0; step < most_steps; ++step) {
    if (result.remainder.empty() || result.remainder.size() > most_terms) break;
    const PowerTerm leading = result.remainder.front();
    const PowerTerm term{leading.coefficient / divisor.front().coefficient, leading.order - divisor.front().order};
    if (term.order < -1e-12) break;
    result.quotient.push_back(term);
    Terms part = detail::scaled(divisor, -term.coefficient, term.order);
    for (const PowerTerm& each : part) result.size = std::max(result.size, std::abs(each.coefficient));
    // The leading terms cancel by construction.
    part.erase(part.begin());
    result.remainder = detail::merged({result.remainder.begin() + 1, result.remainder.end()}, part);
    std::erase_if(result.remainder,
                  [&](const PowerTerm& each) { return std::abs(each.coefficient) <= 64 * eps * result.size; });
  }
  return result;
}

// Common factor by Euclid's algorithm; empty where there is none.
Terms common_factor(Terms a, Terms b) {
  for (int step = 0; step < 200; ++step) {
    if (a.front().order < b.front().order) std::swap(a, b);
    Division division = divided(a, b);
    if (division.remainder.empty()) return b.size() > 1 ? b : Terms{};
    if (division.remainder.front().order >= b.front().order) return {};
    a = std::move(b);
    b = std::move(division.remainder);
    if (b.size() == 1) return {};
    // Coefficients keep about the size 1.
    double size = 0;
    for (const PowerTerm& term : b) size = std::max(size, std::abs(term.coefficient));
    b = detail::scaled(std::move(b), 1 / size, 0);
  }
  return {};
}

}  // namespace

FractionalTransferFunction operator+(const FractionalTransferFunction& a, const FractionalTransferFunction& b) {
  if (a.delay() != b.delay()) {
    throw NoRatio("sum of transfer functions: their dead times " + detail::number_text(a.delay()) + " s and " +
                  detail::number_text(b.delay()) +
                  " s differ, so that the sum is no ratio of sums of powers with one dead time");
  }
  const bool same = a.denominator() == b.denominator();
  Terms numerator = same ? detail::merged(a.numerator(), b.numerator())
                         : detail::merged(detail::product(a.numerator(), b.denominator()),
                                          detail::product(b.numerator(), a.denominator()));
  if (numerator.empty()) throw std::invalid_argument("sum of transfer functions: they cancel; the result is zero");
  return without_common_power(std::move(numerator),
                              same ? a.denominator() : detail::product(a.denominator(), b.denominator()), a.delay());
}

FractionalTransferFunction operator-(const FractionalTransferFunction& a) {
  return -1 * a;
}

FractionalTransferFunction operator*(double factor, const FractionalTransferFunction& a) {
  if (is_factored(a)) {
    return FractionalTransferFunction::from_factors(joined({{{{factor, 0}}, 1}}, numerator_factors(a)),
                                                    denominator_factors(a), a.delay());
  }
  return {detail::scaled(a.numerator(), factor, 0), a.denominator(), a.delay()};
}

FractionalTransferFunction operator-(const FractionalTransferFunction& a, const FractionalTransferFunction& b) {
  return a + -b;
}

FractionalTransferFunction operator*(const FractionalTransferFunction& a, const FractionalTransferFunction& b) {
  if (is_factored(a) || is_factored(b)) {
    return FractionalTransferFunction::from_factors(joined(numerator_factors(a), numerator_factors(b)),
                                                    joined(denominator_factors(a), denominator_factors(b)),
                                                    a.delay() + b.delay());
  }
  return without_common_power(detail::product(a.numerator(), b.numerator()),
                              detail::product(a.denominator(), b.denominator()), a.delay() + b.delay());
}

FractionalTransferFunction operator/(const FractionalTransferFunction& a, const FractionalTransferFunction& b) {
  if (b.delay() > a.delay()) {
    throw std::invalid_argument("quotient of transfer functions: the divisor's dead time " +
                                detail::number_text(b.delay()) + " s exceeds the dividend's " +
                                detail::number_text(a.delay()) + " s; the result would have to look into the future");
  }
  if (is_factored(a) || is_factored(b)) {
    return FractionalTransferFunction::from_factors(joined(numerator_factors(a), denominator_factors(b)),
                                                    joined(denominator_factors(a), numerator_factors(b)),
                                                    a.delay() - b.delay());
  }
  return without_common_power(detail::product(a.numerator(), b.denominator()),
                              detail::product(a.denominator(), b.numerator()), a.delay() - b.delay());
}

FractionalTransferFunction feedback(const FractionalTransferFunction& forward,
                                    const FractionalTransferFunction& backward) {
  const double delay = forward.delay() + backward.delay();
  if (delay > 0) {
    throw NoRatio("feedback: the loop has a dead time of " + detail::number_text(delay) +
                  " s, so that the closed loop is no ratio of sums of powers; the stability analysis of "
                  "the loop itself says whether it is stable when closed");
  }
  const Terms loop_top = detail::product(forward.numerator(), backward.numerator());
  const Terms loop_bottom = detail::product(forward.denominator(), backward.denominator());
  Terms denominator = detail::merged(loop_top, loop_bottom);
  if (denominator.empty()) throw std::invalid_argument("feedback: 1 + forward backward is zero");
  return without_common_power(detail::product(forward.numerator(), backward.denominator()), std::move(denominator), 0);
}

FractionalTransferFunction simplified(const FractionalTransferFunction& model) {
  const double lowest = std::min(model.numerator().back().order, model.denominator().back().order);
  Terms numerator = cleaned(model.numerator(), lowest);
  Terms denominator = cleaned(model.denominator(), lowest);
  if (numerator.size() > 1 && denominator.size() > 1) {
    const Terms factor = common_factor(numerator, denominator);
    if (!factor.empty()) {
      Division top = divided(numerator, factor);
      Division bottom = divided(denominator, factor);
      if (top.remainder.empty() && bottom.remainder.empty()) {
        numerator = cleaned(top.quotient, 0);
        denominator = cleaned(bottom.quotient, 0);
      }
    }
  }
  return {std::move(numerator), std::move(denominator), model.delay()};
}

std::optional<CommensurateOrder> commensurate_order(const FractionalTransferFunction& model, long most_denominator) {
  constexpr long most_common = 1'000'000;
  std::vector<Fraction> fractions;
  long common = 1;
  for (const auto* terms : {&model.numerator(), &model.denominator()}) {
    for (const PowerTerm& term : *terms) {
      const double order = std::abs(term.order);
      if (order > 1e6) return std::nullopt;
      const auto fraction = nearest_fraction(order, order_rounding * std::max(1.0, order), most_denominator);
      if (!fraction) return std::nullopt;
      fractions.push_back(*fraction);
      common = std::lcm(common, fraction->denominator);
      if (common > most_common) return std::nullopt;
    }
  }
  long divisor = 0;
  for (const Fraction& fraction : fractions) {
    divisor = std::gcd(divisor, fraction.numerator * (common / fraction.denominator));
  }
  if (divisor == 0) return std::nullopt;
  const long shared = std::gcd(divisor, common);
  return CommensurateOrder{divisor / shared, common / shared};
}

}  // namespace frac
