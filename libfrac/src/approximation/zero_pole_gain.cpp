// SPDX-License-Identifier: BSD-3-Clause
#include "frac/approximation/zero_pole_gain.hpp"

#include <algorithm>
#include <cstddef>

#include "special/exact_power.hpp"

namespace frac {

std::complex<double> ZeroPoleGain::response(double omega) const {
  const std::complex<double> s(0, omega);
  std::complex<double> value = detail::quarter_turns(integer_order) * (gain * detail::real_power(omega, integer_order));
  // Zero by pole, so that no partial product leaves the range of double on wide bands.
  for (std::size_t i = 0; i < std::max(zeros.size(), poles.size()); ++i) {
    const std::complex<double> numerator = i < zeros.size() ? s - zeros[i] : 1;
    const std::complex<double> denominator = i < poles.size() ? s - poles[i] : 1;
    value *= numerator / denominator;
  }
  const auto pair_factor = [&](std::complex<double> root) { return (s - root) * (s - std::conj(root)); };
  for (std::size_t i = 0; i < std::max(zero_pairs.size(), pole_pairs.size()); ++i) {
    const std::complex<double> numerator = i < zero_pairs.size() ? pair_factor(zero_pairs[i]) : 1;
    const std::complex<double> denominator = i < pole_pairs.size() ? pair_factor(pole_pairs[i]) : 1;
    value *= numerator / denominator;
  }
  return value;
}

}  // namespace frac
