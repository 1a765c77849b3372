// SPDX-License-Identifier: BSD-3-Clause
#include "report/ranking.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <limits>

#include "frac/parameter_units.hpp"
#include "report/figure.hpp"
#include "report/html.hpp"
#include "report/prose.hpp"

namespace report {

namespace {

std::string plain_number(double value, int digits) {
  char buffer[64];
  std::snprintf(buffer, sizeof buffer, "%.*g", digits, value);
  return buffer;
}

}  // namespace

std::string described(const frac::RankedFit& fit) {
  return fit.model_class == frac::ModelClass::fixed_curve ? fit.name + " (no free parameter)" : fit.fit.model;
}

std::string key_label(const frac::RankedFit& fit) {
  // A long formula would leave too little room for the plot.
  std::string text = described(fit);
  if (text.size() > 30) text = fit.name;
  const std::string safe = enhanced_escape(text);
  // "s\^a" becomes a raised a.
  std::string label;
  for (std::size_t i = 0; i < safe.size(); ++i) {
    if (safe.compare(i, 2, "\\^") != 0) {
      label += safe[i];
      continue;
    }
    const std::size_t begin = i + 2;
    std::size_t end = begin;
    while (end < safe.size() && (std::isalnum(static_cast<unsigned char>(safe[end])) != 0 || safe[end] == '.')) ++end;
    label += "^{" + safe.substr(begin, end - begin) + "}";
    i = end - 1;
  }
  return label;
}

std::string remark(const frac::ParameterEstimate& parameter) {
  if (parameter.fixed) return "fixed";
  if (parameter.from_other_component) return "from the other part";
  if (parameter.at_bound) return "at bound";
  if (!parameter.identified) return "not identified";
  return {};
}

std::string estimate_text(const frac::ParameterEstimate& parameter) {
  std::string text = parameter.name + " = " + plain_number(parameter.value, 4);
  if (const std::string note = remark(parameter); !note.empty()) return text + " (" + note + ")";
  if (std::isnan(parameter.ci95_lower)) return text;
  return text + " (" + plain_number(parameter.ci95_lower, 4) + " … " + plain_number(parameter.ci95_upper, 4) + ")";
}

namespace {

/// As it is shown: without noise it has no interval, and may not lack one.
frac::ParameterEstimate shown(frac::ParameterEstimate parameter, bool without_noise) {
  if (!without_noise) return parameter;
  parameter.identified = true;
  parameter.ci95_lower = parameter.ci95_upper = std::numeric_limits<double>::quiet_NaN();
  return parameter;
}

}  // namespace

std::string verdict_html(const frac::IdentificationResult& result) {
  std::string verdict = prose("ranking", "verdict", {{"sentence", escape_html(result.verdict_sentence)}});
  if (!result.notes.empty()) {
    std::string notes;
    for (const std::string& note : result.notes) notes += "<li>" + escape_html(note) + "</li>";
    verdict += "<ul>" + notes + "</ul>";
  }
  if (result.skipped.empty()) return verdict;
  const std::size_t count = result.skipped.size();
  std::string reasons;
  for (const std::string& skipped : result.skipped) reasons += "<li>" + escape_html(skipped) + "</li>";
  return verdict + "<details><summary>" +
         prose("ranking", "left-out",
               {{"count", std::to_string(count) + (count == 1 ? " structure" : " structures")}}) +
         "</summary><ul>" + reasons + "</ul></details>";
}

Table chosen_table(const std::string& name, const frac::IdentificationResult& result, const std::string& unit) {
  const frac::RankedFit& chosen = result.ranking.at(result.chosen);
  const bool without_noise = result.without_noise();
  Table table{name,
              without_noise ? prose("ranking", "chosen-without-noise", {{"model", html_formula(described(chosen))}})
                            : prose("ranking", "chosen", {{"model", html_formula(described(chosen))}}),
              {{"parameter", "parameter"},
               {"value", "value", 5},
               {"standard_error", "standard error", 2},
               {"ci95_lower", "95 % from", 5},
               {"ci95_upper", "to", 5},
               {"remark", "remark"},
               {"unit", "unit", 0, true, true}}};
  if (chosen.fit.parameters.empty()) return table;
  const std::vector<std::string> units = frac::parameter_units(frac::Structure(chosen.fit.model), unit);
  for (std::size_t i = 0; i < chosen.fit.parameters.size(); ++i) {
    const frac::ParameterEstimate& parameter = chosen.fit.parameters[i];
    // Of a fit over time, what the output shows at rest stands behind the parameters of the formula.
    const std::string in_unit = i < units.size() && units[i] != "1" ? units[i] : "";
    table.rows.push_back({parameter.name, parameter.value, parameter.standard_error, parameter.ci95_lower,
                          parameter.ci95_upper, remark(shown(parameter, without_noise)), in_unit});
  }
  for (std::size_t column = 2; column < 5; ++column) table.columns[column].on_page = !without_noise;
  // Nobody reads a column without words.
  for (std::size_t column = table.columns.size() - 2; column < table.columns.size(); ++column)
    table.columns[column].on_page = std::any_of(table.rows.begin(), table.rows.end(), [column](const auto& row) {
      return !std::get<std::string>(row[column]).empty();
    });
  return table;
}

Table ranking_table(const std::string& name, const std::string& caption, const frac::IdentificationResult& result) {
  const bool without_noise = result.without_noise();
  Table table{name,
              caption,
              {{"rank", "rank"},
               {"model", "structure", 0, true, true},
               {"class", "class"},
               {"free_parameters", "free"},
               {"aicc", "AICc", 5, false},
               {"delta_aicc", "ΔAICc", 4},
               {"akaike_weight", "weight", 3, false},
               {"rms_relative", "rms residual", 3},
               {"largest_relative", "largest", 3, false},
               {"parameters", "parameters (95 % interval)", 0, false},
               {"remark", "remark"}}};
  for (std::size_t i = 0; i < result.ranking.size(); ++i) {
    const frac::RankedFit& ranked = result.ranking[i];
    std::string parameters;
    const auto append = [&parameters](const std::string& part) {
      parameters += (parameters.empty() ? "" : "; ") + part;
    };
    for (const auto& parameter : ranked.fit.parameters) append(estimate_text(shown(parameter, without_noise)));
    std::string note = i == result.chosen                             ? "chosen"
                       : ranked.lack_of_fit.adequate || without_noise ? ""
                                                                      : "misses the data";
    if (ranked.fit.termination != frac::FitTermination::converged) {
      append(ranked.fit.message);
      note += (note.empty() ? "" : ", ") + std::string(frac::to_string(ranked.fit.termination));
    }
    if (i == result.chosen) append("[chosen]");
    table.rows.push_back({static_cast<double>(i + 1), ranked.from_family ? ranked.name : described(ranked),
                          std::string(frac::to_string(ranked.model_class)),
                          static_cast<double>(ranked.fit.free_parameters), ranked.fit.aicc, ranked.delta_aicc,
                          ranked.akaike_weight, ranked.fit.rms, ranked.fit.max_residual, parameters, note});
  }
  table.columns[5].on_page = !without_noise;
  table.rows_on_page = 12;
  return table;
}

Table parameter_table(const std::string& name, const std::string& caption, const frac::IdentificationResult& result) {
  Table table{name,
              caption,
              {{"rank", "rank"},
               {"model", "structure", 0, true, true},
               {"parameter", "parameter"},
               {"value", "value"},
               {"standard_error", "standard error"},
               {"ci95_lower", "95 % from"},
               {"ci95_upper", "to"},
               {"remark", "remark"}}};
  table.in_results = false;
  table.folded = true;
  for (std::size_t column = 4; column < 7; ++column) table.columns[column].on_page = !result.without_noise();
  for (std::size_t i = 0; i < result.ranking.size(); ++i) {
    for (const auto& parameter : result.ranking[i].fit.parameters) {
      table.rows.push_back({static_cast<double>(i + 1), described(result.ranking[i]), parameter.name, parameter.value,
                            parameter.standard_error, parameter.ci95_lower, parameter.ci95_upper,
                            remark(shown(parameter, result.without_noise()))});
    }
  }
  return table;
}

void add_ranking(Section& section, const std::string& id, const frac::IdentificationResult& result,
                 const RankingWords& words) {
  section.add(ranking_table(words.ranking_name, words.ranking_caption, result));
  section.add(parameter_table(words.parameters_name, words.parameters_caption, result));
  section.fact("verdict_" + id, std::string(frac::to_string(result.verdict)));
  section.fact("evidence_aicc_" + id, result.evidence);
}

const frac::ParameterEstimate* find_parameter(const frac::FitResult& fit, const std::string& name) {
  const auto found = std::find_if(fit.parameters.begin(), fit.parameters.end(),
                                  [&name](const frac::ParameterEstimate& parameter) { return parameter.name == name; });
  return found == fit.parameters.end() ? nullptr : &*found;
}

}  // namespace report
