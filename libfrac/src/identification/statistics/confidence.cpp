// SPDX-License-Identifier: BSD-3-Clause
#include "confidence.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "base/linear_algebra.hpp"
#include "frac/identification/statistics.hpp"
#include "identification/search/reduced_jacobian.hpp"
#include "identification/search/robust.hpp"

namespace frac::detail {

namespace {

// Share of a parameter in a flat direction (a unit vector) from which on it counts as part of it.
constexpr double flat_share = 0.1;
// A column this much smaller than the largest is rounding: the residuals do not see the parameter.
constexpr double unseen_column = 1e-10;

/// Variance of one unit-weight residual, for a robust loss Huber's (1981, sect. 7.6) estimate sum psi^2/(n - k)/
/// mean(psi')^2, and the same with the first power of mean(psi').
struct Spread {
  double variance, loss_unit;
};
Spread spread_of(const std::vector<double>& residual, double degrees_of_freedom, const LocalOptions& options) {
  double sum = 0, slope = 0;
  for (const double r : residual) {
    const LossAt loss = loss_at(options.loss, r / options.loss_scale);
    sum += loss.psi * loss.psi * options.loss_scale * options.loss_scale;
    slope += loss.slope;
  }
  slope /= static_cast<double>(residual.size());
  return {sum / degrees_of_freedom / (slope * slope), sum / degrees_of_freedom / slope};
}

/// The noise as its residuals tell it; under a loss they count as much as they pull.
CorrelatedNoise noise_of(const Residuals& residuals, std::vector<double> residual, const Eigen::MatrixXd& fitted,
                         const LocalOptions& options) {
  if (options.loss != Loss::none) {
    for (double& each : residual) each = options.loss_scale * loss_at(options.loss, each / options.loss_scale).psi;
  }
  const Eigen::MatrixXd eliminated = residuals.eliminated_columns();
  Eigen::MatrixXd columns(fitted.rows(), fitted.cols() + eliminated.cols());
  columns << fitted, eliminated;
  return {residual, columns, residuals.per_point()};
}

/// Derivatives of the priors by theta, in units of residuals; no rows where there are none.
Eigen::MatrixXd prior_rows(const Residuals& residuals, const std::vector<double>& theta) {
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const auto count = static_cast<Eigen::Index>(residuals.priors() ? residuals.priors()->entries().size() : 0);
  RowMajor rows(count, static_cast<Eigen::Index>(theta.size()));
  std::vector<double> distance(static_cast<std::size_t>(count));
  if (count > 0) residuals.priors()->evaluate(residuals.map(), theta, distance.data(), rows.data());
  return residuals.prior_weight() * rows;
}

}  // namespace

Confidence confidence(const Residuals& residuals, const LocalSolution& solution, const LocalOptions& options) {
  const auto& free = residuals.map().free();
  const std::size_t parameters = residuals.map().parameter_count();
  const auto columns = static_cast<Eigen::Index>(free.size());
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  Confidence result{std::vector<double>(parameters, nan),
                    std::vector<double>(parameters, nan),
                    std::vector<std::vector<double>>(parameters, std::vector<double>(parameters, nan)),
                    std::vector<bool>(parameters, false),
                    std::vector<bool>(parameters, true),
                    std::vector<bool>(parameters, true),
                    0,
                    1,
                    nan,
                    nan,
                    nan,
                    {},
                    std::vector<double>(parameters, 1.0),
                    {}};
  for (std::size_t i = 0; i < parameters; ++i) {
    if (!residuals.map().is_fixed(i)) continue;
    for (std::size_t j = 0; j < parameters; ++j) result.covariance[i][j] = result.covariance[j][i] = 0;
  }

  std::vector<double> residual;
  std::optional<Eigen::MatrixXd> jacobian = reduced_jacobian(residuals, solution.theta, residual);
  if (!jacobian) {
    std::fill(result.identified.begin(), result.identified.end(), false);
    result.condition = std::numeric_limits<double>::infinity();
    return result;
  }

  // The cost weighs priors by the unit of the loss; squares of residuals weigh by their variance.
  const Spread one = spread_of(residual, 1, options);
  const Eigen::MatrixXd priors = std::sqrt(one.variance / one.loss_unit) * prior_rows(residuals, solution.theta);
  jacobian->conservativeResize(jacobian->rows() + priors.rows(), Eigen::NoChange);
  jacobian->bottomRows(priors.rows()) = priors;

  const auto measure_spread = [&] {
    const double degrees =
        static_cast<double>(residual.size()) - result.effective() - static_cast<double>(residuals.eliminated());
    result.t = student_t_95(degrees);
    if (!(degrees > 0)) return;
    const Spread spread = spread_of(residual, degrees, options);
    result.deviation = std::sqrt(spread.variance);
    result.loss_unit = spread.loss_unit;
  };
  if (free.empty()) {
    measure_spread();
    return result;
  }

  const Eigen::VectorXd norm = jacobian->colwise().norm();
  std::vector<Eigen::Index> inner;  // seen and not at a bound
  for (Eigen::Index k = 0; k < columns; ++k) {
    const auto index = static_cast<std::size_t>(k);
    const double margin = 1e-6 * std::min(1.0, free[index].upper - free[index].lower);
    const double theta = solution.theta[index];
    const std::size_t parameter = free[index].parameter;
    result.at_bound[parameter] = theta - free[index].lower <= margin || free[index].upper - theta <= margin;
    // A logarithm at its bound has a vanishing column too, but because the data have driven it there.
    result.seen[parameter] = result.at_bound[parameter] || norm[k] > unseen_column * norm.maxCoeff();
    if (!result.seen[parameter]) {
      result.identified[parameter] = false;
    } else if (result.at_bound[parameter]) {
      ++result.rank;
    } else {
      inner.push_back(k);
    }
  }
  if (inner.empty()) {
    measure_spread();
    return result;
  }

  const auto width = static_cast<Eigen::Index>(inner.size());
  Eigen::MatrixXd scaled(jacobian->rows(), width);
  for (Eigen::Index k = 0; k < width; ++k) {
    const Eigen::Index column = inner[static_cast<std::size_t>(k)];
    scaled.col(k) = jacobian->col(column) / norm[column];
  }
  const auto [sigma, directions] = right_singular_vectors(scaled);
  for (Eigen::Index k = 0; k < width; ++k) result.rank += sigma[k] > unseen_column * sigma[0] ? 1 : 0;
  const Eigen::VectorXd inverse_sigma =
      sigma.cwiseMax(std::numeric_limits<double>::epsilon() * sigma[0]).cwiseInverse();
  const Eigen::VectorXd of_priors =
      (scaled.bottomRows(priors.rows()) * directions * inverse_sigma.asDiagonal()).colwise().squaredNorm().transpose();
  result.from_priors = of_priors.sum();
  // A direction that priors hold is not flat.
  const auto is_held = [&](Eigen::Index direction) { return of_priors[direction] > 0.5; };
  for (Eigen::Index k = 0; k < width; ++k) {
    if (!is_held(k)) result.condition = std::pow(sigma[0] * inverse_sigma[k], 2);
  }

  measure_spread();
  const double deviation = result.deviation;

  const std::vector<double> values = residuals.map().to_user(solution.theta);
  const Eigen::MatrixXd to_user = residuals.map().jacobian(values);
  // Rows: parameters; columns: singular directions of unit residual change.
  Eigen::MatrixXd inner_to_user(to_user.rows(), width);
  for (Eigen::Index k = 0; k < width; ++k) {
    const Eigen::Index column = inner[static_cast<std::size_t>(k)];
    inner_to_user.col(k) = to_user.col(column) / norm[column];
  }
  const Eigen::MatrixXd spread = inner_to_user * directions * inverse_sigma.asDiagonal();

  for (Eigen::Index k = 0; k < width; ++k) {
    const std::size_t parameter = free[static_cast<std::size_t>(inner[static_cast<std::size_t>(k)])].parameter;
    const double error = deviation * spread.row(static_cast<Eigen::Index>(parameter)).stableNorm();
    bool in_flat_direction = false;
    for (Eigen::Index direction = 0; direction < width; ++direction) {
      const bool flat =
          sigma[direction] * sigma[direction] * flat_condition < sigma[0] * sigma[0] && !is_held(direction);
      in_flat_direction = in_flat_direction || (flat && std::abs(directions(k, direction)) > flat_share);
    }
    result.identified[parameter] = !in_flat_direction;
    result.standard_error[parameter] = error;
    // theta is the parameter at the middle of the band, as a logarithm or in its natural unit.
    const double theta_error =
        deviation * (directions.row(k) * inverse_sigma.asDiagonal()).norm() / norm[inner[static_cast<std::size_t>(k)]];
    result.centre_standard_error[parameter] =
        theta_error *
        residuals.map().centre_value_by_theta(static_cast<std::size_t>(inner[static_cast<std::size_t>(k)]), values);
    if (free[static_cast<std::size_t>(inner[static_cast<std::size_t>(k)])].above) {
      Eigen::RowVectorXd centre = Eigen::RowVectorXd::Zero(columns);
      for (const auto& entry :
           residuals.map().centre_entries(static_cast<std::size_t>(inner[static_cast<std::size_t>(k)]), values))
        centre[static_cast<Eigen::Index>(entry.free)] += entry.derivative;
      Eigen::RowVectorXd by_inner(width);
      for (Eigen::Index j = 0; j < width; ++j)
        by_inner[j] = centre[inner[static_cast<std::size_t>(j)]] / norm[inner[static_cast<std::size_t>(j)]];
      result.centre_standard_error[parameter] = deviation * (by_inner * directions * inverse_sigma.asDiagonal()).norm();
    }
    for (Eigen::Index other = 0; other < width; ++other) {
      const std::size_t j = free[static_cast<std::size_t>(inner[static_cast<std::size_t>(other)])].parameter;
      result.covariance[parameter][j] =
          deviation * deviation *
          spread.row(static_cast<Eigen::Index>(parameter)).dot(spread.row(static_cast<Eigen::Index>(j)));
    }
  }

  Eigen::MatrixXd full(static_cast<Eigen::Index>(residual.size()), columns);
  residuals.evaluate(solution.theta, residual.data(), full.data());
  Eigen::MatrixXd fitted(full.rows(), width);
  for (Eigen::Index k = 0; k < width; ++k) {
    const Eigen::Index column = inner[static_cast<std::size_t>(k)];
    fitted.col(k) = full.col(column) / norm[column];
  }
  result.noise = noise_of(residuals, residual, fitted, options);
  result.influence = fitted * (directions * inverse_sigma.asDiagonal() * spread.transpose());
  for (const Eigen::Index column : inner) {
    const std::size_t i = free[static_cast<std::size_t>(column)].parameter;
    result.widening[i] = result.noise.widening(result.influence.col(static_cast<Eigen::Index>(i)));
    if (priors.rows() > 0) {
      // What a prior tells of the parameter has nothing to do with the noise of the residuals.
      const double of_residuals =
          deviation * result.influence.col(static_cast<Eigen::Index>(i)).norm() / result.standard_error[i];
      result.widening[i] = std::sqrt(1 + (result.widening[i] * result.widening[i] - 1) * of_residuals * of_residuals);
    }
    const bool wide = !(result.t * result.widening[i] * result.standard_error[i] <= 0.5 * std::abs(values[i]));
    if (wide && !std::isnan(result.standard_error[i])) result.identified[i] = false;
  }
  return result;
}

}  // namespace frac::detail
