// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <complex>
#include <cstddef>
#include <vector>

namespace frac::detail {

/// The places of residuals: points in order, `per_point` residuals of each.
struct ResidualAxis {
  std::size_t per_point = 1;
  std::vector<double> position = {};  // of the points, not falling: ln omega; empty over time
  /// Factors of the residuals of each point, a pair as real and imaginary part, to be errors relative to the
  /// model as far as they are relative to the data: an error of a gain or of a cable turns with the response, and
  /// weights by the data would bring their noise into columns of the model.  Empty: 1.
  std::vector<std::complex<double>> factor = {};
};

}  // namespace frac::detail
