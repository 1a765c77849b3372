// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "options/command.hpp"

namespace fracfit {

/// What the arguments of the program ask for: a command, its options holding the texts given, or else a page to print.
struct Request {
  Command* command = nullptr;
  std::string page;
};

/// @throws std::invalid_argument  wrong usage; the text says where help is.
[[nodiscard]] Request parse(const std::vector<CommandGroup>& groups, const std::vector<std::string>& arguments);

}  // namespace fracfit
