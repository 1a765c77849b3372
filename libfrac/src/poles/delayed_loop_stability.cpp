// SPDX-License-Identifier: BSD-3-Clause
#include "frac/loop_stability.hpp"
#include "frac/model/algebra.hpp"

namespace frac {

ClosedLoopStability analyse_closed_loop(const DelayedLoop& closed) {
  const ClosedLoopStability loop = analyse_closed_loop(closed.loop);
  if (loop.stability != Stability::stable) return loop;
  const FractionalTransferFunction divisor(closed.loop.denominator(), {{.coefficient = 1, .order = 0}});
  const StabilityAnalysis left = analyse_stability(simplified(closed.forward * divisor));
  ClosedLoopStability result{left.stability, 0};
  for (const Pole& pole : left.poles)
    if (!pole.cancelled && pole.value.real() > 0)
      result.unstable_poles += pole.multiplicity * (pole.value.imag() == 0 ? 1 : 2);
  // The divisor makes it grow with frequency; what counts is whether the model itself does.
  const bool grows = closed.forward.numerator().front().order > closed.forward.denominator().front().order;
  if (left.stability == Stability::differentiating && !grows) result.stability = Stability::stable;
  if (left.stability == Stability::stable && grows) result.stability = Stability::differentiating;
  return result;
}

}  // namespace frac
