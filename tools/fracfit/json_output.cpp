// SPDX-License-Identifier: BSD-3-Clause
#include "json_output.hpp"

#include <charconv>
#include <cmath>
#include <cstdint>

#include "io/number.hpp"
#include "json_number.hpp"

namespace fracfit {
namespace {

// An entry of a scene, as a number where it is one.  Whole numbers stay exact: a seed may exceed 2^53.
Json entry(const std::string& text) {
  std::uint64_t whole = 0;
  const char* const end = text.data() + text.size();
  if (const auto [stop, error] = std::from_chars(text.data(), end, whole); error == std::errc{} && stop == end)
    return whole;
  const auto value = io::parse_number(text);
  return value ? number(*value) : Json(text);
}

Json object_of(const io::Metadata& entries) {
  Json object = Json::object();
  for (const auto& [key, value] : entries) object[key] = entry(value);
  return object;
}

Json origin(const std::string& command) {
  return {{"fracfit", io::version()}, {"command", command}};
}

// File names need not be UTF-8; what is not is replaced, where the default would throw.
std::string text_of(const Json& json) {
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

Json parameter_json(const frac::ParameterEstimate& parameter) {
  return {{"name", parameter.name},
          {"value", number(parameter.value)},
          {"standard_error", number(parameter.standard_error)},
          {"ci95", {number(parameter.ci95_lower), number(parameter.ci95_upper)}},
          {"interval", frac::to_string(parameter.interval)},
          {"identified", parameter.identified},
          {"at_bound", parameter.at_bound},
          {"fixed", parameter.fixed}};
}

void append_fit(Json& json, const frac::FitResult& result) {
  json["model"] = result.model;
  json["parameters"] = Json::array();
  for (const auto& parameter : result.parameters) json["parameters"].push_back(parameter_json(parameter));
  json["cost"] = number(result.cost);
  json["rms"] = number(result.rms);
  json["gain_factor"] = number(result.gain_factor);
  json["max_residual"] = number(result.max_residual);
  json["aicc"] = number(result.aicc);
  json["bic"] = number(result.bic);
  json["termination"] = frac::to_string(result.termination);
  json["message"] = result.message;
  json["residuals"] = result.residuals;
  json["free_parameters"] = result.free_parameters;
  json["starts"] = result.starts;
  json["starts_at_best"] = result.starts_at_best;
  json["distinct_minima"] = result.distinct_minima;
  json["confidence_of_optimum"] = number(result.confidence_of_optimum);
  json["condition"] = number(result.condition);
  json["seconds"] = number(result.seconds);
}

Json interval(double lower, double upper) {
  return {number(lower), number(upper)};
}

Json lack_of_fit_json(const frac::LackOfFit& lack) {
  Json json{{"noise_from", frac::to_string(lack.source)},
            {"noise", number(lack.noise)},
            {"misfit", number(lack.misfit)},
            {"p_value", number(lack.p_value)},
            {"correlation", number(lack.correlation)},
            {"correlation_p_value", number(lack.correlation_p_value)},
            {"adequate", lack.adequate},
            {"misses", Json::array()}};
  for (const auto& band : lack.misses) json["misses"].push_back({number(band.lower), number(band.upper)});
  return json;
}

void append_statistics(Json& json, const frac::FitResult& result, const FitStatistics& statistics, bool over_time) {
  for (std::size_t i = 0; i < result.parameters.size(); ++i) {
    const auto& estimate = result.parameters[i];
    Json& parameter = json["parameters"][i];
    parameter["centre"] = {{"value", number(estimate.centre_value)},
                           {"standard_error", number(estimate.centre_standard_error)}};
    if (!statistics.profile.empty()) {
      const auto& profile = statistics.profile[i];
      parameter["profile_ci95"] = profile ? interval(profile->lower, profile->upper) : Json(nullptr);
      if (profile) parameter["profile_found_better_minimum"] = profile->better_minimum_found;
    }
    if (!statistics.bootstrap.empty()) {
      const auto& bootstrap = statistics.bootstrap[i];
      parameter["bootstrap_ci95"] = interval(bootstrap.lower, bootstrap.upper);
      parameter["bootstrap_standard_error"] = number(bootstrap.standard_error);
    }
  }
  json["centre_omega"] = number(result.centre_omega);
  json["correlation"] = Json::array();
  for (const auto& row : statistics.correlation) {
    Json numbers = Json::array();
    for (const double value : row) numbers.push_back(number(value));
    json["correlation"].push_back(std::move(numbers));
  }
  json["outliers"] = Json::array();
  for (std::size_t i = 0; i < statistics.outlier_at.size(); ++i)
    json["outliers"].push_back(
        {{"index", result.outliers[i]}, {over_time ? "time_s" : "omega", number(statistics.outlier_at[i])}});
  json["lack_of_fit"] = lack_of_fit_json(statistics.lack_of_fit);
  json["whiteness"] = {{"lag_one_correlation", number(statistics.whiteness.lag_one_correlation)},
                       {"p_value", number(statistics.whiteness.p_value)}};
  if (statistics.bootstrap_samples > 0) json["bootstrap_samples"] = statistics.bootstrap_samples;
  if (!statistics.growth) return;
  json["growth"] = {
      {"chosen", statistics.growth->chosen}, {"reason", statistics.growth->reason}, {"fits", Json::array()}};
  for (const auto& fit : statistics.growth->fits) {
    Json grown;
    append_fit(grown, fit);
    json["growth"]["fits"].push_back(std::move(grown));
  }
}

Json finalist_json(const frac::IdentificationResult& result, const std::optional<frac::Finalist>& finalist) {
  if (!finalist) return nullptr;
  return {{"name", result.ranking.at(finalist->index).name},
          {"parameters", finalist->parameters},
          {"prediction_rms", number(finalist->prediction_rms)}};
}

Json origin_of_fit(const FitRun& run) {
  Json json = origin(run.command);
  json["data"] = {{"file", run.file},
                  {"points", run.points},
                  {run.over_time ? "time_from_s" : "omega_lower", number(run.lower)},
                  {run.over_time ? "time_to_s" : "omega_upper", number(run.upper)},
                  {"value_unit", run.value_unit.empty() ? Json(nullptr) : Json(run.value_unit)},
                  {"header", object_of(run.file_header)}};
  json["options"] = object_of(run.options);
  return json;
}

Json power_law_json(const frac::PowerLaw& law) {
  return {{"coefficient", number(law.coefficient)},
          {"exponent", number(law.exponent)},
          {"coefficient_ci95", {number(law.coefficient_ci95_lower), number(law.coefficient_ci95_upper)}},
          {"exponent_ci95", {number(law.exponent_ci95_lower), number(law.exponent_ci95_upper)}},
          {"r_squared", number(law.r_squared)}};
}

Json laws_json(double a_coefficient, double a_exponent, double b_coefficient, double b_exponent) {
  return {{"a_of_clearance", {{"coefficient", number(a_coefficient)}, {"exponent", number(a_exponent)}}},
          {"b_of_clearance", {{"coefficient", number(b_coefficient)}, {"exponent", number(b_exponent)}}}};
}

Json constants_json(const backlash::JumpGrid& grid) {
  Json constants = Json::array();
  for (const auto& constant : grid.constants)
    constants.push_back(
        {{"restitution", number(constant.restitution)},
         {"similarity_constant", constant.similarity_constant ? number(*constant.similarity_constant) : Json(nullptr)},
         {"averaged", constant.similarity_constant.has_value()},
         {"meaning", constant.message}});
  return constants;
}

void append_sweep(Json& json, const backlash::DescribingFunctionSweep& sweep) {
  json["scene"] = object_of(io::scene_of(sweep));
  json["points"] = Json::array();
  for (const auto& point : sweep.points)
    json["points"].push_back({{"omega_rad_s", number(point.omega)},
                              {"re_m_per_n", number(point.value.real())},
                              {"im_m_per_n", number(point.value.imag())},
                              {"regime", backlash::to_string(point.regime)},
                              {"period", point.period},
                              {"impacts_per_period", number(point.impacts_per_period)},
                              {"uncertainty_m_per_n", number(point.uncertainty)},
                              {"third_harmonic_ratio", number(point.third_harmonic_ratio)},
                              {"even_harmonic_ratio", number(point.even_harmonic_ratio)},
                              {"energy_defect", number(point.energy_defect)},
                              {"lyapunov_exponent", number(point.lyapunov_exponent)}});
}

}  // namespace

std::string sweep_json(const backlash::DescribingFunctionSweep& sweep, const std::string& command) {
  Json json = origin(command);
  append_sweep(json, sweep);
  return text_of(json);
}

std::string sweeps_json(const std::vector<backlash::DescribingFunctionSweep>& sweeps, const std::string& command) {
  Json json = origin(command);
  json["sweeps"] = Json::array();
  for (const auto& sweep : sweeps) append_sweep(json["sweeps"].emplace_back(Json::object()), sweep);
  return text_of(json);
}

std::string static_curve_json(const io::StaticCurve& curve, const std::string& command) {
  Json json = origin(command);
  json["scene"] = object_of(io::scene_of(curve));
  json["points"] = Json::array();
  for (std::size_t i = 0; i < curve.omega.size(); ++i)
    json["points"].push_back({{"omega_rad_s", number(curve.omega[i])},
                              {"re_m_per_n", number(curve.value[i].real())},
                              {"im_m_per_n", number(curve.value[i].imag())},
                              {"regime", "static"}});
  return text_of(json);
}

std::string fit_json(const FitRun& run, const frac::FitResult& result, const FitStatistics& statistics) {
  Json json = origin_of_fit(run);
  append_fit(json, result);
  append_statistics(json, result, statistics, run.over_time);
  return text_of(json);
}

std::string identification_json(const FitRun& run, const frac::IdentificationResult& result,
                                const std::vector<double>& prediction_rms) {
  Json json = origin_of_fit(run);
  json["ranking"] = Json::array();
  for (const auto& candidate : result.ranking) {
    Json ranked{{"name", candidate.name}, {"class", frac::to_string(candidate.model_class)}};
    append_fit(ranked, candidate.fit);
    ranked["delta_aicc"] = number(candidate.delta_aicc);
    ranked["akaike_weight"] = number(candidate.akaike_weight);
    ranked["lack_of_fit"] = lack_of_fit_json(candidate.lack_of_fit);
    if (!prediction_rms.empty()) ranked["prediction_rms"] = number(prediction_rms[json["ranking"].size()]);
    json["ranking"].push_back(std::move(ranked));
  }
  json["chosen"] = result.ranking.at(result.chosen).name;
  json["verdict"] = frac::to_string(result.verdict);
  json["evidence"] = number(result.evidence);
  json["verdict_sentence"] = result.verdict_sentence;
  json["log10_odds"] = number(result.log10_odds);
  json["fractional"] = finalist_json(result, result.fractional);
  json["integer"] = finalist_json(result, result.integer);
  json["differ_most"] = {{"omega", number(result.differ_most_omega)}, {"relative", number(result.differ_most)}};
  json["skipped"] = result.skipped;
  return text_of(json);
}

std::string jump_constants_json(const std::string& command, const backlash::JumpGrid& grid) {
  Json json = origin(command);
  json["criterion"] = backlash::to_string(grid.criterion);
  json["mean_similarity_constant"] = number(grid.mean_similarity_constant);
  json["averaged"] = averaged_count(grid);
  json["left_out"] = grid.constants.size() - averaged_count(grid);
  json["constants"] = constants_json(grid);
  return text_of(json);
}

std::string jump_law_json(const JumpLawRun& run, const backlash::JumpLaw& law) {
  Json json = origin(run.command);
  json["scene"] = {{"mass1_kg", number(run.mass1)},
                   {"mass2_kg", number(run.mass2)},
                   {"criterion", backlash::to_string(law.criterion)}};
  json["points"] = Json::array();
  for (const auto& point : law.points)
    json["points"].push_back({{"force", number(point.force)},
                              {"clearance", number(point.clearance)},
                              {"restitution", number(point.restitution)},
                              {"omega_jump", point.omega_jump ? number(*point.omega_jump) : Json(nullptr)}});
  json["constants"] = constants_json(law);
  json["averaged"] = averaged_count(law);
  json["left_out"] = law.constants.size() - averaged_count(law);
  if (!law.message.empty()) json["message"] = law.message;
  json["laws"] = Json::array();
  for (const auto& [clearance, force_law] : law.laws)
    json["laws"].push_back(
        {{"clearance", number(clearance)},
         {"a", number(force_law.coefficient)},
         {"b", number(force_law.exponent)},
         {"a_ci95", {number(force_law.coefficient_ci95_lower), number(force_law.coefficient_ci95_upper)}},
         {"b_ci95", {number(force_law.exponent_ci95_lower), number(force_law.exponent_ci95_upper)}},
         {"r_squared", number(force_law.r_squared)}});
  json["a_of_clearance"] = power_law_json(law.a_of_clearance);
  json["b_of_clearance"] = power_law_json(law.b_of_clearance);

  const auto differences = [&](double a_coefficient, double a_exponent, double b_coefficient) {
    return Json{{"a_coefficient", number(percent_difference(law.a_of_clearance.coefficient, a_coefficient))},
                {"a_exponent", number(percent_difference(law.a_of_clearance.exponent, a_exponent))},
                {"b_coefficient", number(percent_difference(law.b_of_clearance.coefficient, b_coefficient))}};
  };
  const backlash::PublishedJumpLaw published;
  json["published"] =
      laws_json(published.a_coefficient, published.a_exponent, published.b_coefficient, published.b_exponent);
  json["published"]["source"] = "Duarte, Tenreiro Machado (2009), eq. (8), masses 1 kg";
  json["published"]["difference_percent"] =
      differences(published.a_coefficient, published.a_exponent, published.b_coefficient);
  json["published"]["b_exponent_difference"] = number(law.b_of_clearance.exponent - published.b_exponent);
  const SimilarityLaw similarity = similarity_law(run, law);
  json["similarity"] =
      laws_json(similarity.a_coefficient, similarity.a_exponent, similarity.b_coefficient, similarity.b_exponent);
  json["similarity"]["mean_constant"] = number(law.mean_similarity_constant);
  json["similarity"]["difference_percent"] =
      differences(similarity.a_coefficient, similarity.a_exponent, similarity.b_coefficient);
  json["similarity"]["b_exponent_difference"] = number(law.b_of_clearance.exponent - similarity.b_exponent);
  return text_of(json);
}

}  // namespace fracfit
