// SPDX-License-Identifier: BSD-3-Clause
#include "backlash/compliant/compliant_cycles.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <stdexcept>
#include <string>
#include <utility>

#include "backlash/loops/predicted_cycles.hpp"
#include "base/check.hpp"
#include "base/eigenvalues.hpp"
#include "base/linear_algebra.hpp"
#include "compliant_run.hpp"
#include "gauss.hpp"

namespace backlash {
namespace {

using Index = Eigen::Index;
using detail::CompliantFlow;
using detail::CompliantMode;
using detail::CompliantRun;

// In units of the inverse pace: without a meeting for so long there is none to come.
constexpr double patience = 200;

/// The state right after bodies have met, turned over where that was at -clearance/2, so that it is at the other wall.
struct Meeting {
  Eigen::VectorXd state;
  CompliantMode mode;
};

Meeting turned_over(const CompliantFlow& flow, const Meeting& of) {
  Meeting turned{-of.state, flow.turned_over(of.mode)};
  turned.state.segment(CompliantFlow::cosine, 3) *= -1;
  return turned;
}

/// Follows to the next meeting. @return false where none comes, or the motion escapes
bool follow_to_meeting(CompliantRun& run) {
  const CompliantFlow& flow = run.flow();
  const double until = run.time() + patience / flow.pace();
  for (int events = 0; run.time() < until && events < CompliantRun::most_events; ++events) {
    const CompliantRun::Event event = run.advance(until);
    if (run.has_escaped() || run.is_spent()) return false;
    // A wall that presses anew while the bodies still overlap is no meeting.
    if (event == CompliantRun::Event::contact && run.state()[CompliantFlow::gap] == run.subject() * flow.half_gap())
      return true;
  }
  return false;
}

Meeting meeting_of(const CompliantRun& run) {
  const Meeting met{run.state(), run.mode()};
  return run.mode().contact > 0 ? met : turned_over(run.flow(), met);
}

// What an orbit must repeat from meeting to meeting.
std::vector<Index> repeating(const CompliantFlow& flow) {
  std::vector<Index> indices = flow.repeating();
  std::erase(indices, Index{CompliantFlow::gap});
  return indices;
}

double distance(const CompliantFlow& flow, const Meeting& one, const Meeting& other) {
  double largest = 0;
  for (const Index i : repeating(flow))
    largest = std::max(largest, std::abs(one.state[i] - other.state[i]) / flow.sizes()[i]);
  return largest;
}

/// A motion that repeats itself, or its mirror image, after a number of meetings.
struct Closed {
  Meeting first;
  int meetings;
  bool is_mirror;
  double time;
  Eigen::MatrixXd derivative;  // of the map from the first to the last, turned over alike, of scaled states
  double residual;
  std::int64_t sticks;
};

// Newton's method on the map from a meeting to one of the next.
std::optional<Closed> close(const CompliantFlow& flow, const Meeting& guess, int meetings) {
  constexpr int most_steps = 12;
  // Steps below it, of the sizes of the states, are rounding; the step before was its square root.
  constexpr double converged = 1e-10, closed = 1e-8;
  const std::vector<Index> indices = repeating(flow);
  const auto size = static_cast<Index>(indices.size());
  const auto at = [&](Index i) { return indices[static_cast<std::size_t>(i)]; };
  Meeting from = guess;
  bool is_last = false;
  for (int step = 0; step <= most_steps; ++step) {
    CompliantRun run(flow, from.state, from.mode);
    run.begin_transition();
    for (int i = 0; i < meetings; ++i)
      if (!follow_to_meeting(run)) return std::nullopt;
    const bool is_mirror = run.mode().contact < 0;
    const Meeting to = meeting_of(run);
    // Of the state at the meeting instead of at one time.
    const Eigen::VectorXd field = flow.regime(run.mode()).a * run.state();
    const Eigen::MatrixXd map =
        run.transition() - field / field[CompliantFlow::gap] * run.transition().row(CompliantFlow::gap);
    Eigen::MatrixXd derivative(size, size);
    Eigen::VectorXd miss(size);
    for (Index i = 0; i < size; ++i) {
      const double scale = 1 / flow.sizes()[at(i)];
      miss[i] = (to.state[at(i)] - from.state[at(i)]) * scale;
      for (Index k = 0; k < size; ++k)
        derivative(i, k) = (is_mirror ? -1 : 1) * map(at(i), at(k)) * scale * flow.sizes()[at(k)];
    }
    const double residual = miss.cwiseAbs().maxCoeff();
    if (!derivative.allFinite() || !std::isfinite(residual)) return std::nullopt;
    if (is_last) {
      if (to.mode != from.mode || !(residual < closed)) return std::nullopt;
      return Closed{from, meetings, is_mirror, run.time(), derivative, residual, run.sticks()};
    }
    const Eigen::VectorXd change = frac::detail::solve_square(Eigen::MatrixXd::Identity(size, size) - derivative, miss);
    const double largest = change.cwiseAbs().maxCoeff();
    // One further away than the gap is wide is another one.
    if (!(largest < 3)) return std::nullopt;
    for (Index i = 0; i < size; ++i) from.state[at(i)] += change[i] * flow.sizes()[at(i)];
    from.mode = to.mode;
    is_last = largest < converged;
  }
  return std::nullopt;
}

CycleStability stability_of(const Closed& cycle, bool has_cut) {
  const Eigen::VectorXcd multipliers = frac::detail::eigenvalues(cycle.derivative);
  CycleStability stability{true, 0, 0, StabilityLoss::none};
  for (const std::complex<double>& each : multipliers) {
    stability.unstable_multipliers += std::abs(each) > 1;
    // What a fractional power remembers fades as a power of time; its exponentials are no multipliers of the cycle.
    const double along = cycle.is_mirror ? -each.real() : each.real();
    if (has_cut && each.imag() == 0 && along >= 0 && along < 1) continue;
    if (std::abs(each) > std::abs(stability.dominant)) stability.dominant = each;
  }
  stability.stable = stability.unstable_multipliers == 0;
  if (stability.stable) return stability;
  stability.loss = stability.dominant.imag() != 0  ? StabilityLoss::torus
                   : stability.dominant.real() > 0 ? StabilityLoss::saddle_node
                   : cycle.is_mirror               ? StabilityLoss::symmetry_breaking
                                                   : StabilityLoss::period_doubling;
  return stability;
}

/// Over its least period, from its hardest meeting.
std::optional<Closed> reduced(const CompliantFlow& flow, const Closed& cycle) {
  // Slow memories of fractional powers keep what a closed motion does not tell, so that bodies are compared alone.
  constexpr double rounding = 1e-7, same = 1e-3;
  std::vector<Meeting> met{cycle.first};
  CompliantRun run(flow, cycle.first.state, cycle.first.mode);
  while (static_cast<int>(met.size()) < cycle.meetings && follow_to_meeting(run)) met.push_back(meeting_of(run));
  const auto speed = [&](const Meeting& of) { return of.state[CompliantFlow::rate]; };
  const Meeting* hardest = &met.front();
  for (const Meeting& each : met)
    if (speed(each) > speed(*hardest) * (1 + rounding)) hardest = &each;
  for (int n = 1; n < static_cast<int>(met.size()); ++n) {
    const Meeting& other = met[static_cast<std::size_t>(n)];
    if (cycle.meetings % n != 0) continue;
    double apart = 0;
    for (const Index i : {Index{CompliantFlow::rate}, Index{CompliantFlow::x1}, Index{CompliantFlow::v1}})
      apart = std::max(apart, std::abs(other.state[i] - met.front().state[i]) / flow.sizes()[i]);
    if (apart > same) continue;
    auto shorter = close(flow, *hardest, n);
    if (shorter && std::abs(speed(shorter->first) / speed(*hardest) - 1) < same) return shorter;
  }
  return close(flow, *hardest, cycle.meetings);
}

CompliantCycle read(const CompliantFlow& flow, const Closed& cycle, int harmonics, const CompliantBodies& bodies) {
  const int copies = cycle.is_mirror ? 2 : 1;
  const double period = copies * cycle.time, omega = 2 * std::numbers::pi / period;
  CompliantCycle result{omega,
                        cycle.is_mirror,
                        copies * cycle.meetings,
                        copies * static_cast<int>(cycle.sticks),
                        cycle.first.state[CompliantFlow::rate],
                        0,
                        CompliantFlow::positions(cycle.first.state),
                        stability_of(cycle, flow.error() > 0),
                        std::max(cycle.residual, flow.error()),
                        {},
                        {}};
  for (int k = 1; k <= harmonics; ++k) result.harmonics.push_back({k, 0, 0, 0});
  CompliantRun run(flow, cycle.first.state, cycle.first.mode);
  bool is_first_contact = true;
  const double radian = 1 / free_contact(bodies.contact(), bodies.system().mass1(), bodies.system().mass2()).frequency;
  run.visit_pieces([&](const CompliantFlow::Regime& regime, const CompliantMode& mode, const detail::FlightPath& path,
                       double length) {
    is_first_contact = is_first_contact && mode.contact != 0;
    const double longest = std::min(mode.contact != 0 ? radian : period, 1 / (harmonics * omega));
    for (double from = 0, to = 0; to < length; from = to) {
      to = std::min(length, from + longest);
      detail::visit_gauss_nodes(to - from, [&](double t, double node_weight) {
        const Eigen::VectorXd state = path.state(from + t);
        const double weight = 0.5 * (to - from) * node_weight;
        if (is_first_contact) result.impulse += weight * flow.press(regime, mode.contact).row.dot(state);
        const LoopStart at = CompliantFlow::positions(state);
        const double force = regime.wanted.row.dot(state);
        for (CycleHarmonic& each : result.harmonics) {
          // A mirror image has odd orders alone.
          if (cycle.is_mirror && each.order % 2 == 0) continue;
          const std::complex<double> turn =
              2 * copies * weight / period * std::polar(1.0, -each.order * omega * (run.time() + from + t));
          each.x1 += turn * at.x1;
          each.x2 += turn * at.x2;
          each.force += turn * force;
        }
      });
    }
  });
  for (int i = 0; i < cycle.meetings; ++i) follow_to_meeting(run);
  return result;
}

// Newton's method on 1 + C N(F, omega) over the logarithms of both.
std::optional<CompliantPrediction> predicted(const CompliantLoop& loop, double omega, double force) {
  using Complex = std::complex<double>;
  constexpr int most_steps = 12;
  constexpr double difference = 1e-5, converged = 1e-8;
  SweepOptions options;
  options.output = loop.measured();
  options.protocol = Protocol::two_impact;
  options.threads = 1;
  const auto defect = [&](double force, double omega) -> Complex {
    const DescribingFunctionPoint point =
        bodies_describing_function(loop.bodies(), force, {omega}, options).points.front();
    if (point.regime != Regime::symmetric && (point.regime != Regime::periodic || point.period != 1))
      return std::numeric_limits<double>::quiet_NaN();
    return 1.0 + loop.controller().response(omega) * point.value;
  };
  bool is_last = false;
  for (int i = 0; i < most_steps; ++i) {
    const Complex at = defect(force, omega);
    const Complex by_force = (defect(force * (1 + difference), omega) - defect(force * (1 - difference), omega)) /
                             (2 * difference),
                  by_omega = (defect(force, omega * (1 + difference)) - defect(force, omega * (1 - difference))) /
                             (2 * difference);
    const double determinant = by_force.real() * by_omega.imag() - by_force.imag() * by_omega.real();
    if (!std::isfinite(determinant) || determinant == 0) return std::nullopt;
    if (is_last) return CompliantPrediction{omega, force, determinant > 0};
    const double force_step = -(at.real() * by_omega.imag() - at.imag() * by_omega.real()) / determinant;
    const double omega_step = -(by_force.real() * at.imag() - by_force.imag() * at.real()) / determinant;
    // As far as predictions of hard contacts are looked for.
    constexpr double longest = 0.7;
    const double size = std::max(std::abs(force_step), std::abs(omega_step));
    if (!(size < longest)) return std::nullopt;
    force *= std::exp(force_step);
    omega *= std::exp(omega_step);
    is_last = size < converged;
  }
  return std::nullopt;
}

/// Next to the cycle itself, or else to what is predicted where contacts take no time, within a factor of two.
std::optional<CompliantPrediction> predicted(const CompliantLoop& loop, const CompliantCycle& cycle,
                                             const std::vector<PredictedCycle>& hard) {
  if (const auto found = predicted(loop, cycle.omega, std::abs(cycle.harmonics.front().force))) return found;
  const PredictedCycle* nearest = nullptr;
  double smallest = std::numbers::ln2;
  for (const PredictedCycle& each : hard) {
    const double apart = std::abs(std::log(each.omega / cycle.omega));
    if (!each.symmetric || each.period != 1 || apart >= smallest) continue;
    smallest = apart;
    nearest = &each;
  }
  return nearest ? predicted(loop, nearest->omega, nearest->force_amplitude) : std::nullopt;
}

/// The symmetric cycle of two meetings that one of the loop with a restitution becomes, as the contact softens from
/// where it takes no time and dry friction sets in.
std::optional<Closed> softened(const CompliantLoop& loop, const CompliantFlow& flow, const SymmetricCycle& hard,
                               double tolerance, double stiffest) {
  constexpr double shortest_step = 1.0 / 256;
  const CompliantBodies& bodies = loop.bodies();
  const TwoMassSystem& system = bodies.system();
  const FreeContact free = free_contact(bodies.contact(), system.mass1(), system.mass2());
  const SetPoint at_rest{};
  const double no_limit = std::numeric_limits<double>::infinity();
  const auto loop_at = [&](double share) {
    const double frequency = stiffest * std::pow(free.frequency / stiffest, share);
    const CompliantBodies softer(
        bodies.hard().load(), bodies.hard().drive(), system.clearance(),
        CompliantContact::from_frequency(frequency, free.damping_ratio, system.mass1(), system.mass2()),
        {share * bodies.friction().body1, share * bodies.friction().body2});
    return CompliantLoop(softer, loop.controller(), loop.measured());
  };
  const CompliantFlow stiff(loop_at(0), at_rest, no_limit, tolerance, stiffest);
  const Eigen::VectorXd met = stiff.meeting(hard);
  CompliantMode mode;
  mode.contact = 1;
  std::optional<Closed> cycle = close(stiff, {met, mode}, 1);
  if (!cycle || !cycle->is_mirror) return std::nullopt;
  double share = 0, step = 0.25;
  while (share < 1) {
    const double next = std::min(1.0, share + step);
    std::optional<CompliantFlow> softer;
    if (next < 1) softer.emplace(loop_at(next), at_rest, no_limit, tolerance, stiffest);
    const CompliantFlow& to = softer ? *softer : flow;
    Meeting guess = cycle->first;
    for (int i = 0; i < 2; ++i) {
      const double speed = guess.state[CompliantFlow::v1] + (i == 0 ? 0 : guess.state[CompliantFlow::rate]);
      int& slide = guess.mode.slide[static_cast<std::size_t>(i)];
      if (to.friction(i) != 0 && slide != 0) slide = speed < 0 ? -1 : 1;
    }
    std::optional<Closed> further = close(to, guess, 1);
    if (further && further->is_mirror) {
      cycle = std::move(further);
      share = next;
      step *= 1.5;
    } else if ((step *= 0.5) < shortest_step) {
      return std::nullopt;
    }
  }
  return cycle;
}

bool is_same(const CompliantCycle& one, const CompliantCycle& other) {
  // Newton's method leaves 1e-8 of the sizes of states.
  constexpr double rounding = 1e-6;
  return one.contacts == other.contacts && one.symmetric == other.symmetric &&
         std::abs(one.omega / other.omega - 1) < rounding &&
         std::abs(one.impact_speed / other.impact_speed - 1) < rounding;
}

/// A motion from a start until it closes to a stable cycle.
struct Settled {
  LoopRegime regime;
  std::optional<Closed> cycle;
};
Settled settle(const CompliantFlow& flow, const LoopStart& start, std::size_t most_meetings, double fastest) {
  constexpr std::size_t longest_pattern = 24, pause = 20;
  constexpr double near = 1e-3, nearly = 0.02;
  const Eigen::VectorXd state = flow.start(start);
  CompliantRun run(flow, state, flow.mode_of(state));
  run.set_bound(fastest);
  std::vector<Meeting> met;
  std::size_t next_trial = 0;
  const auto closed_within = [&](double tolerance) -> std::optional<Closed> {
    const std::size_t last = met.size() - 1;
    for (std::size_t n = 1; n <= std::min(last, longest_pattern); ++n) {
      if (met[last].mode != met[last - n].mode || distance(flow, met[last], met[last - n]) > tolerance) continue;
      next_trial = met.size() + pause;
      const std::optional<Closed> cycle = close(flow, met[last], static_cast<int>(n));
      if (!cycle || !stability_of(*cycle, flow.error() > 0).stable) break;
      // The one that the motion is near, though memories may fade slowly.
      const double speed = met[last].state[CompliantFlow::rate], closed = cycle->first.state[CompliantFlow::rate];
      if (std::abs(closed / speed - 1) > 0.05) break;
      return reduced(flow, *cycle);
    }
    return std::nullopt;
  };
  while (met.size() < most_meetings) {
    if (!follow_to_meeting(run)) {
      if (run.has_escaped()) return {LoopRegime::diverged, std::nullopt};
      return {run.is_spent() ? LoopRegime::irregular : LoopRegime::quiet, std::nullopt};
    }
    met.push_back(meeting_of(run));
    if (met.size() < next_trial) continue;
    if (auto cycle = closed_within(near)) return {LoopRegime::cycle, std::move(cycle)};
  }
  auto cycle = met.empty() ? std::nullopt : closed_within(nearly);
  return {cycle ? LoopRegime::cycle : LoopRegime::irregular, std::move(cycle)};
}

}  // namespace

CompliantCycles compliant_cycles(const CompliantLoop& loop, const CompliantCycleOptions& options) {
  if (options.starts < 0)
    throw std::invalid_argument("starts is " + std::to_string(options.starts) + "; it must be at least 0");
  if (options.range && !(options.range->from > 0 && options.range->from < options.range->to))
    throw std::invalid_argument("range is " + detail::text(options.range->from) + " to " +
                                detail::text(options.range->to) + " rad/s; it must rise and be above 0");
  if (options.contacts < 1) throw std::invalid_argument("contacts is 0; it must be at least 1");
  if (options.harmonics < 1)
    throw std::invalid_argument("harmonics is " + std::to_string(options.harmonics) + "; it must be at least 1");
  LimitCycleOptions of_hard;
  of_hard.harmonics = 200;
  std::vector<SymmetricCycle> hard = symmetric_cycles(loop.hard(), of_hard).cycles;
  std::erase_if(hard, [](const SymmetricCycle& cycle) { return !cycle.admissible; });
  // Where the time of a contact moves a cycle by some thousandths.
  constexpr double hard_enough = 300;
  const TwoMassSystem& system = loop.bodies().system();
  double stiffest = free_contact(loop.bodies().contact(), system.mass1(), system.mass2()).frequency;
  for (const SymmetricCycle& cycle : hard) stiffest = std::max(stiffest, hard_enough * cycle.omega);
  const CompliantFlow flow(loop, {}, std::numeric_limits<double>::infinity(), options.tolerance, stiffest);
  CompliantCycles result{{}, {}, flow.error()};
  const auto add = [&](const Closed& closed) -> std::optional<std::size_t> {
    CompliantCycle cycle = read(flow, closed, options.harmonics, loop.bodies());
    if (options.range && !(cycle.omega >= options.range->from && cycle.omega <= options.range->to)) return std::nullopt;
    const auto known = std::find_if(result.cycles.begin(), result.cycles.end(),
                                    [&](const CompliantCycle& other) { return is_same(cycle, other); });
    const auto index = static_cast<std::size_t>(known - result.cycles.begin());
    if (known == result.cycles.end()) result.cycles.push_back(std::move(cycle));
    return index;
  };
  for (const SymmetricCycle& each : hard)
    if (const auto cycle = softened(loop, flow, each, options.tolerance, stiffest)) add(*cycle);
  std::mt19937_64 engine(options.seed);
  const auto unit = [&] { return static_cast<double>(engine() >> 11) * 0x1p-53; };
  const double speed = flow.pace() * loop.bodies().system().clearance();
  for (int k = 0; k < options.starts; ++k) {
    LoopStart start;
    start.v1 = speed * (0.4 * unit() - 0.2);
    start.v2 = speed * 0.2 * std::pow(25, unit());
    Settled settled = settle(flow, start, options.contacts, 1e9 * speed);
    CompliantMotion motion{start, settled.regime, std::nullopt};
    if (settled.cycle) motion.cycle = add(*settled.cycle);
    result.motions.push_back(motion);
  }
  // By rising frequency.
  std::vector<std::size_t> order(result.cycles.size()), place(result.cycles.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return result.cycles[a].omega < result.cycles[b].omega; });
  std::vector<CompliantCycle> sorted;
  for (std::size_t i = 0; i < order.size(); ++i) {
    place[order[i]] = i;
    sorted.push_back(std::move(result.cycles[order[i]]));
  }
  result.cycles = std::move(sorted);
  for (CompliantMotion& motion : result.motions)
    if (motion.cycle) motion.cycle = place[*motion.cycle];
  const std::vector<PredictedCycle> of_hard_loop = predicted_limit_cycles(loop.hard());
  for (CompliantCycle& cycle : result.cycles) cycle.predicted = predicted(loop, cycle, of_hard_loop);
  return result;
}

}  // namespace backlash
