// SPDX-License-Identifier: BSD-3-Clause
#include "dead_time.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <boost/math/tools/minima.hpp>
#include <cmath>
#include <complex>
#include <cstddef>
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

/// Columns of a system without dead time over this band, divided by the size of each point: real poles, and pairs with
/// 0.3 and 0.1 of the critical damping, which the phase of a resonance needs and a dead time would else make up for.
Eigen::MatrixXd prompt_columns(const std::vector<double>& omega, const Eigen::VectorXd& size) {
  using Complex = std::complex<double>;
  const double low = std::log(omega.front()), high = std::log(omega.back()), decades = (high - low) / std::log(10.0);
  const auto points = static_cast<Eigen::Index>(omega.size());
  constexpr Eigen::Index ends = 3;
  const auto affordable = [&](double per_decade, Eigen::Index most) {
    return std::min(static_cast<Eigen::Index>(std::ceil(per_decade * decades)), most);
  };
  const Eigen::Index pairs = affordable(4, points / 6), narrow = affordable(8, points / 4),
                     poles = affordable(3, points / 4);
  const auto corner = [&](Eigen::Index i, Eigen::Index of) {
    return std::exp(low + (high - low) * (static_cast<double>(i) + 0.5) / static_cast<double>(of));
  };
  Eigen::MatrixXd columns(2 * points, ends + poles + 2 * pairs + 2 * narrow);
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
    for (const auto& [damping, count] : {std::pair{0.3, pairs}, {0.1, narrow}})
      for (Eigen::Index i = 0; i < count; ++i) {
        const Complex x = s / corner(i, count), pair = 1.0 / (1.0 + 2 * damping * x + x * x);
        put(pair);
        put(x * pair);
      }
  }
  columns.colwise().normalize();
  return columns;
}

}  // namespace

std::vector<DeadTime> dead_times_of(const FrequencyResponseData& data, double floor) {
  const std::vector<double>& omega = data.omega();
  const auto points = static_cast<Eigen::Index>(data.size());
  const Eigen::Map<const Eigen::VectorXcd> value(data.value().data(), points);
  const double largest = value.cwiseAbs().maxCoeff();
  if (!(largest > 0)) return {};
  const double smallest = std::max(floor, 1e-9 * largest);
  Eigen::VectorXd size(points);
  for (Eigen::Index k = 0; k < points; ++k) size(k) = std::hypot(std::abs(value(k)), smallest);

  // Sizes do not change when the phase turns, so that one projection serves all dead times, and what it leaves is the
  // sum of all squares but for those it explains.
  const Eigen::MatrixXd basis = PivotedQr(prompt_columns(omega, size)).basis();
  const auto columns = Eigen::seqN(0, basis.cols());
  const Eigen::MatrixXd of_real = basis(Eigen::seqN(0, points, 2), columns).transpose();
  const Eigen::MatrixXd of_imaginary = basis(Eigen::seqN(1, points, 2), columns).transpose();
  const Eigen::VectorXcd prompt = value.cwiseQuotient(size);
  const double all = prompt.squaredNorm();
  const auto turns = [&](double seconds) {
    return Eigen::VectorXcd::NullaryExpr(
        points, [&, seconds](Eigen::Index k) { return std::polar(1.0, omega[static_cast<std::size_t>(k)] * seconds); });
  };
  const auto left = [&](const auto& explained) {
    constexpr double rounding = 1e-15;
    return std::max(all - explained.squaredNorm(), rounding * all);
  };
  const auto left_ahead = [&](double seconds) {
    const Eigen::VectorXcd ahead = prompt.cwiseProduct(turns(seconds));
    return left(of_real * ahead.real() + of_imaginary * ahead.imag());
  };

  // A dead time that is wrong by more than a radian at the highest frequency misses it altogether.
  constexpr double radians_apart = 0.5;
  constexpr std::size_t most_steps = 600;
  const double step = radians_apart / omega.back();
  // Turned by as much to either side of a middle, the points keep what goes with the cosines and reverse what goes with
  // the sines, so that two dead times take the products of one.
  constexpr Eigen::Index aside = 16;
  Eigen::MatrixXd cosines(points, aside), sines(points, aside);
  for (Eigen::Index j = 0; j < aside; ++j) {
    const Eigen::VectorXcd turn = turns(static_cast<double>(j + 1) * step);
    cosines.col(j) = turn.real();
    sines.col(j) = turn.imag();
  }
  std::vector<double> costs;
  for (Eigen::Index middle = aside; costs.size() <= most_steps; middle += 2 * aside + 1) {
    const Eigen::VectorXcd here = prompt.cwiseProduct(turns(static_cast<double>(middle) * step));
    const Eigen::VectorXd real = here.real(), imaginary = here.imag();
    const Eigen::MatrixXd kept = of_real * real.asDiagonal() + of_imaginary * imaginary.asDiagonal();
    const Eigen::MatrixXd reversed = of_imaginary * real.asDiagonal() - of_real * imaginary.asDiagonal();
    const Eigen::MatrixXd even = kept * cosines, odd = reversed * sines;
    for (Eigen::Index j = aside; j-- > 0;) costs.push_back(left(even.col(j) - odd.col(j)));
    costs.push_back(left(kept.rowwise().sum()));
    for (Eigen::Index j = 0; j < aside; ++j) costs.push_back(left(even.col(j) + odd.col(j)));
  }
  const double undelayed = costs.front();
  const auto freedom = static_cast<double>(2 * points - basis.cols());
  std::vector<DeadTime> found;
  for (std::size_t i = 1; i < most_steps; ++i) {
    if (!(costs[i] < costs[i - 1] && costs[i] <= costs[i + 1])) continue;
    // To a thousandth of a step.
    constexpr int bits = 10;
    const auto [offset, here] = boost::math::tools::brent_find_minima(
        [&](double steps) { return left_ahead((static_cast<double>(i) + steps) * step); }, -1.0, 1.0, bits);
    const double seconds = (static_cast<double>(i) + offset) * step;
    // Twice the logarithm of the likelihood.
    constexpr double worth_it = 20;
    if (2 * static_cast<double>(points) * std::log(undelayed / here) > worth_it)
      found.push_back({seconds, std::sqrt(here / freedom)});
  }
  std::sort(found.begin(), found.end(), [](const DeadTime& a, const DeadTime& b) { return a.left < b.left; });
  return found;
}

}  // namespace frac::detail
