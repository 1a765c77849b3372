// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cassert>
#include <cstddef>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

namespace backlash::detail {

/// Text of an enumerator from a table that holds every one of them.
template <typename Enum, std::size_t N>
std::string_view spelling(const std::array<std::pair<Enum, std::string_view>, N>& table, Enum value) {
  for (const auto& [enumerator, text] : table) {
    if (enumerator == value) return text;
  }
  assert(false);
  return {};
}

/// The enumerators of such a table, in its order.
template <typename Enum, std::size_t N>
constexpr std::array<Enum, N> enumerators(const std::array<std::pair<Enum, std::string_view>, N>& table) {
  std::array<Enum, N> all{};
  for (std::size_t i = 0; i < N; ++i) all[i] = table[i].first;
  return all;
}

/// @throws std::invalid_argument  naming what is allowed.
template <typename Enum, std::size_t N>
Enum from_spelling(const std::array<std::pair<Enum, std::string_view>, N>& table, std::string_view quantity,
                   std::string_view text) {
  std::string allowed;
  for (const auto& [enumerator, spelled] : table) {
    if (spelled == text) return enumerator;
    allowed.append(allowed.empty() ? "" : ", ").append(spelled);
  }
  throw std::invalid_argument(std::string(quantity) + " is '" + std::string(text) + "'; it must be one of " + allowed);
}

}  // namespace backlash::detail
