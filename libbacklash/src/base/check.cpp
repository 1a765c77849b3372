// SPDX-License-Identifier: BSD-3-Clause
#include "check.hpp"

#include <cmath>
#include <stdexcept>

namespace backlash::detail {
namespace {

[[noreturn]] void reject(const std::string& quantity, double value, const std::string& allowed) {
  throw std::invalid_argument(quantity + " is " + text(value) + "; it must be " + allowed);
}

std::string with_unit(std::string_view allowed, std::string_view unit) {
  std::string result(allowed);
  if (!unit.empty()) result.append(" (").append(unit).append(")");
  return result;
}

}  // namespace

void require_positive(std::string_view quantity, std::string_view unit, double value) {
  if (!(value > 0) || !std::isfinite(value))
    reject(std::string(quantity), value, with_unit("positive and finite", unit));
}

void require_not_negative(std::string_view quantity, std::string_view unit, double value) {
  if (!(value >= 0) || !std::isfinite(value)) {
    reject(std::string(quantity), value, with_unit("finite and not negative", unit));
  }
}

void require_restitution(double value) {
  if (!(value >= 0 && value <= 1)) reject("restitution", value, "in [0, 1]");
}

void require_frequency_grid(const std::vector<double>& omega) {
  if (omega.empty()) throw std::invalid_argument("omega is empty; at least one angular frequency (rad/s) is needed");
  for (std::size_t i = 0; i < omega.size(); ++i) {
    const std::string quantity = "omega[" + std::to_string(i) + "]";
    require_positive(quantity, "rad/s", omega[i]);
    if (i > 0 && !(omega[i] > omega[i - 1])) {
      reject(quantity, omega[i],
             "greater than omega[" + std::to_string(i - 1) + "] = " + text(omega[i - 1]) + " (rad/s)");
    }
  }
}

}  // namespace backlash::detail
