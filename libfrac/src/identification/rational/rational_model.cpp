// SPDX-License-Identifier: BSD-3-Clause
#include "rational_model.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <utility>

#include "base/polynomial.hpp"

namespace frac::detail {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// A whole power of s, or of s^a.
std::string power_of_s(std::size_t power, bool free_order) {
  if (power == 0) return "";
  if (!free_order) return power == 1 ? " s" : " s^" + std::to_string(power);
  return power == 1 ? " s^a" : " s^(" + std::to_string(power) + " a)";
}

/// The denominator split off whole powers: numerator = quotient * denominator + remainder, by rising powers.
std::pair<std::vector<double>, std::vector<double>> divided(std::vector<double> numerator,
                                                            const std::vector<double>& denominator) {
  const std::size_t order = denominator.size() - 1;
  std::vector<double> quotient(numerator.size() - order, 0.0);
  for (std::size_t i = numerator.size(); i-- > order;) {
    const double factor = numerator[i] / denominator[order];
    quotient[i - order] = factor;
    for (std::size_t k = 0; k <= order; ++k) numerator[i - order + k] -= factor * denominator[k];
  }
  numerator.resize(order);
  return {quotient, numerator};
}

class Writer {
 public:
  explicit Writer(bool free_order) : free_order_(free_order) {}

  /// A sum of powers with coefficients of either sign, named by letter and power.
  [[nodiscard]] std::string polynomial(const char* letter, std::size_t low, const std::vector<double>& coefficients) {
    std::string text;
    for (std::size_t i = 0; i < coefficients.size(); ++i) {
      const std::string name = letter + std::to_string(low + i);
      text += (i > 0 ? " + " : "") + name + power_of_s(low + i, free_order_);
      add(name, coefficients[i], true);
    }
    return text;
  }
  void add(const std::string& name, double start, bool either_sign) {
    ParameterConstraint constraint{name, {}, {}, {}, start};
    if (either_sign) constraint.lower = -infinity;
    constraints.push_back(std::move(constraint));
  }
  /// Positive, and so fitted as its logarithm, where it may be nothing else.
  void add_damping(const std::string& name, double start, double least) {
    add(name, start, false);
    if (least != 0) constraints.back().lower = least;
  }
  std::vector<ParameterConstraint> constraints;

 private:
  bool free_order_;
};

/// The largest order up to which all pairs of a stable shape stay stable with their dampings in a box, half way between
/// the order of the shape and the one at which the first of them would be on the imaginary axis: within the box of
/// smaller orders and dampings above least_sinh_damping() of it every member is stable.
double most_stable_order(const RationalShape& shape) {
  double most = most_order;
  for (const PoleFactor& factor : shape.factors) {
    const double sine = std::sinh(factor.damping);
    if (!factor.pair || sine >= least_sinh_damping(most_order)) continue;
    const double on_axis = 2 / std::numbers::pi * std::acos(std::clamp(-sine, -1.0, 1.0));
    most = std::min(most, (shape.order + on_axis) / 2);
  }
  return std::max(most, shape.order);
}

}  // namespace

NamedModel written_out(const RationalProblem& problem, const RationalShape& shape, Component component) {
  const double centre = problem.centre_omega();
  // An order that makes no difference does not appear.
  const bool free_order = shape.searches_order();
  Writer writer(free_order);
  const bool stable = problem.poles() == Poles::stable;
  const double greatest_order = stable && free_order ? most_stable_order(shape) : most_order;
  const double least_damping = 2 * least_sinh_damping(free_order ? greatest_order : 1);
  std::string denominator = shape.integrators > 0 ? power_of_s(shape.integrators, free_order).substr(1) : "";
  std::vector<double> expanded{1};
  std::size_t real = 0, pairs = 0;
  for (const PoleFactor& factor : shape.factors) {
    const double size = std::exp(factor.log_size) * centre;
    const double in_z = std::pow(size, shape.order);
    std::vector<double> of_factor{1, factor.sign / in_z};
    denominator += denominator.empty() ? "" : " ";
    if (factor.pair) {
      const std::string w = "w" + std::to_string(++pairs), d = "d" + std::to_string(pairs);
      denominator += free_order ? "((s/" + w + ")^(2 a) + " + d + " (s/" + w + ")^a + 1)"
                                : "(s^2/" + w + "^2 + " + d + " s/" + w + " + 1)";
      const double damping = 2 * std::sinh(factor.damping);
      writer.add(w, size, false);
      writer.add_damping(d, damping, stable ? std::min(least_damping, damping) : -infinity);
      of_factor = {1, damping / in_z, 1 / (in_z * in_z)};
    } else {
      const std::string p = "p" + std::to_string(++real);
      if (free_order) {
        // A power of a negative number has no real value, so the sign stands apart.
        denominator += factor.sign < 0 ? "(1 - (s/" + p + ")^a)" : "((s/" + p + ")^a + 1)";
        writer.add(p, size, false);
      } else {
        denominator += "(s/" + p + " + 1)";
        writer.add(p, factor.sign * size, factor.sign < 0);
      }
    }
    expanded = polynomial_product(expanded, of_factor);
  }

  std::vector<double> numerator = problem.numerator(shape);
  std::string formula;
  std::size_t low = shape.low;
  const bool blind_to_constant = component == Component::imaginary && shape.integrators == 0 && !shape.delayed &&
                                 !shape.factors.empty() && shape.degree >= shape.poles();
  if (blind_to_constant) {
    // The imaginary part tells the fraction only up to a constant, which therefore stands apart.
    numerator.insert(numerator.begin(), low, 0.0);
    const auto [quotient, remainder] = divided(numerator, expanded);
    formula = writer.polynomial("h", 0, quotient) + " + ";
    numerator = remainder;
    low = 0;
  }
  const std::string top = writer.polynomial("b", low, numerator);
  formula += denominator.empty() ? top : "(" + top + ")/(" + denominator + ")";
  if (shape.delayed) {
    formula = "exp(-L s) (" + formula + ")";
    writer.add("L", shape.delay / centre, false);
  }
  if (free_order) writer.constraints.push_back({"a", {}, least_order, greatest_order, shape.order});
  NamedModel model{(free_order ? "commensurate:" : "rational:") + std::to_string(shape.degree) + "/" +
                       std::to_string(shape.poles()) + (shape.delayed ? "+delay" : ""),
                   formula, free_order ? ModelClass::fractional : ModelClass::integer_order,
                   free_order ? "ratio of polynomials in s^a, factored" : "ratio of polynomials in s, factored",
                   std::move(writer.constraints)};
  return model;
}

}  // namespace frac::detail
