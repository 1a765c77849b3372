// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "io/column_name.hpp"

namespace io {

/// A column name in the manner of instruments and of their fields, such as "Freq/Hz", "Zreal", "-Im(Z)/Ohm", "Z''(b)",
/// "|Z|", "theta", "G'", "eps''"; empty for any other name.  Factor and problem of the unit are left to the caller.
[[nodiscard]] std::optional<ColumnMeaning> instrument_column(std::string_view name);

/// The unit is one of impedance, admittance or pressure, perhaps with more behind it: mohm, kOhm_cm2, MPa, S/m.
[[nodiscard]] bool is_unit_of_material(std::string_view unit);

/// The unit is one of frequency: Hz, kHz, rad/s and the like.
[[nodiscard]] bool is_frequency_unit(std::string_view unit);

}  // namespace io
