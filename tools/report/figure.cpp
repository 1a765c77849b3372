// SPDX-License-Identifier: BSD-3-Clause
#include "report/figure.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <string_view>
#include <utility>

namespace report {

namespace {

struct Rgb {
  double red, green, blue;
};

std::string hex(const Rgb& colour) {
  static constexpr std::string_view digits = "0123456789abcdef";
  std::string text = "#";
  for (const double channel : {colour.red, colour.green, colour.blue}) {
    const auto level = static_cast<unsigned>(std::lround(255 * std::clamp(channel, 0.0, 1.0)));
    text += digits[level / 16];
    text += digits[level % 16];
  }
  return text;
}

}  // namespace

Curve make_curve(std::string label, std::string colour, Mark mark, const std::vector<double>& x,
                 const std::vector<double>& y, const std::vector<double>& at) {
  Curve curve{std::move(label), std::move(colour), mark, {{}}};
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (std::isfinite(x[i]) && std::isfinite(y[i])) {
      PlotPoint& point = curve.segments.back().emplace_back(PlotPoint{x[i], y[i], y[i], y[i]});
      if (!at.empty()) point.at = at[i];
    } else if (!curve.segments.back().empty()) {
      curve.segments.emplace_back();
    }
  }
  return curve;
}

Curve make_band(std::string label, std::string colour, const std::vector<double>& x, const std::vector<double>& lower,
                const std::vector<double>& upper) {
  Curve curve{std::move(label), std::move(colour), Mark::band, {{}}};
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (std::isfinite(x[i]) && std::isfinite(lower[i]) && std::isfinite(upper[i])) {
      curve.segments.back().push_back({x[i], (lower[i] + upper[i]) / 2, lower[i], upper[i]});
    } else if (!curve.segments.back().empty()) {
      curve.segments.emplace_back();
    }
  }
  return curve;
}

std::string category_colour(std::size_t index) {
  static constexpr std::array<std::string_view, 7> colours = {"#0072b2", "#d55e00", "#009e73", "#cc79a7",
                                                              "#e69f00", "#56b4e9", "#444444"};
  return std::string(colours[index % colours.size()]);
}

std::string family_colour(std::size_t index, std::size_t count) {
  // Viridis (Smith, van der Walt 2015) at 0, .15, .3, .45, .6, .75, .88; the pale yellow end would vanish on white
  // paper.
  static constexpr std::array<Rgb, 7> nodes = {{{0.267, 0.005, 0.329},
                                                {0.275, 0.195, 0.496},
                                                {0.207, 0.372, 0.553},
                                                {0.146, 0.519, 0.557},
                                                {0.135, 0.659, 0.518},
                                                {0.369, 0.789, 0.383},
                                                {0.620, 0.740, 0.100}}};
  if (count < 2) return hex(nodes[1]);
  const double place = static_cast<double>(index) / static_cast<double>(count - 1) * (nodes.size() - 1);
  const auto lower = std::min(static_cast<std::size_t>(place), nodes.size() - 2);
  const double share = place - static_cast<double>(lower);
  const auto mix = [share](double a, double b) { return a + share * (b - a); };
  const Rgb& a = nodes[lower];
  const Rgb& b = nodes[lower + 1];
  return hex({mix(a.red, b.red), mix(a.green, b.green), mix(a.blue, b.blue)});
}

std::string enhanced_escape(std::string_view text) {
  std::string safe;
  for (const char c : text) {
    if (static_cast<unsigned char>(c) < ' ') {
      safe += ' ';
      continue;
    }
    if (std::string_view("_^{}@&~\\").find(c) != std::string_view::npos) safe += '\\';
    safe += c;
  }
  return safe;
}

}  // namespace report
