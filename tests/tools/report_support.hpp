// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstdlib>
#include <regex>
#include <set>
#include <string>

#include "report/figure.hpp"

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

/// What the first group of a pattern matches in a text, each once.
inline std::set<std::string> all_matches(const std::string& text, const std::string& pattern) {
  std::set<std::string> found;
  const std::regex expression(pattern);
  for (std::sregex_iterator it(text.begin(), text.end(), expression), end; it != end; ++it) found.insert((*it)[1]);
  return found;
}

/// Two equal panels with a line that is interrupted and a curve of points.
inline report::Figure small_figure(const std::string& name) {
  using namespace report;
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
