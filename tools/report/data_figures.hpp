// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "frac/identification/identify.hpp"
#include "frac/model/frequency_response_data.hpp"
#include "report/field.hpp"
#include "report/figure.hpp"
#include "report/table.hpp"

namespace report {

/// The pictures of one measured response and their numbers.
struct MeasuredPictures {
  Figure response;   // data with the three best fits, as the field draws them, and their distance
  Figure residuals;  // of the chosen structure
  Table values;      // every number that the two show
};

/// @param name       stem of the names
/// @param component  that was fitted: both, or imaginary, which is then all that is drawn
/// @param field      not automatic
/// @param unit       of the data, as the file writes it
[[nodiscard]] MeasuredPictures draw_measured(const std::string& name, const frac::FrequencyResponseData& data,
                                             frac::Component component, const frac::IdentificationResult& result,
                                             Field field, const std::string& unit);

}  // namespace report
