#pragma once

#include <complex>
#include <vector>

#include "laplace_image.hpp"

namespace frac::detail {

/// Re sum weight e^{rate t}.
struct Exponential {
  std::complex<double> rate;
  std::complex<double> weight;
};

/// Exponentials with y(t) = constant + sum weight (e^{rate t} - 1) for the original y of `image` on earliest <= t <=
/// latest, within tolerance * size.  The image is s^q, q > -2, at the origin.
/// @param size  of y on that interval; parts of the sum that are larger and cancel are made as much more accurate.
[[nodiscard]] std::vector<Exponential> exponential_sum(const LaplaceImage& image, double earliest, double latest,
                                                       double tolerance, double size);

}  // namespace frac::detail
