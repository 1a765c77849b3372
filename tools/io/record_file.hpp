// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "frac/records/record.hpp"
#include "io/text_table.hpp"

namespace io {

struct RecordReadOptions {
  /// Columns by number from 1 or by name, "time=1,input=3,output=4".  Keys: time, input, reference, and output, which
  /// may be given several times.
  std::string columns;
  std::optional<double> sample_time;  // s; instead of a column of times
};

/// A record as a file holds it.
struct RecordFile {
  frac::Record record;
  std::string input;  // names of columns
  std::vector<std::string> outputs;
  std::string input_unit;          // as the name spells it; empty where it gives none
  std::vector<std::string> units;  // of each output per input, e.g. "m_per_n"; empty where a name gives none
  Metadata metadata;
  std::vector<std::string> notes;  // what was assumed or left out, a sentence each
};

/// Pairs of key and column of RecordReadOptions::columns.
/// @throws std::invalid_argument  another key, one twice that may stand once, or no column.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> record_columns_told(const std::string& text);

/// Reads a table, or the real vectors of a MAT-file, as a record.  Columns that are not told are found by name: time
/// (time, t; with a unit s, ms, us, min, h), input (input, u, force), reference (reference, ref), outputs (output, y,
/// position; several may be followed by a number).
/// Of a table with a column `event`, as fracfit history writes it, the rows `sample` count, and where it has no input,
/// that is the force F cos(w t) of its head.
/// @throws DataError  as TextTable; a column missing; a field that is no finite number; times that do not rise, or not
///                    by equal steps to within half a step, gaps of whole steps apart; a record that frac::Record refuses.
[[nodiscard]] RecordFile read_record(const std::string& file, const RecordReadOptions& options = {});

}  // namespace io
