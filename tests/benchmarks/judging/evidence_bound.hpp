// SPDX-License-Identifier: BSD-3-Clause
// What theory says can be decided on a measured curve.
//
// A model that leaves the exact response by e_k at point k loses, on average over the noise,
//   D = 1/2 sum |e_k|^2 / sigma_k^2   (parts that are measured; whitened for correlated noise; sound points only)
// in log-likelihood against the truth, with standard deviation sqrt(2 D).  With p free parameters and n residuals its
// expected price is E = D + p/2 ln n.  The least E is sought
//   - over ratios of polynomials of order 1 to 12, with and without a direct term in s and a dead time, by vector
//     fitting and then variable projection on the exact response,
//   - over twelve fractional structures of at most nine parameters, in the same way,
//   - and the truth itself has D = 0.
// Where the integer-order truth lies inside a fractional structure with a = 1, the price of the one order more is that
// of price_of_an_order.hpp: an order is a priori as likely anywhere within half a unit of 1.
// The expected log odds of the true class are the least E of the other class minus the least E of its own.  Nobody
// knows the noise better than this bound does, so that no method can decide more on average under these prices.
#pragma once

#include <string>

#include "benchmarks/judging/measurement.hpp"
#include "benchmarks/judging/systems.hpp"

namespace judging {

struct Bound {
  /// Expected natural log odds of the true class, and their standard deviation.
  double log_odds = 0;
  double deviation = 0;
  /// Best rational rival: order, whether with dead time, its loss D and its root mean square relative error.
  int rational_order = 0;
  bool rational_delay = false;
  double rational_loss = 0;
  /// Best fractional rival.
  std::string fractional_name;
  double fractional_loss = 0;

  /// `decidable`: log odds above ln 20 by a standard deviation; `close`: above ln 3; `misleading`: below -ln 3, the
  /// data speak for the other class; `open` between.
  [[nodiscard]] std::string word() const;
};

Bound evidence_bound(const Kind& kind, const System& system, const Curve& curve);

/// Loss of the best ratio of polynomials of one order, without dead time, on the exact curve.
double rational_loss(const Curve& curve, int order);

}  // namespace judging
