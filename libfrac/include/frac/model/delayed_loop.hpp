// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <span>

#include "frac/model/fractional_transfer_function.hpp"
#include "frac/structure.hpp"

namespace frac {

/// forward/(1 + loop): a closed loop whose dead time makes it no ratio of sums of powers.
struct DelayedLoop {
  FractionalTransferFunction forward, loop;
};

/// The closed loop that a formula is at given parameter values: a product or quotient of ratios of sums of powers in
/// which one divisor is a sum of two of them with different dead times, as C G exp(-L s)/(1 + C G exp(-L s)).  Empty
/// for any other formula, one that is such a ratio itself among them.
/// @throws std::invalid_argument  not one value for each parameter
[[nodiscard]] std::optional<DelayedLoop> delayed_loop(const Structure& structure, std::span<const double> parameters);

}  // namespace frac
