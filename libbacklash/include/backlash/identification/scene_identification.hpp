// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <complex>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "backlash/describing_function.hpp"
#include "frac/identification/fit.hpp"
#include "frac/model/frequency_response_data.hpp"

namespace backlash {

/// One measured curve N(F, omega) in m/N and the amplitude of the force it was taken at.
struct MeasuredDescribingFunction {
  frac::FrequencyResponseData data;
  double force_amplitude;  // N, > 0
};

struct SceneIdentificationOptions {
  Output output = Output::x1;                         // whose motion was measured
  frac::Component component = frac::Component::both;  // both, real or imaginary
  /// relative: noise in proportion to |N|, that of the model for both parts, of the data for one; given: the sigma of
  /// the data; absolute: equal noise.
  frac::Weight weight = frac::Weight::relative;
  /// With the weight given: sigma are the deviations themselves, as a measurement tells them, and not only their
  /// ratios. The variance of the residuals then counts as 1 at least: a few points that lie close by accident narrow
  /// nothing.
  bool sigma_is_measured = false;
  /// On mass1, mass2 (kg), clearance (m) and restitution.  Default limits: a factor 1e6 about what the data suggest for
  /// masses and clearance, [0, 1] for restitution.
  std::vector<frac::ParameterConstraint> constraints;
  int threads = 0;  // 0: one per core; the result does not depend on it
};

/// An estimate of a parameter of the scene, or of a combination of them.
struct SceneEstimate {
  std::string name;
  std::string unit;
  double value;
  /// From the residual variance or, where that says more, from how far each point by itself moves the estimate (the
  /// jackknife); widened by the correlation of neighbouring residuals where it is no chance.  0 when fixed; NaN at a
  /// bound, or when no value is better than another.
  double standard_error;
  /// Student t, stretched over the intervals of rival scenes; NaN like standard_error.
  double ci95_lower, ci95_upper;
  bool fixed;
  bool at_bound;
  /// Fixed, or the search settled, no parameter is at a limit, the scene describes the data and the interval is no
  /// wider than the value (than the range [0, 1] for restitution).
  bool identified;
};

enum class PointStatus {
  used,
  /// So far from every steady motion of the fitted scene that it is likelier another motion than the predicted one
  /// (near a jump), or an outlier.
  off_branch,
  /// On no motion of the fitted scene with two impacts per period, nor on one that sticks, but where it has others:
  /// more impacts, subharmonics or chaos, which depend on how the frequency was reached; or x1 without impacts, which
  /// stands still.
  irregular,
};
[[nodiscard]] std::string_view to_string(PointStatus status);

/// What became of one point of the data.
struct ScenePoint {
  std::size_t curve;  // index of the curve
  std::size_t index;  // in that curve
  double omega;       // rad/s
  PointStatus status;
  Regime regime;                  // of the steady motion it is compared with
  std::complex<double> model;     // m/N at the estimate; NaN when irregular
  std::complex<double> residual;  // (model - data) over its standard deviation (sigma, |N| or 1 m/N); NaN likewise
};

/// Another scene that explains the data nearly as well.
struct RivalScene {
  std::array<double, 4> parameters;  // mass1, mass2, clearance, restitution
  double odds;  // evidence of the estimate over that of this scene: 1 to 150, at restitution below 0.1 up to 10^9
};

struct SceneIdentification {
  /// The search settled.  SceneEstimate::identified says which parameters the data determine.
  [[nodiscard]] bool usable() const noexcept { return termination == frac::FitTermination::converged; }
  /// Parameters with their 95 % intervals, and the message.
  [[nodiscard]] std::string summary() const;

  std::array<SceneEstimate, 4> parameters;    // mass1, mass2, clearance, restitution
  std::array<SceneEstimate, 3> combinations;  // mass1 + mass2, mass2 clearance, mass1/mass2
  /// One sentence per direction in the space of the parameters that the data leave free.
  std::vector<std::string> free_directions;
  /// One sentence for each way in which the data contradict the scene: residuals that follow a shape, curves that
  /// contradict each other, points off all of its motions.  Nothing counts as identified then.
  std::vector<std::string> misfits;
  double residual_correlation;     // of neighbours; 0 where it may be chance
  std::vector<RivalScene> rivals;  // best first
  std::vector<ScenePoint> points;
  std::size_t points_used;
  std::size_t residuals;        // count
  std::size_t free_parameters;  // count of what the data determine: fixed ones and free directions do not count
  double cost;                  // sum of squared residuals of the points used
  double rms;                   // sqrt(cost/residuals)
  double max_residual;          // largest part of a residual used, in magnitude
  double condition;             // of the scaled Fisher matrix; above 1e6 a direction counts as free
  std::array<std::array<double, 4>, 4> covariance;  // NaN beside a parameter without standard error, 0 beside fixed
  frac::FitTermination termination;
  std::string message;         // one sentence
  std::size_t starts;          // local solves made
  std::size_t starts_at_best;  // of which ended at the same estimate
  double seconds;

  /// The scene at the estimate. @throws std::invalid_argument  no usable start: there is none.
  [[nodiscard]] TwoMassSystem system() const;
};

/// Estimates masses, clearance and restitution from describing functions at one or several force amplitudes, the two
/// masses themselves being the model.
///
/// In dimensionless terms the motion depends on F/(mass2 clearance omega^2) and restitution alone.  So x1 determines
/// mass1 + mass2, mass2 clearance and restitution: one of the masses or the clearance must be fixed for the others to
/// have values.  x2 determines all four, its imaginary part alone mass1/(mass2 (mass1 + mass2)), mass2 clearance and
/// restitution.  The imaginary part of x1 at low frequency, where the masses chatter, is the power law
///   K(restitution) (mass2 clearance/F)^(4/3) omega^(2/3)/(mass1 + mass2)
/// and determines that product only.  What the data at hand leave free is found from their Fisher matrix and reported.
///
/// Each point is compared with the steady motion of the scene that lies nearest: the orbit of two impacts per period
/// (closed form, with exact derivatives, at first also followed past its loss of stability, so that a jump in the data
/// does not trap the search), motion that sticks every period after chatter, or none at all (x2).  Between the first
/// two, where the motion is chaotic or depends on its history, points are left out, as are points far from every
/// motion; which ones is decided anew at each estimate and listed.  A point left out costs the scene as much evidence
/// as a value of which only the size is explained, so that a scene does not gain by explaining little; at the best
/// estimates simulations from a dozen starts tell what the scene does there, and a point on a subharmonic orbit of it,
/// say, costs as much less as it lies nearer to that.
///
/// The search begins where the law of -1/N places pairs of points of x1, or single ones where both masses or the
/// restitution are known (tools/docs/methods/loss-factor.md); on a grid over mass2 clearance and restitution, with the
/// masses from linear least squares; where the discontinuities of the data place the jump, and where the orbits of two
/// impacts alone explain part of the data; the best places are solved by Levenberg and Marquardt's method in ln mass1,
/// ln mass2, ln clearance and restitution, and the estimate is the one of greatest evidence.  Others of nearly equal
/// evidence are listed and stretch the intervals.
/// @throws std::invalid_argument  no curve; a force amplitude not positive; component magnitude or phase; weight
///     smoothed-relative, log-complex or repeats, or given without sigma; a constraint of an unknown name, out of range
///     or contradictory; fewer residuals than free parameters; all data zero.
[[nodiscard]] SceneIdentification identify_scene(const std::vector<MeasuredDescribingFunction>& curves,
                                                 const SceneIdentificationOptions& options = {});

}  // namespace backlash
