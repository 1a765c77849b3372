// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "base/number_text.hpp"
#include "frac/model/fractional_transfer_function.hpp"
#include "poles/laplace_image.hpp"

namespace frac::detail {

inline void check_sample_time(double sample_time, const char* function) {
  if (!(sample_time > 0 && std::isfinite(sample_time))) {
    throw std::invalid_argument(std::string(function) + ": sample_time = " + number_text(sample_time) +
                                " s; allowed is above 0, finite");
  }
}

inline void check_samples(std::span<const double> samples, const char* function) {
  if (samples.empty()) throw std::invalid_argument(std::string(function) + ": no samples");
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (!std::isfinite(samples[i])) {
      throw std::invalid_argument(std::string(function) + ": samples[" + std::to_string(i) +
                                  "] = " + number_text(samples[i]) + " is not finite");
    }
  }
}

inline void check_proper(const FractionalTransferFunction& model, const char* function) {
  if (order_at_infinity(model) > 0) {
    throw std::invalid_argument(std::string(function) + ": the model grows as s^" +
                                number_text(order_at_infinity(model)) +
                                " at high frequency; allowed is a proper model");
  }
}

/// Moves samples later by a dead time rounded to whole ones.
inline void delay_samples(std::vector<double>& samples, double delay, double sample_time) {
  const double late = std::round(delay / sample_time);
  const auto shift = late < static_cast<double>(samples.size()) ? static_cast<std::size_t>(late) : samples.size();
  samples.insert(samples.begin(), shift, 0.0);
  samples.resize(samples.size() - shift);
}

}  // namespace frac::detail
