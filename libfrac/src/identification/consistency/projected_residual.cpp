// SPDX-License-Identifier: BSD-3-Clause
#include "projected_residual.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "base/linear_algebra.hpp"
#include "special/distributions.hpp"

namespace frac::detail {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// A x for the symmetric matrix A with weights[l - 1] / 2 at distance l between points.
Eigen::MatrixXd neighbours(const Eigen::MatrixXd& x, std::span<const double> weights) {
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(x.rows(), x.cols());
  for (std::size_t l = 1; l <= weights.size(); ++l) {
    const auto shift = static_cast<Eigen::Index>(2 * l);
    if (shift >= x.rows()) break;
    const Eigen::Index overlap = x.rows() - shift;
    sum.topRows(overlap) += 0.5 * weights[l - 1] * x.bottomRows(overlap);
    sum.bottomRows(overlap) += 0.5 * weights[l - 1] * x.topRows(overlap);
  }
  return sum;
}

/// Traces of A^2 and A^3 for `count` points of two rows.
struct Traces {
  double square = 0, cube = 0;
};
Traces traces(Eigen::Index count, std::span<const double> weights) {
  const auto lags = static_cast<Eigen::Index>(weights.size());
  const auto entry = [&](Eigen::Index distance) {
    const Eigen::Index l = std::abs(distance);
    return l == 0 || l > lags ? 0.0 : 0.5 * weights[static_cast<std::size_t>(l - 1)];
  };
  Traces sum;
  for (Eigen::Index i = 0; i < count; ++i) {
    for (Eigen::Index j = std::max<Eigen::Index>(0, i - lags); j <= std::min(count - 1, i + lags); ++j) {
      const double here = entry(i - j);
      if (here == 0) continue;
      sum.square += 2 * here * here;
      double path = 0;
      const Eigen::Index first = std::max<Eigen::Index>({0, i - lags, j - lags});
      const Eigen::Index last = std::min({count - 1, i + lags, j + lags});
      for (Eigen::Index k = first; k <= last; ++k) path += entry(i - k) * entry(k - j);
      sum.cube += 2 * here * path;
    }
  }
  return sum;
}

/// Chances that two normal variables both exceed a limit far above 0.
class BothAbove {
 public:
  explicit BothAbove(double limit) : limit_(limit) {
    for (int i = 0; i <= panels; ++i) {
      const double x = limit + step * i, weight = i == 0 || i == panels ? 1 : i % 2 == 1 ? 4 : 2;
      share_[static_cast<std::size_t>(i)] = weight * std::exp(-x * x / 2) * step / 3 / std::sqrt(2 * std::numbers::pi);
    }
  }
  [[nodiscard]] double chance(double correlation) const {
    const double scale = std::sqrt(std::max(1 - correlation * correlation, 1e-12));
    double sum = 0;
    for (int i = 0; i <= panels; ++i)
      sum += share_[static_cast<std::size_t>(i)] * normal_above((limit_ - correlation * (limit_ + step * i)) / scale);
    return sum;
  }

 private:
  // Integrates the chance of the second given the first over the density of the first, by Simpson's rule.  Nothing is
  // left of that density 9 deviations further on.
  static constexpr int panels = 120;
  static constexpr double step = 9.0 / panels;
  double limit_;
  std::array<double, panels + 1> share_;  // of the density of the first at each node
};

/// The deviate that a normal variable exceeds with this chance.
double normal_deviate(double chance) {
  double low = 0, high = 38;
  for (int i = 0; i < 60; ++i) {
    const double middle = (low + high) / 2;
    (normal_above(middle) > chance ? low : high) = middle;
  }
  return high;
}

}  // namespace

CorrelationTest correlation_test(const ProjectedResidual& of, std::span<const double> weights) {
  const double n = of.freedom();
  if (!(n >= 3) || !(of.square() > 0)) return {nan, nan};
  const Eigen::MatrixXd& q = of.orthonormal;
  const double statistic = of.residual.dot(neighbours(of.residual, weights).col(0)) / of.square();
  // Traces of P A, (P A)^2 and (P A)^3 with P = I - Q Q'.
  const Eigen::MatrixXd once = neighbours(q, weights), twice = neighbours(once, weights);
  const Eigen::MatrixXd inner = q.transpose() * once, inner_twice = q.transpose() * twice;
  const Traces whole = traces(q.rows() / 2, weights);
  const double first = -inner.trace();
  const double second = whole.square - 2 * inner_twice.trace() + inner.squaredNorm();
  const double third = whole.cube - 3 * once.cwiseProduct(twice).sum() + 3 * inner_twice.cwiseProduct(inner).sum() -
                       (inner * inner).cwiseProduct(inner).sum();
  // The eigenvalues of P A about their mean: their power sums make the central moments of the quotient.
  const double mean = first / n;
  const double squares = second - n * mean * mean;
  const double cubes = third - 3 * mean * second + 2 * n * mean * mean * mean;
  const double variance = 2 * squares / (n * (n + 2));
  if (!(variance > 0)) return {nan, nan};
  const double skewness = 8 * cubes / (n * (n + 2) * (n + 4)) / std::pow(variance, 1.5);
  const double deviate = (statistic - mean) / std::sqrt(variance);
  const double excess = statistic - mean;
  if (std::abs(skewness) < 1e-3) return {excess, normal_above(deviate)};
  const double shape = 4 / (skewness * skewness);
  const double place = shape + deviate * std::sqrt(shape) * (skewness > 0 ? 1 : -1);
  if (place <= 0) return {excess, skewness > 0 ? 1.0 : 0.0};
  return {excess, skewness > 0 ? gamma_above(place, shape) : gamma_below(place, shape)};
}

AddedColumn added_column(const ProjectedResidual& of, const Eigen::VectorXd& column) {
  const Eigen::VectorXd free = column - of.orthonormal * (of.orthonormal.transpose() * column);
  const double size = free.squaredNorm(), degrees = of.freedom() - 1;
  if (!(degrees >= 1) || !(size > 1e-20 * column.squaredNorm())) return {nan, nan, nan};
  const double coefficient = free.dot(of.residual) / size;
  const double square = std::max(of.square() - coefficient * coefficient * size, 1e-30 * of.square());
  const double deviation = std::sqrt(square / degrees / size);
  return {coefficient, deviation,
          deviation > 0 ? 2 * student_t_above(std::abs(coefficient) / deviation, degrees) : nan};
}

LargestColumn largest_column(const ProjectedResidual& of, const Eigen::MatrixXd& columns) {
  LargestColumn largest{-1, {nan, nan, nan}};
  const Eigen::MatrixXd& q = of.orthonormal;
  Eigen::MatrixXd free = columns - q * (q.transpose() * columns);
  std::vector<Eigen::Index> used;
  for (Eigen::Index j = 0; j < free.cols(); ++j) {
    const double size = free.col(j).norm();
    if (!(size > 1e-8 * columns.col(j).norm())) continue;
    free.col(j) /= size;
    used.push_back(j);
  }
  double most = 0;
  for (const Eigen::Index j : used) {
    const double share = std::abs(free.col(j).dot(of.residual));
    if (share > most) {
      most = share;
      largest.which = j;
    }
  }
  if (largest.which < 0) return largest;
  largest.column = added_column(of, columns.col(largest.which));
  const double alone = largest.column.p_value;
  double chance = static_cast<double>(used.size()) * alone;
  if (chance > 1e-12) {
    const BothAbove both(normal_deviate(alone / 2));
    for (std::size_t i = 1; i < used.size(); ++i) {
      const double correlation = std::abs(free.col(used[i - 1]).dot(free.col(used[i])));
      chance -= std::min(alone, 2 * both.chance(correlation));
    }
  }
  largest.column.p_value = std::min(1.0, chance);
  return largest;
}

ProjectedResidual with_column(const ProjectedResidual& of, const Eigen::VectorXd& column) {
  const Eigen::VectorXd free = (column - of.orthonormal * (of.orthonormal.transpose() * column)).normalized();
  ProjectedResidual result{Eigen::MatrixXd(of.orthonormal.rows(), of.orthonormal.cols() + 1),
                           of.residual - free * free.dot(of.residual)};
  result.orthonormal << of.orthonormal, free;
  return result;
}

double excess_chance(const ProjectedResidual& of, std::span<const Eigen::Index> points) {
  const auto count = static_cast<Eigen::Index>(points.size());
  const double degrees = of.freedom() - 2 * static_cast<double>(count);
  if (count == 0 || !(degrees >= 3)) return nan;
  Eigen::MatrixXd rows(2 * count, of.orthonormal.cols());
  Eigen::VectorXd residual(2 * count);
  for (Eigen::Index i = 0; i < count; ++i) {
    rows.middleRows(2 * i, 2) = of.orthonormal.middleRows(2 * points[static_cast<std::size_t>(i)], 2);
    residual.segment(2 * i, 2) = of.residual.segment(2 * points[static_cast<std::size_t>(i)], 2);
  }
  // Their squares in units of their own covariance, which the projection has made smaller than that of the noise.
  const Eigen::MatrixXd covariance = Eigen::MatrixXd::Identity(2 * count, 2 * count) - rows * rows.transpose();
  const CholeskyFactor factor(covariance);
  if (!factor.exists()) return nan;
  const double own = residual.dot(factor.solve(residual));
  const double others = of.square() - own;
  if (!(own >= 0) || !std::isfinite(own)) return nan;
  if (!(others > 0)) return 0;
  const double quotient = own / (2 * static_cast<double>(count)) / (others / degrees);
  return fisher_f_above(std::min(quotient, 1e12), 2 * static_cast<double>(count), degrees);
}

}  // namespace frac::detail
