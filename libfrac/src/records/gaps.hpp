// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "frac/records/response.hpp"

namespace frac::detail {

/// Stretches of a record without a gap within, in order of time: those that make a record of their own.
[[nodiscard]] std::vector<Record> stretches(const Record& record);

/// All stretches as one record, each from where a whole number of periods has passed since the end of the one before:
/// a motion that repeats itself goes on there.  Of an input that is sampled at another place in its period both sides
/// are late alike, and their ratio stays.
/// @param period  samples
[[nodiscard]] Record joined(const Record& record, std::size_t period);

/// Joins the points of the same segment of a stepped sine before and after a gap, of all outputs, where the end of
/// `before` and the beginning of `after` have one frequency and one amplitude; weights are the cycles.  Values that
/// differ by more than their errors explain (chance 1e-3) get a flag.  The points of `after` join those of `before`.
void join_segments(const std::vector<std::vector<ResponsePoint>>& after,
                   std::vector<std::vector<ResponsePoint>>& before);

}  // namespace frac::detail
