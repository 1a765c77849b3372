// SPDX-License-Identifier: BSD-3-Clause
#include "filter_kernel.hpp"

#include "base/instruction_set.hpp"
#include "filter_kernel_loops.hpp"

namespace frac::detail {
namespace {

FilterLoop chosen() {
#if defined(__x86_64__)
  if (instruction_set() == InstructionSet::avx512) return avx512_filter_loop();
  if (instruction_set() == InstructionSet::avx2) return avx2_filter_loop();
#endif
  return Loops<16>::run;
}

}  // namespace

void run_filter(const FilterArrays& arrays, const FilterInput* input, double offset, std::size_t blocks,
                double* output) noexcept {
  static const FilterLoop loop = chosen();
  loop(arrays, input, offset, blocks, output);
}

}  // namespace frac::detail
