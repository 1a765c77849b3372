// SPDX-License-Identifier: BSD-3-Clause
#include "report/circuit_drawing.hpp"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <utility>
#include <vector>

#include "io/number.hpp"
#include "report/html.hpp"

namespace report {
namespace {

// Lengths in pixels.
constexpr double slot = 76;     // of one element along the wire
constexpr double symbol = 36;   // of its symbol, in the middle of the slot
constexpr double above = 30;    // from the wire up to the edge of a row: symbol and name
constexpr double below = 14;    // and down
constexpr double rail = 12;     // from a branching point to its branches
constexpr double margin = 10;   // about the picture
constexpr double terminal = 4;  // radius

/// Part of the drawing, its wire entering at the left and leaving at the right, `rise` below the upper edge.
struct Part {
  double width, rise, fall;
  std::string svg;  // with its origin where the wire enters
};

std::string number(double value) {
  return io::format_number(value);
}
std::string line(double x1, double y1, double x2, double y2) {
  return "M" + number(x1) + " " + number(y1) + "L" + number(x2) + " " + number(y2);
}
std::string stroke(const std::string& path) {
  return "<path d=\"" + path + "\"/>";
}
std::string moved(const Part& part, double x, double y) {
  return "<g transform=\"translate(" + number(x) + " " + number(y) + ")\">" + part.svg + "</g>";
}

bool is_kind(std::string_view name, std::string_view kind) {
  return name.starts_with(kind) && std::all_of(name.begin() + static_cast<std::ptrdiff_t>(kind.size()), name.end(),
                                               [](char each) { return each >= '0' && each <= '9'; });
}

/// Paths of the symbol between `from` and `to` on the wire.
std::string symbol_of(std::string_view name, double from, double to) {
  const double middle = (from + to) / 2;
  if (is_kind(name, "L")) {
    std::string path = line(0, 0, from, 0);
    const double radius = (to - from) / 6;
    for (int turn = 0; turn < 3; ++turn)
      path += "a" + number(radius) + " " + number(radius) + " 0 0 1 " + number(2 * radius) + " 0";
    return stroke(path + line(to, 0, slot, 0));
  }
  if (is_kind(name, "C"))
    return stroke(line(0, 0, middle - 3, 0) + line(middle - 3, -9, middle - 3, 9) +
                  line(middle + 3, -9, middle + 3, 9) + line(middle + 3, 0, slot, 0));
  if (is_kind(name, "CPE")) {
    const auto angle = [](double tip) {
      return "M" + number(tip - 7) + " -9L" + number(tip) + " 0L" + number(tip - 7) + " 9";
    };
    return stroke(line(0, 0, middle, 0) + angle(middle) + angle(middle + 7) + line(middle + 7, 0, slot, 0));
  }
  return stroke(line(0, 0, from, 0) + line(to, 0, slot, 0)) + "<rect x=\"" + number(from) + "\" y=\"-7\" width=\"" +
         number(to - from) + "\" height=\"14\"/>";
}

Part element(std::string_view name) {
  if (name.empty()) throw std::invalid_argument("circuit: an element without a name");
  constexpr double from = (slot - symbol) / 2;
  return {slot, above, below,
          symbol_of(name, from, from + symbol) + "<text x=\"" + number(slot / 2) + "\" y=\"-14\">" + escape_html(name) +
              "</text>"};
}

/// Parts of a text between separators that stand in no bracket.
std::vector<std::string_view> split(std::string_view text, char separator) {
  std::vector<std::string_view> parts;
  std::size_t begin = 0;
  int depth = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '(') ++depth;
    if (text[i] == ')') --depth;
    if (depth < 0) break;
    if (depth > 0 || text[i] != separator) continue;
    parts.push_back(text.substr(begin, i - begin));
    begin = i + 1;
  }
  if (depth != 0) throw std::invalid_argument("circuit '" + std::string(text) + "': brackets do not match");
  parts.push_back(text.substr(begin));
  return parts;
}

Part in_series(std::string_view circuit);

Part in_parallel(std::string_view circuit) {
  std::vector<Part> branches;
  double width = 0, height = 0;
  for (const std::string_view each : split(circuit, '|')) {
    branches.push_back(in_series(each));
    width = std::max(width, branches.back().width);
    height += branches.back().rise + branches.back().fall;
  }
  // The wire enters halfway between the first branch and the last one.
  const double first = branches.front().rise, last = height - branches.back().fall, entry = (first + last) / 2;
  Part part{width + 2 * rail, entry, height - entry, ""};
  const double right = part.width - rail;
  std::string wires = line(0, 0, rail, 0) + line(rail, first - entry, rail, last - entry) +
                      line(right, first - entry, right, last - entry) + line(right, 0, part.width, 0);
  double top = 0;
  for (const Part& branch : branches) {
    const double y = top + branch.rise - entry, x = (part.width - branch.width) / 2;
    part.svg += moved(branch, x, y);
    if (branch.width < width) wires += line(rail, y, x, y) + line(x + branch.width, y, right, y);
    top += branch.rise + branch.fall;
  }
  part.svg += stroke(wires);
  return part;
}

Part in_series(std::string_view circuit) {
  Part part{0, 0, 0, ""};
  for (const std::string_view each : split(circuit, '+')) {
    const bool bracket = each.starts_with('(') && each.ends_with(')');
    const Part next = bracket ? in_parallel(each.substr(1, each.size() - 2)) : element(each);
    part.svg += moved(next, part.width, 0);
    part.width += next.width;
    part.rise = std::max(part.rise, next.rise);
    part.fall = std::max(part.fall, next.fall);
  }
  return part;
}

}  // namespace

std::string circuit_of(std::string_view model) {
  constexpr std::string_view sum = "elements:";
  if (model.starts_with(sum)) return std::string(model.substr(sum.size()));
  constexpr std::array<std::pair<std::string_view, std::string_view>, 8> presets{
      {{"zarc", "R0+(R1|CPE1)"},
       {"two-zarc", "R0+(R1|CPE1)+(R2|CPE2)"},
       {"arc-and-cpe", "R0+(R1|CPE1)+CPE2"},
       {"r-l-cpe", "R0+L+CPE1"},
       {"finite-warburg-short", "R0+Ws1"},
       {"finite-warburg-open", "R0+Wo1"},
       {"rc-and-warburg-short", "R0+(R1|C1)+Ws2"},
       {"rc-and-warburg-open", "R0+(R1|C1)+Wo2"}}};
  const auto* const found =
      std::find_if(presets.begin(), presets.end(), [&](const auto& each) { return each.first == model; });
  return found == presets.end() ? "" : std::string(found->second);
}

std::string circuit_drawing(std::string_view circuit) {
  const Part part = in_series(circuit);
  const double width = part.width + 2 * margin, height = part.rise + part.fall + 2 * margin;
  const double y = margin + part.rise;
  const auto end = [&](double x) {
    return "<circle cx=\"" + number(x) + "\" cy=\"" + number(y) + "\" r=\"" + number(terminal) + "\"/>";
  };
  return "<svg class=\"circuit\" viewBox=\"0 0 " + number(width) + " " + number(height) + "\" width=\"" +
         number(width) + "\" height=\"" + number(height) + "\" role=\"img\" aria-label=\"circuit " +
         escape_html(circuit) + "\"><g fill=\"none\" stroke=\"currentColor\" stroke-width=\"1.5\">" +
         moved(part, margin, y) + end(margin - terminal) + end(width - margin + terminal) + "</g></svg>";
}

}  // namespace report
