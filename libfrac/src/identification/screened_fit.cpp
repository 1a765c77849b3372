// SPDX-License-Identifier: BSD-3-Clause
#include "frac/identification/screened_fit.hpp"

#include <cstddef>
#include <type_traits>
#include <utility>

#include "frac/identification/component_power_law.hpp"
#include "frac/identification/fit_from.hpp"
#include "identification/time_noise.hpp"

namespace frac {
namespace {

template <class Data, class Options>
ModelFit fit_of_request(const Data& data, const ModelRequest& request, Options options) {
  options.constraints = request.model.constraints;
  if (request.grow) {
    Growth growth = grow(data, *request.grow, options);
    return {growth.fits.at(growth.chosen), growth.models.at(growth.chosen).constraints, options.global_start,
            std::move(growth)};
  }
  if (!request.model.is_family()) {
    const Structure structure(request.model.formula);
    if constexpr (std::is_same_v<Data, FrequencyResponseData>) {
      if (request.similar)
        return {fit_from(*request.similar, data, structure, options), options.constraints, options.global_start};
    }
    return {fit(data, structure, options), options.constraints, options.global_start};
  }
  const NamedModel member = resolved_model(data, request.model, options);
  options.constraints = request.constraints_of_member ? request.constraints_of_member(member) : member.constraints;
  // The member is started where the family was grown to.
  options.global_start = false;
  FitResult result = fit(data, Structure(member.formula), options);
  if (!member.remark.empty()) result.message += " " + member.remark;
  return {std::move(result), options.constraints, options.global_start};
}

}  // namespace

ModelFit fit(const FrequencyResponseData& data, const ModelRequest& request, const FitOptions& options) {
  if (!request.component_alone) return fit_of_request(data, request, options);
  return fit_of_request(component_alone(data, options.component), request, options);
}

ModelFit fit(const TimeResponseData& data, const ModelRequest& request, const TimeFitOptions& options) {
  if (!detail::noise_is_open(options)) return fit_of_request(data, request, options);
  return detail::made_in_likely_noise(
      data, options, [&](const TimeFitOptions& told) { return fit_of_request(data, request, told); },
      [](ModelFit& made) -> FitResult& { return made.result; },
      [](const ModelFit& made, const TimeFitOptions& told) { return made.options_from(told); });
}

ModelFit fit(ScreenedData& points, const ModelRequest& request, const FitOptions& options) {
  ModelFit first = fit(points.kept(), request, options);
  if (points.take_back_met(first.options_from(options), first.result, request.component_alone).empty()) return first;
  return fit(points.kept(), request, options);
}

IdentificationResult identify(ScreenedData& points, const std::vector<NamedModel>& models,
                              const std::vector<FixedCurve>& curves, const FitOptions& options, int threads) {
  const auto ranked = [&] { return identify(points.kept(), models, at_kept(points, curves), options, threads); };
  IdentificationResult first = ranked();
  return points.take_back_met(options, first.ranking.at(first.chosen)).empty() ? first : ranked();
}

std::vector<FixedCurve> at_kept(const ScreenedData& points, std::vector<FixedCurve> curves) {
  for (FixedCurve& curve : curves)
    for (auto point = points.left_out().rbegin(); point != points.left_out().rend(); ++point)
      curve.value.erase(curve.value.begin() + static_cast<std::ptrdiff_t>(*point));
  return curves;
}

}  // namespace frac
