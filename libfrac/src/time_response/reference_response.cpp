// SPDX-License-Identifier: BSD-3-Clause
#include "frac/time_response/reference_response.hpp"

#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "base/number_text.hpp"
#include "formula/power_sum.hpp"
#include "frac/cancellation.hpp"
#include "inverse_laplace.hpp"
#include "poles/laplace_image.hpp"

namespace frac {
namespace {

using detail::LaplaceImage;
constexpr double eps = std::numeric_limits<double>::epsilon();
constexpr double infinity = std::numeric_limits<double>::infinity();

std::vector<PowerTerm> input_denominator(const ResponseInput& input) {
  switch (input.kind) {
    case ResponseInput::Kind::impulse:
      return {{1, 0}};
    case ResponseInput::Kind::step:
      return {{1, 1}};
    case ResponseInput::Kind::ramp:
      return {{1, 2}};
    case ResponseInput::Kind::sine:
      break;
  }
  return {{1, 2}, {input.omega * input.omega, 0}};
}

LaplaceImage image(const FractionalTransferFunction& model, const ResponseInput& input) {
  if (input.kind == ResponseInput::Kind::sine && !(input.omega > 0 && input.omega < 1e150)) {
    throw std::invalid_argument("reference response: omega = " + detail::number_text(input.omega) +
                                " rad/s of the sine; allowed is above 0 to 1e150");
  }
  const double gain = input.kind == ResponseInput::Kind::sine ? input.omega : 1;
  return {detail::scaled(detail::numerator_of(model), gain, 0),
          detail::product(detail::denominator_of(model), {{}, input_denominator(input)})};
}

}  // namespace

struct ReferenceResponse::Prepared {
  Prepared(const FractionalTransferFunction& model, const ResponseInput& input)
      : original(image(model, input)), delay(model.delay()) {}

  [[nodiscard]] ReferenceValue at_start() const;

  detail::InverseLaplace original;
  double delay;
};

ReferenceValue ReferenceResponse::Prepared::at_start() const {
  const LaplaceImage& y = original.image();
  const double order = y.slope(y.highest_corner() + 1);
  if (order < -1) return {0, 0, ResponseStatus::exact};
  const double value = y.numerator().front().coefficient / y.denominator().front().coefficient;
  if (order == -1) return {value, eps * std::abs(value), ResponseStatus::exact};
  // An impulse through a direct path is a delta at the start and the rest of the response after it.
  return {value > 0 ? infinity : -infinity, infinity, ResponseStatus::infinite};
}

std::string_view explanation(ResponseStatus status) noexcept {
  switch (status) {
    case ResponseStatus::exact:
      return "residues and branch cut agree with the parabola within their rounding";
    case ResponseStatus::inaccurate:
      return "residues and branch cut differ from the parabola by more than their rounding";
    case ResponseStatus::infinite:
      break;
  }
  return "the response is infinite or beyond the range of a double at this time";
}

ReferenceResponse::ReferenceResponse(const FractionalTransferFunction& model, ResponseInput input)
    : prepared_(std::make_unique<Prepared>(model, input)) {}
ReferenceResponse::~ReferenceResponse() = default;
ReferenceResponse::ReferenceResponse(ReferenceResponse&&) noexcept = default;
ReferenceResponse& ReferenceResponse::operator=(ReferenceResponse&&) noexcept = default;

ReferenceValue ReferenceResponse::operator()(double t) const {
  if (!(t >= 0 && std::isfinite(t))) {
    throw std::invalid_argument("reference response: t = " + detail::number_text(t) +
                                " s; allowed is 0 or more, finite");
  }
  if (t < prepared_->delay) return {0, 0, ResponseStatus::exact};
  if (t == prepared_->delay) return prepared_->at_start();
  const auto [value, error_estimate, confirmed] = prepared_->original(t - prepared_->delay);
  if (std::isinf(value)) return {value, infinity, ResponseStatus::infinite};
  return {value, error_estimate, confirmed ? ResponseStatus::exact : ResponseStatus::inaccurate};
}

std::vector<ReferenceValue> reference_response(const FractionalTransferFunction& model, ResponseInput input,
                                               std::span<const double> t) {
  for (std::size_t i = 0; i < t.size(); ++i) {
    if (!(t[i] >= 0 && std::isfinite(t[i]))) {
      throw std::invalid_argument("reference response: t[" + std::to_string(i) + "] = " + detail::number_text(t[i]) +
                                  " s; allowed is 0 or more, finite");
    }
  }
  const ReferenceResponse response(model, input);
  std::vector<ReferenceValue> values;
  values.reserve(t.size());
  for (const double each : t) {
    throw_if_cancelled();
    values.push_back(response(each));
  }
  return values;
}

}  // namespace frac
