// SPDX-License-Identifier: BSD-3-Clause
#include "records/line_sum.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

#include "frac/records/excitation.hpp"

namespace frac::detail {
namespace {

using Complex = std::complex<double>;

/// Lines from 0 to below half the sampling rate; that at half of it has no phase in the samples.
std::size_t lines_below_half(double period) {
  return static_cast<std::size_t>(std::ceil(0.5 * period - 1e-9));
}

double product(const std::vector<Complex>& a, const std::vector<Complex>& b) {
  double sum = 0;
  for (std::size_t k = 0; k < a.size(); ++k) sum += (std::conj(a[k]) * b[k]).real();
  return sum;
}

std::vector<std::size_t> every_index(std::size_t count) {
  std::vector<std::size_t> index(count);
  std::iota(index.begin(), index.end(), std::size_t{0});
  return index;
}

double sum_of_squares(const std::vector<double>& values) {
  return std::inner_product(values.begin(), values.end(), values.begin(), 0.0);
}

/// What lines of a period leave of a signal.
struct Rest {
  double period;
  std::vector<Complex> line;
  std::vector<double> value;
  double square;
};
Rest rest_of(const std::vector<double>& signal, double period) {
  const LineSum sum(signal.size(), period);
  Rest rest{period, sum.fitted(signal, every_index(signal.size())), signal, 0};
  const std::vector<double> model = sum(rest.line);
  for (std::size_t m = 0; m < signal.size(); ++m) rest.value[m] -= model[m];
  rest.square = sum_of_squares(rest.value);
  return rest;
}

/// Gauss and Newton's step of the period: its slope by the period as far as no line follows it (Kaufman 1975).
double newton_step(const Rest& rest) {
  const LineSum sum(rest.value.size(), rest.period);
  std::vector<Complex> turned(rest.line);
  const double turn = 2 * std::numbers::pi / (rest.period * rest.period);
  for (std::size_t k = 0; k < turned.size(); ++k) turned[k] *= Complex(0, -turn * static_cast<double>(k));
  std::vector<double> slope = sum(turned);
  for (std::size_t m = 0; m < slope.size(); ++m) slope[m] *= static_cast<double>(m);
  const std::vector<double> followed = sum(sum.fitted(slope, every_index(slope.size())));
  for (std::size_t m = 0; m < slope.size(); ++m) slope[m] -= followed[m];
  return std::inner_product(slope.begin(), slope.end(), rest.value.begin(), 0.0) / sum_of_squares(slope);
}

/// The period nearby that leaves least; a whole number where that leaves as little, a clock that runs with the
/// generator: half a per cent is within the scatter of both, see period_of().
Rest refined(const std::vector<double>& signal, Rest best) {
  for (int round = 0; round < 12; ++round) {
    const double step = newton_step(best);
    if (!(std::abs(step) > 1e-14 * best.period)) break;
    Rest next = rest_of(signal, best.period + step);
    if (!(next.square < best.square)) break;
    best = std::move(next);
  }
  const double whole = std::round(best.period);
  if (!(std::abs(best.period - whole) < 0.1) || !(whole > 2)) return best;
  constexpr double rounding = 1e-24;
  Rest at_whole = rest_of(signal, whole);
  const bool as_little = at_whole.square <= 1.005 * best.square + rounding * sum_of_squares(signal);
  return as_little ? at_whole : best;
}

/// Whether lines of a period, at Schwarz's price, describe a signal better than a mean and noise do.  Half of the power
/// of a short random signal repeats itself at some lag by chance.
bool is_believed(const Rest& rest, const std::vector<double>& signal) {
  const auto count = static_cast<double>(signal.size());
  const double mean = std::accumulate(signal.begin(), signal.end(), 0.0) / count;
  const double about_mean = sum_of_squares(signal) - count * mean * mean;
  const double parameters = 2 * static_cast<double>(rest.line.size() - 1);
  return count * std::log(about_mean / rest.square) > parameters * std::log(count);
}

}  // namespace

LineSum::LineSum(std::size_t samples, double period)
    : samples_(samples),
      lines_(lines_below_half(period)),
      to_signal_(lines_, period, samples),
      to_lines_(samples, period, lines_) {}

std::vector<double> LineSum::operator()(const std::vector<Complex>& line) const {
  std::vector<Complex> conjugate(lines_);
  for (std::size_t k = 0; k < lines_; ++k) conjugate[k] = std::conj(line[k]);
  const std::vector<Complex> sums = to_signal_(conjugate.data());
  const double scale = 0.5 * static_cast<double>(lines_);
  std::vector<double> signal(samples_);
  for (std::size_t m = 0; m < samples_; ++m) signal[m] = scale * sums[m].real();
  return signal;
}

std::vector<Complex> LineSum::fitted(const std::vector<double>& signal, const std::vector<std::size_t>& index) const {
  // Half the sum of squares has the gradient sum_m rest_m e^{-2 pi j k m/period}; over whole periods its matrix is the
  // identity in units of `weight`.
  const auto count = static_cast<double>(index.size());
  const auto weight = [&](std::size_t k) { return k == 0 ? count : 0.5 * count; };
  const double scale = 0.5 * static_cast<double>(samples_);
  const auto gradient = [&](const std::vector<double>& values) {
    std::vector<double> counted(samples_, 0.0);
    for (const std::size_t m : index) counted[m] = values[m];
    std::vector<Complex> result = to_lines_(counted.data());
    for (std::size_t k = 0; k < lines_; ++k) result[k] *= scale;
    result[0].imag(0);
    return result;
  };
  const auto weighed = [&](std::vector<Complex> values) {
    for (std::size_t k = 0; k < lines_; ++k) values[k] /= weight(k);
    return values;
  };
  std::vector<Complex> line(lines_), rest = gradient(signal), step = weighed(rest);
  std::vector<Complex> preconditioned = step;
  double size = product(rest, preconditioned);
  const double first = size;
  // Every step gains a digit or more where the samples hold two periods or more; a few gaps cost some steps.
  constexpr double settled = 1e-26;
  for (int round = 0; round < 60 && size > settled * first; ++round) {
    const std::vector<Complex> image = gradient((*this)(step));
    const double length = size / product(step, image);
    if (!std::isfinite(length)) break;
    for (std::size_t k = 0; k < lines_; ++k) {
      line[k] += length * step[k];
      rest[k] -= length * image[k];
    }
    preconditioned = weighed(rest);
    const double next = product(rest, preconditioned);
    for (std::size_t k = 0; k < lines_; ++k) step[k] = preconditioned[k] + next / size * step[k];
    size = next;
  }
  return line;
}

InputPeriod input_period(const std::vector<double>& input) {
  const InputPeriod whole_record{static_cast<double>(input.size()), false};
  const std::optional<double> period = period_of(input);
  // A period of less has no line.
  if (!period || !(*period > 2)) return whole_record;
  Rest best = rest_of(input, *period);
  if (*period != std::round(*period)) best = refined(input, std::move(best));
  return is_believed(best, input) ? InputPeriod{best.period, true} : whole_record;
}

}  // namespace frac::detail
