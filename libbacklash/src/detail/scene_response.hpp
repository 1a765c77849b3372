#pragma once

#include <complex>
#include <optional>

#include "backlash/describing_function.hpp"
#include "detail/gap_motion.hpp"

namespace backlash::detail {

/// h = 1 + U/gamma of a steady relative motion, U the phasor of u = y/clearance, with its derivatives.
struct GapResponse {
  std::complex<double> h;
  std::complex<double> by_log_gamma;
  std::complex<double> by_restitution;
};

/// The orbit of two impacts per period, symmetric up to symmetry_breaking_gamma and asymmetric above, whether stable or
/// not, in closed form.  Empty below the saddle-node, or where no member of the asymmetric family has this gamma.
/// @param restitution  in [0, 1]
[[nodiscard]] std::optional<GapResponse> two_impact_response(double gamma, double restitution);

/// Any other closed motion, told apart by regime, period and impacts, and found again from a state on it.
struct MotionBranch {
  Regime regime;
  int period;
  double impacts_per_period;
  GapState state;  // at a peak of the force; just after an impact where `flies`
  bool flies;      // never rests: followed by Newton's iteration on its impacts, stable or not
};

/// The motion that a start leads to; empty when it is averaged, free of impacts, or the two-impact orbit.
struct BranchValue {
  MotionBranch branch;
  std::complex<double> h;
};
[[nodiscard]] std::optional<BranchValue> motion_from(double gamma, double restitution, const GapState& start);

/// The same branch at another gamma and restitution; empty where the motion has become another one.
[[nodiscard]] std::optional<std::complex<double>> continued(const MotionBranch& branch, double gamma,
                                                            double restitution);
/// With derivatives by central differences; empty also where a neighbour they need is another motion.
[[nodiscard]] std::optional<GapResponse> branch_response(const MotionBranch& branch, double gamma, double restitution);

/// Contact at rest, the force at its peak: leads to the chattering motion where there is one.
[[nodiscard]] GapState contact_at_rest_state();

}  // namespace backlash::detail
