// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "frac/model/fractional_transfer_function.hpp"
#include "frac/time_response/response_methods.hpp"

namespace frac {

struct LoopResponse {
  /// The estimated error keeps the tolerance.
  [[nodiscard]] bool usable() const noexcept { return meets_tolerance; }
  /// Number of instants, largest output, estimated error and what it took.
  [[nodiscard]] std::string summary() const;

  /// Infinite only where the first passage through the loop is, as behind an ideal derivative at the step itself.
  std::vector<double> output;
  /// Absolute, in the unit of the output: the sum of what each part of the method may err, bounds but for the error
  /// estimates of the single passages.
  double error_estimate;
  /// error_estimate <= tolerance times the largest output.
  bool meets_tolerance;
  /// Passages through the loop that were computed one by one.
  std::size_t passages;
  /// Values of the image that the rest was summed from; 0 where there is no rest, and the output is that of respond().
  std::size_t nodes;
};

/// Response from rest of the closed loop forward/(1 + loop), both ratios of sums of powers with their dead times; that
/// of the loop, T, may be above 0, where the closed loop is no such ratio.  A reference answers with forward = C G and
/// loop = C G B, a disturbance at the plant with forward = G.
///   forward/(1 + L e^{-sT}) = sum_{k<n} forward (-L)^k e^{-k s T} + forward (-L)^n e^{-n s T}/(1 + L e^{-sT}):
/// what has passed k times through the loop starts at k T and is the response of a ratio, computed by respond().  No
/// more than T_end/T passages ever reach the output.  Where that is more than a few, the rest is integrated along a
/// vertical line right of every root, which the argument principle counts, by the trapezoidal rule: it falls as
/// s^-(n q + ..), q = the excess of orders of L, and its values at t + P, t + 2 P, .. fold back with e^{-cP}.
/// Stable and unstable loops alike; the tolerance is that of the largest output, so that an unstable response is
/// accurate where it is large.
/// @param time       s, rising; from 0 for a named input, from the first sample for a sampled one
/// @param tolerance  of the largest output, 1e-12 to 0.1
/// @throws std::invalid_argument  as respond(); |L| grows without bound at high frequency: the loop then answers a step
///                                by ever steeper pulses.
/// @throws std::domain_error      no vertical line right of all roots was found.
[[nodiscard]] LoopResponse respond_closed_loop(const FractionalTransferFunction& forward,
                                               const FractionalTransferFunction& loop, const TimeInput& input,
                                               std::span<const double> time, double tolerance = 1e-9);

}  // namespace frac
