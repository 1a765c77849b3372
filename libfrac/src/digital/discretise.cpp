// SPDX-License-Identifier: BSD-3-Clause
#include "frac/digital/discretise.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "approximation/band_error.hpp"
#include "base/bound_text.hpp"
#include "base/counted.hpp"
#include "base/number_text.hpp"
#include "base/short_text.hpp"
#include "base/spelling.hpp"
#include "correction_taps.hpp"
#include "frac/grunwald_letnikov.hpp"
#include "power_design.hpp"
#include "section_form.hpp"
#include "special/exact_power.hpp"
#include "z_plane.hpp"

namespace frac {
namespace {

using Complex = std::complex<double>;
constexpr double pi = std::numbers::pi;

constexpr detail::Spellings<Discretisation, 5> method_names{{{Discretisation::direct, "direct"},
                                                             {Discretisation::tustin, "tustin"},
                                                             {Discretisation::tustin_prewarped, "tustin-prewarped"},
                                                             {Discretisation::al_alaoui, "al-alaoui"},
                                                             {Discretisation::grunwald_letnikov, "grunwald-letnikov"}}};

void check_sample_time(double sample_time, const char* where) {
  if (!(sample_time > 0 && std::isfinite(sample_time))) {
    throw std::invalid_argument(std::string(where) + ": sample_time = " + detail::number_text(sample_time) +
                                " s; allowed is above 0, finite");
  }
}

// s = (1/T) delta/(1 + slope delta)
double slope_of(Discretisation method) {
  return method == Discretisation::al_alaoui ? 7.0 / 8 : method == Discretisation::direct ? 1 : 0.5;
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

void check_power(double order, FrequencyBand band, double sample_time, Discretisation method, std::size_t memory_length,
                 double most_amplification) {
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
  if (is_direct && !(most_amplification >= 1.1 && most_amplification <= 1000)) {
    throw std::invalid_argument(where + ": most_amplification = " + detail::number_text(most_amplification) +
                                "; allowed is 1.1 to 1000");
  }
  if (method == Discretisation::grunwald_letnikov && (memory_length < 1 || memory_length > 10'000'000)) {
    throw std::invalid_argument(where + ": memory_length = " + std::to_string(memory_length) +
                                "; allowed are 1 to 10000000 samples");
  }
}

// The band in the variable that the rule puts for s.  The backward difference turns s off the imaginary axis by x, away
// from the poles, where the sections are no less accurate within the band, but for its ends: these lie as far out.
FrequencyBand warped(FrequencyBand band, double sample_time, Discretisation method) {
  if (method == Discretisation::al_alaoui || method == Discretisation::grunwald_letnikov) return band;
  const double low = band.lower * sample_time / 2, high = band.upper * sample_time / 2;
  const double scale = 2 / sample_time;
  if (method != Discretisation::direct) return {scale * std::tan(low), scale * std::tan(high)};
  return {scale * std::sin(low) * std::exp(-low), scale * std::sin(high) * std::exp(high)};
}

// The tolerance is shared between sections and taps; a pole gains a factor of two or three.
constexpr double prototype_share = 0.6;
constexpr double correction_share = 0.35;

ApproximationGoal prototype_goal(ApproximationGoal goal, Discretisation method) {
  auto* tolerance = std::get_if<Tolerance>(&goal);
  if (tolerance != nullptr && method == Discretisation::direct) tolerance->value *= prototype_share;
  return goal;
}

// Beyond the band: evenly for the ripples of taps and differences, and evenly in the logarithm of the frequency that
// the bilinear rule maps to omega.  That one goes to infinity where omega goes to pi/T, and the gain of its sections
// climbs up to their fastest pole, however close to pi/T that lies.
std::vector<double> frequencies_beyond(const DigitalPower& result) {
  const double edge = result.band.upper * result.sample_time / 2;
  std::vector<double> half_angle;
  constexpr int even = 200;
  for (int i = 0; i <= even; ++i) half_angle.push_back(edge + (pi / 2 - edge) * i / even);
  if (!result.parallel.rates.empty()) {
    constexpr double step = 0.1;
    const double last = std::log(1 / std::numeric_limits<double>::epsilon());
    for (double log_tangent = std::log(std::tan(edge)) + step; log_tangent < last; log_tangent += step) {
      half_angle.push_back(std::atan(std::exp(log_tangent)));
    }
    std::sort(half_angle.begin(), half_angle.end());
  }
  for (double& each : half_angle) each *= 2 / result.sample_time;
  return half_angle;
}

void measure(DigitalPower& result) {
  // Two ripples a section, and the narrow ones of the taps at the upper edge.
  const int points = 400 + 60 * static_cast<int>(result.parallel.rates.size());
  const double fall = std::log(result.band.upper / result.band.lower);
  const auto ratio = [&](double omega) {
    return result.response(omega) / (detail::real_power(omega, result.order) * detail::quarter_turns(result.order));
  };
  std::vector<double> on_band;
  on_band.reserve(static_cast<std::size_t>(points) + 1);
  for (int i = 0; i < points; ++i) {
    on_band.push_back(result.band.lower * std::exp(fall * static_cast<double>(i) / points));
  }
  on_band.push_back(result.band.upper);
  const detail::BandError<double> largest = detail::band_error(on_band, ratio);
  result.error = {.max_relative = largest.relative,
                  .omega_at_maximum = largest.place,
                  .max_decibels = largest.decibels,
                  .max_degrees = largest.degrees,
                  .grid_points = points + 1};
  const auto amplification = [&](double omega) {
    return std::pow(omega / result.band.upper, std::min(result.order, 0.0)) * std::abs(ratio(omega));
  };
  const std::vector<double> beyond = frequencies_beyond(result);
  std::vector<double> values;
  values.reserve(beyond.size());
  for (const double omega : beyond) values.push_back(amplification(omega));
  result.most_amplification = amplification(detail::refined_maximum(beyond, values, amplification));
}

std::string size_text(const DigitalPower& result) {
  const std::size_t sections = result.parallel.rates.size();
  const std::size_t taps = result.taps.size();
  std::string in_sections = detail::counted(sections, "section");
  if (taps == 1) return in_sections;
  const std::string own = std::to_string(taps) + " taps";
  return sections == 0 ? own : in_sections + " and " + own;
}

void conclude(DigitalPower& result, const ApproximationGoal& goal, double allowed_amplification) {
  const auto* tolerance = std::get_if<Tolerance>(&goal);
  const std::string reached = detail::bound_text(result.error.max_relative);
  const std::string size = size_text(result);
  if (tolerance == nullptr) {
    result.status = ApproximationStatus::as_asked;
    result.message = "The largest relative error with " + size + " is " + reached + ".";
  } else if (result.error.max_relative <= tolerance->value) {
    result.status = ApproximationStatus::met;
    result.message = "Tolerance " + detail::short_text(tolerance->value) + " is met with " + size +
                     ", largest relative error " + reached + ".";
  } else {
    result.status = ApproximationStatus::not_attainable;
    const std::string share = detail::short_text(result.band.upper * result.sample_time / (2 * pi));
    result.message =
        "Tolerance " + detail::short_text(tolerance->value) + " is not attainable by " +
        std::string(to_string(result.method)) + " up to " + share + " of the sampling frequency" +
        (result.method == Discretisation::direct
             ? " with at most " + detail::short_text(allowed_amplification) + " times the gain of s^" +
                   detail::short_text(result.order) + (result.order < 0 ? " at its edge beyond" : " beyond")
             : "") +
        ", best is " + reached + " with " + size + ".";
  }
}

struct Attempt {
  DigitalPower power;
  bool taps_are_good = true;  // within their share of the tolerance
};

Attempt attempt(const detail::SplitOrder& split, FrequencyBand band, ApproximationGoal goal, double sample_time,
                Discretisation method, ApproximationMethod approximation, const detail::DirectLimits& limits) {
  const double order = split.fractional + split.differences - split.integrators;
  DigitalPower result{.order = order, .band = band, .sample_time = sample_time, .method = method};
  result.prototype =
      approximate(split.fractional, warped(band, sample_time, method), prototype_goal(goal, method), approximation);
  check_system(result.prototype.system);
  result.differences = split.differences;
  result.integrators = split.integrators;
  ZeroPoleGain system = result.prototype.system;
  if (method == Discretisation::tustin_prewarped) {
    // What the trapezoidal rule leaves is of the same kind as what the bilinear one does.
    const double x = band.upper * sample_time / 2;
    system.gain *= std::pow(x / std::tan(x), split.fractional - split.integrators);
  }
  const detail::SectionForm form(system, sample_time, slope_of(method));
  result.cascade = form.cascade();
  result.parallel = form.parallel();
  bool taps_are_good = true;
  if (method == Discretisation::direct) {
    const auto* tolerance = std::get_if<Tolerance>(&goal);
    const double allowed = tolerance != nullptr ? tolerance->value * correction_share
                                                : std::max(0.5 * result.prototype.error.max_relative, 1e-12);
    const double edge = band.upper * sample_time / 2;
    detail::CorrectionTaps correction =
        detail::correction_taps({split, sample_time, &result.parallel, edge}, allowed, limits);
    taps_are_good = correction.error <= allowed;
    result.taps = std::move(correction.taps);
  }
  measure(result);
  return {std::move(result), taps_are_good};
}

}  // namespace

std::string_view to_string(Discretisation method) {
  return detail::spelling(method_names, method);
}

Discretisation discretisation_from_string(std::string_view name) {
  return detail::from_spelling(method_names, "discretisation", name);
}

std::span<const Discretisation> discretisations() {
  static constexpr auto all = detail::enumerators(method_names);
  return all;
}

Complex ParallelSections::response(Complex delta) const {
  Complex sum = direct;
  for (std::size_t i = 0; i < rates.size(); ++i) {
    sum += weights[i] * (output == SectionOutput::state ? 1.0 : delta) / (delta + rates[i]);
  }
  return sum;
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
  const Complex delta = detail::delta_at(omega, sample_time);
  Complex value = cascade.gain * detail::response_of_taps(taps, delta);
  for (const DeltaSection& section : cascade.sections) value *= 1.0 + section.feed / (delta + section.rate);
  for (int i = 0; i < differences; ++i) value *= delta / (1.0 + delta) / sample_time;
  for (int i = 0; i < integrators; ++i) value *= sample_time * (0.5 + 1.0 / delta);
  return value;
}

DigitalPower detail::power_in_sections(const SplitOrder& split, FrequencyBand band, ApproximationGoal goal,
                                       double sample_time, Discretisation method, ApproximationMethod approximation,
                                       const DirectLimits& limits) {
  const double order = split.fractional + split.differences - split.integrators;
  check_power(order, band, sample_time, method, 1, limits.amplification);
  const auto* tolerance = std::get_if<Tolerance>(&goal);
  Attempt best = attempt(split, band, goal, sample_time, method, approximation, limits);
  // Where the ends of the band make the error exceed the tolerance, the design is repeated for a smaller share of it.
  double share = 1;
  for (int again = 0; again < 3 && method == Discretisation::direct && tolerance != nullptr; ++again) {
    const double excess = best.power.error.max_relative / tolerance->value;
    if (excess <= 1 || !best.taps_are_good) break;
    share *= 0.8 / excess;
    Attempt next =
        attempt(split, band, Tolerance{share * tolerance->value}, sample_time, method, approximation, limits);
    if (!(next.power.error.max_relative < best.power.error.max_relative)) break;
    best = std::move(next);
  }
  conclude(best.power, goal, limits.amplification);
  return std::move(best.power);
}

std::string DigitalPower::summary() const {
  using detail::short_text;
  return "s^" + short_text(order) + " on " + short_text(band.lower) + " .. " + short_text(band.upper) +
         " rad/s, every " + short_text(sample_time) + " s by " + std::string(to_string(method)) + ", " +
         detail::counted(parallel.rates.size(), "section") + ", " + detail::counted(taps.size(), "tap") +
         ": largest relative error " + detail::bound_text(error.max_relative) + " at " +
         short_text(error.omega_at_maximum) + " rad/s. " + message;
}

DigitalPower digital_power(double order, FrequencyBand band, ApproximationGoal goal, double sample_time,
                           Discretisation method, ApproximationMethod approximation, std::size_t memory_length,
                           double most_amplification) {
  check_power(order, band, sample_time, method, memory_length, most_amplification);
  const double whole = std::trunc(order);
  if (method != Discretisation::grunwald_letnikov) {
    const detail::SplitOrder split{order - whole, static_cast<int>(std::max(whole, 0.0)),
                                   static_cast<int>(std::max(-whole, 0.0))};
    return detail::power_in_sections(split, band, goal, sample_time, method, approximation, {most_amplification});
  }
  DigitalPower result{.order = order, .band = band, .sample_time = sample_time, .method = method};
  result.prototype = approximate(order - whole, band, goal, approximation);
  result.taps = grunwald_letnikov_weights(order, memory_length);
  const double scale = std::pow(sample_time, -order);
  for (double& tap : result.taps) tap *= scale;
  measure(result);
  conclude(result, goal, most_amplification);
  return result;
}

}  // namespace frac
