// SPDX-License-Identifier: BSD-3-Clause
#include "interchange.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <optional>
#include <string>
#include <tuple>

#include "formula/canonical_form.hpp"
#include "formula/dimension_analysis.hpp"
#include "formula/expression.hpp"

namespace frac::detail {

namespace {

using Pairs = std::vector<std::pair<std::size_t, std::size_t>>;

/// Pairs up the parameters of two subexpressions of equal shape; false where the shapes differ.
bool match(const std::vector<Node>& nodes, int a, int b, Pairs& pairs) {
  if (a < 0 || b < 0) return a == b;
  const Node& left = nodes[static_cast<std::size_t>(a)];
  const Node& right = nodes[static_cast<std::size_t>(b)];
  if (left.operation != right.operation) return false;
  if (left.operation == Operation::number) return left.number == right.number;
  if (left.operation == Operation::parameter) {
    const std::pair pair(static_cast<std::size_t>(left.parameter), static_cast<std::size_t>(right.parameter));
    if (std::find(pairs.begin(), pairs.end(), pair) == pairs.end()) pairs.push_back(pair);
    return true;
  }
  return match(nodes, left.left, right.left, pairs) && match(nodes, left.right, right.right, pairs);
}

bool holds_a_sum(const std::vector<Node>& nodes, int index) {
  if (index < 0) return false;
  const Node& node = nodes[static_cast<std::size_t>(index)];
  return node.operation == Operation::add || node.operation == Operation::subtract || holds_a_sum(nodes, node.left) ||
         holds_a_sum(nodes, node.right);
}

/// Each parameter stands in one pair only, so that the exchange is its own inverse.
bool is_exchange(const Pairs& pairs) {
  std::vector<std::size_t> used;
  for (const auto& [a, b] : pairs) {
    if (a == b) continue;
    used.push_back(a);
    used.push_back(b);
  }
  std::sort(used.begin(), used.end());
  return !used.empty() && std::adjacent_find(used.begin(), used.end()) == used.end();
}

std::vector<double> exchanged(std::vector<double> parameters, const Pairs& pairs) {
  for (const auto& [a, b] : pairs) std::swap(parameters[a], parameters[b]);
  return parameters;
}

/// Whether the model stays as it is, tried at a few points: two formulas that agree at random points are equal.
bool leaves_the_model(const Structure& structure, const Pairs& pairs) {
  std::vector<double> parameters;
  for (std::size_t i = 0; i < structure.parameter_names().size(); ++i) {
    // Irrational multiples, so that no two parameters are alike; small, so that nothing overflows.
    const double share = std::fmod(static_cast<double>(i + 1) * 0.6180339887498949, 1.0);
    parameters.push_back(0.2 + share);
  }
  const std::vector<double> other = exchanged(parameters, pairs);
  for (const double omega : {0.37, 1.9, 5.3}) {
    const std::complex<double> a = structure.response(parameters, omega), b = structure.response(other, omega);
    if (!(std::abs(a - b) <= 1e-12 * std::abs(a))) return false;
  }
  return true;
}

ParameterConstraint of_parameter(std::span<const ParameterConstraint> constraints, const std::string& name) {
  for (const ParameterConstraint& constraint : constraints) {
    if (constraint.name == name) return constraint;
  }
  return {};
}

/// Whether nothing but limits tells two parameters apart.
bool alike(std::span<const ParameterConstraint> constraints, const std::string& a, const std::string& b) {
  const ParameterConstraint left = of_parameter(constraints, a), right = of_parameter(constraints, b);
  const auto in_an_order = [&](const std::string& name) {
    return std::any_of(constraints.begin(), constraints.end(), [&](const ParameterConstraint& each) {
      return !each.above.empty() && (each.name == name || each.above == name);
    });
  };
  const auto prior = [](const ParameterConstraint& each) {
    return each.prior ? std::optional(std::tuple(each.prior->value, each.prior->deviation, each.prior->relative))
                      : std::nullopt;
  };
  return left.fixed == right.fixed && left.start == right.start && prior(left) == prior(right) && !in_an_order(a) &&
         !in_an_order(b);
}

/// Whether each of a pair may have the value of the other.
bool within_limits(std::span<const ParameterConstraint> constraints, const std::vector<std::string>& names,
                   const Pairs& pairs, const std::vector<double>& parameters) {
  const auto allows = [&](std::size_t i, double value) {
    const ParameterConstraint constraint = of_parameter(constraints, names[i]);
    return !(constraint.lower && value < *constraint.lower) && !(constraint.upper && value > *constraint.upper);
  };
  return std::all_of(pairs.begin(), pairs.end(), [&](const auto& pair) {
    return allows(pair.first, parameters[pair.second]) && allows(pair.second, parameters[pair.first]);
  });
}

/// ln of the product of powers of the coefficients that is a time, if there is one.
std::optional<double> log_time_constant(const std::vector<std::size_t>& part, const std::vector<double>& parameters,
                                        const std::vector<ParameterDimension>& dimensions) {
  // Least powers x with sum x v = 0 and sum x f = -1, by the two normal equations: x = a v + b f.
  double vv = 0, vf = 0, ff = 0;
  for (const std::size_t i : part) {
    vv += dimensions[i].value_exponent * dimensions[i].value_exponent;
    vf += dimensions[i].value_exponent * dimensions[i].frequency_exponent;
    ff += dimensions[i].frequency_exponent * dimensions[i].frequency_exponent;
  }
  const double determinant = vv * ff - vf * vf;
  double a = 0, b = 0;
  if (vv <= 1e-12) {
    if (ff <= 1e-12) return std::nullopt;
    b = -1 / ff;
  } else {
    if (determinant <= 1e-9 * vv * ff || ff <= 1e-12) return std::nullopt;
    a = vf / determinant;
    b = -vv / determinant;
  }
  double sum = 0;
  for (const std::size_t i : part) {
    const double power = a * dimensions[i].value_exponent + b * dimensions[i].frequency_exponent;
    if (std::abs(power) > 1e-12) sum += power * std::log(std::abs(parameters[i]));
  }
  return std::isnan(sum) ? std::nullopt : std::optional(sum);
}

/// The key that a part is sorted by.
double sort_key(const Structure& structure, const std::vector<std::size_t>& part, bool single_power,
                const std::vector<double>& parameters, const std::vector<ParameterDimension>& dimensions) {
  std::vector<std::size_t> coefficients;
  std::optional<double> order;
  for (const std::size_t i : part) {
    if (structure.parameter_roles()[i] == ParameterRole::coefficient) coefficients.push_back(i);
    if (structure.parameter_roles()[i] == ParameterRole::order && !order) order = parameters[i];
  }
  if (order && single_power) return *order;
  if (const auto time = log_time_constant(coefficients, parameters, dimensions)) return *time;
  return order ? *order : parameters[part.front()];
}

}  // namespace

std::vector<Interchange> interchanges(const Structure& structure) {
  const std::vector<Node>& nodes = structure.expression().nodes;
  const auto& names = structure.parameter_names();
  std::vector<Interchange> result;
  const int count = static_cast<int>(nodes.size());
  for (int b = count; b-- > 0;) {
    if (!nodes[static_cast<std::size_t>(b)].has_s || !nodes[static_cast<std::size_t>(b)].has_parameter) continue;
    for (int a = 0; a < b; ++a) {
      Pairs pairs;
      if (!match(nodes, a, b, pairs) || !is_exchange(pairs)) continue;
      std::erase_if(pairs, [](const auto& pair) { return pair.first == pair.second; });
      if (named_before(names[pairs.front().second], names[pairs.front().first])) {
        for (auto& [first, second] : pairs) std::swap(first, second);
      }
      const bool known =
          std::any_of(result.begin(), result.end(), [&](const auto& each) { return each.pairs == pairs; });
      if (known || !leaves_the_model(structure, pairs)) continue;
      // The largest parts that pair these parameters come first.
      result.push_back({std::move(pairs), !holds_a_sum(nodes, b)});
    }
  }
  return result;
}

std::vector<double> with_labels_in_order(const Structure& structure, std::span<const ParameterConstraint> constraints,
                                         std::vector<double> parameters) {
  std::vector<Interchange> allowed = interchanges(structure);
  const auto& names = structure.parameter_names();
  std::erase_if(allowed, [&](const Interchange& parts) {
    return !std::all_of(parts.pairs.begin(), parts.pairs.end(),
                        [&](const auto& pair) { return alike(constraints, names[pair.first], names[pair.second]); });
  });
  if (allowed.empty()) return parameters;
  // Exchanges until none is out of order; each lowers the number of pairs out of order, so there are at most as many
  // passes as exchanges.
  for (std::size_t pass = 0; pass <= allowed.size(); ++pass) {
    bool changed = false;
    for (const auto& [pairs, single_powers] : allowed) {
      std::vector<std::size_t> first, second;
      for (const auto& [a, b] : pairs) {
        first.push_back(a);
        second.push_back(b);
      }
      const auto dimensions = parameter_dimensions(structure, parameters);
      const double key_first = sort_key(structure, first, single_powers, parameters, dimensions);
      const double key_second = sort_key(structure, second, single_powers, parameters, dimensions);
      if (!(key_first > key_second) || !within_limits(constraints, names, pairs, parameters)) continue;
      parameters = exchanged(std::move(parameters), pairs);
      changed = true;
    }
    if (!changed) break;
  }
  return parameters;
}

}  // namespace frac::detail
