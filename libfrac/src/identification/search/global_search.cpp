// SPDX-License-Identifier: BSD-3-Clause
#include "global_search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <random>
#include <utility>

#include "base/linear_algebra.hpp"
#include "linearisation.hpp"
#include "search_starts.hpp"

namespace frac::detail {

namespace {

constexpr int rounds = 24;
constexpr int least_rounds = 4;
constexpr int rounds_for_a_start = 4, least_rounds_for_a_start = 2;
constexpr std::size_t agreement = 4;
constexpr double enough_confidence = 0.9;
// A structure that something else beats by far is told by its rms, to a part in a hundred: twice that in its cost is
// the same, and solves end a hundred times closer (rates in tests/benchmarks/ranking_rates).
constexpr double equally_hopeless = 0.02;
constexpr double scouting_hopeless = 1e-4;
// A scout that was stopped early goes on only if it came within the first factor of the best cost so far, and one that
// came to rest is finished only if within the second: the minimum of all residuals next to that of 40 of them is lower
// by the share of noise that parameters follow, k/40 or so.
constexpr double promising = 10;
constexpr double in_reach = 3;
// Ends whose costs agree to this are the same minimum, or equally good fits; those beyond `rival` times the best are
// poor ones.
constexpr double equally_good = 1e-3;
constexpr double rival = 1.5;
// Of mean squares of residuals over all points and over those scouted: noise alone gives 40 points a standard deviation
// of 1/sqrt(20) = 22 % or less, so this is more than four of them.
constexpr double missed_feature = 2;
// A walk is worth its solves along directions where one natural unit (an e-fold) adds less than this many times the
// cost: beyond, the quadratic picture says that the data pin the parameter down.
constexpr double hardly_resists = 0.1;

/// Directions of theta, their largest entry 1, along which a step of 1 adds less than `times` the cost, as the
/// curvature at the solution says.
std::vector<std::vector<double>> flat_directions(const Residuals& residuals, const LocalSolution& solution,
                                                 double times) {
  const std::optional<Linearisation> at_best = linearised(residuals, solution.theta);
  if (!at_best) return {};
  const auto [values, vectors] = right_singular_vectors(at_best->reduced());
  std::vector<std::vector<double>> directions;
  for (Eigen::Index k = values.size(); k-- > 0;) {
    const Eigen::VectorXd direction = vectors.col(k) / vectors.col(k).lpNorm<Eigen::Infinity>();
    const double rise = values[k] * direction.norm();
    if (!(rise * rise <= times * solution.cost)) continue;
    directions.emplace_back(direction.begin(), direction.end());
  }
  return directions;
}

/// The state of one search.
class Search {
 public:
  Search(const Residuals& scouting, const Residuals& residuals, const std::vector<double>& suggested_orders,
         std::uint64_t seed, double hopeless, SearchAim aim)
      : scouting_(scouting),
        residuals_(residuals),
        suggested_orders_(suggested_orders),
        seed_(seed),
        hopeless_(hopeless),
        only_start_(aim == SearchAim::start),
        generator_(seed) {
    result_.best.cost = std::numeric_limits<double>::infinity();
  }

  GlobalSolution run() {
    const auto& free = residuals_.map().free();
    const auto given = std::count_if(free.begin(), free.end(), [&](const ParameterMap::Free& entry) {
      return !std::isnan(residuals_.map().start()[entry.parameter]);
    });
    const bool all_given = static_cast<std::size_t>(given) == free.size();
    // These are not drawn like the others, so they say nothing of the number of minima.
    scout_from(linear_starts(scouting_, suggested_orders_, generator_));
    scout_from(whole_order_starts(scouting_, suggested_orders_, generator_));
    if (all_given) scout_from({residuals_.map().to_theta(residuals_.map().start())});
    independent_ = 0;
    const int most = only_start_ ? rounds_for_a_start : rounds;
    const int least = only_start_ ? least_rounds_for_a_start : least_rounds;
    for (int round = 0; round < most && !exact(); ++round) {
      scout_from(screened_draws(scouting_, suggested_orders_, generator_, given > 0 && !all_given && round == 0));
      // A structure that something else beats by far needs its optimum for its row of a ranking, and no walk beyond one
      // found several times (rates in tests/benchmarks/ranking_rates).  Solves that stopped far out in a valley agree
      // too, but on no minimum, so that the best one first goes on.
      const bool hopeless = is_hopeless();
      if (!hopeless && round + 1 < least) continue;
      finish_promising();
      const bool last = !only_start_ && round + 1 == rounds;
      if (hopeless && (settled() || last)) {
        if (!only_start_) go_on();
        result_.left_early = settled() || last;
        if (result_.left_early) break;
        continue;
      }
      if (settled() && (only_start_ || (!walk_to_lower_cost() && settled()))) break;
    }
    finish_promising();
    if (std::isfinite(result_.best.cost) && !exact() && !only_start_) cross_limits();
    if (at_best() == 1 && !exact() && !only_start_) {
      const std::size_t independent = independent_;
      scout_from({controlled_random_search(scouting_, result_.best.theta, seed_)});
      finish_promising();
      independent_ = independent;
    }
    if (std::isfinite(result_.best.cost)) {
      result_.starts = scouts_.size();
      result_.starts_at_best = at_best();
      result_.minima = minima();
      // A cost of zero cannot be beaten.
      result_.confidence = exact() ? 1 : confidence();
    }
    return result_;
  }

 private:
  struct Scout {
    LocalSolution local;             // on the scouting residuals
    double end;                      // cost of all residuals there, or of the minimum it leads to once finished
    std::vector<double> theta = {};  // where it ended once finished
    enum { waiting, finished, dropped } state = waiting;
  };

  [[nodiscard]] LocalOptions scouting_options() const {
    LocalOptions options;
    options.iterations = 40;
    options.cost_tolerance = !scouts_.empty() && is_hopeless() ? scouting_hopeless : 1e-6;
    return options;
  }

  /// Closer than what tells one minimum from another.
  [[nodiscard]] static LocalOptions finishing_options() {
    LocalOptions options;
    options.cost_tolerance = 1e-10;
    return options;
  }

  [[nodiscard]] bool exact() const { return result_.best.cost <= residuals_.rounding_cost(); }
  [[nodiscard]] double confidence() const { return confidence_of_optimum(independent_, minima()); }
  [[nodiscard]] bool is_hopeless() const { return least_end_ > hopeless_; }
  [[nodiscard]] bool settled() const {
    return at_best() >= agreement && (only_start_ || confidence() >= enough_confidence);
  }
  [[nodiscard]] bool same(double cost, double least) const {
    return cost <= least * (1 + (is_hopeless() ? equally_hopeless : equally_good)) + residuals_.rounding_cost();
  }

  [[nodiscard]] std::size_t at_best() const {
    return static_cast<std::size_t>(std::count_if(
        scouts_.begin(), scouts_.end(), [&](const Scout& scout) { return same(scout.end, result_.best.cost); }));
  }

  /// Distinct costs up to `rival` times the best; all ends beyond it count as one.
  [[nodiscard]] std::size_t minima() const {
    std::vector<double> costs;
    for (const Scout& scout : scouts_) costs.push_back(scout.end);
    std::sort(costs.begin(), costs.end());
    const double floor = residuals_.rounding_cost();
    std::size_t count = 0;
    double least = -1;  // of the minimum counted last
    for (const double cost : costs) {
      if (least >= 0 && same(cost, least)) continue;
      ++count;
      least = cost;
      if (cost > rival * result_.best.cost + floor) break;
    }
    return count;
  }

  /// Short solves from each start on the scouting residuals.
  void scout_from(const std::vector<std::vector<double>>& starts) {
    for (const std::vector<double>& theta : starts) {
      scouts_.push_back({local_solve(scouting_, theta, scouting_options()), 0, {}});
      Scout& scout = scouts_.back();
      end_at(residuals_.cost(scout.local.theta), scout);
      ++independent_;
      if (scout.end <= residuals_.rounding_cost()) finish(scout);
    }
  }

  void end_at(double cost, Scout& scout) {
    scout.end = cost;
    least_end_ = std::min(least_end_, cost);
  }

  /// Solves from where a scout stopped on all residuals.  What goes below the best is polished, if that is of use.
  void finish(Scout& scout) {
    LocalSolution local = scout.local;
    if (!only_start_) {
      const bool hopeless = is_hopeless();
      if (hopeless) local = local_solve(residuals_, local.theta, scouting_options());
      if (!hopeless || !same(result_.best.cost, local.cost))
        local = local_solve(residuals_, local.theta, finishing_options());
      if (local.cost < result_.best.cost && !hopeless) local = local_solve(residuals_, local.theta, {});
    }
    end_at(local.cost, scout);
    scout.theta = local.theta;
    scout.state = Scout::finished;
    if (local.cost < result_.best.cost) result_.best = std::move(local);
  }

  /// Goes on from the best ends of a hopeless structure: the cost may still fall from them.
  void go_on() {
    std::vector<Scout*> ended;
    for (Scout& scout : scouts_)
      if (!scout.theta.empty()) ended.push_back(&scout);
    std::sort(ended.begin(), ended.end(), [](const Scout* a, const Scout* b) { return a->end < b->end; });
    const std::size_t most = settled() ? 1 : agreement;
    for (std::size_t i = 0; i < std::min(most, ended.size()); ++i) {
      Scout& scout = *ended[i];
      for (int round = 0; round < 5; ++round) {
        LocalSolution local = local_solve(residuals_, scout.theta, finishing_options());
        const double before = scout.end;
        end_at(local.cost, scout);
        const bool is_at_rest = local.converged || same(before, local.cost);
        scout.theta = local.theta;
        if (local.cost < result_.best.cost) result_.best = std::move(local);
        if (is_at_rest) break;
      }
    }
  }

  /// Lets a scout that was stopped early come to rest, or a hopeless one near it: the best of these go on in the end.
  void pursue(Scout& scout) {
    LocalOptions patient = scouting_options();
    patient.iterations = is_hopeless() && !only_start_ ? 40 : 200;
    scout.local = local_solve(scouting_, scout.local.theta, patient);
    end_at(residuals_.cost(scout.local.theta), scout);
  }

  /// A finished scout that came to rest at the same cost.
  [[nodiscard]] const Scout* twin_of(const Scout& scout) const {
    const auto twin = std::find_if(scouts_.begin(), scouts_.end(), [&](const Scout& other) {
      return other.state == Scout::finished && scout.local.converged && other.local.converged &&
             same(scout.local.cost, other.local.cost) && same(other.local.cost, scout.local.cost);
    });
    return twin == scouts_.end() ? nullptr : &*twin;
  }

  /// Finishes the scouts in reach of the best, best first, but for those that came to rest where a finished one did
  /// before.  True if one went below the best.
  bool finish_promising() {
    const double before = result_.best.cost;
    std::vector<Scout*> waiting;
    for (Scout& scout : scouts_) {
      if (scout.state == Scout::waiting && std::isfinite(scout.end)) waiting.push_back(&scout);
    }
    std::sort(waiting.begin(), waiting.end(), [](const Scout* a, const Scout* b) { return a->end < b->end; });
    const auto within = [&](const Scout& scout, double times) {
      const double least = std::min(result_.best.cost, waiting.front()->end);
      return scout.end <= times * least + residuals_.rounding_cost();
    };
    for (Scout* const scout : waiting) {
      if (exact()) break;
      if (!scout->local.converged && within(*scout, only_start_ ? in_reach : promising)) pursue(*scout);
      if (!within(*scout, in_reach)) {
        scout->state = Scout::dropped;
      } else if (const Scout* twin = twin_of(*scout)) {
        scout->end = twin->end;
        scout->state = Scout::finished;
      } else {
        finish(*scout);
      }
    }
    return !same(before, result_.best.cost);
  }

  /// Solves from the best point with one parameter at its other limit: of either sign, across its barrier, which is 0,
  /// or infinity for the coefficient 1/M, where the smaller value is where a solve goes on that a barrier at infinity
  /// stopped; or beyond the band, where it acts like 0 or infinity, as far beyond the other end of the band.
  void cross_limits() {
    const std::size_t independent = independent_;
    const auto& free = residuals_.map().free();
    const std::vector<double>& best = result_.best.theta;
    std::vector<std::vector<double>> starts;
    for (std::size_t k = 0; k < free.size(); ++k) {
      if (is_beyond_band(k)) starts.push_back(at_other_end(k));
      if (!free[k].either_sign || free[k].logarithmic) continue;
      for (const double times : {-1.0, -1e-3}) {
        starts.push_back(best);
        starts.back()[k] = std::clamp(times * best[k], free[k].lower, free[k].upper);
      }
    }
    std::erase_if(starts, [&](const auto& theta) { return !std::isfinite(scouting_.cost(theta)); });
    scout_from(starts);
    finish_promising();
    independent_ = independent;
  }

  /// A coefficient of which the corner, as of T in T s + 1, is at no frequency of the band.
  [[nodiscard]] bool is_beyond_band(std::size_t k) const {
    const ParameterMap& map = residuals_.map();
    const ParameterMap::Free& entry = map.free()[k];
    if (entry.role != ParameterRole::coefficient || !entry.logarithmic || entry.above) return false;
    const DataScale& scale = map.scale();
    const double corner = std::abs(map.frequency_exponent(k, map.to_user(result_.best.theta))) *
                          std::log(scale.omega_upper / scale.omega);
    return corner > 0 && std::abs(result_.best.theta[k]) > corner;
  }

  /// With the magnitude of the data, and their sign where the gains may have either.
  [[nodiscard]] std::vector<double> at_other_end(std::size_t k) const {
    const auto& free = residuals_.map().free();
    std::vector<double> theta = result_.best.theta;
    theta[k] = std::clamp(-theta[k], free[k].lower, free[k].upper);
    std::vector<double> opposite = theta;
    for (std::size_t i = 0; i < free.size(); ++i) {
      if (free[i].either_sign && !free[i].logarithmic && free[i].value_exponent != 0)
        opposite[i] = std::clamp(-theta[i], free[i].lower, free[i].upper);
    }
    match_magnitude(scouting_, theta);
    match_magnitude(scouting_, opposite);
    return scouting_.cost(opposite) < scouting_.cost(theta) ? opposite : theta;
  }

  /// Solves from points some e-folds away from the best one along its flat directions, until none leads lower.
  bool walk_to_lower_cost() {
    const std::size_t independent = independent_;
    bool lower = false;
    for (int walk = 0; walk < 4 && !exact(); ++walk) {
      std::vector<std::vector<double>> starts;
      for (const std::vector<double>& direction : flat_directions(residuals_, result_.best, hardly_resists)) {
        for (const double step : {-4.0, -2.0, -1.0, 1.0, 2.0, 4.0}) add_step(direction, step, starts);
        for (const double step : dips_along(direction)) add_step(direction, step, starts);
      }
      scout_from(starts);
      if (!finish_promising()) break;
      lower = true;
    }
    independent_ = independent;
    return lower;
  }

  void add_step(const std::vector<double>& direction, double step, std::vector<std::vector<double>>& starts) const {
    std::vector<double> theta = stepped(direction, step);
    if (std::isfinite(scouting_.cost(theta))) starts.push_back(std::move(theta));
  }

  /// Steps within 24 e-folds of the best point at which the cost has a minimum along the line, the lowest few.
  [[nodiscard]] std::vector<double> dips_along(const std::vector<double>& direction) const {
    constexpr int reach = 96;
    constexpr double spacing = 0.25;
    constexpr std::size_t most = 4;
    std::vector<double> cost;
    for (int i = -reach; i <= reach; ++i) cost.push_back(scouting_.cost(stepped(direction, i * spacing)));
    std::vector<std::pair<double, double>> dips;
    for (std::size_t at = 1; at + 1 < cost.size(); ++at) {
      const double step = (static_cast<double>(at) - reach) * spacing;
      if (step != 0 && cost[at] < cost[at - 1] && cost[at] < cost[at + 1]) dips.emplace_back(cost[at], step);
    }
    std::sort(dips.begin(), dips.end());
    if (dips.size() > most) dips.resize(most);
    std::vector<double> steps;
    steps.reserve(dips.size());
    for (const auto& [height, step] : dips) steps.push_back(step);
    return steps;
  }

  [[nodiscard]] std::vector<double> stepped(const std::vector<double>& direction, double step) const {
    const auto& free = residuals_.map().free();
    std::vector<double> theta = result_.best.theta;
    for (std::size_t k = 0; k < theta.size(); ++k) {
      theta[k] = std::clamp(theta[k] + step * direction[k], free[k].lower, free[k].upper);
    }
    return theta;
  }

  const Residuals& scouting_;
  const Residuals& residuals_;
  const std::vector<double>& suggested_orders_;
  std::uint64_t seed_;
  double hopeless_;
  bool only_start_;
  std::mt19937_64 generator_;
  GlobalSolution result_;
  std::vector<Scout> scouts_;
  double least_end_ = std::numeric_limits<double>::infinity();  // that any scout has had
  std::size_t independent_ = 0;  // scouts from seeded starts, not from the best of the others
};

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

double confidence_of_optimum(std::size_t starts, std::size_t minima) {
  if (starts < minima + 2) return 0;
  return 1 - static_cast<double>(minima) / static_cast<double>(starts - 1);
}

GlobalSolution global_search(const Residuals& scouting, const Residuals& residuals,
                             const std::vector<double>& suggested_orders, std::uint64_t seed, double hopeless,
                             SearchAim aim) {
  GlobalSolution found = Search(scouting, residuals, suggested_orders, seed, hopeless, aim).run();
  if (&scouting == &residuals) return found;
  const auto mean = [&](const Residuals& of) {
    return of.cost(found.best.theta) / static_cast<double>(of.count()) + of.rounding_cost();
  };
  if (found.starts_at_best > 0 && (found.best.cost > hopeless || mean(residuals) <= missed_feature * mean(scouting))) {
    return found;
  }
  const std::size_t in_vain = found.starts;
  found = Search(residuals, residuals, suggested_orders, seed, hopeless, aim).run();
  found.starts += in_vain;
  return found;
}

}  // namespace frac::detail
