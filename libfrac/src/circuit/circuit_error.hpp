// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <string>

#include "approximation/band_error.hpp"
#include "base/short_text.hpp"
#include "frac/state_space.hpp"
#include "state_space/model_on_band.hpp"

namespace frac::detail {

/// Error members, status and message of a circuit whose values are final.
/// @param states    of the circuit: more of them turn the error more often, so the grid is denser
/// @param contents  of the circuit, for the message
template <typename Circuit, typename Response>
void certify(Circuit& circuit, const ModelOnBand& model, std::size_t states, const Response& response,
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

}  // namespace frac::detail
