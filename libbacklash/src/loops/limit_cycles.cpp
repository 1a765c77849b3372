// SPDX-License-Identifier: BSD-3-Clause
#include "backlash/loops/limit_cycles.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "base/check.hpp"
#include "base/spelling.hpp"
#include "cycle_frequencies.hpp"
#include "cycle_stability.hpp"
#include "frequency_search.hpp"
#include "gap_response.hpp"

namespace backlash {
namespace {

using Complex = std::complex<double>;
constexpr double pi = std::numbers::pi;

constexpr std::array<std::pair<StabilityLoss, std::string_view>, 4> loss_names{
    {{StabilityLoss::none, "none"},
     {StabilityLoss::symmetry_breaking, "symmetry-breaking"},
     {StabilityLoss::saddle_node, "saddle-node"},
     {StabilityLoss::torus, "torus"}}};

double exchange(const TwoMassSystem& system) {
  return (1 / system.mass1() + 1 / system.mass2()) / (1 + system.restitution());
}

// Largest excursion towards either wall between the impacts, in units of the clearance, and when.
struct Excursion {
  double size;
  double instant;  // over the half period
};
Excursion largest_excursion(const detail::ImpulseTrain& train, double impulse, double clearance) {
  constexpr int points = 96;
  const double tau = train.half_period();
  const auto y = [&](double share) { return -impulse * train.wave(share * tau).value / clearance; };
  const auto rate = [&](double share) { return -impulse * train.wave(share * tau).slope; };
  Excursion largest{0, 0};
  const auto consider = [&](double share) {
    if (const double size = std::abs(y(share)); size > largest.size) largest = {size, share};
  };
  // Denser at the ends, where the motion leaves a wall and meets the other one; an extremum lies where the rate changes
  // its sign, and the ends themselves are the impacts.
  double before_at = 1e-6;
  double before = rate(before_at);
  for (int i = 1; i <= points; ++i) {
    const double at = i == points ? 1 - 1e-6 : 0.5 - 0.5 * std::cos(pi * i / points);
    const double after = rate(at);
    if ((before > 0) != (after > 0)) {
      double low = before_at, high = at;
      for (int k = 0; k < 40; ++k) {
        const double middle = 0.5 * (low + high);
        ((rate(middle) > 0) == (before > 0) ? low : high) = middle;
      }
      consider(0.5 * (low + high));
    }
    before_at = at;
    before = after;
  }
  return largest;
}

std::string inadmissibility(const ControlLoop& loop, const detail::ImpulseTrain& train, double impulse) {
  if (!(impulse > 0) || !std::isfinite(impulse)) {
    return "the impulse of the impacts would have to pull the masses together";
  }
  const double clearance = loop.system().clearance();
  // Without restitution the masses have to be drawn apart after the impact.
  const double just_after = 1e-6 * train.half_period();
  if (-impulse * train.wave(just_after).slope > 0)
    return "the masses would be pressed into the wall they have just hit";
  const Excursion excursion = largest_excursion(train, impulse, clearance);
  if (excursion.size >= 0.5) {
    return "between its impacts the motion would reach " + detail::text(std::round(1e4 * excursion.size) / 1e4) +
           " of the clearance from the middle, beyond the walls at 0.5";
  }
  return {};
}

std::vector<CycleHarmonic> harmonics_of(const ControlLoop& loop, double omega, double impulse, int count) {
  std::vector<CycleHarmonic> harmonics;
  for (int i = 0; i < count; ++i) {
    const int order = 2 * i + 1;
    const double w = order * omega;
    const double strength = 2 * omega / pi * impulse;  // twice the Fourier coefficient of the alternating impulses
    const Complex receptance1 = loop.bodies().load().response(w);
    const Complex receptance2 = loop.bodies().drive().response(w);
    const Complex controller = loop.controller().response(w);
    CycleHarmonic harmonic{order, strength * receptance1, 0, 0};
    if (loop.measured() == Output::x1) {
      harmonic.force = -controller * harmonic.x1;
      harmonic.x2 = receptance2 * (harmonic.force - strength);
    } else {
      harmonic.x2 = -strength * receptance2 / (1.0 + controller * receptance2);
      harmonic.force = -controller * harmonic.x2;
    }
    harmonics.push_back(harmonic);
  }
  return harmonics;
}

SymmetricCycle cycle_at(const ControlLoop& loop, const detail::GapResponse& response, double omega, int harmonics) {
  const detail::ImpulseTrain train(response, pi / omega);
  const double sum = train.sums({0, omega})[0].real();
  SymmetricCycle cycle{};
  cycle.omega = omega;
  // y(0) = -I sum_(l >= 1) (-1)^l g(l tau) is the wall at clearance/2.
  cycle.impulse = -0.5 * loop.system().clearance() / sum;
  cycle.impact_speed = cycle.impulse * exchange(loop.system());
  cycle.reason = inadmissibility(loop, train, cycle.impulse);
  cycle.admissible = cycle.reason.empty();
  cycle.stability = detail::cycle_stability(train, exchange(loop.system()));
  cycle.harmonics = harmonics_of(loop, omega, cycle.impulse, harmonics);
  return cycle;
}

}  // namespace

std::string_view to_string(StabilityLoss loss) {
  return detail::spelling(loss_names, loss);
}

LimitCycles symmetric_cycles(const ControlLoop& loop, const LimitCycleOptions& options) {
  detail::require_range(options.range);
  if (options.harmonics < 1) throw std::invalid_argument("harmonics is less than 1");
  const detail::GapResponse response = detail::gap_response(loop);
  LimitCycles result{{}, {0, std::numeric_limits<double>::infinity()}, true, false};
  std::vector<double> frequencies;
  if (loop.controller().delay() == 0 && response.images.empty()) {
    const std::vector<frac::PowerTerm> equation = detail::frequency_equation(loop, detail::Harmonics::all);
    result.any_frequency = std::all_of(equation.begin(), equation.end(),
                                       [](const frac::PowerTerm& term) { return term.coefficient == 0; });
    frequencies = detail::positive_roots(equation);
  } else {
    result.searched = detail::search_range(loop, options.range);
    result.certain = false;
    const double q = exchange(loop.system());
    frequencies =
        detail::roots_on_grid([&](double omega) { return 1 + detail::rate_before_impact(response, pi / omega) / q; },
                              detail::search_grid(result.searched, loop.controller().delay()));
  }
  if (options.range) {
    result.searched = *options.range;
    std::erase_if(frequencies, [&](double omega) { return omega < options.range->from || omega > options.range->to; });
  }
  for (const double omega : frequencies) {
    result.cycles.push_back(cycle_at(loop, response, omega, options.harmonics));
  }
  return result;
}

}  // namespace backlash
