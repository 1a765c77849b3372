// SPDX-License-Identifier: BSD-3-Clause
#include "fft_convolution.hpp"

#include <bit>
#include <complex>
#include <cstddef>
#include <unsupported/Eigen/FFT>

namespace frac::detail {

// Both are real: as the real and imaginary part of one signal they need one transform forth, and one back.
std::vector<double> fft_convolution(const std::vector<double>& kernel, const std::vector<double>& samples) {
  using Complex = std::complex<double>;
  const std::size_t count = samples.size();
  if (count == 0) return {};
  const std::size_t length = std::bit_ceil(2 * count);
  std::vector<Complex> time(length);
  for (std::size_t n = 0; n < count; ++n) time[n] = {samples[n], kernel[n]};
  std::vector<Complex> spectrum;
  Eigen::FFT<double> fft;
  fft.fwd(spectrum, time);
  for (std::size_t k = 0; k <= length / 2; ++k) {
    const std::size_t mirrored = (length - k) % length;
    const Complex a = spectrum[k];
    const Complex b = std::conj(spectrum[mirrored]);
    // (A + jB) at k and mirrored: A = (a + b)/2, B = (a - b)/(2j).
    const Complex product = (a + b) * (a - b) / Complex(0, 4);
    spectrum[k] = product;
    spectrum[mirrored] = std::conj(product);
  }
  fft.inv(time, spectrum);
  std::vector<double> result(count);
  for (std::size_t n = 0; n < count; ++n) result[n] = time[n].real();
  return result;
}

}  // namespace frac::detail
