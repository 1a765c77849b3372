// SPDX-License-Identifier: BSD-3-Clause
#include "smooth_error.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <utility>

#include "base/linear_algebra.hpp"
#include "base/wide_vectors.hpp"

namespace frac::detail {

namespace {

constexpr std::size_t most_blocks = 256;

/// Of finite numbers; the operator of the library looks for infinities.
std::complex<double> product(std::complex<double> a, std::complex<double> b) {
  return {a.real() * b.real() - a.imag() * b.imag(), a.real() * b.imag() + a.imag() * b.real()};
}

using Lanes = Doubles<SmoothError::side_by_side>::Type;

/// Covariance of the smooth error and of its slope for each share, given what was seen before.
struct Matern {
  double rate;  // sqrt(3)/length
  Lanes share, steepness, value, cross, slope;

  FRACFIT_INLINE Matern(const Lanes& shares, double length)
      : rate(std::sqrt(3.0) / length),
        share(shares),
        steepness(shares * rate * rate),
        value(share),
        cross{},
        slope(steepness) {}

  /// The transition over a distance is [[a, b], [c, d]].
  struct Step {
    double a = 1, b = 0, c = 0, d = 1;
  };
  FRACFIT_INLINE Step advance(double distance) {
    const double decay = std::exp(-rate * distance), q = rate * distance;
    const Step step{decay * (1 + q), decay * distance, -decay * rate * q, decay * (1 - q)};
    // P -> P0 + F (P - P0) F', with P0 the stationary covariance: what is known fades.
    const Lanes v = value - share, x = cross, s = slope - steepness;
    value = share + step.a * step.a * v + 2 * step.a * step.b * x + step.b * step.b * s;
    cross = step.a * step.c * v + (step.a * step.d + step.b * step.c) * x + step.b * step.d * s;
    slope = steepness + step.c * step.c * v + 2 * step.c * step.d * x + step.d * step.d * s;
    return step;
  }
};

}  // namespace

void SmoothError::turn(std::size_t first, Eigen::Ref<Eigen::MatrixXd> rows) const {
  const auto parts = static_cast<Eigen::Index>(axis_.per_point);
  const Eigen::Index points = axis_.factor.empty() ? 0 : rows.rows() / parts;
  for (Eigen::Index column = 0; column < rows.cols(); ++column) {
    for (Eigen::Index i = 0; i < points; ++i) {
      const std::complex<double> factor = axis_.factor[first + static_cast<std::size_t>(i)];
      double* const part = &rows(i * parts, column);
      if (parts == 1) {
        part[0] *= factor.real();
        continue;
      }
      const std::complex<double> turned = product({part[0], part[1]}, factor);
      part[0] = turned.real();
      part[1] = turned.imag();
    }
  }
}

template <typename Visit>
void SmoothError::for_each_piece(const Visit& visit) const {
  const std::size_t piece = block_ * std::max<std::size_t>(1, most_blocks / block_);
  for (std::size_t first = 0; first < axis_.position.size(); first += piece) {
    const std::size_t row = first * axis_.per_point, end = std::min(axis_.position.size(), first + piece);
    visit(first, static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(end * axis_.per_point - row));
  }
}

SmoothError::SmoothError(std::span<const double> residual, const Eigen::Ref<const Eigen::MatrixXd>& basis,
                         const ResidualAxis& axis)
    : axis_(axis),
      block_((axis.position.size() + most_blocks - 1) / most_blocks),
      position_((axis.position.size() + block_ - 1) / block_, 0.0),
      points_(position_.size(), 0.0),
      degrees_(static_cast<double>(residual.size()) - static_cast<double>(basis.cols())),
      width_(basis.cols()) {
  for (std::size_t i = 0; i < axis_.position.size(); ++i) {
    position_[i / block_] += axis_.position[i];
    ++points_[i / block_];
  }
  for (std::size_t b = 0; b < position_.size(); ++b) position_[b] /= points_[b];
  for (const std::complex<double> factor : axis_.factor)
    by_turning_ += static_cast<double>(axis_.per_point) * std::log(std::abs(factor));
  spacing_ = (position_.back() - position_.front()) / std::max(1.0, static_cast<double>(position_.size()) - 1);

  const auto parts = static_cast<Eigen::Index>(axis_.per_point);
  means_.resize(static_cast<Eigen::Index>(position_.size()) * parts, width_ + 1);
  within_ = Rows::Zero(width_ + 1, width_ + 1);
  for_each_piece([&](std::size_t first, Eigen::Index row, Eigen::Index rows) {
    Eigen::MatrixXd all(rows, width_ + 1);
    all << basis.middleRows(row, rows), Eigen::Map<const Eigen::VectorXd>(residual.data() + row, rows);
    turn(first, all);
    const Eigen::MatrixXd sums = block_sums(all);
    means_.middleRows(static_cast<Eigen::Index>(first / block_) * parts, sums.rows()) = sums;
    if (block_ > 1) within_ += all.transpose() * all;
  });
  for (Eigen::Index row = 0; row < means_.rows(); ++row)
    means_.row(row) /= std::sqrt(points_[static_cast<std::size_t>(row / parts)]);
  if (block_ > 1) within_ -= means_.transpose() * means_;
}

Eigen::MatrixXd SmoothError::block_sums(const Eigen::MatrixXd& rows) const {
  const auto parts = static_cast<Eigen::Index>(axis_.per_point);
  const Eigen::Index length = static_cast<Eigen::Index>(block_) * parts, blocks = (rows.rows() + length - 1) / length;
  Eigen::MatrixXd sums = Eigen::MatrixXd::Zero(blocks * parts, rows.cols());
  for (Eigen::Index column = 0; column < rows.cols(); ++column)
    for (Eigen::Index block = 0; block < blocks; ++block)
      for (Eigen::Index row = block * length; row < std::min(rows.rows(), (block + 1) * length); row += parts)
        for (Eigen::Index part = 0; part < parts; ++part)
          sums(block * parts + part, column) += rows(row + part, column);
  return sums;
}

double SmoothError::longest() const {
  return 3 * (position_.back() - position_.front());
}

SmoothError::Filtered SmoothError::filtered(const Shares& shares, double length) const {
  const std::size_t parts = axis_.per_point, columns = static_cast<std::size_t>(width_) + 1;
  Filtered result;
  result.products.resize(columns * (columns + 1) / 2 * side_by_side);
  std::vector<double> values(parts * columns * side_by_side), slopes(values.size()), news(columns * side_by_side);
  const auto lanes = [](std::vector<double>& memory, std::size_t index) FRACFIT_INLINE -> Lanes& {
    return Doubles<side_by_side>::at(memory.data() + index * side_by_side);
  };
  with_wide_vectors([&]() FRACFIT_INLINE {
    const Lanes share = Doubles<side_by_side>::at(shares.data()), white = 1 - share;
    std::size_t product = 0;
    for (Eigen::Index i = 0; i <= width_; ++i)
      for (Eigen::Index k = 0; k <= i; ++k, ++product) lanes(result.products, product) = within_(i, k) / white;
    Matern known(share, length);
    Lanes determinant = 1 + Lanes{};
    for (std::size_t b = 0; b < position_.size(); ++b) {
      const Matern::Step step = b > 0 ? known.advance(position_[b] - position_[b - 1]) : Matern::Step{};
      const double root = std::sqrt(points_[b]);
      const Lanes scatter = points_[b] * known.value + white, weight = 1 / scatter;
      const Lanes to_value = root * known.value * weight, to_slope = root * known.cross * weight;
      for (std::size_t part = 0; part < parts; ++part) {
        const double* const mean = means_.row(static_cast<Eigen::Index>(b * parts + part)).data();
        product = 0;
        for (std::size_t i = 0; i < columns; ++i) {
          Lanes &value = lanes(values, part * columns + i), &slope = lanes(slopes, part * columns + i);
          const Lanes ahead = step.a * value + step.b * slope, inclined = step.c * value + step.d * slope;
          const Lanes each = mean[i] - root * ahead, weighed = each * weight;
          value = ahead + to_value * each;
          slope = inclined + to_slope * each;
          lanes(news, i) = each;
          for (std::size_t k = 0; k <= i; ++k, ++product) lanes(result.products, product) += weighed * lanes(news, k);
        }
      }
      determinant *= scatter;
      known.slope -= to_slope * to_slope * scatter;
      known.cross -= to_value * to_slope * scatter;
      known.value *= white * weight;
      // Factors are between the least white share and the points of a block: eight of them stay in range.
      if (b % 8 == 7 || b + 1 == position_.size()) {
        for (std::size_t l = 0; l < side_by_side; ++l) result.logarithm[l] += std::log(determinant[l]);
        determinant = 1 + Lanes{};
      }
    }
  });
  const auto within_blocks = static_cast<double>(axis_.position.size() - position_.size());
  for (std::size_t l = 0; l < side_by_side; ++l)
    result.logarithm[l] = static_cast<double>(parts) * (result.logarithm[l] + within_blocks * std::log(1 - shares[l]));
  return result;
}

std::vector<SmoothError::Likelihood> SmoothError::at(std::span<const double> shares, double length) const {
  std::vector<Likelihood> found;
  Rows products = Rows::Zero(width_ + 1, width_ + 1);
  for (std::size_t first = 0; first < shares.size(); first += side_by_side) {
    Shares some;
    for (std::size_t l = 0; l < side_by_side; ++l) some[l] = shares[std::min(first + l, shares.size() - 1)];
    const Filtered sums = filtered(some, length);
    for (std::size_t l = 0; l < std::min(side_by_side, shares.size() - first); ++l) {
      const double* product = sums.products.data() + l;
      for (Eigen::Index i = 0; i <= width_; ++i)
        for (Eigen::Index k = 0; k <= i; ++k, product += side_by_side) products(i, k) = *product;
      const Eigen::VectorXd factor = CholeskyFactor(products).diagonal();
      // The last diagonal entry is the length of the residual once the columns are fitted to it anew.
      double restricted = by_turning_ - 0.5 * sums.logarithm[l];
      for (Eigen::Index i = 0; i < width_; ++i) restricted -= std::log(factor(i));
      const double rest = factor(width_);
      found.push_back({restricted - degrees_ * std::log(rest), rest * rest / degrees_});
    }
  }
  return found;
}

SmoothError::Influences SmoothError::influences(const Eigen::Ref<const Eigen::MatrixXd>& columns) const {
  const auto parts = static_cast<Eigen::Index>(axis_.per_point);
  Influences result{Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(position_.size()) * parts, columns.cols()),
                    Eigen::MatrixXd::Zero(columns.cols(), columns.cols())};
  for_each_piece([&](std::size_t first, Eigen::Index row, Eigen::Index rows) {
    Eigen::MatrixXd some = columns.middleRows(row, rows);
    turn(first, some);
    const Eigen::MatrixXd sums = block_sums(some);
    result.sums.middleRows(static_cast<Eigen::Index>(first / block_) * parts, sums.rows()) = sums;
    result.products += some.transpose() * some;
  });
  return result;
}

Eigen::MatrixXd SmoothError::covariance(const Influences& of, std::span<const Possibility> possibilities) const {
  const auto parts = static_cast<Eigen::Index>(axis_.per_point);
  double white = 0, smooth = 0;
  // Of each sum half of itself and all earlier ones, by their covariance with it: products with the sums and their
  // transpose count each pair twice.
  Eigen::MatrixXd half = Eigen::MatrixXd::Zero(of.sums.rows(), of.sums.cols());
  for (const auto& [variance, share, length] : possibilities) {
    white += variance * (1 - share);
    smooth += variance * share;
    const double rate = std::sqrt(3.0) / length;
    std::vector<double> distance(position_.size()), decay(position_.size());
    for (std::size_t b = 1; b < position_.size(); ++b) {
      distance[b] = rate * (position_[b] - position_[b - 1]);
      decay[b] = std::exp(-distance[b]);
    }
    for (Eigen::Index column = 0; column < of.sums.cols(); ++column) {
      for (Eigen::Index part = 0; part < parts; ++part) {
        // Earlier sums, each times e^-q, and times (1 + q) e^-q less that.
        double faded = 0, sloped = 0;
        for (std::size_t b = 0; b < position_.size(); ++b) {
          const Eigen::Index row = static_cast<Eigen::Index>(b) * parts + part;
          sloped = decay[b] * (sloped + distance[b] * faded);
          faded *= decay[b];
          half(row, column) += variance * share * (faded + sloped);
          faded += of.sums(row, column);
        }
      }
    }
  }
  half += 0.5 * smooth * of.sums;
  const Eigen::MatrixXd of_smooth = of.sums.transpose() * half;
  return white * of.products + of_smooth + of_smooth.transpose();
}

}  // namespace frac::detail
