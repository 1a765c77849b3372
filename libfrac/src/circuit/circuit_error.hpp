// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstddef>
#include <stdexcept>
#include <string>

#include "approximation/band_error.hpp"
#include "base/short_text.hpp"
#include "frac/state_space.hpp"

namespace frac::detail {

/// Error members, status and message of a circuit whose values are final.
/// @param states    of the circuit: more of them turn the error more often, so the grid is denser
/// @param contents  of the circuit, for the message
/// @param model     with grid(), half_width() and response()
template <typename Circuit, typename Model, typename Response>
void certify(Circuit& circuit, const Model& model, std::size_t states, const Response& response,
             const std::string& contents) {
  constexpr double least_density = 3, per_state = 3, finer_than_design = 10;
  const double density = std::max(least_density, per_state * static_cast<double>(states + 1) / model.half_width());
  const std::vector<double> omega = model.grid(finer_than_design * density);
  const BandError<double> error = band_error(omega, [&](double each) { return response(each) / model.response(each); });
  circuit.max_relative_error = error.relative;
  circuit.omega_at_maximum = error.place;
  circuit.grid_points = static_cast<int>(omega.size());
  const bool met = error.relative <= circuit.tolerance;
  circuit.status = met ? RationalModelStatus::met : RationalModelStatus::not_attainable;
  circuit.message = "Tolerance " + short_text(circuit.tolerance) +
                    (met ? " is met with " : " is not attainable with ") + contents + ", largest relative error " +
                    short_text(error.relative) + ".";
}

/// Rounding of residues and poles, relative: a negative number this small is 0.
inline constexpr double rounding_of_parts = 1e-9;

/// @throws std::domain_error  the real part of the impedance is negative on the band.
template <typename Model>
void check_passive(const Model& on_band) {
  constexpr double density = 30;
  for (const double omega : on_band.grid(density)) {
    const std::complex<double> value = on_band.response(omega);
    if (value.real() < -rounding_of_parts * std::abs(value)) {
      throw std::domain_error("impedance: Re Z = " + short_text(value.real()) + " ohm at omega = " + short_text(omega) +
                              " rad/s; a passive circuit has no negative real part, it would give energy");
    }
  }
}

}  // namespace frac::detail
