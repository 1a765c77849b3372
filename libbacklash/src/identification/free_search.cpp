// SPDX-License-Identifier: BSD-3-Clause
#include "free_search.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "scene_evidence.hpp"

namespace backlash::detail {
namespace {

// Before the table of irregular motion is made, to see whether all the data can be explained without; from them the
// orbits of two impacts alone are fitted, too, of which some are pursued.
constexpr std::size_t regular_starts = 48;
constexpr std::size_t two_impact_pursued = 4;
constexpr std::size_t starts_of_full_look = 32;
// At small restitution chatter ends after few impacts, whose number changes with restitution: estimates lie between the
// changes, one beside the other, and of each interval a start is followed.
constexpr double small_restitution = 0.1;
constexpr std::array<double, 7> restitution_ladder = {0, 0.003, 0.007, 0.015, 0.03, 0.05, 0.075};
// At small restitution, where the table of irregular motion, which is interpolated, may prefer the wrong one of two
// estimates by a few units for each of ten or twenty points.
constexpr double rival_deviance_at_small_restitution = 40;
// Contact times, in units of 1/omega, from which longer contacts are looked for: .01, .03 and .1 of a period.
constexpr std::array<double, 3> contact_times = {0.06, 0.2, 0.6};
constexpr std::size_t starts_of_contact_time = 12;
constexpr std::size_t longer_pursued = 2;
constexpr std::size_t rubbing_pursued = 4;

// What a search of fewer parameters holds at 0 may have other limits.
std::vector<Coordinates> within(const SceneBounds& bounds, std::vector<Coordinates> places) {
  for (Coordinates& place : places)
    for (std::size_t k = 3; k < scene_size; ++k) place[k] = std::clamp(place[k], bounds.lower[k], bounds.upper[k]);
  return places;
}

std::vector<Coordinates> given_start(const KnownScene& known, const std::vector<Coordinates>& others) {
  const bool has_start =
      std::any_of(known.start.begin(), known.start.end(), [](const auto& s) { return s.has_value(); });
  if (!has_start) return {};
  Coordinates given = others.empty() ? known.bounds.lower : others.front();
  for (std::size_t k = 0; k < 4; ++k) {
    if (others.empty() && known.bounds.is_free(k)) given[k] = 0.5 * (known.bounds.lower[k] + known.bounds.upper[k]);
    if (known.start[k]) given[k] = *known.start[k];
  }
  return {given};
}

// The best estimate at other small restitutions.
std::vector<Coordinates> small_restitutions(const SceneBounds& bounds, const LocalScene& best) {
  std::vector<Coordinates> starts;
  if (!bounds.is_free(3) || !(best.theta[3] < small_restitution)) return starts;
  for (const double restitution : restitution_ladder) {
    if (restitution < bounds.lower[3] || restitution > bounds.upper[3]) continue;
    starts.push_back(best.theta);
    starts.back()[3] = restitution;
  }
  return starts;
}

// Where a search of more parameters begins: at the best scene and at its rivals, which may be nearer to the truth.
std::vector<Coordinates> places_of(const SceneSearcher& searcher, const SceneSearch& search,
                                   const SceneBounds& bounds) {
  constexpr std::size_t pursued = 3;
  if (!search.best.usable) return {};
  std::vector<LocalScene> scenes = {search.best};
  scenes.insert(scenes.end(), search.rivals.begin(), search.rivals.end());
  return within(bounds, searcher.places_of(scenes, pursued));
}

// See WiderSearch::evidence.
double evidence_over(const LocalScene& narrow, LocalScene wide, const FreeMasses& family) {
  using Kind = PointChoice::Kind;
  for (std::size_t i = 0; i < narrow.choices.size(); ++i) {
    if (narrow.choices[i].kind == Kind::none && wide.choices[i].kind == Kind::none) wide.choices[i] = narrow.choices[i];
  }
  const auto deviance = [&](const LocalScene& scene) {
    return scene_evidence(family.data(), scene.choices, family.free_count(), scene.motions->accuracy()).deviance;
  };
  const double of_narrow = deviance(narrow), of_wide = deviance(wide);
  if (!std::isfinite(of_narrow) || !std::isfinite(of_wide)) return std::numeric_limits<double>::quiet_NaN();
  return of_narrow - of_wide;
}

// Where the scene of a wider family leads within this one, which the search may have missed.
void add_beside(const FreeMasses& family, const LocalScene& wide, SceneSearch& search, int threads) {
  const SceneSearcher searcher(family, threads);
  std::vector<LocalScene> beside = searcher.solve(within(family.bounds(), {wide.theta}), Effort::settle, Motions::all);
  ++search.starts;
  if (beside.empty()) return;
  searcher.explain(beside);
  LocalScene& scene = beside.front();
  const auto is_same = [&](const LocalScene& other) { return family.agree(scene.theta, other.theta, same_estimate); };
  if (search.best.usable && (is_same(search.best) || !(scene.deviance < search.best.deviance))) return;
  std::erase_if(search.rivals, is_same);
  if (search.best.usable) search.rivals.insert(search.rivals.begin(), std::move(search.best));
  search.best = std::move(scene);
  search.starts_at_best = 1;
  std::erase_if(search.rivals,
                [&](const LocalScene& rival) { return !(rival.deviance < search.best.deviance + rival_deviance); });
}

// The places at which orbits of two longer contacts, in closed form, explain the data best.
std::vector<Coordinates> longer_contacts(const SceneData& data, const KnownScene& known, const SceneSearcher& searcher,
                                         const std::vector<Coordinates>& beside) {
  std::vector<Coordinates> places = law_starts(data, known.bounds, known.fixed, starts_of_contact_time);
  if (places.empty()) places = scene_starts(data, known.bounds, known.fixed, {}, false, starts_of_contact_time);
  std::vector<Coordinates> starts;
  for (const double time : contact_times) {
    for (Coordinates place : places) {
      place[4] = std::clamp(time, known.bounds.lower[4], known.bounds.upper[4]);
      starts.push_back(place);
    }
  }
  starts.insert(starts.end(), beside.begin(), beside.end());
  return searcher.places_of(searcher.solve(starts, Effort::settle, Motions::two_impact), longer_pursued);
}

}  // namespace

SceneSearch search_scene(const SceneData& data, const KnownScene& known, const std::vector<double>& jumps,
                         int threads) {
  const FreeMasses family(data, known);
  SceneSearcher searcher(family, threads);
  const auto starts_of = [&](bool rate_irregular, std::size_t count) {
    return scene_starts(data, known.bounds, known.fixed, jumps, rate_irregular, count);
  };
  std::vector<Coordinates> regular = law_starts(data, known.bounds, known.fixed, regular_starts);
  if (regular.empty()) regular = starts_of(false, regular_starts);
  searcher.glance(given_start(known, regular));
  searcher.glance(regular);
  std::vector<LocalScene> settled = searcher.settle();
  const std::vector<Coordinates> parts =
      searcher.places_of(searcher.solve(regular, Effort::settle, Motions::two_impact), two_impact_pursued);
  if (settled.empty() || !is_complete(family, settled.front())) {
    searcher.glance(parts);
    searcher.glance(starts_of(true, starts_of_full_look));
    settled = searcher.settle();
  }
  // One valley of sticking motion may hold all places that were settled, while orbits of two impacts explain the data
  // as well; and the table is no better than 1 %, so that a glance at it leads away from what few points on these show.
  searcher.settle_too(parts, settled);
  if (!settled.empty()) searcher.settle_too(small_restitutions(known.bounds, settled.front()), settled);
  searcher.explain(settled);
  const bool is_small = !settled.empty() && settled.front().theta[3] < small_restitution;
  return searcher.best_of(settled, is_small ? rival_deviance_at_small_restitution : rival_deviance);
}

WiderSearch search_contact(const SceneData& data, const KnownScene& known, const SceneSearch& hard, int threads) {
  const FreeMasses family(data, known);
  SceneSearcher searcher(family, threads);
  std::vector<LocalScene> settled;
  const std::vector<Coordinates> starts = places_of(searcher, hard, known.bounds);
  searcher.settle_too(starts, settled);
  if (known.bounds.is_free(4) && (settled.empty() || !is_complete(family, settled.front()))) {
    searcher.settle_too(longer_contacts(data, known, searcher, starts), settled);
  }
  searcher.explain(settled);
  WiderSearch result{searcher.best_of(settled, rival_deviance), std::numeric_limits<double>::infinity()};
  result.scenes.starts += hard.starts;
  if (hard.best.usable && result.scenes.best.usable) {
    const FreeMasses hard_family(data, with_hard_contacts(known));
    result.evidence = evidence_over(solve_scene(hard_family, hard.best.theta, Effort::settle, Motions::all),
                                    result.scenes.best, family);
  }
  return result;
}

WiderSearch search_friction(const SceneData& data, const KnownScene& known, const KnownScene& smooth,
                            SceneSearch& without, int threads) {
  const FreeMasses family(data, known);
  SceneSearcher searcher(family, threads);
  std::vector<LocalScene> settled;
  searcher.settle_too(places_of(searcher, without, known.bounds), settled);
  const auto rubbing = rubbing_starts(data, known.bounds, known.fixed, rubbing_pursued);
  searcher.settle_too(within(known.bounds, rubbing), settled);
  std::erase_if(settled, [](const LocalScene& local) { return !std::isfinite(local.deviance); });
  WiderSearch result{searcher.best_of(settled, rival_deviance), std::numeric_limits<double>::infinity()};
  result.scenes.starts += without.starts;
  if (!result.scenes.best.usable) return result;
  add_beside(FreeMasses(data, smooth), result.scenes.best, without, threads);
  if (without.best.usable) result.evidence = evidence_over(without.best, result.scenes.best, family);
  return result;
}

}  // namespace backlash::detail
