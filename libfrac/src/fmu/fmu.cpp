// SPDX-License-Identifier: BSD-3-Clause
#include "frac/fmu.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <string>

#include "base/number_text.hpp"
#include "base/spelling.hpp"
#include "digital/c_export/tuned_header.hpp"
#include "fmu/fmu_runtime.hpp"
#include "fmu/fmu_text.hpp"

namespace frac {
namespace {

using detail::FmuParts;
using detail::number_text;
using Role = FmuVariable::Role;
constexpr detail::Spellings<FmiVersion, 2> version_names{{{FmiVersion::two, "2"}, {FmiVersion::three, "3"}}};
constexpr double any_step = std::numeric_limits<double>::quiet_NaN();

// What a recursion needs ahead of its header.
std::string sampling(double sample_time, const std::string& name, Precision precision) {
  return "#define SAMPLE_TIME " + number_text(sample_time) + "\ntypedef " + std::string(to_string(precision)) + " " +
         name + "_real;\n";
}

double finite(double limit, Precision precision) {
  const double most =
      precision == Precision::float_type ? std::numeric_limits<float>::max() : std::numeric_limits<double>::max();
  return std::clamp(limit, -most, most);
}

}  // namespace

std::string_view to_string(FmiVersion value) {
  return detail::spelling(version_names, value);
}

FmiVersion fmi_version_from_string(std::string_view name) {
  return detail::from_spelling(version_names, "version of FMI", name);
}

std::span<const FmiVersion> fmi_versions() {
  static constexpr auto all = detail::enumerators(version_names);
  return all;
}

Fmu fmu(const FractionalPidDesign& design, const FmuOptions& options) {
  const FractionalPidConfig& config = design.config();
  // A part that the design is without has no filter that a gain could bring to life.
  const auto role = [](double gain) { return gain != 0 ? Role::tunable_parameter : Role::fixed_parameter; };
  const std::string header =
      detail::tuned_c_header(design, {.name = "controller", .precision = options.precision, .comment = {}});
  const FmuParts parts{
      .variables =
          {{"setpoint", Role::input, "Set-point"},
           {"measured", Role::input, "Measured value"},
           {.name = "output", .role = Role::output, .description = "Output of the controller", .is_sampled = true},
           {.name = "unlimited", .role = Role::output, .description = "Output before the limits", .is_sampled = true},
           {"kp", Role::tunable_parameter, "Gain of the error", "", config.gains.kp},
           {"ki", role(config.gains.ki), "Gain of the fractional integral", "", config.gains.ki},
           {"kd", role(config.gains.kd), "Gain of the fractional derivative", "", config.gains.kd},
           {"minimum", Role::tunable_parameter, "Least output", "", finite(config.minimum, options.precision)},
           {"maximum", Role::tunable_parameter, "Largest output", "", finite(config.maximum, options.precision)},
           {"setpoint_weight", Role::tunable_parameter, "Share of the set-point in the proportional part", "",
            config.setpoint_weight},
           {"derivative_setpoint_weight", Role::tunable_parameter, "Share of the set-point in the derivative", "",
            config.derivative_setpoint_weight},
           {.name = "saturated",
            .role = Role::output,
            .description = "The last output was cut at a limit",
            .is_boolean = true},
           {.name = "bad_input",
            .role = Role::output,
            .description = "The last input was refused and the output held",
            .is_boolean = true}},
      .sample_time = config.sample_time,
      .values = sampling(config.sample_time, "controller", options.precision),
      .includes = {{"controller.h", header},
                   {"pid_model.h", detail::fmu_runtime::pid_model},
                   {"sampled_model.h", detail::fmu_runtime::sampled_model}}};
  return detail::fmu_of(parts, options);
}

Fmu fmu(const DigitalFilterDesign& design, const FmuOptions& options) {
  const std::string header =
      detail::vector_c_header(design, {.name = "filter", .precision = options.precision, .comment = {}});
  const FmuParts parts{.variables = {{"input", Role::input, "Input of the filter"},
                                     {.name = "output",
                                      .role = Role::output,
                                      .description = "Output of the filter",
                                      .is_sampled = true}},
                       .sample_time = design.sample_time,
                       .values = sampling(design.sample_time, "filter", options.precision),
                       .includes = {{"filter.h", header},
                                    {"filter_model.h", detail::fmu_runtime::filter_model},
                                    {"sampled_model.h", detail::fmu_runtime::sampled_model}}};
  return detail::fmu_of(parts, options);
}

Fmu fmu(const RationalModel& system, const FmuOptions& options) {
  constexpr std::size_t most_states = 200;
  if (system.delay > 0) {
    throw std::invalid_argument("fmu: the model has a dead time of " + number_text(system.delay) +
                                " s, which no state holds; a filter with a sample time has it");
  }
  if (system.states == 0 || system.states > most_states) {
    throw std::invalid_argument("fmu: the model has " + std::to_string(system.states) + " states; allowed is 1 to " +
                                std::to_string(most_states));
  }
  const StateSpace space = modal_form(system);
  const std::size_t n = space.states;
  std::vector<double> rows, columns, entries;
  for (std::size_t i = 0; i < n * n; ++i) {
    if (space.a[i] == 0) continue;
    const std::size_t row = i / n;
    rows.push_back(static_cast<double>(row));
    columns.push_back(static_cast<double>(i - row * n));
    entries.push_back(space.a[i]);
  }
  // A model of integrators alone has no entry, and C no array without one.
  if (entries.empty()) {
    rows = columns = {0};
    entries = {0};
  }
  using detail::c_array;
  const FmuParts parts{
      .variables = {{"input", Role::input, "Input of the model"}, {"output", Role::output, "Output of the model"}},
      .states = n,
      .sample_time = any_step,
      .values = "#define ENTRIES " + std::to_string(entries.size()) + "\n" + c_array("int", "entry_row", rows) +
                c_array("int", "entry_column", columns) + c_array("double", "entry_value", entries) +
                c_array("double", "from_input", space.b) + c_array("double", "to_output", space.c) +
                "static const double direct = " + number_text(space.d) + ";\n",
      .includes = {{"state_space_model.h", detail::fmu_runtime::state_space_model}}};
  return detail::fmu_of(parts, options);
}

}  // namespace frac
