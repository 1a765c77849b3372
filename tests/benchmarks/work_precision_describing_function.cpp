// Describing function of two masses with backlash: cost of an impact, event-driven simulation against fixed steps, and
// the times of the figures of the paper.  Prints case,method,setting,error,seconds: error relative to the reference
// orbits where there is one; median of the repeats.  With --smoke everything once, small.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <complex>
#include <cstdio>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include "backlash/describing_function.hpp"
#include "backlash/impact_simulation.hpp"
#include "backlash/jump_law.hpp"
#include "backlash/static_backlash.hpp"
#include "report/fixed_step_reference.hpp"
#include "support/reference_table.hpp"
#include "support/relative_error.hpp"

namespace {

using backlash::describing_function_sweep;
using backlash::SweepOptions;
using backlash::SweepScene;
using backlash::TwoMassSystem;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

// Median seconds of one call; `work` is repeated within a measurement until that is long enough for the clock.
template <typename Work>
double median_seconds(int repeats, const Work& work) {
  std::vector<double> seconds;
  for (int i = 0; i < repeats; ++i) {
    const auto begin = std::chrono::steady_clock::now();
    int calls = 0;
    double elapsed = 0;
    do {
      work();
      ++calls;
      elapsed = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    } while (elapsed < 1e-3);
    seconds.push_back(elapsed / calls);
  }
  std::nth_element(seconds.begin(), seconds.begin() + repeats / 2, seconds.end());
  return seconds[static_cast<std::size_t>(repeats / 2)];
}

void row(const std::string& name, const std::string& method, const std::string& setting, double error, double seconds) {
  std::printf("%s,%s,%s,%.3g,%.4g\n", name.c_str(), method.c_str(), setting.c_str(), error, seconds);
  std::fflush(stdout);
}

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%g", value);
  return text;
}

volatile double sink = 0;

double sincos_seconds(int repeats) {
  return median_seconds(repeats,
                        [] {
                          double sum = 0;
                          for (int i = 0; i < 10000; ++i) {
                            const double x = 0.3 + 1e-4 * i;
                            sum += std::sin(x) + std::cos(x);
                          }
                          sink = sum;
                        }) /
         10000;
}

void cost_per_impact(int repeats) {
  row("sincos", "libm", "arguments 0.3 to 1.3", nan, sincos_seconds(repeats));
  for (const double restitution : {0.2, 0.6, 0.9}) {
    for (const double gamma : {0.3, 0.85, 2.2, 50.0}) {
      const TwoMassSystem system(1, 1, 1, restitution);
      const double omega = 1 / std::sqrt(gamma);
      // Beside each case, since the clock of a busy processor changes.
      const double one = sincos_seconds(repeats);
      std::size_t impacts = 0;
      const double seconds = median_seconds(repeats, [&] {
        impacts = backlash::simulate_impacts(system, 1, omega, {0.5, 0}, 500).impacts.size();
      });
      const double each = seconds / static_cast<double>(impacts);
      row("impact", "event-driven",
          "restitution " + number(restitution) + " gamma " + number(gamma) + " in sincos " + number(each / one), nan,
          each);
    }
  }
}

void against_reference(int repeats, bool smoke) {
  for (const auto& orbit : support::reference_table("df_orbits.csv")) {
    const double restitution = orbit[0];
    const double gamma = orbit[1];
    const std::complex<double> u(orbit[2], orbit[3]);
    const double omega = 1 / std::sqrt(gamma);
    const std::complex<double> expected = -(1.0 + u / gamma) / (2 * omega * omega);
    const std::string name = "restitution " + number(restitution) + " gamma " + number(gamma);
    for (const double tolerance : {1e-4, 1e-7, 1e-10, 1e-13}) {
      SweepOptions options;
      options.protocol = backlash::Protocol::mid_gap_at_rest;
      options.tolerance = tolerance;
      options.threads = 1;
      std::complex<double> value;
      const double seconds = median_seconds(repeats, [&] {
        value = describing_function_sweep({1, 1, 1, restitution}, 1, {omega}, options).points.front().value;
      });
      row(name, "event-driven", "tolerance " + number(tolerance), support::relative_error(value, expected), seconds);
    }
    for (const std::size_t steps :
         smoke ? std::vector<std::size_t>{100} : std::vector<std::size_t>{100, 1000, 10'000, 100'000}) {
      std::complex<double> value;
      const double seconds = median_seconds(steps > 1000 ? 1 : 3, [&] {
        value = report::fixed_step_describing_function({1, 1, 1, restitution, 1}, omega, steps, 60, 20);
      });
      row(name, "fixed-step", "step " + number(1.0 / static_cast<double>(steps)) + " of a period",
          support::relative_error(value, expected), seconds);
    }
  }
}

std::vector<double> linear_grid(double from, double to, int count) {
  std::vector<double> grid;
  for (int i = 0; i < count; ++i) grid.push_back(from + (to - from) * i / (count - 1));
  return grid;
}

void figures(int repeats, int points) {
  const std::vector<double> fig5 = linear_grid(0.5, 25, points);
  SweepOptions options;
  options.threads = 1;
  row("Fig. 5 curve", "event-driven", number(points) + " points on 1 thread", nan, median_seconds(repeats, [&] {
        (void)describing_function_sweep({1, 1, 0.3, 0.6}, 40, fig5, options);
      }));

  const std::vector<double> force = {10, 20, 30, 40, 50};
  const std::vector<double> restitution = {0, .2, .4, .6, .8, 1};
  const auto all = [&] {
    SweepOptions parallel;
    std::vector<SweepScene> fig4;
    std::vector<SweepScene> fig678;
    for (const double f : force) {
      (void)backlash::static_describing_function(1, 1, 0.3, f, linear_grid(5, 15, points));
      fig4.push_back({TwoMassSystem(1, 1, 0.3, 0.6), f});
      fig678.push_back({TwoMassSystem(1, 1, 0.3, 0.6), f});
    }
    for (const double e : restitution) fig678.push_back({TwoMassSystem(1, 1, 0.3, e), 40});
    for (const double d : {0., .1, .2, .3, .4, .5}) fig678.push_back({TwoMassSystem(1, 1, d, 0.6), 40});
    (void)backlash::describing_function_sweeps(fig4, linear_grid(5, 15, points), parallel);
    (void)backlash::describing_function_sweeps({{TwoMassSystem(1, 1, 0.3, 0.6), 40}}, fig5, parallel);
    (void)backlash::describing_function_sweeps(fig678, support::log_grid(5, 35, points), parallel);
    (void)backlash::fit_jump_law(1, 1, force, {.01, .025, .05, .1, .2, .3, .4, .5}, restitution,
                                 backlash::JumpCriterion::two_impact_loss);
  };
  row("Figs. 3 to 10", "event-driven", number(points) + " points per curve on all cores", nan,
      median_seconds(repeats, all));
  for (const auto criterion : {backlash::JumpCriterion::sweep_up, backlash::JumpCriterion::largest_discontinuity}) {
    row("Figs. 9 and 10", "event-driven", std::string(to_string(criterion)) + " on all cores", nan,
        median_seconds(1, [&] {
          (void)backlash::fit_jump_law(1, 1, force, {.01, .025, .05, .1, .2, .3, .4, .5}, {.4, .6, .8}, criterion);
        }));
  }
}

// N over frequency and restitution with regime and uncertainty, all cores.
void regime_map(int restitutions, int frequencies) {
  SweepOptions options;
  options.protocol = backlash::Protocol::two_impact;
  std::vector<SweepScene> scenes;
  for (const double e : linear_grid(0, 1, restitutions)) scenes.push_back({TwoMassSystem(1, 1, 1, e), 1});
  row("regime map", "event-driven", number(restitutions) + " restitutions by " + number(frequencies) + " frequencies",
      nan, median_seconds(1, [&] {
        (void)backlash::describing_function_sweeps(scenes, support::log_grid(0.5, 4, frequencies), options);
      }));
}

}  // namespace

int main(int argc, char** argv) {
  const bool smoke = argc > 1 && std::strcmp(argv[1], "--smoke") == 0;
  const int repeats = smoke ? 1 : 7;
  std::printf("# build type: %s\n# compiler: g++ %s\n", FRACFIT_BUILD_TYPE, __VERSION__);
  std::printf("case,method,setting,error,seconds\n");
  cost_per_impact(repeats);
  against_reference(repeats, smoke);
  figures(smoke ? 1 : 5, smoke ? 20 : 200);
  regime_map(smoke ? 5 : 250, smoke ? 20 : 400);
}
