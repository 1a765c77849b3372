// SPDX-License-Identifier: BSD-3-Clause
// A rotating drive in its own words: inertias, torques, degrees, a gear and a cascade.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <numbers>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "io/number.hpp"
#include "run_program.hpp"
#include "support/random.hpp"
#include "temporary_folder.hpp"

namespace {

using Words = std::vector<std::string>;

std::string text_of(double value) {
  return io::format_number(value);
}

// Without the command line, which tells the words that were given.
std::string result_of(const Words& words) {
  const auto run = run_fracfit(words);
  EXPECT_EQ(run.code, 0) << run.error;
  std::istringstream lines(run.output);
  std::string text;
  for (std::string line; std::getline(lines, line);) {
    const auto at = line.find("\"command\":\"");
    if (at != std::string::npos) line.erase(at, line.find("\",", at) - at);
    if (line.find("fracfit ") == std::string::npos && line.find("seconds") == std::string::npos) text += line + "\n";
  }
  EXPECT_GT(text.size(), 100U);
  return text;
}

Words joined(Words words, const Words& more) {
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

std::vector<std::vector<double>> rows_of(const Words& words) {
  const auto run = run_fracfit(words);
  EXPECT_EQ(run.code, 0) << run.error;
  std::istringstream lines(run.output);
  std::vector<std::vector<double>> rows;
  bool is_head = true;
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with('#')) continue;
    if (std::exchange(is_head, false)) continue;
    std::istringstream cells(line);
    std::vector<double>& row = rows.emplace_back();
    for (std::string cell; std::getline(cells, cell, ',') && row.size() < 6;)
      row.push_back(io::parse_number(cell).value());
  }
  return rows;
}

// The motor turns 4 times as far, so that its inertia counts 16 times and its torque 4 times, both exact in binary; the
// hand's conversion of degrees is the same product.  So every digit is the same.
TEST(Drive, IsTheTranslationalSceneConvertedByHand) {
  support::Random random(36);
  for (int i = 0; i < 2; ++i) {
    const double inertia1 = random.log_uniform(0.1, 1), inertia2 = random.log_uniform(0.01, 0.1);
    const double torque = random.log_uniform(0.1, 1), gap = random.log_uniform(0.1, 1);
    const double clearance = gap * (std::numbers::pi / 180), force = 4 * torque;
    const double unit = std::sqrt(force / (16 * inertia2 * clearance));
    const Words drive{"--inertia1",    text_of(inertia1), "--inertia2",   text_of(inertia2),
                      "--gap-degrees", text_of(gap),      "--gear-ratio", "4"};
    const Words masses{"--mass1",     text_of(inertia1), "--mass2", text_of(16 * inertia2),
                       "--clearance", text_of(clearance)};
    const Words with_torque = joined(drive, {"--torque", text_of(torque)});
    const Words with_force = joined(masses, {"--force", text_of(force)});
    const std::string omega = text_of(2 * unit);
    for (const Words& command :
         std::vector<Words>{{"simulate", "--restitution", "0.5", "--omega", omega, "--format", "csv"},
                            {"simulate", "--contact-frequency", text_of(60 * unit), "--contact-ratio", "0.2", "--omega",
                             omega, "--format", "csv"},
                            {"map", "--restitution", "0.3,0.6", "--omega", omega},
                            {"basins", "--restitution", "0.6", "--omega", omega, "--position", text_of(0.3 * clearance),
                             "--velocity", "0", "--format", "csv"},
                            {"orbits", "--restitution", "0.6", "--parameter", "omega", "--from", omega, "--to",
                             text_of(2.2 * unit), "--format", "csv"},
                            {"history", "--restitution", "0.6", "--omega", omega, "--periods", "4"}})
      EXPECT_EQ(result_of(joined(command, with_torque)), result_of(joined(command, with_force))) << command[0];
    // Of motor torque and load angle, 4 times; and of motor torque and motor angle, 16 times.
    const Words of_load{"--controller", text_of(2 * inertia1) + " + " + text_of(inertia1) + " s"};
    const Words by_four{"--controller", "4 (" + of_load[1] + ")"};
    const Words of_motor{"--body", "x2", "--controller", "cascade(1, " + text_of(inertia2) + ", 3)"};
    const Words by_sixteen{"--body", "x2", "--controller", "cascade(1, 16 (" + text_of(inertia2) + "), 3)"};
    for (const auto& [theirs, ours] : {std::pair{of_load, by_four}, std::pair{of_motor, by_sixteen}}) {
      const Words cycles{"limit-cycles", "--restitution", "0.5", "--starts", "1"};
      EXPECT_EQ(result_of(joined(joined(cycles, drive), theirs)), result_of(joined(joined(cycles, masses), ours)));
      const Words loop{"loop", "--contact-frequency", "100",   "--contact-ratio", "0.3", "--duration", "2", "--every",
                       "0.1",  "--friction1",         "0.001", "--format",        "csv"};
      EXPECT_EQ(
          result_of(joined(joined(loop, drive), joined(theirs, {"--torque-limit", "0.5", "--friction-torque2", "0.001",
                                                                "--load-torque", "0.01", "--step-degrees", "3"}))),
          result_of(joined(joined(loop, masses),
                           joined(ours, {"--force-limit", "2", "--friction2", "0.004", "--disturbance1", "0.01",
                                         "--setpoint-step", text_of(3 * (std::numbers::pi / 180))}))));
    }
    const Words tune{"tune", "--restitution", "0.5", "--crossover", "3", "--phase-margin", "50", "--lambda",
                     "1",    "--mu",          "1",   "--structure", "pd"};
    EXPECT_EQ(result_of(joined(tune, drive)), result_of(joined(tune, masses)));
  }
  // Lists and grids: the count of a grid is none of torque.
  for (const auto& [theirs, ours] : {std::pair{"0.5:2:3log", "2:8:3log"}, std::pair{"1,3", "4,12"}})
    EXPECT_EQ(result_of({"simulate", "--torque", theirs, "--gear-ratio", "4", "--gap-degrees", "90", "--restitution",
                         "0.5", "--omega", "7", "--format", "csv"}),
              result_of({"simulate", "--force", ours, "--clearance", text_of(90 * (std::numbers::pi / 180)),
                         "--restitution", "0.5", "--omega", "7", "--format", "csv"}));
}

TEST(Drive, RefusesWhatContradictsItself) {
  const Words scene{"simulate", "--restitution", "0.5", "--omega", "7", "--clearance", "1"};
  const auto expect = [&](const Words& more, const std::string& words) {
    const auto run = run_fracfit(joined(scene, more));
    EXPECT_EQ(run.code, 2);
    EXPECT_NE(run.error.find(words), std::string::npos) << run.error;
  };
  expect({"--force", "1", "--gear-ratio", "3"}, "--gear-ratio has no meaning without");
  expect({"--force", "1", "--torque", "3"}, "give either --force or --torque, not both");
  expect({"--torque", "3", "--gear-ratio", "-2"}, "--gear-ratio -2: allowed is above 0");
  expect({"--torque", "x"}, "--torque 'x': expected finite numbers");
  expect({"--torque", "-3"}, "--torque (as --force)");
  expect({"--torque", "3", "--gap-degrees", "1"}, "give either --clearance or --gap-degrees, not both");
  const auto told = run_fracfit(joined(scene, {"--torque", "3", "--inertia2", "0.5", "--gear-ratio", "2"}));
  EXPECT_NE(told.error.find("read m as rad, N as N m"), std::string::npos) << told.error;
  // Its own command line in the file makes the file again.
  EXPECT_NE(told.output.find("--torque 3"), std::string::npos) << told.output;
  EXPECT_EQ(told.output.find("--force"), std::string::npos) << told.output;
}

// Without a set-point a cascade is its formula; with a step the formula takes the derivative of it too.
TEST(Cascade, IsAFormulaWithALagOfTheSetPoint) {
  const Words bare{"loop", "--restitution", "0.5", "--clearance", "0.2", "--duration", "4", "--format", "csv"};
  const Words scene = joined(bare, {"--every", "0.5"});
  const Words pushed = joined(scene, {"--velocity2", "1"});
  const auto one = rows_of(joined(pushed, {"--controller", "cascade(2, 1.5, 2)"}));
  const auto other = rows_of(joined(pushed, {"--controller", "(2 + s) (1.5 + 0.75/s)"}));
  ASSERT_EQ(one.size(), other.size());
  // Two orders of the same sums.
  for (std::size_t i = 0; i < one.size(); ++i)
    for (std::size_t k = 0; k < one[i].size(); ++k) EXPECT_NEAR(one[i][k], other[i][k], 1e-10);
  // The force at the step is K2 K1 times it, and no derivative throws the motor.
  const auto step = rows_of(joined(scene, {"--setpoint-step", "0.5", "--controller", "cascade(2, 1.5, 2)"}));
  EXPECT_NEAR(step.front()[5], 1.5, 1e-14);
  EXPECT_EQ(step.front()[4], 0);
  // In a computer too, less what the first sample has moved it.
  const auto sampled =
      rows_of(joined(bare, {"--setpoint-step", "0.5", "--controller", "cascade(2, 1.5)", "--sample-time", "0.001"}));
  ASSERT_GT(sampled.size(), 1U);
  EXPECT_NEAR(sampled[1][5], 1.5, 1.5e-3);
  for (const auto& [text, message] : {std::pair{"cascade(2)", "expected cascade(K1, K2, T) or cascade(K1, K2)"},
                                      std::pair{"cascade(-2, 1)", "K1 is -2; allowed is above 0"},
                                      std::pair{"cascade(2, 1, 3) exp(-0.01 s)", "with a dead time L write"},
                                      std::pair{"exp(-0.01 s) cascade(2, 1, 3)", "with a dead time L write"}}) {
    const auto run = run_fracfit(joined(scene, {"--setpoint-step", "1", "--controller", text}));
    EXPECT_EQ(run.code, 2);
    EXPECT_NE(run.error.find(message), std::string::npos) << run.error;
  }
}

// kp = K2 (K1 + 1/T), ki = K1 K2/T, kd = K2, and the share K1 T/(1 + K1 T) of the set-point, exact in binary here.
TEST(Cascade, IsAPidOfTwoDegreesOfFreedom) {
  const Words rest{"--sample-time", "0.001", "--min", "-2", "--max", "2"};
  EXPECT_EQ(result_of(joined({"controller", "--cascade", "4,1.5,0.25"}, rest)),
            result_of(joined({"controller", "--kp", "12", "--ki", "24", "--kd", "1.5", "--setpoint-weight", "0.5",
                              "--derivative-setpoint-weight", "0"},
                             rest)));
  for (const auto& [text, message] : {std::pair{"4", "expected K1,K2 or K1,K2,T"}, std::pair{"4,0", "above 0"}}) {
    const auto run = run_fracfit(joined({"controller", "--cascade", text}, rest));
    EXPECT_EQ(run.code, 2);
    EXPECT_NE(run.error.find(message), std::string::npos) << run.error;
  }
}

// A tuned PID of whole orders is a cascade where its zeros are real.
TEST(Cascade, IsToldByTune) {
  const Words tune{"tune", "--model", "1/(0.5 s^2)", "--crossover",       "20",  "--phase-margin", "60",  "--lambda",
                   "1",    "--mu",    "1",           "--max-sensitivity", "1.6", "--format",       "json"};
  const auto run = run_fracfit(tune);
  ASSERT_EQ(run.code, 0) << run.error;
  const auto json = nlohmann::json::parse(run.output);
  const auto &controller = json["controller"], &cascade = json["cascade"];
  const double kp = controller["kp"], ki = controller["ki"], kd = controller["kd"];
  EXPECT_EQ(cascade.is_null(), kp * kp < 4 * ki * kd);
  if (cascade.is_null()) return;
  const double k1 = cascade["position_gain"], k2 = cascade["speed_gain"], t = cascade["integral_time"];
  EXPECT_NEAR(k2 * (k1 + 1 / t) / kp, 1, 1e-13);
  EXPECT_NEAR(k1 * k2 / t / ki, 1, 1e-13);
  EXPECT_EQ(k2, kd);
}

TEST(Tune, ASeriesPidIsACascade) {
  const Words asked{"tune", "--model",     "1/(2 s^2)", "--crossover",     "3",        "--phase-margin",
                    "50",   "--structure", "series",    "--low-frequency", "0.6:0.055"};
  const auto json = nlohmann::json::parse(run_fracfit(joined(asked, {"--quiet"})).output);
  EXPECT_EQ(json["status"], "met");
  EXPECT_GT(json["controller"]["ki"], 0);
  EXPECT_FALSE(json["cascade"].is_null());
  const auto refused = run_fracfit(joined(asked, {"--mu", "1"}));
  EXPECT_EQ(refused.code, 2);
  EXPECT_NE(refused.error.find("--mu has no meaning with --structure series"), std::string::npos) << refused.error;
}

// The number behind a text.
double number_after(const std::string& text, const std::string& head) {
  const auto at = text.find(head);
  EXPECT_NE(at, std::string::npos) << head << " is missing in\n" << text;
  return at == std::string::npos ? NAN : std::strtod(text.c_str() + at + head.size(), nullptr);
}

TEST(SceneInWords, IsTheSceneInTheWordsOfOthers) {
  const TemporaryFolder folder;
  Words identify{"identify-scene", "--fix", "mass1=1.5", "--quiet"};
  for (const auto& [force, omega] : {std::pair{"10", "11.6:16.8:12"}, std::pair{"40", "23.2:33.6:12"}}) {
    identify.push_back(folder.path(std::string("f") + force + ".csv"));
    ASSERT_EQ(run_fracfit({"simulate", "--force", force, "--clearance", "0.3", "--mass1", "1.5", "--mass2", "0.8",
                           "--contact-frequency", "250", "--contact-restitution", "0.6", "--omega", omega, "--out",
                           identify.back()})
                  .code,
              0);
  }
  const auto json = nlohmann::json::parse(run_fracfit(joined(identify, {"--format", "json"})).output);
  const auto value = [&](const char* list, std::size_t i) { return json[list][i]["value"].get<double>(); };
  const double mass1 = value("parameters", 0), mass2 = value("parameters", 1), gap = value("parameters", 2);
  const double time = value("contact", 0), stiffness = value("contact", 1), damping = value("contact", 2);

  const std::string options = run_fracfit(joined(identify, {"--print", "options"})).output;
  for (const auto& [name, number] :
       {std::pair{"--mass1 ", mass1}, std::pair{"--mass2 ", mass2}, std::pair{"--clearance ", gap},
        std::pair{"--contact-stiffness ", stiffness}, std::pair{"--contact-damping ", damping}})
    EXPECT_EQ(number_after(options, name), number);

  const std::string modelica = run_fracfit(joined(identify, {"--print", "modelica"})).output;
  for (const auto& [name, number] :
       {std::pair{"load(J = ", mass1}, std::pair{"motor(J = ", mass2}, std::pair{"(b = ", gap},
        std::pair{", c = ", stiffness}, std::pair{", d = ", damping}})
    EXPECT_EQ(number_after(modelica, name), number);

  // The law of MuJoCo (Todorov 2014, and its documentation, "Computation"): the force f >= 0 makes the acceleration a
  // of the distance r with a + R f = aref, R = (1 - p)/p times the inverse inertia, aref = -B r' - K p r; a negative
  // solref gives K p^2 and B p.
  const std::string mjcf = run_fracfit(joined(identify, {"--print", "mjcf"})).output;
  EXPECT_EQ(number_after(mjcf, "range=\"-"), gap / 2);
  const std::string reference = "solreflimit=\"";
  const double first = number_after(mjcf, reference), p = number_after(mjcf, "solimplimit=\"");
  const double second = number_after(mjcf.substr(mjcf.find(reference)), io::format_number(first));
  const double inverse = 1 / number_after(mjcf, "diaginertia=\"") +
                         1 / number_after(mjcf.substr(mjcf.rfind("diaginertia")), "diaginertia=\"");
  const double k = -first / (p * p), b = -second / p, r = (1 - p) / p * inverse;
  const auto acceleration = [&](double distance, double rate) {
    return inverse * std::max(0.0, (-b * rate - k * p * distance) / (r + inverse));
  };
  // A free contact from speed 1 until it presses no more, by Runge and Kutta: steps of a thousandth leave 1e-10.
  const double h = time / 1000;
  double x = 0, v = -1, t = 0;
  while (t == 0 || acceleration(x, v) > 0) {
    const double a1 = acceleration(x, v), a2 = acceleration(x + h / 2 * v, v + h / 2 * a1);
    const double a3 = acceleration(x + h / 2 * (v + h / 2 * a1), v + h / 2 * a2);
    const double a4 = acceleration(x + h * (v + h / 2 * a2), v + h * a3);
    x += h * (v + h / 6 * (a1 + a2 + a3));
    v += h / 6 * (a1 + 2 * a2 + 2 * a3 + a4);
    t += h;
    ASSERT_LT(t, 2 * time);
  }
  // The end lies within a step; the share p of the reduced mass that moves with it changes frequency and damping ratio
  // by p/2 each.
  EXPECT_NEAR(t / time, 1, 1e-3 + p);
  EXPECT_NEAR(v / value("contact", 3), 1, 2 * p);

  // The same of masses that are given: each model but for the command that it names.
  Words given{"simulate"};
  std::istringstream words(options);
  for (std::string word; words >> word;) given.push_back(word);
  EXPECT_EQ(run_fracfit(joined(given, {"--print", "options"})).output, options);
  const auto without_command = [](const std::string& model) {
    return model.substr(0, model.find("fracfit ")) + model.substr(model.find_first_of("\"\n", model.find("fracfit ")));
  };
  EXPECT_EQ(without_command(run_fracfit(joined(given, {"--print", "modelica"})).output), without_command(modelica));
  EXPECT_EQ(without_command(run_fracfit(joined(given, {"--print", "mjcf"})).output), without_command(mjcf));
  const Words drive{"simulate", "--inertia1", "0.2",     "--inertia2",    "0.01", "--gear-ratio",  "5",
                    "--quiet",  "--print",    "options", "--gap-degrees", "18",   "--restitution", "0.5"};
  const std::string converted = run_fracfit(drive).output;
  EXPECT_EQ(number_after(converted, "--mass2 "), 0.25);
  EXPECT_NEAR(number_after(converted, "--clearance "), std::numbers::pi / 10, 1e-15);
  const Words rigid{"simulate", "--clearance", "1", "--restitution", "0.5", "--print", "modelica"};
  EXPECT_NE(run_fracfit(rigid).error.find("contacts of a simulator have a stiffness"), std::string::npos);
  EXPECT_EQ(run_fracfit(rigid).code, 2);
  EXPECT_EQ(run_fracfit(joined(drive, {"--force", "1"})).code, 2);
  EXPECT_EQ(run_fracfit(joined(drive, {"--clearance", "1,2"})).code, 2);

  const std::string hard = folder.path("hard.csv");
  ASSERT_EQ(run_fracfit({"simulate", "--force", "40", "--clearance", "0.3", "--restitution", "0.6", "--omega",
                         "18:30:12", "--out", hard})
                .code,
            0);
  const auto refused =
      run_fracfit({"identify-scene", hard, "--fix", "mass1=1", "--contact", "hard", "--quiet", "--print", "modelica"});
  EXPECT_EQ(refused.code, 1);
  EXPECT_NE(refused.error.find("the contact of the estimate takes no time"), std::string::npos) << refused.error;
}

// The torque K2 (1 + 1/(T s)) (K1 (r - x1) - s x2) by small steps h. The jump c v of the force where a contact begins
// within one is late by a part of it: the speeds, of which none is above 1, err by c v h/m = 3e-5 each time at most,
// and positions by that over the some 0.3 s that the loop takes to return.
TEST(Loop, ASpeedControllerOfTheMotorIsAReceptance) {
  constexpr double k1 = 2, k2 = 3, t = 0.5, mass1 = 0.5, mass2 = 1, gap = 0.1, stiffness = 2000, damping = 5;
  using State = std::array<double, 5>;  // x1, v1, x2, v2, integral of the speed error
  const auto rate = [&](const State& z) {
    const double y = z[2] - z[0], wall = y > 0 ? 1 : -1, overlap = wall * y - gap / 2;
    const double press = overlap > 0 ? wall * std::max(0.0, stiffness * overlap + damping * wall * (z[3] - z[1])) : 0;
    const double error = k1 * (1 - z[0]) - z[3];
    return State{z[1], press / mass1, z[3], (k2 * (error + z[4] / t) - press) / mass2, error};
  };
  const auto moved = [](State z, const State& by, double h) {
    for (std::size_t i = 0; i < z.size(); ++i) z[i] += h * by[i];
    return z;
  };
  const auto rows = rows_of({"loop",
                             "--controller",
                             "2 (3 + 3/(0.5 s))",
                             "--drive-receptance",
                             "1/(s^2 + 3 s + 3/0.5)",
                             "--mass1",
                             "0.5",
                             "--clearance",
                             "0.1",
                             "--contact-stiffness",
                             "2000",
                             "--contact-damping",
                             "5",
                             "--setpoint-step",
                             "1",
                             "--duration",
                             "3",
                             "--every",
                             "0.5",
                             "--impacts",
                             "1000",
                             "--format",
                             "csv"});
  State z{};
  constexpr double h = 2e-6;
  int compared = 0;
  for (int step = 0; step <= 1'500'000; ++step) {
    if (step % 250'000 == 0) {
      const auto row = std::find_if(rows.begin(), rows.end(), [&](const auto& of) { return of[0] == step / 5e5; });
      ASSERT_NE(row, rows.end()) << step;
      EXPECT_NEAR((*row)[1], z[0], 1e-5) << step;
      EXPECT_NEAR((*row)[3], z[2], 1e-5) << step;
      ++compared;
    }
    const State a = rate(z), b = rate(moved(z, a, h / 2)), c = rate(moved(z, b, h / 2)), d = rate(moved(z, c, h));
    for (std::size_t i = 0; i < z.size(); ++i) z[i] += h / 6 * (a[i] + 2 * b[i] + 2 * c[i] + d[i]);
  }
  EXPECT_EQ(compared, 7);
}

TEST(Loop, FollowsConstantForces) {
  const Words scene{"loop", "--controller", "2 + 3 s", "--body",  "x2", "--restitution", "0",  "--clearance",
                    "0.2",  "--duration",   "60",      "--every", "60", "--format",      "csv"};
  // At rest the spring 2 of the controller holds both forces, and the load lies at the wall towards which it is pushed.
  const auto rows = rows_of(joined(scene, {"--disturbance1", "0.3", "--disturbance2", "-0.1"}));
  EXPECT_NEAR(rows.back()[3], 0.1, 1e-9);
  EXPECT_NEAR(rows.back()[1], 0.2, 1e-9);
  EXPECT_EQ(run_fracfit(joined(scene, {"--disturbance1", "0.3", "--sample-time", "0.01"})).code, 2);
  EXPECT_EQ(run_fracfit(joined(scene, {"--encoder-step", "0.1"})).code, 2);
}

}  // namespace
