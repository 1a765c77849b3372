// SPDX-License-Identifier: BSD-3-Clause
#include "base/instruction_set.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <string_view>

namespace {

using frac::detail::InstructionSet;
using frac::detail::limited_to;

constexpr InstructionSet all[] = {InstructionSet::plain, InstructionSet::avx2, InstructionSet::avx512};

// A set beyond the processor's would end the program with an illegal instruction.
TEST(InstructionSet, IsNeverBeyondTheProcessors) {
  for (const InstructionSet known : all) {
    for (const std::string_view name : {"sse2", "avx2", "avx512", "", "AVX2", "neon"}) {
      EXPECT_LE(limited_to(name, known), known) << name;
    }
  }
}

TEST(InstructionSet, IsTheNamedOneWhereTheProcessorHasIt) {
  EXPECT_EQ(limited_to("sse2", InstructionSet::avx512), InstructionSet::plain);
  EXPECT_EQ(limited_to("avx2", InstructionSet::avx512), InstructionSet::avx2);
  EXPECT_EQ(limited_to("avx512", InstructionSet::avx512), InstructionSet::avx512);
}

TEST(InstructionSet, AnyOtherNameChangesNothing) {
  for (const InstructionSet known : all) {
    for (const std::string_view name : {"", "AVX2", "neon"}) EXPECT_EQ(limited_to(name, known), known) << name;
  }
}

TEST(InstructionSet, TheEnvironmentNamesIt) {
  const char* const name = std::getenv("FRACFIT_INSTRUCTION_SET");
  const InstructionSet known = frac::detail::processor_instruction_set();
  EXPECT_EQ(frac::detail::instruction_set(), name == nullptr ? known : limited_to(name, known));
}

}  // namespace
