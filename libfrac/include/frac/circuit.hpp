// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <complex>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "frac/approximation/zero_pole_gain.hpp"
#include "frac/model/fractional_transfer_function.hpp"
#include "frac/state_space.hpp"
#include "frac/structure.hpp"

namespace frac {

/// How the cells of a one-port are joined, and with it what each cell is.
enum class FosterForm {
  /// One after the other; each is a resistor, a capacitor and an inductor side by side.
  series,
  /// Side by side; each is a resistor, an inductor and a capacitor one after the other.
  parallel,
};

/// Up to four elements of one pole or pair of poles, all positive; an element that is missing is empty.
struct FosterCell {
  /// Ohm.
  std::optional<double> resistance;
  /// F.
  std::optional<double> capacitance;
  /// H.
  std::optional<double> inductance;
  /// Ohm: in series with the inductor of a cell of FosterForm::series, beside the capacitor of a cell of the other
  /// form.
  std::optional<double> loss;
};

/// Two-terminal circuit of resistors, capacitors and inductors in place of an impedance, and what to state about it.
struct PassiveOnePort {
  /// The tolerance is kept.
  [[nodiscard]] bool usable() const noexcept { return status == RationalModelStatus::met; }
  /// Impedance, band, elements and error.
  [[nodiscard]] std::string summary() const;

  /// Ohm, the formula of s.
  std::string impedance;
  FrequencyBand band;
  double tolerance;
  FosterForm form = FosterForm::series;
  std::vector<FosterCell> cells;
  /// Bound on |Z_circuit(j omega)/Z(j omega) - 1| on the band, computed from the values of the elements, on
  /// `grid_points` frequencies and at the summits between them.
  double max_relative_error = 0;
  /// Where that is reached, rad/s.
  double omega_at_maximum = 0;
  int grid_points = 0;
  RationalModelStatus status = RationalModelStatus::met;
  /// One sentence.
  std::string message;

  /// Ohm, omega in rad/s.
  [[nodiscard]] std::complex<double> response(double omega) const;
  [[nodiscard]] std::size_t elements() const noexcept;
};

/// Positive elements for an impedance.  The impedance or, where that does not give positive elements, the admittance is
/// made rational (realise()), and every pole becomes a cell: a circuit that is passive by construction.
/// @param impedance  Z(s), ohm.
/// @throws std::invalid_argument  as realise().
/// @throws std::domain_error      the real part of the impedance is negative on the band, it has a dead time, or its
///                                partial fractions do not all have positive elements; the text says which.
[[nodiscard]] PassiveOnePort passive_one_port(const FractionalTransferFunction& impedance, FrequencyBand band,
                                              double tolerance);

/// The same for a formula with functions, such as tanh(sqrt(2 s))/sqrt(2 s) of a diffusion of finite length: poles are
/// those of the interpolant on the real axis, where the values of a positive real function follow from its real part
/// over all frequencies; residues and constant by least squares on the band, none of them negative.
/// @param impedance  Z(s), ohm, without parameters
/// @throws std::invalid_argument  a parameter, the band, or the tolerance.
/// @throws std::domain_error      the real part is negative on the band, a value is not finite, or no sum of resistors
///                                with capacitors alone, or inductors alone, keeps the tolerance.
[[nodiscard]] PassiveOnePort passive_one_port(const Structure& impedance, FrequencyBand band, double tolerance);

/// A transfer function as capacitors and controlled sources.
struct TransferCircuit {
  [[nodiscard]] bool usable() const noexcept { return status == RationalModelStatus::met; }
  /// Model, band, states and error.
  [[nodiscard]] std::string summary() const;

  FractionalTransferFunction model;
  FrequencyBand band;
  double tolerance;
  /// Ideal delay line in front, s.
  double delay = 0;
  /// Scaled such that a constant input of 1 V holds the voltages of the states at about 1 V.
  StateSpace system;
  /// rad/s.  State i is the voltage of a capacitor of 1/rates[i] farad, which currents a_ij/rates[i] V_j charge.
  std::vector<double> rates;
  /// Integrators of the model that leak, so that the circuit has an operating point; part of the error.
  int leaking_integrators = 0;
  /// Bound on |H(j omega)/G(j omega) - 1| on the band: the largest on `grid_points` frequencies and at the summits
  /// between them, and what the rounding of the elements and of the dead time's phase may add.
  double max_relative_error = 0;
  /// Where that is reached, rad/s.
  double omega_at_maximum = 0;
  int grid_points = 0;
  RationalModelStatus status = RationalModelStatus::met;
  /// One sentence.
  std::string message;
};

/// @throws std::invalid_argument, std::domain_error  as realise().
[[nodiscard]] TransferCircuit transfer_circuit(const FractionalTransferFunction& model, FrequencyBand band,
                                               double tolerance);

struct NetlistOptions {
  /// Name of the subcircuit: letters, digits and _, the first a letter or _, up to 40 characters.
  std::string name = "model";
  /// Comment at the head, one line or more.
  std::string comment = {};
};

/// A SPICE subcircuit `.subckt <name> a b`, elements R, C and L alone.  Values read back as the same doubles.
/// @throws std::invalid_argument  the name.
[[nodiscard]] std::string spice_netlist(const PassiveOnePort& circuit, const NetlistOptions& options);

/// A SPICE subcircuit `.subckt <name> in_plus in_minus out_plus out_minus`: the input takes no current, the output is a
/// voltage source.  Elements R, C, voltage-controlled sources and, for a dead time, a line without loss.
/// @throws std::invalid_argument  the name.
[[nodiscard]] std::string spice_netlist(const TransferCircuit& circuit, const NetlistOptions& options);

}  // namespace frac
