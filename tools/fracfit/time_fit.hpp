#pragma once

#include <string>

#include "fit_request.hpp"
#include "model_choice.hpp"

namespace fracfit {

/// Options of fit that concern samples over time alone, as given; empty when not.
struct TimeFitRequest {
  std::string hold, offset, input_at_rest;
};
void add_time_fit_options(CLI::App& subcommand, TimeFitRequest& request);

/// Fits `model` to samples of input and output and writes the result. @return the exit code
/// @throws std::invalid_argument  an option that has no meaning for data over time.
[[nodiscard]] int run_time_fit(const io::OutputFile& out, const CommonOptions& common, const FitRequest& request,
                               const TimeFitRequest& over_time, const std::string& model,
                               const ParameterOptions& parameters);

}  // namespace fracfit
