// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "fit_request.hpp"
#include "frac/identification/time_fit.hpp"

namespace fracfit {

/// Options that concern samples over time alone, as given; empty when not.
struct TimeRequest {
  std::string hold, offset, input_at_rest;
};
void add_time_options(CLI::App& subcommand, TimeRequest& request);

/// @throws std::invalid_argument  one of them was given, while the data are a frequency response.
void refuse_time_options(const TimeRequest& request);
/// @throws std::invalid_argument  an option was given that has no meaning for samples over time.
void refuse_frequency_options(const FitRequest& request);

/// Options of the fit.  A constraint on the offset is understood as --offset is.
/// @throws std::invalid_argument  naming the option.
[[nodiscard]] frac::TimeFitOptions time_fit_options(const FitRequest& request, const TimeRequest& over_time,
                                                    std::vector<frac::ParameterConstraint> constraints);

/// A file of samples over time; of its outputs those count that --where lets pass.
struct TimeRecord {
  frac::TimeResponseData data;
  io::Metadata header;
  std::string weight;  // given or absolute
};
/// Notes on what was assumed go to standard error.
/// @throws io::DataError  data that no fit can use;  std::invalid_argument  naming the option.
[[nodiscard]] TimeRecord read_time_record(const FitRequest& request, const TimeRequest& over_time,
                                          const CommonOptions& common);

/// Adds the options to the command line, every default spelled out.
void append_to(CommandLine& command, const FitRequest& request, const TimeRecord& record,
               const frac::TimeFitOptions& options);

/// What the outputs say of where a result came from.
[[nodiscard]] FitRun time_fit_run(const FitRequest& request, const TimeRecord& record,
                                  const frac::TimeFitOptions& options, std::string command);

}  // namespace fracfit
