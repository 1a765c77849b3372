// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "io/frequency_response_file.hpp"

namespace fracfit {

/// One of the curves of a file; the name is empty where the file holds one.
struct MeasuredCurve {
  std::string name;
  io::FrequencyResponseFile file;
};

/// Every sweep, curve and scene of a file, or the one selected.
[[nodiscard]] std::vector<MeasuredCurve> read_curves(const std::string& file, const io::MeasurementOptions& how,
                                                     std::optional<backlash::Quantity> quantity = {},
                                                     std::optional<io::Immittance> immittance = {});

/// What was assumed, ignored or sorted while the curves were read, each sentence once.
[[nodiscard]] std::vector<std::string> notes_of(const std::vector<MeasuredCurve>& curves);

}  // namespace fracfit
