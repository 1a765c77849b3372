// SPDX-License-Identifier: BSD-3-Clause
#include "timely.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <limits>
#include <numeric>
#include <utility>
#include <vector>

#include "dead_time.hpp"

namespace frac::detail {
namespace {

using Complex = std::complex<double>;

Timely judge_without(double dead_time, const FrequencyResponseData& data, const ValidationOptions& options) {
  FrequencyResponseData ahead = without_dead_time(data, dead_time);
  Judgement judgement = judge(ahead, options);
  return {std::move(ahead), std::move(judgement), dead_time};
}

/// Dead time that the points still have beside the model and all that it may move by, at most a radian at the end of
/// the band; 0 where nothing tells it.
double further_dead_time(const Fitted& fitted) {
  Eigen::VectorXd column(2 * fitted.points.value.size());
  for (Eigen::Index i = 0; i < fitted.points.value.size(); ++i) {
    const Complex later = Complex(0, -fitted.points.omega[static_cast<std::size_t>(i)]) * fitted.model.value(i) /
                          fitted.points.deviation(i);
    column(2 * i) = later.real();
    column(2 * i + 1) = later.imag();
  }
  const double seconds = added_column(fitted.model.projected, column).coefficient;
  const double most = 1 / fitted.points.omega.back();
  return std::isfinite(seconds) ? std::clamp(seconds, -most, most) : 0;
}

/// A dead time with a few pairs of poles beside real ones, brought to least squares together with them.
struct TimedFit {
  double seconds, criterion;
};
TimedFit fit_timed(const FrequencyResponseData& data, const DeadTime& start, double floor) {
  std::vector<std::size_t> all(data.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  const auto ahead = [&](double seconds) {
    WeightedPoints points = points_of(without_dead_time(data, seconds), all);
    if (data.sigma().empty())
      for (double& each : points.deviation) each = std::hypot(each, floor);
    return points;
  };
  Fitted fitted;
  fitted.points = ahead(start.seconds);
  constexpr std::array<std::size_t, 2> fewest{1, 2};
  fitted.model = best_with_free_poles(fitted.points, fewest);
  TimedFit best{start.seconds, likelihood_criterion(fitted)};
  constexpr int most_steps = 5;
  for (int i = 0; i < most_steps; ++i) {
    const double seconds = best.seconds + further_dead_time(fitted);
    fitted.points = ahead(seconds);
    fitted.model = refitted(fitted.points, fitted.model);
    const double criterion = likelihood_criterion(fitted);
    if (!(criterion < best.criterion)) break;
    best = {seconds, criterion};
  }
  return best;
}

/// The dead time without which the points should be judged too; 0: none.
double promising_dead_time(const FrequencyResponseData& data, const Judgement& plain,
                           const ValidationOptions& options) {
  const double left = rms_of_residuals(plain.fitted);
  if (!(left > options.accuracy)) return 0;
  if (plain.steady(options.level)) {
    // The model may have set aside the very points that ask for a dead time, and then leaves no more than this one.
    constexpr double as_little = 2;
    const std::vector<DeadTime> found = dead_times_of(data, 0);
    return !found.empty() && std::pow(found.front().left, 2) < as_little * left * left ? found.front().seconds : 0;
  }
  // Fixed places follow a resonance only so far: of several dead times poles at free places tell which.  Points that
  // are noise where it is additive would hide it.
  TimedFit best{0, std::numeric_limits<double>::infinity()};
  for (const double floor : {0.0, plain.fitted.floor}) {
    constexpr std::size_t most = 3;
    const std::vector<DeadTime> found = dead_times_of(data, floor);
    for (std::size_t i = 0; i < std::min(found.size(), most); ++i) {
      const TimedFit here = fit_timed(data, found[i], floor);
      if (here.criterion < best.criterion) best = here;
    }
    if (!(plain.fitted.floor > 0)) break;
  }
  return best.seconds;
}

}  // namespace

Timely judge_timely(const FrequencyResponseData& data, const ValidationOptions& options) {
  Timely plain{data, judge(data, options)};
  const double seconds = promising_dead_time(data, plain.judgement, options);
  if (!(seconds > 0)) return plain;
  Timely best = judge_without(seconds, data, options);
  double criterion = criterion_of_all(best.data, best.judgement);
  constexpr int most_steps = 4;
  for (int i = 0; i < most_steps; ++i) {
    Timely next = judge_without(best.dead_time + further_dead_time(best.judgement.fitted), data, options);
    const double least = criterion_of_all(next.data, next.judgement);
    if (!(least < criterion)) break;
    criterion = least;
    best = std::move(next);
  }
  // Pays for the parameter and for having chosen the best of many dead times.
  constexpr double price = 8;
  return criterion + price < criterion_of_all(data, plain.judgement) ? best : plain;
}

}  // namespace frac::detail
