// SPDX-License-Identifier: BSD-3-Clause
#include "fitted_points.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>
#include <utility>

#include "base/linear_algebra.hpp"
#include "identification/data/noise_floor.hpp"

namespace frac::detail {
namespace {

using Complex = std::complex<double>;

double largest_of(const Eigen::VectorXcd& value) {
  const double largest = value.cwiseAbs().maxCoeff();
  return largest > 0 ? largest : 1;
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
    const double square = model.projected.residual.segment(2 * k, 2).squaredNorm();
    const double noise_left = 1 - leverage(model.projected, k);
    if (!(square > 0) || !(noise_left > 1e-6)) return shape;
    log_square(k) = std::log(square / noise_left);
    const double x = (2 * std::log(points.omega[static_cast<std::size_t>(k)]) - first - last) / (last - first);
    for (int degree = 0; degree <= degrees; ++degree) columns(k, degree) = std::pow(x, degree);
  }
  const Eigen::MatrixXd basis = PlainQr(columns).basis();
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
  fitted.floor = noise_floor(data, {model, points.omega.size()}, Component::both);
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

/// Improves weights and free poles in turn.
void refine_free_poles(const FrequencyResponseData& data, Fitted& fitted) {
  if (!data.sigma().empty()) return;
  for (int pass = 0; pass < 2; ++pass) {
    weigh_by_residuals(fitted);
    fitted.model = refitted(fitted.points, fitted.model);
  }
  if (weigh_by_shape(fitted)) fitted.model = refitted(fitted.points, fitted.model);
}

}  // namespace

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

double likelihood_criterion(const Fitted& fitted) {
  return fitted.model.criterion + 4 * fitted.points.deviation.array().log().sum();
}

double relative_residual(const Fitted& fitted, Eigen::Index i) {
  const double size = std::abs(fitted.model.value(i));
  return size > 0 ? std::abs(fitted.points.value(i) - fitted.model.value(i)) / size : 0;
}

double rms_of_residuals(const Fitted& fitted) {
  double sum = 0;
  for (Eigen::Index i = 0; i < fitted.points.value.size(); ++i) sum += std::pow(relative_residual(fitted, i), 2);
  // Each point has two parts, and the parameters have taken up some of the freedom.
  const double degrees = std::max(fitted.model.projected.freedom(), 1.0);
  return std::sqrt(sum / degrees);
}

double left_of_mirrored(const Fitted& fitted) {
  const Eigen::Index count = fitted.points.value.size();
  Eigen::VectorXd mirrored(2 * count);
  for (Eigen::Index i = 0; i < count; ++i) {
    mirrored(2 * i) = fitted.points.value(i).real() / fitted.points.deviation(i);
    mirrored(2 * i + 1) = -fitted.points.value(i).imag() / fitted.points.deviation(i);
  }
  const Eigen::MatrixXd& q = fitted.model.projected.orthonormal;
  return (mirrored - q * (q.transpose() * mirrored)).squaredNorm() / fitted.model.projected.square();
}

Fitted fit_on_grid(const FrequencyResponseData& data, std::vector<std::size_t> kept) {
  auto either = unfitted(data, std::move(kept));
  GridCosts costs;
  if (!data.sigma().empty()) {
    either[0].model = best_on_grid(either[0].points, costs);
    return std::move(either[0]);
  }
  for (Fitted& each : either) {
    each.model = best_on_grid(each.points, costs);
    weigh_by_residuals(each);
    each.model = best_on_grid(each.points, costs);
  }
  Fitted fitted = likelier(std::move(either));
  if (weigh_by_shape(fitted)) fitted.model = best_on_grid(fitted.points, costs);
  return fitted;
}

Fitted fit_free_poles(const FrequencyResponseData& data, std::vector<std::size_t> kept,
                      std::span<const std::size_t> pair_counts) {
  auto either = unfitted(data, std::move(kept));
  if (!data.sigma().empty()) {
    either[0].model = best_with_free_poles(either[0].points, pair_counts);
    return std::move(either[0]);
  }
  for (Fitted& each : either) {
    each.model = best_with_free_poles(each.points, pair_counts);
    refine_free_poles(data, each);
  }
  return likelier(std::move(either));
}

Fitted with_free_poles(const FrequencyResponseData& data, Fitted fitted, std::span<const std::size_t> pair_counts) {
  fitted.model = best_with_free_poles(fitted.points, pair_counts);
  refine_free_poles(data, fitted);
  return fitted;
}

Fitted refitted_points(const FrequencyResponseData& data, std::vector<std::size_t> kept, const ConsistentModel& model) {
  Fitted fitted;
  fitted.points = points_of(data, kept);
  fitted.kept = std::move(kept);
  fitted.model = refitted(fitted.points, model);
  refine_free_poles(data, fitted);
  return fitted;
}

std::vector<std::size_t> without(const std::vector<std::size_t>& kept, const std::vector<Eigen::Index>& removed) {
  std::vector<std::size_t> others;
  for (std::size_t i = 0; i < kept.size(); ++i)
    if (std::find(removed.begin(), removed.end(), static_cast<Eigen::Index>(i)) == removed.end())
      others.push_back(kept[i]);
  return others;
}

}  // namespace frac::detail
