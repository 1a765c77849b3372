// SPDX-License-Identifier: BSD-3-Clause
#include "frac/identification/tune.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <stdexcept>

#include "aligned_table.hpp"
#include "choice.hpp"
#include "common_options.hpp"
#include "exit_code.hpp"
#include "io/sweep_file.hpp"
#include "json_number.hpp"
#include "subcommand.hpp"

namespace fracfit {
namespace {

constexpr double degree = std::numbers::pi / 180;

struct TuneArguments {
  CommonOptions common;
  std::string plant, crossover, phase_margin, max_sensitivity, max_complementary, noise, disturbance;
  std::string lambda, mu, filter = "0", horizon, seed = "1";
  std::string structure = "pid", criterion = "sensitivity", step = "setpoint";
  bool flat_phase = false;
};

double angle_option(const char* name, const std::string& text) {
  const double value = number_option(name, text);
  constexpr double straight = 180;
  if (!(value > 0 && value < straight))
    throw std::invalid_argument(std::string(name) + " " + text + ": expected an angle above 0 and below 180 degrees");
  return value;
}

frac::GainBound bound_option(const char* name, const std::string& text) {
  const auto [omega, gain] = pair_option(name, text, "W:GAIN");
  return {number_option(name, omega), number_option(name, gain)};
}

// One number holds the order.
void set_range(const char* name, const std::string& text, frac::OrderRange& range) {
  if (text.empty()) return;
  if (text.find(':') == std::string::npos) {
    range.lower = range.upper = number_option(name, text);
    return;
  }
  const auto [lower, upper] = range_option(name, text);
  range = {number_option(name, lower), number_option(name, upper)};
}

std::string tuning_json(const frac::TuningResult& result, const std::string& plant, const std::string& command) {
  Json json{{"fracfit", io::version()}, {"command", command}, {"plant", plant}};
  json["status"] = frac::to_string(result.status);
  json["message"] = result.message;
  json["controller"] = {
      {"kp", number(result.gains.kp)}, {"ki", number(result.gains.ki)},
      {"kd", number(result.gains.kd)}, {"lambda", number(result.gains.lambda)},
      {"mu", number(result.gains.mu)}, {"derivative_filter_time", number(result.derivative_filter_time)}};
  json["specification"] = Json::array();
  for (const auto& line : result.specification) {
    json["specification"].push_back(
        {{"name", line.name}, {"asked", number(line.asked)}, {"reached", number(line.reached)}, {"met", line.met}});
  }
  json["closed_loop"] = frac::to_string(result.closed_loop);
  json["crossover"] = number(result.crossover);
  json["phase_margin_deg"] = number(result.phase_margin / degree);
  json["phase_slope_deg_per_e_fold"] = number(result.phase_slope / degree);
  json["gain_margin"] = number(result.gain_margin);
  json["max_sensitivity"] = number(result.max_sensitivity);
  json["omega_at_max_sensitivity"] = number(result.omega_max_sensitivity);
  json["max_complementary_sensitivity"] = number(result.max_complementary_sensitivity);
  json["omega_at_max_complementary_sensitivity"] = number(result.omega_max_complementary_sensitivity);
  json["iae"] = number(result.iae);
  json["itae"] = number(result.itae);
  json["evaluations"] = result.evaluations;
  return json.dump(2) + "\n";
}

std::string tuning_table(const frac::TuningResult& result, const std::string& plant) {
  std::string text = "plant " + plant + "\n\n";
  AlignedTable controller({"", "value"});
  controller.add({"kp", short_number(result.gains.kp)});
  controller.add({"ki", short_number(result.gains.ki)});
  controller.add({"kd", short_number(result.gains.kd)});
  controller.add({"lambda", short_number(result.gains.lambda)});
  controller.add({"mu", short_number(result.gains.mu)});
  if (result.derivative_filter_time > 0) {
    controller.add({"derivative filter, s", short_number(result.derivative_filter_time)});
  }
  text += controller.text() + "\n";
  if (!result.specification.empty()) {
    AlignedTable asked({"asked for", "value", "reached", "kept"});
    for (const auto& line : result.specification) {
      asked.add({line.name, short_number(line.asked), short_number(line.reached), line.met ? "yes" : "no"});
    }
    text += asked.text() + "\n";
  }
  AlignedTable loop({"loop", "value", "at, rad/s"});
  loop.add({"crossover, rad/s", short_number(result.crossover), ""});
  loop.add({"phase margin, deg", short_number(result.phase_margin / degree), ""});
  loop.add({"phase slope, deg per e-fold", short_number(result.phase_slope / degree), ""});
  loop.add({"gain margin", std::isinf(result.gain_margin) ? "infinite" : short_number(result.gain_margin), ""});
  loop.add({"max |S|", short_number(result.max_sensitivity), short_number(result.omega_max_sensitivity)});
  loop.add({"max |T|", short_number(result.max_complementary_sensitivity),
            short_number(result.omega_max_complementary_sensitivity)});
  if (std::isfinite(result.iae)) {
    loop.add({"IAE", short_number(result.iae), ""});
    loop.add({"ITAE", short_number(result.itae), ""});
  }
  return text + loop.text() + "\n" + paragraph(result.message);
}

int run_tune(const TuneArguments& given) {
  const io::OutputFile out(given.common.out);
  frac::LoopSpecification asked;
  frac::TuningOptions options;
  CommandLine command("tune");
  command.option("--plant", given.plant);
  const auto take = [&](const char* name, const std::string& text, const auto& set) {
    if (text.empty()) return;
    set(name, text);
    command.option(name, text);
  };
  take("--crossover", given.crossover,
       [&](const char* name, const std::string& text) { asked.crossover = number_option(name, text); });
  take("--phase-margin", given.phase_margin,
       [&](const char* name, const std::string& text) { asked.phase_margin = degree * angle_option(name, text); });
  asked.flat_phase = given.flat_phase;
  if (given.flat_phase) command.flag("--flat-phase");
  take("--max-sensitivity", given.max_sensitivity,
       [&](const char* name, const std::string& text) { asked.max_sensitivity = number_option(name, text); });
  take("--max-complementary-sensitivity", given.max_complementary, [&](const char* name, const std::string& text) {
    asked.max_complementary_sensitivity = number_option(name, text);
  });
  take("--high-frequency", given.noise,
       [&](const char* name, const std::string& text) { asked.high_frequency = bound_option(name, text); });
  take("--low-frequency", given.disturbance,
       [&](const char* name, const std::string& text) { asked.low_frequency = bound_option(name, text); });
  take("--structure", given.structure,
       [&](const char*, const std::string& text) { options.structure = frac::controller_structure(text); });
  take("--lambda", given.lambda,
       [&](const char* name, const std::string& text) { set_range(name, text, options.lambda); });
  take("--mu", given.mu, [&](const char* name, const std::string& text) { set_range(name, text, options.mu); });
  take("--derivative-filter", given.filter,
       [&](const char* name, const std::string& text) { options.derivative_filter_time = number_option(name, text); });
  take("--criterion", given.criterion,
       [&](const char*, const std::string& text) { options.criterion = frac::tuning_criterion(text); });
  take("--horizon", given.horizon,
       [&](const char* name, const std::string& text) { options.horizon = number_option(name, text); });
  options.load_step = given.step == "load";
  command.option("--step", given.step);
  options.seed = count_option("--seed", given.seed, 0, std::numeric_limits<std::uint64_t>::max());
  command.option("--seed", given.seed);

  const auto plant = frac::FractionalTransferFunction::parse(given.plant);
  const frac::TuningResult result = frac::tune(plant, asked, options);
  const std::string format = chosen_format(given.common, "json");
  out.write(format == "json" ? tuning_json(result, plant.formula(), command.text())
                             : tuning_table(result, plant.formula()));
  if (result.status == frac::TuningStatus::met) {
    if (result.mu_at_limit && format != "table") say(given.common, result.message);
    return usable_result;
  }
  say(given.common, result.message);
  return no_usable_result;
}

}  // namespace

void add_tune(CLI::App& program, Run& run) {
  const auto given = std::make_shared<TuneArguments>();
  auto* tune = program.add_subcommand("tune", "Gains and orders of a fractional PID for a plant");
  const auto option = [&](const char* name, std::string& value, const char* description, const char* type) {
    return tune->add_option(name, value, description)->type_name(type);
  };
  option("--plant", given->plant, "Formula, e.g. \"exp(-0.1 s)/(s^1.5 + 2)\"", "FORMULA")->required();
  option("--crossover", given->crossover, "Angular frequency at which |L| = 1, rad/s", "W");
  option("--phase-margin", given->phase_margin, "At the crossover, degrees", "DEG");
  tune->add_flag("--flat-phase", given->flat_phase, "No slope of the phase at the crossover (iso-damping)");
  option("--max-sensitivity", given->max_sensitivity, "Largest |S| = |1/(1 + L)|", "MS");
  option("--max-complementary-sensitivity", given->max_complementary, "Largest |T| = |L/(1 + L)|", "MT");
  option("--high-frequency", given->noise, "|T| <= GAIN from W on (noise)", "W:GAIN");
  option("--low-frequency", given->disturbance, "|S| <= GAIN up to W (disturbances)", "W:GAIN");
  option("--structure", given->structure, "Terms of the controller", "NAME")
      ->check(one_of(spellings(frac::controller_structures())))
      ->capture_default_str();
  option("--lambda", given->lambda, "Order of integration, or its range; 0.1:1.9 if not given", "ORDER|LOW:HIGH");
  option("--mu", given->mu,
         "Order of differentiation, or its range; 0.1:1.9 if not given. Never above what leaves the loop falling as "
         "s^-0.2 at high frequency: beyond that no dead time or lag is small enough to be left out of the plant; a "
         "derivative filter adds 1",
         "ORDER|LOW:HIGH");
  option("--derivative-filter", given->filter, "Time constant of the derivative's filter, s", "T")
      ->capture_default_str();
  option("--criterion", given->criterion, "What is made least, max |S| or the integral of |error| or of t |error|",
         "NAME")
      ->check(one_of(spellings(frac::tuning_criteria())))
      ->capture_default_str();
  option("--horizon", given->horizon, "Length of the step response of iae and itae, s", "T");
  option("--step", given->step, "Where that step enters", "PLACE")
      ->check(one_of({"setpoint", "load"}))
      ->capture_default_str();
  option("--seed", given->seed, "Of the global search", "N")->capture_default_str();
  add_common_options(*tune, given->common, {"json", "table"});
  tune->footer(
      "Examples:\n"
      "  fracfit tune --plant \"3.13 exp(-50 s)/(433.33 s + 1)\" --crossover 0.008 --phase-margin 60 --flat-phase\n"
      "  fracfit tune --plant \"1/(0.8 s^2.2 + 0.5 s^0.9 + 1)\" --crossover 2 --phase-margin 60 "
      "--max-sensitivity 1.4\n"
      "  fracfit tune --plant \"exp(-0.1 s)/(s + 1)\" --criterion iae --horizon 10 --step load "
      "--max-sensitivity 1.6");
  tune->callback([given, &run] { run = [given] { return run_tune(*given); }; });
}

}  // namespace fracfit
