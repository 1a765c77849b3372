// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>

namespace io {

/// A name of a column and the unit in which it ends, as people write that: "omega" and "rad/s" of "omega_rad_s".
struct NameAndUnit {
  std::string_view name, unit;  // the unit is empty where the name ends in none
};
[[nodiscard]] NameAndUnit unit_apart(std::string_view column);

/// A unit of values as people write it: "m/N" of "m_per_n", which is how names of columns spell it; others as they are.
[[nodiscard]] std::string written_unit(const std::string& unit);

/// Unit of 1/value: "n_per_m" of "m_per_n", "m/N" of "N/m", "1/ohm" of "ohm", "ohm" of "1/ohm"; empty for none.
[[nodiscard]] std::string inverse_unit(const std::string& unit);

}  // namespace io
