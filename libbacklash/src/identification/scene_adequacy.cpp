// SPDX-License-Identifier: BSD-3-Clause
#include "scene_adequacy.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/short_text.hpp"
#include "special/distributions.hpp"

namespace backlash::detail {
namespace {

using frac::detail::short_text;
// Correlation of neighbours from which on the scene misses the shape of the data: less is what noise may have.  Of
// random scenes with white noise whose correlation was above this nearly all estimates were of another scene.
constexpr double shape_correlation = 0.3;
// Fewest neighbours that tell about noise.
constexpr std::size_t least_pairs = 6;
constexpr std::size_t least_off_branch = 3;
constexpr double most_off_branch_of_all = 0.25;
constexpr double most_off_branch_of_curve = 0.5;

struct Neighbours {
  std::size_t pairs = 0;   // of single residuals
  double products = 0;     // sum over them
  double differences = 0;  // sum of squares
};

struct CurveMean {
  std::array<double, 2> sum{};
  std::size_t points = 0;
};

class Residuals {
 public:
  Residuals(const SceneData& data, const std::vector<PointChoice>& choices) : data_(data), choices_(choices) {
    for (std::size_t i = 0; i < choices.size(); ++i) {
      const double deviation = choices[i].used ? data.deviation(data.points[i], choices[i].model) : 1;
      residual_.push_back(data.parts((choices[i].model - data.points[i].value) / deviation));
    }
  }

  [[nodiscard]] double cost() const {
    double sum = 0;
    for (std::size_t i = 0; i < choices_.size(); ++i) {
      if (choices_[i].used) sum += residual_[i][0] * residual_[i][0] + residual_[i][1] * residual_[i][1];
    }
    return sum;
  }

  [[nodiscard]] Neighbours neighbours() const {
    Neighbours result;
    for (std::size_t i = 0; i + 1 < choices_.size(); ++i) {
      const PointChoice& here = choices_[i];
      const PointChoice& next = choices_[i + 1];
      if (!here.used || !next.used || here.kind != next.kind || data_.points[i].curve != data_.points[i + 1].curve)
        continue;
      for (std::size_t part = 0; part < data_.residuals_per_point(); ++part) {
        ++result.pairs;
        result.products += residual_[i][part] * residual_[i + 1][part];
        const double difference = residual_[i + 1][part] - residual_[i][part];
        result.differences += difference * difference;
      }
    }
    return result;
  }

  [[nodiscard]] std::vector<CurveMean> means() const {
    std::vector<CurveMean> result(data_.curve_begin.size() - 1);
    for (std::size_t i = 0; i < choices_.size(); ++i) {
      if (!choices_[i].used) continue;
      CurveMean& mean = result[data_.points[i].curve];
      ++mean.points;
      for (std::size_t part = 0; part < 2; ++part) mean.sum[part] += residual_[i][part];
    }
    return result;
  }

 private:
  const SceneData& data_;
  const std::vector<PointChoice>& choices_;
  std::vector<std::array<double, 2>> residual_;
};

double force_of(const SceneData& data, std::size_t curve) {
  return data.points[data.curve_begin[curve]].force;
}

// Sum of squares of `degrees` standard normal variables that chance exceeds once in a thousand (Wilson, Hilferty 1931).
double most_by_chance(double degrees) {
  const double share = 2 / (9 * degrees);
  return degrees * std::pow(1 - share + significant * std::sqrt(share), 3);
}

void compare_curves(const SceneData& data, const Residuals& residuals, double noise_variance,
                    std::vector<std::string>& misfits) {
  const std::vector<CurveMean> means = residuals.means();
  double square = 0, degrees = 0, worst = 0;
  std::size_t worst_curve = 0, curves = 0;
  for (std::size_t curve = 0; curve < means.size(); ++curve) {
    const CurveMean& mean = means[curve];
    if (mean.points == 0) continue;
    ++curves;
    const double own =
        (mean.sum[0] * mean.sum[0] + mean.sum[1] * mean.sum[1]) / (static_cast<double>(mean.points) * noise_variance);
    square += own;
    degrees += static_cast<double>(data.residuals_per_point());
    if (own > worst) {
      worst = own;
      worst_curve = curve;
    }
  }
  if (curves < 2 || square <= most_by_chance(degrees)) return;
  const CurveMean& mean = means[worst_curve];
  const double size = std::hypot(mean.sum[0], mean.sum[1]) / static_cast<double>(mean.points);
  misfits.push_back("The curves contradict each other: that at " + short_text(force_of(data, worst_curve)) +
                    " N lies off the scene by " + short_text(size) + " of its deviation on average, " +
                    short_text(std::sqrt(worst)) + " times what its noise makes of that.");
}

void count_off_branch(const SceneData& data, const std::vector<PointChoice>& choices,
                      std::vector<std::string>& misfits) {
  std::size_t all_off = 0, all_definite = 0;
  for (std::size_t curve = 0; curve + 1 < data.curve_begin.size(); ++curve) {
    std::size_t off = 0, definite = 0, free_off = 0, used = 0;
    for (std::size_t i = data.curve_begin[curve]; i < data.curve_begin[curve + 1]; ++i) {
      used += choices[i].used ? 1 : 0;
      // Where the mass may move freely it may as well be hit now and then, though not at each point of a curve.
      free_off += choices[i].kind == PointChoice::Kind::free && !choices[i].used ? 1 : 0;
      if (choices[i].kind == PointChoice::Kind::none || choices[i].kind == PointChoice::Kind::free) continue;
      ++definite;
      off += choices[i].used ? 0 : 1;
    }
    all_off += off;
    all_definite += definite;
    if (used == 0 && off + free_off >= least_off_branch) {
      misfits.push_back("At " + short_text(force_of(data, curve)) + " N none of " +
                        std::to_string(data.curve_begin[curve + 1] - data.curve_begin[curve]) +
                        " points lies on a motion that is tried there.");
      continue;
    }
    if (off >= least_off_branch &&
        static_cast<double>(off) > most_off_branch_of_curve * static_cast<double>(definite)) {
      misfits.push_back("At " + short_text(force_of(data, curve)) + " N " + std::to_string(off) + " of " +
                        std::to_string(definite) + " points lie on none of the motions that are tried there.");
    }
  }
  if (misfits.empty() && all_off >= least_off_branch &&
      static_cast<double>(all_off) > most_off_branch_of_all * static_cast<double>(all_definite)) {
    misfits.push_back(std::to_string(all_off) + " of " + std::to_string(all_definite) +
                      " points lie on none of the motions that are tried there.");
  }
}

}  // namespace

SceneAdequacy scene_adequacy(const SceneData& data, const std::vector<PointChoice>& choices, std::size_t parameters) {
  SceneAdequacy result;
  count_off_branch(data, choices, result.misfits);
  const Residuals residuals(data, choices);
  std::size_t used = 0;
  for (const PointChoice& choice : choices) used += choice.used ? 1 : 0;
  const double count = static_cast<double>(used * data.residuals_per_point());
  const double degrees = count - static_cast<double>(parameters);
  const Neighbours neighbours = residuals.neighbours();
  if (!(degrees > 0)) return result;
  const double variance = residuals.cost() / degrees;
  const bool is_rounding = variance <= data.rounding_variance();
  result.is_tested = is_rounding || neighbours.pairs >= least_pairs;
  if (is_rounding || !result.is_tested) return result;
  const double pairs = static_cast<double>(neighbours.pairs);
  // Fitting lowers the correlation of neighbours by about this much.
  const double correlation = neighbours.products / (pairs * variance) + static_cast<double>(parameters) / count;
  if (correlation * std::sqrt(pairs) > significant) {
    result.correlation = std::min(correlation, 0.99);
    if (correlation > shape_correlation) {
      result.misfits.push_back("Neighbouring residuals go together (correlation " + short_text(correlation) +
                               "): the scene misses the shape of the data.");
    }
  }
  const double noise_variance = std::max(neighbours.differences / (2 * pairs), data.rounding_variance());
  compare_curves(data, residuals, noise_variance, result.misfits);
  return result;
}

bool tells_contacts(const SceneData& data, const std::vector<PointChoice>& choices, std::size_t parameters,
                    double least_variance) {
  constexpr double chance = 1e-3;
  const auto deviation_at = [&](std::size_t i) {
    return data.deviation(data.points[i], choices[i].used ? choices[i].model : data.points[i].value);
  };
  // Of -1/(M omega^2) over the deviations: the weighed mean of 1/M is products/squares.
  double cost = 0, of_scene = 0, products = 0, squares = 0;
  std::size_t used = 0;
  for (std::size_t i = 0; i < choices.size(); ++i) {
    const MeasuredPoint& point = data.points[i];
    const double deviation = deviation_at(i);
    if (!(deviation > 0)) continue;
    const std::array<double, 2> value = data.parts(point.value / deviation);
    cost += value[0] * value[0] + value[1] * value[1];
    if (choices[i].used) {
      of_scene += choices[i].misfit * choices[i].misfit;
      ++used;
    }
    if (data.output == Output::x1 || point.harmonic != 1) continue;
    const double of_mass = data.parts(-1 / (point.omega * point.omega * deviation))[0];
    products += value[0] * of_mass;
    squares += of_mass * of_mass;
  }
  const bool has_mass = squares > 0;
  if (has_mass) cost -= products * products / squares;
  const double per_point = static_cast<double>(data.residuals_per_point());
  const double degrees = per_point * static_cast<double>(used) - static_cast<double>(parameters);
  const double further = per_point * static_cast<double>(choices.size()) - degrees - (has_mass ? 1 : 0);
  if (!(degrees > 0) || !(further > 0)) return true;
  const double variance = std::max({of_scene / degrees, least_variance, data.rounding_variance()});
  const double ratio = std::max(0.0, cost - of_scene) / (further * variance);
  return frac::detail::fisher_f_above(ratio, further, degrees) < chance;
}

}  // namespace backlash::detail
