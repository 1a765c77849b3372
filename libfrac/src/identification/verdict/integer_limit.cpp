// SPDX-License-Identifier: BSD-3-Clause
#include "identification/verdict/integer_limit.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>

#include "identification/statistics/information.hpp"

namespace frac::detail {
namespace {

double distance(const Competitor& one, const Competitor& other) {
  double square = 0;
  for (std::size_t i = 0; i < one.residual.size(); ++i) square += std::pow(one.residual[i] - other.residual[i], 2);
  return std::sqrt(square) * one.ranked.fit.relative_rms / one.ranked.fit.rms;
}

/// Schwarz's criterion in normal noise for all free parameters, also those that tell nothing near the limit.
double schwarz_of(const Competitor& each) {
  const auto residuals = static_cast<double>(each.residual.size());
  return 2 * residuals * std::log(each.ranked.fit.rms) + price_of_parameters(each.parameters(), residuals);
}

double limit_of(const Competitor& rich, const std::vector<Competitor>& competitors, const Containing& contains) {
  const double value = schwarz_of(rich);
  double nearest = std::numeric_limits<double>::infinity();
  for (const Competitor& simple : competitors) {
    if (simple.ranked.model_class != ModelClass::integer_order || simple.parameters() >= rich.parameters()) continue;
    if (!(schwarz_of(simple) < value)) continue;
    const double apart = distance(rich, simple);
    if (apart < std::min(least_visible, nearest) && contains(rich.ranked.fit, simple.ranked.fit)) nearest = apart;
  }
  return nearest;
}

}  // namespace

void find_integer_limits(std::vector<Competitor>& competitors, const Containing& contains) {
  for (Competitor& rich : competitors) {
    if (!rich.is_fractional() || rich.ranked.from_family) continue;
    rich.from_integer_limit = [&rich, &competitors, contains, known = std::optional<double>()]() mutable {
      if (!known) known = limit_of(rich, competitors, contains);
      return *known;
    };
  }
}

}  // namespace frac::detail
