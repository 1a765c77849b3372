// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <chrono>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "io/frequency_response_file.hpp"
#include "report/field.hpp"
#include "report/figure.hpp"
#include "report/figure_data.hpp"
#include "report/html.hpp"
#include "report/timing.hpp"
#include "report_support.hpp"
#include "support/random.hpp"
#include "temporary_folder.hpp"

namespace {

using namespace report;

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

// A thread that sleeps for 2 ms takes some 0.05 ms of a processor: what others do in the meantime is not counted.
TEST(MedianSeconds, AreThoseOfTheProcessor) {
  const double seconds = median_seconds([] { std::this_thread::sleep_for(std::chrono::milliseconds(2)); });
  EXPECT_GT(seconds, 0);
  EXPECT_LT(seconds, 1e-3);
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
                                                   {"# quantity: minus-inverse\nomega,re,im", Field::minus_inverse},
                                                   {"omega_rad_s,re,im", Field::transfer_function}};
  for (const auto& [header, field] : headers) {
    EXPECT_EQ(to_string(field_of(read_text(std::string(header) + "\n1,2,3\n2,3,4\n"))), to_string(field)) << header;
  }
}

TEST(NotationOf, KeepsThePrefixOfAUnit) {
  const auto unit = [](Field field, const char* of_file) {
    return notation_of(field, of_file, frac::FrequencyUnit::hertz).unit;
  };
  EXPECT_EQ(unit(Field::impedance, "kohm"), "kΩ");
  EXPECT_EQ(unit(Field::impedance, "ohm"), "Ω");
  EXPECT_EQ(unit(Field::shear_modulus, "MPa"), "MPa");
  EXPECT_EQ(unit(Field::transfer_function, "m_per_n"), "m/N");
  EXPECT_EQ(with_unit("Z", ""), "Z");
}

// Spectra are read over Hz whatever the file has; elsewhere the file decides.
TEST(NotationOf, TakesTheFrequencyAsReadersOfTheFieldDo) {
  for (const auto file : {frac::FrequencyUnit::hertz, frac::FrequencyUnit::rad_per_s}) {
    for (const Field field : {Field::impedance, Field::admittance, Field::permittivity})
      EXPECT_EQ(notation_of(field, "", file).axis_label(), "f in Hz");
    for (const Field field : {Field::shear_modulus, Field::tensile_modulus, Field::transfer_function})
      EXPECT_EQ(notation_of(field, "", file).axis, file);
  }
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
  EXPECT_EQ(draw(*gnuplot, folder.path(), {"map"}), "");
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
    EXPECT_EQ(draw(*gnuplot, folder.path(), {"picture"}), "") << label;
  }
}

TEST(Draw, EndsAProgramThatHangsWithAllItHasStarted) {
  const TemporaryFolder folder;
  const std::string program = folder.write("gnuplot", "#!/bin/sh\nsleep 1000 &\necho $! > child\nwait\n");
  ::chmod(program.c_str(), 0755);
  const std::string trouble = draw(program, folder.path(), {"picture"}, std::chrono::milliseconds(300));
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
  EXPECT_NE(draw(program, folder.path(), {"picture"}).find("made no whole picture"), std::string::npos);
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
  const std::string trouble = draw(program, folder.path(), {"picture"});
  EXPECT_NE(trouble.find("picture.gp"), std::string::npos) << trouble;
  EXPECT_NE(trouble.find("line 7: undefined variable"), std::string::npos) << trouble;
}

TEST(Draw, NoticesThatASuccessfulProgramMadeNoPicture) {
  const TemporaryFolder folder;
  const std::string program = folder.write("gnuplot", "#!/bin/sh\n: > picture.svg\nexit 0\n");
  ::chmod(program.c_str(), 0755);
  EXPECT_NE(draw(program, folder.path(), {"picture"}).find("made no whole picture"), std::string::npos);
}

TEST(Draw, NoticesThatAProgramCannotBeStarted) {
  const TemporaryFolder folder;
  EXPECT_NE(draw(folder.path("missing"), folder.path(), {"picture"}).find("cannot be started"), std::string::npos);
}

TEST(Draw, MakesBothPicturesWithTheRealProgram) {
  const auto gnuplot = find_gnuplot();
  if (!gnuplot) GTEST_SKIP() << "gnuplot is not installed";
  const TemporaryFolder folder;
  folder.write("picture.gp", gnuplot_script(small_figure("picture")));
  EXPECT_EQ(draw(*gnuplot, folder.path(), {"picture"}), "");
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

}  // namespace
