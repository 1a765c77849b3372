// SPDX-License-Identifier: BSD-3-Clause
#include "cycle_branches.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>

#include "frac/cancellation.hpp"
#include "loops/equations/cycle_equations.hpp"

namespace backlash::detail {
namespace {

// A cycle that is followed changes by no more from one value to the next; steps are halved until it does.
constexpr double largest_change = 0.05;
constexpr double least_step = 1e-7;
// Of one branch that turns back and forth.
constexpr std::size_t most_turns = 8;

// Of period, instants and impulses. An impact may become the hardest in place of another one: then it is large.
double change_between(const ImpactCycle& a, const ImpactCycle& b) {
  double change = std::abs(std::log(b.period / a.period));
  for (std::size_t i = 0; i < a.impacts.size(); ++i) {
    change = std::max(change, std::abs(b.impacts[i].time / b.period - a.impacts[i].time / a.period));
    change = std::max(change, std::abs(b.impacts[i].impulse / a.impacts[i].impulse - 1));
  }
  return change;
}

}  // namespace

CycleBranches::CycleBranches(const std::function<ControlLoop(double)>& loop_at, const std::vector<double>& parameters)
    : loop_at_(loop_at), parameters_(parameters), step_(std::abs(parameters[1] - parameters[0])) {
  std::sort(parameters_.begin(), parameters_.end());
  for (std::size_t i = 1; i < parameters_.size(); ++i) step_ = std::min(step_, parameters_[i] - parameters_[i - 1]);
}

// Near its origin a branch lies at distances that grow as the root of that of the parameter.
void CycleBranches::add_from(const CycleEvent& breaking) {
  for (const double side : {1.0, -1.0}) {
    std::optional<ImpactCycle> first;
    double from = breaking.parameter;
    for (double distance = 0.02; distance < 0.5 && !first; distance *= 4) {
      from = breaking.parameter + side * distance * step_;
      if (from < parameters_.front() || from > parameters_.back()) break;
      first = born_at(from, breaking.omega);
    }
    if (!first || !first->admissible) continue;
    const CycleBranch::Sample sample{from, *first};
    CycleBranch branch{breaking.parameter, {sample}, {}, {}, {}};
    add_interval(branch.admissible, breaking.parameter, from);
    if (first->stability.stable) add_interval(branch.stable, breaking.parameter, from);
    follow(branch, sample, side > 0);
    add(std::move(branch));
  }
}

void CycleBranches::add_found(const ImpactCycle& cycle, double parameter) {
  const CycleBranch::Sample sample{parameter, cycle};
  CycleBranch branch{std::numeric_limits<double>::quiet_NaN(), {sample}, {}, {}, {}};
  follow(branch, sample, false);
  std::reverse(branch.samples.begin(), branch.samples.end());
  std::reverse(branch.events.begin(), branch.events.end());
  follow(branch, sample, true);
  add(std::move(branch));
}

// With what turned back from it.
void CycleBranches::add(CycleBranch branch) {
  found.push_back(std::move(branch));
  found.insert(found.end(), turned_.begin(), turned_.end());
  turned_.clear();
  turns_ = 0;
}

void CycleBranches::add_resting(const ImpactCycle& cycle, double parameter, double before) {
  for (CycleBranch& branch : found) {
    const CycleBranch::Sample& last = branch.samples.back();
    const bool is_like = last.parameter == before && last.cycle.symmetric == cycle.symmetric &&
                         last.cycle.rests.size() == cycle.rests.size() &&
                         std::abs(std::log(last.cycle.period / cycle.period)) < 0.5;
    if (!is_like) continue;
    add_interval(branch.admissible, before, parameter);
    add_interval(branch.stable, before, parameter);
    branch.samples.push_back({parameter, cycle});
    return;
  }
  found.push_back({std::numeric_limits<double>::quiet_NaN(), {{parameter, cycle}}, {}, {}, {}});
}

// An asymmetric cycle beside the symmetric one.
std::optional<ImpactCycle> CycleBranches::born_at(double parameter, double omega) const {
  const ControlLoop loop = loop_at_(parameter);
  LimitCycleOptions options;
  options.range = FrequencyRange{0.8 * omega, 1.25 * omega};
  options.harmonics = 1;
  const LimitCycles symmetric = symmetric_cycles(loop, options);
  const auto nearest = std::min_element(symmetric.cycles.begin(), symmetric.cycles.end(),
                                        [&](const SymmetricCycle& a, const SymmetricCycle& b) {
                                          return std::abs(a.omega - omega) < std::abs(b.omega - omega);
                                        });
  if (nearest == symmetric.cycles.end() || !(nearest->impulse > 0)) return std::nullopt;
  const double period = 2 * std::numbers::pi / nearest->omega;
  for (double share = 0.003; share < 0.2; share *= 2) {
    auto cycle =
        close_cycle(loop, {period, {{0, nearest->impulse, 0}, {(0.5 - share) * period, -nearest->impulse, 0}}}, 1);
    if (cycle && !cycle->symmetric && std::abs(std::log(cycle->period / period)) < 0.1) return cycle;
  }
  return std::nullopt;
}

std::optional<ImpactCycle> CycleBranches::near(const ImpactCycle& cycle, double parameter, bool judges) const {
  const ControlLoop loop = loop_at_(parameter);
  auto next = closed_cycle(loop, {cycle.period, cycle.impacts}, 1, false);
  if (!next || next->symmetric != cycle.symmetric || change_between(cycle, *next) > largest_change) return std::nullopt;
  return judges ? closed_cycle(loop, {next->period, next->impacts}, 1, true) : next;
}

void CycleBranches::follow(CycleBranch& branch, const CycleBranch::Sample& first, bool rises, double longest) {
  std::vector<double> ahead;
  for (const double each : parameters_) {
    if (rises ? each > first.parameter : each < first.parameter) ahead.push_back(each);
  }
  if (!rises) std::reverse(ahead.begin(), ahead.end());
  CycleBranch::Sample last = first;
  std::vector<CycleBranch::Sample> passed{first};
  for (const double goal : ahead) {
    double step = std::copysign(std::min(std::abs(goal - last.parameter), longest), goal - last.parameter);
    while (last.parameter != goal) {
      frac::throw_if_cancelled();
      const double to = std::abs(goal - last.parameter) <= std::abs(step) ? goal : last.parameter + step;
      // Towards an end the steps become small; stability is looked at again where they have grown, and at a value.
      const bool judges = to == goal || std::abs(step) > 1e-3 * step_;
      auto next = near(last.cycle, to, judges);
      if (!next) {
        step /= 2;
        if (std::abs(step) < least_step * step_) {
          turn_back(branch, passed, rises);
          return;
        }
        continue;
      }
      if (!judges) next->stability = last.cycle.stability;
      const CycleBranch::Sample sample{to, *next};
      look_between(branch, last, sample);
      last = sample;
      if (!last.cycle.admissible) return;
      passed.push_back(last);
      longest *= 2;
      step *= 2;
    }
    branch.samples.push_back(last);
  }
}

// Near a fold the parameter is a parabola in any coordinate of the cycle, of which three samples tell the vertex, and
// what lies as far beyond it as the last sample lies before it.
void CycleBranches::turn_back(CycleBranch& branch, const std::vector<CycleBranch::Sample>& passed, bool rises) {
  if (passed.size() < 3) return;
  const auto coordinates = [](const ImpactCycle& cycle) {
    std::vector<double> all{std::log(cycle.period)};
    for (const CycleImpact& impact : cycle.impacts) {
      all.push_back(impact.time / cycle.period);
      all.push_back(impact.impulse);
    }
    return all;
  };
  const std::size_t end = passed.size();
  const std::vector<double> a = coordinates(passed[end - 3].cycle), b = coordinates(passed[end - 2].cycle),
                            c = coordinates(passed[end - 1].cycle);
  std::size_t fastest = 0;
  for (std::size_t i = 1; i < c.size(); ++i) {
    if (std::abs(c[i] - a[i]) > std::abs(c[fastest] - a[fastest])) fastest = i;
  }
  const double at_a = a[fastest], at_b = b[fastest], at_c = c[fastest];
  const double last = passed[end - 1].parameter;
  const double slope = (last - passed[end - 2].parameter) / (at_c - at_b);
  const double before = (passed[end - 2].parameter - passed[end - 3].parameter) / (at_b - at_a);
  const double curvature = (slope - before) / (at_c - at_a);
  const double slope_at_c = slope + curvature * (at_c - at_b);
  const double ahead = -0.5 * slope_at_c / curvature;  // of the coordinate, to the vertex
  const double fold = last + 0.5 * slope_at_c * ahead;
  // Followed to least_step, the fold is no farther than a few of these.
  const double left = rises ? fold - last : last - fold;
  if (!(left > 0 && left < 10 * least_step * step_) || !(ahead * (at_c - at_b) > 0)) return;
  branch.events.push_back({CycleEventKind::fold, fold, 2 * std::numbers::pi / passed[end - 1].cycle.period, true, {}});
  add_interval(branch.admissible, last, fold);
  if (passed[end - 1].cycle.stability.stable) add_interval(branch.stable, last, fold);

  if (++turns_ > most_turns) return;
  CycleGuess guess{passed[end - 1].cycle.period, passed[end - 1].cycle.impacts};
  const auto mirrored = [&](std::size_t i) { return c[i] + 2 * ahead * (c[i] - b[i]) / (at_c - at_b); };
  guess.period = std::exp(mirrored(0));
  for (std::size_t i = 0; i < guess.impacts.size(); ++i) {
    guess.impacts[i].time = i == 0 ? 0 : guess.period * mirrored(1 + 2 * i);
    guess.impacts[i].impulse = mirrored(2 + 2 * i);
  }
  const auto beyond = closed_cycle(loop_at_(last), guess, 1, true);
  if (!beyond || !beyond->admissible || !((coordinates(*beyond)[fastest] - at_c) / ahead > 1)) return;
  CycleBranch turned{fold, {{last, *beyond}}, {}, {}, {}};
  add_interval(turned.admissible, last, fold);
  if (beyond->stability.stable) add_interval(turned.stable, last, fold);
  const CycleBranch::Sample first = turned.samples.front();
  follow(turned, first, !rises, left);
  turned_.push_back(std::move(turned));
}

void CycleBranches::look_between(CycleBranch& branch, const CycleBranch::Sample& a,
                                 const CycleBranch::Sample& b) const {
  // Where a property of the cycle at a is lost, its margin no longer above 0; empty where the cycle is not followed
  // between.  By secants (Illinois), and by halves where the margin tells no distance.
  const auto refined =
      [&](bool judges, const std::function<double(const ImpactCycle&)>& margin) -> std::optional<CycleBranch::Sample> {
    CycleBranch::Sample low = a, high = b;
    double at_low = margin(a.cycle), at_high = margin(b.cycle);
    int kept = 0;  // so often in a row the low end (> 0) or the high one has stayed
    while (std::abs(high.parameter - low.parameter) > 1e-11 * std::max(std::abs(high.parameter), step_)) {
      double share = at_low / (at_low - at_high);
      if (!(share > 0 && share < 1)) share = 0.5;
      const double middle = low.parameter + share * (high.parameter - low.parameter);
      if (middle == low.parameter || middle == high.parameter) break;
      const auto cycle = near(low.cycle, middle, judges);
      if (!cycle) return std::nullopt;
      const double at_middle = margin(*cycle);
      if (at_middle > 0) {
        low = {middle, *cycle};
        at_low = at_middle;
        kept = std::min(kept, 0) - 1;
        if (kept < -1) at_high /= 2;
      } else {
        high = {middle, *cycle};
        at_high = at_middle;
        kept = std::max(kept, 0) + 1;
        if (kept > 1) at_low /= 2;
      }
    }
    return high;
  };
  const auto add = [&](CycleEventKind kind, const CycleBranch::Sample& at, const std::string& reason) {
    branch.events.push_back({kind, at.parameter, 2 * std::numbers::pi / at.cycle.period, a.cycle.admissible, reason});
  };
  double motion_ends = b.parameter;
  if (!b.cycle.admissible) {
    const auto at = refined(false, [](const ImpactCycle& cycle) { return cycle.admissible ? 1.0 : -1.0; });
    if (at) add(CycleEventKind::admissibility, *at, at->cycle.reason);
    motion_ends = at ? at->parameter : a.parameter;
  }
  add_interval(branch.admissible, a.parameter, motion_ends);
  const bool was_stable = a.cycle.stability.stable;
  if (was_stable == b.cycle.stability.stable) {
    if (was_stable) add_interval(branch.stable, a.parameter, motion_ends);
    return;
  }
  const auto at = refined(true, [&](const ImpactCycle& cycle) {
    const double distance = std::abs(std::log(std::abs(cycle.stability.dominant)));
    const double size = std::isfinite(distance) ? distance + 1e-12 : 1;
    return cycle.stability.stable == was_stable ? size : -size;
  });
  if (!at) return;
  // A multiplier of +1 is where the branch begins or turns back, and hardly told from one that is beyond it there.
  const StabilityLoss loss = was_stable ? at->cycle.stability.loss : a.cycle.stability.loss;
  if (loss == StabilityLoss::period_doubling) add(CycleEventKind::period_doubling, *at, {});
  if (loss == StabilityLoss::torus) add(CycleEventKind::torus, *at, {});
  const bool is_before_the_end = std::abs(at->parameter - a.parameter) < std::abs(motion_ends - a.parameter);
  if (was_stable) {
    add_interval(branch.stable, a.parameter, is_before_the_end ? at->parameter : motion_ends);
  } else if (is_before_the_end) {
    add_interval(branch.stable, at->parameter, motion_ends);
  }
}

void add_interval(std::vector<ParameterInterval>& intervals, double from, double to) {
  ParameterInterval added{std::min(from, to), std::max(from, to)};
  std::vector<ParameterInterval> merged;
  for (const ParameterInterval& each : intervals) {
    if (each.to < added.from || each.from > added.to) {
      merged.push_back(each);
    } else {
      added = {std::min(added.from, each.from), std::max(added.to, each.to)};
    }
  }
  merged.push_back(added);
  std::sort(merged.begin(), merged.end(), [](const auto& one, const auto& other) { return one.from < other.from; });
  intervals = std::move(merged);
}

std::vector<ParameterInterval> without(const std::vector<ParameterInterval>& intervals,
                                       const std::vector<ParameterInterval>& others) {
  std::vector<ParameterInterval> left = intervals;
  for (const ParameterInterval& other : others) {
    std::vector<ParameterInterval> rest;
    for (const ParameterInterval& each : left) {
      if (other.to <= each.from || other.from >= each.to) {
        rest.push_back(each);
        continue;
      }
      if (each.from < other.from) rest.push_back({each.from, other.from});
      if (other.to < each.to) rest.push_back({other.to, each.to});
    }
    left = std::move(rest);
  }
  return left;
}

}  // namespace backlash::detail
