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

  [[nodiscard]] Eigen::MatrixXd solve(Eigen::Index unknowns) const {
    const auto rows = static_cast<Eigen::Index>(factors_.size());
    Eigen::MatrixXd matrix(rows, unknowns);
    Eigen::MatrixXd right(rows, 2);
    for (Eigen::Index i = 0; i < rows; ++i) {
      matrix.row(i) = factors_[static_cast<std::size_t>(i)];
      right.row(i) = right_[static_cast<std::size_t>(i)];
    }
    return detail::shortest_solution(matrix, right);
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
    case Operation::exp:
    case Operation::tanh:
    case Operation::coth:
    case Operation::sinh:
    case Operation::cosh:
    case Operation::sech:
    case Operation::log:
      conditions.require_dimensionless(of(node.left));
      break;
  }
  return plain;
}

}  // namespace

std::vector<ParameterDimension> parameter_dimensions(const Structure& structure, std::span<const double> parameters) {
  const Expression& expression = structure.expression();
  const auto unknowns = static_cast<Eigen::Index>(parameters.size());
  if (unknowns == 0) return {};
  std::vector<double> real_values;
  evaluate_real_nodes(expression, parameters.data(), real_values);

  Conditions conditions;
  std::vector<Dimension> dimensions;
  for (const Node& node : expression.nodes)
    dimensions.push_back(dimension_of(node, structure, real_values, dimensions, conditions));
  conditions.require_value(dimensions.back());

  const Eigen::MatrixXd solution = conditions.solve(unknowns);
  std::vector<ParameterDimension> result;
  for (Eigen::Index i = 0; i < unknowns; ++i) result.push_back({solution(i, 0), solution(i, 1)});
  return result;
}

}  // namespace frac::detail
