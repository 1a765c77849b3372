// SPDX-License-Identifier: BSD-3-Clause
#include "filter_kernel.hpp"

#include "filter_kernel_loops.hpp"

namespace frac::detail {
namespace {

FilterLoop chosen() {
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl")) {
    return avx512_filter_loop();
  }
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) return avx2_filter_loop();
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
