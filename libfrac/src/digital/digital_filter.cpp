// SPDX-License-Identifier: BSD-3-Clause
#include "frac/digital/digital_filter.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "base/number_text.hpp"
#include "section_kernel.hpp"
#include "tap_line.hpp"
#include "z_plane.hpp"

namespace frac {
namespace {

[[noreturn]] void refuse(const std::string& why) {
  throw std::invalid_argument("digital filter: " + why);
}

template <typename Real>
void check(const DigitalFilterDesign& design, int most_whole) {
  const auto check_count = [&](const char* name, int value) {
    if (value < 0 || value > most_whole) {
      refuse(std::string(name) + " = " + std::to_string(value) + "; allowed are 0 to " + std::to_string(most_whole));
    }
  };
  check_count("differences", design.differences);
  check_count("integrators", design.integrators);
  const auto fits = [](double value) { return std::isfinite(static_cast<Real>(value)); };
  if (!(design.sample_time > 0) || !fits(design.sample_time) || !fits(1 / design.sample_time)) {
    refuse("sample_time = " + detail::number_text(design.sample_time) + " s; allowed is above 0, finite");
  }
  const ParallelSections& sections = design.sections;
  if (sections.rates.size() != sections.weights.size() || design.pair_rates.size() != design.pair_weights.size()) {
    refuse("as many rates as weights are needed");
  }
  if (design.taps.empty()) refuse("no taps; a filter without has the one tap 1");
  for (std::size_t i = 0; i < design.taps.size(); ++i) {
    if (!fits(design.taps[i]))
      refuse("taps[" + std::to_string(i) + "] = " + detail::number_text(design.taps[i]) + " is out of range");
  }
  if (!fits(sections.direct)) refuse("direct = " + detail::number_text(sections.direct) + " is out of range");
  for (std::size_t i = 0; i < sections.rates.size(); ++i) {
    if (!(sections.rates[i] > 0 && sections.rates[i] < 2)) {
      refuse("rates[" + std::to_string(i) + "] = " + detail::number_text(sections.rates[i]) +
             "; allowed is above 0 and below 2");
    }
    if (!fits(sections.weights[i])) {
      refuse("weights[" + std::to_string(i) + "] = " + detail::number_text(sections.weights[i]) + " is out of range");
    }
  }
}

}  // namespace

std::complex<double> DigitalFilterDesign::response(double omega) const {
  const std::complex<double> delta = detail::delta_at(omega, sample_time);
  const std::complex<double> z = 1.0 + delta;
  std::complex<double> value = sections.response(delta);
  for (std::size_t i = 0; i < pair_rates.size(); ++i) {
    value += 0.5 * (pair_weights[i] / (delta + pair_rates[i]) +
                    std::conj(pair_weights[i]) / (delta + std::conj(pair_rates[i])));
  }
  value *= detail::response_of_taps(taps, delta);
  for (int i = 0; i < differences; ++i) value *= delta / z / sample_time;
  for (int i = 0; i < integrators; ++i) {
    value *= sample_time * ((rule == IntegratorRule::held ? 0.0 : 0.5) + 1.0 / delta);
  }
  return value * std::polar(1.0, -omega * sample_time * static_cast<double>(dead_samples));
}

DigitalFilterDesign filter_design(const DigitalPower& power) {
  DigitalFilterDesign design;
  design.sample_time = power.sample_time;
  design.differences = power.differences;
  design.integrators = power.integrators;
  design.taps = power.taps;
  design.sections = power.parallel;
  return design;
}

template <typename Real>
DigitalFilter<Real>::DigitalFilter(const DigitalFilterDesign& design) {
  check<Real>(design, static_cast<int>(most_whole));
  if (design.taps != std::vector<double>{1}) {
    for (const double tap : design.taps) taps_.push_back(static_cast<Real>(tap));
    taps_.resize(detail::even_count(taps_.size()), 0);
    line_.assign(taps_.size() + detail::section_block, 0);
  }
  const ParallelSections& sections = design.sections;
  sections_ = sections.rates.size();
  output_ = sections.output;
  direct_ = static_cast<Real>(sections.direct);
  const std::size_t size = detail::whole_groups(sections_);
  rate_.assign(size, 1);
  weight_.assign(size, 0);
  state_.assign(size, 0);
  lost_.assign(size, 0);
  for (std::size_t i = 0; i < sections_; ++i) {
    rate_[i] = static_cast<Real>(sections.rates[i]);
    weight_[i] = static_cast<Real>(sections.weights[i]);
  }
  for (std::size_t i = 0; i < design.pair_rates.size(); ++i) {
    pairs_.push_back({static_cast<Real>(design.pair_rates[i].real()), static_cast<Real>(design.pair_rates[i].imag()),
                      static_cast<Real>(design.pair_weights[i].real()),
                      static_cast<Real>(design.pair_weights[i].imag())});
  }
  differences_ = static_cast<std::size_t>(design.differences);
  integrators_ = static_cast<std::size_t>(design.integrators);
  time_ = static_cast<Real>(design.sample_time);
  inverse_time_ = static_cast<Real>(1 / design.sample_time);
  now_ = design.rule == IntegratorRule::held ? Real(0) : static_cast<Real>(design.sample_time / 2);
  waiting_.assign(design.dead_samples, 0);
}

template <typename Real>
Real DigitalFilter<Real>::before(Real sample) noexcept {
  if (!waiting_.empty()) {
    std::swap(sample, waiting_[oldest_]);
    oldest_ = oldest_ + 1 == waiting_.size() ? 0 : oldest_ + 1;
  }
  for (std::size_t i = 0; i < differences_; ++i) {
    const Real change = (sample - previous_[i]) * inverse_time_;
    previous_[i] = sample;
    sample = change;
  }
  return sample;
}

template <typename Real>
Real DigitalFilter<Real>::through_taps(Real sample) noexcept {
  if (taps_.empty()) return sample;
  const auto kept = static_cast<std::ptrdiff_t>(taps_.size());
  const Real* const newest = line_.data() + kept - 1;
  const auto past = [newest](std::size_t k) { return *(newest - k); };
  const Real result = detail::tapped(taps_.data(), taps_.size(), past, sample);
  line_[taps_.size()] = sample;
  std::copy(line_.begin() + 1, line_.begin() + kept + 1, line_.begin());
  return result;
}

// Samples beyond `count` are computed too, and are not used.
template <typename Real>
void DigitalFilter<Real>::through_taps(Real* samples, std::size_t count) noexcept {
  if (taps_.empty()) return;
  const auto kept = static_cast<std::ptrdiff_t>(taps_.size());
  std::copy(samples, samples + count, line_.begin() + kept);
  detail::tapped_block<detail::section_block>(taps_.data(), taps_.size(), line_.data() + kept, samples);
  const auto used = static_cast<std::ptrdiff_t>(count);
  std::copy(line_.begin() + used, line_.begin() + used + kept, line_.begin());
}

template <typename Real>
Real DigitalFilter<Real>::after(Real sum) noexcept {
  for (std::size_t i = 0; i < integrators_; ++i) {
    const Real output = integral_[i] + now_ * sum;
    const Real increment = time_ * sum + integral_lost_[i];
    const Real next = integral_[i] + increment;
    integral_lost_[i] = increment - (next - integral_[i]);
    integral_[i] = next;
    sum = output;
  }
  return sum;
}

template <typename Real>
Real DigitalFilter<Real>::step(Real sample) noexcept {
  const Real x = through_taps(before(sample));
  Real y = direct_ * x;
  if (!rate_.empty()) {
    y += output_ == SectionOutput::state
             ? detail::state_sum(weight_.data(), state_.data(), rate_.size())
             : detail::change_sum(rate_.data(), weight_.data(), state_.data(), rate_.size(), x);
    detail::advance_states<Real>({rate_.data(), weight_.data(), state_.data(), lost_.data(), rate_.size()}, x);
  }
  constexpr Real tiny = detail::negligible_state<Real>;
  for (Pair& pair : pairs_) {
    y += pair.weight_re * pair.re - pair.weight_im * pair.im;
    const Real re = pair.re + (x - (pair.rate_re * pair.re - pair.rate_im * pair.im));
    const Real im = pair.im - (pair.rate_re * pair.im + pair.rate_im * pair.re);
    pair.re = std::abs(re) > tiny ? re : 0;
    pair.im = std::abs(im) > tiny ? im : 0;
  }
  return after(y);
}

template <typename Real>
void DigitalFilter<Real>::run(std::span<const Real> samples, std::span<Real> output) {
  if (samples.size() != output.size()) {
    refuse(std::to_string(samples.size()) + " samples but room for " + std::to_string(output.size()) + " values");
  }
  if (!pairs_.empty() || rate_.empty()) {
    for (std::size_t n = 0; n < samples.size(); ++n) output[n] = step(samples[n]);
    return;
  }
  const detail::SectionArrays<Real> bank{rate_.data(), weight_.data(), state_.data(), lost_.data(), rate_.size()};
  Real x[detail::section_block] = {};
  Real y[detail::section_block];
  for (std::size_t from = 0; from < samples.size(); from += detail::section_block) {
    const std::size_t count = std::min(detail::section_block, samples.size() - from);
    for (std::size_t n = 0; n < count; ++n) x[n] = before(samples[from + n]);
    through_taps(x, count);
    if (output_ == SectionOutput::state) {
      detail::run_states(bank, x, y, count);
    } else {
      detail::run_changes(bank, x, y, count);
    }
    for (std::size_t n = 0; n < count; ++n) output[from + n] = after(direct_ * x[n] + y[n]);
  }
}

template <typename Real>
void DigitalFilter<Real>::reset() noexcept {
  for (auto* values : {&line_, &state_, &lost_, &waiting_}) std::fill(values->begin(), values->end(), Real(0));
  for (Pair& pair : pairs_) pair.re = pair.im = 0;
  std::fill(std::begin(previous_), std::end(previous_), Real(0));
  std::fill(std::begin(integral_), std::end(integral_), Real(0));
  std::fill(std::begin(integral_lost_), std::end(integral_lost_), Real(0));
  oldest_ = 0;
}

template class DigitalFilter<float>;
template class DigitalFilter<double>;

}  // namespace frac
