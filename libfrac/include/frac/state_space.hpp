// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <complex>
#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "frac/approximation/zero_pole_gain.hpp"
#include "frac/model/fractional_transfer_function.hpp"

namespace frac {

/// How a whole fractional transfer function is made rational.
enum class RealisationMethod {
  /// One set of poles for the whole model: its own poles, and real ones along the branch cut.  The default.
  joint,
  /// Every power of s by a ladder (approximate.hpp); powers a whole number apart share one.
  term_by_term,
};
/// joint, term-by-term.
[[nodiscard]] std::string_view to_string(RealisationMethod method);
/// @throws std::invalid_argument  unknown name; the text lists the known ones.
[[nodiscard]] RealisationMethod realisation_method_from_string(std::string_view text);
[[nodiscard]] std::span<const RealisationMethod> realisation_methods();

/// sum_k residues[k]/(s - pole)^(k+1), for a complex pole (above the real axis) together with the conjugate.
struct Mode {
  /// rad/s.
  std::complex<double> pole;
  std::vector<std::complex<double>> residues;
};

/// x' = A x + B u, y = C x + D u(t); the dead time of the model, which belongs in front, is kept apart.
struct StateSpace {
  std::size_t states = 0;
  /// states x states numbers, row after row.
  std::vector<double> a;
  /// As many numbers as states, like c.
  std::vector<double> b;
  std::vector<double> c;
  double d = 0;
  /// C (j omega - A)^-1 B + D, omega in rad/s.
  [[nodiscard]] std::complex<double> response(double omega) const;
};

/// direct + sum of modes, one of several systems in series.
struct RationalStage {
  double direct = 0;
  std::vector<Mode> modes;
};

enum class RationalModelStatus {
  /// The tolerance is kept.
  met,
  /// It is not; the result is the best found.
  not_attainable,
};
/// met, not-attainable.
[[nodiscard]] std::string_view to_string(RationalModelStatus status);

/// A rational stand-in for G(s) without its dead time, and what to state about it.
struct RationalModel {
  /// The tolerance is kept.
  [[nodiscard]] bool usable() const noexcept { return status == RationalModelStatus::met; }
  /// Model, band, states and error.
  [[nodiscard]] std::string summary() const;

  FractionalTransferFunction model;
  FrequencyBand band;
  double tolerance;
  /// Falls back from joint to term_by_term where that needs fewer states.
  RealisationMethod method;
  /// Dead time of the model, s.
  double delay;
  /// D, the gain at infinite frequency.
  double direct = 0;
  /// By rising |pole|.
  std::vector<Mode> modes;
  /// Stages in series with direct + modes, for a product of factors whose modes would cancel each other to rounding.
  /// Empty for any other model.
  std::vector<RationalStage> series;
  /// States of all stages together.
  std::size_t states = 0;
  /// All poles lie left of the imaginary axis.
  bool stable = false;
  /// Largest |H(j omega)/G(j omega) - 1| on the band: on `grid_points` frequencies, refined about the worst of them.
  double max_relative_error = 0;
  /// Where that is reached, rad/s.
  double omega_at_maximum = 0;
  /// Largest |20 log10 |H/G||.
  double max_decibels = 0;
  /// Largest |arg(H/G)|.
  double max_degrees = 0;
  /// At least ten times as many as the design was made on.
  int grid_points = 0;
  RationalModelStatus status = RationalModelStatus::met;
  /// One sentence.
  std::string message;

  /// H(j omega), dead time not included.
  [[nodiscard]] std::complex<double> response(double omega) const;
};

/// Fewest states that keep a tolerance on a band.  Poles of the model within two decades of the band, poles in the
/// right half-plane and whole integrators are taken over as they are, so that the result is stable when the model is;
/// other poles are real and negative.  Strictly proper where the model falls by a whole order of s or more.  A model
/// given as a product is made rational factor by factor, in series, where one sum of modes does not keep the tolerance.
/// @param tolerance  largest |H/G - 1|, 1e-12 to below 1.
/// @throws std::invalid_argument  band not 0 < lower < upper < infinity or not between 0.01 and 24 decades wide;
/// tolerance out of range; the model grows by a whole order of s or more.
/// @throws std::domain_error      the poles of the model could not be counted, or G is 0 or not finite on the band.
[[nodiscard]] RationalModel realise(const FractionalTransferFunction& model, FrequencyBand band, double tolerance,
                                    RealisationMethod method = RealisationMethod::joint);

/// Real modal form: A has 1 x 1 blocks of real poles and 2 x 2 blocks [re im; -im re] of pairs, chained for multiple
/// poles; B and C share each residue's size evenly.  Stages in series follow each other below the diagonal.
[[nodiscard]] StateSpace modal_form(const RationalModel& system);

/// Balanced form: controllability and observability Gramian are equal and diagonal, falling.
struct BalancedForm {
  StateSpace system;
  /// Falling.
  std::vector<double> hankel_singular_values;
  /// Largest |H/G - 1| of this form on the band, which rounding may enlarge.
  double max_relative_error = 0;
};
/// @throws std::domain_error  the system is not stable, or has states too alike to be balanced in extended precision.
[[nodiscard]] BalancedForm balanced_form(const RationalModel& system);

}  // namespace frac
