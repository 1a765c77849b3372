// SPDX-License-Identifier: BSD-3-Clause
#include "records/line_noise.hpp"

#include <algorithm>
#include <cmath>

#include "base/linear_algebra.hpp"
#include "frac/cancellation.hpp"

namespace frac::detail {
std::size_t neighbours_for(std::size_t periods) {
  return std::clamp<std::size_t>(periods - 1, 6, 12);
}

LineEstimate::Parts LineEstimate::parts(const Eigen::VectorXcd& weights) const {
  const double whole = std::max(0.0, (weights.transpose() * covariance * weights.conjugate()).value().real());
  if (!is_symmetric) return {whole / 2, whole / 2, 0, 2 * degrees};
  const std::complex<double> related = (weights.transpose() * relation * weights).value();
  return {std::max(0.0, (whole + related.real()) / 2), std::max(0.0, (whole - related.real()) / 2), related.imag() / 2,
          degrees};
}

LineReader::LineReader(const std::vector<Spectrum>& spectra, std::size_t step, std::size_t neighbours)
    : spectra_(spectra), step_(step), neighbours_(neighbours) {}

void LineReader::take_window(std::size_t bin) {
  const std::size_t wanted = 2 * neighbours_, bins = spectra_.front().size();
  offsets_.clear();
  is_symmetric_ = true;
  // Line 0 holds the mean.
  for (std::size_t distance = 1; offsets_.size() < wanted && distance < bins; ++distance) {
    const bool below = bin > distance && (bin - distance) % step_ != 0;
    const bool above = bin + distance < bins && (bin + distance) % step_ != 0;
    if (below) offsets_.push_back(-static_cast<std::ptrdiff_t>(distance));
    if (above && offsets_.size() < wanted) offsets_.push_back(static_cast<std::ptrdiff_t>(distance));
    if (below != above) is_symmetric_ = false;
  }
}

LineEstimate LineReader::operator()(std::size_t bin) {
  throw_if_cancelled();
  constexpr Eigen::Index terms = 3;
  const auto channels = static_cast<Eigen::Index>(spectra_.size());
  const auto of_channel = [this](Eigen::Index channel) -> const Spectrum& {
    return spectra_[static_cast<std::size_t>(channel)];
  };
  LineEstimate line;
  line.value.resize(channels);
  for (Eigen::Index c = 0; c < channels; ++c) line.value(c) = of_channel(c)[bin];
  take_window(bin);
  const auto count = static_cast<Eigen::Index>(offsets_.size());
  if (count < terms + 2) return line;
  Eigen::MatrixXcd around(count, channels);
  for (Eigen::Index i = 0; i < count; ++i)
    for (Eigen::Index c = 0; c < channels; ++c)
      around(i, c) = of_channel(
          c)[static_cast<std::size_t>(static_cast<std::ptrdiff_t>(bin) + offsets_[static_cast<std::size_t>(i)])];
  const auto at = static_cast<double>(bin);
  // Over a window that is wide beside its frequency the power of noise may change as a power of frequency, by more than
  // a factor of 2 from the line to an end for noise like 1/f^2.
  const bool is_wide = largest_offset() > 0.3 * at;
  Fitted best;
  for (const double slope : is_wide ? std::vector<double>{0, 1, 2, 3, 4} : std::vector<double>{0}) {
    Fitted fitted = fit(around, at, slope);
    if (slope == 0 || fitted.likelihood > best.likelihood) best = std::move(fitted);
  }
  line.value -= best.transient;
  line.degrees = static_cast<double>(count - terms);
  const double spread = (1 + best.leverage) / line.degrees;
  line.covariance = spread * (best.left.transpose() * best.left.conjugate());
  line.is_symmetric = is_symmetric_;
  if (!is_symmetric_) return line;
  Eigen::MatrixXcd mirrored(count, channels);
  for (Eigen::Index i = 0; i < count; ++i) mirrored.row(i) = best.left.row(i % 2 == 0 ? i + 1 : i - 1);
  line.relation = spread * (best.left.transpose() * mirrored);
  return line;
}

double LineReader::largest_offset() const {
  return static_cast<double>(std::abs(offsets_.back()));
}

// Restricted likelihood of complex normal lines whose variance is S (1 + offset/bin)^-slope, S left to the data.
LineReader::Fitted LineReader::fit(const Eigen::MatrixXcd& around, double bin, double slope) {
  constexpr Eigen::Index terms = 3;
  const Eigen::Index count = around.rows();
  Eigen::VectorXd inverse_sizes(count);
  double likelihood = 0;
  for (Eigen::Index i = 0; i < count; ++i) {
    const double ratio = 1 + static_cast<double>(offsets_[static_cast<std::size_t>(i)]) / bin;
    inverse_sizes(i) = std::pow(ratio, slope / 2);
    likelihood += slope * std::log(ratio);
  }
  if (offsets_ != planned_ || slope != planned_slope_ || slope != 0) {
    planned_ = offsets_;
    planned_slope_ = slope;
    powers_.resize(count, terms);
    for (Eigen::Index i = 0; i < count; ++i) {
      const double x = static_cast<double>(offsets_[static_cast<std::size_t>(i)]) / largest_offset();
      powers_.row(i) << inverse_sizes(i), inverse_sizes(i) * x, inverse_sizes(i) * x * x;
    }
    to_terms_ = PlainQr(powers_).dual().transpose();
  }
  Fitted fitted;
  fitted.left = inverse_sizes.cast<std::complex<double>>().asDiagonal() * around;
  const Eigen::MatrixXcd polynomial = to_terms_.cast<std::complex<double>>() * fitted.left;
  // The value of the polynomial at the line is its constant.
  fitted.transient = polynomial.row(0).transpose();
  fitted.left -= powers_.cast<std::complex<double>>() * polynomial;
  fitted.leverage = to_terms_.row(0).squaredNorm();
  const auto degrees = static_cast<double>(count - terms);
  // The determinant of the normal equations, from their inverse.
  likelihood += 2 * CholeskyFactor(to_terms_ * to_terms_.transpose()).diagonal().array().log().sum();
  for (Eigen::Index c = 1; c < around.cols(); ++c) {
    const double squares = fitted.left.col(c).squaredNorm();
    if (squares > 0) fitted.likelihood += likelihood - degrees * std::log(squares);
  }
  return fitted;
}

}  // namespace frac::detail
