// SPDX-License-Identifier: BSD-3-Clause
#include "fit_output.hpp"

#include <limits>

#include "aligned_table.hpp"
#include "io/csv_line.hpp"
#include "io/number.hpp"
#include "io/sweep_file.hpp"

namespace fracfit {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

std::string interval(double lower, double upper) {
  return short_number(lower) + " .. " + short_number(upper);
}

std::string option_of(const FitRun& run, std::string_view key) {
  return std::string(io::find_value(run.options, key).value_or(std::string_view{}));
}

std::string heading(const FitRun& run) {
  std::string text = "data       " + run.file + ", " + std::to_string(run.points) + " points, " +
                     interval(run.lower, run.upper) + (run.over_time ? " s" : " rad/s");
  if (!run.value_unit.empty()) text += ", values in " + run.value_unit;
  if (run.over_time) {
    text += "\nresiduals  of the output, " + option_of(run, "weight") + " weight";
    if (option_of(run, "loss") != "none") text += ", " + option_of(run, "loss") + " loss";
    return text + "; input " + option_of(run, "hold") + " hold, offset " + option_of(run, "offset") + "\n";
  }
  text += "\nresiduals  " + option_of(run, "component") + ", " + option_of(run, "weight") + " weight";
  if (option_of(run, "loss") != "none") text += ", " + option_of(run, "loss") + " loss";
  if (option_of(run, "realisation") != "exact") text += ", powers of s through " + option_of(run, "realisation");
  return text + "\n";
}

std::string state_of(const frac::ParameterEstimate& parameter) {
  if (parameter.fixed) return "fixed";
  if (parameter.at_bound) return "at its bound";
  if (!parameter.identified) return "not identified";
  return "";
}

std::string note_on_profiles(const frac::FitResult& result) {
  std::string names;
  for (const auto& parameter : result.parameters) {
    if (parameter.interval == frac::IntervalKind::profile) names += (names.empty() ? "" : ", ") + parameter.name;
  }
  if (names.empty()) return {};
  return "Wide intervals follow the cost itself (profile likelihood), not its curvature: " + names + ".\n";
}

std::string parameter_table(const frac::FitResult& result) {
  AlignedTable table({"parameter", "value", "standard error", "95 % interval", ""}, AlignedTable::Last::remark);
  for (const auto& parameter : result.parameters) {
    const bool has_interval = parameter.ci95_lower == parameter.ci95_lower && !parameter.fixed;
    table.add({parameter.name, short_number(parameter.value),
               parameter.fixed ? "-" : short_number(parameter.standard_error),
               has_interval ? interval(parameter.ci95_lower, parameter.ci95_upper) : "-", state_of(parameter)});
  }
  return table.text() + note_on_profiles(result);
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

std::string residual_remarks(const FitRun& run, const frac::FitResult& result, const FitStatistics& statistics) {
  if (result.confidence_of_optimum == 1) return "residuals: rounding only\n";
  std::string text = "residuals: correlation of neighbours " + short_number(statistics.whiteness.lag_one_correlation) +
                     ", chance of that from noise alone " + short_number(statistics.whiteness.p_value) + "\n";
  if (statistics.outlier_at.empty()) return text;
  text += std::to_string(statistics.outlier_at.size()) + " outliers at " + (run.over_time ? "t =" : "omega =");
  for (const double at : statistics.outlier_at) text += " " + short_number(at);
  return text + (run.over_time ? " s\n" : " rad/s\n");
}

std::string growth_table(const frac::Growth& growth) {
  AlignedTable table({"structures tried", "free", "rms", "AICc", ""}, AlignedTable::Last::remark);
  for (std::size_t i = 0; i < growth.fits.size(); ++i) {
    const auto& fit = growth.fits[i];
    table.add({fit.model, std::to_string(fit.free_parameters), short_number(fit.rms), short_number(fit.aicc),
               i == growth.chosen ? "chosen" : ""});
  }
  return table.text() + growth.reason + "\n\n";
}

std::string closing(const frac::FitResult& result) {
  std::string text = "cost " + short_number(result.cost) + " (sum of " + std::to_string(result.residuals) +
                     " squared residuals), rms " + short_number(result.rms) + ", largest " +
                     short_number(result.max_residual) + "\n";
  text += "AICc " + short_number(result.aicc) + ", BIC " + short_number(result.bic) + "\n";
  return text + paragraph(std::string(frac::to_string(result.termination)) + ": " + result.message + " " +
                          short_number(result.seconds) + " s.");
}

std::string csv_header(const FitRun& run) {
  std::string text =
      "# fracfit: " + std::string(io::version()) + "\n# command: " + run.command + "\n# data: " + run.file + "\n";
  for (const auto& [key, value] : run.options) text += "# " + key + ": " + value + "\n";
  return text;
}

std::string yes_no(bool value) {
  return value ? "true" : "false";
}

}  // namespace

std::string fit_table(const FitRun& run, const frac::FitResult& result, const FitStatistics& statistics) {
  return "model      " + result.model + "\n" + heading(run) + "\n" +
         (statistics.growth ? growth_table(*statistics.growth) : "") + parameter_table(result) + "\n" +
         added_intervals(result, statistics) + residual_remarks(run, result, statistics) + closing(result);
}

std::string identification_table(const FitRun& run, const frac::IdentificationResult& result,
                                 const std::vector<double>& prediction_rms) {
  std::vector<std::string> names{"model", "class", "free", "rms", "delta AICc", "evidence"};
  if (!prediction_rms.empty()) names.emplace_back("rms of predictions");
  names.emplace_back("");
  AlignedTable ranking(names, AlignedTable::Last::remark);
  std::size_t index = 0;
  for (const auto& candidate : result.ranking) {
    std::string remark = candidate.lack_of_fit.adequate ? "" : "misses the data";
    if (candidate.fit.termination != frac::FitTermination::converged)
      remark = frac::to_string(candidate.fit.termination);
    if (&candidate == &result.ranking.at(result.chosen)) remark = "chosen";
    std::vector<std::string> row{candidate.name,
                                 std::string(frac::to_string(candidate.model_class)),
                                 std::to_string(candidate.fit.free_parameters),
                                 short_number(candidate.fit.rms),
                                 short_number(candidate.delta_aicc),
                                 short_number(candidate.akaike_weight)};
    if (!prediction_rms.empty()) row.push_back(short_number(prediction_rms[index++]));
    row.push_back(remark);
    ranking.add(row);
  }
  const auto& chosen = result.ranking.at(result.chosen);
  std::string text = heading(run) + "\n" + ranking.text() +
                     "chosen: the simplest within 2 of the least AICc of those that follow the data\n\n" + chosen.name;
  if (chosen.fit.model != chosen.name) text += "   " + chosen.fit.model;
  text += "\n" + parameter_table(chosen.fit) + "\n";
  return text + paragraph("verdict: " + std::string(frac::to_string(result.verdict)) + ". " + result.verdict_sentence);
}

std::string fit_csv(const FitRun& run, const frac::FitResult& result, const FitStatistics& statistics) {
  std::string text = csv_header(run);
  text += "# formula: " + result.model + "\n# cost: " + io::format_number(result.cost) +
          "\n# rms: " + io::format_number(result.rms) + "\n# aicc: " + io::format_number(result.aicc) +
          "\n# bic: " + io::format_number(result.bic) +
          "\n# termination: " + std::string(frac::to_string(result.termination)) +
          "\n# lag_one_correlation: " + io::format_number(statistics.whiteness.lag_one_correlation) +
          "\n# whiteness_p_value: " + io::format_number(statistics.whiteness.p_value) + "\n";
  text += "name,value,standard_error,ci95_lower,ci95_upper,identified,at_bound,fixed";
  if (!statistics.profile.empty()) text += ",profile_lower,profile_upper";
  if (!statistics.bootstrap.empty()) text += ",bootstrap_lower,bootstrap_upper,bootstrap_standard_error";
  text += "\n";
  for (std::size_t i = 0; i < result.parameters.size(); ++i) {
    const auto& parameter = result.parameters[i];
    text += parameter.name;
    for (const double number : {parameter.value, parameter.standard_error, parameter.ci95_lower, parameter.ci95_upper})
      text += "," + io::format_number(number);
    for (const bool flag : {parameter.identified, parameter.at_bound, parameter.fixed}) text += "," + yes_no(flag);
    if (!statistics.profile.empty()) {
      const auto interval = statistics.profile[i].value_or(frac::ProfileInterval{nan, nan, false});
      text += "," + io::format_number(interval.lower) + "," + io::format_number(interval.upper);
    }
    if (!statistics.bootstrap.empty())
      for (const double number :
           {statistics.bootstrap[i].lower, statistics.bootstrap[i].upper, statistics.bootstrap[i].standard_error})
        text += "," + io::format_number(number);
    text += "\n";
  }
  return text;
}

std::string identification_csv(const FitRun& run, const frac::IdentificationResult& result,
                               const std::vector<double>& prediction_rms) {
  std::string text = csv_header(run);
  text += "# verdict: " + std::string(frac::to_string(result.verdict)) +
          "\n# evidence: " + io::format_number(result.evidence) +
          "\n# chosen: " + result.ranking.at(result.chosen).name + "\n";
  text += "name,class,model,free_parameters,cost,rms,aicc,bic,delta_aicc,akaike_weight,termination";
  text += prediction_rms.empty() ? "\n" : ",prediction_rms\n";
  std::size_t index = 0;
  for (const auto& candidate : result.ranking) {
    text += io::csv_field(candidate.name) + "," + std::string(frac::to_string(candidate.model_class)) + "," +
            io::csv_field(candidate.fit.model) + "," + std::to_string(candidate.fit.free_parameters);
    for (const double number : {candidate.fit.cost, candidate.fit.rms, candidate.fit.aicc, candidate.fit.bic,
                                candidate.delta_aicc, candidate.akaike_weight})
      text += "," + io::format_number(number);
    text += "," + std::string(frac::to_string(candidate.fit.termination));
    if (!prediction_rms.empty()) text += "," + io::format_number(prediction_rms[index++]);
    text += "\n";
  }
  return text;
}

}  // namespace fracfit
