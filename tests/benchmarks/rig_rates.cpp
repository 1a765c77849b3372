// SPDX-License-Identifier: BSD-3-Clause
// The whole chain from a rig to a scene over seeded random scenes: two masses under a stepped sine of one or two
// forces, sensors with noise, steps and jitter, response(), identify_scene() weighed by the deviations it gives.
// Prints how often the 95 % intervals of N, clearance, restitution and masses hold the truth, and how often a segment
// that is not steady is said to be none.  N is compared with that of the exact motion over the last 12 cycles of a
// segment; where its first six and its last six differ by more than 0.1 % there is no N to hold.
// A scene is confidently wrong where something is stated, and each interval stated excludes the truth; far off where
// one of them misses it by more than twice its reach.  --hard: the contacts are known to be hard, as they are.
// --harmonics: the third and fifth harmonic join the fit.
// Usage: rig_rates [--smoke] [--each] [--hard] [--harmonics] [scenes] [seed]
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <complex>
#include <cstdint>
#include <cstdio>
#include <numbers>
#include <string>
#include <vector>

#include "backlash/identification/scene_identification.hpp"
#include "backlash/rig_record.hpp"
#include "frac/records/response.hpp"
#include "steady_state/two_impact_orbit.hpp"
#include "support/arguments.hpp"
#include "support/random.hpp"
#include "support/scene_tally.hpp"

namespace {

using backlash::Output;
using Complex = std::complex<double>;
using std::numbers::pi;

struct Case {
  backlash::TwoMassSystem system;
  Output body;
  std::vector<double> forces;
  std::vector<double> omega;  // of the first force; of another one in proportion to its root
  int periods;
  backlash::RigSensors sensors;  // of which the sample time is that of the first force
  backlash::SceneIdentificationOptions options;
};

Case random_case(support::Random& random) {
  Case made{
      {random.log_uniform(0.2, 5), random.log_uniform(0.2, 5), random.log_uniform(0.01, 1), random.uniform(0.05, 0.95)},
      random.below(2) == 0 ? Output::x1 : Output::x2,
      {random.log_uniform(1, 100)},
      {},
      30 + static_cast<int>(random.below(31)),
      {},
      {}};
  if (random.below(2) == 0) made.forces.push_back(made.forces[0] * random.log_uniform(0.4, 2.5));
  const double clearance = made.system.clearance();
  const double unit = std::sqrt(made.forces[0] / (made.system.mass2() * clearance));
  // From somewhat below the frequencies of the symmetric orbit to well above.
  const double lower = unit / std::sqrt(backlash::detail::symmetry_breaking_gamma(made.system.restitution())) *
                       random.log_uniform(0.8, 1.3);
  const double upper = lower * random.log_uniform(1.5, 3);
  const std::size_t count = 8 + random.below(9);
  for (std::size_t i = 0; i < count; ++i)
    made.omega.push_back(lower * std::pow(upper / lower, static_cast<double>(i) / static_cast<double>(count - 1)));
  made.sensors.sample_time = 2 * pi / upper / random.uniform(50, 150);
  made.sensors.position.noise = random.log_uniform(0.001, 0.02) * clearance;
  made.sensors.position.quantisation = random.uniform(0, 1) * made.sensors.position.noise;
  made.sensors.force.noise = random.log_uniform(1e-4, 1e-2) * made.forces[0];
  made.sensors.clock_jitter = random.below(2) == 0 ? 0 : random.uniform(0, 0.02) * made.sensors.sample_time;
  made.options.output = made.body;
  made.options.weight = frac::Weight::given;
  made.options.sigma_is_measured = true;
  made.options.threads = 1;
  if (random.below(4) > 0) made.options.constraints.push_back({"mass1", made.system.mass1(), {}, {}, {}});
  return made;
}

/// N of a motion over cycles that end `back` cycles before `end`.
Complex cycles_of(const frac::SignalPath& path, double force, double omega, double end, int back, int cycles) {
  constexpr int steps = 500;
  const double period = 2 * pi / omega;
  std::vector<double> times;
  for (int i = 0; i < cycles * steps; ++i) times.push_back(end - period * (back + cycles - (i + 0.5) / steps));
  const auto values = frac::sensor_readings(path, times, {}, 1);
  Complex sum = 0;
  for (std::size_t i = 0; i < times.size(); ++i)
    sum += values[i] * std::polar(2.0 / static_cast<double>(times.size()), omega * (end - times[i]));
  return sum / force;
}

struct Tally : support::SceneTally {
  int steady = 0, steady_said = 0, steady_held = 0, unsteady = 0, unsteady_said = 0, missing = 0;
};

/// The curve of one force, and those of its harmonics; counts what is said of its segments.
std::vector<backlash::MeasuredDescribingFunction> measured(const Case& made, std::size_t which, std::uint64_t seed,
                                                           bool with_harmonics, Tally& tally) {
  const double scale = std::sqrt(made.forces[which] / made.forces[0]);
  std::vector<double> omega = made.omega;
  for (double& w : omega) w *= scale;
  backlash::RigSensors sensors = made.sensors;
  sensors.sample_time /= scale;
  sensors.clock_jitter /= scale;
  sensors.seed = seed;
  const double force = made.forces[which];
  const auto motion = backlash::rig_motion(made.system, force, omega, {made.system.clearance() / 2, 0}, made.periods);
  const auto record = backlash::rig_record(motion, sensors);
  const bool is_x1 = made.body == Output::x1;
  const auto& path = is_x1 ? motion.x1 : motion.x2;
  const auto found = frac::response({frac::Record(sensors.sample_time, record.force, {is_x1 ? record.x1 : record.x2})});
  struct Curve {
    std::vector<double> omega, sigma;
    std::vector<Complex> value;
  };
  Curve fundamental, third, fifth;
  double end = 0;
  for (const double w : omega) {
    end += made.periods * 2 * pi / w;
    const auto& points = found.outputs[0];
    const auto point =
        std::find_if(points.begin(), points.end(), [&](const auto& p) { return std::abs(p.omega / w - 1) < 1e-3; });
    if (point == points.end()) {
      ++tally.missing;
      continue;
    }
    const Complex early = cycles_of(path, force, w, end, 6, 6), late = cycles_of(path, force, w, end, 0, 6);
    const bool is_steady = std::abs(early - late) < 1e-3 * std::abs(late), is_said = !point->flag.empty();
    ++(is_steady ? tally.steady : tally.unsteady);
    if (is_said) {
      ++(is_steady ? tally.steady_said : tally.unsteady_said);
      continue;
    }
    if (is_steady) {
      const Complex error = point->value - 0.5 * (early + late);
      tally.steady_held += std::abs(error.real()) < point->half_width_re() ? 1 : 0;
      tally.steady_held += std::abs(error.imag()) < point->half_width_im() ? 1 : 0;
    }
    const auto add = [&](Curve& curve, Complex value, double sigma) {
      curve.omega.push_back(point->omega);
      curve.value.push_back(value);
      curve.sigma.push_back(sigma);
    };
    add(fundamental, point->value, point->sigma_or_rounding());
    for (const auto& harmonic : point->harmonics)
      if (harmonic.order == 3 || harmonic.order == 5)
        add(harmonic.order == 3 ? third : fifth, harmonic.value, harmonic.sigma);
  }
  if (fundamental.omega.size() < 2) return {};
  const auto curve = [&](const Curve& of, int harmonic) {
    return backlash::MeasuredDescribingFunction{{of.omega, of.value, of.sigma}, force, harmonic};
  };
  if (!with_harmonics) return {curve(fundamental, 1)};
  return {curve(fundamental, 1), curve(third, 3), curve(fifth, 5)};
}

void judge(const Case& made, std::uint64_t seed, bool each, bool with_harmonics, Tally& tally) {
  const auto begin = std::chrono::steady_clock::now();
  ++tally.scenes;
  std::vector<backlash::MeasuredDescribingFunction> curves;
  for (std::size_t i = 0; i < made.forces.size(); ++i)
    for (auto& curve : measured(made, i, seed + 10 * i, with_harmonics, tally)) curves.push_back(std::move(curve));
  if (curves.empty()) {
    ++tally.unusable;
    return;
  }
  const auto result = backlash::identify_scene(curves, made.options);
  const support::SceneScore score(result, made.system);
  tally.add(result, score);
  tally.seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  if (!each) return;
  std::printf("# %s %s %zu forces, noise %.2g of the gap: %zu of %zu points:%s | %s\n", score.word(),
              std::string(to_string(made.body)).c_str(), made.forces.size(),
              made.sensors.position.noise / made.system.clearance(), result.points_used, result.points.size(),
              score.text.c_str(), result.message.c_str());
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  const support::Arguments arguments(argc, argv);
  const std::uint64_t scenes = arguments.has("--smoke") ? 2 : arguments.number(0, 40);
  const std::uint64_t seed = arguments.number(1, 1);
  Tally tally;
  for (std::uint64_t i = 0; i < scenes; ++i) {
    support::Random random(1'000'000 * seed + i);
    Case made = random_case(random);
    if (arguments.has("--hard")) made.options.contact = backlash::ContactModel::hard;
    judge(made, 1000 * (1'000'000 * seed + i), arguments.has("--each"), arguments.has("--harmonics"), tally);
  }
  std::printf("| segments | number | said not to be steady | intervals of N that hold |\n|---|---|---|---|\n");
  std::printf("| steady | %d | %d | %.1f %% of %d |\n", tally.steady, tally.steady_said,
              100.0 * tally.steady_held / std::max(1, 2 * (tally.steady - tally.steady_said)),
              2 * (tally.steady - tally.steady_said));
  std::printf("| not steady | %d | %d | |\n| not found | %d | | |\n\n", tally.unsteady, tally.unsteady_said,
              tally.missing);
  std::printf("| scenes |");
  support::SceneTally::print_names();
  std::printf(
      " said not to fit | confidently wrong | one far off | nothing | s a scene |\n"
      "|---|---|---|---|---|---|---|---|---|---|---|---|\n| %d |",
      tally.scenes);
  tally.print_held();
  std::printf(" %d | %d of %d | %d | %d | %.2g |\n", tally.flagged, tally.wrong, tally.answered, tally.far_off,
              tally.unusable, tally.seconds / std::max(1, tally.scenes));
}
