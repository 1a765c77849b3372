// SPDX-License-Identifier: BSD-3-Clause
// Whether the 95 % intervals of identify_scene hold, and how often it is confidently wrong, over seeded random scenes:
// masses, clearance and restitution, one to four forces, sweeps up and down, either body, noise of 0 to 3 %.
//   symmetric  every point lies where the orbit of two equal impacts per period is stable
//   chaos      the bands reach from there into chaos or chatter
//   limit      the same with a restitution of 0, near 0 or near 1
//   starts     restitution 0.7 to 0.9, each point reached from a start of its own, which may lead to subharmonic orbits
//   misled     two to four forces, at one of which N is off by 5 to 20 %: no scene describes the data
// An estimate is stated where it is called identified, and held where its 95 % interval holds the truth.  Exact data
// leave rounding: an interval counts as 10^-6 of the value at least.  A scene is confidently wrong where something is
// stated, and each interval stated excludes the truth; far off where one of them misses it by more than twice its reach
// and 0.1 %.
// Prints two tables in Markdown: the coverage of each parameter over all kinds but misled, and the scenes.
// Usage: scene_identification_rates [--smoke] [--each] [scenes of each kind] [seed]; --each prints a line for each
// scene as well.
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <complex>
#include <cstdint>
#include <cstdio>
#include <map>
#include <string>
#include <vector>

#include "backlash/basins.hpp"
#include "backlash/identification/scene_identification.hpp"
#include "steady_state/two_impact_orbit.hpp"
#include "support/arguments.hpp"
#include "support/random.hpp"
#include "support/scene_tally.hpp"

namespace {

using backlash::MeasuredDescribingFunction;
using backlash::Output;
using Complex = std::complex<double>;

constexpr std::array<double, 4> noise_levels = {0, 0.001, 0.01, 0.03};
// Exact data leave rounding.
constexpr support::SceneAllowance allowance = {.rounding = 1e-6, .near = 1e-3};

enum class Kind { symmetric, chaos, limit, misled, starts };
constexpr std::array<const char*, 5> kind_names = {"symmetric", "chaos", "limit", "misled", "starts"};

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

double random_restitution(support::Random& random, Kind kind) {
  if (kind == Kind::starts) return random.uniform(0.7, 0.9);
  if (kind != Kind::limit) return random.uniform(0.05, 0.95);
  switch (random.below(3)) {
    case 0:
      return 0;
    case 1:
      return random.log_uniform(0.001, 0.03);
    default:
      return random.uniform(0.95, 0.99);
  }
}

// N at each frequency from a random start of its own.
std::vector<Complex> from_starts(const backlash::TwoMassSystem& system, double force, const std::vector<double>& omega,
                                 const backlash::SweepOptions& options, support::Random& random) {
  std::vector<Complex> value;
  for (const double w : omega) {
    const double position = random.unit() * system.clearance();
    const double velocity = random.uniform(-1, 1) * system.clearance() * w;
    value.push_back(backlash::basins(system, force, w, {position}, {velocity}, options).attractors.front().point.value);
  }
  return value;
}

Case random_case(support::Random& random, Kind kind) {
  const double mass1 = random.log_uniform(0.2, 5), mass2 = random.log_uniform(0.2, 5);
  const double clearance = random.log_uniform(0.01, 1);
  Case made{{mass1, mass2, clearance, random_restitution(random, kind)},
            noise_levels[random.below(noise_levels.size())],
            {},
            {}};
  made.options.threads = 1;
  // Rates with contacts that take time: contact_identification_rates.
  made.options.contact = backlash::ContactModel::hard;
  const std::size_t forces = kind == Kind::misled ? 2 + random.below(3) : 1 + random.below(4);
  // In units of sqrt(F/(mass2 clearance)).
  const double symmetric = 1 / std::sqrt(backlash::detail::symmetry_breaking_gamma(made.system.restitution()));
  const bool all_symmetric = kind == Kind::symmetric;
  const double lower = all_symmetric ? symmetric * random.log_uniform(1.02, 1.5) : random.log_uniform(0.3, 1.7);
  const double upper =
      all_symmetric ? lower * random.log_uniform(1.5, 4) : std::max(1.5 * lower, random.log_uniform(1.8, 3.5));
  const std::size_t points = 12 + random.below(29);
  // In rad/s, not relative to the unit: the greater forces then see less of the symmetric orbit.
  const bool one_band = random.unit() < 0.5 && !all_symmetric;
  const auto setting = random.below(4);
  made.options.output = setting < 2 ? Output::x1 : Output::x2;
  if (setting == 3) made.options.component = frac::Component::imaginary;
  // All that is needed for the others to have values.
  if (setting != 2) made.options.constraints.push_back({"mass1", made.system.mass1(), {}, {}, {}});
  backlash::SweepOptions sweep;
  sweep.output = made.options.output;
  constexpr std::array<backlash::Protocol, 3> protocols = {backlash::Protocol::sweep_up, backlash::Protocol::sweep_down,
                                                           backlash::Protocol::mid_gap_at_rest};
  const backlash::Protocol drawn = protocols[random.below(protocols.size())];
  sweep.protocol = all_symmetric ? backlash::Protocol::sweep_up : drawn;
  sweep.threads = 1;
  // Chaotic means are of no use to the identification, and long to compute.
  sweep.mean_tolerance = 0.01;
  const double first = random.log_uniform(1, 100);
  std::vector<double> amplitude = {first};
  while (amplitude.size() < forces) amplitude.push_back(first * random.log_uniform(0.4, 2.5));
  const std::size_t off = kind == Kind::misled ? random.below(forces) : forces;
  const double factor = 1 + (random.unit() < 0.5 ? -1 : 1) * random.uniform(0.05, 0.2);
  for (std::size_t i = 0; i < forces; ++i) {
    const double unit = std::sqrt((one_band ? first : amplitude[i]) / (made.system.mass2() * made.system.clearance()));
    const auto omega = log_grid(lower * unit, upper * unit, points);
    // Where the orbit is symmetric a mass at rest may be left there, so that it is led in from below.
    std::vector<double> led_in = all_symmetric ? log_grid(0.7 * unit, 0.99 * lower * unit, 8) : std::vector<double>{};
    const auto lead = static_cast<std::ptrdiff_t>(led_in.size());
    led_in.insert(led_in.end(), omega.begin(), omega.end());
    std::vector<Complex> value =
        kind == Kind::starts
            ? from_starts(made.system, amplitude[i], led_in, sweep, random)
            : backlash::describing_function_sweep(made.system, amplitude[i], led_in, sweep).data().value();
    value.erase(value.begin(), value.begin() + lead);
    for (Complex& z : value) {
      const double real = random.normal();
      z += made.noise * std::abs(z) * Complex(real, random.normal());
      if (i == off) z *= factor;
    }
    made.curves.push_back({{omega, value}, amplitude[i]});
  }
  return made;
}

using Tally = support::SceneTally;

void judge(const Case& scene, bool each, Tally& tally) {
  const auto begin = std::chrono::steady_clock::now();
  const auto result = backlash::identify_scene(scene.curves, scene.options);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  ++tally.scenes;
  tally.seconds += seconds;
  const support::SceneScore score(result, scene.system, allowance);
  tally.add(result, score);
  if (each) {
    std::printf("# %s x%d %s%zu forces noise %g: %zu of %zu points, %.2f s:%s | %s\n", score.word(),
                scene.options.output == Output::x1 ? 1 : 2,
                scene.options.component == frac::Component::imaginary ? "imaginary " : "", scene.curves.size(),
                scene.noise, result.points_used, result.points.size(), seconds, score.text.c_str(),
                result.message.c_str());
    std::fflush(stdout);
  }
}

void print_coverage(const std::map<double, Tally>& tallies) {
  std::printf("| noise | scenes |");
  Tally::print_names();
  std::printf("\n|---|---|---|---|---|---|---|---|\n");
  Tally all;
  const auto row = [](const std::string& name, const Tally& tally) {
    std::printf("| %s | %d |", name.c_str(), tally.scenes);
    tally.print_held();
    std::printf("\n");
  };
  for (const auto& [noise, tally] : tallies) {
    char text[16];
    std::snprintf(text, sizeof text, "%g %%", 100 * noise);
    row(text, tally);
    all += tally;
  }
  row("all", all);
}

void print_scenes(const std::map<Kind, Tally>& tallies) {
  std::printf(
      "| kind | scenes | nothing found | said not to fit | something identified | confidently wrong | one far off | "
      "parameters identified | s a scene |\n|---|---|---|---|---|---|---|---|---|\n");
  for (const auto& [kind, tally] : tallies) {
    std::printf("| %s | %d | %d | %d | %d | %d | %d | %d of %d | %.2g |\n", kind_names[static_cast<std::size_t>(kind)],
                tally.scenes, tally.unusable, tally.flagged, tally.answered, tally.wrong, tally.far_off,
                Tally::sum(tally.stated), Tally::sum(tally.free), tally.seconds / tally.scenes);
  }
}

}  // namespace

int main(int argc, char** argv) {
  const support::Arguments arguments(argc, argv);
  const std::uint64_t scenes = arguments.has("--smoke") ? 2 : arguments.number(0, 100);
  const std::uint64_t seed = arguments.number(1, 1);
  std::map<double, Tally> by_noise;
  std::map<Kind, Tally> by_kind;
  for (const Kind kind : {Kind::symmetric, Kind::chaos, Kind::limit, Kind::misled, Kind::starts}) {
    support::Random random(seed + 1'000'000 * static_cast<std::uint64_t>(kind));
    for (std::uint64_t i = 0; i < scenes; ++i) {
      const Case scene = random_case(random, kind);
      Tally tally;
      judge(scene, arguments.has("--each"), tally);
      by_kind[kind] += tally;
      if (kind != Kind::misled) by_noise[scene.noise] += tally;
    }
  }
  print_coverage(by_noise);
  std::printf("\n");
  print_scenes(by_kind);
}
