// SPDX-License-Identifier: BSD-3-Clause
// Files as every command takes them: several curves in one, read once, never replaced by the output.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "run_program.hpp"

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

std::vector<std::string> with(std::vector<std::string> arguments, const std::vector<std::string>& more) {
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

class SeveralScenes : public testing::Test {
 protected:
  SeveralScenes() {
    simulate("table.csv", "15,25,45");
    for (const char* force : {"15", "25", "45"}) simulate(std::string(force) + ".csv", force);
  }
  void simulate(const std::string& name, const std::string& force) const {
    const auto result = run_fracfit({"simulate", "--force", force, "--clearance", "0.2", "--restitution", "0.5",
                                     "--omega", "6:30:25log", "--out", folder.path(name)});
    ASSERT_EQ(result.code, 0) << result.error;
  }
  [[nodiscard]] std::string path(const std::string& name) const { return folder.path(name); }

  TemporaryFolder folder;
};

TEST_F(SeveralScenes, AreNotFittedAsOneCurve) {
  for (const auto& command : std::vector<std::vector<std::string>>{
           {"fit", path("table.csv"), "--model", "power-law"},
           {"identify", path("table.csv"), "--models", "power-law,gain"},
           {"batch", path("table.csv"), "--model", "power-law", "--out", path("rows.csv")}}) {
    const auto result = run_fracfit(command);
    EXPECT_EQ(result.code, 2) << command.front() << result.error;
    for (const char* part : {"several curves", "force_n (15, 25", "--where 'force_n==25'", "batch --by force_n"})
      EXPECT_NE(result.error.find(part), std::string::npos) << part << " in " << result.error;
    EXPECT_FALSE(fs::exists(path("rows.csv")));
  }
  simulate("clearances.csv", "15,25,45");
  const auto map = run_fracfit({"map", "--force", "20", "--clearance", "0.2", "--restitution", "0.3,0.4,0.5", "--omega",
                                "6:9:12", "--out", path("map.csv")});
  ASSERT_EQ(map.code, 0) << map.error;
  const auto fit = run_fracfit({"fit", path("map.csv"), "--model", "power-law"});
  EXPECT_EQ(fit.code, 2);
  EXPECT_NE(fit.error.find("batch --by restitution"), std::string::npos) << fit.error;
}

TEST_F(SeveralScenes, OneIsTakenByAConditionOnItsColumn) {
  const auto of = [&](const std::vector<std::string>& arguments) {
    const auto result = run_fracfit(with(arguments, {"--model", "power-law", "--format", "json"}));
    EXPECT_EQ(result.code, 0) << result.error;
    return Json::parse(result.output).at("parameters");
  };
  EXPECT_EQ(of({"fit", path("table.csv"), "--where", "force_n==25"}), of({"fit", path("25.csv")}));
  EXPECT_EQ(of({"fit", path("table.csv"), "--where", "force_n>=20", "--where", "force_n<30"}),
            of({"fit", path("25.csv")}));
}

TEST_F(SeveralScenes, AreRowsOfABatch) {
  const auto result = run_fracfit({"batch", path("table.csv"), "--by", "force_n", "--model", "power-law"});
  EXPECT_EQ(result.code, 0) << result.error;
  for (const char* force : {"#15,converged,", "#25,converged,", "#45,converged,"})
    EXPECT_NE(result.output.find(force), std::string::npos) << result.output;
}

TEST_F(SeveralScenes, AreCurvesOfOneSceneForItsIdentification) {
  const auto of = [&](const std::vector<std::string>& data, const std::vector<std::string>& more = {}) {
    const auto result =
        run_fracfit(with(with({"identify-scene"}, data), with({"--fix", "mass1=1", "--format", "json"}, more)));
    EXPECT_EQ(result.code, 0) << result.error;
    return Json::parse(result.output);
  };
  const auto separate = of({path("15.csv"), path("25.csv"), path("45.csv")});
  const auto together = of({path("table.csv")});
  EXPECT_EQ(together.at("parameters"), separate.at("parameters"));
  ASSERT_EQ(together.at("data").size(), 3U);
  EXPECT_EQ(together.at("data").at(2).at("force_n"), 45);
  const auto two = of({path("table.csv")}, {"--where", "force_n!=15"});
  EXPECT_EQ(two.at("data").size(), 2U);

  const auto forced = run_fracfit({"identify-scene", path("table.csv"), "--force", "1", "--fix", "mass1=1"});
  EXPECT_EQ(forced.code, 2);
  EXPECT_NE(forced.error.find("whose column force_n"), std::string::npos) << forced.error;
  const auto clearances = run_fracfit({"simulate", "--force", "20", "--clearance", "0.1:0.3:3", "--restitution", "0.5",
                                       "--omega", "6:30:9", "--out", path("clearances.csv")});
  ASSERT_EQ(clearances.code, 0) << clearances.error;
  const auto mixed = run_fracfit({"identify-scene", path("clearances.csv"), "--fix", "mass1=1"});
  EXPECT_EQ(mixed.code, 2);
  EXPECT_NE(mixed.error.find("--where 'clearance_m==0.1'"), std::string::npos) << mixed.error;
}

TEST(Report, HasAChapterForEachCurveOfAFile) {
  const TemporaryFolder folder;
  const auto by_row = folder.write("rows.csv", "force_n,omega_rad_s,re,im\n1,1,1,-1\n1,2,1,-2\n3,1,2,-1\n3,2,2,-2\n");
  const auto by_column = folder.write("columns.csv", "omega_rad_s,re_a,im_a,re_b,im_b\n1,1,-1,2,-1\n2,1,-2,2,-2\n");
  const auto result = run_fracfit({"report", by_row, by_column, "--out", folder.path("report"), "--quiet"});
  EXPECT_LE(result.code, 1) << result.error;  // 1 without gnuplot
  const auto page = content_of(folder.path("report/index.html"));
  for (const char* title :
       {"rows.csv, force_n 1", "rows.csv, force_n 3", "columns.csv, curve a", "columns.csv, curve b"})
    EXPECT_NE(page.find(title), std::string::npos) << title;
}

// A line 2 + 3 s, good where the column says so and rubbish elsewhere.
TEST(Conditions, MayBeOnAnyColumn) {
  const TemporaryFolder folder;
  std::string text = "w_rad_s,re,im,valid,gain db,note [x]\n";
  for (int i = 1; i <= 12; ++i) {
    const bool valid = i % 3 != 0;
    text += std::to_string(i) + (valid ? ",2," + std::to_string(3 * i) : std::string(",none,99")) + "," +
            (valid ? "yes" : "no") + "," + std::to_string(i % 2) + "," + std::to_string(i) + "\n";
  }
  const auto data = folder.write("curve.csv", text);
  const auto points = [&](const std::vector<std::string>& where) {
    std::vector<std::string> arguments{"fit", data, "--model", "a + b s", "--component", "both", "--format", "json"};
    for (const auto& condition : where) arguments.insert(arguments.end(), {"--where", condition});
    const auto result = run_fracfit(arguments);
    EXPECT_EQ(result.code, 0) << result.error;
    const auto json = Json::parse(result.output);
    EXPECT_NEAR(json.at("parameters").at(0).at("value").get<double>(), 2, 1e-9);
    EXPECT_NEAR(json.at("parameters").at(1).at("value").get<double>(), 3, 1e-9);
    return json.at("data").at("points").get<int>();
  };
  EXPECT_EQ(points({"valid==yes"}), 8);
  EXPECT_EQ(points({"valid != no"}), 8);
  EXPECT_EQ(points({"valid==yes", "gain db==1"}), 4);
  EXPECT_EQ(points({"valid==yes", "note[x]<=7", "omega>1"}), 4);
  const auto unknown = run_fracfit({"fit", data, "--model", "gain", "--where", "vaild==yes"});
  EXPECT_EQ(unknown.code, 2);
  for (const char* part : {"unknown quantity 'vaild'", "w_rad_s, re, im, valid, gain db, note [x]"})
    EXPECT_NE(unknown.error.find(part), std::string::npos) << unknown.error;
}

TEST(Conditions, MayBeOnAnyColumnOfSamplesOverTime) {
  const TemporaryFolder folder;
  std::string text = "time_s,input,output,ok\n";
  for (int i = 0; i <= 40; ++i)
    text += std::to_string(0.1 * i) + ",1," + (i % 4 == 3 ? "7,0\n" : std::to_string(2.0) + ",1\n");
  const auto data = folder.write("gain.csv", text);
  const auto result =
      run_fracfit({"fit", data, "--model", "K", "--fix", "offset=0", "--where", "ok==1", "--format", "json"});
  EXPECT_EQ(result.code, 0) << result.error;
  EXPECT_NEAR(Json::parse(result.output).at("parameters").at(0).at("value").get<double>(), 2, 1e-9);
}

// All commands that read files, with an output.
class InputsAndOutputs : public testing::Test {
 protected:
  InputsAndOutputs() {
    folder.write("curve.csv", "omega_rad_s,re,im\n1,1,-1\n2,1,-2\n3,1,-3\n4,1,-4\n5,1,-5\n6,1,-6\n");
    folder.write("input.csv", "time_s,input\n0,1\n1,1\n2,0\n");
    for (const char* shard : {"1/2", "2/2"}) {
      const auto result =
          run_fracfit({"map", "--force", "20", "--clearance", "0.2", "--restitution", "0.3,0.4,0.5", "--omega", "6:7:2",
                       "--shard", shard, "--out", path("shard" + std::string(1, shard[0]) + ".csv")});
      EXPECT_EQ(result.code, 0) << result.error;
    }
  }
  [[nodiscard]] std::string path(const std::string& name) const { return folder.path(name); }

  struct Reading {
    std::string input;
    std::vector<std::string> before, after;  // words around the input
  };
  [[nodiscard]] std::vector<Reading> readings() const {
    return {{"curve.csv", {"fit"}, {"--model", "K/(T s + 1)", "--component", "both"}},
            {"curve.csv", {"identify"}, {"--models", "gain,lag", "--component", "both"}},
            {"curve.csv", {"batch"}, {"--model", "gain", "--component", "both"}},
            {"input.csv", {"respond", "--model", "1/(s + 1)", "--input"}, {}}};
  }

  TemporaryFolder folder;
};

TEST_F(InputsAndOutputs, NoInputIsReplacedUnderWhateverName) {
  for (const auto& reading : readings()) {
    const auto input = path(reading.input);
    const auto content = content_of(input);
    fs::create_symlink(input, path("link.csv"));
    fs::create_symlink(path("link.csv"), path("link2.csv"));
    fs::create_hard_link(input, path("hard.csv"));
    fs::create_directory(path("sub"));
    for (const auto& out : {input, path("sub/../" + reading.input), folder.path() + "/./" + reading.input,
                            path("link.csv"), path("link2.csv"), path("hard.csv")}) {
      const auto result = run_fracfit(with(with(reading.before, {input}), with(reading.after, {"--out", out})));
      EXPECT_EQ(result.code, 2) << reading.before.front() << " " << out;
      EXPECT_NE(result.error.find("is also the input"), std::string::npos) << result.error;
      EXPECT_EQ(content_of(input), content) << out;
      EXPECT_TRUE(fs::is_symlink(path("link.csv")));
    }
    for (const char* name : {"link.csv", "link2.csv", "hard.csv", "sub"}) fs::remove(path(name));
  }
  // Standard input is an input too.
  const auto content = content_of(path("curve.csv"));
  const auto result =
      run_shell("\"$fracfit\" fit - --model gain --out " + path("curve.csv") + " < " + path("curve.csv"));
  EXPECT_EQ(result.code, 2) << result.error;
  EXPECT_EQ(content_of(path("curve.csv")), content);
}

TEST_F(InputsAndOutputs, AReportDoesNotReplaceItsInputs) {
  fs::create_directories(path("report/tables"));
  const auto data = folder.write("report/tables/curve.csv", content_of(path("curve.csv")));
  const auto scene = folder.write("report/results.json", "{}");
  for (const auto& arguments : std::vector<std::vector<std::string>>{{data}, {"--scene", scene}}) {
    const auto result = run_fracfit(with(with({"report"}, arguments), {"--out", path("report"), "--quiet"}));
    EXPECT_EQ(result.code, 2);
    EXPECT_NE(result.error.find("holds the input"), std::string::npos) << result.error;
  }
}

TEST_F(InputsAndOutputs, OutputsWithoutAPlaceAreRefused) {
  fs::create_symlink("b", path("a"));
  fs::create_symlink("a", path("b"));
  fs::create_symlink("missing/below", path("dangling"));
  const std::vector<std::string> command{"mittag-leffler", "--alpha", "0.5", "--beta", "1", "--z", "-1", "--out"};
  for (const auto& out : {std::string(), path("a"), path("dangling")}) {
    const auto result = run_fracfit(with(command, {out}));
    EXPECT_EQ(result.code, 2) << "'" << out << "'";
    EXPECT_NE(result.error.find("--out"), std::string::npos) << result.error;
    EXPECT_EQ(result.output, "");
  }
  // A link to a file that does not exist yet makes that file.
  fs::create_symlink("later.csv", path("early.csv"));
  EXPECT_EQ(run_fracfit(with(command, {path("early.csv")})).code, 0);
  EXPECT_TRUE(fs::is_symlink(path("early.csv")));
  EXPECT_TRUE(fs::is_regular_file(path("later.csv")));
}

TEST_F(InputsAndOutputs, WhatCanBeReadOnlyOnceIsRead) {
  for (const auto& reading : readings()) {
    const auto input = path(reading.input);
    const auto text = [](const std::vector<std::string>& words) {
      std::string line;
      for (const auto& word : words) line += " '" + word + "'";
      return line;
    };
    const auto line = [&](const std::string& file) {
      return "\"$fracfit\"" + text(reading.before) + " " + file + text(reading.after);
    };
    std::vector<std::string> scripts{
        line("<(cat " + input + ")"), "cat " + input + " | " + line("/dev/stdin"),
        "mkfifo " + path("pipe") + "; cat " + input + " > " + path("pipe") + " & " + line(path("pipe"))};
    if (reading.before.front() != "batch") scripts.push_back("cat " + input + " | " + line("-"));
    for (const auto& script : scripts) {
      const auto result = run_shell(script);
      EXPECT_EQ(result.code, 0) << script << "\n" << result.error;
      EXPECT_FALSE(result.output.empty()) << script;
      fs::remove(path("pipe"));
    }
  }
  const auto merged =
      run_shell("\"$fracfit\" merge <(cat " + path("shard1.csv") + ") <(cat " + path("shard2.csv") + ") --out -");
  EXPECT_EQ(merged.code, 0) << merged.error;
  EXPECT_EQ(lines_of(merged.output).back().substr(0, 6), "0.5,7,") << merged.output;
  const auto report =
      run_shell("\"$fracfit\" report <(head -n 4 " + path("curve.csv") + ") --quiet --out " + path("r"));
  EXPECT_LE(report.code, 1) << report.error;
  EXPECT_TRUE(fs::exists(path("r/index.html")));
}

// A pipe that never says anything keeps a command in a call of the system, where it cannot look at the clock: without
// the clock's own end each of these would wait for ever.  What was to be written is not there, nor anything beside it.
TEST_F(InputsAndOutputs, NoCommandOutlivesItsTimeLimit) {
  const std::vector<std::string> commands{"convert pipe",
                                          "fit pipe --model lag",
                                          "identify pipe",
                                          "batch pipe --model gain",
                                          "validate pipe",
                                          "drt pipe",
                                          "response pipe",
                                          "joint-fit pipe other --model lag --shared K",
                                          "respond --model '1/(s + 1)' --input pipe --time 0:1:11",
                                          "evaluate --fit pipe --omega 1",
                                          "merge pipe pipe",
                                          "report pipe"};
  fs::create_directory(path("outputs"));
  std::string script = "cd " + folder.path() + "; mkfifo pipe other; exec 9<>pipe\n";
  for (std::size_t i = 0; i < commands.size(); ++i) {
    const std::string number = std::to_string(i);
    script += "{ \"$fracfit\" " + commands[i] + " --time-limit 0.1 --out outputs/" + number + " 2> error" + number +
              "; echo $? > code" + number + "; } &\n";
  }
  EXPECT_EQ(run_shell(script + "wait").code, 0);
  for (std::size_t i = 0; i < commands.size(); ++i) {
    const std::string number = std::to_string(i);
    EXPECT_EQ(content_of(path("error" + number)), "fracfit: --time-limit 0.1: the time is over\n") << commands[i];
    EXPECT_EQ(content_of(path("code" + number)), "1\n") << commands[i];
  }
  EXPECT_TRUE(fs::is_empty(path("outputs")));
}

// A file with very many columns takes time in proportion to them: the square would be minutes here.  The timeout of
// the test program alone judges.
TEST(WideFiles, AreReadInProportionAndNamedInShort) {
  const TemporaryFolder folder;
  constexpr int columns = 200'000;
  std::string header = "omega_rad_s,re,im", row = ",1,-1";
  for (int i = 0; i < columns; ++i) {
    header += ",c" + std::to_string(i);
    row += ",0";
  }
  const auto data = folder.write("wide.csv", header + "\n1" + row + "\n2" + row + "\n3" + row + "\n");
  const auto result = run_fracfit({"fit", data, "--model", "gain"});
  EXPECT_EQ(result.code, 0) << result.error;
  EXPECT_NE(result.error.find("and 199990 more"), std::string::npos) << result.error.substr(0, 500);
  EXPECT_LT(result.error.size(), 2000U);
}

// A folder of files of several instruments goes through one batch, and what convert writes is read back bit by bit.
TEST(Convert, MixedFilesGoThroughABatchAndComeBackUnchanged) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder.path("in"));
  std::string gamry = "EXPLAIN\nZCURVE\tTABLE\t6\n\tPt\tFreq\tZreal\tZimag\n\t#\tHz\tohm\tohm\n";
  std::string universal = "f/Hz;Z'/ohm;-Z''/ohm\n", touchstone = "# Hz S RI R 50\n";
  for (int i = 1; i <= 6; ++i) {
    const std::string f = std::to_string(i), re = std::to_string(7 - i), im = std::to_string(0.1 * i);
    gamry += "\t" + f + "\t" + f + "\t" + re + "\t-" + im + "\n";
    universal += f + ";" + re + ";" + im + "\n";
    touchstone += f + " " + re + " -" + im + "\n";
  }
  std::replace(universal.begin(), universal.end(), '.', ',');
  folder.write("in/a.DTA", gamry);
  folder.write("in/b.txt", universal);
  folder.write("in/c.s1p", touchstone);
  const auto batch = run_fracfit({"batch", folder.path("in"), "--model", "gain", "--component", "both"});
  EXPECT_EQ(batch.code, 0) << batch.error;
  std::size_t converged = 0;
  for (const auto& line : lines_of(batch.output)) converged += line.find(",converged,") != std::string::npos ? 1 : 0;
  EXPECT_EQ(converged, 3U) << batch.output;

  const auto once = folder.path("once.csv"), twice = folder.path("twice.csv");
  for (const std::string name : {"in/a.DTA", "in/b.txt", "in/c.s1p"}) {
    const auto result = run_fracfit({"convert", folder.path(name), "--out", once});
    ASSERT_EQ(result.code, 0) << result.error;
    EXPECT_NE(result.error.find(" 6 points"), std::string::npos) << result.error;
    ASSERT_EQ(run_fracfit({"convert", once, "--out", twice}).code, 0);
    const auto rows = [](const std::string& file) {
      std::string text;
      for (const auto& line : lines_of(content_of(file)))
        if (!line.starts_with('#')) text += line + "\n";
      return text;
    };
    EXPECT_EQ(rows(once), rows(twice));
  }
}

TEST(Convert, WrongUsageAndDamagedFilesAreTold) {
  const TemporaryFolder folder;
  const auto table = folder.write("table.csv", "f,a,b\n1,2,3\n2,3,4\n");
  EXPECT_EQ(run_fracfit({"convert", table}).code, 3);
  EXPECT_EQ(run_fracfit({"convert", table, "--columns", "f=1,x=2"}).code, 2);
  const auto hertz = run_fracfit({"convert", table, "--columns", "f=1,re=2,im=3"});
  EXPECT_EQ(hertz.code, 0) << hertz.error;
  EXPECT_NE(hertz.error.find("column 'f' has no unit and is taken as Hz"), std::string::npos) << hertz.error;
  const auto told = run_fracfit({"convert", table, "--columns", "f=1,re=2,im=3", "--frequency-unit", "rad/s"});
  EXPECT_EQ(told.code, 0) << told.error;
  EXPECT_NE(told.output.find("\nomega_rad_s,re,im\n1,2,3\n2,3,4\n"), std::string::npos) << told.output;
  EXPECT_EQ(
      run_fracfit({"convert", table, "--columns", "f=1,re=2,im=3", "--frequency-unit", "Hz", "--select", "4"}).code, 2);
  const auto cut = run_fracfit({"convert", folder.write("cut.DTA", "EXPLAIN\nZCURVE\tTABLE\n")});
  EXPECT_EQ(cut.code, 3);
  EXPECT_NE(cut.error.find("cut.DTA:2: ends within table ZCURVE"), std::string::npos) << cut.error;
}

}  // namespace
