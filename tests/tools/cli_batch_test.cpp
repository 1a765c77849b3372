// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <filesystem>
#include <iomanip>
#include <nlohmann/json.hpp>
#include <random>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "io/fingerprint.hpp"
#include "run_program.hpp"

namespace {

using Json = nlohmann::ordered_json;

/// A power law K s^a with a force in its header.
std::string curve(double coefficient, double order, double force) {
  std::ostringstream stream;
  stream.precision(17);
  stream << "# force_n: " << force << "\nomega_rad_s,re,im\n";
  for (int i = 0; i <= 20; ++i) {
    const double omega = std::pow(10.0, -1 + i / 10.0);
    const auto value = coefficient * std::pow(std::complex<double>(0, omega), order);
    stream << omega << ',' << value.real() << ',' << value.imag() << '\n';
  }
  return stream.str();
}

/// Seven files; K = 2 F^0.5, so its law is known exactly.
class Batch : public testing::Test {
 protected:
  Batch() {
    std::filesystem::create_directory(folder.path("data"));
    for (int i = 1; i <= 7; ++i)
      folder.write("data/force_" + std::to_string(i) + ".csv", curve(2 * std::sqrt(i), 0.7, i));
  }

  [[nodiscard]] std::vector<std::string> command(const std::vector<std::string>& more) const {
    std::vector<std::string> arguments{"batch",       folder.path("data"), "--model", "power-law",
                                       "--power-law", "K:force_n",         "--quiet"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }

  [[nodiscard]] std::string whole(const std::string& name) const {
    const auto result = run_fracfit(command({"--out", folder.path(name)}));
    EXPECT_EQ(result.code, 0) << result.error;
    return content_of(folder.path(name));
  }

  TemporaryFolder folder;
};

// The K of each row are known: 2 F^0.5.  A file that is no response has its message below the rows.
TEST_F(Batch, TableForPeopleHasALinePerFileThatATerminalHolds) {
  folder.write("data/force_8.csv", "x,y\n1,2\n");
  const auto result = run_fracfit(command({"--format", "table"}));
  EXPECT_EQ(result.code, 0) << result.error;
  const auto lines = lines_of(result.output);
  ASSERT_GT(lines.size(), 8U);
  for (const auto& line : lines) EXPECT_LE(line.size(), 160U) << line;
  for (const char* column : {"file", "status", "rms", "K", "a"})
    EXPECT_NE((" " + lines[0] + " ").find(" " + std::string(column) + " "), std::string::npos) << lines[0];
  for (std::size_t i = 1; i <= 7; ++i) {
    EXPECT_NE(lines[i].find("force_" + std::to_string(i) + ".csv"), std::string::npos) << lines[i];
    std::ostringstream value;
    value << std::setprecision(5) << 2 * std::sqrt(static_cast<double>(i));
    EXPECT_NE(lines[i].find(" " + value.str() + " +- "), std::string::npos) << lines[i];
  }
  EXPECT_NE(lines[8].find("invalid-data"), std::string::npos) << lines[8];
  EXPECT_NE(result.output.find("no frequency column"), std::string::npos) << result.output;
  EXPECT_NE(result.output.find("power_law: K:force_n points=7"), std::string::npos) << result.output;
}

TEST_F(Batch, OneRowPerFileInOrderAndThePowerLawOfTheData) {
  const auto lines = lines_of(whole("all.csv"));
  std::vector<std::string> rows;
  std::string law;
  for (const auto& line : lines) {
    if (line.starts_with(folder.path("data"))) rows.push_back(line);
    if (line.starts_with("# power_law: K:force_n ")) law = line;
  }
  ASSERT_EQ(rows.size(), 7U);
  for (std::size_t i = 0; i < rows.size(); ++i)
    EXPECT_TRUE(rows[i].starts_with(folder.path("data/force_" + std::to_string(i + 1) + ".csv,converged,")));
  const auto number_after = [&](const std::string& key) { return std::stod(law.substr(law.find(key) + key.size())); };
  // The data are exact to 17 digits; the solver stops at a relative change of the cost near 1e-12, so K holds 1e-6 and
  // so does the law through its values.
  EXPECT_EQ(number_after(" points="), 7);
  EXPECT_NEAR(number_after(" coefficient="), 2, 2e-6);
  EXPECT_NEAR(number_after(" exponent="), 0.5, 1e-6);
}

TEST_F(Batch, ShardsMergedAreTheSingleRunByteForByte) {
  for (const std::string extension : {".csv", ".jsonl"}) {
    const auto single = whole("all" + extension);
    std::vector<std::string> merge{"merge", "--out", folder.path("merged" + extension)};
    for (const char* shard : {"3", "1", "2"}) {
      const auto part = folder.path(std::string("part") + shard + extension);
      EXPECT_EQ(run_fracfit(command({"--shard", std::string(shard) + "/3", "--out", part})).code, 0);
      merge.push_back(part);
    }
    const auto result = run_fracfit(merge);
    EXPECT_EQ(result.code, 0) << result.error;
    EXPECT_EQ(content_of(folder.path("merged" + extension)), single);
  }
}

TEST_F(Batch, MoreShardsThanFilesLeaveSomeEmpty) {
  const auto part = folder.path("part.csv");
  EXPECT_EQ(run_fracfit(command({"--shard", "9/9", "--out", part})).code, 0);
  const auto result = run_fracfit({"merge", "--out", folder.path("merged.csv"), part});
  EXPECT_EQ(result.code, 1);
  EXPECT_NE(result.error.find("7 of 7 files are missing"), std::string::npos) << result.error;
}

// Of four shards one is whole, one has lost its last row and its end, one has a digit changed, and one is not there.
TEST_F(Batch, SaysHowFarShardsAreAndWhichToRunAgain) {
  for (const std::string extension : {".csv", ".jsonl"}) {
    const auto path = [&](int shard) { return folder.path(std::to_string(shard) + extension); };
    for (int shard = 1; shard <= 3; ++shard)
      EXPECT_EQ(run_fracfit(command({"--shard", std::to_string(shard) + "/4", "--out", path(shard)})).code, 0);
    const auto lines = lines_of(content_of(path(2)));
    std::string cut;
    for (std::size_t i = 0; i + 2 < lines.size(); ++i) cut += lines[i] + "\n";
    folder.write("2" + extension, cut);
    const auto finished = content_of(path(3));
    auto changed = finished;
    changed.at(changed.find("21", changed.rfind("force_7.csv"))) = '3';
    folder.write("3" + extension, changed);

    const auto result = run_fracfit({"merge", path(3), path(1), path(2), "--status", "--format", "json"});
    EXPECT_EQ(result.code, 1) << result.error;
    const auto status = Json::parse(result.output);
    EXPECT_EQ(status["shards_to_do"], "2-4");
    const std::vector<std::string> states{"found a checksum", "finished", "unfinished"};
    for (std::size_t i = 0; i < states.size(); ++i) {
      EXPECT_NE(status["rows"][i]["state"].get<std::string>().find(states[i]), std::string::npos) << result.output;
      EXPECT_EQ(status["rows"][i]["expected_rows"], 2);
      EXPECT_EQ(status["rows"][i]["rows"], states[i] == "unfinished" ? 1 : 2);
    }

    const auto missing = run_fracfit({"merge", path(1), path(2), "--out", "-"});
    EXPECT_EQ(missing.code, 1);
    EXPECT_NE(missing.error.find("--array=2-4"), std::string::npos) << missing.error;
    for (const auto& fault : {changed, finished + lines.back() + "\n"}) {
      folder.write("3" + extension, fault);
      const auto refused = run_fracfit({"merge", path(1), path(3), "--out", "-"});
      EXPECT_EQ(refused.code, 3);
      EXPECT_NE(refused.error.find("changed or lost"), std::string::npos) << refused.error;
    }
  }
}

// A whole table is no shard; what is unfinished has its rows checked one by one.
TEST_F(Batch, ShardsOfOtherKindsAreRefused) {
  const auto shard = [&](const std::string& text) {
    const auto path = folder.path("{shard}.csv");
    EXPECT_EQ(run_fracfit(command({"--shard", text, "--out", path})).code, 0);
  };
  shard("1/3");
  shard("1/4");
  static_cast<void>(whole("all.csv"));
  auto wrong = content_of(folder.path("1-of-3.csv"));
  wrong.resize(wrong.rfind("# checksum"));
  wrong.replace(wrong.find(",21,") + 1, 2, "x1");
  folder.write("wrong.csv", wrong);
  for (const auto& [other, part] : std::vector<std::pair<std::string, std::string>>{
           {"all.csv", "expected shards"}, {"1-of-4.csv", "is one of 4 shards"}, {"data/force_1.csv", "batch"}}) {
    const auto result = run_fracfit({"merge", folder.path("1-of-3.csv"), folder.path(other), "--status"});
    EXPECT_EQ(result.code, 3);
    EXPECT_NE(result.error.find(part), std::string::npos) << result.error;
  }
  const auto result = run_fracfit({"merge", folder.path("wrong.csv"), "--out", "-"});
  EXPECT_EQ(result.code, 3);
  EXPECT_NE(result.error.find("found 'x1' in column 'points'"), std::string::npos) << result.error;
}

TEST_F(Batch, AnInterruptedRunResumesToTheSameBytes) {
  for (const std::string extension : {".csv", ".jsonl"}) {
    const auto single = whole("all" + extension);
    // Cut anywhere below the manifest: between rows, within a row, within the law.
    const auto lines = lines_of(single);
    std::size_t manifest = 0;
    for (const auto& line : lines) {
      manifest += line.size() + 1;
      if (line.starts_with("file,") || line.starts_with("{\"fracfit\"")) break;
    }
    for (std::size_t cut = manifest; cut < single.size(); cut += (single.size() - manifest) / 9) {
      const auto out = folder.write("cut" + extension, single.substr(0, cut));
      EXPECT_EQ(run_fracfit(command({"--out", out})).code, 0) << cut;
      EXPECT_EQ(content_of(out), single) << cut;
    }
  }
}

// A row of the output that another number was put into: it stands as long as the row is kept.
TEST_F(Batch, FinishedRowsAreKeptUntilTheirFileChanges) {
  for (const std::string extension : {".csv", ".jsonl"}) {
    const auto out = folder.path("all" + extension);
    auto marked = whole("all" + extension);
    const std::string row = extension == ".csv" ? "force_4.csv,converged" : R"(force_4.csv","status":"converged)";
    const auto at = marked.find("21", marked.find(row));  // its points
    ASSERT_LT(at, marked.find("force_5.csv" + row.substr(11)));
    marked.replace(at, 2, "77");
    folder.write("all" + extension, marked);
    EXPECT_EQ(run_fracfit(command({"--out", out})).code, 0);
    EXPECT_EQ(content_of(out), marked);
    // The same bytes written again are the same input.
    const auto data = content_of(folder.path("data/force_4.csv"));
    folder.write("data/force_4.csv", data);
    EXPECT_EQ(run_fracfit(command({"--out", out})).code, 0);
    EXPECT_EQ(content_of(out), marked);
    folder.write("data/force_4.csv", data + "# a remark more\n");
    EXPECT_EQ(run_fracfit(command({"--out", out})).code, 0);
    EXPECT_EQ(content_of(out).substr(at, 2), "21");
    folder.write("data/force_4.csv", data);
  }
}

TEST_F(Batch, WhatFailedIsDoneAgainOnceItsFileIsMended) {
  const auto good = content_of(folder.path("data/force_5.csv"));
  const auto single = whole("good.csv");
  folder.write("data/force_5.csv", "omega_rad_s,re,im\n1,2,x\n");
  const auto out = folder.path("all.csv");
  EXPECT_EQ(run_fracfit(command({"--out", out})).code, 0);
  EXPECT_NE(content_of(out).find("force_5.csv,invalid-data,"), std::string::npos);
  folder.write("data/force_5.csv", good);
  EXPECT_EQ(run_fracfit(command({"--out", out})).code, 0);
  EXPECT_EQ(content_of(out), single);
  // A file that went away is a failure too, not a result of old.
  std::filesystem::remove(folder.path("data/force_5.csv"));
  const auto gone = run_fracfit({"batch", folder.path("data/force_4.csv"), folder.path("data/force_5.csv"), "--model",
                                 "power-law", "--power-law", "K:force_n", "--quiet"});
  EXPECT_NE(gone.output.find("force_5.csv,invalid-data,"), std::string::npos) << gone.output;
}

TEST_F(Batch, ACommandAtFaultLeavesTheOutputAlone) {
  const auto out = folder.path("all.csv");
  for (const std::string where : {"omega<<4", "omega=4", "no_such_column<4"}) {
    const auto wrong = run_fracfit(command({"--where", where, "--out", out}));
    EXPECT_EQ(wrong.code, 2) << where;
    EXPECT_NE(wrong.error.find("--where"), std::string::npos) << wrong.error;
    EXPECT_FALSE(std::filesystem::exists(out));
  }
  EXPECT_EQ(run_fracfit(command({"--where", "omega<4", "--out", out})).code, 0);
}

TEST_F(Batch, ABadFileAmongGoodOnesIsARowWithItsError) {
  const auto bad = folder.write("data/force_3.csv", "omega_rad_s,re,im\n1,2,three, \"quoted\"\n");
  const auto csv = run_fracfit(command({}));
  EXPECT_EQ(csv.code, 0);
  EXPECT_NE(csv.output.find(bad + ",invalid-data,"), std::string::npos) << csv.output;
  const auto jsonl = run_fracfit(command({"--format", "jsonl"}));
  std::size_t converged = 0;
  for (const auto& line : lines_of(jsonl.output)) {
    const auto json = Json::parse(line);
    if (!json.contains("file")) continue;
    if (json["file"] != bad) {
      EXPECT_EQ(json["status"], "converged");
      ++converged;
      continue;
    }
    EXPECT_EQ(json["status"], "invalid-data");
    EXPECT_NE(json["message"].get<std::string>().find(bad + ":2"), std::string::npos) << json["message"];
    EXPECT_TRUE(json["K"].is_null());
  }
  EXPECT_EQ(converged, 6U);
}

TEST_F(Batch, NoCurveThatCanBeReadIsExitCodeThree) {
  const auto missing = folder.path("missing.csv");
  const auto result = run_fracfit({"batch", missing, folder.write("empty.csv", ""), "--model", "power-law"});
  EXPECT_EQ(result.code, 3);
  EXPECT_NE(result.output.find("missing.csv,invalid-data,"), std::string::npos) << result.output;
  EXPECT_NE(result.error.find(missing), std::string::npos) << result.error;
  EXPECT_NE(result.error.find("nor can the other 1 curves"), std::string::npos) << result.error;
  const auto one = run_fracfit({"batch", missing, folder.path("data/force_1.csv"), "--model", "power-law"});
  EXPECT_EQ(one.code, 0) << one.error;
}

TEST_F(Batch, NoFitAtAllIsExitCodeOne) {
  // Read, but the two parts of one point are too few for three parameters.
  const auto short_file = folder.write("short.csv", "omega_rad_s,re,im\n1,1,1\n");
  const auto result = run_fracfit({"batch", short_file, "--model", "K/(T s^a + 1)"});
  EXPECT_EQ(result.code, 1) << result.output;
  EXPECT_NE(result.error.find("1 of 1 curves gave no result"), std::string::npos) << result.error;
  // Each reason is counted as the column has it.
  const auto three = run_fracfit({"batch", short_file, folder.write("short2.csv", "omega_rad_s,re,im\n1,1,1\n"),
                                  folder.write("empty.csv", ""), folder.path("data/force_1.csv"), "--model",
                                  "K/(T s^a + 1)", "--format", "csv"});
  const std::size_t row = three.output.find("short.csv,") + std::string("short.csv,").size();
  const std::string status = three.output.substr(row, three.output.find(',', row) - row);
  EXPECT_NE(three.error.find("3 of 4 curves gave no result (1 invalid-data, 2 " + status + "); see column status"),
            std::string::npos)
      << three.error;
}

TEST_F(Batch, ALawNeedsAVariableThatTheDataKnow) {
  for (const std::string name : {"foo", "clearance_m"}) {
    const auto out = folder.path("law.csv");
    const auto result =
        run_fracfit({"batch", folder.path("data"), "--model", "power-law", "--power-law", "K:" + name, "--out", out});
    EXPECT_EQ(result.code, 2);
    EXPECT_NE(result.error.find("'" + name + "' is no number in the header of any file"), std::string::npos)
        << result.error;
    EXPECT_NE(result.error.find("known are force_n, points, omega_lower, omega_upper, K, a"), std::string::npos)
        << result.error;
    EXPECT_FALSE(std::filesystem::exists(out));
  }
}

// Fits of a block begin at the answer of its first curve: 70 curves are two blocks, and the 65th begins the second.
TEST_F(Batch, RowsDoNotDependOnShardsThreadsOrWhereARunStopped) {
  std::ostringstream text;
  text.precision(6);
  text << "omega_rad_s";
  for (int k = 0; k < 70; ++k) text << ",re_" << k << ",im_" << k;
  for (int i = 0; i <= 15; ++i) {
    const std::complex<double> s(0, std::pow(10.0, -1 + i / 7.5));
    text << '\n' << s.imag();
    for (int k = 0; k < 70; ++k) {
      const auto value = (1 + 0.02 * k) / (1.0 + std::pow(s, 0.6 + 0.005 * k));
      text << ',' << value.real() << ',' << value.imag();
    }
  }
  const auto file = folder.write("curves.csv", text.str() + "\n");
  const auto run = [&](const std::string& name, const std::vector<std::string>& more) {
    std::vector<std::string> arguments{"batch", file,      "--model", "K/(T s^a + 1)",  "--component",
                                       "both",  "--quiet", "--out",   folder.path(name)};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const auto result = run_fracfit(arguments);
    EXPECT_EQ(result.code, 0) << result.error;
    return content_of(folder.path(name));
  };
  const auto one = run("one.csv", {"--threads", "1"});
  EXPECT_EQ(one.size(), run("two.csv", {"--threads", "2"}).size());
  const auto rows = [](const std::string& table) {
    std::vector<std::string> found;
    for (const auto& line : lines_of(table))
      if (!line.starts_with("#")) found.push_back(line);
    return found;
  };
  EXPECT_EQ(rows(one), rows(content_of(folder.path("two.csv"))));
  std::vector<std::string> merge{"merge", "--out", folder.path("merged.csv")};
  for (const char* shard : {"1/3", "2/3", "3/3"}) {
    const std::string name = std::string("part") + shard[0] + ".csv";
    static_cast<void>(run(name, {"--threads", "1", "--shard", shard}));
    merge.push_back(folder.path(name));
  }
  EXPECT_EQ(run_fracfit(merge).code, 0);
  EXPECT_EQ(rows(content_of(folder.path("merged.csv"))), rows(one));
  // A run that stopped in the second block, begun again.
  const auto lines = lines_of(one);
  std::string begun;
  for (std::size_t i = 0; i + 4 < lines.size(); ++i) begun += lines[i] + "\n";
  folder.write("one.csv", begun);
  EXPECT_EQ(rows(run("one.csv", {"--threads", "1"})), rows(one));
}

// What is left out is left out by fit, identify and batch alike.
TEST_F(Batch, LeavesOutThePointsThatFitLeavesOut) {
  std::string text;
  for (int i = 0; i <= 20; ++i) {
    const double omega = std::pow(10.0, -1 + i / 10.0);
    // Rounding to four digits is the noise that the others show.
    const auto value = (i == 8 ? 1.5 : 1.0) * 2.0 * std::pow(std::complex<double>(0, omega), 0.7);
    std::ostringstream row;
    row.precision(4);
    row << omega << ',' << value.real() << ',' << value.imag() << '\n';
    text += row.str();
  }
  const auto file = folder.write("outlier.csv", "omega_rad_s,re,im\n" + text);
  for (const std::string how : {"leave-out", "keep"}) {
    const auto batch = run_fracfit(
        {"batch", file, "--model", "power-law", "--component", "both", "--outliers", how, "--format", "jsonl"});
    ASSERT_EQ(batch.code, 0) << batch.error;
    const auto row = Json::parse(lines_of(batch.output).at(1));
    const auto fit = run_fracfit(
        {"fit", file, "--model", "power-law", "--component", "both", "--outliers", how, "--format", "json"});
    const auto json = Json::parse(fit.output);
    EXPECT_EQ(row["left_out"], how == "keep" ? 0 : 1) << batch.output;
    EXPECT_EQ(row["left_out"], json["data"]["left_out"].size());
    EXPECT_EQ(row["outliers"], json["outliers"].size());
    EXPECT_EQ(row["K"], json["parameters"][0]["value"]);
    const auto identify = run_fracfit(
        {"identify", file, "--models", "power-law,gain", "--component", "both", "--outliers", how, "--format", "json"});
    EXPECT_EQ(Json::parse(identify.output)["data"]["left_out"], json["data"]["left_out"]);
  }
}

// A resonance narrower than the steps between the points contradicts its neighbours, and the model takes it back: the
// row of a curve is the answer of fit to the bit, and that of the next one, which begins there, to the tolerance of the
// search.
TEST_F(Batch, TakesBackThePointsThatFitTakesBack) {
  std::mt19937_64 generator(1);
  std::normal_distribution<double> normal(0, 0.003);
  const auto file_of = [&](const std::string& name) {
    std::ostringstream rows;
    rows.precision(12);
    rows << "omega_rad_s,re,im\n";
    for (int i = 0; i < 50; ++i) {
      const double omega = std::pow(10.0, -1 + (i + 0.01) * 2 / 49);
      const std::complex<double> s(0, omega);
      const std::complex<double> noise(1 + normal(generator), normal(generator));
      const auto value = (1.0 / (0.8 * s + 1.0) + 0.01 * s / (s * s + 0.003 * s + 1.3)) * noise;
      rows << omega << ',' << value.real() << ',' << value.imag() << '\n';
    }
    return folder.write(name, rows.str());
  };
  const std::vector<std::string> files{file_of("a.csv"), file_of("b.csv")};
  const std::string model = "g/(T s + 1) + b s/(s^2 + c s + e)";
  const auto batch = run_fracfit({"batch", files[0], files[1], "--model", model, "--format", "jsonl"});
  ASSERT_EQ(batch.code, 0) << batch.error;
  for (std::size_t i = 0; i < files.size(); ++i) {
    const auto row = Json::parse(lines_of(batch.output).at(1 + i));
    const auto fit = run_fracfit({"fit", files[i], "--model", model, "--format", "json"});
    EXPECT_NE(fit.error.find("taken in again"), std::string::npos) << fit.error;
    const auto json = Json::parse(fit.output);
    EXPECT_EQ(row["left_out"], 0) << batch.output;
    // Costs end alike to the relative tolerance of a search, 1e-12 of the cost a step, for some steps.
    EXPECT_NEAR(row["cost"].get<double>() / json["cost"].get<double>(), 1, i == 0 ? 0 : 1e-10);
  }
}

// A lag with noise of very unequal size, once with deviations that the head calls measured, once without: a batch
// weighs each curve as fit does, so that costs and parameters are those of fit, and --weight says otherwise.
TEST(BatchOutliers, MeasuredDeviationsWeighAsInFit) {
  const TemporaryFolder folder;
  std::mt19937_64 generator(11);
  std::normal_distribution<double> normal;
  std::ostringstream rows;
  rows.precision(12);
  rows << "omega_rad_s,re,im,sigma\n";
  for (int i = 0; i < 40; ++i) {
    const double omega = std::pow(10.0, -1 + i * 2.0 / 39), sigma = i % 2 == 0 ? 1e-4 : 0.02;
    const auto value = 1.0 / std::complex<double>(1, omega);
    rows << omega << ',' << value.real() + sigma * normal(generator) << ',' << value.imag() + sigma * normal(generator)
         << ',' << sigma << '\n';
  }
  const auto measured = folder.write("measured.csv", "# sigma: measured\n" + rows.str());
  const auto plain = folder.write("plain.csv", rows.str());
  const auto row_of = [](const ProgramResult& batch, std::size_t i) {
    EXPECT_EQ(batch.code, 0) << batch.error;
    return Json::parse(lines_of(batch.output).at(1 + i));
  };
  const auto batch = run_fracfit({"batch", measured, plain, "--model", "K/(T s + 1)", "--format", "jsonl"});
  const auto told =
      run_fracfit({"batch", measured, plain, "--model", "K/(T s + 1)", "--weight", "relative", "--format", "jsonl"});
  std::size_t i = 0;
  for (const auto& file : {measured, plain}) {
    for (const bool is_told : {false, true}) {
      std::vector<std::string> arguments{"fit", file, "--model", "K/(T s + 1)", "--format", "json"};
      if (is_told) arguments.insert(arguments.end(), {"--weight", "relative"});
      const auto fit = Json::parse(run_fracfit(arguments).output);
      const auto row = row_of(is_told ? told : batch, i);
      // The second curve begins at the answer of the first one: searches end alike to 1e-12 of the cost a step.
      EXPECT_NEAR(row["cost"].get<double>() / fit["cost"].get<double>(), 1, 1e-10) << file;
      const bool is_weighed = file == measured && !is_told;
      EXPECT_EQ(row["message"].get<std::string>().find("sigma, which was measured") != std::string::npos, is_weighed);
      if (is_weighed) {
        // Twenty points of both parts at 1e-4 tell K to about 1e-4/sqrt(20).
        EXPECT_LT(row["K_standard_error"].get<double>(), 1e-4);
      }
    }
    ++i;
  }
}

TEST_F(Batch, RowsLeftOutOfALawAreCounted) {
  std::filesystem::create_directory(folder.path("mixed"));
  folder.write("mixed/a.csv", curve(2, 0.7, 1));
  folder.write("mixed/b.csv", curve(4, 0.7, 4));
  folder.write("mixed/c.csv", curve(4, 0.7, -4));
  folder.write("mixed/d.csv", "nothing\n");
  const auto result = run_fracfit({"batch", folder.path("mixed"), "--model", "power-law", "--power-law", "K:force_n"});
  EXPECT_EQ(result.code, 0) << result.error;
  for (const char* part : {"2 of 4 rows are left out: 1 force_n not positive, 1 without a fit", "two points"})
    EXPECT_NE(result.error.find(part), std::string::npos) << part << " in " << result.error;
  const auto law = result.output.substr(result.output.find("# power_law: K:force_n"));
  for (const char* part : {" points=2 ", "left_out=\"1 force_n not positive, 1 without a fit\"", "note=\"two points"})
    EXPECT_NE(law.find(part), std::string::npos) << part << " in " << law;
}

/// The power law fitted to the curves of one file, from the remark below the rows.
double law_exponent(const std::string& output) {
  const std::string key = " exponent=";
  const auto at = output.find(key);
  return at == std::string::npos ? std::nan("") : std::stod(output.substr(at + key.size()));
}

// K = 2 F^0.5 for three forces, in the columns of one file and in its rows.
TEST_F(Batch, CurvesInOneFileAreRowsOfTheirOwn) {
  std::ostringstream columns, rows;
  columns.precision(17);
  rows.precision(17);
  columns << "omega_rad_s,re_10,im_10,re_20,im_20,re_40,im_40\n";
  rows << "force,omega_rad_s,re,im\n";
  for (int i = 0; i <= 20; ++i) {
    const double omega = std::pow(10.0, -1 + i / 10.0);
    columns << omega;
    for (const double force : {10, 20, 40}) {
      const auto value = 2 * std::sqrt(force) * std::pow(std::complex<double>(0, omega), 0.7);
      columns << ',' << value.real() << ',' << value.imag();
      rows << force << ',' << omega << ',' << value.real() << ',' << value.imag() << '\n';
    }
    columns << '\n';
  }
  const std::string by_column = folder.write("columns.csv", columns.str());
  const std::string by_row = folder.write("rows.csv", rows.str());
  const auto first = run_fracfit({"batch", by_column, "--model", "power-law", "--power-law", "K:curve"});
  EXPECT_EQ(first.code, 0) << first.error;
  EXPECT_NE(first.output.find("columns.csv#20,converged,"), std::string::npos) << first.output;
  EXPECT_NEAR(law_exponent(first.output), 0.5, 1e-9) << first.output;
  const auto second = run_fracfit({"batch", by_row, "--by", "force", "--model", "power-law", "--power-law", "K:force"});
  EXPECT_EQ(second.code, 0) << second.error;
  EXPECT_NE(second.output.find("rows.csv#40,converged,"), std::string::npos) << second.output;
  EXPECT_NEAR(law_exponent(second.output), 0.5, 1e-9) << second.output;
  const auto unknown = run_fracfit({"batch", by_row, "--by", "mass", "--model", "power-law"});
  EXPECT_EQ(unknown.code, 3);
  EXPECT_NE(unknown.error.find("no column 'mass' among force, omega_rad_s, re, im"), std::string::npos)
      << unknown.error;
}

TEST_F(Batch, ThreadsDoNotChangeAByte) {
  EXPECT_EQ(run_fracfit(command({"--threads", "1"})).output, run_fracfit(command({"--threads", "3"})).output);
}

TEST_F(Batch, ModelsAreRankedForEachFile) {
  const auto result =
      run_fracfit({"batch", folder.path("data"), "--models", "power-law,lag,gain", "--format", "jsonl"});
  EXPECT_EQ(result.code, 0) << result.error;
  std::size_t rows = 0;
  for (const auto& line : lines_of(result.output)) {
    const auto json = Json::parse(line);
    if (!json.contains("file")) continue;
    ++rows;
    EXPECT_EQ(json["chosen"], "power-law");
    EXPECT_EQ(json["verdict"], "supported");
    EXPECT_NEAR(json["a"].get<double>(), 0.7, 1e-6);
  }
  EXPECT_EQ(rows, 7U);
}

TEST_F(Batch, MergeRefusesWhatDoesNotBelongTogether) {
  const auto one = folder.path("one.csv");
  const auto two = folder.path("two.csv");
  EXPECT_EQ(run_fracfit(command({"--shard", "1/2", "--out", one})).code, 0);
  EXPECT_EQ(run_fracfit(command({"--shard", "2/2", "--seed", "2", "--out", two})).code, 0);
  const auto expect_refusal = [&](const std::vector<std::string>& in, const std::string& part) {
    std::vector<std::string> arguments{"merge", "--out", folder.path("merged.csv")};
    arguments.insert(arguments.end(), in.begin(), in.end());
    const auto result = run_fracfit(arguments);
    EXPECT_EQ(result.code, 3);
    EXPECT_NE(result.error.find(part), std::string::npos) << result.error;
    EXPECT_FALSE(std::filesystem::exists(folder.path("merged.csv")));
  };
  expect_refusal({one, two}, "has command");
  expect_refusal({one, one}, "force_1.csv, which");
  expect_refusal({one, folder.path("data/force_1.csv")}, "expected a table written by fracfit batch");
  expect_refusal({folder.path("absent.csv")}, "cannot be read: No such file");
}

/// Shards of a batch of more curves than `merge` holds the names of at once, written here as the format says: names
/// that both formats have to escape, rows of two columns.
class LongBatch : public testing::TestWithParam<std::string> {
 protected:
  static constexpr std::size_t curves = 70'000, shards = 3;

  [[nodiscard]] static bool is_csv() { return GetParam() == ".csv"; }
  [[nodiscard]] static std::string name(std::size_t i) {
    return std::to_string(i) + (i % 3 == 0 ? R"(\,"inputs":["\)" : ".csv");
  }
  // The quotation marks of CSV are doubled, and those of JSON escaped as backslashes are.
  [[nodiscard]] static std::string quoted_name(std::size_t i) {
    std::string text;
    for (const char c : name(i))
      text += std::string(is_csv() ? (c == '"') : (c == '"' || c == '\\'), is_csv() ? '"' : '\\') + c;
    return is_csv() && text.find('"') == std::string::npos ? text : '"' + text + '"';
  }
  [[nodiscard]] static std::string head(const std::string& shard) {
    std::string text;
    if (is_csv()) {
      text = "# fracfit: 1\n# command: c\n" + (shard.empty() ? "" : "# shard: " + shard + "\n");
      for (std::size_t i = 0; i < curves; ++i) text += "# input: " + name(i) + "\n";
      return text + "file,points\n";
    }
    text = R"({"fracfit":"1","command":"c",)" + (shard.empty() ? "" : R"("shard":")" + shard + R"(",)") +
           R"("laws":[],"inputs":[)";
    for (std::size_t i = 0; i < curves; ++i) text += (i > 0 ? "," : "") + quoted_name(i);
    return text + R"(],"columns":["file","points"]})" + "\n";
  }
  [[nodiscard]] static std::string row(std::size_t i) {
    const std::string points = std::to_string(i % 7);
    return is_csv() ? quoted_name(i) + "," + points + "\n"
                    : R"({"file":)" + quoted_name(i) + R"(,"points":)" + points + "}\n";
  }
  [[nodiscard]] static std::string shard_name(std::size_t shard) {
    return std::to_string(shard) + "/" + std::to_string(shards);
  }
  [[nodiscard]] static std::vector<std::string> rows_of(std::size_t shard) {
    std::vector<std::string> rows;
    for (std::size_t i = shard - 1; i < curves; i += shards) rows.push_back(row(i));
    return rows;
  }
  // With the checksum of a finished shard.
  [[nodiscard]] std::string finished(std::size_t shard) const {
    std::string text = head(shard_name(shard));
    for (const auto& each : rows_of(shard)) text += each;
    const std::string sum = io::Fingerprint(text).text();
    return folder.write(
        std::to_string(shard) + GetParam(),
        text + (is_csv() ? "# checksum: " + sum + "\n" : R"({"remark":"checksum","checksum":")" + sum + "\"}\n"));
  }
  [[nodiscard]] std::string unfinished(std::size_t shard, const std::vector<std::string>& rows) const {
    std::string text = head(shard_name(shard));
    for (const auto& each : rows) text += each;
    return folder.write(std::to_string(shard) + GetParam(), text);
  }

  TemporaryFolder folder;
};
INSTANTIATE_TEST_SUITE_P(All, LongBatch, testing::Values(".csv", ".jsonl"),
                         [](const auto& format) { return format.param.substr(1); });

TEST_P(LongBatch, ShardsAreMergedInTheOrderOfTheCurves) {
  std::string whole = head("");
  for (std::size_t i = 0; i < curves; ++i) whole += row(i);
  const auto out = folder.path("merged" + GetParam());
  const auto result = run_fracfit({"merge", finished(2), finished(3), finished(1), "--out", out});
  EXPECT_EQ(result.code, 0) << result.error;
  EXPECT_TRUE(content_of(out) == whole);
}

// Threads leave the rows of a shard that was interrupted in any order.  Three curves of it have no row.
TEST_P(LongBatch, RowsOfAnUnfinishedShardMayStandInAnyOrder) {
  auto rows = rows_of(2);
  const std::size_t last = rows.size() - 1;
  rows.erase(rows.begin() + static_cast<std::ptrdiff_t>(last));
  rows.erase(rows.begin() + 20'000);
  rows.erase(rows.begin() + 5);
  std::reverse(rows.begin(), rows.end());
  const std::set<std::size_t> gone{1 + 5 * shards, 1 + 20'000 * shards, 1 + last * shards};
  std::string whole = head("");
  for (std::size_t i = 0; i < curves; ++i) whole += gone.contains(i) ? "" : row(i);
  const auto out = folder.path("merged" + GetParam());
  const auto part = unfinished(2, rows);
  const auto result = run_fracfit({"merge", finished(1), part, finished(3), "--out", out});
  EXPECT_EQ(result.code, 1) << result.error;
  EXPECT_TRUE(content_of(out) == whole);
  EXPECT_NE(result.error.find("3 of 70000 files are missing: 16"), std::string::npos) << result.error;
  EXPECT_NE(result.error.find("--array=2"), std::string::npos) << result.error;

  const auto status = run_fracfit({"merge", finished(1), part, finished(3), "--status", "--format", "json"});
  EXPECT_EQ(status.code, 1) << status.error;
  const auto states = Json::parse(status.output);
  EXPECT_EQ(states["rows"][1]["rows"], last - 2);
  EXPECT_EQ(states["rows"][1]["state"], "unfinished");
}

TEST_P(LongBatch, ARowThatIsThereTwiceOrOfAnotherShardIsRefused) {
  const auto one = finished(1), out = folder.path("merged" + GetParam());
  for (const auto& [rows, said] : std::vector<std::pair<std::vector<std::string>, std::string>>{
           {{row(1), row(69'997 / shards * shards + 1), row(1)}, "holds a row for 1.csv, which "},
           {{row(1), row(2)}, "holds a row for 2.csv, which is none of its inputs"}}) {
    const auto result = run_fracfit({"merge", one, unfinished(2, rows), "--out", out});
    EXPECT_EQ(result.code, 3);
    EXPECT_NE(result.error.find(said), std::string::npos) << result.error;
    EXPECT_FALSE(std::filesystem::exists(out));
  }
}

TEST_F(Batch, MergeDoesNotReplaceAnInput) {
  const auto one = folder.path("one.csv");
  const auto two = folder.path("two.csv");
  EXPECT_EQ(run_fracfit(command({"--shard", "1/2", "--out", one})).code, 0);
  EXPECT_EQ(run_fracfit(command({"--shard", "2/2", "--out", two})).code, 0);
  const auto before = content_of(one);
  for (const auto& again : {one, folder.path("data/../one.csv")}) {
    const auto result = run_fracfit({"merge", "--out", again, one, two});
    EXPECT_EQ(result.code, 2);
    EXPECT_NE(result.error.find("is also the input"), std::string::npos) << result.error;
    EXPECT_EQ(content_of(one), before);
  }
}

TEST_F(Batch, WhatIsMissingIsNamedAndCanBeDoneAfterwards) {
  const auto single = whole("all.csv");
  const auto one = folder.path("one.csv");
  const auto merged = folder.path("merged.csv");
  EXPECT_EQ(run_fracfit(command({"--shard", "1/2", "--out", one})).code, 0);
  const auto result = run_fracfit({"merge", "--out", merged, one});
  EXPECT_EQ(result.code, 1);
  EXPECT_NE(result.error.find("3 of 7 files are missing"), std::string::npos) << result.error;
  EXPECT_NE(result.error.find("force_2.csv"), std::string::npos) << result.error;
  EXPECT_EQ(run_fracfit(command({"--out", merged})).code, 0);
  EXPECT_EQ(content_of(merged), single);
}

TEST_F(Batch, ResultsOfAnotherCommandAreNotOverwritten) {
  const auto single = whole("all.csv");
  const auto other = run_fracfit(command({"--out", folder.path("all.csv"), "--seed", "2"}));
  EXPECT_EQ(other.code, 2);
  EXPECT_NE(other.error.find("holds the results of another command"), std::string::npos) << other.error;
  EXPECT_EQ(content_of(folder.path("all.csv")), single);
  const auto data = content_of(folder.path("data/force_1.csv"));
  EXPECT_EQ(run_fracfit(command({"--out", folder.path("data/force_1.csv")})).code, 3);
  EXPECT_EQ(content_of(folder.path("data/force_1.csv")), data);
}

TEST_F(Batch, WrongUsageIsNamed) {
  const auto data = folder.path("data");
  const auto expect_refusal = [](const std::vector<std::string>& more, const std::string& part) {
    std::vector<std::string> arguments{"batch"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const auto result = run_fracfit(arguments);
    EXPECT_EQ(result.code, 2);
    EXPECT_EQ(result.output, "");
    EXPECT_NE(result.error.find(part), std::string::npos) << result.error;
  };
  expect_refusal({data}, "either --model");
  expect_refusal({data, "--model", "gain", "--models", "gain"}, "either --model");
  expect_refusal({data, "--model", "power-law", "--shard", "4/3"}, "1 <= i <= n");
  expect_refusal({data, "--model", "power-law", "--shard", "0/3"}, "--shard '0'");
  expect_refusal({data, "--model", "power-law", "--shard", "2"}, "expected i/n");
  expect_refusal({data, "--model", "power-law", "--fix", "b=1"}, "'b' does not occur");
  expect_refusal({data, "--model", "power-law", "--bound", "a=2:1"}, "lies above");
  expect_refusal({data, "--model", "power-law", "--power-law", "K"}, "PARAMETER:VARIABLE");
  expect_refusal({data, "--model", "power-law", "--power-law", "b:force_n"}, "'b' is no parameter");
  expect_refusal({data, "--models", "power-law", "--power-law", "K:force_n"},
                 "--power-law has no meaning with --models");
  expect_refusal({data, "--model", "rms s^a"}, "two columns 'rms'");
  expect_refusal({data, data, "--model", "power-law"}, "given twice");
  expect_refusal({"-", "--model", "power-law"}, "not standard input");
  const TemporaryFolder empty;
  expect_refusal({empty.path(), "--model", "power-law"}, "holds no file");
}

}  // namespace
