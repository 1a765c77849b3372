// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <complex>

namespace backlash::detail {

/// A point u of the sums with what all powers need there.
struct TrainPoint {
  explicit TrainPoint(std::complex<double> at);
  std::complex<double> u;
  std::complex<double> turned;        // e^u
  std::complex<double> inverse_rest;  // 1/(1 - e^u)
  // ln(-u); what has a closed form does without it.
  [[nodiscard]] std::complex<double> log_distance() const;

 private:
  mutable std::complex<double> log_distance_ = 0;
  mutable bool has_log_ = false;
};

/// Sums over a train of pulses of a response that is a power of time:
///   P_j(u) = sum_(n >= 0) e^{n u} (n + v)^(a - j),   j = 0, 1, 2,
/// continued analytically to all u with |Im u| <= pi but the half line u >= 0 (Lerch's transcendent).
///
/// Away from u = 0 the first terms are added up and the rest is a series in 1/(n |u|); near it
///   P = e^{-u v} [Gamma(1 + a) (-u)^(-1-a) + sum_n zeta(-a - n, v) u^n/n!],   |u| < 2 pi (Lerch 1887).
class PowerTrain {
 public:
  /// @param a  > 1, or 1, for which P_2 is not wanted and left at 0
  /// @param v  in (0, 1]
  PowerTrain(double a, double v);
  [[nodiscard]] std::array<std::complex<double>, 3> operator()(const TrainPoint& point) const;
  [[nodiscard]] std::array<std::complex<double>, 3> operator()(std::complex<double> u) const {
    return (*this)(TrainPoint(u));
  }
  /// The value at u = 0 without the singular part: zeta(j - a, v).
  [[nodiscard]] std::array<double, 3> at_origin() const;

  /// P_j without its singular part, which is that of P_0, `mean`, times (-u)^j/(a (a - 1) ... (a - j + 1)); |u| < 2 pi.
  struct Split {
    std::array<std::complex<double>, 3> regular;
    std::complex<double> mean;
  };
  [[nodiscard]] Split split(std::complex<double> u) const;

 private:
  // Direct terms and order of the series of the rest: the series errs by about order! / (terms |u|)^order.
  static constexpr int most_terms = 20;
  static constexpr int rest_order = 18;
  static constexpr int zeta_terms = 64;

  [[nodiscard]] std::array<std::complex<double>, 3> in_closed_form(const TrainPoint& point) const;
  [[nodiscard]] std::array<std::complex<double>, 3> by_terms(const TrainPoint& point) const;
  [[nodiscard]] std::array<std::complex<double>, 3> about_origin(const TrainPoint& point) const;
  [[nodiscard]] std::array<std::complex<double>, 3> zeta_series(std::complex<double> u) const;
  // Coefficients of the terms, which small multipliers alone need, and of the series about the origin, which powers
  // with a closed form seldom need.
  void prepare_terms() const;
  void prepare_zeta() const;
  void require_zeta() const {
    if (!has_zeta_) prepare_zeta();
  }

  double a_;
  double v_;
  std::array<double, 3> gamma_{};  // Gamma(1 + a - j)
  bool has_closed_form_;           // a = 1, 2 or 3, v = 1
  mutable bool has_terms_ = false;
  mutable std::array<double, most_terms + 1> power_;                     // (n + v)^(a - 2)
  mutable std::array<std::array<double, rest_order>, 3> rest_binomial_;  // of a - j over i
  mutable bool has_zeta_ = false;
  mutable std::array<double, zeta_terms + 2> zeta_{};  // zeta(2 - a - n, v)/n! (2 pi)^n
  // zeta(j - a - n, v)/n! (2 pi)^n
  mutable std::array<std::array<double, 3>, zeta_terms> series_;
};

/// zeta(j - a, v), j = 0, 1, 2, as PowerTrain::at_origin() has them, for one v at the cost of six powers.
[[nodiscard]] std::array<double, 3> power_sums_of_one_sign(double a, double v);

}  // namespace backlash::detail
