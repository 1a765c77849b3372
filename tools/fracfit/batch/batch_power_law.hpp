// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "batch/batch_table.hpp"

namespace fracfit {

/// A parameter of the fits as a power of an entry of the file headers.
struct PowerLawRequest {
  std::string parameter, variable;
};
/// From PARAMETER:VARIABLE. @throws std::invalid_argument
[[nodiscard]] PowerLawRequest power_law_request(const std::string& text);

struct PowerLawRemarks {
  std::string text;                // lines below the rows
  std::vector<std::string> notes;  // of rows left out, laws through two points or none; one sentence each
};

/// The laws of the manifest, each over the rows that converged, identified the parameter, and know the variable, both
/// positive.
[[nodiscard]] PowerLawRemarks power_law_remarks(BatchFormat format, const BatchManifest& manifest,
                                                const std::vector<std::string>& lines);

}  // namespace fracfit
