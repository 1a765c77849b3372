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

/// sum weight v
[[nodiscard]] double state_sum(const double* weight, const double* state, std::size_t size) noexcept;
[[nodiscard]] float state_sum(const float* weight, const float* state, std::size_t size) noexcept;
/// sum weight (x - rate v)
[[nodiscard]] double change_sum(const double* rate, const double* weight, const double* state, std::size_t size,
                                double x) noexcept;
[[nodiscard]] float change_sum(const float* rate, const float* weight, const float* state, std::size_t size,
                               float x) noexcept;
/// v += x - rate v
void advance_states(const double* rate, double* state, double* lost, std::size_t size, double x) noexcept;
void advance_states(const float* rate, float* state, float* lost, std::size_t size, float x) noexcept;

/// Both for `count` samples, sums (without the direct term) into y.
template <typename Real>
struct SectionArrays {
  const Real* rate;
  const Real* weight;
  Real* state;
  Real* lost;
  std::size_t size;
};
inline constexpr std::size_t section_block = 32;
/// count <= section_block
void run_states(const SectionArrays<double>& bank, const double* x, double* y, std::size_t count) noexcept;
void run_states(const SectionArrays<float>& bank, const float* x, float* y, std::size_t count) noexcept;
void run_changes(const SectionArrays<double>& bank, const double* x, double* y, std::size_t count) noexcept;
void run_changes(const SectionArrays<float>& bank, const float* x, float* y, std::size_t count) noexcept;

}  // namespace frac::detail
