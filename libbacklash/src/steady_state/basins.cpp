// SPDX-License-Identifier: BSD-3-Clause
#include "backlash/basins.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <map>
#include <mutex>
#include <numeric>
#include <stdexcept>
#include <string>
#include <type_traits>

#include "base/check.hpp"
#include "describing_function_point.hpp"
#include "steady_state.hpp"

namespace backlash {
namespace {

// Phasors of one closed orbit agree to this over all starts.
constexpr double same_orbit = 1e-6;
// Force periods that a start is followed at most.
constexpr double longest_course = 100'000;
// Averaged starts that are followed on, of each scene, where no start has settled.
constexpr std::size_t probes = 16;
// Starts that are kept together: milliseconds of work.
constexpr std::size_t starts_per_piece = 16;

void check(const TwoMassSystem& system, double gamma, const std::vector<double>& position,
           const std::vector<double>& velocity) {
  detail::require_positive("clearance", "m", system.clearance());
  if (!(gamma > detail::free_force && gamma < detail::rigid_force)) {
    throw std::invalid_argument("F/(M2 clearance omega^2) is " + detail::text(gamma) + "; it must be in (1e-30, 1e30)");
  }
  if (position.empty()) throw std::invalid_argument("position is empty; it must hold at least one value");
  if (velocity.empty()) throw std::invalid_argument("velocity is empty; it must hold at least one value");
  for (std::size_t i = 0; i < position.size(); ++i) {
    if (!(position[i] >= 0 && position[i] <= system.clearance())) {
      throw std::invalid_argument("position[" + std::to_string(i) + "] is " + detail::text(position[i]) +
                                  "; it must be in [0, clearance = " + detail::text(system.clearance()) + "] (m)");
    }
  }
  for (std::size_t i = 0; i < velocity.size(); ++i) {
    if (!std::isfinite(velocity[i])) {
      throw std::invalid_argument("velocity[" + std::to_string(i) + "] is " + detail::text(velocity[i]) +
                                  "; it must be finite (m/s)");
    }
  }
}

bool is_mean(const detail::SteadyState& steady) {
  return steady.regime == Regime::averaged;
}

bool same(const detail::SteadyState& a, const detail::SteadyState& b) {
  if (a.regime == Regime::free || b.regime == Regime::free) return a.regime == b.regime;
  if (is_mean(a) || is_mean(b)) {
    return is_mean(a) && is_mean(b) && std::abs(a.harmonics.u[0] - b.harmonics.u[0]) <= a.uncertainty + b.uncertainty;
  }
  if (a.period != b.period || a.impacts_per_period != b.impacts_per_period) return false;
  if (std::abs(a.harmonics.u[0] - b.harmonics.u[0]) > same_orbit) return false;
  // Even harmonics of mirror twins have opposite signs.  An orbit of several periods seen from another one of them has
  // the same phasors.
  return std::abs(a.harmonics.u[detail::second_harmonic] - b.harmonics.u[detail::second_harmonic]) <= same_orbit;
}

bool is_symmetric(const detail::SteadyState& steady) {
  const double limit = is_mean(steady) ? steady.uncertainty : same_orbit;
  return std::abs(steady.harmonics.u[detail::second_harmonic]) <= limit;
}

// Follows a motion on from where it was left until it is known that it is no transient, or for long enough.
detail::SteadyState followed_on(const detail::GapMotion& motion, detail::SteadyState steady,
                                const SweepOptions& options) {
  double periods = steady.periods_followed;
  while (steady.transient_possible && periods < longest_course) {
    steady = detail::find_steady_state(motion, steady.end, options.tolerance);
    periods += steady.periods_followed;
    if (is_mean(steady)) steady.periods_followed = periods;
  }
  return steady;
}

// Goes through the numbers of an outcome, in the order of the members below.
template <class Step>
void for_each_number(StartOutcome& outcome, detail::SteadyState& steady, const Step& step) {
  std::size_t next = 0;
  const auto each = [&](auto& member) { step(outcome.at(next++), member); };
  const auto both = [&](std::complex<double>& z) {
    double real = z.real(), imag = z.imag();
    each(real);
    each(imag);
    z = {real, imag};
  };
  each(steady.regime);
  each(steady.period);
  each(steady.impacts_per_period);
  for (auto& phasor : steady.harmonics.u) both(phasor);
  both(steady.harmonics.u1_plus_gamma);
  each(steady.uncertainty);
  each(steady.spectral_radius);
  each(steady.energy_defect);
  each(steady.lyapunov);
  each(steady.end.half_period);
  each(steady.end.s);
  each(steady.end.sin_s);
  each(steady.end.cos_s);
  each(steady.end.wall);
  each(steady.end.distance);
  each(steady.end.velocity);
  each(steady.periods_followed);
  each(steady.transient_possible);
  each(steady.force_sensitivity);
}

StartOutcome outcome_of(detail::SteadyState steady) {
  StartOutcome outcome{};
  for_each_number(outcome, steady, [](double& number, const auto& member) { number = static_cast<double>(member); });
  return outcome;
}

detail::SteadyState steady_state_of(StartOutcome outcome) {
  detail::SteadyState steady{};
  for_each_number(outcome, steady, [](double number, auto& member) {
    member = static_cast<std::remove_reference_t<decltype(member)>>(number);
  });
  return steady;
}

class MemoryStore : public OutcomeStore {
 public:
  [[nodiscard]] bool contains(const std::string& key) const override {
    const std::lock_guard guard(mutex_);
    return kept_.contains(key);
  }
  [[nodiscard]] std::vector<StartOutcome> outcomes(const std::string& key) const override {
    const std::lock_guard guard(mutex_);
    return kept_.at(key);
  }
  void keep(const std::string& key, const std::vector<StartOutcome>& outcomes) override {
    const std::lock_guard guard(mutex_);
    kept_.emplace(key, outcomes);
  }

 private:
  mutable std::mutex mutex_;
  std::map<std::string, std::vector<StartOutcome>> kept_;
};

// A search whose outcomes stand in a store.
class Search {
 public:
  Search(const detail::GapMotion& motion, std::size_t starts, const SweepOptions& options, OutcomeStore& store)
      : motion_(motion), starts_(starts), options_(options), store_(store) {}

  /// Follows the starts that are not in the store.
  /// @param course  of a start
  template <class Course>
  void follow(const Course& course, frac::Progress* progress) {
    frac::parallel_for((starts_ + starts_per_piece - 1) / starts_per_piece, options_.threads, [&](std::size_t piece) {
      const std::size_t first = piece * starts_per_piece, last = std::min(starts_, first + starts_per_piece);
      const bool is_there = store_.contains(key_of(piece));
      std::vector<StartOutcome> outcomes;
      for (std::size_t i = first; i < last; ++i) {
        if (!is_there) outcomes.push_back(outcome_of(course(i)));
        if (progress != nullptr) ++progress->done;
      }
      if (!is_there) store_.keep(key_of(piece), outcomes);
    });
  }

  // Chaos that lasts over the usual window may be a transient.  Where starts settle on orbits all averaged ones are
  // followed on; where none does, a sample of them tells whether there is something to settle on.
  void outlast_transients() {
    std::vector<std::size_t> means;
    for_each([&](std::size_t i, const detail::SteadyState& steady) {
      if (steady.transient_possible) means.push_back(i);
    });
    std::size_t begin = 0;
    if (means.size() == starts_) {
      begin = std::min(probes, means.size());
      follow_on(means, 0, begin);
      bool none_settles = true;
      for (std::size_t i = 0; i < begin; ++i)
        none_settles = none_settles && is_mean(steady_state_of(store_.outcomes(key_of_end(means[i])).front()));
      if (none_settles) return;
    }
    follow_on(means, begin, means.size());
  }

  /// Hands over what each start leads to, as far as it is known, in the order of the starts.
  template <class Take>
  void for_each(const Take& take) const {
    for (std::size_t piece = 0; piece * starts_per_piece < starts_; ++piece) {
      const std::vector<StartOutcome> outcomes = store_.outcomes(key_of(piece));
      for (std::size_t i = 0; i < outcomes.size(); ++i) {
        const std::size_t start = piece * starts_per_piece + i;
        const detail::SteadyState steady = steady_state_of(outcomes[i]);
        const bool went_on = steady.transient_possible && store_.contains(key_of_end(start));
        take(start, went_on ? steady_state_of(store_.outcomes(key_of_end(start)).front()) : steady);
      }
    }
  }

 private:
  static std::string key_of(std::size_t piece) { return std::to_string(piece); }
  // Key of a start that was followed further.
  static std::string key_of_end(std::size_t start) { return "on-" + std::to_string(start); }

  void follow_on(const std::vector<std::size_t>& means, std::size_t first, std::size_t last) {
    frac::parallel_for(last - first, options_.threads, [&](std::size_t i) {
      const std::size_t start = means[first + i];
      if (store_.contains(key_of_end(start))) return;
      const StartOutcome outcome = store_.outcomes(key_of(start / starts_per_piece)).at(start % starts_per_piece);
      store_.keep(key_of_end(start), {outcome_of(followed_on(motion_, steady_state_of(outcome), options_))});
    });
  }

  const detail::GapMotion& motion_;
  std::size_t starts_;
  const SweepOptions& options_;
  OutcomeStore& store_;
};

}  // namespace

BasinMap basins(const TwoMassSystem& system, double force_amplitude, double omega, const std::vector<double>& position,
                const std::vector<double>& velocity, const SweepOptions& options, frac::Progress* progress) {
  MemoryStore store;
  return basins(system, force_amplitude, omega, position, velocity, options, progress, store);
}

BasinMap basins(const TwoMassSystem& system, double force_amplitude, double omega, const std::vector<double>& position,
                const std::vector<double>& velocity, const SweepOptions& options, frac::Progress* progress,
                OutcomeStore& store) {
  const double gamma = dimensionless_force(system, force_amplitude, omega);
  check(system, gamma, position, velocity);
  detail::require_valid(options);
  const detail::GapMotion motion(gamma, system.restitution());
  const std::size_t starts = position.size() * velocity.size();
  if (progress != nullptr) progress->total += starts;
  detail::MeanGoal goal = detail::mean_goal(system, gamma, options);
  goal.transients = detail::Transients::ignored;
  Search search(motion, starts, options, store);
  search.follow(
      [&](std::size_t i) {
        const detail::GapState start =
            motion.peak_state(0, {position[i / velocity.size()] / system.clearance(),
                                  velocity[i % velocity.size()] / (system.clearance() * omega)});
        return detail::find_steady_state(motion, start, options.tolerance, goal);
      },
      progress);
  search.outlast_transients();

  BasinMap map{system, force_amplitude, omega, position, velocity, {}, {}};
  std::vector<detail::SteadyState> first;  // that a start led to, of each attractor
  std::vector<std::size_t> count;
  search.for_each([&](std::size_t, const detail::SteadyState& steady) {
    const auto known = std::find_if(first.begin(), first.end(), [&](const auto& other) { return same(steady, other); });
    const auto index = static_cast<std::size_t>(known - first.begin());
    if (known == first.end()) {
      first.push_back(steady);
      count.push_back(0);
    }
    ++count[index];
    map.attractor.push_back(index);
  });
  std::vector<std::size_t> order(first.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return count[a] > count[b]; });
  std::vector<std::size_t> rank(order.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    rank[order[i]] = i;
    const detail::SteadyState& steady = first[order[i]];
    map.attractors.push_back(
        {detail::point_of(system, omega, gamma, options.output, steady), is_symmetric(steady), count[order[i]]});
  }
  for (std::size_t& index : map.attractor) index = rank[index];
  return map;
}

}  // namespace backlash
