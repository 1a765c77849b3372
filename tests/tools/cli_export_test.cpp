// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

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
  expect_refusal({"export", "spice", "exp(-s)", "--kind", "impedance", "--band", "1:10"}, "dead time of 1 s");
  expect_refusal({"export", "spice", "s^1.2", "--kind", "transfer", "--band", "1:10"}, "the model grows as s^1.2");
  expect_refusal(with(cpe, {"--name", "9"}), "name of the subcircuit \"9\"");
}

}  // namespace
