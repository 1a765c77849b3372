// SPDX-License-Identifier: BSD-3-Clause
#include "dead_time.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <complex>
#include <utility>
#include <vector>

#include "base/linear_algebra.hpp"

namespace frac::detail {

FrequencyResponseData without_dead_time(const FrequencyResponseData& data, double seconds) {
  std::vector<std::complex<double>> value = data.value();
  for (std::size_t k = 0; k < value.size(); ++k) value[k] *= std::polar(1.0, data.omega()[k] * seconds);
  return {data.omega(), std::move(value), data.sigma()};
}

namespace {

/// Of a system without dead time over this band, divided by the size of each point: real poles, and pairs with 0.3 of
/// the critical damping, which the phase of a resonance needs and a dead time would else make up for.
Eigen::MatrixXd prompt_columns(const std::vector<double>& omega, const Eigen::VectorXd& size) {
  using Complex = std::complex<double>;
  const double low = std::log(omega.front()), high = std::log(omega.back()), decades = (high - low) / std::log(10.0);
  const auto points = static_cast<Eigen::Index>(omega.size());
  constexpr Eigen::Index ends = 3;
  const auto affordable = [&](double per_decade, Eigen::Index most) {
    return std::min(static_cast<Eigen::Index>(std::ceil(per_decade * decades)), most);
  };
  const Eigen::Index pairs = affordable(4, points / 6), poles = affordable(3, points / 4);
  const auto corner = [&](Eigen::Index i, Eigen::Index of) {
    return std::exp(low + (high - low) * (static_cast<double>(i) + 0.5) / static_cast<double>(of));
  };
  Eigen::MatrixXd columns(2 * points, ends + poles + 2 * pairs);
  for (Eigen::Index k = 0; k < points; ++k) {
    const Complex s(0, omega[static_cast<std::size_t>(k)]);
    Eigen::Index column = 0;
    const auto put = [&](Complex value) {
      columns(2 * k, column) = value.real() / size(k);
      columns(2 * k + 1, column++) = value.imag() / size(k);
    };
    put(1);
    put(s / omega.back());
    put(omega.front() / s);
    for (Eigen::Index i = 0; i < poles; ++i) put(1.0 / (1.0 + s / corner(i, poles)));
    for (Eigen::Index i = 0; i < pairs; ++i) {
      const Complex x = s / corner(i, pairs), pair = 1.0 / (1.0 + 0.6 * x + x * x);
      put(pair);
      put(x * pair);
    }
  }
  columns.colwise().normalize();
  return columns;
}

}  // namespace

double dead_time_of(const FrequencyResponseData& data, double share) {
  const std::vector<double>& omega = data.omega();
  const auto points = static_cast<Eigen::Index>(data.size());
  const Eigen::Map<const Eigen::VectorXcd> value(data.value().data(), points);
  const double largest = value.cwiseAbs().maxCoeff();
  if (!(largest > 0)) return 0;
  const Eigen::VectorXd size = value.cwiseAbs().cwiseMax(1e-9 * largest);

  // Sizes do not change when the phase turns, so that one projection serves all dead times.
  const Eigen::MatrixXd basis = PivotedQr(prompt_columns(omega, size)).basis();
  Eigen::VectorXd turned(2 * points);
  const auto left = [&](double seconds) {
    for (Eigen::Index k = 0; k < points; ++k) {
      const std::complex<double> ahead =
          value(k) * std::polar(1 / size(k), omega[static_cast<std::size_t>(k)] * seconds);
      turned(2 * k) = ahead.real();
      turned(2 * k + 1) = ahead.imag();
    }
    return (turned - basis * (basis.transpose() * turned)).squaredNorm();
  };
  const double without = left(0);

  // A dead time that is wrong by more than a radian at the highest frequency misses it altogether.
  constexpr double radians_apart = 0.5;
  constexpr int most_steps = 600;
  const double step = radians_apart / omega.back();
  int best = 0;
  double least = without;
  for (int i = 1; i <= most_steps; ++i) {
    const double here = left(i * step);
    if (!(here < least)) continue;
    least = here;
    best = i;
  }
  double low = std::max(best - 1, 0) * step, high = (best + 1) * step;
  constexpr double golden = 0.6180339887498949;
  for (int i = 0; i < 30; ++i) {
    const double third = high - golden * (high - low), two_thirds = low + golden * (high - low);
    if (left(third) < left(two_thirds))
      high = two_thirds;
    else
      low = third;
  }
  const double seconds = (low + high) / 2;
  // Twice the logarithm of the likelihood.
  constexpr double worth_it = 20;
  const double gain = 2 * static_cast<double>(points) * std::log(without / left(seconds));
  const auto freedom = static_cast<double>(2 * points - basis.cols());
  // The other model may have set aside the very points that ask for a dead time, and then leaves no more than this one.
  constexpr double as_little = 2;
  return gain > worth_it && left(seconds) < as_little * share * share * freedom ? seconds : 0;
}

}  // namespace frac::detail
