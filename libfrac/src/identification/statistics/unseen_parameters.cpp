// SPDX-License-Identifier: BSD-3-Clause
#include "identification/statistics/unseen_parameters.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <complex>
#include <span>
#include <vector>

#include "base/linear_algebra.hpp"
#include "frac/identification/statistics.hpp"

namespace frac::detail {
namespace {

Component other_component(Component component) {
  return component == Component::imaginary ? Component::real : Component::imaginary;
}

/// Derivatives of the weighted residuals of the one component that `options` name, by every parameter.
Eigen::MatrixXd gradient_of(const FrequencyResponseData& data, const Structure& structure, const FitOptions& options,
                            const std::vector<double>& parameters) {
  const ResidualRule rule = residual_rule(data, options);
  std::vector<std::complex<double>> value(data.size()), gradient(data.size() * parameters.size());
  structure.response_and_gradient(parameters, data.omega(), options.realisation, value, gradient);
  Eigen::MatrixXd result(static_cast<Eigen::Index>(data.size()), static_cast<Eigen::Index>(parameters.size()));
  std::vector<double> column(data.size());
  for (std::size_t k = 0; k < parameters.size(); ++k) {
    rule.derivatives(value, std::span(gradient).subspan(k * data.size(), data.size()), column.data());
    result.col(static_cast<Eigen::Index>(k)) = Eigen::Map<const Eigen::VectorXd>(column.data(), result.rows());
  }
  return result;
}

/// Parameters recovered with the others held move with the errors of those: by -(A' A)^-1 A' B times them, A and B the
/// derivatives of the residuals they were recovered from by the recovered and by the others.  The noise of the two
/// components is taken as unrelated.
/// @param moves  which were recovered
/// @param t      half width of their 95 % intervals in standard errors
void carry_errors(FitResult& result, const FitResult& recovered, const std::vector<bool>& moves,
                  const Eigen::MatrixXd& gradient, double t) {
  std::vector<Eigen::Index> inner, outer;
  for (std::size_t i = 0; i < moves.size(); ++i) {
    if (moves[i]) inner.push_back(static_cast<Eigen::Index>(i));
    if (!moves[i] && std::isfinite(result.covariance[i][i])) outer.push_back(static_cast<Eigen::Index>(i));
  }
  if (inner.empty()) return;
  const auto covariance_of = [](const FitResult& of, Eigen::Index i, Eigen::Index j) {
    return of.covariance[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)];
  };
  Eigen::MatrixXd others(static_cast<Eigen::Index>(outer.size()), static_cast<Eigen::Index>(outer.size()));
  for (Eigen::Index i = 0; i < others.rows(); ++i) {
    for (Eigen::Index j = 0; j < others.cols(); ++j) {
      others(i, j) = covariance_of(result, outer[static_cast<std::size_t>(i)], outer[static_cast<std::size_t>(j)]);
    }
  }
  const Eigen::MatrixXd shift = -PivotedQr(chosen_columns(gradient, inner)).solve(chosen_columns(gradient, outer));
  const Eigen::MatrixXd mixed = shift * others;
  const Eigen::MatrixXd carried = mixed * shift.transpose();
  for (Eigen::Index a = 0; a < shift.rows(); ++a) {
    const auto i = static_cast<std::size_t>(inner[static_cast<std::size_t>(a)]);
    for (Eigen::Index b = 0; b < shift.rows(); ++b) {
      const auto j = static_cast<std::size_t>(inner[static_cast<std::size_t>(b)]);
      result.covariance[i][j] =
          covariance_of(recovered, inner[static_cast<std::size_t>(a)], inner[static_cast<std::size_t>(b)]) +
          carried(a, b);
    }
    for (Eigen::Index b = 0; b < mixed.cols(); ++b) {
      const auto j = static_cast<std::size_t>(outer[static_cast<std::size_t>(b)]);
      result.covariance[i][j] = result.covariance[j][i] = mixed(a, b);
    }
    ParameterEstimate& estimate = result.parameters[i];
    const double grown = std::sqrt(result.covariance[i][i]) / estimate.standard_error;
    estimate.standard_error *= grown;
    estimate.centre_standard_error *= grown;
    if (estimate.interval == IntervalKind::profile) {
      estimate.ci95_lower = estimate.value - grown * (estimate.value - estimate.ci95_lower);
      estimate.ci95_upper = estimate.value + grown * (estimate.ci95_upper - estimate.value);
    } else {
      estimate.ci95_lower = estimate.value - t * estimate.standard_error;
      estimate.ci95_upper = estimate.value + t * estimate.standard_error;
    }
    const double half_width = (estimate.ci95_upper - estimate.ci95_lower) / 2;
    estimate.identified = estimate.identified && half_width <= 0.5 * std::abs(estimate.value);
  }
}

}  // namespace

void recover_unseen(FitResult& result, const Confidence& found, FrequencyProblem& problem, double cost,
                    const std::function<FitResult(const FitOptions&)>& fit_rest) {
  const FitOptions& options = problem.options;
  if (options.component != Component::imaginary && options.component != Component::real) return;
  const bool all_seen = std::find(found.seen.begin(), found.seen.end(), false) == found.seen.end();
  const bool none_seen = std::find(found.seen.begin(), found.seen.end(), true) == found.seen.end();
  if (all_seen || none_seen) return;
  FitOptions rest = options;
  rest.component = other_component(options.component);
  rest.constraints.clear();
  for (std::size_t i = 0; i < result.parameters.size(); ++i) {
    const std::string& name = result.parameters[i].name;
    if (found.seen[i]) {
      rest.constraints.push_back({name, result.parameters[i].value, {}, {}, {}});
      continue;
    }
    for (const ParameterConstraint& constraint : options.constraints) {
      if (constraint.name == name) rest.constraints.push_back(constraint);
    }
  }
  const FitResult recovered = fit_rest(rest);
  std::vector<double> values;
  for (const ParameterEstimate& estimate : recovered.parameters) values.push_back(estimate.value);
  // The fitted component must not notice: blindness at the minimum alone is not enough.
  if (!(problem.residuals().cost(problem.map.to_theta(values)) <=
        cost * (1 + 1e-6) + problem.residuals().rounding_cost()))
    return;
  std::vector<bool> moves(result.parameters.size(), false);
  for (std::size_t i = 0; i < result.parameters.size(); ++i) {
    if (found.seen[i]) continue;
    result.parameters[i] = recovered.parameters[i];
    result.parameters[i].from_other_component = recovered.parameters[i].identified || recovered.parameters[i].at_bound;
    moves[i] = std::isfinite(recovered.parameters[i].standard_error) && !recovered.parameters[i].fixed;
  }
  const double t =
      student_t_95(static_cast<double>(recovered.residuals) - static_cast<double>(recovered.free_parameters));
  carry_errors(result, recovered, moves, gradient_of(problem.data, problem.structure, rest, values), t);
}

}  // namespace frac::detail
