// SPDX-License-Identifier: BSD-3-Clause
#include "output/joint_fit_output.hpp"

#include <algorithm>

#include "io/number.hpp"
#include "output/aligned_table.hpp"
#include "output/document.hpp"
#include "output/json.hpp"
#include "output/parameter_output.hpp"

namespace fracfit {
namespace {

bool is_shared(const frac::JointFitResult& result, const std::string& name) {
  return std::any_of(result.shared.begin(), result.shared.end(),
                     [&](const frac::ParameterEstimate& each) { return each.name == name; });
}

/// Parameters of a curve that are its own.
std::vector<frac::ParameterEstimate> own_of(const frac::JointFitResult& result, const frac::JointCurveResult& curve) {
  std::vector<frac::ParameterEstimate> own;
  for (const auto& parameter : curve.parameters)
    if (!parameter.fixed && !is_shared(result, parameter.name)) own.push_back(parameter);
  return own;
}

std::vector<frac::DerivedEstimate> derived_of(const JointRun& run, const frac::JointFitResult& result,
                                              const frac::JointCurveResult& curve) {
  std::vector<double> values;
  for (const auto& parameter : curve.parameters) values.push_back(parameter.value);
  std::vector<frac::DerivedEstimate> derived;
  for (const auto& each : run.derived) derived.push_back(each.at(values, curve.covariance, result.half_width));
  return derived;
}

std::string shared_table(const frac::JointFitResult& result) {
  AlignedTable table({"shared", "value", "standard error", "95 % interval", ""}, AlignedTable::Last::remark);
  for (const auto& parameter : result.shared)
    table.add(
        {parameter.name, short_number(parameter.value), short_number(parameter.standard_error),
         parameter.ci95_lower == parameter.ci95_lower ? interval(parameter.ci95_lower, parameter.ci95_upper) : "-",
         parameter_state(parameter)});
  return table.text();
}

std::string curve_table(const JointRun& run, const frac::JointFitResult& result) {
  std::vector<std::string> heading{"curve"};
  for (const auto& parameter : own_of(result, result.curves.front())) {
    heading.push_back(parameter.name);
    heading.emplace_back("+-");
  }
  for (const auto& each : run.derived) {
    heading.push_back(each.name());
    heading.emplace_back("+-");
  }
  for (const char* name : {"rms", "alone", ""}) heading.emplace_back(name);
  AlignedTable table(heading, AlignedTable::Last::remark);
  for (const auto& curve : result.curves) {
    std::vector<std::string> row{curve.name};
    std::string remark;
    for (const auto& parameter : own_of(result, curve)) {
      row.push_back(short_number(parameter.value));
      row.push_back(short_number(result.half_width * parameter.standard_error));
      if (const auto state = parameter_state(parameter); !state.empty())
        remark += (remark.empty() ? "" : ", ") + parameter.name + " " + state;
    }
    for (const auto& each : derived_of(run, result, curve)) {
      row.push_back(short_number(each.value));
      row.push_back(short_number(result.half_width * each.standard_error));
    }
    row.push_back(short_number(curve.rms));
    row.push_back(short_number(curve.rms_alone));
    row.push_back(remark);
    table.add(row);
  }
  return table.text();
}

}  // namespace

std::string joint_fit_table(const JointRun& run, const frac::JointFitResult& result) {
  std::string text = "model      " + result.model + "\ncurves     " + std::to_string(run.curves.size());
  if (!run.value_unit.empty()) text += ", values in " + run.value_unit;
  text += "\nresiduals  " + std::string(io::find_value(run.options, "component").value_or("")) + ", " +
          std::string(io::find_value(run.options, "weight").value_or("")) + " weight\n";
  if (const auto laws = io::find_value(run.options, "laws")) text += "laws       " + std::string(*laws) + "\n";
  text += "\n";
  if (!result.curves.empty())
    text += shared_table(result) + "\n" + curve_table(run, result) +
            "+- is half of the 95 % interval; alone: rms where the curve shares nothing.\n\n";
  text += "chance of curves that share to differ as these do " + short_number(result.sharing_p_value) + "\n";
  return text + paragraph(std::string(frac::to_string(result.termination)) + ": " + result.message + " " +
                          short_number(result.seconds) + " s.");
}

std::string joint_fit_csv(const JointRun& run, const frac::JointFitResult& result) {
  struct Row {
    std::string curve;
    frac::ParameterEstimate parameter;
  };
  std::vector<Row> rows;
  for (const auto& parameter : result.shared) rows.push_back({"", parameter});
  for (const auto& curve : result.curves) {
    for (const auto& parameter : own_of(result, curve)) rows.push_back({curve.name, parameter});
    for (const auto& each : derived_of(run, result, curve)) {
      frac::ParameterEstimate row{};
      row.name = each.name;
      row.value = each.value;
      row.standard_error = each.standard_error;
      row.ci95_lower = each.ci95_lower;
      row.ci95_upper = each.ci95_upper;
      row.identified = each.standard_error == each.standard_error;
      rows.push_back({curve.name, row});
    }
  }
  Document document{run.options, {{}, rows.size(), {}}};
  for (const auto& [key, value] : io::Metadata{{"formula", result.model},
                                               {"curves", std::to_string(run.curves.size())},
                                               {"cost", io::format_number(result.cost)},
                                               {"sharing_p_value", io::format_number(result.sharing_p_value)},
                                               {"termination", std::string(frac::to_string(result.termination))}})
    document.head.emplace_back(key, value);
  document.rows.columns = {"curve",      "name",       "value",    "standard_error", "ci95_lower",
                           "ci95_upper", "identified", "at_bound", "shared"};
  document.rows.fill = [&](std::size_t i, std::vector<Cell>& cells) {
    const auto& [curve, parameter] = rows[i];
    cells.emplace_back(curve);
    cells.emplace_back(parameter.name);
    for (const double value : {parameter.value, parameter.standard_error, parameter.ci95_lower, parameter.ci95_upper})
      cells.emplace_back(value);
    for (const bool flag : {parameter.identified, parameter.at_bound, curve.empty()}) cells.emplace_back(flag);
  };
  return text_of(document, "csv", run.command);
}

std::string joint_fit_json(const JointRun& run, const frac::JointFitResult& result) {
  Json json = origin(run.command);
  json["options"] = object_of(run.options);
  json["model"] = result.model;
  json["value_unit"] = run.value_unit.empty() ? Json(nullptr) : Json(run.value_unit);
  json["shared"] = Json::array();
  for (const auto& parameter : result.shared) json["shared"].push_back(parameter_json(parameter));
  json["curves"] = Json::array();
  for (std::size_t c = 0; c < result.curves.size(); ++c) {
    const auto& curve = result.curves[c];
    Json& entry = json["curves"].push_back({{"name", curve.name},
                                            {"points", run.curves[c].points},
                                            {"header", object_of(run.curves[c].header)},
                                            {"parameters", Json::array()},
                                            {"covariance", curve.covariance},
                                            {"residuals", curve.residuals},
                                            {"rms", curve.rms},
                                            {"rms_alone", curve.rms_alone},
                                            {"max_residual", curve.max_residual},
                                            {"noise", curve.noise}});
    for (const auto& parameter : curve.parameters) entry["parameters"].push_back(parameter_json(parameter));
    if (!run.derived.empty()) entry["derived"] = derived_json(derived_of(run, result, curve));
  }
  json["cost"] = result.cost;
  json["residuals"] = result.residuals;
  json["free_parameters"] = result.free_parameters;
  json["starts"] = result.starts;
  json["starts_at_best"] = result.starts_at_best;
  json["sharing_p_value"] = result.sharing_p_value;
  json["condition"] = result.condition;
  json["termination"] = frac::to_string(result.termination);
  json["message"] = result.message;
  json["seconds"] = result.seconds;
  return json.dump() + "\n";
}

}  // namespace fracfit
