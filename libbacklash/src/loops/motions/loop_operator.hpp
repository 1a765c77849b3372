// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <complex>
#include <vector>

#include "frac/approximation/zero_pole_gain.hpp"
#include "frac/model/fractional_transfer_function.hpp"

namespace backlash::detail {

/// A linear operator on a signal x as states of finite order, for the operators of a loop: its controller on a
/// position, and what friction and springs make of one,
///   on_position x + on_velocity x' + sum_i integral_weights_i (i + 1)-fold integral of x + sum modes,
/// a mode being weight z + conjugate of z' = rate z + x^(derivative).  Powers of s have their branch cut as modes on
/// the negative axis: s^-p = sin(p pi)/pi int a^-p/(s + a) da by the trapezoidal rule in ln a, which errs by 2
/// e^{-pi^2/h}; what lies beyond the band is left to one mode at each end.
struct LoopOperator {
  struct OperatorMode {
    int derivative;  // 0, 1 or 2; below 0: integrals of x
    std::complex<double> rate;
    std::complex<double> weight;
    [[nodiscard]] bool is_real() const { return rate.imag() == 0; }
  };
  double on_position = 0;
  double on_velocity = 0;
  std::vector<double> integral_weights;
  std::vector<OperatorMode> modes;
  /// Largest relative error on the band; 0 without fractional powers.
  double error = 0;

  [[nodiscard]] std::complex<double> response(double omega) const;
};

/// @param operand  grows slower than s^2; its dead time is left out
/// @param band     on which the tolerance is kept, rad/s
/// @param shift    of the nodes, in [0, 1) of their distance: operators in a row must not share them
LoopOperator realised(const frac::FractionalTransferFunction& operand, frac::FrequencyBand band, double tolerance,
                      double shift);

}  // namespace backlash::detail
