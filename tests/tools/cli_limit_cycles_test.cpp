// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

#include "run_program.hpp"

namespace {

std::vector<std::string> limit_cycles(const std::string& controller, const std::vector<std::string>& more) {
  std::vector<std::string> arguments{"limit-cycles", "--controller", controller};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

TEST(LimitCyclesCommand, WritesEveryCycleBesideItsPrediction) {
  const auto result =
      run_fracfit(limit_cycles("1 + s^0.5 + 0.3/s^0.6", {"--restitution", "0.6", "--format", "json", "--starts", "0"}));
  ASSERT_EQ(result.code, 0) << result.error;
  const auto json = nlohmann::json::parse(result.output);
  EXPECT_EQ(json["rigid_loop"]["stability"], "stable");
  ASSERT_EQ(json["cycles"].size(), 2U);
  const auto& none = json["cycles"][0];
  EXPECT_EQ(none["admissible"], false);
  EXPECT_NE(none["reason"].get<std::string>().find("pull"), std::string::npos);
  EXPECT_TRUE(none["describing_function"].is_null());
  const auto& cycle = json["cycles"][1];
  // Known to the digits given from an independent solution and an event-driven simulation.
  EXPECT_NEAR(cycle["omega"].get<double>(), 1.32422402744822, 1e-13);
  EXPECT_NEAR(cycle["impulse"].get<double>(), .784011240865, 1e-12);
  EXPECT_NEAR(cycle["amplitude_x1"].get<double>(), .37691285413, 1e-11);
  EXPECT_NEAR(cycle["amplitude_force"].get<double>(), .77451732802, 1e-11);
  EXPECT_NEAR(cycle["describing_function"]["omega"].get<double>(), 1.18317519, 1e-8);
  EXPECT_NEAR(cycle["describing_function"]["relative_error_omega"].get<double>(), 1.18317519 / 1.32422402744822 - 1,
              1e-8);
  EXPECT_TRUE(cycle["reason"].is_null());
  for (const char* key : {"symmetric", "impacts_per_period", "admissible", "stable", "multiplier_modulus",
                          "impact_speed", "amplitude_x2", "harmonics"})
    EXPECT_TRUE(cycle.contains(key)) << key;
}

// Over the frequency of contacts the cycle of two tends to that of the restitution in first order, which
// 2 f(2 wc) - f(wc) removes; what is left is of the size of the first order squared.
TEST(LimitCyclesCommand, FollowsContactsThatTakeTimeOverTheirFrequency) {
  const auto cycle_of = [](const nlohmann::json& loop) {
    for (const auto& cycle : loop["cycles"])
      if (cycle["impacts_per_period"] == 2 && cycle["symmetric"] == true && cycle["stable"] == true)
        return cycle["omega"].get<double>();
    return 0.0;
  };
  const auto hard =
      run_fracfit(limit_cycles("1 + 0.3 s", {"--restitution", "0.6", "--format", "json", "--starts", "0"}));
  ASSERT_EQ(hard.code, 0) << hard.error;
  const double limit = cycle_of(nlohmann::json::parse(hard.output));
  const auto result =
      run_fracfit(limit_cycles("1 + 0.3 s", {"--contact-frequency", "1", "--contact-restitution", "0.6", "--over",
                                             "contact-frequency=100,200,400", "--format", "json", "--starts", "0"}));
  ASSERT_EQ(result.code, 0) << result.error;
  const auto json = nlohmann::json::parse(result.output);
  ASSERT_EQ(json["loops"].size(), 3U);
  std::vector<double> off;
  for (const auto& loop : json["loops"]) off.push_back(cycle_of(loop) - limit);
  EXPECT_EQ(json["loops"][1]["varied"]["contact-frequency"], 200);
  EXPECT_EQ(json["loops"][1]["scene"]["contact_frequency_rad_s"], 200);
  for (std::size_t i = 0; i + 1 < off.size(); ++i) {
    EXPECT_GT(std::abs(off[i + 1]), 1e-4);
    EXPECT_LT(std::abs(2 * off[i + 1] - off[i]), 4 * off[i] * off[i]) << i;
  }
}

// Motions settle on a symmetric cycle of four impacts here, for which only the orbits of a diagram have a prediction.
TEST(LimitCyclesCommand, PredictsOnAllBranchesWhereAsked) {
  const auto predictions = [](const std::vector<std::string>& more) {
    std::vector<std::string> options{"--restitution", "0.6", "--format", "json"};
    options.insert(options.end(), more.begin(), more.end());
    const auto result = run_fracfit(limit_cycles("20 + s", options));
    EXPECT_EQ(result.code, 0) << result.error;
    return nlohmann::json::parse(result.output);
  };
  const auto without = predictions({});
  const auto with = predictions({"--branches"});
  const auto is_of_four = [](const nlohmann::json& cycle) { return cycle["impacts_per_period"] == 4; };
  for (const auto& json : {without, with}) {
    const auto cycle = std::find_if(json["cycles"].begin(), json["cycles"].end(), is_of_four);
    ASSERT_NE(cycle, json["cycles"].end());
    EXPECT_EQ((*cycle)["describing_function"].is_null(), json == without);
    if (json == with) {
      EXPECT_LT(std::abs((*cycle)["describing_function"]["relative_error_omega"].get<double>()), 0.03);
    }
  }
  EXPECT_GT(with["predictions"].size(), without["predictions"].size());
}

TEST(LimitCyclesCommand, FollowsAnyQuantityOfTheLoop) {
  for (const std::string over : {"a=0.4:0.8:3", "mass2=1:2:3", "clearance=1,2,4"}) {
    const std::string formula = over.front() == 'a' ? "2 + s^a" : "2 + s^0.5";
    const auto result =
        run_fracfit(limit_cycles(formula, {"--restitution", "0.6", "--over", over, "--format", "json"}));
    ASSERT_EQ(result.code, 0) << result.error;
    EXPECT_EQ(nlohmann::json::parse(result.output)["loops"].size(), 3U);
  }
}

// With enough viscous friction of the load no cycle is left.
TEST(LimitCyclesCommand, TakesBodiesAsReceptances) {
  const auto result =
      run_fracfit(limit_cycles("2 + s", {"--restitution", "0.6", "--load-receptance", "1/(s^2 + b s)", "--over",
                                         "b=0,0.2,10", "--omega", "0.1:30", "--format", "json"}));
  ASSERT_EQ(result.code, 0) << result.error;
  const auto loops = nlohmann::json::parse(result.output)["loops"];
  ASSERT_EQ(loops.size(), 3U);
  EXPECT_NEAR(loops[0]["cycles"][0]["omega"].get<double>(), 3.14159265358979, 1e-13);
  EXPECT_FALSE(loops[0]["scene"].contains("load_receptance"));
  // The force has less to make up for by itself: the cycle is slower.
  ASSERT_EQ(loops[1]["cycles"].size(), 1U);
  EXPECT_LT(loops[1]["cycles"][0]["omega"].get<double>(), 3.1);
  EXPECT_TRUE(loops[1]["scene"].contains("load_receptance"));
  for (const auto& cycle : loops[2]["cycles"]) EXPECT_EQ(cycle["admissible"], false) << cycle;
}

// The describing function's line and the motion over a period, or the frequencies over what varies.  The gap's plane
// closes at the speeds of the impacts: 1.36364 m/s for 2 + s at restitution .6.
TEST(LimitCyclesCommand, DrawsLoopsAndFamilies) {
  const TemporaryFolder folder;
  // The scripts are written whether gnuplot is there or not.
  (void)run_fracfit(limit_cycles(
      "k + s", {"--restitution", "0.6", "--quiet", "--over", "k=2:14:3", "--pictures", folder.path("family")}));
  (void)run_fracfit(limit_cycles("2 + s", {"--restitution", "0.6", "--quiet", "--pictures", folder.path("one")}));
  const auto script = [&](const std::string& name) {
    std::ifstream file(folder.path(name));
    return std::string(std::istreambuf_iterator<char>(file), {});
  };
  EXPECT_NE(script("family/cycles-frequency.gp").find("events"), std::string::npos);
  EXPECT_NE(script("one/cycles-nyquist.gp").find("predicted"), std::string::npos);
  EXPECT_NE(script("one/cycle-1.gp").find("1.3636"), std::string::npos);
  // A loop that was looked at from 0 to infinity and has no cycle is drawn round its crossover.
  (void)run_fracfit(limit_cycles(
      "2 + 2 s^0.5", {"--restitution", "1", "--quiet", "--starts", "0", "--pictures", folder.path("none")}));
  EXPECT_NE(script("none/cycles-nyquist.gp").find("C(jω)"), std::string::npos);
}

// The cycles of contacts that take time within a range are those found without one that lie in it; their pictures hold
// the meeting of the gap's plane, x2 - x1 = clearance/2 at the speed of the meeting, to the 1e-2 that 400 harmonics of
// a rate leave whose jumps of slope are contacts.
TEST(LimitCyclesCommand, TakesRangeAndPicturesWithContactsThatTakeTime) {
  const TemporaryFolder folder;
  const auto cycles_of = [](const std::vector<std::string>& more) {
    std::vector<std::string> arguments{"--contact-frequency",
                                       "30",
                                       "--contact-restitution",
                                       "0.6",
                                       "--friction1",
                                       "0.02",
                                       "--friction2",
                                       "0.01",
                                       "--quiet",
                                       "--format",
                                       "json"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return nlohmann::json::parse(run_fracfit(limit_cycles("1 + 0.3 s", arguments)).output);
  };
  const auto all = cycles_of({});
  ASSERT_EQ(all["cycles"].size(), 2U);
  const double low = all["cycles"][0]["omega"], high = all["cycles"][1]["omega"];
  const std::string between = std::to_string(0.5 * (low + high));
  const auto upper = cycles_of({"--omega", between + ":10", "--pictures", folder.path("one")});
  ASSERT_EQ(upper["cycles"].size(), 1U);
  EXPECT_EQ(upper["cycles"][0]["omega"], high);
  EXPECT_EQ(upper["cycles"][0]["harmonics"].size(), all["cycles"][1]["harmonics"].size());
  EXPECT_EQ(cycles_of({"--omega", "0.1:" + between})["cycles"][0]["omega"], low);
  const auto script = [&](const std::string& name) {
    std::ifstream file(folder.path(name));
    return std::string(std::istreambuf_iterator<char>(file), {});
  };
  const std::string drawn = script("one/cycle-1.gp");
  // Rows "0.5.. speed" of the portrait.
  const double speed = upper["cycles"][0]["impact_speed"];
  double nearest = 1;
  std::istringstream lines(drawn);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream row(line);
    double gap = 0, rate = 0;
    if (row >> gap >> rate) nearest = std::min(nearest, std::hypot(gap - 0.5, rate / speed - 1));
  }
  // 400 weighted harmonics smooth the rate over a 400th of the period, in the half of which after the meeting it falls
  // by c/m = 2 zeta omega_c of itself: by a quarter of that on the mean.
  const double zeta = 0.180858308, fall = 2 * zeta * 30 * (2 * std::numbers::pi / high) / 400;
  EXPECT_LT(nearest, fall / 4);
  (void)cycles_of({"--over", "friction1=0,0.02", "--pictures", folder.path("family")});
  EXPECT_NE(script("family/cycles-frequency.gp").find("exact, stable"), std::string::npos);
}

// Loops whose only roots are no motions, at any mass and for either body: nothing is written and then refused, and no
// sentence is that of a function inside.
TEST(LimitCyclesCommand, PicturesOfLoopsWithoutAMotionAreMadeOrToldOf) {
  const TemporaryFolder folder;
  for (const char* mass : {"1e4", "1e12", "1e-6"})
    for (const char* body : {"x1", "x2"}) {
      const bool is_driven = std::string(body) == "x2";
      // With the driven body measured a heavy load holds the search for long.
      if (is_driven && std::string(mass) == "1e12") continue;
      SCOPED_TRACE(std::string(mass) + " kg, " + body);
      const std::string pictures = folder.path(std::string(body) + mass);
      const auto result = run_fracfit(
          limit_cycles("1 + s^0.5", {"--mass1", mass, "--clearance", "1", "--restitution", "0.6", "--starts", "0",
                                     "--body", body, "--format", "json", "--pictures", pictures}));
      const auto json = nlohmann::json::parse(result.output);
      EXPECT_NE(result.code, 2) << result.error;
      EXPECT_EQ(result.error.find("omega ="), std::string::npos) << result.error;
      EXPECT_EQ(result.error.find("cannot write"), std::string::npos) << result.error;
      const bool has_picture = std::ifstream(pictures + "/cycles-nyquist.gp").good();
      EXPECT_EQ(has_picture, !is_driven);
      bool is_motion = false;
      for (const auto& cycle : json["cycles"]) is_motion = is_motion || cycle["admissible"].get<bool>();
      if (!has_picture && !is_motion) {
        EXPECT_NE(result.error.find("no picture: no cycle is a motion"), std::string::npos) << result.error;
      }
    }
}

// Where "kp + s" ceases to have a cycle is tested with the library; here that the command says it.
TEST(LimitCyclesCommand, TellsWhatHappensBetweenTheValues) {
  const std::vector<std::string> options{"--restitution", "0.6", "--over", "kp=5:20:4", "--format"};
  auto as = [&](const char* format) {
    std::vector<std::string> all = options;
    all.emplace_back(format);
    all.insert(all.end(), {"--starts", "0"});
    const auto result = run_fracfit(limit_cycles("kp + s", all));
    EXPECT_EQ(result.code, 0) << result.error;
    return result.output;
  };
  const auto json = nlohmann::json::parse(as("json"));
  ASSERT_EQ(json["events"].size(), 2U);
  EXPECT_EQ(json["events"][0]["kind"], "symmetry-breaking");
  EXPECT_EQ(json["events"][1]["kind"], "admissibility");
  ASSERT_EQ(json["without_cycles"].size(), 1U);
  EXPECT_EQ(json["without_cycles"][0][0], json["events"][1]["value"]);
  EXPECT_EQ(json["without_cycles"][0][1], 20);
  EXPECT_EQ(json["without_stable_cycles"][0][0], json["events"][0]["value"]);
  const std::string table = as("table");
  EXPECT_NE(table.find("symmetry-breaking"), std::string::npos) << table;
  EXPECT_NE(table.find("No cycle for kp from"), std::string::npos) << table;
}

// The cycle of "kp + s" keeps its symmetry from kp = 1 to 3, as the command's own JSON says of each value.
TEST(LimitCyclesCommand, SaysThatAStableCycleIsThereForEveryValue) {
  const auto as = [](const char* format) {
    return run_fracfit(
        limit_cycles("kp + s", {"--restitution", "0.6", "--over", "kp=1:3:3", "--starts", "0", "--format", format}));
  };
  const auto json = nlohmann::json::parse(as("json").output);
  ASSERT_EQ(json["loops"].size(), 3U);
  for (const auto& loop : json["loops"]) EXPECT_TRUE(loop["cycles"].back()["stable"]);
  const std::string table = as("table").output;
  EXPECT_NE(table.find("A stable cycle for every kp from 1 to 3."), std::string::npos) << table;
}

// Where the symmetric cycle of "kp + s" is unstable, motions settle on cycles of more impacts.
TEST(LimitCyclesCommand, SimulatesWhereNoCycleIsKnownToBeStable) {
  const auto result = run_fracfit(
      limit_cycles("kp + s", {"--restitution", "0.6", "--over", "kp=13,17", "--starts", "2", "--format", "json"}));
  ASSERT_EQ(result.code, 0) << result.error;
  const auto json = nlohmann::json::parse(result.output);
  EXPECT_EQ(json["simulated_at"][0], 13);
  ASSERT_FALSE(json["branches"].empty());
  EXPECT_TRUE(json["branches"][0]["born_at"].is_null());
  EXPECT_FALSE(json["branches"][0]["stable"].empty());
}

// Bodies with resonances have a root that is no motion beside each odd part of a natural frequency.
TEST(LimitCyclesCommand, CountsManyRootsThatAreNoMotion) {
  const auto with_format = [](const std::string& format) {
    return run_fracfit(limit_cycles(
        "15 + 3 s",
        {"--clearance", "0.02", "--restitution", "0.4", "--load-receptance", "1/(s^2 + 0.06 s + 0.8)",
         "--drive-receptance", "1/(s^2 + 0.06 s + 1.9)", "--omega", "0.08:60", "--starts", "0", "--format", format}));
  };
  const auto cycles = nlohmann::json::parse(with_format("json").output).at("cycles");
  const auto unreal =
      std::count_if(cycles.begin(), cycles.end(), [](const auto& cycle) { return cycle.at("admissible") == false; });
  ASSERT_GT(unreal, 5);
  const std::string table = with_format("table").output;
  EXPECT_NE(table.find(std::to_string(unreal) + " further roots from "), std::string::npos) << table;
  EXPECT_EQ(table.find("  no motion  "), std::string::npos) << table;
  EXPECT_NE(table.find("  stable  "), std::string::npos) << table;
}

TEST(LimitCyclesCommand, SaysWhatIsWrong) {
  const auto expect_refused = [](const std::vector<std::string>& arguments, const std::string& part) {
    const auto result = run_fracfit(arguments);
    EXPECT_EQ(result.code, 2);
    EXPECT_NE(result.error.find(part), std::string::npos) << result.error;
  };
  expect_refused(limit_cycles("1 + s", {}), "--restitution");
  expect_refused(limit_cycles("1 + k s", {"--restitution", "0.6"}), "k has no value");
  expect_refused(limit_cycles("1 + s^2.1", {"--restitution", "0.6"}), "slower than s^2");
  expect_refused(limit_cycles("1 + s", {"--restitution", "0.6", "--omega", "3:1"}), "lower");
  expect_refused(limit_cycles("1 + s", {"--restitution", "1.2"}), "restitution");
  expect_refused(limit_cycles("1 + s", {"--restitution", "0.6", "--clearance", "0"}), "clearance");
  expect_refused(limit_cycles("1 + s", {"--restitution", "0.6", "--over", "m=1:2:3"}), "m");
  expect_refused(limit_cycles("1 + s", {"--restitution", "0.6", "--load-receptance", "1/(s + 1)"}), "1/(M s^2)");
  expect_refused(limit_cycles("1 + s", {"--restitution", "0.6", "--load-receptance", "1/s^2", "--mass1", "2"}),
                 "--mass1 has no meaning with --load-receptance");
}

TEST(LimitCyclesCommand, SaysThatTheLoopIsUnstableWithoutClearance) {
  const auto result = run_fracfit(limit_cycles("3/s", {"--restitution", "0.6", "--format", "table"}));
  EXPECT_EQ(result.code, 0);
  EXPECT_NE(result.error.find("unstable even without clearance"), std::string::npos);
  EXPECT_NE(result.output.find("No symmetric limit cycle"), std::string::npos);
  EXPECT_EQ(result.output.find("omega in rad/s"), std::string::npos) << "a legend without a table";
}

// C = 20 + s has no symmetric cycle of two impacts; simulations go to one of four, whose first two intervals are known.
TEST(LimitCyclesCommand, ListsCyclesThatMotionsComeTo) {
  const auto result = run_fracfit(limit_cycles("20 + s", {"--restitution", "0.6", "--format", "json"}));
  ASSERT_EQ(result.code, 0) << result.error;
  const auto json = nlohmann::json::parse(result.output);
  ASSERT_EQ(json["cycles"].size(), 2U);
  EXPECT_EQ(json["cycles"][0]["impacts_per_period"], 2);
  EXPECT_EQ(json["cycles"][0]["admissible"], false);
  const auto& cycle = json["cycles"][1];
  EXPECT_EQ(cycle["impacts_per_period"], 4);
  EXPECT_EQ(cycle["stable"], true);
  EXPECT_EQ(cycle["multiplier_per"], "period");
  EXPECT_NEAR(cycle["impacts"][1]["time"].get<double>(), .38239689, 6e-9);
  EXPECT_NEAR(cycle["impacts"][2]["time"].get<double>(), .38239689 + .51285064, 1e-8);
  ASSERT_EQ(json["motions"].size(), 3U);
  for (const auto& motion : json["motions"]) EXPECT_EQ(motion["regime"], "cycle");
  const auto none = run_fracfit(limit_cycles("20 + s", {"--restitution", "0.6", "--format", "json", "--starts", "0"}));
  EXPECT_EQ(nlohmann::json::parse(none.output)["cycles"].size(), 1U);
  EXPECT_FALSE(nlohmann::json::parse(none.output).contains("motions"));
}

// At restitution 0 the motion rests twice per period, after one impact each; at 0.02 after bounces without end.  Over a
// parameter it joins its likes where starts are simulated, and else the answer says that none was looked for.
TEST(LimitCyclesCommand, ListsCyclesThatRestInContact) {
  const auto run = [](const char* restitution, const std::vector<std::string>& more) {
    std::vector<std::string> options{"--restitution", restitution};
    options.insert(options.end(), more.begin(), more.end());
    const auto result = run_fracfit(limit_cycles("k + s", options));
    EXPECT_EQ(result.code, 0) << result.error;
    return result.output;
  };
  const auto cycle_of = [](const char* restitution) {
    const auto result = run_fracfit(limit_cycles("1 + s", {"--restitution", restitution, "--format", "json"}));
    return nlohmann::json::parse(result.output)["cycles"].back();
  };
  const auto plain = cycle_of("0"), bouncing = cycle_of("0.02");
  EXPECT_EQ(plain["rests_per_period"], 2);
  EXPECT_EQ(plain["rests"].size(), 2U);
  EXPECT_EQ(plain["impacts_per_period"], 2);
  EXPECT_TRUE(plain["stable"]);
  EXPECT_EQ(bouncing["rests_per_period"], 2);
  EXPECT_TRUE(bouncing["impacts_per_period"].is_null());
  const auto followed = nlohmann::json::parse(run("0", {"--over", "k=1:3:3", "--starts", "1", "--format", "json"}));
  ASSERT_EQ(followed["branches"].size(), 1U);
  EXPECT_EQ(followed["branches"][0]["samples"].size(), 3U);
  EXPECT_EQ(followed["branches"][0]["stable"][0][1], 3);
  EXPECT_TRUE(followed["without_stable_cycles"].empty());
  EXPECT_NE(run("0", {"--over", "k=1:3:3", "--format", "table"}).find("rests in contact are not among them"),
            std::string::npos);
}

// A step of the set-point by 1 meets C = e^{-0.1 s} (2 + s): from 0.1 s on mass 2 has speed 1 from the derivative and
// acceleration 2, so it meets the wall half a clearance away after 0.1 + (sqrt(3) - 1)/2 s.
TEST(LoopCommand, WritesTheMotionWithItsImpacts) {
  const auto result = run_fracfit({"loop", "--controller", "exp(-0.1 s) (2 + s)", "--restitution", "0.6",
                                   "--setpoint-step", "1", "--duration", "5", "--format", "json"});
  ASSERT_EQ(result.code, 0) << result.error;
  const auto json = nlohmann::json::parse(result.output);
  EXPECT_EQ(result.error, "");
  const std::string text = json.dump();
  EXPECT_NE(text.find("before-impact"), std::string::npos);
  for (const auto& member : json) {
    if (!member.is_array() || member.empty() || !member[0].contains("time_s")) continue;
    EXPECT_NEAR(member[0]["time_s"].get<double>(), 0.1 + (std::sqrt(3.0) - 1) / 2, 1e-12);
    EXPECT_NEAR(member[0]["v2_m_s"].get<double>(), std::sqrt(3.0), 1e-12);
    EXPECT_EQ(member[0]["event"], "before-impact");
    return;
  }
  ADD_FAILURE() << text;
}

// A hundred samples and that of the start, and a force that keeps its limit.
TEST(LoopCommand, RunsASampledController) {
  std::vector<std::string> command{"loop", "--controller", "2 + s", "--restitution", "0",    "--velocity2",
                                   "1",    "--duration",   "1",     "--force-limit", "0.25", "--body",
                                   "x2"};
  EXPECT_EQ(run_fracfit(command).code, 0);
  command.insert(command.end(), {"--sample-time", "0.01", "--format", "csv"});
  const auto result = run_fracfit(command);
  ASSERT_EQ(result.code, 0) << result.error;
  std::istringstream lines(result.output);
  std::size_t rows = 0;
  for (std::string line; std::getline(lines, line);) rows += line.find(",sample") != std::string::npos;
  EXPECT_EQ(rows, 101U);
  EXPECT_NE(result.output.find(",-0.25,sample"), std::string::npos) << result.output;
}

// Bodies that stay together after an impact, a limited force, and a set-point that moves; the same set-point from a
// file.
TEST(LoopCommand, FollowsBodiesInContactAndASetPoint) {
  std::vector<std::string> command{"loop",
                                   "--controller",
                                   "2 + s",
                                   "--load-receptance",
                                   "1/(s^2 + 0.3 s)",
                                   "--restitution",
                                   "0",
                                   "--duration",
                                   "20",
                                   "--force-limit",
                                   "2",
                                   "--format",
                                   "csv"};
  const auto with = [&](const std::vector<std::string>& more) {
    std::vector<std::string> all = command;
    all.insert(all.end(), more.begin(), more.end());
    return run_fracfit(all);
  };
  const auto sine = with({"--setpoint-sine", "1:0.5"});
  ASSERT_EQ(sine.code, 0) << sine.error;
  EXPECT_NE(sine.output.find(",contact"), std::string::npos) << sine.output;
  EXPECT_NE(sine.output.find(",release"), std::string::npos) << sine.output;
  EXPECT_NE(sine.output.find(",-2,"), std::string::npos) << sine.output;
  const TemporaryFolder folder;
  const std::string file = folder.path("set_point.csv");
  std::ofstream(file) << "time_s,input\n0,0\n10,5\n20,10\n";
  const auto line = with({"--setpoint-file", file});
  const auto ramp = with({"--setpoint-ramp", "0.5"});
  ASSERT_EQ(line.code, 0) << line.error;
  // The rows; heads name the commands.
  const auto events = [](const std::string& text) { return std::count(text.begin(), text.end(), '\n'); };
  EXPECT_EQ(events(line.output), events(ramp.output));
  EXPECT_EQ(with({"--setpoint-file", folder.path("none.csv")}).code, 3);
  EXPECT_EQ(with({"--setpoint-sine", "1"}).code, 2);
}

TEST(LoopCommand, SaysWhatItDoesNotFollow) {
  const auto result = run_fracfit({"loop", "--controller", "1/(s + 1)", "--restitution", "0.6", "--whole-memory"});
  EXPECT_EQ(result.code, 2);
  EXPECT_NE(result.error.find("sum of powers"), std::string::npos) << result.error;
}

// N of bodies with viscous friction that an event-driven simulation gave, to the digits that it agreed in.
TEST(SimulateCommand, TakesBodiesAsReceptances) {
  std::vector<std::string> command{"simulate",
                                   "--force",
                                   "40",
                                   "--clearance",
                                   "0.3",
                                   "--restitution",
                                   "0.6",
                                   "--omega",
                                   "21",
                                   "--load-receptance",
                                   "1/(s^2 + 0.2 s)",
                                   "--drive-receptance",
                                   "1/(s^2 + 0.3 s)",
                                   "--format",
                                   "json"};
  const auto result = run_fracfit(command);
  ASSERT_EQ(result.code, 0) << result.error;
  EXPECT_NE(result.output.find("-0.00213465"), std::string::npos) << result.output;
  EXPECT_NE(result.output.find("0.00097455"), std::string::npos) << result.output;
  command.insert(command.end(), {"--mass1", "2"});
  const auto refused = run_fracfit(command);
  EXPECT_EQ(refused.code, 2);
  EXPECT_NE(refused.error.find("--mass1"), std::string::npos) << refused.error;
}

TEST(Loop, SaysThatNothingMovesWhereNothingPushes) {
  const std::vector<std::string> scene{"loop", "--controller", "1 + s", "--restitution", "0.6", "--duration", "5"};
  const auto at_rest = run_fracfit(scene);
  EXPECT_EQ(at_rest.code, 0);
  EXPECT_NE(at_rest.error.find("nothing moves"), std::string::npos) << at_rest.error;
  auto pushed = scene;
  pushed.insert(pushed.end(), {"--setpoint-step", "1"});
  EXPECT_EQ(run_fracfit(pushed).error.find("nothing moves"), std::string::npos);
}

}  // namespace
