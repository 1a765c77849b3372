// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include "generators.hpp"
#include "tools/run_program.hpp"

namespace {

using fuzz::Random;

// Valid command lines that take no time, as words.
std::vector<std::vector<std::string>> templates(const std::string& data, const std::string& fit) {
  return {
      {"simulate", "--force", "20", "--clearance", "0.3", "--restitution", "0.6", "--omega", "5:6:3"},
      {"simulate", "--force", "20", "--clearance", "0.3", "--omega", "5:6:3", "--model", "static"},
      {"fit", data, "--model", "K/(T s + 1)", "--component", "both", "--where", "omega<4", "--fix", "T=1"},
      {"identify", data, "--models", "gain,lag", "--weight", "absolute"},
      {"batch", data, "--model", "gain", "--by", "omega_rad_s"},
      {"approximate", "--order", "0.5", "--band", "0.1:10", "--poles", "3", "--method", "oustaloup"},
      {"respond", "--model", "1/(s + 1)", "--time", "0:1:3", "--input", "step"},
      {"mittag-leffler", "--alpha", "0.5", "--beta", "1", "--z", "-1,2"},
      {"analyse", "--model", "1/(s + 1)", "--format", "json"},
      {"controller", "--kp", "1", "--sample-time", "0.01", "--band", "0.1:10"},
      {"merge", data, data, "--out", "-"},
      {"merge", data, "--status"},
      {"limit-cycles", "--controller", "2 + s", "--restitution", "0.6", "--starts", "0"},
      {"limit-cycles", "--controller", "2 + s", "--restitution", "0.6", "--load-receptance", "1/(s^2 + b s)", "--over",
       "b=0:0.5:3"},
      {"loop", "--controller", "exp(-0.1 s) (2 + s)", "--restitution", "0.6", "--setpoint-step", "1", "--duration", "5",
       "--every", "1"},
      {"loop", "--controller", "2 + s^0.5", "--restitution", "0.6", "--velocity2", "1", "--sample-time", "0.01",
       "--force-limit", "0.5", "--duration", "1"},
      {"tune", "--fit", fit, "--crossover", "0.3", "--phase-margin", "60", "--structure", "pi", "--lambda", "0.9"},
      {"joint-fit", data, "--by", "omega_rad_s", "--model", "K s^a", "--shared", "a", "--law", "K = K0 omega_rad_s^p"},
      {"drt", "--fit", fit, "--tau", "0.1:10:5log"},
      {"response", data, "--columns", "time=1,input=2,output=3", "--excitation", "arbitrary"},
      {"multisine", "--band", "1:50", "--period", "2", "--sample-time", "0.01", "--lines", "odd", "--rounds", "5"},
      {"validate", data, "--level", "0.1"},
      {"evaluate", "K/(T s + 1)", "--fix", "K=1", "--fix", "T=2", "--omega", "1:2:3", "--derivatives"},
      {"convert", data, "--columns", "f=1,re=2,im=3", "--frequency-unit", "Hz"},
      {"export", "c99", "--kp", "1", "--ki", "1", "--lambda", "0.8", "--sample-time", "0.01", "--band", "0.1:10"},
      {"export", "spice", "1/(s^0.5 + 1)", "--kind", "transfer", "--band", "1:10", "--tolerance", "0.1"},
      {"cluster-script", "--slurm", "--shards", "4", "batch", data, "--model", "zarc", "--out", "rows.csv"},
  };
}

// Words that mean trouble: limits, other units, other options, nothing.
const std::vector<std::string> odd_words{
    "",         "-",  "--",   "nan",      "inf",  "-1",    "0",     "1e400",  "1:0:5",   "0:1:1",   "0:1:-3",
    "1,,2",     "=",  "K=",   "omega<<4", "\xff", "'",     "--out", "--xyz",  "--force", "--model", "s^s",
    "1/0",      "(",  "--by", "im<x",     "re=1", "a:b:c", ":",     "1e-400", "0x10",    "１",      "--threads=2000",
    "--format", "csv"};

constexpr const char* curve = "omega_rad_s,re,im\n1,1,-1\n2,1,-2\n3,1,-3\n4,1,-4\n5,1,-5\n";

// A result of fit.
std::string fit_of(const TemporaryFolder& folder, const std::string& data) {
  const auto file = folder.path("fit.json");
  const auto result = run_fracfit({"fit", data, "--model", "K/(T s + 1)", "--component", "both", "--out", file});
  EXPECT_EQ(result.code, 0) << result.error;
  return file;
}

void expect_no_names_of_code(const std::string& text, const std::string& command) {
  for (const char* name : {"std::", "boost::", "vector::", "filesystem error", "basic_string", "what()",
                           "TransferFunction", "json.exception"})
    EXPECT_EQ(text.find(name), std::string::npos) << command << text;
}

TEST(ProgramFuzz, AnyCommandLineEndsWithAnExitCodeAndASentence) {
  Random random(fuzz::seed(7));
  const TemporaryFolder folder;
  const auto data = folder.write("curve.csv", curve);
  const auto commands = templates(data, fit_of(folder, data));
  for (std::size_t i = 0; i < fuzz::cases(250); ++i) {
    auto words = fuzz::one_of(random, commands);
    for (std::size_t k = 1 + random.below(2); k > 0; --k) {
      const std::size_t at = 1 + random.below(words.size() - 1);
      const auto place = words.begin() + static_cast<std::ptrdiff_t>(at);
      switch (random.below(4)) {
        case 0:
          words[at] = fuzz::one_of(random, odd_words);
          break;
        case 1:
          words.erase(place);
          break;
        case 2:
          words.insert(place, fuzz::one_of(random, odd_words));
          break;
        default:
          words[at] = fuzz::damaged(random, words[at]);
      }
      if (words.size() < 2) break;
    }
    // A program is given its words without zero bytes.
    for (auto& word : words) std::erase(word, '\0');
    std::string text;
    for (const auto& word : words) text += word + " ";
    const auto result = run_fracfit(words);
    EXPECT_GE(result.code, 0) << text << result.error;
    EXPECT_LE(result.code, 3) << text << result.error;
    if (result.code != 0) {
      EXPECT_TRUE(result.error.find("fracfit: ") != std::string::npos) << text << result.error;
    }
    expect_no_names_of_code(result.error, text);
  }
}

// Folders, devices, nothing, noise, and files of another kind or cut in the middle, wherever a file is read.
TEST(ProgramFuzz, AnyFileIsReadOrRefusedInASentence) {
  Random random(fuzz::seed(10));
  const TemporaryFolder folder;
  const auto data = folder.write("curve.csv", curve);
  const auto fit = fit_of(folder, data);
  const std::string text = content_of(fit);
  std::string noise, deep(20'000, '[');
  for (int i = 0; i < 500; ++i) noise += static_cast<char>(random.below(256));
  std::vector<std::string> files{folder.path(),
                                 folder.path("absent"),
                                 "/dev/null",
                                 folder.write("empty", ""),
                                 folder.write("noise", noise),
                                 folder.write("deep.json", deep),
                                 folder.write("list.json", "[1, {}]"),
                                 data,
                                 fit};
  if (std::filesystem::exists("/dev/zero")) files.emplace_back("/dev/zero");
  for (std::size_t i = 0; i < fuzz::cases(6); ++i)
    files.push_back(folder.write("cut" + std::to_string(i) + ".json", fuzz::cut(random, text)));
  for (const char* value : {"null", "\"x\"", "1e999", "-1", "[]"}) {
    auto other = text;
    const std::string key = "\"value\": ";
    for (auto at = other.find(key); at != std::string::npos; at = other.find(key, at + 1))
      other.replace(at + key.size(), other.find_first_of(",\n", at) - at - key.size(), value);
    files.push_back(folder.write("value" + std::to_string(files.size()) + ".json", other));
  }
  const std::vector<std::vector<std::string>> commands{
      {"fit", "@", "--model", "gain"},
      {"identify", "@", "--models", "gain,lag"},
      {"joint-fit", "@", "--by", "omega_rad_s", "--model", "K s^a", "--shared", "a"},
      {"identify-scene", "@", "--fix", "mass1=1", "--fix", "mass2=1", "--fix", "clearance=1"},
      {"batch", "@", "--model", "gain"},
      {"validate", "@"},
      {"convert", "@"},
      {"drt", "@"},
      {"response", "@"},
      {"response", "@", "--columns", "input=1,output=2", "--sample-time", "0.1"},
      {"drt", "--fit", "@", "--tau", "1,2"},
      {"evaluate", "--fit", "@", "--omega", "1,2"},
      {"tune", "--fit", "@", "--crossover", "0.3", "--phase-margin", "60", "--structure", "pi", "--lambda", "0.9"},
      {"tune", "--from-relay", "@", "--crossover", "0.3", "--phase-margin", "60"},
      {"loop", "--controller", "1", "--restitution", "0.6", "--setpoint-file", "@", "--duration", "5"},
      {"respond", "1/(s + 1)", "--input", "@", "--time", "0:1:3"},
      {"merge", "@"},
      {"merge", "@", "--status"}};
  for (const auto& command : commands) {
    for (const std::string& file : files) {
      auto words = command;
      std::replace(words.begin(), words.end(), std::string("@"), file);
      const auto result = run_fracfit(words);
      const std::string line = words[0] + " " + words[1] + " " + file + ": ";
      EXPECT_GE(result.code, 0) << line << result.error;
      EXPECT_LE(result.code, 3) << line << result.error;
      if (result.code != 0) {
        EXPECT_NE(result.error.find("fracfit: "), std::string::npos) << line << result.error;
      }
      expect_no_names_of_code(result.error, line);
    }
  }
}

class BatchFuzz : public testing::Test {
 protected:
  BatchFuzz() {
    std::filesystem::create_directory(folder.path("data"));
    for (int i = 1; i <= 5; ++i) {
      std::string text = "# force_n: " + std::to_string(i) + "\nomega_rad_s,re,im\n";
      for (int k = 1; k <= 6; ++k) text += std::to_string(k) + "," + std::to_string(i) + ",0\n";
      folder.write("data/" + std::to_string(i) + ".csv", text);
    }
  }
  [[nodiscard]] std::vector<std::string> batch(const std::vector<std::string>& more) const {
    std::vector<std::string> words{"batch", folder.path("data"), "--model", "gain", "--component", "both", "--quiet"};
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }
  TemporaryFolder folder;
};

// What crashes leave behind: a file cut anywhere, or with a block of zeros at its end.
TEST_F(BatchFuzz, ATableLeftByACrashBecomesTheWholeOneOrIsRefused) {
  Random random(fuzz::seed(8));
  for (const std::string name : {"all.csv", "all.jsonl"}) {
    const auto out = folder.path(name);
    ASSERT_EQ(run_fracfit(batch({"--out", out})).code, 0);
    const auto whole = content_of(out);
    for (std::size_t i = 0; i < fuzz::cases(40); ++i) {
      std::string left = fuzz::cut(random, whole);
      if (random.below(4) == 0) left += std::string(1 + random.below(100), '\0');
      folder.write(name, left);
      const auto result = run_fracfit(batch({"--out", out}));
      if (result.code == 0) {
        EXPECT_EQ(content_of(out), whole) << left;
      } else {
        EXPECT_EQ(content_of(out), left) << result.error;
      }
      EXPECT_LE(result.code, 3) << result.error;
    }
  }
}

TEST_F(BatchFuzz, NoDamagedShardIsAccepted) {
  Random random(fuzz::seed(9));
  for (const std::string extension : {".csv", ".jsonl"}) {
    const auto one = folder.path("1" + extension), two = folder.path("2" + extension);
    const auto out = folder.path("merged" + extension);
    ASSERT_EQ(run_fracfit(batch({"--shard", "1/2", "--out", one})).code, 0);
    ASSERT_EQ(run_fracfit(batch({"--shard", "2/2", "--out", two})).code, 0);
    const std::vector<std::string> merge{"merge", one, two, "--out", out};
    ASSERT_EQ(run_fracfit(merge).code, 0) << "undamaged";
    const auto good = content_of(two);
    std::size_t damaged = 0, accepted = 0;
    for (std::size_t i = 0; i < fuzz::cases(60); ++i) {
      const auto bad = random.below(3) == 0 ? fuzz::cut(random, good) : fuzz::damaged(random, good);
      if (bad == good) continue;
      ++damaged;
      folder.write("2" + extension, bad);
      std::filesystem::remove(out);
      const auto result = run_fracfit(merge);
      EXPECT_GE(result.code, 0);
      accepted += result.code == 0 ? 1 : 0;
    }
    EXPECT_EQ(accepted, 0U) << "of " << damaged << " " << extension;
  }
}

}  // namespace
