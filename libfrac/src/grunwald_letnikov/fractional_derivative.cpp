// SPDX-License-Identifier: BSD-3-Clause
#include "frac/fractional_derivative.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "approximation/realised_order.hpp"
#include "base/number_text.hpp"
#include "realisation/grunwald_letnikov_sum.hpp"
#include "weight_convolution.hpp"
#include "weight_exponentials.hpp"

namespace frac {
namespace {

// Unevaluated sum of two numbers.
template <typename Real>
struct Twofold {
  Real high = 0;
  Real low = 0;
};

template <typename Real>
Twofold<Real> sum_of(Real a, Real b) {
  const Real sum = a + b;
  const Real part = sum - a;
  return {sum, (a - (sum - part)) + (b - part)};
}

template <typename Real>
Twofold<Real> sum_of(Twofold<Real> a, Twofold<Real> b) {
  const Twofold<Real> high = sum_of(a.high, b.high);
  const Twofold<Real> low = sum_of(a.low, b.low);
  const Real rest = high.low + low.high;
  const Real first = high.high + rest;
  return {first, (rest - (first - high.high)) + low.low};
}

template <typename Real>
constexpr double smallest_tolerance = sizeof(Real) == sizeof(double) ? 1e-13 : 1e-6;
template <typename Real>
constexpr Real largest_sample = Real(sizeof(Real) == sizeof(double) ? 1e300 : 1e30);

template <typename Real>
void check(double order, double sample_time, double tolerance, double horizon) {
  const auto refuse = [](const char* name, double value, const std::string& allowed) {
    throw std::invalid_argument("fractional derivative: " + std::string(name) + " = " + detail::number_text(value) +
                                allowed);
  };
  detail::check_realised_order(order, "FractionalDerivative");
  if (!(sample_time > 0 && std::isfinite(sample_time)))
    refuse("sample_time", sample_time, " s; allowed is above 0, finite");
  if (!(tolerance >= smallest_tolerance<Real> && tolerance <= 0.1)) {
    refuse("tolerance", tolerance, "; allowed is " + detail::number_text(smallest_tolerance<Real>) + " to 0.1");
  }
  if (!(horizon >= 1 && horizon <= 1e12)) refuse("horizon", horizon, " samples; allowed is 1 to 1e12");
  const double scale = std::pow(sample_time, -order);
  if (!(scale >= static_cast<double>(std::numeric_limits<Real>::min()) &&
        scale <= static_cast<double>(std::numeric_limits<Real>::max()))) {
    refuse("sample_time", sample_time,
           " s to the power " + detail::number_text(-order) + " is out of the range of " +
               (sizeof(Real) == sizeof(double) ? "double" : "single") + " precision");
  }
}

}  // namespace

template <typename Real>
struct FractionalDerivative<Real>::Stream {
  using Convolution = detail::WeightConvolution<Real>;

  Stream(double order, double sample_time, double tolerance, double horizon)
      : scale(static_cast<Real>(std::pow(sample_time, -order))) {
    const double base = order > 0 ? order - std::ceil(order) : order - std::trunc(order);
    differences = order > 0 ? static_cast<std::size_t>(std::ceil(order)) : 0;
    sums = order > 0 ? 0 : static_cast<std::size_t>(-std::trunc(order));
    levels.resize(differences + sums);
    if (base != 0) {
      const detail::WeightExponentials exponentials =
          detail::weight_exponentials(-base, Convolution::first, tolerance, horizon);
      error_bound = exponentials.error_bound;
      terms = exponentials.terms.size();
      convolution.emplace(detail::grunwald_letnikov_weights(base, Convolution::weights - 1), exponentials.terms);
    }
  }

  Real accepted(Real sample) noexcept {
    if (!(std::abs(sample) <= largest_sample<Real>)) {
      ++rejected;
      return latest;
    }
    return latest = sample;
  }

  // Takes the whole differences or sums of a sample, which are the input of the remaining order.
  Real reduced(Real sample) noexcept {
    Twofold<Real> value{sample, 0};
    for (std::size_t i = 0; i < differences; ++i) {
      const Twofold<Real> before = levels[i];
      levels[i] = value;
      value = sum_of(value, {-before.high, -before.low});
    }
    for (std::size_t i = 0; i < sums; ++i) value = levels[i] = sum_of(levels[i], value);
    return value.high;
  }

  Real take(Real sample) noexcept {
    const Real input = reduced(accepted(sample));
    return scale * (convolution ? convolution->step(input) : input);
  }

  void take(std::span<const Real> samples, Real* output) noexcept {
    constexpr std::size_t block = Convolution::block;
    std::size_t n = 0;
    while (n < samples.size() && convolution && !convolution->at_block_start()) {
      output[n] = take(samples[n]);
      ++n;
    }
    Real input[block];
    for (; n + block <= samples.size() && convolution; n += block) {
      const Real* in = &samples[n];
      int refused = 0;
      for (std::size_t i = 0; i < block; ++i) refused |= std::abs(in[i]) <= largest_sample<Real> ? 0 : 1;
      if (differences == 1 && sums == 0 && refused == 0) {
        const Real before = levels[0].high;
        latest = levels[0].high = in[block - 1];
        input[0] = in[0] - before;
        for (std::size_t i = 1; i < block; ++i) input[i] = in[i] - in[i - 1];
      } else {
        for (std::size_t i = 0; i < block; ++i) input[i] = reduced(accepted(in[i]));
      }
      convolution->run_block(input, output + n);
      for (std::size_t i = 0; i < block; ++i) output[n + i] *= scale;
    }
    for (; n < samples.size(); ++n) output[n] = take(samples[n]);
  }

  Real scale;
  std::size_t differences = 0;
  std::size_t sums = 0;
  std::size_t terms = 0;
  double error_bound = 0;
  std::size_t rejected = 0;
  Real latest = 0;
  std::vector<Twofold<Real>> levels;  // the last value of each difference, or each sum
  std::optional<Convolution> convolution;
};

template <typename Real>
FractionalDerivative<Real>::FractionalDerivative(double order, double sample_time, double tolerance, double horizon) {
  check<Real>(order, sample_time, tolerance, horizon);
  stream_ = std::make_unique<Stream>(order, sample_time, tolerance, horizon);
}
template <typename Real>
FractionalDerivative<Real>::~FractionalDerivative() = default;
template <typename Real>
FractionalDerivative<Real>::FractionalDerivative(const FractionalDerivative& other)
    : stream_(std::make_unique<Stream>(*other.stream_)) {}
template <typename Real>
FractionalDerivative<Real>& FractionalDerivative<Real>::operator=(const FractionalDerivative& other) {
  return *this = FractionalDerivative(other);
}
template <typename Real>
FractionalDerivative<Real>::FractionalDerivative(FractionalDerivative&&) noexcept = default;
template <typename Real>
FractionalDerivative<Real>& FractionalDerivative<Real>::operator=(FractionalDerivative&&) noexcept = default;

template <typename Real>
Real FractionalDerivative<Real>::step(Real sample) noexcept {
  return stream_->take(sample);
}

template <typename Real>
void FractionalDerivative<Real>::run(std::span<const Real> samples, std::span<Real> output) {
  if (samples.size() != output.size()) {
    throw std::invalid_argument("fractional derivative: " + std::to_string(samples.size()) + " samples but room for " +
                                std::to_string(output.size()) + " values");
  }
  stream_->take(samples, output.data());
}

template <typename Real>
void FractionalDerivative<Real>::reset() noexcept {
  stream_->rejected = 0;
  stream_->latest = 0;
  std::fill(stream_->levels.begin(), stream_->levels.end(), Twofold<Real>{});
  if (stream_->convolution) stream_->convolution->reset();
}

template <typename Real>
std::size_t FractionalDerivative<Real>::exponentials() const noexcept {
  return stream_->terms;
}
template <typename Real>
double FractionalDerivative<Real>::error_bound() const noexcept {
  return stream_->error_bound;
}
template <typename Real>
std::size_t FractionalDerivative<Real>::rejected() const noexcept {
  return stream_->rejected;
}

template class FractionalDerivative<double>;
template class FractionalDerivative<float>;

}  // namespace frac
