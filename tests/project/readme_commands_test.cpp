// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "tools/temporary_folder.hpp"

namespace {

namespace fs = std::filesystem;

/// The commands of the ```sh blocks of a page that begin with `program`, lines that end in a backslash joined.
std::vector<std::string> commands_of(const fs::path& page, const std::string& program) {
  std::ifstream file(page);
  std::vector<std::string> commands;
  bool in_block = false, continued = false;
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with("```")) {
      in_block = line == "```sh";
      continue;
    }
    if (!in_block) continue;
    if (continued) {
      commands.back() += "\n" + line;
    } else if (line.starts_with(program + " ")) {
      commands.push_back(line);
    } else {
      continue;
    }
    continued = line.ends_with("\\");
  }
  return commands;
}

// A reader types these one after the other from the top of a clone, so that later ones use what earlier ones wrote.
TEST(Readme, EveryCommandRunsAsWritten) {
  const fs::path root = FRACFIT_SOURCE_DIR;
  const std::vector<std::string> commands = commands_of(root / "README.md", "fracfit");
  ASSERT_GE(commands.size(), 10u);
  const TemporaryFolder folder;
  fs::create_directory_symlink(root / "data", folder.path("data"));
  ::setenv("PATH", (fs::path(FRACFIT_PROGRAM).parent_path().string() + ":" + std::getenv("PATH")).c_str(), 1);
  for (const std::string& command : commands) {
    folder.write("command.sh", "cd '" + folder.path("") + "'\n" + command + "\n");
    const int status = std::system(("bash '" + folder.path("command.sh") + "' >'" + folder.path("output") + "' 2>'" +
                                    folder.path("error") + "' </dev/null")
                                       .c_str());
    EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << command << "\n" << content_of(folder.path("error"));
  }
}

}  // namespace
