// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>

namespace io {

/// What a column of a frequency response holds.
enum class Quantity {
  frequency,
  real,
  imaginary,
  negative_imaginary,
  magnitude,
  magnitude_db,
  phase,
  loss_tangent,  // tan delta: of a modulus imaginary over real part, of a permittivity its negative
  sigma,
  weight,
  other
};

/// A column name taken apart.
struct ColumnMeaning {
  Quantity quantity;
  double factor;        // to rad/s for a frequency, to rad for a phase; 1 otherwise
  std::string unit;     // of the values, as written; empty when the name gives none, as with a plain "dB"
  std::string problem;  // of the unit, one sentence; empty when it is understood
  // What the name speaks of: z impedance, y admittance, g shear modulus, e tensile modulus, eps permittivity, w an
  // angular frequency; empty when it does not tell.
  std::string symbol = {};
  bool in_hertz = false;        // of a frequency: it counts turns, not radians
  std::string assumption = {};  // what was taken for granted, one sentence
};

/// Meaning of a name such as "f_Hz", "omega [rad/s]", "re_m_per_n", "magnitude_db", "phase(deg)", or as instruments
/// write them: "Freq/Hz", "Zreal", "-Im(Z)/Ohm", "Z''", "|Z|", "G'", "eps''".
[[nodiscard]] ColumnMeaning column_meaning(std::string_view name);

/// The name says standard deviation (sigma, std, standard_deviation, uncertainty), with or without unit.
[[nodiscard]] bool names_standard_deviation(std::string_view name);

}  // namespace io
