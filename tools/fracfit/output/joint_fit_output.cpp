// SPDX-License-Identifier: BSD-3-Clause
#include "output/joint_fit_output.hpp"

#include <algorithm>
#include <complex>

#include "frac/identification/describe.hpp"
#include "io/number.hpp"
#include "io/unit_name.hpp"
#include "output/aligned_table.hpp"
#include "output/described.hpp"
#include "output/document.hpp"
#include "output/json.hpp"
#include "output/parameter_output.hpp"

namespace fracfit {
namespace {

bool is_shared(const frac::JointFitResult& result, const std::string& name) {
  return std::any_of(result.shared.begin(), result.shared.end(),
                     [&](const frac::ParameterEstimate& each) { return each.name == name; });
}

/// Parameters of a curve that are its own; of those that are held in some curves alone, the held ones too.
std::vector<frac::ParameterEstimate> own_of(const frac::JointFitResult& result, const frac::JointCurveResult& curve) {
  std::vector<frac::ParameterEstimate> own;
  for (std::size_t i = 0; i < curve.parameters.size(); ++i) {
    const bool is_free = std::any_of(result.curves.begin(), result.curves.end(),
                                     [i](const auto& each) { return !each.parameters[i].fixed; });
    if (is_free && !is_shared(result, curve.parameters[i].name)) own.push_back(curve.parameters[i]);
  }
  return own;
}

/// @param curve  of the result
std::vector<frac::DerivedEstimate> derived_of(const JointRun& run, const frac::JointFitResult& result,
                                              const frac::JointCurveResult& curve) {
  // Rows of the covariance are the parameters and then those of the laws, which stand last in `shared`.
  std::vector<frac::ParameterEstimate> known = curve.parameters;
  const std::size_t of_laws = curve.covariance_with_laws.size() - known.size();
  known.insert(known.end(), result.shared.end() - static_cast<std::ptrdiff_t>(of_laws), result.shared.end());
  std::vector<double> values;
  std::vector<std::size_t> row;
  for (const std::string& name : run.derived_from) {
    const auto found = std::find_if(known.begin(), known.end(), [&](const auto& each) { return each.name == name; });
    row.push_back(static_cast<std::size_t>(found - known.begin()));
    if (found != known.end()) {
      values.push_back(found->value);
      continue;
    }
    const auto& covariates = run.curves[static_cast<std::size_t>(&curve - result.curves.data())].covariates;
    values.push_back(std::find_if(covariates.begin(), covariates.end(), [&](const auto& each) {
                       return each.first == name;
                     })->second);
  }
  std::vector<std::vector<double>> covariance(row.size(), std::vector<double>(row.size(), 0.0));
  for (std::size_t i = 0; i < row.size(); ++i)
    for (std::size_t k = 0; k < row.size(); ++k)
      if (row[i] < known.size() && row[k] < known.size()) covariance[i][k] = curve.covariance_with_laws[row[i]][row[k]];
  std::vector<frac::DerivedEstimate> derived;
  for (const auto& each : run.derived) derived.push_back(each.at(values, covariance, result.half_width));
  return derived;
}

/// Of shared parameters, and of each curve's own with the name of the curve.
std::vector<frac::PriorEstimate> priors_of(const frac::JointFitResult& result) {
  auto priors = result.priors;
  for (const auto& curve : result.curves) {
    for (auto prior : curve.priors) {
      prior.name += " of " + curve.name;
      priors.push_back(std::move(prior));
    }
  }
  return priors;
}

/// Of parameters of laws and of shift factors none is known.
ParameterUnits units_of(const JointRun& run) {
  return {run.formula, run.value_unit};
}

std::string curve_table(const JointRun& run, const frac::JointFitResult& result) {
  std::vector<std::string> heading{"curve"};
  const bool noisy = !result.without_noise;
  const ParameterUnits units = units_of(run);
  for (const auto& parameter : own_of(result, result.curves.front())) {
    const std::string unit = units.shown(parameter.name);
    heading.push_back(parameter.name + (unit.empty() ? "" : " (" + unit + ")"));
    if (noisy) heading.emplace_back("+-");
  }
  for (const auto& each : run.derived) {
    heading.push_back(each.name());
    if (noisy) heading.emplace_back("+-");
  }
  for (const char* name : {"rms", "alone", ""}) heading.emplace_back(name);
  AlignedTable table(heading, AlignedTable::Last::remark);
  for (const auto& curve : result.curves) {
    std::vector<std::string> row{curve.name};
    std::string remark;
    for (const auto& parameter : own_of(result, curve)) {
      row.push_back(short_number(parameter.value));
      if (noisy) row.push_back(parameter.fixed ? "-" : short_number(result.half_width * parameter.standard_error));
      if (const auto state = parameter_state(parameter, !noisy); !state.empty())
        remark += (remark.empty() ? "" : ", ") + parameter.name + " " + state;
    }
    for (const auto& each : derived_of(run, result, curve)) {
      row.push_back(short_number(each.value));
      if (noisy) row.push_back(short_number(result.half_width * each.standard_error));
    }
    row.push_back(short_number(curve.rms));
    row.push_back(short_number(curve.rms_alone));
    row.push_back(remark);
    table.add(row);
  }
  return table.text();
}

}  // namespace

namespace {

/// How many responses and records there are, and how far they reach.
std::string extent_text(const JointRun& run) {
  const auto records =
      std::count_if(run.curves.begin(), run.curves.end(), [](const auto& each) { return each.over_time; });
  const auto responses = static_cast<std::ptrdiff_t>(run.curves.size()) - records;
  std::string text;
  if (responses > 0)
    text = std::to_string(responses) + ", " + short_number(in_unit(run.lower, run.frequency_unit)) + " .. " +
           short_number(in_unit(run.upper, run.frequency_unit)) + " " + std::string(to_string(run.frequency_unit));
  if (records > 0)
    text +=
        (text.empty() ? "" : "; ") + std::to_string(records) + " over time, up to " + short_number(run.longest) + " s";
  return text;
}

}  // namespace

std::string joint_fit_table(const JointRun& run, const frac::JointFitResult& result) {
  std::string text = "model      " + result.model + "\ncurves     " + extent_text(run);
  if (!run.value_unit.empty()) text += ", values in " + io::written_unit(run.value_unit);
  const auto component = io::find_value(run.options, "component");
  text += "\nresiduals  " + (component ? std::string(*component) + ", " : "") +
          std::string(io::find_value(run.options, "weight").value_or("")) + " weight\n";
  if (const auto loss = io::find_value(run.options, "loss"); loss && *loss != "none")
    text.insert(text.size() - 1, ", " + std::string(*loss) + " loss");
  const auto add_line = [&](const char* key, const char* label) {
    if (const auto given = io::find_value(run.options, key)) text += label + std::string(*given) + "\n";
  };
  add_line("laws", "laws       ");
  add_line("priors", "priors     ");
  add_line("constraints", "order      ");
  add_line("reference", "reference  ");
  text += "\n";
  if (!result.curves.empty())
    text += estimate_table("shared", result.shared, units_of(run), result.without_noise) + "\n" +
            curve_table(run, result) + (result.without_noise ? "" : "+- is half of the 95 % interval; ") +
            "alone: rms where the curve shares nothing.\n\n" + prior_table(priors_of(result));
  if (!result.without_noise && result.sharing_p_value == result.sharing_p_value)
    text += "chance of curves that share to differ as these do " + short_number(result.sharing_p_value) + "\n";
  return text +
         paragraph(std::string(frac::to_string(result.termination)) + ": " + result.message + " " +
                   short_number(result.seconds) + " s.") +
         (result.without_noise ? paragraph(std::string(frac::no_noise_sentence)) : "");
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
  document.rows.columns = {"curve",      "name",     "value",  "standard_error", "ci95_lower",  "ci95_upper",
                           "identified", "at_bound", "shared", "unit",           "lower_limit", "upper_limit"};
  const ParameterUnits units = units_of(run);
  document.rows.fill = [&](std::size_t i, std::vector<Cell>& cells) {
    const auto& [curve, parameter] = rows[i];
    cells.emplace_back(curve);
    add_cells(cells, parameter,
              {"name", "value", "standard_error", "ci95_lower", "ci95_upper", "identified", "at_bound"});
    cells.emplace_back(curve.empty());
    cells.emplace_back(units.of(parameter.name));
    add_cells(cells, parameter, {"lower_limit", "upper_limit"});
  };
  return text_of(document, "csv", run.command);
}

namespace {

/// Parameters of the master curve: those of a curve with both shift factors at 1.
std::vector<double> master_parameters(const frac::JointCurveResult& curve) {
  std::vector<double> values;
  for (const auto& parameter : curve.parameters) {
    const bool shift = parameter.name == frac::horizontal_shift || parameter.name == frac::vertical_shift;
    values.push_back(shift ? 1 : parameter.value);
  }
  return values;
}

double factor_of(const frac::JointCurveResult& curve, std::string_view name) {
  for (const auto& parameter : curve.parameters)
    if (parameter.name == name) return parameter.value;
  return 1;
}

/// A curve on the master curve: frequencies, values, and what the fit says.
struct Moved {
  std::vector<double> omega;
  std::vector<std::complex<double>> value, model;
};
Moved moved(const frac::JointFitResult& result, std::size_t c, const std::vector<frac::JointCurve>& curves,
            const frac::Realisation& realisation) {
  Moved all{curves[c].response()->omega(), curves[c].response()->value(), {}};
  for (double& each : all.omega) each *= factor_of(result.curves[c], frac::horizontal_shift);
  for (auto& each : all.value) each /= factor_of(result.curves[c], frac::vertical_shift);
  all.model.resize(all.omega.size());
  frac::Structure(result.model).response(master_parameters(result.curves[c]), all.omega, realisation, all.model);
  return all;
}

}  // namespace

std::string master_curve_csv(const JointRun& run, const frac::JointFitResult& result,
                             const std::vector<frac::JointCurve>& curves, const frac::Realisation& realisation) {
  struct Row {
    std::size_t curve;
    double measured, omega;
    std::complex<double> value, model;
  };
  std::vector<Row> rows;
  for (std::size_t c = 0; c < curves.size(); ++c) {
    const Moved all = moved(result, c, curves, realisation);
    for (std::size_t i = 0; i < all.omega.size(); ++i)
      rows.push_back({c, curves[c].response()->omega()[i], all.omega[i], all.value[i], all.model[i]});
  }
  std::stable_sort(rows.begin(), rows.end(), [](const Row& a, const Row& b) { return a.omega < b.omega; });
  Document document{{{"formula", result.model}}, {{}, rows.size(), {}}};
  document.rows.columns = {"omega", "re", "im", "curve", "omega_measured", "model_re", "model_im"};
  const bool in_hertz = run.frequency_unit == frac::FrequencyUnit::hertz;
  if (in_hertz) document.rows.columns.emplace_back("f_hz");
  document.rows.fill = [&](std::size_t i, std::vector<Cell>& cells) {
    const Row& row = rows[i];
    cells.insert(cells.end(), {row.omega, row.value.real(), row.value.imag(), result.curves[row.curve].name,
                               row.measured, row.model.real(), row.model.imag()});
    if (in_hertz) cells.emplace_back(in_unit(row.omega, run.frequency_unit));
  };
  return text_of(document, "csv", run.command);
}

report::Figure master_curve_figure(const JointRun& run, const frac::JointFitResult& result,
                                   const std::vector<frac::JointCurve>& curves, const frac::Realisation& realisation) {
  const report::Axis frequency{run.frequency_unit == frac::FrequencyUnit::hertz ? "f (Hz)" : "{/Symbol w} (rad/s)",
                               true};
  const std::string unit =
      run.value_unit.empty() ? "" : " (" + report::enhanced_escape(io::written_unit(run.value_unit)) + ")";
  report::Panel real{"", frequency, {"real part" + unit, true}},
      imaginary{"", frequency, {"|imaginary part|" + unit, true}};
  real.key = true;
  const auto on_axis = [&](std::vector<double> all) {
    for (double& each : all) each = in_unit(each, run.frequency_unit);
    return all;
  };
  std::vector<double> omega;
  for (std::size_t c = 0; c < curves.size(); ++c) {
    const Moved all = moved(result, c, curves, realisation);
    omega.insert(omega.end(), all.omega.begin(), all.omega.end());
    std::vector<double> re, im;
    for (const auto& each : all.value) {
      re.push_back(each.real());
      im.push_back(std::abs(each.imag()));
    }
    const auto colour = report::family_colour(c, curves.size());
    real.curves.push_back(report::make_curve(report::enhanced_escape(result.curves[c].name), colour,
                                             report::Mark::open_points, on_axis(all.omega), re));
    imaginary.curves.push_back(report::make_curve("", colour, report::Mark::open_points, on_axis(all.omega), im));
  }
  std::sort(omega.begin(), omega.end());
  std::vector<std::complex<double>> model(omega.size());
  frac::Structure(result.model).response(master_parameters(result.curves.front()), omega, realisation, model);
  std::vector<double> re, im;
  for (const auto& each : model) {
    re.push_back(each.real());
    im.push_back(std::abs(each.imag()));
  }
  real.curves.push_back(report::make_curve("master curve", "#000000", report::Mark::line, on_axis(omega), re));
  imaginary.curves.push_back(report::make_curve("", "#000000", report::Mark::line, on_axis(omega), im));
  return {"master", "", {std::move(real), std::move(imaginary)}};
}

std::string joint_fit_json(const JointRun& run, const frac::JointFitResult& result) {
  Json json = origin(run.command);
  json["options"] = object_of(run.options);
  json["model"] = result.model;
  json["value_unit"] = run.value_unit.empty() ? Json(nullptr) : Json(run.value_unit);
  const ParameterUnits units = units_of(run);
  const auto with_unit = [&](const auto& each) { return parameter_json(each, units); };
  json["shared"] = Json::list(result.shared, with_unit);
  json["curves"] = Json::array();
  for (std::size_t c = 0; c < result.curves.size(); ++c) {
    const auto& curve = result.curves[c];
    Json& entry = json["curves"].push_back({{"name", curve.name},
                                            {"points", run.curves[c].points},
                                            {"header", object_of(run.curves[c].header)},
                                            {"parameters", Json::list(curve.parameters, with_unit)},
                                            {"covariance", curve.covariance}});
    add_scalars(entry, curve);
    if (!run.derived.empty()) entry["derived"] = json_of(derived_of(run, result, curve));
  }
  add_scalars(json, result);
  if (priors_of(result).empty()) return json.dump() + "\n";
  Json& priors = json["priors"] = json_of(result.priors);
  for (const auto& curve : result.curves)
    for (const auto& each : curve.priors) priors.push_back(json_of(each))["curve"] = curve.name;
  return json.dump() + "\n";
}

}  // namespace fracfit
