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

Json derived_json(const std::vector<frac::DerivedEstimate>& derived) {
  Json list = Json::array();
  for (const auto& each : derived)
    list.push_back({{"name", each.name},
                    {"formula", each.formula},
                    {"value", each.value},
                    {"standard_error", each.standard_error},
                    {"ci95", {each.ci95_lower, each.ci95_upper}}});
  return list;
}

std::string derived_table(const std::vector<frac::DerivedEstimate>& derived) {
  if (derived.empty()) return {};
  AlignedTable table({"derived", "value", "standard error", "95 % interval", "formula"}, AlignedTable::Last::remark);
  for (const auto& each : derived)
    table.add({each.name, short_number(each.value), short_number(each.standard_error),
               each.ci95_lower == each.ci95_lower ? interval(each.ci95_lower, each.ci95_upper) : "-", each.formula});
  return table.text() + "\n";
}

}  // namespace fracfit
