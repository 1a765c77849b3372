// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

namespace frac::detail {

/// Poles of a ladder for every order between 0 and 1, as smooth functions of the order: those that make the mean of
/// |ln(H/(j omega)^order)|^8 over the band least, interpolated in the order at Chebyshev points.  The minimax ladder
/// itself has kinks in the order, where one maximum of its error takes over from another; the mean of eighth powers is
/// within some ten per cent of it.
class LadderTable {
 public:
  /// half_width as in UnitProblem, poles >= 1.
  LadderTable(double half_width, int poles);

  /// Logarithms of the poles, rising, and their derivatives by the order, 0 < order < 1; zeros are the reciprocals,
  /// the gain is the product of the poles.
  void evaluate(double order, std::vector<double>& log_poles, std::vector<double>& by_order) const;

 private:
  // One row of Chebyshev coefficients per pole; of the last pole plus ln(1 - order), since it goes to infinity as
  // 1/(1 - order).
  std::vector<std::vector<double>> coefficients_;
};

}  // namespace frac::detail
