// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <complex>
#include <string>
#include <utility>
#include <vector>

namespace frac::detail {

/// Stand-in for s^a, 0 < a < 1, on the band e^-half_width .. e^half_width rad/s:
///   gain prod (s + zeros_i)/prod (s + poles_i), pairs (s + c)(s + conj c) likewise.
/// Extended precision, so that the only rounding that counts is the last one to double.
struct UnitDesign {
  std::vector<long double> zeros;  // >= 0
  std::vector<long double> poles;  // > 0
  std::vector<std::complex<long double>> zero_pairs;
  std::vector<std::complex<long double>> pole_pairs;
  long double gain = 1;
  std::vector<std::pair<std::string, double>> parameters;
};

/// Power asked of a design, and the band in natural logarithm.
struct UnitProblem {
  double order;       // 0 < order < 1
  double half_width;  // (ln upper - ln lower)/2
};

/// gain such that |H(j)| = 1, for zeros and poles given.
[[nodiscard]] long double mid_band_gain(const UnitDesign& design);

[[nodiscard]] UnitDesign oustaloup_design(const UnitProblem& problem, int poles);
[[nodiscard]] UnitDesign oustaloup_widened_design(const UnitProblem& problem, int poles);
[[nodiscard]] UnitDesign refined_oustaloup_design(const UnitProblem& problem, int poles);
[[nodiscard]] UnitDesign matsuda_design(const UnitProblem& problem, int poles);
[[nodiscard]] UnitDesign cfe_design(const UnitProblem& problem, int poles);
[[nodiscard]] UnitDesign charef_design(const UnitProblem& problem, int poles);

/// Pole counts of carlson_design for order = m/q, rising. @throws std::invalid_argument  order is not m/q, q <= 10.
[[nodiscard]] std::vector<int> carlson_pole_counts(double order);
/// poles is one of carlson_pole_counts.
[[nodiscard]] UnitDesign carlson_design(const UnitProblem& problem, int poles);

}  // namespace frac::detail
