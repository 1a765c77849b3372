// SPDX-License-Identifier: BSD-3-Clause
#include "scene_uncertainty.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

#include "base/linear_algebra.hpp"
#include "base/short_text.hpp"
#include "frac/identification/statistics.hpp"

namespace backlash::detail {
namespace {

using frac::detail::short_text;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
// Condition of the scaled Fisher matrix from which on a direction counts as free.
constexpr double free_condition = 1e6;
// Share of a quantity's gradient along a free direction from which on the quantity is free with it.
constexpr double free_share = 0.01;
// The residuals do not see a parameter whose column is this much shorter than the longest.
constexpr double unseen_column = 1e-10;

Eigen::Map<const Eigen::VectorXd> gradient_of(const Quantity& quantity) {
  return {quantity.gradient.data(), static_cast<Eigen::Index>(quantity.gradient.size())};
}

}  // namespace

SceneUncertainty::SceneUncertainty(const SceneFamily& family, const Coordinates& theta,
                                   const NormalEquations& equations, const ResidualScatter& scatter)
    : family_(family), theta_(theta), equations_(equations), at_bound_(theta.size()), inner_(theta.size()) {
  const SceneBounds& bounds = family.bounds();
  std::size_t limited = 0;
  for (std::size_t k = 0; k < theta.size(); ++k) {
    const double margin = 1e-9 * std::min(1.0, bounds.upper[k] - bounds.lower[k]);
    const bool at_lower = theta[k] <= bounds.lower[k] + margin;
    at_bound_[k] = bounds.is_free(k) && (at_lower || theta[k] >= bounds.upper[k] - margin);
    inner_[k] = bounds.is_free(k) && (!at_bound_[k] || (at_lower && family.is_ideal(k)));
    limited += at_bound_[k] && !inner_[k] ? 1 : 0;
  }
  decompose();
  rank_ += limited;
  const double degrees = static_cast<double>(equations.residuals) - static_cast<double>(rank_);
  const double square = scatter.widening * scatter.widening;
  variance_ = degrees > 0 ? square * std::max(equations.cost / degrees, scatter.least_variance) : nan;
  t_ = frac::student_t_95(degrees);
  jackknife_ = square * jackknife();
}

void SceneUncertainty::decompose() {
  const Eigen::Index size = equations_.gradient.size();
  column_ = Eigen::VectorXd::Zero(size);
  if (size == 0) return;
  for (Eigen::Index k = 0; k < size; ++k)
    if (inner_[static_cast<std::size_t>(k)]) column_[k] = std::sqrt(equations_.matrix(k, k));
  const double longest = column_.maxCoeff();
  for (double& column : column_)
    if (!(column > unseen_column * longest)) column = 0;
  Eigen::MatrixXd scaled = Eigen::MatrixXd::Zero(size, size);
  for (Eigen::Index k = 0; k < size; ++k) {
    for (Eigen::Index l = 0; l < size; ++l) {
      if (column_[k] > 0 && column_[l] > 0) scaled(k, l) = equations_.matrix(k, l) / (column_[k] * column_[l]);
    }
  }
  // Symmetric and without negative eigenvalues, so that these are its singular values; here the smallest comes first.
  const frac::detail::RightSingularVectors decomposed = frac::detail::right_singular_vectors(scaled);
  eigenvalues_ = decomposed.values.reverse();
  eigenvectors_ = decomposed.vectors.rowwise().reverse();
  is_free_.assign(static_cast<std::size_t>(size), false);
  const double largest = eigenvalues_[size - 1];
  for (Eigen::Index direction = 0; direction < size; ++direction) {
    // Fixed coordinates and those at a limit are directions of their own with eigenvalue 0, as are unseen ones.
    double along_inner = 0;
    for (Eigen::Index k = 0; k < size; ++k) {
      if (inner_[static_cast<std::size_t>(k)]) along_inner += eigenvectors_(k, direction) * eigenvectors_(k, direction);
    }
    if (along_inner < 0.5) continue;
    const double value = eigenvalues_[direction];
    const bool flat = !(value * free_condition > largest);
    is_free_[static_cast<std::size_t>(direction)] = flat;
    if (!flat) ++rank_;
    condition_ = std::max(condition_, largest / std::max(value, largest * 1e-16));
  }
}

Eigen::VectorXd SceneUncertainty::scaled(const std::vector<double>& gradient) const {
  Eigen::VectorXd result = Eigen::VectorXd::Zero(column_.size());
  for (Eigen::Index k = 0; k < column_.size(); ++k)
    if (column_[k] > 0) result[k] = gradient[static_cast<std::size_t>(k)] / column_[k];
  return result;
}

// Quantities with the gradients c and d: c' F^-1 d over the determined directions, NaN when one changes along a free
// one.
double SceneUncertainty::covariance_of(const Quantity& one, const Quantity& other) const {
  double sum = 0;
  const Eigen::VectorXd first = scaled(one.gradient), second = scaled(other.gradient);
  for (Eigen::Index direction = 0; direction < eigenvalues_.size(); ++direction) {
    const double along_first = eigenvectors_.col(direction).dot(first);
    const double along_second = eigenvectors_.col(direction).dot(second);
    if (is_free_[static_cast<std::size_t>(direction)]) {
      if (std::abs(along_first) > free_share * first.norm() || std::abs(along_second) > free_share * second.norm()) {
        return nan;
      }
    } else if (along_first != 0 && along_second != 0 && eigenvalues_[direction] > 0) {
      sum += along_first * along_second / eigenvalues_[direction];
    }
  }
  return sum;
}

// Covariance of the estimate as the points themselves tell it: by how much it moves when each of them is left out, to
// first order (the jackknife; Efron, Tibshirani 1993, chapter 11).  A point of much weight that lies on its motion by
// accident moves the estimate far, which this sees; the variance of all residuals averages such a point away.
Eigen::MatrixXd SceneUncertainty::jackknife() const {
  const Eigen::Index size = column_.size();
  Eigen::MatrixXd inverse = Eigen::MatrixXd::Zero(size, size);  // along the directions that are determined
  for (Eigen::Index direction = 0; direction < size; ++direction) {
    const double value = eigenvalues_[direction];
    if (is_free_[static_cast<std::size_t>(direction)] || !(value > 0)) continue;
    Eigen::VectorXd along = Eigen::VectorXd::Zero(size);
    for (Eigen::Index k = 0; k < size; ++k)
      if (column_[k] > 0) along[k] = eigenvectors_(k, direction) / column_[k];
    inverse += along * along.transpose() / value;
  }
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(size, size);
  for (const PointResiduals& point : equations_.points) {
    const Eigen::Matrix<double, Eigen::Dynamic, 2> pulled = inverse * point.gradient;
    const Eigen::Matrix2d left = Eigen::Matrix2d::Identity() - point.gradient.transpose() * pulled;
    if (!(left.determinant() > 1e-12)) continue;
    const Eigen::VectorXd moved = pulled * left.inverse() * Eigen::Vector2d(point.value[0], point.value[1]);
    sum += moved * moved.transpose();
  }
  const double count = static_cast<double>(equations_.points.size());
  return sum * ((count - 1) / count);
}

// How hard the data press a coordinate against its limit, in standard deviations of what noise does: the square is the
// fall of the cost to be expected beyond the limit, the inner ones being free to follow.
double SceneUncertainty::pull(std::size_t at_limit) const {
  const auto limit = static_cast<Eigen::Index>(at_limit);
  const Eigen::Index size = equations_.gradient.size();
  const Eigen::MatrixXd& products = equations_.matrix;
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Identity(size, size);
  Eigen::VectorXd coupling = Eigen::VectorXd::Zero(size);
  const auto follows = [&](Eigen::Index k) {
    return k != limit && inner_[static_cast<std::size_t>(k)] && products(k, k) > 0;
  };
  for (Eigen::Index k = 0; k < size; ++k) {
    if (!follows(k)) continue;
    coupling[k] = products(k, limit) / std::sqrt(products(k, k));
    for (Eigen::Index l = 0; l < size; ++l) {
      if (follows(l)) matrix(k, l) = products(k, l) / std::sqrt(products(k, k) * products(l, l));
    }
  }
  const double own = products(limit, limit);
  const double left = own - coupling.dot(frac::detail::solve_symmetric(matrix, coupling));
  const double variance = std::max(variance_, family_.data().rounding_variance());
  return left > 1e-12 * own ? std::abs(equations_.gradient[limit]) / std::sqrt(left * variance) : 0;
}

std::vector<std::string> SceneUncertainty::strained() const {
  std::vector<std::string> sentences;
  const std::vector<Quantity> parameters = family_.parameters(theta_);
  for (std::size_t k = 0; k < theta_.size(); ++k) {
    if (!at_bound_[k] || !(pull(k) > significant)) continue;
    const Quantity& pulled = parameters[family_.parameter_of(k)];
    sentences.push_back("The data pull " + pulled.name + " beyond its limit " + short_text(pulled.value) + ".");
  }
  return sentences;
}

std::string SceneUncertainty::direction_text(Eigen::Index direction) const {
  Eigen::VectorXd change = Eigen::VectorXd::Zero(column_.size());
  for (Eigen::Index k = 0; k < change.size(); ++k) {
    if (!inner_[static_cast<std::size_t>(k)]) continue;
    const double component = eigenvectors_(k, direction);
    if (column_[k] > 0) {
      change[k] = component / column_[k];
    } else if (std::abs(component) > 0.5) {
      // Unseen: the direction is the coordinate itself.
      change.setZero();
      change[k] = 1;
      break;
    }
  }
  Eigen::Index leading = 0;
  const double largest = change.cwiseAbs().maxCoeff(&leading);
  change /= change[leading] < 0 ? -largest : largest;
  std::string which, rates;
  for (Eigen::Index k = 0; k < change.size(); ++k) {
    if (std::abs(change[k]) < free_share) continue;
    which += (which.empty() ? "" : " : ") + family_.coordinate_name(static_cast<std::size_t>(k));
    rates += (rates.empty() ? "" : " : ") + short_text(change[k]);
  }
  if (which.find(':') == std::string::npos) return "The data leave " + which + " free.";
  return "The data leave the scene free to move along " + which + " = " + rates + ".";
}

std::vector<std::string> SceneUncertainty::free_directions() const {
  std::vector<std::string> sentences;
  for (std::size_t direction = 0; direction < is_free_.size(); ++direction) {
    if (is_free_[direction]) sentences.push_back(direction_text(static_cast<Eigen::Index>(direction)));
  }
  return sentences;
}

SceneEstimate SceneUncertainty::open_estimate(const Quantity& quantity) const {
  const auto gradient = gradient_of(quantity);
  bool is_unseen = false;
  for (std::size_t k = 0; k < theta_.size(); ++k) {
    const auto row = static_cast<Eigen::Index>(k);
    is_unseen = is_unseen || (inner_[k] && column_[row] == 0 && gradient[row] != 0);
  }
  const double of_residuals = variance_ * covariance_of(quantity, quantity);
  const double of_points = gradient.dot(jackknife_ * gradient);
  const double error = is_unseen ? nan : std::sqrt(of_points > of_residuals ? of_points : of_residuals);
  const double value = quantity.value;
  return {quantity.name, quantity.unit, value, error, value - t_ * error, value + t_ * error, false, false, false};
}

SceneEstimate SceneUncertainty::estimate(const Quantity& quantity) const {
  SceneEstimate result = open_estimate(quantity);
  result.fixed = true;
  for (std::size_t k = 0; k < theta_.size(); ++k) {
    if (quantity.gradient[k] == 0) continue;
    result.fixed = result.fixed && !family_.bounds().is_free(k);
    const bool limits = !quantity.own_coordinate || *quantity.own_coordinate == k;
    result.at_bound = result.at_bound || (limits && at_bound_[k] && !inner_[k]);
  }
  if (result.fixed) {
    result.standard_error = 0;
    result.ci95_lower = result.ci95_upper = result.value;
  } else if (result.at_bound) {
    result.standard_error = result.ci95_lower = result.ci95_upper = nan;
  }
  if (quantity.from_zero) result.ci95_lower = std::max(result.ci95_lower, 0.0);
  result.identified = result.fixed || is_narrow(result);
  return result;
}

std::vector<std::vector<double>> SceneUncertainty::covariance(const std::vector<Quantity>& quantities) const {
  std::vector<SceneEstimate> estimates;
  std::vector<double> length;
  for (const Quantity& quantity : quantities) {
    estimates.push_back(estimate(quantity));
    const double own = std::sqrt(covariance_of(quantity, quantity));
    length.push_back(own > 0 ? estimates.back().standard_error / own : 0);
  }
  std::vector<std::vector<double>> result(quantities.size(), std::vector<double>(quantities.size()));
  for (std::size_t k = 0; k < quantities.size(); ++k) {
    for (std::size_t l = 0; l < quantities.size(); ++l) {
      if (estimates[k].fixed || estimates[l].fixed) continue;
      const bool is_open = std::isnan(estimates[k].standard_error) || std::isnan(estimates[l].standard_error);
      result[k][l] = is_open ? nan : length[k] * length[l] * covariance_of(quantities[k], quantities[l]);
    }
  }
  return result;
}

bool is_narrow(const SceneEstimate& estimate) {
  const bool is_restitution = estimate.name == "restitution" || estimate.name == "contact_restitution";
  return estimate.ci95_upper - estimate.ci95_lower <= (is_restitution ? 1.0 : estimate.value);
}

std::string summary_of(std::span<const SceneEstimate> parameters, const std::string& message) {
  std::string text;
  for (const SceneEstimate& each : parameters) {
    text += each.name + " = " + short_text(each.value) + (each.unit.empty() ? "" : " " + each.unit);
    if (each.fixed) {
      text += ", fixed";
    } else if (std::isfinite(each.ci95_lower) && std::isfinite(each.ci95_upper)) {
      text += ", 95 % within " + short_text(each.ci95_lower) + " .. " + short_text(each.ci95_upper);
    }
    text += each.identified ? "\n" : ", not identified\n";
  }
  return text + message;
}

}  // namespace backlash::detail
