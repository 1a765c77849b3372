// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "frac/identification/joint_fit.hpp"

namespace frac::detail {

/// The structure fitted to all curves as one, and the factors that bring each onto it.
struct Superposition {
  FitResult master;
  std::vector<double> horizontal, vertical;  // of each curve; 1 of the reference
};
/// Lays each curve on its neighbour towards the reference where they overlap, fits the structure to all of them, and
/// lays each curve on that fit once more.
/// @throws std::invalid_argument  as joint_fit() says of shifts.
[[nodiscard]] Superposition superposed(const std::vector<JointCurve>& curves, const Structure& master,
                                       const CurveShift& shift, const FitOptions& options);

/// The structure fitted to all curves as one, each laid where its factors say.
[[nodiscard]] FitResult fit_laid(const std::vector<JointCurve>& curves, const std::vector<double>& horizontal,
                                 const std::vector<double>& vertical, const Structure& master,
                                 const FitOptions& options);

}  // namespace frac::detail
