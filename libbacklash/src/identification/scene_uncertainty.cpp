// SPDX-License-Identifier: BSD-3-Clause
#include "scene_uncertainty.hpp"

#include <Eigen/Core>
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
using Matrix4 = Eigen::Matrix<double, 4, 4>;
using Vector4 = Eigen::Matrix<double, 4, 1>;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
// Condition of the scaled Fisher matrix from which on a direction counts as free.
constexpr double free_condition = 1e6;
// Share of a quantity's gradient along a free direction from which on the quantity is free with it.
constexpr double free_share = 0.01;
// The residuals do not see a parameter whose column is this much shorter than the longest.
constexpr double unseen_column = 1e-10;

// Standard deviations that chance exceeds on one side once in a thousand.
constexpr double significant_pull = 3.09;

constexpr std::array<const char*, 4> names = {"mass1", "mass2", "clearance", "restitution"};
constexpr std::array<const char*, 4> units = {"kg", "kg", "m", "1"};

struct FisherMatrix {
  std::array<bool, 4> inner{};     // free, and not at a bound
  std::array<double, 4> column{};  // lengths
  Vector4 eigenvalues = Vector4::Zero();
  Matrix4 eigenvectors = Matrix4::Zero();  // of the scaled matrix
  std::array<bool, 4> is_free{};           // directions
  std::size_t determined = 0;
  double condition = 1;
};

FisherMatrix fisher_matrix(const NormalEquations& equations, const std::array<bool, 4>& inner) {
  FisherMatrix result;
  result.inner = inner;
  double longest = 0;
  for (std::size_t k = 0; k < 4; ++k) {
    if (!inner[k]) continue;
    result.column[k] = std::sqrt(equations.matrix[k][k]);
    longest = std::max(longest, result.column[k]);
  }
  Matrix4 scaled = Matrix4::Zero();
  for (std::size_t k = 0; k < 4; ++k) {
    if (!inner[k]) continue;
    if (!(result.column[k] > unseen_column * longest)) result.column[k] = 0;
    for (std::size_t l = 0; l < 4; ++l) {
      if (!inner[l] || !(result.column[k] > 0) || !(result.column[l] > 0)) continue;
      scaled(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(l)) =
          equations.matrix[k][l] / (result.column[k] * result.column[l]);
    }
  }
  // Symmetric and without negative eigenvalues, so that these are its singular values; here the smallest comes first.
  const frac::detail::RightSingularVectors decomposed = frac::detail::right_singular_vectors(scaled);
  result.eigenvalues = decomposed.values.reverse();
  result.eigenvectors = decomposed.vectors.rowwise().reverse();
  const double largest = result.eigenvalues[3];
  for (Eigen::Index direction = 0; direction < 4; ++direction) {
    // Fixed parameters and those at a bound are directions of their own with eigenvalue 0, as are unseen ones.
    double along_inner = 0;
    for (std::size_t k = 0; k < 4; ++k) {
      const double component = result.eigenvectors(static_cast<Eigen::Index>(k), direction);
      if (inner[k]) along_inner += component * component;
    }
    if (along_inner < 0.5) continue;
    const double value = result.eigenvalues[direction];
    const bool flat = !(value * free_condition > largest);
    result.is_free[static_cast<std::size_t>(direction)] = flat;
    if (!flat) ++result.determined;
    result.condition = std::max(result.condition, largest / std::max(value, largest * 1e-16));
  }
  return result;
}

// A quantity with the gradient c in theta: variance c' F^-1 c over the determined directions, NaN when it changes along
// a free one.
double covariance_of(const FisherMatrix& fisher, const Vector4& one, const Vector4& other) {
  double sum = 0;
  const auto scaled = [&](const Vector4& gradient) {
    Vector4 result = Vector4::Zero();
    for (std::size_t k = 0; k < 4; ++k) {
      const auto row = static_cast<Eigen::Index>(k);
      if (fisher.inner[k] && fisher.column[k] > 0) result[row] = gradient[row] / fisher.column[k];
    }
    return result;
  };
  const Vector4 first = scaled(one);
  const Vector4 second = scaled(other);
  for (Eigen::Index direction = 0; direction < 4; ++direction) {
    const double along_first = fisher.eigenvectors.col(direction).dot(first);
    const double along_second = fisher.eigenvectors.col(direction).dot(second);
    if (fisher.is_free[static_cast<std::size_t>(direction)]) {
      if (std::abs(along_first) > free_share * first.norm() || std::abs(along_second) > free_share * second.norm()) {
        return nan;
      }
    } else if (along_first != 0 && along_second != 0 && fisher.eigenvalues[direction] > 0) {
      sum += along_first * along_second / fisher.eigenvalues[direction];
    }
  }
  return sum;
}

// Covariance of the estimate as the points themselves tell it: by how much it moves when each of them is left out, to
// first order (the jackknife; Efron, Tibshirani 1993, chapter 11).  A point of much weight that lies on its motion by
// accident moves the estimate far, which this sees; the variance of all residuals averages such a point away.
Matrix4 jackknife_covariance(const FisherMatrix& fisher, const std::vector<PointResiduals>& points) {
  Matrix4 inverse = Matrix4::Zero();  // along the directions that are determined
  for (Eigen::Index direction = 0; direction < 4; ++direction) {
    const double value = fisher.eigenvalues[direction];
    if (fisher.is_free[static_cast<std::size_t>(direction)] || !(value > 0)) continue;
    Vector4 along = Vector4::Zero();
    for (std::size_t k = 0; k < 4; ++k) {
      const auto row = static_cast<Eigen::Index>(k);
      if (fisher.inner[k] && fisher.column[k] > 0) along[row] = fisher.eigenvectors(row, direction) / fisher.column[k];
    }
    inverse += along * along.transpose() / value;
  }
  Matrix4 sum = Matrix4::Zero();
  for (const PointResiduals& point : points) {
    Eigen::Matrix<double, 4, 2> gradient;
    for (Eigen::Index k = 0; k < 4; ++k) {
      const auto& row = point.gradient[static_cast<std::size_t>(k)];
      gradient.row(k) << row[0], row[1];
    }
    const Eigen::Matrix<double, 4, 2> pulled = inverse * gradient;
    const Eigen::Matrix2d left = Eigen::Matrix2d::Identity() - gradient.transpose() * pulled;
    if (!(left.determinant() > 1e-12)) continue;
    const Vector4 moved = pulled * left.inverse() * Eigen::Vector2d(point.value[0], point.value[1]);
    sum += moved * moved.transpose();
  }
  const double count = static_cast<double>(points.size());
  return sum * ((count - 1) / count);
}

bool unseen(const FisherMatrix& fisher, const Vector4& gradient) {
  for (std::size_t k = 0; k < 4; ++k) {
    if (fisher.inner[k] && fisher.column[k] == 0 && gradient[static_cast<Eigen::Index>(k)] != 0) return true;
  }
  return false;
}

std::string direction_text(const FisherMatrix& fisher, Eigen::Index direction) {
  Vector4 change = Vector4::Zero();
  for (std::size_t k = 0; k < 4; ++k) {
    const auto row = static_cast<Eigen::Index>(k);
    if (!fisher.inner[k]) continue;
    const double component = fisher.eigenvectors(row, direction);
    if (fisher.column[k] > 0) {
      change[row] = component / fisher.column[k];
    } else if (std::abs(component) > 0.5) {
      // Unseen: the direction is the parameter itself.
      change.setZero();
      change[row] = 1;
      break;
    }
  }
  Eigen::Index leading = 0;
  const double largest = change.cwiseAbs().maxCoeff(&leading);
  change /= change[leading] < 0 ? -largest : largest;
  constexpr std::array<const char*, 4> coordinates = {"ln mass1", "ln mass2", "ln clearance", "restitution"};
  std::string which, rates;
  for (std::size_t k = 0; k < 4; ++k) {
    const double rate = change[static_cast<Eigen::Index>(k)];
    if (std::abs(rate) < free_share) continue;
    which += (which.empty() ? "" : " : ") + std::string(coordinates[k]);
    rates += (rates.empty() ? "" : " : ") + short_text(rate);
  }
  if (which.find(':') == std::string::npos) return "The data leave " + which + " free.";
  return "The data leave the scene free to move along " + which + " = " + rates + ".";
}

struct Noise {
  double variance;    // of the residuals, widened
  Matrix4 jackknife;  // covariance, widened
  double t;
};

SceneEstimate estimate(const FisherMatrix& fisher, const Vector4& gradient, double value, const Noise& noise) {
  SceneEstimate result{};
  result.value = value;
  const double t = noise.t;
  const double of_residuals = noise.variance * covariance_of(fisher, gradient, gradient);
  const double of_points = gradient.dot(noise.jackknife * gradient);
  const double error = unseen(fisher, gradient) ? nan : std::sqrt(of_points > of_residuals ? of_points : of_residuals);
  result.standard_error = error;
  result.ci95_lower = value - t * error;
  result.ci95_upper = value + t * error;
  return result;
}

// How hard the data press a parameter against its limit, in standard deviations of what noise does: the square is the
// fall of the cost to be expected beyond the limit, the inner parameters being free to follow.
double pull(const NormalEquations& equations, const std::array<bool, 4>& inner, std::size_t at_limit, double variance) {
  Matrix4 matrix = Matrix4::Identity();
  Vector4 coupling = Vector4::Zero();
  for (std::size_t k = 0; k < 4; ++k) {
    if (!inner[k] || !(equations.matrix[k][k] > 0)) continue;
    const auto row = static_cast<Eigen::Index>(k);
    coupling[row] = equations.matrix[k][at_limit] / std::sqrt(equations.matrix[k][k]);
    for (std::size_t l = 0; l < 4; ++l) {
      if (!inner[l] || !(equations.matrix[l][l] > 0)) continue;
      matrix(row, static_cast<Eigen::Index>(l)) =
          equations.matrix[k][l] / std::sqrt(equations.matrix[k][k] * equations.matrix[l][l]);
    }
  }
  const double own = equations.matrix[at_limit][at_limit];
  const double left = own - coupling.dot(frac::detail::solve_symmetric(matrix, coupling));
  return left > 1e-12 * own ? std::abs(equations.gradient[at_limit]) / std::sqrt(left * variance) : 0;
}

// A quantity that is held is known; at a limit nothing tells how far it might go.
void close_interval(SceneEstimate& estimate) {
  if (estimate.fixed) {
    estimate.standard_error = 0;
    estimate.ci95_lower = estimate.ci95_upper = estimate.value;
  } else if (estimate.at_bound) {
    estimate.standard_error = estimate.ci95_lower = estimate.ci95_upper = nan;
  }
  estimate.identified = estimate.fixed || is_narrow(estimate);
}

// Of the directions that the Fisher matrix gives, as long as the standard errors are.
auto covariances(const std::array<SceneEstimate, 4>& parameters, const FisherMatrix& fisher,
                 const std::array<Vector4, 4>& gradient) {
  std::array<double, 4> length{};
  for (std::size_t k = 0; k < 4; ++k) {
    const double own = std::sqrt(covariance_of(fisher, gradient[k], gradient[k]));
    length[k] = own > 0 ? parameters[k].standard_error / own : 0;
  }
  std::array<std::array<double, 4>, 4> covariance{};
  for (std::size_t k = 0; k < 4; ++k) {
    for (std::size_t l = 0; l < 4; ++l) {
      const bool either_fixed = parameters[k].fixed || parameters[l].fixed;
      const bool either_open = std::isnan(parameters[k].standard_error) || std::isnan(parameters[l].standard_error);
      covariance[k][l] = either_fixed  ? 0
                         : either_open ? nan
                                       : length[k] * length[l] * covariance_of(fisher, gradient[k], gradient[l]);
    }
  }
  return covariance;
}

/// Sum of the masses, product of mass 2 and clearance, ratio of the masses.
/// @param estimated  called with the gradient in theta and the value of each
template <typename Estimated>
std::array<SceneEstimate, 3> combinations_of(const std::array<double, 4>& value, const Estimated& estimated) {
  const double product = value[1] * value[2];
  const double ratio = value[0] / value[1];
  std::array<SceneEstimate, 3> combinations = {estimated(Vector4(value[0], value[1], 0, 0), value[0] + value[1]),
                                               estimated(Vector4(0, product, product, 0), product),
                                               estimated(Vector4(ratio, -ratio, 0, 0), ratio)};
  constexpr std::array<const char*, 3> combined_names = {"mass1 + mass2", "mass2 clearance", "mass1/mass2"};
  constexpr std::array<const char*, 3> combined_units = {"kg", "kg m", "1"};
  for (std::size_t c = 0; c < 3; ++c) {
    combinations[c].name = combined_names[c];
    combinations[c].unit = combined_units[c];
  }
  return combinations;
}

}  // namespace

bool is_narrow(const SceneEstimate& estimate) {
  const double range = estimate.name == names[3] ? 1.0 : estimate.value;
  return estimate.ci95_upper - estimate.ci95_lower <= range;
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

void stretch_over(const SceneEstimate& rival, SceneEstimate& estimate) {
  if (estimate.fixed || estimate.at_bound) return;
  // A rival at a limit has a value only.
  const bool has_interval = std::isfinite(rival.ci95_lower);
  estimate.ci95_lower = std::min(estimate.ci95_lower, has_interval ? rival.ci95_lower : rival.value);
  estimate.ci95_upper = std::max(estimate.ci95_upper, has_interval ? rival.ci95_upper : rival.value);
  estimate.identified = is_narrow(estimate);
}

SceneUncertainty scene_uncertainty(const NormalEquations& equations, const SceneBounds& bounds,
                                   const SceneVector& theta, double widening, double least_variance) {
  SceneUncertainty result{};
  std::array<bool, 4> inner{}, at_bound{};
  std::size_t bound_count = 0;
  for (std::size_t k = 0; k < 4; ++k) {
    const double margin = 1e-9 * std::min(1.0, bounds.upper[k] - bounds.lower[k]);
    at_bound[k] = bounds.is_free(k) && (theta[k] <= bounds.lower[k] + margin || theta[k] >= bounds.upper[k] - margin);
    inner[k] = bounds.is_free(k) && !at_bound[k];
    bound_count += at_bound[k] ? 1 : 0;
  }
  const FisherMatrix fisher = fisher_matrix(equations, inner);
  result.condition = fisher.condition;
  result.rank = fisher.determined + bound_count;
  const double degrees = static_cast<double>(equations.residuals) - static_cast<double>(result.rank);
  const double variance = degrees > 0 ? widening * widening * std::max(equations.cost / degrees, least_variance) : nan;
  const Noise noise{variance, widening * widening * jackknife_covariance(fisher, equations.points),
                    frac::student_t_95(degrees)};

  for (std::size_t k = 0; k < 4; ++k) {
    if (at_bound[k] && pull(equations, inner, k, variance) > significant_pull) {
      result.strained.push_back(std::string("The data pull ") + names[k] + " beyond its limit " +
                                short_text(k == 3 ? theta[k] : std::exp(theta[k])) + ".");
    }
  }

  const std::array<double, 4> value = {std::exp(theta[0]), std::exp(theta[1]), std::exp(theta[2]), theta[3]};
  std::array<Vector4, 4> gradient;
  for (std::size_t k = 0; k < 4; ++k) {
    gradient[k] = Vector4::Zero();
    gradient[k][static_cast<Eigen::Index>(k)] = k == 3 ? 1 : value[k];
    SceneEstimate& parameter = result.parameters[k];
    parameter = estimate(fisher, gradient[k], value[k], noise);
    parameter.name = names[k];
    parameter.unit = units[k];
    parameter.fixed = !bounds.is_free(k);
    parameter.at_bound = at_bound[k];
    close_interval(parameter);
  }
  result.covariance = covariances(result.parameters, fisher, gradient);
  result.combinations = combinations_of(value, [&](const Vector4& of, double combined) {
    SceneEstimate combination = estimate(fisher, of, combined, noise);
    combination.fixed = true;
    for (std::size_t k = 0; k < 4; ++k) {
      if (of[static_cast<Eigen::Index>(k)] == 0) continue;
      combination.fixed = combination.fixed && !bounds.is_free(k);
      combination.at_bound = combination.at_bound || at_bound[k];
    }
    close_interval(combination);
    return combination;
  });
  for (Eigen::Index direction = 0; direction < 4; ++direction) {
    if (fisher.is_free[static_cast<std::size_t>(direction)]) {
      result.free_directions.push_back(direction_text(fisher, direction));
    }
  }
  return result;
}

}  // namespace backlash::detail
