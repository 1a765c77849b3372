// SPDX-License-Identifier: BSD-3-Clause
#include "time_model.hpp"

#include <stdexcept>
#include <string>
#include <utility>

#include "frac/no_ratio.hpp"

namespace frac::detail {

TimeModel time_model(const Structure& structure, std::span<const double> parameters, Sensitivity sensitivity) {
  try {
    return reduce(structure.expression(), parameters, sensitivity);
  } catch (const NoRatio& why) {
    std::optional<CutPlaneModel> other = CutPlaneModel::of(structure, parameters, sensitivity);
    if (!other)
      throw NoRatio(std::string(why.what()) +
                    "; nor are its poles known to lie on the negative real axis alone, as those of diffusion "
                    "do, at these values of its parameters");
    return *std::move(other);
  }
}

std::optional<TimeModel> time_model_if_any(const Structure& structure, std::span<const double> parameters,
                                           Sensitivity sensitivity) {
  try {
    return time_model(structure, parameters, sensitivity);
  } catch (const std::invalid_argument&) {
    return std::nullopt;
  }
}

bool respond_to(const TimeModel& model, const EventResponse& input, double tolerance, EventResponse::Result& result) {
  return std::visit([&](const auto& each) { return input.evaluate(each, tolerance, result); }, model);
}

double dead_time(const TimeModel& model) {
  const auto* const ratio = std::get_if<RatioOfPowerSums>(&model);
  return ratio ? ratio->delay : 0;
}

}  // namespace frac::detail
