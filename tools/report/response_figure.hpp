// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "frac/records/response.hpp"
#include "report/figure.hpp"

namespace report {

/// A response with its 95 % bars, and below it in the same panel the noise and the distortion of each point; its phase;
/// of arbitrary inputs the coherence.
/// @param labels  of the outputs
/// @param unit    of the response as file headers write it; empty: none
[[nodiscard]] Figure response_figure(const frac::ResponseEstimate& estimate, const std::vector<std::string>& labels,
                                     const std::string& unit);

}  // namespace report
