// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "io/formats/format.hpp"
#include "io/text_table.hpp"

namespace io {

/// What the caller tells of a file, where the file does not tell it itself.
struct MeasurementOptions {
  /// Columns by number from 1 or by name, "f=1,re=2,-im=3".  Keys: f, omega; re, im, -im; magnitude, magnitude_db;
  /// phase_deg, phase_rad; sigma, weight.
  std::string columns;
  std::string frequency_unit;  // Hz, kHz, rad/s ..., of a frequency whose name has none
  std::string select;          // one of several sweeps, by its number from 1 or its name

  [[nodiscard]] bool operator==(const MeasurementOptions&) const = default;
};

/// Pairs of key and column of MeasurementOptions::columns.
/// @throws std::invalid_argument  another key, one twice, or no column.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> columns_told(const std::string& text);

/// A file whose format has been recognised and whose sweeps can be read.  Immutable; copies share its content.
struct Measurement {
  struct Sweep {
    std::string name;
    bool is_derived = false;                 // see io::Sweep
    std::shared_ptr<const TextTable> table;  // or else
    SampledCurve curve;
  };
  std::string file;    // for messages
  std::string format;  // for people; empty for a plain table of columns
  std::vector<Sweep> sweeps;
  std::vector<std::string> notes;
  std::string unit;         // of the values by the rules of the format, where the names give none
  std::string fingerprint;  // of the whole file, see input_text.hpp
  MeasurementOptions how;
  bool is_selected = false;  // what `how.select` names is all that is left
  /// Of a table with many curves in columns: each as a table of its own, by label; see prepare_curves().
  std::map<std::string, std::shared_ptr<const TextTable>> narrow;
  /// The same of one with curves in rows, behind the name of the column that tells them apart.
  std::pair<std::string, std::map<std::string, std::shared_ptr<const TextTable>>> of_rows;
};

/// Recognises a file by its content: Gamry, BioLogic, ZView, VersaStudio, Touchstone, universal files of dataset 58,
/// and tables with named columns of any other program.
/// @param file  path, or "-" for standard input
/// @throws DataError  as TextTable, or the file is of a known format and damaged, or holds no spectrum.
/// @throws std::invalid_argument  as columns_told().
[[nodiscard]] Measurement read_measurement(const std::string& file, const MeasurementOptions& how = {});

}  // namespace io
