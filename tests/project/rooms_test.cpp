// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <optional>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include "tools/temporary_folder.hpp"

namespace {

namespace fs = std::filesystem;

/// Rooms of a library in the order of the table in its README.md, and the room of each public header named there.  A
/// header folder such as `model/` stands for all headers in it.
struct Rooms {
  std::vector<std::string> order;
  std::map<std::string, std::string> room_of_public;  // "mittag_leffler.hpp" or "model/" -> room
};

Rooms rooms_in(const std::string& readme) {
  Rooms rooms;
  const std::regex row(R"(\| `([a-z_/]+)` \|[^|]*\|([^|]*)\|)");
  const std::regex name(R"(`([a-z_/.]+)`)");
  std::istringstream lines(readme);
  std::smatch match;
  for (std::string line; std::getline(lines, line);) {
    if (!std::regex_match(line, match, row)) continue;
    rooms.order.push_back(match[1]);
    const std::string headers = match[2];
    for (std::sregex_iterator at(headers.begin(), headers.end(), name), end; at != end; ++at) {
      rooms.room_of_public[(*at)[1]] = match[1];
    }
  }
  return rooms;
}

/// Room of a path below src/: the longest room name that is a folder of the path.
std::optional<std::string> room_of_source(const Rooms& rooms, const std::string& path) {
  std::optional<std::string> room;
  for (const std::string& each : rooms.order) {
    if (path.starts_with(each + "/") && (!room || each.size() > room->size())) room = each;
  }
  return room;
}

/// Room of a path below include/<name>/.
std::optional<std::string> room_of_header(const Rooms& rooms, const std::string& path) {
  const auto slash = path.find('/');
  const auto found = rooms.room_of_public.find(slash == std::string::npos ? path : path.substr(0, slash + 1));
  if (found == rooms.room_of_public.end()) return std::nullopt;
  return found->second;
}

class Library : public testing::TestWithParam<std::pair<const char*, const char*>> {
 protected:
  const fs::path root_ = fs::path(FRACFIT_SOURCE_DIR) / GetParam().first;
  const std::string name_ = GetParam().second;
  const Rooms rooms_ = rooms_in(content_of(root_ / "README.md"));

  std::vector<fs::path> files() const {
    std::vector<fs::path> files;
    for (const char* folder : {"include", "src"}) {
      for (const auto& entry : fs::recursive_directory_iterator(root_ / folder)) {
        const auto extension = entry.path().extension();
        if (extension == ".hpp" || extension == ".cpp") files.push_back(entry.path());
      }
    }
    return files;
  }

  std::optional<std::string> room_of(const fs::path& file) const {
    const fs::path header = file.lexically_relative(root_ / "include" / name_);
    if (!header.empty() && *header.begin() != "..") return room_of_header(rooms_, header.generic_string());
    return room_of_source(rooms_, file.lexically_relative(root_ / "src").generic_string());
  }

  /// The file of this library that an include of `file` names, if it is one.
  std::optional<fs::path> included(const fs::path& file, const std::string& name) const {
    for (const fs::path& at : {file.parent_path() / name, root_ / "src" / name, root_ / "include" / name}) {
      if (fs::exists(at)) return at.lexically_normal();
    }
    return std::nullopt;
  }

  std::ptrdiff_t place(const std::string& room) const {
    return std::find(rooms_.order.begin(), rooms_.order.end(), room) - rooms_.order.begin();
  }
};

TEST_P(Library, EveryFileStandsInARoomOfTheReadme) {
  ASSERT_GE(rooms_.order.size(), 4u);
  for (const fs::path& file : files()) EXPECT_TRUE(room_of(file)) << file << " is in no room of README.md";
}

TEST_P(Library, ARoomIncludesOnlyTheRoomsAboveIt) {
  const std::regex include(R"rx(^\s*#include\s+["<]([^">]+)[">])rx");
  std::size_t checked = 0;
  for (const fs::path& file : files()) {
    const auto room = room_of(file);
    if (!room) continue;
    std::istringstream lines(content_of(file));
    std::smatch match;
    for (std::string line; std::getline(lines, line);) {
      if (!std::regex_search(line, match, include)) continue;
      const auto target = included(file, match[1]);
      if (!target) continue;
      const auto other = room_of(*target);
      if (!other) continue;
      ++checked;
      EXPECT_LE(place(*other), place(*room))
          << file << " (room " << *room << ") includes " << match[1] << " of the room " << *other << " below it";
    }
  }
  EXPECT_GT(checked, 100u);  // the pattern has found the includes
}

// What helps is a value (frac::Advice) that each front end says in its own words; the libraries have other front ends
// than the command line.
TEST_P(Library, NamesNoOptionOfTheCommandLine) {
  const std::regex option(R"rx("([^"]*[^-"])?--[a-z][a-z-]+)rx");
  for (const fs::path& file : files()) {
    std::istringstream lines(content_of(file));
    for (std::string line; std::getline(lines, line);)
      EXPECT_FALSE(std::regex_search(line, option)) << file << ": " << line;
  }
}

TEST_P(Library, EveryHeaderNamedInTheReadmeExists) {
  for (const auto& [header, room] : rooms_.room_of_public) {
    EXPECT_TRUE(fs::exists(root_ / "include" / name_ / header)) << header << " of the room " << room;
  }
}

// A newcomer opens what a page names.  A bare name stands beside one with its folder, so the end of a path suffices;
// what begins at the root of the project or of the library does so in full.
TEST(Readmes, NameFilesThatExist) {
  const fs::path root(FRACFIT_SOURCE_DIR);
  std::vector<std::string> paths;
  for (const char* folder : {"libfrac", "libbacklash", "tools", "tests"})
    for (const auto& entry : fs::recursive_directory_iterator(root / folder))
      if (entry.is_regular_file()) paths.push_back("/" + entry.path().lexically_relative(root).generic_string());
  const std::regex name("`([A-Za-z0-9_/]+\\.[ch]pp)`");
  std::size_t checked = 0;
  for (const char* page :
       {"CONTRIBUTING.md", "libfrac/README.md", "libbacklash/README.md", "tools/README.md", "tests/README.md"}) {
    const std::string text = content_of(root / page);
    for (std::sregex_iterator at(text.begin(), text.end(), name), end; at != end; ++at, ++checked) {
      const std::string file = "/" + (*at)[1].str();
      EXPECT_TRUE(std::any_of(paths.begin(), paths.end(), [&](const auto& path) { return path.ends_with(file); }))
          << page << ": " << file;
    }
  }
  EXPECT_GT(checked, 50u);
}

// The rooms of the program stand in order in the line of tools/README.md that tells what tools/fracfit holds.
TEST(Program, ARoomIncludesOnlyTheRoomsBeforeIt) {
  const fs::path root = fs::path(FRACFIT_SOURCE_DIR) / "tools";
  const std::string readme = content_of(root / "README.md");
  const auto row = readme.find("\n| `fracfit` |");
  ASSERT_NE(row, std::string::npos);
  const std::string text = readme.substr(row, readme.find('\n', row + 1) - row);
  const std::regex name("`([a-z_]+)/`");
  std::vector<std::string> order;
  for (std::sregex_iterator at(text.begin(), text.end(), name), end; at != end; ++at) order.push_back((*at)[1]);
  ASSERT_GE(order.size(), 4u);
  const auto place = [&](const std::string& room) { return std::find(order.begin(), order.end(), room); };
  const std::regex include(R"rx(^\s*#include\s+"([a-z_]+)/)rx");
  std::size_t checked = 0;
  for (const auto& folder : fs::directory_iterator(root / "fracfit")) {
    if (!folder.is_directory()) continue;
    const auto room = place(folder.path().filename().string());
    EXPECT_NE(room, order.end()) << folder.path() << " is not in tools/README.md";
    for (const auto& file : fs::directory_iterator(folder)) {
      std::istringstream lines(content_of(file.path()));
      std::smatch match;
      for (std::string line; std::getline(lines, line);) {
        if (!std::regex_search(line, match, include) || place(match[1]) == order.end()) continue;
        ++checked;
        EXPECT_LE(place(match[1]), room) << file.path() << " includes " << match[1] << "/, which comes after it";
      }
    }
  }
  EXPECT_GT(checked, 100u);  // the pattern has found the includes
}

INSTANTIATE_TEST_SUITE_P(Rooms, Library,
                         testing::Values(std::pair{"libfrac", "frac"}, std::pair{"libbacklash", "backlash"}),
                         [](const auto& each) { return std::string(each.param.second); });

}  // namespace
