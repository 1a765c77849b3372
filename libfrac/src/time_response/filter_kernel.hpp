// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

namespace frac::detail {

inline constexpr std::size_t filter_block = 32;    // samples
inline constexpr std::size_t filter_lane = 8;      // states that lie together
inline constexpr std::size_t filter_together = 8;  // blocks, at most

/// A filter for whole blocks of samples, all of it linear: the output of a block from the states before it, from the
/// samples of the input and from a few further numbers; the states after it from the same.
/// States come in lanes of eight, either of real ones or of four real parts and four imaginary parts, so that the
/// partner of state s is s ^ 4.  A matrix has its columns in lanes of eight, one lane after the other and in it one row
/// after the other.
struct FilterArrays {
  std::size_t first, size;     // what lies before first rests at 0; multiples of the lane
  std::size_t extra;           // further numbers
  const double* change;        // by state: what multiplies it from block to block, less 1
  const double* cross;         // by state: what multiplies its partner
  const double* state_output;  // matrix by state and sample of the output
  const double* drive;         // matrix by sample of the input and state
  const double* kernel;        // response to one sample of the input, after a block of zeros
  const double* extra_output;  // matrix by further number and sample of the output
  const double* extra_drive;   // matrix by further number and state
  double* state;
  double* before;  // room for the states before each block
};

/// Input of `filter_block` samples per block, one block after the other, and `extra` numbers per block.
struct FilterInput {
  const double* samples;
  const double* extra;
};

using FilterLoop = void (*)(const FilterArrays&, const FilterInput*, double offset, std::size_t blocks, double* output);

/// One to `filter_together` blocks; without an input (null) the states just decay.  `offset` is added to the output.
void run_filter(const FilterArrays& arrays, const FilterInput* input, double offset, std::size_t blocks,
                double* output) noexcept;

}  // namespace frac::detail
