// SPDX-License-Identifier: BSD-3-Clause
#include "identification/verdict/evidence.hpp"

#include <algorithm>
#include <cmath>

#include "identification/rational/family_members.hpp"
#include "identification/statistics/information.hpp"
#include "identification/verdict/finalists.hpp"

namespace frac::detail {
namespace {

constexpr double nearly_whole = 0.02;  // an order that is known to be so near a whole number counts as one

/// By how much n ln(cost/n) rises, to the curvature of the cost, on the way from an estimate to the nearest order that
/// departs().
/// @param widest  standard error of the estimate
double fall_of_evidence(const FitResult& fit, double distance, double widest, double degrees) {
  const double deviations = std::max(0.0, least_departure - distance) / widest;
  const double fall = static_cast<double>(fit.residuals) * std::log1p(deviations * deviations / degrees);
  return std::isnan(fall) ? 0 : fall;
}

}  // namespace

double evidence_for(const Competitor& fractional, const Competitor& integer, double share) {
  const double n = static_cast<double>(fractional.residual.size());
  // Where both meet the data to rounding, what each needed for it is all that tells them apart.
  if (meets_exactly(fractional) && meets_exactly(integer)) {
    return price_of_parameters(integer.parameters(), n) - price_of_parameters(fractional.parameters(), n);
  }
  const double news = std::log(std::max(share * n, 2.0)) / std::log(n);
  const auto price = [&](const Competitor& each) { return news * price_of_parameters(each.parameters(), n); };
  return share * (misfit_term(integer) - misfit_term(fractional)) + price(integer) - price(fractional);
}

Orders orders_of(const FitResult& fit, double share) {
  const Structure structure(fit.model);
  const auto degrees = static_cast<double>(fit.residuals) - static_cast<double>(fit.free_parameters);
  const double widening = 1 / std::sqrt(share);
  Orders orders;
  double farthest = 1;
  // The offset of a fit over time comes after the structure's own.
  for (std::size_t i = 0; i < structure.parameter_names().size(); ++i) {
    const ParameterEstimate& estimate = fit.parameters[i];
    if (structure.parameter_roles()[i] != ParameterRole::order) continue;
    orders.any_free = true;
    const double distance = std::abs(estimate.value - std::round(estimate.value));
    if (departs(estimate.value)) orders.departure = 0;
    if (estimate.at_bound) {
      orders.all_nearly_whole = orders.all_nearly_whole && distance < 1e-3;
      continue;
    }
    if (!estimate.fixed && !std::isfinite(estimate.standard_error)) {
      orders.all_nearly_whole = false;
      orders.departure = 0;
      continue;
    }
    const double above = estimate.ci95_upper - estimate.value, below = estimate.value - estimate.ci95_lower;
    const double side = std::round(estimate.value) > estimate.value ? above : below;
    const double half_width = estimate.fixed ? 0 : side * widening;
    const double widths = half_width > 0 ? distance / half_width : (distance > 0 ? 1e300 : 0);
    if (!estimate.fixed && degrees > 0) {
      const double widest = std::max(above, below) * widening / student_t_95(degrees);
      orders.departure = std::min(orders.departure, fall_of_evidence(fit, distance, widest, degrees));
    }
    orders.all_nearly_whole = orders.all_nearly_whole && distance + half_width <= nearly_whole;
    if (widths > farthest) {
      farthest = widths;
      orders.decided = &estimate;
    }
  }
  // Where orders are written into the formula as numbers, nothing has to change for one of them to depart.
  if (!orders.any_free) orders.departure = 0;
  orders.all_nearly_whole = orders.all_nearly_whole && orders.any_free;
  return orders;
}

Departure evidence_of_departure(const std::vector<Competitor>& competitors, const Competitor& integer, double share) {
  Departure most;
  for (const Competitor& each : competitors) {
    if (!each.is_fractional() || each.stands_in || each.passive) continue;
    const double evidence = evidence_for(each, integer, share);
    if (!(evidence > most.evidence)) continue;
    const double falls = std::min(orders_of(each.ranked.fit, share).departure, share * each.departed);
    if (evidence - falls > most.evidence) most = {evidence - falls, each.ranked.fit.free_parameters};
  }
  return most;
}

}  // namespace frac::detail
