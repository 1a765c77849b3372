// SPDX-License-Identifier: BSD-3-Clause
#include "identification/verdict/evidence.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "identification/rational/family_members.hpp"
#include "identification/statistics/autocorrelation.hpp"
#include "identification/statistics/information.hpp"
#include "identification/verdict/finalists.hpp"
#include "identification/verdict/integer_limit.hpp"

namespace frac::detail {
namespace {

constexpr double nearly_whole = 0.02;  // an order that is known to be so near a whole number counts as one

double degrees_of(const FitResult& fit) {
  return static_cast<double>(fit.residuals) - static_cast<double>(fit.free_parameters);
}

/// By how much n ln(cost/n) rises, to the curvature of the cost, on the way to an order that departs().
double fall_of_evidence(const FitResult& fit, const Orders& orders) {
  if (orders.departure == 0) return 0;
  return static_cast<double>(fit.residuals) * std::log1p(orders.departure / degrees_of(fit));
}

/// Squared standard errors to where a candidate shows that it is fractional.  It then changes some value by
/// least_visible, so that all residuals together change by at least that against the integer-order limit, and by what
/// is missing to it from here; the sum of squares rises by the square of that from its minimum.
double departure_from_limit(const Competitor& competitor) {
  const double missing = std::max(0.0, least_visible - competitor.from_integer_limit());
  const double error = competitor.ranked.fit.relative_rms;
  const auto residuals = static_cast<double>(competitor.residual.size());
  return missing > 0 ? missing * missing * degrees_of(competitor.ranked.fit) / (residuals * error * error) : 0;
}

/// What the intervals of a fit say about its orders.
Orders orders_of(const FitResult& fit, double share) {
  const Structure structure(fit.model);
  const double degrees = degrees_of(fit);
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
      const double deviations = std::max(0.0, least_departure - distance) / widest;
      orders.departure = std::min(orders.departure, std::isnan(deviations) ? 0 : deviations * deviations);
    }
    orders.all_nearly_whole = orders.all_nearly_whole && distance + half_width <= nearly_whole;
    if (widths > farthest) {
      farthest = widths;
      orders.decided = &estimate;
    }
  }
  // Where orders are written into the formula as numbers, nothing has to change for one of them to depart.
  if (!orders.any_free) orders.departure = 0;
  orders.any_departs = orders.departure == 0;
  orders.all_nearly_whole = orders.all_nearly_whole && orders.any_free;
  return orders;
}

void ask_to_show(Orders& orders, const Competitor& competitor, double share) {
  orders.departure = std::max(orders.departure, share * departure_from_limit(competitor));
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

Orders orders_of(const Competitor& competitor, double share) {
  Orders orders = orders_of(competitor.ranked.fit, share);
  ask_to_show(orders, competitor, share);
  return orders;
}

Departure evidence_of_departure(const std::vector<Competitor>& competitors, const Competitor& integer, double share) {
  Departure most;
  for (const Competitor& each : competitors) {
    if (!each.is_fractional() || each.stands_in || each.passive) continue;
    const double evidence = evidence_for(each, integer, share);
    if (!(evidence > most.evidence)) continue;
    const FitResult& fit = each.ranked.fit;
    const double of_members = share * each.departed;
    Orders orders = orders_of(fit, share);
    const auto left = [&] { return evidence - std::min(fall_of_evidence(fit, orders), of_members); };
    if (left() > most.evidence && fall_of_evidence(fit, orders) < of_members) ask_to_show(orders, each, share);
    if (left() > most.evidence) most = {left(), fit.free_parameters};
  }
  return most;
}

Leftover leftover_of(const Competitor& competitor, std::size_t per_point) {
  const auto residuals = static_cast<double>(competitor.residual.size());
  return {competitor.ranked.fit.relative_rms, autocorrelation(competitor.residual, per_point, 1),
          price_of_parameters(competitor.parameters(), residuals)};
}

EvidenceBesideSmoothError evidence_beside_smooth_error(const std::vector<Competitor>& competitors,
                                                       std::size_t per_point) {
  const Competitor* closest = nullptr;
  const auto takes_part = [](const Competitor& each) {
    return is_comparable(each) && !each.stands_in && !each.passive;
  };
  for (const Competitor& each : competitors) {
    if (takes_part(each) && (!closest || each.ranked.fit.relative_rms < closest->ranked.fit.relative_rms))
      closest = &each;
  }
  constexpr double infinity = std::numeric_limits<double>::infinity(), nan = std::numeric_limits<double>::quiet_NaN();
  if (!closest) return {nan, nan};
  const Leftover least = leftover_of(*closest, per_point);
  if (least.rms == 0) return {nan, nan};
  double fractional = infinity, departing = infinity, integer = infinity;  // evidence against the best of each
  for (const Competitor& each : competitors) {
    if (!takes_part(each)) continue;
    const Leftover own = leftover_of(each, per_point);
    const double against = evidence_against(own, least, each.residual.size());
    if (!each.is_fractional()) {
      integer = std::min(integer, against);
      continue;
    }
    fractional = std::min(fractional, against);
    // A smooth error adds to the variance that the errors of the orders were told from.
    const double share = independent_share(own.correlation);
    const double of_members = share * each.departed, of_noise = share_of_noise(own, least);
    Orders orders = orders_of(each.ranked.fit, share);
    const auto against_departing = [&] { return against + std::min(orders.departure, of_members) * of_noise; };
    if (against_departing() < departing && orders.departure < of_members) ask_to_show(orders, each, share);
    departing = std::min(departing, against_departing());
  }
  const auto compared = [&](double other) {
    return std::isfinite(integer) && std::isfinite(other) ? integer - other : nan;
  };
  return {compared(fractional), compared(departing)};
}

}  // namespace frac::detail
