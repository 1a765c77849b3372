// SPDX-License-Identifier: BSD-3-Clause
#include <gnuplot-iostream.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <iomanip>
#include <limits>
#include <new>
#include <ostream>
#include <string>
#include <string_view>
#include <system_error>
#include <tuple>
#include <utility>
#include <vector>

#include "report/axis_ticks.hpp"
#include "report/figure.hpp"

namespace report {

namespace {

// Margins in px round the axes boxes: room for tick and axis labels, titles, and the key beside the last column.
constexpr int left_margin = 86;
constexpr int right_margin = 24;
constexpr int top_margin = 34;
constexpr int bottom_margin = 62;
constexpr int page_width = 980;

// An apostrophe, even doubled, can end a string inside a block of commands; the typographic one reads the same.
std::string quoted(const std::string& text) {
  std::string safe = "'";
  for (const char c : text) safe += c == '\'' ? std::string("\u2019") : std::string(1, c);
  return safe + "'";
}

std::size_t drawn_length(const std::string& label) {
  return static_cast<std::size_t>(std::count_if(label.begin(), label.end(), [](char c) {
    // Markup and the continuation bytes of UTF-8 take no room.
    return std::string_view("_^{}\\").find(c) == std::string_view::npos &&
           (static_cast<unsigned char>(c) & 0xC0U) != 0x80U;
  }));
}

// Width of the key in px: the sample line, and the longest label at the width of an average character of the fonts in
// use.
int key_width(const Figure& figure) {
  std::size_t longest = 0;
  for (const Panel& panel : figure.panels) {
    if (!panel.key) continue;
    // A plus, of which the names of circuits have many, is half as wide again.
    for (const Curve& curve : panel.curves)
      longest =
          std::max(longest, drawn_length(curve.label) +
                                static_cast<std::size_t>(std::count(curve.label.begin(), curve.label.end(), '+')) / 2);
    if (!panel.map) continue;
    for (const CellMap::Kind& kind : panel.map->kinds) longest = std::max(longest, drawn_length(kind.label));
  }
  return 68 + static_cast<int>(9.0 * static_cast<double>(longest));
}

struct Range {
  double from, to;
};

Range fitted_range(const Panel& panel, bool horizontal) {
  const Axis& axis = horizontal ? panel.x : panel.y;
  if (panel.map) {
    return horizontal ? Range{panel.map->x_from, panel.map->x_to} : Range{panel.map->y_from, panel.map->y_to};
  }
  double lowest = std::numeric_limits<double>::infinity();
  double highest = -lowest;
  for (const Curve& curve : panel.curves) {
    for (const auto& segment : curve.segments) {
      for (const PlotPoint& point : segment) {
        const double value = horizontal ? point.x : point.y;
        if (!std::isfinite(value) || (axis.logarithmic && value <= 0)) continue;
        lowest = std::min(lowest, value);
        highest = std::max(highest, value);
      }
    }
  }
  if (lowest > highest) return axis.logarithmic ? Range{0.1, 10} : Range{0, 1};
  // Widens the range where all values differ by rounding only: its ends would print as the same number.
  const bool constant = highest - lowest <= 1e-9 * std::max(std::abs(lowest), std::abs(highest));
  if (axis.logarithmic) {
    // A vertical axis keeps 4 % of its length free above and below; a horizontal one starts where the data start.
    const double pad = std::pow(std::max(highest / lowest, 1.05), horizontal ? 0 : 0.04);
    return constant ? Range{lowest / 2, highest * 2} : Range{lowest / pad, highest * pad};
  }
  const double span = highest - lowest;
  const double pad = constant ? std::max(1e-12, 0.05 * std::abs(highest)) : (horizontal ? 0.02 : 0.05) * span;
  return {lowest - pad, highest + pad};
}

Range axis_range(const Panel& panel, bool horizontal) {
  const Axis& axis = horizontal ? panel.x : panel.y;
  const Range fitted = fitted_range(panel, horizontal);
  const Range range{axis.from.value_or(fitted.from), axis.to.value_or(fitted.to)};
  if (range.from < range.to) return range;
  // All points lie beyond the end that was asked for.
  return axis.from ? Range{range.from, axis.logarithmic ? 10 * range.from : range.from + 1}
                   : Range{axis.logarithmic ? range.to / 10 : range.to - 1, range.to};
}

// The axes box of a panel in px.
struct Box {
  int left, top, width, height;
};

Range widened(Range range, double length) {
  const double middle = (range.from + range.to) / 2;
  return {middle - length / 2, middle + length / 2};
}

// Ranges of both axes; the shorter one of equal axes is widened round its middle.
std::pair<Range, Range> axis_ranges(const Panel& panel, const Box& box) {
  const Range x = axis_range(panel, true);
  const Range y = axis_range(panel, false);
  if (!panel.equal_axes) return {x, y};
  const double unit = std::max((x.to - x.from) / box.width, (y.to - y.from) / box.height);
  return {widened(x, unit * box.width), widened(y, unit * box.height)};
}

// The boxes of a figure and its size.
struct Layout {
  std::vector<Box> boxes;
  int width, height;
};

struct Place {
  int column, row;
};

// The first places row by row where the panels fit, and the number of rows they take.
std::pair<std::vector<Place>, int> places_of(const Figure& figure, int columns) {
  std::vector<std::vector<bool>> taken;
  const auto is_free = [&](const Panel& panel, int column, int row) {
    if (column + panel.wide > columns) return false;
    for (int r = row; r < row + panel.tall; ++r) {
      for (int c = column; c < column + panel.wide; ++c) {
        if (static_cast<std::size_t>(r) < taken.size() &&
            taken[static_cast<std::size_t>(r)][static_cast<std::size_t>(c)])
          return false;
      }
    }
    return true;
  };
  std::vector<Place> places;
  for (const Panel& panel : figure.panels) {
    Place place{0, 0};
    while (!is_free(panel, place.column, place.row)) {
      if (++place.column == columns) place = {0, place.row + 1};
    }
    const auto end = static_cast<std::size_t>(place.row + panel.tall);
    if (taken.size() < end) taken.resize(end, std::vector<bool>(static_cast<std::size_t>(columns), false));
    for (auto row = static_cast<std::size_t>(place.row); row < end; ++row)
      std::fill_n(taken[row].begin() + place.column, panel.wide, true);
    places.push_back(place);
  }
  return {places, static_cast<int>(taken.size())};
}

Layout layout_of(const Figure& figure) {
  const int columns = std::max(1, std::min(figure.columns, static_cast<int>(figure.panels.size())));
  const auto [places, rows] = places_of(figure, columns);
  // A key beside a panel as wide as the picture narrows that panel alone.
  const auto has_own_key = [columns](const Panel& panel) { return panel.key && columns > 1 && panel.wide == columns; };
  const bool key = std::any_of(figure.panels.begin(), figure.panels.end(),
                               [&](const Panel& panel) { return panel.key && !has_own_key(panel); });
  const int right = key ? key_width(figure) : right_margin;
  const int column_gap = left_margin + right_margin;
  const int row_gap = top_margin + bottom_margin + 10;
  const int panel_width = (page_width - left_margin - right - (columns - 1) * column_gap) / columns;
  Layout layout{{},
                left_margin + columns * panel_width + (columns - 1) * column_gap + right,
                top_margin + rows * figure.panel_height + (rows - 1) * row_gap + bottom_margin};
  for (std::size_t p = 0; p < places.size(); ++p) {
    const Panel& panel = figure.panels[p];
    Box box{left_margin + places[p].column * (panel_width + column_gap),
            top_margin + places[p].row * (figure.panel_height + row_gap),
            panel.wide * panel_width + (panel.wide - 1) * column_gap,
            panel.tall * figure.panel_height + (panel.tall - 1) * row_gap};
    if (has_own_key(panel)) box.width -= key_width(figure) - right_margin;
    layout.boxes.push_back(box);
  }
  return layout;
}

// As many digits as tell the number from its neighbours.  gnuplot takes digits alone for an integer, which overflows.
std::string exact(double value) {
  std::array<char, 32> text{};
  std::string written(text.data(), std::to_chars(text.data(), text.data() + text.size(), value).ptr);
  if (written.size() > 9 && written.find_first_of(".e") == std::string::npos) written += '.';
  return written;
}

void write_axis(std::ostream& script, char name, const Axis& axis, const DrawnAxis& drawn,
                const std::vector<Tick>& ticks) {
  // Makes the axis slightly longer than asked for: rounding could drop a tick exactly at its end.
  constexpr double hair = 1e-6;
  const double factor = std::pow(drawn.to / drawn.from, hair);
  const double margin = hair * (drawn.to - drawn.from);
  const double from = axis.logarithmic ? drawn.from / factor : drawn.from - margin;
  const double to = axis.logarithmic ? drawn.to * factor : drawn.to + margin;
  // The range stands before the scale: the panel before may have left one that has no logarithms.
  script << "unset logscale " << name << "\nset " << name << "range [" << exact(from) << ":" << exact(to) << "]\nset "
         << name << "label " << quoted(axis.label) << "\n";
  if (axis.logarithmic) script << "set logscale " << name << "\n";
  script << "set " << name << "tics (";
  for (const Tick& tick : ticks) {
    script << (&tick == ticks.data() ? "" : ", ") << quoted(tick.label) << " " << exact(tick.value)
           << (tick.label.empty() ? " 1" : "");
  }
  script << ")\n";
}

// Mixes the colour with white.  Transparency would darken marks that overlap.
std::string pale(const std::string& colour) {
  std::string mixed = "#";
  for (const std::size_t at : {1U, 3U, 5U}) {
    const int channel = std::stoi(colour.substr(at, 2), nullptr, 16);
    const int level = 255 - (255 - channel) * 55 / 100;
    for (const int digit : {level / 16, level % 16}) mixed += "0123456789abcdef"[digit];
  }
  return mixed;
}

// A few points with an entry in the key are marks that the eye has to find; others are a cloud or a part of one.
bool is_a_mark(const Curve& curve) {
  if (curve.label.empty()) return false;
  std::size_t points = 0;
  for (const auto& segment : curve.segments) points += segment.size();
  return points <= 3;
}

std::string style_of(const Curve& curve) {
  const std::string solid = " lc rgb '" + curve.colour + "'";
  const std::string faint = " lc rgb '" + pale(curve.colour) + "'";
  switch (curve.mark) {
    case Mark::line:
      return "with lines lw 2" + solid;
    case Mark::dashed:
      return "with lines lw 1.6 dt (8,5)" + solid;
    case Mark::dotted:
      return "with lines lw 1.8 dt (2,4)" + solid;
    case Mark::line_points:
      return "with linespoints lw 1.4 pt 7 ps 0.5" + solid;
    case Mark::points:
      return "with points pt 7 ps " + std::string(is_a_mark(curve) ? "1" : "0.42") + solid;
    case Mark::open_points:
      return "with points pt 6 " + std::string(is_a_mark(curve) ? "ps 1.6 lw 2" : "ps 0.8 lw 1.2") + solid;
    case Mark::faint_points:
      return "with points pt 7 ps 0.32" + faint;
    case Mark::faint_bars:
      return "with yerrorbars pt -1 lw 0.8" + faint;
    case Mark::band:
      return "with filledcurves fs solid noborder" + faint;
  }
  return {};
}

bool has_points(const Curve& curve) {
  return std::any_of(curve.segments.begin(), curve.segments.end(),
                     [](const auto& segment) { return !segment.empty(); });
}

using Row = std::tuple<double, double, double, double>;

std::vector<std::vector<Row>> rows_of(const Curve& curve) {
  std::vector<std::vector<Row>> rows;
  for (const auto& segment : curve.segments) {
    if (segment.empty()) continue;
    auto& block = rows.emplace_back();
    for (const PlotPoint& point : segment) block.emplace_back(point.x, point.y, point.lower, point.upper);
  }
  return rows;
}

std::string block_name(std::size_t panel, std::size_t curve) {
  return "$panel" + std::to_string(panel + 1) + "_curve" + std::to_string(curve + 1);
}

std::string map_name(std::size_t panel) {
  return "$panel" + std::to_string(panel + 1) + "_map";
}

void write_map_data(std::ostream& script, const CellMap& map, std::size_t panel) {
  script << map_name(panel) << " << e\n";
  for (std::size_t i = 0; i < map.cells.size(); ++i) {
    script << map.cells[i] << ((i + 1) % map.columns == 0 ? '\n' : ' ');
  }
  script << "e\n";
}

// Writes the cells as one image, and for each kind a square for the key.
void write_map(std::ostream& script, const CellMap& map, std::size_t panel) {
  const std::size_t rows = map.cells.size() / map.columns;
  const double dx = (map.x_to - map.x_from) / static_cast<double>(map.columns - 1);
  const double dy = (map.y_to - map.y_from) / static_cast<double>(rows - 1);
  script << map_name(panel) << " matrix using (" << map.x_from << "+$1*" << dx << "):(" << map.y_from << "+$2*" << dy
         << "):3 with image notitle";
  for (const CellMap::Kind& kind : map.kinds) {
    script << ", \\\n     NaN with points pt 5 ps 1.6 lc rgb '" << kind.colour << "' title " << quoted(kind.label);
  }
}

void write_palette(std::ostream& script, const CellMap& map) {
  const std::size_t last = map.kinds.size() - 1;
  script << "set palette maxcolors " << map.kinds.size() << "\nset palette defined (";
  for (std::size_t i = 0; i <= last; ++i) script << (i == 0 ? "" : ", ") << i << " '" << map.kinds[i].colour << "'";
  script << ")\nset cbrange [0:" << last << "]\nunset colorbox\n";
}

void write_panel(std::ostream& script, const Panel& panel, std::size_t index, const Box& box) {
  const auto [x_range, y_range] = axis_ranges(panel, box);
  const DrawnAxis x{x_range.from, x_range.to, panel.x.logarithmic, panel.x.degrees, false, 1.0 * box.width};
  const DrawnAxis y{y_range.from, y_range.to, panel.y.logarithmic, panel.y.degrees, true, 1.0 * box.height};
  std::vector<Tick> x_ticks = axis_ticks(x);
  std::vector<Tick> y_ticks = axis_ticks(y);
  if (panel.equal_axes) {
    const TickStep step = std::max(tick_step(x), tick_step(y),
                                   [](const TickStep& a, const TickStep& b) { return a.value() < b.value(); });
    x_ticks = ticks_at(x, step);
    y_ticks = ticks_at(y, step);
  }
  script << "set title " << quoted(panel.title) << "\n";
  write_axis(script, 'x', panel.x, x, x_ticks);
  write_axis(script, 'y', panel.y, y, y_ticks);
  script << (panel.key ? "set key at graph 1.02, graph 1 left top Left reverse samplen 2 spacing 1.15\n"
                       : "unset key\n");
  if (panel.map) write_palette(script, *panel.map);
  script << "plot ";
  bool first = !panel.map;
  if (panel.map) write_map(script, *panel.map, index);
  for (std::size_t i = 0; i < panel.curves.size(); ++i) {
    const Curve& curve = panel.curves[i];
    if (!has_points(curve)) {
      if (curve.label.empty()) continue;
      // A curve without points still gets its entry in the key.
      script << (first ? "" : ", \\\n     ") << "NaN " << style_of(curve) << " title " << quoted(curve.label);
    } else {
      script << (first ? "" : ", \\\n     ") << block_name(index, i) << " using "
             << (curve.mark == Mark::faint_bars ? "1:2:3:4 "
                 : curve.mark == Mark::band     ? "1:3:4 "
                                                : "1:2 ")
             << style_of(curve) << (curve.label.empty() ? " notitle" : " title " + quoted(curve.label));
    }
    first = false;
  }
  if (first) script << "NaN notitle";
  script << "\n";
}

void write_commands(Gnuplot& script, const Figure& figure) {
  const Layout layout = layout_of(figure);
  // Twelve digits, a thousandth of the shortest axis, on which values differ in their ninth.
  script << std::defaultfloat << std::setprecision(12);
  script << "# Makes " << figure.name << ".svg and " << figure.name << ".png:  gnuplot " << figure.name << ".gp\n"
         << "set encoding utf8\n";
  for (std::size_t p = 0; p < figure.panels.size(); ++p) {
    if (figure.panels[p].map) write_map_data(script, *figure.panels[p].map, p);
    for (std::size_t c = 0; c < figure.panels[p].curves.size(); ++c) {
      const Curve& curve = figure.panels[p].curves[c];
      if (!has_points(curve)) continue;
      // send2d closes with a line "e", which serves as the end mark of the data block.
      script << block_name(p, c) << " << e\n";
      script.send2d(rows_of(curve));
    }
  }
  script << "do for [form in 'svg png'] {\n"
         << "if (form eq 'svg') { set terminal svg size " << layout.width << "," << layout.height
         << " dynamic font 'Helvetica,Arial,sans-serif,13' lw 0.9 } else { "
         << "set terminal pngcairo size " << 2 * layout.width << "," << 2 * layout.height
         << " font 'sans,12' fontscale 2 lw 1.8 "
         << "pointscale 2 background 'white' }\n"
         << "set output '" << figure.name << ".' . form\n"
         << "set multiplot\nset grid lc rgb '#dddddd' lw 0.8 lt 1\nset border lc rgb '#333333' lw 0.8\n"
         << "set tics nomirror\nset bars small\nset title offset 0,-0.4\n";
  for (std::size_t p = 0; p < figure.panels.size(); ++p) {
    const Box& box = layout.boxes[p];
    const double width = layout.width;
    const double height = layout.height;
    script << "set lmargin at screen " << box.left / width << "\nset rmargin at screen "
           << (box.left + box.width) / width << "\nset tmargin at screen " << 1 - box.top / height
           << "\nset bmargin at screen " << 1 - (box.top + box.height) / height << "\n";
    write_panel(script, figure.panels[p], p, box);
  }
  script << "unset multiplot\nunset output\n}\n";
}

}  // namespace

std::string gnuplot_script(const Figure& figure) {
  // The stream writes into memory and not into a pipe: the script stays beside each picture for the reader to edit, and
  // a gnuplot that is missing or fails shows in the status of its own process.
  const int memory = ::memfd_create("gnuplot-script", MFD_CLOEXEC);
  if (memory < 0) throw std::system_error(errno, std::generic_category(), "no memory for a gnuplot script");
  std::FILE* const file = ::fdopen(memory, "w+");
  if (file == nullptr) throw std::bad_alloc();
  Gnuplot script(file);  // closes it
  write_commands(script, figure);
  script.flush();
  std::string text(static_cast<std::size_t>(std::max<off_t>(::lseek(memory, 0, SEEK_END), 0)), '\0');
  if (!script.good() || ::pread(memory, text.data(), text.size(), 0) != static_cast<ssize_t>(text.size()))
    throw std::system_error(errno, std::generic_category(), "cannot keep a gnuplot script in memory");
  return text;
}

}  // namespace report
