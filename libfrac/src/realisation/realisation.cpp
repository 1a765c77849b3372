// SPDX-License-Identifier: BSD-3-Clause
#include "frac/realisation.hpp"

#include <cmath>
#include <numbers>
#include <stdexcept>

#include "approximation/realised_order.hpp"
#include "base/number_text.hpp"
#include "ladder_table.hpp"
#include "prepared_power.hpp"
#include "realisation_checks.hpp"

namespace frac {

LadderRealisation::LadderRealisation(FrequencyBand band, int poles) : band_(band), poles_(poles) {
  constexpr double fewest_decades = 0.5;
  constexpr double most_decades = 24;
  // Beyond it the poles are no longer determined well enough to be interpolated in the order.
  constexpr double least_error = 1e-8;
  const bool ordered = band.lower > 0 && band.lower < band.upper && std::isfinite(band.upper);
  const double width = ordered ? std::log(band.upper) - std::log(band.lower) : 0;
  // The slack admits a width that was computed.
  if (width < fewest_decades * std::numbers::ln10 * (1 - 1e-9) ||
      width > most_decades * std::numbers::ln10 * (1 + 1e-9)) {
    throw std::invalid_argument("ladder: band = " + detail::number_text(band.lower) + " to " +
                                detail::number_text(band.upper) +
                                " rad/s; needed is 0 < lower < upper < infinity, 0.5 to 24 decades apart");
  }
  // The limit of approximate.hpp at order 1/2.
  const int most = static_cast<int>(
      std::ceil((width + 4 * std::numbers::ln2) / (std::numbers::pi * std::numbers::pi) * std::log(2 / least_error)));
  if (poles < 1 || poles > most) {
    throw std::invalid_argument("ladder: poles = " + std::to_string(poles) + "; allowed on this band are 1 to " +
                                std::to_string(most));
  }
  table_ = std::make_shared<const detail::LadderTable>(width / 2, poles);
}

// There is nothing to check of an exact realisation; a ladder is checked by its constructor.
void validate(const Realisation& realisation) {
  if (const auto* oustaloup = std::get_if<OustaloupRealisation>(&realisation)) {
    detail::check_oustaloup(oustaloup->band, oustaloup->poles);
  } else if (const auto* difference = std::get_if<GrunwaldLetnikovRealisation>(&realisation)) {
    if (!(std::isfinite(difference->sample_time) && difference->sample_time > 0)) {
      throw std::invalid_argument("grunwald-letnikov: sample_time = " + detail::number_text(difference->sample_time) +
                                  " s is not positive and finite");
    }
    detail::check_memory_length(difference->memory_length, "grunwald-letnikov");
  }
}

std::string to_string(const Realisation& realisation) {
  if (std::holds_alternative<OustaloupRealisation>(realisation)) return "oustaloup";
  if (std::holds_alternative<GrunwaldLetnikovRealisation>(realisation)) return "grunwald-letnikov";
  if (std::holds_alternative<LadderRealisation>(realisation)) return "ladder";
  return "exact";
}

PowerResponse power_response(const Realisation& realisation, double order, double omega) {
  validate(realisation);
  detail::check_omega(realisation, omega, "response of a power of s");
  if (!std::isfinite(order)) {
    throw std::invalid_argument("response of a power of s: order = " + detail::number_text(order) + " is not finite");
  }
  detail::PreparedPower power;
  power.prepare(realisation, order);
  return power.response(omega, std::log(omega));
}

}  // namespace frac
