// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cstring>
#include <vector>

#include "base/instruction_set.hpp"
// The loops as compiled here, for any processor.
#include "digital/section_kernel_loops.hpp"
#include "support/random.hpp"

namespace {

using frac::detail::InstructionSet;
using frac::detail::SectionArrays;
using frac::detail::SectionKernels;

template <typename Real>
struct Bank {
  std::vector<Real> rate, weight, state, lost;
  explicit Bank(std::size_t size) : rate(size), weight(size), state(size), lost(size) {
    support::Random random(size);
    for (std::size_t i = 0; i < size; ++i) {
      rate[i] = static_cast<Real>(random.log_uniform(1e-9, 1.9));
      weight[i] = static_cast<Real>(random.normal());
    }
  }
  SectionArrays<Real> arrays() { return {rate.data(), weight.data(), state.data(), lost.data(), rate.size()}; }
};

// Single steps of both kinds, then blocks of both kinds; all outputs and states in one list.
template <typename Real>
std::vector<Real> exercised(const SectionKernels<Real>& kernels, std::size_t size) {
  Bank<Real> bank(size);
  const auto arrays = bank.arrays();
  support::Random random(3);
  std::vector<Real> all;
  for (int n = 0; n < 200; ++n) {
    // Zeros for a while, so that fast states die out and are flushed.
    const Real x = n > 60 && n < 120 ? 0 : static_cast<Real>(random.normal());
    all.push_back(kernels.state_sum(arrays.weight, arrays.state, size));
    all.push_back(kernels.change_sum(arrays.rate, arrays.weight, arrays.state, size, x));
    kernels.advance(arrays, x);
  }
  Real x[frac::detail::section_block], y[frac::detail::section_block];
  for (const std::size_t count : {frac::detail::section_block, std::size_t{1}, std::size_t{7}}) {
    for (std::size_t n = 0; n < count; ++n) x[n] = static_cast<Real>(random.normal());
    kernels.run_states(arrays, x, y, count);
    all.insert(all.end(), y, y + count);
    kernels.run_changes(arrays, x, y, count);
    all.insert(all.end(), y, y + count);
  }
  all.insert(all.end(), bank.state.begin(), bank.state.end());
  all.insert(all.end(), bank.lost.begin(), bank.lost.end());
  return all;
}

template <typename Real>
void expect_same_bits() {
  for (const std::size_t size : {8, 16, 24, 40}) {
    const std::vector<Real> plain = exercised(frac::detail::section_kernels<Real, 16>, size);
    const auto compare = [&](const SectionKernels<Real>& kernels, const char* name) {
      const std::vector<Real> other = exercised(kernels, size);
      ASSERT_EQ(other.size(), plain.size());
      EXPECT_EQ(std::memcmp(other.data(), plain.data(), plain.size() * sizeof(Real)), 0) << name << " " << size;
    };
#if defined(__x86_64__)
    const InstructionSet known = frac::detail::processor_instruction_set();
    if (known >= InstructionSet::avx2) compare(frac::detail::avx2_section_kernels<Real>(), "avx2");
    if (known >= InstructionSet::avx512) compare(frac::detail::avx512_section_kernels<Real>(), "avx512");
#endif
    compare(frac::detail::section_kernels<Real, 16>, "again");
  }
}

TEST(SectionKernel, EveryInstructionSetGivesTheSameBits) {
  expect_same_bits<double>();
  expect_same_bits<float>();
}

// A step and a block are the same arithmetic.
TEST(SectionKernel, BlocksAreSteps) {
  Bank<double> single(16), block(16);
  const auto kernels = frac::detail::section_kernels<double, 16>;
  support::Random random(4);
  double x[32], y[32];
  for (double& value : x) value = random.normal();
  kernels.run_changes(block.arrays(), x, y, 32);
  for (int n = 0; n < 32; ++n) {
    EXPECT_EQ(kernels.change_sum(single.rate.data(), single.weight.data(), single.state.data(), 16, x[n]), y[n]);
    kernels.advance(single.arrays(), x[n]);
  }
  EXPECT_EQ(single.state, block.state);
}

}  // namespace
