// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <memory>
#include <span>

namespace frac {

/// Derivative (order > 0) or integral (order < 0) of a stream of samples by the Gruenwald-Letnikov sum with its whole
/// memory, h^-order sum_{k=0}^n w_k f_{n-k}, at a cost per sample and a memory that do not depend on n.
///
/// Whole differences of the samples are taken exactly (a twofold sum for integrals), which leaves an order in (-1, 0)
/// whose weights are positive: the first 47 are used as they are, from lag 16 on they are a sum of positive
/// exponentials with a bound on each weight's relative error.  So nothing cancels but what cancels in the samples: the
/// result errs by error_bound() times h^-order sum |w_k d_{n-k}|, d the differences, and by a few roundings of that
/// sum.  For samples whose differences have one sign it is the relative error of the result.
///
/// The sum itself is only of first order accurate in h as a derivative.  Not for the response of a model with poles,
/// see respond.hpp.
///
/// A sample that is not finite, or so large that differences of it could overflow (above 1e300, for float 1e30), counts
/// as the last one accepted and is counted in rejected().  One object serves one signal; copies are independent.
template <typename Real>
class FractionalDerivative {
 public:
  /// Real is double or float.
  /// @param order        -20 .. 20.
  /// @param sample_time  h, s, > 0.
  /// @param tolerance    largest relative error of a weight: 1e-13 (float: 1e-6) to 0.1.
  /// @param horizon      samples for which it holds, 1 to 10^12.  Later the oldest samples are forgotten too slowly or
  ///                     too fast; nothing overflows.
  /// @throws std::invalid_argument  an argument out of range, or h^-order beyond the range of Real.
  explicit FractionalDerivative(double order, double sample_time, double tolerance = default_tolerance,
                                double horizon = 1e9);
  ~FractionalDerivative();
  FractionalDerivative(const FractionalDerivative&);
  FractionalDerivative& operator=(const FractionalDerivative&);
  FractionalDerivative(FractionalDerivative&&) noexcept;
  FractionalDerivative& operator=(FractionalDerivative&&) noexcept;

  /// Takes f_n, returns the derivative at it.  No allocation.
  [[nodiscard]] Real step(Real sample) noexcept;
  /// The same for many samples, several times faster (blocks of 32); continues where the last call ended.  How samples
  /// are divided into calls changes results by rounding only.  Both spans may be the same.
  /// @throws std::invalid_argument  they differ in length.
  void run(std::span<const Real> samples, std::span<Real> output);
  /// Back to zero before the first sample.
  void reset() noexcept;

  /// Number of exponentials in the sum; 0 for a whole order.
  [[nodiscard]] std::size_t exponentials() const noexcept;
  /// Relative error of any weight up to the horizon, known before the first sample; at most the tolerance.
  [[nodiscard]] double error_bound() const noexcept;
  /// Samples refused since the start or the last reset().
  [[nodiscard]] std::size_t rejected() const noexcept;

 private:
  static constexpr double default_tolerance = sizeof(Real) == sizeof(double) ? 1e-12 : 1e-6;
  struct Stream;
  std::unique_ptr<Stream> stream_;
};

extern template class FractionalDerivative<double>;
extern template class FractionalDerivative<float>;

}  // namespace frac
