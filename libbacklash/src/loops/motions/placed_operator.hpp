// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <complex>
#include <optional>
#include <utility>
#include <vector>

#include "frac/model/fractional_transfer_function.hpp"
#include "loop_operator.hpp"

namespace backlash::detail {

/// The force of friction and springs at a position: 1/G - M s^2; empty where that is nothing.
[[nodiscard]] std::optional<frac::FractionalTransferFunction> resistance(
    const frac::FractionalTransferFunction& receptance, double mass);

/// An operator whose states, integrals before modes, stand in a vector from `first` on.  Rows are linear forms of that
/// vector.
struct PlacedOperator {
  using Row = Eigen::RowVectorXd;
  LoopOperator of;
  Eigen::Index first;

  /// Number of its states.
  [[nodiscard]] Eigen::Index size() const;
  /// Its value for a signal with that position and velocity.
  [[nodiscard]] Row output(const Row& position, const Row& velocity) const;
  /// Its rows of the matrix of x' = A x.
  void fill(Eigen::MatrixXd& a, const Row& position, const Row& velocity, const Row& acceleration) const;
  /// Rough sizes of its states.
  /// @param length  of the signal;  @param pace  rad/s, of the motion
  void scale(Eigen::VectorXd& sizes, double length, double pace) const;
  /// A jump of that derivative of the signal.
  void kick(Eigen::VectorXd& state, int derivative, double size) const;
  /// The states at t = 0 of the signal Re sum phasor e^{j omega t}, whose velocity jumps there and whose sums are in
  /// the middle of that jump: just before it.
  /// @param lines  omega, rad/s, and phasor
  void remember(Eigen::VectorXd& state, const std::vector<std::pair<double, std::complex<double>>>& lines,
                double jump) const;
};

}  // namespace backlash::detail
