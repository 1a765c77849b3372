// SPDX-License-Identifier: BSD-3-Clause
#include "options/fit_record.hpp"

#include <cmath>
#include <limits>

#include "io/data_error.hpp"
#include "io/input_text.hpp"
#include "output/json.hpp"

namespace fracfit {
namespace {

[[noreturn]] void refuse(const std::string& file, const std::string& what, const char* command = "fit") {
  throw io::DataError(file, 0, 0, what + "; expected the JSON of fracfit " + command);
}

const Json& member(const std::string& file, const Json& object, const char* name) {
  const Json* found = object.find(name);
  if (found == nullptr) refuse(file, std::string("has no member '") + name + "'");
  return *found;
}

const Json::Array& list(const std::string& file, const Json& object, const char* name) {
  const auto* entries = member(file, object, name).entries();
  if (entries == nullptr) refuse(file, std::string("has no list '") + name + "'");
  return *entries;
}

double finite_number(const std::string& file, const Json& object, const char* name) {
  const auto number = member(file, object, name).number();
  if (!number || !std::isfinite(*number)) refuse(file, std::string("has no number '") + name + "'");
  return *number;
}

std::string text(const std::string& file, const Json& object, const char* name) {
  const std::string* found = member(file, object, name).text();
  if (found == nullptr) refuse(file, std::string("has no text '") + name + "'");
  return *found;
}

}  // namespace

frac::FitResult read_fit(const std::string& file) {
  const auto json = Json::parse(*io::input_text(file));
  if (!json || !json->is_object()) refuse(file, "is no JSON object");
  frac::FitResult fit{};
  fit.model = text(file, *json, "model");
  fit.residuals = static_cast<std::size_t>(finite_number(file, *json, "residuals"));
  fit.free_parameters = static_cast<std::size_t>(finite_number(file, *json, "free_parameters"));
  for (const Json& each : list(file, *json, "parameters")) {
    frac::ParameterEstimate estimate{};
    estimate.name = text(file, each, "name");
    estimate.value = finite_number(file, each, "value");
    estimate.standard_error =
        member(file, each, "standard_error").number().value_or(std::numeric_limits<double>::quiet_NaN());
    fit.parameters.push_back(std::move(estimate));
  }
  const auto& rows = list(file, *json, "correlation");
  const std::size_t count = fit.parameters.size();
  if (rows.size() != count) refuse(file, "has a correlation of another size than its parameters");
  for (std::size_t i = 0; i < count; ++i) {
    const auto* row = rows[i].entries();
    if (row == nullptr || row->size() != count) refuse(file, "has a correlation of another size than its parameters");
    auto& covariance = fit.covariance.emplace_back();
    for (std::size_t j = 0; j < count; ++j)
      covariance.push_back((*row)[j].number().value_or(std::numeric_limits<double>::quiet_NaN()) *
                           fit.parameters[i].standard_error * fit.parameters[j].standard_error);
  }
  return fit;
}

frac::NextMeasurement read_next_measurement(const std::string& file) {
  const auto json = Json::parse(*io::input_text(file));
  if (!json || !json->is_object()) refuse(file, "is no JSON object", "identify");
  const Json* next = json->find("next_measurement");
  if (next == nullptr) refuse(file, "has no member 'next_measurement'", "identify");
  if (!next->is_object())
    throw io::DataError(file, 0, 0, "asks for no next measurement: its verdict is " + text(file, *json, "verdict"));
  frac::NextMeasurement found{finite_number(file, *next, "lower"),
                              finite_number(file, *next, "upper"),
                              static_cast<std::size_t>(finite_number(file, *next, "points")),
                              finite_number(file, *next, "accuracy"),
                              finite_number(file, *next, "relative_accuracy"),
                              finite_number(file, *next, "expected_evidence")};
  if (!(found.lower > 0 && found.lower <= found.upper) || found.points < 1)
    refuse(file, "has a next measurement of no band or no points", "identify");
  return found;
}

}  // namespace fracfit
