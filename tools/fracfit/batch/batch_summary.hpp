// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "batch/batch_table.hpp"

namespace fracfit {

/// The rows of a batch for people to read, a line each: what became of the file, its residuals and its parameters with
/// half the width of their intervals; behind them the messages of files without a result.  Everything else stands in
/// the CSV.
/// @param lines  of the CSV, without its header
[[nodiscard]] std::string summary_of_rows(const BatchManifest& manifest, const std::vector<std::string>& lines);

}  // namespace fracfit
