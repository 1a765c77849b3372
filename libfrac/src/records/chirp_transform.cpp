// SPDX-License-Identifier: BSD-3-Clause
#include "records/chirp_transform.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>
#include <unsupported/Eigen/FFT>

#include "frac/cancellation.hpp"

namespace frac::detail {

std::size_t fast_length(std::size_t least) {
  const std::size_t power = std::bit_ceil(std::max<std::size_t>(least, 8));
  if (power / 8 * 5 >= least) return power / 8 * 5;
  if (power / 4 * 3 >= least) return power / 4 * 3;
  return power;
}

ChirpTransform::ChirpTransform(std::size_t samples, double length, std::size_t count)
    : samples_(samples), count_(count) {
  throw_if_cancelled();
  const std::size_t longest = std::max(samples, count);
  chirp_.resize(longest);
  for (std::size_t m = 0; m < longest; ++m) {
    // In turns, of which the whole ones are dropped before they cost digits.
    const auto square = static_cast<long double>(m) * static_cast<long double>(m);
    const long double turns = square / (2 * static_cast<long double>(length));
    chirp_[m] = std::polar(1.0, -2 * std::numbers::pi * static_cast<double>(turns - std::floor(turns)));
  }
  const std::size_t size = fast_length(samples + count);
  std::vector<std::complex<double>> shifted(size);
  for (std::size_t k = 0; k < count; ++k) shifted[k] = std::conj(chirp_[k]);
  for (std::size_t m = 1; m < samples; ++m) shifted[size - m] = std::conj(chirp_[m]);
  Eigen::FFT<double> fft;
  fft.fwd(kernel_, shifted);
}

template <class Value>
std::vector<std::complex<double>> ChirpTransform::transformed(const Value* signal) const {
  throw_if_cancelled();
  std::vector<std::complex<double>> time(kernel_.size()), spectrum;
  for (std::size_t m = 0; m < samples_; ++m) time[m] = signal[m] * chirp_[m];
  Eigen::FFT<double> fft;
  fft.fwd(spectrum, time);
  for (std::size_t i = 0; i < spectrum.size(); ++i) spectrum[i] *= kernel_[i];
  fft.inv(time, spectrum);
  std::vector<std::complex<double>> result(count_);
  const double scale = 2 / static_cast<double>(samples_);
  for (std::size_t k = 0; k < count_; ++k) result[k] = scale * time[k] * chirp_[k];
  return result;
}

std::vector<std::complex<double>> ChirpTransform::operator()(const double* signal) const {
  return transformed(signal);
}

std::vector<std::complex<double>> ChirpTransform::operator()(const std::complex<double>* signal) const {
  return transformed(signal);
}

}  // namespace frac::detail
