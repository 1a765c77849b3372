// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <vector>

#include "exponential_terms.hpp"
#include "formula/reduction.hpp"

namespace frac::detail {

/// N/D s^extra_order and its derivatives by the parameters at s = e^zeta, on any sheet.  Keeps the phases of the powers
/// from one zeta to the next where these have the same imaginary part, as along a cut.
class SensitiveImage {
 public:
  SensitiveImage(const RatioOfPowerSums& ratio, double extra_order)
      : top_(ratio.numerator), bottom_(ratio.denominator), extra_order_(extra_order) {}

  [[nodiscard]] Eigen::Index columns() const {
    return 1 + static_cast<Eigen::Index>(bottom_.terms.front().by_coefficient.size());
  }

  [[nodiscard]] const ComplexRow& operator()(std::complex<double> zeta) {
    top_.evaluate(zeta);
    bottom_.evaluate(zeta);
    const std::complex<double> factor = std::exp(top_.scale - bottom_.scale + extra_order_ * zeta) / bottom_.sum[0];
    row_ = factor * top_.sum;
    for (Eigen::Index p = 1; p < row_.size(); ++p) row_[p] -= row_[0] * bottom_.sum[p] / bottom_.sum[0];
    return row_;
  }

 private:
  struct Sum {
    explicit Sum(const SensitiveSum& terms_) : terms(terms_) {
      for (const SensitiveTerm& term : terms) {
        double size = std::abs(term.coefficient);
        if (size == 0) {
          for (const double slope : term.by_coefficient) size = std::max(size, std::abs(slope));
        }
        log_size.push_back(std::log(size));
      }
      phase.resize(terms.size());
      sum.resize(1 + static_cast<Eigen::Index>(terms.front().by_coefficient.size()));
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
      sum.setZero();
      for (std::size_t i = 0; i < terms.size(); ++i) {
        const SensitiveTerm& term = terms[i];
        const std::complex<double> power = std::exp(term.order * zeta.real() - scale) * phase[i];
        sum[0] += term.coefficient * power;
        for (std::size_t p = 0; p < term.by_coefficient.size(); ++p) {
          if (term.by_coefficient[p] == 0 && term.by_order[p] == 0) continue;
          sum[static_cast<Eigen::Index>(1 + p)] += (term.by_coefficient[p] + term.by_order[p] * zeta) * power;
        }
      }
    }
    const SensitiveSum& terms;
    std::vector<double> log_size;
    double angle = std::numeric_limits<double>::quiet_NaN();
    std::vector<std::complex<double>> phase;
    ComplexRow sum;  // over e^scale
    double scale = 0;
  };
  Sum top_, bottom_;
  double extra_order_;
  ComplexRow row_;
};

}  // namespace frac::detail
