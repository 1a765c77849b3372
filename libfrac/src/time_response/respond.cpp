// SPDX-License-Identifier: BSD-3-Clause
#include "frac/time_response/respond.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "base/dead_time.hpp"
#include "base/number_text.hpp"
#include "exponential_sum.hpp"
#include "filter_bank.hpp"
#include "formula/power_sum.hpp"
#include "frac/cancellation.hpp"
#include "frac/grunwald_letnikov.hpp"
#include "poles/laplace_image.hpp"
#include "sample_checks.hpp"
#include "special/phi_functions.hpp"

namespace frac {
namespace {

using detail::check_sample_time;
using detail::check_samples;
using detail::FilterBank;
using detail::order_at_infinity;

// Whole integrations that G s^m at the origin is rid of, so that it grows slower than 1/|s|.
std::size_t integrators(const FractionalTransferFunction& model) {
  const double order = model.numerator().back().order - model.denominator().back().order;
  return order <= -1 ? static_cast<std::size_t>(std::floor(-order)) : 0;
}

// Where the horizon ends before the response has risen the parts of its step response would cancel; those of the
// response to what has been integrated until its slope is gone do not.
std::size_t early_integrations(const FractionalTransferFunction& model, double latest) {
  const double order =
      -detail::dominant_slope(detail::numerator_of(model), detail::denominator_of(model), -std::log(3 * latest));
  return static_cast<std::size_t>(std::clamp(std::floor(order), 0.0, 8.0));
}

struct Design {
  double direct;     // from the input straight to the output, where that is read as the input jumps
  std::size_t dead;  // whole samples of dead time
  FilterBank bank;
};

Design design(const FractionalTransferFunction& model, double sample_time, double tolerance, Hold hold,
              double horizon) {
  check_sample_time(sample_time, "respond");
  if (!(tolerance >= 1e-13 && tolerance <= 0.1)) {
    throw std::invalid_argument("respond: tolerance = " + detail::number_text(tolerance) + "; allowed is 1e-13 to 0.1");
  }
  if (!(horizon >= 1 && horizon <= 1e12)) {
    throw std::invalid_argument("respond: horizon = " + detail::number_text(horizon) +
                                " samples; allowed is 1 to 1e12");
  }
  if (hold == Hold::band_limited) {
    throw std::invalid_argument(
        "respond: hold = band-limited takes all of its input at once; sample by sample allowed are zero-order and "
        "first-order");
  }
  const double high_order = order_at_infinity(model);
  if (high_order > 0) {
    throw std::invalid_argument("respond: the model grows as s^" + detail::number_text(high_order) +
                                " at high frequency; allowed is a proper model");
  }
  const std::size_t m = std::max(integrators(model), early_integrations(model, horizon * sample_time));
  if (m > FilterBank::most_integrations)
    throw std::invalid_argument("respond: " + std::to_string(m) + " integrators; allowed is up to 8");
  const double at_infinity =
      high_order == 0 ? model.numerator().front().coefficient / model.denominator().front().coefficient : 0;
  const auto [samples_late, whole, fraction] = detail::sampled_dead_time(model.delay(), sample_time);
  if (!(samples_late <= 1e9)) {
    throw std::invalid_argument("respond: dead time of " + detail::number_text(samples_late) +
                                " samples; allowed is up to 1e9");
  }
  const double theta = 1 - fraction;

  const detail::LaplaceImage step(detail::scaled(detail::numerator_of(model), 1, static_cast<double>(m)),
                                  detail::scaled(detail::denominator_of(model), 1, 1));
  if (!step.poles().complete) {
    throw std::domain_error("respond: the poles of the model could not be counted: " +
                            std::string(step.poles().trouble));
  }
  const bool is_straight = hold == Hold::first_order;
  const std::size_t channels = m + (is_straight ? 2 : 1);
  const double read = theta * sample_time;
  detail::ExponentialSum sum =
      detail::exponential_sum(step, read, horizon * sample_time, tolerance, m, channels, detail::FastTerms::direct);

  // The output at the reading instant to (t/T)^i/i! from rest.
  std::vector<double> now(m + 2, 0.0);
  for (std::size_t i = 0; i < channels; ++i) {
    double factor = 1;  // T^-i t^(i-j)/(i-j)!, from j = i down
    for (std::size_t k = 0; k < i; ++k) factor /= sample_time;
    for (std::size_t j = i + 1; j-- > 0;) {
      now[i] += factor * sum.constants[j];
      factor *= read / static_cast<double>(i - j + 1);
    }
  }
  std::vector<std::complex<double>> phis(channels);
  // The bank counts integrals in units of the sample time.
  const double unit = std::pow(sample_time, static_cast<double>(m));
  for (double& each : now) each *= unit;
  for (detail::Exponential& term : sum.terms) {
    if (!term.is_direct) term.weight *= unit;
    const std::complex<double> z = term.rate * read;
    detail::phi(z, phis);
    const std::size_t first = term.is_direct ? m : 0;
    double factor = 1;  // theta^(i - first)
    for (std::size_t i = first; i < channels; ++i, factor *= theta) {
      const std::complex<double> response = i == first ? detail::expm1(z) : z * phis[i - first];
      now[i] += factor * (term.weight * response).real();
    }
  }
  const double direct = theta == 1 ? at_infinity : 0;
  if (!is_straight) now[m + 1] = direct;
  return {direct, static_cast<std::size_t>(whole),
          FilterBank({std::move(sum.terms), sample_time, theta, m, is_straight, now, 0.1 * tolerance * sum.size})};
}

}  // namespace

struct ResponseFilter::Filter {
  explicit Filter(Design design) : now(std::move(design)) { waiting.reserve(now.dead); }

  double take(double sample) noexcept {
    if (started) return now.bank.step(sample);
    started = true;
    now.bank.start(sample);
    return now.direct * sample;
  }

  void take(std::span<const double> samples, double* output) {
    std::size_t k = 0;
    if (!started && !samples.empty()) output[k++] = take(samples[0]);
    constexpr std::size_t most_blocks = 1024;  // milliseconds
    for (std::size_t blocks = (samples.size() - k) / FilterBank::block; blocks > 0;) {
      throw_if_cancelled();
      const std::size_t some = std::min(blocks, most_blocks);
      now.bank.run(samples.data() + k, some, output + k);
      k += some * FilterBank::block;
      blocks -= some;
    }
    for (; k < samples.size(); ++k) output[k] = take(samples[k]);
  }

  Design now;
  bool started = false;
  std::vector<double> waiting;  // samples within the dead time, a ring once full
  std::size_t oldest = 0;
};

ResponseFilter::ResponseFilter(const FractionalTransferFunction& model, double sample_time, double tolerance, Hold hold,
                               double horizon)
    : filter_(std::make_unique<Filter>(design(model, sample_time, tolerance, hold, horizon))) {}
ResponseFilter::~ResponseFilter() = default;
ResponseFilter::ResponseFilter(const ResponseFilter& other) : filter_(std::make_unique<Filter>(*other.filter_)) {
  filter_->waiting.reserve(filter_->now.dead);
}
ResponseFilter& ResponseFilter::operator=(const ResponseFilter& other) {
  return *this = ResponseFilter(other);
}
ResponseFilter::ResponseFilter(ResponseFilter&&) noexcept = default;
ResponseFilter& ResponseFilter::operator=(ResponseFilter&&) noexcept = default;

double ResponseFilter::step(double sample) noexcept {
  Filter& f = *filter_;
  if (f.now.dead == 0) return f.take(sample);
  if (f.waiting.size() < f.now.dead) {
    f.waiting.push_back(sample);
    return 0;
  }
  std::swap(sample, f.waiting[f.oldest]);
  f.oldest = (f.oldest + 1) % f.now.dead;
  return f.take(sample);
}

void ResponseFilter::run(std::span<const double> samples, std::span<double> output) {
  if (samples.size() != output.size()) {
    throw std::invalid_argument("respond: " + std::to_string(samples.size()) + " samples but room for " +
                                std::to_string(output.size()) + " values");
  }
  Filter& f = *filter_;
  if (f.now.dead == 0) {
    f.take(samples, output.data());
    return;
  }
  std::vector<double> delayed;
  delayed.reserve(samples.size());
  std::size_t silent = 0;
  for (const double sample : samples) {
    if (f.waiting.size() < f.now.dead) {
      f.waiting.push_back(sample);
      output[silent++] = 0;
    } else {
      delayed.push_back(std::exchange(f.waiting[f.oldest], sample));
      f.oldest = (f.oldest + 1) % f.now.dead;
    }
  }
  f.take(delayed, output.data() + silent);
}

void ResponseFilter::reset() noexcept {
  filter_->now.bank.reset();
  filter_->started = false;
  filter_->waiting.clear();
  filter_->oldest = 0;
}

std::size_t ResponseFilter::states() const noexcept {
  return filter_->now.bank.states();
}

std::vector<double> respond(const FractionalTransferFunction& model, std::span<const double> samples,
                            double sample_time, double tolerance, Hold hold) {
  check_samples(samples, "respond");
  ResponseFilter filter(model, sample_time, tolerance, hold, static_cast<double>(samples.size()));
  std::vector<double> output(samples.size());
  filter.run(samples, output);
  return output;
}

std::vector<double> respond_grunwald_letnikov(const FractionalTransferFunction& model, std::span<const double> samples,
                                              double sample_time) {
  check_samples(samples, "respond_grunwald_letnikov");
  check_sample_time(sample_time, "respond_grunwald_letnikov");
  detail::check_proper(model, "respond_grunwald_letnikov");
  // sum_k left_k y_(n-k) = sum_k right_k u_(n-k), the weights of all terms together.
  const std::size_t count = samples.size();
  const auto weights = [&](const std::vector<PowerTerm>& terms) {
    std::vector<double> sum(count, 0);
    for (const PowerTerm& term : terms) {
      const std::vector<double> each = grunwald_letnikov_weights(term.order, count - 1);
      const double factor = term.coefficient * std::pow(sample_time, -term.order);
      for (std::size_t k = 0; k < count; ++k) sum[k] += factor * each[k];
    }
    return sum;
  };
  const std::vector<double> left = weights(model.denominator());
  const std::vector<double> right = weights(model.numerator());
  std::vector<double> output(count, 0);
  for (std::size_t n = 0; n < count; ++n) {
    throw_if_cancelled();
    double sum = 0;
    for (std::size_t k = 0; k <= n; ++k) sum += right[k] * samples[n - k];
    for (std::size_t k = 1; k <= n; ++k) sum -= left[k] * output[n - k];
    output[n] = sum / left[0];
  }
  detail::delay_samples(output, model.delay(), sample_time);
  return output;
}

}  // namespace frac
