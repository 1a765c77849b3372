// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "backlash/describing_function.hpp"
#include "backlash/loops/linear_bodies.hpp"
#include "frac/model/fractional_transfer_function.hpp"

namespace backlash {

/// Two bodies with clearance in a loop: the force on body 2 is f = -C(s) x, with x the position of the body that is
/// measured.  Positions are counted from the middle of the clearance, so that x2 - x1 lies in
/// [-clearance/2, clearance/2].  A constant set-point shifts the motion and changes nothing else.
class ControlLoop {
 public:
  /// @param controller  C, N per m of position; fractional orders and dead time as they come
  /// @param measured    x1: the load, which the force reaches through the clearance only; x2: the driven body
  /// @throws std::invalid_argument  clearance 0; a controller that grows as s^2 or faster, against which the masses do
  ///                                not decide what an impact does.
  ControlLoop(LinearBodies bodies, frac::FractionalTransferFunction controller, Output measured = Output::x1);
  /// Of two free masses.
  ControlLoop(const TwoMassSystem& system, frac::FractionalTransferFunction controller, Output measured = Output::x1);

  [[nodiscard]] const LinearBodies& bodies() const noexcept { return bodies_; }
  [[nodiscard]] const TwoMassSystem& system() const noexcept { return bodies_.system(); }
  [[nodiscard]] const frac::FractionalTransferFunction& controller() const noexcept { return controller_; }
  [[nodiscard]] Output measured() const noexcept { return measured_; }

 private:
  LinearBodies bodies_;
  frac::FractionalTransferFunction controller_;
  Output measured_;
};

}  // namespace backlash
