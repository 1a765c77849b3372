// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "frac/model/fractional_transfer_function.hpp"

namespace frac {

/// What is read from the response of a stable closed loop L/(1 + L) to a step of its reference.
struct StepFigures {
  /// L(0)/(1 + L(0)); 1 with an integrator in the loop.
  double final_value;
  /// Largest output over the final value, less 1; 0 where it is never passed by more than the error of the response.
  double overshoot;
  /// s, of the largest output; NaN without overshoot.
  double peak_time;
  /// s, from which on the output stays within 2 % of the final value, up to `end`; NaN where it is not there by then.
  double settling_time;
  /// s, up to which the response was computed.
  double end;
  /// Largest error of the outputs these figures are read from, over the final value.
  double error_estimate;
};

/// The response is followed until it has stayed within 2 % of its final value for the last third of the time, at most
/// for some 120 times 1/omega_c.  Times are read between 200 instants about each, linearly: they err by 2e-5 of `end`, the
/// overshoot by the square of that times the curvature.
/// @param crossover  rad/s, sets the scale of time; > 0
/// @throws std::invalid_argument  crossover out of range; 1 + L(0) = 0; as respond_closed_loop().
/// @throws std::domain_error      as respond_closed_loop().
[[nodiscard]] StepFigures step_figures(const FractionalTransferFunction& loop, double crossover);

}  // namespace frac
