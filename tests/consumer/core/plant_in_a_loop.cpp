// SPDX-License-Identifier: BSD-3-Clause
// A fractional PID moves two masses with backlash by 1 m: force on mass 2, position of mass 2 measured every
// millisecond.
#include <backlash/two_mass_plant.hpp>
#include <cstdio>
#include <frac/digital/fractional_pid.hpp>

int main() {
  frac::FractionalPidConfig config;
  config.gains = {.kp = 20, .ki = 15, .kd = 14, .lambda = 0.9, .mu = 0.9};  // kp + ki/s^lambda + kd s^mu
  config.sample_time = 1e-3;                                                // s
  config.band = {0.1, 300};                                                 // rad/s, on which the orders hold
  config.minimum = -6;                                                      // N
  config.maximum = 6;
  config.derivative_setpoint_weight = 0;  // derivative on the measurement
  frac::FractionalPid<double> pid(config);

  backlash::TwoMassPlant plant(backlash::TwoMassSystem(1, 1, 0.02, 0.6));  // kg, kg, clearance m, restitution
  std::puts("time_s,force_n,position1_m,position2_m,impacts");
  for (int n = 0; n <= 10000; ++n) {
    const backlash::TwoMassState state = plant.state();
    const double force = pid.step(1.0, state.position2);
    if (n % 500 == 0) {
      std::printf("%g,%.4f,%.5f,%.5f,%d\n", n * config.sample_time, force, state.position1, state.position2,
                  static_cast<int>(plant.impacts()));
    }
    plant.advance(force, config.sample_time);  // constant force over the sample: flights and impacts are exact
  }
}
