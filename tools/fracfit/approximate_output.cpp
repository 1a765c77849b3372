// SPDX-License-Identifier: BSD-3-Clause
#include "approximate_output.hpp"

#include <algorithm>
#include <cmath>

#include "aligned_table.hpp"
#include "io/number.hpp"
#include "io/sweep_file.hpp"
#include "json_number.hpp"

namespace fracfit {
namespace {

struct Outcome {
  std::string status, message;
};

Json array_of(const std::vector<double>& values) {
  Json array = Json::array();
  for (const double value : values) array.push_back(number(value));
  return array;
}

Json array_of(const std::vector<std::complex<double>>& values) {
  Json array = Json::array();
  for (const auto& value : values) array.push_back({number(value.real()), number(value.imag())});
  return array;
}

std::string band_text(const frac::FrequencyBand& band) {
  return short_number(band.lower) + " .. " + short_number(band.upper) + " rad/s";
}

Json parallel_json(const frac::ParallelSections& parallel) {
  Json sections = Json::array();
  for (std::size_t i = 0; i < parallel.rates.size(); ++i) {
    sections.push_back({{"rate", number(parallel.rates[i])}, {"weight", number(parallel.weights[i])}});
  }
  return {{"output", parallel.output == frac::SectionOutput::state ? "state" : "change"},
          {"direct", number(parallel.direct)},
          {"sections", sections}};
}

void add_digital(Json& json, const frac::DigitalPower& digital) {
  json["sample_time"] = number(digital.sample_time);
  json["sections"] = Json::array();
  for (const frac::DeltaSection& section : digital.cascade.sections) {
    json["sections"].push_back({{"rate", number(section.rate)}, {"feed", number(section.feed)}});
  }
  Json& more = json["digital"];
  more["discretisation"] = frac::to_string(digital.method);
  more["recursion"] =
      "H = taps (y_n = sum taps_k x_(n-k)) * gain * product of sections (y = x + feed v, v += x - rate v) * "
      "differences "
      "* integrators, or parallel in place of gain and sections; there y = direct x + sum weight v (output: state) or "
      "direct x + sum weight (x - rate v) (output: change)";
  more["taps"] = array_of(digital.taps);
  more["gain"] = number(digital.cascade.gain);
  more["parallel"] = parallel_json(digital.parallel);
  more["differences"] = digital.differences;
  more["integrators"] = digital.integrators;
  more["status"] = frac::to_string(digital.status);
  more["message"] = digital.message;
  more["max_relative_error"] = number(digital.error.max_relative);
  more["omega_at_max_relative_error"] = number(digital.error.omega_at_maximum);
  more["max_error_decibels"] = number(digital.error.max_decibels);
  more["max_error_degrees"] = number(digital.error.max_degrees);
  more["most_amplification_beyond_band"] = number(digital.most_amplification);
}

// Of the whole: a recursion that misses makes a tolerance that the continuous system keeps a missed one.
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
  Json json{{"fracfit", io::version()}, {"command", command}};
  json["order"] = number(result.order);
  json["band"] = {{"lower", number(result.band.lower)}, {"upper", number(result.band.upper)}};
  json["method"] = frac::to_string(result.method);
  json["parameters"] = Json::object();
  for (const auto& [name, value] : result.parameters) json["parameters"][name] = number(value);
  const Outcome outcome = outcome_of(result, digital);
  json["status"] = outcome.status;
  json["message"] = outcome.message;
  json["integer_order"] = result.system.integer_order;
  json["gain"] = number(result.system.gain);
  json["zeros"] = array_of(result.system.zeros);
  json["poles"] = array_of(result.system.poles);
  json["zero_pairs"] = array_of(result.system.zero_pairs);
  json["pole_pairs"] = array_of(result.system.pole_pairs);
  json["parallel"] = {
      {"direct", number(result.parallel.direct)},
      {"residues", array_of(result.parallel.residues)},
      {"pair_residues", array_of(result.parallel.pair_residues)},
      {"static_gain", number(result.parallel.static_gain)},
      {"direct_max_relative_error", number(result.parallel.direct_error)},
      {"static_max_relative_error", number(result.parallel.static_error)},
      {"forms",
       "direct + sum residue/(s - pole), or static_gain + sum (residue/pole) s/(s - pole); take the one "
       "of least error"}};
  json["pole_count"] = result.poles;
  json["limit_poles"] = result.limit_poles;
  json["max_relative_error"] = number(result.error.max_relative);
  json["omega_at_max_relative_error"] = number(result.error.omega_at_maximum);
  json["max_error_decibels"] = number(result.error.max_decibels);
  json["max_error_degrees"] = number(result.error.max_degrees);
  json["grid_points"] = result.error.grid_points;
  if (digital != nullptr) add_digital(json, *digital);
  return json.dump(2) + "\n";
}

std::string approximation_csv(const frac::Approximation& result, const frac::DigitalPower* digital,
                              const std::string& command) {
  const auto& system = result.system;
  std::string text = "# fracfit: " + std::string(io::version()) + "\n# command: " + command + "\n";
  const auto entry = [&](const std::string& key, const std::string& value) {
    text += "# " + key + ": " + value + "\n";
  };
  entry("method", std::string(frac::to_string(result.method)));
  for (const auto& [name, value] : result.parameters) entry(name, io::format_number(value));
  const Outcome outcome = outcome_of(result, digital);
  entry("status", outcome.status);
  entry("message", outcome.message);
  entry("integer_order", std::to_string(system.integer_order));
  entry("gain", io::format_number(system.gain));
  entry("direct_max_relative_error", io::format_number(result.parallel.direct_error));
  if (std::isfinite(result.parallel.static_gain)) {
    entry("static_gain", io::format_number(result.parallel.static_gain));
    entry("static_max_relative_error", io::format_number(result.parallel.static_error));
  }
  entry("max_relative_error", io::format_number(result.error.max_relative));
  entry("omega_at_max_relative_error", io::format_number(result.error.omega_at_maximum));
  entry("max_error_decibels", io::format_number(result.error.max_decibels));
  entry("max_error_degrees", io::format_number(result.error.max_degrees));
  entry("limit_poles", std::to_string(result.limit_poles));
  if (digital != nullptr) {
    entry("sample_time", io::format_number(digital->sample_time));
    entry("discretisation", std::string(frac::to_string(digital->method)));
    entry("digital_message", digital->message);
    entry("digital_max_relative_error", io::format_number(digital->error.max_relative));
    entry("differences", std::to_string(digital->differences));
    entry("integrators", std::to_string(digital->integrators));
    const auto list = [&](const std::string& key, const std::vector<double>& values) {
      std::string joined;
      for (const double value : values) joined += (joined.empty() ? "" : " ") + io::format_number(value);
      entry(key, joined);
    };
    list("taps", digital->taps);
    entry("parallel_output", digital->parallel.output == frac::SectionOutput::state ? "state" : "change");
    entry("parallel_direct", io::format_number(digital->parallel.direct));
    list("parallel_rates", digital->parallel.rates);
    list("parallel_weights", digital->parallel.weights);
  }
  text += "root,re_rad_s,im_rad_s,residue_re,residue_im\n";
  const auto root = [&](const char* kind, std::complex<double> place) {
    text += std::string(kind) + "," + io::format_number(place.real()) + "," + io::format_number(place.imag());
  };
  const auto residue = [&](std::complex<double> value) {
    text += "," + io::format_number(value.real()) + "," + io::format_number(value.imag()) + "\n";
  };
  for (const double zero : system.zeros) {
    root("zero", zero);
    text += ",,\n";
  }
  for (const auto& pair : system.zero_pairs) {
    for (const auto& zero : {pair, std::conj(pair)}) {
      root("zero", zero);
      text += ",,\n";
    }
  }
  for (std::size_t i = 0; i < system.poles.size(); ++i) {
    root("pole", system.poles[i]);
    residue(result.parallel.residues[i]);
  }
  for (std::size_t i = 0; i < system.pole_pairs.size(); ++i) {
    root("pole", system.pole_pairs[i]);
    residue(result.parallel.pair_residues[i]);
    root("pole", std::conj(system.pole_pairs[i]));
    residue(std::conj(result.parallel.pair_residues[i]));
  }
  return text;
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
          short_number(digital->order) + "\n";
  return text + digital->message + "\n";
}

}  // namespace fracfit
