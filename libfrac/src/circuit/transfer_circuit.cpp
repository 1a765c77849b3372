// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "base/counted.hpp"
#include "circuit/circuit_error.hpp"
#include "frac/circuit.hpp"
#include "state_space/model_on_band.hpp"
#include "state_space/solved_states.hpp"

namespace frac {
namespace {

// An integrator has no operating point for a constant input.  Its pole goes from 0 so little to the left that the
// response changes on the band by a thousandth of the tolerance at most.
int leak_integrators(StateSpace& system, FrequencyBand band, double tolerance) {
  const std::size_t n = system.states;
  int integrators = 0;
  for (std::size_t i = 0; i < n; ++i) integrators += system.a[i * n + i] == 0;
  for (std::size_t i = 0; i < n; ++i) {
    if (system.a[i * n + i] == 0) system.a[i * n + i] = -1e-3 * tolerance * band.lower / integrators;
  }
  return integrators;
}

// Scales state i by its value for an input of size 1 where its own row of A holds it back.  A is block triangular, so
// that what drives a state stands before it; the second of a pair is driven by the first.
void scale(StateSpace& system, std::vector<double>& rates, FrequencyBand band) {
  const std::size_t n = system.states;
  std::vector<double> size(n);
  for (std::size_t i = 0; i < n; ++i) {
    double drive = std::abs(system.b[i]);
    for (std::size_t j = 0; j < i; ++j) drive += std::abs(system.a[i * n + j]) * size[j];
    const double coupling = i + 1 < n ? std::abs(system.a[i * n + i + 1]) : 0;
    // What hardly leaks is scaled by the band instead, where it matters.
    rates.push_back(std::max(std::hypot(system.a[i * n + i], coupling), band.lower));
    size[i] = drive > 0 ? drive / rates[i] : 1;
  }
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < n; ++j) system.a[i * n + j] *= size[j] / size[i];
    system.b[i] /= size[i];
    system.c[i] *= size[i];
  }
}

// What the rounding of the elements adds to the relative error at a frequency, to first order: with y = C x the
// response and w' = C (j omega - A)^-1 a change of an entry a_ij moves y by w_i a_ij x_j times its relative size.
double rounding_of_elements(const StateSpace& system, double omega) {
  const std::size_t n = system.states;
  StateSpace adjoint = system;
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < n; ++j) adjoint.a[i * n + j] = system.a[j * n + i];
  }
  std::swap(adjoint.b, adjoint.c);
  const std::vector<std::complex<double>> x = detail::solved_states(system, omega);
  const std::vector<std::complex<double>> w = detail::solved_states(adjoint, omega);
  double sum = std::abs(system.d);
  std::complex<double> response = system.d;
  for (std::size_t i = 0; i < n; ++i) {
    double row = omega * std::abs(x[i]) + std::abs(system.b[i]);
    for (std::size_t j = 0; j < n; ++j) row += std::abs(system.a[i * n + j] * x[j]);
    sum += std::abs(w[i]) * row + std::abs(system.c[i] * x[i]);
    response += system.c[i] * x[i];
  }
  // A quotient is rounded when it is written, and a number of 17 digits up to three times when it is read.
  constexpr double of_element = 2 * std::numeric_limits<double>::epsilon();
  return of_element * sum / std::abs(response);
}

// The largest on the band, the phase of the dead time included.
double rounding_of_netlist(const TransferCircuit& circuit, const detail::ModelOnBand& on_band) {
  constexpr double per_unit = 3;  // of ln omega
  double largest = 0;
  for (const double omega : on_band.grid(per_unit)) {
    largest = std::max(largest, rounding_of_elements(circuit.system, omega));
  }
  return largest + 2 * std::numeric_limits<double>::epsilon() * circuit.band.upper * circuit.delay;
}

}  // namespace

std::string TransferCircuit::summary() const {
  return model.formula() + " on " + detail::band_text(band) + ". " + message;
}

TransferCircuit transfer_circuit(const FractionalTransferFunction& model, FrequencyBand band, double tolerance) {
  const RationalModel rational = realise(model, band, tolerance);
  TransferCircuit circuit{.model = model,
                          .band = band,
                          .tolerance = tolerance,
                          .delay = rational.delay,
                          .system = modal_form(rational),
                          .rates = {},
                          .message = {}};
  circuit.leaking_integrators = leak_integrators(circuit.system, band, tolerance);
  scale(circuit.system, circuit.rates, band);
  const std::size_t states = circuit.system.states;
  const detail::ModelOnBand on_band(model, band);
  detail::certify(
      circuit, on_band, states, [&](double omega) { return circuit.system.response(omega); },
      detail::counted(states, "state"), rounding_of_netlist(circuit, on_band));
  return circuit;
}

}  // namespace frac
