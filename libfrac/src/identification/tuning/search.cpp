// SPDX-License-Identifier: BSD-3-Clause
#include "search.hpp"

#include <nlopt.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "frac/cancellation.hpp"
#include "gain_space.hpp"
#include "loop.hpp"

namespace frac::detail {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double nothing = std::numeric_limits<double>::quiet_NaN();

class Search {
 public:
  Search(const FractionalTransferFunction& plant, const LoopSpecification& asked, const TuningOptions& options)
      : asked_(asked),
        options_(options),
        space_(plant, asked, options),
        grid_(plant, space_.reference(), bound_frequencies(asked)) {
    if (options.criterion != TuningCriterion::sensitivity) {
      constexpr int samples = 1500;
      simulation_.emplace(plant, options.horizon, options.load_step, samples);
    }
  }

  FoundController operator()() {
    go();
    throw_if_cancelled();
    return {best_.gains, evaluations_, searches_, alike_};
  }

 private:
  struct Candidate {
    FractionalPidGains gains;
    std::vector<double> violations;  // above 0 where kept not
    double criterion = infinity;
    [[nodiscard]] double worst() const { return *std::max_element(violations.begin(), violations.end()); }
    [[nodiscard]] bool keeps_all() const {
      constexpr double kept = 1e-9;
      return worst() <= kept;
    }
    // Whatever keeps the specification is before whatever does not.
    [[nodiscard]] double rank() const {
      constexpr double far = 1e9;
      const double value = worst();
      if (!std::isfinite(value)) return 10 * far;
      return keeps_all() ? std::min(criterion, far) : far * (1 + std::min(value, 1.0)) + std::min(value, far);
    }
  };

  using Objective = double (*)(unsigned, const double*, double*, void*);

  [[nodiscard]] std::size_t dimensions() const { return space_.lower().size(); }

  void go() {
    if (dimensions() == 0) {
      consider({});
      return;
    }
    if (space_.is_overdetermined()) {
      search_flat_line();
      return;
    }
    look_around({}, 0);
    nlopt_srand(static_cast<unsigned long>(options_.seed));
    const auto free = static_cast<int>(dimensions());
    const auto objective = [](unsigned count, const double* x, double*, void* self) {
      return static_cast<Search*>(self)->consider({x, x + count}).rank();
    };
    const int budget = simulation_ ? 400 : 700;
    run(NLOPT_GN_CRS2_LM, objective, budget * free, false);
    // Again from the best, under the inequalities as such.
    const auto smooth = [](unsigned count, const double* x, double*, void* self) {
      return std::min(static_cast<Search*>(self)->consider({x, x + count}).criterion, 1e9);
    };
    run(NLOPT_LN_COBYLA, smooth, 150 * free, true);
    // An integral has many local minima along the bounds, and a small region that keeps them all escapes one search.
    if (simulation_ || !best_.keeps_all()) search_from_many();
  }

  // Local searches from the best points met that differ, and a finer one from where the best of them ended.
  void search_from_many() {
    constexpr std::size_t most = 16, followed = 4;
    constexpr double apart = 0.25, wide = 0.1, fine = 0.02, alike = 1.01;
    std::sort(met_.begin(), met_.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    std::vector<std::vector<double>> starts;
    for (const auto& [rank, x] : met_) {
      const auto& point = x;
      if (starts.size() == most) break;
      if (std::all_of(starts.begin(), starts.end(), [&](const auto& other) { return distance(other, point) > apart; }))
        starts.push_back(point);
    }
    const int free = static_cast<int>(dimensions());
    using End = std::pair<double, std::vector<double>>;
    std::vector<End> ends;
    const auto follow = [&](const std::vector<double>& from, double step, int budget) {
      run_best_ = infinity;
      run_best_at_ = from;
      descend(from, step, budget * free);
      return End(run_best_, run_best_at_);
    };
    for (const auto& start : starts) ends.push_back(follow(start, wide, 40));
    std::sort(ends.begin(), ends.end());
    // The best of them again, from where they ended.
    ends.resize(std::min(ends.size(), followed));
    for (int round = 0; round < 5; ++round) {
      for (End& end : ends) end = std::min(end, follow(end.second, round % 2 == 0 ? wide : fine, 50));
    }
    searches_ = static_cast<int>(ends.size());
    alike_ = static_cast<int>(
        std::count_if(ends.begin(), ends.end(), [&](const End& end) { return end.first <= alike * best_.rank(); }));
  }

  // Largest distance of two points in units of the ranges.
  [[nodiscard]] double distance(const std::vector<double>& a, const std::vector<double>& b) const {
    double largest = 0;
    for (std::size_t i = 0; i < a.size(); ++i)
      largest = std::max(largest, std::abs(a[i] - b[i]) / (space_.upper()[i] - space_.lower()[i]));
    return largest;
  }

  // Downhill with what is not kept as a penalty.
  void descend(std::vector<double> x, double step, int budget) {
    const std::unique_ptr<nlopt_opt_s, decltype(&nlopt_destroy)> search(
        nlopt_create(NLOPT_LN_SBPLX, static_cast<unsigned>(dimensions())), &nlopt_destroy);
    nlopt_set_lower_bounds(search.get(), space_.lower().data());
    nlopt_set_upper_bounds(search.get(), space_.upper().data());
    nlopt_set_maxeval(search.get(), budget);
    nlopt_set_xtol_rel(search.get(), 1e-5);
    const auto penalised = [](unsigned count, const double* at, double*, void* self) {
      constexpr double weight = 30, hopeless = 1e3;
      const Candidate candidate = static_cast<Search*>(self)->consider({at, at + count});
      double missed = 0;
      for (const double violation : candidate.violations) missed += std::clamp(violation, 0.0, hopeless);
      return weight * missed + (std::isfinite(candidate.criterion) ? std::log(candidate.criterion) : hopeless);
    };
    nlopt_set_min_objective(search.get(), penalised, this);
    std::vector<double> steps(x.size());
    for (std::size_t i = 0; i < x.size(); ++i) steps[i] = step * (space_.upper()[i] - space_.lower()[i]);
    nlopt_set_initial_step(search.get(), steps.data());
    double value = 0;
    nlopt_optimize(search.get(), x.data(), &value);
    throw_if_cancelled();
  }

  static std::vector<double> bound_frequencies(const LoopSpecification& asked) {
    std::vector<double> omega;
    if (asked.crossover) omega.push_back(*asked.crossover);
    if (asked.high_frequency) omega.push_back(asked.high_frequency->omega);
    if (asked.low_frequency) omega.push_back(asked.low_frequency->omega);
    return omega;
  }

  void run(nlopt_algorithm algorithm, Objective objective, int budget, bool constrained) {
    const std::unique_ptr<nlopt_opt_s, decltype(&nlopt_destroy)> search(
        nlopt_create(algorithm, static_cast<unsigned>(dimensions())), &nlopt_destroy);
    nlopt_set_lower_bounds(search.get(), space_.lower().data());
    nlopt_set_upper_bounds(search.get(), space_.upper().data());
    nlopt_set_maxeval(search.get(), budget);
    nlopt_set_xtol_rel(search.get(), 1e-7);
    nlopt_set_min_objective(search.get(), objective, this);
    std::vector<double> x(dimensions());
    for (std::size_t i = 0; i < x.size(); ++i) {
      x[i] = best_at_.empty() ? (space_.lower()[i] + space_.upper()[i]) / 2 : best_at_[i];
    }
    if (constrained) {
      const auto constraints = [](unsigned count, double* value, unsigned n, const double* at, double*, void* self) {
        const Candidate candidate = static_cast<Search*>(self)->consider({at, at + n});
        for (unsigned i = 0; i < count; ++i) value[i] = std::min(candidate.violations[i], 1e3);
      };
      const auto count = static_cast<unsigned>(best_.violations.size());
      nlopt_add_inequality_mconstraint(search.get(), count, constraints, this, nullptr);
      std::vector<double> step(x.size());
      for (std::size_t i = 0; i < x.size(); ++i) step[i] = 0.03 * (space_.upper()[i] - space_.lower()[i]);
      nlopt_set_initial_step(search.get(), step.data());
    }
    double value = 0;
    // Whatever it returns, the best candidate met on the way is kept.
    nlopt_optimize(search.get(), x.data(), &value);
    throw_if_cancelled();
  }

  // Some points of each range, ends included: a small region of stable loops may escape a random population.
  void look_around(std::vector<double> x, std::size_t next) {
    throw_if_cancelled();
    if (next == dimensions()) {
      consider(x);
      return;
    }
    const int points = space_.is_order(next) ? 5 : 4;
    for (int i = 0; i < points; ++i) {
      x.push_back(space_.lower()[next] + (space_.upper()[next] - space_.lower()[next]) * i / (points - 1));
      look_around(x, next + 1);
      x.pop_back();
    }
  }

  // Two gains leave one equation for one order: its roots between steps of a scan.
  void search_flat_line() {
    constexpr int steps = 400;
    const auto slope_at = [&](double order) {
      std::vector<double> x(dimensions());
      x[0] = order;
      if (x.size() > 1) x[1] = free_phase_;
      return space_.phase_slope(space_.gains(x));
    };
    std::vector<std::pair<double, std::vector<double>>> scanned;  // slope at an order
    const int phases = dimensions() > 1 ? 40 : 1;
    for (int phase = 0; phase < phases; ++phase) {
      if (phases > 1) free_phase_ = space_.lower()[1] + (space_.upper()[1] - space_.lower()[1]) * phase / (phases - 1);
      double before_order = 0;
      double before = nothing;
      for (int i = 0; i <= steps; ++i) {
        const double order = space_.lower()[0] + (space_.upper()[0] - space_.lower()[0]) * i / steps;
        const double value = slope_at(order);
        if (value == 0 || before * value < 0) {
          double left = i == 0 ? order : before_order;
          double right = order;
          for (int k = 0; k < 80; ++k) {
            const double middle = (left + right) / 2;
            (slope_at(middle) * value > 0 ? right : left) = middle;
          }
          std::vector<double> x(dimensions(), free_phase_);
          x[0] = right;
          consider(x);
        }
        std::vector<double> x(dimensions(), free_phase_);
        x[0] = order;
        if (std::isfinite(value)) scanned.emplace_back(std::abs(value), std::move(x));
        before_order = order;
        before = value;
      }
    }
    if (!best_at_.empty()) return;
    // No root: the flattest of those that keep the rest.
    std::sort(scanned.begin(), scanned.end());
    for (const auto& [slope, x] : scanned)
      if (consider(x).keeps_all()) return;
    if (best_at_.empty()) consider(space_.lower());
  }

  Candidate consider(const std::vector<double>& x) {
    // Nothing can be thrown through NLopt, which is C and calls this: run() throws.  look_around() has found a best
    // one.
    if (is_cancelled()) return best_;
    const CancellationScope unwatched(nullptr);
    ++evaluations_;
    Candidate candidate;
    candidate.gains = space_.gains(x);
    FractionalPidGains& gains = candidate.gains;
    double* const gain[3] = {&gains.kp, &gains.ki, &gains.kd};
    const GainSpace::Shares shares = space_.shares(gains);
    for (int i = 0; i < 3; ++i) {
      // However small, a negative gain is one unstable pole, and a positive one a pole that cannot be told from none.
      if (std::abs(shares.of[i]) < 1e-9) *gain[i] = 0;
      candidate.violations.push_back(-shares.of[i]);
    }
    const bool finite = std::isfinite(gains.kp) && std::isfinite(gains.ki) && std::isfinite(gains.kd);
    const double high = asked_.high_frequency ? asked_.high_frequency->omega : infinity;
    const double low = asked_.low_frequency ? asked_.low_frequency->omega : 0;
    const LoopGrid::Peaks peaks = finite ? grid_.peaks(gains, options_.derivative_filter_time, high, low)
                                         : LoopGrid::Peaks{infinity, infinity, infinity, infinity, infinity};
    const auto add = [&](double reached, double bound) {
      if (std::isfinite(bound)) candidate.violations.push_back(std::log(reached / bound));
    };
    // Half a pole is the rounding of a count.
    candidate.violations.push_back(peaks.unstable_poles > 0.5 ? peaks.unstable_poles : -0.5);
    // Of a plant that keeps a gain at all frequencies: what any dead time would make unstable is no loop.
    constexpr double most_at_infinity = 0.9;
    if (grid_.gain_at_infinity() > 0)
      candidate.violations.push_back(
          std::log(std::max(grid_.gain_at_infinity() * std::abs(gains.kp), 1e-9) / most_at_infinity));
    if (options_.structure == ControllerStructure::series) {
      // What counts as kept is then real for rounding too.
      constexpr double spare = 2e-9;
      candidate.violations.push_back(4 * gains.ki * gains.kd - (1 - spare) * gains.kp * gains.kp);
      if (candidate.violations.back() != 0) candidate.violations.back() /= gains.kp * gains.kp;
    }
    add(peaks.sensitivity, asked_.max_sensitivity);
    add(peaks.complementary_sensitivity, asked_.max_complementary_sensitivity);
    if (asked_.high_frequency) add(peaks.high_frequency, asked_.high_frequency->gain);
    if (asked_.low_frequency) add(peaks.low_frequency, asked_.low_frequency->gain);
    if (!finite) {
      for (double& violation : candidate.violations) violation = infinity;
    } else if (!simulation_) {
      candidate.criterion = peaks.sensitivity;
    } else if (candidate.worst() < 0.5) {
      const ErrorIntegrals integrals = (*simulation_)(gains, options_.derivative_filter_time);
      candidate.criterion = options_.criterion == TuningCriterion::iae ? integrals.iae : integrals.itae;
    }
    // Just outside the specification too, where the local search steps.
    if (options_.objective && candidate.worst() < 0.02) {
      candidate.criterion = options_.objective(gains, candidate.criterion);
    }
    const double rank = candidate.rank();
    met_.emplace_back(rank, x);
    if (rank < run_best_) {
      run_best_ = rank;
      run_best_at_ = x;
    }
    if (best_.violations.empty() || rank < best_.rank()) {
      best_ = candidate;
      best_at_ = x;
    }
    return candidate;
  }

  const LoopSpecification& asked_;
  const TuningOptions& options_;
  GainSpace space_;
  LoopGrid grid_;
  std::optional<LoopSimulation> simulation_;
  double free_phase_ = 1;
  Candidate best_;
  std::vector<double> best_at_;
  std::vector<std::pair<double, std::vector<double>>> met_;  // ranks of all points
  double run_best_ = infinity;
  std::vector<double> run_best_at_;
  int evaluations_ = 0, searches_ = 0, alike_ = 0;
};

}  // namespace

FoundController search_controller(const FractionalTransferFunction& plant, const LoopSpecification& asked,
                                  const TuningOptions& options) {
  return Search(plant, asked, options)();
}

}  // namespace frac::detail
