// SPDX-License-Identifier: BSD-3-Clause
#include "search_starts.hpp"

#include <nlopt.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <utility>

#include "base/draws.hpp"
#include "frac/cancellation.hpp"

namespace frac::detail {
namespace {

constexpr int starts_per_round = 5;
constexpr int draws_per_start = 12;

double between(std::mt19937_64& generator, double lower, double upper) {
  return lower + (upper - lower) * uniform_draw(generator);
}

std::vector<double> draw(const ParameterMap& map, const std::vector<double>& suggested_orders,
                         std::mt19937_64& generator) {
  const DataScale& scale = map.scale();
  const auto& free = map.free();
  std::vector<double> theta(free.size());
  std::vector<double> parameters(map.parameter_count(), 0.0);
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    if (map.is_fixed(i)) parameters[i] = map.start()[i];
  }
  for (std::size_t k = 0; k < free.size(); ++k) {
    if (free[k].role != ParameterRole::order) continue;
    if (free[k].above) {
      theta[k] = uniform_draw(generator);
      continue;
    }
    // Orders beyond 2.5 are rare; the solver may still go there.
    const double lower = std::max(free[k].lower, -2.5), upper = std::min(free[k].upper, 2.5);
    const bool suggest = !suggested_orders.empty() && uniform_draw(generator) < 0.5;
    const double suggestion = suggest ? suggested_orders[static_cast<std::size_t>(
                                            uniform_draw(generator) * static_cast<double>(suggested_orders.size()))]
                                      : 0;
    theta[k] =
        suggest && suggestion >= free[k].lower && suggestion <= free[k].upper
            ? suggestion
            : (lower < upper ? between(generator, lower, upper) : between(generator, free[k].lower, free[k].upper));
  }
  const std::vector<double> drawn = map.to_user(theta);
  for (const ParameterMap::Free& entry : free)
    if (entry.role == ParameterRole::order) parameters[entry.parameter] = drawn[entry.parameter];
  for (std::size_t k = 0; k < free.size(); ++k) {
    if (free[k].role == ParameterRole::order) continue;
    if (free[k].above) {
      // Up to three decades between parameters of one kind.
      theta[k] = between(generator, 0, std::min(free[k].upper, std::log(1e3)));
      continue;
    }
    const double log_value = between(generator, std::log(scale.value_lower), std::log(scale.value_upper));
    const double log_omega = between(generator, std::log(scale.omega_lower), std::log(scale.omega_upper));
    const double magnitude = free[k].value_exponent * (log_value - std::log(scale.value)) +
                             map.frequency_exponent(k, parameters) * (log_omega - std::log(scale.omega));
    if (free[k].logarithmic) {
      theta[k] = magnitude;
    } else {
      theta[k] = std::exp(magnitude);
      if (free[k].either_sign && uniform_draw(generator) < 0.5) theta[k] = -theta[k];
    }
    if (theta[k] < free[k].lower || theta[k] > free[k].upper) {
      theta[k] = free[k].bounded_by_user ? between(generator, free[k].lower, free[k].upper)
                                         : std::clamp(theta[k], free[k].lower, free[k].upper);
    }
  }
  return theta;
}

/// Finds the start of least cost, and computes no cost of one that is known to be higher.
class Contest {
 public:
  explicit Contest(const Residuals& residuals) : residuals_(residuals) {}

  /// @param least_cost  that the start may have, as far as is known
  void enter(std::vector<double> theta, double least_cost) { entries_.push_back({least_cost, std::move(theta)}); }
  /// With the magnitude of the data.
  void enter_matched(std::vector<double> theta) {
    const double least_cost = match_magnitude(residuals_, theta);
    enter(std::move(theta), least_cost);
  }
  /// Empty where no cost is finite.
  [[nodiscard]] std::vector<double> winner() {
    std::ranges::stable_sort(entries_, {}, &Entry::least_cost);
    std::vector<double> best;
    double least = std::numeric_limits<double>::infinity();
    for (auto& [least_cost, theta] : entries_) {
      if (!(least_cost < least)) break;
      const double cost = residuals_.cost(theta);
      if (!(cost < least)) continue;
      least = cost;
      best = std::move(theta);
    }
    return best;
  }

 private:
  struct Entry {
    double least_cost;
    std::vector<double> theta;
  };
  const Residuals& residuals_;
  std::vector<Entry> entries_;
};

/// The draw with the start values the user gave in their places.
void take_given_starts(const ParameterMap& map, std::vector<double>& theta) {
  std::vector<double> parameters = map.to_user(theta);
  for (const ParameterMap::Free& entry : map.free()) {
    const double given = map.start()[entry.parameter];
    if (!std::isnan(given)) parameters[entry.parameter] = given;
  }
  theta = map.to_theta(parameters);
}

}  // namespace

double match_magnitude(const Residuals& residuals, std::vector<double>& theta) {
  const Residuals::BestFactor best = residuals.best_factor(theta);
  const double log_factor = std::log(best.factor);
  if (log_factor == 0) return best.cost;
  const auto& free = residuals.map().free();
  bool as_a_whole = residuals.map().scales_as_a_whole();
  for (std::size_t k = 0; k < free.size(); ++k) {
    const double shift = free[k].value_exponent * log_factor;
    const double matched = free[k].logarithmic ? theta[k] + shift : theta[k] * std::exp(shift);
    theta[k] = std::clamp(matched, free[k].lower, free[k].upper);
    as_a_whole = as_a_whole && theta[k] == matched;
  }
  return as_a_whole ? best.cost : 0;
}

std::vector<double> drawn_about(const ParameterMap& map, std::vector<double> theta, double reach,
                                std::mt19937_64& generator,
                                const std::function<double(const ParameterMap::Free&, double)>& delay_step) {
  constexpr double vanished = -20;
  for (std::size_t k = 0; k < theta.size(); ++k) {
    const ParameterMap::Free& free = map.free()[k];
    const double step = reach * normal_draw(generator);
    if (free.role == ParameterRole::order) {
      theta[k] += step / 3;
    } else if (free.role == ParameterRole::delay) {
      theta[k] += delay_step(free, step);
    } else if (!free.logarithmic) {
      theta[k] *= 1 + step;
    } else {
      theta[k] = theta[k] < vanished && free.least == 0 && !free.above ? step : theta[k] + step;
    }
    theta[k] = std::clamp(theta[k], free.lower, free.upper);
  }
  return theta;
}

std::vector<std::vector<double>> screened_draws(const Residuals& residuals, const std::vector<double>& suggested_orders,
                                                std::mt19937_64& generator, bool from_given_starts) {
  std::vector<std::vector<double>> starts;
  for (int start = 0; start < starts_per_round; ++start) {
    Contest contest(residuals);
    for (int i = 0; i < draws_per_start; ++i) {
      std::vector<double> theta = draw(residuals.map(), suggested_orders, generator);
      if (from_given_starts) {
        take_given_starts(residuals.map(), theta);
        contest.enter(std::move(theta), 0);
      } else {
        contest.enter_matched(std::move(theta));
      }
    }
    if (auto best = contest.winner(); !best.empty()) starts.push_back(std::move(best));
  }
  return starts;
}

std::vector<std::vector<double>> linear_starts(const Residuals& residuals, const std::vector<double>& suggested_orders,
                                               std::mt19937_64& generator) {
  constexpr int draws = 6;
  constexpr std::size_t kept = 2;
  const ParameterMap& map = residuals.map();
  const bool only_coefficients = std::all_of(map.free().begin(), map.free().end(), [](const ParameterMap::Free& entry) {
    return entry.role == ParameterRole::coefficient;
  });
  std::vector<std::pair<double, std::vector<double>>> found;
  for (int i = 0; i < (only_coefficients ? 1 : draws); ++i) {
    for (const auto& parameters : residuals.linear_fits(map.to_user(draw(map, suggested_orders, generator)))) {
      std::vector<double> theta = map.to_theta(parameters);
      const double cost = residuals.cost(theta);
      if (std::isfinite(cost)) found.emplace_back(cost, std::move(theta));
    }
  }
  std::sort(found.begin(), found.end());
  if (found.size() > kept) found.resize(kept);
  std::vector<std::vector<double>> starts;
  starts.reserve(found.size());
  for (auto& [cost, theta] : found) starts.push_back(std::move(theta));
  return starts;
}

std::vector<std::vector<double>> whole_order_starts(const Residuals& residuals,
                                                    const std::vector<double>& suggested_orders,
                                                    std::mt19937_64& generator) {
  constexpr int starts_made = 2;
  const ParameterMap& map = residuals.map();
  const auto whole = [&](std::vector<double> theta) {
    for (std::size_t k = 0; k < theta.size(); ++k) {
      const ParameterMap::Free& entry = map.free()[k];
      if (entry.role != ParameterRole::order) continue;
      // The variable of an order that is to lie above another one is its distance from that.
      const double nearest = entry.above ? 0 : entry.lower <= 1 && entry.upper >= 1 ? 1 : -1;
      theta[k] = std::clamp(nearest, entry.lower, entry.upper);
    }
    return theta;
  };
  const bool has_orders = std::any_of(map.free().begin(), map.free().end(), [](const ParameterMap::Free& entry) {
    return entry.role == ParameterRole::order;
  });
  std::vector<std::vector<double>> starts;
  if (!has_orders) return starts;
  for (int start = 0; start < starts_made; ++start) {
    throw_if_cancelled();
    Contest contest(residuals);
    for (int i = 0; i < draws_per_start; ++i) contest.enter_matched(whole(draw(map, suggested_orders, generator)));
    if (start == 0) {
      const std::vector<double> at = whole(draw(map, suggested_orders, generator));
      for (const auto& parameters : residuals.linear_fits(map.to_user(at))) contest.enter(map.to_theta(parameters), 0);
    }
    if (auto best = contest.winner(); !best.empty()) starts.push_back(std::move(best));
  }
  return starts;
}

std::vector<double> controlled_random_search(const Residuals& residuals, const std::vector<double>& start,
                                             std::uint64_t seed) {
  const auto& free = residuals.map().free();
  std::vector<double> lower, upper, inside = start;
  for (std::size_t k = 0; k < free.size(); ++k) {
    const double reach = free[k].role == ParameterRole::order ? 4 : 12;
    lower.push_back(std::max(free[k].lower, start[k] - reach));
    upper.push_back(std::min(free[k].upper, start[k] + reach));
  }
  nlopt_srand(static_cast<unsigned long>(seed));
  const std::unique_ptr<nlopt_opt_s, decltype(&nlopt_destroy)> search(
      nlopt_create(NLOPT_GN_CRS2_LM, static_cast<unsigned>(free.size())), &nlopt_destroy);
  nlopt_set_lower_bounds(search.get(), lower.data());
  nlopt_set_upper_bounds(search.get(), upper.data());
  nlopt_set_maxeval(search.get(), static_cast<int>(1000 * free.size()));
  const auto objective = [](unsigned count, const double* theta, double*, void* context) {
    // Nothing can be thrown through NLopt, which is C: the rest of its evaluations cost nothing.
    if (is_cancelled()) return 1e6;
    const CancellationScope unwatched(nullptr);
    const double cost = static_cast<const Residuals*>(context)->cost({theta, count});
    return std::isfinite(cost) ? std::log(cost + std::numeric_limits<double>::min()) : 1e6;
  };
  nlopt_set_min_objective(search.get(), objective, const_cast<Residuals*>(&residuals));
  double value = 0;
  // Whatever ends the search, `inside` is the best point it saw; the polish that follows judges it.
  nlopt_optimize(search.get(), inside.data(), &value);
  throw_if_cancelled();
  return inside;
}

}  // namespace frac::detail
