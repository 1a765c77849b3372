// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
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

/// Members of a struct by its text, from the declarations at its own level.
std::set<std::string> members_of(const std::string& text) {
  std::set<std::string> members;
  std::istringstream lines(std::regex_replace(text, std::regex(R"(//.*)"), ""));
  const std::regex declaration(R"(^  ([\w:]+(<.*>)?) ([\w ,={}.()-]+);)");
  for (std::string line; std::getline(lines, line);) {
    std::smatch found;
    if (!std::regex_search(line, found, declaration)) continue;
    std::istringstream names(std::regex_replace(found[3].str(), std::regex(R"( = [^,]*)"), ""));
    for (std::string name; names >> name;) members.insert(name.substr(0, name.find(',')));
  }
  return members;
}

// A number that a result has and its description does not name is in no output.
TEST(PublicHeaders, EveryMemberOfADescribedResultIsDescribed) {
  // Front ends give these a form of their own.
  const std::set<std::string> exempt = {"FitResult::advice",
                                        "RankedFit::model",
                                        "IdentificationResult::advice",
                                        "IdentificationResult::chosen",
                                        "IdentificationResult::distribution",
                                        "IdentificationResult::fractional",
                                        "IdentificationResult::integer",
                                        "IdentificationResult::differ_most",
                                        "IdentificationResult::differ_most_omega",
                                        "IdentificationResult::next",
                                        "IdentificationResult::set_aside",
                                        "Finalist::index",
                                        "JointFitResult::half_width",
                                        "JointFitResult::priors",
                                        "JointCurveResult::priors",
                                        "JointCurveResult::covariance_with_laws",
                                        "ScenePoint::index",
                                        "BodiesIdentification::bodies"};
  std::map<std::string, std::string> structs;
  std::string descriptions;
  for (const fs::path& header : public_headers()) {
    const std::string content = content_of(header);
    if (header.filename() == "describe.hpp") descriptions += content;
    for (const std::string& text : structs_of(content)) structs[text.substr(7, text.find_first_of(" {", 7) - 7)] = text;
  }
  const std::regex head(R"(ResultOf<(?:Result, )?(\w+)>)"), used(R"(result\.(\w+))");
  std::size_t described = 0;
  for (std::size_t begin = descriptions.find("template <"); begin < descriptions.size();) {
    const std::size_t end = std::min(descriptions.find("\n}\n", begin), descriptions.size());
    const std::string text = descriptions.substr(begin, end - begin);
    const std::set<std::string> named = [&] {
      std::set<std::string> names;
      for (std::sregex_iterator each(text.begin(), text.end(), used), none; each != none; ++each)
        names.insert((*each)[1]);
      return names;
    }();
    const std::string before = text.substr(0, text.find("void describe("));
    for (std::sregex_iterator of(before.begin(), before.end(), head), none; of != none; ++of) {
      const std::string name = (*of)[1];
      ++described;
      for (const std::string& member : members_of(structs[name]))
        EXPECT_NE(named.contains(member), exempt.contains(name + "::" + member)) << name << "::" << member;
    }
    begin = descriptions.find("template <", end);
  }
  EXPECT_GT(described, 15U);
}

}  // namespace
