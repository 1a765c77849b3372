// SPDX-License-Identifier: BSD-3-Clause
#include "realised_order.hpp"

#include <cmath>
#include <stdexcept>
#include <string>

#include "base/number_text.hpp"

namespace frac::detail {

void check_realised_order(double order, std::string_view where) {
  if (!(std::abs(order) <= largest_realised_order)) {
    throw std::invalid_argument(std::string(where) + ": order = " + number_text(order) + "; allowed are -20 to 20");
  }
}

void check_oustaloup(FrequencyBand band, int poles) {
  constexpr int most_poles = 1000;
  if (!(band.lower > 0 && band.lower < band.upper && std::isfinite(band.upper))) {
    throw std::invalid_argument("oustaloup: band = " + number_text(band.lower) + " to " + number_text(band.upper) +
                                " rad/s; needed is 0 < lower < upper < infinity");
  }
  if (poles < 1 || poles > most_poles) {
    throw std::invalid_argument("oustaloup: poles = " + std::to_string(poles) + "; allowed are 1 to " +
                                std::to_string(most_poles));
  }
}

}  // namespace frac::detail
