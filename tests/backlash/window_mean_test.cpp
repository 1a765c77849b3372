// SPDX-License-Identifier: BSD-3-Clause
#include "steady_state/window_mean.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <cstddef>
#include <numbers>
#include <utility>
#include <vector>

namespace {

using Complex = std::complex<double>;

// Deviations of n batches with sum |d|^2 = n have the variance 1/(n - 1) of their mean.  Along a line the square of the
// error over it is F(1, n - 1), that is Student's t squared (2.131449546 of 15, 2.364624252 of 7 degrees of freedom,
// from tables); alike in all directions it is F(2, m), m = 2 (n - 1), whose 95 % quantile is m/2 (0.05^(-2/m) - 1).
TEST(WindowMean, HalfWidthIsThatOfErrorsAlongALineAndInAllDirections) {
  for (const auto& [count, student] : {std::pair<std::size_t, double>{16, 2.131449546}, {8, 2.364624252}}) {
    const auto n = static_cast<double>(count);
    std::vector<Complex> line, plane;
    for (std::size_t k = 0; k < count; ++k) {
      line.push_back(std::polar(k % 2 == 0 ? 1.0 : -1.0, 0.7));
      plane.push_back(std::polar(1.0, 2 * std::numbers::pi * static_cast<double>(k) / n));
    }
    EXPECT_NEAR(backlash::detail::half_width_of_mean(line), student / std::sqrt(n - 1), 1e-8);
    const double m = 2 * (n - 1);
    EXPECT_NEAR(backlash::detail::half_width_of_mean(plane), std::sqrt(m / 2 * (std::pow(0.05, -2 / m) - 1) / (n - 1)),
                1e-8);
  }
}

}  // namespace
