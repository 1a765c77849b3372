// SPDX-License-Identifier: BSD-3-Clause
#include "realisation_checks.hpp"

#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string>

#include "base/number_text.hpp"

namespace frac::detail {

void check_memory_length(std::size_t memory_length, std::string_view where) {
  if (memory_length > longest_memory) {
    throw std::invalid_argument(std::string(where) + ": memory_length = " + std::to_string(memory_length) +
                                "; allowed are 0 to " + std::to_string(longest_memory));
  }
}

void check_omega(const Realisation& realisation, std::span<const double> omega, std::string_view where) {
  const bool sampled = std::holds_alternative<GrunwaldLetnikovRealisation>(realisation);
  for (const double each : omega) {
    if (sampled || !(each > 0 && each <= std::numeric_limits<double>::max())) check_omega(realisation, each, where);
  }
}

void check_omega(const Realisation& realisation, double omega, std::string_view where) {
  if (!(std::isfinite(omega) && omega > 0)) {
    throw std::invalid_argument(std::string(where) + ": omega = " + number_text(omega) +
                                " rad/s is not positive and finite");
  }
  const auto* sampled = std::get_if<GrunwaldLetnikovRealisation>(&realisation);
  // The slack admits an omega that was computed as pi/sample_time with its own rounding.
  if (sampled != nullptr &&
      omega * sampled->sample_time > std::numbers::pi * (1 + 4 * std::numeric_limits<double>::epsilon())) {
    throw std::invalid_argument(
        std::string(where) + ": omega = " + number_text(omega) + " rad/s is above pi/sample_time = " +
        number_text(std::numbers::pi / sampled->sample_time) + " rad/s, beyond which samples say nothing");
  }
}

}  // namespace frac::detail
