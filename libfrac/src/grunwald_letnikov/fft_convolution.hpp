// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

namespace frac::detail {

/// The first samples.size() values of the convolution of kernel and samples, through one Fourier transform of both;
/// the kernel is at least as long.  Each value errs by some ten roundings of the product of the two Euclidean norms.
[[nodiscard]] std::vector<double> fft_convolution(const std::vector<double>& kernel,
                                                  const std::vector<double>& samples);

}  // namespace frac::detail
