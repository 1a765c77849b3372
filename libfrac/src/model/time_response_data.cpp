// SPDX-License-Identifier: BSD-3-Clause
#include "frac/model/time_response_data.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <string>
#include <utility>

#include "base/number_text.hpp"
#include "model/even_steps.hpp"

namespace frac {
namespace {

[[noreturn]] void refuse(const std::string& reason) {
  throw std::invalid_argument("samples over time: " + reason);
}

std::string entry(const char* quantity, std::size_t index, double value) {
  return std::string(quantity) + "[" + std::to_string(index) + "] = " + detail::number_text(value);
}

void check_finite(const char* quantity, const std::vector<double>& values) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!std::isfinite(values[i])) refuse(entry(quantity, i, values[i]) + " is not finite");
  }
}

}  // namespace

TimeResponseData::TimeResponseData(std::vector<double> time, std::vector<double> input, std::vector<double> output,
                                   std::vector<double> sigma, Hold hold, double input_at_rest)
    : time_(std::move(time)),
      input_(std::move(input)),
      output_(std::move(output)),
      sigma_(std::move(sigma)),
      hold_(hold),
      input_at_rest_(input_at_rest) {
  const std::size_t count = time_.size();
  if (input_.size() != count || output_.size() != count || (!sigma_.empty() && sigma_.size() != count)) {
    refuse("lengths differ: " + std::to_string(count) + " times, " + std::to_string(input_.size()) + " inputs, " +
           std::to_string(output_.size()) + " outputs, " + std::to_string(sigma_.size()) + " standard deviations");
  }
  if (count < 2) refuse(std::to_string(count) + " samples; at least two are needed");
  check_finite("time", time_);
  check_finite("input", input_);
  check_finite("output", output_);
  check_finite("sigma", sigma_);
  for (std::size_t i = 1; i < count; ++i) {
    if (!(time_[i] > time_[i - 1])) {
      refuse(entry("time", i, time_[i]) + " s does not lie after " + detail::number_text(time_[i - 1]) + " s");
    }
  }
  for (std::size_t i = 0; i < sigma_.size(); ++i) {
    if (!(sigma_[i] > 0)) refuse(entry("sigma", i, sigma_[i]) + " is not positive");
  }
  if (!std::isfinite(input_at_rest_)) {
    refuse("input_at_rest = " + detail::number_text(input_at_rest_) + " is not finite");
  }
  // The last sample counts too: a direct path shows it in its own output even under a zero-order hold.
  if (std::all_of(input_.begin(), input_.end(), [this](double value) { return value == input_at_rest_; })) {
    refuse("the input is " + detail::number_text(input_at_rest_) +
           " throughout, as at rest; nothing drives the system");
  }
  if (hold_ == Hold::band_limited) check_repeating();
  observed_.resize(count);
  std::iota(observed_.begin(), observed_.end(), std::size_t{0});
}

void TimeResponseData::check_repeating() const {
  if (const std::optional<std::size_t> at = detail::first_uneven(time_)) {
    refuse(entry("time", *at, time_[*at]) + " s leaves the even steps of " +
           detail::number_text((time_.back() - time_.front()) / static_cast<double>(size() - 1)) +
           " s that a band-limited input needs");
  }
  if (std::all_of(input_.begin(), input_.end(), [this](double value) { return value == input_.front(); }))
    refuse("the input does not change; a band-limited input that repeats itself needs a line besides its mean");
}

TimeResponseData TimeResponseData::observed_at(std::vector<std::size_t> index) const {
  if (index.empty()) refuse("no output is left");
  for (std::size_t i = 0; i < index.size(); ++i) {
    if (index[i] >= size() || (i > 0 && index[i] <= index[i - 1])) {
      refuse("observed[" + std::to_string(i) + "] = " + std::to_string(index[i]) +
             "; allowed are rising indices below " + std::to_string(size()));
    }
  }
  TimeResponseData result = *this;
  result.observed_ = std::move(index);
  return result;
}

}  // namespace frac
