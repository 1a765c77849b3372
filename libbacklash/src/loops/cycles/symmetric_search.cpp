// SPDX-License-Identifier: BSD-3-Clause
#include "symmetric_search.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <optional>
#include <stdexcept>

#include "base/check.hpp"
#include "base/impact_law.hpp"
#include "cycle_frequencies.hpp"
#include "frequency_search.hpp"
#include "loops/equations/cycle_harmonics.hpp"
#include "loops/equations/cycle_stability.hpp"
#include "loops/equations/excursion.hpp"

namespace backlash::detail {
namespace {

using Complex = std::complex<double>;
constexpr double pi = std::numbers::pi;

std::string reason_against(const ControlLoop& loop, const ImpulseTrain& train, double impulse) {
  if (!(impulse > 0) || !std::isfinite(impulse)) {
    return "the impulse of the impacts would have to pull the masses together";
  }
  // Without restitution the masses have to be drawn apart after the impact.
  const double just_after = 1e-6 * train.half_period();
  if (-impulse * train.wave(just_after).slope > 0)
    return "the masses would be pressed into the wall they have just hit";
  const double clearance = loop.system().clearance();
  const double excursion = largest_excursion(
      [&](double t) {
        const TrainWave wave = train.wave(t);
        return GapSample{-impulse / clearance * wave.value, -impulse / clearance * wave.slope};
      },
      train.half_period());
  if (excursion >= 0.5) {
    return "between its impacts the motion would reach " + text(std::round(1e4 * excursion) / 1e4) +
           " of the clearance from the middle, beyond the walls at 0.5";
  }
  return {};
}

// y(0) = -I sum_(l >= 1) (-1)^l g(l tau) is the wall at clearance/2.
double impulse_of(const ControlLoop& loop, const ImpulseTrain& train) {
  return -0.5 * loop.system().clearance() / train.sums({0, pi / train.half_period()})[0].real();
}

}  // namespace

SymmetricSearch::SymmetricSearch(const ControlLoop& loop, const LimitCycleOptions& options)
    : loop_(&loop), options_(options), response_(gap_response(loop)), range_{} {
  require_range(options.range);
  if (options.harmonics < 1) throw std::invalid_argument("harmonics is less than 1");
  exchange_ = speed_per_impulse(response_.jump, loop.system());
  if (options.range) {
    range_ = *options.range;
  } else if (is_closed_form()) {
    range_ = {0, std::numeric_limits<double>::infinity()};
  } else {
    range_ = search_range(loop, {});
  }
}

bool SymmetricSearch::is_closed_form() const {
  return loop_->controller().delay() == 0 && response_.images.empty();
}

bool SymmetricSearch::any_frequency() const {
  if (!is_closed_form()) return false;
  const std::vector<frac::PowerTerm> equation = frequency_equation(*loop_, CountedHarmonics::all);
  return std::all_of(equation.begin(), equation.end(),
                     [](const frac::PowerTerm& term) { return term.coefficient == 0; });
}

double SymmetricSearch::rate_defect(double omega) const {
  return 1 + rate_before_impact(response_, pi / omega) / exchange_;
}

std::vector<double> SymmetricSearch::frequencies() const {
  if (!is_closed_form()) {
    const auto rough_defect = [&](double omega) {
      const double rate = rough_rate_before_impact(response_, pi / omega) / exchange_;
      const double unsure = response_.images.empty() ? 1e-6 : 1e-2 * (1 + std::abs(rate));
      return std::abs(1 + rate) > unsure ? 1 + rate : rate_defect(omega);
    };
    // Sums by an inverse transform are rounded by less, against the speeds of which the defect is made.
    constexpr double rounding = 1e-12;
    return roots_on_grid(
        rough_defect, [&](double omega) { return rate_defect(omega); },
        search_grid(range_, loop_->controller().delay()), rounding);
  }
  std::vector<double> found = positive_roots(frequency_equation(*loop_, CountedHarmonics::all));
  std::erase_if(found, [&](double omega) { return omega < range_.from || omega > range_.to; });
  return found;
}

std::string SymmetricSearch::inadmissibility(double omega) const {
  const ImpulseTrain train(response_, pi / omega);
  return reason_against(*loop_, train, impulse_of(*loop_, train));
}

SymmetricCycle SymmetricSearch::cycle_at(double omega) const {
  const ImpulseTrain train(response_, pi / omega);
  SymmetricCycle cycle{};
  cycle.omega = omega;
  cycle.impulse = impulse_of(*loop_, train);
  cycle.impact_speed = cycle.impulse * exchange_;
  cycle.reason = reason_against(*loop_, train, cycle.impulse);
  cycle.admissible = cycle.reason.empty();
  cycle.stability = cycle_stability(train, exchange_);
  for (int i = 0; i < options_.harmonics; ++i) {
    cycle.harmonics.push_back(cycle_harmonic(*loop_, omega, 2 * i + 1, 2 * omega / pi * cycle.impulse));
  }
  return cycle;
}

double SymmetricSearch::symmetry_defect(double omega) const {
  const ImpulseTrain train(response_, pi / omega);
  const std::array<double, 3> alike = train.sums_of_one_sign();
  const double bend = alike[2] - train.sums({0, omega})[2].real();
  // The mean of the motion per impulse.
  const std::optional<double> mean = static_gap(*loop_, omega);
  if (!mean) return bend;
  const double rate = exchange_ + alike[1];
  return (alike[0] + *mean / train.half_period()) * bend - rate * rate;
}

}  // namespace backlash::detail
