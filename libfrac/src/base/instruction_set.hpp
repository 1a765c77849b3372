// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string_view>

namespace frac::detail {

/// Instruction sets that loops are compiled for, each containing those before it.
enum class InstructionSet {
  plain,  ///< what the compiler takes for granted: SSE2 on x86-64
  avx2,   ///< AVX2 and FMA
  avx512  ///< AVX-512 F, DQ and VL
};

/// The largest set that this processor knows.
[[nodiscard]] InstructionSet processor_instruction_set() noexcept;

/// The set named sse2 (plain), avx2 or avx512 if it lies below `known`, and `known` with every other name.
[[nodiscard]] InstructionSet limited_to(std::string_view name, InstructionSet known) noexcept;

/// The set that every loop with more than one form is run in: the processor's, limited to the one that the environment
/// variable FRACFIT_INSTRUCTION_SET names.  Tests set it.  It is read once.
[[nodiscard]] InstructionSet instruction_set() noexcept;

}  // namespace frac::detail
