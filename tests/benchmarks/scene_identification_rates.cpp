// SPDX-License-Identifier: BSD-3-Clause
// How often identify_scene is confidently wrong, over seeded random scenes: masses, clearance and restitution, one to
// four forces, bands that reach into chaos or chatter or do not, sweeps up and down, either body, noise of 0 to 3 %.
//   sound   the data are those of two masses
//   misled  two to four forces, at one of which N is off by 5 to 20 %: no scene describes the data
// An estimate is stated where it is called identified.  It is missed where its 95 % interval does not hold the truth,
// and wrong where it lies more than twice as far off as the interval reaches and by more than 0.1 %.  A scene is wrong
// where one of its estimates is.  Exact data leave rounding: an interval counts as 10^-6 of the value at least.
// Prints kind,noise,scenes,unusable,inadequate,stated,missed,missed_percent,wrong_scenes,seconds.
// Usage: scene_identification_rates [--smoke] [--each] [scenes] [seed]; --each prints a line for each scene as well.
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <complex>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <map>
#include <string>
#include <vector>

#include "backlash/identification/scene_identification.hpp"
#include "support/random.hpp"

namespace {

using backlash::MeasuredDescribingFunction;
using backlash::Output;
using Complex = std::complex<double>;

constexpr std::array<double, 4> noise_levels = {0, 0.003, 0.01, 0.03};
constexpr double exact = 1e-6;

struct Case {
  backlash::TwoMassSystem system;
  double noise;
  std::vector<MeasuredDescribingFunction> curves;
  backlash::SceneIdentificationOptions options;
};

std::vector<double> log_grid(double lower, double upper, std::size_t count) {
  std::vector<double> grid;
  for (std::size_t i = 0; i < count; ++i) {
    grid.push_back(lower * std::pow(upper / lower, static_cast<double>(i) / static_cast<double>(count - 1)));
  }
  return grid;
}

Case random_case(support::Random& random, bool misled) {
  Case made{
      {random.log_uniform(0.2, 5), random.log_uniform(0.2, 5), random.log_uniform(0.01, 1), random.uniform(0.05, 0.95)},
      noise_levels[random.below(noise_levels.size())],
      {},
      {}};
  made.options.threads = 1;
  const std::size_t forces = misled ? 2 + random.below(3) : 1 + random.below(4);
  const double lower = random.log_uniform(0.3, 1.7);
  const double upper = std::max(1.5 * lower, random.log_uniform(1.8, 3.5));
  const std::size_t points = 12 + random.below(29);
  const bool one_band = random.unit() < 0.5;  // in rad/s, not relative to sqrt(F/(mass2 clearance))
  const auto setting = random.below(4);
  made.options.output = setting < 2 ? Output::x1 : Output::x2;
  if (setting == 3) made.options.component = frac::Component::imaginary;
  // All that is needed for the others to have values.
  if (setting != 2) made.options.constraints.push_back({"mass1", made.system.mass1(), {}, {}, {}});
  backlash::SweepOptions sweep;
  sweep.output = made.options.output;
  constexpr std::array<backlash::Protocol, 3> protocols = {backlash::Protocol::sweep_up, backlash::Protocol::sweep_down,
                                                           backlash::Protocol::mid_gap_at_rest};
  sweep.protocol = protocols[random.below(protocols.size())];
  sweep.threads = 1;
  // Chaotic means are of no use to the identification, and long to compute.
  sweep.mean_tolerance = 0.01;
  const double first = random.log_uniform(1, 100);
  std::vector<double> amplitude = {first};
  while (amplitude.size() < forces) amplitude.push_back(first * random.log_uniform(0.4, 2.5));
  const std::size_t off = misled ? random.below(forces) : forces;
  const double factor = 1 + (random.unit() < 0.5 ? -1 : 1) * random.uniform(0.05, 0.2);
  for (std::size_t i = 0; i < forces; ++i) {
    const double unit = std::sqrt((one_band ? first : amplitude[i]) / (made.system.mass2() * made.system.clearance()));
    const auto omega = log_grid(lower * unit, upper * unit, points);
    std::vector<Complex> value =
        backlash::describing_function_sweep(made.system, amplitude[i], omega, sweep).data().value();
    for (Complex& z : value) {
      const double real = random.normal();
      z += made.noise * std::abs(z) * Complex(real, random.normal());
      if (i == off) z *= factor;
    }
    made.curves.push_back({{omega, value}, amplitude[i]});
  }
  return made;
}

struct Tally {
  int scenes = 0, unusable = 0, inadequate = 0, stated = 0, missed = 0, wrong = 0;
  double seconds = 0;
};

void judge(const Case& scene, bool each, Tally& tally) {
  const auto begin = std::chrono::steady_clock::now();
  const auto result = backlash::identify_scene(scene.curves, scene.options);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  ++tally.scenes;
  tally.seconds += seconds;
  if (result.termination == frac::FitTermination::no_usable_start) ++tally.unusable;
  if (!result.misfits.empty()) ++tally.inadequate;
  const std::array<double, 4> truth = {scene.system.mass1(), scene.system.mass2(), scene.system.clearance(),
                                       scene.system.restitution()};
  bool wrong = false;
  std::string text;
  for (std::size_t k = 0; k < truth.size(); ++k) {
    const backlash::SceneEstimate& estimate = result.parameters[k];
    if (estimate.fixed) continue;
    char shown[160];
    std::snprintf(shown, sizeof shown, " %s %.5g %s%.5g (%.5g..%.5g)", estimate.name.c_str(), truth[k],
                  estimate.identified ? "" : "? ", estimate.value, estimate.ci95_lower, estimate.ci95_upper);
    text += shown;
    if (!estimate.identified) continue;
    ++tally.stated;
    const double rounding = exact * truth[k];
    const double error = std::abs(estimate.value - truth[k]);
    const double half_width = std::max(rounding, estimate.ci95_upper - estimate.value);
    if (!(error <= half_width)) ++tally.missed;
    if (!(error <= std::max(2 * half_width, 1e-3 * truth[k]))) wrong = true;
  }
  if (wrong) ++tally.wrong;
  if (each) {
    std::printf("# %s x%d %s%zu forces noise %g: %zu of %zu points, %.2f s:%s | %s\n", wrong ? "WRONG" : "ok",
                scene.options.output == Output::x1 ? 1 : 2,
                scene.options.component == frac::Component::imaginary ? "imaginary " : "", scene.curves.size(),
                scene.noise, result.points_used, result.points.size(), seconds, text.c_str(), result.message.c_str());
    std::fflush(stdout);
  }
}

void row(const char* kind, double noise, const Tally& tally) {
  std::printf("%s,%g,%d,%d,%d,%d,%d,%.1f,%d,%.3g\n", kind, noise, tally.scenes, tally.unusable, tally.inadequate,
              tally.stated, tally.missed, 100.0 * tally.missed / std::max(1, tally.stated), tally.wrong, tally.seconds);
}

}  // namespace

int main(int argc, char** argv) {
  bool each = false, smoke = false;
  std::vector<std::uint64_t> numbers;
  for (int i = 1; i < argc; ++i) {
    if (std::strcmp(argv[i], "--each") == 0) {
      each = true;
    } else if (std::strcmp(argv[i], "--smoke") == 0) {
      smoke = true;
    } else {
      numbers.push_back(std::strtoull(argv[i], nullptr, 10));
    }
  }
  const std::uint64_t scenes = smoke ? 2 : !numbers.empty() ? numbers[0] : 200;
  const std::uint64_t seed = numbers.size() > 1 ? numbers[1] : 1;
  std::printf("kind,noise,scenes,unusable,inadequate,stated,missed,missed_percent,wrong_scenes,seconds\n");
  for (const bool misled : {false, true}) {
    support::Random random(seed + (misled ? 1'000'000 : 0));
    std::map<double, Tally> tallies;
    for (std::uint64_t i = 0; i < scenes; ++i) {
      const Case scene = random_case(random, misled);
      judge(scene, each, tallies[scene.noise]);
    }
    for (const auto& [noise, tally] : tallies) row(misled ? "misled" : "sound", noise, tally);
  }
}
