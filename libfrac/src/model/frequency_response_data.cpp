// SPDX-License-Identifier: BSD-3-Clause
#include "frac/model/frequency_response_data.hpp"

#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "base/number_text.hpp"

namespace frac {
namespace {

[[noreturn]] void refuse(const std::string& quantity, std::size_t index, const std::string& value,
                         const std::string& allowed) {
  throw std::invalid_argument("frequency response: " + quantity + "[" + std::to_string(index) + "] = " + value + " " +
                              allowed);
}

void check_omega(const std::vector<double>& omega) {
  for (std::size_t i = 0; i < omega.size(); ++i) {
    if (!(std::isfinite(omega[i]) && omega[i] > 0)) {
      refuse("omega", i, detail::number_text(omega[i]) + " rad/s", "is not positive and finite");
    }
    if (i > 0 && omega[i] < omega[i - 1]) {
      refuse("omega", i, detail::number_text(omega[i]) + " rad/s",
             "is below the one before it (" + detail::number_text(omega[i - 1]) +
                 " rad/s); frequencies must be in increasing order");
    }
  }
}

}  // namespace

FrequencyResponseData::FrequencyResponseData(std::vector<double> omega, std::vector<std::complex<double>> value,
                                             std::vector<double> sigma, FrequencyUnit shown_in)
    : omega_(std::move(omega)), value_(std::move(value)), sigma_(std::move(sigma)), frequency_unit_(shown_in) {
  if (omega_.empty()) throw std::invalid_argument("frequency response: no points; at least one is needed");
  if (value_.size() != omega_.size() || (!sigma_.empty() && sigma_.size() != omega_.size())) {
    throw std::invalid_argument("frequency response: lengths differ: " + std::to_string(omega_.size()) +
                                " frequencies, " + std::to_string(value_.size()) + " values, " +
                                std::to_string(sigma_.size()) + " sigmas (0 sigmas: unknown)");
  }
  check_omega(omega_);
  for (std::size_t i = 0; i < value_.size(); ++i) {
    if (!(std::isfinite(value_[i].real()) && std::isfinite(value_[i].imag()))) {
      refuse("value", i,
             detail::number_text(value_[i].real()) + " + j " + detail::number_text(value_[i].imag()) + " (at " +
                 detail::number_text(omega_[i]) + " rad/s)",
             "is not finite");
    }
  }
  for (std::size_t i = 0; i < sigma_.size(); ++i) {
    if (!(std::isfinite(sigma_[i]) && sigma_[i] > 0)) {
      refuse("sigma", i, detail::number_text(sigma_[i]), "is not positive and finite");
    }
  }
}

}  // namespace frac
