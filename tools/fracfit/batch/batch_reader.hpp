// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <string_view>

#include "batch/batch_table.hpp"
#include "io/shard.hpp"

namespace fracfit {

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
