// SPDX-License-Identifier: BSD-3-Clause
#include "backlash/describing_function.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include "backlash/sweep_pieces.hpp"
#include "base/check.hpp"
#include "base/spelling.hpp"
#include "describing_function_point.hpp"
#include "frac/cancellation.hpp"
#include "steady_state.hpp"
#include "symmetric_orbits.hpp"
#include "two_impact_orbit.hpp"

namespace backlash {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double rounding = std::numeric_limits<double>::epsilon();

constexpr std::array<std::pair<Protocol, std::string_view>, 5> protocol_spellings = {{
    {Protocol::sweep_up, "sweep-up"},
    {Protocol::sweep_down, "sweep-down"},
    {Protocol::contact_at_rest, "contact-at-rest"},
    {Protocol::mid_gap_at_rest, "mid-gap-at-rest"},
    {Protocol::two_impact, "two-impact"},
}};
constexpr std::array<std::pair<Regime, std::string_view>, 6> regime_spellings = {{
    {Regime::rigid, "rigid"},
    {Regime::free, "free"},
    {Regime::symmetric, "symmetric"},
    {Regime::periodic, "periodic"},
    {Regime::chatter, "chatter"},
    {Regime::averaged, "averaged"},
}};
constexpr std::array<std::pair<Output, std::string_view>, 2> output_spellings = {
    {{Output::x1, "x1"}, {Output::x2, "x2"}}};

detail::GapState mid_gap_at_rest() {
  return detail::state_at_peak(0.5, 0);
}
detail::GapState contact_at_rest() {
  return detail::state_at_peak(0, 0);
}

// Relative position and velocity in metres are kept, so the velocity per radian scales with the ratio of the
// frequencies.
detail::GapState carried(const detail::GapState& state, double old_omega, double new_omega) {
  return detail::state_at_peak(state.position(), state.position_rate() * (old_omega / new_omega));
}

DescribingFunctionPoint rigid_point(const TwoMassSystem& system, double omega, double gamma, Output output) {
  DescribingFunctionPoint point{};
  point.omega = omega;
  const double inertia = (system.mass1() + system.mass2()) * omega * omega;
  point.value = -1 / inertia;
  point.regime = Regime::rigid;
  point.period = 1;
  const double share = output == Output::x1 ? 1 : system.mass1() / system.mass2();
  point.uncertainty = (share / gamma + 2 * rounding) / inertia;
  point.even_harmonic_ratio = 0;
  point.energy_defect = 0;
  return point;
}

// The relative motion follows the force without meeting a wall: x1 at rest, x2 = -1/(M2 omega^2).
DescribingFunctionPoint free_point(const TwoMassSystem& system, double omega, Output output) {
  DescribingFunctionPoint point{};
  point.omega = omega;
  point.value = output == Output::x1 ? 0 : -1 / (system.mass2() * omega * omega);
  point.regime = Regime::free;
  point.period = 1;
  point.uncertainty = 4 * rounding * std::abs(point.value);
  const double harmonics = output == Output::x1 ? nan : 0;
  point.third_harmonic_ratio = harmonics;
  point.even_harmonic_ratio = harmonics;
  point.energy_defect = 0;
  return point;
}

detail::SteadyState steady_state(const TwoMassSystem& system, double gamma, const detail::GapState& start,
                                 const SweepOptions& options) {
  return detail::find_steady_state(detail::GapMotion(gamma, system.restitution()), start, options.tolerance,
                                   detail::mean_goal(system, gamma, options));
}

// Every value that a point holds is a few powers of ten around 1/(mass omega^2), which must not leave the range of
// numbers.
void require_representable(const TwoMassSystem& system, const std::vector<double>& omega) {
  constexpr double smallest = 1e-290;
  for (std::size_t i = 0; i < omega.size(); ++i) {
    for (const double mass : {system.mass1() + system.mass2(), system.mass2()}) {
      const double inertia = mass * omega[i] * omega[i];
      if (inertia > smallest && inertia < 1 / smallest) continue;
      throw std::invalid_argument("omega[" + std::to_string(i) + "] is " + detail::text(omega[i]) +
                                  " rad/s; mass times omega^2 must be in (1e-290, 1e290) kg/s^2, or the describing "
                                  "function leaves the range of numbers");
    }
  }
}

void check(const SweepScene& scene, const std::vector<double>& omega) {
  detail::require_positive("force_amplitude", "N", scene.force_amplitude);
  require_representable(scene.system, omega);
}

bool has_independent_points(Protocol protocol) {
  return protocol == Protocol::contact_at_rest || protocol == Protocol::mid_gap_at_rest;
}

DescribingFunctionPoint independent_point(const TwoMassSystem& system, double force_amplitude, double omega,
                                          const SweepOptions& options) {
  const double gamma = dimensionless_force(system, force_amplitude, omega);
  if (!(gamma < detail::rigid_force)) return rigid_point(system, omega, gamma, options.output);
  if (gamma < detail::free_force) return free_point(system, omega, options.output);
  const detail::GapState start = options.protocol == Protocol::contact_at_rest ? contact_at_rest() : mid_gap_at_rest();
  return detail::point_of(system, omega, gamma, options.output, steady_state(system, gamma, start, options));
}

// Points that carry their state from one to the next.
std::vector<DescribingFunctionPoint> carried_points(const TwoMassSystem& system, double force_amplitude,
                                                    const std::vector<double>& omega, const SweepOptions& options,
                                                    frac::Progress* progress) {
  std::vector<DescribingFunctionPoint> points(omega.size());
  const bool down = options.protocol == Protocol::sweep_down;
  const bool follows_orbit = options.protocol == Protocol::two_impact && system.clearance() > 0;
  std::optional<detail::SymmetricOrbits> symmetric;
  if (follows_orbit) symmetric.emplace(system.restitution());
  std::optional<double> loss_gamma;  // of the stable two-impact orbit, found where it is first asked for
  detail::GapState state = mid_gap_at_rest();
  double state_omega = down ? omega.back() : omega.front();
  // gamma of the last point, where it was on the symmetric orbit and its state has not been needed yet.
  std::optional<double> owed_state;
  for (std::size_t step = 0; step < omega.size(); ++step) {
    frac::throw_if_cancelled();
    const std::size_t i = down ? omega.size() - 1 - step : step;
    const double gamma = dimensionless_force(system, force_amplitude, omega[i]);
    if (!(gamma < detail::rigid_force)) {
      points[i] = rigid_point(system, omega[i], gamma, options.output);
    } else if (gamma < detail::free_force) {
      points[i] = free_point(system, omega[i], options.output);
      state = carried(state, state_omega, omega[i]);
    } else if (symmetric && symmetric->contains(gamma)) {
      points[i] = detail::point_of(system, omega[i], gamma, options.output, symmetric->at(gamma));
      owed_state = gamma;
    } else {
      if (owed_state) state = symmetric->end_state(*owed_state);
      owed_state.reset();
      std::optional<detail::SteadyState> steady;
      if (follows_orbit) {
        if (!loss_gamma && system.restitution() > 0 && gamma > detail::symmetry_breaking_gamma(system.restitution()))
          loss_gamma = detail::two_impact_loss(system.restitution()).gamma;
        const auto orbit = detail::stable_two_impact_orbit(gamma, system.restitution(), loss_gamma.value_or(0));
        if (orbit) steady = detail::two_impact_steady_state(*orbit, system.restitution());
      }
      if (!steady) steady = steady_state(system, gamma, carried(state, state_omega, omega[i]), options);
      points[i] = detail::point_of(system, omega[i], gamma, options.output, *steady);
      state = steady->end;
    }
    state_omega = omega[i];
    if (progress != nullptr) ++progress->done;
  }
  return points;
}

}  // namespace

namespace detail {

DescribingFunctionPoint point_of(const TwoMassSystem& system, double omega, double gamma, Output output,
                                 const SteadyState& steady) {
  const double inertia = (system.mass1() + system.mass2()) * omega * omega;
  // With y = x2 - x1 = clearance Re(U e^{jwt}) and the centre of mass moving as F/(M1 + M2), in units of F/inertia:
  // x1 = -(U + gamma)/gamma, x2 = -1 + (M1/M2) U/gamma, and the harmonics of x1, x2 are those of U times share/gamma.
  const double share = (output == Output::x1 ? 1 : system.mass1() / system.mass2()) / gamma;
  const std::complex<double> numerator =
      output == Output::x1 ? -share * steady.harmonics.u1_plus_gamma : -1.0 + share * steady.harmonics.u[0];
  // Far from the ends of the range of numbers, so that the square of a modulus does not leave it.
  const auto modulus = [](std::complex<double> z) { return std::sqrt(std::norm(z)); };
  const double fundamental = modulus(numerator);
  const double unit = 1 / inertia;
  const double ratio = fundamental > 0 ? share / fundamental : nan;
  DescribingFunctionPoint point{};
  point.omega = omega;
  point.value = numerator * unit + std::complex<double>(0, 0);  // a part that is 0 has no sign
  point.regime = steady.regime;
  point.period = steady.period;
  point.impacts_per_period = steady.impacts_per_period;
  point.uncertainty = (share * steady.uncertainty + 4 * rounding * fundamental) * unit;
  point.third_harmonic_ratio = ratio * modulus(steady.harmonics.u[1]);
  point.even_harmonic_ratio = ratio * modulus(steady.harmonics.u[second_harmonic]);
  point.energy_defect = steady.energy_defect;
  point.lyapunov_exponent = steady.lyapunov;
  point.periods_followed = steady.periods_followed;
  point.transient_possible = steady.transient_possible;
  point.force_sensitivity = ratio * steady.force_sensitivity;
  return point;
}

MeanGoal mean_goal(const TwoMassSystem& system, double gamma, const SweepOptions& options) {
  return {options.mean_tolerance, options.output == Output::x1 ? -gamma : gamma * system.mass2() / system.mass1()};
}

void require_valid(const SweepOptions& options) {
  if (!(options.tolerance > 0 && options.tolerance <= 0.01)) {
    throw std::invalid_argument("tolerance is " + text(options.tolerance) + "; it must be in (0, 0.01]");
  }
  if (!(options.mean_tolerance >= 0 && options.mean_tolerance < 1)) {
    throw std::invalid_argument("mean_tolerance is " + text(options.mean_tolerance) +
                                "; it must be in [0, 1), 0 for means over a thousand periods");
  }
  if (options.threads < 0) {
    throw std::invalid_argument("threads is " + std::to_string(options.threads) +
                                "; it must be positive, or 0 for one per core");
  }
}

}  // namespace detail

std::string_view to_string(Protocol protocol) {
  return frac::detail::spelling(protocol_spellings, protocol);
}
std::string_view to_string(Regime regime) {
  return frac::detail::spelling(regime_spellings, regime);
}
std::string_view to_string(Output output) {
  return frac::detail::spelling(output_spellings, output);
}
Protocol protocol_from_string(std::string_view text) {
  return frac::detail::from_spelling(protocol_spellings, "protocol", text);
}
Regime regime_from_string(std::string_view text) {
  return frac::detail::from_spelling(regime_spellings, "regime", text);
}
Output output_from_string(std::string_view text) {
  return frac::detail::from_spelling(output_spellings, "output", text);
}
std::span<const Protocol> protocols() {
  static constexpr auto all = frac::detail::enumerators(protocol_spellings);
  return all;
}
std::span<const Output> outputs() {
  static constexpr auto all = frac::detail::enumerators(output_spellings);
  return all;
}

frac::FrequencyResponseData DescribingFunctionSweep::data() const {
  std::vector<double> omega;
  std::vector<std::complex<double>> value;
  omega.reserve(points.size());
  value.reserve(points.size());
  for (const DescribingFunctionPoint& point : points) {
    omega.push_back(point.omega);
    value.push_back(point.value);
  }
  return {std::move(omega), std::move(value)};
}

DescribingFunctionSweep describing_function_sweep(const TwoMassSystem& system, double force_amplitude,
                                                  const std::vector<double>& omega, const SweepOptions& options) {
  std::vector<DescribingFunctionSweep> sweeps = describing_function_sweeps({{system, force_amplitude}}, omega, options);
  return std::move(sweeps.front());
}

SweepPieces::SweepPieces(std::vector<SweepScene> scenes, std::vector<double> omega, const SweepOptions& options)
    : SweepPieces(std::move(scenes), std::move(omega), options, Compute()) {
  for (std::size_t i = 0; i < scenes_.size(); ++i) {
    try {
      check(scenes_[i], omega_);
    } catch (const std::invalid_argument& error) {
      if (scenes_.size() == 1) throw;
      throw std::invalid_argument("scene " + std::to_string(i) + ": " + error.what());
    }
  }
}

SweepPieces::SweepPieces(std::vector<SweepScene> scenes, std::vector<double> omega, const SweepOptions& options,
                         Compute compute)
    : scenes_(std::move(scenes)), omega_(std::move(omega)), options_(options), compute_(std::move(compute)) {
  detail::require_frequency_grid(omega_);
  detail::require_valid(options_);
  // Many pieces load the threads evenly; one of some hundred points takes milliseconds, so that little is lost with it.
  width_ = omega_.size();
  if (has_independent_points(options_.protocol)) width_ = std::clamp<std::size_t>(omega_.size() / 32, 1, 256);
  per_scene_ = (omega_.size() + width_ - 1) / width_;
}

SweepPiece SweepPieces::piece(std::size_t number) const noexcept {
  const std::size_t first = number % per_scene_ * width_;
  return {number / per_scene_, first, std::min(width_, omega_.size() - first)};
}

std::vector<DescribingFunctionPoint> SweepPieces::points(std::size_t number, frac::Progress* progress) const {
  if (compute_) return compute_(piece(number), progress);
  const auto [index, first, count] = piece(number);
  const SweepScene& scene = scenes_.at(index);
  if (!has_independent_points(options_.protocol))
    return carried_points(scene.system, scene.force_amplitude, omega_, options_, progress);
  std::vector<DescribingFunctionPoint> points;
  points.reserve(count);
  for (std::size_t i = first; i < first + count; ++i) {
    points.push_back(independent_point(scene.system, scene.force_amplitude, omega_[i], options_));
    if (progress != nullptr) ++progress->done;
  }
  return points;
}

void SweepPieces::compute(const std::function<bool(std::size_t)>& is_there,
                          const std::function<void(std::size_t, std::vector<DescribingFunctionPoint>)>& take,
                          frac::Progress* progress) const {
  if (progress != nullptr) progress->total += scenes_.size() * omega_.size();
  // Scenes mostly stand in the order of rising restitution, of which the largest takes longest: begun first, it keeps
  // no thread waiting at the end.
  frac::parallel_for(count(), options_.threads, [&](std::size_t i) {
    const std::size_t number = count() - 1 - i;
    if (!is_there(number))
      take(number, points(number, progress));
    else if (progress != nullptr)
      progress->done += piece(number).count;
  });
}

std::vector<DescribingFunctionSweep> SweepPieces::sweeps(frac::Progress* progress) const {
  std::vector<DescribingFunctionSweep> sweeps;
  sweeps.reserve(scenes_.size());
  for (const SweepScene& scene : scenes_)
    sweeps.push_back(
        {scene.system, scene.force_amplitude, options_, std::vector<DescribingFunctionPoint>(omega_.size())});
  const auto take = [&](std::size_t number, std::vector<DescribingFunctionPoint> points) {
    const SweepPiece piece = this->piece(number);
    std::move(points.begin(), points.end(),
              sweeps[piece.scene].points.begin() + static_cast<std::ptrdiff_t>(piece.first));
  };
  compute([](std::size_t) { return false; }, take, progress);
  return sweeps;
}

double expected_cost(double restitution) {
  // Of a point whose transient is short; the loss at which the limit of periods takes over.  Measured on the curves of
  // one map, 801 restitutions over frequencies of 0.5 to 4.
  constexpr double least = 1, smallest_loss = 0.006;
  return least + 1 / (1 - restitution + smallest_loss);
}

std::vector<DescribingFunctionSweep> describing_function_sweeps(const std::vector<SweepScene>& scenes,
                                                                const std::vector<double>& omega,
                                                                const SweepOptions& options, frac::Progress* progress) {
  return SweepPieces(scenes, omega, options).sweeps(progress);
}

}  // namespace backlash
