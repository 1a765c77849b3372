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

double largest_of(const std::vector<Complex>& line) {
  double largest = 0;
  for (std::size_t k = 1; k < line.size(); ++k) largest = std::max(largest, std::abs(line[k]));
  return largest;
}

/// Without 0.
std::vector<std::size_t> lines_above(const std::vector<Complex>& line, double least) {
  std::vector<std::size_t> above;
  for (std::size_t k = 1; k < line.size(); ++k)
    if (std::abs(line[k]) > least) above.push_back(k);
  return above;
}

/// Mean square of the error of a line, by what all lines leave of the input.
double noise_power(const std::vector<double>& input, const LineSum& sum, const std::vector<Complex>& line) {
  const std::vector<double> model = sum(line);
  double square = 0;
  for (std::size_t m = 0; m < input.size(); ++m) square += (input[m] - model[m]) * (input[m] - model[m]);
  const auto count = static_cast<double>(input.size());
  return 4 / count * square / std::max(1.0, count - 2 * static_cast<double>(line.size()));
}

/// Lines that noise of that power reaches with a chance below 1e-3 over all of them and, where a gap of more than a
/// factor of 4 parts these, those above the widest: what lies below is the answer of a loop or of an amplifier to the
/// rest, with disturbances in it, as in response().
std::vector<std::size_t> excited_lines(const std::vector<Complex>& line, double noise) {
  constexpr double chance = 1e-3, least_gap = 4;
  const double least = std::sqrt(noise * std::log(static_cast<double>(line.size()) / chance));
  std::vector<double> amplitude;
  for (const std::size_t k : lines_above(line, std::max(least, 1e-13 * largest_of(line))))
    amplitude.push_back(std::abs(line[k]));
  if (amplitude.empty()) return {};
  std::sort(amplitude.rbegin(), amplitude.rend());
  double widest = least_gap, lowest = amplitude.back();
  for (std::size_t i = 1; i < amplitude.size(); ++i) {
    if (!(amplitude[i - 1] > widest * amplitude[i])) continue;
    widest = amplitude[i - 1] / amplitude[i];
    lowest = amplitude[i - 1];
  }
  return lines_above(line, lowest * (1 - 1e-12));
}

}  // namespace

PeriodicInput::PeriodicInput(const std::vector<double>& time, const std::vector<double>& input)
    : period_(input_period(input)), samples_(input.size()), first_time_(time.front()) {
  const double step = (time.back() - time.front()) / static_cast<double>(time.size() - 1);
  spacing_ = 2 * std::numbers::pi / (period_.samples * step);
  const LineSum sum(samples_, period_.samples);
  line_ = sum.fitted(input, every_index(samples_));
  excited_ = period_.repeats ? excited_lines(line_, noise_power(input, sum, line_))
                             : lines_above(line_, 1e-13 * largest_of(line_));
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
  return respond(value_at_origin(*top, *bottom), image, ratio.delay, ratio.delay_slope, result);
}

bool SteadyResponse::evaluate(CutPlaneModel model, EventResponse::Result& result) const {
  return respond(model.at_origin().cast<Complex>(), model, 0, {}, result);
}

template <typename Image>
bool SteadyResponse::respond(const ComplexRow& origin, Image& image, double delay, const Slope& delay_slope,
                             EventResponse::Result& result) const {
  const Eigen::Index columns = origin.size();
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
  if (!place(0, origin, input_->line()[0])) return false;
  const bool moves = std::any_of(delay_slope.begin(), delay_slope.end(), [](double each) { return each != 0; });
  for (const std::size_t k : input_->excited()) {
    const double omega = input_->omega(k);
    const ComplexRow& row = image(Complex(std::log(omega), 0.5 * std::numbers::pi));
    const Complex factor = input_->line()[k] * std::polar(1.0, -omega * delay);
    if (!place(k, row, factor)) return false;
    if (!moves) continue;
    for (std::size_t p = 0; p < delay_slope.size(); ++p) {
      line[p + 1][k] -= Complex(0, omega * delay_slope[p]) * line[0][k];
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
