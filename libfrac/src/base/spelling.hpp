// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

namespace frac::detail {

/// Every enumerator with its name on the command line.
template <typename Enum, std::size_t count>
using Spellings = std::array<std::pair<Enum, std::string_view>, count>;

/// Name of an enumerator; empty for a value that is none.
template <typename Enum, std::size_t count>
[[nodiscard]] constexpr std::string_view spelling(const Spellings<Enum, count>& table, Enum value) noexcept {
  for (const auto& [enumerator, text] : table) {
    if (enumerator == value) return text;
  }
  return {};
}

/// The enumerators of a table, in its order.
template <typename Enum, std::size_t count>
[[nodiscard]] constexpr std::array<Enum, count> enumerators(const Spellings<Enum, count>& table) {
  std::array<Enum, count> all{};
  for (std::size_t i = 0; i < count; ++i) all[i] = table[i].first;
  return all;
}

/// Enumerator of a name.
/// @param quantity  what is named, for the refusal
/// @throws std::invalid_argument  the name is not in the table; the text lists those that are.
template <typename Enum, std::size_t count>
[[nodiscard]] Enum from_spelling(const Spellings<Enum, count>& table, const char* quantity, std::string_view text) {
  std::string known;
  for (const auto& [enumerator, spelled] : table) {
    if (spelled == text) return enumerator;
    known.append(known.empty() ? "" : ", ").append(spelled);
  }
  throw std::invalid_argument(std::string(quantity) + " \"" + std::string(text) + "\": expected one of " + known);
}

}  // namespace frac::detail
