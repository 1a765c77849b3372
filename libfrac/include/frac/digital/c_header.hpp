// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "frac/digital/digital_filter.hpp"
#include "frac/digital/fractional_pid.hpp"

namespace frac {

/// Arithmetic of exported code: of C's float or double.
enum class Precision { float_type, double_type };

/// float, double.
[[nodiscard]] std::string_view to_string(Precision precision);
/// @throws std::invalid_argument  unknown name.
[[nodiscard]] Precision precision_from_string(std::string_view text);
[[nodiscard]] std::span<const Precision> precisions();

/// @throws std::invalid_argument  no C identifier, a keyword, or above 40 characters.
void check_c_name(const std::string& name);

struct CHeaderOptions {
  std::string name = "controller";  // prefix of types and functions, a C identifier of up to 40 characters
  Precision precision = Precision::double_type;
  std::string comment = {};  // put at the head, one line or more
};

/// A self-contained C99 header (no heap, nothing to link, no mathematical library) with the controller as static inline
/// functions on a struct:
///   void <name>_init(<name>_state *);                             at rest, all signals 0
///   void <name>_reset(<name>_state *);                            the same again
///   void <name>_reset_at(<name>_state *, double setpoint, double measured);  at rest at these values
///   double <name>_step(<name>_state *, double setpoint, double measured);
///   void <name>_track(<name>_state *, double output);             see FractionalPid
/// Flags saturated and bad_input are members of the struct.  A header for double is refused by compilers whose double
/// has fewer than 53 bits (float.h is all it includes).  Outputs are those of FractionalPid, bit for bit, as long
/// as the compiler keeps to IEEE arithmetic without fused or extended operations, which the header asks of GCC and
/// Clang.
/// @throws std::invalid_argument  the name is no C identifier, or too long.
[[nodiscard]] std::string c_header(const FractionalPidDesign& design, const CHeaderOptions& options);

/// The same for a filter: <name>_init, <name>_reset and double <name>_step(<name>_state *, double sample).
/// @throws std::invalid_argument  as above, or as DigitalFilter; dead time above 10^5 samples.
[[nodiscard]] std::string c_header(const DigitalFilterDesign& design, const CHeaderOptions& options);

}  // namespace frac
