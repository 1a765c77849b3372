// SPDX-License-Identifier: BSD-3-Clause
#include "backlash/loops/control_loop.hpp"

#include <stdexcept>
#include <utility>

#include "base/check.hpp"

namespace backlash {

ControlLoop::ControlLoop(const TwoMassSystem& system, frac::FractionalTransferFunction controller, Output measured)
    : ControlLoop(LinearBodies(system), std::move(controller), measured) {}

ControlLoop::ControlLoop(LinearBodies bodies, frac::FractionalTransferFunction controller, Output measured)
    : bodies_(std::move(bodies)), controller_(std::move(controller)), measured_(measured) {
  detail::require_positive("clearance", "m", system().clearance());
  const double growth = controller_.numerator().front().order - controller_.denominator().front().order;
  if (!(growth < 2)) {
    throw std::invalid_argument("the controller grows as s^" + detail::text(growth) +
                                " at high frequency; it must grow slower than s^2, as otherwise its force is as large "
                                "as the inertia of the masses (a filter such as 1/(T s + 1)^2 helps)");
  }
}

}  // namespace backlash
