// SPDX-License-Identifier: BSD-3-Clause
// Which part of the response is fitted unless told otherwise.
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <nlohmann/json.hpp>
#include <random>
#include <sstream>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "frac/identification/economy.hpp"
#include "frac/identification/fit.hpp"
#include "run_program.hpp"

namespace {

using Json = nlohmann::ordered_json;

Json successful(const std::vector<std::string>& arguments) {
  const auto result = run_fracfit(arguments);
  EXPECT_EQ(result.code, 0) << result.error;
  return Json::parse(result.output);
}

/// 2/(0.5 s + 1), exact.
std::complex<double> lag(double omega) {
  return 2.0 / std::complex<double>(1, 0.5 * omega);
}

std::string rows(const std::string& header, bool with_zeros) {
  std::ostringstream text;
  text.precision(17);
  text << header << '\n';
  for (int i = 0; i <= 40; ++i) {
    const double omega = std::pow(10.0, -1 + i / 20.0);
    text << omega << (with_zeros ? ",0," : ",") << lag(omega).imag() << '\n';
  }
  return text.str();
}

class ImaginaryPartAlone : public testing::Test {
 protected:
  TemporaryFolder folder;
  std::string alone = folder.write("alone.csv", rows("omega_rad_s,im", false));
  std::string zeros = folder.write("zeros.csv", rows("omega_rad_s,re,im", true));
};

double value_of(const Json& parameters, const std::string& name) {
  for (const auto& each : parameters)
    if (each["name"] == name) return each["value"].get<double>();
  ADD_FAILURE() << "no " << name;
  return 0;
}

/// Defaults in the signature of a function of the Python module.
std::string python_default(const std::string& module, const std::string& function, const std::string& parameter) {
  const auto begin = module.find("\ndef " + function + "(\n");
  const auto end = module.find("\n)", begin);
  const auto at = module.find("\n    " + parameter + ": ", begin);
  EXPECT_LT(at, end) << function << " " << parameter;
  const auto first = module.find(" = ", at) + 3;
  return module.substr(first, module.find(",\n", first) - first);
}

// C++, command line and Python fit the same where nothing is said.
TEST(DefaultComponent, IsOneInAllFrontEnds) {
  const std::string component(frac::to_string(frac::FitOptions{}.component));
  const std::string weight(frac::to_string(frac::FitOptions{}.weight));
  EXPECT_EQ(component, "both");
  EXPECT_EQ(weight, "learned");
  EXPECT_EQ(frac::EconomyOptions{}.component, frac::FitOptions{}.component);
  const std::string examples = FRACFIT_SOURCE_DIR "/data/examples/", cell = examples + "cell.csv";
  const std::string one = examples + "spectra/cell-1.csv", other = examples + "spectra/cell-2.csv";
  for (const auto& command : {std::vector<std::string>{"fit", cell, "--model", "zarc"},
                              std::vector<std::string>{"identify", cell, "--models", "zarc,r-rc"},
                              std::vector<std::string>{"joint-fit", one, other, "--model", "zarc", "--shared", "R0"}}) {
    const Json json = successful(command);
    EXPECT_EQ(json["options"]["component"], component) << command.front();
    EXPECT_EQ(json["options"]["weight"], weight) << command.front();
  }
  const std::string module = content_of(FRACFIT_SOURCE_DIR "/tools/python/fracfit/_fit.py");
  EXPECT_NE(module.find("otherwise: str = \"" + weight + "\") -> str:"), std::string::npos);
  for (const char* function : {"fit", "identify"}) {
    EXPECT_EQ(python_default(module, function, "component"), '"' + component + '"') << function;
    // A weight of None is that of a sigma that was measured, or else this one.
    EXPECT_EQ(python_default(module, function, "weight"), "None") << function;
  }
}

// The imaginary part of an impedance alone leaves the resistance of an arc open to infinity.  Of the model that made
// these data every parameter is met: five standard errors are exceeded once in two million.
TEST(DefaultComponent, GivesTheArcsOfAnImpedanceFiniteIntervals) {
  const std::string cell = FRACFIT_SOURCE_DIR "/data/examples/cell.csv";
  const Json two = successful({"fit", cell, "--model", "R0 + R1/(1 + R1 Q1 s^n1) + R2/(1 + R2 Q2 s^n2)"});
  const std::pair<const char*, double> truth[] = {{"R0", 0.02}, {"R1", 0.03}, {"Q1", 0.05}, {"n1", 0.85},
                                                  {"R2", 0.06}, {"Q2", 4},    {"n2", 0.75}};
  for (const auto& [name, value] : truth) {
    for (const auto& each : two["parameters"]) {
      if (each["name"] != name) continue;
      EXPECT_NEAR(each["value"].get<double>(), value, 5 * each["standard_error"].get<double>()) << name;
      EXPECT_TRUE(each["ci95"][0].is_number() && each["ci95"][1].is_number()) << each;
    }
    static_cast<void>(value_of(two["parameters"], name));
  }
}

TEST_F(ImaginaryPartAlone, IsWhatIsFitted) {
  for (const auto& file : {alone, zeros}) {
    const auto result = run_fracfit({"fit", file, "--model", "K/(T s + 1)"});
    ASSERT_EQ(result.code, 0) << result.error;
    EXPECT_NE(result.error.find("so that the imaginary part alone is fitted"), std::string::npos) << result.error;
    const Json json = Json::parse(result.output);
    EXPECT_EQ(json["options"]["component"], "imaginary");
    EXPECT_EQ(json["residuals"], 41);
    // Exact to 17 digits; the search stops at a relative change of the cost near 1e-12, so parameters hold 1e-6.
    EXPECT_NEAR(value_of(json["parameters"], "K"), 2, 2e-6);
    EXPECT_NEAR(value_of(json["parameters"], "T"), 0.5, 5e-7);
    // The command in the result makes it again, and says nothing any more.
    EXPECT_NE(json["command"].get<std::string>().find(" --component imaginary "), std::string::npos) << json["command"];
    const auto again = run_fracfit({"fit", file, "--model", "K/(T s + 1)", "--component", "imaginary"});
    EXPECT_EQ(again.error.find("so that"), std::string::npos) << again.error;
    EXPECT_EQ(Json::parse(again.output)["parameters"], json["parameters"]);
  }
  // The frequency-independent part is not taken from zeros that nobody has measured.
  const Json open = successful({"fit", alone, "--model", "R + K/(T s + 1)"});
  EXPECT_FALSE(open["parameters"][0]["identified"].get<bool>()) << open["parameters"];
}

TEST_F(ImaginaryPartAlone, IsWhatEveryCommandFits) {
  const auto identified = successful({"identify", alone, "--models", "lag,gain"});
  EXPECT_EQ(identified["options"]["component"], "imaginary");
  EXPECT_EQ(identified["chosen"], "lag");

  const auto law = successful({"fit", alone, "--model", "component-power-law", "--where", "omega<0.2"});
  EXPECT_EQ(law["options"]["component"], "imaginary");
  // |Im| = omega/(1 + omega^2/4) falls short of omega by omega^2/4, 1 % at most: the slope is 1 but for twice that.
  EXPECT_NEAR(value_of(law["parameters"], "b"), 1, 0.02);

  // Beside a curve that has both parts, all count by what they have in common.
  std::ostringstream whole;
  whole.precision(17);
  whole << "omega_rad_s,re,im\n";
  for (int i = 0; i <= 20; ++i) {
    const double omega = std::pow(10.0, -1 + i / 10.0);
    whole << omega << ',' << lag(omega).real() << ',' << lag(omega).imag() << '\n';
  }
  const auto complete = folder.write("whole.csv", whole.str());
  const auto joint = run_fracfit({"joint-fit", complete, alone, "--model", "K/(T s + 1)", "--shared", "T"});
  ASSERT_EQ(joint.code, 0) << joint.error;
  EXPECT_NE(joint.error.find("alone is fitted in all curves"), std::string::npos) << joint.error;
  const Json of_all = Json::parse(joint.output);
  EXPECT_EQ(of_all["options"]["component"], "imaginary");
  EXPECT_NEAR(value_of(of_all["shared"], "T"), 0.5, 5e-7);

  // A batch fits each curve by what it has.
  const auto batch = run_fracfit({"batch", complete, alone, "--model", "K/(T s + 1)", "--format", "jsonl"});
  ASSERT_EQ(batch.code, 0) << batch.error;
  const auto lines = lines_of(batch.output);
  ASSERT_EQ(lines.size(), 3U) << batch.output;
  for (const std::size_t i : {1U, 2U}) {
    const Json row = Json::parse(lines[i]);
    EXPECT_NEAR(row["K"].get<double>(), 2, 2e-6);
    EXPECT_EQ(row["message"].get<std::string>().find("the imaginary part alone") != std::string::npos, i == 2)
        << row["message"];
  }
}

// What asks for the part that is not there is refused, and says what is missing.
TEST_F(ImaginaryPartAlone, IsNoRealPartNorAWholeResponse) {
  const std::vector<std::string> fit{"fit", alone, "--model", "K/(T s + 1)"};
  for (const char* component : {"real", "magnitude", "phase"}) {
    auto arguments = fit;
    arguments.insert(arguments.end(), {"--component", component});
    const auto result = run_fracfit(arguments);
    EXPECT_EQ(result.code, 3) << component;
    EXPECT_NE(result.error.find("no real part among the columns omega_rad_s, im"), std::string::npos) << result.error;
  }
  EXPECT_EQ(run_fracfit({"validate", alone}).code, 3);
  const auto inverse = run_fracfit({"fit", folder.write("n.csv", rows("omega_rad_s,im_m_per_n", false)), "--model",
                                    "K s", "--quantity", "minus-inverse"});
  EXPECT_EQ(inverse.code, 3);
  EXPECT_NE(inverse.error.find("holds no real part"), std::string::npos) << inverse.error;
  auto conditional = fit;
  conditional.insert(conditional.end(), {"--where", "re<1"});
  EXPECT_EQ(run_fracfit(conditional).code, 2);
}

class ImpedanceOrAdmittance : public testing::Test {
 protected:
  /// Y = (s - 1)/(s + 10) + 0.5, whose pole is stable; Z = 1/Y = (s + 10)/(1.5 s + 4), or with 0.05 in place of 0.5 one
  /// with the pole 0.5/1.05 right of the axis.  Noise of 0.1 %, seeded.
  std::string file_of(const std::string& name, const std::string& unit, double constant, bool as_admittance) {
    std::mt19937 generator(7);
    std::normal_distribution<double> noise(0, 1e-3);
    std::ostringstream text;
    text.precision(17);
    text << "omega_rad_s,re" << unit << ",im" << unit << '\n';
    for (int i = 0; i <= 60; ++i) {
      const double omega = std::pow(10.0, -1 + i / 15.0);
      const std::complex<double> s(0, omega);
      const auto disturbed =
          ((s - 1.0) / (s + 10.0) + constant) * (1.0 + std::complex<double>(noise(generator), noise(generator)));
      const auto value = as_admittance ? disturbed : 1.0 / disturbed;
      text << omega << ',' << value.real() << ',' << value.imag() << '\n';
    }
    return folder.write(name, text.str());
  }
  TemporaryFolder folder;
};

// What the same numbers give as the other quantity: each command sees the same values but for the rounding of two
// divisions, and the optimum moves by no more than the search's own end, 1e-6 of a parameter.
TEST_F(ImpedanceOrAdmittance, IsMadeOfTheOther) {
  const auto z = file_of("z.csv", "_ohm", 0.5, false), y = file_of("y.csv", "_S", 0.5, true);
  for (const auto& [given, other, word, unit] :
       {std::tuple(z, y, "admittance", "S"), std::tuple(y, z, "impedance", "ohm")}) {
    const auto made = run_fracfit({"fit", given, "--model", "(A s + B)/(s + p)", "--component", word});
    ASSERT_EQ(made.code, 0) << made.error;
    EXPECT_NE(made.error.find(std::string("values are the ") + word + ", 1 over the "), std::string::npos)
        << made.error;
    const Json json = Json::parse(made.output);
    EXPECT_EQ(json["options"]["component"], word);
    EXPECT_EQ(json["parameters"][0]["unit"], unit);
    const Json direct = successful({"fit", other, "--model", "(A s + B)/(s + p)"});
    for (const char* name : {"A", "B", "p"})
      EXPECT_NEAR(value_of(json["parameters"], name) / value_of(direct["parameters"], name), 1, 2e-6) << name << word;
    // A file that holds what is asked for is taken as it is.
    const auto same = run_fracfit({"fit", other, "--model", "(A s + B)/(s + p)", "--component", word});
    EXPECT_EQ(same.error.find("values are"), std::string::npos) << same.error;
    EXPECT_EQ(Json::parse(same.output)["parameters"], direct["parameters"]);
  }
  const Json ranked = successful({"identify", z, "--models", "rational:1,gain", "--component", "admittance"});
  EXPECT_EQ(ranked["options"]["component"], "admittance");
  const auto batch =
      run_fracfit({"batch", z, y, "--model", "(A s + B)/(s + p)", "--component", "impedance", "--format", "jsonl"});
  ASSERT_EQ(batch.code, 0) << batch.error;
  const auto lines = lines_of(batch.output);
  std::vector<double> gains;
  for (const auto& line : lines)
    if (const Json row = Json::parse(line); row.contains("A")) gains.push_back(row["A"].get<double>());
  ASSERT_EQ(gains.size(), 2U);
  EXPECT_NEAR(gains[0] / gains[1], 1, 2e-6);
}

// An impedance with a pole right of the axis is no stable response, while the admittance, measured at a held voltage,
// is one: the verdicts differ by construction.
TEST_F(ImpedanceOrAdmittance, IsJudgedByItself) {
  const auto z = file_of("unstable.csv", "_ohm", 0.05, false);
  EXPECT_EQ(successful({"validate", z, "--format", "json"})["rows"][0]["validity"], "invalid");
  const Json held = successful({"validate", z, "--component", "admittance", "--format", "json"});
  EXPECT_EQ(held["rows"][0]["validity"], "valid");
  EXPECT_EQ(held["component"], "admittance");
}

TEST_F(ImpedanceOrAdmittance, OfOtherDataIsRefusedOrSaysWhatItTook) {
  const auto modulus = run_fracfit({"validate", file_of("m.csv", "_Pa", 0.5, false), "--component", "admittance"});
  EXPECT_EQ(modulus.code, 3);
  EXPECT_NE(modulus.error.find("holds values in Pa, which are neither an impedance nor an admittance"),
            std::string::npos)
      << modulus.error;
  const auto unknown =
      run_fracfit({"validate", file_of("n.csv", "", 0.5, false), "--component", "admittance", "--format", "json"});
  EXPECT_EQ(unknown.code, 0);
  EXPECT_NE(unknown.error.find("they are taken for the impedance, and 1 over them for the admittance"),
            std::string::npos)
      << unknown.error;
  const auto both = run_fracfit(
      {"fit", file_of("z.csv", "_ohm", 0.5, false), "--model", "zarc", "--component", "admittance", "--quantity", "n"});
  EXPECT_EQ(both.code, 2);
  const auto alone = folder.write("alone.csv", "omega_rad_s,im_ohm\n1,-1\n2,-2\n3,-1\n");
  const auto missing = run_fracfit({"fit", alone, "--model", "lag", "--component", "admittance"});
  EXPECT_EQ(missing.code, 3);
  EXPECT_NE(missing.error.find("holds no real part, without which the admittance is not known"), std::string::npos)
      << missing.error;
}

}  // namespace
