// SPDX-License-Identifier: BSD-3-Clause
#include "frequency_axis.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "frac/cancellation.hpp"

namespace frac::detail {
namespace {

using Complex = std::complex<double>;
constexpr double quarter_turn = std::numbers::pi / 2;

void add_about(const std::vector<RootCluster>& roots, std::vector<double>& points) {
  for (const RootCluster& root : roots) {
    const double distance = std::max(1e-12, std::abs(root.log_s.imag() - quarter_turn));
    const double middle = root.log_s.real();
    points.push_back(middle);
    for (double offset = distance / 4; offset < 2; offset *= 1.3) {
      points.push_back(middle - offset);
      points.push_back(middle + offset);
    }
  }
}

// Below this what lies between a sum and its leading term is no more than rounding.
constexpr double invisible = 1e-14;

// By rising order, equal orders added up, what cancels to rounding dropped.
template <typename Part>
std::vector<Part> collected_parts(std::vector<Part> parts) {
  std::sort(parts.begin(), parts.end(), [](const Part& a, const Part& b) { return a.order < b.order; });
  std::vector<Part> result;
  for (const Part& part : parts) {
    if (!result.empty() && part.order - result.back().order <= 1e-13 * std::max(1.0, part.order)) {
      result.back().coefficient += part.coefficient;
      result.back().modulus += part.modulus;
    } else {
      result.push_back(part);
    }
  }
  for (Part& part : result) {
    if (std::abs(part.coefficient) <= 1e-13 * part.modulus) part.coefficient = 0;
  }
  return result;
}

// The part of lowest order outweighs the others and `rest` together.
template <typename Part>
bool leads(const std::vector<Part>& parts, double log_x, double rest) {
  const auto size = [&](const Part& part) { return std::abs(part.coefficient) * std::exp(part.order * log_x); };
  double others = rest;
  double leading = 0;
  for (const Part& part : parts) {
    if (part.coefficient == 0) continue;
    if (leading == 0) {
      leading = size(part);
    } else {
      others += size(part);
    }
  }
  return leading > others;
}

template <typename Part>
double sum_of_sizes(const std::vector<Part>& parts, double log_x) {
  double sum = 0;
  for (const Part& part : parts) sum += std::abs(part.coefficient) * std::exp(part.order * log_x);
  return sum;
}

template <typename Part>
double sum_of_moduli(const std::vector<Part>& parts, double log_x) {
  double sum = 0;
  for (const Part& part : parts) sum += part.modulus * std::exp(part.order * log_x);
  return sum;
}

}  // namespace

AxisLimit::AxisLimit(const LaplaceImage& image, End end) : end_(end) {
  const auto add = [&](const PowerProduct& product, double sign) {
    product.for_each_sum([&](const std::vector<PowerTerm>& terms, int power) {
      const PowerTerm& leading = end == End::low ? terms.back() : terms.front();
      order_ += sign * power * leading.order;
      std::vector<PowerTerm> ratio;  // with the orders as distances
      for (const PowerTerm& term : terms) {
        if (term.order == leading.order) continue;
        ratio.push_back({term.coefficient / leading.coefficient, std::abs(term.order - leading.order)});
      }
      Factor factor{{}, {}, sign * power};
      const double turned = end == End::low ? quarter_turn : -quarter_turn;
      for (const PowerTerm& a : ratio) {
        const double size = std::abs(a.coefficient);
        factor.square.push_back({a.order, 2 * a.coefficient * std::cos(a.order * turned), 2 * size});
        factor.turn.push_back({a.order, a.coefficient * std::sin(a.order * turned), size});
        for (const PowerTerm& b : ratio) {
          const double both = a.coefficient * b.coefficient;
          factor.square.push_back({a.order + b.order, both * std::cos((a.order - b.order) * turned), std::abs(both)});
        }
      }
      factor.square = collected_parts(std::move(factor.square));
      factor.turn = collected_parts(std::move(factor.turn));
      factors_.push_back(std::move(factor));
    });
  };
  add(image.numerator(), 1);
  add(image.denominator(), -1);
}

bool AxisLimit::gain_is_monotone(double u) const {
  const double x = log_x(u);
  // d ln|sum|^2/d ln x = sum order c x^order/(1 + sum c x^order); the divisor is told apart from 1 in `rest`.
  std::vector<Part> slopes;
  double rest = 0;
  double visible = 0;
  for (const Factor& factor : factors_) {
    double slope = 0;
    for (const Part& part : factor.square) {
      slopes.push_back({part.order, factor.power * part.order * part.coefficient,
                        std::abs(factor.power) * part.order * part.modulus});
      slope += std::abs(part.order * part.coefficient) * std::exp(part.order * x);
    }
    const double size = sum_of_sizes(factor.square, x);
    if (!(size < 1)) return false;
    rest += std::abs(factor.power) * slope * size / (1 - size);
    visible += std::abs(factor.power) * slope;
  }
  if (std::abs(order_) > 1e-13) return visible + rest < 2 * std::abs(order_);
  return visible < invisible || leads(collected_parts(std::move(slopes)), x, rest);
}

bool AxisLimit::phase_keeps_side(double u, double delay) const {
  const double x = log_x(u);
  std::vector<Part> turns;
  double rest = 0;
  double visible = 0;
  for (const Factor& factor : factors_) {
    for (const Part& part : factor.turn) {
      turns.push_back({part.order, factor.power * part.coefficient, std::abs(factor.power) * part.modulus});
    }
    const double size = sum_of_moduli(factor.turn, x);
    if (!(size < 1)) return false;
    rest += std::abs(factor.power) * size * size / (2 * (1 - size));
    visible += std::abs(factor.power) * size;
  }
  if (delay > 0 && end_ == End::low) turns.push_back({1, -delay, delay});
  turns = collected_parts(std::move(turns));
  const bool never_turns =
      std::all_of(turns.begin(), turns.end(), [](const Part& part) { return part.coefficient == 0; });
  // A ratio of real polynomials in s^2 has no phase but that of the leading term.
  if (never_turns) return visible < 1e-3;
  return visible < invisible || leads(turns, x, rest);
}

FrequencyAxis::FrequencyAxis(const LaplaceImage& image, double delay) : image_(image), delay_(delay) {
  const auto add = [&](const PowerProduct& product, double sign) {
    product.for_each_sum([&](const std::vector<PowerTerm>& terms, int power) {
      Sum sum{{}, sign * power};
      for (const PowerTerm& term : terms) {
        const double angle = term.order * quarter_turn;
        const double turned = term.coefficient < 0 ? -1 : 1;
        sum.terms.push_back(
            {std::log(std::abs(term.coefficient)), term.order, turned * Complex(std::cos(angle), std::sin(angle))});
      }
      sums_.push_back(std::move(sum));
    });
  };
  add(image.numerator(), 1);
  add(image.denominator(), -1);
}

FrequencyAxis::Value FrequencyAxis::evaluated(const Sum& sum, double u) {
  // Every search along the axis comes through here.
  throw_if_cancelled();
  Value result{0, 0, -std::numeric_limits<double>::infinity()};
  for (const Term& term : sum.terms) result.scale = std::max(result.scale, term.log_size + term.order * u);
  for (const Term& term : sum.terms) {
    const Complex part = std::exp(term.log_size + term.order * u - result.scale) * term.phase;
    result.value += part;
    result.slope += term.order * part;
  }
  return result;
}

Complex FrequencyAxis::value(double u) const {
  Complex direction = 1;
  double scale = 0;
  for (const Sum& sum : sums_) {
    const Value each = evaluated(sum, u);
    scale += sum.power * each.scale;
    direction *= sum.power == 1 ? each.value : sum.power == -1 ? 1.0 / each.value : std::pow(each.value, sum.power);
  }
  return direction * std::exp(Complex(scale, -delay_ * std::exp(u)));
}

double FrequencyAxis::log_gain(double u) const {
  double sum_of_logs = 0;
  for (const Sum& sum : sums_) {
    const Value each = evaluated(sum, u);
    sum_of_logs += sum.power * (std::log(std::abs(each.value)) + each.scale);
  }
  return sum_of_logs;
}

Complex FrequencyAxis::log_slope(double u) const {
  Complex slope(0, -delay_ * std::exp(u));
  for (const Sum& sum : sums_) {
    const Value each = evaluated(sum, u);
    slope += sum.power * (each.slope / each.value);
  }
  return slope;
}

std::vector<double> FrequencyAxis::breakpoints(double first, double last) const {
  std::vector<double> points;
  constexpr double spacing = 0.02;
  for (double u = first; u < last; u += spacing) points.push_back(u);
  points.push_back(last);
  add_about(image_.poles().clusters, points);
  add_about(power_sum_roots(image_.numerator(), 1.5 * std::numbers::pi).clusters, points);
  std::sort(points.begin(), points.end());
  std::erase_if(points, [&](double u) { return u < first || u > last; });
  return points;
}

}  // namespace frac::detail
