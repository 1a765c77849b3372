// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <limits>
#include <optional>
#include <stdexcept>

#include "commands/subcommand.hpp"
#include "frac/digital/c_header.hpp"
#include "frac/digital/digital_filter.hpp"
#include "frac/digital/fractional_pid.hpp"
#include "io/number.hpp"
#include "io/version.hpp"
#include "options/model_options.hpp"
#include "output/controller_output.hpp"

namespace fracfit {
namespace {

struct FilterRequest {
  std::optional<frac::FrequencyBand> band;
  GoalOptions goal;
  std::optional<frac::Discretisation> discretisation;
  double samples = 1e9;
};

bool is_power(const frac::FractionalTransferFunction& model) {
  return model.numerator().size() == 1 && model.denominator().size() == 1 && model.delay() == 0;
}

frac::FilterChoice filter_for(const frac::FractionalTransferFunction& model, const FilterRequest& given,
                              double sample_time) {
  if (is_power(model) && given.band)
    return frac::power_filter(model, *given.band, given.goal.goal().value_or(frac::Tolerance{1e-3}), sample_time,
                              given.discretisation.value_or(frac::Discretisation::direct));
  if (given.discretisation) {
    throw std::invalid_argument(
        "--discretisation belongs to a PID or to a power of s on a --band; other models are made for an input that is "
        "constant between samples");
  }
  if (given.goal.poles) throw std::invalid_argument("--poles belongs to a power of s on a --band");
  const double order = model.numerator().front().order - model.denominator().front().order;
  if (is_power(model) && order > 0)
    throw std::invalid_argument("--band is required for a power of s: LOW:HIGH in rad/s");
  return frac::model_filter(model, given.band, sample_time, given.goal.tolerance.value_or(given.band ? 1e-3 : 1e-9),
                            given.samples);
}

// Those that give sections, which a controller is made of.
std::vector<frac::Discretisation> section_discretisations() {
  const auto all = frac::discretisations();
  std::vector<frac::Discretisation> some(all.begin(), all.end());
  std::erase(some, frac::Discretisation::grunwald_letnikov);
  return some;
}

class Controller : public Command {
 public:
  Controller() : Command("controller", "Fractional PID, or any model, as a recursion in the samples: JSON or C") {
    Options& o = options();
    const Condition model{"--model"};
    constexpr const char* why = "which is a filter in place of a PID";
    o.number("--kp", config_.gains.kp, "Gain of the error", "K").not_with(model, why);
    o.number("--ki", config_.gains.ki, "Gain of the fractional integral, kp + ki/s^lambda + kd s^mu", "K")
        .not_with(model, why);
    o.number("--kd", config_.gains.kd, "Gain of the fractional derivative", "K").not_with(model, why);
    o.number("--lambda", config_.gains.lambda, "above 0 and below 2").not_with(model, why);
    o.number("--mu", config_.gains.mu, "above 0 and below 2").not_with(model, why);
    o.parsed("--model", model_, formula_of,
             "a filter instead of a PID: a proper model, with fewer states on a --band; or a power of s on a --band");
    o.number("--sample-time", config_.sample_time).required();
    o.parsed("--band", filter_.band, band_of, "the orders hold there; cut at a quarter of the sampling frequency");
    add_goal(o, filter_.goal, "on the band; of a --model without band: of its step response", "instead of a tolerance");
    o["--tolerance"].default_is("1e-3, without a band 1e-9");
    o.at_most_one({"--tolerance", "--poles"});
    o.choice("--discretisation", filter_.discretisation, section_discretisations(), "for a PID or power")
        .default_is("direct");
    o.number("--min", minimum_, "Least output", "U").default_is("no limit").not_with(model, why);
    o.number("--max", maximum_, "Largest output", "U").default_is("no limit").not_with(model, why);
    o.choice("--anti-windup", config_.anti_windup, frac::anti_windup_methods(),
             "What the integral does while the output is at a limit", "METHOD")
        .not_with(model, why);
    o.number("--tracking-time", tracking_time_, "Of back-calculation, s", "T")
        .default_is("(kp/ki)^(1/lambda)")
        .not_with(model, why);
    o.number("--derivative-filter", config_.derivative_filter_time).not_with(model, why);
    o.number("--setpoint-weight", config_.setpoint_weight, "Share of the set-point in the proportional part", "B")
        .not_with(model, why);
    o.number("--derivative-setpoint-weight", config_.derivative_setpoint_weight,
             "Share of the set-point in the derivative; 0: derivative on the measurement", "C")
        .not_with(model, why);
    o.number("--swing", config_.most_swing,
             "How far the derivative's answer to a set-point step may rise again after its peak, share of the peak: "
             "more is more accurate at the upper edge of the band",
             "SHARE")
        .not_with(model, why);
    o.number("--sample-count", filter_.samples,
             "Of a --model for all frequencies: samples it is good for; fewer states for fewer", "N")
        .otherwise("1e9")
        .only_with(model)
        .was("--horizon");
    o.choice("--precision", header_.precision, frac::precisions(), "Of C code", "REAL").unsaid();
    o.text("--name", name_, "prefix of the functions of C code").default_is("controller or filter").unsaid();
    add_common({"json", "c", "table"});
    set_footer(
        "The format is C if FILE ends in .h.\n"
        "Examples:\n"
        "  fracfit controller --kp 2 --ki 3 --kd 0.05 --lambda 0.8 --mu 0.6 --sample-time 1e-3 --band 0.1:300\n"
        "  fracfit controller --kp 2 --ki 3 --lambda 0.8 --sample-time 1e-3 --band 0.1:300 --min -5 --max 5 --out "
        "pi.h\n"
        "  fracfit controller --model '1/(0.8 s^2.2 + 0.5 s^0.9 + 1)' --sample-time 0.01 --precision float --out "
        "plant.h\n"
        "  fracfit controller --model '1/(0.8 s^2.2 + 0.5 s^0.9 + 1)' --sample-time 0.01 --band 0.01:100 --format "
        "table");
  }

 private:
  [[nodiscard]] std::string format() const override {
    return !options()["--format"].is_given() && out().ends_with(".h") ? "c" : Command::format();
  }

  void check() override {
    header_.name = name_.empty() ? (model_ ? "filter" : "controller") : name_;
    frac::check_c_name(header_.name);
    if (model_) return;
    const auto& gains = config_.gains;
    if (!options()["--kp"].is_given() && !options()["--ki"].is_given() && !options()["--kd"].is_given())
      throw std::invalid_argument("expected at least one of --kp, --ki and --kd, or --model");
    const bool needs_band = (gains.ki != 0 && gains.lambda != 1) || (gains.kd != 0 && gains.mu != 1);
    if (!filter_.band && needs_band)
      throw std::invalid_argument("--band is required for orders other than 1: LOW:HIGH in rad/s");
  }

  // The command line with the goal, and what shapes C code.
  std::string whole_command_line(const char* tolerance) {
    if (!filter_.goal.goal()) options()["--tolerance"].say(tolerance);
    if (format() != "c") return command_line();
    return command_line() + " --format c --precision " + std::string(frac::to_string(header_.precision)) + " --name " +
           header_.name;
  }

  int run_pid() {
    if (filter_.band) config_.band = *filter_.band;
    if (const auto goal = filter_.goal.goal()) config_.goal = *goal;
    config_.discretisation = filter_.discretisation.value_or(frac::Discretisation::direct);
    options()["--discretisation"].say(std::string(frac::to_string(config_.discretisation)));
    constexpr double infinity = std::numeric_limits<double>::infinity();
    config_.minimum = minimum_.value_or(-infinity);
    config_.maximum = maximum_.value_or(infinity);
    config_.tracking_time = tracking_time_.value_or(0);
    const frac::FractionalPidDesign design(config_);
    const std::string command = whole_command_line("1e-3");
    header_.comment = controller_comment(design, command);
    write(format() == "c"      ? frac::c_header(design, header_)
          : format() == "json" ? controller_json(design, command)
                               : controller_table(design));
    if (!design.note().empty() && format() != "table") say(design.note());
    return usable_result;
  }

  int run_filter() {
    const frac::FilterChoice result = filter_for(*model_, filter_, config_.sample_time);
    if (filter_.band && is_power(*model_))
      options()["--discretisation"].say(
          std::string(frac::to_string(filter_.discretisation.value_or(frac::Discretisation::direct))));
    const std::string command = whole_command_line(filter_.band ? "1e-3" : "1e-9");
    header_.comment = "Filter " + model_->formula() + ", every " + options()["--sample-time"].text() +
                      " s, written by fracfit " + std::string(io::version()) + ":\n  " + command;
    write(format() == "c"      ? frac::c_header(result.design, header_)
          : format() == "json" ? filter_json(result.design, model_->formula(), result.max_relative_error, command)
                               : filter_table(result.design, model_->formula(), result.max_relative_error));
    if (!result.note.empty()) say(result.note);
    return usable_result;
  }

  int run() override { return model_ ? run_filter() : run_pid(); }

  frac::FractionalPidConfig config_;
  std::optional<frac::FractionalTransferFunction> model_;
  FilterRequest filter_;
  std::optional<double> minimum_, maximum_, tracking_time_;
  frac::CHeaderOptions header_;
  std::string name_;
};

}  // namespace

std::unique_ptr<Command> make_controller() {
  return std::make_unique<Controller>();
}

}  // namespace fracfit
