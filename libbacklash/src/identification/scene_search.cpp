// SPDX-License-Identifier: BSD-3-Clause
#include "scene_search.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "frac/parallel_for.hpp"
#include "scene_adequacy.hpp"
#include "scene_evidence.hpp"

namespace backlash::detail {
namespace {

// Before the table of irregular motion is made, to see whether all the data can be explained without; from them the
// orbits of two impacts alone are fitted, too, of which some are pursued.
constexpr std::size_t regular_starts = 48;
constexpr std::size_t two_impact_pursued = 4;
constexpr std::size_t starts_of_full_look = 32;
// Places that are followed with the table, and of their estimates those that are followed with exact motions.  Those
// of much worse evidence than the best are not: a few steps take a glance only so far, and the table is good to 1 %.
constexpr std::size_t roughly_settled = 20;
constexpr double worth_a_rough_look = 400;
constexpr std::size_t settled_at_most = 8;
constexpr double worth_settling = 100;
// At small restitution chatter ends after few impacts, whose number changes with restitution: estimates lie between the
// changes, one beside the other, and of each interval a start is followed.
constexpr double small_restitution = 0.1;
constexpr std::array<double, 7> restitution_ladder = {0, 0.003, 0.007, 0.015, 0.03, 0.05, 0.075};
// -2 ln of odds of 150 to 1.
constexpr double rival_deviance = 10;
// At small restitution, where the table of irregular motion, which is interpolated, may prefer the wrong one of two
// estimates by a few units for each of ten or twenty points.
constexpr double rival_deviance_at_small_restitution = 40;
// Estimates of which simulations tell what they do at the points they leave out, and how much worse than the best these
// may be before that is known.
constexpr std::size_t simulated_at_most = 6;
constexpr double worth_simulating = 300;
// Estimates that agree to this are one.
constexpr double same_estimate = 1e-4;
// Places that agree to this lead to the same estimate.
constexpr double same_place = 0.01;

bool agree(const LocalScene& one, const LocalScene& other, double within) {
  return std::abs(one.theta[1] + one.theta[2] - other.theta[1] - other.theta[2]) < within &&
         std::abs(one.theta[3] - other.theta[3]) < within && std::abs(one.theta[4] - other.theta[4]) < within &&
         std::abs(one.theta[5] - other.theta[5]) < within && std::abs(one.theta[6] - other.theta[6]) < within;
}

bool better(const LocalScene& one, const LocalScene& other) {
  return one.deviance < other.deviance;
}

// Every point lies on its motion, and what is left of them is noise.
bool complete(const SceneData& data, const SceneBounds& bounds, const LocalScene& local) {
  return local.usable &&
         std::all_of(local.choices.begin(), local.choices.end(),
                     [](const PointChoice& choice) { return choice.used; }) &&
         scene_adequacy(data, local.choices, bounds.free_count()).misfits.empty();
}

// Of estimates, best first, those that are not much worse than the best one, which the search has.
void take_rivals(const std::vector<LocalScene>& settled, double allowed, SceneSearch& search) {
  for (const LocalScene& local : settled) {
    if (agree(local, search.best, same_estimate)) {
      ++search.starts_at_best;
    } else if (local.deviance < search.best.deviance + allowed &&
               std::none_of(search.rivals.begin(), search.rivals.end(),
                            [&](const LocalScene& other) { return agree(local, other, same_estimate); })) {
      search.rivals.push_back(local);
    }
  }
}

// The best places that are not near each other.
std::vector<SceneVector> places_of(const std::vector<LocalScene>& sorted, std::size_t most,
                                   double worth = std::numeric_limits<double>::infinity()) {
  std::vector<SceneVector> places;
  std::vector<const LocalScene*> taken;
  for (const LocalScene& local : sorted) {
    if (places.size() == most || local.deviance > sorted.front().deviance + worth) break;
    const bool is_known =
        std::any_of(taken.begin(), taken.end(), [&](const auto* other) { return agree(local, *other, same_place); });
    if (is_known) continue;
    taken.push_back(&local);
    places.push_back(local.theta);
  }
  return places;
}

// Where a search of more parameters begins: at the best scene and at its rivals, which may be nearer to the truth.
std::vector<SceneVector> places_of(const SceneSearch& search) {
  constexpr std::size_t pursued = 3;
  if (!search.best.usable) return {};
  std::vector<LocalScene> scenes = {search.best};
  scenes.insert(scenes.end(), search.rivals.begin(), search.rivals.end());
  return places_of(scenes, pursued);
}

class SceneSearcher {
 public:
  SceneSearcher(const SceneData& data, const KnownScene& known, int threads)
      : data_(data), known_(known), threads_(threads) {}

  [[nodiscard]] std::size_t starts() const { return tried_; }

  std::vector<LocalScene> solve(const std::vector<SceneVector>& starts, Effort effort, Motions motions) {
    std::vector<LocalScene> solved(starts.size());
    frac::parallel_for(starts.size(), threads_, [&](std::size_t i) {
      solved[i] = solve_scene(data_, known_.bounds, starts[i], effort, motions);
    });
    std::erase_if(solved, [](const LocalScene& local) { return !local.usable; });
    std::stable_sort(solved.begin(), solved.end(), better);
    return solved;
  }

  void glance(const std::vector<SceneVector>& starts) {
    tried_ += starts.size();
    for (LocalScene& local : solve(starts, Effort::glance, Motions::all)) glances_.push_back(std::move(local));
  }

  // The best places seen so far, each followed to its estimate, best first.
  std::vector<LocalScene> settle() {
    std::stable_sort(glances_.begin(), glances_.end(), better);
    const auto rough = solve(places_of(glances_, roughly_settled, worth_a_rough_look), Effort::rough, Motions::all);
    return solve(places_of(rough, settled_at_most, worth_settling), Effort::settle, Motions::all);
  }

  // Estimates from more starts, best first; those beside an estimate that is there already lead back to it.
  void settle_too(const std::vector<SceneVector>& starts, std::vector<LocalScene>& settled) {
    std::vector<SceneVector> further;
    for (const SceneVector& start : starts) {
      LocalScene place;
      place.theta = start;
      const bool is_known = std::any_of(settled.begin(), settled.end(),
                                        [&](const LocalScene& local) { return agree(local, place, same_estimate); });
      if (!is_known) further.push_back(start);
    }
    tried_ += further.size();
    for (LocalScene& local : solve(further, Effort::settle, Motions::all)) settled.push_back(std::move(local));
    std::stable_sort(settled.begin(), settled.end(), better);
  }

  // What the best estimates do at points that they leave out may put another one first.
  void explain(std::vector<LocalScene>& settled) const {
    std::vector<LocalScene*> chosen;
    for (LocalScene& local : settled) {
      if (chosen.size() == simulated_at_most || local.deviance > settled.front().deviance + worth_simulating) break;
      const bool is_known = std::any_of(chosen.begin(), chosen.end(),
                                        [&](const auto* other) { return agree(local, *other, same_estimate); });
      if (!is_known) chosen.push_back(&local);
    }
    frac::parallel_for(chosen.size(), threads_,
                       [&](std::size_t i) { explain_left_out(data_, known_.bounds.free_count(), *chosen[i]); });
    std::stable_sort(settled.begin(), settled.end(), better);
  }

  // The best estimate at other small restitutions.
  [[nodiscard]] std::vector<SceneVector> small_restitutions(const LocalScene& best) const {
    std::vector<SceneVector> starts;
    if (!known_.bounds.is_free(3) || !(best.theta[3] < small_restitution)) return starts;
    for (const double restitution : restitution_ladder) {
      if (restitution < known_.bounds.lower[3] || restitution > known_.bounds.upper[3]) continue;
      starts.push_back(best.theta);
      starts.back()[3] = restitution;
    }
    return starts;
  }

 private:
  const SceneData& data_;
  const KnownScene& known_;
  int threads_;
  std::vector<LocalScene> glances_;
  std::size_t tried_ = 0;
};

std::vector<SceneVector> given_start(const KnownScene& known, const std::vector<SceneVector>& others) {
  const bool has_start =
      std::any_of(known.start.begin(), known.start.end(), [](const auto& s) { return s.has_value(); });
  if (!has_start) return {};
  SceneVector given = others.empty() ? known.bounds.lower : others.front();
  for (std::size_t k = 0; k < 4; ++k) {
    if (others.empty() && known.bounds.is_free(k)) given[k] = 0.5 * (known.bounds.lower[k] + known.bounds.upper[k]);
    if (known.start[k]) given[k] = *known.start[k];
  }
  return {given};
}

}  // namespace

SceneSearch search_scene(const SceneData& data, const KnownScene& known, const std::vector<double>& jumps,
                         int threads) {
  SceneSearcher searcher(data, known, threads);
  const auto starts_of = [&](bool rate_irregular, std::size_t count) {
    return scene_starts(data, known.bounds, known.fixed, jumps, rate_irregular, count);
  };
  std::vector<SceneVector> regular = law_starts(data, known.bounds, known.fixed, regular_starts);
  if (regular.empty()) regular = starts_of(false, regular_starts);
  searcher.glance(given_start(known, regular));
  searcher.glance(regular);
  std::vector<LocalScene> settled = searcher.settle();
  const std::vector<SceneVector> parts =
      places_of(searcher.solve(regular, Effort::settle, Motions::two_impact), two_impact_pursued);
  if (settled.empty() || !complete(data, known.bounds, settled.front())) {
    searcher.glance(parts);
    searcher.glance(starts_of(true, starts_of_full_look));
    settled = searcher.settle();
  }
  // One valley of sticking motion may hold all places that were settled, while orbits of two impacts explain the data
  // as well; and the table is no better than 1 %, so that a glance at it leads away from what few points on these show.
  searcher.settle_too(parts, settled);
  if (!settled.empty()) searcher.settle_too(searcher.small_restitutions(settled.front()), settled);
  SceneSearch result;
  result.starts = searcher.starts();
  if (settled.empty()) return result;
  searcher.explain(settled);
  result.best = settled.front();
  take_rivals(settled, result.best.theta[3] < small_restitution ? rival_deviance_at_small_restitution : rival_deviance,
              result);
  return result;
}

namespace {

// Contact times, in units of 1/omega, from which longer contacts are looked for: .01, .03 and .1 of a period.
constexpr std::array<double, 3> contact_times = {0.06, 0.2, 0.6};
constexpr std::size_t starts_of_contact_time = 12;
constexpr std::size_t longer_pursued = 2;

// See ContactSearch::evidence.
double evidence_over(const SceneData& data, LocalScene hard, LocalScene compliant, std::size_t parameters) {
  using Kind = PointChoice::Kind;
  for (std::size_t i = 0; i < hard.choices.size(); ++i) {
    if (hard.choices[i].kind == Kind::none && compliant.choices[i].kind == Kind::none)
      compliant.choices[i] = hard.choices[i];
  }
  const auto deviance = [&](const LocalScene& scene) {
    return scene_evidence(data, scene.choices, parameters, Effort::settle).deviance;
  };
  return deviance(hard) - deviance(compliant);
}

// The places at which orbits of two longer contacts, in closed form, explain the data best.
std::vector<SceneVector> longer_contacts(const SceneData& data, const KnownScene& known, SceneSearcher& searcher,
                                         const std::vector<SceneVector>& beside) {
  std::vector<SceneVector> places = law_starts(data, known.bounds, known.fixed, starts_of_contact_time);
  if (places.empty()) places = scene_starts(data, known.bounds, known.fixed, {}, false, starts_of_contact_time);
  std::vector<SceneVector> starts;
  for (const double time : contact_times) {
    for (SceneVector place : places) {
      place[4] = std::clamp(time, known.bounds.lower[4], known.bounds.upper[4]);
      starts.push_back(place);
    }
  }
  starts.insert(starts.end(), beside.begin(), beside.end());
  return places_of(searcher.solve(starts, Effort::settle, Motions::two_impact), longer_pursued);
}

}  // namespace

ContactSearch search_contact(const SceneData& data, const KnownScene& known, const SceneSearch& hard, int threads) {
  ContactSearch result{{}, std::numeric_limits<double>::infinity()};
  SceneSearcher searcher(data, known, threads);
  std::vector<SceneVector> starts = places_of(hard);
  for (SceneVector& start : starts) start[4] = std::clamp(start[4], known.bounds.lower[4], known.bounds.upper[4]);
  std::vector<LocalScene> settled = searcher.solve(starts, Effort::settle, Motions::all);
  if (known.bounds.is_free(4) && (settled.empty() || !complete(data, known.bounds, settled.front()))) {
    searcher.settle_too(longer_contacts(data, known, searcher, starts), settled);
  }
  result.scenes.starts = hard.starts + starts.size() + searcher.starts();
  if (settled.empty()) return result;
  searcher.explain(settled);
  result.scenes.best = settled.front();
  if (hard.best.usable) {
    KnownScene hard_scene = known;
    hard_scene.bounds.lower[4] = hard_scene.bounds.upper[4] = 0;
    const LocalScene best = solve_scene(data, hard_scene.bounds, hard.best.theta, Effort::settle, Motions::all);
    result.evidence = evidence_over(data, best, result.scenes.best, known.bounds.free_count());
  }
  take_rivals(settled, rival_deviance, result.scenes);
  return result;
}

FrictionSearch search_friction(const SceneData& data, const KnownScene& known, const SceneSearch& without,
                               int threads) {
  constexpr std::size_t rubbing_pursued = 4;
  FrictionSearch result{{}, std::numeric_limits<double>::infinity()};
  SceneSearcher searcher(data, known, threads);
  const auto within = [&](std::vector<SceneVector> starts) {
    for (SceneVector& start : starts)
      for (std::size_t k = 3; k < scene_size; ++k)
        start[k] = std::clamp(start[k], known.bounds.lower[k], known.bounds.upper[k]);
    return starts;
  };
  std::vector<LocalScene> settled;
  searcher.settle_too(within(places_of(without)), settled);
  searcher.settle_too(within(rubbing_starts(data, known.bounds, known.fixed, rubbing_pursued)), settled);
  result.scenes.starts = without.starts + searcher.starts();
  if (settled.empty()) return result;
  result.scenes.best = settled.front();
  if (without.best.usable)
    result.evidence = evidence_over(data, without.best, result.scenes.best, known.bounds.free_count());
  take_rivals(settled, rival_deviance, result.scenes);
  return result;
}

}  // namespace backlash::detail
