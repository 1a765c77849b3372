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

}  // namespace

std::vector<ParameterDimension> parameter_dimensions(const Structure& structure, std::span<const double> parameters) {
  const Expression& expression = structure.expression();
  const auto unknowns = static_cast<Eigen::Index>(parameters.size());
  if (unknowns == 0) return {};
  std::vector<double> real_values;
  evaluate_real_nodes(expression, parameters.data(), real_values);

  Conditions conditions;
  std::vector<Dimension> dimensions;
  for (const Node& node : expression.nodes) {
    const auto of = [&](int index) -> const Dimension& { return dimensions[static_cast<std::size_t>(index)]; };
    const auto exponent = [&] { return real_values[static_cast<std::size_t>(node.right)]; };
    Dimension result{Eigen::VectorXd::Zero(unknowns)};
    switch (node.operation) {
      case Operation::number:
        break;
      case Operation::parameter:
        if (structure.parameter_roles()[static_cast<std::size_t>(node.parameter)] != ParameterRole::order) {
          result.factors[node.parameter] = 1;
        }
        break;
      case Operation::laplace:
      case Operation::exact_laplace:
        result.frequency = 1;
        break;
      case Operation::add:
      case Operation::subtract: {
        const Dimension& left = of(node.left);
        const Dimension& right = of(node.right);
        conditions.require_equal(left, right);
        result.terms = left.terms + right.terms;
        result.factors = (left.terms * left.factors + right.terms * right.factors) / result.terms;
        result.frequency = (left.terms * left.frequency + right.terms * right.frequency) / result.terms;
        break;
      }
      case Operation::multiply:
        result.factors = of(node.left).factors + of(node.right).factors;
        result.frequency = of(node.left).frequency + of(node.right).frequency;
        break;
      case Operation::divide:
        result.factors = of(node.left).factors - of(node.right).factors;
        result.frequency = of(node.left).frequency - of(node.right).frequency;
        break;
      case Operation::negate:
        result = of(node.left);
        break;
      case Operation::power:
        result.factors = exponent() * of(node.left).factors;
        result.frequency = exponent() * of(node.left).frequency;
        break;
      case Operation::power_of_s:
        result.factors = exponent() * of(node.left).factors;
        result.frequency = exponent() * (of(node.left).frequency + 1);
        break;
      case Operation::sqrt:
        result.factors = of(node.left).factors / 2;
        result.frequency = of(node.left).frequency / 2;
        break;
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
    dimensions.push_back(std::move(result));
  }
  conditions.require_value(dimensions.back());

  const Eigen::MatrixXd solution = conditions.solve(unknowns);
  std::vector<ParameterDimension> result;
  for (Eigen::Index i = 0; i < unknowns; ++i) result.push_back({solution(i, 0), solution(i, 1)});
  return result;
}

}  // namespace frac::detail
