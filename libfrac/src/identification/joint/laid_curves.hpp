// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "frac/identification/joint_fit.hpp"
#include "laws.hpp"
#include "preparation.hpp"

namespace frac::detail {

/// Shift factors are positive, whatever else is known of them.
void keep_shifts_positive(std::vector<ParameterConstraint>& constraints, const CurveShift& shift);

/// Residuals that a fit with a shift factor of each curve leaves.
struct FreeShifts {
  double squares;       // each residual by the noise of its curve
  double unlikelihood;  // see JointSearch
  std::size_t residuals, free_parameters;
};

/// Curves laid on each other by free factors, and by the laws of factors where there are such.
struct LaidCurves {
  Preparation known;
  std::optional<FreeShifts> free;  // none where free factors are more than the residuals tell, or nothing was found
};
/// @param options       with a shift
/// @param without_laws  the same without what is said of parameters of the laws
[[nodiscard]] LaidCurves lay_curves(const std::vector<JointCurve>& curves, const Structure& master,
                                    const Structure& structure, const JointFitOptions& options,
                                    const JointFitOptions& without_laws, const Laws& laws);

/// Laws of shift factors against factors of each curve (F test): see JointFitResult::sharing_p_value.
/// @param squares  of the fit with the laws, by the noise of the free factors
void compare_with_free(const FreeShifts& free, double squares, JointFitResult& result);

}  // namespace frac::detail
