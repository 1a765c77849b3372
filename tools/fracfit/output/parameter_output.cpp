// SPDX-License-Identifier: BSD-3-Clause
#include "output/parameter_output.hpp"

#include "output/aligned_table.hpp"

namespace fracfit {

std::string interval(double lower, double upper) {
  return short_number(lower) + " .. " + short_number(upper);
}

std::string parameter_state(const frac::ParameterEstimate& parameter) {
  if (parameter.fixed) return "fixed";
  if (parameter.at_bound) return "at its bound";
  if (!parameter.identified) return "not identified";
  return "";
}

Json parameter_json(const frac::ParameterEstimate& parameter) {
  return {{"name", parameter.name},
          {"value", parameter.value},
          {"standard_error", parameter.standard_error},
          {"ci95", {parameter.ci95_lower, parameter.ci95_upper}},
          {"interval", frac::to_string(parameter.interval)},
          {"widening", parameter.widening},
          {"identified", parameter.identified},
          {"at_bound", parameter.at_bound},
          {"fixed", parameter.fixed}};
}

}  // namespace fracfit
