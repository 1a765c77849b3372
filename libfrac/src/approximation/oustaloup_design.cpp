// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>

#include "unit_design.hpp"

namespace frac::detail {

long double mid_band_gain(const UnitDesign& design) {
  long double gain = 1;
  const std::complex<long double> s(0, 1);
  for (const long double pole : design.poles) gain *= std::abs(s + pole);
  for (const long double zero : design.zeros) gain /= std::abs(s + zero);
  for (const auto& pair : design.pole_pairs) gain *= std::abs((s + pair) * (s + std::conj(pair)));
  for (const auto& pair : design.zero_pairs) gain /= std::abs((s + pair) * (s + std::conj(pair)));
  return gain;
}

// As in frac::oustaloup, with the geometric mean of the band at 1.
UnitDesign oustaloup_design(const UnitProblem& problem, int poles) {
  UnitDesign design;
  const long double half_width = problem.half_width;
  const long double rung = 2 * half_width / poles;
  for (int i = 0; i < poles; ++i) {
    const long double shift = static_cast<long double>(problem.order) / 2;
    design.zeros.push_back(std::exp((i + 0.5L - shift) * rung - half_width));
    design.poles.push_back(std::exp((i + 0.5L + shift) * rung - half_width));
  }
  design.gain = std::exp(half_width * problem.order);
  return design;
}

}  // namespace frac::detail
