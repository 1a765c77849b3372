#include "frac/realisation.hpp"

#include <cmath>
#include <stdexcept>

#include "detail/number_text.hpp"
#include "detail/prepared_power.hpp"
#include "detail/realisation_checks.hpp"

namespace frac {
namespace {

constexpr int most_poles = 1000;

void validate_as(const ExactRealisation&) {}

void validate_as(const OustaloupRealisation& realisation) {
  const FrequencyBand band = realisation.band;
  if (!(band.lower > 0 && band.lower < band.upper && std::isfinite(band.upper))) {
    throw std::invalid_argument("oustaloup: band = " + detail::number_text(band.lower) + " to " +
                                detail::number_text(band.upper) + " rad/s; needed is 0 < lower < upper < infinity");
  }
  if (realisation.poles < 1 || realisation.poles > most_poles) {
    throw std::invalid_argument("oustaloup: poles = " + std::to_string(realisation.poles) + "; allowed are 1 to " +
                                std::to_string(most_poles));
  }
}

void validate_as(const GrunwaldLetnikovRealisation& realisation) {
  if (!(std::isfinite(realisation.sample_time) && realisation.sample_time > 0)) {
    throw std::invalid_argument("grunwald-letnikov: sample_time = " + detail::number_text(realisation.sample_time) +
                                " s is not positive and finite");
  }
  detail::check_memory_length(realisation.memory_length, "grunwald-letnikov");
}

}  // namespace

void validate(const Realisation& realisation) {
  std::visit([](const auto& choice) { validate_as(choice); }, realisation);
}

std::string to_string(const Realisation& realisation) {
  if (std::holds_alternative<OustaloupRealisation>(realisation)) return "oustaloup";
  if (std::holds_alternative<GrunwaldLetnikovRealisation>(realisation)) return "grunwald-letnikov";
  return "exact";
}

PowerResponse power_response(const Realisation& realisation, double order, double omega) {
  validate(realisation);
  detail::check_omega(realisation, omega, "power_response");
  if (!std::isfinite(order)) {
    throw std::invalid_argument("power_response: order = " + detail::number_text(order) + " is not finite");
  }
  detail::PreparedPower power;
  power.prepare(realisation, order);
  return power.response(omega, std::log(omega));
}

}  // namespace frac
