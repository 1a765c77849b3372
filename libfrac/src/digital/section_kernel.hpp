// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

namespace frac::detail {

/// Sections are worked on in groups of this many side by side; lists are filled up to whole groups with zeros.
inline constexpr std::size_t section_group = 8;

[[nodiscard]] constexpr std::size_t whole_groups(std::size_t sections) {
  return (sections + section_group - 1) / section_group * section_group;
}

/// Magnitudes below which a state is set to 0: nothing to the output, and denormal numbers are slow.
template <typename Real>
inline constexpr Real negligible_state = Real(1e-280);
template <>
inline constexpr float negligible_state<float> = 1e-20F;

// Sums are formed lane by lane over the groups and then as ((0+4)+(2+6)) + ((1+5)+(3+7)), so that every instruction set
// and the exported C code give the same bits.  The states are sums of very many small increments: what an addition
// loses is kept in `lost` and added the next time, without which a slow section would never reach its end value.

/// Sections of a filter, `size` of them in whole groups.
template <typename Real>
struct SectionArrays {
  const Real* rate;
  const Real* weight;
  Real* state;
  Real* lost;
  std::size_t size;
};

// For float and double.

/// sum weight v
template <typename Real>
[[nodiscard]] Real state_sum(const Real* weight, const Real* state, std::size_t size) noexcept;
/// sum weight (x - rate v)
template <typename Real>
[[nodiscard]] Real change_sum(const Real* rate, const Real* weight, const Real* state, std::size_t size,
                              Real x) noexcept;
/// v += x - rate v
template <typename Real>
void advance_states(const SectionArrays<Real>& bank, Real x) noexcept;

inline constexpr std::size_t section_block = 32;
/// Both for count <= section_block samples; y gets sum weight v.
template <typename Real>
void run_states(const SectionArrays<Real>& bank, const Real* x, Real* y, std::size_t count) noexcept;
/// y gets sum weight (x - rate v).
template <typename Real>
void run_changes(const SectionArrays<Real>& bank, const Real* x, Real* y, std::size_t count) noexcept;

}  // namespace frac::detail
