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
constexpr auto dimension = static_cast<int>(scene_size);
using SceneMatrix = Eigen::Matrix<double, dimension, dimension>;
using SceneGradient = Eigen::Matrix<double, dimension, 1>;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
// Condition of the scaled Fisher matrix from which on a direction counts as free.
constexpr double free_condition = 1e6;
// Share of a quantity's gradient along a free direction from which on the quantity is free with it.
constexpr double free_share = 0.01;
// The residuals do not see a parameter whose column is this much shorter than the longest.
constexpr double unseen_column = 1e-10;

// Standard deviations that chance exceeds on one side once in a thousand.
constexpr double significant_pull = 3.09;
// Residuals below this share of the data are rounding errors, and pull without meaning.
constexpr double rounding_share = 1e-7;

constexpr std::array<const char*, scene_size> names = {"mass1",        "mass2",     "clearance", "restitution",
                                                       "contact_time", "friction1", "friction2"};
constexpr std::array<const char*, scene_size> units = {"kg", "kg", "m", "1", "s", "N", "N"};

struct FisherMatrix {
  std::array<bool, scene_size> inner{};     // free, and not at a bound
  std::array<double, scene_size> column{};  // lengths
  SceneGradient eigenvalues = SceneGradient::Zero();
  SceneMatrix eigenvectors = SceneMatrix::Zero();  // of the scaled matrix
  std::array<bool, scene_size> is_free{};          // directions
  std::size_t determined = 0;
  double condition = 1;
};

FisherMatrix fisher_matrix(const NormalEquations& equations, const std::array<bool, scene_size>& inner) {
  FisherMatrix result;
  result.inner = inner;
  double longest = 0;
  for (std::size_t k = 0; k < scene_size; ++k) {
    if (!inner[k]) continue;
    result.column[k] = std::sqrt(equations.matrix[k][k]);
    longest = std::max(longest, result.column[k]);
  }
  SceneMatrix scaled = SceneMatrix::Zero();
  for (std::size_t k = 0; k < scene_size; ++k) {
    if (!inner[k]) continue;
    if (!(result.column[k] > unseen_column * longest)) result.column[k] = 0;
    for (std::size_t l = 0; l < scene_size; ++l) {
      if (!inner[l] || !(result.column[k] > 0) || !(result.column[l] > 0)) continue;
      scaled(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(l)) =
          equations.matrix[k][l] / (result.column[k] * result.column[l]);
    }
  }
  // Symmetric and without negative eigenvalues, so that these are its singular values; here the smallest comes first.
  const frac::detail::RightSingularVectors decomposed = frac::detail::right_singular_vectors(scaled);
  result.eigenvalues = decomposed.values.reverse();
  result.eigenvectors = decomposed.vectors.rowwise().reverse();
  const double largest = result.eigenvalues[dimension - 1];
  for (Eigen::Index direction = 0; direction < dimension; ++direction) {
    // Fixed parameters and those at a bound are directions of their own with eigenvalue 0, as are unseen ones.
    double along_inner = 0;
    for (std::size_t k = 0; k < scene_size; ++k) {
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
double covariance_of(const FisherMatrix& fisher, const SceneGradient& one, const SceneGradient& other) {
  double sum = 0;
  const auto scaled = [&](const SceneGradient& gradient) {
    SceneGradient result = SceneGradient::Zero();
    for (std::size_t k = 0; k < scene_size; ++k) {
      const auto row = static_cast<Eigen::Index>(k);
      if (fisher.inner[k] && fisher.column[k] > 0) result[row] = gradient[row] / fisher.column[k];
    }
    return result;
  };
  const SceneGradient first = scaled(one);
  const SceneGradient second = scaled(other);
  for (Eigen::Index direction = 0; direction < dimension; ++direction) {
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
SceneMatrix jackknife_covariance(const FisherMatrix& fisher, const std::vector<PointResiduals>& points) {
  SceneMatrix inverse = SceneMatrix::Zero();  // along the directions that are determined
  for (Eigen::Index direction = 0; direction < dimension; ++direction) {
    const double value = fisher.eigenvalues[direction];
    if (fisher.is_free[static_cast<std::size_t>(direction)] || !(value > 0)) continue;
    SceneGradient along = SceneGradient::Zero();
    for (std::size_t k = 0; k < scene_size; ++k) {
      const auto row = static_cast<Eigen::Index>(k);
      if (fisher.inner[k] && fisher.column[k] > 0) along[row] = fisher.eigenvectors(row, direction) / fisher.column[k];
    }
    inverse += along * along.transpose() / value;
  }
  SceneMatrix sum = SceneMatrix::Zero();
  for (const PointResiduals& point : points) {
    Eigen::Matrix<double, dimension, 2> gradient;
    for (Eigen::Index k = 0; k < dimension; ++k) {
      const auto& row = point.gradient[static_cast<std::size_t>(k)];
      gradient.row(k) << row[0], row[1];
    }
    const Eigen::Matrix<double, dimension, 2> pulled = inverse * gradient;
    const Eigen::Matrix2d left = Eigen::Matrix2d::Identity() - gradient.transpose() * pulled;
    if (!(left.determinant() > 1e-12)) continue;
    const SceneGradient moved = pulled * left.inverse() * Eigen::Vector2d(point.value[0], point.value[1]);
    sum += moved * moved.transpose();
  }
  const double count = static_cast<double>(points.size());
  return sum * ((count - 1) / count);
}

bool unseen(const FisherMatrix& fisher, const SceneGradient& gradient) {
  for (std::size_t k = 0; k < scene_size; ++k) {
    if (fisher.inner[k] && fisher.column[k] == 0 && gradient[static_cast<Eigen::Index>(k)] != 0) return true;
  }
  return false;
}

std::string direction_text(const FisherMatrix& fisher, Eigen::Index direction) {
  SceneGradient change = SceneGradient::Zero();
  for (std::size_t k = 0; k < scene_size; ++k) {
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
  constexpr std::array<const char*, scene_size> coordinates = {
      "ln mass1", "ln mass2", "ln clearance", "restitution", "contact time", "friction1", "friction2"};
  std::string which, rates;
  for (std::size_t k = 0; k < scene_size; ++k) {
    const double rate = change[static_cast<Eigen::Index>(k)];
    if (std::abs(rate) < free_share) continue;
    which += (which.empty() ? "" : " : ") + std::string(coordinates[k]);
    rates += (rates.empty() ? "" : " : ") + short_text(rate);
  }
  if (which.find(':') == std::string::npos) return "The data leave " + which + " free.";
  return "The data leave the scene free to move along " + which + " = " + rates + ".";
}

struct Noise {
  double variance;        // of the residuals, widened
  SceneMatrix jackknife;  // covariance, widened
  double t;
  double time_unit;  // of the contact time, s
};

SceneEstimate estimate(const FisherMatrix& fisher, const SceneGradient& gradient, double value, const Noise& noise) {
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
double pull(const NormalEquations& equations, const std::array<bool, scene_size>& inner, std::size_t at_limit,
            double variance) {
  SceneMatrix matrix = SceneMatrix::Identity();
  SceneGradient coupling = SceneGradient::Zero();
  for (std::size_t k = 0; k < scene_size; ++k) {
    if (k == at_limit || !inner[k] || !(equations.matrix[k][k] > 0)) continue;
    const auto row = static_cast<Eigen::Index>(k);
    coupling[row] = equations.matrix[k][at_limit] / std::sqrt(equations.matrix[k][k]);
    for (std::size_t l = 0; l < scene_size; ++l) {
      if (l == at_limit || !inner[l] || !(equations.matrix[l][l] > 0)) continue;
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
                 const std::array<SceneGradient, scene_size>& gradient) {
  std::array<double, 4> length{};
  for (std::size_t k = 0; k < parameters.size(); ++k) {
    const double own = std::sqrt(covariance_of(fisher, gradient[k], gradient[k]));
    length[k] = own > 0 ? parameters[k].standard_error / own : 0;
  }
  std::array<std::array<double, 4>, 4> covariance{};
  for (std::size_t k = 0; k < parameters.size(); ++k) {
    for (std::size_t l = 0; l < parameters.size(); ++l) {
      const bool either_fixed = parameters[k].fixed || parameters[l].fixed;
      const bool either_open = std::isnan(parameters[k].standard_error) || std::isnan(parameters[l].standard_error);
      covariance[k][l] = either_fixed  ? 0
                         : either_open ? nan
                                       : length[k] * length[l] * covariance_of(fisher, gradient[k], gradient[l]);
    }
  }
  return covariance;
}

// With m the reduced mass, and zeta and a the damping ratio and the angle of a free contact of that restitution and the
// duration t,
//   k = m a^2/t^2,   c = 2 zeta a m/t.
// 1/sqrt(k) and 1/c go smoothly to 0 at the hard contact, so that their intervals give those of k and c, which have no
// upper end where the contact may be hard.
std::vector<SceneEstimate> contact_estimates(const FisherMatrix& fisher, const SceneVector& value, SceneEstimate time,
                                             SceneEstimate restitution, const Noise& noise) {
  constexpr double difference = 1e-6;
  const double mass = value[0] / (value[0] + value[1]) * value[1];
  time.ci95_lower = std::max(time.ci95_lower, 0.0);
  restitution.name = "contact_restitution";
  const auto inverse_roots = [&](double of_restitution) {
    const ContactShape shape = contact_shape(of_restitution);
    return std::array{1 / (shape.angle * std::sqrt(mass)), 1 / (2 * shape.damping_ratio * shape.angle * mass)};
  };
  const double before = std::max(0.0, value[3] - difference), after = std::min(1.0, value[3] + difference);
  const auto here = inverse_roots(value[3]), low = inverse_roots(before), high = inverse_roots(after);
  constexpr std::array<double, 2> power = {2, 1}, power_of_mass = {0.5, 1};
  constexpr std::array<const char*, 2> contact_names = {"contact_stiffness", "contact_damping"};
  constexpr std::array<const char*, 2> contact_units = {"N/m", "N s/m"};
  std::vector<SceneEstimate> result = {time};
  for (std::size_t i = 0; i < 2; ++i) {
    const double inverse = value[4] * here[i];
    SceneGradient gradient = SceneGradient::Zero();
    gradient[0] = -power_of_mass[i] * inverse * value[1] / (value[0] + value[1]);
    gradient[1] = -power_of_mass[i] * inverse * value[0] / (value[0] + value[1]);
    gradient[3] = value[4] * (high[i] - low[i]) / (after - before);
    gradient[4] = here[i] * noise.time_unit;
    const SceneEstimate root = estimate(fisher, gradient, inverse, noise);
    SceneEstimate made{};
    made.name = contact_names[i];
    made.unit = contact_units[i];
    made.value = std::pow(inverse, -power[i]);
    made.standard_error = power[i] * made.value * root.standard_error / inverse;
    made.ci95_lower = std::pow(root.ci95_upper, -power[i]);
    made.ci95_upper = root.ci95_lower > 0 ? std::pow(root.ci95_lower, -power[i]) : nan;
    made.fixed = time.fixed && restitution.fixed;
    made.at_bound = time.at_bound || restitution.at_bound || !std::isfinite(inverse);
    made.identified = !made.at_bound && is_narrow(made);
    if (!std::isfinite(made.standard_error)) made.standard_error = nan;
    result.push_back(made);
  }
  result.push_back(restitution);
  return result;
}

/// Sum of the masses, product of mass 2 and clearance, ratio of the masses.
/// @param estimated  called with the gradient in theta and the value of each
template <typename Estimated>
std::array<SceneEstimate, 3> combinations_of(const SceneVector& value, const Estimated& estimated) {
  const double product = value[1] * value[2];
  const double ratio = value[0] / value[1];
  const auto along = [](double mass1, double mass2, double clearance) {
    SceneGradient gradient = SceneGradient::Zero();
    gradient.head<3>() << mass1, mass2, clearance;
    return gradient;
  };
  std::array<SceneEstimate, 3> combinations = {estimated(along(value[0], value[1], 0), value[0] + value[1]),
                                               estimated(along(0, product, product), product),
                                               estimated(along(ratio, -ratio, 0), ratio)};
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
  const double range = estimate.name == names[3] || estimate.name == "contact_restitution" ? 1.0 : estimate.value;
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
                                   const SceneVector& theta, double widening, double least_variance,
                                   const SceneData& data) {
  SceneUncertainty result{};
  std::array<bool, scene_size> inner{}, at_bound{};
  std::size_t bound_count = 0;
  for (std::size_t k = 0; k < scene_size; ++k) {
    const double margin = 1e-9 * std::min(1.0, bounds.upper[k] - bounds.lower[k]);
    at_bound[k] = bounds.is_free(k) && (theta[k] <= bounds.lower[k] + margin || theta[k] >= bounds.upper[k] - margin);
    const bool is_ideal = k >= 4 && bounds.lower[k] == 0 && theta[k] <= margin;
    inner[k] = bounds.is_free(k) && (!at_bound[k] || is_ideal);
    bound_count += at_bound[k] && !inner[k] ? 1 : 0;
  }
  const FisherMatrix fisher = fisher_matrix(equations, inner);
  result.condition = fisher.condition;
  result.rank = fisher.determined + bound_count;
  const double degrees = static_cast<double>(equations.residuals) - static_cast<double>(result.rank);
  const double variance = degrees > 0 ? widening * widening * std::max(equations.cost / degrees, least_variance) : nan;
  const Noise noise{variance, widening * widening * jackknife_covariance(fisher, equations.points),
                    frac::student_t_95(degrees), data.time_unit};

  const SceneVector value = {std::exp(theta[0]),        std::exp(theta[1]),         std::exp(theta[2]),        theta[3],
                             theta[4] * data.time_unit, theta[5] * data.force_unit, theta[6] * data.force_unit};
  const double rounding = rounding_share * data.typical_misfit;
  for (std::size_t k = 0; k < scene_size; ++k) {
    if (at_bound[k] && pull(equations, inner, k, std::max(variance, rounding * rounding)) > significant_pull) {
      result.strained.push_back(std::string("The data pull ") + names[k] + " beyond its limit " + short_text(value[k]) +
                                ".");
    }
  }

  std::array<SceneGradient, scene_size> gradient;
  for (std::size_t k = 0; k < scene_size; ++k) {
    gradient[k] = SceneGradient::Zero();
    gradient[k][static_cast<Eigen::Index>(k)] = k < 3    ? value[k]
                                                : k == 3 ? 1
                                                : k == 4 ? data.time_unit
                                                         : data.force_unit;
    SceneEstimate parameter = estimate(fisher, gradient[k], value[k], noise);
    parameter.name = names[k];
    parameter.unit = units[k];
    parameter.fixed = !bounds.is_free(k);
    parameter.at_bound = at_bound[k] && !inner[k];
    close_interval(parameter);
    if (k < result.parameters.size())
      result.parameters[k] = parameter;
    else if (k >= first_friction && bounds.has_friction()) {
      parameter.ci95_lower = std::max(parameter.ci95_lower, 0.0);
      parameter.identified = parameter.fixed || is_narrow(parameter);
      result.friction.push_back(parameter);
    } else if (k == 4 && bounds.upper[k] > 0)
      result.contact = contact_estimates(fisher, value, parameter, result.parameters[3], noise);
  }
  result.covariance = covariances(result.parameters, fisher, gradient);
  result.combinations = combinations_of(value, [&](const SceneGradient& of, double combined) {
    SceneEstimate combination = estimate(fisher, of, combined, noise);
    combination.fixed = true;
    for (std::size_t k = 0; k < scene_size; ++k) {
      if (of[static_cast<Eigen::Index>(k)] == 0) continue;
      combination.fixed = combination.fixed && !bounds.is_free(k);
      combination.at_bound = combination.at_bound || at_bound[k];
    }
    close_interval(combination);
    return combination;
  });
  for (Eigen::Index direction = 0; direction < dimension; ++direction) {
    if (fisher.is_free[static_cast<std::size_t>(direction)]) {
      result.free_directions.push_back(direction_text(fisher, direction));
    }
  }
  return result;
}

}  // namespace backlash::detail
