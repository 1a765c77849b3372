// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "options/command.hpp"

namespace fracfit {

// Scripts that complete subcommands, options and the words that options take.
[[nodiscard]] std::string bash_completion(const std::vector<CommandGroup>& groups);
[[nodiscard]] std::string zsh_completion(const std::vector<CommandGroup>& groups);
[[nodiscard]] std::string fish_completion(const std::vector<CommandGroup>& groups);

}  // namespace fracfit
