// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <complex>
#include <deque>
#include <nlohmann/json.hpp>
#include <numbers>
#include <random>
#include <string>
#include <tuple>
#include <vector>

#include "run_program.hpp"

namespace {

using Json = nlohmann::ordered_json;
using Complex = std::complex<double>;

// A relay with hysteresis about 2 exp(-0.5 s)/(3 s + 1), noise of 5 mV in an output of some volts.  The lag is advanced
// exactly for the held input, so that the record is that of the plant.
TEST(CliTune, TunesFromARelayExperiment) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> noise(0, 0.005);
  constexpr double step = 0.05, decay = 3;
  std::deque<double> delayed(10, 0.0);
  double output = 0, relay = 1;
  std::string text = "time_s,input,output\n";
  for (int n = 0; n < 600; ++n) {
    const double measured = output + noise(random);
    if (std::abs(measured) > 0.1) relay = measured > 0 ? -1 : 1;
    text += std::to_string(n * step) + "," + std::to_string(relay) + "," + std::to_string(measured) + "\n";
    delayed.push_back(relay);
    const double share = std::exp(-step / decay);
    output = output * share + 2 * delayed.front() * (1 - share);
    delayed.pop_front();
  }
  const TemporaryFolder folder;
  const auto result = run_fracfit(
      {"tune", "--from-relay", folder.write("relay.csv", text), "--crossover", "1.5", "--phase-margin", "55"});
  ASSERT_EQ(result.code, 0) << result.error;
  const Json json = Json::parse(result.output);
  EXPECT_EQ(json["region"]["not_stable"], 0);
  EXPECT_LT(json["region"]["least_phase_margin_deg"], 55);
  // What was asked for holds for the true plant as far as the region says.
  const Json& c = json["controller"];
  const Complex s(0, 1.5);
  const Complex loop = 2.0 * std::exp(-0.5 * s) / (3.0 * s + 1.0) *
                       (c["kp"].get<double>() + c["ki"].get<double>() * std::pow(s, -c["lambda"].get<double>()) +
                        c["kd"].get<double>() * std::pow(s, c["mu"].get<double>()));
  const double allowed = 55 - json["region"]["least_phase_margin_deg"].get<double>();
  EXPECT_NEAR(std::arg(-loop) * 180 / std::numbers::pi, 55, 2 * allowed);
  EXPECT_NEAR(std::abs(loop), 1, 0.02);  // the gain is known to about 1 %
}

// The step of a PI about exp(-1 s)/s, by the trapezoidal rule over a ring of one dead time: second
// order, 1e-6 at 2000 steps per dead time.
TEST(CliTune, ForetellsTheStepOfItsLoop) {
  const auto result = run_fracfit({"tune", "--model", "exp(-1 s)/s", "--structure", "pi", "--lambda", "1",
                                   "--crossover", "0.4", "--phase-margin", "45"});
  ASSERT_EQ(result.code, 0) << result.error;
  const Json json = Json::parse(result.output);
  const double kp = json["controller"]["kp"], ki = json["controller"]["ki"];
  constexpr int per_delay = 2000, steps = 60 * per_delay;
  constexpr double h = 1.0 / per_delay;
  std::deque<double> control(per_delay + 1, 0.0);
  double y = 0, integral = 0, peak = 0, settled = 0;
  for (int n = 0; n <= steps; ++n) {
    peak = std::max(peak, y);
    if (std::abs(y - 1) > 0.02) settled = n * h;
    control.push_back(kp * (1 - y) + ki * integral);
    control.pop_front();
    // What the controller gave from t - 1 to t - 1 + h; before 0 nothing.
    const double next = y + (n < per_delay ? 0 : 0.5 * h * (control[0] + control[1]));
    integral += 0.5 * h * ((1 - y) + (1 - next));
    y = next;
  }
  const Json& step = json["setpoint_step"];
  EXPECT_EQ(step["final_value"], 1.0);
  // The response of the program is within 1e-5, the times within 2e-5 of what it looked at.
  EXPECT_NEAR(step["overshoot"].get<double>(), peak - 1, 3e-5);
  EXPECT_NEAR(step["settling_time"].get<double>(), settled, 1e-2);
}

// The reason for exit code 1 is no note that --quiet takes away.
TEST(CliTune, SaysWhyThereIsNoAnswerEvenIfQuiet) {
  const std::vector<std::string> asked{"tune",
                                       "--model",
                                       "exp(-2 s)/(s + 1)",
                                       "--crossover",
                                       "20",
                                       "--phase-margin",
                                       "60",
                                       "--max-sensitivity",
                                       "1.2",
                                       "--format",
                                       "json"};
  const auto told = run_fracfit(asked);
  std::vector<std::string> quietly = asked;
  quietly.emplace_back("--quiet");
  const auto quiet = run_fracfit(quietly);
  EXPECT_EQ(told.code, 1);
  EXPECT_EQ(quiet.code, 1);
  EXPECT_EQ(quiet.output, told.output);
  EXPECT_EQ(quiet.error, told.error);
  EXPECT_NE(quiet.error.find("fracfit: No "), std::string::npos) << quiet.error;
}

TEST(CliTune, RefusesOrdersThatNoDeviceMeans) {
  for (const char* order : {"1e-300", "0.0009", "1.9995", "0.5:2"}) {
    const auto result = run_fracfit({"tune", "--model", "1/(s^1.5 + 1)", "--crossover", "1", "--phase-margin", "50",
                                     std::string("--lambda=") + order, "--quiet"});
    EXPECT_EQ(result.code, 2) << order;
    EXPECT_TRUE(result.output.empty()) << order;
    EXPECT_NE(result.error.find("--lambda"), std::string::npos) << result.error;
    EXPECT_NE(result.error.find("0.001 to 1.999"), std::string::npos) << result.error;
  }
}

// The search takes some seconds and ends soon after its time; nothing is written.
TEST(CliTune, EndsWhenItsTimeIsOver) {
  const auto begin = std::chrono::steady_clock::now();
  const auto result = run_fracfit({"tune", "--model", "exp(-1 s)/(s^1.5 + 0.2 s^0.7 + 1)", "--minimise", "iae",
                                   "--horizon", "1e4", "--max-sensitivity", "1.7", "--time-limit", "0.3"});
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  EXPECT_EQ(result.code, 1);
  EXPECT_TRUE(result.output.empty());
  EXPECT_NE(result.error.find("--time-limit 0.3: the time is over"), std::string::npos) << result.error;
  // A hundred times the limit: the machine may be busy, and the search would take longer still there.
  EXPECT_LT(seconds, 30);
  EXPECT_EQ(run_fracfit({"mittag-leffler", "--alpha", "0.5", "--z", "-1", "--time-limit", "0"}).code, 2);
}

// A relay about a chain of five lags, which no plant that is fitted follows to within such noise.
TEST(CliTune, ARecordThatNoPlantFollowsGivesNoUsableAnswer) {
  std::mt19937_64 random(4);
  std::normal_distribution<double> noise(0, 0.0005);
  std::array<double, 5> chain{};
  double relay = 1;
  std::string text = "time_s,input,output\n";
  for (int n = 0; n < 600; ++n) {
    const double measured = chain.back() + noise(random);
    if (std::abs(measured) > 0.05) relay = measured > 0 ? -1 : 1;
    text += std::to_string(n * 0.1) + "," + std::to_string(relay) + "," + std::to_string(measured) + "\n";
    double input = relay;
    for (double& each : chain) input = each += 0.1 * (input - each);
  }
  const TemporaryFolder folder;
  const auto result = run_fracfit(
      {"tune", "--from-relay", folder.write("relay.csv", text), "--crossover", "0.3", "--phase-margin", "60"});
  EXPECT_EQ(result.code, 1);
  EXPECT_EQ(Json::parse(result.output)["status"], "not-met");
  EXPECT_NE(result.error.find("times the noise"), std::string::npos) << result.error;
}

// The cycle left is the one that limit-cycles finds for that controller, and the constraints say so.
TEST(CliTune, TunesTwoBodiesWithClearance) {
  const std::vector<std::string> bodies{"--mass1", "2", "--restitution", "0.3", "--clearance", "0.01"};
  std::vector<std::string> tune{"tune", "--crossover", "1", "--phase-margin", "35", "--structure", "pd"};
  tune.insert(tune.end(), bodies.begin(), bodies.end());
  const auto result = run_fracfit(tune);
  ASSERT_EQ(result.code, 0) << result.error;
  const Json json = Json::parse(result.output);
  EXPECT_EQ(json["status"], "met");
  const Json& gains = json["controller"];
  std::vector<std::string> cycles{"limit-cycles", "--controller",
                                  gains["kp"].dump() + " + " + gains["kd"].dump() + " s^" + gains["mu"].dump(),
                                  "--format", "json"};
  cycles.insert(cycles.end(), bodies.begin(), bodies.end());
  const auto listed = run_fracfit(cycles);
  ASSERT_EQ(listed.code, 0) << listed.error;
  const Json exact = Json::parse(listed.output)["cycles"];
  const Json& left = json["backlash"]["cycles"];
  ASSERT_EQ(left.size(), 1U);
  ASSERT_EQ(exact.size(), 1U);
  for (const char* key : {"omega", "amplitude_x1", "impact_speed"})
    EXPECT_NEAR(left[0][key].get<double>() / exact[0][key].get<double>(), 1, 1e-9) << key;
  EXPECT_TRUE(json["backlash"]["verified"].get<bool>()) << json["message"];
  EXPECT_LT(json["backlash"]["swing_m"].get<double>(), json["regardless"]["swing_m"].get<double>());
  EXPECT_EQ(json["constraints"].back()["name"], "no limit cycle");
  EXPECT_TRUE(json["constraints"].back()["active"].get<bool>());
  tune.insert(tune.end(), {"--format", "table"});
  EXPECT_NE(run_fracfit(tune).output.find("motion with clearance"), std::string::npos);
  const auto alone = run_fracfit({"tune", "--model", "1/(s + 1)", "--crossover", "1", "--restitution", "0.3"});
  EXPECT_EQ(alone.code, 2);
  EXPECT_NE(alone.error.find("--clearance"), std::string::npos) << alone.error;
}

// (s + 1)^-0.5 has a branch cut that no ratio of powers of s has: the refusal says so and what to do, and that works.
TEST(CliTune, SaysWhatToDoWithAPowerOfASum) {
  const TemporaryFolder folder;
  const std::string formula = "1/(s + 1)^0.5", data = folder.path("plant.csv"), fit = folder.path("plant.json");
  const std::vector<std::string> demands{"--crossover", "3",    "--phase-margin", "60",     "--max-sensitivity",
                                         "1.6",         "--mu", "0.1:0.3",        "--quiet"};
  std::vector<std::string> words{"tune", "--model", formula};
  words.insert(words.end(), demands.begin(), demands.end());
  const auto refused = run_fracfit(words);
  EXPECT_EQ(refused.code, 2);
  for (const char* part : {"(s + 1)^0.5", "power of a sum", "fracfit evaluate", "fracfit fit"})
    EXPECT_NE(refused.error.find(part), std::string::npos) << refused.error;
  ASSERT_EQ(run_fracfit({"evaluate", "--model", formula, "--omega", "0.01:100:60log", "--out", data, "--quiet"}).code,
            0);
  ASSERT_EQ(run_fracfit({"fit", data, "--model",
                         "K (T1 s + 1) (T2 s + 1) (T3 s + 1)/((T4 s + 1) (T5 s + 1) (T6 s + 1) (T7 s + 1))", "--weight",
                         "relative", "--component", "both", "--out", fit, "--quiet"})
                .code,
            0);
  words[1] = "--fit";
  words[2] = fit;
  const auto result = run_fracfit(words);
  ASSERT_EQ(result.code, 0) << result.error;
  const Json c = Json::parse(result.output)["controller"];
  const auto loop = [&](double omega) {
    const Complex s(0, omega);
    return 1.0 / std::sqrt(s + 1.0) *
           (c["kp"].get<double>() + c["ki"].get<double>() * std::pow(s, -c["lambda"].get<double>()) +
            c["kd"].get<double>() * std::pow(s, c["mu"].get<double>()));
  };
  // The ratio differs from the plant by 0.016 of it on the band at most, and |T| <= 1.5 lets through of that to |S|.
  constexpr double error = 0.016;
  EXPECT_NEAR(std::abs(loop(3)), 1, error);
  EXPECT_NEAR(std::arg(-loop(3)), 60 * std::numbers::pi / 180, error);
  for (int i = 0; i <= 400; ++i)
    EXPECT_LT(std::abs(1.0 / (1.0 + loop(0.01 * std::pow(1e4, i / 400.0)))), 1.6 * (1 + 1.5 * error));
}

TEST(CliTune, TakesThePlantFromAFit) {
  const TemporaryFolder folder;
  const auto fit = folder.path("fit.json");
  ASSERT_EQ(run_fracfit({"fit", FRACFIT_SOURCE_DIR "/data/examples/step.csv", "--model", "K exp(-L s)/(T s^a + 1)",
                         "--out", fit})
                .code,
            0);
  const auto result = run_fracfit({"tune", "--fit", fit, "--crossover", "0.3", "--phase-margin", "60"});
  ASSERT_EQ(result.code, 0) << result.error;
  const Json json = Json::parse(result.output);
  EXPECT_GT(json["region"]["max_sensitivity"], json["max_sensitivity"]);
  EXPECT_EQ(json["status"], "met");
  // What the file says of plant and controller gives the margins that are printed, by their definitions.
  const Json fitted = Json::parse(content_of(fit));
  const Json& c = json["controller"];
  const auto loop = [&](double omega, const std::vector<double>& plant) {
    const Complex s(0, omega);
    return plant[0] * std::exp(-plant[1] * s) / (plant[2] * std::pow(s, plant[3]) + 1.0) *
           (c["kp"].get<double>() + c["ki"].get<double>() * std::pow(s, -c["lambda"].get<double>()) +
            c["kd"].get<double>() * std::pow(s, c["mu"].get<double>()));
  };
  const auto largest_sensitivity = [&](const std::vector<double>& plant) {
    double largest = 0;
    for (int i = 0; i <= 600; ++i)
      largest = std::max(largest, std::abs(1.0 / (1.0 + loop(0.003 * std::pow(1e4, i / 600.0), plant))));
    return largest;
  };
  std::vector<double> best;
  for (const char* name : {"K", "L", "T", "a"}) {
    const Json& parameter = fitted["parameters"][best.size()];
    ASSERT_EQ(parameter["name"], name);
    best.push_back(parameter["value"]);
  }
  EXPECT_NEAR(std::abs(loop(0.3, best)), 1, 1e-6);
  EXPECT_NEAR(std::arg(-loop(0.3, best)) * 180 / std::numbers::pi, 60, 1e-4);
  EXPECT_NEAR(largest_sensitivity(best), json["max_sensitivity"], 0.002);
  // The region holds 95 % of the plants that the covariance of the file draws: 500 draws know that share to 1 %, of
  // which three are allowed.  Root L of the covariance, L L' = C, by Cholesky.
  std::vector<std::vector<double>> root(4, std::vector<double>(4));
  const auto covariance = [&](std::size_t i, std::size_t j) {
    return fitted["correlation"][i][j].get<double>() * fitted["parameters"][i]["standard_error"].get<double>() *
           fitted["parameters"][j]["standard_error"].get<double>();
  };
  for (std::size_t i = 0; i < 4; ++i) {
    for (std::size_t j = 0; j <= i; ++j) {
      double rest = covariance(i, j);
      for (std::size_t k = 0; k < j; ++k) rest -= root[i][k] * root[j][k];
      root[i][j] = i == j ? std::sqrt(rest) : rest / root[j][j];
    }
  }
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  constexpr int draws = 500;
  int beyond = 0;
  for (int draw = 0; draw < draws; ++draw) {
    std::vector<double> z(4), plant = best;
    for (double& each : z) each = normal(random);
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t k = 0; k <= i; ++k) plant[i] += root[i][k] * z[k];
    beyond += largest_sensitivity(plant) > json["region"]["max_sensitivity"].get<double>() * 1.002 ? 1 : 0;
  }
  EXPECT_LE(beyond, (0.05 + 3 * 0.01) * draws);
  EXPECT_EQ(run_fracfit({"tune", "--fit", fit, "--model", "1/(s+1)", "--crossover", "0.3"}).code, 2);
  EXPECT_EQ(run_fracfit({"tune", "--fit", folder.write("no.json", "{}"), "--crossover", "0.3"}).code, 3);
}

TEST(CliTune, PrintsAControllerThatKeepsWhatWasAsked) {
  const auto result = run_fracfit({"tune", "--model", "1/(s^1.5 + 1)", "--crossover", "3", "--phase-margin", "55",
                                   "--flat-phase", "--max-sensitivity", "1.7"});
  ASSERT_EQ(result.code, 0) << result.error;
  const Json json = Json::parse(result.output);
  EXPECT_EQ(json["status"], "met");
  EXPECT_EQ(json["closed_loop"], "stable");
  EXPECT_EQ(json["specification"].size(), 4u);
  const Json& c = json["controller"];
  const Complex s(0, 3);
  const Complex loop = (c["kp"].get<double>() + c["ki"].get<double>() * std::pow(s, -c["lambda"].get<double>()) +
                        c["kd"].get<double>() * std::pow(s, c["mu"].get<double>())) /
                       (std::pow(s, 1.5) + 1.0);
  // Three linear equations in double.
  EXPECT_NEAR(std::abs(loop), 1, 1e-9);
  EXPECT_NEAR(std::arg(loop), -125 * std::numbers::pi / 180, 1e-9);
  EXPECT_TRUE(json["iae"].is_null());
  // The command line that is printed makes the same output.
  EXPECT_NE(json["command"].get<std::string>().find("--phase-margin 55 --flat-phase"), std::string::npos);
}

TEST(CliTune, SaysWhereTheOrderOfDifferentiationIsHeldBack) {
  const std::vector<std::string> steep{"tune", "--model",        "1/(s + 1)", "--crossover",
                                       "10",   "--phase-margin", "85",        "--flat-phase"};
  const auto held = run_fracfit(steep);
  ASSERT_EQ(held.code, 0) << held.error;
  const Json json = Json::parse(held.output);
  // The plant falls as 1/s, so s^mu leaves s^(mu - 1), and s^-0.2 is the slowest fall allowed.
  EXPECT_NEAR(json["controller"]["mu"].get<double>(), 0.8, 1e-3);
  EXPECT_NE(json["message"].get<std::string>().find("mu stands at its limit, 0.8"), std::string::npos) << json;
  EXPECT_NE(held.error.find("mu stands at its limit, 0.8"), std::string::npos) << held.error;
  auto asked = steep;
  asked.insert(asked.end(), {"--mu", "0.5"});
  EXPECT_EQ(run_fracfit(asked).output.find("stands at its limit"), std::string::npos);
  const auto help = run_fracfit({"tune", "--help"}).output;
  EXPECT_NE(help.find("s^-0.2"), std::string::npos) << help;
}

TEST(CliTune, SaysWhatIsWrongAndWhatIsNotReached) {
  const auto wrong = run_fracfit({"tune", "--model", "1/(s + 1)", "--phase-margin", "50"});
  EXPECT_EQ(wrong.code, 2);
  EXPECT_NE(wrong.error.find("needs the crossover"), std::string::npos) << wrong.error;
  for (const auto& [option, value, part] : std::vector<std::tuple<std::string, std::string, std::string>>{
           {"--phase-margin", "200", "--phase-margin 200: expected an angle above 0 and below 180 degrees"},
           {"--high-frequency", "10", "--high-frequency '10': expected W:GAIN"}}) {
    const auto refused = run_fracfit({"tune", "--model", "1/(s + 1)", "--crossover", "1", option, value});
    EXPECT_EQ(refused.code, 2);
    EXPECT_NE(refused.error.find(part), std::string::npos) << refused.error;
  }
  const auto impossible =
      run_fracfit({"tune", "--model", "exp(-1 s)/(s + 1)", "--crossover", "50", "--max-sensitivity", "1.2"});
  EXPECT_EQ(impossible.code, 1);
  EXPECT_EQ(Json::parse(impossible.output)["status"], "not-met");
}

TEST(CliRealise, PrintsMatricesWithTheResponseOfTheModel) {
  for (const std::string form : {"modal", "balanced"}) {
    const auto result = run_fracfit(
        {"realise", "--model", "exp(-0.2 s)/(s^0.5 + 1)", "--band", "0.1:10", "--tolerance", "1e-3", "--form", form});
    ASSERT_EQ(result.code, 0) << result.error;
    const Json json = Json::parse(result.output);
    EXPECT_EQ(json["delay"], 0.2);
    EXPECT_TRUE(json["stable"]);
    const std::size_t n = json["states"];
    ASSERT_EQ(json["A"].size(), n);
    // (j omega - A) x = B by Gauss and Seidel's elimination without pivoting: the diagonal has j omega.
    const Complex s(0, 1);
    std::vector<std::vector<Complex>> m(n, std::vector<Complex>(n + 1));
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t j = 0; j < n; ++j) m[i][j] = (i == j ? s : 0.0) - json["A"][i][j].get<double>();
      m[i][n] = json["B"][i][0].get<double>();
    }
    for (std::size_t k = 0; k < n; ++k) {
      for (std::size_t i = 0; i < n; ++i) {
        if (i == k) continue;
        const Complex factor = m[i][k] / m[k][k];
        for (std::size_t j = k; j <= n; ++j) m[i][j] -= factor * m[k][j];
      }
    }
    Complex value = json["D"].get<double>();
    for (std::size_t k = 0; k < n; ++k) value += json["C"][0][k].get<double>() * m[k][n] / m[k][k];
    const Complex exact = 1.0 / (std::sqrt(s) + 1.0);
    EXPECT_LT(std::abs(value / exact - 1.0), 1.001e-3) << form;
  }
}

}  // namespace
