// SPDX-License-Identifier: BSD-3-Clause
#include "report/report.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <chrono>
#include <cmath>
#include <complex>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>
#include <optional>
#include <random>
#include <regex>
#include <set>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "io/data_error.hpp"
#include "io/frequency_response_file.hpp"
#include "io/number.hpp"
#include "io/text_table.hpp"
#include "report/field.hpp"
#include "report/figure.hpp"
#include "report/figure_data.hpp"
#include "report/fixed_step_reference.hpp"
#include "report/html.hpp"
#include "report/prose.hpp"
#include "report/scene.hpp"
#include "report/staged_folder.hpp"
#include "report/sweep_curves.hpp"
#include "report/table.hpp"
#include "support/random.hpp"
#include "temporary_folder.hpp"

namespace {

using namespace report;
namespace fs = std::filesystem;

/// PATH with another value for the time of one test.
class SearchPath {
 public:
  explicit SearchPath(const std::string& value) : before_(std::getenv("PATH")) { ::setenv("PATH", value.c_str(), 1); }
  ~SearchPath() { ::setenv("PATH", before_.c_str(), 1); }
  SearchPath(const SearchPath&) = delete;
  SearchPath& operator=(const SearchPath&) = delete;

 private:
  std::string before_;
};

std::set<std::string> all_matches(const std::string& text, const std::string& pattern) {
  std::set<std::string> found;
  const std::regex expression(pattern);
  for (std::sregex_iterator it(text.begin(), text.end(), expression), end; it != end; ++it) found.insert((*it)[1]);
  return found;
}

Figure small_figure(const std::string& name) {
  Panel panel;
  panel.title = "Reader's view";
  panel.x = {"ω in rad/s", true, {}, {}};
  panel.y = {"N/m", false, {}, {}};
  panel.key = true;
  panel.curves = {
      make_curve("first", category_colour(0), Mark::line, {1, 2, 3, 4}, {1, std::nan(""), 3, 4.5}),
      make_curve("second", category_colour(1), Mark::open_points, {1, 2, 4}, {2, 2, 2}),
  };
  Figure figure;
  figure.name = name;
  figure.panels = {panel, panel};
  return figure;
}

TEST(EscapeHtml, LeavesNoCharacterThatEndsTextOrAnAttribute) {
  EXPECT_EQ(escape_html("a<b>&\"c\"'d'"), "a&lt;b&gt;&amp;&quot;c&quot;&#39;d&#39;");
  EXPECT_EQ(escape_html("Δ = 0.3 m"), "Δ = 0.3 m");
}

TEST(HtmlNumber, WritesWhatReadersExpect) {
  EXPECT_EQ(html_number(0), "0");
  EXPECT_EQ(html_number(3.14159, 3), "3.14");
  EXPECT_EQ(html_number(380.4, 2), "380");
  EXPECT_EQ(html_number(-0.5, 4), "−0.5");
  EXPECT_EQ(html_number(99.996, 4), "100");
  EXPECT_EQ(html_number(1.5e-7, 3), "1.5·10<sup>−7</sup>");
  EXPECT_EQ(html_number(2e9, 3), "2·10<sup>9</sup>");
  EXPECT_EQ(html_number(std::nan("")), "–");
  EXPECT_EQ(html_number(-INFINITY), "−∞");
}

TEST(HtmlSeconds, PicksTheUnit) {
  EXPECT_EQ(html_seconds(1.5e-6), "1.5 µs");
  EXPECT_EQ(html_seconds(0.0132), "13 ms");
  EXPECT_EQ(html_seconds(2.5e-8), "25 ns");
  EXPECT_EQ(html_seconds(12), "12 s");
}

TEST(HtmlFormula, RaisesPowersAndEscapes) {
  EXPECT_EQ(html_formula("K s^a1/(T s^0.5 + 1)"),
            "<span class=\"formula\">K s<sup>a1</sup>/(T s<sup>0.5</sup> + 1)</span>");
  EXPECT_EQ(html_formula("a<b"), "<span class=\"formula\">a&lt;b</span>");
}

TEST(Prose, JoinsTheLinesOfAPassageAndFillsItsPlaces) {
  const auto passages = passages_of({"words", "# one\nfirst line\nsecond {x} and {x}\n\n# two\n{y}\n"});
  ASSERT_EQ(passages.size(), 2U);
  EXPECT_EQ(passages.at("one"), "first line second {x} and {x}");
  EXPECT_EQ(filled(passages.at("one"), {{"x", "{y}"}}), "first line second {y} and {y}");
}

TEST(Prose, RefusesWhatDoesNotFitTogether) {
  EXPECT_THROW((void)filled("{x} and {y}", {{"x", "1"}}), std::logic_error) << "a place without a value";
  EXPECT_THROW((void)filled("{x}", {{"x", "1"}, {"y", "2"}}), std::logic_error) << "a value without a place";
  EXPECT_THROW((void)filled("{x", {{"x", "1"}}), std::logic_error);
  EXPECT_THROW((void)prose("no such chapter", "title"), std::logic_error);
  EXPECT_THROW((void)prose("jumps", "no such passage"), std::logic_error);
  EXPECT_THROW((void)passages_of({"words", "text\n# one\ntext\n"}), std::logic_error) << "text before a passage";
  EXPECT_THROW((void)passages_of({"words", "# one\ntext\n# one\ntext\n"}), std::logic_error) << "defined twice";
  EXPECT_THROW((void)passages_of({"words", "# one\n\n# two\ntext\n"}), std::logic_error) << "empty";
}

/// The text of a call from its opening parenthesis to the closing one.
std::string call_at(const std::string& source, std::size_t open) {
  int depth = 0;
  bool quoted = false;
  for (std::size_t i = open; i < source.size(); ++i) {
    if (source[i] == '"' && source[i - 1] != '\\') quoted = !quoted;
    if (quoted) continue;
    depth += source[i] == '(' ? 1 : source[i] == ')' ? -1 : 0;
    if (depth == 0) return source.substr(open, i - open + 1);
  }
  return source.substr(open);
}

TEST(Prose, EveryPassageIsUsedWithExactlyTheValuesItHasPlacesFor) {
  std::map<std::pair<std::string, std::string>, std::set<std::string>> used;
  const std::regex call(R"re((prose|paragraph|open_section|open_measured)(\()\s*"([^"]+)"(?:,\s*"([^"]+)")?)re");
  for (const auto& entry : fs::directory_iterator(fs::path(FRACFIT_SOURCE_DIR) / "tools/report")) {
    if (entry.path().extension() != ".cpp") continue;
    const std::string source = content_of(entry.path().string());
    for (std::sregex_iterator it(source.begin(), source.end(), call), end; it != end; ++it) {
      const std::string function = (*it)[1];
      const std::string chapter = (*it)[3];
      if (function == "open_section") used[{chapter, "title"}];
      if (function.starts_with("open_")) {
        used[{chapter, "reading"}];
      } else {
        const auto open = static_cast<std::size_t>(it->position(2));
        used[{chapter, (*it)[4]}] = all_matches(call_at(source, open), R"re(\{\s*"(\w+)",)re");
      }
    }
  }
  ASSERT_GT(used.size(), 50U) << "the sources were not understood";
  std::set<std::pair<std::string, std::string>> written;
  for (const ProseText& text : prose_texts()) {
    for (const auto& [name, passage] : passages_of(text)) {
      const std::pair<std::string, std::string> key{text.name, name};
      written.insert(key);
      ASSERT_TRUE(used.contains(key)) << "text/" << text.name << ".txt: nobody uses \"" << name << '"';
      EXPECT_EQ(all_matches(passage, R"(\{([^}]*)\})"), used.at(key)) << "text/" << text.name << ".txt: " << name;
    }
  }
  for (const auto& [key, values] : used) {
    EXPECT_TRUE(written.contains(key)) << "text/" << key.first << ".txt has no passage \"" << key.second << '"';
  }
}

TEST(InlineSvg, GivesEveryPictureIdsOfItsOwnAndKeepsReferencesWhole) {
  const std::string svg =
      "<?xml version=\"1.0\"?>\n<!DOCTYPE svg>\n<svg viewBox=\"0 0 1 1\" xmlns=\"http://www.w3.org/2000/svg\">\n"
      "<title>Gnuplot</title><defs>\n\t<circle id='gpPt5' r='1'/>\n<use xlink:href='#gpPt5' id='gpPt6' "
      "fill='currentColor'/>"
      "<pattern id=\"fill\"/></defs>\n<g id=\"plot_1\" fill=\"url(#fill)\"><use xlink:href='#gpPt6'/></g></svg>";
  const std::string one = inline_svg(svg, "one-");
  const std::string two = inline_svg(svg, "two-");
  EXPECT_EQ(one.rfind("<svg", 0), 0U);
  EXPECT_EQ(one.find("Gnuplot"), std::string::npos) << "would be shown as a tooltip";
  const std::string id = "[\\s]id=['\"]([^'\"]+)['\"]";
  const std::string reference = "(?:href=['\"]#|url\\(#)([^'\")]+)";
  EXPECT_EQ(all_matches(one, id), (std::set<std::string>{"one-gpPt5", "one-gpPt6", "one-fill", "one-plot_1"}));
  EXPECT_EQ(all_matches(one, reference), (std::set<std::string>{"one-gpPt5", "one-gpPt6", "one-fill"}));
  EXPECT_EQ(all_matches(two, id).count("one-gpPt5"), 0U);
}

TEST(InlineSvg, IsEmptyForWhatIsNoPicture) {
  EXPECT_EQ(inline_svg("gnuplot: error", "x-"), "");
}

TEST(EnhancedEscape, TakesTheMeaningFromEveryMarkupCharacter) {
  EXPECT_EQ(enhanced_escape("my_file^2 {a}@&~\\"), "my\\_file\\^2 \\{a\\}\\@\\&\\~\\\\");
  EXPECT_EQ(enhanced_escape("two\nlines"), "two lines");
}

TEST(MakeCurve, BreaksTheLineWhereThereIsNoNumber) {
  const Curve curve = make_curve("c", "#000000", Mark::line, {1, 2, 3, 4}, {1, std::nan(""), 3, 4});
  ASSERT_EQ(curve.segments.size(), 2U);
  EXPECT_EQ(curve.segments[0].size(), 1U);
  EXPECT_EQ(curve.segments[1].size(), 2U);
}

TEST(FamilyColour, GetsLighterFromMemberToMember) {
  // Luma of ITU-R BT.601: a grey print keeps the order of the family.
  double before = -1;
  for (std::size_t i = 0; i < 8; ++i) {
    const std::string colour = family_colour(i, 8);
    const auto channel = [&](std::size_t at) { return std::stoi(colour.substr(at, 2), nullptr, 16); };
    const double luma = 0.299 * channel(1) + 0.587 * channel(3) + 0.114 * channel(5);
    EXPECT_GT(luma, before) << i;
    before = luma;
  }
  EXPECT_LT(before, 200) << "the last member must stand out from white paper";
}

TEST(WriteScript, NeedsNoGnuplotAndHoldsTheData) {
  const SearchPath nothing("");
  const TemporaryFolder folder;
  const std::string script = gnuplot_script(small_figure("picture"));
  EXPECT_NE(script.find("set title 'Reader\u2019s view'"), std::string::npos);
  EXPECT_NE(script.find("set logscale x"), std::string::npos);
  EXPECT_NE(script.find("title 'second'"), std::string::npos);
  // The break of the first curve is a blank line between its points.
  EXPECT_NE(script.find("$panel1_curve1 << e\n1 1 1 1\n\n3 3 3 3\n4 4.5 4.5 4.5\n"), std::string::npos)
      << script.substr(0, 400);
}

// Margins of a panel of a script: the axes box in shares of the picture, left, right, top, bottom.
std::vector<double> margins_of(const std::string& script, std::size_t panel) {
  const std::regex margin(R"(set [lrtb]margin at screen (\S+))");
  std::vector<double> all;
  for (std::sregex_iterator it(script.begin(), script.end(), margin), end; it != end; ++it)
    all.push_back(std::stod((*it)[1]));
  const auto first = all.begin() + static_cast<std::ptrdiff_t>(4 * panel);
  return {first, first + 4};
}

TEST(WriteScript, PutsAPanelOfSeveralPlacesBesideSmallOnes) {
  Figure figure = small_figure("picture");
  figure.panels.resize(4, figure.panels.front());
  for (Panel& panel : figure.panels) panel.key = false;
  figure.columns = 2;
  figure.panels[0].tall = 2;
  figure.panels[3].wide = 2;
  const std::string script = gnuplot_script(figure);
  const auto tall = margins_of(script, 0);
  const auto upper = margins_of(script, 1);
  const auto lower = margins_of(script, 2);
  const auto wide = margins_of(script, 3);
  // Nine digits are written.
  constexpr double digits = 1e-8;
  EXPECT_NEAR(tall[2], upper[2], digits);
  EXPECT_NEAR(tall[3], lower[3], digits);
  EXPECT_LT(tall[1], upper[0]);
  EXPECT_LT(lower[2], upper[3]);
  EXPECT_LT(wide[2], lower[3]);
  EXPECT_NEAR(wide[0], tall[0], digits);
  EXPECT_NEAR(wide[1], upper[1], digits);
}

TEST(WriteScript, DrawsEqualAxesWithOneScale) {
  Figure figure = small_figure("picture");
  Panel& panel = figure.panels.front();
  figure.panels.pop_back();
  panel.x.logarithmic = false;
  panel.equal_axes = true;
  const std::string script = gnuplot_script(figure);
  const auto numbers = [&](const char* pattern) {
    std::smatch found;
    EXPECT_TRUE(std::regex_search(script, found, std::regex(pattern))) << pattern;
    return std::make_pair(std::stod(found[1]), std::stod(found[2]));
  };
  const auto [x_from, x_to] = numbers(R"(set xrange \[(\S+):(\S+)\])");
  const auto [y_from, y_to] = numbers(R"(set yrange \[(\S+):(\S+)\])");
  const auto [width, height] = numbers(R"(terminal svg size (\d+),(\d+))");
  const auto margins = margins_of(script, 0);
  const double x_unit = (x_to - x_from) / (width * (margins[1] - margins[0]));
  const double y_unit = (y_to - y_from) / (height * (margins[2] - margins[3]));
  // Nine digits of each number, of which the differences keep seven.
  EXPECT_NEAR(x_unit / y_unit, 1, 1e-6);
  // Nothing of the curves, 1 to 4 and 1 to 4.5, is cut off.
  EXPECT_LT(x_from, 1);
  EXPECT_GT(x_to, 4);
  EXPECT_LT(y_from, 1);
  EXPECT_GT(y_to, 4.5);
}

io::FrequencyResponseFile read_text(const std::string& text) {
  const TemporaryFolder folder;
  return io::read_frequency_response(folder.write("file.csv", text));
}

TEST(FieldOf, IsToldByNamesThenByUnits) {
  const std::pair<const char*, Field> headers[] = {{"f_hz,re_ohm,im_ohm", Field::impedance},
                                                   {"Freq/Hz,Z' (kOhm),Z'' (kOhm)", Field::impedance},
                                                   {"f_hz,re_S,im_S", Field::admittance},
                                                   {"omega (rad/s),G' (Pa),G'' (Pa)", Field::shear_modulus},
                                                   {"omega (rad/s),E' (MPa),E'' (MPa)", Field::tensile_modulus},
                                                   {"omega,re_kPa,im_kPa", Field::shear_modulus},
                                                   {"f (Hz),eps',eps''", Field::permittivity},
                                                   {"omega_rad_s,re_m_per_n,im_m_per_n", Field::transfer_function},
                                                   {"omega_rad_s,re,im", Field::transfer_function}};
  for (const auto& [header, field] : headers) {
    EXPECT_EQ(to_string(field_of(read_text(std::string(header) + "\n1,2,3\n2,3,4\n"))), to_string(field)) << header;
  }
}

TEST(NotationOf, KeepsThePrefixOfAUnit) {
  EXPECT_EQ(notation_of(Field::impedance, "kohm").unit, "kΩ");
  EXPECT_EQ(notation_of(Field::impedance, "ohm").unit, "Ω");
  EXPECT_EQ(notation_of(Field::shear_modulus, "MPa").unit, "MPa");
  EXPECT_EQ(notation_of(Field::transfer_function, "m_per_n").unit, "m_per_n");
  EXPECT_EQ(with_unit("Z", ""), "Z");
}

TEST(WriteScript, DrawsAMapOfCellsRowByRowFromTheLowest) {
  const TemporaryFolder folder;
  Figure figure;
  figure.name = "map";
  Panel panel;
  panel.key = true;
  panel.map = CellMap{1, 3, 0, 1, 3, {0, 1, 1, 2, 0, 1}, {{"a", "#000000"}, {"b", "#ff0000"}, {"c", "#00ff00"}}};
  figure.panels = {panel};
  const std::string script = gnuplot_script(figure);
  folder.write("map.gp", script);
  EXPECT_NE(script.find("$panel1_map << e\n0 1 1\n2 0 1\ne\n"), std::string::npos);
  // Centres 1, 2, 3 and 0, 1.
  EXPECT_NE(script.find("matrix using (1+$1*1):(0+$2*1):3 with image"), std::string::npos);
  const auto gnuplot = find_gnuplot();
  if (!gnuplot) GTEST_SKIP() << "gnuplot is not installed";
  EXPECT_EQ(draw(*gnuplot, folder.path(), "map"), "");
}

// Found by trying: in a block of commands gnuplot stumbles over '##\'\'' and the like.
TEST(WriteScript, AnyLabelIsDrawn) {
  const auto gnuplot = find_gnuplot();
  if (!gnuplot) GTEST_SKIP() << "gnuplot is not installed";
  const TemporaryFolder folder;
  support::Random random(20260);
  constexpr std::string_view odd("'\"{}#\\$@`%;,()[]|!\0", 19);
  for (int i = 0; i < 12; ++i) {
    Figure figure = small_figure("picture");
    std::string label;
    for (int k = 0; k < 12; ++k) label += odd[random.below(odd.size())];
    figure.panels.front().title = enhanced_escape(label);
    figure.panels.front().y.label = enhanced_escape("##'" + label);
    folder.write("picture.gp", gnuplot_script(figure));
    EXPECT_EQ(draw(*gnuplot, folder.path(), "picture"), "") << label;
  }
}

TEST(Draw, EndsAProgramThatHangsWithAllItHasStarted) {
  const TemporaryFolder folder;
  const std::string program = folder.write("gnuplot", "#!/bin/sh\nsleep 1000 &\necho $! > child\nwait\n");
  ::chmod(program.c_str(), 0755);
  const std::string trouble = draw(program, folder.path(), "picture", std::chrono::milliseconds(300));
  EXPECT_NE(trouble.find("did not finish picture.gp"), std::string::npos) << trouble;
  // The signal reaches the grandchild a moment later.
  const int child = std::stoi(content_of(folder.path("child")));
  const auto is_alive = [&] {
    std::ifstream status("/proc/" + std::to_string(child) + "/stat");
    std::string text;
    return std::getline(status, text) && text.find(") Z ") == std::string::npos;
  };
  for (int i = 0; i < 1000 && is_alive(); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  EXPECT_FALSE(is_alive());
}

TEST(Draw, NoticesAPictureThatStopsInTheMiddle) {
  const TemporaryFolder folder;
  const std::string program = folder.write(
      "gnuplot", "#!/bin/sh\nprintf '<svg><path' > picture.svg\nprintf 'PNG..IEND' > picture.png\nexit 0\n");
  ::chmod(program.c_str(), 0755);
  EXPECT_NE(draw(program, folder.path(), "picture").find("made no whole picture"), std::string::npos);
}

TEST(FindGnuplot, FindsNothingOnAnEmptyPathAndSkipsWhatCannotRun) {
  const TemporaryFolder folder;
  folder.write("gnuplot", "not executable");
  {
    const SearchPath nothing("");
    EXPECT_FALSE(find_gnuplot());
  }
  const SearchPath here(":" + folder.path() + ":");
  // A plain file without the executable bit is no program.
  EXPECT_FALSE(find_gnuplot());
}

TEST(Draw, SaysWhatAProgramThatFailsHadToSay) {
  const TemporaryFolder folder;
  const std::string program = folder.write("gnuplot", "#!/bin/sh\necho 'line 7: undefined variable'\nexit 3\n");
  ::chmod(program.c_str(), 0755);
  const std::string trouble = draw(program, folder.path(), "picture");
  EXPECT_NE(trouble.find("picture.gp"), std::string::npos) << trouble;
  EXPECT_NE(trouble.find("line 7: undefined variable"), std::string::npos) << trouble;
}

TEST(Draw, NoticesThatASuccessfulProgramMadeNoPicture) {
  const TemporaryFolder folder;
  const std::string program = folder.write("gnuplot", "#!/bin/sh\n: > picture.svg\nexit 0\n");
  ::chmod(program.c_str(), 0755);
  EXPECT_NE(draw(program, folder.path(), "picture").find("made no whole picture"), std::string::npos);
}

TEST(Draw, NoticesThatAProgramCannotBeStarted) {
  const TemporaryFolder folder;
  EXPECT_NE(draw(folder.path("missing"), folder.path(), "picture").find("cannot be started"), std::string::npos);
}

TEST(Draw, MakesBothPicturesWithTheRealProgram) {
  const auto gnuplot = find_gnuplot();
  if (!gnuplot) GTEST_SKIP() << "gnuplot is not installed";
  const TemporaryFolder folder;
  folder.write("picture.gp", gnuplot_script(small_figure("picture")));
  EXPECT_EQ(draw(*gnuplot, folder.path(), "picture"), "");
  EXPECT_EQ(content_of(folder.path("picture.png")).substr(1, 3), "PNG");
  const std::string svg = inline_svg(content_of(folder.path("picture.svg")), "p-");
  const std::string id = "[\\s]id=['\"]([^'\"]+)['\"]";
  const std::set<std::string> ids = all_matches(svg, id);
  EXPECT_FALSE(ids.empty());
  for (const std::string& name : ids) EXPECT_EQ(name.rfind("p-", 0), 0U) << name;
  for (const std::string& name : all_matches(svg, "(?:href=['\"]#|url\\(#)([^'\")]+)")) {
    EXPECT_EQ(ids.count(name), 1U) << name;
  }
}

TEST(CsvText, ReadsBackWithTheSameValues) {
  const double third = 1.0 / 3;
  const Table table{"t",
                    "caption",
                    {{"name", "n"}, {"value", "v"}},
                    {{std::string("a, b; c"), third}, {std::string("d"), std::nan("")}}};
  const TemporaryFolder folder;
  const std::string file = folder.write("t.csv", csv_text(table, {{"command", "fracfit report\n--out x"}}));
  const io::TextTable read(file);
  ASSERT_EQ(read.header().size(), 2U);
  EXPECT_EQ(read.header()[1].text, "value");
  EXPECT_EQ(io::find_value(read.metadata(), "command"), "fracfit report --out x");
  std::vector<double> values;
  read.for_each_row([&](const io::TextTable::Row& row) { values.push_back(io::parse_number(row.fields[1]).value()); });
  ASSERT_EQ(values.size(), 2U);
  EXPECT_EQ(values[0], third);
  EXPECT_TRUE(std::isnan(values[1]));
}

backlash::DescribingFunctionPoint point(double omega, backlash::Regime regime, int period, double impacts) {
  return {omega, {-1 / omega, 0.1}, regime, period, impacts, 0.01, 0};
}

TEST(SweepCurves, NeverJoinAcrossAJumpOrToALongTimeMean) {
  using backlash::Regime;
  const backlash::TwoMassSystem system(1, 1, 0.3, 0.6);
  const backlash::DescribingFunctionSweep sweep{
      system,
      40,
      {},
      {point(1, Regime::chatter, 1, INFINITY), point(2, Regime::chatter, 1, INFINITY),
       point(3, Regime::averaged, 0, 3.2), point(4, Regime::periodic, 1, 3), point(5, Regime::periodic, 1, 2),
       point(6, Regime::symmetric, 1, 2)}};
  const auto curves = sweep_curves(sweep, "label", "#000000", [](const auto& p) {
    return std::optional<PlotPoint>(
        {p.omega, p.value.real(), p.value.real() - p.uncertainty, p.value.real() + p.uncertainty});
  });
  std::map<Mark, std::vector<std::size_t>> lengths;
  for (const Curve& curve : curves) {
    for (const auto& segment : curve.segments) lengths[curve.mark].push_back(segment.size());
  }
  EXPECT_EQ(lengths[Mark::line], (std::vector<std::size_t>{2, 2}));
  EXPECT_EQ(lengths[Mark::points], (std::vector<std::size_t>{1}));
  EXPECT_EQ(lengths[Mark::faint_points], (std::vector<std::size_t>{1}));
}

TEST(NegativeInverse, CarriesTheUncertaintyAndHasNoValueWhereNothingMoves) {
  backlash::DescribingFunctionPoint p = point(2, backlash::Regime::symmetric, 1, 2);
  p.value = {-0.5, 0};
  p.uncertainty = 1e-3;
  const auto inverse = negative_inverse(p);
  ASSERT_TRUE(inverse);
  EXPECT_DOUBLE_EQ(inverse->value.real(), 2);
  // d(1/N) = dN/N^2.
  EXPECT_DOUBLE_EQ(inverse->uncertainty, 4e-3);
  p.value = 0;
  EXPECT_FALSE(negative_inverse(p));
}

// U at gamma = 0.3, eps = 0.6 from the closed form of the symmetric orbit in quadruple precision; N1 = -(1 +
// U/gamma)/(M1 + M2) at omega = 1.  The method is first order: a quarter of the step leaves a quarter of the error. The
// error of a single step size scatters by where the impact falls within its step, hence the wide bracket.
TEST(FixedStepReference, ConvergesToTheClosedFormWithFirstOrder) {
  const FixedStepScene scene{1, 1, 1, 0.6, 0.3};
  const std::complex<double> relative(0.27179811, -0.25733052);
  const std::complex<double> exact = -(1.0 + relative / 0.3) / 2.0;
  const auto error = [&](std::size_t steps) {
    return std::abs(fixed_step_describing_function(scene, 1, steps, 80, 20) - exact) / std::abs(exact);
  };
  const double coarse = error(512);
  const double fine = error(8192);
  EXPECT_LT(coarse, 0.03);
  const double order = std::log2(coarse / fine) / 4;
  EXPECT_NEAR(order, 1, 0.2);
}

TEST(PaperScene, HoldsTheFamiliesOfTheFigures) {
  const Scene scene = paper_scene();
  EXPECT_EQ(scene.forces, (std::vector<double>{10, 20, 30, 40, 50}));
  EXPECT_EQ(scene.clearances, (std::vector<double>{0, 0.1, 0.2, 0.3, 0.4, 0.5}));
  EXPECT_EQ(scene.restitutions, (std::vector<double>{0, 0.2, 0.4, 0.6, 0.8, 1}));
  EXPECT_EQ(scene.jump_clearances, (std::vector<double>{0.01, 0.025, 0.05, 0.1, 0.2, 0.3, 0.4, 0.5}));
  EXPECT_EQ(scene.omega_bode.front(), 0.5);
  EXPECT_EQ(scene.omega_family.back(), 35);
}

TEST(ReadScene, TakesNumbersListsAndGrids) {
  const TemporaryFolder folder;
  const Scene scene = read_scene(folder.write(
      "scene.json", R"({"m1": 2, "clearance": [0, 0.2], "restitution": 0.5, "force": [10, 30], "omega": "1:9:5"})"));
  EXPECT_EQ(scene.mass1, 2);
  EXPECT_EQ(scene.mass2, 1);
  EXPECT_EQ(scene.clearance, 0.2);
  EXPECT_EQ(scene.jump_clearances, (std::vector<double>{0.2}));
  EXPECT_EQ(scene.force, 10);
  EXPECT_EQ(scene.omega_bode, (std::vector<double>{1, 3, 5, 7, 9}));
}

TEST(ReadScene, TakesTheMassesUnderTheNamesOfTheCommandLine) {
  const TemporaryFolder folder;
  const std::string rest = R"("clearance": 0.2, "restitution": 0.5, "force": 10, "omega": "1:9:5"})";
  const Scene scene = read_scene(folder.write("scene.json", R"({"mass1": 2, "mass2": 3, )" + rest));
  EXPECT_EQ(scene.mass1, 2);
  EXPECT_EQ(scene.mass2, 3);
  EXPECT_THROW(static_cast<void>(read_scene(folder.write("twice.json", R"({"mass1": 2, "m1": 2, )" + rest))),
               io::DataError);
}

TEST(ReadScene, NamesTheMemberThatIsWrong) {
  const std::vector<std::pair<std::string, std::string>> cases = {
      {R"({"clearance": 0.3, "restitution": 0.6, "omega": "1:9:5"})", "\"force\" is missing"},
      {R"({"clearance": -1, "restitution": 0.6, "force": 1, "omega": "1:9:5"})", "\"clearance\" holds -1"},
      {R"({"clearance": 1, "restitution": 1.5, "force": 1, "omega": "1:9:5"})", "\"restitution\" holds 1.5"},
      {R"({"clearance": 1, "restitution": "high", "force": 1, "omega": "1:9:5"})", "\"restitution\" holds \"high\""},
      {R"({"clearance": 1, "restitution": 1, "force": [], "omega": "1:9:5"})", "\"force\" is an empty list"},
      {R"({"clearance": 1, "restitution": 1, "force": [5, 5], "omega": "1:9:5"})", "\"force\" holds 5 twice"},
      {R"({"clearance": 1, "restitution": 1, "force": 1, "omega": [3, 2, 4, 5, 6]})", "\"omega\" holds 2 after 3"},
      {R"({"clearance": 1, "restitution": 1, "force": 1, "omega": [0, 2, 4, 5, 6]})", "\"omega\" holds 0"},
      {R"({"clearance": 1, "restitution": 1, "force": 1, "omega": [1, 2]})", "\"omega\" has 2 entries"},
      {R"({"clearance": 1, "restitution": 1, "force": 1, "omega": "1:9"})", "omega"},
      {R"({"clearance": 1, "restitution": 1, "force": 1, "omega": "1:9:5", "gap": 2})", "unknown member \"gap\""},
      {R"({"m1": [1, 2], "clearance": 1, "restitution": 1, "force": 1, "omega": "1:9:5"})", "\"m1\" is a list"},
      {R"([1, 2])", "expected an object"},
      {R"({"clearance": )", "scene.json:1:15: is not JSON: it ends too early"},
      {"{\"clearance\":\n  ?1}", "scene.json:2:3: is not JSON: cannot go on with '?'"},
  };
  const TemporaryFolder folder;
  for (const auto& [text, expected] : cases) {
    const std::string file = folder.write("scene.json", text);
    try {
      static_cast<void>(read_scene(file));
      ADD_FAILURE() << text;
    } catch (const io::DataError& error) {
      EXPECT_NE(std::string(error.what()).find(expected), std::string::npos) << error.what();
    }
  }
  EXPECT_THROW(static_cast<void>(read_scene(folder.path("missing.json"))), io::DataError);
}

TEST(StagedFolder, LeavesNothingBehindUnlessPublished) {
  const TemporaryFolder folder;
  {
    const StagedFolder staged(folder.path("new/report"));
    staged.write("tables/a.csv", "a\n1\n");
  }
  EXPECT_FALSE(fs::exists(folder.path("new/report")));
}

TEST(StagedFolder, PublishesFilesAndKeepsWhatElseIsThere) {
  const TemporaryFolder folder;
  folder.write("notes.txt", "mine");
  folder.write("index.html", "old");
  StagedFolder staged(folder.path());
  staged.write("tables/a.csv", "a\n1\n");
  staged.write("index.html", "new");
  EXPECT_EQ(content_of(folder.path("index.html")), "old");
  staged.publish("index.html");
  EXPECT_EQ(content_of(folder.path("index.html")), "new");
  EXPECT_EQ(content_of(folder.path("tables/a.csv")), "a\n1\n");
  EXPECT_EQ(content_of(folder.path("notes.txt")), "mine");
}

TEST(StagedFolder, RefusesAFileInPlaceOfTheFolder) {
  const TemporaryFolder folder;
  const std::string file = folder.write("report", "");
  EXPECT_THROW(StagedFolder(fs::path(file)), std::invalid_argument);
  EXPECT_THROW(StagedFolder(fs::path(file) / "below"), std::invalid_argument);
}

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

TEST(WriteReport, WritesAllNumbersAndSaysWhatToInstallWithoutGnuplot) {
  const SearchPath nothing("");
  const TemporaryFolder folder;
  ReportOptions options;
  options.out = folder.path("out");
  options.data = {folder.write("lag <1>.csv", fractional_lag_csv())};
  const ReportOutcome outcome = write_report(options);
  EXPECT_FALSE(outcome.pictures);
  EXPECT_NE(outcome.message.find("gnuplot-nox"), std::string::npos) << outcome.message;
  expect_complete(options.out, false);
  const std::string page = content_of(outcome.index.string());
  EXPECT_NE(page.find("apt-get install gnuplot-nox"), std::string::npos);
  EXPECT_NE(page.find("lag &lt;1&gt;.csv"), std::string::npos);
  EXPECT_EQ(page.find("lag <1>.csv"), std::string::npos);
  EXPECT_TRUE(fs::exists(options.out / "figures/data-1.gp"));
}

TEST(WriteReport, FindsTheStructureThatMadeTheData) {
  const SearchPath nothing("");
  const TemporaryFolder folder;
  ReportOptions options;
  options.out = folder.path("out");
  options.data = {folder.write("lag.csv", fractional_lag_csv())};
  static_cast<void>(write_report(options));
  const auto json = nlohmann::json::parse(content_of(folder.path("out/results.json")));
  EXPECT_EQ(json.at("facts").at("verdict_data-1"), "supported");
  std::optional<double> order;
  const io::TextTable table(folder.path("out/tables/data-1-parameters.csv"));
  table.for_each_row([&](const io::TextTable::Row& row) {
    if (row.fields[1] == "K/(T s^a + 1)" && row.fields[2] == "a") order = io::parse_number(row.fields[3]);
  });
  ASSERT_TRUE(order);
  // Six digits per value leave the order uncertain by about 1e-6.
  EXPECT_NEAR(*order, 0.7, 1e-5);
}

// The response of the lag with its real part times three at one frequency, as an instrument that slips a range writes
// it: the page names the frequency, and the order is that of the other points.
TEST(WriteReport, LeavesOutWhatItsNeighboursContradict) {
  const SearchPath nothing("");
  const TemporaryFolder folder;
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
  ReportOptions options;
  options.out = folder.path("out");
  options.data = {folder.write("lag.csv", text)};
  static_cast<void>(write_report(options));
  const std::string page = content_of(folder.path("out/index.html"));
  const auto named = page.find("Left out, because they contradict their neighbours");
  ASSERT_NE(named, std::string::npos);
  EXPECT_NE(page.substr(named, 120).find(frequency.substr(0, 4)), std::string::npos) << frequency;
  EXPECT_EQ(nlohmann::json::parse(content_of(folder.path("out/results.json"))).at("facts").at("verdict_data-1"),
            "supported");
}

// 1/((s + 1)(2 s + 1)(0.3 s + 1)) with 1 % of seeded noise.  No preset has three different lags: where only presets
// compete, a fractional one wins.  The truth is a ratio with three poles.
TEST(WriteReport, LetsRationalModelsCompete) {
  const SearchPath nothing("");
  const TemporaryFolder folder;
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
  ReportOptions options;
  options.out = folder.path("out");
  options.data = {folder.write("lags.csv", text)};
  static_cast<void>(write_report(options));
  const auto json = nlohmann::json::parse(content_of(folder.path("out/results.json")));
  EXPECT_EQ(json.at("facts").at("verdict_data-1"), "not-supported");
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
  const SearchPath nothing("");
  const TemporaryFolder folder;
  ReportOptions options;
  options.out = folder.path("out");
  const std::string file = folder.write("arc.csv", arc_csv());
  options.data = {file};
  static_cast<void>(write_report(options));
  const auto json = nlohmann::json::parse(content_of(folder.path("out/results.json")));
  EXPECT_EQ(json.at("facts").at("quantity_data-1"), "impedance");
  const std::string script = content_of(folder.path("out/figures/data-1.gp"));
  EXPECT_NE(script.find("set xlabel 'Z′ in Ω'"), std::string::npos);
  EXPECT_NE(script.find("set ylabel '−Z″ in Ω'"), std::string::npos);
  EXPECT_NE(script.find("set xlabel 'f in Hz'"), std::string::npos);

  // The values of the pictures are those of the file.
  const io::TextTable written(file);
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

  // The verdict stands in the frame of the picture, the intervals in a table of their own.
  const std::string page = content_of(folder.path("out/index.html"));
  const std::size_t figure = page.find("<figure id=\"figure-data-1\"");
  const std::size_t verdict = page.find("class=\"verdict\"", figure);
  ASSERT_NE(figure, std::string::npos);
  EXPECT_LT(verdict, page.find("</figure>", figure));
  const auto& parameters = json.at("tables").at("data-1-chosen");
  ASSERT_FALSE(parameters.empty());
  for (const auto& parameter : parameters) {
    EXPECT_LT(parameter.at("ci95_lower").get<double>(), parameter.at("value").get<double>());
    EXPECT_GT(parameter.at("ci95_upper").get<double>(), parameter.at("value").get<double>());
  }

  options.field = Field::transfer_function;
  static_cast<void>(write_report(options));
  const std::string changed = content_of(folder.path("out/figures/data-1.gp"));
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

TEST(FigureData, KeepsEveryDigitAndEndsNoElement) {
  Figure figure = small_figure("picture");
  figure.panels.front().curves.front().label = "</script><b>";
  figure.panels.front().curves.front().segments.front().front() = {0.1 + 0.2, 1.0 / 3, 1.0 / 3, 1.0 / 3, 7};
  const std::string text = figure_data(figure);
  EXPECT_EQ(text.find('<'), std::string::npos);
  const auto json = nlohmann::json::parse(text);
  const auto& curve = json.at("panels").at(0).at("curves").at(0);
  EXPECT_EQ(curve.at("label"), "</script><b>");
  const auto point = curve.at("segments").at(0).at(0).get<std::vector<double>>();
  EXPECT_EQ(point, (std::vector<double>{0.1 + 0.2, 1.0 / 3, 1.0 / 3, 1.0 / 3, 7}));
  EXPECT_EQ(json.at("panels").at(0).at("curves").at(1).at("segments").at(0).at(0).size(), 2U);
}

TEST(WriteReport, GivesTheScriptTheValuesOfTheResults) {
  const SearchPath nothing("");
  const TemporaryFolder folder;
  ReportOptions options;
  options.out = folder.path("out");
  options.data = {folder.write("arc.csv", arc_csv())};
  static_cast<void>(write_report(options));
  const std::string page = content_of(folder.path("out/index.html"));
  expect_complete(options.out, false);
  EXPECT_NE(page.find("default-src 'none'"), std::string::npos);
  const auto figures = figures_in(page);
  ASSERT_EQ(figures.size(), 2U) << "response and residuals";
  const auto json = nlohmann::json::parse(content_of(folder.path("out/results.json")));
  const auto& rows = json.at("tables").at("data-1-curves");
  // The data are the last curve of the Nyquist panel.
  const auto& points = figures[0].at("panels").at(0).at("curves").back().at("segments").at(0);
  const auto& residuals = figures[1].at("panels").at(0).at("curves").back().at("segments").at(0);
  ASSERT_EQ(points.size(), rows.size());
  ASSERT_EQ(residuals.size(), rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    EXPECT_EQ(points[i][0], rows[i].at("re"));
    EXPECT_EQ(points[i][1].get<double>(), -rows[i].at("im").get<double>());
    EXPECT_EQ(points[i][4], rows[i].at("f_hz")) << "what other panels find the point by";
    EXPECT_EQ(residuals[i][0], rows[i].at("f_hz"));
    EXPECT_EQ(residuals[i][1], rows[i].at("residual_magnitude_percent"));
  }
}

TEST(WriteReport, ShowsAModulusAsStorageAndLoss) {
  const SearchPath nothing("");
  const TemporaryFolder folder;
  std::string text = "omega (rad/s),G' (Pa),G'' (Pa)\n";
  for (int i = 0; i < 20; ++i) {
    const double omega = std::pow(10.0, -1 + 3.0 * i / 19);
    const std::complex<double> modulus = 20.0 * std::pow(std::complex<double>(0, omega), 0.4);
    char line[128];
    std::snprintf(line, sizeof line, "%.6g,%.6g,%.6g\n", omega, modulus.real(), modulus.imag());
    text += line;
  }
  ReportOptions options;
  options.out = folder.path("out");
  options.data = {folder.write("gel.csv", text)};
  static_cast<void>(write_report(options));
  const std::string script = content_of(folder.path("out/figures/data-1.gp"));
  EXPECT_NE(script.find("set ylabel 'G′, G″ in Pa'\nset logscale y"), std::string::npos);
  EXPECT_NE(script.find("'data, G″'"), std::string::npos);
  EXPECT_NE(script.find("set ylabel 'G″/G′'"), std::string::npos);
}

// Step response 2 - 2 exp(-t) + 1 of 2/(s + 1), six digits: a lag, and no fractional order.
TEST(WriteReport, TakesSamplesOverTime) {
  const SearchPath nothing("");
  const TemporaryFolder folder;
  std::string text = "time_s,input,output\n";
  for (int n = 0; n <= 24; ++n) {
    text += std::to_string(0.2 * n) + ",1," + std::to_string(1 - 2 * std::expm1(-0.2 * n)) + "\n";
  }
  ReportOptions options;
  options.out = folder.path("out");
  options.data = {folder.write("step.csv", text)};
  static_cast<void>(write_report(options));
  const auto json = nlohmann::json::parse(content_of(folder.path("out/results.json")));
  EXPECT_EQ(json.at("facts").at("verdict_data-1"), "not-supported");
  EXPECT_NE(content_of(folder.path("out/figures/data-1.gp")).find("Residuals"), std::string::npos);
  std::optional<double> offset;
  const io::TextTable table(folder.path("out/tables/data-1-parameters.csv"));
  table.for_each_row([&](const io::TextTable::Row& row) {
    if (row.fields[1] == "K/(T s + 1)" && row.fields[2] == "offset") offset = io::parse_number(row.fields[3]);
  });
  ASSERT_TRUE(offset);
  EXPECT_NEAR(*offset, 1, 1e-5);
}

}  // namespace
