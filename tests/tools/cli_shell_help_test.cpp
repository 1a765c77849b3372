// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <tuple>
#include <vector>

#include "run_program.hpp"

namespace {

std::vector<std::string> subcommand_names() {
  std::istringstream help(run_fracfit({"--help"}).output);
  std::vector<std::string> names;
  bool listed = false;
  for (std::string line; std::getline(help, line);) {
    if (line.ends_with(':') && line != "Options:" && line != "Examples:") listed = true;
    if (line.empty()) listed = false;
    std::smatch match;
    if (listed && std::regex_search(line, match, std::regex("^  ([a-z-]+( [a-z0-9]+)?)(  |$)")))
      names.push_back(match[1]);
  }
  return names;
}

std::vector<std::string> options_in_help(const std::string& subcommand) {
  std::vector<std::string> arguments = words_of(subcommand);
  arguments.emplace_back("--help");
  const std::string help = run_fracfit(arguments).output;
  const std::regex option("\n  (-[a-z],)?(--[a-z0-9-]+)");
  std::vector<std::string> names;
  for (auto it = std::sregex_iterator(help.begin(), help.end(), option); it != std::sregex_iterator(); ++it)
    names.push_back((*it)[2]);
  return names;
}

std::string shell(const std::string& command) {
  std::FILE* pipe = ::popen(command.c_str(), "r");
  std::string text;
  for (int c; pipe != nullptr && (c = std::fgetc(pipe)) != EOF;) text += static_cast<char>(c);
  return pipe != nullptr && ::pclose(pipe) == 0 ? text : "failed: " + text;
}

// What bash offers for the last of these words.
std::set<std::string> completed(const std::vector<std::string>& words) {
  const TemporaryFolder folder;
  std::string line = "source " + folder.write("fracfit.bash", run_fracfit({"completion"}).output) + "\nCOMP_WORDS=(";
  for (const std::string& word : words) line += "'" + word + "' ";
  line += ")\nCOMP_CWORD=" + std::to_string(words.size() - 1) + "\n_fracfit\nprintf '%s\\n' \"${COMPREPLY[@]}\"\n";
  std::istringstream lines(shell("bash " + folder.write("ask.bash", line)));
  std::set<std::string> offered;
  for (std::string word; std::getline(lines, word);) offered.insert(word);
  return offered;
}

TEST(ShellHelp, KnowsEverySubcommandAndOptionOfTheHelp) {
  const std::string manual = run_fracfit({"man"}).output;
  const std::set<std::string> offered = completed({"fracfit", ""});
  const std::vector<std::string> names = subcommand_names();
  ASSERT_GE(names.size(), 10U);
  for (const std::string& name : names) {
    SCOPED_TRACE(name);
    std::vector<std::string> words = words_of("fracfit " + name);
    EXPECT_TRUE(offered.count(words[1]));
    if (words.size() > 2) {
      EXPECT_TRUE(completed({"fracfit", words[1], ""}).count(words[2]));
    }
    words.emplace_back("--");
    const std::set<std::string> options = completed(words);
    const auto begin = manual.find("\n.SS " + std::regex_replace(name, std::regex("-"), "\\-") + "\n");
    ASSERT_NE(begin, std::string::npos);
    const std::string chapter = manual.substr(begin, manual.find("\n.SS ", begin + 1) - begin);
    for (const std::string& option : options_in_help(name)) {
      EXPECT_TRUE(options.count(option)) << option;
      EXPECT_NE(chapter.find(std::regex_replace(option, std::regex("-"), "\\-")), std::string::npos) << option;
    }
  }
}

TEST(ShellHelp, CompletesBeginningsAndChoices) {
  EXPECT_EQ(completed({"fracfit", "mitt"}), (std::set<std::string>{"mittag-leffler"}));
  EXPECT_EQ(completed({"fracfit", "orbits", "--longest"}), (std::set<std::string>{"--longest-period"}));
  EXPECT_EQ(completed({"fracfit", "simulate", "--motion", ""}), (std::set<std::string>{"dynamic", "static"}));
}

// The library lists in its message what it takes, so that the two can be compared.
TEST(ShellHelp, OffersTheWordsThatAreAccepted) {
  for (const auto& [subcommand, option, some] : std::vector<std::tuple<std::string, std::string, std::string>>{
           {"approximate", "--method", "oustaloup-widened"},
           {"approximate", "--discretisation", "al-alaoui"},
           {"basins", "--body", "x2"},
           {"batch", "--format", "jsonl"},
           {"controller", "--anti-windup", "back-calculation"},
           {"controller", "--precision", "float"},
           {"fit", "--component", "magnitude"},
           {"fit", "--format", "table"},
           {"fit", "--grow", "arcs"},
           {"fit", "--hold", "first-order"},
           {"fit", "--loss", "cauchy"},
           {"fit", "--realisation", "grunwald-letnikov"},
           {"identify-scene", "--weight", "given"},
           {"jump-law", "--criterion", "saddle-node"},
           {"map", "--protocol", "mid-gap-at-rest"},
           {"orbits", "--parameter", "clearance"},
           {"realise", "--form", "balanced"},
           {"realise", "--method", "term-by-term"},
           {"respond", "--method", "bdf2"},
           {"simulate", "--protocol", "two-impact"},
           {"tune", "--minimise", "itae"},
           {"tune", "--structure", "pd"}}) {
    SCOPED_TRACE(subcommand + " " + option);
    const std::set<std::string> words = completed({"fracfit", subcommand, option, ""});
    EXPECT_TRUE(words.count(some));
    const auto refused = run_fracfit({subcommand, option, "no-such-word"});
    EXPECT_EQ(refused.code, 2);
    const auto list = refused.error.find("'no-such-word' is not allowed; expected ");
    ASSERT_NE(list, std::string::npos) << refused.error;
    const std::string expected = refused.error.substr(list);
    const std::string help = std::regex_replace(run_fracfit({subcommand, "--help"}).output, std::regex("\\s+"), " ");
    for (const std::string& word : words) {
      EXPECT_NE(expected.find(word), std::string::npos) << word;
      EXPECT_NE(help.find(word), std::string::npos) << word;
    }
  }
}

TEST(ShellHelp, OffersWordsBesideFilesAndOtherText) {
  EXPECT_EQ(completed({"fracfit", "fit", "--weight", "r"}), (std::set<std::string>{"relative", "repeats"}));
  EXPECT_EQ(completed({"fracfit", "respond", "--input", "s"}), (std::set<std::string>{"step", "sine"}));
  EXPECT_EQ(completed({"fracfit", "fit", "--model", "two-z"}), (std::set<std::string>{"two-zarc"}));
  const TemporaryFolder folder;
  const std::string file = folder.write("signal.csv", "");
  const std::string beginning = file.substr(0, file.size() - 4);
  EXPECT_EQ(completed({"fracfit", "respond", "--input", beginning}), (std::set<std::string>{file}));
}

TEST(ShellHelp, ManualPageIsDated) {
  const std::string manual = run_fracfit({"man"}).output;
  EXPECT_TRUE(std::regex_search(manual, std::regex("^\\.TH FRACFIT 1 \"20[0-9]{2}-[01][0-9]-[0-3][0-9]\" \"fracfit ")))
      << manual.substr(0, 80);
}

TEST(ShellHelp, ManualPageIsSoundTroff) {
  if (shell("groff --version").rfind("failed", 0) == 0) GTEST_SKIP() << "groff is not installed";
  const TemporaryFolder folder;
  EXPECT_EQ(shell("groff -man -ww -z " + folder.write("fracfit.1", run_fracfit({"man"}).output) + " 2>&1"), "");
}

}  // namespace
