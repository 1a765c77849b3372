// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "frac/identification/outliers.hpp"

namespace python {

/// The points that a fit leaves out, as the command line does, and what the user is told of them.
struct Screening {
  std::vector<std::size_t> left_out;  // indices of all data, increasing
  std::vector<std::string> notes;     // sentences without a stop

  Screening() = default;
  Screening(const frac::FrequencyResponseData& data, const frac::FitOptions& options, bool keep) {
    if (keep) return;
    left_out = frac::left_out_of_fit(data, options);
    if (!left_out.empty())
      notes.push_back(frac::left_out_sentence(data, left_out) + ", and taken in with outliers=\"keep\"");
  }

  [[nodiscard]] bool leaves_out(std::size_t point) const {
    return std::binary_search(left_out.begin(), left_out.end(), point);
  }

  [[nodiscard]] frac::FrequencyResponseData others(const frac::FrequencyResponseData& data) const {
    return left_out.empty() ? data : frac::without_points(data, left_out);
  }

  /// Whether the fit meets some of them after all, so that it is to be made anew with these.
  [[nodiscard]] bool take_back_met(const frac::FrequencyResponseData& data, const frac::FitOptions& made_with,
                                   const frac::FitResult& fit) {
    const auto met = frac::points_met(data, left_out, made_with, fit);
    if (met.empty()) return false;
    notes.push_back(frac::taken_back_sentence(data, met));
    std::erase_if(left_out, [&](std::size_t point) { return std::binary_search(met.begin(), met.end(), point); });
    return true;
  }

  /// Makes indices of the other points ones of all data.
  void restore_indices(std::vector<std::size_t>& points) const {
    for (std::size_t& point : points)
      for (const std::size_t each : left_out)
        if (each <= point) ++point;
  }
};

}  // namespace python
