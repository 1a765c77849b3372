// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <span>
#include <string_view>

#include "frac/realisation.hpp"

namespace frac::detail {

/// Longest Gruenwald-Letnikov memory; its weights take 160 MB.
inline constexpr std::size_t longest_memory = 10'000'000;

/// @throws std::invalid_argument  memory_length beyond the longest; the text begins with `where`.
void check_memory_length(std::size_t memory_length, std::string_view where);

/// @throws std::invalid_argument  omega not positive and finite, or above the Nyquist frequency of the realisation.
void check_omega(const Realisation& realisation, double omega, std::string_view where);
void check_omega(const Realisation& realisation, std::span<const double> omega, std::string_view where);

}  // namespace frac::detail
