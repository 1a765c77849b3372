// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace report {

struct PlotPoint {
  double x;
  double y;
  double lower;  // error bar, equal to y where there is none
  double upper;
  double at = std::numeric_limits<double>::quiet_NaN();  // what tells the point apart in other panels; NaN: its x
};

enum class Mark {
  line,
  dashed,
  dotted,
  line_points,   // line with a filled circle at each point
  points,        // filled circles
  open_points,   // circles that let what lies below show through
  faint_points,  // small, pale: values that carry a large uncertainty
  faint_bars,    // pale error bars
  band,          // pale area between lower and upper; the axes do not stretch for it
};

/// One family member.  Segments are drawn apart from each other: a line never crosses from one into the next.
struct Curve {
  std::string label;   // key entry in gnuplot's enhanced text; empty: none
  std::string colour;  // #rrggbb
  Mark mark = Mark::line;
  std::vector<std::vector<PlotPoint>> segments = {};
};

struct Axis {
  std::string label;
  bool logarithmic = false;
  std::optional<double> from = {}, to = {};  // fitted to the curves when unset
  bool degrees = false;                      // an angle, whose ticks stand at multiples of 15, 45 or 90
};

/// A coloured grid below the curves: each cell shows one of a few kinds.
struct CellMap {
  struct Kind {
    std::string label;   // key entry in gnuplot's enhanced text
    std::string colour;  // #rrggbb
  };
  double x_from, x_to, y_from, y_to;  // centres of the outermost cells; the axes are linear
  std::size_t columns;                // >= 2
  std::vector<std::size_t> cells;     // index of the kind, row by row from the lowest y, at least two rows
  std::vector<Kind> kinds;            // >= 2
};

struct Panel {
  std::string title;
  Axis x, y;
  std::vector<Curve> curves = {};
  std::optional<CellMap> map = {};
  bool key = false;         // the key stands to the right of the panel, so it never covers a curve
  bool equal_axes = false;  // one unit is as long along x as along y; both axes are then linear
  int wide = 1, tall = 1;   // places of the grid that the panel takes
};

/// A picture: panels on a grid, each in the first place row by row that is free.
struct Figure {
  std::string name;     // file stem, [a-z0-9-]
  std::string caption;  // HTML
  std::vector<Panel> panels;
  int columns = 1;
  int panel_height = 300;    // px of the axes box of a panel one place tall
  std::string verdict = {};  // HTML that stands above the picture, in its frame; empty: none
  std::string link = {};     // pictures of the same link show one point under the pointer together; empty: none
};

/// Curves of the plain kinds; points where x or y is not finite break the line.
/// @param at  of each point, see PlotPoint; empty: none
[[nodiscard]] Curve make_curve(std::string label, std::string colour, Mark mark, const std::vector<double>& x,
                               const std::vector<double>& y, const std::vector<double>& at = {});

/// The area between two curves.
[[nodiscard]] Curve make_band(std::string label, std::string colour, const std::vector<double>& x,
                              const std::vector<double>& lower, const std::vector<double>& upper);

/// Colours of unordered curves, told apart by readers with any colour vision (Okabe, Ito 2008).
[[nodiscard]] std::string category_colour(std::size_t index);
/// Colours of an ordered family from dark to light, of rising lightness in grey print as well (viridis without its pale
/// end).
[[nodiscard]] std::string family_colour(std::size_t index, std::size_t count);

/// Plain text made safe for gnuplot's enhanced mode.
[[nodiscard]] std::string enhanced_escape(std::string_view text);

/// A gnuplot script with the data inside that makes name.svg and name.png in the folder it runs in; empty in a browser
/// for a figure that the page of the report draws.
/// @throws std::invalid_argument  in a browser, for any other figure
[[nodiscard]] std::string gnuplot_script(const Figure& figure);

/// The gnuplot program on PATH.
[[nodiscard]] std::optional<std::filesystem::path> find_gnuplot();

/// What to do where it is not found, in one sentence.
[[nodiscard]] std::string gnuplot_missing();

/// Longest time for one picture: hundred times what the largest takes on a slow machine.
constexpr std::chrono::milliseconds picture_time{120'000};

/// Runs folder/name.gp of each name inside the folder, one after the other in one gnuplot, whose start takes as long as
/// a small picture, and checks that name.svg and name.png came out whole.
/// @param limit  for each picture; a gnuplot that runs longer than all of them may is ended
/// @return  empty when they did, else one sentence with gnuplot's own words.
[[nodiscard]] std::string draw(const std::filesystem::path& gnuplot, const std::filesystem::path& folder,
                               const std::vector<std::string>& names, std::chrono::milliseconds limit = picture_time);

}  // namespace report
