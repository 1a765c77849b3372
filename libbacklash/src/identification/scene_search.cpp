// SPDX-License-Identifier: BSD-3-Clause
#include "scene_search.hpp"

#include <algorithm>
#include <utility>

#include "frac/parallel_for.hpp"
#include "scene_adequacy.hpp"
#include "scene_evidence.hpp"

namespace backlash::detail {
namespace {

// Places that are followed with the table, and of their estimates those that are followed with exact motions.  Those
// of much worse evidence than the best are not: a few steps take a glance only so far, and the table is good to 1 %.
constexpr std::size_t roughly_settled = 20;
constexpr double worth_a_rough_look = 400;
constexpr std::size_t settled_at_most = 8;
// Estimates of which simulations tell what they do at the points they leave out, and how much worse than the best these
// may be before that is known.
constexpr std::size_t simulated_at_most = 6;
constexpr double worth_simulating = 300;
// Places that agree to this lead to the same estimate.
constexpr double same_place = 0.01;

void sort(std::vector<LocalScene>& scenes) {
  std::stable_sort(scenes.begin(), scenes.end(),
                   [](const LocalScene& one, const LocalScene& other) { return one.deviance < other.deviance; });
}

}  // namespace

bool is_complete(const SceneFamily& family, const LocalScene& local) {
  return local.usable &&
         std::all_of(local.choices.begin(), local.choices.end(),
                     [](const PointChoice& choice) { return choice.used; }) &&
         scene_adequacy(family.data(), local.choices, family.free_count()).misfits.empty();
}

std::vector<LocalScene> SceneSearcher::solve(const std::vector<Coordinates>& starts, Effort effort,
                                             Motions motions) const {
  std::vector<LocalScene> solved(starts.size());
  frac::parallel_for(starts.size(), threads_,
                     [&](std::size_t i) { solved[i] = solve_scene(family_, starts[i], effort, motions); });
  std::erase_if(solved, [](const LocalScene& local) { return !local.usable; });
  sort(solved);
  return solved;
}

std::vector<Coordinates> SceneSearcher::places_of(const std::vector<LocalScene>& sorted, std::size_t most,
                                                  double worth) const {
  std::vector<Coordinates> places;
  for (const LocalScene& local : sorted) {
    if (places.size() == most || local.deviance > sorted.front().deviance + worth) break;
    const bool is_known = std::any_of(places.begin(), places.end(), [&](const Coordinates& other) {
      return family_.agree(local.theta, other, same_place);
    });
    if (!is_known) places.push_back(local.theta);
  }
  return places;
}

void SceneSearcher::glance(const std::vector<Coordinates>& starts) {
  tried_ += starts.size();
  for (LocalScene& local : solve(starts, Effort::glance, Motions::all)) glances_.push_back(std::move(local));
}

std::vector<LocalScene> SceneSearcher::settle() {
  sort(glances_);
  const auto rough = solve(places_of(glances_, roughly_settled, worth_a_rough_look), Effort::rough, Motions::all);
  return solve(places_of(rough, settled_at_most, worth_settling), Effort::settle, Motions::all);
}

void SceneSearcher::settle_too(const std::vector<Coordinates>& starts, std::vector<LocalScene>& settled) {
  std::vector<Coordinates> further;
  for (const Coordinates& start : starts) {
    const bool is_known = std::any_of(settled.begin(), settled.end(), [&](const LocalScene& local) {
      return family_.agree(local.theta, start, same_estimate);
    });
    if (!is_known) further.push_back(start);
  }
  tried_ += further.size();
  for (LocalScene& local : solve(further, Effort::settle, Motions::all)) settled.push_back(std::move(local));
  sort(settled);
}

void SceneSearcher::explain(std::vector<LocalScene>& settled) const {
  std::vector<LocalScene*> chosen;
  for (LocalScene& local : settled) {
    if (chosen.size() == simulated_at_most || local.deviance > settled.front().deviance + worth_simulating) break;
    const bool is_known = std::any_of(chosen.begin(), chosen.end(), [&](const auto* other) {
      return family_.agree(local.theta, other->theta, same_estimate);
    });
    if (!is_known) chosen.push_back(&local);
  }
  frac::parallel_for(chosen.size(), threads_,
                     [&](std::size_t i) { explain_left_out(family_.data(), family_.free_count(), *chosen[i]); });
  sort(settled);
}

SceneSearch SceneSearcher::best_of(const std::vector<LocalScene>& settled, double allowed) const {
  SceneSearch result;
  result.starts = tried_;
  if (settled.empty()) return result;
  result.best = settled.front();
  const auto is_same = [&](const LocalScene& one, const LocalScene& other) {
    return family_.agree(one.theta, other.theta, same_estimate);
  };
  for (const LocalScene& local : settled) {
    if (is_same(local, result.best)) {
      ++result.starts_at_best;
    } else if (local.deviance < result.best.deviance + allowed &&
               std::none_of(result.rivals.begin(), result.rivals.end(),
                            [&](const LocalScene& other) { return is_same(local, other); })) {
      result.rivals.push_back(local);
    }
  }
  return result;
}

}  // namespace backlash::detail
