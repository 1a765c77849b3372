// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "io/fingerprint.hpp"
#include "io/shard.hpp"

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
[[nodiscard]] std::string row_line(BatchFormat format, const BatchRow& row);
/// Columns and their texts, numbers as written; what is unset is left out.  Empty when the line is no row of the table.
[[nodiscard]] std::optional<std::map<std::string, std::string>> read_row(BatchFormat format,
                                                                         const std::vector<std::string>& columns,
                                                                         const std::string& line);
/// A remark below the rows, as one line: a name and what it says.
[[nodiscard]] std::string remark_line(BatchFormat format, const BatchRow& remark);

/// Last line of a finished shard, with the checksum of the text above it.
[[nodiscard]] std::string shard_end(BatchFormat format, const io::Fingerprint& above);

/// A row where it stands.
struct PlacedRow {
  std::size_t curve;      // place of its curve among the inputs of the manifest
  std::string_view line;  // without its end, valid while it is handed over
  std::size_t begin;      // first byte in the file
};

/// A batch table on disk, finished or cut off by an interruption, read line by line.
class BatchReader {
 public:
  /// @param descriptor  of the file, open as long as it is read
  /// @throws io::DataError  the file is no batch table; the text names file and line.
  BatchReader(std::string file, int descriptor);

  [[nodiscard]] BatchFormat format() const { return format_; }
  [[nodiscard]] const BatchManifest& manifest() const { return manifest_; }
  /// 1/1 where the table is none.
  [[nodiscard]] const io::Shard& shard() const { return shard_; }

  /// Hands over each row.  A right checksum at the end vouches for what the rows hold; without one each is checked.
  /// @throws io::DataError  a row cannot be understood or belongs to no input of the shard, or the text does not have
  ///                        the checksum at its end; the text names file and line.
  void read_rows(const std::function<void(const PlacedRow&)>& take);

  /// Rows that have been read.
  [[nodiscard]] std::size_t rows() const { return rows_; }
  /// Rows of the table when it is finished.
  [[nodiscard]] std::size_t expected_rows() const { return expected_; }
  /// The shard was finished and nothing has changed it since.
  [[nodiscard]] bool has_end() const { return has_end_; }

 private:
  std::string file_;
  int descriptor_;
  BatchFormat format_ = BatchFormat::csv;
  BatchManifest manifest_;
  io::Shard shard_;
  std::size_t head_lines_ = 0, rows_ = 0, expected_ = 0;
  bool has_end_ = false;
};

}  // namespace fracfit
