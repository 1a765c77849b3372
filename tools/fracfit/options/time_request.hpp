// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "frac/identification/time_fit.hpp"
#include "options/fit_request.hpp"

namespace fracfit {

/// Options that concern samples over time alone.
struct TimeRequest {
  frac::Hold hold = frac::Hold::zero_order;
  std::string offset = "free";
  double input_at_rest = 0;
  bool trend = false, earlier_input = false;
  frac::RecordNoise noise = frac::RecordNoise::white;
};
void add_time_options(Options& options, TimeRequest& request);

/// Options of the fit.  A constraint on the offset is understood as --offset is, and told so in the command line.
/// @throws std::invalid_argument  naming the option.
[[nodiscard]] frac::TimeFitOptions time_fit_options(const FitRequest& request, const TimeRequest& over_time,
                                                    Options& given, std::vector<frac::ParameterConstraint> constraints);

/// A file of samples over time; of its outputs those count that --where lets pass.
struct TimeRecord {
  frac::TimeResponseData data;
  io::Metadata header;
  std::string weight;  // given or absolute
};
/// `note` is told what was assumed.
/// @param weight_is_told  whether the weight of the request is to be taken for records
/// @throws io::DataError  data that no fit can use;  std::invalid_argument  naming the option.
[[nodiscard]] TimeRecord read_time_record(const FitRequest& request, const TimeRequest& over_time, bool weight_is_told,
                                          const std::function<void(const std::string&)>& note);
/// The same; the weight that was taken is what the command line says from then on.
[[nodiscard]] TimeRecord read_time_record(const FitRequest& request, const TimeRequest& over_time, Options& options,
                                          const std::function<void(const std::string&)>& note);

/// What the outputs say of where a result came from.
[[nodiscard]] FitRun time_fit_run(const FitRequest& request, const TimeRecord& record, const Options& options,
                                  std::string command);

}  // namespace fracfit
