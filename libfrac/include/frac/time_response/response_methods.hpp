// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "frac/model/fractional_transfer_function.hpp"
#include "frac/time_response/reference_response.hpp"
#include "frac/time_response/respond.hpp"

namespace frac {

/// Ways to a time response.  The last three are there to be compared with and never the cheaper choice: for 1000
/// samples of the furnace model the sum of exponentials takes 0.14 ms at 1e-12, set-up included, Gruenwald-Letnikov
/// 0.7 ms at 4e-2, bdf2 1.9 ms at 1e-3 and the ladder 9 ms at 8e-4 (tests/benchmarks/work_precision_respond).
enum class ResponseMethod {
  automatic,          // the cheaper of the next two that meets the tolerance
  reference,          // residues and branch cut at each instant, to rounding
  exponential_sum,    // one sum of exponentials for all instants
  grunwald_letnikov,  // differences of every term: first order in the step
  bdf2,               // Lubich's convolution quadrature with starting weights: second order
  ladder,             // every power of s by a ladder of real poles, then exactly
};
/// "auto", "reference", "exponential-sum", "grunwald-letnikov", "bdf2", "ladder".
[[nodiscard]] std::string_view to_string(ResponseMethod method) noexcept;
/// @throws std::invalid_argument  naming the known ones.
[[nodiscard]] ResponseMethod response_method_from_string(std::string_view text);
[[nodiscard]] std::span<const ResponseMethod> response_methods();

/// Samples of an input at rising instants (s), steps of any length; 0 before the first.  Under Hold::band_limited the
/// steps are even, and the input repeats itself before and after the samples.
struct SampledInput {
  std::vector<double> time;
  std::vector<double> value;
  Hold hold = Hold::zero_order;
};
using TimeInput = std::variant<ResponseInput, SampledInput>;

struct TimeResponse {
  /// The estimated error keeps the tolerance.
  [[nodiscard]] bool usable() const noexcept { return meets_tolerance; }
  /// Method, number of instants, largest output and estimated error.
  [[nodiscard]] std::string summary() const;

  /// Never NaN; infinite from the instant on at which it exceeds a double, with the sign that it had.
  std::vector<double> output;
  /// The one used.
  ResponseMethod method;
  /// Absolute, in the unit of the output: of the reference from its rounding; else the largest difference at all
  /// instants from an exponential sum of a thousandth of the tolerance, plus the error of that sum, which is its
  /// largest difference from the reference at some twenty instants (named input) or its tolerance (samples).  Of
  /// exponential sums for less than 1e-12 the twenty instants alone are compared.  Infinite where the output has
  /// outgrown a double.
  double error_estimate;
  /// error_estimate <= tolerance times the largest output.
  bool meets_tolerance;
};

/// Response from rest at rising instants, by the cheapest method that meets the tolerance or by the one asked for; by
/// the more accurate one where none meets it, the reference being tried where it takes no more than some twenty
/// seconds. Dead time, integrators, improper models (reference only) and instants of any spacing are welcome;
/// grunwald_letnikov, bdf2 and ladder want instants 0, T, 2 T, ..., the last two those of the samples.
/// To an input under Hold::band_limited the answer is the periodic steady state, exact to rounding; its mean is left out
/// where the model integrates.
/// @param time       s, rising; from 0 for a named input, from the first sample for a sampled one
/// @param tolerance  of the largest output, 1e-15 to 0.1; 1e-13 and above for all but the reference
/// @throws std::invalid_argument  as ReferenceResponse and ResponseFilter; bad instants or samples, named by their
///                                index; a method that cannot serve this input or these instants.
[[nodiscard]] TimeResponse respond(const FractionalTransferFunction& model, const TimeInput& input,
                                   std::span<const double> time, double tolerance = 1e-9,
                                   ResponseMethod method = ResponseMethod::automatic);

/// Lubich (1986): every power of s as the power of the second-order backward difference (3/2 - 2 z + z^2/2)/h, with
/// weights of the first samples that make it exact for the powers of t with which input and response begin.  Second
/// order in the step for an input smooth after t = 0; cost proportional to the square of the number of samples; dead
/// time is rounded to samples.
/// @throws std::invalid_argument  as respond_grunwald_letnikov(); more than 8 such powers below the highest order + 1.
[[nodiscard]] std::vector<double> respond_bdf2(const FractionalTransferFunction& model, std::span<const double> samples,
                                               double sample_time);

/// Every fractional power by a ladder with relative error `tolerance` on two decades more than the samples span at
/// either end, the rational model then exactly for the input as held, by its modes.  Dead time is rounded to samples.
/// @throws std::invalid_argument  as respond(); tolerance not within 1e-8 to 0.1.
[[nodiscard]] std::vector<double> respond_ladder(const FractionalTransferFunction& model,
                                                 std::span<const double> samples, double sample_time,
                                                 double tolerance = 1e-4, Hold hold = Hold::zero_order);

}  // namespace frac
