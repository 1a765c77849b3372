// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "frac/fmu.hpp"

namespace frac::detail {

/// What a unit is made of besides the functions of FMI.
struct FmuParts {
  std::vector<FmuVariable> variables;
  /// States of the continuous system, for model exchange; 0: co-simulation only.
  std::size_t states = 0;
  /// Event indicators of the model, for model exchange; where there are some, states may jump at an event.
  std::size_t events = 0;
  /// Largest step that makes sense, s; NaN where any does.
  double sample_time;
  /// C text ahead of the model: numbers, and headers it includes.
  std::string values;
  /// Files of the model and what it includes, in the order in which they are included.
  std::vector<std::pair<std::string, std::string_view>> includes;
};

/// @throws std::invalid_argument  the name.
[[nodiscard]] Fmu fmu_of(const FmuParts& parts, const FmuOptions& options);

/// static const double name[n] = {...};
[[nodiscard]] std::string c_array(const std::string& type, const std::string& name, const std::vector<double>& values);

}  // namespace frac::detail
