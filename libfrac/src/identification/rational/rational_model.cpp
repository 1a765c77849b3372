// SPDX-License-Identifier: BSD-3-Clause
#include "rational_model.hpp"

#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

#include "identification/data/residual_rule.hpp"

namespace frac::detail {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

std::string power_of_s(std::size_t power) {
  if (power == 0) return "";
  return power == 1 ? " s" : " s^" + std::to_string(power);
}

/// The denominator split off whole powers: numerator = quotient * denominator + rest, by rising powers.
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
  /// A sum of powers with coefficients of either sign, named by letter and power.
  [[nodiscard]] std::string polynomial(const char* letter, std::size_t low, const std::vector<double>& coefficients) {
    std::string text;
    for (std::size_t i = 0; i < coefficients.size(); ++i) {
      const std::string name = letter + std::to_string(low + i);
      text += (i > 0 ? " + " : "") + name + power_of_s(low + i);
      add(name, coefficients[i], true);
    }
    return text;
  }
  void add(const std::string& name, double start, bool either_sign) {
    ParameterConstraint constraint{name, {}, {}, {}, start};
    if (either_sign) constraint.lower = -infinity;
    constraints.push_back(std::move(constraint));
  }
  std::vector<ParameterConstraint> constraints;
};

}  // namespace

NamedModel written_out(const RationalProblem& problem, const RationalShape& shape, Component component) {
  const double centre = problem.centre_omega();
  Writer writer;
  std::string denominator = shape.integrators > 0 ? power_of_s(shape.integrators).substr(1) : "";
  std::vector<double> expanded{1};
  std::size_t real = 0, pairs = 0;
  for (const PoleFactor& factor : shape.factors) {
    const double size = std::exp(factor.log_size) * centre;
    std::vector<double> of_factor{1, factor.sign / size};
    denominator += denominator.empty() ? "" : " ";
    if (factor.pair) {
      const std::string w = "w" + std::to_string(++pairs), d = "d" + std::to_string(pairs);
      denominator += "(s^2/" + w + "^2 + " + d + " s/" + w + " + 1)";
      const double damping = 2 * std::sinh(factor.damping);
      writer.add(w, size, false);
      writer.add(d, damping, true);
      of_factor = {1, damping / size, 1 / (size * size)};
    } else {
      const std::string p = "p" + std::to_string(++real);
      denominator += "(s/" + p + " + 1)";
      writer.add(p, factor.sign * size, factor.sign < 0);
    }
    std::vector<double> product(expanded.size() + of_factor.size() - 1, 0.0);
    for (std::size_t i = 0; i < expanded.size(); ++i) {
      for (std::size_t k = 0; k < of_factor.size(); ++k) product[i + k] += expanded[i] * of_factor[k];
    }
    expanded = std::move(product);
  }

  std::vector<double> numerator = problem.numerator(shape);
  std::string formula;
  std::size_t low = shape.low;
  const bool blind_to_constant = component == Component::imaginary && shape.integrators == 0 && !shape.delayed &&
                                 !shape.factors.empty() && shape.degree >= shape.order();
  if (blind_to_constant) {
    // The imaginary part tells the fraction only up to a constant, which therefore stands apart.
    numerator.insert(numerator.begin(), low, 0.0);
    const auto [quotient, rest] = divided(numerator, expanded);
    formula = writer.polynomial("h", 0, quotient) + " + ";
    numerator = rest;
    low = 0;
  }
  const std::string top = writer.polynomial("b", low, numerator);
  formula += denominator.empty() ? top : "(" + top + ")/(" + denominator + ")";
  if (shape.delayed) {
    formula = "exp(-L s) (" + formula + ")";
    writer.add("L", shape.delay / centre, false);
  }
  NamedModel model{"rational:" + std::to_string(shape.degree) + "/" + std::to_string(shape.order()) +
                       (shape.delayed ? "+delay" : ""),
                   formula,
                   ModelClass::integer_order,
                   "ratio of polynomials in s, factored",
                   std::move(writer.constraints),
                   std::nullopt};
  return model;
}

RationalMembers rational_members(const FrequencyResponseData& data, const RationalFamily& family,
                                 const FitOptions& options) {
  if (options.component == Component::magnitude || options.component == Component::phase) {
    throw std::invalid_argument("rational families are grown on the real and the imaginary part, not on the " +
                                std::string(to_string(options.component)) + "; write the fraction as a formula");
  }
  // Logarithmic residuals are relative ones as long as they are small, and linear in the numerator only so.
  const bool logarithmic = options.weight == Weight::log_complex;
  const ResidualRule rule =
      logarithmic ? residual_rule(data, options.component, Weight::relative) : residual_rule(data, options);
  const RationalProblem problem(data, rule);
  if (2 * family.fewest_poles + 2 > problem.rows()) {
    throw std::invalid_argument(std::to_string(problem.rows()) + " residuals cannot determine " +
                                std::to_string(family.fewest_poles) + " poles and their numerator");
  }
  RationalMembers members;
  if (family.zeros) {
    const RationalFit fit = fit_rational(problem, *family.zeros, family.fewest_poles, family.dead_time);
    members.models.push_back(written_out(problem, fit.shape, options.component));
    return members;
  }
  const RationalLadder ladder = grow_rational(problem, family.fewest_poles, family.most_poles, family.dead_time);
  for (const RationalFit& fit : ladder.fits) {
    members.models.push_back(written_out(problem, fit.shape, options.component));
  }
  members.chosen = ladder.chosen;
  return members;
}

NamedModel best_rational_model(const FrequencyResponseData& data, const RationalFamily& family,
                               const FitOptions& options) {
  RationalMembers members = rational_members(data, family, options);
  return std::move(members.models.at(members.chosen));
}

}  // namespace frac::detail
