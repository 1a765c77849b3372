// SPDX-License-Identifier: BSD-3-Clause
#include "backlash/loops/cycle_continuation.hpp"

#include <algorithm>
#include <array>
#include <boost/math/tools/minima.hpp>
#include <boost/math/tools/toms748_solve.hpp>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <stdexcept>
#include <utility>

#include "base/check.hpp"
#include "base/spelling.hpp"
#include "cycle_branches.hpp"
#include "symmetric_search.hpp"

namespace backlash {
namespace {

constexpr std::array<std::pair<CycleEventKind, std::string_view>, 6> kind_names{
    {{CycleEventKind::fold, "fold"},
     {CycleEventKind::symmetry_breaking, "symmetry-breaking"},
     {CycleEventKind::torus, "torus"},
     {CycleEventKind::admissibility, "admissibility"},
     {CycleEventKind::period_doubling, "period-doubling"},
     {CycleEventKind::range_end, "range-end"}}};

// Neighbouring values are halved this often until each cycle of one is told from those of the other.
constexpr int most_halvings = 12;

double root_of(const std::function<double(double)>& function, double from, double to, double at_from, double at_to) {
  if (from > to) return root_of(function, to, from, at_to, at_from);
  std::uintmax_t evaluations = 100;
  const auto [low, high] = boost::math::tools::toms748_solve(
      function, from, to, at_from, at_to, boost::math::tools::eps_tolerance<double>(50), evaluations);
  return 0.5 * (low + high);
}

// The loop at one value.
struct At {
  At(const std::function<ControlLoop(double)>& loop_at, double value, const LimitCycleOptions& options)
      : parameter(value), loop(loop_at(value)), search(loop, options) {}
  At(const At&) = delete;
  At& operator=(const At&) = delete;

  double parameter;
  ControlLoop loop;
  detail::SymmetricSearch search;
};

struct Sample {
  double parameter;
  std::vector<SymmetricCycle> cycles;
};

// One cycle at two values.
struct Piece {
  double from, to;
  double omega_from, omega_to;

  [[nodiscard]] double guess(double parameter) const {
    const double share = (parameter - from) / (to - from);
    return std::exp((1 - share) * std::log(omega_from) + share * std::log(omega_to));
  }
};

class Continuation {
 public:
  Continuation(const std::function<ControlLoop(double)>& loop_at, const LimitCycleOptions& options)
      : loop_at_(loop_at), options_(options) {}

  void between(const Sample& a, const Sample& b) { between(a, b, most_halvings); }
  [[nodiscard]] Sample sample(double parameter) const {
    const At at(loop_at_, parameter, options_);
    Sample made{parameter, {}};
    for (const double omega : at.search.frequencies()) made.cycles.push_back(at.search.cycle_at(omega));
    return made;
  }

  std::vector<CycleEvent> events;

 private:
  void between(const Sample& a, const Sample& b, int halvings) {
    const double middle = 0.5 * (a.parameter + b.parameter);
    if (a.cycles.size() != b.cycles.size()) {
      if (halvings > 0) {
        const Sample between_them = sample(middle);
        between(a, between_them, halvings - 1);
        between(between_them, b, halvings - 1);
        return;
      }
      const bool is_lost = a.cycles.size() > b.cycles.size();
      resolve(is_lost ? a : b, is_lost ? b : a);
      return;
    }
    double farthest = 0;
    for (std::size_t i = 0; i < a.cycles.size(); ++i)
      farthest = std::max(farthest, std::abs(std::log(b.cycles[i].omega / a.cycles[i].omega)));
    if (farthest > 0.5 && halvings > 0) {
      const Sample between_them = sample(middle);
      between(a, between_them, halvings - 1);
      between(between_them, b, halvings - 1);
      return;
    }
    for (std::size_t i = 0; i < a.cycles.size(); ++i) follow(a, a.cycles[i], b, b.cycles[i]);
  }

  // Values so near that all cycles but those that vanish have hardly moved.
  void resolve(const Sample& more, const Sample& fewer) {
    const std::size_t lost = more.cycles.size() - fewer.cycles.size();
    // The cycles from `first` on, `lost` of them, that have no match.
    std::size_t first = 0;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t skipped = 0; skipped + lost <= more.cycles.size(); ++skipped) {
      double distance = 0;
      for (std::size_t i = 0; i < fewer.cycles.size(); ++i)
        distance += std::abs(std::log(more.cycles[i < skipped ? i : i + lost].omega / fewer.cycles[i].omega));
      if (distance < least) {
        least = distance;
        first = skipped;
      }
    }
    for (std::size_t i = 0; i < fewer.cycles.size(); ++i)
      follow(more, more.cycles[i < first ? i : i + lost], fewer, fewer.cycles[i]);
    if (lost == 2) {
      refine_fold(more, first, fewer);
    } else if (lost == 1) {
      refine_range_end(more, more.cycles[first], fewer);
    }
  }

  // An end of the range becomes a root.  An end at 0 or infinity is reached at a bound of the parameter itself.
  void refine_range_end(const Sample& more, const SymmetricCycle& gone, const Sample& fewer) {
    const FrequencyRange range = At(loop_at_, more.parameter, options_).search.range();
    CycleEvent event{CycleEventKind::range_end, fewer.parameter, gone.omega, gone.admissible, {}};
    for (const double end : {range.from, range.to}) {
      if (!(end > 0) || !std::isfinite(end)) continue;
      const auto defect = [&](double parameter) { return At(loop_at_, parameter, options_).search.rate_defect(end); };
      const double at_more = defect(more.parameter), at_fewer = defect(fewer.parameter);
      if ((at_more > 0) == (at_fewer > 0)) continue;
      event.parameter = root_of(defect, more.parameter, fewer.parameter, at_more, at_fewer);
      event.omega = end;
      break;
    }
    events.push_back(event);
  }

  // Between the two cycles the defect has one sign, and an extremum that reaches 0 where they meet.
  void refine_fold(const Sample& more, std::size_t first, const Sample& fewer) {
    const SymmetricCycle& lower = more.cycles[first];
    const SymmetricCycle& upper = more.cycles[first + 1];
    const double gap = std::log(upper.omega / lower.omega);
    double from = std::log(lower.omega) - gap;
    double to = std::log(upper.omega) + gap;
    if (first > 0) from = std::max(from, 0.5 * std::log(lower.omega * more.cycles[first - 1].omega));
    if (first + 2 < more.cycles.size()) to = std::min(to, 0.5 * std::log(upper.omega * more.cycles[first + 2].omega));
    const double sign =
        At(loop_at_, more.parameter, options_).search.rate_defect(std::sqrt(lower.omega * upper.omega)) > 0 ? 1 : -1;
    double log_omega = 0;
    const auto extremum = [&](double parameter) {
      const At at(loop_at_, parameter, options_);
      const auto [where, value] = boost::math::tools::brent_find_minima(
          [&](double x) { return -sign * at.search.rate_defect(std::exp(x)); }, from, to, 30);
      log_omega = where;
      return value;
    };
    const double at_more = extremum(more.parameter);
    const double at_fewer = extremum(fewer.parameter);
    if (!((at_more > 0) != (at_fewer > 0))) return;  // they did not meet: one has left the range, and another one too
    const double where = root_of(extremum, more.parameter, fewer.parameter, at_more, at_fewer);
    events.push_back({CycleEventKind::fold, where, std::exp(log_omega), lower.admissible || upper.admissible, {}});
  }

  // One cycle at both values.
  void follow(const Sample& a, const SymmetricCycle& at_a, const Sample& b, const SymmetricCycle& at_b) {
    const Piece piece{a.parameter, b.parameter, at_a.omega, at_b.omega};
    if (at_a.admissible != at_b.admissible) {
      const double where = bisected(piece, [&](const At& at, double omega) {
        return at.search.inadmissibility(omega).empty() == at_a.admissible;
      });
      const double lost_at = at_a.admissible ? b.parameter : a.parameter;
      events.push_back(
          {CycleEventKind::admissibility, where, piece.guess(where), true, reason_beyond(piece, where, lost_at)});
      refine_omega(piece, events.back());
    }
    if (at_a.stability.stable == at_b.stability.stable) return;
    const std::optional<double> breaking = symmetry_breaking(piece);
    if (breaking) {
      events.push_back({CycleEventKind::symmetry_breaking,
                        *breaking,
                        piece.guess(*breaking),
                        at_a.admissible || at_b.admissible,
                        {}});
    } else {
      std::complex<double> multiplier = 0;
      const double where = bisected(piece, [&](const At& at, double omega) {
        const CycleStability stability = at.search.cycle_at(omega).stability;
        if (std::isfinite(std::abs(stability.dominant))) multiplier = stability.dominant;
        return stability.stable == at_a.stability.stable;
      });
      // A real multiplier of 1 is a fold, which is found by its cycles.
      if (multiplier.imag() == 0 && multiplier.real() > 0) return;
      events.push_back({multiplier.imag() == 0 ? CycleEventKind::symmetry_breaking : CycleEventKind::torus,
                        where,
                        piece.guess(where),
                        at_a.admissible || at_b.admissible,
                        {}});
    }
    refine_omega(piece, events.back());
  }

  // Why there is no motion right beyond a limit, towards a value where there is none.
  [[nodiscard]] std::string reason_beyond(const Piece& piece, double limit, double towards) const {
    std::string reason;
    for (double share = 1e-4; share <= 1 && reason.empty(); share *= 10) {
      const double beyond = limit + share * (towards - limit);
      const At at(loop_at_, beyond, options_);
      reason = at.search.inadmissibility(omega_near(at, piece.guess(beyond)));
    }
    return reason;
  }

  // The frequency next to a guess; the guess where there is none.
  [[nodiscard]] static double omega_near(const At& at, double guess) {
    const auto defect = [&](double omega) { return at.search.rate_defect(omega); };
    for (double width = 1e-4; width < 0.5; width *= 4) {
      const double low = guess / (1 + width), high = guess * (1 + width);
      const double at_low = defect(low), at_high = defect(high);
      if ((at_low > 0) != (at_high > 0)) return root_of(defect, low, high, at_low, at_high);
    }
    return guess;
  }
  void refine_omega(const Piece& piece, CycleEvent& event) const {
    const At at(loop_at_, event.parameter, options_);
    event.omega = omega_near(at, piece.guess(event.parameter));
  }

  // Where a property of the cycle that holds at the first value ends.
  template <typename Holds>
  [[nodiscard]] double bisected(Piece piece, const Holds& holds) const {
    const double close_enough = 1e-11 * std::max(std::abs(piece.from), std::abs(piece.to - piece.from));
    while (std::abs(piece.to - piece.from) > close_enough) {
      const double middle = 0.5 * (piece.from + piece.to);
      if (middle == piece.from || middle == piece.to) break;
      const At at(loop_at_, middle, options_);
      const double omega = omega_near(at, piece.guess(middle));
      if (holds(at, omega)) {
        piece.from = middle;
        piece.omega_from = omega;
      } else {
        piece.to = middle;
        piece.omega_to = omega;
      }
    }
    return 0.5 * (piece.from + piece.to);
  }

  [[nodiscard]] std::optional<double> symmetry_breaking(const Piece& piece) const {
    const auto defect = [&](double parameter) {
      const At at(loop_at_, parameter, options_);
      return at.search.symmetry_defect(omega_near(at, piece.guess(parameter)));
    };
    const double at_from = defect(piece.from), at_to = defect(piece.to);
    if ((at_from > 0) == (at_to > 0)) return std::nullopt;
    return root_of(defect, piece.from, piece.to, at_from, at_to);
  }

  const std::function<ControlLoop(double)>& loop_at_;
  const LimitCycleOptions& options_;
};

}  // namespace

std::string_view to_string(CycleEventKind kind) {
  return frac::detail::spelling(kind_names, kind);
}

CycleContinuation continue_cycles(const std::function<ControlLoop(double)>& loop_at,
                                  const std::vector<double>& parameters, const LimitCycleOptions& options, int starts) {
  const auto is_out_of_order = [&](double a, double b) {
    return !(parameters.front() < parameters.back() ? a < b : a > b);
  };
  if (parameters.size() < 2 ||
      std::adjacent_find(parameters.begin(), parameters.end(), is_out_of_order) != parameters.end()) {
    throw std::invalid_argument("cycles are followed over two or more values that rise or fall strictly");
  }
  CycleContinuation result;
  Continuation continuation(loop_at, options);
  std::vector<Sample> samples;
  for (const double parameter : parameters) {
    const ControlLoop loop = loop_at(parameter);
    result.samples.push_back({parameter, symmetric_cycles(loop, options)});
    samples.push_back({parameter, result.samples.back().found.cycles});
  }
  for (std::size_t i = 0; i + 1 < samples.size(); ++i) continuation.between(samples[i], samples[i + 1]);
  result.events = std::move(continuation.events);
  const bool rises = parameters.front() < parameters.back();
  std::sort(result.events.begin(), result.events.end(), [&](const CycleEvent& a, const CycleEvent& b) {
    return rises ? a.parameter < b.parameter : a.parameter > b.parameter;
  });
  // Between events nothing changes, so that one value in between decides.
  std::vector<double> ends{parameters.front()};
  for (const CycleEvent& event : result.events) {
    if (event.parameter != ends.back()) ends.push_back(event.parameter);
  }
  if (parameters.back() != ends.back()) ends.push_back(parameters.back());
  for (std::size_t i = 0; i + 1 < ends.size(); ++i) {
    const std::vector<SymmetricCycle> cycles = continuation.sample(0.5 * (ends[i] + ends[i + 1])).cycles;
    const auto is_motion = [](const SymmetricCycle& cycle) { return cycle.admissible; };
    const auto is_stable = [](const SymmetricCycle& cycle) { return cycle.admissible && cycle.stability.stable; };
    if (std::none_of(cycles.begin(), cycles.end(), is_motion))
      detail::add_interval(result.without_cycles, ends[i], ends[i + 1]);
    if (std::none_of(cycles.begin(), cycles.end(), is_stable))
      detail::add_interval(result.without_stable_cycles, ends[i], ends[i + 1]);
  }
  detail::CycleBranches branches(loop_at, parameters);
  for (const CycleEvent& event : result.events) {
    if (event.kind == CycleEventKind::symmetry_breaking && event.is_admissible) branches.add_from(event);
  }
  const auto take_out = [&](const CycleBranch& branch) {
    result.without_cycles = detail::without(result.without_cycles, branch.admissible);
    result.without_stable_cycles = detail::without(result.without_stable_cycles, branch.stable);
  };
  for (const CycleBranch& branch : branches.found) take_out(branch);
  double before = std::numeric_limits<double>::quiet_NaN();
  for (const double parameter : parameters) {
    const double last = std::exchange(before, parameter);
    const bool is_open =
        std::any_of(result.without_stable_cycles.begin(), result.without_stable_cycles.end(),
                    [&](const ParameterInterval& each) { return each.from <= parameter && parameter <= each.to; });
    if (starts == 0 || !is_open) continue;
    const ControlLoop loop = loop_at(parameter);
    // Such loops are not simulated.
    if (loop.measured() == Output::x2 && loop.controller().delay() > 0) continue;
    result.simulated.push_back(parameter);
    ImpactCycleOptions seeded;
    seeded.starts = starts;
    seeded.harmonics = 1;
    for (const ImpactCycle& cycle : impact_cycles(loop, seeded).cycles) {
      if (cycle.symmetric && cycle.impacts.size() == 2 && cycle.rests.empty()) continue;
      if (cycle.rests.empty()) {
        branches.add_found(cycle, parameter);
        for (const CycleBranch& branch : branches.found) take_out(branch);
      } else {
        branches.add_resting(cycle, parameter, last);
      }
    }
  }
  for (const CycleBranch& branch : branches.found) take_out(branch);
  result.branches = std::move(branches.found);
  return result;
}

}  // namespace backlash
