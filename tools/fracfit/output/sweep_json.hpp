// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "backlash/describing_function.hpp"
#include "io/sweep_file.hpp"

namespace fracfit {

[[nodiscard]] std::string sweep_json(const backlash::DescribingFunctionSweep& sweep, const std::string& command);
[[nodiscard]] std::string sweeps_json(const std::vector<backlash::DescribingFunctionSweep>& sweeps,
                                      const std::string& command);
[[nodiscard]] std::string static_curve_json(const io::StaticCurve& curve, const std::string& command);

}  // namespace fracfit
