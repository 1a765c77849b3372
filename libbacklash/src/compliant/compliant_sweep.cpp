// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
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
#include "compliant_point.hpp"
#include "frac/cancellation.hpp"
#include "frac/parallel_for.hpp"
#include "loops/equations/gap_response.hpp"
#include "loops/motions/symmetric_forced_orbit.hpp"
#include "steady_state/describing_function_point.hpp"
#include "symmetric_compliant_orbit.hpp"

namespace backlash::detail {
namespace {

using Complex = std::complex<double>;
using Index = Eigen::Index;

// The symmetric orbits of two contacts of free bodies, one frequency after the other.
class SymmetricOrbitsOfContacts {
 public:
  SymmetricOrbitsOfContacts(const CompliantBodies& bodies, double force, Output output)
      : bodies_(bodies),
        force_(force),
        output_(output),
        contact_(free_contact(bodies.contact(), bodies.system().mass1(), bodies.system().mass2())) {}

  /// Where there is one that attracts.
  [[nodiscard]] std::optional<DescribingFunctionPoint> at(double omega) {
    const double gamma = dimensionless_force(bodies_.system(), force_, omega);
    const CompliantGroups groups{gamma, contact_.frequency / omega, contact_.damping_ratio};
    std::optional<SymmetricCompliantOrbit> orbit;
    if (last_) {
      const Guess guess = at_frequency(omega);
      orbit = symmetric_compliant_orbit(groups, guess[0], guess[1], guess[2]);
    }
    if (last_ && !orbit) orbit = symmetric_compliant_orbit(groups, last_->angle, last_->speed, last_->duration);
    if (!orbit) orbit = symmetric_compliant_orbit_from_hard(groups);
    if (!orbit || !(orbit->largest_multiplier < 1)) return std::nullopt;
    last_ = orbit;
    last_omega_ = omega;
    known_ = std::min<std::size_t>(known_ + 1, before_.size());
    for (std::size_t k = known_ - 1; k > 0; --k) before_[k] = before_[k - 1];
    before_[0] = {omega, {orbit->angle, orbit->speed, orbit->duration}};
    return point(*orbit, gamma, omega);
  }

  /// State at a peak of the force on the last orbit.
  [[nodiscard]] LoopStart at_peak() const {
    const CompliantFlow flow(bodies_, {force_, last_omega_}, output_, compliant_realisation, 1);
    const double width = bodies_.system().clearance(), total = bodies_.system().mass1() + bodies_.system().mass2();
    const double rate = last_->speed * width * last_omega_;
    // The centre of mass at rest at the next peak.
    const double centre = force_ / (total * last_omega_) * std::sin(last_->angle);
    const double v1 = centre - bodies_.system().mass2() / total * rate;
    Eigen::VectorXd state = flow.start({0, v1, 0.5 * width, v1 + rate});
    state[CompliantFlow::cosine] = std::cos(last_->angle);
    state[CompliantFlow::sine] = std::sin(last_->angle);
    CompliantRun run(flow, state, flow.mode_of(state));
    const double turn = 2 * std::numbers::pi;
    const double until = (turn - std::fmod(std::fmod(last_->angle, turn) + turn, turn)) / last_omega_;
    while (run.time() < until && !run.has_escaped()) run.advance(until);
    return CompliantFlow::positions(run.state());
  }

 private:
  using Guess = std::array<double, 3>;  // angle, speed, duration
  // By the polynomial through the last orbits.
  [[nodiscard]] Guess at_frequency(double omega) const {
    Guess guess{};
    for (std::size_t k = 0; k < known_; ++k) {
      double weight = 1;
      for (std::size_t other = 0; other < known_; ++other)
        if (other != k) weight *= (omega - before_[other].first) / (before_[k].first - before_[other].first);
      for (std::size_t i = 0; i < guess.size(); ++i) guess[i] += weight * before_[k].second[i];
    }
    return guess;
  }

  [[nodiscard]] DescribingFunctionPoint point(const SymmetricCompliantOrbit& orbit, double gamma, double omega) const {
    const double mass1 = bodies_.system().mass1(), mass2 = bodies_.system().mass2();
    // With the gap's phasor U = contact - gamma: x1 = -(U + gamma)/gamma, x2 = -1 + (M1/M2) U/gamma over the inertia.
    const Complex gap = orbit.contact[0] - gamma;
    const double inertia = (mass1 + mass2) * omega * omega, share = mass1 / mass2;
    const Complex first = -orbit.contact[0] / gamma, second = -1.0 + share * gap / gamma;
    const bool is_first = output_ == Output::x1;
    DescribingFunctionPoint point = empty_point(omega);
    point.value = (is_first ? first : second) / inertia;
    point.regime = Regime::symmetric;
    point.period = 1;
    point.impacts_per_period = 2;
    point.third_harmonic_ratio =
        (is_first ? 1 : share) * std::abs(orbit.contact[1]) / (9 * gamma * std::abs(is_first ? first : second));
    point.even_harmonic_ratio = 0;
    point.uncertainty =
        std::max(1e-13, orbit.residual) * std::abs(point.value) / std::max(1e-6, 1 - orbit.largest_multiplier);
    const double work = -std::numbers::pi * gamma * gap.imag(), moved = 2 * gamma * gamma / share * std::abs(second);
    point.energy_defect = std::abs(work - orbit.loss) / moved;
    point.lyapunov_exponent = std::log(orbit.largest_multiplier);
    return point;
  }

  const CompliantBodies& bodies_;
  double force_;
  Output output_;
  FreeContact contact_;
  std::optional<SymmetricCompliantOrbit> last_;
  double last_omega_ = 0;
  std::array<std::pair<double, Guess>, 3> before_{};  // frequencies and orbits, the last first
  std::size_t known_ = 0;
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

std::vector<DescribingFunctionPoint> independent_points(const CompliantScene& scene, const std::vector<double>& omega,
                                                        const SweepOptions& options, const SweepPiece& piece,
                                                        frac::Progress* progress) {
  std::vector<DescribingFunctionPoint> points;
  for (std::size_t i = piece.first; i < piece.first + piece.count; ++i) {
    frac::throw_if_cancelled();
    CompliantPoint point(scene.bodies, scene.force_amplitude, omega[i], options);
    points.push_back(point.follow(protocol_start(scene.bodies, options.protocol)).point);
    if (progress != nullptr) ++progress->done;
  }
  return points;
}

// Points that carry their state from one to the next.
std::vector<DescribingFunctionPoint> carried_points(const CompliantScene& scene, const std::vector<double>& omega,
                                                    const SweepOptions& options, frac::Progress* progress) {
  const auto& [bodies, force] = scene;
  std::vector<DescribingFunctionPoint> points(omega.size());
  const bool is_down = options.protocol == Protocol::sweep_down;
  const bool seeks_orbit = options.protocol == Protocol::two_impact;
  std::optional<SymmetricOrbitsOfContacts> symmetric;
  if (seeks_orbit && bodies.are_free()) symmetric.emplace(bodies, force, options.output);
  std::optional<ImpulseAnswer> response;
  LoopStart carried = protocol_start(bodies, options.protocol);
  bool is_owed = false;  // the state of a symmetric orbit, until it is needed
  for (std::size_t step = 0; step < omega.size(); ++step) {
    frac::throw_if_cancelled();
    const std::size_t i = is_down ? omega.size() - 1 - step : step;
    if (progress != nullptr) ++progress->done;
    if (symmetric) {
      if (const auto found = symmetric->at(omega[i])) {
        points[i] = *found;
        is_owed = true;
        continue;
      }
      if (std::exchange(is_owed, false)) carried = symmetric->at_peak();
    }
    CompliantPoint at(bodies, force, omega[i], options);
    std::optional<CompliantReached> reached;
    if (seeks_orbit) {
      if (!response) response.emplace(gap_response(bodies.hard()));
      reached = at.near(carried);
      const SymmetricForcedOrbit hard(bodies.hard(), *response, force, omega[i]);
      if (!reached && hard.exists()) reached = at.near(hard.at_peak());
    }
    if (!reached) reached = at.follow(carried);
    points[i] = reached->point;
    carried = CompliantFlow::positions(reached->state);
  }
  return points;
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
  return bodies_sweep_pieces(scenes, omega, options).sweeps(progress);
}

SweepPieces bodies_sweep_pieces(std::vector<CompliantScene> scenes, std::vector<double> omega,
                                const SweepOptions& options) {
  detail::require_valid(options);
  detail::require_frequency_grid(omega);
  std::vector<SweepScene> told;
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    const CompliantScene& scene = scenes[i];
    const std::string which = scenes.size() == 1 ? "" : " of scene " + std::to_string(i);
    detail::require_positive("force_amplitude" + which, "N", scene.force_amplitude);
    detail::require_followed(scene.bodies, omega.front());
    told.push_back({scene.bodies.system(), scene.force_amplitude});
  }
  const bool is_carried =
      options.protocol != Protocol::contact_at_rest && options.protocol != Protocol::mid_gap_at_rest;
  const auto compute = [scenes = std::move(scenes), omega, options, is_carried](const SweepPiece& piece,
                                                                                frac::Progress* progress) {
    const CompliantScene& scene = scenes[piece.scene];
    return is_carried ? detail::carried_points(scene, omega, options, progress)
                      : detail::independent_points(scene, omega, options, piece, progress);
  };
  return {std::move(told), std::move(omega), options, compute};
}

}  // namespace backlash
