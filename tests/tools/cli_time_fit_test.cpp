// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "run_program.hpp"
#include "support/random.hpp"

namespace {

using Json = nlohmann::json;
const std::string furnace = "1/(0.8 s^2.2 + 0.5 s^0.9 + 1)";
const std::string structure = "1/(a2 s^q2 + a1 s^q1 + 1)";

// 301 exact samples of the furnace step as a file of time_s,input,output.
std::string furnace_file() {
  const auto response = run_fracfit({"respond", "--model", furnace, "--time", "0:15:301", "--method", "reference"});
  EXPECT_EQ(response.code, 0) << response.error;
  std::istringstream lines(response.output);
  std::string text = "time_s,input,output\n";
  for (std::string line; std::getline(lines, line);) {
    const std::size_t comma = line.find(',');
    if (line[0] == '#' || line[0] == 't') continue;
    text += line.substr(0, comma) + ",1," + line.substr(comma + 1) + "\n";
  }
  return text;
}

double value_of(const Json& json, const std::string& name) {
  for (const auto& parameter : json["parameters"]) {
    if (parameter["name"] == name) return parameter["value"].get<double>();
  }
  ADD_FAILURE() << "no parameter " << name;
  return 0;
}

void expect_failure(const std::vector<std::string>& arguments, int code, const std::string& part) {
  const auto result = run_fracfit(arguments);
  EXPECT_EQ(result.code, code) << part << ": " << result.error;
  EXPECT_EQ(result.output, "");
  EXPECT_NE(result.error.find(part), std::string::npos) << result.error;
}

}  // namespace

TEST(TimeFit, OrdersOfTheFurnaceComeBack) {
  const TemporaryFolder folder;
  const std::string text = furnace_file();
  const std::string file = folder.write("step.csv", text);
  const auto from_start = run_fracfit(
      {"fit", file, "--model", structure, "--start", "a2=1", "--start", "q2=2", "--start", "a1=1", "--start", "q1=1"});
  const auto without = run_fracfit({"fit", "-", "--model", structure}, {"", text});
  for (const auto& result : {from_start, without}) {
    ASSERT_EQ(result.code, 0) << result.error;
    const Json json = Json::parse(result.output);
    EXPECT_NEAR(value_of(json, "q2"), 2.2, 1e-9);
    EXPECT_NEAR(value_of(json, "q1"), 0.9, 1e-9);
    EXPECT_NEAR(value_of(json, "offset"), 0, 1e-9);
    EXPECT_EQ(json["data"]["points"], 301);
    EXPECT_EQ(json["data"]["time_to_s"], 15);
    EXPECT_EQ(json["termination"], "converged");
    EXPECT_EQ(json["options"]["offset"], "free");
  }
  // The command in the output makes the same output.
  const Json first = Json::parse(from_start.output);
  EXPECT_NE(first["command"].get<std::string>().find("--start q2=2"), std::string::npos);
}

TEST(TimeFit, UnitsWeightsAndFormats) {
  const TemporaryFolder folder;
  std::string text = "t [ms];u [V];y [K];std [K]\n";
  for (int n = 0; n <= 200; ++n) {
    const double t = 0.02 * n;
    text += std::to_string(1000 * t) + ";2;" + std::to_string(5 + 6 * -std::expm1(-t)) + ";0.1\n";
  }
  const std::string file = folder.write("lag.csv", text);
  const auto result = run_fracfit({"fit", file, "--model", "K/(T s + 1)"});
  ASSERT_EQ(result.code, 0) << result.error;
  const Json json = Json::parse(result.output);
  // Six decimals in the file.
  EXPECT_NEAR(value_of(json, "K"), 3, 1e-5);
  EXPECT_NEAR(value_of(json, "T"), 1, 1e-5);
  EXPECT_NEAR(value_of(json, "offset"), 5, 1e-5);
  EXPECT_EQ(json["options"]["weight"], "given");
  const auto table = run_fracfit({"fit", file, "--model", "K/(T s + 1)", "--format", "table", "--offset", "5"});
  EXPECT_NE(table.output.find("0 .. 4 s"), std::string::npos) << table.output;
  EXPECT_NE(table.output.find("offset 5"), std::string::npos) << table.output;
  const auto csv = run_fracfit({"fit", file, "--model", "K/(T s + 1)", "--format", "csv", "--weight", "absolute"});
  EXPECT_NE(csv.output.find("# weight: absolute"), std::string::npos) << csv.output;
}

TEST(TimeFit, HelpNamesWhatDoesNotApply) {
  const auto help = run_fracfit({"fit", "--help"}).output;
  const auto from = help.find("Samples over time take");
  ASSERT_NE(from, std::string::npos) << help;
  const auto sentence = help.substr(from, help.find("--memory.", from) - from + 9);
  for (const char* option :
       {"--weight", "--component", "--realisation", "--band", "--poles", "--sample-time", "--memory", "--where"})
    EXPECT_NE(sentence.find(option), std::string::npos) << option;
}

TEST(TimeFit, WhatIsWrongIsNamed) {
  const TemporaryFolder folder;
  const std::string good = folder.write("good.csv", "time_s,input,output\n0,1,0\n1,1,1\n2,1,1.5\n3,1,1.7\n");
  for (const auto& [option, value] : {std::pair{"--component", "both"},
                                      {"--where", "omega<4"},
                                      {"--weight", "relative"},
                                      {"--weight", "log-complex"},
                                      {"--bootstrap", "5"},
                                      {"--fix", "offset=a"},
                                      {"--bound", "offset=0:1"},
                                      {"--realisation", "ladder"}}) {
    expect_failure({"fit", good, "--model", "K/(T s + 1)", option, value}, 2, option);
  }
  expect_failure({"fit", good, "--model", "K/(T s + 1)", "--loss", "hubert"}, 2, "none, huber or cauchy");
  expect_failure({"fit", good, "--model", "K/(T s + 1)", "--where", "omega<4"}, 2, "t (s), input or output");
  expect_failure({"fit", good, "--model", "K/(T s + 1)", "--hold", "second"}, 2,
                 "zero-order, first-order or band-limited");
  expect_failure({"fit", good, "--model", "K/(T s + 1)", "--offset", "some"}, 2, "--offset");
  expect_failure({"fit", good, "--model", "K/(T s + 1)", "--weight", "given"}, 3, "no column sigma");
  expect_failure({"fit", good, "--model", "a/(b s^c + d s^e + f)"}, 2, "4 samples");
  expect_failure({"fit", good, "--model", "tanh(T s)"}, 2, "tanh");
  const auto file = [&](const std::string& text) { return folder.write("bad.csv", text); };
  expect_failure({"fit", file("time_s,input,output\n0,1,0\n1,1,x\n"), "--model", "K/(s + 1)"}, 3, "bad.csv:3:5");
  expect_failure({"fit", file("time_s,input,output\n0,1,0\n0,1,1\n"), "--model", "K/(s + 1)"}, 3, "a time after 0");
  expect_failure({"fit", file("time_s,input,output\n0,1,inf\n"), "--model", "K/(s + 1)"}, 3, "finite");
  expect_failure({"fit", file("time_s,x,output\n0,1,0\n"), "--model", "K/(s + 1)"}, 3, "no input");
  expect_failure({"fit", file("time_days,u,y\n0,1,0\n"), "--model", "K/(s + 1)"}, 3, "'days'; expected s, ms");
  expect_failure({"fit", file("t,u,y,sigma\n0,1,0,0\n"), "--model", "K/(s + 1)"}, 3, "must be > 0");
  expect_failure({"fit", file("t,u,y\n0,0,0\n1,0,1\n"), "--model", "K/(s + 1)"}, 3, "nothing drives");
  expect_failure({"fit", file("t,u,y\n0,1,0\n"), "--model", "K/(s + 1)"}, 3, "one sample; expected at least two");
  expect_failure({"fit", good, "--model", "K/(T s + 1)", "--where", "t>7"}, 3, "no sample satisfies");
  expect_failure({"identify", good, "--force", "40"}, 2, "--force");
  const auto frequency = folder.write("curve.csv", "omega_rad_s,re,im\n1,1,-1\n2,1,-1\n3,1,-1\n");
  expect_failure({"fit", frequency, "--model", "K/(T s + 1)", "--hold", "zero-order"}, 2, "--hold");
}

// An output that does not move: exit code 1 with a sentence.  So for one that its offset explains alone, and for a dead
// time beyond the record.
TEST(TimeFit, WhatCannotBeIdentifiedIsSaid) {
  const TemporaryFolder folder;
  std::string constant = "time_s,input,output\n", moving = constant;
  for (int n = 0; n < 50; ++n) {
    constant += std::to_string(n) + ",1,5\n";
    moving += std::to_string(n) + ",1," + std::to_string(-std::expm1(-0.1 * n)) + "\n";
  }
  const auto still = run_fracfit({"fit", folder.write("still.csv", constant), "--model", "K/(T s + 1)"});
  EXPECT_EQ(still.code, 1);
  EXPECT_NE(still.error.find("The output is 5 throughout"), std::string::npos) << still.error;
  EXPECT_TRUE(Json::parse(still.output)["parameters"][0]["value"].is_null());
  const auto late =
      run_fracfit({"fit", folder.write("moving.csv", moving), "--model", "K exp(-L s)/(T s + 1)", "--fix", "L=60"});
  EXPECT_EQ(late.code, 1);
  EXPECT_NE(late.error.find("is 60 s"), std::string::npos) << late.error;
}

// A step response of 1/(s + 1) with one sample of 200 far off, which stays in the fit.
TEST(TimeFit, OutlierIsNamedWithWhatHelps) {
  const TemporaryFolder folder;
  support::Random random(5);
  std::string text = "time_s,input,output\n";
  for (int i = 0; i < 200; ++i) {
    const double t = 0.05 * i, output = 1 - std::exp(-t) + 0.01 * random.normal() + (i == 100 ? 3 : 0);
    text += std::to_string(t) + ",1," + std::to_string(output) + "\n";
  }
  const std::string file = folder.write("off.csv", text);
  const auto plain = run_fracfit({"fit", file, "lag", "--format", "table"});
  EXPECT_NE(plain.output.find("1 outlier at t = 5 s"), std::string::npos) << plain.output;
  EXPECT_NE(plain.output.find("--loss huber"), std::string::npos) << plain.output;
  const auto robust = run_fracfit({"fit", file, "lag", "--loss", "huber"});
  // Four standard errors: 0.01 of noise on 200 samples leaves T to 0.003.
  EXPECT_NEAR(value_of(Json::parse(robust.output), "T"), 1, 0.012) << robust.output;
  EXPECT_EQ(
      run_fracfit({"fit", file, "lag", "--loss", "huber", "--format", "table"}).output.find("--loss huber bounds"),
      std::string::npos);
}

// A dead time that noise hides: two standard errors below it there is none.
TEST(TimeFit, DeadTimeHasNoIntervalBelowZero) {
  const TemporaryFolder folder;
  support::Random random(5);
  std::string text = "time_s,input,output\n";
  for (int i = 0; i < 100; ++i) {
    const double t = 0.1 * i, output = t < 0.15 ? 0 : 1 - std::exp(0.15 - t);
    text += std::to_string(t) + ",1," + std::to_string(output + 0.3 * random.normal()) + "\n";
  }
  const auto fit = run_fracfit({"fit", folder.write("noisy.csv", text), "lag-delay"});
  const Json delay = Json::parse(fit.output)["parameters"][1];
  ASSERT_EQ(delay["name"], "L") << fit.output;
  ASSERT_LT(delay["value"].get<double>(), 1.9 * delay["standard_error"].get<double>()) << fit.output;
  EXPECT_EQ(delay["ci95"][0], 0) << fit.output;
}

TEST(TimeFit, WhatFitsOverFrequencyOfferIsThereOverTime) {
  const TemporaryFolder folder;
  support::Random random(7);
  std::string text = "time_s,input,output\n";
  for (int n = 0; n <= 150; ++n) {
    const double t = 0.04 * n;
    const double noise = n % 25 == 7 ? 2 : 0.01 * random.normal();
    text += std::to_string(t) + ",2," + std::to_string(1 + 6 * -std::expm1(-t) + noise) + "\n";
  }
  const std::string file = folder.write("lag.csv", text);
  const auto fit = run_fracfit({"fit", file, "--model", "K/(T s + 1)", "--loss", "cauchy", "--profile", "--bootstrap",
                                "40", "--fix", "offset=1", "--where", "t<5.5"});
  ASSERT_EQ(fit.code, 0) << fit.error;
  const Json json = Json::parse(fit.output);
  EXPECT_EQ(json["data"]["points"], 138);
  EXPECT_EQ(json["options"]["loss"], "cauchy");
  EXPECT_EQ(json["options"]["where"], "t<5.5");
  ASSERT_EQ(json["outliers"].size(), 6u);
  EXPECT_EQ(json["outliers"][1]["time_s"], 1.28);
  ASSERT_EQ(json["parameters"].size(), 2u);
  for (const auto& parameter : json["parameters"]) {
    // Several times the standard error of about 2e-3.
    EXPECT_NEAR(parameter["value"].get<double>(), parameter["name"] == "K" ? 3 : 1, 0.01);
    for (const char* interval : {"profile_ci95", "bootstrap_ci95"}) {
      EXPECT_LT(parameter[interval][0], parameter["value"]) << interval;
      EXPECT_GT(parameter[interval][1], parameter["value"]) << interval;
    }
  }
  // The command in the output makes the same output.
  EXPECT_NE(json["command"].get<std::string>().find(
                "--loss cauchy --hold zero-order --offset 1 --input-at-rest 0 --noise white "
                "--where 't<5.5' --seed 1"),
            std::string::npos)
      << json["command"];
  const auto grown = run_fracfit({"fit", file, "--grow", "denominator", "--loss", "huber"});
  ASSERT_EQ(grown.code, 0) << grown.error;
  EXPECT_EQ(Json::parse(grown.output)["growth"]["chosen"], 0);
  const auto ranked = run_fracfit(
      {"identify", file, "--models", "lag,fractional-lag,cole-davidson", "--loss", "huber", "--folds", "4"});
  ASSERT_EQ(ranked.code, 0) << ranked.error;
  const Json ranking = Json::parse(ranked.output);
  EXPECT_EQ(ranking["chosen"], "lag");
  EXPECT_EQ(ranking["verdict"], "not-supported");
  EXPECT_EQ(ranking["ranking"].size(), 2u);  // K/(1 + T s)^b is no ratio of sums of powers
  EXPECT_GT(ranking["ranking"][0]["prediction_rms"], 0);
}

// A multisine of 3.4 samples per period of its highest line in the steady state: the parameters come back to the digits
// of the solver, and under any other hold the answer names the option.
TEST(TimeFit, ABandLimitedInputIsAnsweredExactly) {
  const TemporaryFolder folder;
  const auto drive = run_fracfit(
      {"multisine", "--band", "1:18", "--period", "6.8", "--sample-time", "0.1", "--lines", "full", "--periods", "2"});
  ASSERT_EQ(drive.code, 0) << drive.error;
  const std::string input = folder.write("drive.csv", drive.output);
  const auto response =
      run_fracfit({"respond", "--model", "2/(1.5 s^0.7 + 1)", "--input", input, "--hold", "band-limited"});
  ASSERT_EQ(response.code, 0) << response.error;
  std::string text = "time_s,input,output\n";
  std::istringstream inputs(drive.output), outputs(response.output);
  support::Random random(1);
  for (std::string in, out; std::getline(inputs, in);) {
    if (in[0] == '#' || in[0] == 't') continue;
    do std::getline(outputs, out);
    while (out[0] == '#' || out[0] == 't');
    const double value = std::stod(out.substr(out.find(',') + 1)) + 0.005 * random.normal();
    text += in + "," + std::to_string(value) + "\n";
  }
  const std::string file = folder.write("record.csv", text);
  const auto exact = run_fracfit({"fit", file, "--model", "K/(T s^a + 1)", "--hold", "band-limited"});
  ASSERT_EQ(exact.code, 0) << exact.error;
  const Json json = Json::parse(exact.output);
  for (const auto& parameter : json["parameters"]) {
    const std::string name = parameter["name"];
    if (name == "offset") continue;
    const double truth = name == "K" ? 2 : name == "T" ? 1.5 : 0.7;
    // Four standard errors.
    EXPECT_NEAR(parameter["value"].get<double>(), truth, 4 * parameter["standard_error"].get<double>()) << name;
  }
  EXPECT_NE(json["message"].get<std::string>().find("repeats itself every 6.8 s"), std::string::npos) << exact.output;
  const auto straight = run_fracfit({"fit", file, "--model", "K/(T s^a + 1)", "--hold", "first-order"});
  EXPECT_NE(straight.output.find("--hold band-limited"), std::string::npos) << straight.output;
}

// A band-limited input is a property of the samples: where they cannot have it, it is the file that is at fault.
TEST(TimeFit, ABandLimitedInputNeedsEvenStepsAndChange) {
  const TemporaryFolder folder;
  const auto uneven =
      folder.write("uneven.csv", "time_s,input,output\n0,0,0\n1,1,1\n2,0,1\n3.5,1,1\n4.5,0,1\n5.5,1,1\n");
  const auto steady = folder.write("steady.csv", "time_s,input,output\n0,1,0\n1,1,1\n2,1,1\n3,1,1\n4,1,1\n5,1,1\n");
  for (const auto& [file, part] : {std::pair(uneven, "even steps"), std::pair(steady, "does not change")}) {
    const auto result = run_fracfit({"fit", file, "--model", "K/(T s + 1)", "--hold", "band-limited"});
    EXPECT_EQ(result.code, 3) << result.error;
    EXPECT_NE(result.error.find(part), std::string::npos) << result.error;
    EXPECT_NE(result.error.find(file), std::string::npos) << result.error;
  }
}

// The correlation of n samples is known to 1/sqrt(n) in atanh r; three of that.
TEST(TimeFit, NoiseIsColouredWhereThatIsTold) {
  const TemporaryFolder folder;
  support::Random random(3);
  constexpr double r = 0.8;
  constexpr int count = 200;
  std::string text = "time_s,input,output\n";
  double input = 1, state = 0, noise = random.normal();
  for (int i = 0; i < count; ++i) {
    text += std::to_string(0.1 * i) + "," + std::to_string(input) + "," + std::to_string(state + 0.05 * noise) + "\n";
    // A lag of 1 s under a held input, exactly.
    state += (2 * input - state) * -std::expm1(-0.1);
    noise = r * noise + std::sqrt(1 - r * r) * random.normal();
    if (i % 10 == 9) input = random.normal();
  }
  const std::string file = folder.write("record.csv", text);
  const auto answer = [&](const std::vector<std::string>& arguments) {
    const auto result = run_fracfit(arguments);
    EXPECT_EQ(result.code, 0) << result.error;
    return Json::parse(result.output);
  };
  const Json white = answer({"fit", file, "--model", "K/(T s + 1)"});
  const Json coloured = answer({"fit", file, "--model", "K/(T s + 1)", "--noise", "coloured"});
  EXPECT_EQ(white["options"]["noise"], "white");
  EXPECT_EQ(coloured["options"]["noise"], "coloured");
  EXPECT_NEAR(std::atanh(coloured["noise_correlation"].get<double>()), std::atanh(r), 3 / std::sqrt(count));
  // What is left of the residuals is white, which it is not before.
  EXPECT_LT(white["whiteness"]["p_value"].get<double>(), 1e-3);
  EXPECT_GT(coloured["whiteness"]["p_value"].get<double>(), 1e-3);
  const std::vector<std::string> ranking{"identify", file, "--models", "lag,fractional-lag", "--format", "json"};
  const Json of_itself = answer(ranking);
  EXPECT_EQ(of_itself["options"]["noise"], "coloured");
  EXPECT_GT(of_itself["noise_correlation"].get<double>(), 0.5);
  std::vector<std::string> told = ranking;
  told.insert(told.end(), {"--noise", "white"});
  const auto held = run_fracfit(told);
  EXPECT_EQ(Json::parse(held.output)["noise_correlation"], 0) << held.error;

  expect_failure({"fit", file, "--model", "lag", "--noise", "pink"}, 2, "white or coloured");
  const std::string response =
      folder.write("response.csv", "omega_rad_s,re,im\n1,1,-1\n2,.5,-.6\n3,.3,-.4\n4,.2,-.3\n");
  expect_failure({"fit", response, "--model", "lag", "--noise", "coloured"}, 2, "--noise");
}
