// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "base/wide_vectors.hpp"
#include "weight_exponentials.hpp"

namespace frac::detail {

/// y_n = sum_{k=0}^n w_k x_{n-k} with w_k given one by one for k < 47 and as a sum of exponentials from k = 16 on:
/// states count(exponentials), each the sum over all samples up to 16 before the present block of 32.  Samples one at a
/// time, or whole blocks.  Real is float or double.
template <typename Real>
class WeightConvolution {
 public:
  static constexpr std::size_t block = 32;
  static constexpr std::size_t first = 16;                   // lag from which a block of samples is in the states
  static constexpr std::size_t weights = block + first - 1;  // lags 0 .. 46 occur within a block

  /// @param weight  w_0 .. w_46.
  /// @param terms   by falling rate, for lags from `first` on.
  WeightConvolution(const std::vector<double>& weight, const std::vector<WeightExponential>& terms);

  [[nodiscard]] Real step(Real sample) noexcept;
  /// At a block's start only. input and output may be the same.
  void run_block(const Real* input, Real* output) noexcept;
  [[nodiscard]] bool at_block_start() const noexcept { return position_ == 0; }
  void reset() noexcept;

 private:
  static constexpr std::size_t width = 64 / sizeof(Real);
  static constexpr std::size_t history = first - 1;

  void advance_states() noexcept;

  std::size_t size_;      // states, filled up to whole vectors
  std::size_t position_;  // in the block
  AlignedVector<Real> state_;
  AlignedVector<Real> lost_;      // of them, to rounding
  AlignedVector<Real> arriving_;  // sum of the samples of the block by their powers, for one step
  AlignedVector<Real> weight_;    // of the terms
  AlignedVector<Real> change_;    // e^{-rate block} - 1: next to 1 the factor itself would round the rate away
  AlignedVector<Real> power_;     // e^{-rate i} by i and state
  AlignedVector<Real> output_;    // the same by state and i
  AlignedVector<Real> kernel_;    // w_(15 + i - j) by recent sample j and output i of a block
  AlignedVector<Real> reversed_;  // w_46 .. w_1, zeros
  AlignedVector<Real> recent_;    // 15 samples before the block, then those of the block
};

extern template class WeightConvolution<double>;
extern template class WeightConvolution<float>;

}  // namespace frac::detail
