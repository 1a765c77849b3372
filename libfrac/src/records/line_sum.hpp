// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <complex>
#include <cstddef>
#include <vector>

#include "records/chirp_transform.hpp"

namespace frac::detail {

/// Signals x_m = Re sum_k X_k e^{2 pi j k m/period}, m counting samples from the first: sums of the lines of a period
/// from 0 to below half the sampling rate.  The period need not be a whole number of samples.
class LineSum {
 public:
  /// @param samples  that are computed, >= 1
  /// @param period   in samples, > 2
  LineSum(std::size_t samples, double period);

  /// Lines from 0 on.
  [[nodiscard]] std::size_t lines() const noexcept { return lines_; }
  [[nodiscard]] std::vector<double> operator()(const std::vector<std::complex<double>>& line) const;

  /// The lines that come nearest a signal in least squares, X_0 real: one discrete Fourier transform where the samples
  /// are whole periods, else by conjugate gradients.  Where samples do not determine every line, those near 0.
  /// @param signal  `samples` values
  /// @param index   samples that count, rising
  [[nodiscard]] std::vector<std::complex<double>> fitted(const std::vector<double>& signal,
                                                         const std::vector<std::size_t>& index) const;

 private:
  std::size_t samples_, lines_;
  ChirpTransform to_signal_, to_lines_;
};

/// Period of an input in samples: that of period_of(), where that is no whole number the one near it whose lines leave
/// the least of the input; or the whole signal where nothing in it repeats or its lines do not pay for themselves.
struct InputPeriod {
  double samples;
  bool repeats;
};
[[nodiscard]] InputPeriod input_period(const std::vector<double>& input);

}  // namespace frac::detail
