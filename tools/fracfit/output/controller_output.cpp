// SPDX-License-Identifier: BSD-3-Clause
#include "output/controller_output.hpp"

#include <cmath>

#include "io/version.hpp"
#include "output/aligned_table.hpp"
#include "output/json.hpp"

namespace fracfit {
namespace {

const char* output_name(frac::SectionOutput output) {
  return output == frac::SectionOutput::state ? "state" : "change";
}

constexpr const char* recursion =
    "x = sum taps_k input_(n-k); per section v += x - rate v; y = direct x + sum weight v (output: state) or direct x "
    "+ sum weight (x - rate v) "
    "(output: change), v from before the update";

Json part_json(const frac::PidFilter& filter, double order, double error) {
  return {{"filter_order", order},
          {"taps", filter.taps.empty() ? Json{1} : Json(filter.taps)},
          {"output", output_name(filter.sections.output)},
          {"direct", filter.sections.direct},
          {"max_relative_error", error}};
}

double derivative_filter_order(const frac::FractionalPidGains& gains) {
  return gains.kd == 0 ? 0 : gains.mu < 1 ? gains.mu : gains.mu - 1;
}

std::string power_of_s(double order) {
  return order == 1 ? "s" : "s^" + short_number(order);
}

std::string formula(const frac::FractionalPidGains& gains) {
  std::string text;
  const auto add = [&](double gain, const std::string& part) {
    if (gain != 0) text += (text.empty() ? "" : " + ") + short_number(gain) + part;
  };
  add(gains.kp, "");
  add(gains.ki, "/" + power_of_s(gains.lambda));
  add(gains.kd, " " + power_of_s(gains.mu));
  return text.empty() ? "0" : text;
}

bool has_band(const frac::FractionalPidDesign& design) {
  return !design.integral().sections.rates.empty() || !design.derivative().sections.rates.empty();
}

// A line on the error of the controller as it runs; empty where it has no band.
std::string accuracy_of(const frac::FractionalPidDesign& design) {
  if (!std::isfinite(design.error())) return {};
  return "whole controller within " + short_number(design.error()) + " relative, worst at " +
         short_number(design.omega_at_error()) + " rad/s\n";
}

}  // namespace

std::string controller_json(const frac::FractionalPidDesign& design, const std::string& command) {
  const frac::FractionalPidConfig& config = design.config();
  const frac::FractionalPidGains& gains = config.gains;
  Json json = origin(command);
  json["kind"] = "fractional-pid";
  json["gains"] = {{"kp", gains.kp}, {"ki", gains.ki}, {"kd", gains.kd}, {"lambda", gains.lambda}, {"mu", gains.mu}};
  json["sample_time"] = config.sample_time;
  json["band"] = has_band(design) ? Json{{"lower", config.band.lower}, {"upper", config.band.upper}} : Json();
  json["discretisation"] = frac::to_string(config.discretisation);
  json["note"] = design.note();
  json["recursion"] = recursion;
  json["integral"] = part_json(design.integral(), gains.ki == 0 ? 0 : 1 - gains.lambda, design.integral_error());
  json["integral"]["then"] = "trapezoidal integrator T/2 (z + 1)/(z - 1)";
  const Json before = gains.mu < 1 ? "lag by the backward rule, y += T/(Tf + T) (x - y)"
                                   : "backward difference with lag, y_n = (Tf y_(n-1) + x_n - x_(n-1))/(Tf + T)";
  json["derivative"] = part_json(design.derivative(), derivative_filter_order(gains), design.derivative_error());
  json["derivative"]["after"] = before;
  json["derivative"]["filter_time"] = config.derivative_filter_time;
  const frac::ParallelSections &integral = design.integral().sections, &derivative = design.derivative().sections;
  json["sections"] = {{"integral", rates_and_weights(integral.rates, integral.weights)},
                      {"derivative", rates_and_weights(derivative.rates, derivative.weights)}};
  json["setpoint_weight"] = config.setpoint_weight;
  json["derivative_setpoint_weight"] = config.derivative_setpoint_weight;
  json["minimum"] = config.minimum;
  json["maximum"] = config.maximum;
  json["anti_windup"] = {{"method", frac::to_string(config.anti_windup)},
                         {"tracking_time", design.tracking_time() > 0 ? Json(design.tracking_time()) : Json()}};
  json["max_relative_error"] = design.error();
  json["omega_at_max_relative_error"] = design.omega_at_error();
  return json.dump() + "\n";
}

std::string filter_json(const frac::DigitalFilterDesign& design, const std::string& model, double error,
                        const std::string& command) {
  Json json = origin(command);
  json["kind"] = "filter";
  json["model"] = model;
  json["sample_time"] = design.sample_time;
  json["recursion"] = recursion;
  json["dead_samples"] = design.dead_samples;
  json["differences"] = design.differences;
  json["states"] = design.states();
  json["taps"] = design.taps;
  json["output"] = output_name(design.sections.output);
  json["direct"] = design.sections.direct;
  json["sections"] = rates_and_weights(design.sections.rates, design.sections.weights);
  json["pairs"] = rates_and_weights(design.pair_rates, design.pair_weights);
  json["integrators"] = design.integrators;
  json["integrator_rule"] = design.rule == frac::IntegratorRule::held ? "held" : "trapezoidal";
  json["max_relative_error"] = error;
  return json.dump() + "\n";
}

std::string controller_table(const frac::FractionalPidDesign& design) {
  const frac::FractionalPidConfig& config = design.config();
  std::string text = formula(config.gains) + ", every " + short_number(config.sample_time) + " s\n\n";
  AlignedTable table({"", "filter", "sections", "taps", "largest error"});
  const auto filter = [&](double order) { return order == 0 ? std::string("none") : power_of_s(order); };
  table.add({"integral", filter(config.gains.ki == 0 ? 0 : 1 - config.gains.lambda),
             std::to_string(design.integral().sections.rates.size()), std::to_string(design.integral().taps.size()),
             short_number(design.integral_error())});
  table.add({"derivative", filter(derivative_filter_order(config.gains)),
             std::to_string(design.derivative().sections.rates.size()), std::to_string(design.derivative().taps.size()),
             short_number(design.derivative_error())});
  text += table.text() + "\n";
  if (has_band(design)) {
    text += "band " + short_number(config.band.lower) + " .. " + short_number(config.band.upper) + " rad/s, " +
            std::string(frac::to_string(config.discretisation)) + "\n";
  }
  text += accuracy_of(design);
  text += "anti-windup " + std::string(frac::to_string(config.anti_windup));
  if (design.tracking_time() > 0) text += ", tracking time " + short_number(design.tracking_time()) + " s";
  text += "\n";
  return design.note().empty() ? text : text + design.note() + "\n";
}

std::string filter_table(const frac::DigitalFilterDesign& design, const std::string& model, double error) {
  const auto counted = [](std::size_t count, const std::string& thing) {
    return std::to_string(count) + " " + thing + (count == 1 ? "" : "s");
  };
  std::string text = model + ", every " + short_number(design.sample_time) + " s\n" +
                     counted(design.states(), "state") + ": " + counted(design.sections.rates.size(), "section");
  const auto add = [&](std::size_t count, const std::string& thing) {
    if (count > 0) text += ", " + counted(count, thing);
  };
  add(design.pair_rates.size(), "complex pair");
  if (design.taps.size() > 1) add(design.taps.size(), "tap");
  add(static_cast<std::size_t>(design.differences), "difference");
  add(static_cast<std::size_t>(design.integrators), "integrator");
  add(design.dead_samples, "sample");
  if (design.dead_samples > 0) text += " of dead time";
  text += "\n";
  if (std::isfinite(error)) text += "largest relative error on the band " + short_number(error) + "\n";
  return text;
}

std::string controller_comment(const frac::FractionalPidDesign& design, const std::string& command) {
  std::string text = "Fractional PID, " + formula(design.config().gains) + ", every " +
                     short_number(design.config().sample_time) + " s, written by fracfit " +
                     std::string(io::version()) + ":\n  " + command;
  std::string accuracy = accuracy_of(design);
  if (!accuracy.empty()) accuracy.pop_back();
  return text + (accuracy.empty() ? "" : "\n") + accuracy + (design.note().empty() ? "" : "\n") + design.note();
}

std::string filter_comment(const frac::DigitalFilterDesign& design, const std::string& model,
                           const std::string& command) {
  return "Filter " + model + ", every " + short_number(design.sample_time) + " s, written by fracfit " +
         std::string(io::version()) + ":\n  " + command;
}

}  // namespace fracfit
