// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <vector>

#include "base/wide_vectors.hpp"
#include "exponential_terms.hpp"
#include "formula/reduction.hpp"
#include "special/complex_functions.hpp"

namespace frac::detail {

/// N/D s^extra_order and its derivatives by the parameters at s = e^zeta, on any sheet.  Keeps the phases of the powers
/// from one zeta to the next where these have the same imaginary part, as along a cut.
class SensitiveImage {
 public:
  SensitiveImage(const RatioOfPowerSums& ratio, double extra_order)
      : top_(ratio.numerator), bottom_(ratio.denominator), extra_order_(extra_order), row_(1 + bottom_.parameters) {}

  [[nodiscard]] Eigen::Index columns() const { return row_.size(); }

  [[nodiscard]] const ComplexRow& operator()(std::complex<double> zeta) {
    top_.evaluate(zeta);
    bottom_.evaluate(zeta);
    const std::complex<double> inverse = reciprocal(bottom_.value);
    const std::complex<double> factor = product(std::exp(top_.scale - bottom_.scale + extra_order_ * zeta), inverse);
    row_[0] = product(factor, top_.value);
    const std::complex<double> of_bottom = product(row_[0], inverse);
    for (Eigen::Index p = 0; p + 1 < row_.size(); ++p) {
      row_[1 + p] = product(factor, top_.derivative(p)) - product(of_bottom, bottom_.derivative(p));
    }
    return row_;
  }

 private:
  /// A sum of powers over e^scale and its derivatives by the parameters.
  struct Sum {
    using Wide = Doubles<4>;
    static constexpr std::size_t width = 4;

    explicit Sum(const SensitiveSum& terms_)
        : terms(terms_),
          parameters(static_cast<Eigen::Index>(terms_.front().by_coefficient.size())),
          stride((terms_.front().by_coefficient.size() + width - 1) / width * width),
          phase(terms_.size()),
          power_re(terms_.size()),
          power_im(terms_.size()),
          slopes(2 * stride * terms_.size()),
          re(stride),
          im(stride) {
      double* to = slopes.data();
      for (const SensitiveTerm& term : terms) {
        double size = std::abs(term.coefficient);
        if (size == 0) {
          for (const double slope : term.by_coefficient) size = std::max(size, std::abs(slope));
        }
        log_size.push_back(std::log(size));
        std::copy(term.by_coefficient.begin(), term.by_coefficient.end(), to);
        std::copy(term.by_order.begin(), term.by_order.end(), to + stride);
        to += 2 * stride;
      }
    }

    void evaluate(std::complex<double> zeta) {
      if (zeta.imag() != angle) {
        angle = zeta.imag();
        for (std::size_t i = 0; i < terms.size(); ++i) phase[i] = std::polar(1.0, terms[i].order * angle);
      }
      scale = -std::numeric_limits<double>::infinity();
      for (std::size_t i = 0; i < terms.size(); ++i) {
        scale = std::max(scale, log_size[i] + terms[i].order * zeta.real());
      }
      value = 0;
      for (std::size_t i = 0; i < terms.size(); ++i) {
        const std::complex<double> power = std::exp(terms[i].order * zeta.real() - scale) * phase[i];
        value += terms[i].coefficient * power;
        power_re[i] = power.real();
        power_im[i] = power.imag();
      }
      with_wide_vectors([&]() FRACFIT_INLINE {
        for (std::size_t first = 0; first < stride; first += width) {
          // sum of (dc + c dq zeta) power
          Wide::Type plain_re = {}, plain_im = {}, log_re = {}, log_im = {};
          for (std::size_t i = 0; i < phase.size(); ++i) {
            const double* const slope = slopes.data() + 2 * i * stride + first;
            plain_re += power_re[i] * Wide::at(slope);
            plain_im += power_im[i] * Wide::at(slope);
            log_re += power_re[i] * Wide::at(slope + stride);
            log_im += power_im[i] * Wide::at(slope + stride);
          }
          Wide::at(re.data() + first) = plain_re + zeta.real() * log_re - zeta.imag() * log_im;
          Wide::at(im.data() + first) = plain_im + zeta.real() * log_im + zeta.imag() * log_re;
        }
      });
    }

    [[nodiscard]] std::complex<double> derivative(Eigen::Index parameter) const {
      return {re[static_cast<std::size_t>(parameter)], im[static_cast<std::size_t>(parameter)]};
    }

    const SensitiveSum& terms;
    Eigen::Index parameters;
    std::size_t stride;  // as many slots as parameters, filled up to whole vectors
    std::vector<double> log_size;
    double angle = std::numeric_limits<double>::quiet_NaN();
    std::vector<std::complex<double>> phase;
    std::vector<double> power_re, power_im;
    std::vector<double> slopes;  // of each term by_coefficient, then by_order
    std::complex<double> value;
    std::vector<double> re, im;  // of the derivatives
    double scale = 0;
  };
  Sum top_, bottom_;
  double extra_order_;
  ComplexRow row_;
};

}  // namespace frac::detail
