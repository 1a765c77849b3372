// SPDX-License-Identifier: BSD-3-Clause
#include "io/frequency_response_file.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <complex>
#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

#include "io/number.hpp"
#include "temporary_folder.hpp"

namespace {

constexpr double turn = 2 * std::numbers::pi;

class FrequencyResponseFileTest : public ::testing::Test {
 protected:
  [[nodiscard]] io::FrequencyResponseFile read(const std::string& content,
                                               const io::FrequencyResponseReadOptions& options = {}) {
    return io::read_frequency_response(folder.write("data.csv", content), options);
  }

  /// Reads what must fail, and compares place and part of the message.
  void expect_error(const std::string& content, std::size_t line, std::size_t column, const std::string& part,
                    const io::FrequencyResponseReadOptions& options = {}) {
    SCOPED_TRACE(content.substr(0, 200));
    try {
      (void)read(content, options);
      FAIL() << "no error";
    } catch (const io::DataError& error) {
      const std::string message = error.what();
      EXPECT_EQ(error.line(), line) << message;
      EXPECT_EQ(error.column(), column) << message;
      EXPECT_NE(message.find(part), std::string::npos) << message;
      std::string place = folder.path("data.csv");
      if (line > 0) place += ":" + std::to_string(line);
      if (column > 0) place += ":" + std::to_string(column);
      EXPECT_EQ(message.substr(0, place.size() + 2), place + ": ");
    }
  }

  static bool has_note(const io::FrequencyResponseFile& file, const std::string& part) {
    for (const auto& note : file.notes)
      if (note.find(part) != std::string::npos) return true;
    return false;
  }

  TemporaryFolder folder;
};

using namespace std::complex_literals;

TEST_F(FrequencyResponseFileTest, ReadsCommaSeparatedValues) {
  const auto file = read("omega_rad_s,re,im\n1,0.5,-0.25\n2,1e-3,+4\n");
  EXPECT_EQ(file.data.omega(), (std::vector<double>{1, 2}));
  EXPECT_EQ(file.data.value(), (std::vector<std::complex<double>>{{0.5, -0.25}, {1e-3, 4}}));
  EXPECT_TRUE(file.data.sigma().empty());
  EXPECT_TRUE(file.notes.empty());
  EXPECT_EQ(file.value_unit, "");
}

TEST_F(FrequencyResponseFileTest, OtherSeparatorsGiveTheSame) {
  const auto expected = read("omega_rad_s,re,im\n1,2,3\n4,5,6\n");
  for (const char* content :
       {"omega_rad_s;re;im\n1;2;3\n4;5;6\n", "omega_rad_s\tre\tim\n1\t2\t3\n4\t5\t6\n",
        "omega_rad_s re im\n1 2 3\n4 5 6\n", "  omega_rad_s   re   im\n  1   2  3 \n4 5 6",
        "omega_rad_s , re , im\n 1 , 2 , 3\n4, 5, 6\n", "\"omega_rad_s\",\"re\",\"im\"\n1,2,3\n\"4\",5,6\n",
        "omega_rad_s,re,im\n1;2;3\n4;5;6\n"}) {
    const auto file = read(content);
    EXPECT_EQ(file.data.omega(), expected.data.omega()) << content;
    EXPECT_EQ(file.data.value(), expected.data.value()) << content;
  }
}

TEST_F(FrequencyResponseFileTest, ByteOrderMarkAndLineEndsMakeNoDifference) {
  for (const char* content :
       {"\xEF\xBB\xBFomega_rad_s,re,im\n1,2,3\n4,5,6\n", "omega_rad_s,re,im\r\n1,2,3\r\n4,5,6\r\n",
        "\xEF\xBB\xBF# a: b\r\nomega_rad_s,re,im\r\n\r\n1,2,3\r\n4,5,6", "omega_rad_s,re,im\r1,2,3\r4,5,6\r"}) {
    const auto file = read(content);
    EXPECT_EQ(file.data.omega(), (std::vector<double>{1, 4})) << content;
    EXPECT_EQ(file.data.value(), (std::vector<std::complex<double>>{{2, 3}, {5, 6}})) << content;
    EXPECT_TRUE(file.notes.empty()) << content;
  }
}

TEST_F(FrequencyResponseFileTest, CommentsAreKeptAsKeyAndValue) {
  const auto file = read(
      "# force_n: 40\n# free text, no key\n#clearance_m: 0.3\n# see http://x.org/a\nf_Hz,re,im\n# in: side\n1,2,3\n");
  EXPECT_EQ(file.metadata, (io::Metadata{{"force_n", "40"}, {"clearance_m", "0.3"}}));
  EXPECT_EQ(io::find_value(file.metadata, "clearance_m"), "0.3");
  EXPECT_EQ(io::find_value(file.metadata, "mass"), std::nullopt);
}

TEST_F(FrequencyResponseFileTest, TheHeaderMayBeACommentDirectlyAboveTheData) {
  for (const char* content :
       {"# measured, ohm\n# f_Hz,re,im\n1,2,3\n", "#f_Hz re im\n1 2 3\n", "# f_Hz, re, im\n1 2 3\n"}) {
    const auto file = read(content);
    EXPECT_EQ(file.data.omega(), (std::vector<double>{turn})) << content;
    EXPECT_EQ(file.data.value(), (std::vector<std::complex<double>>{{2, 3}})) << content;
  }
}

TEST_F(FrequencyResponseFileTest, FrequencyNamesAndUnits) {
  const std::pair<const char*, double> names[] = {{"omega_rad_s", 1},
                                                  {"w_rad_s", 1},
                                                  {"OMEGA[rad/s]", 1},
                                                  {"omega (rad/s)", 1},
                                                  {"omega_rad_per_s", 1},
                                                  {"w [rad s^-1]", 1},
                                                  {"omega", 1},
                                                  {"angular frequency [krad/s]", 1e3},
                                                  {"freq_rad_s", 1},
                                                  {"f_Hz", turn},
                                                  {"F_HZ", turn},
                                                  {"frequency_hz", turn},
                                                  {"Frequency (Hz)", turn},
                                                  {"freq [kHz]", 1e3 * turn},
                                                  {"f_MHz", 1e6 * turn},
                                                  {"f_mHz", 1e-3 * turn},
                                                  {"f / Hz", turn},
                                                  {"freq[GHz]", 1e9 * turn}};
  for (const auto& [name, factor] : names) {
    const auto file = read(std::string(name) + ",re,im\n2,1,1\n");
    // One multiplication by a factor rounded once or twice.
    EXPECT_NEAR(file.data.omega().front() / (2 * factor), 1, 4e-16) << name;
  }
  EXPECT_TRUE(has_note(read("w,re,im\n1,2,3\n"), "taken as rad/s"));
}

TEST_F(FrequencyResponseFileTest, SweepsSideBySideAreTakenByName) {
  const std::string rows = "f_Hz,re_cold,im_cold,re_hot,im_hot\n1,2,3,4,5\n2,3,4,5,6\n";
  try {
    (void)read(rows);
    FAIL() << "no error";
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find("holds 2 sweeps (cold, hot); take one by --select"), std::string::npos)
        << error.what();
  }
  io::FrequencyResponseReadOptions options;
  options.how.select = "hot";
  EXPECT_EQ(read(rows, options).data.value().front(), (std::complex<double>{4, 5}));
  expect_error("f_Hz,re,im,re_fit,im_fit\n1,2,3,4,5\n", 1, 12, "--columns");
}

TEST_F(FrequencyResponseFileTest, CopiesOfRowsAreNoRepeatedMeasurements) {
  const auto joined = read("f_Hz,re,im\n1,2,3\n2,3,4\n1,2,3\n2,3,4\n");
  EXPECT_EQ(joined.data.omega(), (std::vector<double>{turn, 2 * turn}));
  EXPECT_EQ(joined.data.value(), (std::vector<std::complex<double>>{{2, 3}, {3, 4}}));
  EXPECT_TRUE(has_note(joined, "2 rows are copies of others"));
  EXPECT_EQ(read("f_Hz,re,im\n1,2,3\n2,3,4\n1,2,3\n2,3,5\n").data.size(), 4u);
  EXPECT_EQ(read("f_Hz,re,im,sigma\n1,2,3,1\n1,2,3,2\n").data.size(), 2u);
}

TEST_F(FrequencyResponseFileTest, UnitsOfValuesAreKeptAndMustAgree) {
  EXPECT_EQ(read("f_Hz,re_m_per_n,im_m_per_n\n1,2,3\n").value_unit, "m_per_n");
  EXPECT_EQ(read("f_Hz,Re [ohm],Im [ohm]\n1,2,3\n").value_unit, "ohm");
  EXPECT_EQ(read("f_Hz,magnitude[m/N],phase_deg\n1,2,3\n").value_unit, "m/N");
  expect_error("f_Hz,re_ohm,im_mohm\n1,2,3\n", 1, 13, "differs from 'ohm'");
}

TEST_F(FrequencyResponseFileTest, NegatedImaginaryPartsOfImpedanceFiles) {
  EXPECT_EQ(read("f_Hz,re_ohm,-im_ohm\n1,2,3\n").data.value().front(), (std::complex<double>{2, -3}));
}

TEST_F(FrequencyResponseFileTest, MagnitudeAndPhase) {
  // polar(2, 90 deg): the rounding of pi/2 leaves 2 * 6e-17 in the real part.
  const auto value = read("f_Hz,magnitude,phase_deg\n1,2,90\n").data.value().front();
  EXPECT_NEAR(std::abs(value - 2i), 0, 1e-15);
  EXPECT_NEAR(std::abs(read("f_Hz,mag_dB,phase_rad\n1,20,0\n").data.value().front() - 10.0), 0, 1e-14);
  EXPECT_NEAR(std::abs(read("f_Hz,gain[dB],phase[deg]\n1,-6.020599913279624,-180\n").data.value().front() + 0.5), 0,
              1e-15);
}

TEST_F(FrequencyResponseFileTest, DecibelsAreNoUnitOfTheValuesTheyBecome) {
  for (const char* name : {"magnitude_db", "gain[dB]", "mag (dB)"})
    EXPECT_EQ(read("f_Hz," + std::string(name) + ",phase_deg\n1,0,0\n").value_unit, "") << name;
  // 40 dB re 1 m/N are 100 m/N.
  for (const char* name : {"gain (dB re 1 m/N)", "magnitude [dB re m/N]", "mag [dB rel 1m/N]"}) {
    const auto file = read("f_Hz," + std::string(name) + ",phase_deg\n1,40,0\n");
    EXPECT_EQ(file.value_unit, "m/N") << name;
    EXPECT_NEAR(std::abs(file.data.value().front() - 100.0), 0, 1e-12) << name;
  }
  EXPECT_EQ(read("f_Hz,gain (dB re 1),phase_deg\n1,40,0\n").value_unit, "");
  expect_error("f_Hz,gain (dB re 20 uPa),phase_deg\n1,40,0\n", 1, 6, "relative to '20 uPa'");
}

TEST_F(FrequencyResponseFileTest, RealAndImaginaryPartsGoBeforeMagnitudeAndPhase) {
  const auto file = read("f_Hz,magnitude_db,phase_deg,re,im,remark\n1,0,0,2,3,good\n");
  EXPECT_EQ(file.data.value().front(), (std::complex<double>{2, 3}));
  EXPECT_TRUE(has_note(file, "columns not used: magnitude_db, phase_deg, remark"));
}

TEST_F(FrequencyResponseFileTest, UnsortedRowsAreSortedAndSaidSo) {
  const auto file = read("f_Hz,re,im,sigma\n3,1,1,0.1\n1,2,2,0.2\n3,3,3,0.3\n2,4,4,0.4\n");
  EXPECT_EQ(file.data.value(), (std::vector<std::complex<double>>{{2, 2}, {4, 4}, {1, 1}, {3, 3}}));
  EXPECT_EQ(file.data.sigma(), (std::vector<double>{0.2, 0.4, 0.1, 0.3}));
  EXPECT_TRUE(has_note(file, "sorted"));
  EXPECT_FALSE(has_note(read("f_Hz,re,im\n1,1,1\n1,2,2\n2,3,3\n"), "sorted"));
}

TEST_F(FrequencyResponseFileTest, SigmaAndWeightColumns) {
  EXPECT_EQ(read("f_Hz,re,im,sigma\n1,2,3,0.5\n").data.sigma(), (std::vector<double>{0.5}));
  EXPECT_EQ(read("f_Hz,re,im,weight\n1,2,3,4\n").data.sigma(), (std::vector<double>{0.5}));
  io::FrequencyResponseReadOptions options;
  options.weight_column = "uncertainty_m";
  EXPECT_EQ(read("f_Hz,re_m,im_m,uncertainty_m\n1,2,3,0.5\n", options).data.sigma(), (std::vector<double>{0.5}));
  options.weight_column = "trust";
  const auto file = read("f_Hz,re,im,trust\n1,2,3,4\n", options);
  EXPECT_EQ(file.data.sigma(), (std::vector<double>{0.5}));
  EXPECT_TRUE(has_note(file, "weight of the squared residuals"));
  options.weight_column = "absent";
  EXPECT_THROW((void)read("f_Hz,re,im\n1,2,3\n", options), std::invalid_argument);
  expect_error("f_Hz,re,im,sigma\n1,2,3,0\n", 2, 7, "standard deviation must be > 0");
  expect_error("f_Hz,re,im,weight\n1,2,3,-1\n", 2, 7, "weight must be > 0");
  expect_error("f_Hz,re_ohm,im_ohm,sigma_mohm\n1,2,3,1\n", 1, 20, "differs from 'ohm'");
}

TEST_F(FrequencyResponseFileTest, ConditionsChoosePoints) {
  io::FrequencyResponseReadOptions options;
  options.where = {io::PointFilter("im<0"), io::PointFilter("omega<10")};
  const auto file = read("omega_rad_s,re,im\n1,1,-1\n2,1,1\n20,1,-1\n", options);
  EXPECT_EQ(file.data.omega(), (std::vector<double>{1}));
  EXPECT_TRUE(has_note(file, "1 of 3 points"));
  expect_error("omega_rad_s,re,im\n1,1,1\n", 0, 0, "none of the 1 points satisfies im<0 and omega<10", options);
}

TEST_F(FrequencyResponseFileTest, OneRowIsAccepted) {
  EXPECT_EQ(read("f_Hz,re,im\n1,2,3\n").data.size(), 1U);
}

TEST_F(FrequencyResponseFileTest, FilesThatCannotBeRead) {
  const auto message = [](const std::string& path) -> std::string {
    try {
      (void)io::read_frequency_response(path);
    } catch (const io::DataError& error) {
      return error.what();
    }
    return "no error";
  };
  EXPECT_EQ(message(folder.path("absent.csv")),
            folder.path("absent.csv") + ": cannot be read: No such file or directory");
  EXPECT_NE(message(folder.path()).find("is a folder"), std::string::npos);
}

TEST_F(FrequencyResponseFileTest, FilesWithoutDataSayWhatIsMissing) {
  expect_error("", 0, 0, "is empty");
  expect_error("\n\n", 0, 0, "holds no rows");
  expect_error("# only: comments\n", 0, 0, "holds no rows");
  expect_error("\xEF\xBB\xBF", 0, 0, "is empty");
  expect_error("# a: b\nf_Hz,re,im\n", 2, 0, "no data rows");
  expect_error("f_Hz,re,im\n# comment\n\n", 1, 0, "no data rows");
  expect_error("1,2,3\n", 1, 1, "no header row");
  expect_error("# some remark\n1,2,3\n", 2, 1, "no header row");
}

TEST_F(FrequencyResponseFileTest, MissingAndDoubtfulColumns) {
  expect_error("a,re,im\n1,2,3\n", 1, 1, "no frequency column among the columns a, re, im");
  expect_error("f_Hz,re\n1,2\n", 1, 1, "no imaginary part");
  expect_error("f_Hz,im\n1,2\n", 1, 1, "no real part");
  expect_error("f_Hz,magnitude\n1,2\n", 1, 1, "no phase");
  expect_error("f_Hz,phase_deg\n1,2\n", 1, 1, "no magnitude");
  expect_error("f_Hz,x,y\n1,2,3\n", 1, 1, "no values");
  expect_error("f_Hz,re,im,real\n1,2,3,4\n", 1, 12, "means the same as column 're'");
  expect_error("# x\n# f_Hz,im,re,im_ohm\n1,2,3,4\n", 2, 14, "means the same");
}

TEST_F(FrequencyResponseFileTest, UnknownUnitsAreNeverGuessed) {
  expect_error("re,im,f_rpm\n1,2,3\n", 1, 7, "unknown unit 'rpm'");
  expect_error("omega_Hz,re,im\n1,2,3\n", 1, 1, "unknown unit 'Hz' of an angular frequency");
  expect_error("f_mhz,re,im\n1,2,3\n", 1, 1, "milli or mega");
  expect_error("f_Hz,magnitude,phase\n1,2,3\n", 1, 16, "phase has no unit");
  expect_error("f_Hz,magnitude,phase[grad]\n1,2,3\n", 1, 16, "unknown unit 'grad'");
  // A second frequency column of unknown unit does no harm.
  EXPECT_EQ(read("f_rpm,omega_rad_s,re,im\n1,2,3,4\n").data.omega().front(), 2);
}

TEST_F(FrequencyResponseFileTest, BadFieldsAreNamedWithLineAndColumn) {
  expect_error("f_Hz,re,im\n1,2,3\n2,abc,4\n", 3, 3, "found 'abc' in column 're'; expected a number");
  expect_error("f_Hz,re,im\n1,2,3\n\n# remark\n2,5,4x\n", 5, 5, "found '4x'");
  expect_error("f_Hz,re,im\r\n1,nan,3\r\n", 2, 3, "found 'nan' in column 're'; expected a finite number");
  expect_error("f_Hz,re,im\n1,2,inf\n", 2, 5, "finite");
  expect_error("f_Hz,re,im\n1,2,1e999\n", 2, 5, "finite");
  expect_error("f_Hz,re,im\nnan,2,3\n", 2, 1, "finite");
  expect_error("f_Hz,re,im\n1,,3\n", 2, 3, "field is empty");
  expect_error("f_Hz,re,im\n0,2,3\n", 0, 0, "no point at a frequency above 0");
  expect_error("f_Hz,re,im\n1,2,3\n-1,2,3\n", 3, 1, "must be > 0");
  expect_error("f_Hz,magnitude,phase_deg\n1,-2,3\n", 2, 3, "magnitude must be >= 0");
  expect_error("f_Hz,magnitude_db,phase_deg\n1,1e5,3\n", 2, 3, "beyond the range");
  // Columns count characters, not bytes: the remark holds two of two bytes each.
  expect_error("remark,f_Hz,re,im\n\xC3\xA4\xC3\xB6,1,x,3\n", 2, 6, "found 'x'");
  expect_error("  # f_Hz,re,im\n   1 ,  zz , 3\n", 2, 9, "found 'zz'");
}

TEST_F(FrequencyResponseFileTest, RowsOfAnotherLengthAreRefused) {
  expect_error("f_Hz,re,im\n1,2,3\n1,2\n", 3, 4, "found 2 fields in '1,2'; expected 3 as in the header of line 1");
  expect_error("f_Hz,re,im\n1,2,3,4\n", 2, 7, "found 4 fields");
  expect_error("f_Hz,re,im\n1,2,3,\n", 2, 7, "found 4 fields");
  expect_error("f_Hz,re,im\n1,2,3\nthe end\n2,3,4\n", 3, 8, "found 1 field in 'the end'");
}

TEST_F(FrequencyResponseFileTest, BinaryRubbishIsAnError) {
  std::string content = "f_Hz,re,im\n1,2,";
  content += '\0';
  content += "\x01\xff\n";
  expect_error(content, 2, 5, "expected a number");
}

TEST_F(FrequencyResponseFileTest, AMillionRowsAreReadQuickly) {
  std::string content = "f_Hz,re,im\n";
  constexpr int rows = 1'000'000;
  for (int i = 1; i <= rows; ++i) {
    io::append_number(content, 1e-3 * i);
    content += ",0.12345678901234567,-";
    io::append_number(content, 1.0 / i);
    content += '\n';
  }
  const auto path = folder.write("data.csv", content);
  const auto begin = std::chrono::steady_clock::now();
  const auto file = io::read_frequency_response(path);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  RecordProperty("seconds", std::to_string(seconds));
  ASSERT_EQ(file.data.size(), static_cast<std::size_t>(rows));
  EXPECT_EQ(file.data.value().back().imag(), -1.0 / rows);
  // Under a second on an idle machine; the allowance is for loaded ones and sanitizers.
  EXPECT_LT(seconds, 10);
}

TEST_F(FrequencyResponseFileTest, MagnitudeOrPhaseAloneIsReadOnlyWhereTheOtherMayMiss) {
  const std::string magnitude = "f_Hz,magnitude_db\n1,20\n2,-20\n";
  expect_error(magnitude, 1, 1, "--component magnitude");
  io::FrequencyResponseReadOptions options;
  options.phase_may_miss = true;
  const auto sizes = read(magnitude, options);
  EXPECT_NEAR(sizes.data.value()[0].real(), 10, 1e-14);
  EXPECT_NEAR(sizes.data.value()[1].real(), 0.1, 1e-16);
  EXPECT_EQ(sizes.data.value()[0].imag(), 0);
  // Who asks for the magnitude alone need not be told that nothing else is there.
  EXPECT_TRUE(sizes.notes.empty());

  const std::string phase = "f_Hz,phase_deg,sigma\n1,-90,2\n2,180,1\n";
  expect_error(phase, 1, 1, "--component phase");
  options = {};
  options.magnitude_may_miss = true;
  const auto angles = read(phase, options);
  EXPECT_NEAR(std::abs(angles.data.value()[0] - std::complex<double>(0, -1)), 0, 1e-15);
  EXPECT_NEAR(angles.data.sigma()[0], 2 * std::numbers::pi / 180, 1e-17);
  EXPECT_TRUE(angles.notes.empty());
}

TEST_F(FrequencyResponseFileTest, AnImaginaryPartAloneIsReadOnlyWhereTheRealOneMayMiss) {
  const std::string alone = "omega_rad_s,-im_ohm,sigma_ohm\n1,2,0.1\n2,-3,0.2\n";
  expect_error(alone, 1, 1, "no real part");
  io::FrequencyResponseReadOptions options;
  options.real_may_miss = true;
  const auto file = read(alone, options);
  EXPECT_EQ(file.data.value(), (std::vector<std::complex<double>>{-2i, 3i}));
  EXPECT_EQ(file.data.sigma(), (std::vector<double>{0.1, 0.2}));
  EXPECT_EQ(file.value_unit, "ohm");
  EXPECT_TRUE(file.real_is_missing);
  EXPECT_TRUE(has_note(file, "no column holds a real part"));
  expect_error("omega_rad_s,im_ohm,sigma_s\n1,2,0.1\n", 1, 20, "differs from 'ohm'", options);
  // Several curves in columns.
  options.curve = "b";
  EXPECT_EQ(read("omega_rad_s,im_a,im_b\n1,2,3\n", options).data.value(), (std::vector<std::complex<double>>{3i}));
  options.curve.clear();
  // -1/N takes both parts of N.
  options.quantity = backlash::Quantity::minus_inverse;
  expect_error("omega_rad_s,im_m_per_n\n1,2\n", 0, 0, "holds no real part, without which -1/N is not known from N",
               options);
  options.quantity.reset();
  // What is there is read.
  const auto both = read("omega_rad_s,im,re\n1,2,3\n", options);
  EXPECT_EQ(both.data.value().front(), 3.0 + 2i);
  EXPECT_FALSE(both.real_is_missing);
  const auto polar = read("omega_rad_s,im,magnitude,phase_deg\n1,7,2,0\n", options);
  EXPECT_EQ(polar.data.value().front(), 2.0);
}

// Of a part that the file does not hold a condition asks for nothing.
TEST_F(FrequencyResponseFileTest, AConditionOnAMissingRealPartIsRefused) {
  io::FrequencyResponseReadOptions options;
  options.real_may_miss = true;
  for (const char* condition : {"re<1", "magnitude>0"}) {
    options.where = {io::PointFilter(condition)};
    try {
      static_cast<void>(read("omega_rad_s,im\n1,2\n", options));
      ADD_FAILURE() << "no error";
    } catch (const std::invalid_argument& error) {
      EXPECT_NE(std::string(error.what()).find("no real part"), std::string::npos) << error.what();
    }
  }
  options.where = {io::PointFilter("im<0")};
  EXPECT_EQ(read("omega_rad_s,im\n1,2\n2,-1\n", options).data.size(), 1U);
}

TEST_F(FrequencyResponseFileTest, CurvesInColumnsAreToldApartByTheirLabels) {
  const std::string file = folder.write("columns.csv",
                                        "omega_rad_s,re_10,im_10,re_20,-im_20,sigma_20\n"
                                        "1,2,3,4,5,0.1\n"
                                        "2,6,7,8,9,0.2\n");
  EXPECT_EQ(io::curve_labels(io::read_measurement(file), ""), (std::vector<std::string>{"10", "20"}));
  io::FrequencyResponseReadOptions options;
  options.curve = "20";
  const auto curve = io::read_frequency_response(file, options);
  EXPECT_EQ(curve.data.value()[1], std::complex<double>(8, -9));
  EXPECT_EQ(curve.data.sigma()[1], 0.2);
  EXPECT_EQ(io::find_value(curve.metadata, "curve"), "20");

  const std::string polar = folder.write("polar.csv",
                                         "f_Hz,magnitude_db_a,phase_deg_a,magnitude_b,phase_rad_b\n"
                                         "1,20,180,3,0\n");
  EXPECT_EQ(io::curve_labels(io::read_measurement(polar), ""), (std::vector<std::string>{"a", "b"}));
  options.curve = "a";
  EXPECT_NEAR(std::abs(io::read_frequency_response(polar, options).data.value()[0] + 10.0), 0, 1e-13);
  options.curve = "b";
  EXPECT_EQ(io::read_frequency_response(polar, options).data.value()[0], 3.0);
}

TEST_F(FrequencyResponseFileTest, CurvesInRowsAreToldApartByTheKeyColumn) {
  const std::string file = folder.write("rows.csv",
                                        "force_n,omega_rad_s,re,im\n"
                                        "40,1,1,2\n"
                                        "10,1,3,4\n"
                                        "40.0,2,5,6\n"
                                        "10,2,7,8\n");
  EXPECT_EQ(io::curve_labels(io::read_measurement(file), "force_n"), (std::vector<std::string>{"40", "10"}));
  io::FrequencyResponseReadOptions options;
  options.rows = {{"force_n", "40"}};
  const auto curve = io::read_frequency_response(file, options);
  ASSERT_EQ(curve.data.size(), 2u);
  EXPECT_EQ(curve.data.value()[1], std::complex<double>(5, 6));
  EXPECT_EQ(io::find_value(curve.metadata, "force_n"), "40");
  options.rows = {{"mass_kg", "1"}};
  try {
    (void)io::read_frequency_response(file, options);
    FAIL() << "no error";
  } catch (const io::DataError& error) {
    EXPECT_NE(std::string(error.what()).find("no column 'mass_kg' among force_n"), std::string::npos) << error.what();
  }
}

TEST_F(FrequencyResponseFileTest, PointsOfSeveralScenesAreNoCurve) {
  const std::string file = folder.write("scenes.csv",
                                        "clearance_m,restitution,omega_rad_s,re,im\n"
                                        "0.1,0.5,1,1,2\n"
                                        "0.10,0.5,2,3,4\n"
                                        "0.2,0.5,1,5,6\n"
                                        "0.2,0.5,2,7,8\n"
                                        "0.2,0.5,3,9,9\n");
  EXPECT_EQ(io::scenes_in(io::read_measurement(file)),
            (std::vector<io::Metadata>{{{"clearance_m", "0.1"}}, {{"clearance_m", "0.2"}}}));
  EXPECT_TRUE(io::scenes_in(io::read_measurement(file), {io::PointFilter("clearance_m<0.15")}).empty());
  EXPECT_THROW(static_cast<void>(io::read_frequency_response(file)), std::invalid_argument);
  io::FrequencyResponseReadOptions options;
  options.where.emplace_back("clearance_m==0.1");
  const auto one = io::read_frequency_response(file, options);
  EXPECT_EQ(one.data.value(), (std::vector<std::complex<double>>{{1, 2}, {3, 4}}));
  EXPECT_EQ(io::find_value(one.metadata, "clearance_m"), "0.1");
  EXPECT_EQ(io::find_value(one.metadata, "restitution"), "0.5");
  // A condition on the points that leaves those of one scene.
  options.where = {io::PointFilter("omega>2")};
  EXPECT_EQ(io::read_frequency_response(file, options).data.size(), 1U);
}

TEST_F(FrequencyResponseFileTest, AnOrdinaryFileHoldsOneCurveWithoutLabel) {
  EXPECT_TRUE(io::curve_labels(io::read_measurement(folder.write("one.csv", "omega_rad_s,re_ohm,im_ohm\n1,2,3\n")), "")
                  .empty());
  EXPECT_TRUE(
      io::curve_labels(io::read_measurement(folder.write("two.csv", "f_Hz,magnitude_db,phase_deg\n1,2,3\n")), "")
          .empty());
}

TEST(DataError, MessagesHoldNothingThatATerminalCannotShow) {
  EXPECT_EQ(io::printable("\xcf\x89_rad_s"), "\xcf\x89_rad_s");  // UTF-8 stays
  EXPECT_EQ(io::printable("a\x1b[2J"), "a?[2J");
  EXPECT_EQ(io::printable("\xff\xe2\x82 \xc0\x80 \xc2\x9b"), "??? ?? ??");
  EXPECT_EQ(io::quoted(std::string(50, 'x')), "'" + std::string(40, 'x') + "...'");
}

}  // namespace
