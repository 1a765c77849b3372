#include "aligned_table.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace fracfit {

AlignedTable::AlignedTable(std::vector<std::string> heading) {
  rows_.push_back(std::move(heading));
}

void AlignedTable::add(std::vector<std::string> row) {
  rows_.push_back(std::move(row));
}

std::string AlignedTable::text() const {
  std::vector<std::size_t> width(rows_.front().size(), 0);
  for (const auto& row : rows_)
    for (std::size_t i = 0; i < row.size(); ++i) width[i] = std::max(width[i], row[i].size());
  std::string text;
  for (const auto& row : rows_) {
    std::string line = " ";
    for (std::size_t i = 0; i < row.size(); ++i) {
      const std::string gap(width[i] - row[i].size(), ' ');
      line += i == 0 ? " " + row[i] + gap : "  " + gap + row[i];
    }
    line.erase(line.find_last_not_of(' ') + 1);
    text += line + "\n";
  }
  return text;
}

std::string short_number(double value) {
  if (std::isnan(value)) return "-";
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", value);
  return text;
}

}  // namespace fracfit
