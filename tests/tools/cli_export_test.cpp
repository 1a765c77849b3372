// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <regex>
#include <string>
#include <vector>

#include "run_program.hpp"

namespace {

std::vector<std::string> with(std::vector<std::string> arguments, const std::vector<std::string>& more) {
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

const std::vector<std::string> cpe{"export", "spice", "s^-0.5", "--kind", "impedance", "--band", "1e-3:1e3"};

TEST(ExportSpice, WritesElementsAndWhatIsCertifiedAboutThem) {
  const auto result = run_fracfit(with(cpe, {"--name", "cpe"}));
  ASSERT_EQ(result.code, 0) << result.error;
  const auto lines = lines_of(result.output);
  ASSERT_GT(lines.size(), 10U);
  EXPECT_NE(lines[0].find("largest relative error 0.000"), std::string::npos) << lines[0];
  EXPECT_NE(
      result.output.find(
          "*   fracfit export spice --model 's^-0.5' --kind impedance --band 1e-3:1e3 --tolerance 1e-3 --name cpe\n"),
      std::string::npos)
      << result.output;
  bool is_inside = false;
  for (const std::string& line : lines) {
    if (line == ".subckt cpe a b") is_inside = true;
    if (!is_inside || line.front() == '.') continue;
    EXPECT_TRUE(line.front() == 'R' || line.front() == 'C') << line;
    EXPECT_GT(std::stod(line.substr(line.rfind(' '))), 0) << line;
  }
  EXPECT_EQ(lines.back(), ".ends cpe");
}

std::vector<double> element_values(const std::string& netlist) {
  std::vector<double> values;
  for (const std::string& line : lines_of(netlist.substr(netlist.find(".subckt"))))
    if (line.front() != '.') values.push_back(std::stod(line.substr(line.rfind(' '))));
  return values;
}

TEST(ExportSpice, AnAdmittanceIsTheInverseOfAnImpedance) {
  const auto impedance = element_values(run_fracfit(cpe).output);
  const auto admittance =
      element_values(run_fracfit({"export", "spice", "s^0.5", "--kind", "admittance", "--band", "1e-3:1e3"}).output);
  ASSERT_EQ(impedance.size(), admittance.size());
  // Two ways to the same design, which stops at a relative 1e-12 or so.
  for (std::size_t i = 0; i < impedance.size(); ++i) EXPECT_NEAR(admittance[i] / impedance[i], 1, 1e-6);
}

// A chain of resistors, each alone or beside a capacitor, against the formula of Davidson and Cole.
TEST(ExportSpice, PowersOfSumsBecomeOnePorts) {
  const auto result = run_fracfit({"export", "spice", "3/(1 + 2 s)^0.6", "--kind", "impedance", "--band", "1e-2:1e2"});
  ASSERT_EQ(result.code, 0) << result.error;
  std::map<std::string, std::complex<double>> admittances;  // by the nodes of an element
  for (double omega = 0.01; omega <= 100; omega *= 1.1) {
    admittances.clear();
    for (const std::string& line : lines_of(result.output.substr(result.output.find("\nR1 ") + 1))) {
      if (line.front() == '.') break;
      const auto first = line.find(' '), last = line.rfind(' ');
      const double value = std::stod(line.substr(last));
      ASSERT_GT(value, 0) << line;
      admittances[line.substr(first, last - first)] +=
          line.front() == 'C' ? std::complex<double>(0, omega * value) : 1 / value;
    }
    std::complex<double> impedance = 0;
    for (const auto& [nodes, admittance] : admittances) impedance += 1.0 / admittance;
    const auto expected = 3.0 / std::pow(std::complex<double>(1, 2 * omega), 0.6);
    EXPECT_LT(std::abs(impedance / expected - 1.0), 1e-3) << omega;
  }
  EXPECT_GT(admittances.size(), 3U);
}

TEST(ExportSpice, TransferFunctionsHaveFourPorts) {
  const auto result = run_fracfit(
      {"export", "spice", "exp(-0.2 s)/(s^1.5 + 1)", "--kind", "transfer", "--band", "1e-2:1e2", "--name", "plant"});
  EXPECT_EQ(result.code, 0) << result.error;
  EXPECT_NE(result.output.find("\n.subckt plant in_plus in_minus out_plus out_minus\n"), std::string::npos);
  EXPECT_NE(result.output.find(" TD=0.2\n"), std::string::npos) << result.output;
}

void expect_refusal(const std::vector<std::string>& arguments, const std::string& words) {
  const auto result = run_fracfit(arguments);
  EXPECT_EQ(result.code, 2);
  EXPECT_TRUE(result.output.empty());
  EXPECT_NE(result.error.find(words), std::string::npos) << result.error;
}

TEST(ExportSpice, RefusalsNameTheQuantity) {
  expect_refusal({"export"}, "'fracfit export' expects one of ");
  expect_refusal({"export", "spicy"}, "not 'spicy' (did you mean spice?)");
  expect_refusal({"export", "spice", "s^-0.5", "--band", "1:10"}, "--kind is required");
  expect_refusal({"export", "spice", "s^1.2", "--kind", "impedance", "--band", "1:10"}, "Re Z = -");
  expect_refusal({"export", "spice", "(s+1)^-0.6", "--kind", "transfer", "--band", "1:10"}, "powers of sums");
  expect_refusal({"export", "spice", "R0/(s+1)", "--kind", "impedance", "--band", "1:10"}, "R0");
  expect_refusal({"export", "spice", "exp(-s)", "--kind", "impedance", "--band", "1:10"}, "dead time of 1 s");
  expect_refusal({"export", "spice", "s^1.2", "--kind", "transfer", "--band", "1:10"}, "the model grows as s^1.2");
  expect_refusal(with(cpe, {"--name", "9"}), "name of the subcircuit \"9\"");
}

const std::vector<std::string> design{"--kp",  "2", "--ki",   "3",       "--lambda", "0.8",  "--min",         "-5",
                                      "--max", "5", "--band", "0.1:300", "--name",   "loop", "--sample-time", "1e-3"};

// The two verbs differ in the command that the comment shows.
std::string without_comment(const std::string& header) {
  return header.substr(header.find("*/"));
}

TEST(ExportC99, WritesWhatControllerWrites) {
  const auto code = run_fracfit(with({"export", "c99"}, design));
  ASSERT_EQ(code.code, 0) << code.error;
  const auto old = run_fracfit(with(with({"controller"}, design), {"--format", "c"}));
  EXPECT_NE(code.output.find("\n *   fracfit export c99 --kp 2 --ki 3 "), std::string::npos) << code.output;
  const auto body = [](const std::string& header) {
    // The guard holds a fingerprint of the whole text, comment included.
    return std::regex_replace(without_comment(header), std::regex("LOOP_H_[0-9a-f]+"), "");
  };
  EXPECT_EQ(body(code.output), body(old.output));
}

TEST(ExportC99, FixedPointStatesItsError) {
  const std::vector<std::string> filter{"export", "c99",           "--model", "s^-0.5",        "--band",
                                        "0.1:70", "--sample-time", "0.02",    "--fixed-point", "5:100"};
  const auto result = run_fracfit(with(filter, {"--discretisation", "tustin"}));
  ASSERT_EQ(result.code, 0) << result.error;
  EXPECT_NE(result.output.find("int32_t filter_step(filter_state *s, int32_t sample)"), std::string::npos);
  EXPECT_NE(result.output.find("an output differs from the exact one by "), std::string::npos);
  EXPECT_NE(result.output.find("--fixed-point 5:100 --name filter\n"), std::string::npos) << result.output;
  // The default design, with taps.
  const auto direct = run_fracfit(filter);
  EXPECT_EQ(direct.code, 0) << direct.error;
  EXPECT_NE(direct.output.find("filter_section_tap["), std::string::npos);
  expect_refusal(
      {"export", "c99", "--model", "s^-2.5", "--band", "0.1:70", "--sample-time", "0.02", "--fixed-point", "5:100"},
      "2 integrators; fixed point takes one");
  expect_refusal(with(filter, {"--precision", "float"}), "--fixed-point has no meaning with --precision float");
  const auto pid = run_fracfit({"export", "c99", "--kp", "1", "--ki", "2", "--lambda", "0.8", "--sample-time", "0.01",
                                "--band", "0.1:100", "--discretisation", "tustin", "--fixed-point", "2:10"});
  EXPECT_EQ(pid.code, 0) << pid.error;
  EXPECT_NE(pid.output.find("controller_step(controller_state *s, int32_t setpoint, int32_t measured)"),
            std::string::npos);
  const auto tapped = run_fracfit({"export", "c99", "--kp", "1", "--ki", "2", "--lambda", "0.8", "--sample-time",
                                   "0.01", "--band", "0.1:100", "--fixed-point", "2:10"});
  EXPECT_EQ(tapped.code, 0) << tapped.error;
  EXPECT_NE(tapped.output.find("controller_integral_tap["), std::string::npos);
}

TEST(ExportArduino, WritesALibraryWithASketchThatCompiles) {
  const TemporaryFolder folder;
  const auto result = run_fracfit(with(with({"export", "arduino"}, design), {"--out", folder.path("loop")}));
  ASSERT_EQ(result.code, 0) << result.error;
  const std::string header = content_of(folder.path("loop/src/loop.h"));
  EXPECT_NE(header.find("static inline float loop_step("), std::string::npos);
  const std::string properties = content_of(folder.path("loop/library.properties"));
  for (const char* key :
       {"name=loop\n", "version=", "author=", "maintainer=", "sentence=Fractional PID, 2 + 3/s^0.8",
        "paragraph=", "category=Signal Input/Output\n", "url=", "architectures=*\n", "includes=loop.h\n"})
    EXPECT_NE(properties.find(key), std::string::npos) << properties;
  EXPECT_EQ(lines_of(properties).size(), 10U) << properties;
  EXPECT_NE(content_of(folder.path("loop/keywords.txt")).find("loop_step\tKEYWORD2\n"), std::string::npos);
  const std::string sketch = content_of(folder.path("loop/examples/loop_example/loop_example.ino"));
  EXPECT_NE(sketch.find("next_time += 1000UL;"), std::string::npos) << sketch;
  if (std::system("c++ --version >/dev/null 2>&1") != 0) GTEST_SKIP() << "no C++ compiler";
  // What a sketch finds around it on every board.
  const std::string board = folder.write(
      "board.cpp",
      "#define A0 14\n#define OUTPUT 1\nvoid pinMode(int, int);\nint analogRead(int);\nvoid analogWrite(int, int);\n"
      "unsigned long micros();\n#include \"" +
          folder.path("loop/examples/loop_example/loop_example.ino") + "\"\n");
  const auto compiled =
      run_shell("c++ -std=c++11 -Wall -Wextra -Werror -fsyntax-only -I" + folder.path("loop/src") + " " + board);
  EXPECT_EQ(compiled.code, 0) << compiled.error;
}

TEST(ExportArduino, RefusesASampleTimeThatABoardCannotCount) {
  const TemporaryFolder folder;
  expect_refusal({"export", "arduino", "--kp", "1", "--sample-time", "1e-7", "--out", folder.path("loop")},
                 "--sample-time = 1e-07 s; allowed is 1e-6 to 2000 s");
  EXPECT_FALSE(std::filesystem::exists(folder.path("loop")));
}

}  // namespace
