// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <complex>
#include <cstddef>
#include <span>

namespace frac::detail {

/// E_{alpha,beta} for 0 < alpha <= 2 by the trapezoidal rule on the line Re w = c of
///   E(z) = (1/(2 pi i)) int e^{w^2} 2 w^(2 (alpha - beta) + 1) / (w^(2 alpha) - z) dw.
/// With nodes c + i (k + offset) h, a pole w_j of residue R_j left of the line changes the rule by
/// -R_j / (1 - e^{2 pi i offset - 2 pi (w_j - c)/h}), one right of it by R_j less than that: adding the quotient gives
/// E on whichever side the pole is.
class MittagLefflerContour {
 public:
  /// @param offset  0 or 1/2, of the nodes in steps.
  MittagLefflerContour(double alpha, double beta, double offset);

  [[nodiscard]] bool is(double alpha, double beta, double offset) const noexcept {
    return alpha == alpha_ && beta == beta_ && offset == offset_;
  }

  /// The roots of s^alpha = z on the principal sheet, where w = sqrt(s) has a positive real part.
  struct Poles {
    std::size_t count = 0;
    double log_radius = 0;  // of s
    double radius = 0;
    std::array<double, 4> argument;
    std::array<std::complex<double>, 4> w;
  };
  [[nodiscard]] static Poles poles(double alpha, std::complex<double> z);

  /// Whether a pole is so near a node that the other offset cancels less.
  [[nodiscard]] bool has_pole_at_node(const Poles& poles) const;

  struct ValueAndDerivative {
    std::complex<double> value;
    std::complex<double> derivative;
  };
  /// 0 < |z| < 1e60.  Infinite parts on overflow.
  [[nodiscard]] std::complex<double> value(std::complex<double> z, const Poles& poles) const;
  [[nodiscard]] ValueAndDerivative value_and_derivative(std::complex<double> z, const Poles& poles) const;

  /// Each -1e30 < z < 0, and alpha < 1, so that no pole is met: accurate in relative terms.
  void negative_values(std::span<const double> z, double* value) const;

 private:
  static constexpr std::size_t capacity = 128;  // a multiple of lanes
  static constexpr std::size_t lanes = 4;       // partial sums that run side by side
  using Column = std::array<double, capacity>;
  void choose_line();
  void place_nodes();
  template <bool cancels_far_out>
  void negative_blocks(std::span<const double> z, double* value) const;
  template <bool with_derivative>
  [[nodiscard]] ValueAndDerivative over_nodes(std::complex<double> z) const;
  template <bool with_derivative>
  [[nodiscard]] ValueAndDerivative evaluate(std::complex<double> z, const Poles& poles) const;

  double alpha_;
  double beta_;
  double offset_;
  double power_;           // of w in the integrand's numerator
  double line_ = 0;        // c
  double step_ = 0;        // h
  double least_pole_ = 0;  // poles of smaller |w| fall under the bound for the branch point
  std::size_t count_ = 0;
  double leading_;  // 1/Gamma(beta - alpha), that of -1/z far out
  // Pairs of conjugate nodes: the rule is sum a/(v - z) + conj(a)/(conj(v) - z), v = w^(2 alpha).
  Column a_re_, a_im_, v_re_, v_im_;
  // At real z: a v instead of a gives E_{alpha,beta-alpha}, and products of imaginary parts stay the same.
  Column av_re_, v_im_square_, a_cross_, av_cross_;
};

}  // namespace frac::detail
