// SPDX-License-Identifier: BSD-3-Clause
#include "backlash/loops/forced_bodies.hpp"

#include "base/check.hpp"
#include "forced_motion.hpp"
#include "frac/parallel_for.hpp"
#include "loops/equations/gap_response.hpp"
#include "steady_state/describing_function_point.hpp"
#include "symmetric_forced_orbit.hpp"

namespace backlash {

DescribingFunctionSweep bodies_describing_function(const LinearBodies& bodies, double force_amplitude,
                                                   const std::vector<double>& omega, const SweepOptions& options) {
  if (bodies.are_free()) return describing_function_sweep(bodies.system(), force_amplitude, omega, options);
  detail::require_valid(options);
  detail::require_positive("clearance", "m", bodies.system().clearance());
  detail::require_positive("force amplitude", "N", force_amplitude);
  detail::require_frequency_grid(omega);
  const detail::ImpulseAnswer response = detail::gap_response(bodies);
  DescribingFunctionSweep sweep{bodies.system(), force_amplitude, options, {}};
  sweep.points.resize(omega.size());
  const auto begin = [&] {
    LoopStart start;
    if (options.protocol == Protocol::contact_at_rest) {
      start.x1 = 0.25 * bodies.system().clearance();
      start.x2 = -start.x1;
    }
    return start;
  };
  const bool is_carried =
      options.protocol != Protocol::contact_at_rest && options.protocol != Protocol::mid_gap_at_rest;
  LoopStart carried = begin();
  const auto follow = [&](std::size_t i) {
    const double at = omega[i];
    if (options.protocol == Protocol::two_impact) {
      const detail::SymmetricForcedOrbit orbit(bodies, response, force_amplitude, at);
      if (orbit.exists()) {
        const CycleStability stability = orbit.stability();
        if (stability.stable) {
          sweep.points[i] = orbit.point(options.output, stability);
          carried = orbit.at_peak();
          return;
        }
      }
    }
    const detail::ForcedMotion motion =
        detail::follow_forced(bodies, force_amplitude, at, is_carried ? carried : begin(), options);
    sweep.points[i] = motion.point;
    if (is_carried) carried = motion.end;
  };
  if (is_carried) {
    const bool is_down = options.protocol == Protocol::sweep_down;
    for (std::size_t i = 0; i < omega.size(); ++i) follow(is_down ? omega.size() - 1 - i : i);
  } else {
    frac::parallel_for(omega.size(), options.threads, follow);
  }
  return sweep;
}

}  // namespace backlash
