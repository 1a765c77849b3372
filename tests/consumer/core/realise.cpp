// SPDX-License-Identifier: BSD-3-Clause
// A fractional model as a state space x' = A x + B u, y = C x + D u on a band, and its largest relative error.
#include <cstdio>
#include <frac/model/fractional_transfer_function.hpp>
#include <frac/state_space.hpp>

int main() {
  const auto furnace = frac::FractionalTransferFunction::parse("1/(0.8 s^2.2 + 0.5 s^0.9 + 1)");
  const frac::RationalModel rational = frac::realise(furnace, {1e-2, 1e2}, 1e-3);  // band in rad/s, tolerance
  std::puts(rational.summary().c_str());

  const frac::StateSpace system = frac::modal_form(rational);
  for (const frac::Mode& mode : rational.modes) {
    if (mode.pole.imag() != 0) std::printf("pole %.10f +- %.10fi rad/s\n", mode.pole.real(), mode.pole.imag());
  }
  for (const double omega : {0.1, 1.0, 10.0}) {
    const double error = std::abs(system.response(omega) / furnace.response(omega) - 1.0);
    std::printf("omega %g rad/s: relative error %s 1e-3\n", omega, error <= 1e-3 ? "below" : "above");
  }
  return rational.usable() ? 0 : 1;
}
