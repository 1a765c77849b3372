// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>
#include <numeric>
#include <stdexcept>

#include "approximation/band_error.hpp"
#include "base/bound_text.hpp"
#include "base/number_text.hpp"
#include "base/short_text.hpp"
#include "base/spelling.hpp"
#include "correction_taps.hpp"
#include "frac/digital/fractional_pid.hpp"
#include "power_design.hpp"
#include "section_kernel.hpp"
#include "tap_line.hpp"
#include "z_plane.hpp"

namespace frac {
namespace {

constexpr detail::Spellings<AntiWindup, 3> anti_windup_names{
    {{AntiWindup::none, "none"},
     {AntiWindup::back_calculation, "back-calculation"},
     {AntiWindup::conditional_integration, "conditional-integration"}}};

constexpr double pi = std::numbers::pi;
// Larger coefficients are refused, so that they fit into a float.
constexpr double largest_coefficient = 1e30;
// Largest gain of the filters beyond the band over that of the exact operator.
constexpr double most_amplification = 5;

[[noreturn]] void refuse(const std::string& why) {
  throw std::invalid_argument("fractional PID: " + why);
}

void check_number(const char* name, double value, double lowest, const char* allowed, const char* unit) {
  if (!(value >= lowest && std::isfinite(value))) {
    refuse(std::string(name) + " = " + detail::number_text(value) + unit + "; allowed is " + allowed);
  }
}

void check(const FractionalPidConfig& config) {
  const FractionalPidGains& gains = config.gains;
  const auto check_gain = [](const char* name, double value) {
    if (!(std::abs(value) < largest_coefficient)) {
      refuse(std::string(name) + " = " + detail::number_text(value) + "; allowed is a finite number below 1e30");
    }
  };
  check_gain("kp", gains.kp);
  check_gain("ki", gains.ki);
  check_gain("kd", gains.kd);
  const auto check_order = [](const char* name, double value) {
    if (!(value >= least_controller_order && value <= largest_controller_order)) {
      refuse(std::string(name) + " = " + detail::number_text(value) + "; allowed is " +
             detail::number_text(least_controller_order) + " to " + detail::number_text(largest_controller_order));
    }
  };
  check_order("lambda", gains.lambda);
  check_order("mu", gains.mu);
  check_number("sample_time", config.sample_time, std::numeric_limits<double>::min(), "above 0, finite", " s");
  if (!(config.minimum < config.maximum)) {
    refuse("limits = " + detail::number_text(config.minimum) + " to " + detail::number_text(config.maximum) +
           "; needed is minimum < maximum");
  }
  check_number("tracking_time", config.tracking_time, 0, "0 (chosen) or above, finite", " s");
  check_number("derivative_filter_time", config.derivative_filter_time, 0, "0 or above, finite", " s");
  if (!(config.most_swing >= 0 && config.most_swing <= 10)) {
    refuse("most_swing = " + detail::number_text(config.most_swing) + "; allowed is 0 to 10");
  }
  const double lowest = std::numeric_limits<double>::lowest();
  check_number("setpoint_weight", config.setpoint_weight, lowest, "a finite number", "");
  check_number("derivative_setpoint_weight", config.derivative_setpoint_weight, lowest, "a finite number", "");
  if (config.discretisation == Discretisation::grunwald_letnikov) {
    refuse("discretisation = grunwald-letnikov; allowed are direct, tustin, tustin-prewarped and al-alaoui");
  }
}

// The band within what the sample time can hold.
FrequencyBand usable_band(const FractionalPidConfig& config, std::string& note) {
  const FrequencyBand band = config.band;
  const std::string asked =
      "band = " + detail::number_text(band.lower) + " to " + detail::number_text(band.upper) + " rad/s";
  if (!(band.lower > 0 && band.lower < band.upper && std::isfinite(band.upper))) {
    refuse(asked + "; needed for orders other than 1 is 0 < lower < upper < infinity");
  }
  const double nyquist = pi / config.sample_time;
  const double highest = config.discretisation == Discretisation::direct ? 0.5 * nyquist : 0.9 * nyquist;
  if (band.upper <= highest) return band;
  constexpr double narrowest = 1.1;
  if (!(highest > narrowest * band.lower)) {
    refuse(asked + " begins where sample time " + detail::number_text(config.sample_time) +
           " s ends: usable are frequencies up to " + detail::short_text(highest) + " rad/s (" +
           (config.discretisation == Discretisation::direct ? "a quarter" : "0.45") + " of the sampling frequency)");
  }
  note += "The upper edge of the band was cut from " + detail::short_text(band.upper) + " to " +
          detail::short_text(highest) + " rad/s, " +
          (config.discretisation == Discretisation::direct ? "a quarter" : "0.45") + " of the sampling frequency. ";
  return {band.lower, highest};
}

PidFilter filter_of(const DigitalPower& power) {
  PidFilter result;
  if (power.taps.size() > 1) {
    result.taps = power.taps;
    result.taps.resize(detail::even_count(power.taps.size()), 0);
    assert(result.taps.size() <= PidFilter::most_taps);
  }
  const ParallelSections& sections = power.parallel;
  const std::size_t count = sections.rates.size();
  if (count > PidFilter::most_sections) {
    refuse(std::to_string(count) + " sections are needed; allowed are up to " +
           std::to_string(PidFilter::most_sections) + ": ask for a larger tolerance or a narrower band");
  }
  result.sections = {.output = sections.output, .direct = sections.direct, .rates = {}, .weights = {}};
  result.high_gain = sections.direct;
  std::vector<std::size_t> order(count);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return sections.rates[a] < sections.rates[b]; });
  for (const std::size_t i : order) {
    result.sections.rates.push_back(sections.rates[i]);
    result.sections.weights.push_back(sections.weights[i]);
    if (sections.output == SectionOutput::change) result.high_gain += sections.weights[i];
  }
  result.high_gain *= power.taps[0];
  const auto is_wild = [](double value) { return !(std::abs(value) < largest_coefficient); };
  if (is_wild(sections.direct) || std::any_of(sections.weights.begin(), sections.weights.end(), is_wild)) {
    refuse("a coefficient above 1e30 is needed; scale the signals or the time");
  }
  return result;
}

std::string design_note(const DigitalPower& power, const std::string& name, const detail::DirectLimits& limits) {
  const bool is_limited = power.method == Discretisation::direct && std::isfinite(limits.swing);
  const double swing = is_limited ? detail::step_swing(power.parallel, power.taps, limits.lag_share) : 0;
  const bool swings = is_limited && swing > limits.swing;
  std::string note;
  if (power.status == ApproximationStatus::not_attainable) {
    note += "The error of the " + name + " filter is " + detail::bound_text(power.error.max_relative) +
            ", above the tolerance";
    if (is_limited && !swings) {
      note += "; less would make its answer to a step swing by more than " + detail::short_text(limits.swing) +
              " of the peak from sample to sample: allow more swing, a lag before the derivative, or a lower band";
    }
    note += ". ";
  }
  if (swings) {
    note += "The answer of the " + name + " to a step swings by " + detail::short_text(swing) +
            " of its peak from sample to sample; a lag before the derivative or a lower band avoids that. ";
  }
  return note;
}

// The filter for s^order, made so that `integrators` trapezoidal ones behind it are right too.
PidFilter filter_for(double order, int integrators, const detail::DirectLimits& limits, const std::string& name,
                     const FractionalPidConfig& config, double& error, std::string& note) {
  if (order == 0) return {};
  const DigitalPower power = [&] {
    try {
      return detail::power_in_sections({order, 0, integrators}, config.band, config.goal, config.sample_time,
                                       config.discretisation, ApproximationMethod::ladder, limits);
    } catch (const std::invalid_argument& failure) {
      refuse(name + ": " + failure.what());
    }
  }();
  error = power.error.max_relative;
  note += design_note(power, name, limits);
  return filter_of(power);
}

// With Ti = (kp/ki)^(1/lambda) the integral settles at the limit itself, whatever the control error is, and begins to
// move as soon as the error has changed its sign.
double natural_time(const FractionalPidConfig& config) {
  const auto& [kp, ki, kd, lambda, mu] = config.gains;
  if (kp != 0) return std::pow(std::abs(kp / ki), 1 / lambda);
  if (kd != 0) return std::pow(std::abs(kd / ki), 1 / (lambda + mu));
  return 10 * config.sample_time;
}

}  // namespace

std::string_view to_string(AntiWindup method) {
  return detail::spelling(anti_windup_names, method);
}

AntiWindup anti_windup_from_string(std::string_view name) {
  return detail::from_spelling(anti_windup_names, "anti-windup", name);
}

std::span<const AntiWindup> anti_windup_methods() {
  static constexpr auto all = detail::enumerators(anti_windup_names);
  return all;
}

std::string validate(const FractionalPidConfig& config) {
  try {
    const FractionalPidDesign design(config);
    return "";
  } catch (const std::exception& failure) {
    return failure.what();
  }
}

FractionalPidDesign::FractionalPidDesign(const FractionalPidConfig& config) : config_(config) {
  check(config);
  // Names of their own, which a lambda may capture in every compiler.
  const double kp = config.gains.kp, ki = config.gains.ki, kd = config.gains.kd;
  const double lambda = config.gains.lambda, mu = config.gains.mu;
  const double integral_order = ki != 0 ? 1 - lambda : 0;
  const double derivative_order = kd != 0 ? (mu < 1 ? mu : mu - 1) : 0;
  if (integral_order != 0 || derivative_order != 0) config_.band = usable_band(config, note_);
  integral_ = filter_for(integral_order, 1, {most_amplification}, "integral", config_, integral_error_, note_);
  // Its first sample of the step response: the limits are obeyed by solving for it.
  if (!(integral_.high_gain > 0))
    refuse("no usable filter for s^" + detail::short_text(integral_order) + " on this band");
  const double lag_share = config.sample_time / (config.derivative_filter_time + config.sample_time);
  derivative_ = filter_for(derivative_order, 0, {most_amplification, config.most_swing, lag_share}, "derivative",
                           config_, derivative_error_, note_);
  if (ki != 0 && config.anti_windup == AntiWindup::back_calculation) {
    // The correction acts within its sample, so that any tracking time is stable; one below the sample time is in
    // effect the sample time.
    tracking_time_ =
        std::max(config.tracking_time > 0 ? config.tracking_time : natural_time(config), config.sample_time);
  }
  if (!note_.empty()) note_.pop_back();

  const FrequencyBand band = config_.band;
  if (!(band.lower > 0 && band.lower < band.upper && band.upper < pi / config.sample_time)) return;
  std::vector<double> grid;
  constexpr int steps = 500;
  for (int i = 0; i <= steps; ++i) {
    grid.push_back(band.lower * std::pow(band.upper / band.lower, static_cast<double>(i) / steps));
  }
  const detail::BandError<double> largest = detail::band_error(grid, [&](double omega) {
    const std::complex<double> s(0, omega);
    const std::complex<double> exact =
        kp + ki * std::pow(s, -lambda) + kd * std::pow(s, mu) / (1.0 + config.derivative_filter_time * s);
    return response(omega) / exact;
  });
  error_ = largest.relative;
  omega_at_error_ = largest.place;
}

std::complex<double> FractionalPidDesign::response(double omega) const {
  const double time = config_.sample_time;
  const std::complex<double> delta = detail::delta_at(omega, time);
  const auto filter = [&](const PidFilter& design) {
    const std::complex<double> value = design.sections.response(delta);
    return design.taps.empty() ? value : value * detail::response_of_taps(design.taps, delta);
  };
  const auto& [kp, ki, kd, lambda, mu] = config_.gains;
  const std::complex<double> difference = delta / (1.0 + delta) / time;
  const std::complex<double> lag = 1.0 / (1.0 + config_.derivative_filter_time * difference);
  std::complex<double> value = kp;
  if (ki != 0) value += ki * filter(integral_) * time * (0.5 + 1.0 / delta);
  if (kd != 0) value += kd * filter(derivative_) * lag * (mu < 1 ? 1.0 : difference);
  return value;
}

}  // namespace frac
