// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "frac/records/record.hpp"

namespace frac::detail {

/// Samples up to which a record is transformed as it is: some tenths of a second. Longer ones are folded where they can
/// be.
constexpr std::size_t long_record = 1 << 17;

/// The period as a whole number of samples, where many of them differ from it by rounding alone; else 0.
[[nodiscard]] std::size_t whole_samples(double period, std::size_t samples);

/// Mean of `blocks` stretches of `length` samples that follow one another up to the end `end` of the signal.  Its
/// Fourier sum is every `blocks`-th line of that of all of them.
[[nodiscard]] std::vector<double> mean_of_blocks(const std::vector<double>& signal, std::size_t end, std::size_t length,
                                                 std::size_t blocks);

/// Record of fewer periods that stands for a long one.
struct FoldedRecord {
  Record record;
  std::size_t blocks;
};

/// Samples first to first + count - 1 of a long record, folded to 50 periods or more: as many as leave the noise
/// between the lines resolved to a fiftieth of their distance.  Nothing of a short record, of fewer than 100 periods,
/// and of a period that is no whole number of samples.
[[nodiscard]] std::optional<FoldedRecord> folded(const Record& record, std::size_t first, std::size_t count,
                                                 double period);

/// Of a long signal: whether whole periods as they are leave as little between their lines as any period near them
/// does. The phases of the lines of the mean periods of both halves tell by how much the signal runs away; that may
/// cost a half per cent of what is between the lines.
[[nodiscard]] bool keeps_to(const std::vector<double>& signal, std::size_t period);

}  // namespace frac::detail
