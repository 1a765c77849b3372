#include "frac/discretise.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <stdexcept>

#include "detail/exact_power.hpp"
#include "detail/number_text.hpp"
#include "digital/gain_correction.hpp"
#include "digital/power_design.hpp"
#include "digital/section_form.hpp"
#include "frac/grunwald_letnikov.hpp"

namespace frac {
namespace {

using Complex = std::complex<double>;
constexpr double pi = std::numbers::pi;

constexpr Discretisation all_methods[] = {Discretisation::direct, Discretisation::tustin,
                                          Discretisation::tustin_prewarped, Discretisation::al_alaoui,
                                          Discretisation::grunwald_letnikov};

std::string short_text(double value) {
  std::array<char, 32> buffer;
  std::snprintf(buffer.data(), buffer.size(), "%.3g", value);
  return buffer.data();
}

void check_sample_time(double sample_time, const char* where) {
  if (!(sample_time > 0 && std::isfinite(sample_time))) {
    throw std::invalid_argument(std::string(where) + ": sample_time = " + detail::number_text(sample_time) +
                                " s; allowed is above 0, finite");
  }
}

// s = (1/T) delta/(1 + slope delta)
double slope_of(Discretisation method) {
  return method == Discretisation::al_alaoui ? 7.0 / 8 : 0.5;
}

void check_system(const ZeroPoleGain& system) {
  const auto refuse = [](const std::string& why) { throw std::invalid_argument("discretise: " + why); };
  if (!system.zero_pairs.empty() || !system.pole_pairs.empty()) {
    refuse("the system has complex zeros or poles; first-order sections need real ones");
  }
  if (system.zeros.size() != system.poles.size()) {
    refuse(std::to_string(system.zeros.size()) + " zeros and " + std::to_string(system.poles.size()) +
           " poles; needed are as many zeros as poles");
  }
  if (system.integer_order != 0) {
    refuse("integer_order = " + std::to_string(system.integer_order) + "; needed is 0, see digital_power()");
  }
  const auto check_roots = [&](const char* name, const std::vector<double>& roots, bool zero_allowed) {
    for (std::size_t i = 0; i < roots.size(); ++i) {
      if (!(roots[i] < 0 || (zero_allowed && roots[i] == 0)) || !std::isfinite(roots[i])) {
        refuse(std::string(name) + "[" + std::to_string(i) + "] = " + detail::number_text(roots[i]) +
               " rad/s; needed is a negative, finite number");
      }
    }
  };
  check_roots("zeros", system.zeros, true);
  check_roots("poles", system.poles, false);
  std::vector<double> sorted = system.poles;
  std::sort(sorted.begin(), sorted.end());
  const auto twin = std::adjacent_find(sorted.begin(), sorted.end());
  if (twin != sorted.end())
    refuse("pole " + detail::number_text(*twin) + " rad/s occurs twice; needed are simple poles");
  if (!std::isfinite(system.gain)) refuse("gain = " + detail::number_text(system.gain) + " is not finite");
}

void check_power(double order, FrequencyBand band, double sample_time, Discretisation method,
                 std::size_t memory_length) {
  const std::string where = "digital_power (" + std::string(to_string(method)) + ")";
  check_sample_time(sample_time, where.c_str());
  constexpr double most = 8;
  if (!(std::abs(order) < most)) {
    throw std::invalid_argument(where + ": order = " + detail::number_text(order) +
                                "; allowed is -8 to 8, ends excluded");
  }
  const double nyquist = pi / sample_time;
  const bool is_direct = method == Discretisation::direct;
  const double highest = is_direct ? nyquist / 2 * (1 + 1e-12) : nyquist * (1 - 1e-9);
  if (!(band.lower > 0 && band.lower < band.upper && band.upper <= highest)) {
    throw std::invalid_argument(where + ": band = " + detail::number_text(band.lower) + " to " +
                                detail::number_text(band.upper) + " rad/s; needed is 0 < lower < upper " +
                                (is_direct ? "<= pi/(2 T) = " : "< pi/T = ") +
                                detail::number_text(is_direct ? nyquist / 2 : nyquist) +
                                " rad/s at sample time T = " + detail::number_text(sample_time) + " s");
  }
  if (method == Discretisation::grunwald_letnikov && (memory_length < 1 || memory_length > 10'000'000)) {
    throw std::invalid_argument(where + ": memory_length = " + std::to_string(memory_length) +
                                "; allowed are 1 to 10000000 samples");
  }
}

// The band in the variable that the rule puts for s.
FrequencyBand warped(FrequencyBand band, double sample_time, Discretisation method) {
  if (method == Discretisation::al_alaoui || method == Discretisation::grunwald_letnikov) return band;
  const auto stretched = [sample_time](double omega) { return 2 / sample_time * std::tan(omega * sample_time / 2); };
  return {stretched(band.lower), stretched(band.upper)};
}

// The tolerance is shared between sections and correction; a corner gains about a factor of two, a pole much more.
constexpr double prototype_share = 0.65;
constexpr double correction_share = 0.3;

ApproximationGoal prototype_goal(ApproximationGoal goal, Discretisation method) {
  auto* tolerance = std::get_if<Tolerance>(&goal);
  if (tolerance != nullptr && method == Discretisation::direct) tolerance->value *= prototype_share;
  return goal;
}

void measure(DigitalPower& result) {
  constexpr int points = 4000;
  const double fall = std::log(result.band.upper / result.band.lower);
  ApproximationError& error = result.error;
  const auto ratio = [&](double omega) {
    return result.response(omega) / (detail::real_power(omega, result.order) * detail::quarter_turns(result.order));
  };
  error = {};
  error.grid_points = points + 1;
  for (int i = 0; i <= points; ++i) {
    const double omega =
        i == points ? result.band.upper : result.band.lower * std::exp(fall * static_cast<double>(i) / points);
    const Complex value = ratio(omega);
    const double relative = std::abs(value - 1.0);
    if (relative > error.max_relative) {
      error.max_relative = relative;
      error.omega_at_maximum = omega;
    }
    error.max_decibels = std::max(error.max_decibels, std::abs(20 * std::log10(std::abs(value))));
    error.max_degrees = std::max(error.max_degrees, std::abs(std::arg(value)) * 180 / pi);
  }
  constexpr int beyond = 200;
  const double nyquist = pi / result.sample_time;
  result.most_amplification = 0;
  for (int i = 0; i < beyond; ++i) {
    const double omega = result.band.upper + (nyquist - result.band.upper) * i / beyond;
    result.most_amplification = std::max(result.most_amplification, std::abs(ratio(omega)));
  }
}

void conclude(DigitalPower& result, const ApproximationGoal& goal) {
  const auto* tolerance = std::get_if<Tolerance>(&goal);
  const std::string reached = short_text(result.error.max_relative);
  const std::string size = result.method == Discretisation::grunwald_letnikov
                               ? std::to_string(result.taps.size()) + " taps"
                               : std::to_string(result.parallel.rates.size()) + " sections";
  if (tolerance == nullptr) {
    result.status = ApproximationStatus::as_asked;
    result.message = "The largest relative error with " + size + " is " + reached + ".";
  } else if (result.error.max_relative <= tolerance->value) {
    result.status = ApproximationStatus::met;
    result.message = "Tolerance " + short_text(tolerance->value) + " is met with " + size +
                     ", largest relative error " + reached + ".";
  } else {
    result.status = ApproximationStatus::not_attainable;
    const std::string share = short_text(result.band.upper * result.sample_time / (2 * pi));
    result.message = "Tolerance " + short_text(tolerance->value) + " is not attainable by " +
                     std::string(to_string(result.method)) + " up to " + share +
                     " of the sampling frequency, best is " + reached + " with " + size + ".";
  }
}

}  // namespace

std::string_view to_string(Discretisation method) {
  switch (method) {
    case Discretisation::direct:
      return "direct";
    case Discretisation::tustin:
      return "tustin";
    case Discretisation::tustin_prewarped:
      return "tustin-prewarped";
    case Discretisation::al_alaoui:
      return "al-alaoui";
    case Discretisation::grunwald_letnikov:
      break;
  }
  return "grunwald-letnikov";
}

Discretisation discretisation(std::string_view name) {
  std::string known;
  for (const Discretisation method : all_methods) {
    if (to_string(method) == name) return method;
    known += (known.empty() ? "" : ", ") + std::string(to_string(method));
  }
  throw std::invalid_argument("discretisation \"" + std::string(name) + "\": expected one of " + known);
}

std::span<const Discretisation> discretisations() {
  return all_methods;
}

Complex ParallelSections::response(Complex delta) const {
  Complex sum = direct;
  for (std::size_t i = 0; i < rates.size(); ++i) {
    sum += weights[i] * (output == SectionOutput::state ? 1.0 : delta) / (delta + rates[i]);
  }
  return sum;
}

Complex delta_at(double omega, double sample_time) {
  const double half = omega * sample_time / 2;
  return 2 * std::sin(half) * Complex(-std::sin(half), std::cos(half));
}

DigitalSections discretise(const ZeroPoleGain& system, double sample_time, Discretisation method) {
  check_sample_time(sample_time, "discretise");
  if (method != Discretisation::tustin && method != Discretisation::al_alaoui) {
    throw std::invalid_argument("discretise: method " + std::string(to_string(method)) +
                                " is for powers of s; a rational function takes tustin or al-alaoui");
  }
  check_system(system);
  const detail::SectionForm form(system, sample_time, slope_of(method));
  return {form.cascade(), form.parallel()};
}

Complex DigitalPower::response(double omega) const {
  const Complex delta = delta_at(omega, sample_time);
  if (!taps.empty()) {
    const Complex back = 1.0 / (1.0 + delta);
    Complex sum = 0;
    for (auto tap = taps.rbegin(); tap != taps.rend(); ++tap) sum = sum * back + *tap;
    return sum;
  }
  Complex value = cascade.gain * correction.response(delta);
  for (const DeltaSection& section : cascade.sections) value *= 1.0 + section.feed / (delta + section.rate);
  for (int i = 0; i < differences; ++i) value *= delta / (1.0 + delta) / sample_time;
  for (int i = 0; i < integrators; ++i) value *= sample_time * (0.5 + 1.0 / delta);
  return value;
}

DigitalPower detail::power_in_sections(const SplitOrder& split, FrequencyBand band, ApproximationGoal goal,
                                       double sample_time, Discretisation method, ApproximationMethod approximation,
                                       double most_gain) {
  const double order = split.fractional + split.differences - split.integrators;
  check_power(order, band, sample_time, method, 1);
  DigitalPower result{.order = order, .band = band, .sample_time = sample_time, .method = method};
  result.prototype =
      approximate(split.fractional, warped(band, sample_time, method), prototype_goal(goal, method), approximation);
  check_system(result.prototype.system);
  result.differences = split.differences;
  result.integrators = split.integrators;
  const SectionForm form(result.prototype.system, sample_time, slope_of(method));
  // What the trapezoidal rule leaves is of the same kind as what the bilinear one does.
  const double gain_order = split.fractional - split.integrators;
  GainCorrection correction;
  if (method == Discretisation::direct) {
    const double edge = band.upper * sample_time / 2;
    const auto* tolerance = std::get_if<Tolerance>(&goal);
    const double allowed = tolerance != nullptr ? tolerance->value * correction_share
                                                : std::max(0.3 * result.prototype.error.max_relative, 1e-12);
    std::vector<double> occupied;
    for (const double pole : result.prototype.system.poles) occupied.push_back(-pole * sample_time / 2);
    correction = gain_correction({gain_order, split.differences}, edge, allowed, most_gain, occupied);
  } else if (method == Discretisation::tustin_prewarped) {
    const double x = band.upper * sample_time / 2;
    correction.constant = std::pow(x / std::tan(x), gain_order);
  }
  result.cascade = form.cascade();
  result.correction = sections_of(correction);
  result.parallel = form.times(correction);
  measure(result);
  conclude(result, goal);
  return result;
}

DigitalPower digital_power(double order, FrequencyBand band, ApproximationGoal goal, double sample_time,
                           Discretisation method, ApproximationMethod approximation, std::size_t memory_length,
                           double most_gain) {
  check_power(order, band, sample_time, method, memory_length);
  const double whole = std::trunc(order);
  if (method != Discretisation::grunwald_letnikov) {
    const detail::SplitOrder split{order - whole, static_cast<int>(std::max(whole, 0.0)),
                                   static_cast<int>(std::max(-whole, 0.0))};
    return detail::power_in_sections(split, band, goal, sample_time, method, approximation, most_gain);
  }
  DigitalPower result{.order = order, .band = band, .sample_time = sample_time, .method = method};
  result.prototype = approximate(order - whole, band, goal, approximation);
  result.taps = grunwald_letnikov_weights(order, memory_length);
  const double scale = std::pow(sample_time, -order);
  for (double& tap : result.taps) tap *= scale;
  measure(result);
  conclude(result, goal);
  return result;
}

}  // namespace frac
