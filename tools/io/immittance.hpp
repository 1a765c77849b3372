// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace io {

/// Voltage per current, or its inverse, current per voltage.
enum class Immittance { impedance, admittance };

[[nodiscard]] std::string_view to_string(Immittance immittance);
/// None for another word.
[[nodiscard]] std::optional<Immittance> immittance_from_string(std::string_view text);
[[nodiscard]] std::span<const Immittance> immittances();

/// What values in this unit are: an impedance in ohm, an admittance in S or 1/ohm, with any prefix and per or times an
/// area or a length ("kohm", "ohm cm2", "mS/cm2", "Ohm-1").  None for another unit.
[[nodiscard]] std::optional<Immittance> immittance_of_unit(const std::string& unit);

/// Unit of 1/value: "S" of "ohm", "mS" of "kohm", "ohm" of "S", "1/(ohm cm2)" of "ohm cm2"; empty for none.
[[nodiscard]] std::string inverse_immittance_unit(const std::string& unit);

}  // namespace io
