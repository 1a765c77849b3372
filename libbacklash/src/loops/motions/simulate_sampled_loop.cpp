// SPDX-License-Identifier: BSD-3-Clause
#include "backlash/loops/simulate_sampled_loop.hpp"

#include <cmath>
#include <cstddef>
#include <numbers>
#include <stdexcept>

#include "backlash/two_mass_plant.hpp"
#include "base/check.hpp"
#include "frac/cancellation.hpp"
#include "loops/cycles/frequency_search.hpp"
#include "sampled_controller.hpp"

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

namespace detail {

SampledController::SampledController(const ControlLoop& loop, const SampledLoopOptions& options)
    : options_(options),
      measured_(loop.measured()),
      pid_(sampled_controller(loop, options)),
      waiting_(static_cast<std::size_t>(std::llround(loop.controller().delay() / options.sample_time)), 0.0) {
  require_positive("duration", "s", options.duration);
  if (!(options.force_limit > 0)) throw std::invalid_argument("the limit of the force is not above 0");
  for (const double value : {options.velocity1, options.velocity2, options.set_point.step, options.set_point.ramp,
                             options.set_point.lag, options.disturbance.body1, options.disturbance.body2}) {
    if (!std::isfinite(value)) throw std::invalid_argument("a number of the start or the set-point is not finite");
  }
  require_not_negative("step of the encoder", "m", options.encoder_step);
  const double samples = options.duration / options.sample_time;
  if (samples > 1e7) throw std::invalid_argument("duration over sample time makes more than 10^7 samples");
  samples_ = static_cast<std::size_t>(samples * (1 + 1e-12));
}

double SampledController::step(std::size_t sample, double x1, double x2) {
  const double position = measured_ == Output::x1 ? x1 : x2, quantum = options_.encoder_step;
  const double read = quantum > 0 ? quantum * std::round(position / quantum) : position;
  waiting_.push_back(pid_.step(options_.set_point.step + options_.set_point.ramp * time(sample), read));
  const double force = waiting_.front();
  waiting_.pop_front();
  return force;
}

}  // namespace detail

SampledLoopHistory simulate_sampled_loop(const ControlLoop& loop, const SampledLoopOptions& options) {
  if (!loop.bodies().are_free()) throw std::invalid_argument("a sampled loop is simulated with two free masses");
  if (options.disturbance.body1 != 0)
    throw std::invalid_argument("a sampled loop whose contacts take no time has no constant force on body 1");
  detail::SampledController controller(loop, options);
  // The plant counts the gap from the near wall.
  const double half = 0.5 * loop.system().clearance();
  TwoMassPlant plant(loop.system(), {0, options.velocity1, half, options.velocity2});
  SampledLoopHistory history{{}, 0};
  history.rows.reserve(controller.samples() + 1);
  for (std::size_t n = 0; n <= controller.samples(); ++n) {
    frac::throw_if_cancelled();
    const TwoMassState state = plant.state();
    const double x2 = state.position2 - half;
    const double force = controller.step(n, state.position1, x2);
    history.rows.push_back(
        {controller.time(n), state.position1, state.velocity1, x2, state.velocity2, force, LoopEvent::sample});
    if (n < controller.samples()) plant.advance(force + options.disturbance.body2, options.sample_time);
  }
  history.impacts = plant.impacts();
  return history;
}

}  // namespace backlash
