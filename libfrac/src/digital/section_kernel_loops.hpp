// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <limits>
#include <type_traits>

#include "section_kernel.hpp"

// The loops over sections, for registers of `bytes` bytes.  Each file that includes this is compiled for one
// instruction set; nothing of it is shared between them.
namespace frac::detail {

template <typename Real>
struct SectionKernels {
  Real (*state_sum)(const Real*, const Real*, std::size_t);
  Real (*change_sum)(const Real*, const Real*, const Real*, std::size_t, Real);
  void (*advance)(const SectionArrays<Real>&, Real);
  void (*run_states)(const SectionArrays<Real>&, const Real*, Real*, std::size_t);
  void (*run_changes)(const SectionArrays<Real>&, const Real*, Real*, std::size_t);
};

/// Present on x86-64 only, and to be called only where the processor knows the instructions.
template <typename Real>
[[nodiscard]] SectionKernels<Real> avx2_section_kernels() noexcept;
template <typename Real>
[[nodiscard]] SectionKernels<Real> avx512_section_kernels() noexcept;

namespace {

template <typename Real, std::size_t width>
struct Register {
  // At any address.
  typedef Real type __attribute__((vector_size(sizeof(Real) * width), aligned(sizeof(Real)), may_alias));
  using Bits = std::conditional_t<sizeof(Real) == 8, std::int64_t, std::int32_t>;
  typedef Bits bits __attribute__((vector_size(sizeof(Real) * width)));

  static type magnitude(type value) { return reinterpret_cast<type>(reinterpret_cast<bits>(value) & ~sign()); }

 private:
  static bits sign() { return bits{} + std::numeric_limits<Bits>::min(); }
};

// A group of sections in as many registers as it takes.
template <typename Real, std::size_t bytes>
struct Group {
  static constexpr std::size_t width = bytes / sizeof(Real) < section_group ? bytes / sizeof(Real) : section_group;
  static constexpr std::size_t count = section_group / width;
  using Lanes = Register<Real, width>;
  using Vector = typename Lanes::type;
  Vector part[count];

  void load(const Real* at) {
    for (std::size_t k = 0; k < count; ++k) part[k] = *reinterpret_cast<const Vector*>(at + k * width);
  }
  void store(Real* at) const {
    for (std::size_t k = 0; k < count; ++k) *reinterpret_cast<Vector*>(at + k * width) = part[k];
  }
  void clear() {
    for (std::size_t k = 0; k < count; ++k) part[k] = Vector{};
  }
  [[nodiscard]] Real lane_sum() const {
    Real lane[section_group];
    store(lane);
    return ((lane[0] + lane[4]) + (lane[2] + lane[6])) + ((lane[1] + lane[5]) + (lane[3] + lane[7]));
  }
};

template <typename Real, std::size_t bytes>
struct Sections {
  Group<Real, bytes> rate, weight, state, lost;

  void load(const SectionArrays<Real>& bank, std::size_t at) {
    rate.load(bank.rate + at);
    weight.load(bank.weight + at);
    state.load(bank.state + at);
    lost.load(bank.lost + at);
  }
  void store(const SectionArrays<Real>& bank, std::size_t at) const {
    state.store(bank.state + at);
    lost.store(bank.lost + at);
  }
  template <bool of_changes>
  void add_output(Group<Real, bytes>& sum, Real x) const {
    for (std::size_t k = 0; k < sum.count; ++k) {
      const auto v = state.part[k];
      sum.part[k] += weight.part[k] * (of_changes ? x - rate.part[k] * v : v);
    }
  }
  void advance(Real x) {
    using Vector = typename Group<Real, bytes>::Vector;
    const Vector tiny = Vector{} + negligible_state<Real>;
    for (std::size_t k = 0; k < state.count; ++k) {
      const Vector v = state.part[k];
      const Vector increment = (x - rate.part[k] * v) + lost.part[k];
      const Vector sum = v + increment;
      const Vector remainder = increment - (sum - v);
      const Vector none{};
      const Vector magnitude = Group<Real, bytes>::Lanes::magnitude(sum);
      state.part[k] = magnitude > tiny ? sum : none;
      lost.part[k] = magnitude > tiny ? remainder : none;
    }
  }
};

template <typename Real, std::size_t bytes>
Real state_sum_of(const Real* weight, const Real* state, std::size_t size) {
  Group<Real, bytes> sum, w, v;
  sum.clear();
  for (std::size_t s = 0; s < size; s += section_group) {
    w.load(weight + s);
    v.load(state + s);
    for (std::size_t k = 0; k < sum.count; ++k) sum.part[k] += w.part[k] * v.part[k];
  }
  return sum.lane_sum();
}

template <typename Real, std::size_t bytes>
Real change_sum_of(const Real* rate, const Real* weight, const Real* state, std::size_t size, Real x) {
  Group<Real, bytes> sum, c, w, v;
  sum.clear();
  for (std::size_t s = 0; s < size; s += section_group) {
    c.load(rate + s);
    w.load(weight + s);
    v.load(state + s);
    for (std::size_t k = 0; k < sum.count; ++k) sum.part[k] += w.part[k] * (x - c.part[k] * v.part[k]);
  }
  return sum.lane_sum();
}

template <typename Real, std::size_t bytes>
void advance_of(const SectionArrays<Real>& bank, Real x) {
  Sections<Real, bytes> sections;
  for (std::size_t s = 0; s < bank.size; s += section_group) {
    sections.load(bank, s);
    sections.advance(x);
    sections.store(bank, s);
  }
}

// `groups` groups at a time hide each other's latency.
template <std::size_t groups, bool of_changes, typename Real, std::size_t bytes>
void run_groups(const SectionArrays<Real>& bank, std::size_t at, const Real* x, Group<Real, bytes>* sums,
                std::size_t count) {
  Sections<Real, bytes> sections[groups];
  for (std::size_t g = 0; g < groups; ++g) sections[g].load(bank, at + g * section_group);
  for (std::size_t n = 0; n < count; ++n) {
    Group<Real, bytes> sum = sums[n];
    for (std::size_t g = 0; g < groups; ++g) sections[g].template add_output<of_changes>(sum, x[n]);
    for (std::size_t g = 0; g < groups; ++g) sections[g].advance(x[n]);
    sums[n] = sum;
  }
  for (std::size_t g = 0; g < groups; ++g) sections[g].store(bank, at + g * section_group);
}

template <typename Real, std::size_t bytes, bool of_changes>
void run_of(const SectionArrays<Real>& bank, const Real* x, Real* y, std::size_t count) {
  Group<Real, bytes> sums[section_block];
  for (std::size_t n = 0; n < count; ++n) sums[n].clear();
  // More groups at a time hide more latency, but must fit into the registers.
  constexpr std::size_t most = bytes == 16 ? 2 : 4;
  std::size_t s = 0;
  for (; s + most * section_group <= bank.size; s += most * section_group) {
    run_groups<most, of_changes>(bank, s, x, sums, count);
  }
  // The groups that are left are taken in one go as well: a further pass takes as long as its chain of additions,
  // however few its sections are.
  const std::size_t left = (bank.size - s) / section_group;
  if (left == 1) run_groups<1, of_changes>(bank, s, x, sums, count);
  if constexpr (most > 2) {
    if (left == 2) run_groups<2, of_changes>(bank, s, x, sums, count);
    if (left == 3) run_groups<3, of_changes>(bank, s, x, sums, count);
  }
  for (std::size_t n = 0; n < count; ++n) y[n] = sums[n].lane_sum();
}

template <typename Real, std::size_t bytes>
constexpr SectionKernels<Real> section_kernels{state_sum_of<Real, bytes>, change_sum_of<Real, bytes>,
                                               advance_of<Real, bytes>, run_of<Real, bytes, false>,
                                               run_of<Real, bytes, true>};

}  // namespace
}  // namespace frac::detail
