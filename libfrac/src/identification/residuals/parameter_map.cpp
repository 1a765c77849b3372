// SPDX-License-Identifier: BSD-3-Clause
#include "parameter_map.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string>

#include "base/number_text.hpp"
#include "formula/parameter_roles.hpp"

namespace frac::detail {

namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();
// A coefficient may be this many factors e away from its natural unit: 26 decades to either side, beyond any data that
// doubles can resolve and far from overflow in products of a few coefficients.
constexpr double log_range = 60;
// The same of what may have either sign.  Such are sums over products of many poles, of which each may lie decades
// below the band: e^300 is reached by 20 poles that are six decades away.  Its square is a number still.
constexpr double log_range_of_sums = 300;

[[noreturn]] void reject(const std::string& name, const std::string& reason) {
  throw std::invalid_argument("parameter '" + name + "': " + reason);
}

void check(const ParameterConstraint& constraint, ParameterRole role, bool positive) {
  const auto finite = [&](const std::optional<double>& value, const char* what) {
    if (value && !std::isfinite(*value)) reject(constraint.name, std::string(what) + " must be finite");
  };
  finite(constraint.fixed, "fixed value");
  if (constraint.fixed && constraint.prior) reject(constraint.name, "is fixed, so a prior says nothing of it");
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

constexpr std::size_t none = std::numeric_limits<std::size_t>::max();

/// The parameter each one is not below, or none.
std::vector<std::size_t> lesser_ones(const Structure& structure, const std::vector<ParameterConstraint>& of) {
  std::vector<std::size_t> lesser(of.size(), none);
  for (std::size_t i = 0; i < of.size(); ++i)
    if (!of[i].above.empty()) lesser[i] = structure.parameter_index(of[i].above);
  for (std::size_t i = 0; i < of.size(); ++i) {
    std::size_t at = i;
    for (std::size_t step = 0; lesser[at] != none; ++step) {
      at = lesser[at];
      if (step == of.size() || at == i) reject(of[i].name, "the order of parameters goes in a circle");
    }
    if (lesser[i] != none && structure.parameter_roles()[i] != structure.parameter_roles()[lesser[i]])
      reject(of[i].name, "is of another kind than '" + of[i].above + "', which it is not to be below");
  }
  return lesser;
}

/// Limits that follow from the order: those of the greater parameter hold for the lesser one from above, and the other
/// way round; a parameter that has no room left is held.
void tighten(std::vector<ParameterConstraint>& of, const Structure& structure, const std::vector<std::size_t>& lesser) {
  const auto room = [&](ParameterConstraint& each) {
    if (each.fixed || !each.lower || !each.upper || *each.lower < *each.upper) return;
    // Ends of a profile come here with rounding.
    if (*each.lower - *each.upper > 1e-9 * std::max(std::abs(*each.lower), std::abs(*each.upper)))
      reject(each.name, "the order of parameters and their limits leave no value for it");
    each.fixed = *each.upper;
    each.lower = each.upper = each.start = std::nullopt;
  };
  for (std::size_t pass = 0; pass < of.size(); ++pass) {
    for (std::size_t i = 0; i < of.size(); ++i) {
      if (lesser[i] == none) continue;
      ParameterConstraint &greater = of[i], &least = of[lesser[i]];
      if (least.name.empty()) least.name = structure.parameter_names()[lesser[i]];
      const auto top = greater.fixed ? greater.fixed : greater.upper;
      const auto bottom = least.fixed ? least.fixed : least.lower;
      if (least.fixed && greater.fixed && *least.fixed > *greater.fixed)
        reject(greater.name, "is fixed below '" + least.name + "', which it is not to be below");
      if (!least.fixed && top && !(least.upper && *least.upper <= *top)) least.upper = top;
      if (!greater.fixed && bottom && !(greater.lower && *greater.lower >= *bottom)) greater.lower = bottom;
      room(least);
      room(greater);
    }
  }
}

/// A deviation of the logarithm is one of a positive number.
bool has_prior_of_logarithm(const ParameterConstraint& constraint) {
  return constraint.prior && constraint.prior->relative;
}

/// Whether a coefficient is positive unless a lower limit is given.
bool is_positive(const Structure& structure, std::size_t i, const ParameterConstraint& constraint, bool blind_to_sign) {
  if (structure.parameter_roles()[i] != ParameterRole::coefficient) return false;
  return constraint.positive || has_prior_of_logarithm(constraint) || structure.parameter_keeps_sign()[i] ||
         (blind_to_sign && !structure.parameter_in_sum()[i]);
}

/// One constraint for each parameter, which says by `positive` what holds without a lower limit; those that the caller
/// does not constrain have no name.
std::vector<ParameterConstraint> by_parameter(const Structure& structure,
                                              const std::vector<ParameterConstraint>& constraints, bool blind_to_sign) {
  std::vector<ParameterConstraint> of(structure.parameter_names().size());
  for (const ParameterConstraint& constraint : constraints) {
    const std::size_t i = structure.parameter_index(constraint.name);
    if (!of[i].name.empty()) reject(constraint.name, "is constrained twice");
    const ParameterRole role = structure.parameter_roles()[i];
    of[i] = constraint;
    of[i].positive = is_positive(structure, i, constraint, blind_to_sign);
    check(constraint, role, of[i].positive);
    // A magnitude is blind to the sign of an outer gain, and a prior of the logarithm knows it: positive, even where
    // the model leaves it open.
    const bool sign_is_known =
        (blind_to_sign && !structure.parameter_in_sum()[i]) || has_prior_of_logarithm(constraint);
    if (of[i].positive && sign_is_known && constraint.lower == -infinity) of[i].lower.reset();
  }
  for (std::size_t i = 0; i < of.size(); ++i)
    if (of[i].name.empty()) of[i].positive = is_positive(structure, i, of[i], blind_to_sign);
  return of;
}

/// A parameter that is not below another takes its lower limit from that one.
void check_lower_limits(const std::vector<ParameterConstraint>& of, const std::vector<std::size_t>& lesser) {
  for (std::size_t i = 0; i < of.size(); ++i) {
    if (lesser[i] != none && of[i].lower && !of[lesser[i]].fixed && !(of[lesser[i]].lower >= of[i].lower))
      reject(of[i].name,
             "is not to be below '" + of[i].above + "', so '" + of[i].above + "' needs a lower limit at least as high");
  }
}

/// Orders first, on which the units of the others depend, and each entry behind that which it is above.
std::vector<std::size_t> in_sequence(const std::vector<ParameterMap::Free>& free) {
  std::vector<std::size_t> sequence;
  std::vector<bool> placed(free.size(), false);
  for (const bool orders : {true, false}) {
    for (std::size_t pass = 0; pass < free.size(); ++pass) {
      for (std::size_t k = 0; k < free.size(); ++k) {
        const bool waits = free[k].above && !placed[*free[k].above];
        if (placed[k] || waits || (free[k].role == ParameterRole::order) != orders) continue;
        sequence.push_back(k);
        placed[k] = true;
      }
    }
  }
  return sequence;
}

}  // namespace

ParameterMap::ParameterMap(const Structure& structure, const std::vector<ParameterConstraint>& constraints,
                           const DataScale& scale, bool blind_to_sign)
    : scale_(scale) {
  std::vector<ParameterConstraint> of = by_parameter(structure, constraints, blind_to_sign);
  const std::vector<std::size_t> lesser = lesser_ones(structure, of);
  check_lower_limits(of, lesser);
  tighten(of, structure, lesser);

  const std::size_t count = of.size();
  fixed_.assign(count, nan);
  start_.assign(count, nan);
  for (std::size_t i = 0; i < count; ++i) {
    if (of[i].fixed) fixed_[i] = start_[i] = *of[i].fixed;
    if (of[i].start) start_[i] = *of[i].start;
    if (structure.parameter_roles()[i] == ParameterRole::order) order_parameters_.push_back(i);
  }
  OrderLimits orders = limits_of_orders(structure, of);
  const Dimensions dimensions = dimensions_of(structure, orders.middle);
  tighten_orders(lesser, orders);

  std::vector<std::size_t> entry_of(count, none);
  for (std::size_t i = 0; i < count; ++i) {
    if (is_fixed(i)) continue;
    entry_of[i] = free_.size();
    add_entry(i, structure.parameter_roles()[i], of[i], orders, dimensions);
  }
  measure_from_lesser_ones(structure, lesser, entry_of);
  sequence_ = in_sequence(free_);
  scales_as_a_whole_ = scales_as_a_whole(structure, orders.middle, dimensions);
}

ParameterMap::OrderLimits ParameterMap::limits_of_orders(const Structure& structure,
                                                         const std::vector<ParameterConstraint>& of) const {
  const std::vector<bool> plain = orders_of_plain_powers(structure.expression());
  OrderLimits orders{std::vector<double>(of.size()), std::vector<double>(of.size()), std::vector<double>(of.size())};
  for (const std::size_t i : order_parameters_) {
    orders.lower[i] = of[i].lower.value_or(plain[i] || !structure.parameter_in_sum()[i] ? -4.0 : 0.0);
    orders.upper[i] = of[i].upper.value_or(std::max(4.0, orders.lower[i] + 4));
    orders.middle[i] = of[i].fixed.value_or((orders.lower[i] + orders.upper[i]) / 2);
  }
  return orders;
}

ParameterMap::Dimensions ParameterMap::dimensions_of(const Structure& structure,
                                                     const std::vector<double>& orders) const {
  // The frequency exponents are linear in the orders for every formula whose exponents are, so differences are exact.
  Dimensions dimensions{parameter_dimensions(structure, orders), {}};
  for (const std::size_t k : order_parameters_) {
    std::vector<double> shifted = orders;
    shifted[k] += 0.5;
    dimensions.at_shifted_order.push_back(parameter_dimensions(structure, shifted));
  }
  return dimensions;
}

bool ParameterMap::scales_as_a_whole(const Structure& structure, const std::vector<double>& orders,
                                     const Dimensions& dimensions) const {
  constexpr double rounding = 1e-9;
  const auto exponent = [&](std::size_t i) { return dimensions.at_middle[i].value_exponent; };
  for (std::size_t i = 0; i < fixed_.size(); ++i) {
    if (is_fixed(i) && std::abs(exponent(i)) > rounding) return false;
    for (const std::vector<ParameterDimension>& shifted : dimensions.at_shifted_order)
      if (std::abs(shifted[i].value_exponent - exponent(i)) > rounding) return false;
  }
  // What is measured from another one goes with that, and what is measured to a limit does not go far.
  for (const Free& entry : free_) {
    if (!entry.above) continue;
    const double own = exponent(entry.parameter), other = exponent(free_[*entry.above].parameter);
    if (std::abs(own - other) > rounding || (entry.most < infinity && std::abs(own) > rounding)) return false;
  }
  return scales_with_parameters(structure, orders);
}

void ParameterMap::tighten_orders(const std::vector<std::size_t>& lesser, OrderLimits& orders) const {
  for (std::size_t pass = 0; pass < lesser.size(); ++pass) {
    for (const std::size_t i : order_parameters_) {
      if (lesser[i] == none || is_fixed(i) || is_fixed(lesser[i])) continue;
      orders.lower[i] = std::max(orders.lower[i], orders.lower[lesser[i]]);
      orders.upper[lesser[i]] = std::min(orders.upper[lesser[i]], orders.upper[i]);
    }
  }
}

void ParameterMap::add_entry(std::size_t parameter, ParameterRole role, const ParameterConstraint& constraint,
                             const OrderLimits& orders, const Dimensions& dimensions) {
  Free entry{parameter, role, false, false, constraint.lower || constraint.upper, 0, 0, 0, 0, -infinity, infinity};
  slope_.emplace_back(order_parameters_.size(), 0.0);
  intercept_.push_back(0);
  switch (role) {
    case ParameterRole::order:
      entry.lower = entry.least = orders.lower[parameter];
      entry.upper = entry.most = orders.upper[parameter];
      break;
    case ParameterRole::delay:
      entry.frequency_exponent = intercept_.back() = -1;
      entry.lower = std::max(constraint.lower.value_or(0.0) * scale_.omega, -1e6);
      entry.upper = constraint.upper ? *constraint.upper * scale_.omega
                                     : 2 * std::numbers::pi * scale_.omega / scale_.omega_lower;
      entry.least = entry.lower / scale_.omega;
      entry.most = entry.upper / scale_.omega;
      break;
    case ParameterRole::coefficient:
      limit_coefficient(constraint, orders.middle, dimensions, entry);
      break;
  }
  free_.push_back(entry);
}

void ParameterMap::limit_coefficient(const ParameterConstraint& constraint, const std::vector<double>& orders,
                                     const Dimensions& dimensions, Free& entry) {
  const ParameterDimension& dimension = dimensions.at_middle[entry.parameter];
  std::vector<double>& slope = slope_.back();
  double& intercept = intercept_.back();
  entry.value_exponent = dimension.value_exponent;
  entry.frequency_exponent = intercept = dimension.frequency_exponent;
  const double lower = constraint.lower.value_or(constraint.positive ? 0.0 : -infinity);
  const double upper = constraint.upper.value_or(infinity);
  entry.logarithmic = lower >= 0 && (!constraint.lower || lower > 0);
  entry.either_sign = lower < 0;
  entry.least = lower;
  entry.most = upper;
  // Limits in the unit of the user bound theta only if that unit does not move with the orders.
  const bool movable = upper == infinity && (lower == 0 || lower == -infinity);
  for (std::size_t k = 0; k < order_parameters_.size() && movable; ++k) {
    const ParameterDimension& shifted = dimensions.at_shifted_order[k][entry.parameter];
    slope[k] = (shifted.frequency_exponent - dimension.frequency_exponent) / 0.5;
    intercept -= slope[k] * orders[order_parameters_[k]];
  }
  const double unit = movable ? 0 : entry.value_exponent * std::log(scale_.value) + intercept * std::log(scale_.omega);
  if (entry.logarithmic) {
    entry.lower = lower > 0 ? std::log(lower) - unit : -log_range;
    entry.upper = upper < infinity ? std::log(upper) - unit : std::max(log_range, entry.lower + 2 * log_range);
    if (!(lower > 0)) entry.lower = std::min(entry.lower, entry.upper - 2 * log_range);
  } else {
    const double widest = std::exp(log_range_of_sums);
    entry.lower = std::max(lower * std::exp(-unit), -widest);
    entry.upper = std::min(upper * std::exp(-unit), widest);
  }
}

void ParameterMap::measure_from_lesser_ones(const Structure& structure, const std::vector<std::size_t>& lesser,
                                            const std::vector<std::size_t>& entry_of) {
  const auto& names = structure.parameter_names();
  for (Free& entry : free_) {
    const std::size_t other = lesser[entry.parameter];
    if (other == none || is_fixed(other)) continue;
    entry.above = entry_of[other];
    if (entry.logarithmic != free_[*entry.above].logarithmic)
      reject(names[entry.parameter], "may have another sign than '" + names[other] + "', which it is not to be below");
    // A ratio has no dimension, and neither has a share of the way to a limit.
    if (entry.logarithmic || entry.most < infinity) entry.value_exponent = 0;
    entry.lower = 0;
    entry.upper = entry.most < infinity ? 1 : (entry.logarithmic ? 2 * log_range : std::exp(log_range));
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

double ParameterMap::way_up(std::size_t k, std::span<const double> parameters) const {
  const Free& entry = free_[k];
  const double from = parameters[free_[*entry.above].parameter];
  if (entry.most < infinity) return entry.logarithmic ? std::log(entry.most / from) : entry.most - from;
  if (entry.logarithmic) return 1;
  return std::exp(entry.value_exponent * std::log(scale_.value) + entry.frequency_exponent * std::log(scale_.omega));
}

double ParameterMap::value_at(std::size_t k, double theta, std::span<const double> parameters) const {
  const Free& entry = free_[k];
  if (entry.above) {
    const double from = parameters[free_[*entry.above].parameter], way = theta * way_up(k, parameters);
    return entry.logarithmic ? from * std::exp(way) : from + way;
  }
  if (entry.role == ParameterRole::order) return theta;
  const double unit = log_unit(k, parameters);
  return entry.logarithmic ? std::exp(theta + unit) : theta * std::exp(unit);
}

double ParameterMap::theta_at(std::size_t k, std::span<const double> parameters) const {
  const Free& entry = free_[k];
  const double value = parameters[entry.parameter];
  if (entry.above) {
    const double from = parameters[free_[*entry.above].parameter], way = way_up(k, parameters);
    return way > 0 ? (entry.logarithmic ? std::log(value / from) : value - from) / way : 0;
  }
  if (entry.role == ParameterRole::order) return value;
  const double unit = log_unit(k, parameters);
  return entry.logarithmic ? std::log(value) - unit : value * std::exp(-unit);
}

std::vector<double> ParameterMap::to_user(std::span<const double> theta) const {
  std::vector<double> parameters = fixed_;
  for (const std::size_t k : sequence_) parameters[free_[k].parameter] = value_at(k, theta[k], parameters);
  return parameters;
}

std::vector<double> ParameterMap::to_theta(std::span<const double> given) const {
  std::vector<double> parameters(given.begin(), given.end());
  // As many passes as exchanges of neighbours can bring a chain into order.
  for (std::size_t pass = 0; pass < free_.size(); ++pass) {
    for (const Free& entry : free_) {
      if (!entry.above) continue;
      double &value = parameters[entry.parameter], &other = parameters[free_[*entry.above].parameter];
      if (value < other) std::swap(value, other);
    }
  }
  std::vector<double> theta(free_.size());
  for (std::size_t k = 0; k < free_.size(); ++k)
    theta[k] = std::clamp(theta_at(k, parameters), free_[k].lower, free_[k].upper);
  return theta;
}

void ParameterMap::add_slopes(std::size_t k, double factor, std::span<const double> parameters,
                              std::size_t of_parameter, std::vector<Entry>& entries) const {
  const Free& entry = free_[k];
  const double value = parameters[entry.parameter];
  if (entry.above) {
    const double way = way_up(k, parameters), unit = entry.logarithmic ? value : 1;
    entries.push_back({of_parameter, k, factor * unit * way});
    const double from = entry.logarithmic ? parameters[free_[*entry.above].parameter] : 1;
    const double left = entry.most < infinity ? 1 - theta_at(k, parameters) : 1;
    add_slopes(*entry.above, factor * unit / from * left, parameters, of_parameter, entries);
    return;
  }
  if (entry.role == ParameterRole::order) {
    entries.push_back({of_parameter, k, factor});
    return;
  }
  entries.push_back({of_parameter, k, factor * (entry.logarithmic ? value : std::exp(log_unit(k, parameters)))});
  for (std::size_t j = 0; j < order_parameters_.size(); ++j) {
    if (slope_[k][j] == 0) continue;
    for (std::size_t order = 0; order < free_.size(); ++order) {
      if (free_[order].parameter != order_parameters_[j]) continue;
      add_slopes(order, factor * value * slope_[k][j] * std::log(scale_.omega), parameters, of_parameter, entries);
    }
  }
}

std::vector<ParameterMap::Entry> ParameterMap::jacobian_entries(std::span<const double> parameters) const {
  std::vector<Entry> entries;
  entries.reserve(2 * free_.size());
  for (std::size_t k = 0; k < free_.size(); ++k) add_slopes(k, 1, parameters, free_[k].parameter, entries);
  return entries;
}

Eigen::MatrixXd ParameterMap::jacobian(std::span<const double> parameters) const {
  Eigen::MatrixXd result =
      Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(parameter_count()), static_cast<Eigen::Index>(free_.size()));
  for (const Entry& entry : jacobian_entries(parameters)) {
    result(static_cast<Eigen::Index>(entry.parameter), static_cast<Eigen::Index>(entry.free)) += entry.derivative;
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

std::vector<ParameterMap::Entry> ParameterMap::centre_entries(std::size_t k, std::span<const double> parameters) const {
  std::vector<Entry> entries;
  const std::size_t parameter = free_[k].parameter;
  const double centre = centre_value(k, parameters);
  add_slopes(k, free_[k].role == ParameterRole::order ? 1 : std::pow(scale_.omega, -frequency_exponent(k, parameters)),
             parameters, parameter, entries);
  for (std::size_t j = 0; j < order_parameters_.size(); ++j) {
    for (std::size_t order = 0; order < free_.size() && slope_[k][j] != 0; ++order) {
      if (free_[order].parameter == order_parameters_[j])
        add_slopes(order, -centre * slope_[k][j] * std::log(scale_.omega), parameters, parameter, entries);
    }
  }
  return entries;
}

}  // namespace frac::detail
