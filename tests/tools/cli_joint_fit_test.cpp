// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <nlohmann/json.hpp>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

#include "run_program.hpp"

namespace {

using Json = nlohmann::ordered_json;

/// Power laws K s^0.7 with K = 2, 3, 4 as three files, or as one file with the gain in a column.
struct PowerLaws {
  TemporaryFolder folder;
  std::vector<std::string> files;
  std::string one_file;
  PowerLaws() {
    std::ostringstream together;
    together.precision(17);
    together << "gain,omega_rad_s,re,im\n";
    for (int gain = 2; gain <= 4; ++gain) {
      std::ostringstream text;
      text.precision(17);
      text << "omega_rad_s,re,im\n";
      for (int i = 0; i <= 20; ++i) {
        const double omega = std::pow(10.0, -1 + i / 10.0);
        const std::complex<double> value = static_cast<double>(gain) * std::pow(std::complex<double>(0, omega), 0.7);
        text << omega << ',' << value.real() << ',' << value.imag() << '\n';
        together << gain << ',' << omega << ',' << value.real() << ',' << value.imag() << '\n';
      }
      files.push_back(folder.write("gain" + std::to_string(gain) + ".csv", text.str()));
    }
    one_file = folder.write("all.csv", together.str());
  }
  [[nodiscard]] ProgramResult joint(std::vector<std::string> data, const std::vector<std::string>& more) const {
    std::vector<std::string> arguments{"joint-fit"};
    arguments.insert(arguments.end(), data.begin(), data.end());
    arguments.insert(arguments.end(), {"--model", "K s^a", "--component", "both"});
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_fracfit(arguments);
  }
};

// K = gain, told by the column: K0 = 1 and p = 1, as closely as the search ends.
TEST(JointFitCommand, AParameterFollowsALaw) {
  const PowerLaws data;
  const auto result = data.joint({data.one_file}, {"--by", "gain", "--shared", "a", "--law", "K = K0 gain^p"});
  ASSERT_EQ(result.code, 0) << result.error;
  const auto json = Json::parse(result.output);
  ASSERT_EQ(json["shared"].size(), 3U);
  EXPECT_EQ(json["shared"][1]["name"], "K0");
  EXPECT_NEAR(json["shared"][1]["value"].get<double>(), 1, 1e-7);
  EXPECT_EQ(json["shared"][2]["name"], "p");
  EXPECT_NEAR(json["shared"][2]["value"].get<double>(), 1, 1e-7);
  EXPECT_NEAR(json["curves"][2]["parameters"][0]["value"].get<double>(), 4, 1e-6);
  const auto table =
      data.joint({data.one_file}, {"--by", "gain", "--shared", "a", "--law", "K = K0 gain^p", "--format", "table"});
  EXPECT_NE(table.output.find("laws       K = K0 gain^p"), std::string::npos) << table.output;
  const auto unknown = data.joint({data.one_file}, {"--by", "gain", "--shared", "a", "--law", "K = K0 load^p"});
  EXPECT_EQ(unknown.code, 2);
  EXPECT_NE(unknown.error.find("known of the curves"), std::string::npos) << unknown.error;
}

// Of the parameters of a law, and of what the headers or the column know of a curve.
TEST(JointFitCommand, QuantitiesMayBeDerivedFromALaw) {
  const PowerLaws data;
  const auto result =
      data.joint({data.one_file}, {"--by", "gain", "--shared", "a", "--law", "K = K0 gain^p", "--derive",
                                   "x = K0 + 2 p", "--derive", "y = K/gain", "--derive", "z = gain a"});
  ASSERT_EQ(result.code, 0) << result.error;
  const auto json = Json::parse(result.output);
  for (std::size_t c = 0; c < 3; ++c) {
    const auto& derived = json["curves"][c]["derived"];
    // As closely as the search ends: K0 = 1, p = 1, a = 0.7, K = gain = 2, 3, 4.
    EXPECT_NEAR(derived[0]["value"].get<double>(), 3, 1e-6);
    EXPECT_NEAR(derived[1]["value"].get<double>(), 1, 1e-6);
    EXPECT_NEAR(derived[2]["value"].get<double>(), 0.7 * (2 + static_cast<double>(c)), 1e-6);
    // y = K0 gain^(p - 1): its error is that of K over the gain, and z's that of a times the gain.
    const auto& parameters = json["curves"][c]["parameters"];
    const double gain = 2 + static_cast<double>(c);
    EXPECT_NEAR(derived[1]["standard_error"].get<double>() * gain, parameters[0]["standard_error"].get<double>(),
                1e-6 * parameters[0]["standard_error"].get<double>());
    EXPECT_NEAR(derived[2]["standard_error"].get<double>(), gain * parameters[1]["standard_error"].get<double>(),
                1e-6 * gain * parameters[1]["standard_error"].get<double>());
  }
}

// The values that made the data, to what 17 digits and the tolerance of the search leave.
void expect_power_laws(const ProgramResult& result) {
  ASSERT_EQ(result.code, 0) << result.error;
  const auto json = Json::parse(result.output);
  EXPECT_EQ(json["model"], "K s^a");
  EXPECT_EQ(json["termination"], "converged");
  ASSERT_EQ(json["shared"].size(), 1U);
  EXPECT_EQ(json["shared"][0]["name"], "a");
  EXPECT_NEAR(json["shared"][0]["value"].get<double>(), 0.7, 1e-8);
  ASSERT_EQ(json["curves"].size(), 3U);
  for (std::size_t c = 0; c < 3; ++c) {
    EXPECT_EQ(json["curves"][c]["parameters"][0]["name"], "K");
    EXPECT_NEAR(json["curves"][c]["parameters"][0]["value"].get<double>(), 2 + static_cast<double>(c), 1e-7);
    EXPECT_EQ(json["curves"][c]["points"], 21);
  }
}

TEST(CliJointFit, FitsFilesAndTheCurvesOfOneFileAlike) {
  const PowerLaws data;
  expect_power_laws(data.joint(data.files, {"--shared", "a"}));
  expect_power_laws(data.joint(data.files, {"--each", "K"}));
  expect_power_laws(data.joint({data.one_file}, {"--by", "gain", "--each", "K"}));
}

TEST(CliJointFit, TableAndCsvNameSharedAndOwnParameters) {
  const PowerLaws data;
  const auto table = data.joint(data.files, {"--shared", "a", "--format", "table"});
  ASSERT_EQ(table.code, 0) << table.error;
  for (const char* part : {"shared", "gain3.csv", "alone", "converged"})
    EXPECT_NE(table.output.find(part), std::string::npos) << part << "\n" << table.output;
  const auto csv = data.joint(data.files, {"--shared", "a", "--format", "csv"});
  ASSERT_EQ(csv.code, 0) << csv.error;
  EXPECT_NE(csv.output.find("\ncurve,name,value,standard_error,ci95_lower,ci95_upper,identified,at_bound,shared,unit,"
                            "lower_limit,upper_limit\n"),
            std::string::npos)
      << csv.output;
}

// 1/(2 pi K) of each gain, in JSON and as a row of each curve.
TEST(CliJointFit, DerivesQuantitiesOfEachCurve) {
  const PowerLaws data;
  const auto result = data.joint(data.files, {"--shared", "a", "--derive", "g = 1/(2 pi K)"});
  ASSERT_EQ(result.code, 0) << result.error;
  const auto json = Json::parse(result.output);
  for (std::size_t c = 0; c < 3; ++c) {
    const double expected = 1 / (2 * std::numbers::pi * (2 + static_cast<double>(c)));
    EXPECT_EQ(json["curves"][c]["derived"][0]["name"], "g");
    EXPECT_NEAR(json["curves"][c]["derived"][0]["value"].get<double>(), expected, 1e-7);
  }
  const auto single =
      run_fracfit({"fit", data.files[0], "--model", "K s^a", "--component", "both", "--derive", "g=K^2"});
  ASSERT_EQ(single.code, 0) << single.error;
  const auto fit = Json::parse(single.output);
  ASSERT_EQ(fit["derived"].size(), 1U);
  EXPECT_NEAR(fit["derived"][0]["value"].get<double>(), 4, 1e-6);
  const auto named = run_fracfit({"fit", data.files[0], "--model", "K s^a", "--derive", "K = 2 K"});
  EXPECT_EQ(named.code, 2);
  EXPECT_NE(named.error.find("--derive 'K' is a parameter"), std::string::npos) << named.error;
  const auto wrong = run_fracfit({"fit", data.files[0], "--model", "K s^a", "--derive", "g=M"});
  EXPECT_EQ(wrong.code, 2);
  EXPECT_NE(wrong.error.find("--derive"), std::string::npos) << wrong.error;
}

// A tenth of an outlier among 21 points moves a plain fit of exact power laws, and a robust one not at all.
TEST(CliJointFit, ARobustLossLeavesAnOutlierWhereItIs) {
  const PowerLaws data;
  std::string text = content_of(data.folder.path("gain3.csv"));
  const auto line = text.find("\n", text.size() / 2) + 1, comma = text.find(',', line);
  text.insert(comma + 1, "1");  // a digit in front of the real part
  static_cast<void>(data.folder.write("gain3.csv", text));
  const auto value = [&](const std::vector<std::string>& more) {
    std::vector<std::string> options{"--shared", "a"};
    options.insert(options.end(), more.begin(), more.end());
    const auto result = data.joint(data.files, options);
    EXPECT_EQ(result.code, 0) << result.error;
    return Json::parse(result.output)["curves"][1]["parameters"][0]["value"].get<double>();
  };
  EXPECT_GT(std::abs(value({}) - 3), 1e-3);
  EXPECT_NEAR(value({"--loss", "cauchy"}), 3, 1e-6);
}

TEST(CliJointFit, PriorsAndOrdersAreTakenAndSaid) {
  const PowerLaws data;
  const auto result = data.joint(data.files, {"--shared", "a", "--prior", "a=0.7+-0.01", "--prior", "K = 3 +- 50%"});
  ASSERT_EQ(result.code, 0) << result.error;
  const auto json = Json::parse(result.output);
  EXPECT_EQ(json["options"]["priors"], "a=0.7+-0.01; K = 3 +- 50%");
  ASSERT_EQ(json["priors"].size(), 4U);
  EXPECT_EQ(json["priors"][0]["name"], "a");
  EXPECT_EQ(json["priors"][1]["relative"], true);
  EXPECT_EQ(json["priors"][3]["curve"], data.files[2]);
  // ln(4/3)/0.5: the curve alone decides, as it is exact.
  EXPECT_NEAR(json["priors"][3]["distance"].get<double>(), std::log(4.0 / 3) / 0.5, 1e-6);
  // Exact data tell everything: three gains and one order.
  EXPECT_NEAR(json["effective_parameters"].get<double>(), 4, 1e-6);
  const auto table = data.joint(data.files, {"--shared", "a", "--prior", "a=0.7+-0.01", "--format", "table"});
  for (const char* part : {"a = 0.7 +- 0.01", "data off by", "priors"})
    EXPECT_NE(table.output.find(part), std::string::npos) << table.output;

  const auto single = run_fracfit({"fit", data.files[0], "--model", "K1 s^a1 + K2 s", "--component", "both", "--bound",
                                   "a1=:1", "--prior", "K1=2+-0.2", "--constraint", "K2<K1"});
  ASSERT_EQ(single.code, 0) << single.error;
  const auto fit = Json::parse(single.output);
  EXPECT_EQ(fit["options"]["constraints"], "K2<K1");
  ASSERT_EQ(fit["priors"].size(), 1U);
  EXPECT_LE(fit["effective_parameters"].get<double>(), 3);
  for (const char* wrong : {"--bootstrap", "--grow"}) {
    std::vector<std::string> arguments{"fit", data.files[0], "--prior", "K=2+-1", "--component", "both"};
    if (std::string(wrong) == "--grow")
      arguments.insert(arguments.end(), {"--grow", "powers"});
    else
      arguments.insert(arguments.end(), {"--model", "K s^a", "--bootstrap", "20"});
    const auto refused = run_fracfit(arguments);
    EXPECT_EQ(refused.code, 2) << wrong;
    EXPECT_NE(refused.error.find("--prior"), std::string::npos) << refused.error;
  }
}

// A lag seen through windows of a decade and a half that move by a factor of four: the factors come back, every point
// is in the table of the master curve, and lies on it.
TEST(CliJointFit, ShiftsCurvesOntoAMasterCurve) {
  const TemporaryFolder folder;
  std::vector<std::string> arguments{"joint-fit"};
  for (int c = 0; c < 4; ++c) {
    std::ostringstream text;
    text.precision(17);
    text << "# step: " << c << "\nomega_rad_s,re,im\n";
    for (int i = 0; i <= 15; ++i) {
      const double omega = std::pow(10.0, i / 10.0);
      const std::complex<double> s(0, 0.01 * std::pow(4.0, c) * omega);
      const std::complex<double> value = 5.0 / (1.0 + std::pow(s, 0.8));
      text << omega << ',' << value.real() << ',' << value.imag() << '\n';
    }
    arguments.push_back(folder.write("at" + std::to_string(c) + ".csv", text.str()));
  }
  const std::string master = folder.path("master.csv"), picture = folder.path("master.svg");
  const std::string reference = arguments[2];
  arguments.insert(arguments.end(), {"--model", "K/(1 + (T s)^a)", "--component", "both", "--shift", "horizontal",
                                     "--reference", reference, "--master", master});
  const auto result = run_fracfit(arguments);
  ASSERT_EQ(result.code, 0) << result.error;
  const auto json = Json::parse(result.output);
  EXPECT_EQ(json["model"], "K/(1 + (T (aT s))^a)");
  for (int c = 0; c < 4; ++c) {
    for (const auto& parameter : json["curves"][static_cast<std::size_t>(c)]["parameters"])
      if (parameter["name"] == "aT") {
        EXPECT_NEAR(parameter["value"].get<double>() * std::pow(4.0, 1 - c), 1, 1e-5);
      }
  }
  std::istringstream rows(content_of(master));
  int count = 0;
  double last = 0;
  for (std::string row; std::getline(rows, row);) {
    if (row.empty() || row.front() == '#' || row.front() == 'o') continue;
    std::vector<std::string> cells;
    std::istringstream text(row);
    for (std::string cell; std::getline(text, cell, ',');) cells.push_back(cell);
    ASSERT_EQ(cells.size(), 7U) << row;
    const double omega = std::stod(cells[0]);
    EXPECT_GE(omega, last);
    last = omega;
    const std::complex<double> value = 5.0 / (1.0 + std::pow(std::complex<double>(0, 0.04 * omega), 0.8));
    EXPECT_NEAR(std::stod(cells[1]), value.real(), 1e-4);
    EXPECT_NEAR(std::stod(cells[6]), value.imag(), 1e-4);
    ++count;
  }
  EXPECT_EQ(count, 64);
  EXPECT_EQ(json["options"]["reference"], reference);
  // A law says by itself which curve is not moved.
  auto by_law = std::vector<std::string>(arguments.begin(), arguments.begin() + 5);
  by_law.insert(by_law.end(), {"--model", "K/(1 + (T s)^a)", "--component", "both", "--shift", "horizontal", "--law",
                               "aT = exp(k (step - 1))", "--format", "json"});
  const auto lawful = run_fracfit(by_law);
  ASSERT_EQ(lawful.code, 0) << lawful.error;
  EXPECT_FALSE(Json::parse(lawful.output)["options"].contains("reference")) << lawful.output;
}

// The head and the master curve name frequencies in the unit of the files; parameters have their units, by hand: of
// K/(1 + (T s)^a) the value's, s and none.
TEST(CliJointFit, SpeaksInTheUnitsOfItsFiles) {
  const TemporaryFolder folder;
  std::vector<std::string> arguments{"joint-fit"};
  for (int c = 0; c < 3; ++c) {
    std::ostringstream text;
    text.precision(17);
    text << "f_Hz,re_m_per_n,im_m_per_n\n";
    for (int i = 0; i <= 15; ++i) {
      const double f = std::pow(10.0, i / 10.0);
      const std::complex<double> s(0, 0.01 * std::pow(4.0, c) * 2 * std::numbers::pi * f);
      const std::complex<double> value = 5.0 / (1.0 + std::pow(s, 0.8));
      text << f << ',' << value.real() << ',' << value.imag() << '\n';
    }
    arguments.push_back(folder.write("at" + std::to_string(c) + ".csv", text.str()));
  }
  const std::string master = folder.path("master.csv");
  arguments.insert(arguments.end(), {"--model", "K/(1 + (T s)^a)", "--component", "both", "--shift", "horizontal",
                                     "--master", master, "--format", "table"});
  const auto table = run_fracfit(arguments);
  ASSERT_EQ(table.code, 0) << table.error;
  EXPECT_NE(table.output.find("curves     3, 1 .. 31.6228 Hz, values in m/N\n"), std::string::npos) << table.output;
  std::istringstream rows(content_of(master));
  int count = 0;
  for (std::string row; std::getline(rows, row);) {
    if (row.starts_with("omega")) {
      EXPECT_TRUE(row.ends_with(",f_hz")) << row;
    }
    if (row.empty() || row.front() == '#' || row.front() == 'o') continue;
    EXPECT_NEAR(std::stod(row.substr(row.rfind(',') + 1)) * 2 * std::numbers::pi / std::stod(row), 1, 1e-12);
    ++count;
  }
  EXPECT_EQ(count, 48);
  arguments.back() = "json";
  const auto json = Json::parse(run_fracfit(arguments).output);
  EXPECT_EQ(json["value_unit"], "m_per_n");
  EXPECT_EQ(json["shared"][0]["unit"], "m/N");
  EXPECT_EQ(json["shared"][1]["unit"], "s");
  EXPECT_EQ(json["shared"][2]["unit"], "1");
}

// A law of known quantities alone leaves nothing of it to be fitted.
TEST(CliJointFit, ALawMayHoldNoParameter) {
  const PowerLaws data;
  const auto result = data.joint({data.one_file}, {"--by", "gain", "--shared", "a", "--law", "K = gain"});
  ASSERT_EQ(result.code, 0) << result.error;
  const auto json = Json::parse(result.output);
  ASSERT_EQ(json["shared"].size(), 1U);
  EXPECT_NEAR(json["shared"][0]["value"].get<double>(), 0.7, 1e-7);
}

TEST(CliJointFit, WrongUsageIsNamed) {
  const PowerLaws data;
  const auto expect = [&](const std::vector<std::string>& more, const std::string& part) {
    const auto result = data.joint(data.files, more);
    EXPECT_EQ(result.code, 2) << result.error;
    EXPECT_NE(result.error.find(part), std::string::npos) << result.error;
  };
  expect({}, "--shared");
  expect({"--shared", "a", "--each", "K"}, "--each");
  expect({"--shared", "b"}, "b");
  expect({"--each", "K,a"}, "batch");
  expect({"--shared", "a", "--fix", "a=0.7"}, "fixed");
  expect({"--shared", "a", "--prior", "K=2"}, "--prior 'K=2'");
  expect({"--shared", "a", "--prior", "K=2+-0"}, "positive");
  expect({"--shared", "a", "--prior", "K=2+-1", "--fix", "K=2"}, "is fixed");
  expect({"--shared", "a", "--constraint", "K"}, "--constraint 'K'");
  expect({"--shared", "a", "--constraint", "a<K"}, "another kind");
  expect({"--shared", "a", "--master", "m.csv"}, "--master");
  expect({"--shift", "horizontal", "--reference", "none"}, "--reference 'none'");
  EXPECT_EQ(data.joint({data.folder.path("none.csv")}, {"--shared", "a"}).code, 3);
}

/// A spectrum of K/(T s + 1) with K = 3, T = 0.5, and a record of its step response with K = 2 beside an offset of 1.
struct SpectrumAndRecord {
  TemporaryFolder folder;
  std::string spectrum, record, other_spectrum, other_record;
  SpectrumAndRecord() {
    std::ostringstream response, samples;
    response.precision(17);
    samples.precision(17);
    response << "omega_rad_s,re,im\n";
    samples << "time_s,input,output\n";
    for (int i = 0; i <= 20; ++i) {
      const double omega = std::pow(10.0, -1 + i / 10.0);
      const std::complex<double> value = 3.0 / std::complex<double>(1, 0.5 * omega);
      response << omega << ',' << value.real() << ',' << value.imag() << '\n';
    }
    for (int i = 0; i <= 40; ++i) samples << 0.1 * i << ",1," << 1 + 2 * (1 - std::exp(-0.1 * i / 0.5)) << '\n';
    spectrum = folder.write("spectrum.csv", response.str());
    record = folder.write("record.csv", samples.str());
    other_spectrum = folder.write("other_spectrum.csv", response.str());
    other_record = folder.write("other_record.csv", samples.str());
  }
};

TEST(JointFitCommand, FitsARecordTogetherWithASpectrum) {
  const SpectrumAndRecord data;
  const std::vector<std::string> model{"--model", "K/(T s + 1)", "--each", "K"};
  const auto joint = [&](std::vector<std::string> arguments, const std::vector<std::string>& more = {}) {
    arguments.insert(arguments.begin(), "joint-fit");
    arguments.insert(arguments.end(), model.begin(), model.end());
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_fracfit(arguments);
  };
  const auto result = joint({data.record, data.spectrum});
  ASSERT_EQ(result.code, 0) << result.error;
  const auto json = Json::parse(result.output);
  EXPECT_NEAR(json["shared"][0]["value"].get<double>(), 0.5, 1e-7);
  ASSERT_EQ(json["curves"].size(), 2U);
  EXPECT_EQ(json["curves"][0]["name"], data.record);
  EXPECT_EQ(json["curves"][0]["points"], 41);
  EXPECT_NEAR(json["curves"][0]["parameters"][0]["value"].get<double>(), 2, 1e-7);
  EXPECT_NEAR(json["curves"][1]["parameters"][0]["value"].get<double>(), 3, 1e-7);
  EXPECT_EQ(json["options"]["offset"], "free");

  const auto table = joint({data.record, data.spectrum}, {"--format", "table"});
  EXPECT_NE(table.output.find("1, 0.1 .. 10 rad/s; 1 over time, up to 4 s"), std::string::npos) << table.output;

  // Options of one kind of data alone are refused where all are of the other.
  const auto records = joint({data.record, data.other_record}, {"--component", "both"});
  EXPECT_EQ(records.code, 2);
  EXPECT_NE(records.error.find("--component"), std::string::npos) << records.error;
  const auto responses = joint({data.spectrum, data.other_spectrum}, {"--trend"});
  EXPECT_EQ(responses.code, 2);
  EXPECT_NE(responses.error.find("--trend"), std::string::npos) << responses.error;
  const auto shifted =
      run_fracfit({"joint-fit", data.record, data.spectrum, "--model", "K/(T s + 1)", "--shift", "horizontal"});
  EXPECT_EQ(shifted.code, 2);
  EXPECT_NE(shifted.error.find("over time"), std::string::npos) << shifted.error;
}

}  // namespace
