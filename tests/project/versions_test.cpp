// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <regex>
#include <sstream>
#include <string>

namespace {

const std::filesystem::path root = FRACFIT_SOURCE_DIR;

/// The parts of the first place in a file that the pattern fits; empty ones where there is none.
std::smatch first_match(const std::string& file, const std::string& pattern, std::string& content) {
  std::ifstream stream(root / file);
  content = std::string(std::istreambuf_iterator<char>(stream), {});
  std::smatch match;
  EXPECT_TRUE(std::regex_search(content, match, std::regex(pattern))) << pattern << " stands nowhere in " << file;
  return match;
}

// A release has one version and one date wherever they are told.  Between two releases the program, the packages and
// the changelog name the next one, and what is cited is the last.
TEST(Versions, AreTheSameWhereverTheyAreTold) {
  std::string cmake, changelog, packages, citation;
  const auto project = first_match("CMakeLists.txt", R"(project\(fracfit VERSION ([0-9.]+))", cmake);
  const bool is_release = cmake.find("set(FRACFIT_VERSION ${PROJECT_VERSION})") != std::string::npos;
  EXPECT_TRUE(is_release || cmake.find("set(FRACFIT_VERSION ${PROJECT_VERSION}-dev)") != std::string::npos);
  const std::string version = project[1];

  const auto newest = first_match("CHANGELOG.md", R"(\n## ([0-9.]+) - (\S+)\n)", changelog);
  EXPECT_EQ(newest[1], version);
  EXPECT_EQ(newest[2] == "unreleased", !is_release);
  const auto package = first_match("tools/packaging/debian/changelog", R"(^fracfit \(([^)]+)\))", packages);
  EXPECT_EQ(package[1], version + (is_release ? "-1" : "~dev-1"));
  // The package of the shared library carries the number of its interface, MAJOR.MINOR.
  std::string control;
  const auto library =
      first_match("tools/packaging/debian/control", R"(\nPackage: libfracfit(\S+)\nSection: libs\n)", control);
  EXPECT_EQ(library[1], version.substr(0, version.rfind('.')));

  std::string releases;
  const auto released = first_match("CHANGELOG.md", R"(\n## ([0-9.]+) - ([0-9-]+)\n)", releases);
  const auto cited = first_match("CITATION.cff", R"(version: ([0-9.]+)\ndate-released: ([0-9-]+))", citation);
  EXPECT_EQ(cited[1], released[1]);
  EXPECT_EQ(cited[2], released[2]);
  EXPECT_TRUE(!is_release || cmake.find("set(FRACFIT_DATE " + released[2].str() + ")") != std::string::npos);
}

}  // namespace
