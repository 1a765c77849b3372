// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "frac/parallel_for.hpp"
#include "io/measurement.hpp"
#include "report/field.hpp"

namespace report {

/// What to report on and where to write it.  scene and data exclude each other; with neither, the paper's scenes are
/// used.
struct ReportOptions {
  std::filesystem::path out;                // folder, made if missing
  std::vector<std::filesystem::path> data;  // measured files: the report is then on these alone
  io::MeasurementOptions how = {};          // what these files do not tell of themselves
  Field field = Field::automatic;           // decides the pictures of measured frequency responses
  std::optional<std::filesystem::path>
      scene;                           // JSON with mass1, mass2, clearance, restitution, force, omega (see scene.hpp)
  int threads = 0;                     // 0: one per core
  std::string command;                 // command line, quoted in the report so that it can be made again
  frac::Progress* progress = nullptr;  // counts steps of the current stage, if given
  std::function<void(std::string_view)> stage;  // called at the start of each stage with its name, if given
};

/// The outcome of a report.
struct ReportOutcome {
  bool pictures;                // false: numbers and text are complete, the figures are missing
  std::string message;          // one or two sentences: where the report is, or what to install for the pictures
  std::filesystem::path index;  // the page, out/index.html
};

/// Writes out/index.html (self-contained), out/figures (SVG, PNG and the gnuplot scripts that made them), out/tables
/// (CSV) and out/results.json.  All of it is made in a hidden folder and moved into place at the end, so nothing is
/// left half-written; only files that a report writes are replaced.
/// @throws std::invalid_argument  both data and scene given, or `out` cannot be written; found before any computation.
/// @throws io::DataError  a data or scene file that cannot be read or parsed.
/// @throws std::runtime_error  a file cannot be written in full, e.g. the disk is full; the text gives the cause.
[[nodiscard]] ReportOutcome write_report(const ReportOptions& options);

}  // namespace report
