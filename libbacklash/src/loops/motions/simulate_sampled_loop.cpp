// SPDX-License-Identifier: BSD-3-Clause
#include "backlash/loops/simulate_sampled_loop.hpp"

#include <cmath>
#include <cstddef>
#include <deque>
#include <numbers>
#include <stdexcept>

#include "backlash/two_mass_plant.hpp"
#include "base/check.hpp"
#include "frac/cancellation.hpp"
#include "loops/cycles/frequency_search.hpp"

namespace backlash {

frac::FractionalPidConfig sampled_controller(const ControlLoop& loop, const SampledLoopOptions& options) {
  detail::require_positive("sample time", "s", options.sample_time);
  frac::FractionalPidConfig config;
  config.gains.kp = 0;
  config.sample_time = options.sample_time;
  config.minimum = -options.force_limit;
  config.maximum = options.force_limit;
  config.anti_windup = frac::AntiWindup::conditional_integration;
  const double nyquist = std::numbers::pi / options.sample_time;
  // Up to there the filters of a tolerance of 1e-3 do not ring from sample to sample.
  config.band = {1e-6 * nyquist, 0.1 * nyquist};
  const std::vector<frac::PowerTerm> powers = detail::controller_powers(loop);
  bool fits = !powers.empty();
  for (const frac::PowerTerm& term : powers) {
    if (term.order == 0) {
      config.gains.kp = term.coefficient;
    } else if (term.order < 0) {
      fits = fits && config.gains.ki == 0;
      config.gains.ki = term.coefficient;
      config.gains.lambda = -term.order;
    } else {
      fits = fits && config.gains.kd == 0;
      config.gains.kd = term.coefficient;
      config.gains.mu = term.order;
    }
  }
  if (!fits) {
    throw std::invalid_argument(
        "a sampled loop runs a controller kp + ki/s^lambda + kd s^mu with a dead time; this one has other terms");
  }
  if (const double lag = options.set_point.lag; lag > 0) {
    const auto& [kp, ki, kd, lambda, mu] = config.gains;
    // kp b + ki/s = C/(lag s + 1) takes kp b lag = kd and kp (1 - b) = ki lag.
    const double rest = std::abs(kp - ki * lag - kd / lag);
    constexpr double rounding = 1e-12;
    if (!(kp > 0) || (ki != 0 && lambda != 1) || mu != 1 || rest > rounding * kp) {
      throw std::invalid_argument(
          "a sampled loop takes a lag of the set-point only of a cascade, whose controller is 0 "
          "at s = -1/lag");
    }
    config.setpoint_weight = kd / (lag * kp);
    config.derivative_setpoint_weight = 0;
  }
  return config;
}

SampledLoopHistory simulate_sampled_loop(const ControlLoop& loop, const SampledLoopOptions& options) {
  if (!loop.bodies().are_free()) throw std::invalid_argument("a sampled loop is simulated with two free masses");
  detail::require_positive("duration", "s", options.duration);
  if (!(options.force_limit > 0)) throw std::invalid_argument("the limit of the force is not above 0");
  for (const double value : {options.velocity1, options.velocity2, options.set_point.step, options.set_point.ramp,
                             options.set_point.lag, options.disturbance}) {
    if (!std::isfinite(value)) throw std::invalid_argument("a number of the start or the set-point is not finite");
  }
  detail::require_not_negative("step of the encoder", "m", options.encoder_step);
  const auto read = [step = options.encoder_step](double position) {
    return step > 0 ? step * std::round(position / step) : position;
  };
  const double time = options.sample_time;
  frac::FractionalPid<double> controller(sampled_controller(loop, options));
  if (options.duration / time > 1e7) {
    throw std::invalid_argument("duration over sample time makes more than 10^7 samples");
  }
  // The plant counts the gap from the near wall.
  const double half = 0.5 * loop.system().clearance();
  TwoMassPlant plant(loop.system(), {0, options.velocity1, half, options.velocity2});
  std::deque<double> waiting(static_cast<std::size_t>(std::llround(loop.controller().delay() / time)), 0.0);
  SampledLoopHistory history{{}, 0};
  const auto samples = static_cast<std::size_t>(options.duration / time * (1 + 1e-12));
  history.rows.reserve(samples + 1);
  for (std::size_t n = 0; n <= samples; ++n) {
    frac::throw_if_cancelled();
    const TwoMassState state = plant.state();
    const double now = static_cast<double>(n) * time;
    const double x2 = state.position2 - half;
    const double set_point = options.set_point.step + options.set_point.ramp * now;
    waiting.push_back(controller.step(set_point, read(loop.measured() == Output::x1 ? state.position1 : x2)));
    const double force = waiting.front();
    waiting.pop_front();
    history.rows.push_back({now, state.position1, state.velocity1, x2, state.velocity2, force, LoopEvent::sample});
    if (n < samples) plant.advance(force + options.disturbance, time);
  }
  history.impacts = plant.impacts();
  return history;
}

}  // namespace backlash
