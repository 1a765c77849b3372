// SPDX-License-Identifier: BSD-3-Clause
#include "forced_motion.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstddef>
#include <limits>
#include <numbers>
#include <optional>
#include <vector>

#include "base/impact_law.hpp"
#include "frac/cancellation.hpp"
#include "loop_run.hpp"
#include "loops/equations/cycle_equations.hpp"
#include "loops/equations/cycle_stability.hpp"
#include "realised_loop.hpp"
#include "steady_state/window_mean.hpp"

namespace backlash::detail {
namespace {

using Complex = std::complex<double>;
constexpr double pi = std::numbers::pi;
constexpr double nothing = std::numeric_limits<double>::quiet_NaN();

// Tolerance of fractional powers while a motion is followed; closed orbits are solved without them.
constexpr double realisation = 1e-9;
// Force periods: before returns are looked for, between two looks, of the longest orbit, left to the transient of a
// mean, of its window, and without an impact until there is none to come.
constexpr std::size_t first_look = 24, look_interval = 8, longest_period = 32, transient = 256, window = 1024,
                      first_judged = 128, quiet_periods = 64;
constexpr std::size_t most_impacts_closed = 24;
constexpr std::size_t most_impacts = 300'000;
// Distance of states, over clearance and omega: near enough for Newton's method.
constexpr double near_return = 1e-4;
// Change of the phasor, over its size: orbits with rests are followed until they repeat.
constexpr double repeated = 1e-9;

struct Peak {
  double gap;
  double gap_rate;
  std::size_t impacts;  // until then
  bool has_contact;     // in the period that ends there
  Complex phasor;       // of that period
};

class Follower {
 public:
  Follower(const LinearBodies& bodies, double force, double omega, const LoopStart& start, const SweepOptions& options)
      : bodies_(bodies),
        force_(force),
        omega_(omega),
        options_(options),
        loop_(bodies, {force, omega}, options.output, realisation),
        run_(loop_, start) {}

  [[nodiscard]] ForcedMotion follow() {
    const auto ended = [&](const DescribingFunctionPoint& point) {
      const LoopRow at = run_.row(LoopEvent::sample);
      ForcedMotion motion{point, {at.x1, at.v1, at.x2, at.v2}};
      motion.point.periods_followed = point.regime == Regime::averaged ? static_cast<double>(peaks_.size()) : 0;
      return motion;
    };
    while (peaks_.size() < transient + window && impacts_.size() < most_impacts) {
      frac::throw_if_cancelled();
      if (!follow_period()) break;
      const std::size_t count = peaks_.size();
      if (is_quiet()) return ended(free_point(bodies_, omega_, options_.output));
      if (count < first_look || count % look_interval != 0) continue;
      if (const auto point = resting_orbit()) return ended(*point);
      if (const auto point = closed_orbit()) return ended(*point);
      if (is_known()) break;
    }
    return ended(mean());
  }

 private:
  [[nodiscard]] double period() const { return 2 * pi / omega_; }

  bool follow_period() {
    const double until = static_cast<double>(peaks_.size() + 1) * period();
    bool has_contact = run_.is_in_contact();
    while (run_.time() < until) {
      const LoopRun::Event event = run_.advance(until);
      if (event == LoopRun::Event::impact) impacts_.push_back(run_.last_impact());
      has_contact = has_contact || run_.is_in_contact();
      if (run_.is_stuck() || run_.is_spent() || run_.has_diverged() || impacts_.size() > most_impacts) return false;
    }
    const LoopRow at = run_.row(LoopEvent::sample);
    const double clearance = bodies_.system().clearance();
    peaks_.push_back({(at.x2 - at.x1) / clearance, (at.v2 - at.v1) / (clearance * omega_), impacts_.size(), has_contact,
                      run_.take_phasor() / force_});
    return true;
  }

  [[nodiscard]] const Peak& back(std::size_t periods) const { return peaks_[peaks_.size() - 1 - periods]; }

  [[nodiscard]] bool is_quiet() const {
    return peaks_.size() > quiet_periods && back(0).impacts == back(quiet_periods).impacts && !back(0).has_contact;
  }

  [[nodiscard]] Complex mean_of_last(std::size_t periods, std::size_t before = 0) const {
    Complex sum = 0;
    for (std::size_t i = 0; i < periods; ++i) sum += back(before + i).phasor;
    return sum / static_cast<double>(periods);
  }

  // Rests in contact forget what was before them, but for what friction and springs remember.
  [[nodiscard]] std::optional<DescribingFunctionPoint> resting_orbit() const {
    for (std::size_t p = 1; p <= 4; ++p) {
      bool rests = true;
      for (std::size_t i = 0; i < 2 * p; ++i) rests = rests && back(i).has_contact;
      if (!rests) return std::nullopt;
      const Complex value = mean_of_last(p);
      const double change = std::abs(value - mean_of_last(p, p));
      if (change > repeated * std::abs(value)) continue;
      DescribingFunctionPoint point = empty_point(omega_);
      point.value = value;
      point.regime = Regime::chatter;
      point.period = static_cast<int>(p);
      point.impacts_per_period = std::numeric_limits<double>::infinity();
      point.uncertainty = 4 * change + (1e-10 + loop_.error()) * std::abs(value);
      point.lyapunov_exponent = -std::numeric_limits<double>::infinity();
      return point;
    }
    return std::nullopt;
  }

  [[nodiscard]] std::optional<DescribingFunctionPoint> closed_orbit() {
    for (std::size_t p = 1; p <= std::min(longest_period, peaks_.size() - 1); ++p) {
      const Peak& now = back(0);
      const Peak& then = back(p);
      if (std::abs(now.gap - then.gap) + std::abs(now.gap_rate - then.gap_rate) > near_return) continue;
      const std::size_t count = now.impacts - then.impacts;
      if (count == 0 || count > most_impacts_closed || peaks_.size() < wait_until_) return std::nullopt;
      for (std::size_t i = 0; i < p; ++i) {
        if (back(i).has_contact) return std::nullopt;
      }
      if (const auto point = closed(p, count)) return point;
      // A guess that led nowhere is not tried for as long again.
      wait_until_ = 2 * peaks_.size();
      return std::nullopt;
    }
    return std::nullopt;
  }

  // The orbit that the last impacts follow.
  [[nodiscard]] std::optional<DescribingFunctionPoint> closed(std::size_t periods, std::size_t count) const {
    const auto turns = static_cast<int>(periods);
    const TwoMassSystem& system = bodies_.system();
    const LoopImpact* const first = impacts_.data() + (impacts_.size() - count);
    CycleGuess guess{turns * period(), {}};
    for (std::size_t b = 0; b < count; ++b) {
      const double sign = first[b].wall == Wall::far ? 1 : -1;
      guess.impacts.push_back({first[b].time - first->time, sign * impulse_per_speed(system) * first[b].speed, 0});
    }
    if (guess.impacts.back().time >= guess.period || guess.impacts.front().impulse == 0) return std::nullopt;
    const Complex drive = bodies_.drive().response(omega_);
    const CycleEquations equations(bodies_, guess, {force_ * std::abs(drive), turns});
    const auto solution = equations.solve(guess, std::remainder(omega_ * first->time, 2 * pi) + std::arg(drive));
    if (!solution || !equations.reason_against(solution->motion).empty()) return std::nullopt;
    const ClosedMotion& motion = solution->motion;
    std::vector<double> times;
    std::vector<double> bend = equations.gap(motion, 2);
    for (std::size_t b = 0; b < count; ++b) {
      if (std::abs(motion.shares[b] * motion.period - guess.impacts[b].time) > 0.01 * period()) return std::nullopt;
      times.push_back(motion.shares[b] * motion.period);
      bend[b] /= -motion.impulses[b];
    }
    const CycleStability stability =
        cycle_stability(equations.response(), ImpulseTrain(equations.response(), motion.period), times, bend,
                        equations.exchange(), true);
    if (!stability.stable) return std::nullopt;
    return point_of(motion, turns, std::abs(stability.dominant), solution->error);
  }

  [[nodiscard]] DescribingFunctionPoint point_of(const ClosedMotion& motion, int turns, double multiplier,
                                                 double error) const {
    const Complex drive = bodies_.drive().response(omega_);
    const Complex forced = force_ * std::polar(1.0, motion.phase - std::arg(drive));
    const frac::FractionalTransferFunction& body = options_.output == Output::x1 ? bodies_.load() : bodies_.drive();
    const auto of_impulses = [&](int order) {
      return body.response(order * omega_) * CycleEquations::strength(motion, order * turns);
    };
    const Complex read = options_.output == Output::x1 ? of_impulses(1) : drive * forced - of_impulses(1);
    DescribingFunctionPoint point = empty_point(omega_);
    point.value = read / forced;
    point.period = turns;
    point.impacts_per_period = static_cast<double>(motion.shares.size()) / turns;
    point.third_harmonic_ratio = std::abs(of_impulses(3) / read);
    point.even_harmonic_ratio = std::abs(of_impulses(2) / read);
    const bool is_symmetric = turns == 1 && motion.shares.size() == 2 && point.even_harmonic_ratio < 1e-9;
    point.regime = is_symmetric ? Regime::symmetric : Regime::periodic;
    if (is_symmetric) point.even_harmonic_ratio = 0;
    // The error that the sums and the last step leave, and what a weak attraction makes of it.
    point.uncertainty = (1e-11 + error) * std::abs(point.value) / std::max(1e-6, 1 - multiplier);
    point.lyapunov_exponent = std::log(multiplier) / turns;
    return point;
  }

  // The window that is averaged: all after the transient.
  [[nodiscard]] std::size_t window_size() const { return peaks_.size() > transient ? peaks_.size() - transient : 0; }

  [[nodiscard]] bool is_known() const {
    const std::size_t length = window_size();
    if (options_.mean_tolerance == 0 || length < first_judged || (length & (length - 1)) != 0) return false;
    const DescribingFunctionPoint point = mean();
    return point.uncertainty <= options_.mean_tolerance * std::abs(point.value);
  }

  [[nodiscard]] DescribingFunctionPoint mean() const {
    DescribingFunctionPoint point = empty_point(omega_);
    point.transient_possible = true;
    const std::size_t length = std::max(window_size(), std::min<std::size_t>(peaks_.size() / 2, transient));
    if (length < 16) return point;
    const Peak& begin = back(length);
    point.impacts_per_period = static_cast<double>(back(0).impacts - begin.impacts) / static_cast<double>(length);
    std::vector<Complex> phasors;
    for (std::size_t i = 0; i < length; ++i) phasors.push_back(back(i).phasor);
    const PeriodMean found = mean_of_periods(phasors);
    point.value = found.value;
    point.uncertainty = found.half_width + loop_.error() * std::abs(point.value);
    return point;
  }

  const LinearBodies& bodies_;
  double force_;
  double omega_;
  const SweepOptions& options_;
  RealisedLoop loop_;
  LoopRun run_;
  std::vector<LoopImpact> impacts_;
  std::vector<Peak> peaks_;
  std::size_t wait_until_ = 0;
};

}  // namespace

DescribingFunctionPoint empty_point(double omega) {
  DescribingFunctionPoint point{};
  point.omega = omega;
  point.value = {nothing, nothing};
  point.regime = Regime::averaged;
  point.impacts_per_period = point.uncertainty = point.third_harmonic_ratio = nothing;
  return point;
}

DescribingFunctionPoint free_point(const LinearBodies& bodies, double omega, Output output) {
  DescribingFunctionPoint point = empty_point(omega);
  point.value = output == Output::x1 ? 0 : bodies.drive().response(omega);
  point.regime = Regime::free;
  point.period = 1;
  point.impacts_per_period = 0;
  point.uncertainty = 1e-15 * std::abs(point.value);
  point.energy_defect = 0;
  return point;
}

ForcedMotion follow_forced(const LinearBodies& bodies, double force, double omega, const LoopStart& start,
                           const SweepOptions& options) {
  return Follower(bodies, force, omega, start, options).follow();
}

}  // namespace backlash::detail
