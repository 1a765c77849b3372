// SPDX-License-Identifier: BSD-3-Clause
#include "fit_request.hpp"

#include <limits>
#include <stdexcept>
#include <string>
#include <tuple>
#include <type_traits>
#include <utility>

#include "arrays.hpp"
#include "described.hpp"
#include "frac/identification/constraints.hpp"
#include "frac/identification/describe.hpp"
#include "frac/identification/validate.hpp"
#include "realisation_choice.hpp"

namespace frac {

// For python::read().
static void from_text(const std::string& text, FitTermination& value) {
  value = fit_termination_from_string(text);
}
static void from_text(const std::string& text, IntervalKind& value) {
  value = interval_kind_from_string(text);
}

}  // namespace frac

namespace python {
namespace {

using Prior = std::tuple<double, double, bool>;
using Constraint = std::tuple<std::string, std::optional<double>, std::optional<double>, std::optional<double>,
                              std::optional<double>, std::optional<Prior>, std::string, bool>;

template <typename T>
void take(T& value, const py::dict& given, const char* key) {
  const py::handle found = PyDict_GetItemString(given.ptr(), key);
  if (!found || found.is_none()) return;
  try {
    value = found.cast<T>();
  } catch (const py::cast_error&) {
    throw std::invalid_argument(std::string(key) + " is " + py::repr(found).cast<std::string>() +
                                (std::is_same_v<T, std::string> ? "; expected a text"
                                 : std::is_same_v<T, bool> || std::is_same_v<T, std::optional<bool>>
                                     ? "; expected True or False"
                                     : "; expected a number"));
  }
}

std::string text_of(const py::dict& given, const char* key) {
  std::string text;
  take(text, given, key);
  return text;
}

}  // namespace

frac::FitOptions fit_options(const py::dict& given) {
  frac::FitOptions options;
  if (const auto text = text_of(given, "component"); !text.empty())
    options.component = frac::component_from_string(text);
  if (const auto text = text_of(given, "weight"); !text.empty()) options.weight = frac::weight_from_string(text);
  if (const auto text = text_of(given, "loss"); !text.empty()) options.loss = frac::loss_from_string(text);
  take(options.noise_floor, given, "noise_floor");
  take(options.loss_scale, given, "loss_scale");
  take(options.seed, given, "seed");
  take(options.global_start, given, "global_start");
  take(options.without_noise, given, "without_noise");
  take(options.assumptions.stable, given, "stable");
  take(options.assumptions.dead_time, given, "dead_time");
  take(options.assumptions.passive, given, "passive");
  if (given.contains("realisation")) options.realisation = realisation_of(given["realisation"].cast<py::dict>());
  if (given.contains("constraints")) options.constraints = constraints_from(given["constraints"].cast<py::list>());
  return options;
}

frac::TimeFitOptions time_fit_options(const py::dict& given) {
  frac::TimeFitOptions options;
  if (const auto text = text_of(given, "loss"); !text.empty()) options.loss = frac::loss_from_string(text);
  take(options.offset, given, "offset");
  take(options.trend, given, "trend");
  take(options.earlier_input, given, "earlier_input");
  if (const auto text = text_of(given, "noise"); !text.empty()) options.noise = frac::record_noise_from_string(text);
  take(options.loss_scale, given, "loss_scale");
  take(options.seed, given, "seed");
  take(options.global_start, given, "global_start");
  if (given.contains("constraints")) options.constraints = constraints_from(given["constraints"].cast<py::list>());
  return options;
}

bool keeps_outliers(const py::dict& given) {
  const auto text = text_of(given, "outliers");
  if (text == "keep") return true;
  if (!text.empty() && text != "leave-out")
    throw std::invalid_argument("outliers \"" + text + "\": expected one of leave-out, keep");
  return false;
}

std::vector<std::string> settle_component(frac::FitOptions& options, const frac::FrequencyResponseData& data) {
  const frac::Component fitted = frac::fitted_component(data, options.component);
  if (fitted == std::exchange(options.component, fitted)) return {};
  return {std::string(frac::imaginary_part_alone)};
}

std::vector<std::string> notes_of(const frac::ScreenedData& points) {
  if (points.left_out().empty()) return {};
  return {points.sentence() + ", and taken in with outliers=\"keep\""};
}

std::vector<std::string> note_of_sign(const frac::FrequencyResponseData& data, const frac::FitOptions& options) {
  if (options.component != frac::Component::both || options.weight == frac::Weight::repeats) return {};
  const auto found = frac::validate(data, {.most_points = frac::points_in_passing});
  if (!found.reversed_sign) return {};
  return {found.summary() + "; np.conj(response) has the other sign"};
}

frac::FrequencyResponseData spectrum_of(const py::dict& data) {
  return {vector_of(data["omega"].cast<Reals>()), vector_of(data["response"].cast<Complexes>()),
          vector_of(data["sigma"].cast<Reals>()),
          data["frequency_unit"].cast<std::string>() == to_string(frac::FrequencyUnit::hertz)
              ? frac::FrequencyUnit::hertz
              : frac::FrequencyUnit::rad_per_s};
}

frac::TimeResponseData record_of(const py::dict& data) {
  const frac::TimeResponseData record(vector_of(data["time"].cast<Reals>()), vector_of(data["input"].cast<Reals>()),
                                      vector_of(data["output"].cast<Reals>()), vector_of(data["sigma"].cast<Reals>()),
                                      frac::hold_from_string(data["hold"].cast<std::string>()),
                                      data["input_at_rest"].cast<double>());
  if (data["kept"].is_none()) return record;
  const auto kept = data["kept"].cast<py::array_t<std::int64_t, py::array::c_style>>();
  return record.observed_at({kept.data(), kept.data() + kept.size()});
}

std::vector<frac::FixedCurve> fixed_curves(const py::dict& given, std::size_t points) {
  std::vector<frac::FixedCurve> curves;
  for (const auto& [name, value] : given) {
    curves.push_back({name.cast<std::string>(), vector_of(value.cast<Complexes>())});
    if (curves.back().value.size() != points)
      throw std::invalid_argument("curve " + curves.back().name + " has " + std::to_string(curves.back().value.size()) +
                                  " values; expected one for each of the " + std::to_string(points) + " frequencies");
  }
  return curves;
}

std::vector<frac::ParameterConstraint> constraints_of(const frac::NamedModel& model, const py::dict& given) {
  auto constraints = model.constraints;
  constexpr double infinity = std::numeric_limits<double>::infinity();
  // Limits and a start are the model's own here: those of the caller come below.
  for (const auto& [name, value] : given["fixed"].cast<py::dict>())
    frac::constraint_of(constraints, name.cast<std::string>()) = {
        name.cast<std::string>(), value.cast<double>(), {}, {}, {}};
  for (const auto& [name, range] : given["bounds"].cast<py::dict>()) {
    const auto [lower, upper] = range.cast<std::pair<std::optional<double>, std::optional<double>>>();
    auto& constraint = frac::constraint_of(constraints, name.cast<std::string>());
    const bool is_free = !lower && !upper;
    if (lower || is_free) constraint.lower = lower.value_or(-infinity);
    if (upper || is_free) constraint.upper = upper.value_or(infinity);
  }
  for (const auto& [name, value] : given["start"].cast<py::dict>()) {
    auto& constraint = frac::constraint_of(constraints, name.cast<std::string>());
    if (!constraint.fixed) constraint.start = value.cast<double>();
  }
  for (const auto& [name, told] : given["prior"].cast<py::dict>()) {
    const auto [value, deviation, relative] = told.cast<Prior>();
    frac::constraint_of(constraints, name.cast<std::string>()).prior = {value, deviation, relative};
  }
  for (const auto& chain : given["constraint"].cast<std::vector<std::vector<std::string>>>()) {
    for (std::size_t i = 1; i < chain.size(); ++i) {
      auto& constraint = frac::constraint_of(constraints, chain[i]);
      if (!constraint.above.empty())
        throw std::invalid_argument("constraint: " + chain[i] + " is above " + constraint.above +
                                    " already; write one chain, A<B<C");
      constraint.above = chain[i - 1];
    }
  }
  return constraints;
}

py::list list_of(const std::vector<frac::Advice>& advice) {
  py::list list;
  for (const auto& each : advice)
    list.append(py::cast(std::pair(std::string(frac::to_string(each.remedy)), each.parameters)));
  return list;
}

py::list list_of(const std::vector<frac::ParameterConstraint>& constraints) {
  py::list list;
  for (const auto& each : constraints) {
    std::optional<Prior> prior;
    if (each.prior) prior = {each.prior->value, each.prior->deviation, each.prior->relative};
    list.append(py::cast(
        Constraint(each.name, each.fixed, each.lower, each.upper, each.start, prior, each.above, each.positive)));
  }
  return list;
}

std::vector<frac::ParameterConstraint> constraints_from(const py::list& list) {
  std::vector<frac::ParameterConstraint> constraints;
  for (const auto& each : list) {
    const auto [name, fixed, lower, upper, start, prior, above, positive] = each.cast<Constraint>();
    constraints.push_back({name, fixed, lower, upper, start, {}, above, positive});
    if (prior) constraints.back().prior = {std::get<0>(*prior), std::get<1>(*prior), std::get<2>(*prior)};
  }
  return constraints;
}

py::dict dict_of_fit(const frac::FitResult& result) {
  py::dict dict = dict_of(result);
  dict["advice"] = list_of(result.advice);
  return dict;
}

frac::FitResult fit_result_from(const py::dict& dict) {
  frac::FitResult result{};
  read(dict, result);
  for (const auto& each : dict["advice"].cast<py::list>()) {
    const auto [remedy, parameters] = each.cast<std::pair<std::string, std::vector<std::string>>>();
    result.advice.push_back({frac::remedy_from_string(remedy), parameters});
  }
  return result;
}

}  // namespace python
