// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstddef>
#include <cstdlib>
#include <numbers>
#include <stdexcept>
#include <string>

#include "approximation/band_error.hpp"
#include "base/bound_text.hpp"
#include "base/short_text.hpp"
#include "frac/state_space.hpp"

namespace frac::detail {

/// Error members, status and message of a circuit whose values are final.
/// @param states    of the circuit: more of them turn the error more often, so the grid is denser
/// @param contents  of the circuit, for the message
/// @param model     with grid(), half_width() and response()
/// @param rounding  relative, of the values as a netlist writes and a simulator reads them
template <typename Circuit, typename Model, typename Response>
void certify(Circuit& circuit, const Model& model, std::size_t states, const Response& response,
             const std::string& contents, double rounding = 0) {
  constexpr double least_density = 3, per_state = 3, finer_than_design = 10;
  const double density = std::max(least_density, per_state * static_cast<double>(states + 1) / model.half_width());
  const std::vector<double> omega = model.grid(finer_than_design * density);
  const BandError<double> error = band_error(omega, [&](double each) { return response(each) / model.response(each); });
  circuit.max_relative_error = error.relative + rounding;
  circuit.omega_at_maximum = error.place;
  circuit.grid_points = static_cast<int>(omega.size());
  const bool met = circuit.max_relative_error <= circuit.tolerance;
  circuit.status = met ? RationalModelStatus::met : RationalModelStatus::not_attainable;
  circuit.message = "Tolerance " + short_text(circuit.tolerance) +
                    (met ? " is met with " : " is not attainable with ") + contents + ", largest relative error " +
                    bound_text(circuit.max_relative_error) + ".";
}

/// The band as a simulator is asked for it, rounded to its inside: beyond its ends an error grows steeply.
[[nodiscard]] inline std::string band_text(FrequencyBand band) {
  constexpr int digits = 6;
  constexpr double turn = 2 * std::numbers::pi;
  const auto within = [&](double hertz, double outward) {
    std::string text = short_text(hertz, digits);
    const double excess = outward * (std::strtod(text.c_str(), nullptr) - hertz);
    const double unit = std::pow(10.0, std::floor(std::log10(hertz)) - (digits - 1));
    return excess > 0 ? short_text(hertz - outward * unit, digits) : text;
  };
  return short_text(band.lower) + " .. " + short_text(band.upper) + " rad/s (" + within(band.lower / turn, -1) +
         " .. " + within(band.upper / turn, 1) + " Hz)";
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
