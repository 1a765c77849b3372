// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "frac/describe.hpp"

namespace backlash {

struct CycleHarmonic;
struct CycleImpact;
struct CycleRest;
struct PredictedCycle;

// Descriptions of limit cycles, see frac/describe.hpp.

template <frac::ResultOf<CycleHarmonic> Result, class Visit>
void describe(Result& result, const Visit& visit) {
  visit("order", "1", "multiple of the frequency", result.order);
  visit("x1", "m", "phasor of mass 1", result.x1);
  visit("x2", "m", "phasor of mass 2", result.x2);
  visit("force", "N", "phasor of the controller's force", result.force);
}

template <frac::ResultOf<CycleImpact> Result, class Visit>
void describe(Result& result, const Visit& visit) {
  visit("time", "s", "from the first impact of the period", result.time);
  visit("impulse", "N s", "on mass 1", result.impulse);
  visit("speed", "m/s", "of the masses towards each other", result.speed);
}

template <frac::ResultOf<CycleRest> Result, class Visit>
void describe(Result& result, const Visit& visit) {
  visit("time", "s", "from the first impact of the period", result.time);
  visit("duration", "s", "of the rest in contact", result.duration);
  visit("impulse", "N s", "of the wall on mass 1 meanwhile", result.impulse);
}

template <frac::ResultOf<PredictedCycle> Result, class Visit>
void describe(Result& result, const Visit& visit) {
  visit("omega", "rad/s", "of the force", result.omega);
  visit({"force", "force_amplitude"}, "N", "peak of the force", result.force_amplitude);
  visit("stable", "", "by Loeb's criterion: a change of the amplitude dies out", result.stable);
  visit("third_harmonic", "1", "of the force over the fundamental", result.third_harmonic);
  visit("second_harmonic", "1", "of the force over the fundamental", result.second_harmonic);
  visit("symmetric", "", "the second half of the orbit is the mirror image of the first", result.symmetric);
  visit("impacts", "1", "per orbit", result.impacts);
  visit({"force_periods", "period"}, "1", "of the orbit, in periods of the force", result.period);
  visit("admissible", "", "the orbit stays off the walls between its impacts", result.admissible);
  visit("faster_orbit", "", "of two orbits of one amplitude the one of faster impacts", result.faster_orbit);
}

}  // namespace backlash
