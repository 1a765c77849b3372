// SPDX-License-Identifier: BSD-3-Clause
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <stdexcept>

#include "choice.hpp"
#include "common_options.hpp"
#include "controller_output.hpp"
#include "exit_code.hpp"
#include "frac/digital/c_header.hpp"
#include "frac/digital/digital_filter.hpp"
#include "frac/digital/fractional_pid.hpp"
#include "io/sweep_file.hpp"
#include "subcommand.hpp"

namespace fracfit {
namespace {

struct ControllerArguments {
  CommonOptions common;
  std::string model;
  std::string kp, ki, kd, lambda = "1", mu = "1";
  std::string sample_time, band, tolerance, poles;
  std::string discretisation;
  std::string minimum, maximum, anti_windup = "back-calculation", tracking_time;
  std::string derivative_filter = "0", setpoint_weight = "1", derivative_setpoint_weight = "1", swing = "0.15";
  std::string horizon = "1e9";
  std::string precision = "double", name;
};

std::string format_of(const ControllerArguments& given) {
  if (given.common.format.empty() && given.common.out.ends_with(".h")) return "c";
  return chosen_format(given.common, "json");
}

frac::CHeaderOptions header_options(const ControllerArguments& given, const std::string& default_name) {
  frac::CHeaderOptions header;
  header.name = given.name.empty() ? default_name : given.name;
  frac::check_c_name(header.name);
  header.precision = frac::precision(given.precision);
  return header;
}

double number_or(const std::string& name, const std::string& text, double otherwise) {
  return text.empty() ? otherwise : number_option(name, text);
}

frac::FrequencyBand band_option(const std::string& text) {
  const auto [lower, upper] = range_option("--band", text);
  return {number_option("--band", lower), number_option("--band", upper)};
}

frac::Discretisation discretisation_option(const ControllerArguments& given) {
  return given.discretisation.empty() ? frac::Discretisation::direct : frac::discretisation(given.discretisation);
}

std::optional<frac::ApproximationGoal> goal_option(const ControllerArguments& given) {
  if (!given.tolerance.empty() && !given.poles.empty())
    throw std::invalid_argument("expected --tolerance or --poles, not both");
  if (!given.tolerance.empty()) return frac::Tolerance{number_option("--tolerance", given.tolerance)};
  if (given.poles.empty()) return std::nullopt;
  constexpr std::size_t most = std::numeric_limits<int>::max();
  return frac::PoleCount{static_cast<int>(
      std::min(most, count_option("--poles", given.poles, 1, std::numeric_limits<std::size_t>::max())))};
}

void put_goal(CommandLine& command, const ControllerArguments& given, const std::string& default_tolerance) {
  if (!given.poles.empty()) {
    command.option("--poles", given.poles);
  } else {
    command.option("--tolerance", given.tolerance.empty() ? default_tolerance : given.tolerance);
  }
}

void put_format(CommandLine& command, const std::string& format, const frac::CHeaderOptions& header) {
  if (format != "c") return;
  command.option("--format", format).option("--precision", std::string(frac::to_string(header.precision)));
  command.option("--name", header.name);
}

int run_pid(const ControllerArguments& given) {
  const io::OutputFile out(given.common.out);
  if (given.kp.empty() && given.ki.empty() && given.kd.empty())
    throw std::invalid_argument("expected at least one of --kp, --ki and --kd, or --model");
  frac::FractionalPidConfig config;
  config.gains = {.kp = number_or("--kp", given.kp, 0),
                  .ki = number_or("--ki", given.ki, 0),
                  .kd = number_or("--kd", given.kd, 0),
                  .lambda = number_option("--lambda", given.lambda),
                  .mu = number_option("--mu", given.mu)};
  config.sample_time = number_option("--sample-time", given.sample_time);
  const bool needs_band =
      (config.gains.ki != 0 && config.gains.lambda != 1) || (config.gains.kd != 0 && config.gains.mu != 1);
  if (given.band.empty() && needs_band)
    throw std::invalid_argument("--band is required for orders other than 1: LOW:HIGH in rad/s");
  if (!given.band.empty()) config.band = band_option(given.band);
  if (const auto goal = goal_option(given)) config.goal = *goal;
  config.discretisation = discretisation_option(given);
  constexpr double infinity = std::numeric_limits<double>::infinity();
  config.minimum = number_or("--min", given.minimum, -infinity);
  config.maximum = number_or("--max", given.maximum, infinity);
  config.anti_windup = frac::anti_windup(given.anti_windup);
  config.tracking_time = number_or("--tracking-time", given.tracking_time, 0);
  config.derivative_filter_time = number_option("--derivative-filter", given.derivative_filter);
  config.setpoint_weight = number_option("--setpoint-weight", given.setpoint_weight);
  config.derivative_setpoint_weight = number_option("--derivative-setpoint-weight", given.derivative_setpoint_weight);
  config.most_swing = number_option("--swing", given.swing);
  const frac::FractionalPidDesign design(config);

  const std::string format = format_of(given);
  frac::CHeaderOptions header = header_options(given, "controller");
  CommandLine command("controller");
  for (const auto& [name, value] : {std::pair{"--kp", given.kp}, {"--ki", given.ki}, {"--kd", given.kd}})
    command.option(name, value.empty() ? "0" : value);
  command.option("--lambda", given.lambda).option("--mu", given.mu).option("--sample-time", given.sample_time);
  if (!given.band.empty()) command.option("--band", given.band);
  put_goal(command, given, "1e-3");
  command.option("--discretisation", std::string(frac::to_string(config.discretisation)));
  if (!given.minimum.empty()) command.option("--min", given.minimum);
  if (!given.maximum.empty()) command.option("--max", given.maximum);
  command.option("--anti-windup", given.anti_windup);
  if (!given.tracking_time.empty()) command.option("--tracking-time", given.tracking_time);
  command.option("--derivative-filter", given.derivative_filter).option("--setpoint-weight", given.setpoint_weight);
  command.option("--derivative-setpoint-weight", given.derivative_setpoint_weight).option("--swing", given.swing);
  put_format(command, format, header);
  header.comment = controller_comment(design, command.text());

  out.write(format == "c"      ? frac::c_header(design, header)
            : format == "json" ? controller_json(design, command.text())
                               : controller_table(design));
  if (!design.note().empty() && format != "table") say(given.common, design.note());
  return usable_result;
}

struct FilterResult {
  frac::DigitalFilterDesign design;
  double error = std::numeric_limits<double>::quiet_NaN();  // largest relative one on the band
  std::string note;
};

FilterResult power_filter(const frac::FractionalTransferFunction& model, const ControllerArguments& given,
                          double sample_time) {
  const double order = model.numerator()[0].order - model.denominator()[0].order;
  const frac::DigitalPower power =
      digital_power(order, band_option(given.band), goal_option(given).value_or(frac::Tolerance{1e-3}), sample_time,
                    discretisation_option(given));
  FilterResult result{filter_design(power), power.error.max_relative, ""};
  const double factor = model.numerator()[0].coefficient / model.denominator()[0].coefficient;
  for (double& tap : result.design.taps) tap *= factor;
  if (power.status == frac::ApproximationStatus::not_attainable) result.note = power.message;
  return result;
}

// One set of poles for the band, unless the filter for all frequencies takes no more states or is the only one.
FilterResult model_filter(const frac::FractionalTransferFunction& model, const ControllerArguments& given,
                          double sample_time) {
  const bool has_band = !given.band.empty();
  const double tolerance = number_or("--tolerance", given.tolerance, has_band ? 1e-3 : 1e-9);
  const auto for_all = [&] {
    return FilterResult{filter_design(model, sample_time, tolerance, number_option("--horizon", given.horizon)), NAN,
                        ""};
  };
  // Held between samples, what grows would answer each step by a jump that depends on the band's upper end.
  const bool grows = model.numerator().front().order > model.denominator().front().order;
  if (!has_band || grows) return for_all();
  const frac::RationalModel system = realise(model, band_option(given.band), tolerance);
  FilterResult on_band;
  try {
    on_band = {filter_design(system, sample_time), system.max_relative_error,
               system.status == frac::RationalModelStatus::met ? "" : system.message};
  } catch (const std::invalid_argument& failure) {
    FilterResult all = for_all();
    all.note =
        std::string("A filter for all frequencies is written, because one for the band alone is not possible: ") +
        failure.what() + ".";
    return all;
  }
  FilterResult all = for_all();
  return all.design.states() <= on_band.design.states() ? all : on_band;
}

bool is_power(const frac::FractionalTransferFunction& model) {
  return model.numerator().size() == 1 && model.denominator().size() == 1 && model.delay() == 0;
}

FilterResult filter_for(const frac::FractionalTransferFunction& model, const ControllerArguments& given,
                        double sample_time) {
  if (is_power(model) && !given.band.empty()) return power_filter(model, given, sample_time);
  if (!given.discretisation.empty()) {
    throw std::invalid_argument(
        "--discretisation belongs to a PID or to a power of s on a --band; other models are made for an input that is "
        "constant between samples");
  }
  if (!given.poles.empty()) throw std::invalid_argument("--poles belongs to a power of s on a --band");
  const double order = model.numerator().front().order - model.denominator().front().order;
  if (is_power(model) && order > 0)
    throw std::invalid_argument("--band is required for a power of s: LOW:HIGH in rad/s");
  return model_filter(model, given, sample_time);
}

int run_filter(const ControllerArguments& given) {
  const io::OutputFile out(given.common.out);
  const auto model = frac::FractionalTransferFunction::parse(given.model);
  const FilterResult result = filter_for(model, given, number_option("--sample-time", given.sample_time));

  const std::string format = format_of(given);
  frac::CHeaderOptions header = header_options(given, "filter");
  CommandLine command("controller");
  command.option("--model", given.model).option("--sample-time", given.sample_time);
  if (!given.band.empty()) command.option("--band", given.band);
  if (!given.band.empty() && is_power(model))
    command.option("--discretisation", std::string(frac::to_string(discretisation_option(given))));
  put_goal(command, given, given.band.empty() ? "1e-9" : "1e-3");
  command.option("--horizon", given.horizon);
  put_format(command, format, header);
  header.comment = "Filter " + model.formula() + ", every " + given.sample_time + " s, written by fracfit " +
                   std::string(io::version()) + ":\n  " + command.text();
  out.write(format == "c"      ? frac::c_header(result.design, header)
            : format == "json" ? filter_json(result.design, model.formula(), result.error, command.text())
                               : filter_table(result.design, model.formula(), result.error));
  if (!result.note.empty()) say(given.common, result.note);
  return usable_result;
}

// Those that give sections, which a controller is made of.
std::vector<std::string> section_discretisations() {
  std::vector<std::string> words = spellings(frac::discretisations());
  std::erase(words, std::string(frac::to_string(frac::Discretisation::grunwald_letnikov)));
  return words;
}

// Options of one kind of controller that the other would not heed.
const std::vector<std::string> pid_options{"--kp",
                                           "--ki",
                                           "--kd",
                                           "--lambda",
                                           "--mu",
                                           "--min",
                                           "--max",
                                           "--anti-windup",
                                           "--tracking-time",
                                           "--derivative-filter",
                                           "--setpoint-weight",
                                           "--derivative-setpoint-weight",
                                           "--swing"};
const std::vector<std::string> filter_options{"--horizon"};

std::string first_given(const CLI::App& subcommand, const std::vector<std::string>& names) {
  for (const std::string& name : names) {
    if (subcommand.count(name) > 0) return name;
  }
  return {};
}

}  // namespace

void add_controller(CLI::App& program, Run& run) {
  const auto given = std::make_shared<ControllerArguments>();
  auto* controller =
      program.add_subcommand("controller", "Fractional PID, or any model, as a recursion in the samples: JSON or C");
  const auto option = [&](const char* name, std::string& value, const char* text, const char* type) {
    auto* added = controller->add_option(name, value, text)->type_name(type);
    if (!value.empty()) added->capture_default_str();
    return added;
  };
  option("--kp", given->kp, "Gain of the error; gains left out are 0", "K");
  option("--ki", given->ki, "Gain of the fractional integral, kp + ki/s^lambda + kd s^mu", "K");
  option("--kd", given->kd, "Gain of the fractional derivative", "K");
  option("--lambda", given->lambda, "Order of integration, above 0 and below 2", "ORDER");
  option("--mu", given->mu, "Order of differentiation, above 0 and below 2", "ORDER");
  option("--model", given->model,
         "A filter instead of a PID: a proper model, with fewer states on a --band; or a power of s on a --band",
         "FORMULA");
  option("--sample-time", given->sample_time, "Time between samples, s", "T")->required();
  option("--band", given->band, "Band on which the orders hold, rad/s; cut at a quarter of the sampling frequency",
         "LOW:HIGH");
  option(
      "--tolerance", given->tolerance,
      "Largest relative error on the band; 1e-3 if not given. For a --model without band: of its step response, 1e-9 "
      "if not given",
      "T");
  option("--poles", given->poles, "Number of poles per power, instead of a tolerance", "N");
  option("--horizon", given->horizon,
         "Of a --model for all frequencies: samples it is good for; fewer states for fewer", "N");
  option("--discretisation", given->discretisation, "Of a PID or power (default direct)", "METHOD")
      ->check(one_of(section_discretisations()));
  option("--min", given->minimum, "Least output; no limit if not given", "U");
  option("--max", given->maximum, "Largest output; no limit if not given", "U");
  option("--anti-windup", given->anti_windup, "What the integral does while the output is at a limit", "METHOD")
      ->check(one_of(spellings(frac::anti_windup_methods())));
  option("--tracking-time", given->tracking_time, "Of back-calculation, s; (kp/ki)^(1/lambda) if not given", "T");
  option("--derivative-filter", given->derivative_filter, "Time constant of the lag before the derivative, s", "T");
  option("--setpoint-weight", given->setpoint_weight, "Share of the set-point in the proportional part", "B");
  option("--derivative-setpoint-weight", given->derivative_setpoint_weight,
         "Share of the set-point in the derivative; 0: derivative on the measurement", "C");
  option(
      "--swing", given->swing,
      "How far the derivative's answer to a set-point step may rise again after its peak, share of the peak: more is "
      "more accurate at the upper edge of the band",
      "SHARE");
  option("--precision", given->precision, "Of C code", "REAL")->check(one_of(spellings(frac::precisions())));
  option("--name", given->name, "Of C code: prefix of its functions; controller or filter if not given", "NAME");
  add_common_options(*controller, given->common, {"json", "c", "table"});
  controller->footer(
      "The format is C if FILE ends in .h.\n"
      "Examples:\n"
      "  fracfit controller --kp 2 --ki 3 --kd 0.05 --lambda 0.8 --mu 0.6 --sample-time 1e-3 --band 0.1:300\n"
      "  fracfit controller --kp 2 --ki 3 --lambda 0.8 --sample-time 1e-3 --band 0.1:300 --min -5 --max 5 --out pi.h\n"
      "  fracfit controller --model '1/(0.8 s^2.2 + 0.5 s^0.9 + 1)' --sample-time 0.01 --precision float --out "
      "plant.h\n"
      "  fracfit controller --model '1/(0.8 s^2.2 + 0.5 s^0.9 + 1)' --sample-time 0.01 --band 0.01:100 --format table");
  controller->callback([given, controller, &run] {
    const std::string stray = first_given(*controller, given->model.empty() ? filter_options : pid_options);
    run = [given, stray] {
      if (!stray.empty())
        throw std::invalid_argument(stray + (given->model.empty() ? " is for --model; a PID takes none"
                                                                  : " is for a PID; the filter of a --model has none"));
      return given->model.empty() ? run_pid(*given) : run_filter(*given);
    };
  });
}

}  // namespace fracfit
