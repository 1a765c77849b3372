// SPDX-License-Identifier: BSD-3-Clause
#include "output/fit_output.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "frac/identification/describe.hpp"
#include "io/frequency_response_file.hpp"
#include "io/number.hpp"
#include "io/unit_name.hpp"
#include "output/aligned_table.hpp"
#include "output/described.hpp"
#include "output/document.hpp"
#include "output/economy_output.hpp"
#include "output/fitted_stability.hpp"
#include "output/json.hpp"
#include "output/parameter_output.hpp"

namespace fracfit {
namespace {

constexpr std::size_t law_indent = 11, note_indent = 4;
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

std::string option_of(const FitRun& run, std::string_view key) {
  return std::string(io::find_value(run.options, key).value_or(std::string_view{}));
}

// Where on the axis, as the file gives it.
double on_axis(const FitRun& run, double at) {
  return run.over_time ? at : in_unit(at, run.frequency_unit);
}
std::string axis_unit(const FitRun& run) {
  return " " + (run.over_time ? "s" : std::string(to_string(run.frequency_unit)));
}

/// A line of what the options say of the system; empty where they say nothing.
std::string told_assumptions(const frac::Assumptions& assumptions) {
  std::string text;
  const auto add = [&](const char* each) { text += (text.empty() ? "\nassumed    " : ", ") + std::string(each); };
  if (assumptions.stable) add(*assumptions.stable ? "stable" : "perhaps unstable");
  if (assumptions.dead_time) add(*assumptions.dead_time ? "with a dead time or without" : "no dead time");
  if (assumptions.passive) add("passive");
  return text;
}

std::string heading(const FitRun& run) {
  std::string text = "data       " + run.file + ", " + std::to_string(run.points) + " points, " +
                     short_number(on_axis(run, run.lower)) + " .. " + short_number(on_axis(run, run.upper)) +
                     axis_unit(run);
  const bool inverse =
      io::find_value(run.file_header, io::quantity_key) == backlash::to_string(backlash::Quantity::minus_inverse);
  if (inverse || !run.value_unit.empty()) text += inverse ? ", values of -1/N" : ", values";
  if (!run.value_unit.empty()) text += " in " + io::written_unit(run.value_unit);
  if (!run.left_out.empty()) {
    text += "\nleft out   at";
    for (const LeftOutPoint& point : run.left_out) text += " " + short_number(on_axis(run, point.omega));
    text += axis_unit(run);
  }
  if (run.over_time) {
    text += "\nresiduals  of the output, " + option_of(run, "weight") + " weight";
    if (option_of(run, "loss") != "none") text += ", " + option_of(run, "loss") + " loss";
    return text + "; input " + option_of(run, "hold") + " hold, offset " + option_of(run, "offset") + "\n";
  }
  text += "\nresiduals  " + option_of(run, "component") + ", " + option_of(run, "weight") + " weight";
  if (option_of(run, "loss") != "none") text += ", " + option_of(run, "loss") + " loss";
  if (option_of(run, "realisation") != "exact") text += ", powers of s through " + option_of(run, "realisation");
  if (run.validity) text += "\nvalidity   " + run.validity_sentence;
  if (run.assumptions) text += told_assumptions(*run.assumptions);
  return text + "\n";
}

// The formula as it was understood, where its spelling leaves it open.
std::string reading(const std::string& formula) {
  const std::string grouped = frac::Structure(formula).grouped();
  const auto bare = [](std::string text) {
    std::erase_if(text, [](char c) { return c == ' ' || c == '*'; });
    return text;
  };
  return bare(grouped) == bare(formula) ? "" : "read as    " + grouped + "\n";
}

std::string remark_on_profiles(const frac::FitResult& result) {
  std::string names;
  for (const auto& parameter : result.parameters) {
    if (parameter.interval == frac::IntervalKind::profile) names += (names.empty() ? "" : ", ") + parameter.name;
  }
  if (names.empty()) return {};
  return "Wide intervals follow the cost itself (profile likelihood), not its curvature: " + names + ".\n";
}

std::string parameter_table(const FitRun& run, const frac::FitResult& result) {
  if (result.parameters.empty()) return {};
  return estimate_table("parameter", result.parameters, {result.model, run.value_unit}, result.without_noise) +
         remark_on_limits(result.parameters) + (result.without_noise ? "" : remark_on_profiles(result));
}

std::string added_intervals(const frac::FitResult& result, const FitStatistics& statistics) {
  if (statistics.profile.empty() && statistics.bootstrap.empty()) return {};
  std::vector<std::string> names{"95 % intervals"};
  if (!statistics.profile.empty()) names.emplace_back("profile likelihood");
  if (!statistics.bootstrap.empty()) names.push_back("bootstrap of " + std::to_string(statistics.bootstrap_samples));
  names.emplace_back("");
  AlignedTable table(names, AlignedTable::Last::remark);
  for (std::size_t i = 0; i < result.parameters.size(); ++i) {
    std::vector<std::string> row{result.parameters[i].name};
    std::string remark;
    if (!statistics.profile.empty()) {
      const auto& profile = statistics.profile[i];
      row.push_back(profile ? interval(profile->lower, profile->upper) : "-");
      if (profile && profile->better_minimum_found) remark = "the profile found a better minimum";
    }
    if (!statistics.bootstrap.empty())
      row.push_back(interval(statistics.bootstrap[i].lower, statistics.bootstrap[i].upper));
    row.push_back(remark);
    table.add(row);
  }
  return table.text() + "\n";
}

std::string remarks_on_residuals(const FitRun& run, const frac::FitResult& result, const FitStatistics& statistics) {
  if (result.confidence_of_optimum == 1) return "residuals: rounding only\n";
  if (result.without_noise) return {};
  std::string text = "residuals: correlation of neighbours " +
                     short_number(statistics.whiteness.lag_one_correlation, 3) + ", chance of that from noise alone " +
                     short_number(statistics.whiteness.p_value, 3) + "\n";
  const frac::LackOfFit& lack = statistics.lack_of_fit;
  if (!lack.adequate && lack.misfit > 1)
    text += "the model misses the data: its residuals are " + short_number(lack.misfit, 3) + " times the noise\n";
  else if (!lack.adequate && std::isfinite(lack.correlation))
    text += "the model misses the data: its residuals follow each other as noise does not\n";
  if (statistics.outlier_at.empty()) return text;
  const std::size_t count = statistics.outlier_at.size();
  text += std::to_string(count) + (count == 1 ? " outlier at" : " outliers at") + (run.over_time ? " t =" : "");
  for (const double at : statistics.outlier_at) text += " " + short_number(on_axis(run, at));
  text += axis_unit(run);
  const bool bears_them = run.over_time && io::find_value(run.options, "loss") == "none";
  return text +
         (bears_them ? "; each weighs like every sample, and --loss huber bounds what it does to the fit\n" : "\n");
}

std::string growth_table(const frac::Growth& growth) {
  AlignedTable table({"structures tried", "free", "rms", "AICc", ""}, AlignedTable::Last::remark);
  for (std::size_t i = 0; i < growth.fits.size(); ++i) {
    const auto& fit = growth.fits[i];
    // A circuit is read faster than its formula, which stands above for the chosen one.
    const std::string& name = growth.models.at(i).name;
    table.add({name.starts_with("elements:") ? name.substr(name.find(':') + 1) : fit.model,
               std::to_string(fit.free_parameters), short_number(fit.rms), short_number(fit.aicc),
               i == growth.chosen ? "chosen" : ""});
  }
  return table.text() + growth.reason + "\n\n";
}

/// Empty where the fitted model is not unstable, and where its stability cannot be told.
std::string remark_on_poles(const frac::FitResult& result) {
  const std::string remark = remark_on_stability(fitted_stability(result));
  return remark.empty() ? "" : paragraph(remark);
}

/// " (1.2 % of the data)", where residuals are no shares of the data themselves.
std::string share_of_data(const frac::FitResult& result) {
  if (!(std::abs(result.relative_rms - result.rms) > 1e-3 * result.rms)) return "";
  return " (" + short_number(100 * result.relative_rms, 3) + " % of the data)";
}

std::string closing(const frac::FitResult& result) {
  std::string text = "cost " + short_number(result.cost) + " (sum of " + std::to_string(result.residuals) +
                     " squared residuals), rms " + short_number(result.rms) + share_of_data(result) + ", largest " +
                     short_number(result.max_residual) + "\n";
  if (!result.without_noise) text += "AICc " + short_number(result.aicc) + ", BIC " + short_number(result.bic) + "\n";
  return text +
         paragraph(std::string(frac::to_string(result.termination)) + ": " +
                   with_advice(result.message, result.advice) + " " + short_number(result.seconds) + " s.") +
         remark_on_poles(result) + (result.without_noise ? paragraph(std::string(frac::no_noise_sentence)) : "");
}

io::Metadata head_of(const FitRun& run) {
  io::Metadata head{{"data", run.file}};
  head.insert(head.end(), run.options.begin(), run.options.end());
  if (run.validity) head.emplace_back("validity", run.validity_sentence);
  return head;
}

Json parameters_json(const FitRun& run, const frac::FitResult& result) {
  // A curve without parameters need not be a formula.
  if (result.parameters.empty()) return Json::array();
  const ParameterUnits units(result.model, run.value_unit);
  return Json::list(result.parameters, [&](const auto& each) { return parameter_json(each, units); });
}

void append_fit(Json& json, const FitRun& run, const frac::FitResult& result) {
  json["model"] = result.model;
  json["parameters"] = parameters_json(run, result);
  add_scalars(json, result);
  json["message"] = with_advice(result.message, result.advice);
}

/// A row of the CSV: no bound, no profile, no bootstrap and no unit.
void append_derived(std::vector<Cell>& cells, const frac::DerivedEstimate& derived, std::size_t columns) {
  add_cells(cells, derived, {"name", "value", "standard_error", "ci95_lower", "ci95_upper"});
  for (const bool flag : {std::isfinite(derived.standard_error), false, false}) cells.emplace_back(flag);
  while (cells.size() + 3 < columns) cells.emplace_back(nan);
  cells.emplace_back(std::string{});
  cells.insert(cells.end(), 2, nan);
}

Json stability_json(const frac::FitResult& result) {
  const auto analysis = fitted_stability(result);
  return analysis ? Json(frac::to_string(analysis->stability)) : Json(nullptr);
}

Json finalist_json(const frac::IdentificationResult& result, const std::optional<frac::Finalist>& finalist) {
  if (!finalist) return nullptr;
  Json json{{"name", result.ranking.at(finalist->index).name}};
  add_scalars(json, *finalist);
  return json;
}

// Points of the data read by their index: those left out, and those whose residuals stand out of the fit's.
Json outliers_json(const FitRun& run, const frac::FitResult& result, const FitStatistics& statistics) {
  const char* const at = run.over_time ? "time_s" : "omega";
  std::map<std::size_t, Json> by_index;
  for (const LeftOutPoint& point : run.left_out)
    by_index[point.index] = {{"index", point.index}, {at, point.omega}, {"left_out", true}};
  for (std::size_t i = 0; i < statistics.outlier_at.size(); ++i) {
    std::size_t index = result.outliers[i];
    for (const LeftOutPoint& point : run.left_out) index += point.index <= index ? 1 : 0;
    by_index[index] = {{"index", index}, {at, statistics.outlier_at[i]}, {"left_out", false}};
  }
  Json outliers = Json::array();
  for (const auto& [index, outlier] : by_index) outliers.push_back(outlier);
  return outliers;
}

Json left_out_json(const FitRun& run) {
  return Json::list(run.left_out, [](const LeftOutPoint& point) { return Json(point.omega); });
}

void append_statistics(Json& json, const FitRun& run, const frac::FitResult& result, const FitStatistics& statistics) {
  for (std::size_t i = 0; i < result.parameters.size(); ++i) {
    Json& parameter = json["parameters"][i];
    if (!statistics.profile.empty()) {
      const auto& profile = statistics.profile[i];
      parameter["profile_ci95"] = profile ? Json{profile->lower, profile->upper} : Json();
      if (profile) parameter["profile_found_better_minimum"] = profile->better_minimum_found;
    }
    if (!statistics.bootstrap.empty()) {
      const auto& bootstrap = statistics.bootstrap[i];
      parameter["bootstrap_ci95"] = {bootstrap.lower, bootstrap.upper};
      parameter["bootstrap_standard_error"] = bootstrap.standard_error;
    }
  }
  json["correlation"] = statistics.correlation;
  json["outliers"] = outliers_json(run, result, statistics);
  json["lack_of_fit"] = json_of(statistics.lack_of_fit);
  json["whiteness"] = {{"lag_one_correlation", statistics.whiteness.lag_one_correlation},
                       {"p_value", statistics.whiteness.p_value}};
  if (statistics.bootstrap_samples > 0) json["bootstrap_samples"] = statistics.bootstrap_samples;
  if (!statistics.growth) return;
  json["growth"] = {
      {"chosen", statistics.growth->chosen}, {"reason", statistics.growth->reason}, {"fits", Json::array()}};
  for (std::size_t i = 0; i < statistics.growth->fits.size(); ++i) {
    Json grown;
    append_fit(grown, run, statistics.growth->fits[i]);
    grown["name"] = statistics.growth->models.at(i).name;
    json["growth"]["fits"].push_back(std::move(grown));
  }
}

constexpr std::string_view misses_the_data = "misses the data";

/// @param noisy  data without noise are missed by every model that does not meet them to rounding
std::string remark_on(const frac::IdentificationResult& result, std::size_t rank, bool noisy) {
  const auto& candidate = result.ranking[rank];
  if (rank == result.chosen) return "chosen";
  if (candidate.fit.termination != frac::FitTermination::converged)
    return std::string(frac::to_string(candidate.fit.termination));
  return std::string(candidate.lack_of_fit.adequate || !noisy ? "" : misses_the_data);
}

/// The remark with the other spellings of the model.
std::string remark_with_spellings(const frac::IdentificationResult& result, std::size_t rank, bool noisy) {
  std::string text = remark_on(result, rank, noisy);
  for (const std::string& name : result.ranking[rank].also) text += (text.empty() ? "also " : ", also ") + name;
  return text;
}

/// A reader compares the candidates that follow the data and the best of each class; of a long ranking the rest is
/// named beneath the table.
bool belongs_in_table(const frac::IdentificationResult& result, std::size_t rank) {
  constexpr std::size_t leading_ranks = 10;
  const auto& candidate = result.ranking[rank];
  const auto first_of_class = std::find_if(result.ranking.begin(), result.ranking.end(), [&](const auto& other) {
    return other.model_class == candidate.model_class;
  });
  return rank < leading_ranks || candidate.lack_of_fit.adequate || &candidate == &*first_of_class;
}

/// Words of the options, "assumed" where nobody has said it.
Json assumptions_json(const frac::Assumptions& assumptions) {
  const auto word = [](const std::optional<bool>& said, const char* unsaid) {
    return std::string(said ? (*said ? "yes" : "no") : unsaid);
  };
  return {{"stable", word(assumptions.stable, "unless the data speak against it")},
          {"dead_time", word(assumptions.dead_time, "if the data speak for it")},
          {"passive", assumptions.passive}};
}

Json origin_of_fit(const FitRun& run) {
  Json json = origin(run.command);
  json["data"] = {{"file", run.file},
                  {"points", run.points},
                  {run.over_time ? "time_from_s" : "omega_lower", run.lower},
                  {run.over_time ? "time_to_s" : "omega_upper", run.upper},
                  {"value_unit", run.value_unit.empty() ? Json(nullptr) : Json(run.value_unit)},
                  {"header", object_of(run.file_header)}};
  if (!run.over_time) json["data"]["left_out"] = left_out_json(run);
  json["options"] = object_of(run.options);
  if (run.assumptions) json["assumptions"] = assumptions_json(*run.assumptions);
  if (run.validity)
    json["validity"] = {{"verdict", frac::to_string(run.validity->validity)},
                        {"noise", run.validity->noise},
                        {"drift", run.validity->drift},
                        {"drift_deviation", run.validity->drift_deviation},
                        {"departs", run.validity->departs},
                        {"consistent_to", run.validity->consistent_to},
                        {"sentence", run.validity_sentence}};
  return json;
}

// Of those that are told apart by AICc the simplest, unless the verdict prefers another one.
std::string why_chosen(const frac::IdentificationResult& result) {
  const frac::RankedFit& chosen = result.ranking.at(result.chosen);
  if (result.set_aside)
    return "the best of its class that keeps to what is assumed, in place of " +
           result.ranking.at(*result.set_aside).name;
  if (chosen.name.starts_with("elements:")) return "a sum of passive elements, which the data do not speak against";
  if (!chosen.lack_of_fit.adequate) return "the simplest within 2 of the least AICc of all, as none follows the data";
  const bool least = std::none_of(result.ranking.begin(), result.ranking.end(), [&](const frac::RankedFit& other) {
    return other.lack_of_fit.adequate && other.fit.usable() && other.fit.aicc + 2 < chosen.fit.aicc;
  });
  return least ? "the simplest within 2 of the least AICc of those that follow the data"
               : "of those that follow the data the one that the verdict prefers, not that of the least AICc";
}

// A weight is a probability: digits beyond the fourth place say nothing.
std::string weight_text(double weight) {
  return weight < 1e-4 ? "<0.0001" : short_number(weight, 3);
}

}  // namespace

std::string fit_table(const FitRun& run, const frac::FitResult& result, const FitStatistics& statistics) {
  return "model      " + result.model + "\n" +
         (run.law.empty() ? reading(result.model) : "law        " + paragraph(run.law, law_indent)) + heading(run) +
         "\n" + (statistics.growth ? growth_table(*statistics.growth) : "") + parameter_table(run, result) + "\n" +
         prior_table(result.priors) + derived_table(statistics.derived, result.without_noise) +
         added_intervals(result, statistics) + remarks_on_residuals(run, result, statistics) + closing(result);
}

std::string identification_table(const FitRun& run, const frac::IdentificationResult& result,
                                 const std::vector<double>& prediction_rms) {
  // Weights of evidence are of data with noise.
  const bool noisy = !run.economy;
  std::vector<std::string> names{"model", "class", "free", "rms"};
  if (noisy) names.insert(names.end(), {"delta AICc", "Akaike weight"});
  if (!prediction_rms.empty()) names.emplace_back("rms of predictions");
  names.emplace_back("");
  AlignedTable ranking(names, AlignedTable::Last::remark);
  std::string others;
  for (std::size_t i = 0; i < result.ranking.size(); ++i) {
    const auto& candidate = result.ranking[i];
    const std::string remark = remark_on(result, i, noisy);
    if (!belongs_in_table(result, i)) {
      others += (others.empty() ? "" : ", ") + candidate.name + " " + short_number(candidate.fit.rms, 3);
      if (!remark.empty() && remark != misses_the_data) others += " (" + remark + ")";
      continue;
    }
    std::vector<std::string> row{candidate.name, std::string(frac::to_string(candidate.model_class)),
                                 std::to_string(candidate.fit.free_parameters), short_number(candidate.fit.rms)};
    if (noisy) row.insert(row.end(), {short_number(candidate.delta_aicc), weight_text(candidate.akaike_weight)});
    if (!prediction_rms.empty()) row.push_back(short_number(prediction_rms[i]));
    row.push_back(remark_with_spellings(result, i, noisy));
    ranking.add(row);
  }
  const auto& chosen = result.ranking.at(result.chosen);
  std::string text = heading(run);
  if (result.noise_floor > 0) {
    text += "floor      " + short_number(result.noise_floor) +
            ": the noise does not fall with the data, residuals are divided by sqrt(|data|^2 + floor^2)\n";
  }
  text += "\n" + ranking.text();
  if (!others.empty())
    text += paragraph((noisy ? "These miss the data too, by an rms of: " : "Others, with their rms: ") + others + ".");
  if (!noisy) return text + "\n" + economy_table(*run.economy);
  text +=
      "chosen: " + why_chosen(result) + "; the verdict compares those of the least Schwarz criterion\n\n" + chosen.name;
  if (chosen.fit.model != chosen.name) text += "   " + chosen.fit.model;
  text += "\n" + parameter_table(run, chosen.fit) + "\n" + remark_on_poles(chosen.fit);
  text += paragraph("verdict: " + std::string(frac::to_string(result.verdict)) + ". " +
                    with_advice(result.verdict_sentence, result.advice));
  for (const auto& note : result.notes) text += "  - " + paragraph(note, note_indent);
  return text;
}

std::string fit_csv(const FitRun& run, const frac::FitResult& result, const FitStatistics& statistics) {
  Document document{head_of(run), {{}, result.parameters.size() + statistics.derived.size(), {}}};
  for (const auto& [key, value] :
       io::Metadata{{"formula", result.model},
                    {"cost", io::format_number(result.cost)},
                    {"rms", io::format_number(result.rms)},
                    {"aicc", io::format_number(result.aicc)},
                    {"bic", io::format_number(result.bic)},
                    {"termination", std::string(frac::to_string(result.termination))},
                    {"lag_one_correlation", io::format_number(statistics.whiteness.lag_one_correlation)},
                    {"whiteness_p_value", io::format_number(statistics.whiteness.p_value)}})
    document.head.emplace_back(key, value);
  if (result.without_noise) document.head.emplace_back("without_noise", "true");
  if (!run.law.empty()) document.head.emplace_back("law", run.law);
  auto& columns = document.rows.columns;
  columns = {"name", "value", "standard_error", "ci95_lower", "ci95_upper", "identified", "at_bound", "fixed"};
  if (!statistics.profile.empty()) columns.insert(columns.end(), {"profile_lower", "profile_upper"});
  if (!statistics.bootstrap.empty())
    columns.insert(columns.end(), {"bootstrap_lower", "bootstrap_upper", "bootstrap_standard_error"});
  columns.insert(columns.end(), {"unit", "lower_limit", "upper_limit"});
  const ParameterUnits units(result.model, run.value_unit);
  document.rows.fill = [&](std::size_t i, std::vector<Cell>& cells) {
    if (i >= result.parameters.size()) {
      append_derived(cells, statistics.derived[i - result.parameters.size()], columns.size());
      return;
    }
    const auto& parameter = result.parameters[i];
    add_cells(cells, parameter,
              {"name", "value", "standard_error", "ci95_lower", "ci95_upper", "identified", "at_bound", "fixed"});
    if (!statistics.profile.empty()) {
      const auto profile = statistics.profile[i].value_or(frac::ProfileInterval{nan, nan, false});
      for (const double value : {profile.lower, profile.upper}) cells.emplace_back(value);
    }
    if (!statistics.bootstrap.empty()) {
      const auto& bootstrap = statistics.bootstrap[i];
      for (const double value : {bootstrap.lower, bootstrap.upper, bootstrap.standard_error}) cells.emplace_back(value);
    }
    cells.emplace_back(units.of(parameter.name));
    add_cells(cells, parameter, {"lower_limit", "upper_limit"});
  };
  return text_of(document, "csv", run.command);
}

std::string identification_csv(const FitRun& run, const frac::IdentificationResult& result,
                               const std::vector<double>& prediction_rms) {
  Document document{head_of(run), {{}, result.ranking.size(), {}}};
  document.head.emplace_back("verdict", frac::to_string(result.verdict));
  document.head.emplace_back("evidence", io::format_number(result.evidence));
  document.head.emplace_back("chosen", result.ranking.at(result.chosen).name);
  if (run.economy) document.head.emplace_back("economy", run.economy->sentence);
  auto& columns = document.rows.columns;
  columns = {"name", "class", "model",      "free_parameters", "cost",       "rms",
             "aicc", "bic",   "delta_aicc", "akaike_weight",   "termination"};
  if (!prediction_rms.empty()) columns.emplace_back("prediction_rms");
  document.rows.fill = [&](std::size_t i, std::vector<Cell>& cells) {
    const auto& candidate = result.ranking[i];
    const auto& fit = candidate.fit;
    add_cells(cells, candidate, {"name", "class"});
    add_cells(cells, fit, {"model", "free_parameters", "cost", "rms", "aicc", "bic"});
    add_cells(cells, candidate, {"delta_aicc", "akaike_weight"});
    add_cells(cells, fit, {"termination"});
    if (!prediction_rms.empty()) cells.emplace_back(prediction_rms[i]);
  };
  return text_of(document, "csv", run.command);
}

std::string fit_json(const FitRun& run, const frac::FitResult& result, const FitStatistics& statistics) {
  Json json = origin_of_fit(run);
  append_fit(json, run, result);
  if (!run.law.empty()) json["law"] = run.law;
  json["stability"] = run.law.empty() ? stability_json(result) : Json(nullptr);
  append_statistics(json, run, result, statistics);
  if (!statistics.derived.empty()) json["derived"] = json_of(statistics.derived);
  if (!result.priors.empty()) json["priors"] = json_of(result.priors);
  return json.dump() + "\n";
}

std::string identification_json(const FitRun& run, const frac::IdentificationResult& result,
                                const std::vector<double>& prediction_rms) {
  Json json = origin_of_fit(run);
  json["ranking"] = Json::array();
  for (const auto& candidate : result.ranking) {
    Json ranked = Json::object();
    add_scalars(ranked, candidate);
    ranked["also"] = candidate.also;
    append_fit(ranked, run, candidate.fit);
    ranked["lack_of_fit"] = json_of(candidate.lack_of_fit);
    if (!prediction_rms.empty()) ranked["prediction_rms"] = prediction_rms[json["ranking"].size()];
    json["ranking"].push_back(std::move(ranked));
  }
  json["chosen"] = result.ranking.at(result.chosen).name;
  json["stability"] = stability_json(result.ranking.at(result.chosen).fit);
  add_scalars(json, result);
  json["verdict_sentence"] = run.economy ? std::string(frac::no_noise_sentence) + " " + run.economy->sentence
                                         : with_advice(result.verdict_sentence, result.advice);
  json["notes"] = result.notes;
  json["set_aside"] = result.set_aside ? Json(result.ranking.at(*result.set_aside).name) : Json(nullptr);
  json["fractional"] = finalist_json(result, result.fractional);
  json["integer"] = finalist_json(result, result.integer);
  json["differ_most"] = {{"omega", result.differ_most_omega}, {"relative", result.differ_most}};
  json["next_measurement"] = json_of(result.next);
  json["distribution"] = json_of(result.distribution);
  json["economy"] = run.economy ? economy_json(*run.economy) : Json();
  json["skipped"] = result.skipped;
  return json.dump() + "\n";
}

}  // namespace fracfit
