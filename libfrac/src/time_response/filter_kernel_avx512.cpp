// SPDX-License-Identifier: BSD-3-Clause
#include "filter_kernel_loops.hpp"

#if defined(__x86_64__)
namespace frac::detail {

FilterLoop avx512_filter_loop() noexcept {
  return Loops<64>::run;
}

}  // namespace frac::detail
#endif
