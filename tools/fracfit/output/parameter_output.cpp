// SPDX-License-Identifier: BSD-3-Clause
#include "output/parameter_output.hpp"

#include <algorithm>
#include <cmath>

#include "frac/identification/describe.hpp"
#include "frac/parameter_units.hpp"
#include "io/unit_name.hpp"
#include "output/described.hpp"

namespace fracfit {

ParameterUnits::ParameterUnits(const std::string& formula, const std::string& value_unit) {
  const frac::Structure structure(formula);
  const std::vector<std::string> units = frac::parameter_units(structure, io::written_unit(value_unit));
  for (std::size_t i = 0; i < units.size(); ++i) units_.emplace(structure.parameter_names()[i], units[i]);
}

std::string ParameterUnits::of(const std::string& name) const {
  const auto found = units_.find(name);
  return found == units_.end() ? "" : found->second;
}

std::string ParameterUnits::shown(const std::string& name) const {
  const std::string unit = of(name);
  return unit == "1" ? "" : unit;
}

std::string interval(double lower, double upper) {
  const ShownInterval shown = shown_interval(lower, lower, upper);
  return shown.lower + " .. " + shown.upper;
}

std::string estimate_table(const std::string& title, const std::vector<frac::ParameterEstimate>& estimates,
                           const ParameterUnits& units, bool without_noise) {
  const bool has_units = std::any_of(estimates.begin(), estimates.end(),
                                     [&](const auto& each) { return !units.shown(each.name).empty(); });
  const auto with_unit = [&](std::vector<std::string> cells, const std::string& unit) {
    if (has_units) cells.insert(cells.end() - 1, unit);
    return cells;
  };
  AlignedTable table(
      with_unit(without_noise ? std::vector<std::string>{title, "value", ""}
                              : std::vector<std::string>{title, "value", "standard error", "95 % interval", ""},
                "unit"),
      AlignedTable::Last::remark);
  for (const auto& each : estimates) {
    const std::string state = parameter_state(each, without_noise);
    const auto [value, standard_error, interval] = estimate_cells(each, !std::isnan(each.ci95_lower) && !each.fixed);
    table.add(with_unit(without_noise ? std::vector<std::string>{each.name, short_number(each.value), state}
                                      : std::vector<std::string>{each.name, value, standard_error, interval, state},
                        units.shown(each.name)));
  }
  return table.text();
}

std::string remark_on_limits(const std::vector<frac::ParameterEstimate>& estimates) {
  std::string text;
  for (const auto& each : estimates) {
    const bool is_obvious = std::isinf(each.upper_limit) && (each.lower_limit == 0 || std::isinf(each.lower_limit));
    if (each.fixed || !each.limits_given || is_obvious) continue;
    text += (text.empty() ? "limits: " : ", ") + each.name + " " + short_number(each.lower_limit) + " .. " +
            short_number(each.upper_limit);
  }
  return text.empty() ? text : text + "\n";
}

std::string with_advice(std::string message, const std::vector<frac::Advice>& advice) {
  for (const frac::Advice& each : advice) {
    switch (each.remedy) {
      case frac::Remedy::give_limits:
        message += " Others are given by --bound " + each.parameters.front() + "=LOW:HIGH.";
        break;
      case frac::Remedy::estimate_trend:
        message += " --trend estimates a drift.";
        break;
      case frac::Remedy::estimate_earlier_input:
        message += " --earlier-input estimates the input before the record.";
        break;
      case frac::Remedy::hold_zero_order:
        message += " --hold zero-order takes the input so.";
        break;
      case frac::Remedy::hold_first_order:
        message += " --hold first-order takes the input so.";
        break;
      case frac::Remedy::hold_band_limited:
        message += " --hold band-limited takes the input so.";
        break;
    }
  }
  return message;
}

Json parameter_json(const frac::ParameterEstimate& parameter, const ParameterUnits& units) {
  Json json = json_of(parameter);
  Json& unit = json["unit"] = nullptr;
  if (const std::string found = units.of(parameter.name); !found.empty()) unit = found;
  return json;
}

std::string prior_text(const frac::PriorEstimate& prior) {
  const double shown = prior.prior.relative ? 100 * prior.prior.deviation : prior.prior.deviation;
  return prior.name + " = " + short_number(prior.prior.value) + " +- " + short_number(shown) +
         (prior.prior.relative ? " %" : "");
}

std::string prior_table(const std::vector<frac::PriorEstimate>& priors) {
  if (priors.empty()) return {};
  AlignedTable table({"prior", "estimate off by", "data off by", "prior tells"});
  for (const auto& each : priors) {
    table.add({prior_text(each), short_number(each.distance, 3), short_number(each.conflict, 3),
               short_number(100 * each.share, 3) + " %"});
  }
  return table.text() +
         "Estimates are off in standard deviations of the prior, data in those of both; beyond 2.6 they contradict "
         "it.\n\n";
}

std::string derived_table(const std::vector<frac::DerivedEstimate>& derived, bool without_noise) {
  if (derived.empty()) return {};
  AlignedTable table(without_noise
                         ? std::vector<std::string>{"derived", "value", "formula"}
                         : std::vector<std::string>{"derived", "value", "standard error", "95 % interval", "formula"},
                     AlignedTable::Last::remark);
  for (const auto& each : derived) {
    if (without_noise) {
      table.add({each.name, short_number(each.value), each.formula});
      continue;
    }
    const auto [value, standard_error, interval] = estimate_cells(each, !std::isnan(each.ci95_lower));
    table.add({each.name, value, standard_error, interval, each.formula});
  }
  return table.text() + "\n";
}

}  // namespace fracfit
