// SPDX-License-Identifier: BSD-3-Clause
// Points of a sweep on the symmetric orbit of two contacts, and what they cost beside those of two impacts.
#include <algorithm>
#include <complex>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <limits>
#include <string>
#include <vector>

#include "backlash/compliant/compliant_bodies.hpp"
#include "compliant/compliant_orbit.hpp"
#include "support/relative_error.hpp"

namespace {

using backlash::Protocol;

volatile double sink = 0;

// Of the processor, so that whatever else runs on it does not count.
template <typename Work>
double seconds_of(const Work& work) {
  const std::clock_t begin = std::clock();
  work();
  return static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
}

// Gap, force and masses 1.
backlash::CompliantBodies bodies_of(double frequency, double restitution) {
  return {
      backlash::free_mass(1), backlash::free_mass(1), 1,
      backlash::CompliantContact::from_frequency(frequency, backlash::damping_ratio_of_restitution(restitution), 1, 1)};
}

backlash::SweepOptions options_of(Protocol protocol) {
  backlash::SweepOptions options;
  options.protocol = protocol;
  options.threads = 1;
  return options;
}

// By the orbit of the flow from event to event.
std::complex<double> value_of_flow(const backlash::CompliantBodies& bodies, double omega) {
  const auto force = backlash::detail::SineForce{1, omega};
  const backlash::detail::CompliantFlow flow(bodies, force, backlash::Output::x1, 1e-9, 1);
  const Eigen::VectorXd start = flow.start({0, 0, 0, omega});
  backlash::detail::CompliantRun run(flow, start, flow.mode_of(start));
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  if (!run.follow(200)) return none;
  const auto orbit = backlash::detail::closed_orbit(flow, run.state(), run.mode(), 1);
  // Another motion may attract too.
  return orbit ? backlash::detail::read_orbit(*orbit, bodies, force, backlash::Output::x1, 1e-9).value : none;
}

}  // namespace

int main(int argc, char** argv) {
  const bool smoke = argc > 1 && std::strcmp(argv[1], "--smoke") == 0;
  const int bursts = smoke ? 1 : 60;
  std::printf("# build type: %s\n# compiler: g++ %s\n", FRACFIT_BUILD_TYPE, __VERSION__);
  std::printf("case,method,setting,error,seconds\n");
  for (const std::size_t points : {std::size_t{200}, std::size_t{2000}, std::size_t{20000}}) {
    for (const double restitution : {0.3, 0.6, 0.8}) {
      for (const double frequency : {8.0, 32.0, 256.0}) {
        const std::vector<double> omega = support::linear_grid(1.7, 2.1, static_cast<int>(points));
        const auto bodies = bodies_of(frequency, restitution);
        const auto options = options_of(Protocol::two_impact);
        double hard = std::numeric_limits<double>::infinity(), compliant = hard;
        // In turn, as the clock of a busy processor changes.
        for (int burst = 0; burst < bursts; ++burst) {
          hard = std::min(hard, seconds_of([&] {
                            sink = describing_function_sweep(bodies.system(), 1, omega, options).points.back().period;
                          }));
          compliant = std::min(compliant, seconds_of([&] {
                                 sink = bodies_describing_function(bodies, 1, omega, options).points.back().period;
                               }));
        }
        const auto sweep = bodies_describing_function(bodies, 1, omega, options);
        const bool is_closed = std::all_of(sweep.points.begin(), sweep.points.end(), [](const auto& point) {
          return point.regime == backlash::Regime::symmetric && point.impacts_per_period == 2;
        });
        const double middle = omega[points / 2];
        const double error = support::relative_error(sweep.points[points / 2].value, value_of_flow(bodies, middle));
        const auto each = [&](double seconds) { return seconds / static_cast<double>(points); };
        char setting[128];
        std::snprintf(setting, sizeof setting, "%zu points restitution %g wc %g%s: times hard %.2f", points,
                      restitution, frequency, is_closed ? "" : " (not all symmetric)", compliant / hard);
        std::printf("symmetric orbit,closed form,%s,%.2g,%.3g\n", setting, error, each(compliant));
        std::fflush(stdout);
      }
    }
    if (smoke) break;
  }
}
