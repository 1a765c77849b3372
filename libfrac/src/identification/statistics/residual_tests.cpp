// SPDX-License-Identifier: BSD-3-Clause
#include "residual_tests.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "autocorrelation.hpp"
#include "first_order_likelihood.hpp"
#include "identification/data/fit_data.hpp"
#include "identification/data/residual_rule.hpp"
#include "identification/search/robust.hpp"
#include "special/distributions.hpp"

namespace frac {

namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t fewest_points = 10;

/// Standard deviation of the noise from the distance of each residual to the middle of its two neighbours, which white
/// noise makes sqrt(3/2) times as large; by the median, so that outliers do not count.
double noise_from_neighbours(std::span<const double> residual, std::size_t per_point) {
  std::vector<double> distance;
  for (std::size_t i = per_point; i + per_point < residual.size(); ++i) {
    distance.push_back(residual[i] - (residual[i - per_point] + residual[i + per_point]) / 2);
  }
  return distance.empty() ? 0 : detail::robust_spread(distance) / std::sqrt(1.5);
}

double chi_squared_chance(double statistic, double degrees) {
  if (!(degrees > 0)) return nan;
  if (!std::isfinite(statistic)) return 0;
  return detail::chi_squared_above(statistic, degrees);
}

std::vector<double> clipped(std::span<const double> residual) {
  const double limit = 3 * detail::robust_spread(residual);
  std::vector<double> result(residual.begin(), residual.end());
  if (limit > 0) {
    for (double& each : result) each = std::clamp(each, -limit, limit);
  }
  return result;
}

/// Runs of points over which the mean residual of five neighbours is far from 0.
std::vector<LackOfFit::Band> missed_bands(std::span<const double> residual, std::size_t per_point,
                                          std::span<const double> abscissa, double noise) {
  constexpr std::size_t reach = 2;
  constexpr double limit = 3;
  std::vector<LackOfFit::Band> bands;
  bool inside = false;
  for (std::size_t i = 0; i < abscissa.size(); ++i) {
    const std::size_t first = i > reach ? i - reach : 0, last = std::min(abscissa.size(), i + reach + 1);
    const auto width = static_cast<double>(last - first);
    bool far = false;
    for (std::size_t part = 0; part < per_point; ++part) {
      double sum = 0;
      for (std::size_t k = first; k < last; ++k) sum += residual[k * per_point + part];
      far = far || std::abs(sum) > limit * noise * std::sqrt(width);
    }
    if (far && !inside) bands.push_back({abscissa[i], abscissa[i]});
    if (far) bands.back().upper = abscissa[i];
    inside = far;
  }
  return bands;
}

/// Variance of the weighted residuals about the means of repeats, and its degrees of freedom.
struct PureError {
  double square = 0, degrees = 0;
};
PureError pure_error(const FrequencyResponseData& data, std::span<const double> residual, std::size_t per_point) {
  PureError error;
  for (std::size_t first = 0; first < data.size();) {
    std::size_t last = first;
    while (last < data.size() && data.omega()[last] == data.omega()[first]) ++last;
    for (std::size_t part = 0; part < per_point && last - first > 1; ++part) {
      double mean = 0;
      for (std::size_t i = first; i < last; ++i) mean += residual[i * per_point + part];
      mean /= static_cast<double>(last - first);
      for (std::size_t i = first; i < last; ++i) {
        const double distance = residual[i * per_point + part] - mean;
        error.square += distance * distance;
      }
      error.degrees += static_cast<double>(last - first - 1);
    }
    first = last;
  }
  return error;
}

double sum_of_squares(std::span<const double> values) {
  double sum = 0;
  for (const double each : values) sum += each * each;
  return sum;
}

bool is_exact(double square, std::size_t count, double rounding) {
  return std::sqrt(square / static_cast<double>(count)) <= rounding;
}

}  // namespace

LackOfFit detail::residual_tests(std::span<const double> residual, std::size_t per_point,
                                 std::span<const double> abscissa, std::size_t parameters, bool told, double rounding,
                                 bool whitened) {
  LackOfFit result{told ? NoiseSource::sigma : NoiseSource::data, 1, nan, nan, nan, nan, true, {}};
  const auto count = static_cast<double>(residual.size());
  const double degrees = count - static_cast<double>(parameters);
  const double square = sum_of_squares(residual);
  if (!std::isfinite(square)) {
    result.adequate = false;
    return result;
  }
  const std::vector<double> tame = clipped(residual);
  if (!told) result.noise = noise_from_neighbours(residual, per_point);
  if (degrees > 0) result.misfit = std::sqrt(square / degrees) / result.noise;
  if (is_exact(square, residual.size(), rounding)) {
    result.misfit = 1;
    return result;
  }
  if (told) {
    result.p_value = chi_squared_chance(square, degrees);
    result.adequate = !(result.p_value < detail::least_chance);
  }
  result.correlation = autocorrelation(tame, per_point, 1);
  if (abscissa.size() >= fewest_points) {
    // Fitted parameters take their share of the slow changes: white noise then shows a correlation of about
    // -parameters/count, with a variance of 1/count.
    const double expected = -static_cast<double>(parameters) / count;
    const double deviate = (result.correlation - expected) * std::sqrt(count);
    const double chance = whitened ? 2 * detail::normal_above(std::abs(deviate)) : detail::normal_above(deviate);
    const double of_all = whiteness(tame, per_point).p_value;
    // The smaller of two chances, doubled because there were two (Bonferroni).
    result.correlation_p_value =
        std::min(1.0, 2 * (result.correlation > 0 || whitened ? std::min(chance, of_all) : chance));
    result.adequate = result.adequate && !(result.correlation_p_value < detail::least_chance);
  }
  if (!result.adequate) result.misses = missed_bands(tame, per_point, abscissa, result.noise);
  return result;
}

// Noise of first order has neighbours correlated by r, the middle of both by r too: e_i - (e_(i-1) + e_(i+1))/2 then
// has the variance 3/2 - 2 r + r^2/2, and a sum of n squares that of n (1 - r^2)/(1 + r^2) independent ones.
LackOfFit detail::first_order_tests(std::span<const double> residual, std::span<const double> time,
                                    std::size_t parameters, bool told, double rounding) {
  const LackOfFit white = residual_tests(residual, 1, time, parameters, told, rounding);
  if (white.adequate || time.size() <= fewest_points || !std::isfinite(white.misfit)) return white;
  const std::vector<double> tame = clipped(residual);
  const double r = first_order_likelihood(tame).correlation;
  if (r == 0) return white;
  std::vector<double> innovation;
  for (std::size_t i = 1; i < tame.size(); ++i) innovation.push_back(tame[i] - r * tame[i - 1]);
  // White noise beside a smooth misfit is no noise of first order: it leaves neighbours that oppose each other, so that
  // either sign tells.
  const ResidualWhiteness left = whiteness(innovation, 1);
  const auto count = static_cast<double>(innovation.size());
  const double expected = -static_cast<double>(parameters + 1) / count;
  const double either_way = 2 * normal_above(std::abs(left.lag_one_correlation - expected) * std::sqrt(count));
  LackOfFit result = white;
  result.correlation_p_value = std::min(1.0, 2 * std::min(either_way, left.p_value));
  result.adequate = !(result.correlation_p_value < least_chance);
  if (told) {
    const double square = sum_of_squares(residual);
    const double degrees = static_cast<double>(residual.size()) - static_cast<double>(parameters);
    const double share = (1 - r * r) / (1 + r * r);
    result.p_value = chi_squared_chance(share * square, share * degrees);
    result.adequate = result.adequate && !(result.p_value < least_chance);
  } else {
    const double nearer = std::sqrt((1.5 - 2 * r + 0.5 * r * r) / 1.5);
    result.noise /= nearer;
    result.misfit *= nearer;
  }
  if (result.adequate) result.misses.clear();
  return result;
}

LackOfFit lack_of_fit(const FrequencyResponseData& data, const FitOptions& options, const FitResult& result) {
  const detail::ResidualRule rule = detail::residual_rule(data, detail::settled(options, result));
  const std::vector<double> residual = detail::weighted_residuals(data, options, result);
  // What ratios of order ten leave of exact data: their coefficients differ by ten decades.
  const double rounding = 1e-9 * rule.unit;
  const bool told = options.weight == Weight::given || options.weight == Weight::repeats;
  LackOfFit test =
      detail::residual_tests(residual, rule.per_point(), data.omega(), result.free_parameters, told, rounding);
  if (options.weight == Weight::repeats) test.source = NoiseSource::repeats;
  if (told) return test;
  const double square = sum_of_squares(residual);
  // Of exact data the repeats scatter by less than their fit.
  if (is_exact(square, residual.size(), rounding)) return test;
  const PureError error = pure_error(data, residual, rule.per_point());
  const double degrees =
      static_cast<double>(residual.size()) - static_cast<double>(result.free_parameters) - error.degrees;
  if (!(error.degrees >= 5) || !(degrees >= 1) || !(error.square > 0)) return test;
  test.source = NoiseSource::repeats;
  const double variance = error.square / error.degrees;
  test.noise = std::sqrt(variance);
  test.misfit = std::sqrt(square / (degrees + error.degrees) / variance);
  const double statistic = std::max(0.0, square - error.square) / degrees / variance;
  test.p_value = detail::fisher_f_above(std::min(statistic, 1e12), degrees, error.degrees);
  test.adequate = test.adequate && !(test.p_value < detail::least_chance);
  if (!test.adequate) test.misses = missed_bands(clipped(residual), rule.per_point(), data.omega(), test.noise);
  return test;
}

namespace {

double rounding_of(const TimeResponseData& data, const TimeFitOptions& options) {
  return 1e-12 * detail::weighted_size(data, options);
}

}  // namespace

LackOfFit detail::tests_in_told_noise(const TimeResponseData& data, const TimeFitOptions& options,
                                      std::span<const double> residual, std::size_t parameters) {
  return residual_tests(residual, 1, observed(data, data.time()), parameters, !data.sigma().empty(),
                        rounding_of(data, options), options.noise_correlation > 0);
}

LackOfFit lack_of_fit(const TimeResponseData& data, const TimeFitOptions& options, const FitResult& result) {
  const TimeFitOptions known = detail::settled(options, result);
  const std::vector<double> residual = detail::weighted_residuals(data, known, result);
  if (known.noise_correlation > 0) {
    return detail::tests_in_told_noise(data, known, residual, result.free_parameters);
  }
  return detail::first_order_tests(residual, detail::observed(data, data.time()), result.free_parameters,
                                   !data.sigma().empty(), rounding_of(data, options));
}

}  // namespace frac
