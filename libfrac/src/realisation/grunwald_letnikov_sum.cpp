// SPDX-License-Identifier: BSD-3-Clause
#include "grunwald_letnikov_sum.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace frac::detail {
namespace {

using Complex = std::complex<double>;

// w_k = w_{k-1} (k - 1 - order)/k.  Beyond the first few, w_k = w_{k-1} - w_{k-1} (order + 1)/k with the rounding of
// the subtraction carried along: the error then grows like the sum of 1/k instead of like k.
class WeightRecurrence {
 public:
  explicit WeightRecurrence(double order) : order_(order) {}
  [[nodiscard]] Weight current() const { return {high_ + low_, by_order_}; }
  void advance() {
    k_ += 1;
    const double previous = high_ + low_;
    by_order_ = (by_order_ * (k_ - 1 - order_) - previous) / k_;
    if (k_ < 64) {
      high_ = previous * (k_ - 1 - order_) / k_;
      low_ = 0;
      return;
    }
    const double carried = low_ - (previous - high_);
    const double decrease = previous * (order_ + 1) / k_;
    const double next = previous - decrease;
    const double part = next - previous;
    low_ = carried + ((previous - (next - part)) - (decrease + part));
    high_ = next;
  }

 private:
  double order_;
  double k_ = 0;
  double high_ = 1;
  double low_ = 0;
  double by_order_ = 0;
};

std::vector<Weight> all_weights(double order, std::size_t memory_length) {
  std::vector<Weight> weights;
  weights.reserve(memory_length + 1);
  WeightRecurrence recurrence(order);
  weights.push_back(recurrence.current());
  for (std::size_t k = 1; k <= memory_length; ++k) {
    recurrence.advance();
    weights.push_back(recurrence.current());
  }
  return weights;
}

// e^{-j k x} - 1 = -2 sin(k x/2) (sin(k x/2) + j cos(k x/2)); the rounding of k x/2 is recovered by fma, because for k
// x large it would shift the phase.
Complex phasor_minus_one(std::size_t k, double x) {
  const double factor = static_cast<double>(k) / 2;
  const double angle = factor * x;
  const double rest = std::fma(factor, x, -angle);
  const double s = std::sin(angle) + rest * std::cos(angle);
  const double c = std::cos(angle) - rest * std::sin(angle);
  return {-2 * s * s, -2 * s * c};
}

constexpr std::size_t block = 64;

// Sum over k of weight_k (z^k - 1), and of weight_k z^k, block by block: z^(k0+i) - 1 = z^k0 (z^i - 1) + (z^k0 - 1).
struct BlockSums {
  Complex minus_one, minus_one_by_order;
  Complex plain, plain_by_order;
};

BlockSums sum_blocks(const std::vector<Weight>& weights, double x) {
  std::array<Complex, block> inner;
  for (std::size_t i = 0; i < std::min(block, weights.size()); ++i) inner[i] = phasor_minus_one(i, x);
  BlockSums sums{};
  for (std::size_t start = 0; start < weights.size(); start += block) {
    Complex turned = 0;
    Complex turned_by_order = 0;
    double weight = 0;
    double weight_by_order = 0;
    for (std::size_t i = 0; i < std::min(block, weights.size() - start); ++i) {
      turned += weights[start + i].value * inner[i];
      turned_by_order += weights[start + i].by_order * inner[i];
      weight += weights[start + i].value;
      weight_by_order += weights[start + i].by_order;
    }
    const Complex outer_minus_one = phasor_minus_one(start, x);
    const Complex outer = 1.0 + outer_minus_one;
    sums.minus_one += outer * turned + outer_minus_one * weight;
    sums.minus_one_by_order += outer * turned_by_order + outer_minus_one * weight_by_order;
    sums.plain += outer * (turned + weight);
    sums.plain_by_order += outer * (turned_by_order + weight_by_order);
  }
  return sums;
}

}  // namespace

std::vector<double> grunwald_letnikov_weights(double order, std::size_t memory_length) {
  std::vector<double> weights;
  weights.reserve(memory_length + 1);
  WeightRecurrence recurrence(order);
  weights.push_back(recurrence.current().value);
  for (std::size_t k = 1; k <= memory_length; ++k) {
    recurrence.advance();
    weights.push_back(recurrence.current().value);
  }
  return weights;
}

Weight grunwald_letnikov_weight(double order, std::size_t memory_length) {
  WeightRecurrence recurrence(order);
  for (std::size_t k = 1; k <= memory_length; ++k) recurrence.advance();
  return recurrence.current();
}

GrunwaldLetnikovSum::GrunwaldLetnikovSum(double order, std::size_t memory_length) : memory_length_(memory_length) {
  steps_ = static_cast<int>(std::ceil(order)) - 1;
  const double base = order - steps_;
  base_weights_ = all_weights(base, memory_length);
  base_constant_ = grunwald_letnikov_weight(base - 1, memory_length);
  for (int i = 0; i < steps_; ++i) boundary_.push_back(grunwald_letnikov_weight(base + i, memory_length));
  for (int i = -1; i >= steps_; --i) boundary_.push_back(grunwald_letnikov_weight(base + i, memory_length));
  if (order <= 0) direct_weights_ = all_weights(order, memory_length);
}

GrunwaldLetnikovSum::Value GrunwaldLetnikovSum::base_sum(double x) const {
  // The term k = 0 vanishes in the sum of w_k (z^k - 1), as it should.
  const BlockSums sums = sum_blocks(base_weights_, x);
  return {sums.minus_one + base_constant_.value, sums.minus_one_by_order + base_constant_.by_order};
}

GrunwaldLetnikovSum::Value GrunwaldLetnikovSum::direct_sum(double x) const {
  const BlockSums sums = sum_blocks(direct_weights_, x);
  return {sums.plain, sums.plain_by_order};
}

GrunwaldLetnikovSum::Value GrunwaldLetnikovSum::operator()(double x) const {
  if (steps_ < 0 && static_cast<double>(memory_length_ + 1) * x < 1) return direct_sum(x);
  Value sum = base_sum(x);
  const Complex one_minus_z = -phasor_minus_one(1, x);
  const Complex end = 1.0 + phasor_minus_one(memory_length_ + 1, x);
  for (const Weight& weight : boundary_) {
    if (steps_ > 0) {
      sum.value = one_minus_z * sum.value + end * weight.value;
      sum.by_order = one_minus_z * sum.by_order + end * weight.by_order;
    } else {
      sum.value = (sum.value - end * weight.value) / one_minus_z;
      sum.by_order = (sum.by_order - end * weight.by_order) / one_minus_z;
    }
  }
  return sum;
}

}  // namespace frac::detail
