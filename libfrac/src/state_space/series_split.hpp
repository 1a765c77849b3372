// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "frac/model/fractional_transfer_function.hpp"

namespace frac::detail {

enum class SeriesSplit {
  whole_orders,  // each factor of whole orders is a stage, all others together are one
  every_factor,  // each factor is a stage
};

/// gain times the product of the stages.
struct SeriesStages {
  double gain = 1;
  std::vector<FractionalTransferFunction> stages;
};

/// A model without its dead time as stages that fall or grow slower than s: for every copy of a factor in the
/// denominator one, with as much of the numerator as it bears.  No stages where the model has no factors or cannot be
/// split so.  Copies of a factor are equal models.
[[nodiscard]] SeriesStages series_stages(const FractionalTransferFunction& model, SeriesSplit split);

}  // namespace frac::detail
