// SPDX-License-Identifier: BSD-3-Clause
#include "output/approximate_output.hpp"

#include <algorithm>
#include <cmath>

#include "io/number.hpp"
#include "output/aligned_table.hpp"
#include "output/document.hpp"
#include "output/json.hpp"

namespace fracfit {
namespace {

struct Outcome {
  std::string status, message;
};

std::string band_text(const frac::FrequencyBand& band) {
  return short_number(band.lower) + " .. " + short_number(band.upper) + " rad/s";
}

Json parallel_json(const frac::ParallelSections& parallel) {
  return {{"output", parallel.output == frac::SectionOutput::state ? "state" : "change"},
          {"direct", parallel.direct},
          {"sections", rates_and_weights(parallel.rates, parallel.weights)}};
}

void add_digital(Json& json, const frac::DigitalPower& digital) {
  json["sample_time"] = digital.sample_time;
  json["sections"] = Json::list(digital.cascade.sections, [](const auto& section) {
    return Json{{"rate", section.rate}, {"feed", section.feed}};
  });
  Json& more = json["digital"];
  more["discretisation"] = frac::to_string(digital.method);
  more["recursion"] =
      "H = taps (y_n = sum taps_k x_(n-k)) * gain * product of sections (y = x + feed v, v += x - rate v) * "
      "differences "
      "* integrators, or parallel in place of gain and sections; there y = direct x + sum weight v (output: state) or "
      "direct x + sum weight (x - rate v) (output: change)";
  more["taps"] = digital.taps;
  more["gain"] = digital.cascade.gain;
  more["parallel"] = parallel_json(digital.parallel);
  more["differences"] = digital.differences;
  more["integrators"] = digital.integrators;
  more["status"] = frac::to_string(digital.status);
  more["message"] = digital.message;
  more["max_relative_error"] = digital.error.max_relative;
  more["omega_at_max_relative_error"] = digital.error.omega_at_maximum;
  more["max_error_decibels"] = digital.error.max_decibels;
  more["max_error_degrees"] = digital.error.max_degrees;
  more["most_amplification_beyond_band"] = digital.most_amplification;
}

// Outcome of continuous system and recursion together: the tolerance is missed where the recursion misses it, even if
// the continuous system meets it.
Outcome outcome_of(const frac::Approximation& result, const frac::DigitalPower* digital) {
  if (result.status != frac::ApproximationStatus::not_attainable && missed(result, digital))
    return {"missed", digital->message};
  return {std::string(frac::to_string(result.status)), result.message};
}

}  // namespace

bool missed(const frac::Approximation& result, const frac::DigitalPower* digital) {
  return result.status == frac::ApproximationStatus::not_attainable ||
         (digital != nullptr && digital->status == frac::ApproximationStatus::not_attainable);
}

std::string approximation_json(const frac::Approximation& result, const frac::DigitalPower* digital,
                               const std::string& command) {
  Json json = origin(command);
  json["order"] = result.order;
  json["band"] = {{"lower", result.band.lower}, {"upper", result.band.upper}};
  json["method"] = frac::to_string(result.method);
  json["parameters"] = Json::object();
  for (const auto& [name, value] : result.parameters) json["parameters"][name] = value;
  const Outcome outcome = outcome_of(result, digital);
  json["status"] = outcome.status;
  json["message"] = outcome.message;
  json["integer_order"] = result.system.integer_order;
  json["gain"] = result.system.gain;
  json["zeros"] = result.system.zeros;
  json["poles"] = result.system.poles;
  json["zero_pairs"] = Json(result.system.zero_pairs);
  json["pole_pairs"] = Json(result.system.pole_pairs);
  json["parallel"] = {
      {"direct", result.parallel.direct},
      {"residues", result.parallel.residues},
      {"pair_residues", Json(result.parallel.pair_residues)},
      {"static_gain", result.parallel.static_gain},
      {"direct_max_relative_error", result.parallel.direct_error},
      {"static_max_relative_error", result.parallel.static_error},
      {"forms",
       "direct + sum residue/(s - pole), or static_gain + sum (residue/pole) s/(s - pole); take the one "
       "of least error"}};
  json["pole_count"] = result.poles;
  json["limit_poles"] = result.limit_poles;
  json["max_relative_error"] = result.error.max_relative;
  json["omega_at_max_relative_error"] = result.error.omega_at_maximum;
  json["max_error_decibels"] = result.error.max_decibels;
  json["max_error_degrees"] = result.error.max_degrees;
  json["grid_points"] = result.error.grid_points;
  if (digital != nullptr) add_digital(json, *digital);
  return json.dump() + "\n";
}

std::string approximation_csv(const frac::Approximation& result, const frac::DigitalPower* digital,
                              const std::string& command) {
  const auto& system = result.system;
  const Outcome outcome = outcome_of(result, digital);
  io::Metadata head{{"method", std::string(frac::to_string(result.method))}};
  const auto entry = [&](const std::string& key, double value) { head.emplace_back(key, io::format_number(value)); };
  for (const auto& [name, value] : result.parameters) entry(name, value);
  head.emplace_back("status", outcome.status);
  head.emplace_back("message", outcome.message);
  entry("integer_order", system.integer_order);
  entry("gain", system.gain);
  entry("direct_max_relative_error", result.parallel.direct_error);
  if (std::isfinite(result.parallel.static_gain)) {
    entry("static_gain", result.parallel.static_gain);
    entry("static_max_relative_error", result.parallel.static_error);
  }
  entry("max_relative_error", result.error.max_relative);
  entry("omega_at_max_relative_error", result.error.omega_at_maximum);
  entry("max_error_decibels", result.error.max_decibels);
  entry("max_error_degrees", result.error.max_degrees);
  entry("limit_poles", result.limit_poles);
  if (digital != nullptr) {
    entry("sample_time", digital->sample_time);
    head.emplace_back("discretisation", frac::to_string(digital->method));
    head.emplace_back("digital_message", digital->message);
    entry("digital_max_relative_error", digital->error.max_relative);
    entry("differences", digital->differences);
    entry("integrators", digital->integrators);
    const auto list = [&](const std::string& key, const std::vector<double>& values) {
      std::string joined;
      for (const double value : values) joined += (joined.empty() ? "" : " ") + io::format_number(value);
      head.emplace_back(key, joined);
    };
    list("taps", digital->taps);
    head.emplace_back("parallel_output", digital->parallel.output == frac::SectionOutput::state ? "state" : "change");
    entry("parallel_direct", digital->parallel.direct);
    list("parallel_rates", digital->parallel.rates);
    list("parallel_weights", digital->parallel.weights);
  }
  struct Root {
    bool is_pole;
    std::complex<double> place, residue;
  };
  std::vector<Root> roots;
  for (const double zero : system.zeros) roots.push_back({false, zero, {}});
  for (const auto& pair : system.zero_pairs)
    for (const auto& zero : {pair, std::conj(pair)}) roots.push_back({false, zero, {}});
  for (std::size_t i = 0; i < system.poles.size(); ++i)
    roots.push_back({true, system.poles[i], result.parallel.residues[i]});
  for (std::size_t i = 0; i < system.pole_pairs.size(); ++i) {
    roots.push_back({true, system.pole_pairs[i], result.parallel.pair_residues[i]});
    roots.push_back({true, std::conj(system.pole_pairs[i]), std::conj(result.parallel.pair_residues[i])});
  }
  const auto fill = [&](std::size_t i, std::vector<Cell>& cells) {
    const auto& [is_pole, place, residue] = roots[i];
    cells.emplace_back(std::string(is_pole ? "pole" : "zero"));
    for (const double value : {place.real(), place.imag()}) cells.emplace_back(value);
    for (const double value : {residue.real(), residue.imag()}) cells.push_back(is_pole ? Cell(value) : Cell(""));
  };
  return text_of({head, {{"root", "re_rad_s", "im_rad_s", "residue_re", "residue_im"}, roots.size(), fill}}, "csv",
                 command);
}

std::string approximation_table(const frac::Approximation& result, const frac::DigitalPower* digital) {
  const auto& system = result.system;
  std::string text = "s^" + short_number(result.order) + " on " + band_text(result.band) + ", " +
                     std::string(frac::to_string(result.method));
  for (const auto& [name, value] : result.parameters) text += ", " + name + " " + short_number(value);
  text += "\n\n";
  AlignedTable roots({"", "zero, rad/s", "pole, rad/s", "residue"});
  for (std::size_t i = 0; i < system.poles.size(); ++i) {
    roots.add({std::to_string(i + 1), i < system.zeros.size() ? short_number(system.zeros[i]) : "",
               short_number(system.poles[i]), short_number(result.parallel.residues[i])});
  }
  const auto complex_text = [](std::complex<double> value, bool both) {
    const std::string sign = both ? " +-" : value.imag() < 0 ? " -" : " +";
    return short_number(value.real()) + sign + short_number(std::abs(value.imag())) + "j";
  };
  for (std::size_t i = 0; i < std::max(system.zero_pairs.size(), system.pole_pairs.size()); ++i) {
    const bool has_pole = i < system.pole_pairs.size();
    roots.add({"pair " + std::to_string(i + 1),
               i < system.zero_pairs.size() ? complex_text(system.zero_pairs[i], true) : "",
               has_pole ? complex_text(system.pole_pairs[i], true) : "",
               has_pole ? complex_text(result.parallel.pair_residues[i], false) : ""});
  }
  if (result.poles > 0) text += roots.text() + "\n";
  text += "gain " + short_number(system.gain);
  if (system.integer_order != 0) text += ", times s^" + std::to_string(system.integer_order);
  text += "\nlargest error " + short_number(result.error.max_relative) + " relative at " +
          short_number(result.error.omega_at_maximum) + " rad/s, " + short_number(result.error.max_decibels) + " dB, " +
          short_number(result.error.max_degrees) + " deg\n";
  text += "poles " + std::to_string(result.poles) + ", attainable limit " + std::to_string(result.limit_poles) + "\n";
  text += result.message + "\n";
  if (digital == nullptr) return text;
  text +=
      "\nevery " + short_number(digital->sample_time) + " s, " + std::string(frac::to_string(digital->method)) + "\n\n";
  const frac::ParallelSections& parallel = digital->parallel;
  if (!parallel.rates.empty()) {
    AlignedTable sections({"section", "rate", "weight"});
    for (std::size_t i = 0; i < parallel.rates.size(); ++i) {
      sections.add({std::to_string(i + 1), short_number(parallel.rates[i]), short_number(parallel.weights[i])});
    }
    text += sections.text() + "direct " + short_number(parallel.direct) + ", output " +
            (parallel.output == frac::SectionOutput::state ? "state" : "change") + "\n";
  }
  constexpr std::size_t most_shown = 20;
  if (digital->taps.size() > 1 && digital->taps.size() <= most_shown) {
    text += "taps";
    for (const double tap : digital->taps) text += " " + short_number(tap);
    text += "\n";
  }
  text += "largest error " + short_number(digital->error.max_relative) + " relative; from the band to half the " +
          "sampling frequency at most " + short_number(digital->most_amplification) + " times the gain of s^" +
          short_number(digital->order) + (digital->order < 0 ? " at the upper edge\n" : "\n");
  return text + digital->message + "\n";
}

}  // namespace fracfit
