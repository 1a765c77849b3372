#pragma once

#include <string>

#include "frac/identification/fit.hpp"
#include "frac/identification/identify.hpp"
#include "io/text_table.hpp"

namespace fracfit {

/// What a fit or an identification was made from.
struct FitRun {
  std::string command;
  std::string file;
  std::size_t points;
  double omega_lower, omega_upper;  // rad/s
  std::string value_unit;           // empty when the file gives none
  io::Metadata file_header;         // "# key: value" lines of the data file
  io::Metadata options;
};

// Tables for people.
[[nodiscard]] std::string fit_table(const FitRun& run, const frac::FitResult& result);
[[nodiscard]] std::string identification_table(const FitRun& run, const frac::IdentificationResult& result);

// CSV: version, command and options as "# key: value" lines, then one row per parameter or candidate.
[[nodiscard]] std::string fit_csv(const FitRun& run, const frac::FitResult& result);
[[nodiscard]] std::string identification_csv(const FitRun& run, const frac::IdentificationResult& result);

}  // namespace fracfit
