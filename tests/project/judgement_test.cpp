// SPDX-License-Identifier: BSD-3-Clause
// The page of the constants between data and verdict lists those of the sources, with their values and files.
#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "tools/temporary_folder.hpp"

namespace {

namespace fs = std::filesystem;

/// Arithmetic constants of a source, name to value; several may stand in one declaration.
std::map<std::string, std::string> constants_in(const std::string& source) {
  const std::regex declaration(R"(constexpr (?:double|int|std::size_t) ([a-z_]+ = [^;]+);)");
  const std::regex one(R"(([a-z_]+) = ([^,]+))");
  std::map<std::string, std::string> found;
  for (std::sregex_iterator at(source.begin(), source.end(), declaration), end; at != end; ++at) {
    const std::string names = (*at)[1];
    for (std::sregex_iterator each(names.begin(), names.end(), one); each != end; ++each) {
      const std::string value = (*each)[2];
      if (!value.starts_with("std::")) found[(*each)[1]] = value;  // infinity and not a number
    }
  }
  return found;
}

std::vector<fs::path> judging_sources() {
  const fs::path folder = fs::path(FRACFIT_SOURCE_DIR) / "libfrac/src/identification";
  std::vector<fs::path> files;
  for (const char* each : {"identify.cpp", "statistics/assumption_evidence.hpp", "statistics/correlated_noise.cpp",
                           "statistics/residual_tests.hpp", "statistics/residual_tests.cpp",
                           "rational/family_members.hpp", "rational/family_members.cpp"})
    files.push_back(folder / each);
  for (const auto& entry : fs::directory_iterator(folder / "verdict")) files.push_back(entry.path());
  return files;
}

TEST(Judgement, EveryConstantStandsOnThePageWithItsValue) {
  const std::string page = content_of(fs::path(FRACFIT_SOURCE_DIR) / "tools/docs/judgement.md");
  std::map<std::string, std::string> judging, place;
  const std::regex row(R"(\| `([a-z_]+)` \| ([^ |]+) \| [^|\n]+ \| [^|\n]+ \| `([a-z_/.]+)` \|)");
  for (std::sregex_iterator at(page.begin(), page.end(), row), end; at != end; ++at) {
    judging[(*at)[1]] = (*at)[2];
    place[(*at)[1]] = (*at)[3];
  }
  const std::string rest = page.substr(page.find("Numbers in the same files"));
  std::set<std::string> others;
  const std::regex name("`([a-z_]+)`");
  for (std::sregex_iterator at(rest.begin(), rest.end(), name), end; at != end; ++at) others.insert((*at)[1]);

  std::set<std::string> seen;
  for (const fs::path& file : judging_sources()) {
    for (const auto& [constant, value] : constants_in(content_of(file))) {
      seen.insert(constant);
      if (others.contains(constant)) continue;
      ASSERT_TRUE(judging.contains(constant)) << constant << " of " << file << " stands on no page";
      EXPECT_EQ(std::stod(value), std::stod(judging[constant])) << constant << " of " << file;
      EXPECT_TRUE(file.generic_string().ends_with("identification/" + place[constant])) << constant << " of " << file;
    }
  }
  for (const auto& [constant, value] : judging) EXPECT_TRUE(seen.contains(constant)) << constant << " is in no source";
  for (const std::string& constant : others) EXPECT_TRUE(seen.contains(constant)) << constant << " is in no source";
  // Few rules: each number can be tuned to files that were seen.
  EXPECT_LE(judging.size(), 60U);
}

}  // namespace
