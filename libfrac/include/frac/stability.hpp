#pragma once

#include <complex>
#include <optional>
#include <string_view>
#include <vector>

#include "frac/fractional_transfer_function.hpp"

namespace frac {

/// A root of the denominator.  Of a conjugate pair only the one above the real axis is listed.
struct Pole {
  std::complex<double> value;  // rad/s
  int multiplicity;            // roots closer than one part in a thousand count as one
  bool cancelled;              // the numerator vanishes there too, to 1e-9 of its terms
};

/// A root of the denominator as a polynomial in lambda = s^q, q the commensurate order.
struct SheetRoot {
  std::complex<double> lambda;  // upper half
  int multiplicity;
  bool on_principal_sheet;  // |arg lambda| <= q pi: it is a pole
  bool stable;              // |arg lambda| > q pi/2
};

enum class Stability {
  stable,           // bounded input, bounded output
  marginal,         // a pole on the imaginary axis within 1e-9 rad
  unstable,         // a pole right of it
  integrating,      // G is unbounded at s = 0
  differentiating,  // G is unbounded at infinity
  undetermined,     // the poles could not be counted
};
/// "stable", "marginal", ...
[[nodiscard]] std::string_view to_string(Stability stability) noexcept;

struct StabilityAnalysis {
  Stability stability;
  std::vector<Pole> poles;  // |arg s| <= pi, all of them: counted by the argument principle
  /// As commensurate_order() of algebra.hpp finds it, if it is one of 1/1000 or more.
  std::optional<double> commensurate_order;
  std::vector<SheetRoot> sheet_roots;  // where there is a commensurate order (Matignon 1996)
};
/// Of a model without regard to its dead time, which moves no pole.
[[nodiscard]] StabilityAnalysis analyse_stability(const FractionalTransferFunction& model);

/// Roots of 1 + L(s) = 0 with Re s > 0, dead time of L included, by the argument principle on D(s) + N(s) e^{-delay s}.
struct ClosedLoopStability {
  Stability stability;  // stable, marginal, unstable or undetermined
  int unstable_poles;   // conjugates counted
};
/// @throws std::invalid_argument  L does not fall below 1 at high frequency.
[[nodiscard]] ClosedLoopStability analyse_closed_loop(const FractionalTransferFunction& loop);

/// sup |G(j omega)|: the extrema of |G| are roots of its logarithmic derivative, bracketed about every pole.
struct PeakGain {
  double gain;   // infinite for a model that is not stable
  double omega;  // rad/s; 0 or infinite where the supremum is a limit
};
[[nodiscard]] PeakGain h_infinity_norm(const FractionalTransferFunction& model);

/// sqrt((1/pi) int_0^inf |G(j omega)|^2 d omega), relative error below 1e-12; infinite for a model that is not stable
/// or falls no faster than omega^-1/2.
[[nodiscard]] double h2_norm(const FractionalTransferFunction& model);

struct Crossover {
  double omega;   // rad/s
  double margin;  // gain: factor 1/|L| that makes |L| = 1 at phase -pi; phase: arg L + pi in (-pi, pi], rad
};
/// Margins of the loop L, all crossovers by root finding on the exact response.
struct Margins {
  std::vector<Crossover> gain;   // where L is real and negative
  std::vector<Crossover> phase;  // where |L| = 1
  /// The factors nearest to 1 above and below it; infinite and 0 where there are none.
  double gain_margin = 0;
  double gain_reduction = 0;
  /// Smallest |margin| of `phase`, infinite where there is none; and the dead time that uses one up, s.
  double phase_margin = 0;
  double delay_margin = 0;
};
/// Dead time makes L real and negative infinitely often: crossovers are listed down to |L| = 1e-3.
[[nodiscard]] Margins margins(const FractionalTransferFunction& loop);

}  // namespace frac
