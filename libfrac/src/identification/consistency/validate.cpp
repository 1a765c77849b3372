// SPDX-License-Identifier: BSD-3-Clause
#include "frac/identification/validate.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <optional>
#include <span>
#include <stdexcept>

#include "base/linear_algebra.hpp"
#include "base/number_text.hpp"
#include "consistent_model.hpp"
#include "dead_time.hpp"
#include "frac/identification/statistics.hpp"
#include "identification/data/noise_floor.hpp"
#include "level_share.hpp"
#include "projected_residual.hpp"
#include "special/distributions.hpp"

namespace frac {
namespace {

using Complex = std::complex<double>;
using detail::ConsistentModel;
using detail::WeightedPoints;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr std::array all_tests{ValidityTest::neighbours,    ValidityTest::neighbourhoods, ValidityTest::drift_even,
                               ValidityTest::drift_periods, ValidityTest::step,           ValidityTest::outliers,
                               ValidityTest::mains_50,      ValidityTest::mains_60};
constexpr double fewest_degrees = 8;
constexpr double negligible_drift = 1e-3;
constexpr double highest_leverage = 0.5;

std::size_t index_of(ValidityTest test) {
  return static_cast<std::size_t>(test);
}

/// Points by index into the data, and a model of them.
struct Fitted {
  std::vector<std::size_t> kept;
  WeightedPoints points;
  ConsistentModel model;
  double floor = 0, slope = 0;
};

double largest_of(const Eigen::VectorXcd& value) {
  const double largest = value.cwiseAbs().maxCoeff();
  return largest > 0 ? largest : 1;
}

WeightedPoints points_of(const FrequencyResponseData& data, const std::vector<std::size_t>& kept) {
  WeightedPoints points;
  const auto count = static_cast<Eigen::Index>(kept.size());
  points.value.resize(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    points.omega.push_back(data.omega()[kept[static_cast<std::size_t>(i)]]);
    points.value(i) = data.value()[kept[static_cast<std::size_t>(i)]];
  }
  points.deviation = points.value.cwiseAbs().cwiseMax(1e-9 * largest_of(points.value));
  if (!data.sigma().empty())
    for (Eigen::Index i = 0; i < count; ++i) points.deviation(i) = data.sigma()[kept[static_cast<std::size_t>(i)]];
  return points;
}

/// How the noise changes over the band.
struct NoiseShape {
  std::vector<double> log_size;  // of each point, its mean 0; empty: nothing is clear
  double slope = 0;              // over the logarithm of frequency, on average
};

/// Regression of ln |r|^2 on polynomials of ln omega.  The logarithm of the sum of two squared normal variables has the
/// variance pi^2/6; divided by it, what each column explains is a chi-squared variable.
NoiseShape noise_shape(const WeightedPoints& points, const ConsistentModel& model) {
  const auto count = static_cast<Eigen::Index>(points.omega.size());
  NoiseShape shape;
  if (count < 12) return shape;
  constexpr int highest = 4;
  const int degrees = static_cast<int>(std::min<Eigen::Index>(highest, count / 12));
  const double first = std::log(points.omega.front()), last = std::log(points.omega.back());
  Eigen::MatrixXd columns(count, degrees + 1);
  Eigen::VectorXd log_square(count);
  for (Eigen::Index k = 0; k < count; ++k) {
    const double square = model.rest.residual.segment(2 * k, 2).squaredNorm();
    const double noise_left = 1 - detail::leverage(model.rest, k);
    if (!(square > 0) || !(noise_left > 1e-6)) return shape;
    log_square(k) = std::log(square / noise_left);
    const double x = (2 * std::log(points.omega[static_cast<std::size_t>(k)]) - first - last) / (last - first);
    for (int degree = 0; degree <= degrees; ++degree) columns(k, degree) = std::pow(x, degree);
  }
  const Eigen::MatrixXd basis = detail::PlainQr(columns).basis();
  const Eigen::VectorXd found = basis.transpose() * log_square;
  constexpr double variance = std::numbers::pi * std::numbers::pi / 6;
  // A slope alone has to explain 9, three standard deviations; each further degree adds 3 to that.
  double most = 0, sum = 0;
  int chosen = 0;
  for (int degree = 1; degree <= degrees; ++degree) {
    sum += found(degree) * found(degree) / variance;
    const double gain = sum - 6 - 3 * degree;
    if (!(gain > most)) continue;
    most = gain;
    chosen = degree;
  }
  if (chosen == 0) return shape;
  const Eigen::VectorXd log_size = 0.5 * basis.middleCols(1, chosen) * found.segment(1, chosen);
  shape.log_size.assign(log_size.begin(), log_size.end());
  shape.slope = basis.col(1).dot(log_size) / basis.col(1).dot(columns.col(1)) * 2 / (last - first);
  return shape;
}

/// Sets the weights by the noise that the residuals show: in part relative to the model, in part additive.
void weigh_by_residuals(Fitted& fitted) {
  WeightedPoints& points = fitted.points;
  const Complex* model = fitted.model.value.data();
  const FrequencyResponseData data(points.omega, {points.value.data(), points.value.data() + points.value.size()});
  fitted.floor = detail::noise_floor(data, {model, points.omega.size()}, Component::both);
  const double smallest = 1e-9 * largest_of(points.value);
  for (Eigen::Index k = 0; k < points.value.size(); ++k)
    points.deviation(k) = std::hypot(std::max(std::abs(fitted.model.value(k)), smallest), fitted.floor);
}

/// Scales the weights where the noise also changes with frequency.
/// @return whether it clearly does
bool weigh_by_shape(Fitted& fitted) {
  const NoiseShape shape = noise_shape(fitted.points, fitted.model);
  fitted.slope = shape.slope;
  for (std::size_t k = 0; k < shape.log_size.size(); ++k)
    fitted.points.deviation(static_cast<Eigen::Index>(k)) *= std::exp(shape.log_size[k]);
  return !shape.log_size.empty();
}

/// AICc with the part of the likelihood that depends on the weights.
double likelihood_criterion(const Fitted& fitted) {
  return fitted.model.criterion + 4 * fitted.points.deviation.array().log().sum();
}

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

detail::AddedColumn drift_of(const FrequencyResponseData& data, const Fitted& fitted, ValidityTest law) {
  return detail::added_column(fitted.model.rest, drift_column(data, fitted, law));
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
std::size_t first_beyond(Eigen::Index step_column) {
  return static_cast<std::size_t>(step_column) + 2;
}

constexpr std::array mains_frequencies{50.0, 60.0};

std::size_t mains_index(ValidityTest test) {
  return test == ValidityTest::mains_50 ? 0 : 1;
}

/// Positions among the kept points that lie at a harmonic of the mains: the first, and every `step`-th after it up to
/// the one numbered `highest`.
std::vector<Eigen::Index> at_mains(const Fitted& fitted, double mains, int highest, int step) {
  constexpr double width = 0.02;
  std::vector<Eigen::Index> found;
  for (std::size_t i = 0; i < fitted.points.omega.size(); ++i) {
    const double multiple = fitted.points.omega[i] / (2 * std::numbers::pi * mains);
    const double nearest = std::round(multiple);
    const bool is_meant = nearest >= 1 && nearest <= highest && (static_cast<int>(nearest) - 1) % step == 0;
    if (is_meant && std::abs(multiple - nearest) <= width * nearest) found.push_back(static_cast<Eigen::Index>(i));
  }
  return found;
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
        std::min(1.0, static_cast<double>(sets.size()) * detail::excess_chance(fitted.model.rest, points));
    if (std::isnan(found.p_value) || chance < found.p_value) found = {chance, std::move(points)};
  }
  return found;
}

double relative_residual(const Fitted& fitted, Eigen::Index i) {
  const double size = std::abs(fitted.model.value(i));
  return size > 0 ? std::abs(fitted.points.value(i) - fitted.model.value(i)) / size : 0;
}

double rms_of_residuals(const Fitted& fitted) {
  double sum = 0;
  for (Eigen::Index i = 0; i < fitted.points.value.size(); ++i) sum += std::pow(relative_residual(fitted, i), 2);
  // Each point has two parts, and the parameters have taken up some of the freedom.
  const double degrees = std::max(fitted.model.rest.freedom(), 1.0);
  return std::sqrt(sum / degrees);
}

/// Findings about one model, and the point of the largest residual.
struct Tested {
  std::array<double, all_tests.size()> p_value;
  std::array<bool, all_tests.size()> counts;  // the departure is not negligible
  double correlation = 0;
  detail::AddedColumn drift;
  ValidityTest drift_law = ValidityTest::drift_even;
  detail::LargestColumn step;
  double chance_beside_drift = nan;  // the least of both neighbour tests, the drift taken out
  double chance_beside_step = nan;
  double square_beside_drift, square_beside_step;                            // what is left then
  std::vector<double> point_chance;                                          // of each residual
  std::array<std::vector<Eigen::Index>, mains_frequencies.size()> at_mains;  // that stand out most together

  [[nodiscard]] bool alarm(ValidityTest test, double level) const {
    const std::size_t i = index_of(test);
    return counts[i] && p_value[i] < level * detail::share_of_level;
  }
  /// Every point whose residual is an alarm by itself.
  [[nodiscard]] std::vector<Eigen::Index> standing_out(double level) const {
    std::vector<Eigen::Index> points;
    const double limit = level * detail::share_of_level / static_cast<double>(point_chance.size());
    for (std::size_t i = 0; i < point_chance.size(); ++i)
      if (point_chance[i] < limit) points.push_back(static_cast<Eigen::Index>(i));
    return points;
  }
};

Tested tested(const FrequencyResponseData& data, const Fitted& fitted, double accuracy) {
  Tested result;
  result.p_value.fill(nan);
  result.counts.fill(true);
  const auto& rest = fitted.model.rest;
  const auto points = static_cast<Eigen::Index>(fitted.kept.size());
  const bool seen = rms_of_residuals(fitted) > accuracy;

  const std::array next{1.0};
  const auto short_range = detail::correlation_test(rest, next);
  std::vector<double> wide;
  const auto reach = std::clamp<std::size_t>(static_cast<std::size_t>(points) / 12, 3, 30);
  for (std::size_t l = 1; l <= reach; ++l) wide.push_back(1 - static_cast<double>(l) / static_cast<double>(reach + 1));
  const auto long_range = detail::correlation_test(rest, wide);
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
    const auto steady = detail::with_column(rest, column);
    square = steady.square();
    chance = std::fmin(detail::correlation_test(steady, next).p_value, detail::correlation_test(steady, wide).p_value);
  };
  beside(drift_column(data, fitted, result.drift_law), result.chance_beside_drift, result.square_beside_drift);

  const Eigen::MatrixXd steps = step_columns(fitted);
  result.step = detail::largest_column(rest, steps);
  put(ValidityTest::step, result.step.column.p_value,
      seen && std::abs(result.step.column.coefficient) > negligible_drift);
  result.square_beside_step = rest.square();
  if (result.step.which >= 0)
    beside(steps.col(result.step.which), result.chance_beside_step, result.square_beside_step);

  for (Eigen::Index i = 0; i < points; ++i) {
    const std::array one{i};
    // Skips a point that a free pole has moved to: the leverage, and so the chance, holds for poles placed beforehand.
    const bool judged = fitted.model.free_poles.empty() || detail::leverage(rest, i) < highest_leverage;
    const bool counts = relative_residual(fitted, i) > accuracy;
    const double chance = judged && counts ? detail::excess_chance(rest, one) : 1;
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

/// The points with the two kinds of weights that a fit starts from, relative and additive.  Residuals show noise of one
/// kind best where the weights of the fit are of that kind.
std::array<Fitted, 2> unfitted(const FrequencyResponseData& data, std::vector<std::size_t> kept) {
  Fitted relative;
  relative.points = points_of(data, kept);
  relative.kept = std::move(kept);
  Fitted additive = relative;
  additive.points.deviation.setConstant(largest_of(relative.points.value));
  return {std::move(relative), std::move(additive)};
}

Fitted likelier(std::array<Fitted, 2> of) {
  return std::move(of[likelihood_criterion(of[1]) < likelihood_criterion(of[0]) ? 1 : 0]);
}

/// What the poles of the model leave of the complex conjugates of the points, over what they leave of the points.
double left_of_mirrored(const Fitted& fitted) {
  const Eigen::Index count = fitted.points.value.size();
  Eigen::VectorXd mirrored(2 * count);
  for (Eigen::Index i = 0; i < count; ++i) {
    mirrored(2 * i) = fitted.points.value(i).real() / fitted.points.deviation(i);
    mirrored(2 * i + 1) = -fitted.points.value(i).imag() / fitted.points.deviation(i);
  }
  const Eigen::MatrixXd& q = fitted.model.rest.orthonormal;
  return (mirrored - q * (q.transpose() * mirrored)).squaredNorm() / fitted.model.rest.square();
}

/// The best model with poles on a grid, weighted by its own residuals.
Fitted fit_on_grid(const FrequencyResponseData& data, std::vector<std::size_t> kept) {
  auto either = unfitted(data, std::move(kept));
  detail::GridCosts costs;
  if (!data.sigma().empty()) {
    either[0].model = detail::best_on_grid(either[0].points, costs);
    return std::move(either[0]);
  }
  for (Fitted& each : either) {
    each.model = detail::best_on_grid(each.points, costs);
    weigh_by_residuals(each);
    each.model = detail::best_on_grid(each.points, costs);
  }
  Fitted fitted = likelier(std::move(either));
  if (weigh_by_shape(fitted)) fitted.model = detail::best_on_grid(fitted.points, costs);
  return fitted;
}

/// Improves weights and free poles in turn.
void settle_free_poles(const FrequencyResponseData& data, Fitted& fitted) {
  if (!data.sigma().empty()) return;
  for (int pass = 0; pass < 2; ++pass) {
    weigh_by_residuals(fitted);
    fitted.model = detail::refitted(fitted.points, fitted.model);
  }
  if (weigh_by_shape(fitted)) fitted.model = detail::refitted(fitted.points, fitted.model);
}

Fitted fit_free_poles(const FrequencyResponseData& data, std::vector<std::size_t> kept,
                      std::span<const std::size_t> pair_counts) {
  auto either = unfitted(data, std::move(kept));
  if (!data.sigma().empty()) {
    either[0].model = detail::best_with_free_poles(either[0].points, pair_counts);
    return std::move(either[0]);
  }
  for (Fitted& each : either) {
    each.model = detail::best_with_free_poles(each.points, pair_counts);
    settle_free_poles(data, each);
  }
  return likelier(std::move(either));
}

/// Free poles for points whose weights come from the residuals of another model.
Fitted with_free_poles(const FrequencyResponseData& data, Fitted fitted, std::span<const std::size_t> pair_counts) {
  fitted.model = detail::best_with_free_poles(fitted.points, pair_counts);
  settle_free_poles(data, fitted);
  return fitted;
}

/// Fits a model anew to some of its points, starting from its poles.
Fitted refitted_points(const FrequencyResponseData& data, std::vector<std::size_t> kept, const ConsistentModel& model) {
  Fitted fitted;
  fitted.points = points_of(data, kept);
  fitted.kept = std::move(kept);
  fitted.model = detail::refitted(fitted.points, model);
  settle_free_poles(data, fitted);
  return fitted;
}

std::vector<std::size_t> without(const std::vector<std::size_t>& kept, const std::vector<Eigen::Index>& removed) {
  std::vector<std::size_t> rest;
  for (std::size_t i = 0; i < kept.size(); ++i)
    if (std::find(removed.begin(), removed.end(), static_cast<Eigen::Index>(i)) == removed.end())
      rest.push_back(kept[i]);
  return rest;
}

bool is_of_points(ValidityTest test) {
  return test == ValidityTest::outliers || test == ValidityTest::mains_50 || test == ValidityTest::mains_60;
}

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
  const ConsistentModel model = detail::on_grid(all, others.model.grid_poles, others.model.reach);
  const std::array one{at};
  // The model was chosen so that this point stands out, which counts like looking at some three models.
  constexpr double models = 3;
  const double chance = models * detail::excess_chance(model.rest, one);
  if (!(chance < *largest)) return;
  *largest = chance;
  result.p_value[index_of(ValidityTest::outliers)] = std::min(1.0, points * chance);
}

/// A model of the points that do not stand out, and what was found on the way.
struct Judgement {
  Fitted fitted;
  Tested first, last;  // with all points, and without those that stand out
  std::vector<ValidityTest> of_points;
  std::vector<std::size_t> outliers, mains;
  double left_of_mirrored = 0;  // with poles on a grid, of all points

  [[nodiscard]] bool pattern(double level) const {
    return std::any_of(all_tests.begin(), all_tests.end(),
                       [&](ValidityTest test) { return !is_of_points(test) && last.alarm(test, level); });
  }
  [[nodiscard]] bool steady(double level) const { return !pattern(level) && of_points.empty(); }
};

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

/// AICc of all points with the part of the likelihood that depends on the weights.  A point set aside costs
/// price_of_point; a drift two parameters, its size and its law; a step two, its size and place.
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
  const auto parameters = static_cast<std::size_t>(fitted.model.rest.orthonormal.cols()) +
                          detail::price_of_narrow_pair * fitted.model.narrow_pairs + price_of_point * aside;
  const auto aicc = [&](double square, std::size_t further) {
    return information_criteria(square * share, 2 * data.size(), parameters + further, rounding).aicc;
  };
  return std::min({aicc(fitted.model.rest.square(), 0), aicc(judgement.last.square_beside_drift, 2),
                   aicc(judgement.last.square_beside_step, 2)}) +
         4 * logarithms;
}

/// Whether points stand out and none of the outliers are neighbours.
bool has_lone_points(const Judgement& judgement) {
  const std::vector<std::size_t>& points = judgement.outliers;
  const auto next = [](std::size_t a, std::size_t b) { return b == a + 1; };
  return !judgement.of_points.empty() && std::adjacent_find(points.begin(), points.end(), next) == points.end();
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

/// The points without their dead time, and the judgement of them.
struct Timely {
  FrequencyResponseData data;
  Judgement judgement;
  double dead_time = 0;
};

Timely judge_without(double dead_time, const FrequencyResponseData& data, const ValidationOptions& options) {
  FrequencyResponseData ahead = detail::without_dead_time(data, dead_time);
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
  const double seconds = detail::added_column(fitted.model.rest, column).coefficient;
  const double most = 1 / fitted.points.omega.back();
  return std::isfinite(seconds) ? std::clamp(seconds, -most, most) : 0;
}

/// A dead time with a few pairs of poles beside real ones, brought to least squares together with them.
struct TimedFit {
  double seconds, criterion;
};
TimedFit fit_timed(const FrequencyResponseData& data, const detail::DeadTime& start, double floor) {
  std::vector<std::size_t> all(data.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  const auto ahead = [&](double seconds) {
    WeightedPoints points = points_of(detail::without_dead_time(data, seconds), all);
    if (data.sigma().empty())
      for (double& each : points.deviation) each = std::hypot(each, floor);
    return points;
  };
  Fitted fitted;
  fitted.points = ahead(start.seconds);
  constexpr std::array<std::size_t, 2> fewest{1, 2};
  fitted.model = detail::best_with_free_poles(fitted.points, fewest);
  TimedFit best{start.seconds, likelihood_criterion(fitted)};
  constexpr int most_steps = 5;
  for (int i = 0; i < most_steps; ++i) {
    const double seconds = best.seconds + further_dead_time(fitted);
    fitted.points = ahead(seconds);
    fitted.model = detail::refitted(fitted.points, fitted.model);
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
    const std::vector<detail::DeadTime> found = detail::dead_times_of(data, 0);
    return !found.empty() && std::pow(found.front().left, 2) < as_little * left * left ? found.front().seconds : 0;
  }
  // Fixed places follow a resonance only so far: of several dead times poles at free places tell which.  Points that
  // are noise where it is additive would hide it.
  TimedFit best{0, std::numeric_limits<double>::infinity()};
  for (const double floor : {0.0, plain.fitted.floor}) {
    constexpr std::size_t most = 3;
    const std::vector<detail::DeadTime> found = detail::dead_times_of(data, floor);
    for (std::size_t i = 0; i < std::min(found.size(), most); ++i) {
      const TimedFit here = fit_timed(data, found[i], floor);
      if (here.criterion < best.criterion) best = here;
    }
    if (!(plain.fitted.floor > 0)) break;
  }
  return best.seconds;
}

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
  const Timely mirror = judge_timely({data.omega(), std::move(mirrored), data.sigma()}, options);
  if (mirror.judgement.pattern(options.level)) return false;
  return criterion_of_all(mirror.data, mirror.judgement) + of_all_points < criterion_of_all(data, as_given.judgement);
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
  ValidationResult result = validate({std::move(omega), std::move(value), std::move(sigma)}, options);
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
  result.validity = Validity::undecided;
  result.noise = result.drift = result.drift_deviation = result.detectable_drift = nan;
  result.step = result.step_deviation = result.step_below = result.step_above = nan;
  result.drift_share = result.step_share = result.largest_residual = nan;
  return result;
}

void describe_tests(const Judgement& judgement, ValidationResult& result) {
  const std::vector<ValidityTest>& of_points = judgement.of_points;
  for (const ValidityTest test : all_tests) {
    const bool alarm = is_of_points(test) ? std::find(of_points.begin(), of_points.end(), test) != of_points.end()
                                          : judgement.last.alarm(test, result.level);
    const Tested& tested = is_of_points(test) ? judgement.first : judgement.last;
    result.findings.push_back({test, tested.p_value[index_of(test)], alarm});
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
  const double square = fitted.model.rest.square();
  result.drift_share = 1 - now.square_beside_drift / square;
  if (now.step.which < 0) return;
  const std::size_t above = first_beyond(now.step.which);
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
  result.freedom = fitted.model.rest.freedom();
  result.largest_residual = 0;
  for (Eigen::Index i = 0; i < fitted.points.value.size(); ++i)
    result.largest_residual = std::max(result.largest_residual, relative_residual(fitted, i));
  result.noise_floor = fitted.floor;
  result.noise_slope = fitted.slope;
  const double scale = std::sqrt(fitted.model.rest.square() / std::max(result.freedom, 1.0));
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
  const auto other = drift_of(data, judgement.fitted, is_even ? ValidityTest::drift_periods : ValidityTest::drift_even);
  return found * std::fmin(now.drift.deviation, other.deviation);
}

Validity validity_of(const FrequencyResponseData& data, const Judgement& judgement, const ValidationResult& result) {
  if (judgement.pattern(result.level))
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
  if (options.most_points > 0 && data.size() > options.most_points)
    return validate_thinned(data, options, (data.size() - 1) / options.most_points + 1);

  ValidationResult result = nothing_known(options);
  constexpr std::size_t fewest_points = 6;
  if (data.size() < fewest_points || !(data.omega().back() > data.omega().front())) {
    for (const ValidityTest test : all_tests) result.findings.push_back({test, nan, false});
    return result;
  }
  const Timely timely = judge_timely(data, options);
  const Judgement& judgement = timely.judgement;
  describe_tests(judgement, result);
  describe_model(judgement.fitted, data.size(), result);
  result.dead_time = timely.dead_time;
  for (std::size_t k = 0; k < data.size(); ++k) result.model[k] *= std::polar(1.0, -data.omega()[k] * result.dead_time);
  describe_unsteadiness(judgement, result);
  result.detectable_drift = detectable_drift(timely.data, judgement, result);
  result.reversed_sign = judgement.pattern(options.level) && sign_is_reversed(timely, options);
  result.validity = validity_of(data, judgement, result);
  return result;
}

}  // namespace frac
