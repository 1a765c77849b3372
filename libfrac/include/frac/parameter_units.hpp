// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "frac/structure.hpp"

namespace frac {

/// Units of the parameters of a formula, as they follow from that of its value and from s in rad/s, where the radian
/// counts as 1: the terms of every sum have one unit, arguments of functions and orders have none.  K/(T s^a + 1) of
/// the unit "m/N" gives "m/N", "s^a" and "1".  A number that stands before the whole formula may carry the unit.
/// @param value_unit  as people write it; "1" where the value has none; empty where it is not known
/// @return  by parameter; empty where it does not follow, as of K, T and U in K/(T s + U)
[[nodiscard]] std::vector<std::string> parameter_units(const Structure& structure, std::string_view value_unit);

}  // namespace frac
