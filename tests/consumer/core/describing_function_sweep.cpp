// SPDX-License-Identifier: BSD-3-Clause
// Describing function from the force on mass 2 to the position of mass 1, two masses of 1 kg with 1 m of clearance
// between them, swept over frequency.
#include <backlash/describing_function.hpp>
#include <cstdio>
#include <vector>

int main() {
  const backlash::TwoMassSystem system(1, 1, 1, 0.6);  // kg, kg, clearance m, restitution
  const double force = 1;                              // N
  backlash::SweepOptions options;
  options.protocol = backlash::Protocol::mid_gap_at_rest;
  const std::vector<double> omega{1.2, 1.4907119849998598, 1.8};  // rad/s
  const auto sweep = backlash::describing_function_sweep(system, force, omega, options);
  for (const backlash::DescribingFunctionPoint& point : sweep.points) {
    std::printf("%.6f %.9f %.9f\n", point.omega, point.value.real(), point.value.imag());
    std::puts(point.summary().c_str());
  }

  // Without clearance the two move as one: -1/((m1 + m2) omega^2).
  const backlash::TwoMassSystem rigid(1, 1, 0, 0.6);
  const auto point = backlash::describing_function_sweep(rigid, force, {2.0}).points.front();
  std::printf("rigid %.6f\n", point.value.real());
}
