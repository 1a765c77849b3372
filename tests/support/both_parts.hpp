// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "frac/identification/fit.hpp"

namespace support {

/// Fit options for both parts of the response, all else by default.
inline frac::FitOptions both_parts() {
  frac::FitOptions options;
  options.component = frac::Component::both;
  return options;
}

}  // namespace support
