// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <complex>
#include <cstddef>
#include <span>
#include <string_view>
#include <vector>

#include "backlash/describing_function.hpp"
#include "backlash/impact_simulation.hpp"
#include "backlash/two_mass_system.hpp"
#include "frac/parallel_for.hpp"

namespace backlash {

/// The quantity that changes along a branch; the others of the scene are held.
enum class OrbitParameter {
  omega,
  force,
  clearance,
  restitution,
  contact_frequency,  // of contacts that take time, at one damping ratio; see compliant/compliant_orbits.hpp
};

/// Bifurcations of periodic orbits in one parameter.
enum class Bifurcation {
  saddle_node,        // a multiplier +1: two orbits meet and vanish
  symmetry_breaking,  // a multiplier +1 at which the orbit parts from its mirror image (pitchfork)
  period_doubling,    // a multiplier -1
  grazing,            // a contact of speed 0 is gained or lost
  sticking,           // a rest of a body with dry friction, or a turn without one, is gained or lost
};

/// Why a branch ends.
enum class BranchEnd {
  range,              // at the end of the range asked for
  grazing,            // at a bifurcation of that kind
  sticking,           // the same
  symmetry_breaking,  // at the bifurcation it is born from
  period_doubling,    // the same
  closed,             // a closed loop, ended where it began
  lost,               // Newton's iteration failed
  too_long,           // after 20 000 orbits, of contacts that take time 500
};

[[nodiscard]] std::string_view to_string(OrbitParameter parameter);
[[nodiscard]] std::string_view to_string(Bifurcation bifurcation);
[[nodiscard]] std::string_view to_string(BranchEnd end);
/// @throws std::invalid_argument  naming the allowed spellings.
[[nodiscard]] OrbitParameter orbit_parameter_from_string(std::string_view text);
[[nodiscard]] std::span<const OrbitParameter> orbit_parameters();

struct OrbitImpact {
  double phase;  // omega t at the impact, rad; that of the first one in [0, 2 pi)
  Wall wall;
  double speed;  // |x2' - x1'| before the impact, m/s
};

/// A periodic orbit, stable or not.
struct PeriodicOrbit {
  double parameter;            // in rad/s, N, m or 1, see OrbitDiagram
  double omega;                // rad/s
  std::complex<double> value;  // describing function, m/N
  /// Of the map over the whole orbit, larger modulus first; infinite where an impact has speed 0.
  std::array<std::complex<double>, 2> multipliers;
  bool stable;                       // both multipliers within the unit circle
  std::vector<OrbitImpact> impacts;  // of the whole orbit, in order of time
};

/// The orbit of x2 - x1 -> clearance - (x2 - x1) half a force period later: again one, with the same describing
/// function and multipliers. A symmetric orbit is its own twin.
[[nodiscard]] PeriodicOrbit mirror_twin(const PeriodicOrbit& orbit, int period);

struct BifurcationPoint {
  Bifurcation kind;
  PeriodicOrbit orbit;
  std::size_t after;  // index of the last orbit of the branch before it
};

/// A one-parameter family of orbits of one pattern.
struct OrbitBranch {
  int period;      // force periods per orbit
  int impacts;     // per orbit
  bool symmetric;  // the second half is the mirror image of the first one
  std::vector<PeriodicOrbit> orbits;
  std::vector<BifurcationPoint> bifurcations;
  BranchEnd begin;
  BranchEnd end;
};

struct OrbitContinuationOptions {
  Output output = Output::x1;
  int longest_period = 4;  // force periods: longer orbits are left out, >= 1
  int most_impacts = 16;   // per orbit: orbits of more are left out, >= 2
  int threads = 0;         // 0: one per core
  /// Values of the parameter within the range at which all orbits are followed that a grid of 41 x 41 starts settles
  /// on, positions from wall to wall and velocities up to clearance times omega either way: those that basins() finds
  /// from the same starts.
  std::vector<double> basins_at = {};
};

struct OrbitDiagram {
  TwoMassSystem system;    // its clearance or restitution holds where that is not the parameter
  double force_amplitude;  // N, likewise
  double omega;            // rad/s, likewise
  OrbitParameter parameter;
  double from, to;  // of the parameter: rad/s, N, m or 1
  OrbitContinuationOptions options;
  std::vector<OrbitBranch> branches;  // of few impacts and short period first
};

/// The periodic orbits of a scene between two values of one of its quantities: those that simulations from starts
/// spread over the range settle on or come near to, continued through folds by pseudo-arclength (Keller 1977), and
/// those that branch off them at symmetry breaking, period doubling and grazing.  Orbits along a branch are exact to
/// rounding; bifurcations are refined to 1e-10 of the parameter.  By similarity frequency, force and clearance lead
/// along the same family, in ln(F/(M2 clearance omega^2)).  Orbits in which the masses rest in contact (see
/// Regime::chatter) are not among them: a branch ends at the grazing before.  The value that `system`,
/// `force_amplitude` or `omega` gives for the parameter itself is not used. Not promised: every orbit.  Unstable
/// branches are listed where a bifurcation of a stable one leads to them, and so are branches that are stable over less
/// than 1e-4 of the range.  An orbit that attracts few starts over a short piece of the range may be missed, unless
/// basins_at names a value where it does.
/// @param force_amplitude  N, > 0
/// @param omega            rad/s, > 0
/// @param parameter  not contact_frequency, as contacts take no time
/// @param from,to   0 < from < to, for restitution 0 <= from < to <= 1
/// @param progress  counts starts, if given
/// @throws std::invalid_argument  naming the quantity, its value and what is allowed; clearance 0 has no impacts.
[[nodiscard]] OrbitDiagram orbit_diagram(const TwoMassSystem& system, double force_amplitude, double omega,
                                         OrbitParameter parameter, double from, double to,
                                         const OrbitContinuationOptions& options = {},
                                         frac::Progress* progress = nullptr);

/// Over frequency, rad/s.
[[nodiscard]] OrbitDiagram orbit_diagram(const TwoMassSystem& system, double force_amplitude, double omega_from,
                                         double omega_to, const OrbitContinuationOptions& options = {},
                                         frac::Progress* progress = nullptr);

}  // namespace backlash
