// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "backlash/compliant/compliant_bodies.hpp"
#include "base/check.hpp"
#include "compliant_orbit.hpp"
#include "frac/cancellation.hpp"
#include "frac/parallel_for.hpp"
#include "loops/equations/gap_response.hpp"
#include "loops/motions/forced_motion.hpp"
#include "loops/motions/symmetric_forced_orbit.hpp"
#include "steady_state/describing_function_point.hpp"
#include "steady_state/window_mean.hpp"

namespace backlash::detail {
namespace {

using Complex = std::complex<double>;
using Index = Eigen::Index;

// Of fractional powers.
constexpr double realisation = 1e-9;
// Force periods: before returns are looked for, between two looks, of the longest orbit, left to the transient of a
// mean, of its window, of one that is judged, without a contact until there is none to come, and of the value of a
// motion without any.
constexpr std::size_t first_look = 16, look_interval = 8, longest_period = 32, transient = 256, window = 1024,
                      first_judged = 128, quiet_periods = 64, quiet_window = 8;
// Periods followed from a guess of an orbit before Newton's method.
constexpr int settling = 2;
// Over the sizes of the states: near enough for Newton's method.
constexpr double near_return = 1e-3;

struct Peak {
  Eigen::VectorXd state;  // those that repeat
  std::int64_t contacts;  // until then
  Complex phasor;         // of that period, m/N
};

/// A point with the state at its last peak.
struct Reached {
  DescribingFunctionPoint point;
  Eigen::VectorXd state;
  CompliantMode mode;
};

class Point {
 public:
  Point(const CompliantBodies& bodies, double force, double omega, const SweepOptions& options)
      : bodies_(bodies),
        force_{force, omega},
        options_(options),
        flow_(bodies, force_, options.output, realisation, 1) {}

  /// The stable orbit of one period near a motion that begins there, if Newton's method finds one.
  [[nodiscard]] std::optional<Reached> near(const LoopStart& start) const {
    const Eigen::VectorXd state = flow_.start(start);
    CompliantRun run(flow_, state, flow_.mode_of(state));
    if (!run.follow(settling)) return std::nullopt;
    const auto orbit = closed_orbit(flow_, run.state(), run.mode(), 1);
    if (!orbit || orbit->contacts == 0 || !(orbit->largest_multiplier < 1)) return std::nullopt;
    return reached(*orbit);
  }

  /// Follows the motion until it is decided what it comes to.
  [[nodiscard]] Reached follow(const LoopStart& start) {
    const Eigen::VectorXd state = flow_.start(start);
    CompliantRun run(flow_, state, flow_.mode_of(state));
    peaks_.clear();
    std::size_t wait_until = first_look;
    const auto ended = [&](const DescribingFunctionPoint& point) { return Reached{point, run.state(), run.mode()}; };
    while (peaks_.size() < transient + window) {
      if (!run.follow(1)) break;
      peaks_.push_back({repeating(run.state()), run.contacts(), position(run.phasors().front())});
      if (is_quiet()) return ended(quiet());
      if (is_known()) break;
      if (peaks_.size() < wait_until || peaks_.size() % look_interval != 0) continue;
      const std::optional<int> periods = returns_after();
      if (!periods) continue;
      const auto orbit = closed_orbit(flow_, run.state(), run.mode(), *periods);
      if (orbit && orbit->contacts > 0 && orbit->largest_multiplier < 1) return reached(*orbit);
      // What led nowhere is left alone for as long again.
      wait_until = 2 * peaks_.size();
    }
    return ended(mean());
  }

 private:
  [[nodiscard]] Complex position(Complex velocity) const {
    return velocity / Complex(0, force_.omega) / force_.amplitude;
  }

  [[nodiscard]] Eigen::VectorXd repeating(const Eigen::VectorXd& state) const {
    Eigen::VectorXd result(static_cast<Index>(flow_.repeating().size()));
    for (std::size_t i = 0; i < flow_.repeating().size(); ++i) {
      const Index at = flow_.repeating()[i];
      result[static_cast<Index>(i)] = state[at] / flow_.sizes()[at];
    }
    return result;
  }

  [[nodiscard]] const Peak& back(std::size_t periods) const { return peaks_[peaks_.size() - 1 - periods]; }

  [[nodiscard]] std::optional<int> returns_after() const {
    for (std::size_t p = 1; p <= std::min(longest_period, peaks_.size() - 1); ++p)
      if ((back(0).state - back(p).state).cwiseAbs().maxCoeff() < near_return && back(0).contacts > back(p).contacts)
        return static_cast<int>(p);
    return std::nullopt;
  }

  [[nodiscard]] bool is_quiet() const {
    return peaks_.size() > quiet_periods && back(0).contacts == back(quiet_periods).contacts;
  }

  // Without contacts body 1 comes to rest; body 2 moves as its own receptance and dry friction let it.
  [[nodiscard]] DescribingFunctionPoint quiet() const {
    DescribingFunctionPoint point = free_point(bodies_.hard(), force_.omega, options_.output);
    if (options_.output == Output::x1 || flow_.friction(1) == 0) return point;
    point.value = mean_of_last(quiet_window);
    for (std::size_t i = 0; i < quiet_window; ++i)
      point.uncertainty = std::max(point.uncertainty, std::abs(back(i).phasor - point.value));
    point.energy_defect = std::numeric_limits<double>::quiet_NaN();
    return point;
  }

  [[nodiscard]] Complex mean_of_last(std::size_t periods, std::size_t before = 0) const {
    Complex sum = 0;
    for (std::size_t i = 0; i < periods; ++i) sum += back(before + i).phasor;
    return sum / static_cast<double>(periods);
  }

  [[nodiscard]] Reached reached(const CompliantOrbit& orbit) const {
    const CompliantReading reading = read_orbit(orbit, bodies_, force_, options_.output, realisation);
    DescribingFunctionPoint point = empty_point(force_.omega);
    point.value = reading.value;
    point.period = orbit.periods;
    point.impacts_per_period = static_cast<double>(orbit.contacts) / orbit.periods;
    point.third_harmonic_ratio = reading.third_ratio;
    // What a mirror symmetric motion has of it is rounding.
    constexpr double no_even_harmonic = 1e-9;
    const bool is_symmetric = orbit.periods == 1 && reading.second_ratio < no_even_harmonic;
    point.even_harmonic_ratio = is_symmetric ? 0 : reading.second_ratio;
    point.regime = is_symmetric ? Regime::symmetric : Regime::periodic;
    // What flights round and the last step leaves, and what a weak attraction makes of it.
    point.uncertainty =
        std::max(1e-13, orbit.residual) * std::abs(point.value) / std::max(1e-6, 1 - orbit.largest_multiplier) +
        flow_.error() * std::abs(point.value);
    point.energy_defect = std::abs(reading.work - reading.loss) / reading.moved;
    point.lyapunov_exponent = std::log(orbit.largest_multiplier) / orbit.periods;
    return {point, orbit.state, orbit.mode};
  }

  // A mean of which that is enough.
  [[nodiscard]] bool is_known() const {
    const std::size_t length = peaks_.size() > transient ? peaks_.size() - transient : 0;
    if (options_.mean_tolerance == 0 || length < first_judged || (length & (length - 1)) != 0) return false;
    const DescribingFunctionPoint point = mean();
    return point.uncertainty <= options_.mean_tolerance * std::abs(point.value);
  }

  [[nodiscard]] DescribingFunctionPoint mean() const {
    DescribingFunctionPoint point = empty_point(force_.omega);
    point.transient_possible = true;
    point.periods_followed = static_cast<double>(peaks_.size());
    const std::size_t length = std::max(peaks_.size() > transient ? peaks_.size() - transient : 0,
                                        std::min<std::size_t>(peaks_.size() / 2, transient));
    if (length < 16) return point;
    point.value = mean_of_last(length);
    point.impacts_per_period =
        static_cast<double>(back(0).contacts - back(length).contacts) / static_cast<double>(length);
    double half_width = 0;
    for (const std::size_t batches : {std::size_t{16}, std::size_t{8}}) {
      std::vector<Complex> deviations;
      const std::size_t each = length / batches;
      for (std::size_t i = 0; i < batches; ++i) deviations.push_back(mean_of_last(each, i * each) - point.value);
      half_width = std::max(half_width, half_width_of_mean(deviations));
    }
    point.uncertainty = half_width + flow_.error() * std::abs(point.value);
    return point;
  }

  const CompliantBodies& bodies_;
  SineForce force_;
  const SweepOptions& options_;
  CompliantFlow flow_;
  std::vector<Peak> peaks_;
};

// At a peak of the force; free bodies with their centre of mass at rest, as the force leaves it there.
LoopStart protocol_start(const CompliantBodies& bodies, Protocol protocol) {
  LoopStart start;
  if (protocol == Protocol::contact_at_rest) {
    start.x1 = 0.25 * bodies.system().clearance();
    start.x2 = -start.x1;
  }
  return start;
}

}  // namespace
}  // namespace backlash::detail

namespace backlash {

DescribingFunctionSweep bodies_describing_function(const CompliantBodies& bodies, double force_amplitude,
                                                   const std::vector<double>& omega, const SweepOptions& options) {
  return std::move(bodies_describing_functions({{bodies, force_amplitude}}, omega, options).front());
}

std::vector<DescribingFunctionSweep> bodies_describing_functions(const std::vector<CompliantScene>& scenes,
                                                                 const std::vector<double>& omega,
                                                                 const SweepOptions& options,
                                                                 frac::Progress* progress) {
  detail::require_valid(options);
  detail::require_frequency_grid(omega);
  std::vector<DescribingFunctionSweep> sweeps;
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    const CompliantScene& scene = scenes[i];
    const std::string which = scenes.size() == 1 ? "" : " of scene " + std::to_string(i);
    detail::require_positive("force_amplitude" + which, "N", scene.force_amplitude);
    sweeps.push_back({scene.bodies.system(), scene.force_amplitude, options, {}});
    sweeps.back().points.resize(omega.size());
  }
  if (progress != nullptr) progress->total += scenes.size() * omega.size();
  const bool is_carried =
      options.protocol != Protocol::contact_at_rest && options.protocol != Protocol::mid_gap_at_rest;
  const auto count = [&] {
    if (progress != nullptr) ++progress->done;
  };
  if (!is_carried) {
    frac::parallel_for(scenes.size() * omega.size(), options.threads, [&](std::size_t number) {
      const CompliantScene& scene = scenes[number / omega.size()];
      const std::size_t i = number % omega.size();
      detail::Point point(scene.bodies, scene.force_amplitude, omega[i], options);
      sweeps[number / omega.size()].points[i] =
          point.follow(detail::protocol_start(scene.bodies, options.protocol)).point;
      count();
    });
    return sweeps;
  }
  const bool is_down = options.protocol == Protocol::sweep_down;
  frac::parallel_for(scenes.size(), options.threads, [&](std::size_t number) {
    const auto& [bodies, force] = scenes[number];
    std::optional<detail::ImpulseAnswer> response;
    if (options.protocol == Protocol::two_impact) response.emplace(detail::gap_response(bodies.hard()));
    LoopStart carried = detail::protocol_start(bodies, options.protocol);
    for (std::size_t step = 0; step < omega.size(); ++step) {
      const std::size_t i = is_down ? omega.size() - 1 - step : step;
      detail::Point point(bodies, force, omega[i], options);
      std::optional<detail::Reached> reached;
      if (response) {
        reached = point.near(carried);
        const detail::SymmetricForcedOrbit hard(bodies.hard(), *response, force, omega[i]);
        if (!reached && hard.exists()) reached = point.near(hard.at_peak());
      }
      if (!reached) reached = point.follow(carried);
      sweeps[number].points[i] = reached->point;
      carried = detail::CompliantFlow::positions(reached->state);
      count();
    }
  });
  return sweeps;
}

}  // namespace backlash
