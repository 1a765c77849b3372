// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "frac/model/fractional_transfer_function.hpp"

namespace frac {

/// Input that starts at t = 0 from rest: 1, delta(t), t or sin(omega t).
struct ResponseInput {
  enum class Kind { step, impulse, ramp, sine };
  Kind kind = Kind::step;
  /// Of the sine, rad/s, > 0.
  double omega = 0;
};

enum class ResponseStatus {
  /// Both methods agree within their rounding.
  exact,
  /// They do not; error_estimate is the difference.
  inaccurate,
  /// The response is infinite at t, as s^0.5 is to a step at t = 0, or exceeds a double.
  infinite,
};
/// One sentence.
[[nodiscard]] std::string_view explanation(ResponseStatus status) noexcept;

struct ReferenceValue {
  /// In the unit of the output.
  double value;
  /// Absolute: from the rounding of the method used, or the difference of the two.
  double error_estimate;
  ResponseStatus status;
};

/// Time response of a fractional transfer function at single instants, to rounding.  Two independent evaluations of the
/// inverse Laplace transform judge each other:
/// - residues of the poles, counted by the argument principle on every sheet the path crosses, plus the integral along
/// a
///   branch cut turned away from them, plus the terms of non-integrable powers at the origin in closed form;
/// - the trapezoidal rule on a parabola that scales with 1/t, poles taken out in closed form (relative accuracy also
///   where the response has barely begun).
/// Cost 10 to 500 microseconds per instant; respond() is for many samples.
class ReferenceResponse {
 public:
  /// @throws std::invalid_argument  omega of a sine not positive and finite.
  explicit ReferenceResponse(const FractionalTransferFunction& model, ResponseInput input = {});
  ~ReferenceResponse();
  ReferenceResponse(ReferenceResponse&&) noexcept;
  ReferenceResponse& operator=(ReferenceResponse&&) noexcept;

  /// At time t (s); 0 for t before the delay.  At the delay itself the limit from the right; the delta that an impulse
  /// meets in a model with direct feedthrough is left out.
  /// @throws std::invalid_argument  t negative or not finite.
  [[nodiscard]] ReferenceValue operator()(double t) const;

 private:
  struct Prepared;
  std::unique_ptr<const Prepared> prepared_;
};

/// @throws std::invalid_argument  as ReferenceResponse; a bad instant is named by its index.
[[nodiscard]] std::vector<ReferenceValue> reference_response(const FractionalTransferFunction& model,
                                                             ResponseInput input, std::span<const double> t);

}  // namespace frac
