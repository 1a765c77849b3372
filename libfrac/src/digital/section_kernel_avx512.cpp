// SPDX-License-Identifier: BSD-3-Clause
#include "section_kernel_loops.hpp"

#if defined(__x86_64__)
namespace frac::detail {

template <typename Real>
SectionKernels<Real> avx512_section_kernels() noexcept {
  return section_kernels<Real, 64>;
}

template SectionKernels<float> avx512_section_kernels<float>() noexcept;
template SectionKernels<double> avx512_section_kernels<double>() noexcept;

}  // namespace frac::detail
#endif
