// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <complex>
#include <vector>

#include "formula/power_sum.hpp"

namespace frac::detail {

/// sum c e^{q zeta}, that is sum c s^q at zeta = ln s, and its derivative with respect to zeta, both divided by e^scale
/// so that they neither overflow nor vanish.  With zeta = ln|s| + i arg s every sheet has its own arguments.
struct ScaledSum {
  std::complex<double> value;
  std::complex<double> slope;
  double scale;
  double magnitude;  // sum of the moduli of the terms of value
};
[[nodiscard]] ScaledSum scaled_sum(const std::vector<PowerTerm>& terms, std::complex<double> zeta);
/// @param log_size  ln|coefficient| of each term, for many sums of the same terms
[[nodiscard]] ScaledSum scaled_sum(const std::vector<PowerTerm>& terms, const std::vector<double>& log_size,
                                   std::complex<double> zeta);

/// The same of a product, from its factors; magnitude: relative to |value|, the sum of those of its factors.
[[nodiscard]] ScaledSum scaled_sum(const PowerProduct& product, std::complex<double> zeta);

/// Taylor coefficients f^(j)/j! of a sum about zeta, over e^scale, for j = 0 to count - 1, and bounds of their errors
/// in units of the rounding unit.
struct TaylorStart {
  std::vector<std::complex<double>> coefficient;
  std::vector<double> rounding;
};
[[nodiscard]] TaylorStart taylor_start(const std::vector<PowerTerm>& terms, std::complex<double> zeta, int count);

/// scaled_sum(terms, zeta + offset) e^(scale there - scale at zeta) without the first `order` terms of its expansion in
/// offset: where they vanish but for rounding, the rest is known to relative accuracy however small the offset is.
struct DeflatedSum {
  std::complex<double> value;
  double magnitude;  // sum of the moduli of its parts
};
[[nodiscard]] DeflatedSum deflated_sum(const std::vector<PowerTerm>& terms, std::complex<double> zeta,
                                       std::complex<double> offset, int order);

}  // namespace frac::detail
