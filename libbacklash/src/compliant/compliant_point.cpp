// SPDX-License-Identifier: BSD-3-Clause
#include "compliant_point.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "steady_state/describing_function_point.hpp"

namespace backlash::detail {
namespace {

using Complex = std::complex<double>;
using Index = Eigen::Index;

// Force periods: before returns are looked for, between two looks, of the longest orbit, left to the transient of a
// mean, of its window, of one that is judged, without a contact until there is none to come, and of the value of a
// motion without any.
constexpr std::size_t first_look = 16, look_interval = 8, longest_period = 32, transient = 256, window = 1024,
                      first_judged = 128, quiet_periods = 64, quiet_window = 8;
// Periods followed from a guess of an orbit before Newton's method.
constexpr int settling = 2;
// Over the sizes of the states: near enough for Newton's method.
constexpr double near_return = 1e-3;

}  // namespace

CompliantPoint::CompliantPoint(const CompliantBodies& bodies, double force, double omega, const SweepOptions& options,
                               bool tells_twins)
    : bodies_(bodies),
      force_{force, omega},
      options_(options),
      flow_(bodies, force_, options.output, compliant_realisation, tells_twins ? 2 : 1) {}

std::optional<CompliantReached> CompliantPoint::near(const LoopStart& start) const {
  const Eigen::VectorXd state = flow_.start(start);
  CompliantRun run(flow_, state, flow_.mode_of(state));
  if (!run.follow(settling)) return std::nullopt;
  const auto orbit = closed_orbit(flow_, run.state(), run.mode(), 1);
  if (!orbit || orbit->contacts == 0 || !(orbit->largest_multiplier < 1)) return std::nullopt;
  return reached(*orbit);
}

CompliantReached CompliantPoint::follow(const LoopStart& start) {
  const Eigen::VectorXd state = flow_.start(start);
  CompliantRun run(flow_, state, flow_.mode_of(state));
  peaks_.clear();
  std::size_t wait_until = first_look;
  while (peaks_.size() < transient + window) {
    if (!run.follow(1)) break;
    std::vector<Complex> phasors;
    for (const Complex& velocity : run.phasors())
      phasors.push_back(velocity / Complex(0, static_cast<double>(phasors.size() + 1) * force_.omega) /
                        force_.amplitude);
    peaks_.push_back({repeating(run.state()), run.contacts(), run.mode().contact != 0, std::move(phasors)});
    if (is_quiet()) return quiet(run);
    if (is_known(run)) break;
    if (peaks_.size() < wait_until || peaks_.size() % look_interval != 0) continue;
    const std::optional<int> periods = returns_after();
    if (!periods) continue;
    const auto orbit = closed_orbit(flow_, run.state(), run.mode(), *periods);
    if (orbit && orbit->contacts > 0 && orbit->largest_multiplier < 1) return reached(*orbit);
    // What led nowhere is left alone for as long again.
    wait_until = 2 * peaks_.size();
  }
  return mean(run);
}

Eigen::VectorXd CompliantPoint::repeating(const Eigen::VectorXd& state) const {
  Eigen::VectorXd result(static_cast<Index>(flow_.repeating().size()));
  for (std::size_t i = 0; i < flow_.repeating().size(); ++i) {
    const Index at = flow_.repeating()[i];
    result[static_cast<Index>(i)] = state[at] / flow_.sizes()[at];
  }
  return result;
}

std::optional<int> CompliantPoint::returns_after() const {
  for (std::size_t p = 1; p <= std::min(longest_period, peaks_.size() - 1); ++p)
    if ((back(0).state - back(p).state).cwiseAbs().maxCoeff() < near_return && back(0).contacts > back(p).contacts)
      return static_cast<int>(p);
  return std::nullopt;
}

bool CompliantPoint::is_quiet() const {
  return peaks_.size() > quiet_periods && back(0).contacts == back(quiet_periods).contacts && !back(0).is_in_contact;
}

// Without contacts body 1 comes to rest; body 2 moves as its own receptance and dry friction let it.
CompliantReached CompliantPoint::quiet(const CompliantRun& run) const {
  DescribingFunctionPoint point = free_point(bodies_.hard(), force_.omega, options_.output);
  if (options_.output == Output::x2 && flow_.friction(1) != 0) {
    point.value = mean_of_last(quiet_window).value;
    for (std::size_t i = 0; i < quiet_window; ++i)
      point.uncertainty = std::max(point.uncertainty, std::abs(back(i).phasors.front() - point.value));
    point.energy_defect = std::numeric_limits<double>::quiet_NaN();
  }
  return {point, 0, true, run.state(), run.mode()};
}

PeriodMean CompliantPoint::mean_of_last(std::size_t periods, std::size_t harmonic) const {
  std::vector<Complex> phasors;
  for (std::size_t i = 0; i < periods; ++i) phasors.push_back(back(i).phasors[harmonic]);
  return mean_of_periods(phasors);
}

CompliantReached CompliantPoint::reached(const CompliantOrbit& orbit) const {
  const CompliantReading reading = read_orbit(orbit, bodies_, force_, options_.output, compliant_realisation);
  DescribingFunctionPoint point = empty_point(force_.omega);
  point.value = reading.value;
  point.period = orbit.periods;
  point.impacts_per_period = static_cast<double>(orbit.contacts) / orbit.periods;
  point.third_harmonic_ratio = reading.third_ratio;
  point.even_harmonic_ratio = reading.is_symmetric ? 0 : std::abs(reading.second / reading.value);
  point.regime = reading.is_symmetric ? Regime::symmetric : Regime::periodic;
  // What flights and the difference of gap and wall, times the stiffness, round, what the last step leaves, and what
  // a weak attraction makes of it.
  const FreeContact free = free_contact(bodies_.contact(), bodies_.system().mass1(), bodies_.system().mass2());
  const double rounding = 1e-13 + 5e-16 * std::pow(free.frequency / force_.omega, 2);
  point.uncertainty =
      std::max(rounding, orbit.residual) * std::abs(point.value) / std::max(1e-6, 1 - orbit.largest_multiplier) +
      flow_.error() * std::abs(point.value);
  point.energy_defect = std::abs(reading.work - reading.loss) / reading.moved;
  point.lyapunov_exponent = std::log(orbit.largest_multiplier) / orbit.periods;
  return {point, reading.is_symmetric ? 0 : reading.second, reading.is_symmetric, orbit.state, orbit.mode};
}

// A mean of which that is enough.
bool CompliantPoint::is_known(const CompliantRun& run) const {
  const std::size_t length = peaks_.size() > transient ? peaks_.size() - transient : 0;
  if (options_.mean_tolerance == 0 || length < first_judged || (length & (length - 1)) != 0) return false;
  const DescribingFunctionPoint point = mean(run).point;
  return point.uncertainty <= options_.mean_tolerance * std::abs(point.value);
}

CompliantReached CompliantPoint::mean(const CompliantRun& run) const {
  DescribingFunctionPoint point = empty_point(force_.omega);
  point.transient_possible = true;
  point.periods_followed = static_cast<double>(peaks_.size());
  const std::size_t length = std::max(peaks_.size() > transient ? peaks_.size() - transient : 0,
                                      std::min<std::size_t>(peaks_.size() / 2, transient));
  CompliantReached reached{point, 0, false, run.state(), run.mode()};
  if (length < 16) return reached;
  reached.point.impacts_per_period =
      static_cast<double>(back(0).contacts - back(length).contacts) / static_cast<double>(length);
  const PeriodMean found = mean_of_last(length);
  reached.point.value = found.value;
  reached.point.uncertainty = found.half_width + flow_.error() * std::abs(found.value);
  if (back(0).phasors.size() < 2) return reached;
  const PeriodMean second = mean_of_last(length, 1);
  reached.second = second.value;
  reached.is_symmetric = std::abs(second.value) <= second.half_width;
  return reached;
}

}  // namespace backlash::detail
