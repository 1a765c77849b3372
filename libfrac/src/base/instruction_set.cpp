// SPDX-License-Identifier: BSD-3-Clause
#include "instruction_set.hpp"

#include <algorithm>
#include <cstdlib>

namespace frac::detail {

InstructionSet processor_instruction_set() noexcept {
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) {
    const bool has_512 =
        __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl");
    return has_512 ? InstructionSet::avx512 : InstructionSet::avx2;
  }
#endif
  return InstructionSet::plain;
}

InstructionSet limited_to(std::string_view name, InstructionSet known) noexcept {
  if (name == "sse2") return InstructionSet::plain;
  if (name == "avx2") return std::min(known, InstructionSet::avx2);
  return known;
}

InstructionSet instruction_set() noexcept {
  static const InstructionSet choice = [] {
    const char* const name = std::getenv("FRACFIT_INSTRUCTION_SET");
    return limited_to(name == nullptr ? "" : name, processor_instruction_set());
  }();
  return choice;
}

}  // namespace frac::detail
