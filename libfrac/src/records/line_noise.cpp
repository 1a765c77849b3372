// SPDX-License-Identifier: BSD-3-Clause
#include "records/line_noise.hpp"

#include <algorithm>
#include <cmath>

#include "base/linear_algebra.hpp"
#include "frac/cancellation.hpp"
#include "special/distributions.hpp"

namespace frac::detail {
namespace {

constexpr Eigen::Index terms = 3;  // of the polynomial that follows the transient

}  // namespace

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

LineEstimate LineReader::operator()(std::size_t bin, const ShapedSum* sum) {
  throw_if_cancelled();
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
  const auto bin_of = [&](Eigen::Index i) {
    return static_cast<std::size_t>(static_cast<std::ptrdiff_t>(bin) + offsets_[static_cast<std::size_t>(i)]);
  };
  Eigen::MatrixXcd around(count, channels);
  for (Eigen::Index i = 0; i < count; ++i)
    for (Eigen::Index c = 0; c < channels; ++c) around(i, c) = of_channel(c)[bin_of(i)];
  const auto degrees = static_cast<double>(count - terms);
  const auto judged_of = [&](const Fitted& fitted) {
    return sum ? Eigen::MatrixXcd(fitted.left * sum->weights) : Eigen::MatrixXcd(fitted.left.rightCols(channels - 1));
  };
  Eigen::VectorXcd shape;
  Eigen::VectorXd sizes_of_loop;  // inverse ones
  if (sum) {
    Eigen::VectorXcd response(count);
    for (Eigen::Index i = 0; i < count; ++i) response(i) = sum->response(bin_of(i));
    const std::complex<double> here = sum->response(bin);
    sizes_of_loop = (1.0 - sum->loop * response.array()).abs() / std::abs(1.0 - sum->loop * here);
    response /= here;
    const Eigen::MatrixXcd summed = around * sum->weights;
    const auto power = [&](const Eigen::VectorXcd& with) { return fit(summed, {}, with).left.squaredNorm(); };
    if (response.allFinite() && response.cwiseAbs().minCoeff() > 0) {
      constexpr double chance = 0.01;
      const double shaped = power(response), even = power({});
      if (shaped > 0 && shaped < even && fisher_f_above(even / shaped, 2 * degrees, 2 * degrees) < chance)
        shape = std::move(response);
    }
  }
  Fitted best;
  const auto try_sizes = [&](const Eigen::VectorXd& inverse_sizes) {
    Fitted fitted = fit(around, inverse_sizes, shape);
    const Eigen::MatrixXcd judged = judged_of(fitted);
    for (Eigen::Index c = 0; c < judged.cols(); ++c) {
      const double squares = judged.col(c).squaredNorm();
      if (squares > 0) fitted.likelihood += fitted.likelihood_of_sizes - degrees * std::log(squares);
    }
    if (best.left.size() == 0 || fitted.likelihood > best.likelihood) best = std::move(fitted);
  };
  try_sizes({});
  const auto at = static_cast<double>(bin);
  // Over a window that is wide beside its frequency the power of noise may change as a power of frequency, by more than
  // a factor of 2 from the line to an end for noise like 1/f^2.
  if (largest_offset() > 0.3 * at)
    for (const double slope : {1, 2, 3, 4}) {
      Eigen::VectorXd inverse_sizes(count);
      for (Eigen::Index i = 0; i < count; ++i)
        inverse_sizes(i) = std::pow(static_cast<double>(bin_of(i)) / at, slope / 2);
      try_sizes(inverse_sizes);
    }
  if (sum && sum->loop != 0.0 && sizes_of_loop.allFinite()) try_sizes(sizes_of_loop);
  line.value -= best.transient;
  line.degrees = degrees;
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

LineReader::Plan LineReader::plan(const Eigen::VectorXd& factors) const {
  const auto count = static_cast<Eigen::Index>(offsets_.size());
  Plan made{Eigen::MatrixXd(count, terms), {}};
  for (Eigen::Index i = 0; i < count; ++i) {
    const double x = static_cast<double>(offsets_[static_cast<std::size_t>(i)]) / largest_offset();
    made.powers.row(i) << 1, x, x * x;
  }
  if (factors.size() > 0) made.powers = factors.asDiagonal() * made.powers;
  made.to_terms = PlainQr(made.powers).dual().transpose();
  return made;
}

// Restricted likelihood of complex normal lines whose deviation is S over inverse_sizes, S left to the data.  Lines are
// turned by the phases of the shape, so that what follows them stays real, and what is left is turned back.
LineReader::Fitted LineReader::fit(const Eigen::MatrixXcd& around, const Eigen::VectorXd& inverse_sizes,
                                   const Eigen::VectorXcd& shape) {
  const bool is_even = inverse_sizes.size() == 0, is_shaped = shape.size() > 0;
  if (offsets_ != planned_) {
    planned_ = offsets_;
    even_ = plan({});
  }
  Plan made;
  if (is_shaped || !is_even) {
    Eigen::VectorXd factors = Eigen::VectorXd::Ones(around.rows());
    if (is_shaped) factors = shape.cwiseAbs();
    if (!is_even) factors = factors.cwiseProduct(inverse_sizes);
    made = plan(factors);
  }
  const auto& [powers, to_terms] = is_shaped || !is_even ? made : even_;
  Fitted fitted;
  fitted.left = around;
  if (!is_even) fitted.left = inverse_sizes.cast<std::complex<double>>().asDiagonal() * around;
  const Eigen::VectorXcd phases = is_shaped ? Eigen::VectorXcd(shape.cwiseQuotient(shape.cwiseAbs())) : shape;
  if (is_shaped) fitted.left = phases.conjugate().asDiagonal() * fitted.left;
  const Eigen::MatrixXcd polynomial = to_terms.cast<std::complex<double>>() * fitted.left;
  // The value of the polynomial at the line is its constant.
  fitted.transient = polynomial.row(0).transpose();
  fitted.left -= powers.cast<std::complex<double>>() * polynomial;
  if (is_shaped) fitted.left = phases.asDiagonal() * fitted.left;
  fitted.leverage = to_terms.row(0).squaredNorm();
  // The determinant of the normal equations, from their inverse.
  fitted.likelihood_of_sizes = 2 * CholeskyFactor(to_terms * to_terms.transpose()).diagonal().array().log().sum();
  if (!is_even) fitted.likelihood_of_sizes += 2 * inverse_sizes.array().log().sum();
  return fitted;
}

}  // namespace frac::detail
