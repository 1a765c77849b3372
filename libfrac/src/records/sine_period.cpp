// SPDX-License-Identifier: BSD-3-Clause
#include "records/sine_period.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "records/whole_periods.hpp"

namespace frac::detail {
namespace {

using std::numbers::pi;

double mean_of(const double* signal, std::size_t count) {
  double sum = 0;
  for (std::size_t i = 0; i < count; ++i) sum += signal[i];
  return sum / static_cast<double>(count);
}

/// 2/n sum of (x - mean) exp(-2 pi j i/period).
std::complex<double> phasor(const double* signal, std::size_t count, double period) {
  const double mean = mean_of(signal, count);
  std::complex<double> sum = 0;
  for (std::size_t i = 0; i < count; ++i)
    sum += (signal[i] - mean) * std::polar(1.0, -2 * pi * std::fmod(static_cast<double>(i) / period, 1));
  return 2.0 / static_cast<double>(count) * sum;
}

}  // namespace

double sine_period(const double* signal, std::size_t count, double near) {
  double period = near;
  for (int round = 0; round < 4; ++round) {
    const double cycles = std::floor(0.5 * static_cast<double>(count) / period);
    if (cycles < 1) return period;
    // Halves of whole cycles, as close as samples allow.
    const auto half = static_cast<std::size_t>(std::lround(cycles * period));
    if (2 * half > count) return period;
    const std::complex<double> first = phasor(signal, half, period), second = phasor(signal + half, half, period);
    const double turn = std::arg(second * std::conj(first) *
                                 std::polar(1.0, -2 * pi * std::fmod(static_cast<double>(half) / period, 1)));
    // The phase of a sine of another period runs away by this much over half the signal.
    const double rate = 1 / period + turn / (2 * pi * static_cast<double>(half));
    // A correction that leaves the neighbourhood is noise.
    if (!(std::abs(rate * near - 1) < 0.5)) return near;
    period = 1 / rate;
  }
  return period;
}

double share_of_sine(const double* signal, std::size_t count, double period) {
  const double mean = mean_of(signal, count);
  double power = 0;
  for (std::size_t i = 0; i < count; ++i) power += (signal[i] - mean) * (signal[i] - mean);
  const auto whole = static_cast<std::size_t>(std::lround(static_cast<double>(whole_periods(count, period)) * period));
  return 0.5 * std::norm(phasor(signal, std::min(whole, count), period)) * static_cast<double>(count) / power;
}

}  // namespace frac::detail
