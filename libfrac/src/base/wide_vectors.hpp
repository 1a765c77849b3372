// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <new>
#include <vector>

#include "instruction_set.hpp"

#define FRACFIT_INLINE __attribute__((always_inline))

namespace frac::detail {

// Each holds a copy of the work that was compiled for its instruction set.  The work has to be FRACFIT_INLINE, and so
// has every function in it that must not be left behind in the plain set.
#if defined(__x86_64__)
template <typename Work>
__attribute__((target("avx2,fma"))) decltype(auto) run_in_avx2(const Work& work) {
  return work();
}
template <typename Work>
__attribute__((target("avx512f"))) decltype(auto) run_in_avx512(const Work& work) {
  return work();
}
#endif

/// work() with the widest registers of instruction_set().
template <typename Work>
decltype(auto) with_wide_vectors(const Work& work) {
#if defined(__x86_64__)
  const InstructionSet set = instruction_set();
  if (set == InstructionSet::avx512) return run_in_avx512(work);
  if (set == InstructionSet::avx2) return run_in_avx2(work);
#endif
  return work();
}

/// work() with fused multiply-add where instruction_set() has it, in registers of the usual width.
template <typename Work>
decltype(auto) with_fused_operations(const Work& work) {
#if defined(__x86_64__)
  if (instruction_set() != InstructionSet::plain) return run_in_avx2(work);
#endif
  return work();
}

/// Doubles side by side, at any address.  GCC keeps sums in registers only if these are vectors by name, of the width
/// that the instruction set has.  A reference to them has to name their type: one declared with auto forgets that they
/// may lie anywhere, and reading through it ends the program.
template <std::size_t width>
struct Doubles {
  typedef double Type __attribute__((vector_size(width * sizeof(double)), aligned(alignof(double)), may_alias));
  static FRACFIT_INLINE inline Type& at(double* place) { return *reinterpret_cast<Type*>(place); }
  static FRACFIT_INLINE inline const Type& at(const double* place) { return *reinterpret_cast<const Type*>(place); }
};

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
