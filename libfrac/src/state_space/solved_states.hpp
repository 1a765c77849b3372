// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <complex>
#include <vector>

#include "frac/state_space.hpp"

namespace frac::detail {

/// (j omega - A)^-1 B, omega in rad/s.
[[nodiscard]] std::vector<std::complex<double>> solved_states(const StateSpace& system, double omega);

}  // namespace frac::detail
