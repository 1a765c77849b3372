// SPDX-License-Identifier: BSD-3-Clause
#include "scene_evidence.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace backlash::detail {
namespace {

constexpr double two_pi = 2 * std::numbers::pi;
// Another motion than the one expected often lies as near to it.
constexpr double other_motion = 0.1;
// Share of points that lie on another motion than the scene's definite one, or are outliers.
constexpr double expected_exceptions = 0.05;
// Share of N to which a motion in closed form, or with exact chatter, and the same one simulated agree.
constexpr double same_motion = 1e-5;
// Sizes below this share of the median count as it: a point that is 0 would cost or gain without limit.
constexpr double least_size = 1e-3;

// N of a motion that does not close is a mean, in data as in simulations, which is known to about that.
constexpr double long_mean_accuracy = 0.01;

double log_size(const SceneData& data, const MeasuredPoint& point) {
  return std::log(std::max(std::abs(point.value), least_size * data.typical));
}

// -2 ln of the density of a value about a motion, by a Cauchy distribution in one or two dimensions.
double price_about(const SceneData& data, const PointChoice& choice, std::size_t i, double accuracy) {
  const double width = accuracy * std::max(std::abs(choice.model), least_size * data.typical);
  const double distance = data.size(choice.model - data.points[i].value) / width;
  const double tail = std::log1p(distance * distance);
  return data.residuals_per_point() == 2 ? 2 * std::log(two_pi * width * width) + 3 * tail
                                         : 2 * std::log(std::numbers::pi * width) + 2 * tail;
}

// The same of a value of which only the size is known: even over a disc, or over an interval.
double price_of_size(const SceneData& data, std::size_t i) {
  const double size = log_size(data, data.points[i]);
  return data.residuals_per_point() == 2 ? 2 * std::log(std::numbers::pi) + 4 * size : 2 * std::log(2.0) + 2 * size;
}

double price_left_out(const SceneData& data, const PointChoice& choice, std::size_t i) {
  if (choice.kind == PointChoice::Kind::none) {
    // Any of the motions is as likely.
    return choice.means > 0 ? price_about(data, choice, i, choice.accuracy) + 2 * std::log(choice.means)
                            : price_of_size(data, i);
  }
  const double price = std::min(price_about(data, choice, i, other_motion), price_of_size(data, i));
  // Where the mass may move freely it may as well be hit now and then, as long as it remembers having been.
  return choice.kind == PointChoice::Kind::free ? price : price - 2 * std::log(expected_exceptions);
}

// What the density of a used point owes to its deviation.
double price_used(const SceneData& data, const PointChoice& choice, std::size_t i) {
  const double deviation = data.deviation(data.points[i], choice.model);
  const double scale =
      data.weight == frac::Weight::relative ? std::max(deviation, least_size * data.typical) : deviation;
  return 2 * static_cast<double>(data.residuals_per_point()) * std::log(scale);
}

struct Sums {
  double cost = 0;
  double prices = 0;  // of points used and left out
  std::size_t used = 0;
};

SceneEvidence evidence_of(const SceneData& data, const Sums& sums, std::size_t parameters, double accuracy) {
  const double residuals = static_cast<double>(sums.used * data.residuals_per_point());
  const double degrees = residuals - static_cast<double>(parameters);
  if (!(degrees > 0)) return {std::numeric_limits<double>::infinity(), 0, sums.used};
  const double floor = accuracy * data.typical_misfit;
  const double variance = std::max(sums.cost / degrees, floor * floor);
  const double deviance = degrees * std::log(two_pi * variance) + sums.cost / variance +
                          static_cast<double>(parameters) * std::log(residuals) + sums.prices;
  return {deviance, std::sqrt(variance), sums.used};
}

}  // namespace

SceneEvidence scene_evidence(const SceneData& data, const std::vector<PointChoice>& choices, std::size_t parameters,
                             double accuracy) {
  Sums sums;
  for (std::size_t i = 0; i < choices.size(); ++i) {
    const PointChoice& choice = choices[i];
    sums.prices += choice.used ? price_used(data, choice, i) : price_left_out(data, choice, i);
    if (!choice.used) continue;
    sums.cost += choice.misfit * choice.misfit;
    ++sums.used;
  }
  return evidence_of(data, sums, parameters, accuracy);
}

void use_by_evidence(const SceneData& data, std::vector<PointChoice>& choices, std::size_t parameters,
                     double accuracy) {
  std::vector<std::size_t> order;
  Sums sums;
  for (std::size_t i = 0; i < choices.size(); ++i) {
    choices[i].used = false;
    sums.prices += price_left_out(data, choices[i], i);
    if (choices[i].kind != PointChoice::Kind::none) order.push_back(i);
  }
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return choices[a].misfit != choices[b].misfit ? choices[a].misfit < choices[b].misfit : a < b;
  });
  double least = std::numeric_limits<double>::infinity();
  // With as many parameters as residuals the data do not tell how good a fit is.
  std::size_t best = order.size();
  for (std::size_t n = 0; n < order.size(); ++n) {
    const PointChoice& choice = choices[order[n]];
    sums.prices += price_used(data, choice, order[n]) - price_left_out(data, choice, order[n]);
    sums.cost += choice.misfit * choice.misfit;
    ++sums.used;
    const double deviance = evidence_of(data, sums, parameters, accuracy).deviance;
    if (deviance < least) {
      least = deviance;
      best = n + 1;
    }
  }
  for (std::size_t n = 0; n < best; ++n) choices[order[n]].used = true;
}

void explain_left_out(const SceneData& data, std::size_t parameters, LocalScene& local) {
  const double accuracy = local.motions->accuracy();
  const double deviation = scene_evidence(data, local.choices, parameters, accuracy).deviation;
  for (std::size_t i = 0; i < local.choices.size(); ++i) {
    PointChoice& choice = local.choices[i];
    const MeasuredPoint& point = data.points[i];
    if (choice.used) continue;
    const std::vector<SettledMotion> motions = local.motions->settled(local.theta, point);
    const PointChoice compared = choice;
    double least = price_left_out(data, choice, i);
    for (const SettledMotion& motion : motions) {
      PointChoice other;
      other.model = motion.value;
      other.means = static_cast<int>(motions.size());
      const double size = std::max(std::abs(other.model), least_size * data.typical);
      // The motion that the point lies off is none the nearer for being found again.
      if (compared.kind != PointChoice::Kind::none &&
          std::abs(other.model - compared.model) <= std::max(same_motion, motion.accuracy) * size)
        continue;
      other.accuracy = std::hypot(motion.closes ? 0 : long_mean_accuracy,
                                  deviation * data.deviation(point, other.model) / size, motion.accuracy);
      const double price = price_left_out(data, other, i);
      if (!(price < least)) continue;
      least = price;
      choice = other;
    }
  }
  local.deviance = scene_evidence(data, local.choices, parameters, accuracy).deviance;
}

}  // namespace backlash::detail
