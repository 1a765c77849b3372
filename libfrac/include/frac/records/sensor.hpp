// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace frac {

/// A signal over time by its values and rates at times that do not fall.  Between two of them it is the cubic that both
/// ends give, whose error is at most h^4/384 times the largest fourth derivative, h apart.  Two entries of one time are
/// a jump.
struct SignalPath {
  std::vector<double> time;   // s
  std::vector<double> value;  // unit of the signal
  std::vector<double> rate;   // per s

  void add(double at, double its_value, double its_rate);
};

/// What a sensor and its converter do to a signal, in this order.
struct SensorErrors {
  double delay = 0;                                       // s, >= 0: readings show the signal of so long ago
  double noise = 0;                                       // standard deviation of white noise, unit of the signal, >= 0
  double clip = std::numeric_limits<double>::infinity();  // largest absolute value that is read, > 0
  double quantisation = 0;                                // step of the converter, unit of the signal, >= 0; 0: none
};

/// Instants at which a clock samples that is told to do so every `sample_time`.
/// @param first   s
/// @param jitter  standard deviation of each instant, s, >= 0, at most a tenth of the sample time, so that instants
///                rise
/// @throws std::invalid_argument  a number out of its range; the text names it.
[[nodiscard]] std::vector<double> sampling_instants(double first, double sample_time, std::size_t count, double jitter,
                                                    std::uint64_t seed);

/// What a sensor reads of a signal at these instants.
/// @param seed  of the noise: the same seed gives the same readings
/// @throws std::invalid_argument  an error out of its range, a path of other lengths or of fewer than two entries, or
/// an
///                                instant that the path, with the delay, does not hold; the text names it.
[[nodiscard]] std::vector<double> sensor_readings(const SignalPath& path, const std::vector<double>& instants,
                                                  const SensorErrors& errors, std::uint64_t seed);

}  // namespace frac
