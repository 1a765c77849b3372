// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <stdexcept>
#include <string>
#include <string_view>

namespace frac::detail {

/// Letters, digits and _, the first no digit, up to `longest` characters.
[[nodiscard]] inline bool is_identifier(std::string_view name, std::size_t longest) {
  const auto is_letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; };
  const auto is_part = [&](char c) { return is_letter(c) || (c >= '0' && c <= '9'); };
  return !name.empty() && name.size() <= longest && is_letter(name[0]) &&
         std::all_of(name.begin(), name.end(), is_part);
}

/// @param quantity  what is named, for the refusal
/// @throws std::invalid_argument  the name is no identifier or is above 40 characters.
inline void check_identifier(std::string_view quantity, const std::string& name) {
  constexpr std::size_t longest = 40;
  if (is_identifier(name, longest)) return;
  throw std::invalid_argument(std::string(quantity) + " \"" + name +
                              "\": expected an identifier of letters, digits and _, up to " + std::to_string(longest) +
                              " characters");
}

}  // namespace frac::detail
