// SPDX-License-Identifier: BSD-3-Clause
#include "parameter_map.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string>

#include "base/number_text.hpp"
#include "formula/dimension_analysis.hpp"

namespace frac::detail {

namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();
// A coefficient may be this many factors e away from its natural unit: 26 decades to either side, beyond any data that
// doubles can resolve and far from overflow in products of a few coefficients.
constexpr double log_range = 60;

[[noreturn]] void reject(const std::string& name, const std::string& reason) {
  throw std::invalid_argument("parameter '" + name + "': " + reason);
}

void check(const ParameterConstraint& constraint, ParameterRole role, bool positive) {
  const auto finite = [&](const std::optional<double>& value, const char* what) {
    if (value && !std::isfinite(*value)) reject(constraint.name, std::string(what) + " must be finite");
  };
  finite(constraint.fixed, "fixed value");
  finite(constraint.start, "start value");
  if (constraint.fixed && (constraint.lower || constraint.upper || constraint.start)) {
    reject(constraint.name, "is fixed, so it takes no limits and no start");
  }
  if ((constraint.lower && std::isnan(*constraint.lower)) || (constraint.upper && std::isnan(*constraint.upper))) {
    reject(constraint.name, "a limit is NaN");
  }
  const double lower = constraint.lower.value_or(-infinity), upper = constraint.upper.value_or(infinity);
  if (!(lower < upper)) {
    reject(constraint.name, "lower limit " + number_text(lower) + " must lie below upper limit " + number_text(upper));
  }
  if (constraint.start && (*constraint.start < lower || *constraint.start > upper)) {
    reject(constraint.name, "start " + number_text(*constraint.start) + " lies outside its limits");
  }
  constexpr double widest_order = 20;  // what realisations express, and as much as doubles can tell from a delay
  if (role == ParameterRole::order) {
    for (const std::optional<double>& order : {constraint.fixed, constraint.lower, constraint.upper}) {
      if (order && !(std::abs(*order) <= widest_order)) {
        reject(constraint.name, "is an order, so its value and limits must lie within -20 and 20");
      }
    }
  }
  if (positive && !constraint.lower) {
    if (constraint.upper && *constraint.upper <= 0) {
      reject(constraint.name, "is positive unless a lower limit <= 0 is given, so its upper limit must be positive");
    }
    if (constraint.start && *constraint.start <= 0) {
      reject(constraint.name, "is positive unless a lower limit <= 0 is given, so its start must be positive");
    }
  }
}

}  // namespace

ParameterMap::ParameterMap(const Structure& structure, const std::vector<ParameterConstraint>& constraints,
                           const DataScale& scale, bool blind_to_sign)
    : scale_(scale) {
  const auto& names = structure.parameter_names();
  const auto& roles = structure.parameter_roles();
  const std::size_t count = names.size();
  std::vector<ParameterConstraint> of(count);
  for (const ParameterConstraint& constraint : constraints) {
    const std::size_t i = structure.parameter_index(constraint.name);
    if (!of[i].name.empty()) reject(constraint.name, "is constrained twice");
    check(constraint, roles[i],
          roles[i] == ParameterRole::coefficient && (blind_to_sign || structure.parameter_in_sum()[i]));
    of[i] = constraint;
    // A magnitude is blind to the sign of an outer gain: positive, even where the model leaves it open.
    const bool outer_gain = roles[i] == ParameterRole::coefficient && !structure.parameter_in_sum()[i];
    if (blind_to_sign && outer_gain && constraint.lower == -infinity) of[i].lower.reset();
  }

  fixed_.assign(count, nan);
  start_.assign(count, nan);
  std::vector<double> order_middle(count, 0.0);
  std::vector<double> order_lower(count), order_upper(count);
  for (std::size_t i = 0; i < count; ++i) {
    if (of[i].fixed) fixed_[i] = start_[i] = *of[i].fixed;
    if (of[i].start) start_[i] = *of[i].start;
    if (roles[i] != ParameterRole::order) continue;
    order_parameters_.push_back(i);
    order_lower[i] = of[i].lower.value_or(structure.parameter_in_sum()[i] ? 0.0 : -4.0);
    order_upper[i] = of[i].upper.value_or(std::max(4.0, order_lower[i] + 4));
    order_middle[i] = of[i].fixed.value_or((order_lower[i] + order_upper[i]) / 2);
  }

  // The frequency exponents are linear in the orders for every formula whose exponents are, so differences are exact.
  const auto dimension = parameter_dimensions(structure, order_middle);
  std::vector<std::vector<ParameterDimension>> shifted;
  for (const std::size_t k : order_parameters_) {
    std::vector<double> orders = order_middle;
    orders[k] += 0.5;
    shifted.push_back(parameter_dimensions(structure, orders));
  }

  for (std::size_t i = 0; i < count; ++i) {
    if (is_fixed(i)) continue;
    Free entry{i, roles[i], false, false, of[i].lower || of[i].upper, 0, 0, 0, 0};
    std::vector<double> slope(order_parameters_.size(), 0.0);
    double intercept = 0;
    switch (roles[i]) {
      case ParameterRole::order:
        entry.lower = order_lower[i];
        entry.upper = order_upper[i];
        break;
      case ParameterRole::delay:
        entry.frequency_exponent = intercept = -1;
        entry.lower = std::max(of[i].lower.value_or(0.0) * scale.omega, -1e6);
        entry.upper = of[i].upper ? *of[i].upper * scale.omega : 2 * std::numbers::pi * scale.omega / scale.omega_lower;
        break;
      case ParameterRole::coefficient: {
        entry.value_exponent = dimension[i].value_exponent;
        entry.frequency_exponent = intercept = dimension[i].frequency_exponent;
        const bool positive = blind_to_sign || structure.parameter_in_sum()[i] || (of[i].upper && *of[i].upper > 0);
        const double lower = of[i].lower.value_or(positive ? 0.0 : -infinity), upper = of[i].upper.value_or(infinity);
        entry.logarithmic = lower >= 0 && (!of[i].lower || lower > 0);
        entry.either_sign = lower < 0;
        // Limits in the unit of the user bound theta only if that unit does not move with the orders.
        const bool movable = upper == infinity && (lower == 0 || lower == -infinity);
        for (std::size_t k = 0; k < order_parameters_.size() && movable; ++k) {
          slope[k] = (shifted[k][i].frequency_exponent - dimension[i].frequency_exponent) / 0.5;
          intercept -= slope[k] * order_middle[order_parameters_[k]];
        }
        const double unit =
            movable ? 0 : entry.value_exponent * std::log(scale.value) + intercept * std::log(scale.omega);
        if (entry.logarithmic) {
          entry.lower = lower > 0 ? std::log(lower) - unit : -log_range;
          entry.upper = upper < infinity ? std::log(upper) - unit : std::max(log_range, entry.lower + 2 * log_range);
          if (!(lower > 0)) entry.lower = std::min(entry.lower, entry.upper - 2 * log_range);
        } else {
          const double widest = std::exp(log_range);
          entry.lower = std::max(lower * std::exp(-unit), -widest);
          entry.upper = std::min(upper * std::exp(-unit), widest);
        }
        break;
      }
    }
    free_.push_back(entry);
    slope_.push_back(std::move(slope));
    intercept_.push_back(intercept);
  }
}

double ParameterMap::frequency_exponent(std::size_t k, std::span<const double> parameters) const {
  double exponent = intercept_[k];
  for (std::size_t j = 0; j < order_parameters_.size(); ++j)
    exponent += slope_[k][j] * parameters[order_parameters_[j]];
  return exponent;
}

double ParameterMap::log_unit(std::size_t k, std::span<const double> parameters) const {
  return free_[k].value_exponent * std::log(scale_.value) + frequency_exponent(k, parameters) * std::log(scale_.omega);
}

std::vector<double> ParameterMap::to_user(std::span<const double> theta) const {
  std::vector<double> parameters = fixed_;
  for (std::size_t k = 0; k < free_.size(); ++k) {
    if (free_[k].role == ParameterRole::order) parameters[free_[k].parameter] = theta[k];
  }
  for (std::size_t k = 0; k < free_.size(); ++k) {
    if (free_[k].role == ParameterRole::order) continue;
    const double unit = log_unit(k, parameters);
    parameters[free_[k].parameter] = free_[k].logarithmic ? std::exp(theta[k] + unit) : theta[k] * std::exp(unit);
  }
  return parameters;
}

std::vector<double> ParameterMap::to_theta(std::span<const double> parameters) const {
  std::vector<double> theta(free_.size());
  for (std::size_t k = 0; k < free_.size(); ++k) {
    const double value = parameters[free_[k].parameter];
    if (free_[k].role == ParameterRole::order) {
      theta[k] = value;
    } else {
      const double unit = log_unit(k, parameters);
      theta[k] = free_[k].logarithmic ? std::log(value) - unit : value * std::exp(-unit);
    }
    theta[k] = std::clamp(theta[k], free_[k].lower, free_[k].upper);
  }
  return theta;
}

std::vector<ParameterMap::Entry> ParameterMap::jacobian_entries(std::span<const double> parameters) const {
  std::vector<Entry> entries;
  const double log_omega = std::log(scale_.omega);
  for (std::size_t k = 0; k < free_.size(); ++k) {
    const std::size_t parameter = free_[k].parameter;
    if (free_[k].role == ParameterRole::order) {
      entries.push_back({parameter, k, 1});
      continue;
    }
    const double value = parameters[parameter];
    entries.push_back({parameter, k, free_[k].logarithmic ? value : std::exp(log_unit(k, parameters))});
    for (std::size_t j = 0; j < order_parameters_.size(); ++j) {
      if (slope_[k][j] == 0) continue;
      for (std::size_t order = 0; order < free_.size(); ++order) {
        if (free_[order].parameter != order_parameters_[j]) continue;
        entries.push_back({parameter, order, value * slope_[k][j] * log_omega});
      }
    }
  }
  return entries;
}

Eigen::MatrixXd ParameterMap::jacobian(std::span<const double> parameters) const {
  Eigen::MatrixXd result =
      Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(parameter_count()), static_cast<Eigen::Index>(free_.size()));
  for (const Entry& entry : jacobian_entries(parameters)) {
    result(static_cast<Eigen::Index>(entry.parameter), static_cast<Eigen::Index>(entry.free)) = entry.derivative;
  }
  return result;
}

double ParameterMap::centre_value(std::size_t k, std::span<const double> parameters) const {
  const double value = parameters[free_[k].parameter];
  if (free_[k].role == ParameterRole::order) return value;
  return value * std::pow(scale_.omega, -frequency_exponent(k, parameters));
}

double ParameterMap::centre_value_by_theta(std::size_t k, std::span<const double> parameters) const {
  if (free_[k].role == ParameterRole::order) return 1;
  if (free_[k].logarithmic) return centre_value(k, parameters);
  return std::pow(scale_.value, free_[k].value_exponent);
}

}  // namespace frac::detail
