// SPDX-License-Identifier: BSD-3-Clause
#include "output/limit_cycles_output.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>

#include "backlash/loops/describe.hpp"
#include "io/number.hpp"
#include "output/aligned_table.hpp"
#include "output/described.hpp"
#include "output/document.hpp"
#include "output/json.hpp"

namespace fracfit {
namespace {

// The prediction of the same kind nearest in frequency, within a factor of two; nullptr where there is none.
const backlash::PredictedCycle* prediction_of(const LoopCycles& loop, double omega, bool symmetric, int impacts) {
  const backlash::PredictedCycle* nearest = nullptr;
  double smallest = std::log(2);
  for (const backlash::PredictedCycle& predicted : loop.predicted) {
    const double distance = std::abs(std::log(predicted.omega / predicted.period / omega));
    if (predicted.symmetric == symmetric && predicted.impacts == impacts && distance < smallest) {
      smallest = distance;
      nearest = &predicted;
    }
  }
  return nearest;
}

double frequency_of(const backlash::ImpactCycle& cycle) {
  return 2 * std::numbers::pi / cycle.period;
}

// "4 impacts", or "2 rests".
std::string pattern_of(const backlash::ImpactCycle& cycle) {
  const auto plural = [](std::size_t count, const char* what) {
    return std::to_string(count) + " " + what + (count == 1 ? "" : "s");
  };
  return cycle.rests.empty() ? plural(cycle.impacts.size(), "impact") : plural(cycle.rests.size(), "rest");
}

// What all outputs say of a cycle, however it was found.
struct ListedCycle {
  double omega;
  bool symmetric;
  std::size_t impacts;  // per period
  bool admissible;
  const std::string& reason;
  const backlash::CycleStability& stability;
  const char* multiplier_per;
  double impulse, impact_speed;
  const std::vector<backlash::CycleHarmonic>& harmonics;
  const backlash::PredictedCycle* predicted;
  const backlash::ImpactCycle* further;  // nullptr where it is symmetric with two impacts

  [[nodiscard]] double amplitude_x1() const { return std::abs(harmonics.front().x1); }
  [[nodiscard]] double amplitude_x2() const { return std::abs(harmonics.front().x2); }
  [[nodiscard]] double amplitude_force() const { return std::abs(harmonics.front().force); }
  [[nodiscard]] std::optional<std::size_t> impacts_per_period() const {
    return further == nullptr || !has_chatter(*further) ? std::optional(impacts) : std::nullopt;
  }
  [[nodiscard]] double multiplier_modulus() const { return std::abs(stability.dominant); }
};

// The symmetric cycles with two impacts, and then those that motions settle on and that are not among these.
std::vector<ListedCycle> listed_cycles(const LoopCycles& loop) {
  std::vector<ListedCycle> listed;
  for (const backlash::SymmetricCycle& cycle : loop.exact.cycles) {
    listed.push_back({cycle.omega, true, 2, cycle.admissible, cycle.reason, cycle.stability, "half-period",
                      cycle.impulse, cycle.impact_speed, cycle.harmonics, prediction_of(loop, cycle.omega, true, 2),
                      nullptr});
  }
  for (const backlash::ImpactCycle* cycle : backlash::further_cycles(loop.settled.cycles, loop.exact.cycles)) {
    const double omega = frequency_of(*cycle);
    listed.push_back({omega, cycle->symmetric, cycle->impacts.size(), cycle->admissible, cycle->reason,
                      cycle->stability, "period", cycle->impacts.front().impulse, cycle->impacts.front().speed,
                      cycle->harmonics,
                      prediction_of(loop, omega, cycle->symmetric, static_cast<int>(cycle->impacts.size())), cycle});
  }
  return listed;
}

std::vector<const ListedCycle*> by_frequency(const std::vector<ListedCycle>& listed) {
  std::vector<const ListedCycle*> sorted;
  for (const ListedCycle& cycle : listed) sorted.push_back(&cycle);
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](const ListedCycle* a, const ListedCycle* b) { return a->omega < b->omega; });
  return sorted;
}

// What the describing function says of the cycle; null where it says nothing.
Json comparison_json(const ListedCycle& cycle) {
  if (cycle.predicted == nullptr) return {};
  const backlash::PredictedCycle& predicted = *cycle.predicted;
  Json json{{"omega", predicted.omega},
            {"force", predicted.force_amplitude},
            {"relative_error_omega", predicted.omega / predicted.period / cycle.omega - 1},
            {"relative_error_force", predicted.force_amplitude / cycle.amplitude_force() - 1}};
  json.update(json_of(predicted));
  return json;
}

template <frac::ResultOf<ListedCycle> Result, class Visit>
void describe(Result& cycle, const Visit& visit) {
  const backlash::CycleStability& stability = cycle.stability;
  visit("omega", "rad/s", "angular frequency, exact", cycle.omega);
  visit("symmetric", "", "the second half is the mirror image of the first", cycle.symmetric);
  visit("impacts_per_period", "1", "none where they have no count", cycle.impacts_per_period());
  visit("admissible", "", "the masses stay off the walls between the impacts", cycle.admissible);
  visit("reason", "", "why it is no motion, where it is none",
        cycle.admissible ? std::nullopt : std::optional(cycle.reason));
  visit("stable", "", "disturbances die out", stability.stable);
  visit("multiplier_modulus", "1", "of the largest multiplier", cycle.multiplier_modulus());
  visit("multiplier_per", "", "period or half-period", std::string(cycle.multiplier_per));
  visit("multiplier", "1", "largest", stability.dominant);
  visit("unstable_multipliers", "1", "their number", stability.unstable_multipliers);
  visit("loss", "", "how stability is lost", stability.loss);
  visit("impulse", "N s", "of the first impact", cycle.impulse);
  visit("impact_speed", "m/s", "of the first impact", cycle.impact_speed);
  visit("amplitude_x1", "m", "peak of the fundamental of mass 1", cycle.amplitude_x1());
  visit("amplitude_x2", "m", "peak of the fundamental of mass 2", cycle.amplitude_x2());
  visit("amplitude_force", "N", "peak of the fundamental of the force", cycle.amplitude_force());
  visit("harmonics", "", "harmonics of the motion, see cycle-harmonic", cycle.harmonics);
}

Json cycle_json(const ListedCycle& cycle) {
  Json json = json_of(cycle);
  json["describing_function"] = comparison_json(cycle);
  if (cycle.further == nullptr) return json;
  json.update({{"period", cycle.further->period},
               {"middle", cycle.further->middle},
               {"error", cycle.further->error},
               {"impacts", json_of(cycle.further->impacts)},
               {"rests_per_period", cycle.further->rests.size()},
               {"rests", json_of(cycle.further->rests)}});
  return json;
}

Json motions_json(const LoopCycles& loop) {
  Json motions = Json::array();
  for (const backlash::LoopMotion& motion : loop.settled.motions) {
    const bool has_exponent = std::isfinite(motion.lyapunov_exponent);
    motions.push_back({{"velocity1", motion.start.v1},
                       {"velocity2", motion.start.v2},
                       {"regime", backlash::to_string(motion.regime)},
                       {"omega", motion.cycle ? Json(frequency_of(loop.settled.cycles[*motion.cycle])) : Json()},
                       {"lyapunov_exponent", has_exponent ? Json(motion.lyapunov_exponent) : Json()}});
  }
  return motions;
}

ListedCycle listed_cycle(const backlash::CompliantCycle& cycle, const std::string& no_reason) {
  return {cycle.omega,
          cycle.symmetric,
          static_cast<std::size_t>(cycle.contacts),
          true,
          no_reason,
          cycle.stability,
          cycle.symmetric ? "half-period" : "period",
          cycle.impulse,
          cycle.impact_speed,
          cycle.harmonics,
          nullptr,
          nullptr};
}

Json cycle_json(const backlash::CompliantCycle& cycle) {
  const std::string no_reason;
  const ListedCycle listed = listed_cycle(cycle, no_reason);
  Json json = json_of(listed);
  json.update(
      {{"sticks_per_period", cycle.sticks},
       {"error", cycle.error},
       {"start", {{"x1", cycle.start.x1}, {"v1", cycle.start.v1}, {"x2", cycle.start.x2}, {"v2", cycle.start.v2}}}});
  json["describing_function"] = Json();
  if (!cycle.predicted) return json;
  json["describing_function"] = {
      {"omega", cycle.predicted->omega},
      {"force", cycle.predicted->force_amplitude},
      {"relative_error_omega", cycle.predicted->omega / cycle.omega - 1},
      {"relative_error_force", cycle.predicted->force_amplitude / listed.amplitude_force() - 1},
      {"stable", cycle.predicted->stable}};
  return json;
}

/// Where dry friction can hold the loop, if anywhere in particular.
std::optional<backlash::RestRange> rests_of(const backlash::CompliantLoop& loop) {
  const backlash::CoulombFriction& friction = loop.bodies().friction();
  if (friction.body1 == 0 && friction.body2 == 0) return std::nullopt;
  const backlash::RestRange range = backlash::rest_range(loop, 0);
  if (!std::isfinite(range.from) || !std::isfinite(range.to)) return std::nullopt;
  return range;
}

// "1 of 3 starts: ...", of motions that settle on no cycle.
std::string motions_text(const std::vector<backlash::CompliantMotion>& motions) {
  std::string text;
  for (const auto& [regime, what] : {std::pair{backlash::LoopRegime::quiet, "the bodies meet no more."},
                                     std::pair{backlash::LoopRegime::irregular, "no cycle of up to 24 meetings."},
                                     std::pair{backlash::LoopRegime::diverged, "the motion grows without bound."}}) {
    const auto count = std::count_if(motions.begin(), motions.end(),
                                     [regime = regime](const auto& motion) { return motion.regime == regime; });
    if (count > 0)
      text += paragraph(std::to_string(count) + " of " + std::to_string(motions.size()) + " starts: " + what, 2);
  }
  const auto outside = std::count_if(motions.begin(), motions.end(), [](const auto& motion) {
    return motion.regime == backlash::LoopRegime::cycle && !motion.cycle;
  });
  if (outside > 0)
    text += paragraph(std::to_string(outside) + " of " + std::to_string(motions.size()) +
                          " starts: a cycle outside the range of --omega.",
                      2);
  return text;
}

Json loop_json(const CompliantLoopCycles& loop) {
  const backlash::CompliantBodies& bodies = loop.loop.bodies();
  Json json = Json::object();
  json["scene"] = {{"controller", loop.loop.controller().formula()},
                   {"body", backlash::to_string(loop.loop.measured())},
                   {"mass1_kg", bodies.system().mass1()},
                   {"mass2_kg", bodies.system().mass2()},
                   {"clearance_m", bodies.system().clearance()}};
  json["scene"].update(object_of(loop.contact));
  if (!bodies.hard().are_free()) {
    json["scene"]["load_receptance"] = bodies.hard().load().formula();
    json["scene"]["drive_receptance"] = bodies.hard().drive().formula();
  }
  json["rigid_loop"] = {{"stability", frac::to_string(loop.rigid.stability)},
                        {"unstable_poles", loop.rigid.unstable_poles}};
  const auto rests = rests_of(loop.loop);
  json["rests"] = rests ? Json({{"from", rests->from}, {"to", rests->to}}) : Json();
  Json& cycles = json["cycles"] = Json::array();
  for (const backlash::CompliantCycle& cycle : loop.found.cycles) cycles.push_back(cycle_json(cycle));
  Json& motions = json["motions"] = Json::array();
  for (const backlash::CompliantMotion& motion : loop.found.motions)
    motions.push_back({{"velocity1", motion.start.v1},
                       {"velocity2", motion.start.v2},
                       {"regime", backlash::to_string(motion.regime)},
                       {"omega", motion.cycle ? Json(loop.found.cycles[*motion.cycle].omega) : Json()}});
  return json;
}

Json loop_json(const LoopCycles& loop) {
  const backlash::TwoMassSystem& system = loop.loop.system();
  Json json = Json::object();
  json["scene"] = {{"controller", loop.loop.controller().formula()},
                   {"body", backlash::to_string(loop.loop.measured())},
                   {"mass1_kg", system.mass1()},
                   {"mass2_kg", system.mass2()},
                   {"clearance_m", system.clearance()},
                   {"restitution", system.restitution()}};
  if (!loop.loop.bodies().are_free()) {
    json["scene"]["load_receptance"] = loop.loop.bodies().load().formula();
    json["scene"]["drive_receptance"] = loop.loop.bodies().drive().formula();
  }
  json["rigid_loop"] = {{"stability", frac::to_string(loop.rigid.stability)},
                        {"unstable_poles", loop.rigid.unstable_poles}};
  json["searched"] = {{"from", loop.exact.searched.from},
                      {"to", loop.exact.searched.to},
                      {"certain", loop.exact.certain},
                      {"any_frequency", loop.exact.any_frequency}};
  const std::vector<ListedCycle> listed = listed_cycles(loop);
  Json& cycles = json["cycles"] = Json::array();
  for (const ListedCycle* cycle : by_frequency(listed)) cycles.push_back(cycle_json(*cycle));
  if (!loop.settled.motions.empty()) json["motions"] = motions_json(loop);
  json["predictions"] = json_of(loop.predicted);
  return json;
}

Json events_json(const std::vector<backlash::CycleEvent>& events) {
  Json list = Json::array();
  for (const backlash::CycleEvent& event : events) {
    list.push_back({{"kind", backlash::to_string(event.kind)},
                    {"value", event.parameter},
                    {"omega", event.omega},
                    {"admissible", event.is_admissible},
                    {"reason", event.reason.empty() ? Json() : Json(event.reason)}});
  }
  return list;
}

Json events_json(const backlash::CycleContinuation& followed) {
  Json json = Json::object();
  json["events"] = events_json(followed.events);
  const auto intervals = [](const std::vector<backlash::ParameterInterval>& all) {
    Json list = Json::array();
    for (const backlash::ParameterInterval& each : all) list.push_back({each.from, each.to});
    return list;
  };
  Json& branches = json["branches"] = Json::array();
  for (const backlash::CycleBranch& branch : followed.branches) {
    Json samples = Json::array();
    for (const backlash::CycleBranch::Sample& sample : branch.samples) {
      samples.push_back(
          {{"value", sample.parameter},
           {"omega", frequency_of(sample.cycle)},
           {"stable", sample.cycle.stability.stable},
           {"multiplier_modulus", std::abs(sample.cycle.stability.dominant)},
           {"second_impact",
            sample.cycle.impacts.size() > 1 ? Json(sample.cycle.impacts[1].time / sample.cycle.period) : Json()},
           {"impact_speed", sample.cycle.impacts.front().speed},
           {"middle", sample.cycle.middle}});
    }
    branches.push_back({{"born_at", branch.born_at},
                        {"samples", std::move(samples)},
                        {"events", events_json(branch.events)},
                        {"admissible", intervals(branch.admissible)},
                        {"stable", intervals(branch.stable)}});
  }
  json["without_cycles"] = intervals(followed.without_cycles);
  json["without_stable_cycles"] = intervals(followed.without_stable_cycles);
  json["simulated_at"] = followed.simulated;
  return json;
}

std::string events_text(const std::string& name, const backlash::CycleContinuation& followed) {
  std::string text;
  const auto precise = [](double value) { return io::format_number(std::round(value * 1e10) / 1e10); };
  for (const backlash::CycleEvent& event : followed.events) {
    if (!event.is_admissible) continue;
    std::string line = name + " = " + precise(event.parameter) + ", omega " + short_number(event.omega) + ": " +
                       std::string(backlash::to_string(event.kind));
    if (!event.reason.empty()) line += "; beyond it " + event.reason;
    text += paragraph(line + ".", 2);
  }
  for (const backlash::CycleBranch& branch : followed.branches) {
    std::string manner;
    for (const backlash::ParameterInterval& each : branch.stable) {
      manner += (manner.empty() ? ", stable from " : " and from ") + precise(each.from) + " to " + precise(each.to);
    }
    if (manner.empty()) manner = ", nowhere stable";
    const backlash::ImpactCycle& first = branch.samples.front().cycle;
    const std::string which = first.symmetric ? "a symmetric cycle" : "an asymmetric cycle";
    if (std::isnan(branch.born_at)) {
      const std::string motion = branch.admissible.empty()
                                     ? ", stable at " + name + " = " + precise(branch.samples.front().parameter)
                                     : ", a motion from " + name + " = " + precise(branch.admissible.front().from) +
                                           " to " + precise(branch.admissible.front().to) + " at least" + manner;
      std::string line = "Found by simulation: " + which + " of " + pattern_of(first) + motion;
      for (const backlash::CycleEvent& event : branch.events) {
        if (event.kind == backlash::CycleEventKind::fold) line += "; it turns back at " + precise(event.parameter);
      }
      text += paragraph(line + ".", 2);
      continue;
    }
    std::string line = "From " + name + " = " + precise(branch.born_at) + " " + which;
    if (!first.rests.empty() || first.impacts.size() != 2) line += " of " + pattern_of(first);
    bool has_end = false;
    for (const backlash::CycleEvent& event : branch.events) {
      const std::string kind(backlash::to_string(event.kind));
      has_end = event.kind == backlash::CycleEventKind::admissibility || event.kind == backlash::CycleEventKind::fold;
      line += has_end ? " goes on to " + precise(event.parameter) + " (" + kind + ")"
                      : ", " + kind + " at " + precise(event.parameter) + ",";
    }
    if (!has_end) {
      const double low = branch.admissible.front().from, high = branch.admissible.back().to;
      const double farther = high - branch.born_at > branch.born_at - low ? high : low;
      line += " goes on to " + precise(farther) + " at least";
    }
    text += paragraph(line + manner + ".", 2);
  }
  const auto intervals = [&](const std::vector<backlash::ParameterInterval>& all, const std::string& what) {
    if (all.empty()) return;
    std::string list;
    for (const backlash::ParameterInterval& each : all)
      list += (list.empty() ? "" : ", ") + precise(each.from) + " to " + precise(each.to);
    text += paragraph("No " + what + " for " + name + " from " + list + ".");
  };
  intervals(followed.without_cycles, "cycle");
  intervals(followed.without_stable_cycles, "stable cycle");
  if (followed.without_stable_cycles.empty()) {
    text += paragraph("A stable cycle for every " + name + " from " + precise(followed.samples.front().parameter) +
                      " to " + precise(followed.samples.back().parameter) + ".");
  } else {
    std::string searched =
        "Looked for were all symmetric cycles of two impacts per period and the asymmetric ones that begin where those "
        "break their symmetry";
    if (!followed.simulated.empty()) {
      searched +=
          "; where none of them is stable, cycles of up to twelve impacts or rests that simulated motions settle on, "
          "at " +
          std::to_string(followed.simulated.size()) + (followed.simulated.size() == 1 ? " value" : " values");
    }
    searched += followed.simulated.empty() ? ". Cycles of more impacts or with rests in contact are not among them; "
                                             "--starts looks for them."
                                           : ".";
    text += paragraph(searched);
  }
  return text;
}

// What the motions come to that settle on no cycle.
std::string motions_text(const LoopCycles& loop) {
  using backlash::LoopRegime;
  int quiet = 0, irregular = 0, diverged = 0;
  bool is_chaotic = false;
  double exponent = -std::numeric_limits<double>::infinity();
  for (const backlash::LoopMotion& motion : loop.settled.motions) {
    quiet += motion.regime == LoopRegime::quiet;
    irregular += motion.regime == LoopRegime::irregular;
    diverged += motion.regime == LoopRegime::diverged;
    if (motion.lyapunov_exponent > exponent) exponent = motion.lyapunov_exponent;
    is_chaotic = is_chaotic || motion.chaotic;
  }
  const auto starts = [&](int count) {
    return std::to_string(count) + " of " + std::to_string(loop.settled.motions.size()) + " starts: ";
  };
  std::string text;
  if (quiet > 0) {
    const bool is_late = loop.loop.controller().delay() > 0;
    text += paragraph(starts(quiet) + "the impacts cease" +
                          (is_late ? ", or the masses rest in contact, which is not followed with dead time." : "."),
                      2);
  }
  if (irregular > 0) {
    std::string sentence = starts(irregular) + "no cycle of up to twelve impacts or rests in contact";
    if (std::isfinite(exponent)) {
      sentence += ", Lyapunov exponent " + short_number(exponent, 3) + " 1/s" + (is_chaotic ? " (chaotic)" : "");
    }
    text += paragraph(sentence + ".", 2);
  }
  if (diverged > 0) text += paragraph(starts(diverged) + "the motion grows without bound.", 2);
  return text;
}

// Cycles that the describing function predicts and the table has not.
std::string unmatched_text(const LoopCycles& loop, const std::vector<ListedCycle>& listed) {
  std::string text;
  for (const backlash::PredictedCycle& predicted : loop.predicted) {
    const bool is_matched = std::any_of(listed.begin(), listed.end(),
                                        [&](const ListedCycle& cycle) { return cycle.predicted == &predicted; });
    if (!predicted.admissible || is_matched) continue;
    text +=
        paragraph("The describing function also predicts omega " + short_number(predicted.omega / predicted.period) +
                      ", force " + short_number(predicted.force_amplitude) + ": " +
                      (predicted.stable ? "stable" : "unstable") + ", " + std::to_string(predicted.impacts) +
                      " impacts per period, " + (predicted.symmetric ? "symmetric" : "asymmetric") + ".",
                  2);
  }
  return text;
}

std::string motion_of(const ListedCycle& cycle) {
  if (cycle.further != nullptr) return pattern_of(*cycle.further);
  if (!cycle.admissible) return "no motion";
  return cycle.stability.stable ? "stable" : "unstable";
}

std::string percent(double value) {
  return (value > 0 ? "+" : "") + io::format_number(std::round(1000 * value) / 10) + " %";
}

std::vector<std::string> row_of(const ListedCycle& cycle, const LoopCycles& loop) {
  std::vector<std::string> row;
  for (const auto& [name, value] : loop.varied) row.push_back(short_number(io::parse_number(value).value_or(NAN)));
  row.push_back(short_number(cycle.omega));
  row.push_back(motion_of(cycle));
  for (const double value : {cycle.multiplier_modulus(), cycle.impact_speed, cycle.amplitude_x1(), cycle.amplitude_x2(),
                             cycle.amplitude_force()})
    row.push_back(short_number(value));
  const backlash::PredictedCycle* predicted = cycle.predicted;
  row.push_back(predicted ? short_number(predicted->omega) : "-");
  row.push_back(predicted ? percent(predicted->omega / predicted->period / cycle.omega - 1) : "-");
  return row;
}

bool is_unstable(const ListedCycle& cycle) {
  return cycle.admissible && !cycle.stability.stable;
}

/// @param alone  the table has no other loop, so that there is room for each of its cycles
std::string remark_on(const ListedCycle& cycle, bool alone) {
  const std::string at = "omega " + short_number(cycle.omega) + ": ";
  if (cycle.further != nullptr) {
    return paragraph(at + "stable, " + pattern_of(*cycle.further) +
                         (cycle.further->rests.empty() ? "" : " in contact") + " per period, " +
                         (cycle.symmetric ? "symmetric" : "asymmetric, its mirror image is another one") +
                         "; |z| is that of the period, the speed that of the hardest impact.",
                     2);
  }
  if (!alone) return {};
  if (!cycle.admissible) return paragraph(at + cycle.reason + ".", 2);
  if (cycle.stability.stable) return {};
  return paragraph(at + "unstable by " + std::string(backlash::to_string(cycle.stability.loss)) + ".", 2);
}

}  // namespace

std::vector<frac::NumberDescription> described_limit_cycle(bool flat) {
  const std::string reason;
  const backlash::CycleStability stability{};
  const std::vector<backlash::CycleHarmonic> harmonics(1);
  return frac::described_numbers(
      flat, ListedCycle{0, false, 0, false, reason, stability, "", 0, 0, harmonics, nullptr, nullptr});
}

// A rest begins with no impact then, or with the last one that was followed.
bool has_chatter(const backlash::ImpactCycle& cycle) {
  return std::any_of(cycle.rests.begin(), cycle.rests.end(), [&](const auto& rest) {
    return std::none_of(cycle.impacts.begin(), cycle.impacts.end(), [&](const auto& impact) {
      return std::abs(impact.time - rest.time) < 1e-12 * cycle.period &&
             impact.speed > 1e-6 * cycle.impacts.front().speed;
    });
  });
}

std::string limit_cycles_json(const std::vector<LoopCycles>& loops, const backlash::CycleContinuation* followed,
                              const std::string& command) {
  Json json = origin(command);
  if (loops.size() == 1 && loops.front().varied.empty()) {
    json.update(loop_json(loops.front()));
    return json.dump(1) + "\n";
  }
  Json& all = json["loops"] = Json::array();
  for (const LoopCycles& loop : loops) {
    Json each = Json::object();
    each["varied"] = object_of(loop.varied);
    each.update(loop_json(loop));
    all.push_back(std::move(each));
  }
  if (followed) json.update(events_json(*followed));
  return json.dump(1) + "\n";
}

std::string limit_cycles_csv(const std::vector<LoopCycles>& loops, const std::string& command) {
  std::vector<std::vector<ListedCycle>> listed;
  std::vector<std::pair<const LoopCycles*, const ListedCycle*>> rows;
  for (const LoopCycles& loop : loops) listed.push_back(listed_cycles(loop));
  for (std::size_t i = 0; i < loops.size(); ++i)
    for (const ListedCycle* cycle : by_frequency(listed[i])) rows.emplace_back(&loops[i], cycle);
  std::vector<std::string> columns;
  for (const auto& [name, value] : loops.front().varied) columns.push_back(name);
  for (const char* column :
       {"omega_rad_s", "symmetric", "impacts_per_period", "admissible", "stable", "multiplier_modulus", "impulse_n_s",
        "impact_speed_m_per_s", "amplitude_x1_m", "amplitude_x2_m", "amplitude_force_n", "predicted_omega_rad_s",
        "predicted_force_n", "reason"}) {
    columns.emplace_back(column);
  }
  const LoopCycles& first = loops.front();
  io::Metadata head{{"body", std::string(backlash::to_string(first.loop.measured()))}};
  if (first.varied.empty()) {
    head.emplace_back("rigid_loop", std::string(frac::to_string(first.rigid.stability)));
    head.emplace_back("certain", first.exact.certain ? "true" : "false");
  }
  return text_of(
      {head,
       {columns, rows.size(),
        [&](std::size_t i, std::vector<Cell>& cells) {
          const auto& [loop, cycle] = rows[i];
          for (const auto& [name, value] : loop->varied) {
            const auto parsed = io::parse_number(value);
            cells.emplace_back(parsed ? Cell(*parsed) : Cell(value));
          }
          constexpr double none = std::numeric_limits<double>::quiet_NaN();
          const backlash::PredictedCycle* predicted = cycle->predicted;
          cells.insert(
              cells.end(),
              {cycle->omega, cycle->symmetric, cycle->impacts_per_period() ? cell_of(cycle->impacts) : Cell(none),
               cycle->admissible, cycle->stability.stable, cycle->multiplier_modulus(), cycle->impulse,
               cycle->impact_speed, cycle->amplitude_x1(), cycle->amplitude_x2(), cycle->amplitude_force(),
               predicted ? predicted->omega : none, predicted ? predicted->force_amplitude : none, cycle->reason});
        }}},
      "csv", command);
}

namespace {

// Bodies with resonances have a root beside each odd part of a natural frequency, without end towards low frequency:
// hundreds that are no motion would hide the cycles, and dozens that are unstable get one sentence.
struct ManyAlike {
  std::size_t count = 0;
  double from = 0, to = 0;  // rad/s
  [[nodiscard]] std::string remark(const std::string& what, const std::string& are) const {
    return count == 0 ? ""
                      : paragraph(std::to_string(count) + " " + what + " from " + short_number(from) + " to " +
                                      short_number(to) + " rad/s are " + are + ".",
                                  2);
  }
};
// None where they are few enough to be told one by one.
template <typename IsOne>
ManyAlike many_alike(const std::vector<ListedCycle>& listed, const IsOne& is_one) {
  constexpr std::size_t most_shown = 5;
  ManyAlike many;
  for (const ListedCycle& cycle : listed) {
    if (!is_one(cycle)) continue;
    if (many.count++ == 0) many.from = cycle.omega;
    many.to = cycle.omega;
  }
  return many.count > most_shown ? many : ManyAlike{};
}

std::string loop_table(const CompliantLoopCycles& loop) {
  std::string text = "Rigid loop (no clearance): " + std::string(frac::to_string(loop.rigid.stability));
  if (loop.rigid.unstable_poles > 0) text += ", poles to the right: " + std::to_string(loop.rigid.unstable_poles);
  text += "\n\n";
  AlignedTable table(
      {"omega", "motion", "contacts", "sticks", "|z|", "speed", "x1", "x2", "force", "predicted", "error"});
  std::string remarks;
  for (const backlash::CompliantCycle& cycle : loop.found.cycles) {
    const std::string no_reason;
    const ListedCycle listed = listed_cycle(cycle, no_reason);
    std::vector<std::string> row{short_number(cycle.omega), cycle.stability.stable ? "stable" : "unstable",
                                 std::to_string(cycle.contacts), std::to_string(cycle.sticks)};
    for (const double value : {listed.multiplier_modulus(), cycle.impact_speed, listed.amplitude_x1(),
                               listed.amplitude_x2(), listed.amplitude_force()})
      row.push_back(short_number(value));
    row.push_back(cycle.predicted ? short_number(cycle.predicted->omega) : "-");
    row.push_back(cycle.predicted ? percent(cycle.predicted->omega / cycle.omega - 1) : "-");
    table.add(row);
    const std::string at = "omega " + short_number(cycle.omega) + ": ";
    if (!cycle.symmetric) remarks += paragraph(at + "asymmetric, its mirror image is another one.", 2);
    if (!cycle.stability.stable)
      remarks += paragraph(at + "unstable by " + std::string(backlash::to_string(cycle.stability.loss)) + ".", 2);
  }
  remarks += motions_text(loop.found.motions);
  text += loop.found.cycles.empty() ? "No limit cycle was found.\n" : table.text();
  if (!remarks.empty()) text += "\n" + remarks;
  if (const auto rests = rests_of(loop.loop))
    text +=
        "\n" + paragraph("Dry friction can hold " + std::string(backlash::to_string(loop.loop.measured())) + " from " +
                         short_number(rests->from) + " to " + short_number(rests->to) + " m off the set-point.");
  if (loop.found.cycles.empty()) return text;
  text +=
      "\n" + paragraph(
                 "omega in rad/s; contacts: times that the bodies meet in a period; sticks: times that one comes to "
                 "rest; |z|: largest multiplier, per half period of symmetric cycles; speed: of the hardest meeting, "
                 "m/s; x1, x2 (m) and force (N): peak of the fundamental; predicted: omega by the describing "
                 "function. Looked for were what symmetric cycles of the restitution become and what motions settle "
                 "on.");
  return text;
}

}  // namespace

std::string limit_cycles_table(const std::vector<LoopCycles>& loops, const backlash::CycleContinuation* followed) {
  std::string text;
  if (loops.size() == 1) {
    const LoopCycles& loop = loops.front();
    text += "Rigid loop (no clearance): " + std::string(frac::to_string(loop.rigid.stability));
    if (loop.rigid.unstable_poles > 0) text += ", poles to the right: " + std::to_string(loop.rigid.unstable_poles);
    text += "\n\n";
  }
  std::vector<std::string> heading;
  for (const auto& [name, value] : loops.front().varied) heading.push_back(name);
  for (const char* column : {"omega", "motion", "|z|", "speed", "x1", "x2", "force", "predicted", "error"})
    heading.emplace_back(column);
  AlignedTable table(heading);
  std::string remarks;
  std::size_t rows = 0;
  for (const LoopCycles& loop : loops) {
    const std::vector<ListedCycle> listed = listed_cycles(loop);
    const ManyAlike left_out = many_alike(listed, [](const ListedCycle& cycle) { return !cycle.admissible; });
    const ManyAlike unstable = many_alike(listed, is_unstable);
    for (const ListedCycle& cycle : listed) {
      if (!cycle.admissible && left_out.count > 0) continue;
      table.add(row_of(cycle, loop));
      if (!is_unstable(cycle) || unstable.count == 0) remarks += remark_on(cycle, loops.size() == 1);
    }
    rows += listed.size() - left_out.count;
    if (loops.size() == 1) remarks += unstable.remark("cycles", "unstable, for the reasons in --format json");
    remarks += left_out.remark("further roots", "no motion; --format json lists each with its reason");
    remarks += motions_text(loop);
    if (loops.size() > 1) continue;
    remarks += unmatched_text(loop, listed);
    if (loop.exact.any_frequency) {
      text += "Every frequency is one of a cycle: nothing is lost and nothing made up for.\n";
    } else if (loop.exact.cycles.empty()) {
      text += "No symmetric limit cycle with two impacts per period.\n";
    }
  }
  if (rows > 0) text += table.text();
  if (!remarks.empty()) text += "\n" + remarks;
  if (loops.size() == 1 && loops.front().settled.motions.empty()) {
    text += "\nNo motion was simulated: cycles of more impacts or with rests in contact are not\nlooked for.\n";
  }
  if (loops.size() == 1 && !loops.front().exact.certain) {
    text += "\n" + paragraph("Searched on a grid from " + short_number(loops.front().exact.searched.from) + " to " +
                             short_number(loops.front().exact.searched.to) + " rad/s.");
  }
  if (followed) text += "\n" + events_text(loops.front().varied.front().first, *followed);
  if (rows == 0) return text;
  text += "\n" +
          paragraph(
              "omega in rad/s, exact; |z|: largest multiplier per half period; speed: of the impacts, m/s; x1, x2 (m) "
              "and force (N): peak of the fundamental; predicted: omega by the describing function.");
  return text;
}

std::string limit_cycles_json(const std::vector<CompliantLoopCycles>& loops, const std::string& command) {
  Json json = origin(command);
  if (loops.front().varied.empty()) {
    json.update(loop_json(loops.front()));
    return json.dump(1) + "\n";
  }
  json["loops"] = Json::list(loops, [](const CompliantLoopCycles& loop) {
    Json each{{"varied", object_of(loop.varied)}};
    each.update(loop_json(loop));
    return each;
  });
  return json.dump(1) + "\n";
}

std::string limit_cycles_csv(const std::vector<CompliantLoopCycles>& loops, const std::string& command) {
  const CompliantLoopCycles& first = loops.front();
  io::Metadata head{{"body", std::string(backlash::to_string(first.loop.measured()))}};
  if (first.varied.empty()) {
    head.emplace_back("rigid_loop", std::string(frac::to_string(first.rigid.stability)));
    head.insert(head.end(), first.contact.begin(), first.contact.end());
    if (const auto rests = rests_of(first.loop)) {
      head.emplace_back("rest_from_m", io::format_number(rests->from));
      head.emplace_back("rest_to_m", io::format_number(rests->to));
    }
  }
  std::vector<std::pair<const io::Metadata*, const backlash::CompliantCycle*>> rows;
  for (const CompliantLoopCycles& loop : loops)
    for (const backlash::CompliantCycle& cycle : loop.found.cycles) rows.emplace_back(&loop.varied, &cycle);
  std::vector<std::string> columns;
  for (const auto& [name, value] : first.varied) columns.push_back(name);
  for (const char* column : {"omega_rad_s", "symmetric", "impacts_per_period", "sticks_per_period", "stable",
                             "multiplier_modulus", "impulse_n_s", "impact_speed_m_per_s", "amplitude_x1_m",
                             "amplitude_x2_m", "amplitude_force_n", "predicted_omega_rad_s", "predicted_force_n"})
    columns.emplace_back(column);
  return text_of({head,
                  {columns, rows.size(),
                   [&](std::size_t i, std::vector<Cell>& cells) {
                     constexpr double none = std::numeric_limits<double>::quiet_NaN();
                     for (const auto& [name, value] : *rows[i].first)
                       cells.emplace_back(io::parse_number(value).value_or(none));
                     const backlash::CompliantCycle& cycle = *rows[i].second;
                     const std::string no_reason;
                     const ListedCycle listed = listed_cycle(cycle, no_reason);
                     cells.insert(cells.end(),
                                  {cycle.omega, cycle.symmetric, cell_of(cycle.contacts), cell_of(cycle.sticks),
                                   cycle.stability.stable, listed.multiplier_modulus(), cycle.impulse,
                                   cycle.impact_speed, listed.amplitude_x1(), listed.amplitude_x2(),
                                   listed.amplitude_force(), cycle.predicted ? cycle.predicted->omega : none,
                                   cycle.predicted ? cycle.predicted->force_amplitude : none});
                   }}},
                 "csv", command);
}

std::string limit_cycles_table(const std::vector<CompliantLoopCycles>& loops) {
  std::string text;
  for (const CompliantLoopCycles& loop : loops) {
    for (const auto& [name, value] : loop.varied) text += (text.empty() ? "" : "\n") + name + " " + value + "\n\n";
    text += loop_table(loop);
  }
  return text;
}

}  // namespace fracfit
