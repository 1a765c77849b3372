// SPDX-License-Identifier: BSD-3-Clause
#include "steady_response.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <stdexcept>
#include <string>
#include <utility>

#include "base/number_text.hpp"
#include "frac/cancellation.hpp"
#include "sensitive_image.hpp"

namespace frac::detail {
namespace {

using Complex = std::complex<double>;

bool is_whole(double period) {
  return period == std::round(period);
}

std::vector<std::size_t> every_index(std::size_t count) {
  std::vector<std::size_t> index(count);
  std::iota(index.begin(), index.end(), std::size_t{0});
  return index;
}

/// The last term that counts; null where none does.
const SensitiveTerm* lowest(const SensitiveSum& sum) {
  const auto last =
      std::find_if(sum.rbegin(), sum.rend(), [](const SensitiveTerm& term) { return term.coefficient != 0; });
  return last == sum.rend() ? nullptr : &*last;
}

/// Value at s = 0 and its derivatives; 0 where the model has none that is finite.
ComplexRow value_at_origin(const SensitiveTerm& top, const SensitiveTerm& bottom) {
  const auto parameters = static_cast<Eigen::Index>(top.by_coefficient.size());
  ComplexRow row = ComplexRow::Zero(1 + parameters);
  if (top.order != bottom.order) return row;
  row[0] = top.coefficient / bottom.coefficient;
  for (Eigen::Index p = 0; p < parameters; ++p) {
    const auto at = static_cast<std::size_t>(p);
    row[1 + p] = (top.by_coefficient[at] - row[0] * bottom.by_coefficient[at]) / bottom.coefficient;
  }
  return row;
}

}  // namespace

PeriodicInput::PeriodicInput(const std::vector<double>& time, const std::vector<double>& input)
    : period_(input_period(input)), samples_(input.size()), first_time_(time.front()) {
  const double step = (time.back() - time.front()) / static_cast<double>(time.size() - 1);
  spacing_ = 2 * std::numbers::pi / (period_.samples * step);
  line_ = LineSum(samples_, period_.samples).fitted(input, every_index(samples_));
  constexpr double rounding = 1e-13;
  double largest = 0;
  for (const Complex& each : line_) largest = std::max(largest, std::abs(each));
  for (std::size_t k = 1; k < line_.size(); ++k) {
    if (std::abs(line_[k]) > rounding * largest) excited_.push_back(k);
  }
}

SteadyResponse::SteadyResponse(std::shared_ptr<const PeriodicInput> input, std::vector<std::size_t> index)
    : input_(std::move(input)),
      row_(std::move(index)),
      sum_(is_whole(input_->period()) ? static_cast<std::size_t>(input_->period()) : input_->samples(),
           input_->period()) {
  if (!is_whole(input_->period())) return;
  for (std::size_t& each : row_) each %= static_cast<std::size_t>(input_->period());
}

bool SteadyResponse::evaluate(const RatioOfPowerSums& ratio, EventResponse::Result& result) const {
  const SensitiveTerm* const top = lowest(ratio.numerator);
  const SensitiveTerm* const bottom = lowest(ratio.denominator);
  if (!top || !bottom || !std::isfinite(ratio.delay)) return false;
  SensitiveImage image(ratio, 0);
  const Eigen::Index columns = image.columns();
  std::vector<std::vector<Complex>> line(static_cast<std::size_t>(columns),
                                         std::vector<Complex>(sum_.lines(), Complex(0)));
  const auto place = [&](std::size_t k, const ComplexRow& row, Complex factor) {
    bool finite = true;
    for (Eigen::Index p = 0; p < columns; ++p) {
      const Complex value = factor * row[p];
      finite = finite && std::isfinite(value.real()) && std::isfinite(value.imag());
      line[static_cast<std::size_t>(p)][k] = value;
    }
    return finite;
  };
  if (!place(0, value_at_origin(*top, *bottom), input_->line()[0])) return false;
  const bool moves =
      std::any_of(ratio.delay_slope.begin(), ratio.delay_slope.end(), [](double each) { return each != 0; });
  for (const std::size_t k : input_->excited()) {
    const double omega = input_->omega(k);
    const ComplexRow& row = image(Complex(std::log(omega), 0.5 * std::numbers::pi));
    const Complex factor = input_->line()[k] * std::polar(1.0, -omega * ratio.delay);
    if (!place(k, row, factor)) return false;
    if (!moves) continue;
    for (std::size_t p = 0; p < ratio.delay_slope.size(); ++p) {
      line[p + 1][k] -= Complex(0, omega * ratio.delay_slope[p]) * line[0][k];
    }
  }
  const auto rows = static_cast<Eigen::Index>(row_.size());
  result.value.resize(rows);
  result.gradient.resize(rows, columns - 1);
  for (Eigen::Index p = 0; p < columns; ++p) {
    const std::vector<double> signal = sum_(line[static_cast<std::size_t>(p)]);
    for (Eigen::Index i = 0; i < rows; ++i) {
      const double value = signal[row_[static_cast<std::size_t>(i)]];
      if (p == 0) {
        result.value[i] = value;
      } else {
        result.gradient(i, p - 1) = value;
      }
    }
  }
  return true;
}

std::vector<double> steady_response(const FractionalTransferFunction& model, const PeriodicInput& input,
                                    std::span<const double> time) {
  std::vector<double> output(time.size(), 0.0);
  const auto add = [&](std::size_t k, Complex value) {
    throw_if_cancelled();
    if (!std::isfinite(value.real()) || !std::isfinite(value.imag())) {
      throw std::domain_error("respond: the model is not finite at " + number_text(input.omega(k)) +
                              " rad/s, a line of the input: it has no steady state");
    }
    for (std::size_t i = 0; i < time.size(); ++i) {
      output[i] += (value * std::polar(1.0, input.omega(k) * (time[i] - input.first_time()))).real();
    }
  };
  const PowerTerm &top = model.numerator().back(), &bottom = model.denominator().back();
  if (top.order == bottom.order) add(0, input.line()[0] * (top.coefficient / bottom.coefficient));
  for (const std::size_t k : input.excited()) add(k, input.line()[k] * model.response(input.omega(k)));
  return output;
}

}  // namespace frac::detail
