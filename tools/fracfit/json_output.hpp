// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "backlash/describing_function.hpp"
#include "backlash/identification/jump_law.hpp"
#include "fit_output.hpp"
#include "fit_statistics.hpp"
#include "frac/identification/identify.hpp"
#include "io/sweep_file.hpp"
#include "jump_law_output.hpp"

namespace fracfit {

// JSON texts; a number that is not finite is written as null.
[[nodiscard]] std::string sweep_json(const backlash::DescribingFunctionSweep& sweep, const std::string& command);
[[nodiscard]] std::string sweeps_json(const std::vector<backlash::DescribingFunctionSweep>& sweeps,
                                      const std::string& command);
[[nodiscard]] std::string static_curve_json(const io::StaticCurve& curve, const std::string& command);
[[nodiscard]] std::string fit_json(const FitRun& run, const frac::FitResult& result, const FitStatistics& statistics);
[[nodiscard]] std::string identification_json(const FitRun& run, const frac::IdentificationResult& result,
                                              const std::vector<double>& prediction_rms);
[[nodiscard]] std::string jump_law_json(const JumpLawRun& run, const backlash::JumpLaw& law);
[[nodiscard]] std::string jump_constants_json(const std::string& command, const backlash::JumpGrid& grid);

}  // namespace fracfit
