// SPDX-License-Identifier: BSD-3-Clause
#include "judgement.hpp"

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <complex>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>

#include "frac/identification/statistics.hpp"

namespace frac::detail {
namespace {

using Complex = std::complex<double>;

/// Judges the point that stands out most again, with the number of poles that the other points need: an outlier adds
/// poles of its own, which then follow it.
void look_again(const FrequencyResponseData& data, const Fitted& fitted, Tested& result) {
  const auto largest = std::min_element(result.point_chance.begin(), result.point_chance.end());
  const auto points = static_cast<double>(result.point_chance.size());
  constexpr double not_worth_it = 0.5;
  if (!fitted.model.free_poles.empty() || !(points * *largest < not_worth_it)) return;
  const auto at = static_cast<Eigen::Index>(largest - result.point_chance.begin());
  const Fitted others = fit_on_grid(data, without(fitted.kept, {at}));
  WeightedPoints all = fitted.points;
  for (Eigen::Index i = 0; i < all.deviation.size(); ++i)
    if (i != at) all.deviation(i) = others.points.deviation(i < at ? i : i - 1);
  const Eigen::Index beside = at > 0 ? at - 1 : at + 1;
  all.deviation(at) *= all.deviation(beside) / fitted.points.deviation(beside);
  const ConsistentModel model = on_grid(all, others.model.grid_poles, others.model.margin);
  const std::array one{at};
  // The model was chosen so that this point stands out, which counts like looking at some three models.
  constexpr double models = 3;
  const double chance = models * excess_chance(model.projected, one);
  if (!(chance < *largest)) return;
  *largest = chance;
  result.p_value[index_of(ValidityTest::outliers)] = std::min(1.0, points * chance);
}

/// Which of the alarms about single points to act on: the least likely one, since an outlier may happen to lie at a
/// harmonic of the mains.  At the frequency of the mains itself the mains are always taken as the cause.
std::optional<ValidityTest> least_likely_of_points(const Judgement& judgement, double level) {
  const Tested& last = judgement.last;
  const auto largest = std::min_element(last.point_chance.begin(), last.point_chance.end()) - last.point_chance.begin();
  std::optional<ValidityTest> found;
  for (const ValidityTest test : all_tests) {
    if (!is_of_points(test) || !last.alarm(test, level)) continue;
    if (test != ValidityTest::outliers) {
      const auto first = at_mains(judgement.fitted, mains_frequencies[mains_index(test)], 1, 1);
      if (std::find(first.begin(), first.end(), largest) != first.end()) return test;
    }
    if (!found || last.p_value[index_of(test)] < last.p_value[index_of(*found)]) found = test;
  }
  return found;
}

/// Sets points that stand out aside, so that the others are judged without them.
/// @param most  points set aside
template <typename Fit>
Judgement judge(const FrequencyResponseData& data, const ValidationOptions& options, std::size_t most, const Fit& fit) {
  const double level = options.level;
  std::vector<std::size_t> kept(data.size());
  std::iota(kept.begin(), kept.end(), std::size_t{0});
  Judgement judgement;
  judgement.fitted = fit(std::move(kept));
  judgement.left_of_mirrored = left_of_mirrored(judgement.fitted);
  judgement.last = tested(data, judgement.fitted, options.accuracy);
  look_again(data, judgement.fitted, judgement.last);
  judgement.first = judgement.last;
  while (true) {
    const Fitted& fitted = judgement.fitted;
    const std::optional<ValidityTest> alarmed = least_likely_of_points(judgement, level);
    if (!alarmed) break;
    const bool outlier = *alarmed == ValidityTest::outliers;
    const std::vector<Eigen::Index> removed =
        outlier ? judgement.last.standing_out(level) : judgement.last.at_mains[mains_index(*alarmed)];
    judgement.of_points.push_back(*alarmed);
    auto& list = outlier ? judgement.outliers : judgement.mains;
    for (const Eigen::Index i : removed) list.push_back(fitted.kept[static_cast<std::size_t>(i)]);
    if (judgement.outliers.size() + judgement.mains.size() > most) break;
    judgement.fitted = fit(without(fitted.kept, removed));
    judgement.last = tested(data, judgement.fitted, options.accuracy);
    look_again(data, judgement.fitted, judgement.last);
  }
  std::sort(judgement.outliers.begin(), judgement.outliers.end());
  std::sort(judgement.mains.begin(), judgement.mains.end());
  return judgement;
}

/// A point set aside costs as much as three parameters: its two parts, and the choice of the point.
constexpr std::size_t price_of_point = 3;

/// Whether points stand out and none of the outliers are neighbours.
bool has_lone_points(const Judgement& judgement) {
  const std::vector<std::size_t>& points = judgement.outliers;
  const auto next = [](std::size_t a, std::size_t b) { return b == a + 1; };
  return !judgement.of_points.empty() && std::adjacent_find(points.begin(), points.end(), next) == points.end();
}

}  // namespace

double criterion_of_all(const FrequencyResponseData& data, const Judgement& judgement) {
  const Fitted& fitted = judgement.fitted;
  const Eigen::VectorXd& deviation = fitted.points.deviation;
  const std::size_t aside = data.size() - fitted.kept.size();
  const double share = static_cast<double>(data.size()) / static_cast<double>(fitted.kept.size());
  double logarithms = 0;
  for (std::size_t k = 0, i = 0; k < data.size(); ++k) {
    if (i + 1 < fitted.kept.size() && fitted.kept[i] < k) ++i;
    logarithms += std::log(deviation(static_cast<Eigen::Index>(i)));
  }
  const double rounding = 1e-24 * fitted.points.value.cwiseQuotient(deviation.cast<Complex>()).squaredNorm();
  const auto parameters = static_cast<std::size_t>(fitted.model.projected.orthonormal.cols()) +
                          price_of_narrow_pair * fitted.model.narrow_pairs + price_of_point * aside;
  const auto aicc = [&](double square, std::size_t further) {
    return information_criteria(square * share, 2 * data.size(), parameters + further, rounding).aicc;
  };
  return std::min({aicc(fitted.model.projected.square(), 0), aicc(judgement.last.square_beside_drift, 2),
                   aicc(judgement.last.square_beside_step, 2)}) +
         4 * logarithms;
}

Judgement judge(const FrequencyResponseData& data, const ValidationOptions& options) {
  const double level = options.level;
  const std::size_t some = std::max<std::size_t>(1, data.size() / 20), many = data.size() / 5;
  Judgement best = judge(data, options, some, [&](auto kept) { return fit_on_grid(data, std::move(kept)); });
  double least = best.outliers.size() + best.mains.size() > some ? std::numeric_limits<double>::infinity()
                                                                 : criterion_of_all(data, best);
  // Beside real poles a resonance looks like outliers, and outliers hide resonances.  So free poles are fitted to all
  // points and to those that do not stand out; the model that explains all points best is taken.
  const double mirrored = best.left_of_mirrored;
  const auto compare = [&](const Fitted& free) {
    Judgement other =
        judge(data, options, many, [&](auto points) { return refitted_points(data, std::move(points), free.model); });
    const double criterion = criterion_of_all(data, other);
    // A pair of poles may follow a single outlier and nothing else, so it has to explain much more than setting the
    // outlier aside does.  Points at the mains cost nothing to set aside, because their frequency is known beforehand.
    constexpr double alike = 2, alone = 8;
    const double needed = alone + static_cast<double>(2 * price_of_point * best.mains.size());
    if (has_lone_points(best) && other.of_points.empty() && !(criterion < criterion_of_all(data, best) - needed))
      return;
    if (!(criterion < least + (other.steady(level) && !best.steady(level) ? alike : 0))) return;
    least = criterion;
    best = std::move(other);
  };
  constexpr std::array<std::size_t, 4> few{1, 2, 3, 4};
  const auto with_few = [&](std::vector<std::size_t> kept) { return fit_free_poles(data, std::move(kept), few); };
  // An echo needs one pair for each ripple over the band; with fewer pairs no part of it is followed.
  constexpr std::array<std::size_t, 5> more{6, 8, 11, 14, 18};
  // So many real poles may stand for one well damped resonance, and their residuals then look like noise.
  constexpr double many_per_decade = 4;
  const bool is_laboured = static_cast<double>(best.fitted.model.grid_poles) >
                           many_per_decade * std::log10(data.omega().back() / data.omega().front());
  if (!best.steady(level) || is_laboured) {
    const std::vector<std::size_t> kept = best.fitted.kept;
    std::vector<std::size_t> all(data.size());
    std::iota(all.begin(), all.end(), std::size_t{0});
    const bool lone = has_lone_points(best);
    if (lone) compare(with_few(kept));
    compare(with_few(all));
    if (!lone && kept != all && !best.steady(level)) compare(with_few(kept));
    if (best.pattern(level)) compare(with_free_poles(data, best.fitted, more));
  }
  best.left_of_mirrored = mirrored;
  return best;
}

}  // namespace frac::detail
