#include "global_search.hpp"

#include <nlopt.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <random>

namespace frac::detail {

namespace {

constexpr int starts_per_round = 5;
constexpr int draws_per_start = 12;
constexpr int rounds = 16;
constexpr int least_rounds = 4;
constexpr std::size_t agreement = 4;
// A scouting solve is finished only if it came within this factor of the best cost so far.
constexpr double promising = 10;
// Two solves found the same minimum when their costs agree to this; separate minima closer than that are equally good
// fits.
constexpr double same_cost = 1e-6;

/// Uniform in [0, 1) from the generator's top 53 bits: the same on every platform, unlike
/// std::uniform_real_distribution.
double uniform(std::mt19937_64& generator) {
  return static_cast<double>(generator() >> 11) * 0x1p-53;
}

double between(std::mt19937_64& generator, double lower, double upper) {
  return lower + (upper - lower) * uniform(generator);
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
    // Orders beyond 2.5 are rare; the solver may still go there.
    const double lower = std::max(free[k].lower, -2.5), upper = std::min(free[k].upper, 2.5);
    const bool suggest = !suggested_orders.empty() && uniform(generator) < 0.5;
    const double suggestion = suggest ? suggested_orders[static_cast<std::size_t>(
                                            uniform(generator) * static_cast<double>(suggested_orders.size()))]
                                      : 0;
    theta[k] =
        suggest && suggestion >= free[k].lower && suggestion <= free[k].upper
            ? suggestion
            : (lower < upper ? between(generator, lower, upper) : between(generator, free[k].lower, free[k].upper));
    parameters[free[k].parameter] = theta[k];
  }
  for (std::size_t k = 0; k < free.size(); ++k) {
    if (free[k].role == ParameterRole::order) continue;
    const double log_value = between(generator, std::log(scale.value_lower), std::log(scale.value_upper));
    const double log_omega = between(generator, std::log(scale.omega_lower), std::log(scale.omega_upper));
    const double magnitude = free[k].value_exponent * (log_value - std::log(scale.value)) +
                             map.frequency_exponent(k, parameters) * (log_omega - std::log(scale.omega));
    if (free[k].logarithmic) {
      theta[k] = magnitude;
    } else {
      theta[k] = std::exp(magnitude);
      if (free[k].either_sign && uniform(generator) < 0.5) theta[k] = -theta[k];
    }
    if (theta[k] < free[k].lower || theta[k] > free[k].upper) {
      theta[k] = free[k].bounded_by_user ? between(generator, free[k].lower, free[k].upper)
                                         : std::clamp(theta[k], free[k].lower, free[k].upper);
    }
  }
  return theta;
}

/// The draw with the whole model multiplied by the factor that brings it nearest the data: by homogeneity, each
/// parameter times the factor to the power of its dimension.
void match_magnitude(const Residuals& residuals, std::vector<double>& theta) {
  const double log_factor = std::log(residuals.best_factor(theta));
  if (log_factor == 0) return;
  const auto& free = residuals.map().free();
  for (std::size_t k = 0; k < free.size(); ++k) {
    const double shift = free[k].value_exponent * log_factor;
    theta[k] = free[k].logarithmic ? theta[k] + shift : theta[k] * std::exp(shift);
    theta[k] = std::clamp(theta[k], free[k].lower, free[k].upper);
  }
}

/// The draw with the start values the user gave in their places.
void take_given_starts(const ParameterMap& map, std::vector<double>& theta) {
  std::vector<double> parameters = map.to_user(theta);
  for (const ParameterMap::Free& entry : map.free()) {
    const double given = map.start()[entry.parameter];
    if (!std::isnan(given)) parameters[entry.parameter] = given;
  }
  theta = map.to_theta(parameters);
}

/// The starts of a round, each the best of a few draws: screening all draws together would send every solve into the
/// one basin that looks best from afar.
std::vector<std::vector<double>> screened_draws(const Residuals& residuals, const std::vector<double>& suggested_orders,
                                                std::mt19937_64& generator, bool from_given_starts) {
  std::vector<std::vector<double>> starts;
  for (int start = 0; start < starts_per_round; ++start) {
    std::vector<double> best;
    double least = std::numeric_limits<double>::infinity();
    for (int i = 0; i < draws_per_start; ++i) {
      std::vector<double> theta = draw(residuals.map(), suggested_orders, generator);
      if (from_given_starts) {
        take_given_starts(residuals.map(), theta);
      } else {
        match_magnitude(residuals, theta);
      }
      const double cost = residuals.cost(theta);
      if (!(cost < least)) continue;
      least = cost;
      best = std::move(theta);
    }
    if (!best.empty()) starts.push_back(std::move(best));
  }
  return starts;
}

/// Best point of NLopt's CRS2 over a box six natural units (e-folds) around the data, for models no start agrees on.
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
    const double cost = static_cast<const Residuals*>(context)->cost({theta, count});
    return std::isfinite(cost) ? std::log(cost + std::numeric_limits<double>::min()) : 1e6;
  };
  nlopt_set_min_objective(search.get(), objective, const_cast<Residuals*>(&residuals));
  double value = 0;
  // Whatever ends the search, `inside` is the best point it saw; the polish that follows judges it.
  nlopt_optimize(search.get(), inside.data(), &value);
  return inside;
}

}  // namespace

std::vector<double> suggested_orders(const FrequencyResponseData& data) {
  const std::size_t n = data.size();
  const std::size_t window = std::max<std::size_t>(2, n / 8);
  if (n < 3) return {};
  const auto slope = [&](std::size_t first, auto part) {
    const std::size_t last = std::min(n - 1, first + window);
    const double rise = std::log(part(data.value()[last]) / part(data.value()[first]));
    return rise / std::log(data.omega()[last] / data.omega()[first]);
  };
  std::vector<double> orders;
  const auto add = [&](double order) {
    if (!std::isfinite(order)) return;
    for (const double share : {1.0, 0.75, 0.5, 0.25}) {
      orders.push_back(std::abs(order) * share);
      if (order < 0) orders.push_back(order * share);
    }
  };
  const auto magnitude = [](std::complex<double> value) { return std::abs(value); };
  const auto imaginary = [](std::complex<double> value) { return std::abs(value.imag()); };
  const std::size_t end = n - 1 > window ? n - 1 - window : 0;
  for (const std::size_t first : {std::size_t{0}, end}) {
    add(slope(first, magnitude));
    add(slope(first, imaginary));
  }
  return orders;
}

GlobalSolution global_search(const Residuals& residuals, const std::vector<double>& suggested_orders,
                             std::uint64_t seed) {
  std::mt19937_64 generator(seed);
  GlobalSolution result;
  result.best.cost = std::numeric_limits<double>::infinity();
  std::vector<double> costs;
  const double floor = residuals.rounding_cost();
  LocalOptions scouting;
  scouting.iterations = 40;
  scouting.cost_tolerance = 1e-6;
  // Scouts from each start, then finishes those that are in reach of the best.
  const auto try_from = [&](const std::vector<std::vector<double>>& starts) {
    std::vector<LocalSolution> found;
    double least = result.best.cost;
    for (const std::vector<double>& theta : starts) {
      found.push_back(local_solve(residuals, theta, scouting));
      least = std::min(least, found.back().cost);
    }
    for (LocalSolution& local : found) {
      ++result.starts;
      if (local.cost <= promising * least + floor) local = local_solve(residuals, local.theta, {});
      costs.push_back(local.cost);
      if (local.cost < result.best.cost) result.best = std::move(local);
    }
  };
  const auto at_best = [&] {
    return static_cast<std::size_t>(std::count_if(
        costs.begin(), costs.end(), [&](double cost) { return cost <= result.best.cost * (1 + same_cost) + floor; }));
  };

  const auto& free = residuals.map().free();
  const bool start_given = std::any_of(free.begin(), free.end(), [&](const ParameterMap::Free& entry) {
    return !std::isnan(residuals.map().start()[entry.parameter]);
  });
  for (int round = 0; round < rounds; ++round) {
    try_from(screened_draws(residuals, suggested_orders, generator, start_given && round == 0));
    result.starts_at_best = costs.empty() ? 0 : at_best();
    if (result.best.cost <= floor) return result;
    if (round + 1 >= least_rounds && result.starts_at_best >= agreement) return result;
  }
  if (result.starts_at_best == 1) {
    try_from({controlled_random_search(residuals, result.best.theta, seed)});
    result.starts_at_best = at_best();
  }
  return result;
}

}  // namespace frac::detail
