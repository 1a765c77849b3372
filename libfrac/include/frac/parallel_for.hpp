// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <cstddef>
#include <functional>

namespace frac {

/// Work done and to do, for a caller who watches a long computation from another thread.
struct Progress {
  std::atomic<std::size_t> done = 0;
  std::atomic<std::size_t> total = 0;
};

/// Calls body(i) for i = 0 .. count-1 on `threads` threads (0: one per core), the calling one among them.  Each index
/// runs exactly once, so results written by index do not depend on the number of threads.  When a body throws, no
/// further index is begun, and the exception of the lowest failing index, the one a serial loop would meet, is rethrown
/// after all ended.
/// @throws std::invalid_argument  threads < 0.
void parallel_for(std::size_t count, int threads, const std::function<void(std::size_t)>& body);

}  // namespace frac
