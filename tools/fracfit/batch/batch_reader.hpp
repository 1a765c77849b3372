// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "batch/batch_table.hpp"
#include "io/line_reader.hpp"
#include "io/shard.hpp"

namespace fracfit {

/// Names of the inputs of a table on disk, one after the other.
class InputNames {
 public:
  /// @param begin  of the first name in the file, with what the format writes before it
  InputNames(BatchFormat format, int descriptor, const std::string& file, std::size_t begin);

  /// Valid until the next call; nothing behind the last.
  [[nodiscard]] std::optional<std::string_view> next();
  /// First byte behind the names given so far.
  [[nodiscard]] std::size_t end() const { return end_; }

 private:
  BatchFormat format_;
  io::FileLines pieces_;  // lines of a CSV; what stands between the quotation marks of JSON
  std::size_t begin_, end_;
  std::string text_;
};

/// Inputs that follow each other.
struct InputPart {
  std::size_t first = 0;  // place of the first one among all
  std::vector<std::string> names;
  std::unordered_map<std::string_view, std::size_t> indices;  // of the names
};

/// Beginning of a line.
struct LinePlace {
  std::size_t begin, number;  // byte of the file; from 1
};

/// A row where it stands.
struct PlacedRow {
  std::string_view line;  // without its end, valid while it is handed over
  LinePlace place;
};

/// A batch table on disk, finished or cut off by an interruption, read line by line: memory grows neither with the rows
/// nor with the inputs.
class BatchReader {
 public:
  /// Reads the head.
  /// @param descriptor  of the file, open as long as it is read
  /// @throws io::DataError  the file is no batch table; the text names file and line.
  BatchReader(std::string file, int descriptor);

  [[nodiscard]] const std::string& file() const { return file_; }
  [[nodiscard]] BatchFormat format() const { return format_; }
  /// Without the inputs.
  [[nodiscard]] const BatchManifest& manifest() const { return manifest_; }
  /// 1/1 where the table is none.
  [[nodiscard]] const io::Shard& shard() const { return shard_; }

  [[nodiscard]] std::size_t inputs() const { return inputs_; }
  /// Text of the head with all inputs, so much of it as is handled at once.
  /// @param from  bytes of it that have been read already
  /// @return      empty behind the last
  [[nodiscard]] std::string text_of_inputs(std::size_t from) const;
  /// Hands over all inputs in parts.
  void each_part(const std::function<void(const InputPart&)>& use) const;

  /// Reads the whole text.  A right checksum at its end vouches for what the rows hold; without one each is checked.
  /// @throws io::DataError  a row cannot be understood, or the text does not have the checksum at its end; the text
  /// names
  ///                        file and line.
  void check();
  /// Hands over the rows from a place on, until one is not taken.
  /// @return  place of that one, or of the end of the file
  LinePlace each_row(LinePlace from, const std::function<bool(const PlacedRow&)>& take) const;
  /// Name of the input that a row is of, as check() has let it stand.
  [[nodiscard]] std::string curve_of(const PlacedRow& row) const;
  [[nodiscard]] LinePlace first_row() const { return first_row_; }
  [[nodiscard]] int descriptor() const { return descriptor_; }

  /// Rows that check() has found.
  [[nodiscard]] std::size_t rows() const { return rows_; }
  /// Rows of the table when it is finished.
  [[nodiscard]] std::size_t expected_rows() const;
  /// The shard was finished, and check() has found that nothing has changed it since: its rows are in order.
  [[nodiscard]] bool has_end() const { return has_end_; }

 private:
  void read_csv_head();
  void read_json_head();
  void take_inputs(std::size_t begin);

  std::string file_;
  int descriptor_;
  BatchFormat format_ = BatchFormat::csv;
  BatchManifest manifest_;
  io::Shard shard_;
  std::size_t inputs_ = 0, inputs_begin_ = 0, inputs_end_ = 0;  // their number, bytes
  LinePlace first_row_{0, 1};
  std::size_t rows_ = 0;
  bool has_end_ = false;
};

/// The rows of a table that has been checked, part by part of its inputs.
class BatchRows {
 public:
  /// @param table  stays as long as this
  explicit BatchRows(const BatchReader& table);

  [[nodiscard]] const BatchReader& table() const { return *table_; }
  /// Hands over the rows of a part, with the index of the input in it.  The parts come in their order, each once.
  void take(const InputPart& part, const std::function<void(std::size_t, const PlacedRow&)>& use);
  /// Text of a row that has been handed over, read again; valid until the next call.
  [[nodiscard]] std::string_view line(std::size_t begin, std::size_t size);
  /// @throws io::DataError  a row is left, which belongs to no input of the table.
  void require_end() const;

 private:
  const BatchReader* table_;
  LinePlace next_;           // of a finished shard: its rows above are taken
  std::vector<bool> taken_;  // rows of another table, which stand in any order
  std::string text_;         // that was read last, and where it stands
  std::size_t text_begin_ = 0;
};

}  // namespace fracfit
