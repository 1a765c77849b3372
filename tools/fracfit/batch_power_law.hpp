#pragma once

#include <string>
#include <vector>

#include "batch_table.hpp"

namespace fracfit {

/// A parameter of the fits as a power of an entry of the file headers.
struct PowerLawRequest {
  std::string parameter, variable;
};
/// From PARAMETER:VARIABLE. @throws std::invalid_argument
[[nodiscard]] PowerLawRequest power_law_request(const std::string& text);

/// The laws of the manifest as lines below the rows, each over the rows that converged, identified the parameter, and
/// know the variable.
[[nodiscard]] std::string power_law_remarks(BatchFormat format, const BatchManifest& manifest,
                                            const std::vector<std::string>& lines);

}  // namespace fracfit
