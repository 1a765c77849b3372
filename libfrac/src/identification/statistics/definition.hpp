// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>

namespace frac::detail {

/// "NAME = FORMULA", without blanks around either.
struct Definition {
  std::string name, formula;
};
/// @throws std::invalid_argument  no name before =
[[nodiscard]] Definition split_definition(std::string_view text);

/// The formula with the number instead of each word `pi`, which is no name of a parameter.
[[nodiscard]] std::string with_pi(std::string_view formula);

}  // namespace frac::detail
