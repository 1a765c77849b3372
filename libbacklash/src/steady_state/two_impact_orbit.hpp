// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "closed_orbit.hpp"
#include "motion/gap_motion.hpp"

namespace backlash::detail {

/// Orbit of one force period with one impact at each wall; both impacts have the same speed, also where it is not
/// symmetric.
struct TwoImpactOrbit {
  double gamma;
  double speed;        // before either impact
  GapState start;      // just after the impact at the wall u = 0
  double flight_time;  // radians from u = 0 to u = 1; pi when symmetric
  [[nodiscard]] bool symmetric() const noexcept;
};

/// The impact at the wall u = 0 of the symmetric orbit, in closed form.
struct SymmetricImpact {
  double speed;  // before it
  double sin_phase, cos_phase;
  double uncertainty;  // of U_1: rounding of gamma and of the closed form, which the saddle-node amplifies
};

/// The symmetric two-impact orbits of one restitution: v the larger root of [(1-e)^2 + pi^2 (1+e)^2/4] v^2 - pi (1+e) v
/// + 1 - 4 gamma^2 = 0, sin phi = -v (1-e)/(2 gamma), cos phi = [1 - pi (1+e) v/2]/(2 gamma).  From the two equations
/// of a flight of pi radians from u = 0 to 1 that starts and ends alike.
class SymmetricFamily {
 public:
  explicit SymmetricFamily(double restitution) noexcept;
  /// gamma below which there is none.
  [[nodiscard]] double saddle_node() const noexcept { return saddle_node_; }
  /// @param gamma  from the saddle-node on
  [[nodiscard]] SymmetricImpact at(double gamma) const noexcept;

 private:
  double lost_;  // 1 - e
  double kept_;  // 1 + e
  double saddle_node_;
  double a_;  // coefficients of v^2 and v
  double inverse_a_;
  double half_b_;
};

/// The symmetric orbit in closed form (the branch of larger speed); empty below the saddle-node.
[[nodiscard]] std::optional<TwoImpactOrbit> symmetric_two_impact_orbit(double gamma, double restitution);

/// gamma at which the symmetric orbit appears, and at which its symmetry breaks (pitchfork).
[[nodiscard]] double saddle_node_gamma(double restitution);
[[nodiscard]] double symmetry_breaking_gamma(double restitution);

/// Member of the asymmetric family whose flight from u = 0 to u = 1 lasts pi - 2 asymmetry, with asymmetry in (0,
/// pi/2); its mirror twin has the two flights exchanged.  Tends to the symmetric orbit at symmetry_breaking_gamma as
/// asymmetry -> 0.
[[nodiscard]] TwoImpactOrbit asymmetric_two_impact_orbit(double asymmetry, double restitution);

/// How the orbit fares in the true motion.
struct TwoImpactStability {
  bool admissible;  // no contact besides the two impacts
  double trace;     // of the Jacobian of one period; NaN where not admissible
  double determinant;
  [[nodiscard]] bool stable() const noexcept;
};
[[nodiscard]] TwoImpactStability two_impact_stability(const TwoImpactOrbit& orbit, double restitution);

/// The stable two-impact orbit at this gamma, symmetric or not; empty when there is none.
[[nodiscard]] std::optional<TwoImpactOrbit> stable_two_impact_orbit(double gamma, double restitution);
/// Same, for callers that already have the gamma of two_impact_loss(): finding it is the expensive part.
[[nodiscard]] std::optional<TwoImpactOrbit> stable_two_impact_orbit(double gamma, double restitution,
                                                                    double loss_gamma);

/// Harmonics in closed form.
[[nodiscard]] Harmonics two_impact_harmonics(const TwoImpactOrbit& orbit, double restitution);

/// Low-frequency end of the stable two-impact orbit.
enum class TwoImpactEnd { grazing, period_doubling, fold };
struct TwoImpactLoss {
  double gamma;
  TwoImpactEnd end;
  bool symmetric;  // the orbit is still symmetric at its end
};
/// @param restitution  in (0, 1]
[[nodiscard]] TwoImpactLoss two_impact_loss(double restitution);
/// End of the symmetric orbit: symmetry breaking, or grazing when that comes first (restitution below 0.0867).
struct SymmetryLoss {
  double gamma;
  bool grazing;
};
[[nodiscard]] SymmetryLoss symmetry_loss(double restitution);

}  // namespace backlash::detail
