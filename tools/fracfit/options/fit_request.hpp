// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "backlash/minus_inverse.hpp"
#include "frac/identification/fit.hpp"
#include "frac/identification/outliers.hpp"
#include "io/frequency_response_file.hpp"
#include "options/command.hpp"
#include "options/data_options.hpp"
#include "output/fit_output.hpp"

namespace fracfit {

/// What fit, identify and batch have in common: the data and how residuals are formed.
struct FitRequest {
  std::string data;
  std::optional<backlash::Quantity> quantity;
  frac::Component component = frac::FitOptions{}.component;
  /// Where --component says so: both parts of the data as this one, and models of it.
  std::optional<io::Immittance> immittance;
  std::string weight{frac::to_string(frac::FitOptions{}.weight)};
  frac::Loss loss = frac::Loss::none;
  std::string realisation = "exact";
  std::optional<frac::FrequencyBand> band;
  std::optional<std::size_t> poles;
  std::optional<double> sample_time;
  std::size_t memory = 0;
  std::vector<std::string> where;
  std::uint64_t seed = 1;
  std::string outliers = "leave-out";
  std::string stable, dead_time;  // yes, no or empty
  bool passive = false;
  bool without_noise = false;     // as the header of the data says, see io::is_computed()
  std::string key_column, curve;  // which curve of a file that holds several
  io::MeasurementOptions how;     // what the file does not tell of itself
};

void add_data(Options& options, FitRequest& request);
void add_residual_options(Options& options, FitRequest& request);
/// --stable, --dead-time and --passive.
void add_assumptions(Options& options, FitRequest& request);
/// --where and --seed.
void add_points_and_seed(Options& options, FitRequest& request);

/// --outliers, with one meaning wherever residuals are formed.
void add_outliers(Options& options, FitRequest& request);

/// The options without constraints. @throws std::invalid_argument  naming the option.
[[nodiscard]] frac::FitOptions fit_options(const FitRequest& request);

/// Reads the data; `note` is told what was assumed.
[[nodiscard]] io::FrequencyResponseFile read_data(const FitRequest& request,
                                                  const std::function<void(const std::string&)>& note);
/// The same of a file that is already open.
[[nodiscard]] io::FrequencyResponseFile read_data(const FitRequest& request, const io::Measurement& measurement,
                                                  const std::function<void(const std::string&)>& note);

/// Puts the component that is fitted in the place of the one that was asked for, in the command line too, see
/// frac::fitted_component(); `note` is told where it is another.
void settle_component(FitRequest& request, Options& options, const frac::FrequencyResponseData& data,
                      const std::function<void(const std::string&)>& note);

/// Takes --weight given where it was not told and the data have deviations that were measured; `note` is told so.
void settle_weight(FitRequest& request, Options& options, const io::FrequencyResponseFile& file,
                   const std::function<void(const std::string&)>& note);
/// What is said then.
constexpr const char* weighed_by_measured_sigma =
    "residuals are divided by sigma, which was measured; --weight says otherwise";

/// Tests of --where as one text, the entry that outputs show.
[[nodiscard]] std::string where_text(const FitRequest& request);

/// The data without the points that --outliers leaves out; `note` is told of them.
[[nodiscard]] frac::ScreenedData screened(const FitRequest& request, const frac::FrequencyResponseData& data,
                                          const std::function<void(const std::string&)>& note);

/// What the outputs say of where a result came from.
/// @param left_out  indices of the file's data
[[nodiscard]] FitRun fit_run(const FitRequest& request, const Options& options, const io::FrequencyResponseFile& file,
                             const std::vector<std::size_t>& left_out, std::string command);

}  // namespace fracfit
