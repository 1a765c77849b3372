// SPDX-License-Identifier: BSD-3-Clause
#include "departures.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <utility>

namespace frac::detail {
namespace {

using Complex = std::complex<double>;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double negligible_drift = 1e-3;
constexpr double highest_leverage = 0.5;

/// Elapsed share of the sweep from high to low frequency.
Eigen::VectorXd elapsed(const FrequencyResponseData& data, ValidityTest law) {
  const auto count = static_cast<Eigen::Index>(data.size());
  Eigen::VectorXd time(count);
  double sum = 0;
  for (Eigen::Index k = count - 1; k >= 0; --k) {
    const double step = law == ValidityTest::drift_even ? 1 : 1 / data.omega()[static_cast<std::size_t>(k)];
    time(k) = sum + step / 2;
    sum += step;
  }
  return time / sum;
}

Eigen::VectorXd drift_column(const FrequencyResponseData& data, const Fitted& fitted, ValidityTest law) {
  const Eigen::VectorXd time = elapsed(data, law);
  Eigen::VectorXd column(2 * static_cast<Eigen::Index>(fitted.kept.size()));
  for (Eigen::Index i = 0; i < fitted.points.value.size(); ++i) {
    const Complex moved = fitted.model.value(i) *
                          time(static_cast<Eigen::Index>(fitted.kept[static_cast<std::size_t>(i)])) /
                          fitted.points.deviation(i);
    column(2 * i) = moved.real();
    column(2 * i + 1) = moved.imag();
  }
  return column;
}

/// One column for each place of a step: the model from there on, zero before.  Two points at least stand on either
/// side.
Eigen::MatrixXd step_columns(const Fitted& fitted) {
  constexpr Eigen::Index least = 2;
  const Eigen::Index count = fitted.points.value.size();
  Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(2 * count, std::max<Eigen::Index>(0, count - 2 * least + 1));
  for (Eigen::Index j = 0; j < columns.cols(); ++j)
    for (Eigen::Index i = j + least; i < count; ++i) {
      const Complex moved = fitted.model.value(i) / fitted.points.deviation(i);
      columns(2 * i, j) = moved.real();
      columns(2 * i + 1, j) = moved.imag();
    }
  return columns;
}
/// Points at the mains that stand out together.
struct MainsFound {
  double p_value = nan;
  std::vector<Eigen::Index> points;
};

/// The mains disturb most at their own frequency, then at its odd harmonics.  Undisturbed points in the set would hide
/// them, so three sets are tested, each of which contains the one before.
MainsFound found_at_mains(const Fitted& fitted, double mains) {
  std::vector<std::vector<Eigen::Index>> sets;
  for (const auto& [highest, step] : {std::pair{1, 1}, {9, 2}, {10, 1}}) {
    auto points = at_mains(fitted, mains, highest, step);
    if (!points.empty() && (sets.empty() || points.size() > sets.back().size())) sets.push_back(std::move(points));
  }
  MainsFound found;
  for (auto& points : sets) {
    const double chance =
        std::min(1.0, static_cast<double>(sets.size()) * excess_chance(fitted.model.projected, points));
    if (std::isnan(found.p_value) || chance < found.p_value) found = {chance, std::move(points)};
  }
  return found;
}

}  // namespace

AddedColumn drift_of(const FrequencyResponseData& data, const Fitted& fitted, ValidityTest law) {
  return added_column(fitted.model.projected, drift_column(data, fitted, law));
}

Eigen::Index neighbourhood(Eigen::Index points) {
  return std::clamp<Eigen::Index>(points / 12, 3, 30);
}

std::size_t first_beyond(Eigen::Index step_column) {
  return static_cast<std::size_t>(step_column) + 2;
}

std::vector<Eigen::Index> at_mains(const Fitted& fitted, double mains, int highest, int step) {
  constexpr double width = 0.02;
  std::vector<Eigen::Index> found;
  const std::vector<double>& omega = fitted.points.omega;
  for (int harmonic = 1; harmonic <= highest; harmonic += step) {
    const double line = 2 * std::numbers::pi * mains * harmonic;
    const auto first = std::lower_bound(omega.begin(), omega.end(), (1 - width) * line);
    const auto last = std::upper_bound(first, omega.end(), (1 + width) * line);
    if (first == last) continue;
    // A line is narrow: where points are dense, the nearest one and its neighbours show it.
    const auto nearest =
        std::min_element(first, last, [line](double a, double b) { return std::abs(a - line) < std::abs(b - line); });
    for (auto at = nearest == first ? first : nearest - 1; at != last && at <= nearest + 1; ++at)
      found.push_back(at - omega.begin());
  }
  return found;
}

Tested tested(const FrequencyResponseData& data, const Fitted& fitted, double accuracy) {
  Tested result;
  result.p_value.fill(nan);
  result.counts.fill(true);
  const auto& projected = fitted.model.projected;
  const auto points = static_cast<Eigen::Index>(fitted.kept.size());
  const bool seen = rms_of_residuals(fitted) > accuracy;

  const std::array next{1.0};
  const auto short_range = correlation_test(projected, next);
  std::vector<double> wide;
  const auto lags = static_cast<std::size_t>(neighbourhood(points));
  for (std::size_t l = 1; l <= lags; ++l) wide.push_back(1 - static_cast<double>(l) / static_cast<double>(lags + 1));
  const auto long_range = correlation_test(projected, wide);
  result.correlation = short_range.excess;
  const auto put = [&](ValidityTest test, double p_value, bool counts) {
    result.p_value[index_of(test)] = p_value;
    result.counts[index_of(test)] = counts;
  };
  put(ValidityTest::neighbours, short_range.p_value, seen);
  put(ValidityTest::neighbourhoods, long_range.p_value, seen);

  const auto even = drift_of(data, fitted, ValidityTest::drift_even);
  const auto periods = drift_of(data, fitted, ValidityTest::drift_periods);
  put(ValidityTest::drift_even, even.p_value, seen && std::abs(even.coefficient) > negligible_drift);
  put(ValidityTest::drift_periods, periods.p_value, seen && std::abs(periods.coefficient) > negligible_drift);
  const bool by_periods = std::isnan(even.p_value) || periods.p_value < even.p_value;
  result.drift_law = by_periods ? ValidityTest::drift_periods : ValidityTest::drift_even;
  result.drift = by_periods ? periods : even;

  const auto beside = [&](const Eigen::VectorXd& column, double& chance, double& square) {
    const auto steady = with_column(projected, column);
    square = steady.square();
    chance = std::fmin(correlation_test(steady, next).p_value, correlation_test(steady, wide).p_value);
  };
  beside(drift_column(data, fitted, result.drift_law), result.chance_beside_drift, result.square_beside_drift);

  const Eigen::MatrixXd steps = step_columns(fitted);
  result.step = largest_column(projected, steps);
  put(ValidityTest::step, result.step.column.p_value,
      seen && std::abs(result.step.column.coefficient) > negligible_drift);
  result.square_beside_step = projected.square();
  if (result.step.which >= 0)
    beside(steps.col(result.step.which), result.chance_beside_step, result.square_beside_step);

  for (Eigen::Index i = 0; i < points; ++i) {
    const std::array one{i};
    // Skips a point that a free pole has moved to: the leverage, and so the chance, holds for poles placed beforehand.
    const bool judged = fitted.model.free_poles.empty() || leverage(projected, i) < highest_leverage;
    const bool counts = relative_residual(fitted, i) > accuracy;
    const double chance = judged && counts ? excess_chance(projected, one) : 1;
    result.point_chance.push_back(std::isnan(chance) ? 1 : chance);
  }
  const double least = *std::min_element(result.point_chance.begin(), result.point_chance.end());
  put(ValidityTest::outliers, std::min(1.0, static_cast<double>(points) * least), true);
  for (const ValidityTest test : {ValidityTest::mains_50, ValidityTest::mains_60}) {
    MainsFound found = found_at_mains(fitted, mains_frequencies[mains_index(test)]);
    const bool counts = std::any_of(found.points.begin(), found.points.end(),
                                    [&](auto i) { return relative_residual(fitted, i) > accuracy; });
    put(test, found.p_value, counts);
    result.at_mains[mains_index(test)] = std::move(found.points);
  }
  return result;
}

}  // namespace frac::detail
