// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <variant>
#include <vector>

#include "io/shard.hpp"
#include "io/text_table.hpp"

namespace fracfit {

class Json;

using Cell = std::variant<double, std::int64_t, bool, std::string>;

/// Rows that are made one at a time, so that a table of ten million of them never stands in memory twice.
struct Rows {
  std::vector<std::string> columns;
  std::size_t count = 0;
  std::function<void(std::size_t row, std::vector<Cell>& cells)> fill;  ///< appends the cells of a row
  /// Columns of a value and of the ends of its interval, which tables for people show with the digits it warrants.
  struct Interval {
    std::size_t value, lower, upper;
  };
  std::vector<Interval> intervals = {};
};

/// A result of rows: what it is, in the entries of its head, and the rows.
struct Document {
  io::Metadata head;
  Rows rows;
  io::Shard shard = {};  ///< which part of a table that is computed in pieces; its CSV ends with its checksum
};

/// One object per row.
[[nodiscard]] Json array_of(const Rows& rows);

/// @param format  "csv", "json", or "table" for people to read
[[nodiscard]] std::string text_of(const Document& document, const std::string& format, const std::string& command);

/// The part of the CSV above the rows.
[[nodiscard]] std::string csv_head(const Document& document, const std::string& command);
[[nodiscard]] std::string csv_rows(const Rows& rows);

/// A document from the text of a CSV file with head, for writers of files that only know CSV.
[[nodiscard]] Document document_of(const std::string& csv);

}  // namespace fracfit
