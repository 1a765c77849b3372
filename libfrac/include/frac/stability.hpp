// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <complex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "frac/model/fractional_transfer_function.hpp"

namespace frac {

/// A root of the denominator.  Of a conjugate pair only the one above the real axis is listed.
struct Pole {
  /// rad/s.
  std::complex<double> value;
  /// Roots of one factor closer than one part in a thousand count as one; those of different factors only where they
  /// agree to rounding.
  int multiplicity;
  /// The numerator vanishes there as many times, to 1e-9 of its terms.
  bool cancelled;
};

/// A root of the denominator as a polynomial in lambda = s^q, q the commensurate order.
struct SheetRoot {
  /// In the upper half plane.
  std::complex<double> lambda;
  int multiplicity;
  /// |arg lambda| <= q pi: it is a pole.
  bool on_principal_sheet;
  /// |arg lambda| > q pi/2.
  bool stable;
};

enum class Stability {
  /// A bounded input has a bounded output.
  stable,
  /// A pole lies on the imaginary axis, within 1e-9 rad.
  marginal,
  /// A pole lies right of the imaginary axis.
  unstable,
  /// G is unbounded at s = 0.
  integrating,
  /// G is unbounded at infinity.
  differentiating,
  /// The poles could not be counted.
  undetermined,
};
/// "stable", "marginal", ...
[[nodiscard]] std::string_view to_string(Stability stability) noexcept;

struct StabilityAnalysis {
  /// The poles could be counted.
  [[nodiscard]] bool usable() const noexcept { return stability != Stability::undetermined; }
  /// Stability and poles.
  [[nodiscard]] std::string summary() const;

  Stability stability;
  /// All with |arg s| <= pi, counted by the argument principle.
  std::vector<Pole> poles;
  /// As commensurate_order() of algebra.hpp finds it, if it is one of 1/1000 or more.
  std::optional<double> commensurate_order;
  /// Empty where there is no commensurate order (Matignon 1996).
  std::vector<SheetRoot> sheet_roots;
  /// One sentence that says why the stability is undetermined; else empty.
  std::string remark;
};
/// Stability and poles of a model; its dead time moves no pole and is not looked at.
[[nodiscard]] StabilityAnalysis analyse_stability(const FractionalTransferFunction& model);

/// Roots of 1 + L(s) = 0 with Re s > 0, dead time of L included, by the argument principle on D(s) + N(s) e^{-delay s}.
/// Marginal where none is right of the axis but one on it, or at s = 0: D(0) + N(0) is 0 to rounding of its terms.
/// Undetermined where the roots cannot be counted, and where |L| may be 1 beyond omega = 1e6/delay or an order is above
/// 1e6: the contour then makes more turns than can be followed.
struct ClosedLoopStability {
  /// stable, marginal, unstable or undetermined.
  Stability stability;
  /// Both members of a pair are counted.
  int unstable_poles;
};
/// @throws std::invalid_argument  L does not fall below 1 at high frequency.
[[nodiscard]] ClosedLoopStability analyse_closed_loop(const FractionalTransferFunction& loop);

/// sup |G(j omega)|: the extrema of |G| are roots of its logarithmic derivative, bracketed about every pole.
struct PeakGain {
  /// Infinite for a model that is not stable.
  double gain;
  /// rad/s; 0 or infinite where the supremum is a limit.
  double omega;
};
[[nodiscard]] PeakGain h_infinity_norm(const FractionalTransferFunction& model);

/// sqrt((1/pi) int_0^inf |G(j omega)|^2 d omega), relative error below 1e-12 at any damping of a stable model, for
/// the coefficients as they stand.  Infinite for a model that is not stable or falls no faster than omega^-1/2.
[[nodiscard]] double h2_norm(const FractionalTransferFunction& model);

struct Crossover {
  /// rad/s.
  double omega;
  /// Gain: the factor 1/|L| that makes |L| = 1 at phase -pi.  Phase: arg L + pi in (-pi, pi], rad.
  double margin;
};
/// Margins of the loop L by root finding on the exact response.
struct Margins {
  /// Where L is real and negative, by rising omega from 0 to infinity.
  std::vector<Crossover> gain;
  /// Where |L| = 1, by rising omega.
  std::vector<Crossover> phase;
  /// The factors nearest to 1 above and below it; infinite and 0 where there are none.
  double gain_margin = 0;
  double gain_reduction = 0;
  /// Smallest |margin| of `phase`, infinite where there is none; and the dead time that uses one up, s.  NaN where
  /// `remark` says that they are not determined.
  double phase_margin = 0;
  double delay_margin = 0;
  /// One sentence for each thing that is not determined or not listed; empty where nothing is missing.
  std::string remark;
};
/// |L| does not depend on the dead time: it is cut at its extrema and at every gain crossover into stretches where it
/// is monotone and on one side of 1.  On each, the phase crossover next to one of the ends has |L| nearest 1, so that
/// the margins are those of all phase crossovers, however many dead time makes.  Listed are those that decide the
/// margins and the others with |L| >= 1e-3 up to about the first thousand turns of the dead time; `remark` tells where
/// there are more.  A limit of L at omega = 0 or infinity that is finite, real and negative is a phase crossover:
/// there a pole of the closed loop passes through s = 0 or infinity.  So is, unlisted, a limit of |L| at high frequency
/// with dead time.  Not determined is a phase margin where delay omega is so large that its rounding exceeds 1e-3 rad,
/// and where |L| reaches 1 only beyond omega = e^690 or e^-690.
[[nodiscard]] Margins margins(const FractionalTransferFunction& loop);

}  // namespace frac
