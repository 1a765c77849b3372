// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>

#include "frac/identification/relaxation_times.hpp"
#include "frac/model/frequency_response_data.hpp"
#include "report/figure.hpp"

namespace report {

/// Density over the time, areas of lines as points, and the range where the distribution has one.
void add_times(const std::string& label, std::size_t colour, const frac::TimesDistribution& times, bool with_range,
               Panel& panel);
/// The times within the band of the data.  What is drawn beyond is the prior's: the data do not tell a faster density
/// from the constant, nor a slower one from the elastance.
[[nodiscard]] frac::TimesDistribution within_band(frac::TimesDistribution times,
                                                  const frac::FrequencyResponseData& data);
/// Extends the axis so that ranges stay in the picture, up to twice the highest summit.
void make_room_for_ranges(Panel& panel);

/// The distribution of an impedance without a model; nothing where none follows the data.
/// @param unit  as on axes
[[nodiscard]] std::optional<Figure> times_figure(const std::string& name, const frac::FrequencyResponseData& data,
                                                 const std::string& unit);

}  // namespace report
