// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>

namespace fracfit {

/// What an option means wherever it occurs.
struct Meaning {
  std::string name, type, text;
};

/// Meaning of an option of several commands, so that one name has one meaning, unit and type.
/// @throws std::logic_error  the name is not in the vocabulary.
[[nodiscard]] const Meaning& meaning_of(std::string_view name);

}  // namespace fracfit
