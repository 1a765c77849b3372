// SPDX-License-Identifier: BSD-3-Clause
#include "options/controller_request.hpp"

#include <limits>
#include <stdexcept>
#include <string>
#include <variant>
#include <vector>

#include "output/aligned_table.hpp"
#include "output/controller_output.hpp"

namespace fracfit {
namespace {

bool is_power(const frac::FractionalTransferFunction& model) {
  return model.numerator().size() == 1 && model.denominator().size() == 1 && model.delay() == 0;
}

// Discretisations that give sections, which a controller is made of.
std::vector<frac::Discretisation> section_discretisations() {
  const auto all = frac::discretisations();
  std::vector<frac::Discretisation> some(all.begin(), all.end());
  std::erase(some, frac::Discretisation::grunwald_letnikov);
  return some;
}

frac::CascadeGains cascade_of(std::string_view name, const std::string& text) {
  const std::vector<double> values = numbers_of(name, text);
  const bool has_time = values.size() == 3;
  if (values.size() != 2 && !has_time)
    throw std::invalid_argument(std::string(name) + " " + text + ": expected K1,K2 or K1,K2,T");
  for (const double value : values)
    if (!(value > 0)) throw std::invalid_argument(std::string(name) + " " + text + ": allowed are numbers above 0");
  frac::CascadeGains cascade{values[0], values[1]};
  if (has_time) cascade.integral_time = values[2];
  return cascade;
}

// The filters keep the tolerance, but the rules beside them need not.
std::string note_on_rules(const frac::FractionalPidDesign& design) {
  const frac::FractionalPidConfig& config = design.config();
  const auto* asked = std::get_if<frac::Tolerance>(&config.goal);
  constexpr double clearly = 2;
  const bool has_rules = config.gains.kd != 0 && (config.gains.mu >= 1 || config.derivative_filter_time > 0);
  const bool has_filters = design.integral_error() > 0 || design.derivative_error() > 0;
  if (asked == nullptr || !has_rules || !has_filters || !(design.error() > clearly * asked->value)) return {};
  return "The whole controller is off by " + short_number(design.error(), 3) + " at " +
         short_number(design.omega_at_error(), 3) +
         " rad/s: a lag or a whole differentiation errs by half of frequency times sample time.";
}

}  // namespace

void ControllerRequest::declare(Options& o, SampleTime sample_time) {
  config_.sample_time = std::numeric_limits<double>::quiet_NaN();
  const Condition model{"--model"};
  constexpr const char* why = "which is a filter in place of a PID";
  o.number("--kp", config_.gains.kp, "Gain of the error", "K").not_with(model, why);
  o.number("--ki", config_.gains.ki, "Gain of the fractional integral, kp + ki/s^lambda + kd s^mu", "K")
      .not_with(model, why);
  o.number("--kd", config_.gains.kd, "Gain of the fractional derivative", "K").not_with(model, why);
  o.number("--lambda", config_.gains.lambda, "0.001 to 1.999").not_with(model, why);
  o.number("--mu", config_.gains.mu, "0.001 to 1.999").not_with(model, why);
  o.parsed("--cascade", cascade_, cascade_of,
           "A position controller K1 around the speed controller K2 (1 + 1/(T s)), as a PID, instead of its gains and "
           "set-point weights",
           "K1,K2[,T]")
      .not_with(model, why);
  for (const char* name : {"--kp", "--ki", "--kd", "--lambda", "--mu"})
    o[name].not_with({"--cascade"}, "which gives the gains");
  o.parsed("--model", model_, formula_of,
           "a filter instead of a PID: a proper model, with fewer states on a --band; or a power of s on a --band");
  Option& time = o.number("--sample-time", config_.sample_time);
  if (sample_time == SampleTime::required) time.required();
  o.parsed("--band", band_, band_of, "the orders hold there; cut at a quarter of the sampling frequency");
  add_goal(
      o, goal_,
      "on the band; of a --model without band: of the largest value of its step response within --sample-count samples",
      "instead of a tolerance");
  o["--tolerance"].default_is("1e-3, without a band 1e-9");
  o.at_most_one({"--tolerance", "--poles"});
  o.choice("--discretisation", discretisation_, section_discretisations(), "for a PID or power").default_is("direct");
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
  for (const char* name : {"--setpoint-weight", "--derivative-setpoint-weight"})
    o[name].not_with({"--cascade"}, "which gives the weights");
  o.number("--swing", config_.most_swing,
           "How far the derivative's answer to a set-point step may rise again after its peak, share of the peak: "
           "more is more accurate at the upper edge of the band",
           "SHARE")
      .not_with(model, why);
  o.number("--sample-count", samples_,
           "Of a --model for all frequencies: samples it is good for; fewer take fewer states, and of a model that "
           "integrates they make the first ones more accurate",
           "N")
      .otherwise("1e9")
      .only_with(model);
}

void ControllerRequest::check(const Options& options) const {
  if (model_) return;
  const auto& gains = config_.gains;
  if (!cascade_ && !options["--kp"].is_given() && !options["--ki"].is_given() && !options["--kd"].is_given())
    throw std::invalid_argument("expected at least one of --kp, --ki and --kd, or --cascade or --model");
  const bool needs_band = (gains.ki != 0 && gains.lambda != 1) || (gains.kd != 0 && gains.mu != 1);
  if (!band_ && needs_band)
    throw std::invalid_argument("--band is required for orders other than 1: LOW:HIGH in rad/s");
}

frac::FractionalPidDesign ControllerRequest::pid(Options& options) {
  if (band_) config_.band = *band_;
  if (cascade_) {
    config_.gains = frac::pid_of(*cascade_);
    config_.setpoint_weight = frac::setpoint_weight_of(*cascade_);
    config_.derivative_setpoint_weight = 0;
  }
  if (const auto goal = goal_.goal()) config_.goal = *goal;
  config_.discretisation = discretisation_.value_or(frac::Discretisation::direct);
  options["--discretisation"].say(std::string(frac::to_string(config_.discretisation)));
  constexpr double infinity = std::numeric_limits<double>::infinity();
  config_.minimum = minimum_.value_or(-infinity);
  config_.maximum = maximum_.value_or(infinity);
  config_.tracking_time = tracking_time_.value_or(0);
  if (!goal_.goal()) options["--tolerance"].say("1e-3");
  return frac::FractionalPidDesign(config_);
}

frac::FilterChoice ControllerRequest::filter(Options& options) const {
  const auto discretisation = discretisation_.value_or(frac::Discretisation::direct);
  if (!goal_.goal()) options["--tolerance"].say(band_ ? "1e-3" : "1e-9");
  if (is_power(*model_) && band_) {
    options["--discretisation"].say(std::string(frac::to_string(discretisation)));
    return frac::power_filter(*model_, *band_, goal_.goal().value_or(frac::Tolerance{1e-3}), config_.sample_time,
                              discretisation);
  }
  if (discretisation_) {
    throw std::invalid_argument(
        "--discretisation belongs to a PID or to a power of s on a --band; other models are made for an input that is "
        "constant between samples");
  }
  if (goal_.poles) throw std::invalid_argument("--poles belongs to a power of s on a --band");
  const double order = model_->numerator().front().order - model_->denominator().front().order;
  if (is_power(*model_) && order > 0)
    throw std::invalid_argument("--band is required for a power of s: LOW:HIGH in rad/s");
  return frac::model_filter(*model_, band_, config_.sample_time, goal_.tolerance.value_or(band_ ? 1e-3 : 1e-9),
                            samples_);
}

ControllerRequest::Design ControllerRequest::design(Options& options) {
  if (model_) return filter(options);
  return pid(options);
}

std::string note_of(const ControllerRequest::Design& design) {
  if (const auto* pid = std::get_if<frac::FractionalPidDesign>(&design)) {
    const std::string rules = note_on_rules(*pid);
    return pid->note() + (pid->note().empty() || rules.empty() ? "" : " ") + rules;
  }
  return std::get<frac::FilterChoice>(design).note;
}

void CodeRequest::declare(Options& o) {
  o.choice("--precision", header_.precision, frac::precisions(), "of C code").unsaid();
  o.text("--name", name_, "prefix of the functions of C code").default_is("controller or filter").unsaid();
}

void CodeRequest::check(bool is_filter) {
  header_.name = !name_.empty() ? name_ : is_filter ? "filter" : "controller";
  frac::check_c_name(header_.name);
}

std::string CodeRequest::words() const {
  return " --precision " + std::string(frac::to_string(header_.precision)) + name_in_words();
}

frac::CHeaderOptions CodeRequest::with_comment(const ControllerRequest& request,
                                               const ControllerRequest::Design& design,
                                               const std::string& command) const {
  frac::CHeaderOptions options = header_;
  if (const auto* pid = std::get_if<frac::FractionalPidDesign>(&design)) {
    options.comment = controller_comment(*pid, command);
  } else {
    options.comment = filter_comment(std::get<frac::FilterChoice>(design).design, request.model()->formula(), command);
  }
  return options;
}

}  // namespace fracfit
