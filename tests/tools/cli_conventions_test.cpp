// SPDX-License-Identifier: BSD-3-Clause
// One command line: what every subcommand's help must keep, so that an option learnt once is known everywhere.
#include <gtest/gtest.h>

#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "run_program.hpp"

namespace {

struct OptionHelp {
  std::string type, text;  // text without line breaks
};

std::string help_of(const std::string& subcommand) {
  std::vector<std::string> arguments = words_of(subcommand);
  arguments.insert(arguments.begin(), "help");
  return run_fracfit(arguments).output;
}

std::vector<std::string> subcommands() {
  std::vector<std::string> names;
  const std::string help = run_fracfit({"--help"}).output;
  const std::regex entry("\n  ([a-z][a-z-]*( [a-z][a-z0-9]*)?) +[A-Z]");
  for (auto it = std::sregex_iterator(help.begin(), help.end(), entry); it != std::sregex_iterator(); ++it)
    names.push_back((*it)[1]);
  return names;
}

// Options of the help, the part between "Options:" and the empty line below.
std::map<std::string, OptionHelp> options_of(const std::string& subcommand) {
  std::istringstream help(help_of(subcommand));
  std::map<std::string, OptionHelp> options;
  OptionHelp* last = nullptr;
  bool listed = false;
  const std::regex heading("^  (-[a-z],)?(--[a-z0-9-]+)( [^ ]+)?( REQUIRED)?( +(.*))?$");
  for (std::string line; std::getline(help, line);) {
    std::smatch match;
    if (line == "Options:") {
      listed = true;
    } else if (line.empty()) {
      listed = false;
    } else if (listed && std::regex_match(line, match, heading)) {
      last = &options[match[2]];
      const std::string type = match[3];
      last->type = type.empty() ? type : type.substr(1);
      last->text = match[6];
    } else if (listed && last != nullptr) {
      last->text += (last->text.empty() ? "" : " ") + line.substr(line.find_first_not_of(' '));
    }
  }
  return options;
}

// What an option means, without the remark of one command, its words and its default.
std::string meaning(const std::string& text) {
  std::string plain = std::regex_replace(text, std::regex(" \\(default .*\\)$"), "");
  plain = plain.substr(0, plain.find(';'));
  return std::regex_replace(plain, std::regex(": [a-z0-9, -]+( or [a-z0-9-]+)?$"), "");
}

TEST(Conventions, OneNameHasOneMeaningUnitAndType) {
  std::map<std::string, std::pair<std::string, OptionHelp>> first;
  const auto names = subcommands();
  ASSERT_GE(names.size(), 20U);
  for (const std::string& name : names) {
    for (const auto& [option, help] : options_of(name)) {
      if ((name == "report" || name == "export arduino") && option == "--out") continue;  // a folder
      const auto [known, is_new] = first.try_emplace(option, name, help);
      if (is_new) continue;
      const auto& [other, expected] = known->second;
      EXPECT_EQ(help.type, expected.type) << option << " of " << name << " and " << other;
      EXPECT_EQ(meaning(help.text), meaning(expected.text)) << option << " of " << name << " and " << other;
    }
  }
}

TEST(Conventions, EveryCommandThatWritesDataHasOutAndFormat) {
  const std::set<std::string> pages{"completion", "man", "report", "export arduino"};
  for (const std::string& name : subcommands()) {
    if (pages.contains(name)) continue;
    const auto options = options_of(name);
    for (const char* option : {"--out", "--format", "--threads", "--quiet"})
      EXPECT_TRUE(options.contains(option)) << name << " has no " << option;
  }
}

TEST(Conventions, DefaultsStandAtTheEndInParentheses) {
  for (const std::string& name : subcommands()) {
    for (const auto& [option, help] : options_of(name)) {
      const auto place = help.text.find("default");
      if (place == std::string::npos) continue;
      EXPECT_EQ(help.text.substr(place - 1, 9), "(default ") << option << " of " << name;
      EXPECT_EQ(help.text.back(), ')') << option << " of " << name;
    }
  }
}

TEST(Conventions, TheHelpFitsAPageAndNamesExamples) {
  for (const std::string& name : subcommands()) {
    std::vector<std::string> arguments = words_of(name);
    arguments.emplace_back("--help");
    const std::string help = run_fracfit(arguments).output;
    EXPECT_NE(help.find("Example"), std::string::npos) << name;
    EXPECT_EQ(help, help_of(name));
    bool in_options = false;
    for (const std::string& line : lines_of(help)) {
      in_options = line == "Options:" || (in_options && !line.empty());
      if (in_options) {
        EXPECT_LE(line.size(), 100U) << name << ": " << line;
      }
    }
  }
}

// A name that has gone is refused like any other that is none, never taken for a similar one.
TEST(Conventions, NamesOfAnEarlierVersionAreRefused) {
  const std::vector<std::string> scene{"simulate",      "--force", "40",      "--clearance", "0.3",
                                       "--restitution", "0.6",     "--omega", "20"};
  const std::vector<std::string> tune{"tune", "--model", "1/(s + 1)"};
  const std::vector<std::string> controller{"controller", "--model", "s^-0.5", "--sample-time", "0.01"};
  const std::vector<std::pair<std::vector<std::string>, std::vector<std::string>>> gone{
      {scene, {"--m1", "2"}},         {scene, {"--m2", "2"}},
      {scene, {"--output", "x2"}},    {scene, {"--tolerance", "1e-9"}},
      {scene, {"--model", "static"}}, {tune, {"--plant", "1/(s + 1)"}},
      {tune, {"--criterion", "iae"}}, {controller, {"--horizon", "100"}}};
  for (const auto& [command, old] : gone) {
    std::vector<std::string> words = command;
    words.insert(words.end(), old.begin(), old.end());
    const auto result = run_fracfit(words);
    EXPECT_EQ(result.code, 2) << old.front();
    EXPECT_EQ(result.output, "") << old.front();
    EXPECT_NE(result.error.find("unknown option '" + old.front() + "'"), std::string::npos) << result.error;
  }
  const auto merge = run_fracfit({"merge", "not-there.csv", "1.csv", "2.csv"});
  EXPECT_EQ(merge.code, 2);
  EXPECT_NE(merge.error.find("--out is required"), std::string::npos) << merge.error;
}

TEST(Conventions, ListsOfTwoAreTakenAndDecimalCommasAreNot) {
  for (const std::string command : {"simulate", "map"}) {
    std::vector<std::string> arguments{command, "--force", "40", "--clearance",
                                       "0.3",   "--omega", "20", "--restitution"};
    arguments.emplace_back("0.5,0.6");
    EXPECT_EQ(run_fracfit(arguments).code, 0);
    arguments.back() = "0,6";
    const auto comma = run_fracfit(arguments);
    EXPECT_EQ(comma.code, 2);
    EXPECT_NE(comma.error.find("--restitution '0,6': expected one number with a decimal point"), std::string::npos)
        << comma.error;
  }
}

TEST(Conventions, AFormulaMayStandWithoutTheNameOfItsOption) {
  for (const std::vector<std::string>& rest : {std::vector<std::string>{"analyse"},
                                               {"respond", "--time", "1,2"},
                                               {"realise", "--band", "1:2", "--tolerance", "0.1"}}) {
    std::vector<std::string> with_name = rest, without = rest;
    with_name.insert(with_name.end(), {"--model", "1/(s + 2)"});
    without.insert(without.begin() + 1, "1/(s + 2)");
    const auto expected = run_fracfit(with_name);
    ASSERT_EQ(expected.code, 0) << expected.error;
    EXPECT_EQ(run_fracfit(without).output, expected.output);
  }
}

TEST(Conventions, AForgottenValueIsNamed) {
  const TemporaryFolder folder;
  const std::string out = folder.path("out");
  for (const auto& [words, said] : std::vector<std::pair<std::vector<std::string>, std::string>>{
           {{"tune", "--model", "1/(s + 1)", "--crossover", "--out", out},
            "--crossover lacks its value: --out is an option"},
           {{"analyse", "--model", "--out=" + out}, "--model lacks its value: --out is an option"},
           {{"analyse", "1/(s + 1)", "--out"}, "--out needs a value"}}) {
    const auto result = run_fracfit(words);
    EXPECT_EQ(result.code, 2);
    EXPECT_NE(result.error.find(said), std::string::npos) << result.error;
  }
  // A number may be negative.
  EXPECT_EQ(run_fracfit({"mittag-leffler", "--alpha", "1", "--z", "-1"}).code, 0);
}

TEST(Conventions, VersionAndOutHaveShortNames) {
  EXPECT_EQ(run_fracfit({"-V"}).output, run_fracfit({"--version"}).output);
  const TemporaryFolder folder;
  const auto result = run_fracfit({"mittag-leffler", "--alpha", "1", "--z", "0", "-o", folder.path("value")});
  EXPECT_EQ(result.code, 0) << result.error;
  EXPECT_EQ(content_of(folder.path("value")), "1,0\n");
}

// On a terminal, data come as a table of numbers short enough to read; into a file or pipe they come as CSV.
TEST(Conventions, DataOnATerminalAreATable) {
  if (!has_terminals()) GTEST_SKIP() << "no pseudo-terminal here";
  ProgramSetting terminal;
  terminal.terminal_output = true;
  for (const std::vector<std::string>& arguments :
       {std::vector<std::string>{"simulate", "--force", "40", "--clearance", "0.3", "--restitution", "0.6", "--omega",
                                 "20"},
        {"map", "--restitution", "0.6", "--omega", "2"},
        {"history", "--restitution", "0.6", "--omega", "2", "--periods", "1", "--samples", "2"},
        {"basins", "--restitution", "0.6", "--omega", "2", "--position", "0.5", "--velocity", "0"},
        {"respond", "--model", "1/(s + 1)", "--time", "1,2"}}) {
    const auto shown = run_fracfit(arguments, terminal);
    EXPECT_EQ(shown.code, 0) << shown.error;
    EXPECT_EQ(shown.output.find('#'), std::string::npos) << shown.output;
    EXPECT_EQ(shown.output.find(",re_m_per_n"), std::string::npos) << shown.output;
    EXPECT_NE(run_fracfit(arguments).output.find("# command: fracfit "), std::string::npos);
  }
}

// Colours are for terminals that have them and users who did not refuse them; without their codes the text is that of
// a pipe, where a terminal of unknown width has 80 columns.
TEST(Conventions, TablesOnATerminalHaveColours) {
  if (!has_terminals()) GTEST_SKIP() << "no pseudo-terminal here";
  const std::vector<std::string> command{
      "identify", FRACFIT_SOURCE_DIR "/data/examples/cell.csv", "--models", "two-zarc,lag", "--format", "table"};
  const std::string plain = run_fracfit(command).output;
  EXPECT_EQ(plain.find('\x1b'), std::string::npos);
  const auto shown = [&](const std::string& terminal, const std::string& no_color) {
    ProgramSetting setting;
    setting.terminal_output = true;
    setting.environment = {{"TERM", terminal}, {"NO_COLOR", no_color}};
    // A terminal ends lines with both characters.
    return std::regex_replace(run_fracfit(command, setting).output, std::regex("\r\n"), "\n");
  };
  EXPECT_EQ(shown("dumb", ""), plain);
  EXPECT_EQ(shown("xterm", "1"), plain);
  const std::string coloured = shown("xterm", "");
  EXPECT_EQ(std::regex_replace(coloured, std::regex("\x1b\\[[0-9]*m"), ""), plain);
  for (const char* const marked : {"\x1b[1mverdict:\x1b[0m", "\x1b[1mchosen\x1b[0m", "\x1b[31mmisses the data\x1b[0m"})
    EXPECT_NE(coloured.find(marked), std::string::npos) << marked;
}

}  // namespace
