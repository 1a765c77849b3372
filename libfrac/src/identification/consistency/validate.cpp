// SPDX-License-Identifier: BSD-3-Clause
#include "frac/identification/validate.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "base/number_text.hpp"
#include "departures.hpp"
#include "judgement.hpp"
#include "level_share.hpp"
#include "special/distributions.hpp"
#include "timely.hpp"

namespace frac {
namespace {

using Complex = std::complex<double>;
using detail::Fitted;
using detail::Judgement;
using detail::Tested;
using detail::Timely;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double fewest_degrees = 8;

/// Whether the points with reversed imaginary parts show no pattern and are explained so much better that no few points
/// can make the difference, such as the two or three on a narrow resonance.
bool sign_is_reversed(const Timely& as_given, const ValidationOptions& options) {
  const FrequencyResponseData& data = as_given.data;
  // Residuals that are 1.6 times as large in every point make this difference: their squares, e times.
  const double of_all_points = 2 * static_cast<double>(data.size());
  // Real poles, however poorly, follow a response better than its complex conjugate.
  if (as_given.judgement.left_of_mirrored > std::numbers::e) return false;
  auto mirrored = data.value();
  for (Complex& each : mirrored) each = std::conj(each);
  const Timely mirror = detail::judge_timely({data.omega(), std::move(mirrored), data.sigma()}, options);
  if (mirror.judgement.pattern(options.level)) return false;
  return detail::criterion_of_all(mirror.data, mirror.judgement) + of_all_points <
         detail::criterion_of_all(data, as_given.judgement);
}

/// Whether a pattern proves nothing.  Over less than an octave, poles outside the band can make any smooth curve, and
/// an echo that turns by more than half a cycle between points looks as if it came before its cause.  Such data are
/// invalid only if their complex conjugate is explained: cause and effect are exchanged then.
bool is_left_open(const FrequencyResponseData& data, bool sign_is_reversed) {
  return data.omega().back() < 2 * data.omega().front() && !sign_is_reversed;
}

/// Judges every k-th point.
ValidationResult validate_thinned(const FrequencyResponseData& data, ValidationOptions options, std::size_t every) {
  std::vector<double> omega, sigma;
  std::vector<Complex> value;
  for (std::size_t k = 0; k < data.size(); k += every) {
    omega.push_back(data.omega()[k]);
    value.push_back(data.value()[k]);
    if (!data.sigma().empty()) sigma.push_back(data.sigma()[k]);
  }
  options.most_points = 0;
  ValidationResult result =
      validate({std::move(omega), std::move(value), std::move(sigma), data.frequency_unit()}, options);
  result.every = every;
  for (auto* points : {&result.outliers, &result.mains})
    for (std::size_t& point : *points) point *= every;
  std::vector<Complex> model(result.model.empty() ? 0 : data.size(), Complex(nan, nan));
  std::vector<double> deviation(model.size(), nan);
  for (std::size_t i = 0; i < result.model.size(); ++i) {
    model[i * every] = result.model[i];
    deviation[i * every] = result.deviation[i];
  }
  result.model = std::move(model);
  result.deviation = std::move(deviation);
  return result;
}

/// The result before anything is judged.
ValidationResult nothing_known(const ValidationOptions& options) {
  ValidationResult result{};
  result.level = options.level;
  result.accuracy = options.accuracy;
  result.tolerance = options.tolerance;
  result.validity = Validity::undecided;
  result.noise = result.drift = result.drift_deviation = result.detectable_drift = nan;
  result.step = result.step_deviation = result.step_below = result.step_above = nan;
  result.drift_share = result.step_share = result.largest_residual = result.consistent_to = nan;
  return result;
}

void describe_tests(const Judgement& judgement, ValidationResult& result) {
  const std::vector<ValidityTest>& of_points = judgement.of_points;
  for (const ValidityTest test : detail::all_tests) {
    const bool alarm = detail::is_of_points(test)
                           ? std::find(of_points.begin(), of_points.end(), test) != of_points.end()
                           : judgement.last.alarm(test, result.level);
    const Tested& tested = detail::is_of_points(test) ? judgement.first : judgement.last;
    result.findings.push_back({test, tested.p_value[detail::index_of(test)], alarm});
  }
  result.outliers = judgement.outliers;
  result.mains = judgement.mains;
  result.correlation = judgement.last.correlation;
}

/// How much of the residuals a drift and a step explain.
void describe_unsteadiness(const Judgement& judgement, ValidationResult& result) {
  const Fitted& fitted = judgement.fitted;
  const Tested& now = judgement.last;
  result.drift = now.drift.coefficient;
  result.drift_deviation = now.drift.deviation;
  result.drift_law = now.drift_law;
  result.drift_explains = !(now.chance_beside_drift < result.level * detail::share_of_level);
  const double square = fitted.model.projected.square();
  result.drift_share = 1 - now.square_beside_drift / square;
  if (now.step.which < 0) return;
  const std::size_t above = detail::first_beyond(now.step.which);
  result.step = now.step.column.coefficient;
  result.step_deviation = now.step.column.deviation;
  result.step_below = fitted.points.omega[above - 1];
  result.step_above = fitted.points.omega[above];
  result.step_share = 1 - now.square_beside_step / square;
  result.step_explains = !(now.chance_beside_step < result.level * detail::share_of_level);
}

void describe_model(const Fitted& fitted, std::size_t points, ValidationResult& result) {
  result.real_poles = fitted.model.grid_poles;
  for (const Complex& pole : fitted.model.free_poles) (pole.imag() == 0 ? result.real_poles : result.pole_pairs) += 1;
  result.freedom = fitted.model.projected.freedom();
  result.largest_residual = 0;
  for (Eigen::Index i = 0; i < fitted.points.value.size(); ++i)
    result.largest_residual = std::max(result.largest_residual, detail::relative_residual(fitted, i));
  result.noise_floor = fitted.floor;
  result.noise_slope = fitted.slope;
  const double scale = std::sqrt(fitted.model.projected.square() / std::max(result.freedom, 1.0));
  // Both stay NaN at points set aside.
  result.model.assign(points, Complex(nan, nan));
  result.deviation.assign(points, nan);
  double sum = 0;
  for (std::size_t i = 0; i < fitted.kept.size(); ++i) {
    const auto at = static_cast<Eigen::Index>(i);
    const std::size_t k = fitted.kept[i];
    result.model[k] = fitted.model.value(at);
    result.deviation[k] = scale * fitted.points.deviation(at);
    sum += std::pow(result.deviation[k] / std::abs(result.model[k]), 2);
  }
  result.noise = std::sqrt(sum / static_cast<double>(fitted.kept.size()));
}

/// The drift that is found in nine of ten such measurements.
double detectable_drift(const FrequencyResponseData& data, const Judgement& judgement, const ValidationResult& result) {
  if (!(result.freedom > 1)) return nan;
  const Tested& now = judgement.last;
  const double degrees = result.freedom - 1;
  const double found = detail::student_t_quantile(0.9, degrees) -
                       detail::student_t_quantile(result.level * detail::share_of_level / 2, degrees);
  const bool is_even = now.drift_law == ValidityTest::drift_even;
  const auto other =
      detail::drift_of(data, judgement.fitted, is_even ? ValidityTest::drift_periods : ValidityTest::drift_even);
  return found * std::fmin(now.drift.deviation, other.deviation);
}

/// The largest root mean square of the relative residuals of neighbouring points, as many as share a neighbourhood.
double largest_neighbourhood(const Fitted& fitted) {
  const Eigen::Index points = fitted.points.value.size();
  const Eigen::Index window = std::min(points, detail::neighbourhood(points));
  double sum = 0, largest = 0;
  for (Eigen::Index i = 0; i < points; ++i) {
    sum += std::pow(detail::relative_residual(fitted, i), 2);
    if (i >= window) sum -= std::pow(detail::relative_residual(fitted, i - window), 2);
    if (i + 1 >= window) largest = std::max(largest, sum);
  }
  // Both parts of a point make one departure.
  return std::sqrt(largest / static_cast<double>(window));
}

/// A drift or step counts where it explains what the residuals show: a phase that is wrong by a third of a degree
/// everywhere looks like a drift of several percent that leaves a pattern.
double consistent_to(const Fitted& fitted, const ValidationResult& result) {
  double largest = largest_neighbourhood(fitted);
  const auto alarmed = [&](ValidityTest test) {
    return std::any_of(result.findings.begin(), result.findings.end(),
                       [test](const auto& each) { return each.test == test && each.alarm; });
  };
  if (result.drift_explains && (alarmed(ValidityTest::drift_even) || alarmed(ValidityTest::drift_periods)))
    largest = std::max(largest, std::abs(result.drift));
  if (result.step_explains && alarmed(ValidityTest::step)) largest = std::max(largest, std::abs(result.step));
  return largest;
}

Validity validity_of(const FrequencyResponseData& data, const Judgement& judgement, const ValidationResult& result) {
  if (result.departs && !(result.consistent_to <= result.tolerance))
    return is_left_open(data, result.reversed_sign) ? Validity::undecided : Validity::invalid;
  if (!(result.freedom >= fewest_degrees) || !(result.detectable_drift < 1)) return Validity::undecided;
  return judgement.of_points.empty() ? Validity::valid : Validity::suspect;
}

}  // namespace

ValidationResult validate(const FrequencyResponseData& data, const ValidationOptions& options) {
  // Quantiles of less are beyond the range of numbers.
  if (!(options.level >= 1e-15 && options.level < 1))
    throw std::invalid_argument("level = " + detail::number_text(options.level) + "; allowed is 1e-15 up to 1");
  if (!(options.accuracy >= 0 && std::isfinite(options.accuracy)))
    throw std::invalid_argument("accuracy = " + detail::number_text(options.accuracy) + "; allowed is 0 or above");
  if (!(options.tolerance >= 0 && std::isfinite(options.tolerance)))
    throw std::invalid_argument("tolerance = " + detail::number_text(options.tolerance) + "; allowed is 0 or above");
  if (options.most_points > 0 && data.size() > options.most_points)
    return validate_thinned(data, options, (data.size() - 1) / options.most_points + 1);

  ValidationResult result = nothing_known(options);
  result.frequency_unit = data.frequency_unit();
  constexpr std::size_t fewest_points = 6;
  if (data.size() < fewest_points || !(data.omega().back() > data.omega().front())) {
    for (const ValidityTest test : detail::all_tests) result.findings.push_back({test, nan, false});
    return result;
  }
  const Timely timely = detail::judge_timely(data, options);
  const Judgement& judgement = timely.judgement;
  describe_tests(judgement, result);
  describe_model(judgement.fitted, data.size(), result);
  result.dead_time = timely.dead_time;
  for (std::size_t k = 0; k < data.size(); ++k) result.model[k] *= std::polar(1.0, -data.omega()[k] * result.dead_time);
  describe_unsteadiness(judgement, result);
  result.detectable_drift = detectable_drift(timely.data, judgement, result);
  result.departs = judgement.pattern(options.level);
  result.consistent_to = consistent_to(judgement.fitted, result);
  result.reversed_sign = result.departs && sign_is_reversed(timely, options);
  result.validity = validity_of(data, judgement, result);
  return result;
}

}  // namespace frac
