// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "frac/time_response/reference_response.hpp"
#include "frac/time_response/respond.hpp"

namespace support {

/// Output of a model from rest to an input at rising instants, at the same instants: by superposition of exact step
/// responses (zero-order hold) or ramp responses (first-order hold, and a step to the first sample).
inline std::vector<double> exact_output(const frac::FractionalTransferFunction& model, const std::vector<double>& time,
                                        const std::vector<double>& input, frac::Hold hold) {
  const frac::ReferenceResponse step(model);
  const frac::ReferenceResponse ramp(model, {frac::ResponseInput::Kind::ramp});
  std::vector<double> output(time.size(), 0);
  double slope = 0;
  for (std::size_t j = 0; j < time.size(); ++j) {
    const bool first_order = hold == frac::Hold::first_order;
    const double jump = j == 0 ? input[0] : (first_order ? 0 : input[j] - input[j - 1]);
    const double next = first_order && j + 1 < time.size() ? (input[j + 1] - input[j]) / (time[j + 1] - time[j]) : 0;
    for (std::size_t i = j; i < time.size(); ++i) {
      if (jump != 0) output[i] += jump * step(time[i] - time[j]).value;
      if (next != slope) output[i] += (next - slope) * ramp(time[i] - time[j]).value;
    }
    slope = next;
  }
  return output;
}

}  // namespace support
