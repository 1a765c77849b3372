#pragma once

#include <cmath>
#include <complex>
#include <cstddef>
#include <limits>
#include <numbers>
#include <vector>

namespace frac::detail {

template <typename Function>
double phase_change(const Function& f, std::complex<double> from, std::complex<double> to, std::complex<double> f_from,
                    std::complex<double> f_to, double longest, int depth) {
  const double change = std::arg(f_to / f_from);
  if (std::abs(change) < 0.7 && std::abs(to - from) <= longest) return change;
  if (depth == 0 || !std::isfinite(change)) return std::numeric_limits<double>::quiet_NaN();
  const std::complex<double> middle = (from + to) / 2.0;
  const std::complex<double> f_middle = f(middle);
  return phase_change(f, from, middle, f_from, f_middle, longest, depth - 1) +
         phase_change(f, middle, to, f_middle, f_to, longest, depth - 1);
}

/// Change of arg f along the closed polygon divided by 2 pi, for f analytic that winds at most `rate` rad per unit
/// length away from its zeros.  NaN where the path runs into a zero.
template <typename Function>
[[nodiscard]] double winding_number(const Function& f, const std::vector<std::complex<double>>& polygon, double rate) {
  double total = 0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const std::complex<double> from = polygon[i];
    const std::complex<double> to = polygon[(i + 1) % polygon.size()];
    total += phase_change(f, from, to, f(from), f(to), 0.6 / rate, 48);
  }
  return total / (2 * std::numbers::pi);
}

}  // namespace frac::detail
