// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "options/command.hpp"

namespace fracfit {

// Pages made from the declarations that the arguments are checked against.
[[nodiscard]] std::string program_help(const std::vector<CommandGroup>& groups);
/// What `fracfit WORD --help` lists where commands have two words of which WORD is the first; empty where none has.
[[nodiscard]] std::string first_word_help(const std::vector<CommandGroup>& groups, const std::string& word);
[[nodiscard]] std::string command_help(const Command& command);
/// In troff.
[[nodiscard]] std::string manual_page(const std::vector<CommandGroup>& groups);

}  // namespace fracfit
