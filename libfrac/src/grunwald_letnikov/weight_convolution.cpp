// SPDX-License-Identifier: BSD-3-Clause
#include "weight_convolution.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace frac::detail {
namespace {

constexpr std::size_t block = WeightConvolution<double>::block;
constexpr std::size_t lags = WeightConvolution<double>::weights;

// 64 bytes of numbers, at any address.
template <typename Real>
struct Wide {
  typedef Real Vector __attribute__((vector_size(64), aligned(alignof(Real)), may_alias));
  static constexpr std::size_t width = 64 / sizeof(Real);
  static FRACFIT_INLINE inline Vector& at(Real* place) { return *reinterpret_cast<Vector*>(place); }
  static FRACFIT_INLINE inline const Vector& at(const Real* place) { return *reinterpret_cast<const Vector*>(place); }
};

// A block of sums, in two parts that are added to in turn: that hides the time an addition takes.
template <typename Real>
struct BlockSums {
  static constexpr std::size_t vectors = block / Wide<Real>::width;
  typename Wide<Real>::Vector even[vectors];
  typename Wide<Real>::Vector odd[vectors];
};

// sums += sum_k factor[k] row(k), a row being a block; the first `from` vectors of each are zero.
template <typename Real, std::size_t from>
FRACFIT_INLINE inline void add_rows(const Real* factor, std::size_t count, const Real* row, BlockSums<Real>& sums) {
  using W = Wide<Real>;
  std::size_t k = 0;
  for (; k + 1 < count; k += 2, row += 2 * block) {
#pragma GCC unroll 8
    for (std::size_t v = from; v < sums.vectors; ++v) {
      sums.even[v] += factor[k] * W::at(row + v * W::width);
      sums.odd[v] += factor[k + 1] * W::at(row + block + v * W::width);
    }
  }
  if (k < count) {
#pragma GCC unroll 8
    for (std::size_t v = from; v < sums.vectors; ++v) sums.even[v] += factor[k] * W::at(row + v * W::width);
  }
}

// output[0..block) = sum of states by their powers, and of the recent samples by the first weights.
template <typename Real>
FRACFIT_INLINE inline void block_output(const Real* state, std::size_t size, const Real* table, const Real* recent,
                                        const Real* kernel, Real* output) {
  using W = Wide<Real>;
  constexpr std::size_t history = lags - block;
  constexpr std::size_t step = W::width;
  BlockSums<Real> sums = {};
  add_rows<Real, 0>(state, size, table, sums);
  // Sample j of `recent` comes into output i from i = j - history on.
  add_rows<Real, 0>(recent, history + step, kernel, sums);
  recent += history + step;
  kernel += (history + step) * block;
  add_rows<Real, 1>(recent, step, kernel, sums);
  if constexpr (block / step > 2) {
    add_rows<Real, 2>(recent + step, step, kernel + step * block, sums);
    add_rows<Real, 3>(recent + 2 * step, step, kernel + 2 * step * block, sums);
  }
#pragma GCC unroll 8
  for (std::size_t v = 0; v < sums.vectors; ++v) W::at(output + v * step) = sums.even[v] + sums.odd[v];
}

// sum[0..count vectors) = sum_l sample[l] power[block - 1 - l], rows of `power` being `size` numbers.
template <typename Real, std::size_t count>
FRACFIT_INLINE inline void add_arrivals(const Real* sample, const Real* power, std::size_t size, Real* sum) {
  using W = Wide<Real>;
  typename W::Vector even[count] = {};
  typename W::Vector odd[count] = {};
  const Real* row = power + (block - 1) * size;
  for (std::size_t l = 0; l < block; l += 2, row -= 2 * size) {
#pragma GCC unroll 8
    for (std::size_t v = 0; v < count; ++v) {
      even[v] += sample[l] * W::at(row + v * W::width);
      odd[v] += sample[l + 1] * W::at(row - size + v * W::width);
    }
  }
#pragma GCC unroll 8
  for (std::size_t v = 0; v < count; ++v) W::at(sum + v * W::width) = even[v] + odd[v];
}

template <typename Real>
FRACFIT_INLINE inline void block_arrivals(const Real* sample, const Real* power, std::size_t size, Real* sum) {
  constexpr std::size_t width = Wide<Real>::width;
  std::size_t left = size / width;
  while (left > 0) {
    const std::size_t count = left > 8 ? 4 : left;
    switch (count) {
      case 1:
        add_arrivals<Real, 1>(sample, power, size, sum);
        break;
      case 2:
        add_arrivals<Real, 2>(sample, power, size, sum);
        break;
      case 3:
        add_arrivals<Real, 3>(sample, power, size, sum);
        break;
      case 4:
        add_arrivals<Real, 4>(sample, power, size, sum);
        break;
      case 5:
        add_arrivals<Real, 5>(sample, power, size, sum);
        break;
      case 6:
        add_arrivals<Real, 6>(sample, power, size, sum);
        break;
      case 7:
        add_arrivals<Real, 7>(sample, power, size, sum);
        break;
      default:
        add_arrivals<Real, 8>(sample, power, size, sum);
    }
    left -= count;
    power += count * width;
    sum += count * width;
  }
}

// state += change state + weight arriving, with the rounding of the sum carried along: a slow state sums up millions
// of blocks.  Returns the largest state and the largest arrival.
template <typename Real>
struct Largest {
  Real state;
  Real arriving;
};
template <typename Real>
FRACFIT_INLINE inline Largest<Real> advance(const Real* change, const Real* weight, const Real* arriving,
                                            std::size_t size, Real* state, Real* lost) {
  using W = Wide<Real>;
  typename W::Vector largest = {};
  typename W::Vector largest_arriving = {};
  for (std::size_t s = 0; s < size; s += W::width) {
    const typename W::Vector old = W::at(state + s);
    const typename W::Vector rest = W::at(lost + s);
    const typename W::Vector add =
        W::at(change + s) * old + W::at(weight + s) * W::at(arriving + s) + rest + W::at(change + s) * rest;
    const typename W::Vector sum = old + add;
    const typename W::Vector part = sum - old;
    W::at(lost + s) = (old - (sum - part)) + (add - part);
    W::at(state + s) = sum;
    const typename W::Vector size_of = sum < Real(0) ? -sum : sum;
    largest = size_of > largest ? size_of : largest;
    const typename W::Vector in = W::at(arriving + s);
    const typename W::Vector size_of_in = in < Real(0) ? -in : in;
    largest_arriving = size_of_in > largest_arriving ? size_of_in : largest_arriving;
  }
  Largest<Real> all = {0, 0};
  for (std::size_t v = 0; v < W::width; ++v) {
    all.state = std::max(all.state, largest[v]);
    all.arriving = std::max(all.arriving, largest_arriving[v]);
  }
  return all;
}

// Sets states that are negligible beside the largest to 0 before they become denormal, which is slow.
template <typename Real>
FRACFIT_INLINE inline void flush(std::size_t size, Real least, Real* state, Real* lost) {
  using W = Wide<Real>;
  const typename W::Vector zero = {};
  for (std::size_t s = 0; s < size; s += W::width) {
    const typename W::Vector value = W::at(state + s);
    const typename W::Vector size_of = value < Real(0) ? -value : value;
    W::at(state + s) = size_of < least ? zero : value;
    W::at(lost + s) = size_of < least ? zero : W::at(lost + s);
  }
}

// Adds up by halves, because in one long chain each addition would wait for the one before it.
template <typename Real>
FRACFIT_INLINE inline Real sum_of(const typename Wide<Real>::Vector& vector) {
  Real part[Wide<Real>::width];
  Wide<Real>::at(part) = vector;
  for (std::size_t half = Wide<Real>::width / 2; half > 0; half /= 2) {
    for (std::size_t v = 0; v < half; ++v) part[v] += part[v + half];
  }
  return part[0];
}

template <typename Real>
struct Tables {
  std::size_t size;
  const Real* change;
  const Real* weight;
  const Real* power;
  const Real* output;
  const Real* kernel;
  const Real* reversed;
};

template <typename Real>
FRACFIT_INLINE inline void finish_block(const Tables<Real>& t, const Real* arriving, Real* state, Real* lost) {
  // Their sum is below half a rounding of a state of equal weight in the output.
  constexpr Real negligible = std::numeric_limits<Real>::epsilon() * std::numeric_limits<Real>::epsilon();
  const Largest<Real> largest = advance(t.change, t.weight, arriving, t.size, state, lost);
  // Denormal states are kept as long as samples, denormal themselves, come in.
  const Real least = largest.arriving == 0 ? std::numeric_limits<Real>::min() : 0;
  flush(t.size, std::max(negligible * largest.state, least), state, lost);
}

template <typename Real>
FRACFIT_INLINE inline void whole_block(const Tables<Real>& t, const Real* recent, Real* state, Real* lost,
                                       Real* arriving, Real* output) {
  block_output(state, t.size, t.output, recent, t.kernel, output);
  block_arrivals(recent, t.power, t.size, arriving);
  finish_block(t, arriving, state, lost);
}

// Adds the newest sample apart: it has just been stored, and a wide load that covers it would wait for the store.
template <typename Real>
FRACFIT_INLINE inline Real one_sample(const Tables<Real>& t, std::size_t position, const Real* recent,
                                      const Real* state, Real* arriving) {
  using W = Wide<Real>;
  const Real* now = t.power + position * t.size;
  const Real* later = t.power + (block - 1 - position) * t.size;
  const Real entering = recent[position];
  typename W::Vector total = {};
  typename W::Vector direct = {};
  for (std::size_t s = 0; s < t.size; s += W::width) {
    total += W::at(state + s) * W::at(now + s);
    W::at(arriving + s) += entering * W::at(later + s);
  }
  const Real* weight = t.reversed + (block - 1 - position);
#pragma GCC unroll 8
  for (std::size_t k = 0; k < lags + 1; k += W::width) direct += W::at(recent + k) * W::at(weight + k);
  total += direct;
  return sum_of<Real>(total);
}

}  // namespace

template <typename Real>
WeightConvolution<Real>::WeightConvolution(const std::vector<double>& weight,
                                           const std::vector<WeightExponential>& terms)
    : size_((terms.size() + width - 1) / width * width),
      position_(0),
      state_(size_, 0),
      lost_(size_, 0),
      arriving_(size_, 0),
      weight_(size_, 0),
      change_(size_, 0),
      power_(block * size_, 0),
      output_(block * size_, 0),
      kernel_(weights * block, 0),
      reversed_(weights + block + first + 1, 0),
      recent_(weights + 1, 0) {
  for (std::size_t s = 0; s < terms.size(); ++s) {
    weight_[s] = static_cast<Real>(terms[s].weight);
    change_[s] = static_cast<Real>(std::expm1(-terms[s].rate * static_cast<double>(block)));
    // Powers by squares of short products: a rounding per factor of two.
    double factor = std::exp(-terms[s].rate);
    double powers[block] = {1, factor};
    for (std::size_t i = 2; i < block; ++i) powers[i] = powers[i / 2] * powers[i - i / 2];
    for (std::size_t i = 0; i < block; ++i) {
      power_[i * size_ + s] = output_[s * block + i] = static_cast<Real>(powers[i]);
    }
  }
  for (std::size_t j = 0; j < weights; ++j) {
    for (std::size_t i = j > history ? j - history : 0; i < block; ++i) {
      kernel_[j * block + i] = static_cast<Real>(weight[history + i - j]);
    }
    if (j > 0) reversed_[weights - 1 - j] = static_cast<Real>(weight[j]);
  }
}

template <typename Real>
Real WeightConvolution<Real>::step(Real sample) noexcept {
  const Tables<Real> tables{size_,          change_.data(), weight_.data(),  power_.data(),
                            output_.data(), kernel_.data(), reversed_.data()};
  // w_0 = 1.
  const Real result = sample + with_wide_vectors([&]() FRACFIT_INLINE {
                        return one_sample(tables, position_, recent_.data(), state_.data(), arriving_.data());
                      });
  recent_[history + position_] = sample;
  if (++position_ == block) {
    with_wide_vectors([&]() FRACFIT_INLINE { finish_block(tables, arriving_.data(), state_.data(), lost_.data()); });
    std::fill(arriving_.begin(), arriving_.end(), Real(0));
    std::copy_n(recent_.begin() + block, history, recent_.begin());
    position_ = 0;
  }
  return result;
}

template <typename Real>
void WeightConvolution<Real>::run_block(const Real* input, Real* output) noexcept {
  std::copy_n(input, block, recent_.begin() + history);
  const Tables<Real> tables{size_,          change_.data(), weight_.data(),  power_.data(),
                            output_.data(), kernel_.data(), reversed_.data()};
  with_wide_vectors([&]() FRACFIT_INLINE {
    whole_block(tables, recent_.data(), state_.data(), lost_.data(), arriving_.data(), output);
  });
  std::fill(arriving_.begin(), arriving_.end(), Real(0));
  std::copy_n(recent_.begin() + block, history, recent_.begin());
}

template <typename Real>
void WeightConvolution<Real>::reset() noexcept {
  for (auto* each : {&state_, &lost_, &arriving_, &recent_}) std::fill(each->begin(), each->end(), Real(0));
  position_ = 0;
}

template class WeightConvolution<double>;
template class WeightConvolution<float>;

}  // namespace frac::detail
