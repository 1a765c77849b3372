// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <complex>
#include <cstddef>
#include <vector>

namespace frac::detail {

/// Fourier sums X_k = (2/n) sum x_m exp(-2 pi j k m/length), k = 0 .. count - 1, of signals of n samples, where length
/// need be neither whole nor equal to n: as a convolution with a chirp (Rabiner, Schafer, Rader 1969), so that no
/// length is slow.  A sine of amplitude A on a line has |X| = A.
class ChirpTransform {
 public:
  ChirpTransform(std::size_t samples, double length, std::size_t count);

  [[nodiscard]] std::vector<std::complex<double>> operator()(const double* signal) const;
  [[nodiscard]] std::vector<std::complex<double>> operator()(const std::complex<double>* signal) const;

 private:
  template <class Value>
  [[nodiscard]] std::vector<std::complex<double>> transformed(const Value* signal) const;

  std::size_t samples_, count_;
  std::vector<std::complex<double>> chirp_;   // exp(-pi j m^2/length)
  std::vector<std::complex<double>> kernel_;  // transform of its conjugate
};

/// The smallest length >= least that the transform of Eigen is fast for: 2, 3 or 5 times a power of two.
[[nodiscard]] std::size_t fast_length(std::size_t least);

}  // namespace frac::detail
