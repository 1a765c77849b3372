// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <nlohmann/json.hpp>

namespace fracfit {

using Json = nlohmann::ordered_json;

/// JSON has neither infinity nor NaN: null stands for both.
inline Json number(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

}  // namespace fracfit
