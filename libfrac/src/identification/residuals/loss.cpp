// SPDX-License-Identifier: BSD-3-Clause
#include "loss.hpp"

#include <cmath>

namespace frac::detail {

LossAt loss_at(Loss loss, double x) {
  switch (loss) {
    case Loss::none:
      break;
    case Loss::huber:
      if (std::abs(x) > 1) return {2 * std::abs(x) - 1, x > 0 ? 1.0 : -1.0, 0};
      break;
    case Loss::cauchy: {
      const double spread = 1 + x * x;
      return {std::log1p(x * x), x / spread, (1 - x * x) / (spread * spread)};
    }
  }
  return {x * x, x, 1};
}

}  // namespace frac::detail
