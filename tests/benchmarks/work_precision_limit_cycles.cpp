// SPDX-License-Identifier: BSD-3-Clause
// Exact symmetric limit cycles with their stability: all of one loop, by closed form, and in a range of two decades by
// search where there is dead time or a ratio; and one of them, whose frequency is known to a thousandth.  Prints
// case,method,setting,error,seconds; error is that of the frequency against its known value (a ratio whose factor
// cancels has that of the sum it is), seconds the least and the median of the repeats.  Motions: processor time per
// impact, and as error the drift of the speed of impact from that of the exact cycle over the second half.  The maps
// are of 1 + k s^q over k and q, on two threads; their error counts the loops that come out another way on one thread
// or on three.  Energy: the largest change of that of a loop without loss, over what it began with.
// The second one follows a motion where no symmetric cycle is stable and tells after how many impacts it repeats.
// --smoke: one repeat and small ones.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

#include "backlash/loops/impact_cycles.hpp"
#include "backlash/loops/limit_cycles.hpp"
#include "backlash/loops/simulate_loop.hpp"
#include "frac/parallel_for.hpp"

namespace {

struct Case {
  const char* name;
  const char* method;
  const char* controller;
  double restitution;
  double omega;  // NaN: not known in closed form
};

backlash::LimitCycles run(const Case& each, const char* setting, backlash::FrequencyRange range, int repeats) {
  const backlash::ControlLoop loop({1, 1, 1, each.restitution},
                                   frac::FractionalTransferFunction::parse(each.controller));
  backlash::LimitCycleOptions options;
  options.range = range;
  backlash::LimitCycles found;
  std::vector<double> seconds;
  for (int i = 0; i < repeats; ++i) {
    const auto start = std::chrono::steady_clock::now();
    found = backlash::symmetric_cycles(loop, options);
    seconds.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  }
  std::sort(seconds.begin(), seconds.end());
  double error = std::numeric_limits<double>::quiet_NaN();
  if (found.cycles.size() == 1) error = std::abs(found.cycles[0].omega / each.omega - 1);
  for (const auto& [name, value] :
       {std::pair{"least", seconds.front()}, std::pair{"median", seconds[seconds.size() / 2]}})
    std::printf("%s,%s,%s %s,%.3e,%.3e\n", each.name, each.method, setting, name, error, value);
  return found;
}

// Bits: a stable motion, an unstable one.
std::vector<int> map_of(std::size_t side, int threads) {
  std::vector<int> map(side * side);
  frac::parallel_for(map.size(), threads, [&](std::size_t i) {
    const double share = 1 / static_cast<double>(side - 1);
    const double gain = std::pow(10, -1.5 + 3 * share * static_cast<double>(i / side));
    const double order = 0.05 + 1.55 * share * static_cast<double>(i % side);
    const backlash::ControlLoop loop({1, 1, 1, .6},
                                     frac::FractionalTransferFunction({{gain, order}, {1, 0}}, {{1, 0}}));
    for (const backlash::SymmetricCycle& cycle : backlash::symmetric_cycles(loop).cycles) {
      if (cycle.admissible) map[i] |= cycle.stability.stable ? 1 : 2;
    }
  });
  return map;
}

// 0: a stable symmetric cycle of two impacts; 1 to 12: the impacts of the cycle that a motion comes to; 13: none, 14:
// the impacts cease, 15: it diverges.
int kind_of(const backlash::ControlLoop& loop) {
  for (const backlash::SymmetricCycle& cycle : backlash::symmetric_cycles(loop).cycles) {
    if (cycle.admissible && cycle.stability.stable) return 0;
  }
  backlash::LoopSimulationOptions options;
  options.duration = 2000;
  options.most_impacts = 250;
  options.rows_at_impacts = false;
  options.tolerance = 1e-3;
  const backlash::LoopHistory history = backlash::simulate_loop(loop, {0, .1, 0, 2}, {}, options);
  if (history.end == backlash::LoopEnd::diverged) return 15;
  if (history.end != backlash::LoopEnd::most_impacts) return 14;
  const auto pattern = backlash::repeated_pattern(loop, history.impacts);
  return pattern ? static_cast<int>(pattern->impacts.size()) : 13;
}

std::vector<int> kinds_of(std::size_t side, int threads) {
  std::vector<int> map(side * side);
  frac::parallel_for(map.size(), threads, [&](std::size_t i) {
    const double share = 1 / static_cast<double>(side - 1);
    const double gain = std::pow(10, -1.5 + 3 * share * static_cast<double>(i / side));
    const double order = 0.05 + 1.55 * share * static_cast<double>(i % side);
    map[i] = kind_of({{1, 1, 1, .6}, frac::FractionalTransferFunction({{gain, order}, {1, 0}}, {{1, 0}})});
  });
  return map;
}

void run_motion(const char* controller, double tolerance, std::size_t impacts) {
  const backlash::ControlLoop loop({1, 1, 1, .6}, frac::FractionalTransferFunction::parse(controller));
  backlash::LoopSimulationOptions options;
  options.duration = 1e9;
  options.most_impacts = impacts;
  options.rows_at_impacts = false;
  options.tolerance = tolerance;
  const std::clock_t start = std::clock();
  const backlash::LoopHistory history = backlash::simulate_loop(loop, {0, .1, 0, 1}, {}, options);
  const double seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  const double speed = backlash::symmetric_cycles(loop).cycles.front().impact_speed;
  double drift = 0;
  for (std::size_t i = impacts / 2; i < history.impacts.size(); ++i) {
    drift = std::max(drift, std::abs(history.impacts[i].speed / speed - 1));
  }
  std::printf("%s per impact,exponentials to %.0e,%zu impacts,%.3e,%.3e\n", controller, tolerance,
              history.impacts.size(), drift, seconds / static_cast<double>(impacts));
}

// A spring in place of the controller and elastic impacts: M1 v1^2 + M2 v2^2 + k x2^2 stays what it is.
void run_energy(std::size_t impacts) {
  const backlash::ControlLoop loop({1, 3, 1, 1}, frac::FractionalTransferFunction::parse("4"), backlash::Output::x2);
  backlash::LoopSimulationOptions options;
  options.duration = 1e9;
  options.most_impacts = impacts;
  const std::clock_t start = std::clock();
  const backlash::LoopHistory history = backlash::simulate_loop(loop, {0, 0, 0, 1}, {}, options);
  const double seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  double drift = 0;
  for (const backlash::LoopRow& row : history.rows)
    drift = std::max(drift, std::abs((row.v1 * row.v1 + 3 * row.v2 * row.v2 + 4 * row.x2 * row.x2) / 3 - 1));
  std::printf("energy without loss per impact,sines,%zu impacts,%.3e,%.3e\n", history.impacts.size(), drift,
              seconds / static_cast<double>(impacts));
}

template <typename Map>
void run_map(std::size_t side, const char* method, const Map& map_of) {
  const std::clock_t processor_start = std::clock();
  const auto start = std::chrono::steady_clock::now();
  const std::vector<int> map = map_of(side, 2);
  const double processor = static_cast<double>(std::clock() - processor_start) / CLOCKS_PER_SEC;
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  int different = 0;
  for (const int threads : {1, 3}) {
    const std::vector<int> again = map_of(side, threads);
    for (std::size_t i = 0; i < map.size(); ++i) different += map[i] != again[i];
  }
  std::printf("map of %zu loops,%s,once,%d,%.3e\n", map.size(), method, different, seconds);
  std::printf("map of %zu loops,%s,processor,%d,%.3e\n", map.size(), method, different, processor);
}

}  // namespace

int main(int argc, char** argv) {
  const bool is_smoke = argc > 1 && std::strcmp(argv[1], "--smoke") == 0;
  std::printf("# build %s\ncase,method,setting,error,seconds\n", FRACFIT_BUILD_TYPE);
  constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
  const Case cases[] = {
      {"1 + s", "closed form", "1 + s", .6, std::numbers::pi},
      {"1 + s^0.5", "closed form", "1 + s^0.5", .6, 1.58131922051927},
      {"2 + 1.5 s^0.9", "closed form", "2 + 1.5 s^0.9", .8, 8.22531524987729},
      {"1 + s^0.5 late", "dead time", "exp(-0.05 s) (1 + s^0.5)", .6, unknown},
      {"1 + s^0.5 as a ratio", "inverse transform", "(s + 2) (1 + s^0.5)/(s + 2)", .6, 1.58131922051927},
      {"filtered", "inverse transform", "(1 + s)/(1 + 0.01 s)", .6, unknown},
      {"filtered and late", "inverse transform", "exp(-0.05 s) (1 + s^0.5)/(1 + 0.01 s)", .6, unknown}};
  for (const Case& each : cases) {
    const int repeats = is_smoke ? 1 : 200;
    const backlash::LimitCycles found = run(each, "two decades", {0.5, 50}, repeats);
    if (found.cycles.empty()) continue;
    const double omega = found.cycles.front().omega;
    run(each, "one cycle", {0.999 * omega, 1.001 * omega}, repeats);
  }
  run_motion("1 + s", 1e-8, is_smoke ? 1000 : 1'000'000);
  run_motion("1 + s^0.5", 1e-5, is_smoke ? 500 : 100'000);
  run_energy(is_smoke ? 1000 : 1'000'000);
  run_map(is_smoke ? 10 : 100, "closed form", map_of);
  run_map(is_smoke ? 10 : 100, "with motions", kinds_of);
}
