// SPDX-License-Identifier: BSD-3-Clause
#include "dimension_analysis.hpp"

#include <Eigen/Core>
#include <cstddef>

#include "base/linear_algebra.hpp"
#include "expression.hpp"

namespace frac::detail {
namespace {

// Exponents of [value] and [omega] are affine in those of the parameters, with the same factors for both.
struct Dimension {
  Eigen::VectorXd factors;  // of the exponents of the parameters
  double frequency = 0;     // constant part of the exponent of [omega]; that of [value] is 0
  double terms = 1;         // of the sum that this node is
};

// Collects conditions factors . exponents = right-hand side, one column for [value] and one for [omega].
class Conditions {
 public:
  void require_dimensionless(const Dimension& dimension) { add(dimension.factors, 0, -dimension.frequency); }
  void require_equal(const Dimension& a, const Dimension& b) {
    add(a.factors - b.factors, 0, b.frequency - a.frequency);
  }
  void require_value(const Dimension& dimension) { add(dimension.factors, 1, -dimension.frequency); }

  struct Equations {
    Eigen::MatrixXd matrix, right;
  };
  [[nodiscard]] Equations equations(Eigen::Index unknowns) const {
    const auto rows = static_cast<Eigen::Index>(factors_.size());
    Equations all{Eigen::MatrixXd(rows, unknowns), Eigen::MatrixXd(rows, 2)};
    for (Eigen::Index i = 0; i < rows; ++i) {
      all.matrix.row(i) = factors_[static_cast<std::size_t>(i)];
      all.right.row(i) = right_[static_cast<std::size_t>(i)];
    }
    return all;
  }

 private:
  void add(const Eigen::VectorXd& factors, double value, double frequency) {
    factors_.emplace_back(factors.transpose());
    right_.emplace_back(value, frequency);
  }

  std::vector<Eigen::RowVectorXd> factors_;
  std::vector<Eigen::RowVector2d> right_;
};

Dimension power_of(const Dimension& base, double exponent) {
  return {exponent * base.factors, exponent * base.frequency};
}

Dimension product(const Dimension& one, const Dimension& other) {
  return {one.factors + other.factors, one.frequency + other.frequency};
}

// A sum has the dimension that its terms have on the mean: where they cannot be equal, each counts alike.
Dimension sum(const Dimension& one, const Dimension& other) {
  const double terms = one.terms + other.terms;
  return {(one.terms * one.factors + other.terms * other.factors) / terms,
          (one.terms * one.frequency + other.terms * other.frequency) / terms, terms};
}

// The dimension of a node from those of the nodes before it, and what it demands of these.
Dimension dimension_of(const Node& node, const Structure& structure, const std::vector<double>& real_values,
                       const std::vector<Dimension>& before, Conditions& conditions) {
  const auto of = [&](int index) -> const Dimension& { return before[static_cast<std::size_t>(index)]; };
  const auto exponent = [&] { return real_values[static_cast<std::size_t>(node.right)]; };
  const auto& roles = structure.parameter_roles();
  Dimension plain{Eigen::VectorXd::Zero(static_cast<Eigen::Index>(roles.size()))};
  switch (node.operation) {
    case Operation::number:
      break;
    case Operation::parameter:
      if (roles[static_cast<std::size_t>(node.parameter)] != ParameterRole::order) plain.factors[node.parameter] = 1;
      break;
    case Operation::laplace:
    case Operation::exact_laplace:
      plain.frequency = 1;
      break;
    case Operation::add:
    case Operation::subtract:
      conditions.require_equal(of(node.left), of(node.right));
      return sum(of(node.left), of(node.right));
    case Operation::multiply:
      return product(of(node.left), of(node.right));
    case Operation::divide:
      return product(of(node.left), power_of(of(node.right), -1));
    case Operation::negate:
      return of(node.left);
    case Operation::power:
      return power_of(of(node.left), exponent());
    case Operation::power_of_s:
      plain.frequency = 1;
      return power_of(product(of(node.left), plain), exponent());
    case Operation::sqrt:
      return power_of(of(node.left), 0.5);
    default:  // a function
      conditions.require_dimensionless(of(node.left));
      break;
  }
  return plain;
}

// Dimensions of all nodes, the whole formula last, and what they demand of each other.
std::vector<Dimension> dimensions_of(const Structure& structure, std::span<const double> parameters,
                                     Conditions& conditions) {
  const Expression& expression = structure.expression();
  std::vector<double> real_values;
  evaluate_real_nodes(expression, parameters.data(), real_values);
  std::vector<Dimension> dimensions;
  for (const Node& node : expression.nodes)
    dimensions.push_back(dimension_of(node, structure, real_values, dimensions, conditions));
  return dimensions;
}

}  // namespace

std::vector<ParameterDimension> parameter_dimensions(const Structure& structure, std::span<const double> parameters) {
  const auto unknowns = static_cast<Eigen::Index>(parameters.size());
  if (unknowns == 0) return {};
  Conditions conditions;
  conditions.require_value(dimensions_of(structure, parameters, conditions).back());
  const auto [matrix, right] = conditions.equations(unknowns);
  const Eigen::MatrixXd solution = shortest_solution(matrix, right);
  std::vector<ParameterDimension> result;
  for (Eigen::Index i = 0; i < unknowns; ++i) result.push_back({solution(i, 0), solution(i, 1)});
  return result;
}

namespace {

// Whether a number multiplies the whole formula, the 1 of 1/(T s + 1) too.
bool has_leading_number(const std::vector<Node>& nodes, int index) {
  const Node& node = nodes[static_cast<std::size_t>(index)];
  switch (node.operation) {
    case Operation::number:
      return true;
    case Operation::negate:
    case Operation::divide:
      return has_leading_number(nodes, node.left);
    case Operation::multiply:
      return has_leading_number(nodes, node.left) || has_leading_number(nodes, node.right);
    default:
      return false;
  }
}

constexpr double no_more_than_rounding = 1e-9;

// What follows from conditions; one column for [value] and one for [omega], of which each may contradict itself.
struct Solved {
  Eigen::MatrixXd exponents;
  Eigen::VectorXd told;  // by parameter: 1 where the conditions tell its exponents, less where they leave a choice
  bool has_value, has_frequency;
};
Solved solved(const Conditions& conditions, Eigen::Index unknowns) {
  const auto [matrix, right] = conditions.equations(unknowns);
  if (matrix.rows() == 0) return {Eigen::MatrixXd::Zero(unknowns, 2), Eigen::VectorXd::Zero(unknowns), true, true};
  const Eigen::MatrixXd exponents = shortest_solution(matrix, right), left = matrix * exponents - right;
  return {exponents, shortest_solution(matrix, matrix).diagonal(),
          left.col(0).cwiseAbs().maxCoeff() < no_more_than_rounding,
          left.col(1).cwiseAbs().maxCoeff() < no_more_than_rounding};
}

}  // namespace

bool scales_with_parameters(const Structure& structure, std::span<const double> parameters) {
  if (parameters.empty()) return false;
  Conditions conditions;
  conditions.require_value(dimensions_of(structure, parameters, conditions).back());
  return solved(conditions, static_cast<Eigen::Index>(parameters.size())).has_value;
}

std::vector<KnownDimension> known_dimensions(const Structure& structure, std::span<const double> parameters) {
  const auto unknowns = static_cast<Eigen::Index>(parameters.size());
  if (unknowns == 0) return {};
  Conditions within;
  const Dimension whole = dimensions_of(structure, parameters, within).back();
  Conditions all = within;
  all.require_value(whole);
  Solved found = solved(all, unknowns);
  const std::vector<Node>& nodes = structure.expression().nodes;
  if (!found.has_value && has_leading_number(nodes, static_cast<int>(nodes.size()) - 1))
    found = solved(within, unknowns);
  std::vector<KnownDimension> result(parameters.size());
  for (Eigen::Index i = 0; i < unknowns; ++i) {
    if (!(found.told(i) > 1 - no_more_than_rounding)) continue;
    KnownDimension& known = result[static_cast<std::size_t>(i)];
    if (found.has_value) known.value_exponent = found.exponents(i, 0);
    if (found.has_frequency) known.frequency_exponent = found.exponents(i, 1);
  }
  return result;
}

}  // namespace frac::detail
