// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

namespace frac::detail {

/// Period of a sine in samples, from the phase between both halves of the signal.
/// @param near  the period to within a few per cent of the reciprocal of the number of cycles
[[nodiscard]] double sine_period(const double* signal, std::size_t count, double near);

/// Share of the power about the mean that a sine of this period has.
[[nodiscard]] double share_of_sine(const double* signal, std::size_t count, double period);

}  // namespace frac::detail
