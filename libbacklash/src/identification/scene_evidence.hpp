// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "scene_solver.hpp"

namespace backlash::detail {

/// How well a scene explains all points of the data, those that it leaves out among them.
///
/// A point that is used has residuals drawn from a normal distribution whose variance s^2, relative to its deviation,
/// all points share.  One that is left out pays for it by what is expected of it without the scene's steady motions:
///  - where the scene is irregular N lies about its mean, or the N of a motion that simulations of it settle on, by a
///    Cauchy distribution as wide as that is known,
///  - where the scene has a definite motion the point is an exception, of which one point in twenty is expected, and
///  its
///    value lies either about that motion, to a tenth, or as likely anywhere within |N| of the origin.
/// With n residuals of p parameters and cost C, the integral over s and, by Schwarz's approximation, over the
/// parameters leaves of -2 ln(evidence)
///   (n - p) ln(2 pi s^2) + n - p + p ln n + 2 sum ln(deviation) + sum of the prices,   s^2 = C/(n - p).
/// So an exception costs up to 4 ln(1/s) + 8: as much as at noise of 1 % a residual of 5 sigma does.
struct SceneEvidence {
  double deviance = 0;   // -2 ln(evidence) up to a constant of the data; infinite when too few points are used
  double deviation = 0;  // s
  std::size_t used = 0;  // points
};

/// @param choices  used, kind, misfit and model are read
/// @param parameters  count of those estimated
/// @param accuracy  to which the motions are known, as a share of N: s is no less
[[nodiscard]] SceneEvidence scene_evidence(const SceneData& data, const std::vector<PointChoice>& choices,
                                           std::size_t parameters, double accuracy);

/// Uses the points with which the evidence is greatest, at the misfits they have: those of least misfit.
void use_by_evidence(const SceneData& data, std::vector<PointChoice>& choices, std::size_t parameters, double accuracy);

/// Compares the points that a settled scene leaves out with the motions that simulations of it settle on, and rates the
/// scene anew: points on subharmonic orbits, or about a mean, count as explained by what the scene itself does there.
void explain_left_out(const SceneData& data, std::size_t parameters, LocalScene& local);

}  // namespace backlash::detail
