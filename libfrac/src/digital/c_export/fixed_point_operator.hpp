// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <complex>
#include <cstdint>
#include <vector>

#include "frac/digital/digital_filter.hpp"
#include "frac/digital/fractional_pid.hpp"

/// Filters in whole numbers, with bounds of what rounding does to their output.
namespace frac::detail::fixed_point {

/// sum tap_k x_(n-k) over 2^head, within -1 .. 1 for inputs that are.
struct Taps {
  int head = 0;
  std::vector<std::int64_t> taps;  // times 2^(30 - head); empty: x itself
  double swing = 1;                // largest output for inputs up to 1
  double error = 0;                // of the output for exact inputs

  [[nodiscard]] double error_with(double of_input) const { return swing * of_input + error; }
};

/// v += x - r v as p = r v/2^head: p += r (x/2^head - p), which stays within -1 .. 1 for inputs that do.
struct Section {
  int head;
  int slower;         // r = rate/2^(30 + slower)
  std::int64_t rate;  // 2^30 to below 2^31
  double gain;        // of p in the output, both as fractions of their ranges
  double error;       // of p as the output takes it, its largest over all time, for an exact input
  double swing;       // largest p for inputs up to 1
};

/// The same with a complex rate, p += r (x/2^head - p), |p| <= 1.
struct Pair {
  int head;
  int slower;                     // r = rate/2^(29 + slower)
  std::int64_t rate_re, rate_im;  // the larger 2^29 to 2^30
  std::complex<double> gain;      // the output is Re(gain p), both as fractions of their ranges
  double error;                   // of |p| as the output takes it, its largest over all time, for an exact input
  double swing;                   // largest |p| for inputs up to 1
};

/// Taps, sections and pairs in whole numbers.  Inputs are fractions of their range times 2^30; sums are those of the
/// output range times 2^(bits + 30 - guard).
struct Operator {
  Taps taps;
  std::vector<Section> sections;
  std::vector<Pair> pairs;
  std::int64_t direct = 0;
  std::vector<std::int64_t> gains;
  std::vector<std::int64_t> pair_gains_re, pair_gains_im;
  int bits = 0;
  int guard = 0;
  double largest = 0;  // gain
  double error = 0;    // of the output for exact values behind the taps, over its range
  double swing = 0;    // output over the largest value behind the taps, both over their ranges

  [[nodiscard]] int scale() const { return bits + 30 - guard; }
  [[nodiscard]] double error_with(double of_input) const { return error + swing * taps.error_with(of_input); }
};

/// What a filter has beside its sections.
struct Others {
  std::vector<double> taps = {1};
  std::vector<std::complex<double>> pair_rates = {}, pair_weights = {};
};

/// @param scale  input range over output range, times a gain in front
/// @throws std::invalid_argument  complex poles that are damped too little
[[nodiscard]] Operator operator_of(const ParallelSections& parallel, const Others& others, double scale);
[[nodiscard]] Operator operator_of(const PidFilter& from, double scale);

/// A gain as a whole number below 2^30 and a shift to the right.
struct Product {
  std::int64_t number = 0;
  int shift = 0;
  double rounding = 0;  // of the gain
};

/// @throws std::invalid_argument  a gain of 2^30 or more
[[nodiscard]] Product product_of(double gain);

[[noreturn]] void refuse_gain(double gain);

}  // namespace frac::detail::fixed_point
