// SPDX-License-Identifier: BSD-3-Clause
// Describing function of two masses with backlash: cost of an impact and of a point in closed form, in libm sincos of
// the same run; fixed steps, impacts followed, orbit solver and closed form against quadruple precision; the jump law
// that a fixed step bends; the figures of the paper; a regime map over points and threads.  Prints
// case,method,setting,error,seconds: relative error where there is something to compare with; median of the repeats, of
// an impact and a point the least of many short bursts.  With --smoke everything once, small.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <complex>
#include <cstdio>
#include <cstring>
#include <limits>
#include <numbers>
#include <string>
#include <tuple>
#include <variant>
#include <vector>

#include "backlash/describing_function.hpp"
#include "backlash/identification/jump_law.hpp"
#include "backlash/regime_map.hpp"
#include "backlash/static_backlash.hpp"
#include "motion/gap_motion.hpp"
#include "motion/harmonics.hpp"
#include "report/fixed_step_jump.hpp"
#include "report/fixed_step_reference.hpp"
#include "steady_state/steady_state.hpp"
#include "steady_state/symmetric_orbits.hpp"
#include "support/reference_table.hpp"
#include "support/relative_error.hpp"

namespace {

using backlash::describing_function_sweep;
using backlash::SweepOptions;
using backlash::SweepScene;
using backlash::TwoMassSystem;
using backlash::detail::find_steady_state;
using backlash::detail::Flight;
using backlash::detail::GapMotion;
using backlash::detail::GapState;
using backlash::detail::harmonics_of_jumps;
using backlash::detail::JumpSum;
using backlash::detail::state_at_peak;
using backlash::detail::SteadyState;
using backlash::detail::SymmetricOrbits;

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

// Least seconds of one call among many short bursts: what the work costs where nothing else runs on the core.
template <typename Work>
double least_seconds(int bursts, const Work& work) {
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < bursts; ++i) {
    const auto begin = std::chrono::steady_clock::now();
    work();
    least = std::min(least, std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
  }
  return least;
}

double least_sincos_seconds(int bursts) {
  return least_seconds(bursts,
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

// One impact after the other, with the sums of harmonics 1, 2, 3 and 5 and the test for the end of a chatter.
struct EventDriven {
  GapMotion motion;
  GapState state = state_at_peak(0.5, 0);
  JumpSum jumps{};

  void follow(int impacts) {
    for (int i = 0; i < impacts; ++i) {
      if (motion.rests(state) || motion.chatter_tail(state).negligible(1e-13)) state = motion.release_after(state);
      const Flight flight = motion.next_flight(state);
      state = motion.after_impact(state, flight);
      jumps.add(state, flight.speed);
    }
  }
};

// Error of the first harmonic of a closed orbit, taken from the impacts of one round after many.
double error_of_followed_orbit(double gamma, double restitution) {
  const GapMotion motion(gamma, restitution);
  const SteadyState steady = find_steady_state(motion, state_at_peak(0.5, 0), 1e-10);
  if (steady.period == 0 || !std::isfinite(steady.impacts_per_period) || steady.spectral_radius == 0) return nan;
  EventDriven run{motion};
  run.follow(100'000);
  run.jumps = {};
  run.follow(static_cast<int>(std::lround(steady.impacts_per_period * steady.period)));
  return support::relative_error(harmonics_of_jumps(run.jumps, gamma, 2.0 * steady.period).u[0], steady.harmonics.u[0]);
}

void cost_per_impact(int bursts) {
  row("sincos", "libm", "arguments 0.3 to 1.3", nan, least_sincos_seconds(bursts));
  for (const double restitution : {0.2, 0.6, 0.9}) {
    for (const double gamma : {0.3, 0.85, 2.2, 50.0}) {
      // Beside each case, since the clock of a busy processor changes.
      const double one = least_sincos_seconds(bursts);
      EventDriven run{GapMotion(gamma, restitution)};
      const int impacts = 5000;
      const double each = least_seconds(bursts, [&] { run.follow(impacts); }) / impacts;
      sink = run.jumps.sums()[0].real();
      row("impact with harmonics", "event-driven",
          "restitution " + number(restitution) + " gamma " + number(gamma) + " in sincos " + number(each / one),
          error_of_followed_orbit(gamma, restitution), each);
    }
  }
}

// Points of a sweep on the symmetric orbit, diagnostics included.
void cost_of_closed_form(int bursts) {
  SweepOptions options;
  options.protocol = backlash::Protocol::two_impact;
  options.threads = 1;
  const int points = 20'000;
  const std::vector<double> omega = support::linear_grid(1.7, 2.6, points);
  const double one = least_sincos_seconds(bursts);
  const double each =
      least_seconds(bursts,
                    [&] {
                      sink = describing_function_sweep({1, 1, 1, 0.6}, 1, omega, options).points.back().value.real();
                    }) /
      points;
  double worst = 0;
  for (const double w : {1.7, 1.8, 1.9, 1.98}) {
    const auto closed = describing_function_sweep({1, 1, 1, 0.6}, 1, {w}, options).points.front();
    EventDriven run{GapMotion(1 / (w * w), 0.6)};
    run.follow(2000);
    run.jumps = {};
    run.follow(2);
    const std::complex<double> followed =
        -harmonics_of_jumps(run.jumps, 1 / (w * w), 2).u1_plus_gamma * (w * w) / (2 * w * w);
    worst = std::max(worst, support::relative_error(closed.value, followed));
  }
  row("point of a sweep", "closed form", "restitution 0.6 in sincos " + number(each / one), worst, each);
}

// Impacts followed without looking for an orbit: what is left of the transient after `settle` periods is the error.
std::complex<double> followed_mean(double gamma, double restitution, int settle, int measure) {
  EventDriven run{GapMotion(gamma, restitution)};
  const auto until = [&](std::int64_t half_period) {
    while (run.state.half_period < half_period) run.follow(1);
  };
  until(1 + 2 * settle);
  const GapState from = run.state;
  run.jumps = {};
  until(from.half_period + 2 * measure);
  return harmonics_of_jumps(run.jumps, gamma, static_cast<double>(run.state.half_period - from.half_period)).u[0];
}

// A scene whose U_1 is known.
struct Reference {
  double restitution;
  double gamma;
  std::complex<double> u;
  bool rests;
};

// The reference orbits, of quadruple precision, and a symmetric one, whose closed form is evaluated in long double.
std::vector<Reference> references() {
  std::vector<Reference> all;
  const long double e = 0.6;
  const long double gamma = 0.3;
  const long double pi = std::numbers::pi_v<long double>;
  const long double a = (1 - e) * (1 - e) + pi * pi * (1 + e) * (1 + e) / 4;
  const long double b = pi * (1 + e);
  const long double v = (b + std::sqrt(b * b - 4 * a * (1 - 4 * gamma * gamma))) / (2 * a);
  const long double cosine = (1 - pi * v * (1 + e) / 2) / (2 * gamma);
  const long double sine = -v * (1 - e) / (2 * gamma);
  const long double jump = 2 * (1 + e) * v / pi;
  all.push_back({0.6, 0.3, {static_cast<double>(-gamma - jump * cosine), static_cast<double>(jump * sine)}, false});
  for (const auto& orbit : support::reference_table("df_orbits.csv")) {
    const bool rests = orbit[8] > 10 || orbit[0] == 0;
    all.push_back({orbit[0], orbit[1], {orbit[2], orbit[3]}, rests});
  }
  return all;
}

// N by every method, against more than double precision.
void against_reference(int repeats, bool smoke) {
  for (const auto& [restitution_, gamma_, u, rests] : references()) {
    const double restitution = restitution_;
    const double gamma = gamma_;
    const double omega = 1 / std::sqrt(gamma);
    const std::complex<double> expected = -(1.0 + u / gamma) / (2 * omega * omega);
    const std::string name = "restitution " + number(restitution) + " gamma " + number(gamma);
    for (const std::size_t steps :
         smoke ? std::vector<std::size_t>{100} : std::vector<std::size_t>{100, 1000, 10'000, 100'000}) {
      std::complex<double> value;
      const double seconds = median_seconds(steps > 1000 ? 1 : 3, [&] {
        value = report::fixed_step_describing_function({1, 1, 1, restitution, 1}, omega, steps, 60, 20);
      });
      row(name, "fixed-step", "step " + number(1.0 / static_cast<double>(steps)) + " of a period",
          support::relative_error(value, expected), seconds);
    }
    if (!rests) {  // sums of velocity jumps do not describe rests
      for (const int settle : {10, 60, 200}) {
        std::complex<double> mean;
        const double seconds = median_seconds(repeats, [&] { mean = followed_mean(gamma, restitution, settle, 20); });
        row(name, "event-driven", number(settle) + " periods to settle",
            support::relative_error(-(1.0 + mean / gamma) / (2 * omega * omega), expected), seconds);
      }
    }
    for (const double tolerance : {1e-4, 1e-10}) {
      SweepOptions options;
      options.protocol = backlash::Protocol::mid_gap_at_rest;
      options.tolerance = tolerance;
      options.threads = 1;
      std::complex<double> value;
      const double seconds = median_seconds(repeats, [&] {
        value = describing_function_sweep({1, 1, 1, restitution}, 1, {omega}, options).points.front().value;
      });
      row(name, "orbit solver", "tolerance " + number(tolerance), support::relative_error(value, expected), seconds);
    }
    const SymmetricOrbits symmetric(restitution);
    if (symmetric.contains(gamma)) {
      std::complex<double> closed;
      const double seconds = median_seconds(repeats, [&] { closed = symmetric.at(gamma).harmonics.u1_plus_gamma; });
      row(name, "closed form", "symmetric orbit",
          support::relative_error(-closed / gamma / (2 * omega * omega), expected), seconds);
    }
  }
}

// Exponents of the jump law as a fixed time step sees them; exactly -1/2 and 1/2.
void bent_exponents(bool smoke) {
  const std::vector<double> force = smoke ? std::vector<double>{10, 50} : std::vector<double>{10, 20, 30, 40, 50};
  const std::vector<double> clearance =
      smoke ? std::vector<double>{.3, .5} : std::vector<double>{.01, .025, .05, .1, .2, .3, .4, .5};
  const auto begin = std::chrono::steady_clock::now();
  const report::Table table = report::fixed_step_jumps(force, clearance, 0);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  for (const auto& cells : table.rows) {
    const auto value = [&](std::size_t column) { return std::get<double>(cells[column]); };
    row("jump law from contact at rest", "fixed-step",
        std::get<std::string>(cells[0]) + " of 1e-4 s: exponent of a " + number(value(4)) + " b " + number(value(5)) +
            " to " + number(value(6)),
        std::max(std::abs(value(5) / 0.5 - 1), std::abs(value(6) / 0.5 - 1)),
        seconds / static_cast<double>(table.rows.size()));
  }
  const auto exact = backlash::fit_jump_law(1, 1, force, clearance, {0.6}, backlash::JumpCriterion::contact_at_rest);
  row("jump law from contact at rest", "closed form",
      "exponent of a " + number(exact.a_of_clearance.exponent) + " b " + number(exact.laws.front().law.exponent),
      std::abs(exact.laws.front().law.exponent / 0.5 - 1), median_seconds(3, [&] {
        (void)backlash::fit_jump_law(1, 1, force, clearance, {0.6}, backlash::JumpCriterion::contact_at_rest);
      }));
}

void figures(int repeats, int points) {
  const std::vector<double> fig5 = support::linear_grid(0.5, 25, points);
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
      (void)backlash::static_describing_function(1, 1, 0.3, f, support::linear_grid(5, 15, points));
      fig4.push_back({TwoMassSystem(1, 1, 0.3, 0.6), f});
      fig678.push_back({TwoMassSystem(1, 1, 0.3, 0.6), f});
    }
    for (const double e : restitution) fig678.push_back({TwoMassSystem(1, 1, 0.3, e), 40});
    for (const double d : {0., .1, .2, .3, .4, .5}) fig678.push_back({TwoMassSystem(1, 1, d, 0.6), 40});
    (void)backlash::describing_function_sweeps(fig4, support::linear_grid(5, 15, points), parallel);
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

// N over frequency and restitution with regime and uncertainty: cost over points and over threads.
void regime_map(bool smoke) {
  const auto seconds = [](int restitutions, int frequencies, int threads) {
    SweepOptions options = backlash::map_options();
    options.threads = threads;
    const std::vector<double> restitution = support::linear_grid(0, 1, restitutions);
    const std::vector<double> omega = support::log_grid(0.5, 4, frequencies);
    return median_seconds(1, [&] { (void)backlash::regime_map({}, restitution, omega, options); });
  };
  const auto setting = [](int restitutions, int frequencies, int threads) {
    return number(restitutions) + " restitutions by " + number(frequencies) + " frequencies on " + number(threads) +
           (threads == 1 ? " thread" : " threads");
  };
  const int size = smoke ? 4 : 50;
  for (const auto& [restitutions, frequencies, threads] :
       {std::tuple{size, 2 * size, 1}, {size, 4 * size, 1}, {2 * size, 4 * size, 1}, {2 * size, 4 * size, 2}}) {
    row("regime map", "event-driven", setting(restitutions, frequencies, threads), nan,
        seconds(restitutions, frequencies, threads));
  }
  if (!smoke) row("regime map", "event-driven", setting(250, 400, 2), nan, seconds(250, 400, 2));
}

}  // namespace

int main(int argc, char** argv) {
  const bool smoke = argc > 1 && std::strcmp(argv[1], "--smoke") == 0;
  const int repeats = smoke ? 1 : 7;
  std::printf("# build type: %s\n# compiler: g++ %s\n", FRACFIT_BUILD_TYPE, __VERSION__);
  std::printf("case,method,setting,error,seconds\n");
  cost_per_impact(smoke ? 1 : 60);
  cost_of_closed_form(smoke ? 1 : 60);
  against_reference(repeats, smoke);
  bent_exponents(smoke);
  figures(smoke ? 1 : 5, smoke ? 20 : 200);
  regime_map(smoke);
}
