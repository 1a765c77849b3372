// SPDX-License-Identifier: BSD-3-Clause
#include "smooth_error.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <utility>

#include "base/linear_algebra.hpp"

namespace frac::detail {

namespace {

constexpr std::size_t most_blocks = 256;

/// Of finite numbers; the operator of the library looks for infinities.
std::complex<double> product(std::complex<double> a, std::complex<double> b) {
  return {a.real() * b.real() - a.imag() * b.imag(), a.real() * b.imag() + a.imag() * b.real()};
}

/// State of the smooth error and of its slope: mean and covariance, given what was seen before.
struct Matern {
  double rate;  // sqrt(3)/length
  double share;
  double value, cross, slope;  // covariance

  Matern(double smooth_share, double length)
      : rate(std::sqrt(3.0) / length), share(smooth_share), value(share), cross(0), slope(share * rate * rate) {}

  /// The transition over a distance is [[a, b], [c, d]].
  struct Step {
    double a, b, c, d;
  };
  Step advance(double distance) {
    const double decay = std::exp(-rate * distance), q = rate * distance;
    const Step step{decay * (1 + q), decay * distance, -decay * rate * q, decay * (1 - q)};
    // P -> P0 + F (P - P0) F', with P0 the stationary covariance: what is known fades.
    const double v = value - share, x = cross, s = slope - share * rate * rate;
    value = share + step.a * step.a * v + 2 * step.a * step.b * x + step.b * step.b * s;
    cross = step.a * step.c * v + (step.a * step.d + step.b * step.c) * x + step.b * step.d * s;
    slope = share * rate * rate + step.c * step.c * v + 2 * step.c * step.d * x + step.d * step.d * s;
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

SmoothError::Likelihood SmoothError::at(double share, double length) const {
  const double white = 1 - share;
  const auto parts = static_cast<double>(axis_.per_point);
  const auto blocks = static_cast<double>(position_.size()), points = static_cast<double>(axis_.position.size());
  // A filter (Kalman) for all columns at once, in plain loops: there are a dozen columns, and this is called often.
  const Eigen::Index columns = width_ + 1;
  Rows products = within_ / white;
  double logarithm = parts * (points - blocks) * std::log(white);
  Matern known(share, length);
  Rows value = Rows::Zero(static_cast<Eigen::Index>(axis_.per_point), columns), slope = value;
  std::vector<double> news(static_cast<std::size_t>(columns));
  for (std::size_t b = 0; b < position_.size(); ++b) {
    const Matern::Step step = b > 0 ? known.advance(position_[b] - position_[b - 1]) : Matern::Step{1, 0, 0, 1};
    const double root = std::sqrt(points_[b]), scatter = points_[b] * known.value + white;
    const double to_value = known.value * root / scatter, to_slope = known.cross * root / scatter;
    for (Eigen::Index part = 0; part < value.rows(); ++part) {
      const double* const mean = means_.row(static_cast<Eigen::Index>(b) * value.rows() + part).data();
      double *const v = value.row(part).data(), *const s = slope.row(part).data();
      for (Eigen::Index k = 0; k < columns; ++k) {
        const double ahead = step.a * v[k] + step.b * s[k], inclined = step.c * v[k] + step.d * s[k];
        const double each = mean[k] - root * ahead;
        v[k] = ahead + to_value * each;
        s[k] = inclined + to_slope * each;
        news[static_cast<std::size_t>(k)] = each;
      }
      for (Eigen::Index i = 0; i < columns; ++i) {
        const double weighed = news[static_cast<std::size_t>(i)] / scatter;
        double* const row = products.row(i).data();
        for (Eigen::Index k = 0; k <= i; ++k) row[k] += weighed * news[static_cast<std::size_t>(k)];
      }
    }
    logarithm += parts * std::log(scatter);
    known.slope -= to_slope * to_slope * scatter;
    known.cross -= to_value * to_slope * scatter;
    known.value *= white / scatter;
  }
  const Eigen::VectorXd factor = CholeskyFactor(products).diagonal();
  // The last diagonal entry is the length of the residual once the columns are fitted to it anew.
  double restricted = -0.5 * logarithm;
  for (Eigen::Index i = 0; i < width_; ++i) restricted -= std::log(factor(i));
  const double rest = factor(width_);
  return {restricted - degrees_ * std::log(rest), rest * rest / degrees_};
}

SmoothError::Influence SmoothError::influence(const Eigen::VectorXd& each, double unit) const {
  const std::size_t parts = axis_.per_point;
  Influence result{
      0, Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(position_.size()), static_cast<Eigen::Index>(parts))};
  const std::complex<double> one = 1;
  Eigen::Index block = 0;
  for (std::size_t i = 0, next = block_; i < axis_.position.size(); ++i) {
    if (i == next) {
      ++block;
      next += block_;
    }
    const std::complex<double> factor = axis_.factor.empty() ? one : axis_.factor[i];
    const double* const part = each.data() + i * parts;
    const std::complex<double> turned = product({part[0] / unit, parts == 2 ? part[1] / unit : 0}, factor);
    result.square += turned.real() * turned.real();
    result.sums(block, 0) += turned.real();
    if (parts == 1) continue;
    result.square += turned.imag() * turned.imag();
    result.sums(block, 1) += turned.imag();
  }
  return result;
}

double SmoothError::variance(const Influence& of, double share, double length) const {
  const double rate = std::sqrt(3.0) / length;
  double smooth = 0;
  for (Eigen::Index part = 0; part < of.sums.cols(); ++part) {
    // Earlier sums, each times e^-q, and times (1 + q) e^-q less that.
    double faded = 0, sloped = 0;
    for (Eigen::Index b = 0; b < of.sums.rows(); ++b) {
      if (b > 0) {
        const auto place = static_cast<std::size_t>(b);
        const double q = rate * (position_[place] - position_[place - 1]), decay = std::exp(-q);
        sloped = decay * (sloped + q * faded);
        faded *= decay;
      }
      const double sum = of.sums(b, part);
      smooth += sum * (sum + 2 * (faded + sloped));
      faded += sum;
    }
  }
  return (1 - share) * of.square + share * smooth;
}

}  // namespace frac::detail
