// SPDX-License-Identifier: BSD-3-Clause
#include "backlash/basins.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <stdexcept>
#include <string>
#include <type_traits>

#include "base/check.hpp"
#include "describing_function_point.hpp"
#include "start_search.hpp"
#include "steady_state.hpp"

namespace backlash {
namespace {

// Phasors of one closed orbit agree to this over all starts.
constexpr double same_orbit = 1e-6;
// Force periods that a start is followed at most.
constexpr double longest_course = 100'000;
// Averaged starts that are followed on, of each scene, where no start has settled.
constexpr std::size_t probes = 16;

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

// A search that follows long transients on.
class Search : public detail::StartSearch {
 public:
  Search(const detail::GapMotion& motion, std::size_t starts, const SweepOptions& options, OutcomeStore& store)
      : StartSearch(starts, options.threads, store), motion_(motion), options_(options) {}

  // Chaos that lasts over the usual window may be a transient.  Where starts settle on orbits all averaged ones are
  // followed on; where none does, a sample of them tells whether there is something to settle on.
  void outlast_transients() {
    std::vector<std::size_t> means;
    for_each([&](std::size_t i, const detail::SteadyState& steady) {
      if (steady.transient_possible) means.push_back(i);
    });
    std::size_t begin = 0;
    if (means.size() == starts()) {
      begin = std::min(probes, means.size());
      follow_on(means, 0, begin);
      bool none_settles = true;
      for (std::size_t i = 0; i < begin; ++i)
        none_settles = none_settles && is_mean(steady_state_of(store().outcomes(key_of_end(means[i])).front()));
      if (none_settles) return;
    }
    follow_on(means, begin, means.size());
  }

  /// Hands over what each start leads to, as far as it is known, in the order of the starts.
  template <class Take>
  void for_each(const Take& take) const {
    for_each_outcome([&](std::size_t start, const StartOutcome& outcome) {
      const detail::SteadyState steady = steady_state_of(outcome);
      const bool went_on = steady.transient_possible && store().contains(key_of_end(start));
      take(start, went_on ? steady_state_of(store().outcomes(key_of_end(start)).front()) : steady);
    });
  }

 private:
  // Key of a start that was followed further.
  static std::string key_of_end(std::size_t start) { return "on-" + std::to_string(start); }

  void follow_on(const std::vector<std::size_t>& means, std::size_t first, std::size_t last) {
    frac::parallel_for(last - first, threads(), [&](std::size_t i) {
      const std::size_t start = means[first + i];
      if (store().contains(key_of_end(start))) return;
      store().keep(key_of_end(start), {outcome_of(followed_on(motion_, steady_state_of(outcome(start)), options_))});
    });
  }

  const detail::GapMotion& motion_;
  const SweepOptions& options_;
};

}  // namespace

BasinMap basins(const TwoMassSystem& system, double force_amplitude, double omega, const std::vector<double>& position,
                const std::vector<double>& velocity, const SweepOptions& options, frac::Progress* progress) {
  return detail::in_memory([&](OutcomeStore& store) {
    return basins(system, force_amplitude, omega, position, velocity, options, progress, store);
  });
}

BasinMap basins(const TwoMassSystem& system, double force_amplitude, double omega, const std::vector<double>& position,
                const std::vector<double>& velocity, const SweepOptions& options, frac::Progress* progress,
                OutcomeStore& store) {
  const double gamma = dimensionless_force(system, force_amplitude, omega);
  detail::require_positive("clearance", "m", system.clearance());
  if (!(gamma > detail::free_force && gamma < detail::rigid_force)) {
    throw std::invalid_argument("F/(M2 clearance omega^2) is " + detail::text(gamma) + "; it must be in (1e-30, 1e30)");
  }
  detail::require_starts(system, position, velocity);
  detail::require_valid(options);
  const detail::GapMotion motion(gamma, system.restitution());
  detail::MeanGoal goal = detail::mean_goal(system, gamma, options);
  goal.transients = detail::Transients::ignored;
  Search search(motion, position.size() * velocity.size(), options, store);
  search.follow(
      [&](std::size_t i) {
        const detail::GapState start =
            motion.peak_state(0, {position[i / velocity.size()] / system.clearance(),
                                  velocity[i % velocity.size()] / (system.clearance() * omega)});
        return outcome_of(detail::find_steady_state(motion, start, options.tolerance, goal));
      },
      progress);
  search.outlast_transients();

  BasinMap map{system, force_amplitude, omega, position, velocity, {}, {}};
  detail::MotionsOfStarts<detail::SteadyState, decltype(&same)> motions(&same);
  search.for_each([&](std::size_t, const detail::SteadyState& steady) { motions.add(steady); });
  motions.write(map, [&](const detail::SteadyState& steady, std::size_t starts) {
    return Attractor{detail::point_of(system, omega, gamma, options.output, steady), is_symmetric(steady), starts};
  });
  return map;
}

}  // namespace backlash
