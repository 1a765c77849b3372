#pragma once

#include <optional>
#include <string>
#include <vector>

#include "frac/frequency_response_data.hpp"
#include "io/point_filter.hpp"
#include "io/text_table.hpp"

namespace io {

struct FrequencyResponseReadOptions {
  /// Column that weighs the points: a name beginning with sigma, std, standard_deviation or uncertainty holds standard
  /// deviations, any other name weights of the squared residuals (sigma = 1/sqrt(weight)).  Unset: a column named sigma
  /// or weight, if there is one.
  std::optional<std::string> weight_column;
  /// A point is kept when all of these hold.
  std::vector<PointFilter> where;
};

struct FrequencyResponseFile {
  frac::FrequencyResponseData data;  // omega in rad/s, rising; values in the unit of the file
  Metadata metadata;
  std::string value_unit;          // as written in the header, e.g. "m_per_n"; empty when the header gives none
  std::vector<std::string> notes;  // what was assumed, ignored, converted or sorted, one sentence each
};

/// Reads a measured or simulated frequency response.
///
/// Columns are recognised by name, upper or lower case, units after an underscore or in brackets:
///   frequency  omega, w, angular_frequency [rad/s, krad/s];  f, freq, frequency [Hz, kHz, MHz, GHz, mHz, rad/s]
///   value      re, real, re_<unit> and im, imag, im_<unit> (or -im: the negative is stored);
///              or magnitude, mag, abs, gain [any unit or dB] with phase, arg, angle [deg, rad]
///   optional   sigma or weight
/// Units are taken from the names alone, never from the values.  Other columns are ignored.
/// @throws DataError  as TextTable; a column missing, of unknown unit, or doubled; a field that is no finite number or
/// not in its
///                    range; no point left after the filter.
/// @throws std::invalid_argument  options.weight_column is no column of the file.
[[nodiscard]] FrequencyResponseFile read_frequency_response(const std::string& file,
                                                            const FrequencyResponseReadOptions& options = {});

}  // namespace io
