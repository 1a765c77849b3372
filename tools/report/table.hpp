// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace report {

/// A number (NaN: there is none) or a word.
using Cell = std::variant<double, std::string>;

struct Column {
  std::string name;     // in CSV and JSON, with the unit: force_n
  std::string heading;  // on the page, HTML
  int digits = 4;       // significant digits on the page; CSV and JSON carry all
  bool on_page = true;
  bool formula = false;   // words are formulas of s
  double zero_below = 0;  // smaller magnitudes are shown as 0 on the page: rounding of an exact zero
};

/// One table, written as CSV, as JSON and on the page from the same values.
struct Table {
  std::string name;     // file stem, [a-z0-9-]
  std::string caption;  // HTML
  std::vector<Column> columns;
  std::vector<std::vector<Cell>> rows = {};
  bool on_page = true;              // false: too long to be read, CSV only
  std::size_t rows_on_page = 1000;  // the rest stands in the CSV, and the page says so
  bool in_results = on_page;        // in results.json
  bool folded = false;              // the page shows the caption, and the rows on a click
};

using Metadata = std::vector<std::pair<std::string, std::string>>;

/// CSV text: "# key: value" lines, a header row of column names, then the rows.  Numbers round-trip, a missing one is
/// "nan".
[[nodiscard]] std::string csv_text(const Table& table, const Metadata& metadata);

}  // namespace report
