// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <complex>
#include <vector>

#include "frac/state_space.hpp"

namespace frac::detail {

/// A model to be made rational on a band: its response without dead time, and the poles to be kept.
class ModelOnBand {
 public:
  /// @throws std::domain_error  the poles could not be counted.
  ModelOnBand(const FractionalTransferFunction& model, FrequencyBand band);

  /// Poles within two decades of the band or right of the imaginary axis, and whole integrators; residues, one per
  /// order, still zero.
  [[nodiscard]] const std::vector<Mode>& kept_poles() const { return kept_poles_; }
  [[nodiscard]] bool has_direct() const { return has_direct_; }
  [[nodiscard]] bool is_rational() const { return is_rational_; }
  [[nodiscard]] double half_width() const { return half_width_; }
  [[nodiscard]] double centre() const { return centre_; }  // geometric mean of the band, rad/s
  [[nodiscard]] const FractionalTransferFunction& model() const { return model_; }
  [[nodiscard]] FrequencyBand band() const { return band_; }
  /// Rising frequencies: `density` per unit of ln omega, more at the ends of the band and about lightly damped poles.
  [[nodiscard]] std::vector<double> grid(double density) const;
  [[nodiscard]] std::complex<double> response(double omega) const { return model_.response(omega); }

 private:
  FractionalTransferFunction model_;  // without dead time
  FrequencyBand band_;
  double half_width_;
  double centre_;
  std::vector<Mode> kept_poles_;
  bool has_direct_;
  bool is_rational_;
};

[[nodiscard]] std::size_t state_count(const std::vector<Mode>& modes);
[[nodiscard]] std::complex<double> modal_response(double direct, const std::vector<Mode>& modes, double omega);

/// Error members of `system` from a grid ten times as dense as `density`, refined about the largest.
void measure(const ModelOnBand& model, double density, RationalModel& system);

/// A direct part and modes; empty modes and NaN as `error` where there is none.
struct ModalDesign {
  double direct = 0;
  std::vector<Mode> modes;
  double density = 0;  // of the grid it was designed on
};

/// One set of poles: the model's and `cut_poles` real ones, which together with all residues make the largest relative
/// error least.
[[nodiscard]] ModalDesign joint_design(const ModelOnBand& model, int cut_poles);

/// Ladders with a largest error of `ladder_tolerance` in place of every power.
[[nodiscard]] ModalDesign term_by_term_design(const ModelOnBand& model, double ladder_tolerance);

}  // namespace frac::detail
