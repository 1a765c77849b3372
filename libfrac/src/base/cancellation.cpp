// SPDX-License-Identifier: BSD-3-Clause
#include "frac/cancellation.hpp"

namespace frac {
namespace {

thread_local const std::atomic<bool>* watched = nullptr;

}  // namespace

CancellationScope::CancellationScope(const std::atomic<bool>* flag) noexcept : outer_(watched) {
  watched = flag;
}

CancellationScope::~CancellationScope() {
  watched = outer_;
}

const std::atomic<bool>* cancellation_flag() noexcept {
  return watched;
}

bool is_cancelled() noexcept {
  return watched != nullptr && watched->load(std::memory_order_relaxed);
}

void throw_if_cancelled() {
  if (is_cancelled()) throw Cancelled();
}

}  // namespace frac
