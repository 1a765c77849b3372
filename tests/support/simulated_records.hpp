// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <cstddef>
#include <map>
#include <numbers>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "frac/records/response.hpp"

// Records of experiments on a resonant system whose response is known exactly, with the disturbances of real ones.

namespace support {

enum class RecordCase {
  white,
  coloured,
  input_noise,
  closed_loop,
  transient,
  jitter,
  quantised,
  arbitrary,
  arbitrary_loop,
  stepped,
  stepped_coloured,
  stepped_jitter
};
inline constexpr std::array record_cases{
    RecordCase::white,          RecordCase::coloured, RecordCase::input_noise,      RecordCase::closed_loop,
    RecordCase::transient,      RecordCase::jitter,   RecordCase::quantised,        RecordCase::arbitrary,
    RecordCase::arbitrary_loop, RecordCase::stepped,  RecordCase::stepped_coloured, RecordCase::stepped_jitter};

constexpr std::string_view name_of(RecordCase which) {
  switch (which) {
    case RecordCase::white:
      return "white noise";
    case RecordCase::coloured:
      return "coloured noise (pole 0.98)";
    case RecordCase::input_noise:
      return "noise on input and output";
    case RecordCase::closed_loop:
      return "closed loop";
    case RecordCase::transient:
      return "start from rest";
    case RecordCase::jitter:
      return "clock with jitter";
    case RecordCase::quantised:
      return "8 bits";
    case RecordCase::arbitrary:
      return "random input";
    case RecordCase::arbitrary_loop:
      return "random reference, closed loop";
    case RecordCase::stepped:
      return "stepped sine, white noise";
    case RecordCase::stepped_coloured:
      return "stepped sine, coloured noise";
    case RecordCase::stepped_jitter:
      break;
  }
  return "stepped sine, clock with jitter";
}

constexpr bool is_stepped(RecordCase which) {
  return which == RecordCase::stepped || which == RecordCase::stepped_coloured || which == RecordCase::stepped_jitter;
}
constexpr bool is_random(RecordCase which) {
  return which == RecordCase::arbitrary || which == RecordCase::arbitrary_loop;
}

/// y_n = b1 u_{n-1} + b2 u_{n-2} - a1 y_{n-1} - a2 y_{n-2}: a resonance at 0.05 of the sampling rate, damping 5 %.
class ResonantFilter {
 public:
  explicit ResonantFilter(double damping = 0.05, double turns = 0.05) {
    const double angle = 2 * std::numbers::pi * turns, radius = std::exp(-damping * angle);
    a1_ = -2 * radius * std::cos(angle);
    a2_ = radius * radius;
    b1_ = 0.6 * (1 + a1_ + a2_);
    b2_ = 0.4 * (1 + a1_ + a2_);
  }
  double step(double input) {
    const double output = b1_ * u1_ + b2_ * u2_ - a1_ * y1_ - a2_ * y2_;
    u2_ = u1_;
    u1_ = input;
    y2_ = y1_;
    y1_ = output;
    return output;
  }
  /// What the next step() returns, which needs no input yet.
  [[nodiscard]] double next() const { return b1_ * u1_ + b2_ * u2_ - a1_ * y1_ - a2_ * y2_; }
  [[nodiscard]] std::complex<double> response(double turns) const {
    const auto z = std::polar(1.0, -2 * std::numbers::pi * turns);
    return (b1_ * z + b2_ * z * z) / (1.0 + a1_ * z + a2_ * z * z);
  }

 private:
  double a1_, a2_, b1_, b2_, u1_ = 0, u2_ = 0, y1_ = 0, y2_ = 0;
};

/// Sines of amplitude 1 and random phases on lines 1 to `lines` of a period of so many samples.
struct Multisine {
  std::size_t period = 0;
  std::vector<std::size_t> lines;
  std::vector<double> phases;

  template <class Generator>
  static Multisine random(std::size_t period, std::vector<std::size_t> lines, Generator& generator) {
    Multisine made{period, std::move(lines), {}};
    std::uniform_real_distribution<double> phase(0, 2 * std::numbers::pi);
    for (std::size_t i = 0; i < made.lines.size(); ++i) made.phases.push_back(phase(generator));
    return made;
  }
  /// At a time in samples, through a response.
  template <class Response>
  [[nodiscard]] double value(double time, const Response& response) const {
    double sum = 0;
    for (std::size_t i = 0; i < lines.size(); ++i) {
      const double turns = static_cast<double>(lines[i]) / static_cast<double>(period);
      const std::complex<double> phasor = response(turns) * std::polar(1.0, phases[i]);
      sum += (phasor * std::polar(1.0, 2 * std::numbers::pi * std::fmod(turns * time, 1))).real();
    }
    return sum;
  }
  [[nodiscard]] double value(double time) const {
    return value(time, [](double) { return std::complex<double>(1); });
  }
};

/// Samples per cycle of a stepped sine; the second one is at the resonance.
constexpr std::array stepped_cycles{23.7, 20.0, 17.3};

inline double rounded_to(double value, double step) {
  return step * std::round(value / step);
}

/// A record of `periods` periods of 128 samples on lines 1 to 40 (of a random input: as many samples; of a stepped
/// sine: three segments of `periods` cycles of 23.7, 20 and 17.3 samples). The time unit is one sample.
inline frac::Record simulated_record(RecordCase which, std::size_t periods, std::mt19937_64& generator) {
  constexpr std::size_t length = 128;
  std::normal_distribution<double> normal;
  ResonantFilter filter;
  const auto response = [&filter](double turns) { return filter.response(turns); };
  std::vector<double> input, output, reference;
  double colour = 0;
  const auto noise = [&](double size) {
    colour = 0.98 * colour + normal(generator) * std::sqrt(1 - 0.98 * 0.98);
    const bool is_coloured = which == RecordCase::coloured || which == RecordCase::stepped_coloured;
    return size * (is_coloured ? colour : normal(generator));
  };
  for (int i = 0; i < 300; ++i) noise(1);
  if (is_stepped(which)) {
    double phase = 0.3;
    for (const double cycle : stepped_cycles) {
      const auto count = static_cast<std::size_t>(std::ceil(static_cast<double>(periods) * cycle));
      for (std::size_t i = 0; i < count; ++i) {
        const double late = which == RecordCase::stepped_jitter ? 0.05 * normal(generator) : 0;
        const std::complex<double> at = std::polar(1.0, phase + 2 * std::numbers::pi * late / cycle);
        input.push_back(at.real());
        output.push_back((response(1 / cycle) * at).real() + (which == RecordCase::stepped_jitter ? 0 : noise(0.3)));
        phase += 2 * std::numbers::pi / cycle;
      }
    }
    return {1, input, {output}};
  }
  const std::size_t count = length * periods;
  if (is_random(which)) {
    const bool loop = which == RecordCase::arbitrary_loop;
    // The system has been running for as long as the record is.
    for (std::size_t i = 0; i < 2 * count; ++i) {
      const double of_reference = normal(generator), disturbance = 0.2 * normal(generator);
      const double y = filter.next() + (loop ? disturbance : 0.0);
      const double u = of_reference - (loop ? 0.5 * y : 0.0);
      filter.step(u);
      if (i < count) continue;
      reference.push_back(of_reference);
      input.push_back(u);
      output.push_back(y + (loop ? 0 : disturbance));
    }
    return {1, input, {output}, loop ? reference : std::vector<double>{}};
  }
  std::vector<std::size_t> lines(40);
  for (std::size_t i = 0; i < lines.size(); ++i) lines[i] = i + 1;
  const Multisine sines = Multisine::random(length, lines, generator);
  if (which == RecordCase::closed_loop) {
    for (std::size_t i = 0; i < count + 4 * length; ++i) {
      const double y = filter.next() + noise(0.5);
      const double u = sines.value(static_cast<double>(i)) - 0.5 * y;
      filter.step(u);
      if (i < 4 * length) continue;
      input.push_back(u);
      output.push_back(y);
    }
    return {1, input, {output}};
  }
  // 8 bits over +-15, which 40 sines of amplitude 1 (rms 4.5) leave once in a thousand samples; noise of half a step.
  constexpr double step = 30.0 / 256;
  for (std::size_t i = 0; i < count; ++i) {
    const double time = static_cast<double>(i) + (which == RecordCase::jitter ? 0.02 * normal(generator) : 0);
    double u = sines.value(time);
    double y = which == RecordCase::transient ? filter.step(u) : sines.value(time, response);
    if (which == RecordCase::quantised) {
      u = rounded_to(u + 0.5 * step * normal(generator), step);
      y = rounded_to(y + 0.5 * step * normal(generator), step);
    } else if (which != RecordCase::jitter) {
      if (which == RecordCase::input_noise) u += 0.3 * normal(generator);
      y += noise(0.5);
    }
    input.push_back(u);
    output.push_back(y);
  }
  return {1, input, {output}};
}

/// How many of the 95 % intervals of real and imaginary parts hold the exact response.
struct RecordCoverage {
  int held = 0, whole = 0, flagged = 0;
  int recognised = 0, records = 0;            // kind of excitation, and the period to a thousandth
  double squares = 0;                         // of errors over sigma
  double errors = 0;                          // their squares
  std::map<int, std::array<int, 2>> of_line;  // held and whole, by line of the period of 128 samples
  [[nodiscard]] double percent() const { return 100.0 * held / std::max(whole, 1); }

  /// Of the line of which the fewest hold.
  [[nodiscard]] double percent_of_worst_line() const {
    double least = 100;
    for (const auto& [line, counts] : of_line) least = std::min(least, 100.0 * counts[0] / counts[1]);
    return least;
  }

  void count(RecordCase which, std::size_t periods, std::mt19937_64& generator) {
    const frac::Record record = simulated_record(which, periods, generator);
    frac::ResponseOptions options;
    options.excitation = is_stepped(which)                 ? frac::Excitation::stepped_sine
                         : is_random(which) || periods < 2 ? frac::Excitation::arbitrary
                                                           : frac::Excitation::periodic;
    if (options.excitation == frac::Excitation::periodic) options.period = 128;
    const auto found = frac::response({record}, options);
    ++records;
    const auto kind = frac::excitation_of(record);
    recognised += kind == *options.excitation &&
                  (kind != frac::Excitation::periodic ||
                   std::abs(frac::period_of(record.drive()).value_or(0) / 128 - 1) < 1e-3) &&
                  (kind != frac::Excitation::stepped_sine || found.outputs.front().size() == 3);
    const ResonantFilter filter;
    for (const auto& point : found.outputs.front()) {
      if (!point.flag.empty()) {
        ++flagged;
        continue;
      }
      double turns = point.omega / (2 * std::numbers::pi);
      // The frequency of a noisy sine has an error of its own; the response is that at the true one.
      if (is_stepped(which))
        turns = 1 / *std::min_element(stepped_cycles.begin(), stepped_cycles.end(), [turns](double a, double b) {
                  return std::abs(a * turns - 1) < std::abs(b * turns - 1);
                });
      const auto error = point.value - filter.response(turns);
      const int here = (std::abs(error.real()) <= point.half_width_re() ? 1 : 0) +
                       (std::abs(error.imag()) <= point.half_width_im() ? 1 : 0);
      held += here;
      auto& line = of_line[static_cast<int>(std::lround(128 * turns))];
      line[0] += here;
      line[1] += 2;
      errors += std::norm(error);
      squares += std::norm(error) / (2 * point.sigma * point.sigma);
      whole += 2;
    }
  }
};

}  // namespace support
