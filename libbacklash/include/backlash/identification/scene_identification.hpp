// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <complex>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "backlash/compliant_contact.hpp"
#include "backlash/describing_function.hpp"
#include "frac/identification/fit.hpp"
#include "frac/model/frequency_response_data.hpp"

namespace backlash {

/// One measured curve N(F, omega) in m/N and the amplitude of the force it was taken at.
struct MeasuredDescribingFunction {
  frac::FrequencyResponseData data;
  double force_amplitude;  // N, > 0
  /// 1, 3 or 5: of the position, over the amplitude of the force, its phase counted from as many times that of the
  /// force.
  int harmonic = 1;
};

/// What a contact is taken for.
enum class ContactModel {
  hard,       // an impact of a restitution, which takes no time
  compliant,  // stiffness and damping, see CompliantContact
  automatic,  // compliant, with the hard contact as its limit
};
[[nodiscard]] std::string_view to_string(ContactModel model);  // hard, compliant, auto
[[nodiscard]] std::span<const ContactModel> contact_models();
/// @throws std::invalid_argument  naming the allowed ones.
[[nodiscard]] ContactModel contact_model_from_string(std::string_view text);

/// What the data say of the contact.
enum class ContactVerdict {
  hard,       // that was asked for
  compliant,  // told from a hard one
  undecided,  // either explains the data
};
[[nodiscard]] std::string_view to_string(ContactVerdict verdict);

/// Whether masses may rub on the ground.
enum class FrictionModel {
  none,
  automatic,  // where the data ask for it
  estimate,   // from 0 on
};
[[nodiscard]] std::string_view to_string(FrictionModel model);  // none, auto, estimate
[[nodiscard]] std::span<const FrictionModel> friction_models();
/// @throws std::invalid_argument  naming the allowed ones.
[[nodiscard]] FrictionModel friction_model_from_string(std::string_view text);

/// What the data say of dry friction.
enum class FrictionVerdict {
  none,       // that was asked for
  present,    // told from none
  undecided,  // either explains the data
};
[[nodiscard]] std::string_view to_string(FrictionVerdict verdict);

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
  /// On mass1, mass2 (kg), clearance (m), restitution, contact_time (s), friction1 and friction2 (N).  Default limits:
  /// a factor 1e6 about what the data suggest for masses and clearance, [0, 1] for restitution, from 0 to half the
  /// period of the median frequency for contact_time, which is 0 of hard contacts, and from 0 to the least force
  /// amplitude for friction.
  std::vector<frac::ParameterConstraint> constraints;
  ContactModel contact = ContactModel::automatic;
  FrictionModel friction = FrictionModel::none;
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
  double contact_time;               // s, 0 of hard contacts
  std::array<double, 2> friction;    // N, of mass 1 and mass 2
  double odds;  // evidence of the estimate over that of this scene: 1 to 150, at restitution below 0.1 up to 10^9
};

struct SceneIdentification {
  /// The search settled.  SceneEstimate::identified says which parameters the data determine.
  [[nodiscard]] bool usable() const noexcept { return termination == frac::FitTermination::converged; }
  /// Parameters with their 95 % intervals, and the message.
  [[nodiscard]] std::string summary() const;

  std::array<SceneEstimate, 4> parameters;    // mass1, mass2, clearance, restitution
  std::array<SceneEstimate, 3> combinations;  // mass1 + mass2, mass2 clearance, mass1/mass2
  /// contact_time (s, of a contact of bodies on which nothing else acts), contact_stiffness (N/m), contact_damping
  /// (N s/m) and contact_restitution (that of such a contact, `restitution` again).  Stiffness and damping are infinite
  /// at contact time 0, and have no upper end of their interval where that may be 0.  Empty for ContactModel::hard.
  std::vector<SceneEstimate> contact;
  /// Whether the data tell the contact from a hard one: compliant where the likelihood ratio is beyond what chance does
  /// once in a thousand and the interval of the contact time excludes 0.
  ContactVerdict contact_verdict;
  /// Twice the logarithm of the likelihood of contacts that take time over that of hard ones, each at its best and at
  /// its own noise; NaN for ContactModel::hard.
  double contact_evidence;
  /// friction1 and friction2 (N).  Empty where the values are those of a scene without friction.
  std::vector<SceneEstimate> friction;
  /// Whether the data tell friction from none: present where the likelihood ratio is beyond what chance does once in a
  /// thousand and the interval of either friction or of their sum excludes 0.
  FrictionVerdict friction_verdict;
  /// Twice the logarithm of the likelihood of scenes with friction over that of those without, each at its best and at
  /// its own noise; NaN for FrictionModel::none and where either has no more residuals than the first have parameters.
  double friction_evidence;
  /// One sentence per direction in the space of the parameters that the data leave free.
  std::vector<std::string> free_directions;
  /// One sentence for each way in which the data contradict the scene: residuals that follow a shape, curves that
  /// contradict each other, points off all of its motions.  Nothing counts as identified then.  Of a scene whose
  /// parameters are all fixed too.
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

  /// The scene at the estimate, with the restitution of a free contact. @throws std::invalid_argument  no usable start:
  /// there is none.
  [[nodiscard]] TwoMassSystem system() const;
  /// Empty where the estimate is a hard contact.
  [[nodiscard]] std::optional<CompliantContact> compliant_contact() const;
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
///
/// Harmonics are curves of their own, beside at least one of the fundamental, from which the search begins.  Between
/// impacts a position moves by its force alone, so that of motions with two hard impacts per period the third and fifth
/// harmonic of x1 follow from the fundamental: they tell whether the contacts are hard, how long they last, and what
/// motion it is.
///
/// Unless contacts are to be hard, the search goes on from there with the time of a free contact as a fifth parameter,
/// from 0 on: two contacts per period by the closed form of their flights, other orbits of one period by Newton's
/// method on the flow (tools/docs/methods/compliant-contact.md), where hard contacts do not describe the data from
/// places with longer contacts too.  Near 0 N changes in proportion to it, so that the intervals of the others hold for
/// all contact times that the data allow, also where the estimate is a hard contact.
///
/// Then dry friction of both masses, from 0 on, is freed in the same way, each point being compared with the stable
/// orbit of one period that Newton's method on the flow finds.  FrictionModel::automatic takes the scene with friction
/// where the data tell it from none, and else answers for a scene without, whose intervals reach over those of the
/// scene with friction; FrictionModel::estimate answers with friction.  Intervals of both hold for all friction that
/// the data allow.  Where no scene with friction was found, nothing counts as identified.
///
/// Points of x1 with N = 0, of a load at rest, form no residuals and are not listed.
/// @throws std::invalid_argument  no curve of the fundamental; a harmonic other than 1, 3 and 5; a force amplitude not
///     positive; component magnitude or phase; weight
///     smoothed-relative, log-complex or repeats, or given without sigma; a constraint of an unknown name, out of range
///     or contradictory, of contact_time where contacts are hard or of friction where there is none; fewer residuals
///     than free parameters; all data zero.
[[nodiscard]] SceneIdentification identify_scene(const std::vector<MeasuredDescribingFunction>& curves,
                                                 const SceneIdentificationOptions& options = {});

}  // namespace backlash
