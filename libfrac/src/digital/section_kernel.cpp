// SPDX-License-Identifier: BSD-3-Clause
#include "section_kernel.hpp"

#include "base/instruction_set.hpp"
#include "section_kernel_loops.hpp"

namespace frac::detail {
namespace {

template <typename Real>
SectionKernels<Real> chosen() {
#if defined(__x86_64__)
  if (instruction_set() == InstructionSet::avx512) return avx512_section_kernels<Real>();
  if (instruction_set() == InstructionSet::avx2) return avx2_section_kernels<Real>();
#endif
  return section_kernels<Real, 16>;
}

template <typename Real>
const SectionKernels<Real>& kernels() noexcept {
  static const SectionKernels<Real> choice = chosen<Real>();
  return choice;
}

}  // namespace

template <typename Real>
Real state_sum(const Real* weight, const Real* state, std::size_t size) noexcept {
  return kernels<Real>().state_sum(weight, state, size);
}

template <typename Real>
Real change_sum(const Real* rate, const Real* weight, const Real* state, std::size_t size, Real x) noexcept {
  return kernels<Real>().change_sum(rate, weight, state, size, x);
}

template <typename Real>
void advance_states(const SectionArrays<Real>& bank, Real x) noexcept {
  kernels<Real>().advance(bank, x);
}

template <typename Real>
void run_states(const SectionArrays<Real>& bank, const Real* x, Real* y, std::size_t count) noexcept {
  kernels<Real>().run_states(bank, x, y, count);
}

template <typename Real>
void run_changes(const SectionArrays<Real>& bank, const Real* x, Real* y, std::size_t count) noexcept {
  kernels<Real>().run_changes(bank, x, y, count);
}

#define FRACFIT_INSTANTIATE(Real)                                                                       \
  template Real state_sum<Real>(const Real*, const Real*, std::size_t) noexcept;                        \
  template Real change_sum<Real>(const Real*, const Real*, const Real*, std::size_t, Real) noexcept;    \
  template void advance_states<Real>(const SectionArrays<Real>&, Real) noexcept;                        \
  template void run_states<Real>(const SectionArrays<Real>&, const Real*, Real*, std::size_t) noexcept; \
  template void run_changes<Real>(const SectionArrays<Real>&, const Real*, Real*, std::size_t) noexcept;
FRACFIT_INSTANTIATE(float)
FRACFIT_INSTANTIATE(double)

}  // namespace frac::detail
