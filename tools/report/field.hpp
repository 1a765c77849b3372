// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "backlash/minus_inverse.hpp"
#include "io/frequency_response_file.hpp"

namespace report {

/// The kind of a measured response, which decides how readers of its field draw it.
enum class Field {
  automatic,          // told by the names and units of the file
  impedance,          // -Im Z over Re Z beside magnitude and phase over Hz
  admittance,         // Im Y over Re Y beside magnitude and phase over Hz
  shear_modulus,      // G' and G'' over the frequency as the file gives it, both axes logarithmic
  tensile_modulus,    // E' and E'', likewise
  permittivity,       // eps' and eps'' over Hz, likewise
  transfer_function,  // magnitude in dB and phase over the frequency as the file gives it
  n,                  // a describing function N: magnitude and phase, likewise
  minus_inverse,      // its -1/N: real and imaginary part, both axes logarithmic
};

/// Command-line spellings.
[[nodiscard]] std::string_view to_string(Field field);
[[nodiscard]] std::span<const Field> fields();

/// The field of a file: -1/N where its header says so, else that of its columns' names, else that of its unit, else a
/// transfer function.
[[nodiscard]] Field field_of(const io::FrequencyResponseFile& file);

/// N or -1/N, for the fields that are one of them.
[[nodiscard]] std::optional<backlash::Quantity> quantity_of(Field field);

/// How one field writes its quantities.
struct Notation {
  std::string symbol;           // Z
  std::string real, imaginary;  // Z', -Z''
  double sign;                  // of the imaginary part as drawn
  std::string unit;             // as on axes; empty: none is known
  frac::FrequencyUnit axis;     // of the frequency

  [[nodiscard]] std::string axis_name() const;   // in tables: f_hz or omega_rad_s
  [[nodiscard]] std::string axis_label() const;  // f in Hz
};

/// @param field  not automatic
/// @param unit   of the file, as it stands there
/// @param axis   of the file; impedances, admittances and permittivities are shown over Hz all the same
[[nodiscard]] Notation notation_of(Field field, const std::string& unit, frac::FrequencyUnit axis);

/// "Z' in ohm": a quantity with its unit, if there is one.
[[nodiscard]] std::string with_unit(const std::string& quantity, const std::string& unit);

/// Frequencies as the field gives them.
[[nodiscard]] std::vector<double> axis_values(const Notation& notation, const std::vector<double>& omega);

}  // namespace report
