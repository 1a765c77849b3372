// SPDX-License-Identifier: BSD-3-Clause
// Whether the 95 % intervals of identify_scene hold where contacts have stiffness and damping, and how often it is
// confidently wrong: seeded random scenes of N of x1 or x2 at two or three forces, noise of 1 %, the time of a free
// contact a given share of the period of the band's middle at the first force (0: hard contacts).  Half of the bands
// lie where hard contacts have their symmetric orbit of two impacts, half reach below it. An estimate is stated where
// it is called identified, held where its interval holds the truth; a scene is confidently wrong where something is
// stated and each interval stated excludes the truth, far off where one of them misses it by more than twice its reach.
// With --friction the contact time is .003 of the period and one or both bodies have dry friction, each a given share
// of the least force; bands lie where hard contacts have their symmetric orbit, ten points at each of two forces.
// --none answers without friction, --estimate with it, else it is where the data ask. Usage:
// contact_identification_rates [--smoke] [--each] [--hard] [--friction [--none|--estimate]] [scenes of each time]
// [seed] [row, from 1 on; 0: all]; --hard takes contacts for hard ones.
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <cstdint>
#include <cstdio>
#include <ctime>
#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

#include "backlash/compliant/compliant_bodies.hpp"
#include "backlash/identification/scene_identification.hpp"
#include "backlash/jump_frequency.hpp"
#include "steady_state/two_impact_orbit.hpp"
#include "support/arguments.hpp"
#include "support/random.hpp"
#include "support/relative_error.hpp"
#include "support/scene_tally.hpp"

namespace {

using Complex = std::complex<double>;

constexpr std::array<double, 6> contact_shares = {0, 0.0003, 0.003, 0.01, 0.03, 0.1};
constexpr double noise = 0.01;
// Over the least force, and the contact time of these scenes.
constexpr std::array<double, 4> friction_shares = {0, 0.01, 0.05, 0.2};
constexpr double contact_share_with_friction = 0.003;

struct Case {
  backlash::TwoMassSystem system;
  double contact_time;
  backlash::CoulombFriction friction;
  std::vector<backlash::MeasuredDescribingFunction> curves;
  backlash::SceneIdentificationOptions options;
};

Case random_case(support::Random& random, double share, double friction, bool with_friction) {
  const double mass1 = random.log_uniform(0.2, 5), mass2 = random.log_uniform(0.2, 5);
  const double clearance = random.log_uniform(0.01, 1), restitution = random.uniform(0.15, 0.9);
  Case made{{mass1, mass2, clearance, restitution}, 0, {}, {}, {}};
  made.options.threads = 1;
  const bool is_symmetric = random.unit() < 0.5 || with_friction;
  // In units of sqrt(F/(mass2 clearance)).
  const double symmetric = 1 / std::sqrt(backlash::detail::symmetry_breaking_gamma(restitution));
  const double lower = symmetric * (is_symmetric ? random.log_uniform(1.02, 1.2) : random.log_uniform(0.4, 0.9));
  const double upper = symmetric * random.log_uniform(1.5, 2);
  const std::size_t forces = with_friction ? 2 : 2 + random.below(2),
                    points = with_friction ? 10 : 15 + random.below(16);
  made.options.output = random.unit() < 0.7 ? backlash::Output::x1 : backlash::Output::x2;
  if (made.options.output == backlash::Output::x1) made.options.constraints.push_back({"mass1", mass1, {}, {}, {}});
  backlash::SweepOptions sweep;
  sweep.output = made.options.output;
  sweep.threads = 1;
  sweep.mean_tolerance = 0.01;
  sweep.protocol = backlash::Protocol::sweep_up;
  const double first = random.log_uniform(1, 100);
  std::vector<double> amplitude = {first};
  while (amplitude.size() < forces) amplitude.push_back(first * random.log_uniform(0.4, 2.5));
  const double middle = std::sqrt(lower * upper * first / (mass2 * clearance));
  made.contact_time = share * 2 * std::numbers::pi / middle;
  if (friction > 0) {
    const double each = friction * *std::min_element(amplitude.begin(), amplitude.end());
    const std::size_t bodies = random.below(3);
    if (bodies != 1) made.friction.body1 = each;
    if (bodies != 0) made.friction.body2 = each;
  }
  for (const double force : amplitude) {
    const double unit = std::sqrt(force / (mass2 * clearance));
    const std::vector<double> omega = support::log_grid(lower * unit, upper * unit, static_cast<int>(points));
    std::vector<double> led_in = support::log_grid(0.6 * lower * unit, 0.99 * lower * unit, 8);
    const auto lead = static_cast<std::ptrdiff_t>(led_in.size());
    led_in.insert(led_in.end(), omega.begin(), omega.end());
    std::vector<Complex> value;
    if (share == 0) {
      value = backlash::describing_function_sweep(made.system, force, led_in, sweep).data().value();
    } else {
      const double ratio = backlash::damping_ratio_of_restitution(restitution);
      const double angle = backlash::free_contact(backlash::CompliantContact(1, 2 * ratio), 2, 2).duration;
      const auto contact = backlash::CompliantContact::from_frequency(angle / made.contact_time, ratio, mass1, mass2);
      const backlash::CompliantBodies bodies(backlash::free_mass(mass1), backlash::free_mass(mass2), clearance, contact,
                                             made.friction);
      value = backlash::bodies_describing_function(bodies, force, led_in, sweep).data().value();
    }
    value.erase(value.begin(), value.begin() + lead);
    for (Complex& z : value) {
      const double real = random.normal();
      z += noise * std::abs(z) * Complex(real, random.normal());
    }
    made.curves.push_back({{omega, value}, force});
  }
  return made;
}

struct Tally : support::SceneTally {
  int told = 0, time_stated = 0, time_held = 0, friction_stated = 0, friction_held = 0, friction_told = 0;
  std::vector<double> processor_seconds;
};

void judge(const Case& scene, bool each, Tally& tally) {
  const std::clock_t begin = std::clock();
  ++tally.scenes;
  backlash::SceneIdentification result;
  try {
    result = backlash::identify_scene(scene.curves, scene.options);
  } catch (const std::invalid_argument& refused) {
    // Friction that keeps the load at rest leaves too few points.
    if (each) std::printf("# refused: %s\n", refused.what());
    return;
  }
  tally.processor_seconds.push_back(static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC);
  tally.told += result.contact_verdict == backlash::ContactVerdict::compliant ? 1 : 0;
  support::SceneScore score(result, scene.system);
  if (!result.contact.empty() && score.answered && std::isfinite(result.contact[0].ci95_upper)) {
    ++tally.time_stated;
    tally.time_held += score.add(result.contact[0], scene.contact_time) ? 1 : 0;
  }
  const std::array<double, 2> friction = {scene.friction.body1, scene.friction.body2};
  for (std::size_t i = 0; i < result.friction.size(); ++i) {
    if (!score.answered || !std::isfinite(result.friction[i].ci95_upper)) continue;
    ++tally.friction_stated;
    tally.friction_held += score.add(result.friction[i], friction[i]) ? 1 : 0;
  }
  tally.friction_told += result.friction_verdict == backlash::FrictionVerdict::present ? 1 : 0;
  tally.add(result, score);
  if (each) {
    std::printf("# %s x%d %zu forces: %zu of %zu points, %.2f s:%s | %s\n", score.word(),
                scene.options.output == backlash::Output::x1 ? 1 : 2, scene.curves.size(), result.points_used,
                result.points.size(), tally.processor_seconds.back(), score.text.c_str(), result.message.c_str());
    std::fflush(stdout);
  }
}

}  // namespace

int main(int argc, char** argv) {
  const support::Arguments arguments(argc, argv);
  const bool with_friction = arguments.has("--friction");
  backlash::FrictionModel model = with_friction ? backlash::FrictionModel::automatic : backlash::FrictionModel::none;
  if (arguments.has("--none")) model = backlash::FrictionModel::none;
  if (arguments.has("--estimate")) model = backlash::FrictionModel::estimate;
  const std::uint64_t scenes = arguments.has("--smoke") ? 1 : arguments.number(0, 20);
  const std::uint64_t seed = arguments.number(1, 1);
  std::printf(
      "| %s | scenes | said not to fit | something identified | confidently wrong | one far off | "
      "intervals | coverage | contact time held | told from hard | friction held | told from none | processor s in the "
      "middle |\n"
      "|---|---|---|---|---|---|---|---|---|---|---|---|---|\n",
      with_friction ? "friction/force" : "contact time/period");
  std::vector<double> shares(contact_shares.begin(), contact_shares.end());
  if (with_friction) shares.assign(friction_shares.begin(), friction_shares.end());
  if (const std::uint64_t row = arguments.number(2, 0)) shares = {shares.at(row - 1)};
  for (const double share : shares) {
    support::Random random(seed + 1'000'000 * static_cast<std::uint64_t>(1e4 * share));
    Tally tally;
    for (std::uint64_t i = 0; i < scenes; ++i) {
      Case scene = with_friction ? random_case(random, contact_share_with_friction, share, true)
                                 : random_case(random, share, 0, false);
      scene.options.friction = model;
      if (arguments.has("--hard")) scene.options.contact = backlash::ContactModel::hard;
      judge(scene, arguments.has("--each"), tally);
    }
    std::sort(tally.processor_seconds.begin(), tally.processor_seconds.end());
    const int held = support::SceneTally::sum(tally.held), stated = support::SceneTally::sum(tally.stated);
    std::printf("| %g | %d | %d | %d | %d | %d | %d of %d | %.1f %% | %d of %d | %d | %d of %d | %d | %.2g |\n", share,
                tally.scenes, tally.flagged, tally.answered, tally.wrong, tally.far_off, held, stated,
                100.0 * held / std::max(1, stated), tally.time_held, tally.time_stated, tally.told, tally.friction_held,
                tally.friction_stated, tally.friction_told,
                tally.processor_seconds.empty() ? 0.0 : tally.processor_seconds[tally.processor_seconds.size() / 2]);
    std::fflush(stdout);
  }
}
