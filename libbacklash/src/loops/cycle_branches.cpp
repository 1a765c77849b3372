// SPDX-License-Identifier: BSD-3-Clause
#include "cycle_branches.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "frac/cancellation.hpp"

namespace backlash::detail {
namespace {

// A cycle that is followed changes by no more from one value to the next; steps are halved until it does.
constexpr double largest_change = 0.05;
constexpr double least_step = 1e-7;

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
    found.push_back(std::move(branch));
  }
}

void CycleBranches::add_found(const ImpactCycle& cycle, double parameter) {
  const CycleBranch::Sample sample{parameter, cycle};
  CycleBranch branch{std::numeric_limits<double>::quiet_NaN(), {sample}, {}, {}, {}};
  follow(branch, sample, false);
  std::reverse(branch.samples.begin(), branch.samples.end());
  std::reverse(branch.events.begin(), branch.events.end());
  follow(branch, sample, true);
  found.push_back(std::move(branch));
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

std::optional<ImpactCycle> CycleBranches::near(const ImpactCycle& cycle, double parameter) const {
  auto next = close_cycle(loop_at_(parameter), {cycle.period, cycle.impacts}, 1);
  if (!next || next->symmetric != cycle.symmetric || change_between(cycle, *next) > largest_change) return std::nullopt;
  return next;
}

void CycleBranches::follow(CycleBranch& branch, const CycleBranch::Sample& first, bool rises) const {
  std::vector<double> ahead;
  for (const double each : parameters_) {
    if (rises ? each > first.parameter : each < first.parameter) ahead.push_back(each);
  }
  if (!rises) std::reverse(ahead.begin(), ahead.end());
  CycleBranch::Sample last = first;
  for (const double goal : ahead) {
    double step = goal - last.parameter;
    while (last.parameter != goal) {
      frac::throw_if_cancelled();
      const double to = std::abs(goal - last.parameter) <= std::abs(step) ? goal : last.parameter + step;
      const auto next = near(last.cycle, to);
      if (!next) {
        step /= 2;
        if (std::abs(step) < least_step * step_) return;
        continue;
      }
      const CycleBranch::Sample sample{to, *next};
      look_between(branch, last, sample);
      last = sample;
      if (!last.cycle.admissible) return;
      step *= 2;
    }
    branch.samples.push_back(last);
  }
}

void CycleBranches::look_between(CycleBranch& branch, const CycleBranch::Sample& a,
                                 const CycleBranch::Sample& b) const {
  // Where a property of the cycle at a is lost, by halving; empty where the cycle is not followed between.
  const auto refined = [&](const std::function<bool(const ImpactCycle&)>& holds) -> std::optional<CycleBranch::Sample> {
    CycleBranch::Sample low = a, high = b;
    while (std::abs(high.parameter - low.parameter) > 1e-11 * std::max(std::abs(high.parameter), step_)) {
      const double middle = 0.5 * (low.parameter + high.parameter);
      const auto cycle = near(low.cycle, middle);
      if (!cycle) return std::nullopt;
      (holds(*cycle) ? low : high) = {middle, *cycle};
    }
    return high;
  };
  const auto add = [&](CycleEventKind kind, const CycleBranch::Sample& at, const std::string& reason) {
    branch.events.push_back({kind, at.parameter, 2 * std::numbers::pi / at.cycle.period, a.cycle.admissible, reason});
  };
  double motion_ends = b.parameter;
  if (!b.cycle.admissible) {
    const auto at = refined([](const ImpactCycle& cycle) { return cycle.admissible; });
    if (at) add(CycleEventKind::admissibility, *at, at->cycle.reason);
    motion_ends = at ? at->parameter : a.parameter;
  }
  add_interval(branch.admissible, a.parameter, motion_ends);
  const bool was_stable = a.cycle.stability.stable;
  if (was_stable == b.cycle.stability.stable) {
    if (was_stable) add_interval(branch.stable, a.parameter, motion_ends);
    return;
  }
  const auto at = refined([&](const ImpactCycle& cycle) { return cycle.stability.stable == was_stable; });
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
