// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <complex>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "frac/approximation/zero_pole_gain.hpp"

namespace frac {

/// How the fractional part s^a, -1 < a < 1, of a power of s is made rational.  a < 0 is the reciprocal of -a.
enum class ApproximationMethod {
  /// Least largest error over all real poles and zeros placed symmetrically on the band; the default.
  ladder,
  /// Oustaloup, Levron, Mathieu, Nanot (2000).  On its own band the error at the edges never vanishes.
  oustaloup,
  /// The same on a band wider by the margin that makes the error on the asked band smallest.
  oustaloup_widened,
  /// Xue, Zhao, Chen (2006) with b = 10, d = 9 and a mid-band gain of exactly 1.  Its error levels off at 2.7 to 12 %.
  refined_oustaloup,
  /// Matsuda, Fujii (1993): interpolates x^a at 2N+1 real points spread evenly in logarithm.
  matsuda,
  /// Carlson, Halijak (1964): Halley's iteration for roots s^(1/q), and products of them for a = m/q, q <= 10.
  carlson,
  /// Continued fraction of s^a at mid-band: its [N/N] Pade approximant.
  cfe,
  /// Charef, Sun, Tsao, Onaral (1992): corners at equal steps of the asymptotes.
  charef,
};

/// Names as on the command line: ladder, oustaloup, oustaloup-widened, refined-oustaloup, matsuda, carlson, cfe,
/// charef.
[[nodiscard]] std::string_view to_string(ApproximationMethod method);
/// @throws std::invalid_argument  unknown name; the text lists the known ones.
[[nodiscard]] ApproximationMethod approximation_method_from_string(std::string_view text);
[[nodiscard]] std::span<const ApproximationMethod> approximation_methods();

/// Number of poles, and as many zeros, that stand for s^a.
struct PoleCount {
  int poles;
};

/// Largest |H(j omega)/(j omega)^order - 1| allowed on the band, 0 < value < 1.
struct Tolerance {
  double value;
};

/// A number of poles, or the smallest number that keeps a tolerance.
using ApproximationGoal = std::variant<PoleCount, Tolerance>;

enum class ApproximationStatus {
  /// The number of poles was given.
  as_asked,
  /// The tolerance is kept, and the method's design with one pole less does not keep it.
  met,
  /// The tolerance is not kept; the result is the best found.
  not_attainable,
};

/// met, as-asked, not-attainable.
[[nodiscard]] std::string_view to_string(ApproximationStatus status);

/// Deviation of H(j omega)/(j omega)^order from 1 on the band, in extended precision from the zeros, poles and gain as
/// they are stored, on a grid ten times denser than that of the design and refined at the largest value.
struct ApproximationError {
  /// |H/(j omega)^order - 1|.
  double max_relative = 0;
  /// Where that is reached, rad/s.
  double omega_at_maximum = 0;
  /// |20 log10 |H/(j omega)^order||.
  double max_decibels = 0;
  /// |arg(H/(j omega)^order)|.
  double max_degrees = 0;
  int grid_points = 0;
};

/// Partial fractions of H(s)/s^integer_order, for sections side by side.  Two forms share the residues; sums run over
/// the poles and, for a conjugate pair, over both members:
///   direct      + sum residue/(s - pole)             whose terms cancel at low frequency where the power rises,
///   static_gain + sum (residue/pole) s/(s - pole)    whose terms cancel at high frequency where the power falls.
/// The errors include the rounding of the stored numbers and of sums in double, taken in any order.
struct ParallelForm {
  double direct = 0;
  /// One per real pole, in the order of ZeroPoleGain::poles.
  std::vector<double> residues;
  /// Of the pole in ZeroPoleGain::pole_pairs; its conjugate has the conjugate residue.
  std::vector<std::complex<double>> pair_residues;
  /// Value at s = 0; NaN where the system has a pole there.
  double static_gain = std::numeric_limits<double>::quiet_NaN();
  /// Bounds of |H/(j omega)^order - 1| on the band, of the form with `direct` and of the one with `static_gain`.
  double direct_error = 0;
  double static_error = std::numeric_limits<double>::quiet_NaN();
};

/// A rational stand-in for s^order and what to state about it.
struct Approximation {
  /// The tolerance is kept, where one was asked for.
  [[nodiscard]] bool usable() const noexcept { return status != ApproximationStatus::not_attainable; }
  /// Order, band, method, poles and error.
  [[nodiscard]] std::string summary() const;

  double order;
  FrequencyBand band;
  ApproximationMethod method;
  /// What else defines the method's design, e.g. margin_decades.
  std::vector<std::pair<std::string, double>> parameters;
  ZeroPoleGain system;
  ParallelForm parallel;
  int poles;  // of the fractional part
  ApproximationError error;
  /// Poles that the attainable limit e(N) = 2 sin(pi |a|) exp(-pi^2 N/(ln(upper/lower) + 4 ln 2)) asks for at the
  /// tolerance or, where poles were given, at the error reached.  A figure for bands of two decades and more.
  int limit_poles;
  ApproximationStatus status;
  std::string message;  // one sentence
};

/// Rational approximation of s^order on a band.  The whole part trunc(order) is exact (system.integer_order) and a
/// whole order takes no poles.  All methods but carlson give real zeros and poles, negative but for one at exactly 0 of
/// refined_oustaloup: a zero for 0 < a < 1, a pole for -1 < a < 0.
/// Design work is done on the band scaled to have its geometric mean at 1 rad/s.
/// @throws std::invalid_argument  order not finite or |order| > 20; band not 0 < lower < upper < infinity or not
/// between 0.01 and 24 decades wide; poles not within 1 .. 200 (matsuda: 60), or a number the method cannot give
/// (refined-oustaloup: below 3; carlson: the text lists what there is); tolerance not within (0, 1); carlson: |a| is
/// not m/q.
[[nodiscard]] Approximation approximate(double order, FrequencyBand band, ApproximationGoal goal,
                                        ApproximationMethod method = ApproximationMethod::ladder);

}  // namespace frac
