// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <string>

#include "base/counted.hpp"
#include "base/short_text.hpp"
#include "circuit/circuit_error.hpp"
#include "frac/circuit.hpp"
#include "state_space/model_on_band.hpp"

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

}  // namespace

std::string TransferCircuit::summary() const {
  return model.formula() + " on " + detail::short_text(band.lower) + " .. " + detail::short_text(band.upper) +
         " rad/s. " + message;
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
  detail::certify(
      circuit, detail::ModelOnBand(model, band), states, [&](double omega) { return circuit.system.response(omega); },
      detail::counted(states, "state"));
  return circuit;
}

}  // namespace frac
