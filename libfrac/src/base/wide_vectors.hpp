// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <new>
#include <vector>

// Copies of a function for processors with wider registers, chosen when the program is loaded.
#if defined(__x86_64__) && defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define FRACFIT_WIDE_VECTORS __attribute__((target_clones("avx512f", "fma", "default")))
#else
#define FRACFIT_WIDE_VECTORS
#endif

namespace frac::detail {

/// Memory that begins where a wide register's begins: a load across two lines of the cache costs two.
template <typename Value>
struct LineAllocator {
  using value_type = Value;
  static constexpr std::align_val_t line{64};

  LineAllocator() = default;
  template <typename Other>
  explicit(false) LineAllocator(const LineAllocator<Other>&) noexcept {}
  [[nodiscard]] Value* allocate(std::size_t count) {
    return static_cast<Value*>(::operator new(count * sizeof(Value), line));
  }
  void deallocate(Value* place, std::size_t) noexcept { ::operator delete(place, line); }
  template <typename Other>
  bool operator==(const LineAllocator<Other>&) const noexcept {
    return true;
  }
};

template <typename Value>
using AlignedVector = std::vector<Value, LineAllocator<Value>>;

}  // namespace frac::detail
