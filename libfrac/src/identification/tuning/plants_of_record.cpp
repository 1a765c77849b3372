// SPDX-License-Identifier: BSD-3-Clause
#include "frac/identification/plants_of_record.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "base/short_text.hpp"
#include "frac/identification/lack_of_fit.hpp"
#include "frac/identification/robust_tune.hpp"
#include "frac/identification/time_fit.hpp"
#include "frac/structure.hpp"

namespace frac {
namespace {

// Parameters of the record, its offset, stand behind those of the plant.
bool is_told(const FitResult& fit) {
  const auto own = static_cast<std::ptrdiff_t>(Structure(fit.model).parameter_names().size());
  return std::all_of(fit.parameters.begin(), fit.parameters.begin() + own,
                     [](const auto& each) { return each.standard_error < std::abs(each.value); });
}

std::string misfit_of(const TimeResponseData& data, const FitResult& fit) {
  const LackOfFit lack = lack_of_fit(data, TimeFitOptions{}, fit);
  if (lack.adequate) return {};
  return "No plant that was tried follows the record to within its noise (residuals of " +
         detail::short_text(lack.misfit) + " times the noise, correlation of neighbours " +
         detail::short_text(lack.correlation) +
         "), so that the true one may lie outside of the region: the answer is not to be used.";
}

}  // namespace

std::optional<PlantsOfRecord> plants_of_record(const TimeResponseData& data) {
  std::vector<FitResult> fits;
  for (const char* formula : {"K exp(-L s)/(T s + 1)", "K exp(-L s)/(T s^a + 1)", "K exp(-L s)/(T2 s^2 + T1 s + 1)",
                              "K exp(-L s)/(T s^2 + s)", "K exp(-L s)/(T s + 1)^3"}) {
    FitResult result = fit(data, Structure(formula));
    if (result.usable()) fits.push_back(std::move(result));
  }
  if (fits.empty()) return std::nullopt;
  std::ranges::sort(fits, [](const FitResult& a, const FitResult& b) {
    return is_told(a) == is_told(b) ? a.aicc < b.aicc : is_told(a);
  });
  // Evidence of e^5 to 1 is beyond doubt.
  constexpr double certain = 10;
  PlantsOfRecord plants{fits.front(), {}, misfit_of(data, fits.front())};
  for (std::size_t i = 1; i < fits.size(); ++i)
    if (is_told(fits[i]) && fits[i].aicc < fits.front().aicc + certain) plants.others.push_back(fitted_plant(fits[i]));
  return plants;
}

}  // namespace frac
