// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <regex>
#include <set>
#include <sstream>
#include <string>

#include "tools/temporary_folder.hpp"

namespace {

namespace fs = std::filesystem;

std::set<std::string> names_of_all_tests() {
  const std::regex macro(R"(\bTEST(?:_P|_F)?\(\s*(\w+),\s*(\w+)\))");
  std::set<std::string> names;
  for (const auto& entry : fs::recursive_directory_iterator(fs::path(FRACFIT_SOURCE_DIR) / "tests")) {
    if (entry.path().extension() != ".cpp") continue;
    const std::string text = content_of(entry.path());
    for (std::sregex_iterator at(text.begin(), text.end(), macro), end; at != end; ++at) {
      names.insert((*at)[1].str() + "." + (*at)[2].str());
    }
  }
  return names;
}

TEST(Promises, NameTestsThatExist) {
  const std::string page = content_of(fs::path(FRACFIT_SOURCE_DIR) / "tools/docs/promises.md");
  const std::set<std::string> known = names_of_all_tests();
  const std::regex bracket(R"(\[([A-Z][^\]`]*)\])");
  const std::regex name(R"([A-Za-z]+\.[A-Z]\w+)");
  std::size_t named = 0;
  for (std::sregex_iterator at(page.begin(), page.end(), bracket), end; at != end; ++at) {
    const std::string list = (*at)[1];
    for (std::sregex_iterator each(list.begin(), list.end(), name); each != end; ++each) {
      ++named;
      EXPECT_TRUE(known.contains(each->str())) << each->str() << " stands in promises.md and is no test";
    }
  }
  EXPECT_GE(named, 30u);  // the patterns have found the names
}

}  // namespace
