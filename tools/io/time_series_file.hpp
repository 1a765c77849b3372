// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "frac/model/time_response_data.hpp"
#include "io/measurement.hpp"
#include "io/point_filter.hpp"
#include "io/text_table.hpp"

namespace io {

/// Samples over time, as in the file.
struct TimeSeries {
  std::vector<double> time;  // s, strictly increasing
  std::vector<double> input;
  std::vector<double> output;     // empty where none was asked for
  std::vector<double> sigma;      // of the output; empty where the file gives none
  std::vector<std::size_t> kept;  // indices of the samples that satisfy the conditions, rising
  Metadata metadata;
  std::vector<std::string> notes;  // what was assumed or left out, a sentence each
};

/// Whether the file has a column of times and one of outputs, and none of frequencies: data for a fit over time.
/// @throws DataError  as TextTable.
[[nodiscard]] bool holds_time_response(const std::string& file, const MeasurementOptions& how = {});

/// Reads the columns time (time, t with unit s, ms, us, min or h; without one: s), input (input, u), and output
/// (output, y) with an optional standard deviation (sigma, std, uncertainty); units of these are not interpreted.
/// @throws DataError  as TextTable; a column missing or given twice; a unit of time not understood; a field that is no
///                    finite number; time that does not increase; a standard deviation that is not positive.
/// @throws std::invalid_argument  a condition on a column that the file does not have.
[[nodiscard]] TimeSeries read_time_response(const std::string& file, const std::vector<SampleFilter>& where = {});
/// The same without output and sigma.
[[nodiscard]] TimeSeries read_input_signal(const std::string& file);

/// The samples of read_time_response() as data of a fit.
/// @throws DataError  fewer than two samples, or an input that stays at its value at rest.
[[nodiscard]] frac::TimeResponseData time_response_data(const std::string& file, TimeSeries series,
                                                        frac::Hold hold = frac::Hold::zero_order,
                                                        double input_at_rest = 0);

}  // namespace io
