// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "io/fingerprint.hpp"

namespace fracfit {

enum class BatchFormat { csv, jsonl };

/// Last column of a row: which content of its file the row was made from, see io::fingerprint.
inline constexpr std::string_view fingerprint_column = "input_fingerprint";

/// One field of a batch table: a name and a number or a text; unset where it has no meaning for the row.
struct BatchCell {
  std::string column;
  std::optional<double> number;
  std::optional<std::string> text;
};
/// The first cell is column `file`, the key of the row.
using BatchRow = std::vector<BatchCell>;

/// What a batch table was made from.
struct BatchManifest {
  std::string version;
  std::string command;              // without the data
  std::string shard;                // "i/n"; empty: all files
  std::vector<std::string> laws;    // PARAMETER:VARIABLE
  std::vector<std::string> inputs;  // of all shards, in order
  std::vector<std::string> columns;
};

/// Manifest and, for CSV, the header row.
[[nodiscard]] std::string header_text(BatchFormat format, const BatchManifest& manifest);
/// The same without the inputs: what stands before them and behind them.
struct HeaderParts {
  std::string before, behind;
};
[[nodiscard]] HeaderParts header_parts(BatchFormat format, const BatchManifest& manifest);
[[nodiscard]] std::string row_line(BatchFormat format, const BatchRow& row);
/// Columns and their texts, numbers as written; what is unset is left out.  Empty when the line is no row of the table.
[[nodiscard]] std::optional<std::map<std::string, std::string>> read_row(BatchFormat format,
                                                                         const std::vector<std::string>& columns,
                                                                         const std::string& line);
/// A remark below the rows, as one line: a name and what it says.
[[nodiscard]] std::string remark_line(BatchFormat format, const BatchRow& remark);

/// Last line of a finished shard, with the checksum of the text above it.
[[nodiscard]] std::string shard_end(BatchFormat format, const io::Fingerprint& above);

}  // namespace fracfit
