// SPDX-License-Identifier: BSD-3-Clause
#include "frac/records/multisine.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <random>
#include <stdexcept>
#include <string>

#include "base/draws.hpp"
#include "base/number_text.hpp"
#include "records/chirp_transform.hpp"

namespace frac {
namespace {

using std::numbers::pi;

std::size_t samples_of(const MultisineOptions& options) {
  const auto require = [](const char* name, double value) {
    if (!(value > 0) || !std::isfinite(value))
      throw std::invalid_argument(std::string(name) + " is " + detail::number_text(value) +
                                  "; expected a finite number > 0");
  };
  require("sample_time", options.sample_time);
  require("period", options.period);
  require("peak", options.peak);
  if (options.rounds < 0)
    throw std::invalid_argument("rounds is " + std::to_string(options.rounds) + "; expected at least 0");
  const double samples = options.period / options.sample_time, whole = std::round(samples);
  constexpr double least = 4, most = 1e7, rounding = 1e-9;
  if (!(whole >= least && whole <= most) || std::abs(samples - whole) > rounding * whole)
    throw std::invalid_argument("period is " + detail::number_text(options.period) + " s, which are " +
                                detail::number_text(samples) +
                                " samples; expected a whole number of them from 4 to 1e7");
  if (!(options.lower > 0 && options.lower <= options.upper && options.upper < pi / options.sample_time))
    throw std::invalid_argument("band is " + detail::number_text(options.lower) + " to " +
                                detail::number_text(options.upper) + " rad/s; expected 0 < lower <= upper < " +
                                detail::number_text(pi / options.sample_time) + " rad/s, half the sampling rate");
  return static_cast<std::size_t>(whole);
}

std::vector<std::size_t> lines_of(const MultisineOptions& options, std::size_t samples, std::mt19937_64& generator) {
  const double spacing = 2 * pi / options.period;
  // Ends of a band that are lines count as such, whatever the rounding.
  constexpr double rounding = 1e-9;
  const auto first = static_cast<std::size_t>(std::max(1.0, std::ceil(options.lower / spacing * (1 - rounding))));
  const auto last = static_cast<std::size_t>(options.upper / spacing * (1 + rounding));
  std::vector<std::size_t> lines;
  for (std::size_t k = first; k <= last && 2 * k < samples; ++k)
    if (options.lines == MultisineLines::full || k % 2 == 1) lines.push_back(k);
  if (options.lines == MultisineLines::odd_random && lines.size() > 2) {
    std::vector<std::size_t> kept;
    constexpr std::size_t group = 4;
    for (std::size_t begin = 0; begin < lines.size(); begin += group) {
      const auto hole = begin + static_cast<std::size_t>(detail::uniform_draw(generator) * static_cast<double>(group));
      // The ends of the band stay, so that every line left out has excited ones on both sides.
      for (std::size_t i = begin; i < std::min(begin + group, lines.size()); ++i)
        if (i != hole || i == 0 || i + 1 == lines.size()) kept.push_back(lines[i]);
    }
    lines = kept;
  }
  if (lines.empty())
    throw std::invalid_argument("band holds no line: those of a period of " + detail::number_text(options.period) +
                                " s are the multiples of " + detail::number_text(spacing) + " rad/s" +
                                (options.lines == MultisineLines::full ? "" : ", of which odd ones are asked for"));
  return lines;
}

}  // namespace

std::string_view to_string(MultisineLines lines) {
  switch (lines) {
    case MultisineLines::full:
      return "full";
    case MultisineLines::odd:
      return "odd";
    case MultisineLines::odd_random:
      break;
  }
  return "odd-random";
}

Multisine multisine(const MultisineOptions& options) {
  const std::size_t count = samples_of(options);
  std::mt19937_64 generator(options.seed);
  Multisine best;
  best.lines = lines_of(options, count, generator);
  const std::size_t last = best.lines.back();
  const auto lines = static_cast<double>(best.lines.size());
  std::vector<double> phases;
  for (std::size_t i = 0; i < best.lines.size(); ++i) phases.push_back(2 * pi * detail::uniform_draw(generator));
  const auto length = static_cast<double>(count);
  const detail::ChirpTransform to_lines(count, length, last + 1), to_samples(last + 1, length, count);
  // sum cos(k t + p) as the real part of the conjugate of a Fourier sum over the lines.
  const auto samples_with = [&](const std::vector<double>& of_phases) {
    std::vector<double> real(last + 1), imaginary(last + 1);
    for (std::size_t i = 0; i < of_phases.size(); ++i) {
      real[best.lines[i]] = std::cos(of_phases[i]);
      imaginary[best.lines[i]] = -std::sin(of_phases[i]);
    }
    const auto a = to_samples(real.data()), b = to_samples(imaginary.data());
    std::vector<double> samples(count);
    // ChirpTransform has the factor 2/n of its own.
    const double scale = 0.5 * static_cast<double>(last + 1);
    for (std::size_t i = 0; i < count; ++i) samples[i] = scale * (a[i].real() - b[i].imag());
    return samples;
  };
  constexpr double kept = 0.9;  // of the peak: clips a tenth of a period or less
  double least_peak = 0;
  for (int round = 0;; ++round) {
    std::vector<double> samples = samples_with(phases);
    double peak = 0;
    for (const double each : samples) peak = std::max(peak, std::abs(each));
    if (round == 0 || peak < least_peak) {
      least_peak = peak;
      best.samples = samples;
    }
    if (round >= options.rounds) break;
    for (double& each : samples) each = std::clamp(each, -kept * peak, kept * peak);
    const auto spectrum = to_lines(samples.data());
    for (std::size_t i = 0; i < phases.size(); ++i) phases[i] = std::arg(spectrum[best.lines[i]]);
  }
  best.amplitude = options.peak / least_peak;
  for (double& each : best.samples) each *= best.amplitude;
  best.crest_factor = least_peak / std::sqrt(lines / 2);
  return best;
}

std::vector<SteppedSineStep> stepped_sine_plan(const std::vector<double>& omega, double total_time,
                                               std::size_t settling_cycles) {
  constexpr double fewest = 6;
  if (omega.empty()) throw std::invalid_argument("omega is empty; expected at least one frequency");
  double settling = 0, least = 0;
  std::vector<double> shortest;  // time that a step measures at least
  for (const double each : omega) {
    if (!(each > 0) || !std::isfinite(each))
      throw std::invalid_argument("omega holds " + detail::number_text(each) + " rad/s; expected finite numbers > 0");
    settling += static_cast<double>(settling_cycles) * 2 * pi / each;
    shortest.push_back(fewest * 2 * pi / each);
    least += shortest.back();
  }
  if (!(total_time >= settling + least) || !std::isfinite(total_time))
    throw std::invalid_argument(
        "total_time is " + detail::number_text(total_time) + " s; expected a finite number of at least " +
        detail::number_text(settling + least) + " s, which " + std::to_string(settling_cycles) +
        " cycles of settling and 6 that are measured take at each of " + std::to_string(omega.size()) + " frequencies");
  // Steps that six cycles take longer than an even share leave less for the others, and so may make more of them.
  double left = total_time - settling, share = 0;
  auto sharing = shortest;
  std::sort(sharing.begin(), sharing.end());
  while (!sharing.empty() && (share = left / static_cast<double>(sharing.size())) < sharing.back()) {
    left -= sharing.back();
    sharing.pop_back();
  }
  std::vector<SteppedSineStep> plan;
  double at = 0;
  for (const double each : omega) {
    const double cycles = std::max(fewest, std::floor(share * each / (2 * pi)));
    const double end = at + (static_cast<double>(settling_cycles) + cycles) * 2 * pi / each;
    plan.push_back({each, settling_cycles, static_cast<std::size_t>(cycles), at, end});
    at = end;
  }
  return plan;
}

}  // namespace frac
