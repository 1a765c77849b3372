// SPDX-License-Identifier: BSD-3-Clause
#include "frac/records/sensor.hpp"

#include <algorithm>
#include <cmath>
#include <random>
#include <stdexcept>
#include <string>

#include "base/draws.hpp"
#include "base/number_text.hpp"

namespace frac {
namespace {

void require_not_below_zero(const char* name, double value) {
  if (!(value >= 0) || !std::isfinite(value))
    throw std::invalid_argument(std::string(name) + " is " + detail::number_text(value) +
                                "; expected a finite number >= 0");
}

/// Value at a time between the entries `after` - 1 and `after`.
double cubic_between(const SignalPath& path, std::size_t after, double time) {
  const std::size_t before = after - 1;
  const double length = path.time[after] - path.time[before];
  if (length == 0) return path.value[after];
  const double share = (time - path.time[before]) / length, rest = 1 - share;
  const double rise = path.value[after] - path.value[before];
  // The chord, and what the rates depart from it.
  return path.value[before] + share * rise +
         share * rest * (rest * (path.rate[before] * length - rise) - share * (path.rate[after] * length - rise));
}

}  // namespace

void SignalPath::add(double at, double its_value, double its_rate) {
  time.push_back(at);
  value.push_back(its_value);
  rate.push_back(its_rate);
}

std::vector<double> sampling_instants(double first, double sample_time, std::size_t count, double jitter,
                                      std::uint64_t seed) {
  if (!(sample_time > 0) || !std::isfinite(sample_time))
    throw std::invalid_argument("sample_time is " + detail::number_text(sample_time) +
                                "; expected a finite number > 0");
  constexpr double most = 0.1;
  // Neighbours change places where their errors differ by a step: by 7 deviations, once in 10^12.
  if (!(jitter >= 0 && jitter <= most * sample_time))
    throw std::invalid_argument("clock_jitter is " + detail::number_text(jitter) + "; expected 0 to " +
                                detail::number_text(most * sample_time) + " s, a tenth of the sample time");
  std::mt19937_64 generator(seed);
  std::vector<double> instants(count);
  for (std::size_t i = 0; i < count; ++i) {
    instants[i] = first + static_cast<double>(i) * sample_time;
    if (jitter > 0) instants[i] += jitter * detail::normal_draw(generator);
  }
  return instants;
}

std::vector<double> sensor_readings(const SignalPath& path, const std::vector<double>& instants,
                                    const SensorErrors& errors, std::uint64_t seed) {
  require_not_below_zero("delay", errors.delay);
  require_not_below_zero("noise", errors.noise);
  require_not_below_zero("quantisation", errors.quantisation);
  if (!(errors.clip > 0))
    throw std::invalid_argument("clip is " + detail::number_text(errors.clip) + "; expected a number > 0");
  if (path.time.size() < 2 || path.value.size() != path.time.size() || path.rate.size() != path.time.size())
    throw std::invalid_argument("path has " + std::to_string(path.time.size()) + " times, " +
                                std::to_string(path.value.size()) + " values and " + std::to_string(path.rate.size()) +
                                " rates; expected as many of each, at least 2");
  std::mt19937_64 generator(seed);
  std::vector<double> readings;
  readings.reserve(instants.size());
  for (const double instant : instants) {
    const double time = instant - errors.delay;
    if (!(time >= path.time.front() && time <= path.time.back()))
      throw std::invalid_argument("instant " + detail::number_text(instant) + " s less the delay is not between " +
                                  detail::number_text(path.time.front()) + " and " +
                                  detail::number_text(path.time.back()) + " s, which the path holds");
    const auto next = std::upper_bound(path.time.begin(), path.time.end(), time);
    const auto after = static_cast<std::size_t>(std::min(next, path.time.end() - 1) - path.time.begin());
    double reading = cubic_between(path, after, time);
    if (errors.noise > 0) reading += errors.noise * detail::normal_draw(generator);
    reading = std::clamp(reading, -errors.clip, errors.clip);
    if (errors.quantisation > 0) reading = errors.quantisation * std::round(reading / errors.quantisation);
    readings.push_back(reading);
  }
  return readings;
}

}  // namespace frac
