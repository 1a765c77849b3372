// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "frac/identification/economy.hpp"
#include "frac/identification/fit.hpp"
#include "frac/identification/identify.hpp"
#include "frac/identification/validate.hpp"
#include "io/text_table.hpp"
#include "output/fit_statistics.hpp"

namespace fracfit {

/// A point that a fit has left out.
struct LeftOutPoint {
  std::size_t index;  // of the data read
  double omega;       // rad/s
};

/// What a fit or an identification was made from.
struct FitRun {
  std::string command;
  std::string file;
  std::size_t points;        // read, those left out among them
  double lower, upper;       // of omega, rad/s, or of time, s
  std::string value_unit;    // empty when the file gives none
  io::Metadata file_header;  // "# key: value" lines of the data file
  io::Metadata options;
  bool over_time = false;
  std::optional<frac::ValidationResult> validity = {};  // of a frequency response of which both parts are fitted
  std::string validity_sentence = {};
  std::optional<frac::Economy> economy = {};                            // of data without noise
  std::vector<LeftOutPoint> left_out = {};                              // index rising
  frac::FrequencyUnit frequency_unit = frac::FrequencyUnit::rad_per_s;  // of the file
  std::optional<frac::Assumptions> assumptions = {};                    // of a frequency response
  std::string law = {};  // what the model says in words, where its formula does not; see component_power_law
};

// Tables for people.  prediction_rms: of cross-validation, one per candidate of the ranking; empty when not asked for.
[[nodiscard]] std::string fit_table(const FitRun& run, const frac::FitResult& result, const FitStatistics& statistics);
[[nodiscard]] std::string identification_table(const FitRun& run, const frac::IdentificationResult& result,
                                               const std::vector<double>& prediction_rms);

// CSV: version, command and options as "# key: value" lines, then one row per parameter or candidate.
[[nodiscard]] std::string fit_csv(const FitRun& run, const frac::FitResult& result, const FitStatistics& statistics);
[[nodiscard]] std::string identification_csv(const FitRun& run, const frac::IdentificationResult& result,
                                             const std::vector<double>& prediction_rms);

[[nodiscard]] std::string fit_json(const FitRun& run, const frac::FitResult& result, const FitStatistics& statistics);
[[nodiscard]] std::string identification_json(const FitRun& run, const frac::IdentificationResult& result,
                                              const std::vector<double>& prediction_rms);

}  // namespace fracfit
