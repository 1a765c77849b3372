// SPDX-License-Identifier: BSD-3-Clause
// Pictures are read back as a reader does: the ends of a curve whose values are known calibrate both axes of the drawn
// box, and every label must then stand at the value that it says.
#include "report/axis_ticks.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "report/figure.hpp"
#include "support/random.hpp"
#include "temporary_folder.hpp"

namespace {

using namespace report;

struct Mark2D {
  double x, y;
};

struct Drawn {
  struct Label {
    double value;
    Mark2D mark, text;  // px
    double width;       // px of the text
  };
  std::vector<Label> labels[2];  // of x and of y
  std::vector<Mark2D> small[2];
  Mark2D first, last;  // ends of the curve, px
};

// "−1.5×10" with a raised "−3", or a plain number; NaN for other texts.
double number_of(const std::string& group, double& width) {
  std::string text, raised;
  const std::regex part(R"(<tspan([^>]*)>([^<]*)</tspan>)");
  std::sregex_iterator it(group.begin(), group.end(), part);
  if (it == std::sregex_iterator()) {
    std::smatch plain;
    if (std::regex_search(group, plain, std::regex("<text>([^<]*)</text>"))) text = plain[1];
  }
  for (; it != std::sregex_iterator(); ++it)
    ((*it)[1].str().find("dy=\"-") != std::string::npos ? raised : text) += (*it)[2];
  const auto ascii = [](std::string number) { return std::regex_replace(number, std::regex("\u2212"), "-"); };
  text = ascii(text);
  raised = ascii(raised);
  // A digit of Helvetica is 0.556 of its height wide, a point half of that; raised ones are smaller.
  const auto points = static_cast<double>(std::count(text.begin(), text.end(), '.'));
  width = 13 * 0.556 * (static_cast<double>(text.size()) - points / 2 + 0.8 * static_cast<double>(raised.size()));
  const std::string times =
      "\u00d7"
      "10";
  if (!raised.empty()) {
    if (text == "10") return std::stod("1e" + raised);
    const std::size_t at = text.find(times);
    return at == std::string::npos ? std::nan("") : std::stod(text.substr(0, at) + "e" + raised);
  }
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  return text.empty() || *end != '\0' ? std::nan("") : value;
}

// Panels of a picture in the order in which they were drawn.
std::vector<Drawn> panels_of(const std::string& svg) {
  std::vector<Drawn> panels(1);
  const std::regex tick(R"(<path stroke='[^']*'  d='M(\S+),(\S+) L(\S+),(\S+)\s+'/>)");
  const std::regex place(R"(translate\(([^,]+),([^)]+)\))");
  const std::regex line(R"(d='M(\S+),(\S+) L(\S+),(\S+))");
  std::istringstream lines(svg);
  std::string text;
  while (std::getline(lines, text)) {
    std::smatch found;
    if (text.find("gnuplot_plot_") != std::string::npos) {
      // The curve follows; what was read so far belongs to its axes.
      while (std::getline(lines, text) && !std::regex_search(text, found, line)) {
      }
      panels.back().first = {std::stod(found[1]), std::stod(found[2])};
      panels.back().last = {std::stod(found[3]), std::stod(found[4])};
      panels.emplace_back();
    } else if (std::regex_search(text, found, tick)) {
      const Mark2D from{std::stod(found[1]), std::stod(found[2])};
      const bool vertical = found[2] == found[4];  // a tick of the vertical axis lies
      if (std::regex_search(text, found, place)) {
        const Mark2D at{std::stod(found[1]), std::stod(found[2])};
        std::getline(lines, text);
        double width = 0;
        const double value = number_of(text, width);
        panels.back().labels[vertical].push_back({value, from, at, width});
      } else {
        panels.back().small[vertical].push_back(from);
      }
    }
  }
  panels.pop_back();
  return panels;
}

// An axis and the values at the two ends of the curve.
struct Asked {
  Axis axis;
  double first, last;
};

Asked random_axis(support::Random& random, bool linear) {
  Asked asked{{"", !linear && random.below(2) == 0}, 0, 0};
  if (asked.axis.logarithmic) {
    asked.first = random.log_uniform(1e-12, 1e12);
    // From a part of a decade too short for six digits to twenty decades.
    asked.last = asked.first * std::pow(10, random.log_uniform(1e-6, 20));
    if (random.below(3) == 0) asked.axis.from = asked.first * std::pow(asked.last / asked.first, -random.unit());
    if (random.below(3) == 0) asked.axis.to = asked.last * std::pow(asked.last / asked.first, random.unit());
    if (!asked.axis.from && !asked.axis.to && random.below(10) == 0)
      asked.last = asked.first = std::pow(10, std::round(std::log10(asked.first)));
  } else {
    asked.axis.degrees = random.below(3) == 0;
    const double span = asked.axis.degrees ? random.log_uniform(0.1, 3000) : random.log_uniform(1e-9, 1e9);
    const double offset = random.below(3) == 0 ? 0 : random.log_uniform(1e-2, asked.axis.degrees ? 10 : 1e7);
    asked.first = span * (random.below(2) == 0 ? offset : -offset);
    asked.last = asked.first + span;
  }
  return asked;
}

double scaled(const Asked& asked, double value) {
  return asked.axis.logarithmic ? std::log(value) : value;
}

// Coordinates have two decimals.  Where a curve spans a part of its axis only, the error of its ends is stretched.
double pixel(double place, double from, double to) {
  return 0.02 + 0.01 * (1 + std::abs(place - from) / std::abs(to - from));
}

void expect_true_axis(const Asked& asked, const Drawn& drawn, bool vertical) {
  const auto coordinate = [vertical](const Mark2D& mark) { return vertical ? mark.y : mark.x; };
  const auto& labels = drawn.labels[vertical];
  ASSERT_GE(labels.size(), 2U);
  EXPECT_LE(labels.size(), 13U);
  const double first = scaled(asked, asked.first);
  const double last = scaled(asked, asked.last);
  const double from = coordinate(drawn.first);
  const double to = coordinate(drawn.last);
  std::set<double> values;
  for (const Drawn::Label& label : labels) {
    ASSERT_TRUE(std::isfinite(label.value));
    EXPECT_TRUE(values.insert(label.value).second) << label.value << " stands twice";
    // A constant has no second point; its own value is then the only known place.
    if (first != last) {
      const double place = from + (scaled(asked, label.value) - first) / (last - first) * (to - from);
      EXPECT_NEAR(coordinate(label.mark), place, pixel(place, from, to)) << label.value;
    } else if (label.value == asked.first) {
      EXPECT_NEAR(coordinate(label.mark), from, 0.02);
    }
    // The text stands at its tick: centred, or its base line a third of its height below.
    EXPECT_NEAR(coordinate(label.text), coordinate(label.mark) + (vertical ? 13.0 / 3 : 0), vertical ? 1 : 0.02);
  }
  for (std::size_t i = 1; i < labels.size(); ++i) {
    const double free = std::abs(coordinate(labels[i].mark) - coordinate(labels[i - 1].mark));
    const double wide = (labels[i].width + labels[i - 1].width) / 2;
    EXPECT_GE(free, vertical ? 13 : wide) << labels[i].value;
  }
  // Small ticks stand at 1 to 9 in their decade, but on a part of one between labels.
  if (!asked.axis.logarithmic || last - first < std::log(10)) return;
  for (const Mark2D& mark : drawn.small[vertical]) {
    const double logarithm = (first + (coordinate(mark) - from) / (to - from) * (last - first)) / std::log(10);
    const double mantissa = std::pow(10, logarithm - std::floor(logarithm));
    const double error = pixel(coordinate(mark), from, to) / std::abs(to - from) * (last - first) * mantissa;
    EXPECT_LE(std::abs(mantissa - std::round(mantissa)), error + 1e-9) << logarithm;
  }
}

TEST(AxisTicks, ADrawnPictureReadsBackAsItsData) {
  const auto gnuplot = find_gnuplot();
  if (!gnuplot) GTEST_SKIP() << "gnuplot is not installed";
  support::Random random(20261126);
  const TemporaryFolder folder;
  std::vector<std::vector<std::pair<Asked, Asked>>> asked(200);
  std::string all;
  for (std::size_t i = 0; i < asked.size(); ++i) {
    Figure figure;
    figure.name = "figure" + std::to_string(i);
    figure.columns = static_cast<int>(1 + random.below(3));
    figure.panel_height = static_cast<int>(160 + random.below(240));
    for (int p = 0; p < 6; ++p) {
      Panel panel;
      panel.equal_axes = random.below(8) == 0;
      const Asked x = random_axis(random, panel.equal_axes);
      const Asked y = random_axis(random, panel.equal_axes);
      panel.x = x.axis;
      panel.y = y.axis;
      panel.curves = {make_curve("", "#0072b2", Mark::line, {x.first, x.last}, {y.first, y.last})};
      // A curve of one point is not drawn.
      if (x.first == x.last && y.first == y.last) continue;
      // Equal axes of very unequal spans leave a point of one of the two.
      if (panel.equal_axes && std::abs(std::log((x.last - x.first) / (y.last - y.first))) > std::log(10)) continue;
      figure.panels.push_back(panel);
      asked[i].emplace_back(x, y);
    }
    all += std::regex_replace(gnuplot_script(figure), std::regex("in 'svg png'"), "in 'svg'") + "\nreset\n";
  }
  folder.write("all.gp", all);
  ASSERT_EQ(std::system(("cd '" + folder.path() + "' && '" + gnuplot->string() + "' -d all.gp").c_str()), 0);
  int panels = 0;
  for (std::size_t i = 0; i < asked.size(); ++i) {
    std::ostringstream svg;
    svg << std::ifstream(folder.path() + "/figure" + std::to_string(i) + ".svg").rdbuf();
    const std::vector<Drawn> drawn = panels_of(svg.str());
    ASSERT_EQ(drawn.size(), asked[i].size());
    for (std::size_t p = 0; p < drawn.size(); ++p) {
      SCOPED_TRACE(testing::Message() << "figure " << i << " panel " << p);
      expect_true_axis(asked[i][p].first, drawn[p], false);
      expect_true_axis(asked[i][p].second, drawn[p], true);
      ++panels;
    }
  }
  EXPECT_GT(panels, 1000);
}

std::vector<std::string> labels_of(const DrawnAxis& axis) {
  std::vector<std::string> labels;
  for (const Tick& tick : axis_ticks(axis))
    if (!tick.label.empty()) labels.push_back(tick.label);
  return labels;
}

// Parts of a right angle wherever the axis is longer than a few degrees.
TEST(AxisTicks, AnglesStandAtPartsOfARightAngle) {
  const auto step = [](double from, double to) {
    const std::vector<Tick> ticks = axis_ticks({from, to, false, true, true, 300});
    return ticks[1].value - ticks[0].value;
  };
  EXPECT_EQ(step(-90, 0), 15);
  EXPECT_EQ(step(-250, 20), 45);
  EXPECT_EQ(step(-700, 0), 90);
  EXPECT_EQ(step(-30, 10), 5);
}

TEST(AxisTicks, AnAxisThatStartsOffADecadeHasWholePowersOfTen) {
  EXPECT_EQ(labels_of({0.03, 4000, true}),
            (std::vector<std::string>{"10^{\u22121}", "10^{0}", "10^{1}", "10^{2}", "10^{3}"}));
  EXPECT_EQ(labels_of({2e-9, 7e8, true, false, true, 200}),
            (std::vector<std::string>{"10^{\u22128}", "10^{\u22124}", "10^{0}", "10^{4}", "10^{8}"}));
}

TEST(AxisTicks, LabelsHaveAsManyDigitsAsTellThemApart) {
  EXPECT_EQ(labels_of({1000000, 1000000.4, false, false, true, 100}),
            (std::vector<std::string>{"1000000", "1000000.1", "1000000.2", "1000000.3", "1000000.4"}));
  EXPECT_EQ(labels_of({0, 2.1e-7, false, false, true, 60}),
            (std::vector<std::string>{"0", "1\u00d710^{\u22127}", "2\u00d710^{\u22127}"}));
}

}  // namespace
