// SPDX-License-Identifier: BSD-3-Clause
#include "report/report.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>
#include <random>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "io/data_error.hpp"
#include "io/number.hpp"
#include "io/text_table.hpp"
#include "report/field.hpp"
#include "report/figure.hpp"
#include "report_support.hpp"
#include "temporary_folder.hpp"

namespace {

using namespace report;
namespace fs = std::filesystem;

TEST(WriteReport, FindsAnUnusableFolderBeforeAnyWork) {
  const TemporaryFolder folder;
  ReportOptions options;
  options.out = folder.write("file", "");
  bool worked = false;
  options.stage = [&](std::string_view) { worked = true; };
  EXPECT_THROW(static_cast<void>(write_report(options)), std::invalid_argument);
  EXPECT_FALSE(worked);
}

TEST(WriteReport, RefusesDataTogetherWithAScene) {
  const TemporaryFolder folder;
  ReportOptions options;
  options.out = folder.path("out");
  options.data = {"a.csv"};
  options.scene = "b.json";
  EXPECT_THROW(static_cast<void>(write_report(options)), std::invalid_argument);
}

TEST(WriteReport, LeavesNoFolderWhenTheDataCannotBeRead) {
  const TemporaryFolder folder;
  ReportOptions options;
  options.out = folder.path("out");
  options.data = {folder.path("missing.csv")};
  EXPECT_THROW(static_cast<void>(write_report(options)), io::DataError);
  EXPECT_FALSE(fs::exists(folder.path("out")));
}

/// Everything that results.json promises is there, and every table reads back as a table of as many columns in each
/// row.
void expect_complete(const fs::path& out, bool pictures) {
  const std::string page = content_of((out / "index.html").string());
  const auto json = nlohmann::json::parse(content_of((out / "results.json").string()));
  EXPECT_EQ(json.at("schema"), "fracfit-report/1");
  EXPECT_EQ(json.at("pictures"), pictures);
  std::size_t tables = 0, drawings = 0;
  for (const std::string file : json.at("files")) {
    const fs::path path = out / file;
    ASSERT_TRUE(fs::exists(path)) << file;
    EXPECT_GT(fs::file_size(path), 0U) << file;
    if (path.extension() == ".csv") {
      ++tables;
      const io::TextTable table(path.string());
      EXPECT_GE(table.header().size(), 2U) << file;
      std::size_t rows = 0;
      table.for_each_row([&rows](const io::TextTable::Row&) { ++rows; });
      EXPECT_GT(rows, 0U) << file;
    }
    drawings += path.extension() == ".svg" ? 1 : 0;
  }
  EXPECT_GT(tables, 0U);
  EXPECT_EQ(drawings > 0, pictures);
  // Self-contained: nothing to load and no link out; scripts stand in the page.
  for (const char* foreign :
       {"<link", "<img", "<iframe", " src=", "href=\"http", "@import", "fetch(", "XMLHttpRequest", "import("}) {
    EXPECT_EQ(page.find(foreign), std::string::npos) << foreign;
  }
  // One page, one meaning per id.
  std::map<std::string, int> ids;
  const std::regex id("[\\s]id=['\"]([^'\"]+)['\"]");
  for (std::sregex_iterator it(page.begin(), page.end(), id), end; it != end; ++it) ++ids[(*it)[1]];
  for (const auto& [name, count] : ids) EXPECT_EQ(count, 1) << name;
  for (const auto& entry : fs::directory_iterator(out)) {
    EXPECT_NE(entry.path().filename().string().front(), '.') << "left over: " << entry.path();
  }
}

/// Im(-1/N) of two symmetric impacts is k omega^2, so that one parameter and a whole order meet it to rounding, and a
/// power law fitted to it has the order 2 to the rounding of a regression; no other band of the scene has such a law.
void expect_economy_of_the_law(const nlohmann::json& json) {
  const auto& facts = json.at("facts");
  EXPECT_EQ(facts.at("economy_two-impact_minus-inverse"), "integer-cheaper");
  EXPECT_EQ(facts.at("whole_parameters_two-impact_minus-inverse"), 1);
  EXPECT_GT(facts.at("whole_parameters_two-impact_n"), 1);
  EXPECT_GT(facts.at("whole_parameters_chatter_minus-inverse"), 1);
  EXPECT_NEAR(facts.at("fitted_order_two-impact_minus-inverse").get<double>(), 2, 1e-9);
  // From 10 rad/s on the static model transmits nothing, N = 0, and its error is the whole of the imaginary part.
  EXPECT_NEAR(facts.at("static_error_two-impact_n").get<double>(), 1, 1e-12);
  // The table shows the class of the law as exact, and nothing else of whole orders.
  std::map<std::string, std::string> needs;
  for (const auto& row : json.at("tables").at("economy-needs"))
    needs[row.at("class")] = row.at("two-impact_minus-inverse");
  EXPECT_EQ(needs.at("whole powers of omega"), "1, exact");
  EXPECT_EQ(needs.at("real powers"), "2, exact");
  EXPECT_EQ(needs.at("static backlash"), "–") << "its -1/N is infinite there";
}

/// The text of an element without its tags.
std::string without_tags(const std::string& html) {
  return std::regex_replace(html, std::regex("<[^>]*>"), "");
}

/// Six sentences, each with numbers that follow from the scene by hand: F = 20 N, clearance 0.2 m, both masses 1 kg, so
/// that sqrt(F/(M2 clearance)) = 10 rad/s; restitution 0.6.
void expect_first_page(const std::string& page) {
  const auto begin = page.find("<section id=\"minute\">");
  ASSERT_NE(begin, std::string::npos);
  EXPECT_LT(begin, page.find("<nav>")) << "the first page stands before the table of contents";
  const std::string text = without_tags(page.substr(begin, page.find("<nav>") - begin));
  std::size_t at = 0;
  for (const char* expected : {
           "What was computed.",
           "Two masses of 1 kg touch only at the two ends of a gap of 0.2 m: a sine force of 20 N",
           "What is fractional.",
           "against 14/3",
           "What is not.",
           // (pi/4) (0.4/1.6) (1 + 1)
           "here 0.3927 ω²",
           "What the static model misses.",
           // sqrt(2 F/((M1 + M2) clearance))
           "from 10 rad/s on",
           "The jump.",
           // The asymmetric orbit doubles its period, as jump_frequency_test has it from the multiplier.
           "here 1.408 and so 14.1 rad/s",
           "What a controller meets.",
       }) {
    const auto found = text.find(expected, at);
    ASSERT_NE(found, std::string::npos) << expected << "\nin: " << text;
    at = found;
  }
}

TEST(WriteReport, WritesEverythingForASmallScene) {
  const TemporaryFolder folder;
  ReportOptions options;
  options.out = folder.path("out/report");
  options.command = "fracfit report --scene <scene>";
  options.scene = folder.write(
      "scene.json", R"({"clearance": [0.2, 0.3], "restitution": [0.6], "force": [20, 40], "omega": "1:30:60log"})");
  std::vector<std::string> stages;
  options.stage = [&](std::string_view name) { stages.emplace_back(name); };
  const ReportOutcome outcome = write_report(options);
  EXPECT_EQ(outcome.pictures, find_gnuplot().has_value()) << outcome.message;
  EXPECT_EQ(outcome.index.filename(), "index.html");
  EXPECT_GE(stages.size(), 5U);
  expect_complete(options.out, outcome.pictures);
  const auto json = nlohmann::json::parse(content_of((options.out / "results.json").string()));
  // Similarity: b = 1/2 and a proportional to clearance^-1/2 hold exactly, so least squares finds them to rounding.
  EXPECT_NEAR(json.at("facts").at("a_exponent").get<double>(), -0.5, 1e-9);
  EXPECT_NEAR(json.at("facts").at("b_coefficient").get<double>(), 0.5, 1e-9);
  // Sticking motion leaves its asymptote by about gamma^(-2/3); at a sixth of 1 rad/s, gamma = 7200 for the first
  // scene.
  EXPECT_NEAR(json.at("facts").at("lowest_local_slope").get<double>(), 2.0 / 3, 0.01);
  // That of Im(-1/N) likewise from 14/3.
  EXPECT_NEAR(json.at("facts").at("lowest_local_slope_minus-inverse").get<double>(), 14.0 / 3, 0.02);
  expect_economy_of_the_law(json);
  expect_first_page(content_of(outcome.index.string()));
  // Symmetry of the two-impact orbit at restitution 0.6, to six digits (1/sqrt(0.3660699362)).
  const io::TextTable bifurcations((options.out / "tables/bifurcations.csv").string());
  double symmetry_loss = 0;
  bifurcations.for_each_row([&](const io::TextTable::Row& row) {
    const bool two_impact = row.fields[1] == "2" && row.fields[2] == "1" && row.fields[3] == "symmetric";
    if (two_impact && row.fields[4] == "symmetry-breaking") symmetry_loss = *io::parse_number(row.fields[6]);
  });
  EXPECT_NEAR(symmetry_loss, 1.65279, 5e-6);
  EXPECT_NE(content_of(outcome.index.string()).find("fracfit report --scene &lt;scene&gt;"), std::string::npos);
  // The scene stands in every file, so that each can be made again.
  EXPECT_EQ(json.at("inputs").at("forces_n"), "20 40");
  const io::TextTable family((options.out / "tables/force-family.csv").string());
  EXPECT_EQ(io::find_value(family.metadata(), "clearances_m"), "0.2 0.3");
  EXPECT_EQ(io::find_value(family.metadata(), "m2_kg"), "1");
}

// Contacts a thousand times as fast as the force: N, its loss factor and its jump differ from those of the restitution
// in first order of omega/omega_c with factors of about 1 (0.9 of c). Closed orbits balance their energy to rounding.
TEST(WriteReport, ReportsOnContactsThatTakeTime) {
  const SearchPath nothing("");
  const TemporaryFolder folder;
  const auto facts_of = [&](const std::string& more) {
    ReportOptions options;
    options.out = folder.path("out");
    options.scene = folder.write("scene.json", R"({"clearance": 0.3, "force": 40, "omega": "20:24:5",)" + more + "}");
    static_cast<void>(write_report(options));
    expect_complete(options.out, false);
    const std::string page = content_of((options.out / "index.html").string());
    // Chapters of contacts that take no time are left out.
    for (const char* hard : {"id=\"minute\"", "id=\"loss-factor\"", "id=\"orbits\"", "(π/4)"})
      EXPECT_EQ(page.find(hard), std::string::npos) << hard;
    const auto json = nlohmann::json::parse(content_of((options.out / "results.json").string()));
    EXPECT_EQ(json.at("inputs").count("restitutions"), 0U);
    return json.at("facts");
  };
  const auto stiff = facts_of(R"("contact_frequency": 20000, "contact_restitution": 0.6)");
  const double unit = std::sqrt(40 / 0.3);
  EXPECT_EQ(stiff.at("contact_closed_orbits"), 5);
  EXPECT_NEAR(stiff.at("contact_loss_factor").get<double>() / (std::numbers::pi / 16), 1, 2e-3);
  EXPECT_NEAR(stiff.at("contact_jump_rad_s").get<double>() / unit / 1.65279, 1, 2e-3);
  EXPECT_NEAR(stiff.at("contact_jump_exponent").get<double>(), 0.5, 2e-3);
  // More is lost where a body rubs.
  const auto rubbing = facts_of(R"("contact_frequency": 20000, "contact_restitution": 0.6, "friction1": 1)");
  EXPECT_GT(rubbing.at("contact_loss_factor"), stiff.at("contact_loss_factor"));
  for (const auto& facts : {stiff, rubbing}) EXPECT_LT(facts.at("contact_energy_defect").get<double>(), 1e-12);
}

TEST(WriteReport, ReportsOnRigidMassesWithoutFits) {
  const SearchPath nothing("");
  const TemporaryFolder folder;
  ReportOptions options;
  options.out = folder.path("out");
  options.scene =
      folder.write("scene.json", R"({"clearance": 0, "restitution": 0.6, "force": 40, "omega": "1:30:10log"})");
  const ReportOutcome outcome = write_report(options);
  expect_complete(options.out, false);
  EXPECT_FALSE(outcome.pictures);
}

TEST(WriteReport, FirstPageSaysWhatARunLacks) {
  const SearchPath nothing("");
  const auto first_page = [](const std::string& scene) {
    const TemporaryFolder folder;
    ReportOptions options;
    options.out = folder.path("out");
    options.scene = folder.write("scene.json", scene);
    const std::string page = content_of(write_report(options).index.string());
    const auto begin = page.find("<section id=\"minute\">");
    return without_tags(page.substr(begin, page.find("<nav>") - begin));
  };
  const std::string lossless = first_page(R"({"clearance": 0.3, "restitution": 1, "force": 40, "omega": "2:30:8log"})");
  EXPECT_NE(lossless.find("Impacts of restitution 1 lose nothing"), std::string::npos) << lossless;
  EXPECT_EQ(lossless.find("What is not."), std::string::npos) << lossless;
  const std::string rigid = first_page(R"({"clearance": 0, "restitution": 0.6, "force": 40, "omega": "1:30:8log"})");
  EXPECT_NE(rigid.find("without a gap move as one"), std::string::npos) << rigid;
  EXPECT_EQ(rigid.find("fractional power"), std::string::npos) << rigid;
  // Too coarse for a point with two impacts: below the jump, which is at 16 rad/s.
  const std::string low = first_page(R"({"clearance": 0.3, "restitution": 0.6, "force": 40, "omega": "1:8:8log"})");
  EXPECT_NE(low.find("No point of this run has two impacts half a period apart"), std::string::npos) << low;
}

/// The report of one file, made without gnuplot, which no number of it needs.
class FileReport {
 public:
  FileReport(const std::string& name, const std::string& text, Field field = Field::automatic)
      : data_(folder_.write(name, text)) {
    ReportOptions options;
    options.out = path();
    options.data = {data_};
    options.field = field;
    outcome_ = write_report(options);
  }

  [[nodiscard]] const ReportOutcome& outcome() const { return outcome_; }
  [[nodiscard]] const std::string& data() const { return data_; }
  /// A file of the report, or its folder.
  [[nodiscard]] std::string path() const { return folder_.path("out"); }
  [[nodiscard]] std::string path(const std::string& file) const { return folder_.path("out/" + file); }
  [[nodiscard]] std::string page() const { return content_of(path("index.html")); }
  [[nodiscard]] std::string script() const { return content_of(path("figures/data-1.gp")); }
  [[nodiscard]] nlohmann::json results() const { return nlohmann::json::parse(content_of(path("results.json"))); }
  [[nodiscard]] std::string verdict() const { return results().at("facts").at("verdict_data-1"); }
  /// Estimate of a parameter of a structure; NaN if there is none.
  [[nodiscard]] double parameter(const std::string& structure, const std::string& name) const {
    double value = NAN;
    const io::TextTable table(path("tables/data-1-parameters.csv"));
    table.for_each_row([&](const io::TextTable::Row& row) {
      if (row.fields[1] == structure && row.fields[2] == name) value = io::parse_number(row.fields[3]).value();
    });
    return value;
  }

 private:
  SearchPath nothing_{""};
  TemporaryFolder folder_;
  std::string data_;
  ReportOutcome outcome_;
};

// K/(T s^a + 1) with K = 2, T = 0.5, a = 0.7, computed here and rounded to 6 digits.
std::string fractional_lag_csv() {
  std::string text = "omega_rad_s,re,im\n";
  for (int i = 0; i < 40; ++i) {
    const double omega = std::pow(10.0, -2 + 4.0 * i / 39);
    const std::complex<double> value = 2.0 / (0.5 * std::pow(std::complex<double>(0, omega), 0.7) + 1.0);
    char line[128];
    std::snprintf(line, sizeof line, "%.6g,%.6g,%.6g\n", omega, value.real(), value.imag());
    text += line;
  }
  return text;
}

// Of data without a real part the report fits, draws and lists the imaginary one.
TEST(WriteReport, AnImaginaryPartAloneIsFittedAndDrawnAlone) {
  std::istringstream lines(fractional_lag_csv());
  std::string csv, line;
  while (std::getline(lines, line)) csv += line.substr(0, line.find(',')) + line.substr(line.rfind(',')) + "\n";
  const FileReport report("loss.csv", csv);
  expect_complete(report.path(), report.outcome().pictures);
  EXPECT_NE(report.page().find("so that the imaginary part alone is fitted"), std::string::npos);
  // Six digits are rounded by 5e-6 of a value at most, and 40 of them tell T and a to less than twice that.
  EXPECT_NEAR(report.parameter("K/(T s^a + 1)", "T"), 0.5, 1e-5);
  EXPECT_NEAR(report.parameter("K/(T s^a + 1)", "a"), 0.7, 1e-5);
  const io::TextTable curves(report.path("tables/data-1-curves.csv"));
  std::set<std::string> columns;
  for (const auto& field : curves.header()) columns.emplace(field.text);
  for (const char* drawn : {"im", "fit1_im", "residual_imaginary_percent"})
    EXPECT_TRUE(columns.contains(drawn)) << drawn;
  for (const char* none : {"re", "fit1_re", "magnitude", "phase_deg"}) EXPECT_FALSE(columns.contains(none)) << none;
  EXPECT_EQ(report.script().find("Phase"), std::string::npos);
  EXPECT_EQ(report.script().find("nan"), std::string::npos);
}

TEST(WriteReport, WritesAllNumbersAndSaysWhatToInstallWithoutGnuplot) {
  const FileReport report("lag <1>.csv", fractional_lag_csv());
  EXPECT_FALSE(report.outcome().pictures);
  EXPECT_NE(report.outcome().message.find("gnuplot-nox"), std::string::npos) << report.outcome().message;
  expect_complete(report.path(), false);
  const std::string page = report.page();
  EXPECT_NE(page.find("apt-get install gnuplot-nox"), std::string::npos);
  EXPECT_NE(page.find("lag &lt;1&gt;.csv"), std::string::npos);
  EXPECT_EQ(page.find("lag <1>.csv"), std::string::npos);
  EXPECT_TRUE(fs::exists(report.path("figures/data-1.gp")));
}

TEST(WriteReport, FindsTheStructureThatMadeTheData) {
  const FileReport report("lag.csv", fractional_lag_csv());
  EXPECT_EQ(report.verdict(), "supported");
  // Six digits per value leave the order uncertain by about 1e-6.
  EXPECT_NEAR(report.parameter("K/(T s^a + 1)", "a"), 0.7, 1e-5);
}

// With the header of a command that computes, the same data carry no noise, and the answer is about economy: to the
// error of six digits three parameters follow them, the law that they were made from.
TEST(WriteReport, SaysOfComputedDataWhatIdentifySays) {
  const FileReport report("lag.csv", "# command: fracfit evaluate --model lag\n" + fractional_lag_csv());
  const std::string page = report.page();
  for (const char* said : {"These data carry no noise: what counts is how many parameters buy which error.",
                           "a fractional order is the shorter description"})
    EXPECT_NE(page.find(said), std::string::npos) << said;
  for (const char* hidden : {" odds ", "with 95 % intervals", "misses the data</td>", ">not identified<"})
    EXPECT_EQ(page.find(hidden), std::string::npos) << hidden;
}

// The response of the lag with its real part times three at one frequency, as an instrument that slips a range writes
// it: the page names the frequency, and the order is that of the other points.
TEST(WriteReport, LeavesOutWhatItsNeighboursContradict) {
  std::istringstream lines(fractional_lag_csv());
  std::string text, frequency;
  std::size_t number = 0;
  for (std::string line; std::getline(lines, line); ++number) {
    if (number == 21) {
      const auto first = line.find(','), second = line.find(',', first + 1);
      frequency = line.substr(0, first);
      const double real = io::parse_number(line.substr(first + 1, second - first - 1)).value();
      line = frequency + "," + io::format_number(3 * real) + line.substr(second);
    }
    text += line + "\n";
  }
  const FileReport report("lag.csv", text);
  const std::string page = report.page();
  const auto named = page.find("Left out, because they contradict their neighbours");
  ASSERT_NE(named, std::string::npos);
  EXPECT_NE(page.substr(named, 120).find(frequency.substr(0, 4)), std::string::npos) << frequency;
  EXPECT_EQ(report.verdict(), "supported");
}

// 1/((s + 1)(2 s + 1)(0.3 s + 1)) with 1 % of seeded noise.  No preset has three different lags: where only presets
// compete, a fractional one wins.  The truth is a ratio with three poles.
TEST(WriteReport, LetsRationalModelsCompete) {
  std::mt19937_64 generator(1);
  std::normal_distribution<double> noise(0, 0.01);
  std::string text = "omega_rad_s,re,im\n";
  for (int i = 0; i < 60; ++i) {
    const std::complex<double> s(0, std::pow(10.0, -2 + 4.0 * i / 59));
    const std::complex<double> exact = 1.0 / ((s + 1.0) * (2.0 * s + 1.0) * (0.3 * s + 1.0));
    const std::complex<double> value = exact * std::complex<double>(1 + noise(generator), noise(generator));
    text += io::format_number(s.imag()) + "," + io::format_number(value.real()) + "," +
            io::format_number(value.imag()) + "\n";
  }
  const FileReport report("lags.csv", text);
  EXPECT_EQ(report.verdict(), "not-supported");
}

// 1 + 2/(1 + (j 2 pi f 0.1)^0.8) ohm, rounded to 6 digits.
std::string arc_csv() {
  std::string text = "f_hz,re_ohm,im_ohm\n";
  for (int i = 0; i < 30; ++i) {
    const double hertz = std::pow(10.0, -2 + 4.0 * i / 29);
    const std::complex<double> z =
        1.0 + 2.0 / (1.0 + std::pow(std::complex<double>(0, 0.2 * std::numbers::pi * hertz), 0.8));
    char line[128];
    std::snprintf(line, sizeof line, "%.6g,%.6g,%.6g\n", hertz, z.real(), z.imag());
    text += line;
  }
  return text;
}

TEST(WriteReport, ShowsAnImpedanceAsReadersOfSpectraDo) {
  const FileReport report("arc.csv", arc_csv());
  const auto json = report.results();
  EXPECT_EQ(json.at("facts").at("quantity_data-1"), "impedance");
  const std::string script = report.script();
  EXPECT_NE(script.find("set xlabel 'Z′ in Ω'"), std::string::npos);
  EXPECT_NE(script.find("set ylabel '−Z″ in Ω'"), std::string::npos);
  EXPECT_NE(script.find("set xlabel 'f in Hz'"), std::string::npos);

  // The values of the pictures are those of the file.
  const io::TextTable written(report.data());
  const auto& rows = json.at("tables").at("data-1-curves");
  std::size_t row = 0;
  written.for_each_row([&](const io::TextTable::Row& cells) {
    // 2 pi is multiplied and divided again.
    const double hertz = *io::parse_number(cells.fields[0]);
    EXPECT_NEAR(rows.at(row).at("f_hz").get<double>(), hertz, 4e-16 * hertz);
    EXPECT_EQ(rows.at(row).at("re").get<double>(), *io::parse_number(cells.fields[1]));
    EXPECT_EQ(rows.at(row).at("im").get<double>(), *io::parse_number(cells.fields[2]));
    ++row;
  });
  EXPECT_EQ(rows.size(), row);
  char drawn[64];
  std::snprintf(drawn, sizeof drawn, "%.9g %.9g ", rows.at(12).at("re").get<double>(),
                -rows.at(12).at("im").get<double>());
  EXPECT_NE(script.find(drawn), std::string::npos) << "−Im points upward: " << drawn;

  // Sentences speak of the frequency as the pictures do.
  EXPECT_NE(report.page().find("0.01 … 100 Hz"), std::string::npos);
  EXPECT_EQ(report.page().find("rad/s"), std::string::npos);

  // The verdict stands in the frame of the picture, the intervals in a table of their own.
  const std::string page = report.page();
  const std::size_t figure = page.find("<figure id=\"figure-data-1\"");
  const std::size_t verdict = page.find("class=\"verdict\"", figure);
  ASSERT_NE(figure, std::string::npos);
  EXPECT_LT(verdict, page.find("</figure>", figure));
  // Before it a line with the verdict, the resistances and to how much the points are consistent.
  const std::size_t line = page.find("; consistent to ");
  EXPECT_LT(line, figure);
  EXPECT_NE(page.rfind(" ± ", line), std::string::npos);
  EXPECT_NE(page.rfind(report.verdict() + ", odds ", line), std::string::npos);
  const auto& parameters = json.at("tables").at("data-1-chosen");
  ASSERT_FALSE(parameters.empty());
  for (const auto& parameter : parameters) {
    EXPECT_LT(parameter.at("ci95_lower").get<double>(), parameter.at("value").get<double>());
    EXPECT_GT(parameter.at("ci95_upper").get<double>(), parameter.at("value").get<double>());
  }

  // Beside it the relaxation times, with units.
  const std::string times = content_of(report.path("figures/data-1-times.gp"));
  EXPECT_NE(times.find("set xlabel 'τ in s'"), std::string::npos);
  EXPECT_NE(times.find("set ylabel 'density per e-fold in Ω'"), std::string::npos);
  EXPECT_NE(page.find("<figure id=\"figure-data-1-times\""), std::string::npos);
  // Within the band alone: what is faster than 100 Hz or slower than 0.01 Hz the data do not tell.
  std::istringstream lines(times);
  int drawn_times = 0;
  for (std::string line; std::getline(lines, line);) {
    double tau = 0, density = 0;
    char more = 0;
    if (std::sscanf(line.c_str(), "%lf %lf%c", &tau, &density, &more) < 2) continue;
    EXPECT_GE(tau, 1 / (2 * std::numbers::pi * 100) * (1 - 1e-8)) << line;  // written with nine digits
    EXPECT_LE(tau, 1 / (2 * std::numbers::pi * 0.01) * (1 + 1e-8)) << line;
    ++drawn_times;
  }
  EXPECT_GT(drawn_times, 40);  // twelve in each of four decades

  const FileReport of_other_field("arc.csv", arc_csv(), Field::transfer_function);
  EXPECT_FALSE(fs::exists(of_other_field.path("figures/data-1-times.gp")));
  const std::string changed = of_other_field.script();
  EXPECT_EQ(changed.find("Nyquist"), std::string::npos);
  EXPECT_NE(changed.find("dB re 1 Ω"), std::string::npos);
}

// JSON of the figures in a page.
std::vector<nlohmann::json> figures_in(const std::string& page) {
  std::vector<nlohmann::json> figures;
  const std::string begin = "class=\"figure-data\">";
  for (std::size_t at = page.find(begin); at != std::string::npos; at = page.find(begin, at + 1)) {
    const std::size_t first = at + begin.size();
    figures.push_back(nlohmann::json::parse(page.substr(first, page.find("</script>", first) - first)));
  }
  return figures;
}

TEST(WriteReport, GivesTheScriptTheValuesOfTheResults) {
  const FileReport report("arc.csv", arc_csv());
  const std::string page = report.page();
  expect_complete(report.path(), false);
  EXPECT_NE(page.find("default-src 'none'"), std::string::npos);
  const auto figures = figures_in(page);
  ASSERT_EQ(figures.size(), 3U) << "response, relaxation times and residuals";
  // Drawn once, by the script, and who allows none is told of it at each picture.  The page itself has the circuit.
  EXPECT_EQ(page.find("<svg"), page.rfind("<svg"));
  EXPECT_NE(page.find("<svg class=\"circuit\""), std::string::npos);
  EXPECT_NE(page.find("aria-label=\"circuit R0+(R1|CPE1)\""), std::string::npos);
  std::size_t told = 0;
  for (std::size_t at = page.find("<noscript>"); at != std::string::npos; at = page.find("<noscript>", at + 1)) ++told;
  EXPECT_EQ(told, figures.size());
  const auto json = report.results();
  const auto& rows = json.at("tables").at("data-1-curves");
  // The data are the last curve of the Nyquist panel.
  const auto& points = figures[0].at("panels").at(0).at("curves").back().at("segments").at(0);
  const auto& residuals = figures[2].at("panels").at(0).at("curves").back().at("segments").at(0);
  ASSERT_EQ(points.size(), rows.size());
  ASSERT_EQ(residuals.size(), rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    EXPECT_EQ(points[i][0], rows[i].at("re"));
    EXPECT_EQ(points[i][1].get<double>(), -rows[i].at("im").get<double>());
    EXPECT_EQ(points[i][4], rows[i].at("f_hz")) << "what other panels find the point by";
    EXPECT_EQ(residuals[i][0], rows[i].at("f_hz"));
    EXPECT_EQ(residuals[i][1], rows[i].at("residual_magnitude_percent"));
  }
  // A wide range may end above the axis, the density may not.
  const auto& times = figures[1].at("panels").at(0);
  for (const auto& point : times.at("curves").at(1).at("segments").at(0))
    EXPECT_LT(point.at(1), times.at("y").at("to")) << "tau = " << point.at(0);
}

TEST(WriteReport, ShowsAModulusAsStorageAndLoss) {
  std::string text = "omega (rad/s),G' (Pa),G'' (Pa)\n";
  for (int i = 0; i < 20; ++i) {
    const double omega = std::pow(10.0, -1 + 3.0 * i / 19);
    const std::complex<double> modulus = 20.0 * std::pow(std::complex<double>(0, omega), 0.4);
    char line[128];
    std::snprintf(line, sizeof line, "%.6g,%.6g,%.6g\n", omega, modulus.real(), modulus.imag());
    text += line;
  }
  const FileReport report("gel.csv", text);
  const std::string script = report.script();
  EXPECT_NE(script.find("set ylabel 'G′, G″ in Pa'\nset logscale y"), std::string::npos);
  EXPECT_NE(script.find("'data, G″'"), std::string::npos);
  EXPECT_NE(script.find("set ylabel 'G″/G′'"), std::string::npos);
}

// Step response of 2/(s^2 + 0.6 s + 1) above an offset of 1, six digits: an oscillator, and no fractional order.
TEST(WriteReport, TakesSamplesOverTime) {
  std::string text = "time_s,input,output\n";
  const double natural = std::sqrt(1 - 0.09);
  for (int n = 0; n <= 24; ++n) {
    const double t = 0.4 * n, swing = std::cos(natural * t) + 0.3 / natural * std::sin(natural * t);
    text += std::to_string(t) + ",1," + std::to_string(3 - 2 * std::exp(-0.3 * t) * swing) + "\n";
  }
  const FileReport report("step.csv", text);
  EXPECT_EQ(report.verdict(), "not-supported");
  EXPECT_NE(report.script().find("Residuals"), std::string::npos);
  EXPECT_NEAR(report.parameter("K/(b2 s^2 + b1 s + 1)", "offset"), 1, 1e-5);
  // Differentiators are not simulated; the verdict is not buried under their reasons.
  const std::string page = report.page();
  const auto verdict = page.find("class=\"verdict\"");
  const auto fold = page.find("<details><summary>Left out: ", verdict), end = page.find("</div>", verdict);
  ASSERT_LT(verdict, fold);
  EXPECT_LT(fold, end);
  EXPECT_LT(page.find("<li>differentiator: ", fold), end);
  EXPECT_EQ(page.substr(verdict, fold - verdict).find("no finite response"), std::string::npos);
}

}  // namespace
