// SPDX-License-Identifier: BSD-3-Clause
#include "rational_growth.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "frac/identification/model_library.hpp"

namespace frac::detail {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

bool exact(const RationalProblem& problem, const RationalFit& fit) {
  return fit.cost <= problem.negligible_cost();
}

/// Whether the fit misses the data by more than a tenth: it has not found their shape.
bool is_far(const RationalProblem& problem, const RationalFit& fit) {
  return fit.cost > 0.01 * problem.data_power();
}

/// Whether the fit misses the data by less than half: it follows some of them.
bool follows_some(const RationalProblem& problem, const RationalFit& fit) {
  return fit.cost < 0.25 * problem.data_power();
}

/// Delays from which a search is started, rising, in units of the middle of the band: a fifth of a turn at either end
/// and between, and every fifth of a turn at the upper end, where the basins of many turns are half a turn wide, as far
/// as the spacing of the points tells one from another.
std::vector<double> delays(const RationalProblem& problem) {
  constexpr double fifth = 1.2;
  constexpr int most = 400;
  std::vector<double> result;
  for (double at = problem.log_lower(); at <= problem.log_upper() + 0.1;
       at += std::max(0.7, (problem.log_upper() - problem.log_lower()) / 12)) {
    result.push_back(fifth * std::exp(-at));
  }
  const double step = fifth * std::exp(-problem.log_upper());
  for (int i = 1; i <= most; ++i) result.push_back(i * step);
  std::erase_if(result, [&](double delay) { return delay > problem.longest_delay(); });
  std::sort(result.begin(), result.end());
  return result;
}

/// @param starts  with their costs at few points
RationalFit best_refined(const RationalProblem& problem, std::vector<RationalFit> starts, std::size_t tried) {
  std::stable_sort(starts.begin(), starts.end(),
                   [](const RationalFit& a, const RationalFit& b) { return a.cost < b.cost; });
  RationalFit best{{}, infinity, 0};
  for (std::size_t i = 0; i < std::min(tried, starts.size()); ++i) {
    if (!std::isfinite(starts[i].cost)) break;
    RationalFit fit = problem.few().refine(starts[i].shape, scouting.in_reach_of(best.cost));
    if (fit.cost < best.cost) best = std::move(fit);
  }
  if (std::isfinite(best.cost)) best = problem.refine(best.shape, thorough);
  return best;
}

/// The shape with its slowest pole at 0, if that lies below the band.
std::optional<RationalShape> with_integrator(const RationalProblem& problem, const RationalShape& shape) {
  if (shape.low > 0 || shape.factors.empty() || shape.factors.front().pair) return std::nullopt;
  if (!(shape.factors.front().log_size < problem.log_lower() + 0.5)) return std::nullopt;
  RationalShape result = shape;
  result.factors.erase(result.factors.begin());
  ++result.integrators;
  return result;
}

}  // namespace

double schwarz(const RationalProblem& problem, const RationalFit& fit) {
  return schwarz(problem, fit.likely_cost, fit.parameters);
}

double price_of_search(const RationalProblem& problem, const RationalShape& shape) {
  double price = 0;
  for (const PoleFactor& factor : shape.factors)
    price += factor.pair ? price_of_point(problem) : price_of_place(problem);
  return price;
}

RationalGrowth::RationalGrowth(const RationalProblem& problem, const RationalKind& kind, std::size_t excess,
                               std::size_t most_zeros)
    : problem_(problem), kind_(kind), excess_(excess), most_zeros_(most_zeros) {
  RationalShape shape;
  shape.degree = std::min(excess, most_zeros);
  shape.delayed = kind.delayed;
  shape.free_order = kind.free_order;
  if (!kind.delayed) {
    members_.push_back(problem.at(shape));
    return;
  }
  std::vector<RationalFit> starts;
  for (const double delay : delays(problem)) {
    shape.delay = delay;
    starts.push_back(problem.few().at(shape));
  }
  std::vector<RationalFit> minima;
  add_local_minima(std::move(starts), minima);
  members_.push_back(best_refined(problem, std::move(minima), 3));
}

void RationalGrowth::add_real_poles(double order, std::vector<RationalFit>& starts) const {
  for (const double sign : {1.0, -1.0}) {
    // One part alone does not tell a pole from its mirror image.
    if (sign < 0 && (problem_.one_part() || problem_.poles() != Poles::anywhere)) continue;
    std::vector<PoleFactor> poles;
    for (const double place : places(problem_, sign > 0 ? 14 : 6)) poles.push_back({false, place, 0, sign});
    add_local_minima(along(members_.back().shape, poles, order), starts);
  }
}

void RationalGrowth::add_pairs(double order, std::vector<RationalFit>& starts) const {
  const RationalShape& before = members_[members_.size() - 2].shape;
  // Resonances are narrow: a pair is also tried at the points the smaller model misses most.
  std::vector<double> pair_places = places(problem_, 10);
  const std::vector<double> missed = problem_.residual_sizes(before);
  for (int peak = 0; peak < 3; ++peak) {
    std::size_t most = 0;
    double largest = -1;
    for (std::size_t i = 0; i < missed.size(); ++i) {
      const bool top = (i == 0 || missed[i] >= missed[i - 1]) && (i + 1 == missed.size() || missed[i] > missed[i + 1]);
      const bool taken =
          std::find(pair_places.begin(), pair_places.end(), problem_.log_omega()[i]) != pair_places.end();
      if (top && !taken && missed[i] > largest) {
        largest = missed[i];
        most = i;
      }
    }
    if (largest >= 0) pair_places.push_back(problem_.log_omega()[most]);
  }
  std::sort(pair_places.begin(), pair_places.end());
  // In powers of s^a a pair without resonance is no pair of real poles yet.
  const std::vector<double> dampings = kind_.free_order ? std::vector{0.02, 0.3, 0.8} : std::vector{0.02, 0.3};
  for (const double damping : dampings) {
    std::vector<PoleFactor> pairs;
    for (const double place : pair_places) pairs.push_back({true, place, damping, 1});
    add_local_minima(along(before, pairs, order), starts);
  }
}

RationalShape RationalGrowth::with(const RationalShape& from, const PoleFactor& factor, double order) const {
  RationalShape shape = from;
  shape.factors.push_back(factor);
  shape.degree = std::min(members_.size() + excess_, most_zeros_);
  shape.order = order;
  return shape;
}

std::vector<RationalFit> RationalGrowth::along(RationalShape from, const std::vector<PoleFactor>& factors,
                                               double order) const {
  from.order = order;
  RationalProblem::Linear linear;
  const RationalProblem& few = problem_.few();
  const bool is_seen = few.solve(few.columns(from), linear);
  std::vector<RationalFit> fits;
  for (const PoleFactor& factor : factors) {
    RationalShape shape = with(from, factor, order);
    const bool contains = shape.degree - from.degree == (factor.pair ? 2 : 1);
    fits.push_back(is_seen && contains ? RationalFit{shape, few.cost_with(linear, few.columns_of(factor, from)), 0}
                                       : few.at(shape));
  }
  return fits;
}

// One pole more, where a response falls by many decades, is worth nothing under relative residuals until the slope of
// its tail is right: all poles are put to one place, or a spread of it.
void RationalGrowth::add_steep_ends(double order, std::vector<RationalFit>& starts) const {
  const std::size_t poles = members_.size();
  for (const double spread : {0.3, 1.5}) {
    std::vector<RationalFit> steep;
    for (const double place : places(problem_, 10)) {
      RationalShape shape = members_.back().shape;
      shape.factors.clear();
      for (std::size_t i = 0; i + 1 < poles; ++i) {
        const double share = poles > 1 ? static_cast<double>(i) / static_cast<double>(poles - 1) - 0.5 : 0;
        shape.factors.push_back({false, place + spread * share, 0, 1});
      }
      shape.integrators = 0;
      shape.low = 0;
      steep.push_back(problem_.few().at(with(shape, {false, place + spread / 2, 0, 1}, order)));
    }
    add_local_minima(std::move(steep), starts);
  }
}

std::vector<double> RationalGrowth::orders() const {
  if (!kind_.free_order) return {1};
  if (members_.size() <= 2) return {1, 0.8, 0.6, 0.4};
  const double last = members_.back().shape.order;
  // Half the order with more poles may be what the smaller models stood for.
  return {last, last > 0.7 ? 0.5 : 1.0};
}

void RationalGrowth::extend(const RationalShape* contained) {
  const RationalShape last = members_.back().shape;
  std::vector<RationalFit> starts;
  for (const double order : orders()) {
    add_real_poles(order, starts);
    if (members_.size() >= 2) add_pairs(order, starts);
  }
  if (members_.size() >= 2 && is_far(problem_, members_.back())) add_steep_ends(last.order, starts);
  if (last.delayed) {
    // A longer or shorter delay may suit the richer model better.
    RationalShape shape = last;
    for (const double factor : {0.0, 0.3, 3.0}) {
      shape.delay = last.delay * factor;
      std::vector<PoleFactor> poles;
      for (const double place : places(problem_, 4)) poles.push_back({false, place, 0, 1});
      for (RationalFit& fit : along(shape, poles, last.order)) starts.push_back(std::move(fit));
    }
  }
  RationalFit best = best_refined(problem_, std::move(starts), 4);
  if (contained) {
    RationalShape freed = *contained;
    freed.free_order = kind_.free_order;
    RationalFit from_contained = problem_.refine(freed, thorough);
    if (from_contained.cost < best.cost) best = std::move(from_contained);
  }
  // A member contains the one before, with a pole that a zero cancels.
  if (!(best.cost <= members_.back().cost)) {
    RationalFit same = problem_.at(with(last, {false, problem_.log_upper() + 2, 0, 1}, last.order));
    if (same.cost < best.cost) best = std::move(same);
  }
  members_.push_back(std::move(best));
}

RationalFit RatioGrowths::member_of(Slot& slot, const RationalProblem& problem, bool delayed, std::size_t most_zeros,
                                    std::size_t poles) {
  const std::lock_guard lock(slot.mutex);
  if (!slot.growing) slot.growing = std::make_unique<Growing>(problem, delayed, most_zeros);
  RationalGrowth& growth = slot.growing->growth;
  while (growth.members().size() <= poles) growth.extend();
  return growth.members()[poles];
}

RationalFit RatioGrowths::member(const RationalProblem& problem, bool delayed, std::size_t poles) {
  return member_of(with_zeros_[delayed ? 1 : 0], problem, delayed, any_zeros, poles);
}

RationalFit RatioGrowths::without_zeros(const RationalProblem& problem, bool delayed, std::size_t poles) {
  return member_of(without_zeros_[delayed ? 1 : 0], problem, delayed, 0, poles);
}

const RationalLadder& RatioGrowths::ladder(const RationalProblem& problem) {
  const std::lock_guard lock(ladder_mutex_);
  const RationalFamily family;
  if (!ladder_) ladder_ = grow_rational(problem, family.fewest_poles, family.most_poles, {}, *this);
  return *ladder_;
}

RatioGrowths& RatioGrowths::stable() {
  const std::lock_guard lock(stable_mutex_);
  if (!stable_) stable_ = std::make_unique<RatioGrowths>();
  return *stable_;
}

RationalFit without_idle_parts(const RationalProblem& problem, const RationalFit& fit) {
  const auto moves_of = [&](const RationalFit& best, int round) {
    std::vector<RationalShape> moves;
    const RationalShape& shape = best.shape;
    if (shape.degree > shape.low) {
      moves.push_back(shape);
      --moves.back().degree;
      if (shape.integrators == 0) {
        moves.push_back(shape);
        ++moves.back().low;
      }
    }
    if (shape.degree <= shape.poles() && round == 0) {
      moves.push_back(shape);
      ++moves.back().degree;
    }
    if (const auto integrating = with_integrator(problem, shape)) moves.push_back(*integrating);
    return moves;
  };
  const auto value_of = [&](const RationalFit& each) { return schwarz(problem, each); };
  return without_idle(problem, fit, &RationalFit::shape, value_of, moves_of);
}

namespace {

/// Whether the data fall faster than 1/s^1.5 at the upper end of the band.  There every zero in the band must be taken
/// back by a pole, and a growth with as many zeros as poles may end where that is done badly; under relative residuals
/// no number of poles is worth anything before there are enough.
bool falls_steeply(const RationalProblem& problem) {
  return problem.end_slope() < -1.5;
}

/// @param excess  see RationalGrowth
RationalLadder grown_ladder(const RationalProblem& problem, std::size_t fewest_poles, std::size_t most_poles,
                            const RationalKind& kind, std::size_t excess, RatioGrowths& ratios) {
  RationalLadder ladder;
  std::optional<RationalGrowth> own;
  if (kind.free_order || excess > 0) own.emplace(problem, kind, excess);
  const bool steep = falls_steeply(problem);
  for (std::size_t order = 0; order <= most_poles; ++order) {
    if (own && order > 0) {
      const bool contains = kind.free_order;
      const RationalFit whole = contains ? ratios.member(problem, kind.delayed, order) : RationalFit{};
      own->extend(contains ? &whole.shape : nullptr);
    }
    const RationalFit member = own ? own->members().back() : ratios.member(problem, kind.delayed, order);
    if (order < fewest_poles) continue;
    if (2 * order + excess + 3 >= problem.rows()) break;
    const auto value_of = [&](const RationalFit& fit) {
      return schwarz(problem, fit) + price_of_search(problem, fit.shape);
    };
    RationalFit simple = without_idle_parts(problem, member);
    if (!own && order > 1 && steep) {
      RationalFit lean = without_idle_parts(problem, ratios.without_zeros(problem, kind.delayed, order));
      if (value_of(lean) < value_of(simple)) simple = std::move(lean);
    }
    const double value = value_of(simple);
    ladder.add(std::move(simple), value);
    const bool begun = !steep || follows_some(problem, ladder.best());
    if (begun && ladder.in_vain >= (is_far(problem, ladder.best()) ? 4u : 2u)) break;
    if (exact(problem, ladder.fits.back())) break;
  }
  return ladder;
}

}  // namespace

RationalLadder grow_rational(const RationalProblem& problem, std::size_t fewest_poles, std::size_t most_poles,
                             const RationalKind& kind, RatioGrowths& ratios) {
  RationalLadder ladder = grown_ladder(problem, fewest_poles, most_poles, kind, 0, ratios);
  if (ladder.fits.empty()) return ladder;
  // A ladder that ended with one zero more than poles was grown without it: a resonance beside such a rise, say, is not
  // seen. With a free order members need no zero to rise.
  const RationalShape& ended = ladder.fits[ladder.chosen].shape;
  if (kind.free_order || ended.degree <= ended.poles()) return ladder;
  RationalLadder steeper = grown_ladder(problem, fewest_poles, most_poles, kind, 1, ratios);
  return steeper.value < ladder.value ? steeper : ladder;
}

RationalFit fit_rational(const RationalProblem& problem, std::size_t zeros, std::size_t poles,
                         const RationalKind& kind) {
  RationalGrowth growth(problem, kind, zeros > poles ? zeros - poles : 0);
  while (growth.members().size() <= poles) growth.extend();
  RationalFit fit = growth.members().back();
  while (fit.shape.degree > zeros) {
    RationalShape shape = fit.shape;
    --shape.degree;
    fit = problem.refine(shape, thorough);
  }
  if (zeros < poles) {
    // With fewer zeros from the beginning poles go other ways.
    RationalGrowth proper(problem, kind, 0, zeros);
    while (proper.members().size() <= poles) proper.extend();
    if (proper.members().back().cost < fit.cost) fit = proper.members().back();
  }
  while (const auto shape = with_integrator(problem, fit.shape)) {
    RationalFit integrating = problem.refine(*shape, thorough);
    // The pole at 0 has one parameter less, so as much as noise gives a parameter is no reason to keep the other.
    const double share = 1 + 4 / static_cast<double>(problem.rows());
    if (!(integrating.cost <= fit.cost * share + problem.rounding_cost())) break;
    fit = std::move(integrating);
  }
  return fit;
}

}  // namespace frac::detail
