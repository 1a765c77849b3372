// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "frac/identification/joint_fit.hpp"
#include "joint_problem.hpp"

namespace frac::detail {

/// Fits of the curves alone, none where a curve has none.
using Alone = std::vector<std::optional<FitResult>>;

/// Values of every parameter in the fits alone, one list per curve; the user's starts where no curve has a fit.
struct StartValues {
  std::vector<std::vector<double>> parameters;  // of each curve
  std::vector<bool> from_curve;
  std::vector<double> lead_laws;     // weight by which the laws follow the values of a curve at their start
  std::vector<double> of_laws = {};  // where their parameters start; empty: where the laws follow best
};

/// Knowledge before the curves are fitted together.
struct Preparation {
  Alone alone;
  StartValues values;
  std::vector<CurveOptions> settled;
  std::vector<double> noise;  // standard deviation of a residual of each curve
};

/// The options of a curve by itself.
[[nodiscard]] CurveOptions options_of(const JointCurve& curve, const JointFitOptions& options);

[[nodiscard]] Preparation from_fits_alone(const std::vector<JointCurve>& curves, const Structure& structure,
                                          const JointFitOptions& options);

}  // namespace frac::detail
