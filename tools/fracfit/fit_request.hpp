// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common_options.hpp"
#include "fit_output.hpp"
#include "frac/identification/fit.hpp"
#include "io/frequency_response_file.hpp"

namespace fracfit {

/// What fit and identify have in common: the data and how residuals are formed.
struct FitRequest {
  std::string data;
  std::string component;
  std::string weight = "relative";
  bool weight_is_given = false;  // by the user
  std::string loss = "none";
  std::string realisation = "exact";
  std::string band, poles, sample_time, memory;
  std::vector<std::string> where;
  std::string seed = "1";
  std::string key_column, curve;  // which curve of a file that holds several
};

[[nodiscard]] std::uint64_t seed_of(const FitRequest& request);

void add_fit_options(CLI::App& subcommand, FitRequest& request);
/// Those without the data.
void add_residual_options(CLI::App& subcommand, FitRequest& request);

/// The options without constraints. @throws std::invalid_argument  naming the option.
[[nodiscard]] frac::FitOptions fit_options(const FitRequest& request);

/// Reads the data; notes on what was assumed go to standard error.
[[nodiscard]] io::FrequencyResponseFile read_data(const FitRequest& request, const CommonOptions& common);

/// Adds data and options to the command line.
void append_to(CommandLine& command, const FitRequest& request, const frac::FitOptions& options);

/// What the outputs say of where a result came from.
[[nodiscard]] FitRun fit_run(const FitRequest& request, const frac::FitOptions& options,
                             const io::FrequencyResponseFile& file, std::string command);

}  // namespace fracfit
