// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

namespace frac {

/// Which lines of its period a multisine excites.
enum class MultisineLines {
  full,       // all of the band: the most points, distortion is not told from one record
  odd,        // every other one: even distortion shows beside them
  odd_random  // odd ones, of each four neighbours one left out at random: odd distortion shows as well
};
[[nodiscard]] constexpr std::array<MultisineLines, 3> multisine_lines() {
  return {MultisineLines::full, MultisineLines::odd, MultisineLines::odd_random};
}
/// "full", "odd", "odd-random".
[[nodiscard]] std::string_view to_string(MultisineLines lines);

struct MultisineOptions {
  double lower = 0, upper = 0;  // band, rad/s, 0 < lower <= upper, below half the sampling rate
  double period = 0;            // s, a whole number of samples, at least 4
  double sample_time = 0;       // s
  MultisineLines lines = MultisineLines::odd_random;
  double peak = 1;         // largest absolute value, > 0
  std::uint64_t seed = 1;  // of the phases and of the lines left out: each seed is another realisation
  int rounds = 500;        // in which the phases are made better, >= 0
};

/// One period of a sum of sines of equal amplitude.
struct Multisine {
  std::vector<double> samples;
  std::vector<std::size_t> lines;  // of the period, rising
  double amplitude = 0;            // of each line
  double crest_factor = 0;         // peak over root mean square
};

/// A multisine whose peak is small beside its power: random phases, then rounds of clipping in time and restoring the
/// amplitudes in frequency (Van der Ouderaa, Schoukens, Renneboog 1988); the best round is returned.
/// @throws std::invalid_argument  an option out of its range, or no line in the band; the text names it.
[[nodiscard]] Multisine multisine(const MultisineOptions& options);

/// Whole cycles of one frequency of a stepped sine.
struct SteppedSineStep {
  double omega;                     // rad/s
  std::size_t settling, measuring;  // cycles; those of settling come first
  double begin, end;                // s
};

/// Steps one after the other, in the order of `omega`, that take `total_time` or less: each settles for so many cycles,
/// and what is left is shared evenly in time, because noise that is as large everywhere gives a line a variance of
/// 1/time at every frequency.  Of the shares whole cycles are kept, of each at least six, from which response() tells
/// the noise; more than its share takes a step that six cycles take longer than that.
/// @param omega       rad/s, > 0
/// @param total_time  s
/// @throws std::invalid_argument  no omega or one that is not a finite number > 0, or a total time in which six cycles
///                                of each do not fit; the text has the time that they take.
[[nodiscard]] std::vector<SteppedSineStep> stepped_sine_plan(const std::vector<double>& omega, double total_time,
                                                             std::size_t settling_cycles);

}  // namespace frac
