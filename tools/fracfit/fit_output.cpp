#include "fit_output.hpp"

#include "aligned_table.hpp"
#include "io/number.hpp"
#include "io/sweep_file.hpp"

namespace fracfit {
namespace {

std::string interval(double lower, double upper) {
  return short_number(lower) + " .. " + short_number(upper);
}

std::string option_of(const FitRun& run, std::string_view key) {
  return std::string(io::find_value(run.options, key).value_or(std::string_view{}));
}

std::string heading(const FitRun& run) {
  std::string text = "data       " + run.file + ", " + std::to_string(run.points) + " points, " +
                     interval(run.omega_lower, run.omega_upper) + " rad/s";
  if (!run.value_unit.empty()) text += ", values in " + run.value_unit;
  text += "\nresiduals  " + option_of(run, "component") + ", " + option_of(run, "weight") + " weight";
  if (option_of(run, "loss") != "none") text += ", " + option_of(run, "loss") + " loss";
  if (option_of(run, "realisation") != "exact") text += ", powers of s through " + option_of(run, "realisation");
  return text + "\n";
}

std::string state_of(const frac::ParameterEstimate& parameter) {
  if (parameter.fixed) return "fixed";
  if (parameter.at_bound) return "at its bound: no interval";
  if (!parameter.identified) return "not identified by these data";
  return "";
}

std::string parameter_table(const frac::FitResult& result) {
  AlignedTable table({"parameter", "value", "standard error", "95 % interval", ""});
  for (const auto& parameter : result.parameters) {
    const bool has_interval = parameter.ci95_lower == parameter.ci95_lower && !parameter.fixed;
    table.add({parameter.name, short_number(parameter.value),
               parameter.fixed ? "-" : short_number(parameter.standard_error),
               has_interval ? interval(parameter.ci95_lower, parameter.ci95_upper) : "-", state_of(parameter)});
  }
  return table.text();
}

std::string closing(const frac::FitResult& result) {
  std::string text = "cost " + short_number(result.cost) + " (sum of " + std::to_string(result.residuals) +
                     " squared residuals), rms " + short_number(result.rms) + ", largest " +
                     short_number(result.max_residual) + "\n";
  text += "AICc " + short_number(result.aicc) + ", BIC " + short_number(result.bic) + "\n";
  return text + std::string(frac::to_string(result.termination)) + ": " + result.message + " " +
         short_number(result.seconds) + " s.\n";
}

std::string csv_header(const FitRun& run) {
  std::string text =
      "# fracfit: " + std::string(io::version()) + "\n# command: " + run.command + "\n# data: " + run.file + "\n";
  for (const auto& [key, value] : run.options) text += "# " + key + ": " + value + "\n";
  return text;
}

// A field that holds a comma or a quote is put in quotes.
std::string csv_text(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

std::string yes_no(bool value) {
  return value ? "true" : "false";
}

}  // namespace

std::string fit_table(const FitRun& run, const frac::FitResult& result) {
  return "model      " + result.model + "\n" + heading(run) + "\n" + parameter_table(result) + "\n" + closing(result);
}

std::string identification_table(const FitRun& run, const frac::IdentificationResult& result) {
  AlignedTable ranking({"model", "class", "free", "rms", "AICc above best", "share of evidence", ""});
  for (const auto& candidate : result.ranking) {
    std::string remark;
    if (candidate.fit.termination != frac::FitTermination::converged)
      remark = frac::to_string(candidate.fit.termination);
    if (&candidate == &result.ranking.at(result.chosen)) remark = "chosen: simplest within 2 of the best";
    ranking.add({candidate.name, std::string(frac::to_string(candidate.model_class)),
                 std::to_string(candidate.fit.free_parameters), short_number(candidate.fit.rms),
                 short_number(candidate.delta_aicc), short_number(candidate.akaike_weight), remark});
  }
  const auto& chosen = result.ranking.at(result.chosen);
  std::string text = heading(run) + "\n" + ranking.text() + "\n" + chosen.name;
  if (chosen.fit.model != chosen.name) text += "   " + chosen.fit.model;
  text += "\n" + parameter_table(chosen.fit) + "\n";
  return text + "verdict: " + std::string(frac::to_string(result.verdict)) + ". " + result.verdict_sentence + "\n";
}

std::string fit_csv(const FitRun& run, const frac::FitResult& result) {
  std::string text = csv_header(run);
  text += "# formula: " + result.model + "\n# cost: " + io::format_number(result.cost) +
          "\n# rms: " + io::format_number(result.rms) + "\n# aicc: " + io::format_number(result.aicc) +
          "\n# bic: " + io::format_number(result.bic) +
          "\n# termination: " + std::string(frac::to_string(result.termination)) + "\n";
  text += "name,value,standard_error,ci95_lower,ci95_upper,identified,at_bound,fixed\n";
  for (const auto& parameter : result.parameters) {
    text += parameter.name;
    for (const double number : {parameter.value, parameter.standard_error, parameter.ci95_lower, parameter.ci95_upper})
      text += "," + io::format_number(number);
    for (const bool flag : {parameter.identified, parameter.at_bound, parameter.fixed}) text += "," + yes_no(flag);
    text += "\n";
  }
  return text;
}

std::string identification_csv(const FitRun& run, const frac::IdentificationResult& result) {
  std::string text = csv_header(run);
  text += "# verdict: " + std::string(frac::to_string(result.verdict)) +
          "\n# evidence: " + io::format_number(result.evidence) +
          "\n# chosen: " + result.ranking.at(result.chosen).name + "\n";
  text += "name,class,model,free_parameters,cost,rms,aicc,bic,delta_aicc,akaike_weight,termination\n";
  for (const auto& candidate : result.ranking) {
    text += csv_text(candidate.name) + "," + std::string(frac::to_string(candidate.model_class)) + "," +
            csv_text(candidate.fit.model) + "," + std::to_string(candidate.fit.free_parameters);
    for (const double number : {candidate.fit.cost, candidate.fit.rms, candidate.fit.aicc, candidate.fit.bic,
                                candidate.delta_aicc, candidate.akaike_weight})
      text += "," + io::format_number(number);
    text += "," + std::string(frac::to_string(candidate.fit.termination)) + "\n";
  }
  return text;
}

}  // namespace fracfit
