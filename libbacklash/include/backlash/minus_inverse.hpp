// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <complex>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "backlash/describing_function.hpp"
#include "frac/model/frequency_response_data.hpp"

namespace backlash {

/// What a curve of a describing function holds: N itself, m/N, or -1/N, N/m, which a loop's frequency response is drawn
/// against.
enum class Quantity { n, minus_inverse };

[[nodiscard]] std::string_view to_string(Quantity quantity);
/// Command-line spellings (n, minus-inverse). @throws std::invalid_argument  naming the allowed ones.
[[nodiscard]] Quantity quantity_from_string(std::string_view text);
[[nodiscard]] std::span<const Quantity> quantities();

/// -1/N with the uncertainty carried over.
struct MinusInverse {
  std::complex<double> value;  // N/m
  /// Of |value|, N/m.  d(-1/N) = dN/N^2 turns and stretches alike in all directions, so that a standard deviation
  /// of real and imaginary part alike stays one.
  double uncertainty;
};

/// The map is its own inverse: that of -1/N is N.  Empty where -1/N is no finite number: at N = 0, as x1 stands
/// still where the masses do not meet.  A value that is not finite stays not finite.
[[nodiscard]] std::optional<MinusInverse> minus_inverse(std::complex<double> value, double uncertainty);
[[nodiscard]] std::optional<MinusInverse> minus_inverse(const DescribingFunctionPoint& point);

struct MinusInverseData {
  frac::FrequencyResponseData data;  // sigma carried over, where there is one
  std::vector<double> left_out;      // omega, rad/s, of the points without -1/N
};
/// @throws std::invalid_argument  no point is left.
[[nodiscard]] MinusInverseData minus_inverse(const frac::FrequencyResponseData& data);

}  // namespace backlash
