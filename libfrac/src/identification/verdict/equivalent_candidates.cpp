// SPDX-License-Identifier: BSD-3-Clause
#include "identification/verdict/equivalent_candidates.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstddef>
#include <iterator>
#include <utility>
#include <variant>

namespace frac::detail {
namespace {

// Two searches that end at one optimum differ by less than a hundredth of the noise; exact fits by rounding.
constexpr double of_noise = 0.01, of_rounding = 1e-9;
constexpr double of_response = 1e-3;  // a decade beyond the data

bool same_residuals(const Competitor& one, const Competitor& other, double unit) {
  double distance = 0, size = 0;
  for (std::size_t i = 0; i < one.residual.size(); ++i) {
    distance += std::pow(one.residual[i] - other.residual[i], 2);
    size += std::pow(one.residual[i], 2);
  }
  const double rounding = of_rounding * unit;
  return distance <= of_noise * of_noise * size + rounding * rounding * static_cast<double>(one.residual.size());
}

}  // namespace

bool same_beyond(const FrequencyResponseData& data, const FitOptions& options, const FitResult& one,
                 const FitResult& other) {
  if (!std::holds_alternative<ExactRealisation>(options.realisation)) return true;
  const std::vector<double> omega{data.omega().front() / 10, data.omega().back() * 10};
  const auto a = fitted_response(one, options.realisation, omega),
             b = fitted_response(other, options.realisation, omega);
  for (std::size_t i = 0; i < omega.size(); ++i) {
    std::complex<double> difference = a[i] - b[i];
    // A part that is not fitted may hold any constant.
    if (options.component == Component::imaginary) difference = difference.imag();
    if (options.component == Component::real) difference = difference.real();
    if (!(std::abs(difference) <= of_response * std::abs(a[i]))) return false;
  }
  return true;
}

void merge_equivalent(std::vector<Competitor>& competitors, std::vector<Competitor> passive, double size,
                      const std::function<bool(const FitResult&, const FitResult&)>& one_beyond) {
  // A preset says more than the member of a family.
  std::stable_sort(competitors.begin(), competitors.end(), [](const Competitor& a, const Competitor& b) {
    return !a.ranked.from_family && b.ranked.from_family;
  });
  competitors.insert(competitors.end(), std::make_move_iterator(passive.begin()),
                     std::make_move_iterator(passive.end()));
  std::vector<Competitor> kept;
  for (Competitor& each : competitors) {
    const auto same = std::find_if(kept.begin(), kept.end(), [&](const Competitor& other) {
      return each.ranked.model_class != ModelClass::fixed_curve &&
             other.ranked.model_class == each.ranked.model_class && !(each.passive && other.ranked.from_family) &&
             other.ranked.fit.free_parameters == each.ranked.fit.free_parameters && same_residuals(other, each, size) &&
             one_beyond(other.ranked.fit, each.ranked.fit);
    });
    if (same == kept.end()) {
      kept.push_back(std::move(each));
      continue;
    }
    same->ranked.also.push_back(each.ranked.name);
    same->departed = std::min(same->departed, each.departed);
    same->relaxations = std::max(same->relaxations, each.relaxations);
    same->is_such_a_sum = same->is_such_a_sum || each.passive;
    // A stable member leaves its part in the verdict to the unstable one that it stands for.  Where both are one model,
    // the one that is kept takes the part.
    same->stands_in = same->stands_in && each.stands_in;
  }
  competitors = std::move(kept);
}

}  // namespace frac::detail
