// SPDX-License-Identifier: BSD-3-Clause
#include "steady_state/window_mean.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <cstddef>
#include <cstdint>
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

// A drift of 0.01 a period with hardly an impact is the same in every batch, so that nothing scatters; the ends alone
// move the mean, by (u + j u')/(pi periods) at each.  With many impacts they are part of the scatter.
TEST(WindowMean, ADriftThatDoesNotScatterWidensTheInterval) {
  const backlash::detail::GapMotion motion(0.8, 0.5);
  for (const int impacts_per_period : {0, 2}) {
    std::vector<backlash::detail::WindowRecord> window(33);
    for (int i = 0; i <= 32; ++i) {
      auto& record = window[static_cast<std::size_t>(i)];
      record.period = i;
      record.strobe = {0.01 * i, -0.002 * i, impacts_per_period * i + i / 32};
    }
    const double drift = impacts_per_period == 0 ? 0.012 / std::numbers::pi : 0;
    EXPECT_NEAR(backlash::detail::averaged(window, motion).uncertainty, drift, 1e-15);
  }
}

// Without impacts a window goes on: to 64 times its records once it is as long as asked for, to 128 times before.
TEST(WindowMean, AWindowWithFewImpactsEndsEarlierOnceItIsLongEnough) {
  for (const auto& [wanted, last] : {std::pair<std::int64_t, std::int64_t>{1, 64 * 1024}, {1'000'000, 128 * 1024}}) {
    backlash::detail::Window window;
    std::int64_t period = 0;
    for (bool goes_on = true; goes_on; ++period) {
      backlash::detail::WindowRecord record;
      record.period = period;
      goes_on = window.add(record, wanted);
    }
    EXPECT_EQ(period - 1, last);
  }
}

}  // namespace
