// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <stdexcept>
#include <string>

#include "base/number_text.hpp"
#include "frac/approximation/zero_pole_gain.hpp"

namespace frac::detail {

/// What may be asked of a rational model on a band.
/// @param what  is to be made, the first word of the message
/// @throws std::invalid_argument  the band is empty or of an unlikely width, or the tolerance is out of range.
inline void check_demand(const std::string& what, FrequencyBand band, double tolerance) {
  const bool ordered = band.lower > 0 && band.lower < band.upper && std::isfinite(band.upper);
  const double decades = ordered ? std::log10(band.upper) - std::log10(band.lower) : 0;
  if (!ordered || decades < 0.01 || decades > 24) {
    throw std::invalid_argument(what + ": band = " + number_text(band.lower) + " to " + number_text(band.upper) +
                                " rad/s; needed is 0 < lower < upper < infinity, 0.01 to 24 decades apart");
  }
  if (!(tolerance >= 1e-12 && tolerance < 1))
    throw std::invalid_argument(what + ": tolerance = " + number_text(tolerance) + "; allowed is 1e-12 to below 1");
}

}  // namespace frac::detail
