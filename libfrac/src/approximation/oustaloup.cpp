// SPDX-License-Identifier: BSD-3-Clause
#include "frac/approximation/oustaloup.hpp"

#include <cmath>

#include "realised_order.hpp"

namespace frac {

ZeroPoleGain oustaloup(double order, FrequencyBand band, int poles) {
  detail::check_realised_order(order, "oustaloup");
  detail::check_oustaloup(band, poles);

  ZeroPoleGain result;
  const double whole = std::trunc(order);
  const double fractional = order - whole;
  result.integer_order = static_cast<int>(whole);
  result.gain = std::pow(band.upper, fractional);
  // Zeros and poles form a geometric ladder over the band; a pole trails its zero by the share `fractional` of one
  // rung.  In logarithms, so wide bands keep full precision.
  const double log_rung = (std::log(band.upper) - std::log(band.lower)) / poles;
  const auto root_at = [&](double rungs) { return -std::exp(std::log(band.lower) + rungs * log_rung); };
  for (int i = 0; i < poles; ++i) {
    result.zeros.push_back(root_at(i + 0.5 - fractional / 2));
    result.poles.push_back(root_at(i + 0.5 + fractional / 2));
  }
  return result;
}

}  // namespace frac
