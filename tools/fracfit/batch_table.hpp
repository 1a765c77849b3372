// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace fracfit {

enum class BatchFormat { csv, jsonl };

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

/// A batch table as it stands on disk: finished, or cut off by an interruption.
struct BatchTable {
  BatchFormat format;
  BatchManifest manifest;
  std::vector<std::pair<std::string, std::string>> rows;  // file and line
};

/// Manifest and, for CSV, the header row.
[[nodiscard]] std::string header_text(BatchFormat format, const BatchManifest& manifest);
[[nodiscard]] std::string row_line(BatchFormat format, const BatchRow& row);
/// Columns and their texts, numbers as written; what is unset is left out.  Empty when the line is no row of the table.
[[nodiscard]] std::optional<std::map<std::string, std::string>> read_row(BatchFormat format,
                                                                         const std::vector<std::string>& columns,
                                                                         const std::string& line);
/// A remark below the rows, as one line: a name and what it says.
[[nodiscard]] std::string remark_line(BatchFormat format, const BatchRow& remark);

/// @throws io::DataError  the file is no batch table, or a row of it cannot be understood.
[[nodiscard]] BatchTable read_batch_table(const std::string& file);

}  // namespace fracfit
