// SPDX-License-Identifier: BSD-3-Clause
#include "identification/data/physical_properties.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

#include "base/short_text.hpp"
#include "frac/stability.hpp"

namespace frac::detail {
namespace {

constexpr double decades_beyond = 3;
constexpr double rounding = 1e-9;  // of |G|: a real part of that size is 0

/// Sums of powers with positive coefficients and orders less than 2 apart vanish nowhere in the right half plane: there
/// their terms, over the lowest one, point into directions less than pi apart.
bool is_plainly_stable(const std::vector<PowerTerm>& sum) {
  double lowest = sum.front().order, highest = lowest;
  for (const PowerTerm& term : sum) {
    if (!(term.coefficient > 0)) return false;
    lowest = std::min(lowest, term.order);
    highest = std::max(highest, term.order);
  }
  return highest - lowest < 2;
}

bool is_plainly_stable(const FractionalTransferFunction& model) {
  const auto& factors = model.denominator_factors();
  if (factors.empty()) return is_plainly_stable(model.denominator());
  return std::all_of(factors.begin(), factors.end(),
                     [](const PowerFactor& factor) { return is_plainly_stable(factor.sum); });
}

std::vector<double> values_of(const FitResult& fit) {
  std::vector<double> values;
  for (const ParameterEstimate& estimate : fit.parameters) values.push_back(estimate.value);
  return values;
}

}  // namespace

std::optional<bool> is_unstable(const Structure& structure, std::span<const double> parameters) {
  try {
    const FractionalTransferFunction model = to_transfer_function(structure, parameters);
    if (is_plainly_stable(model)) return false;
    const Stability stability = analyse_stability(model).stability;
    if (stability == Stability::undetermined) return std::nullopt;
    return stability == Stability::unstable;
  } catch (const std::invalid_argument&) {
    return std::nullopt;
  }
}

std::optional<bool> is_unstable(const FitResult& fit) {
  // A given curve is no formula, and over time the output at rest and its drift are parameters too.
  try {
    const Structure structure(fit.model);
    std::vector<double> values = values_of(fit);
    const std::size_t count = structure.parameter_names().size();
    if (values.size() < count) return std::nullopt;
    values.resize(count);
    return is_unstable(structure, values);
  } catch (const std::invalid_argument&) {
    return std::nullopt;
  }
}

bool has_dead_time(const Structure& structure) {
  const auto& roles = structure.parameter_roles();
  return std::find(roles.begin(), roles.end(), ParameterRole::delay) != roles.end();
}

double longest_dead_time(const FrequencyResponseData& data) {
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 1; i < data.size(); ++i) {
    const double spacing = data.omega()[i] - data.omega()[i - 1];
    if (spacing > 0) nearest = std::min(nearest, spacing);
  }
  return std::numbers::pi / nearest;
}

std::optional<ActivePlace> active_place(const FitResult& fit, const FrequencyResponseData& data) {
  constexpr int points = 600;
  const double first = std::log(data.omega().front()) - decades_beyond * std::log(10.0);
  const double last = std::log(data.omega().back()) + decades_beyond * std::log(10.0);
  std::vector<double> omega = data.omega();
  for (int i = 0; i < points; ++i) omega.push_back(std::exp(first + (last - first) * i / (points - 1)));
  const std::vector<std::complex<double>> value = fitted_response(fit, ExactRealisation{}, omega);
  std::optional<ActivePlace> worst;
  for (std::size_t i = 0; i < omega.size(); ++i) {
    const double share = -value[i].real() / std::abs(value[i]);
    if (share > rounding && (!worst || share > worst->share)) worst = {omega[i], share};
  }
  return worst;
}

std::string remark_on_passivity(const FitResult& fit, const FrequencyResponseData& data) {
  const auto place = active_place(fit, data);
  const auto in_file = [&](double omega) { return four_digits(in_unit(omega, data.frequency_unit())); };
  const std::string unit(to_string(data.frequency_unit()));
  if (place) {
    return " The model is not passive: at " + in_file(place->omega) + " " + unit + " its real part is negative, " +
           four_digits(100 * place->share) + " % of its size.";
  }
  const double beyond = std::pow(10.0, decades_beyond);
  return " The real part of the model is nowhere negative from " + in_file(data.omega().front() / beyond) + " to " +
         in_file(data.omega().back() * beyond) + " " + unit + ".";
}

}  // namespace frac::detail
