// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "run_program.hpp"

namespace {

TEST(JumpLaw, WithoutAnyJumpItRanButHasNoUsableResult) {
  // At restitution 0 two impacts per period remain at every lower frequency.
  const auto result = run_fracfit({"jump-law", "--restitution", "0"});
  EXPECT_EQ(result.code, 1);
  EXPECT_NE(result.error.find("two-impact-loss"), std::string::npos) << result.error;
  const auto json = nlohmann::json::parse(result.output);
  EXPECT_EQ(json["averaged"], 0);
  EXPECT_EQ(json["left_out"], 1);
  EXPECT_TRUE(json["laws"].empty());
  EXPECT_TRUE(json["points"][0]["omega_jump"].is_null());
  EXPECT_NE(json["constants"][0]["meaning"].get<std::string>().find("stick"), std::string::npos);
}

// Laws and constants name the same things alike, with units as the columns of CSV have them.
TEST(JumpLaw, KeysAreThoseOfTheOtherOutputs) {
  const auto laws = nlohmann::json::parse(run_fracfit({"jump-law"}).output);
  const auto constants = nlohmann::json::parse(run_fracfit({"jump-law", "--constants"}).output);
  for (const char* key : {"criterion", "mean_similarity_constant", "constants", "averaged", "left_out"}) {
    ASSERT_TRUE(laws.contains(key) && constants.contains(key)) << key;
    EXPECT_EQ(laws[key], constants[key]) << key;
  }
  const auto& point = laws["points"][0];
  EXPECT_EQ(point["force_n"], point["force"]);
  EXPECT_EQ(point["clearance_m"], point["clearance"]);
  EXPECT_EQ(point["omega_jump_rad_s"], point["omega_jump"]);
  EXPECT_EQ(laws["laws"][0]["clearance_m"], laws["laws"][0]["clearance"]);
}

TEST(JumpLaw, SaysWhichRestitutionsAreAveraged) {
  const auto result = run_fracfit({"jump-law", "--restitution", "0,0.05,0.6,1"});
  ASSERT_EQ(result.code, 0) << result.error;
  const auto json = nlohmann::json::parse(result.output);
  EXPECT_EQ(json["averaged"], 3);
  EXPECT_EQ(json["left_out"], 1);
  double sum = 0;
  for (const auto& constant : json["constants"]) {
    if (constant["averaged"].get<bool>()) sum += constant["similarity_constant"].get<double>();
  }
  EXPECT_NEAR(json["similarity"]["mean_constant"].get<double>(), sum / 3, 1e-12);
}

TEST(JumpLaw, ConstantsOverRestitutionStandInATable) {
  const auto result = run_fracfit(
      {"jump-law", "--constants", "--restitution", "0.2,0.4,0.6", "--criterion", "symmetry-loss", "--format", "csv"});
  ASSERT_EQ(result.code, 0) << result.error;
  EXPECT_NE(result.output.find("restitution,similarity_constant,meaning\n0.2,"), std::string::npos) << result.output;
  // Pitchfork at gamma_sb = .3660699362 for restitution 0.6, c = gamma^-1/2; tabled to ten digits.
  const auto row = result.output.find("\n0.6,");
  ASSERT_NE(row, std::string::npos);
  EXPECT_NEAR(std::stod(result.output.substr(row + 5)), 1 / std::sqrt(.3660699362), 3e-10);
}

// c depends on restitution alone, so one force is as good as five; sweeps take the scenes that are given.
TEST(JumpLaw, ConstantsNeedNoMoreThanOneScene) {
  const std::vector<std::string> constants{"jump-law", "--constants", "--restitution", "0.4,0.6"};
  auto one_force = constants;
  one_force.insert(one_force.end(), {"--force", "3"});
  const auto result = run_fracfit(one_force);
  EXPECT_EQ(result.code, 0);
  EXPECT_EQ(result.output, run_fracfit(constants).output);
  EXPECT_NE(result.error.find("depend on restitution alone"), std::string::npos) << result.error;
  one_force.insert(one_force.end(), {"--clearance", "0.3", "--criterion", "largest-discontinuity"});
  const auto swept = run_fracfit(one_force);
  ASSERT_EQ(swept.code, 0) << swept.error;
  EXPECT_EQ(swept.error.find("restitution alone"), std::string::npos) << swept.error;
  EXPECT_NE(swept.output.find("1 of 1 sweeps"), std::string::npos) << swept.output;
}

TEST(JumpLaw, OneValueIsRefusedWithWhatIsAllowed) {
  for (const std::string option : {"--force", "--clearance"}) {
    const auto result = run_fracfit({"jump-law", option, "0.3"});
    EXPECT_EQ(result.code, 2);
    EXPECT_NE(result.error.find(option + " is one value; the laws need at least two"), std::string::npos)
        << result.error;
    EXPECT_NE(result.error.find("--constants"), std::string::npos) << result.error;
    const auto twice = run_fracfit({"jump-law", option, "0.3,0.3"});
    EXPECT_EQ(twice.code, 2);
    EXPECT_NE(twice.error.find("holds 0.3 twice"), std::string::npos) << twice.error;
  }
}

TEST(JumpLaw, TablesFitATerminal) {
  for (const std::vector<std::string>& arguments :
       {std::vector<std::string>{"jump-law", "--format", "table"},
        std::vector<std::string>{"jump-law", "--constants", "--format", "table"}}) {
    const auto result = run_fracfit(arguments);
    ASSERT_EQ(result.code, 0) << result.error;
    std::istringstream lines(result.output);
    for (std::string line; std::getline(lines, line);) EXPECT_LE(line.size(), 80u) << line;
  }
}

TEST(Simulate, DiagnosticsAreColumnsAfterTheOthers) {
  const std::vector<std::string> scene{"simulate",      "--force", "40",      "--clearance", "0.3",
                                       "--restitution", "0.6",     "--omega", "8:20:5"};
  auto with = scene;
  with.emplace_back("--diagnostics");
  const auto plain = run_fracfit(scene);
  const auto more = run_fracfit(with);
  ASSERT_EQ(plain.code, 0) << plain.error;
  ASSERT_EQ(more.code, 0) << more.error;
  const std::string columns =
      "omega_rad_s,re_m_per_n,im_m_per_n,regime,period,impacts_per_period,uncertainty_m_per_n,third_harmonic_ratio";
  EXPECT_NE(plain.output.find("\n" + columns + "\n"), std::string::npos);
  const std::string longer = "\n" + columns +
                             ",even_harmonic_ratio,energy_defect,lyapunov_exponent,periods_followed,transient_possible,"
                             "force_sensitivity\n";
  const auto rows = more.output.find(longer);
  ASSERT_NE(rows, std::string::npos);
  // Each row begins with the row without diagnostics.
  std::size_t from = plain.output.find("\n" + columns + "\n") + columns.size() + 2;
  while (from < plain.output.size()) {
    const auto end = plain.output.find('\n', from);
    EXPECT_NE(more.output.find("\n" + plain.output.substr(from, end - from) + ",", rows), std::string::npos);
    from = end + 1;
  }
  EXPECT_EQ(run_fracfit({"simulate", "--force", "40", "--clearance", "0.3", "--omega", "8:20:5", "--motion", "static",
                         "--diagnostics"})
                .code,
            2);
}

TEST(Simulate, FrequenciesThatLeaveTheRangeOfNumbersAreRefused) {
  for (const std::string omega : {"1e200", "1e-200"}) {
    const auto result =
        run_fracfit({"simulate", "--force", "40", "--clearance", "0.3", "--restitution", "0.6", "--omega", omega});
    EXPECT_EQ(result.code, 2);
    EXPECT_NE(result.error.find("range of numbers"), std::string::npos) << result.error;
  }
  for (const std::string omega : {"1e140", "1e-140", "1e20", "1e-9", "1e9"}) {
    const auto result = run_fracfit(
        {"simulate", "--force", "40", "--clearance", "0.3", "--restitution", "0.6", "--omega", omega, "--body", "x2"});
    EXPECT_EQ(result.code, 0) << result.error;
    EXPECT_EQ(result.output.find("nan"), std::string::npos) << result.output;
  }
}

// Stiff contacts have the law of their restitution but for a share of w/wc, soft ones a smaller exponent of the force,
// and that of the clearance the larger for it; --constants says the same for one scene.
TEST(JumpLaw, ContactsThatTakeTimeLowerTheExponent) {
  const std::vector<std::string> scene{"jump-law", "--force", "0.99,1,1.01", "--clearance", "0.99,1,1.01", "--quiet"};
  const auto law_of = [&](const std::string& frequency) {
    std::vector<std::string> arguments = scene;
    arguments.insert(arguments.end(), {"--contact-frequency", frequency, "--contact-restitution", "0.6"});
    const auto result = run_fracfit(arguments);
    EXPECT_EQ(result.code, 0) << result.error;
    return nlohmann::json::parse(result.output);
  };
  const auto soft = law_of("10"), stiff = law_of("10000");
  EXPECT_EQ(soft["criterion"], "symmetry-loss");
  EXPECT_EQ(soft["points"][0]["contact_frequency_rad_s"], 10);
  EXPECT_EQ(soft["points"][0]["contact_restitution"], 0.6);
  EXPECT_NEAR(soft["points"][0]["restitution"].get<double>(), 0.6, 1e-14);
  const double b = soft["laws"][1]["b"], a = soft["a_of_clearance"]["exponent"];
  const auto one = run_fracfit({"jump-law", "--constants", "--force", "1", "--clearance", "1", "--contact-frequency",
                                "10", "--contact-restitution", "0.6", "--format", "csv"});
  ASSERT_EQ(one.code, 0) << one.error;
  const auto lines = lines_of(one.output);
  ASSERT_GT(lines.size(), 2u);
  EXPECT_EQ(lines[lines.size() - 2],
            "force_n,clearance_m,contact_frequency_rad_s,contact_restitution,stiffness_group,similarity_constant,"
            "exponent,clearance_exponent,meaning");
  std::istringstream row(lines.back());
  std::vector<double> numbers;
  for (std::string cell; numbers.size() < 7 && std::getline(row, cell, ',');) numbers.push_back(std::stod(cell));
  EXPECT_NEAR(numbers[4], 100, 1e-12);
  // Over 1 % of the force a secant differs from the tangent by the square of that.
  EXPECT_NEAR(numbers[6], b, 1e-4);
  EXPECT_NEAR(a, -b, 1e-4);
  EXPECT_LT(b, 0.48);
  // w/wc is 1.65e-4, and b is off by about half of that.
  EXPECT_NEAR(stiff["laws"][1]["b"].get<double>(), 0.5, 2e-4);

  const auto refused =
      run_fracfit({"jump-law", "--contact-stiffness", "1", "--contact-damping", "1", "--criterion", "sweep-up"});
  EXPECT_EQ(refused.code, 2);
  EXPECT_NE(refused.error.find("symmetry-loss or saddle-node"), std::string::npos) << refused.error;
  const auto undamped = run_fracfit({"jump-law", "--contact-stiffness", "1", "--contact-damping", "0"});
  EXPECT_EQ(undamped.code, 2);
  EXPECT_NE(undamped.error.find("--contact-damping is 0"), std::string::npos) << undamped.error;
  const auto friction = run_fracfit({"jump-law", "--friction1", "1"});
  EXPECT_EQ(friction.code, 2);
  EXPECT_NE(friction.error.find("--friction1 needs --contact-stiffness or --contact-frequency"), std::string::npos)
      << friction.error;
}

// Dry friction of a tenth of the force on the load. Over 1 % of the force a secant is the tangent but for 1e-4.
TEST(JumpLaw, DryFrictionMovesTheExponentOfTheForce) {
  const std::vector<std::string> contact{
      "jump-law",    "--contact-frequency", "20",     "--contact-restitution", "0.6", "--friction1", "0.1",
      "--criterion", "saddle-node",         "--quiet"};
  std::vector<std::string> law = contact, one = contact;
  law.insert(law.end(), {"--force", "0.99,1.01", "--clearance", "0.99,1.01"});
  const auto fitted = run_fracfit(law);
  ASSERT_EQ(fitted.code, 0) << fitted.error;
  const auto json = nlohmann::json::parse(fitted.output);
  EXPECT_EQ(json["scene"]["friction1_n"], 0.1);
  one.insert(one.end(), {"--constants", "--force", "1", "--clearance", "1", "--format", "csv"});
  const auto constants = run_fracfit(one);
  ASSERT_EQ(constants.code, 0) << constants.error;
  EXPECT_NE(constants.output.find("# friction1_n: 0.1\n"), std::string::npos) << constants.output;
  std::istringstream row(lines_of(constants.output).back());
  std::vector<double> numbers;
  for (std::string cell; numbers.size() < 8 && std::getline(row, cell, ',');) numbers.push_back(std::stod(cell));
  const double b = 0.5 * (json["laws"][0]["b"].get<double>() + json["laws"][1]["b"].get<double>());
  EXPECT_NEAR(numbers[6], b, 1e-4);
  EXPECT_NEAR(numbers[7], json["a_of_clearance"]["exponent"].get<double>(), 1e-4);
  // Above 1/2, unlike contacts without friction.
  EXPECT_GT(b, 0.5);
}

}  // namespace
