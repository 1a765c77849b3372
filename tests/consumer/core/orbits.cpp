// SPDX-License-Identifier: BSD-3-Clause
// Orbits of two masses with backlash over frequency: branches, where they end, and their bifurcations.
#include <backlash/orbit_continuation.hpp>
#include <cstdio>
#include <string>

int main() {
  const backlash::TwoMassSystem system(1, 1, 1, 0.6);  // kg, kg, clearance m, restitution
  const double force = 1;                              // N
  backlash::OrbitContinuationOptions options;
  options.longest_period = 1;
  options.most_impacts = 2;
  const backlash::OrbitDiagram diagram = backlash::orbit_diagram(system, force, 1.3, 6, options);  // rad/s
  for (const backlash::OrbitBranch& branch : diagram.branches) {
    std::printf("%d impacts in %d periods, %s: %zu orbits, ends by %s\n", branch.impacts, branch.period,
                branch.symmetric ? "symmetric" : "asymmetric", branch.orbits.size(),
                std::string(to_string(branch.end)).c_str());
    for (const backlash::BifurcationPoint& point : branch.bifurcations) {
      // By similarity F/(m2 clearance omega^2) decides.
      std::printf("  %s at omega %.8f rad/s, F/(m2 clearance omega^2) = %.8f\n",
                  std::string(to_string(point.kind)).c_str(), point.orbit.omega,
                  force / (point.orbit.omega * point.orbit.omega));
    }
  }
}
