// SPDX-License-Identifier: BSD-3-Clause
#include "confidence.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "base/linear_algebra.hpp"
#include "frac/identification/statistics.hpp"
#include "identification/residuals/loss.hpp"
#include "identification/search/linearisation.hpp"
#include "prior_weight.hpp"

namespace frac::detail {

namespace {

// Share of a parameter in a flat direction (a unit vector) from which on it counts as part of it.
constexpr double flat_share = 0.1;

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
/// @param basis  of the space of what was fitted
CorrelatedNoise noise_of(const Residuals& residuals, std::span<const double> theta, std::vector<double> residual,
                         const Eigen::Ref<const Eigen::MatrixXd>& basis, const LocalOptions& options) {
  if (options.loss != Loss::none) {
    for (double& each : residual) each = options.loss_scale * loss_at(options.loss, each / options.loss_scale).psi;
  }
  return {residual, basis, residuals.axis(theta)};
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

/// What is known before the residuals are looked at: fixed parameters, and nothing else.
Confidence nothing_known(const ParameterMap& map) {
  const std::size_t parameters = map.parameter_count();
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
                    {},
                    {}};
  for (std::size_t i = 0; i < parameters; ++i) {
    if (!map.is_fixed(i)) continue;
    for (std::size_t j = 0; j < parameters; ++j) result.covariance[i][j] = result.covariance[j][i] = 0;
  }
  return result;
}

/// The largest change of the residuals by an e-fold or by the unit of a variable, whichever is less: of a gain that is
/// nearly 0 the derivative alone, which grows as the rest of a factor does, tells nothing of the others.
double largest_change(const ParameterMap& map, const std::vector<double>& theta, const Eigen::VectorXd& norm) {
  double largest = 0;
  for (Eigen::Index k = 0; k < norm.size(); ++k) {
    const auto index = static_cast<std::size_t>(k);
    const double step = map.free()[index].either_sign ? std::min(1.0, std::abs(theta[index])) : 1;
    largest = std::max(largest, step * norm[k]);
  }
  return largest;
}

/// The columns of those variables that are seen and not at a bound; notes the others in `result`.
std::vector<Eigen::Index> inner_columns(const ParameterMap& map, const std::vector<double>& theta,
                                        const Eigen::VectorXd& norm, Confidence& result) {
  std::vector<Eigen::Index> inner;
  const double largest = largest_change(map, theta, norm);
  for (Eigen::Index k = 0; k < norm.size(); ++k) {
    const auto index = static_cast<std::size_t>(k);
    const ParameterMap::Free& free = map.free()[index];
    const bool at_bound = is_at_bound(theta[index], free.lower, free.upper);
    result.at_bound[free.parameter] = at_bound;
    // A logarithm at its bound has a vanishing column too, but because the data have driven it there.
    result.seen[free.parameter] = at_bound || norm[k] > unseen_column * largest;
    if (!result.seen[free.parameter]) {
      result.identified[free.parameter] = false;
    } else if (at_bound) {
      ++result.rank;
    } else {
      inner.push_back(k);
    }
  }
  return inner;
}

/// The inner columns of the Jacobian, each of length one, and the directions in which they tell the variables apart.
struct InnerDirections {
  std::vector<Eigen::Index> column;    // of each inner variable, among all that are free
  std::vector<std::size_t> parameter;  // of each inner variable
  Eigen::VectorXd norm;                // of each column before it was scaled
  Eigen::VectorXd sigma, inverse_sigma;
  Eigen::MatrixXd vectors;    // a direction per column
  Eigen::VectorXd of_priors;  // share of what is known along a direction that priors tell

  /// @param jacobian  of the residuals, and in its last rows of the priors
  InnerDirections(const ParameterMap& map, std::vector<Eigen::Index> inner, const Eigen::VectorXd& norms,
                  const Eigen::MatrixXd& jacobian, Eigen::Index priors)
      : column(std::move(inner)), norm(norms(column)) {
    for (const Eigen::Index k : column) parameter.push_back(map.free()[static_cast<std::size_t>(k)].parameter);
    const Eigen::MatrixXd unit = scaled(jacobian);
    RightSingularVectors right = right_singular_vectors(unit);
    sigma = std::move(right.values);
    vectors = std::move(right.vectors);
    // A variable has no share in a direction that nothing tells but for rounding, which 1/sigma would make large.
    for (auto k = static_cast<Eigen::Index>(rank()); k < count(); ++k)
      for (double& share : vectors.col(k))
        if (std::abs(share) < unseen_column) share = 0;
    inverse_sigma = sigma.cwiseMax(std::numeric_limits<double>::epsilon() * sigma[0]).cwiseInverse();
    of_priors = (unit.bottomRows(priors) * vectors * inverse_sigma.asDiagonal()).colwise().squaredNorm().transpose();
  }

  [[nodiscard]] Eigen::Index count() const { return norm.size(); }

  /// The inner columns of a matrix that has one for each free variable, by the norms of those of the Jacobian.
  [[nodiscard]] Eigen::MatrixXd scaled(const Eigen::MatrixXd& matrix) const {
    Eigen::MatrixXd columns(matrix.rows(), count());
    for (Eigen::Index k = 0; k < count(); ++k)
      columns.col(k) = matrix.col(column[static_cast<std::size_t>(k)]) / norm[k];
    return columns;
  }

  /// Directions that more than rounding tells; they are the first.
  [[nodiscard]] std::size_t rank() const {
    return static_cast<std::size_t>((sigma.array() > unseen_column * sigma[0]).count());
  }
  /// Whether priors hold a direction: such a one is not flat, however little the residuals tell of it.
  [[nodiscard]] bool is_held(Eigen::Index direction) const { return of_priors[direction] > 0.5; }

  /// Whether a variable has a share in a direction along which estimates are noise.
  [[nodiscard]] bool lies_in_flat_direction(Eigen::Index k) const {
    for (Eigen::Index direction = 0; direction < count(); ++direction) {
      const bool flat = sigma[direction] * sigma[direction] * flat_condition < sigma[0] * sigma[0];
      if (flat && !is_held(direction) && std::abs(vectors(k, direction)) > flat_share) return true;
    }
    return false;
  }
};

void measure_rank(const InnerDirections& inner, Confidence& result) {
  result.from_priors = inner.of_priors.sum();
  result.rank += inner.rank();
  for (Eigen::Index k = 0; k < inner.count(); ++k) {
    if (!inner.is_held(k)) result.condition = std::pow(inner.sigma[0] * inner.inverse_sigma[k], 2);
  }
}

/// How far the residuals scatter, given how many parameters they were spent on.
void measure_spread(const Residuals& residuals, const std::vector<double>& residual, const LocalOptions& options,
                    Confidence& result) {
  const double degrees =
      static_cast<double>(residual.size()) - result.effective() - static_cast<double>(residuals.eliminated());
  result.t = student_t_95(degrees);
  if (!(degrees > 0)) return;
  const Spread spread = spread_of(residual, degrees, options);
  result.deviation = std::sqrt(spread.variance);
  result.loss_unit = spread.loss_unit;
}

/// Standard error of a parameter with frequency in units of the middle of the band: theta is that parameter, as a
/// logarithm or in its natural unit.
double centre_error(const ParameterMap& map, const std::vector<double>& values, const InnerDirections& inner,
                    Eigen::Index k, double deviation) {
  const auto place = static_cast<std::size_t>(inner.column[static_cast<std::size_t>(k)]);
  if (!map.free()[place].above) {
    const double theta_error =
        deviation * (inner.vectors.row(k) * inner.inverse_sigma.asDiagonal()).norm() / inner.norm[k];
    return theta_error * map.centre_value_by_theta(place, values);
  }
  Eigen::RowVectorXd centre = Eigen::RowVectorXd::Zero(static_cast<Eigen::Index>(map.free().size()));
  for (const auto& entry : map.centre_entries(place, values))
    centre[static_cast<Eigen::Index>(entry.free)] += entry.derivative;
  const Eigen::RowVectorXd by_inner = inner.scaled(centre);
  return deviation * (by_inner * inner.vectors * inner.inverse_sigma.asDiagonal()).norm();
}

/// Errors in white noise.  @param spread  rows: parameters; columns: directions of unit residual change
void set_errors(const ParameterMap& map, const std::vector<double>& values, const InnerDirections& inner,
                const Eigen::MatrixXd& spread, Confidence& result) {
  const double deviation = result.deviation;
  for (Eigen::Index k = 0; k < inner.count(); ++k) {
    const std::size_t parameter = inner.parameter[static_cast<std::size_t>(k)];
    const auto row = spread.row(static_cast<Eigen::Index>(parameter));
    result.identified[parameter] = !inner.lies_in_flat_direction(k);
    result.standard_error[parameter] = deviation * row.stableNorm();
    result.centre_standard_error[parameter] = centre_error(map, values, inner, k, deviation);
  }
}

/// By how much the correlation of neighbouring residuals widens errors, and the covariance in it.
void allow_for_correlation(const InnerDirections& inner, Confidence& result) {
  const Eigen::MatrixXd& directions = result.directions;
  // Of unit variance along each in white noise, also where priors tell a part of it: those have nothing to do with the
  // noise of the residuals.
  const Eigen::MatrixXd along = Eigen::MatrixXd::Identity(directions.cols(), directions.cols()) +
                                result.noise.covariance(directions) - directions.transpose() * directions;
  for (const std::size_t i : inner.parameter) {
    const Eigen::RowVectorXd row = result.spread.row(static_cast<Eigen::Index>(i));
    const double size = row.stableNorm();
    if (size > 0 && std::isfinite(size)) result.widening[i] = std::sqrt((row / size * along).dot(row / size));
    const Eigen::RowVectorXd carried = result.deviation * row * along;
    for (const std::size_t k : inner.parameter)
      result.covariance[i][k] = result.covariance[k][i] =
          carried.dot(result.deviation * result.spread.row(static_cast<Eigen::Index>(k)));
  }
}

}  // namespace

bool is_at_bound(double value, double lower, double upper) {
  const double margin = 1e-6 * std::min(1.0, upper - lower);
  return value - lower <= margin || upper - value <= margin;
}

Confidence confidence(const Residuals& residuals, const LocalSolution& solution, const LocalOptions& options) {
  const ParameterMap& map = residuals.map();
  Confidence result = nothing_known(map);

  std::optional<Linearisation> at_best = linearised(residuals, solution.theta);
  if (!at_best) {
    std::fill(result.identified.begin(), result.identified.end(), false);
    result.condition = std::numeric_limits<double>::infinity();
    return result;
  }
  const std::vector<double>& residual = at_best->residual;
  Eigen::MatrixXd jacobian = at_best->reduced();
  // The cost weighs priors by the unit of the loss; squares of residuals weigh by their variance.
  const Spread one = spread_of(residual, 1, options);
  const Eigen::MatrixXd priors = std::sqrt(one.variance / one.loss_unit) * prior_rows(residuals, solution.theta);
  jacobian.conservativeResize(jacobian.rows() + priors.rows(), Eigen::NoChange);
  jacobian.bottomRows(priors.rows()) = priors;

  const Eigen::VectorXd norm = jacobian.colwise().norm();
  std::vector<Eigen::Index> columns = inner_columns(map, solution.theta, norm, result);
  if (columns.empty()) {
    measure_spread(residuals, residual, options, result);
    return result;
  }
  const InnerDirections inner(map, std::move(columns), norm, jacobian, priors.rows());
  measure_rank(inner, result);
  measure_spread(residuals, residual, options, result);

  const std::vector<double> values = map.to_user(solution.theta);
  result.spread = inner.scaled(map.jacobian(values)) * inner.vectors * inner.inverse_sigma.asDiagonal();
  set_errors(map, values, inner, result.spread, result);

  result.directions = inner.scaled(at_best->jacobian) * (inner.vectors * inner.inverse_sigma.asDiagonal()).eval();
  at_best->jacobian.resize(0, 0);
  const auto rank = static_cast<Eigen::Index>(inner.rank());
  result.directions.rightCols(inner.count() - rank).setZero();
  const auto fitted = result.directions.leftCols(rank);
  if (priors.rows() == 0 && residuals.eliminated() == 0) {
    result.noise = noise_of(residuals, solution.theta, residual, fitted, options);
  } else {
    Eigen::MatrixXd columns(fitted.rows(), fitted.cols() + static_cast<Eigen::Index>(residuals.eliminated()));
    columns << fitted, residuals.eliminated_columns();
    result.noise = noise_of(residuals, solution.theta, residual, PivotedQr(columns).basis(), options);
  }
  allow_for_correlation(inner, result);
  for (const std::size_t i : inner.parameter) {
    const bool wide = !(result.t * result.widening[i] * result.standard_error[i] <= 0.5 * std::abs(values[i]));
    if (wide && !std::isnan(result.standard_error[i])) result.identified[i] = false;
  }
  return result;
}

Confidence weighed_confidence(Problem& problem, LocalSolution& solution, const LocalOptions& options) {
  Residuals& residuals = problem.residuals();
  Confidence found = confidence(residuals, solution, options);
  if (problem.priors.empty()) return found;
  return weighed_by_noise(std::move(found), residuals.prior_weight(), [&](double noise) {
    residuals.set_priors(problem.priors, noise);
    solution = local_solve(residuals, solution.theta, options);
    return confidence(residuals, solution, options);
  });
}

}  // namespace frac::detail
