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
  /// Columns by number from 1 or by name, "time=1,input=3,output=4".  Keys: time, input, reference, trigger, and
  /// output, which may be given several times.
  std::string columns;
  std::optional<double> sample_time;  // s; instead of a column of times
  /// The file that holds the input, with times of its own; empty: it stands beside the outputs.
  std::string input_file = {};
};

/// A record as a file holds it.
struct RecordFile {
  frac::Record record;
  std::string input;  // names of columns
  std::vector<std::string> outputs;
  std::string input_unit;          // as the name spells it; empty where it gives none
  std::vector<std::string> units;  // of each output per input, e.g. "m_per_n"; empty where a name gives none
  Metadata metadata;
  std::vector<std::string> notes;     // what was assumed or left out, a sentence each
  std::optional<double> period = {};  // s, by a trigger, of what is no stepped sine
  /// s, by which instants of the outputs are before those of an input of another file that they stand beside.
  double sensor_delay = 0;
};

/// Pairs of key and column of RecordReadOptions::columns.
/// @throws std::invalid_argument  another key, one twice that may stand once, or no column.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> record_columns_told(const std::string& text);

/// Reads a table, or the real vectors of a MAT-file, as a record.  Columns that are not told are found by name: time
/// (time, t; with a unit s, ms, us, min, h), input (input, u, force), reference (reference, ref), outputs (output, y,
/// position; several may be followed by a number).
/// Of a table with a column `event`, as fracfit history writes it, the rows `sample` count, and where it has no input,
/// that is the force F cos(w t) of its head.
/// An input of another file is joined by time: rows whose instants are nearer than half a step stand side by side, the
/// others are left out.  A trigger, which is used where it is told, gives the period; without an input it gives that
/// too, a cosine with a summit at each of its instants.
/// @throws DataError  as TextTable; a column missing; a field that is no finite number; times that do not rise, or not
///                    by equal steps to within half a step, gaps of whole steps apart; two files whose steps differ by
///                    half of one over the record, or that share no instants; a trigger with fewer than three instants
///                    or with gaps; a record that frac::Record refuses.
[[nodiscard]] RecordFile read_record(const std::string& file, const RecordReadOptions& options = {});

}  // namespace io
