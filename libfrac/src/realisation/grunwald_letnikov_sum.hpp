// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <complex>
#include <cstddef>
#include <vector>

namespace frac::detail {

/// A weight and its derivative by the order.
struct Weight {
  double value;
  double by_order;
};

/// Weight w_k^(order) of the Gruenwald-Letnikov difference at k = memory_length alone.
[[nodiscard]] Weight grunwald_letnikov_weight(double order, std::size_t memory_length);

/// All of them, k = 0 .. memory_length, without the derivatives.
[[nodiscard]] std::vector<double> grunwald_letnikov_weights(double order, std::size_t memory_length);

/// sum_{k=0}^{memory_length} w_k^(order) e^{-j k x} and its derivative by the order, prepared once for many angles x.
///
/// Summed as it stands, the weights of a positive order cancel to x^order.  Instead, with z = e^{-jx}, M the memory
/// length:
///   0 < order <= 1:  sum_{k>=1} w_k (z^k - 1) + w_M^(order-1)       all w_k of one sign, z^k - 1 from sin(k x/2)
///   order > 1:       S^(order) = (1 - z) S^(order-1) + z^(M+1) w_M^(order-1)
///   order <= 0:      S^(order) = (S^(order+1) - z^(M+1) w_M^(order))/(1 - z),  or as it stands when (M+1) x < 1
/// (the last two by summation by parts), so the error is a few eps of the value plus that of the phase of z^M.
class GrunwaldLetnikovSum {
 public:
  struct Value {
    std::complex<double> value;
    std::complex<double> by_order;
  };
  GrunwaldLetnikovSum() = default;
  /// |order| <= 20, memory_length >= 1.
  GrunwaldLetnikovSum(double order, std::size_t memory_length);
  /// 0 < x <= pi.
  [[nodiscard]] Value operator()(double x) const;

 private:
  [[nodiscard]] Value base_sum(double x) const;
  [[nodiscard]] Value direct_sum(double x) const;

  std::size_t memory_length_ = 0;
  int steps_ = 0;                       // from the base order, in (0, 1], up (> 0) or down (< 0) to the wanted one
  std::vector<Weight> base_weights_;    // of the base order
  Weight base_constant_{};              // sum of base_weights_
  std::vector<Weight> boundary_;        // w_M of the orders passed on the way
  std::vector<Weight> direct_weights_;  // of the wanted order when it is <= 0
};

}  // namespace frac::detail
