// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <filesystem>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "tools/temporary_folder.hpp"

namespace {

namespace fs = std::filesystem;

std::vector<fs::path> public_headers() {
  std::vector<fs::path> headers;
  for (const char* folder : {"libfrac/include", "libbacklash/include"})
    for (const auto& entry : fs::recursive_directory_iterator(fs::path(FRACFIT_SOURCE_DIR) / folder))
      if (entry.path().extension() == ".hpp") headers.push_back(entry.path());
  return headers;
}

/// Texts of the structs of a header, from their name to their closing brace at the margin.
std::vector<std::string> structs_of(const std::string& text) {
  std::vector<std::string> found;
  std::istringstream lines(text);
  bool inside = false;
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("struct ") && line.ends_with("{")) {
      found.emplace_back();
      inside = true;
    }
    if (inside) found.back() += line + "\n";
    if (line == "};") inside = false;
  }
  return found;
}

// A result with a message carries a judgement: a caller has to be able to ask for it and to show it without reading the
// header.  Entries of a table of jumps are no results by themselves.
TEST(PublicHeaders, ResultsSayWhetherTheyAreUsable) {
  const std::set<std::string> entries = {"JumpFrequency", "JumpConstant"};
  std::size_t results = 0;
  for (const fs::path& header : public_headers()) {
    for (const std::string& text : structs_of(content_of(header))) {
      if (text.find("std::string message") == std::string::npos) continue;
      std::smatch name;
      ASSERT_TRUE(std::regex_search(text, name, std::regex(R"(^struct (\w+))")));
      if (entries.contains(name[1])) continue;
      ++results;
      EXPECT_NE(text.find(" usable() const"), std::string::npos) << header << ": " << name[1];
      EXPECT_NE(text.find(" summary() const"), std::string::npos) << header << ": " << name[1];
    }
  }
  EXPECT_GT(results, 10U);
}

// A comment behind a member that goes on in the next line tears the declarations apart.
TEST(PublicHeaders, LongCommentsStandAboveTheirMember) {
  const std::regex behind(R"(^\s*[^\s/].*\s//.*$)"), alone(R"(^\s+//(?!/).*$)");
  for (const fs::path& header : public_headers()) {
    std::istringstream lines(content_of(header));
    std::string line, last;
    for (std::size_t number = 1; std::getline(lines, line); last = line, ++number) {
      EXPECT_FALSE(std::regex_match(last, behind) && std::regex_match(line, alone) &&
                   line.find("//") == last.find("//", last.find_first_not_of(' ')))
          << header << ":" << number << ": " << line;
      EXPECT_EQ(line.find("///<"), std::string::npos) << header << ":" << number << ": " << line;
    }
  }
}

}  // namespace
