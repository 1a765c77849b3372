// SPDX-License-Identifier: BSD-3-Clause
#include "frac/identification/outliers.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <limits>
#include <span>
#include <string>
#include <utility>

#include "base/median.hpp"
#include "base/short_text.hpp"
#include "frac/identification/component_power_law.hpp"
#include "frac/identification/identify.hpp"
#include "frac/identification/lack_of_fit.hpp"
#include "identification/data/fit_data.hpp"
#include "identification/data/local_curve.hpp"
#include "identification/data/noise_floor.hpp"
#include "identification/statistics/curvature_fit.hpp"

namespace frac {
namespace {

using detail::median;

constexpr std::size_t fewest_points = 12;
constexpr double most_of_the_data = 0.15;
// Two points of a resonance look like two outliers, so a pair has to stand out farther.
constexpr double of_all = 5.5, of_neighbours = 4, of_neighbours_of_pair = 10;

/// Distances of points from the curves through their neighbours, in units of the noise they would have if all noise
/// were alike.
class Distances {
 public:
  Distances(const FrequencyResponseData& data, Component component) {
    const double floor = detail::noise_floor(data, component);
    double largest = 0;
    for (const std::complex<double>& value : data.value()) largest = std::max(largest, std::abs(value));
    for (std::size_t i = 0; i < data.size(); ++i) {
      const std::complex<double> value = data.value()[i] / largest;
      log_omega_.push_back(std::log(data.omega()[i]));
      size_.push_back(std::sqrt(std::norm(value) + std::pow(floor / largest, 2)));
      value_.emplace_back(component == Component::imaginary ? 0 : value.real(),
                          component == Component::real ? 0 : value.imag());
    }
  }

  [[nodiscard]] double operator()(std::span<const std::size_t> usable, std::size_t point) const {
    const detail::LocalCurve curve = detail::local_curve(log_omega_, usable, point);
    std::complex<double> distance = value_[point];
    std::array<double, detail::LocalCurve::most_neighbours> sizes{};
    for (std::size_t i = 0; i < curve.count; ++i) {
      distance -= curve.weight[i] * value_[curve.neighbour[i]];
      sizes[i] = size_[curve.neighbour[i]];
    }
    const auto middle = sizes.begin() + curve.count / 2;
    std::nth_element(sizes.begin(), middle, sizes.begin() + curve.count);
    return std::sqrt(std::norm(distance)) / (curve.noise * *middle);
  }

  /// What the distance of any of these points is below, whichever of the others it is measured from.  The weights w of
  /// a curve sum to 1, so that with values from their mean on |v - sum w v_i| <= sqrt(1 + sum w^2) sqrt(sum of
  /// squares).
  [[nodiscard]] double bound(std::span<const std::size_t> points) const {
    std::complex<double> mean = 0;
    for (const std::size_t each : points) mean += value_[each] / static_cast<double>(points.size());
    double sum = 0, smallest = size_[points.front()];
    for (const std::size_t each : points) {
      sum += std::norm(value_[each] - mean);
      smallest = std::min(smallest, size_[each]);
    }
    constexpr double rounding = 1 + 1e-6;  // of values, over the least noise that points stand out of
    return rounding * std::sqrt(sum) / smallest;
  }

 private:
  std::vector<std::complex<double>> value_;  // the part in question, in units of the largest value
  std::vector<double> log_omega_, size_;
};

constexpr std::size_t longest_pattern = 5;

/// Points near each other, as distances from the first among the usable ones.  Each hides the others, whose curves run
/// through it, so they are tried together.
using Pattern = std::vector<std::size_t>;
const std::vector<Pattern>& patterns() {
  // A sound point stands between any three: three in a row would be a resonance.
  static const std::vector<Pattern> all = {{0},       {0, 1},    {0, 2},    {0, 3},    {0, 4},    {0, 5},   {0, 1, 3},
                                           {0, 2, 3}, {0, 2, 4}, {0, 1, 4}, {0, 3, 4}, {0, 1, 5}, {0, 4, 5}};
  return all;
}

// Curves reach three points to a side at most.
constexpr std::size_t curve_reach = 3;

/// By how much the points of a pattern stand out, over what is allowed: above 1 for outliers.
/// @param all  distances of the usable points
double excess(const Distances& distance, const std::vector<std::size_t>& usable, const std::vector<double>& all,
              std::size_t first, const Pattern& pattern, double usual) {
  constexpr std::size_t reach = 2, most_rest = 32;
  const std::size_t begin = first - std::min(first, reach + curve_reach + 1);
  const std::size_t end = std::min(usable.size(), first + pattern.back() + reach + curve_reach + 2);
  std::array<std::size_t, most_rest> window{};
  std::size_t count = 0;
  for (std::size_t i = begin, next = 0; i < end; ++i) {
    if (next < pattern.size() && i == first + pattern[next]) {
      ++next;
    } else {
      window[count++] = usable[i];
    }
  }
  const std::span<const std::size_t> rest(window.data(), count);
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < pattern.size(); ++i) {
    const bool is_alone = (i == 0 || pattern[i] - pattern[i - 1] > curve_reach) &&
                          (i + 1 == pattern.size() || pattern[i + 1] - pattern[i] > curve_reach);
    const std::size_t point = first + pattern[i];
    least = std::min(least, (is_alone ? all[point] : distance(rest, usable[point])) / (of_all * usual));
    if (least <= 1) return least;
  }
  const double most = least * of_all * usual;
  double allowed = of_all * usual;
  const double times = pattern.size() > 1 ? of_neighbours_of_pair : of_neighbours;
  const std::size_t after = first - begin + pattern.back() + 1 - pattern.size() + reach;
  for (std::size_t i = first - begin - std::min(first - begin, reach); i < std::min(after, count) && allowed < most;
       ++i) {
    allowed = std::max(allowed, times * distance(rest, rest[i]));
  }
  return most / allowed;
}

// "1, 3.162"
std::string frequencies_of(const FrequencyResponseData& data, const std::vector<std::size_t>& points) {
  std::string list;
  for (const std::size_t point : points)
    list += (list.empty() ? "" : ", ") + detail::four_digits(in_unit(data.omega()[point], data.frequency_unit()));
  return list + " " + std::string(to_string(data.frequency_unit()));
}

}  // namespace

std::vector<std::size_t> isolated_outliers(const FrequencyResponseData& data, Component component) {
  const auto& omega = data.omega();
  const bool repeats = std::adjacent_find(omega.begin(), omega.end()) != omega.end();
  if (data.size() < fewest_points || repeats || component == Component::magnitude || component == Component::phase) {
    return {};
  }
  const Distances distance(data, component);
  std::vector<std::size_t> usable(data.size()), outliers;
  for (std::size_t i = 0; i < usable.size(); ++i) usable[i] = i;
  const auto most = static_cast<std::size_t>(most_of_the_data * static_cast<double>(data.size()));
  for (;;) {
    std::vector<double> all;
    all.reserve(usable.size());
    for (const std::size_t point : usable) all.push_back(distance(usable, point));
    // Medians of the absolute value of normal noise, of one part and of both.
    const double median_of_noise = component == Component::both ? 1.1774 : 0.6745;
    const double usual = detail::median(all) / median_of_noise;
    // Data that follow each other to rounding have no noise to stand out of.
    if (!(usual > 1e-9)) return {};
    Pattern worst;
    double most_excess = 1;
    for (std::size_t first = 0; first < usable.size(); ++first) {
      if (!(all[first] > usual)) continue;
      const std::size_t before = std::min(first, curve_reach);
      const std::span around(usable.data() + first - before,
                             std::min(before + longest_pattern + curve_reach + 1, usable.size() - first + before));
      if (distance.bound(around) <= of_all * usual) continue;
      for (const Pattern& pattern : patterns()) {
        if (first + pattern.back() >= usable.size()) continue;
        const double by = excess(distance, usable, all, first, pattern, usual);
        if (!(by > most_excess)) continue;
        most_excess = by;
        worst.clear();
        for (const std::size_t each : pattern) worst.push_back(usable[first + each]);
      }
    }
    if (worst.empty()) break;
    outliers.insert(outliers.end(), worst.begin(), worst.end());
    std::erase_if(usable, [&](std::size_t point) { return std::binary_search(worst.begin(), worst.end(), point); });
    if (outliers.size() > most) return {};
  }
  std::sort(outliers.begin(), outliers.end());
  return outliers;
}

std::vector<std::size_t> points_met(const FrequencyResponseData& data, const std::vector<std::size_t>& points,
                                    const FitOptions& options, const FitResult& fit) {
  if (points.empty() || !fit.usable()) return {};
  constexpr double within_noise = 3, much_larger = 1.05, rounding = 1e-9;
  if (fit.rms > rounding && !lack_of_fit(without_points(data, points), options, fit).adequate) return {};
  const double noise = std::max(fit.rms, rounding);
  const Structure structure(fit.model);
  const FitOptions started = detail::started_at(detail::settled(options, fit), fit);
  std::vector<std::size_t> met;
  for (const std::size_t point : points) {
    std::vector<std::size_t> others = points;
    std::erase(others, point);
    const FrequencyResponseData with = without_points(data, others);
    const FitResult refit = detail::curvature_fit(with, structure, started);
    if (!refit.usable() || refit.rms > much_larger * noise) continue;
    const std::vector<double> residual = detail::weighted_residuals(data, options, refit);
    const std::size_t parts = residual.size() / data.size();
    const auto first = residual.begin() + static_cast<std::ptrdiff_t>(point * parts);
    const bool is_met = std::all_of(first, first + static_cast<std::ptrdiff_t>(parts),
                                    [&](double each) { return std::abs(each) <= within_noise * noise; });
    if (is_met) met.push_back(point);
  }
  return met;
}

FrequencyResponseData without_points(const FrequencyResponseData& data, const std::vector<std::size_t>& points) {
  return detail::chosen_points(data,
                               [&](std::size_t i) { return !std::binary_search(points.begin(), points.end(), i); });
}

ScreenedData::ScreenedData(FrequencyResponseData all, const FitOptions& options, bool keep_all)
    : all_(std::move(all)),
      left_out_(keep_all || options.loss != Loss::none ? std::vector<std::size_t>{}
                                                       : isolated_outliers(all_, options.component)),
      kept_(without_points(all_, left_out_)) {}

std::string ScreenedData::sentence() const {
  if (left_out_.empty()) return {};
  return std::to_string(left_out_.size()) + " of " + std::to_string(all_.size()) +
         (left_out_.size() == 1 ? " points contradicts its" : " points contradict their") +
         " neighbours on both sides (at " + frequencies_of(all_, left_out_) + "); they are left out";
}

std::string ScreenedData::take_back_met(const FitOptions& options, const FitResult& fit, bool is_of_component_alone) {
  taken_back_.clear();
  // Residuals are weighed against what was fitted.
  const auto met =
      points_met(is_of_component_alone ? component_alone(all_, options.component) : all_, left_out_, options, fit);
  if (met.empty()) return {};
  std::erase_if(left_out_, [&](std::size_t point) { return std::binary_search(met.begin(), met.end(), point); });
  kept_ = without_points(all_, left_out_);
  taken_back_ = "the model meets what was left out at " + frequencies_of(all_, met) +
                " to within the noise, so that it is taken in again";
  return taken_back_;
}

std::string ScreenedData::take_back_met(FitOptions options, const RankedFit& chosen) {
  if (chosen.model_class == ModelClass::fixed_curve) return {};
  options.constraints = chosen.model.constraints;
  return take_back_met(options, chosen.fit);
}

void ScreenedData::restore_indices(std::vector<std::size_t>& points) const {
  for (std::size_t& point : points)
    for (const std::size_t each : left_out_)
      if (each <= point) ++point;
}

}  // namespace frac
