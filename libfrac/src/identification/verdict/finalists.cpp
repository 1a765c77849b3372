// SPDX-License-Identifier: BSD-3-Clause
#include "identification/verdict/finalists.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "identification/statistics/autocorrelation.hpp"
#include "identification/statistics/information.hpp"
#include "identification/statistics/residual_tests.hpp"

namespace frac::detail {
namespace {

/// Chance of residuals like these by noise alone.
double chance_of(const LackOfFit& lack) {
  const double of_size = std::isnan(lack.p_value) ? 1 : lack.p_value;
  return std::min(of_size, std::isnan(lack.correlation_p_value) ? 1 : lack.correlation_p_value);
}

/// Whether a candidate takes part as one that follows the data.  One that fails its test may have failed by accident:
/// a true model does so with a chance of least_chance.  A false one, again, gains evidence E over the true one with a
/// chance of at most exp(-E/2).  So the better of two is set aside only by a chance that is less than both together.
/// @param least  criterion of the best candidate that passes
bool follows(const Competitor& competitor, double least) {
  const LackOfFit& lack = competitor.ranked.lack_of_fit;
  if (lack.adequate) return true;
  const double correlation = std::isnan(lack.correlation) ? 0 : lack.correlation;
  const double evidence = (least - criterion(competitor)) * independent_share(correlation);
  return evidence > 0 && std::isfinite(evidence) && chance_of(lack) > least_chance * std::exp(-evidence / 2);
}

/// The comparable candidate of a class with the least criterion that `takes_part`.
template <class TakesPart>
std::optional<std::size_t> best_of(const std::vector<Competitor>& competitors, bool fractional, TakesPart takes_part) {
  std::optional<std::size_t> best;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < competitors.size(); ++i) {
    const Competitor& each = competitors[i];
    if (each.is_fractional() != fractional || each.stands_in || each.passive || !is_comparable(each) ||
        !takes_part(each))
      continue;
    const double value = criterion(each);
    if (!std::isfinite(value) || !(value < least)) continue;
    least = value;
    best = i;
  }
  return best;
}

}  // namespace

bool is_comparable(const Competitor& competitor) {
  const std::size_t n = competitor.residual.size(), k = competitor.ranked.fit.free_parameters;
  return n > k + 2 && n >= 2 * k;
}

bool meets_exactly(const Competitor& competitor) {
  const LackOfFit& lack = competitor.ranked.lack_of_fit;
  return lack.misfit == 1 && std::isnan(lack.correlation);
}

double misfit_term(const Competitor& competitor) {
  const double n = static_cast<double>(competitor.residual.size());
  const double normal = competitor.ranked.fit.bic - (competitor.parameters() + 1) * std::log(n);
  return meets_exactly(competitor) ? normal : std::min(normal, heavy_tailed_misfit(competitor.residual));
}

double criterion(const Competitor& competitor) {
  const double n = static_cast<double>(competitor.residual.size());
  return misfit_term(competitor) + price_of_parameters(competitor.parameters(), n);
}

Finalists finalists_of(const std::vector<Competitor>& competitors) {
  double least_of_adequate = std::numeric_limits<double>::infinity();
  for (const Competitor& each : competitors) {
    const double value = criterion(each);
    if (each.ranked.lack_of_fit.adequate && !each.stands_in && !each.passive && std::isfinite(value))
      least_of_adequate = std::min(least_of_adequate, value);
  }
  const auto follows_data = [&](const Competitor& each) { return follows(each, least_of_adequate); };
  const auto any = [](const Competitor&) { return true; };
  Finalists finalists;
  finalists.fractional = best_of(competitors, true, follows_data);
  finalists.integer = best_of(competitors, false, follows_data);
  finalists.fractional_follows = finalists.fractional.has_value();
  finalists.integer_follows = finalists.integer.has_value();
  if (!finalists.fractional) finalists.fractional = best_of(competitors, true, any);
  if (!finalists.integer) finalists.integer = best_of(competitors, false, any);
  return finalists;
}

}  // namespace frac::detail
