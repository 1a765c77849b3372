// SPDX-License-Identifier: BSD-3-Clause
#include "frac/identification/robust_tune.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <stdexcept>

#include "base/linear_algebra.hpp"
#include "base/number_text.hpp"
#include "frac/structure.hpp"
#include "loop_description.hpp"
#include "special/distributions.hpp"
#include "specification.hpp"

namespace frac {
namespace {

// A fit over time has parameters of the record, behind those of the model.
std::vector<double> model_values(const FitResult& fit, const Structure& structure) {
  const auto& names = structure.parameter_names();
  std::vector<double> values;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (i >= fit.parameters.size() || fit.parameters[i].name != names[i])
      throw std::invalid_argument("the fit has no value of the parameter '" + names[i] + "' of its model");
    values.push_back(fit.parameters[i].value);
  }
  return values;
}

// Distance of the border of the joint 95 % region, in standard deviations.
double radius_of_region(std::size_t parameters, const FitResult& fit) {
  const double count = static_cast<double>(parameters);
  const double freedom = static_cast<double>(fit.residuals) - static_cast<double>(fit.free_parameters);
  constexpr double level = 0.95;
  if (!(freedom >= 1)) return std::sqrt(detail::chi_squared_quantile(level, count));
  return std::sqrt(count * detail::fisher_f_quantile(level, count, freedom));
}

std::vector<double> moved(const Structure& structure, std::vector<double> values, const Eigen::VectorXd& step) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double by = step[static_cast<Eigen::Index>(i)];
    const bool is_coefficient = structure.parameter_roles()[i] == ParameterRole::coefficient;
    // By logarithms a coefficient that is known to no better than its size would leave every range.
    if (is_coefficient && by > values[i] && values[i] > 0)
      values[i] = std::numbers::e * by;
    else if (is_coefficient && values[i] > 0)
      values[i] *= std::exp(by / values[i]);
    else
      values[i] = is_coefficient ? values[i] + by : std::max(0.0, values[i] + by);
  }
  return values;
}

// What the plants of the region make of a controller.
void look_at_region(const std::vector<FractionalTransferFunction>& plants, const LoopSpecification& asked,
                    const TuningOptions& options, RobustTuningResult& result) {
  result.plants = plants.size();
  result.not_stable = 0;
  result.max_sensitivity = result.nominal.max_sensitivity;
  result.max_complementary_sensitivity = result.nominal.max_complementary_sensitivity;
  result.least_phase_margin = result.nominal.phase_margin;
  result.lowest_crossover = result.highest_crossover = result.nominal.crossover;
  // The integrals of a step response say nothing here and cost most.
  TuningOptions without_steps = options;
  without_steps.horizon = 0;
  for (const FractionalTransferFunction& plant : plants) {
    TuningResult loop;
    loop.gains = result.nominal.gains;
    loop.derivative_filter_time = result.nominal.derivative_filter_time;
    detail::describe_loop(plant, asked, without_steps, loop);
    if (loop.closed_loop != Stability::stable) {
      ++result.not_stable;
      continue;
    }
    result.max_sensitivity = std::max(result.max_sensitivity, loop.max_sensitivity);
    result.max_complementary_sensitivity =
        std::max(result.max_complementary_sensitivity, loop.max_complementary_sensitivity);
    if (std::isnan(loop.crossover)) continue;
    result.least_phase_margin = std::min(result.least_phase_margin, loop.phase_margin);
    result.lowest_crossover = std::min(result.lowest_crossover, loop.crossover);
    result.highest_crossover = std::max(result.highest_crossover, loop.crossover);
  }
}

// By how much the region exceeds what was asked for; at most 1 where it keeps it.
double excess(const RobustTuningResult& result, const LoopSpecification& asked) {
  return std::max(result.max_sensitivity / asked.max_sensitivity,
                  result.max_complementary_sensitivity / asked.max_complementary_sensitivity);
}

}  // namespace

FractionalTransferFunction fitted_plant(const FitResult& fit) {
  const Structure structure(fit.model);
  return to_transfer_function(structure, model_values(fit, structure));
}

std::vector<FractionalTransferFunction> plants_of_region(const FitResult& fit, std::size_t directions) {
  const Structure structure(fit.model);
  const std::vector<double> values = model_values(fit, structure);
  const auto count = static_cast<Eigen::Index>(values.size());
  Eigen::MatrixXd covariance(count, count);
  const auto known = [&](std::size_t row, std::size_t column) {
    const bool is_there = row < fit.covariance.size() && column < fit.covariance[row].size();
    return is_there ? fit.covariance[row][column] : std::numeric_limits<double>::quiet_NaN();
  };
  for (std::size_t i = 0; i < values.size(); ++i)
    if (!std::isfinite(known(i, i)))
      throw std::invalid_argument("the fit has no standard error of its parameter '" + fit.parameters[i].name +
                                  "', so that no region of plants is known");
  for (Eigen::Index i = 0; i < count; ++i)
    for (Eigen::Index j = 0; j < count; ++j)
      covariance(i, j) = known(static_cast<std::size_t>(i), static_cast<std::size_t>(j));
  // Symmetric and not negative: its singular vectors are the principal axes.  Held parameters have none.
  const auto [squares, axes] = detail::right_singular_vectors(covariance);
  const auto free = (squares.array() > 1e-16 * squares[0]).count();
  if (free == 0) return {};
  const Eigen::MatrixXd ends = radius_of_region(static_cast<std::size_t>(free), fit) * axes.leftCols(free) *
                               squares.head(free).cwiseSqrt().asDiagonal();
  std::vector<Eigen::VectorXd> steps;
  for (Eigen::Index axis = 0; axis < free; ++axis)
    for (const double sign : {-1.0, 1.0}) steps.emplace_back(sign * ends.col(axis));
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  for (std::size_t i = 0; i < directions; ++i) {
    const Eigen::VectorXd direction = Eigen::VectorXd::NullaryExpr(free, [&] { return normal(random); });
    steps.emplace_back(ends * direction.normalized());
  }
  std::vector<FractionalTransferFunction> plants;
  for (const Eigen::VectorXd& step : steps)
    plants.push_back(to_transfer_function(structure, moved(structure, values, step)));
  return plants;
}

RobustTuningResult tune_for_region(const FitResult& fit, const LoopSpecification& specification,
                                   const TuningOptions& options,
                                   const std::vector<FractionalTransferFunction>& others) {
  const FractionalTransferFunction plant = fitted_plant(fit);
  std::vector<FractionalTransferFunction> plants = plants_of_region(fit);
  plants.insert(plants.end(), others.begin(), others.end());
  TuningOptions searched = options;
  for (const FractionalTransferFunction& each : plants) {
    detail::require_valid(each, specification, options);
    searched.mu.upper = std::min(searched.mu.upper, detail::highest_mu(each, options));
  }
  RobustTuningResult result;
  LoopSpecification tightened = specification;
  // Each round takes the ratio by which the region still exceeds the bounds; it is nearly the same for any controller,
  // so that two or three rounds do.
  constexpr int most_rounds = 8;
  constexpr double enough = 1 + 1e-3;
  for (int round = 0; round < most_rounds; ++round) {
    RobustTuningResult next;
    next.nominal = tune(plant, tightened, searched);
    if (round > 0 && !next.nominal.usable()) break;
    look_at_region(plants, specification, searched, next);
    result = next;
    if (!result.nominal.usable() || result.not_stable > 0) break;
    const double ratio = excess(result, specification);
    if (ratio <= enough) {
      result.status = TuningStatus::met;
      break;
    }
    tightened.max_sensitivity = std::max(1 + 1e-3, tightened.max_sensitivity / ratio);
    tightened.max_complementary_sensitivity = tightened.max_complementary_sensitivity / ratio;
  }
  const std::string count = std::to_string(result.plants);
  const std::string region =
      others.empty()
          ? "on the border of the joint 95 % region of the fit"
          : "on the border of the joint 95 % region of the fit and of other kinds that its data leave possible";
  if (result.status == TuningStatus::met) {
    const bool is_bounded =
        std::isfinite(specification.max_sensitivity) || std::isfinite(specification.max_complementary_sensitivity);
    result.message = "All " + count + " plants tried " + region + " have a stable loop" +
                     (is_bounded ? " and keep the bounds." : ".");
  } else if (!result.nominal.usable()) {
    result.message = "The fitted plant itself: " + result.nominal.message;
  } else if (result.not_stable > 0) {
    result.message = std::to_string(result.not_stable) + " of " + count + " plants " + region +
                     " have no stable loop; ask for less, or measure the plant more closely.";
  } else {
    result.message = "No controller was found with which all of " + count + " plants " + region +
                     " keep the bounds; the nearest one reaches max |S| " +
                     detail::number_text(result.max_sensitivity) + ".";
  }
  return result;
}

}  // namespace frac
