// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <complex>
#include <optional>
#include <vector>

#include "scene_response.hpp"

namespace backlash::detail {

inline constexpr double lowest_log_gamma = -5;  // gamma 0.0067, below the saddle-node of restitution 0.96
inline constexpr double highest_log_gamma = 12;

/// h(gamma) at one restitution, for searches, which need some digits only.
struct ResponseRow {
  double restitution;
  double loss;           // gamma where the orbit of two impacts ends
  double chatter_onset;  // gamma from which on the motion sticks every period
  std::vector<std::optional<std::complex<double>>> h;

  [[nodiscard]] std::optional<std::complex<double>> at(double log_gamma) const;
};

/// Rows of rising restitution, with h where it is cheap and definite: two impacts per period, and motion that sticks.
[[nodiscard]] const std::vector<ResponseRow>& regular_table();

/// The same with the mean of h in between, known to some percent, which takes some time to make.
[[nodiscard]] const std::vector<ResponseRow>& full_table();

/// h from the full table, to some percent; empty beyond it.
[[nodiscard]] std::optional<std::complex<double>> mean_h(double gamma, double restitution);

/// gamma from which on the motion from contact at rest sticks every period, about, from the table; infinite above
/// restitution 0.97, where a period takes thousands of impacts.
[[nodiscard]] double chatter_onset(double restitution);

/// sticking_response() to two or three digits, from the table; empty beyond it.
[[nodiscard]] std::optional<GapResponse> rough_sticking_response(double gamma, double restitution);

}  // namespace backlash::detail
