// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "frac/identification/fit.hpp"
#include "frac/model/fractional_transfer_function.hpp"
#include "frac/model/time_response_data.hpp"

namespace frac {

/// Plants of control loops that a record of input and output, such as one of a relay experiment, leaves possible.
struct PlantsOfRecord {
  FitResult best;  // of the best evidence among those whose parameters the record tells
  /// The others that it leaves possible: what falls faster at high frequency than the true plant, for the sake of a
  /// little noise, would allow a derivative that the true plant does not.
  std::vector<FractionalTransferFunction> others;
  /// That not even the best follows the record to within its noise, so that its region tells nothing of the true plant;
  /// empty where it does.
  std::string misfit;
};

/// A lag, a fractional lag, a second order, an integrator with lag and three equal lags, each with dead time, fitted to
/// the record.
/// @return empty where none of the fits is usable
[[nodiscard]] std::optional<PlantsOfRecord> plants_of_record(const TimeResponseData& data);

}  // namespace frac
