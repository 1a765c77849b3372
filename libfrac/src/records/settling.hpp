// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

#include "frac/records/record.hpp"

namespace frac::detail {

/// Where under a steady sine the response is steady too.
struct Settling {
  std::size_t cycles = 0;         // whole ones of the record
  std::size_t cut = 0;            // of them, at the beginning, in which the response still settles; at most half
  std::size_t changes_after = 0;  // cycle after which the response changes in what is left; 0: it does not
};

/// Judges the ratio of each output to the input, cycle by cycle.
///
/// A cycle of the first half belongs to the settling where its ratio departs from the mean of the second half by more
/// than their scatter explains, and so do all before it.  What is left changes where the means before and after some
/// cycle differ by more than the scatter about them explains; a change in the first half ends the settling.  Both are
/// tests of Fisher's distribution, wrong about steady responses in white noise once in 1000 segments each.  Fewer than
/// six cycles, or four samples in each, tell nothing.
/// @param period  of the input in samples
[[nodiscard]] Settling settling_of(const Record& record, double period);

}  // namespace frac::detail
