// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include "project/page_blocks.hpp"
#include "tools/run_program.hpp"
#include "tools/temporary_folder.hpp"

namespace {

namespace fs = std::filesystem;

const fs::path root = FRACFIT_SOURCE_DIR;

/// A folder as a reader has it before him: `data` of the clone in it, and fracfit on the path.
class ReadersFolder {
 public:
  ReadersFolder() { fs::create_directory_symlink(root / "data", folder_.path("data")); }

  void save(const std::string& name, const std::string& content) const { folder_.write(name, content); }

  /// Runs a command with standard output on a terminal, and leaves in `text` what was printed there, after what was
  /// printed on standard error.  Standard error is a file, so that no progress bar is drawn.
  int run(const std::string& command, std::string& text) const {
    const char* path = std::getenv("PATH");
    ProgramSetting setting;
    setting.search_path = fs::path(FRACFIT_PROGRAM).parent_path().string() + ":" + (path == nullptr ? "" : path);
    setting.terminal_output = true;
    setting.environment.emplace_back("NO_COLOR", "1");
    const ProgramResult result = run_program("/bin/bash", {"-c", "cd '" + folder_.path() + "'\n" + command}, setting);
    text = result.error + result.output;
    std::erase(text, '\r');
    return result.code;
  }

 private:
  TemporaryFolder folder_;
};

/// Lines without those that are empty at the end.
std::vector<std::string> lines_of(const std::string& text) {
  std::istringstream stream(text);
  std::vector<std::string> lines;
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  while (!lines.empty() && lines.back().find_first_not_of(" \t") == std::string::npos) lines.pop_back();
  return lines;
}

std::vector<std::string> pages_with_commands() {
  std::vector<std::string> pages;
  for (const auto& entry : fs::recursive_directory_iterator(root / "tools/docs")) {
    if (entry.path().extension() == ".md" && !read_page(entry.path()).steps.empty()) {
      pages.push_back(fs::relative(entry.path(), root).string());
    }
  }
  std::sort(pages.begin(), pages.end());
  return pages;
}

class Pages : public testing::TestWithParam<std::string> {};

// A reader types the commands of a page one after the other, so that later ones use what earlier ones wrote.
TEST_P(Pages, ShowWhatTheProgramPrints) {
  if (!has_terminals()) GTEST_SKIP() << "no pseudo-terminals here";
  const Page page = read_page(root / GetParam());
  const ReadersFolder folder;
  for (const PageStep& step : page.steps) {
    if (!step.file.empty()) {
      folder.save(step.file, step.content);
      continue;
    }
    std::string text;
    const int status = folder.run(step.command, text);
    EXPECT_EQ(status, 0) << GetParam() << ":" << step.line << ": " << step.command << "\n" << text;
    const std::string wrong = difference(step.expected, lines_of(text), step.tolerance);
    EXPECT_TRUE(wrong.empty()) << GetParam() << ":" << step.line << ": " << step.command << "\n" << wrong;
  }
}

// What the prose of a tutorial says in decimals stands in one of its blocks, which the test above compares: in a
// command, in a file, or in what was printed, there possibly with more digits.
TEST_P(Pages, SayInProseWhatTheirBlocksShow) {
  if (!GetParam().starts_with("tools/docs/tutorials/")) GTEST_SKIP() << "no tutorial";
  const Page page = read_page(root / GetParam());
  std::string blocks;
  for (const PageStep& step : page.steps) {
    blocks += step.command + "\n" + step.content + "\n";
    for (const std::string& line : step.expected) blocks += line + "\n";
  }
  const std::vector<PrintedNumber> shown = decimal_numbers(blocks);
  for (const auto& [line, text] : page.prose) {
    for (const PrintedNumber& number : decimal_numbers(text)) {
      // Half a unit of rounding, and one unit of the last digit shown, in which the block itself may be off.
      const bool found = std::any_of(shown.begin(), shown.end(), [&](const PrintedNumber& other) {
        return std::abs(other.value - number.value) <= 0.5001 * number.unit + 0.0001 * other.unit;
      });
      EXPECT_TRUE(found) << GetParam() << ":" << line << ": " << number.text << " stands in no block of the page";
    }
  }
}

INSTANTIATE_TEST_SUITE_P(All, Pages, testing::ValuesIn(pages_with_commands()), [](const auto& page) {
  std::string name = fs::path(page.param).stem().string();
  std::replace_if(
      name.begin(), name.end(), [](char c) { return std::isalnum(static_cast<unsigned char>(c)) == 0; }, '_');
  return name;
});

/// Targets of the links and pictures of a page, without anchors; addresses in the web left out.
std::vector<std::string> links_of(const fs::path& page) {
  static const std::regex link(R"(\]\(([^)#:]+)(#[^)]*)?\)|^```\{(?:figure|image|include|literalinclude)\} (\S+))");
  std::istringstream lines(content_of(page.string()));
  std::vector<std::string> targets;
  for (std::string line; std::getline(lines, line);) {
    for (std::sregex_iterator match(line.begin(), line.end(), link), end; match != end; ++match) {
      targets.push_back((*match)[1].matched ? (*match)[1].str() : (*match)[3].str());
    }
  }
  return targets;
}

std::vector<fs::path> all_pages() {
  std::vector<fs::path> pages{root / "README.md", root / "CONTRIBUTING.md"};
  for (const auto& entry : fs::recursive_directory_iterator(root / "tools/docs")) {
    if (entry.path().extension() == ".md") pages.push_back(entry.path());
  }
  return pages;
}

// A paragraph that counts errors and links to the page where they were counted says what that page says.
TEST(Rates, InProseStandOnThePageThatIsLinked) {
  const std::regex link(R"(\]\(([^)\s]*(?:rates|coverage)\.md)\))"), count(R"(\b(none|\d+) of (\d+)\b)");
  int compared = 0;
  for (const fs::path& page : all_pages()) {
    std::istringstream lines(content_of(page.string()));
    std::string paragraph;
    for (std::string line; std::getline(lines, line) || !paragraph.empty(); line.clear()) {
      if (!line.empty()) {
        paragraph += line + " ";
        continue;
      }
      std::string linked;
      for (std::sregex_iterator it(paragraph.begin(), paragraph.end(), link), end; it != end; ++it)
        linked += content_of((page.parent_path() / (*it)[1].str()).string());
      for (std::sregex_iterator it(paragraph.begin(), paragraph.end(), count), end; !linked.empty() && it != end;
           ++it) {
        const std::string part = (*it)[1], whole = (*it)[2], number = part == "none" ? "0" : part;
        const auto stands = [&](const std::string& text) { return linked.find(text + whole) != std::string::npos; };
        EXPECT_TRUE(stands(part + " of ") || stands(number + " of ") || stands(number + "/") ||
                    stands(part + " of the "))
            << page << ": " << (*it)[0];
        ++compared;
      }
      paragraph.clear();
    }
  }
  EXPECT_GT(compared, 5);
}

// The site refuses a section that lies more than one level below the section around it.
TEST(Headings, LeaveNoLevelOut) {
  for (const fs::path& page : all_pages()) {
    std::istringstream lines(content_of(page.string()));
    bool in_block = false;
    std::size_t level = 0;
    for (std::string line; std::getline(lines, line);) {
      if (line.starts_with("```")) in_block = !in_block;
      const std::size_t marks = line.find_first_not_of('#');
      if (in_block || marks == 0 || marks == std::string::npos || line[marks] != ' ') continue;
      EXPECT_LE(marks, level + 1) << page << ": " << line;
      level = marks;
    }
    EXPECT_GE(level, 1u) << page << " has no title";
  }
}

// Pages under reference/ are made by tools/make-docs: those of the commands from their help, those of C++ from the
// headers; pictures under gallery/ are drawn by it, from what the commands of the page write.
TEST(Links, LeadToFilesThatExist) {
  std::size_t links = 0;
  for (const fs::path& page : all_pages()) {
    for (const std::string& target : links_of(page)) {
      ++links;
      const fs::path path = (page.parent_path() / target).lexically_normal();
      const std::string made = path.lexically_relative(root / "tools/docs/reference").string();
      if (target.starts_with("gallery/")) continue;
      if (made.starts_with("commands/") || made == "cpp/index.rst") continue;
      bool found = fs::exists(path);
      if (made.starts_with("cpp/")) {
        const fs::path header = fs::path(made.substr(4)).replace_extension(".hpp");
        found = fs::exists(root / "libfrac/include" / header) || fs::exists(root / "libbacklash/include" / header);
      }
      EXPECT_TRUE(found) << page << ": " << target;
    }
  }
  EXPECT_GE(links, 50u);
}

class ShellBlocks : public testing::TestWithParam<std::string> {};

// These, too, are typed one after the other; what they print is not shown.
TEST_P(ShellBlocks, EveryCommandRunsAsWritten) {
  if (!has_terminals()) GTEST_SKIP() << "no pseudo-terminals here";
  const std::vector<std::string> commands = shell_commands(root / GetParam(), "fracfit");
  ASSERT_GE(commands.size(), 5u);
  const ReadersFolder folder;
  for (const std::string& command : commands) {
    std::string text;
    EXPECT_EQ(folder.run(command, text), 0) << command << "\n" << text;
  }
}

INSTANTIATE_TEST_SUITE_P(All, ShellBlocks, testing::Values("README.md", "tools/docs/recipes.md"),
                         [](const auto& page) { return fs::path(page.param).stem().string(); });

TEST(PageBlocks, DifferInNumbersByTheLastDigitShownAtMost) {
  EXPECT_EQ(difference({"rms  0.01230 V"}, {"rms 0.01231 V "}), "");
  EXPECT_EQ(difference({"a -1.500e-05 b"}, {"a -1.501e-05 b"}), "");
  EXPECT_EQ(difference({"rms 0.012... V"}, {"rms 0.0123456 V"}), "");
  EXPECT_NE(difference({"rms 0.01230"}, {"rms 0.01232"}), "");
  EXPECT_NE(difference({"rms 0.012"}, {"rms 0.013"}), "");
  EXPECT_NE(difference({"rms 0.012... V"}, {"rms 0.0143 V"}), "");
  EXPECT_NE(difference({"rms 1.5e-05"}, {"rms 1.5e-06"}), "");
  EXPECT_NE(difference({"57 points"}, {"58 points"}), "");
  EXPECT_NE(difference({"R1 0.5"}, {"R2 0.5"}), "");
  EXPECT_NE(difference({"0.5 V"}, {"0.5 A"}), "");
}

TEST(PageBlocks, AreComparedByValueToTheirTolerance) {
  EXPECT_EQ(difference({"a = 0.30756044512,"}, {"a = 0.307560445,"}), "");
  EXPECT_NE(difference({"a = 0.30756044512"}, {"a = 0.307560455"}), "");
  EXPECT_EQ(difference({"1.5e-05"}, {"0.000015"}), "");
  EXPECT_EQ(difference({"0.5 V"}, {"0.5004 V"}, 1e-3), "");
  EXPECT_NE(difference({"0.5 V"}, {"0.5006 V"}, 1e-3), "");
}

TEST(PageBlocks, MayBreakTheirLinesElsewhere) {
  EXPECT_EQ(difference({"a sentence that", "  is wrapped, 0.4108 s"}, {"a sentence", "that is wrapped, 0.4108", "s"}),
            "");
  EXPECT_NE(difference({"a sentence that", "is wrapped"}, {"a sentence thatis wrapped"}), "");
}

TEST(PageBlocks, DifferNotWhereDotsStand) {
  EXPECT_EQ(difference({"done in ... s", "end"}, {"done in 0.03 s", "end"}), "");
  EXPECT_EQ(difference({"...", "b", "..."}, {"a", "b", "c", "d"}), "");
  EXPECT_EQ(difference({"x ... y z"}, {"x y y y z"}), "");
  EXPECT_EQ(difference({"a", "..."}, {"a"}), "");
  EXPECT_NE(difference({"...", "e"}, {"a", "b"}), "");
  EXPECT_NE(difference({"x ... y z"}, {"x y z y"}), "");
  EXPECT_NE(difference({"a"}, {"a", "b"}), "");
  EXPECT_NE(difference({"a", "b"}, {"a"}), "");
  EXPECT_NE(difference({}, {"a"}), "");
}

TEST(PageBlocks, AreReadWithFilesAndContinuedLines) {
  const TemporaryFolder folder;
  const Page page = read_page(folder.write("page.md",
                                           "Text 0.5\n```console\n$ a \\\n>   b\nout\n$ c\n```\n"
                                           "<!-- numbers to 1e-3: chaotic -->\n```console\n$ d\n```\n"
                                           "```{code-block} c\n:caption: x.c\n\nint x;\n```\n"));
  ASSERT_EQ(page.steps.size(), 4u);
  EXPECT_EQ(page.steps[0].command, "a \\\n  b");
  EXPECT_EQ(page.steps[0].expected, std::vector<std::string>{"out"});
  EXPECT_EQ(page.steps[1].command, "c");
  EXPECT_EQ(page.steps[1].tolerance, 1e-8);
  EXPECT_EQ(page.steps[2].command, "d");
  EXPECT_EQ(page.steps[2].tolerance, 1e-3);
  EXPECT_EQ(page.steps[3].file, "x.c");
  EXPECT_EQ(page.steps[3].content, "int x;\n");
  EXPECT_EQ(page.prose.size(), 1u);
}

}  // namespace
