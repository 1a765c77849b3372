// SPDX-License-Identifier: BSD-3-Clause
// A fractional PID sample by sample: the half-order integral of a constant error rises as sqrt(t)/Gamma(3/2).
#include <cmath>
#include <cstdio>
#include <frac/digital/fractional_pid.hpp>

int main() {
  frac::FractionalPidConfig config;
  config.gains = {.kp = 0, .ki = 1, .kd = 0, .lambda = 0.5, .mu = 1};
  config.sample_time = 1e-2;  // s
  config.band = {1e-4, 1e2};  // rad/s, on which the order holds
  frac::FractionalPid<double> pid(config);

  std::puts("time_s,output,exact");
  for (int n = 1; n <= 10'000; ++n) {
    const double output = pid.step(1.0, 0.0);  // set-point 1, measurement 0
    const double time = n * config.sample_time;
    if (n == 100 || n == 1'000 || n == 10'000)
      std::printf("%g,%.2f,%.2f\n", time, output, std::sqrt(time) / std::tgamma(1.5));
  }
}
