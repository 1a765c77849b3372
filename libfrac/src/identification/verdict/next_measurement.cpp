// SPDX-License-Identifier: BSD-3-Clause
#include "identification/verdict/next_measurement.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <vector>

#include "base/linear_algebra.hpp"

namespace frac::detail {
namespace {

using Index = Eigen::Index;
constexpr std::size_t most_points = 64;

/// Responses of a fit at new frequencies with what is not known of them.
struct Prediction {
  Eigen::VectorXd value;       // real and imaginary parts, or one of them
  Eigen::MatrixXd covariance;  // of the values, from that of the estimates
};

/// Rows of a complex value that the component looks at.
void put(Component component, Index points, Index at, std::complex<double> value, Eigen::Ref<Eigen::VectorXd> rows) {
  if (component == Component::both) rows[at + points] = value.imag();
  rows[at] = component == Component::imaginary ? value.imag() : value.real();
}

Prediction predicted(const FitResult& fit, Component component, const std::vector<double>& omega,
                     const std::vector<double>& scale) {
  const Structure structure(fit.model);
  const std::size_t count = structure.parameter_names().size();
  std::vector<double> parameters;
  for (std::size_t i = 0; i < count; ++i) parameters.push_back(fit.parameters[i].value);
  const auto points = static_cast<Index>(omega.size());
  const Index rows = component == Component::both ? 2 * points : points;
  Prediction result{Eigen::VectorXd(rows), {}};
  Eigen::MatrixXd jacobian(rows, static_cast<Index>(count));
  std::vector<std::complex<double>> gradient(count);
  for (Index at = 0; at < points; ++at) {
    const auto i = static_cast<std::size_t>(at);
    const auto value = structure.response_and_gradient(parameters, omega[i], ExactRealisation{}, gradient);
    put(component, points, at, value / scale[i], result.value);
    for (std::size_t k = 0; k < count; ++k) {
      put(component, points, at, gradient[k] / scale[i], jacobian.col(static_cast<Index>(k)));
    }
  }
  // What is fixed, at a bound or not seen takes no part.
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(jacobian.cols(), jacobian.cols());
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t k = 0; k < count; ++k) {
      const double entry = fit.covariance[i][k];
      if (std::isfinite(entry)) covariance(static_cast<Index>(i), static_cast<Index>(k)) = entry;
    }
  }
  result.covariance = jacobian * covariance * jacobian.transpose();
  return result;
}

}  // namespace

std::optional<NextMeasurement> next_measurement(const FrequencyResponseData& data, const FitOptions& options,
                                                const FitResult& a, const FitResult& b, double noise, double wanted) {
  const bool part = options.component == Component::both || options.component == Component::imaginary ||
                    options.component == Component::real;
  if (!part || !std::holds_alternative<ExactRealisation>(options.realisation)) return std::nullopt;
  const bool relative = options.weight == Weight::relative || options.weight == Weight::smoothed_relative ||
                        options.weight == Weight::log_complex;
  const bool learned = options.weight == Weight::learned;
  if ((!relative && !learned && options.weight != Weight::absolute) || !(noise > 0)) return std::nullopt;
  const double floor = learned ? options.noise_floor.value_or(0) : 0;

  const double half_decade = std::sqrt(10.0);
  const auto residual_unit = [&](std::complex<double> response) {
    return relative || learned ? std::hypot(std::abs(response), floor) : 1;
  };
  const auto gain = [&](double lower, std::size_t points, double accuracy) {
    std::vector<double> omega, scale;
    for (std::size_t i = 0; i < points; ++i) {
      const double share = points > 1 ? static_cast<double>(i) / static_cast<double>(points - 1) : 0.5;
      omega.push_back(lower * std::pow(half_decade, share));
    }
    const auto of_a = fitted_response(a, options.realisation, omega);
    for (const std::complex<double>& value : of_a) scale.push_back(residual_unit(value));
    const Prediction first = predicted(a, options.component, omega, scale);
    const Prediction second = predicted(b, options.component, omega, scale);
    const Eigen::VectorXd difference = first.value - second.value;
    // The one of the two that is wrong will adapt itself to the new points.  As either may be wrong, the one that can
    // adapt itself more says what evidence is to be expected.
    double least = std::numeric_limits<double>::infinity();
    for (const Eigen::MatrixXd* own : {&first.covariance, &second.covariance}) {
      Eigen::MatrixXd variance = *own;
      variance.diagonal().array() += accuracy * accuracy;
      const double change = difference.dot(detail::solve_symmetric(variance, difference));
      least = std::isfinite(change) ? std::min(least, change) : 0;
    }
    return least;
  };

  std::vector<double> lowers;
  const double first = data.omega().front() / 10, last = data.omega().back() * 10 / half_decade;
  const auto steps = static_cast<int>(std::ceil(4 * std::log10(last / first)));
  for (int i = 0; i <= steps; ++i) lowers.push_back(first * std::pow(last / first, static_cast<double>(i) / steps));
  double place = 0, most = 0;
  constexpr std::size_t probing = 8;
  for (const double lower : lowers) {
    const double change = gain(lower, probing, noise);
    if (!(change > most)) continue;
    most = change;
    place = lower;
  }
  if (!(most > 0)) return std::nullopt;
  NextMeasurement next{place, place * half_decade, 1, noise, 0, 0};
  for (next.points = 1; next.points < most_points; next.points *= 2) {
    if (gain(place, next.points, noise) >= wanted) break;
  }
  next.expected_evidence = gain(place, next.points, noise);
  for (int halving = 0; halving < 10 && next.expected_evidence < wanted; ++halving) {
    next.accuracy /= 2;
    next.expected_evidence = gain(place, next.points, next.accuracy);
  }
  const auto middle = fitted_response(a, options.realisation, {place * std::sqrt(half_decade)}).front();
  next.relative_accuracy = next.accuracy * residual_unit(middle) / std::abs(middle);
  return next;
}

}  // namespace frac::detail
