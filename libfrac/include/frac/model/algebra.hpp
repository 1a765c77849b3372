// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "frac/model/fractional_transfer_function.hpp"

namespace frac {

/// Sums, differences, products and quotients.  Terms of equal order are merged; coefficients that cancel to rounding
/// are dropped; powers of s common to numerator and denominator are cancelled.  Factors are not: see simplified().
/// @throws std::invalid_argument  + and -: dead times that differ, whose sum is no ratio of sums of powers with one
///     dead time, or a result that is zero; /: a dead time of the divisor above that of the dividend, which would have
///     to look into the future.
[[nodiscard]] FractionalTransferFunction operator+(const FractionalTransferFunction& a,
                                                   const FractionalTransferFunction& b);
[[nodiscard]] FractionalTransferFunction operator-(const FractionalTransferFunction& a,
                                                   const FractionalTransferFunction& b);
[[nodiscard]] FractionalTransferFunction operator*(const FractionalTransferFunction& a,
                                                   const FractionalTransferFunction& b);
[[nodiscard]] FractionalTransferFunction operator/(const FractionalTransferFunction& a,
                                                   const FractionalTransferFunction& b);
[[nodiscard]] FractionalTransferFunction operator-(const FractionalTransferFunction& a);
[[nodiscard]] FractionalTransferFunction operator*(double factor, const FractionalTransferFunction& a);

/// Negative feedback forward/(1 + forward backward).
/// @throws std::invalid_argument  1 + forward backward = 0, or dead time in the loop: the closed loop is then no ratio
///     of sums of powers.  analyse_closed_loop() decides its
///     stability all the same.
[[nodiscard]] FractionalTransferFunction feedback(const FractionalTransferFunction& forward,
                                                  const FractionalTransferFunction& backward);

/// The same function of s with fewer terms where it has them: orders from 0 up, those that are fractions n/d, d <=
/// 1000, but for rounding (1e-12) made so, and common factors of numerator and denominator cancelled where the division
/// leaves nothing but rounding.
[[nodiscard]] FractionalTransferFunction simplified(const FractionalTransferFunction& model);

/// numerator/denominator in lowest terms.
struct CommensurateOrder {
  long numerator;
  long denominator;
  [[nodiscard]] double value() const { return static_cast<double>(numerator) / static_cast<double>(denominator); }
};
/// The largest order of which every order of the model is a whole multiple.  Each order is taken as the fraction of
/// least denominator, at most `most_denominator`, within 1e-12 of it (relative above 1), found among its convergents
/// and their intermediate fractions.  Empty when some order is no such fraction, their common denominator exceeds
/// 10^6, or all orders are 0.
[[nodiscard]] std::optional<CommensurateOrder> commensurate_order(const FractionalTransferFunction& model,
                                                                  long most_denominator = 1000);

}  // namespace frac
