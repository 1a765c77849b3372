#pragma once

#include <cmath>
#include <complex>
#include <numbers>

namespace benchmark {

/// What a general simulation tool with a fixed time step does with u'' = gamma cos tau between walls at 0 and 1:
/// semi-implicit Euler steps; when a step ends beyond a wall, the mass is put on the wall and its velocity reversed
/// with the restitution, at the end of that step.  Impacts are late by up to a step, chatter becomes rest by itself,
/// and the error falls only with the first power of the step.  Kept here for comparison; the library does not step.
struct FixedStepResult {
  std::complex<double> u1;  // e^{j tau} phasor of u over the last `periods`
  double impacts_per_period;
};

/// @param steps_per_period  of the force
/// @param transient,periods  force periods left out, and averaged over
inline FixedStepResult fixed_step_harmonic(double gamma, double restitution, int steps_per_period, int transient,
                                           int periods) {
  constexpr double pi = std::numbers::pi;
  const double step = 2 * pi / steps_per_period;
  double u = 0.5;
  double velocity = 0;
  std::complex<double> sum = 0;
  long long impacts = 0;
  for (int period = 0; period < transient + periods; ++period) {
    const bool counts = period >= transient;
    for (int i = 0; i < steps_per_period; ++i) {
      const double tau = step * i;
      velocity += step * gamma * std::cos(tau);
      u += step * velocity;
      const bool below = u < 0 && velocity < 0;
      const bool above = u > 1 && velocity > 0;
      if (below || above) {
        u = below ? 0 : 1;
        velocity = -restitution * velocity;
        impacts += counts ? 1 : 0;
      }
      if (counts) sum += u * std::polar(1.0, -(tau + step));
    }
  }
  return {sum * (step / pi / periods), static_cast<double>(impacts) / periods};
}

}  // namespace benchmark
