// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <complex>
#include <cstddef>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "backlash/two_mass_system.hpp"
#include "frac/model/frequency_response_data.hpp"
#include "frac/parallel_for.hpp"

namespace backlash {

/// Where the motion starts, which decides the attractor that is seen.  A state is carried from one frequency to the
/// next where the force is at its peak: relative position (m) and velocity (m/s) are kept.
enum class Protocol {
  sweep_up,         // the state is carried from point to point, omega rising; begins at mid-gap at rest
  sweep_down,       // the same, omega falling
  contact_at_rest,  // each point anew from contact at rest, x2 = x1, force at its peak
  mid_gap_at_rest,  // each point anew from the middle of the gap at rest, force at its peak
  two_impact,       // the two-impact orbit where it exists and is stable, else as sweep_up
};

/// Cheapest exact model of a point.
enum class Regime {
  /// Clearance 0, or so small against F/(M2 omega^2) that the masses move as one to the last digit.
  rigid,
  free,       // no impacts
  symmetric,  // two impacts per period, closed form
  periodic,   // closed orbit
  chatter,    // sticks every period after infinitely many impacts: one run from release is exact
  averaged,   // neither found: long-time mean with error estimate
};

enum class Output { x1, x2 };

[[nodiscard]] std::string_view to_string(Protocol protocol);
[[nodiscard]] std::string_view to_string(Regime regime);
[[nodiscard]] std::string_view to_string(Output output);
/// Command-line spellings (sweep-up, ...). @throws std::invalid_argument  naming the allowed ones.
[[nodiscard]] Protocol protocol_from_string(std::string_view text);
[[nodiscard]] Regime regime_from_string(std::string_view text);
[[nodiscard]] Output output_from_string(std::string_view text);
[[nodiscard]] std::span<const Protocol> protocols();
[[nodiscard]] std::span<const Output> outputs();

struct SweepOptions {
  Protocol protocol = Protocol::sweep_up;
  Output output = Output::x1;
  /// In (0, 0.01]: an orbit is closed when its state repeats to within this, u and du/d(omega t) in units of the
  /// clearance; chatter is cut off where it matters less than a thousandth of it.
  double tolerance = 1e-10;
  /// In [0, 1): a long-time mean of a chaotic motion ends early, with its uncertainty, once that is below this share of
  /// |N|; 0 follows each for a thousand periods.
  double mean_tolerance = 0;
  int threads = 0;  // 0: one per core
};

/// Steady state at one frequency.
struct DescribingFunctionPoint {
  /// The value is finite.
  [[nodiscard]] bool usable() const noexcept { return std::isfinite(value.real()) && std::isfinite(value.imag()); }
  /// Frequency, value with its uncertainty, and kind of motion.
  [[nodiscard]] std::string summary() const;

  /// rad/s.
  double omega;
  /// m/N.
  std::complex<double> value;
  Regime regime;
  /// Force periods per orbit; 0 when averaged.
  int period;
  /// Infinite for complete chatter; NaN where not one whole period could be followed.
  double impacts_per_period;
  /// Uncertainty of |value|, m/N: rounding for closed orbits, the 95 % half width of the mean when averaged.
  double uncertainty;
  /// |third harmonic|/|fundamental| of the output position; NaN where the fundamental is 0.
  double third_harmonic_ratio;
  /// |second harmonic|/|fundamental| of the output position: 0 for a symmetric motion.
  double even_harmonic_ratio = std::numeric_limits<double>::quiet_NaN();
  /// |work of the force - impact losses| over the energy of relative motion that the impacts meet: rounding and closure
  /// of the orbit; 0 without impacts.
  double energy_defect = std::numeric_limits<double>::quiet_NaN();
  /// The largest one, per force period: negative on orbits, positive where the motion is chaotic, near 0 in slow
  /// transients.  -infinity where a stick forgets every disturbance, NaN where nothing was followed.
  double lyapunov_exponent = std::numeric_limits<double>::quiet_NaN();
  /// Force periods that an averaged motion was followed from its start; 0 for the other regimes.
  double periods_followed = 0;
  /// The mean may be of a transient: chaotic motions of small dissipation can settle on an orbit after any time, 10^5
  /// periods for example.  `uncertainty` is then that of the mean over periods_followed alone.
  bool transient_possible = false;
  /// Relative change of the value per relative change of the force, estimated from above, where a motion that sticks is
  /// so long that rounding decides which orbit is computed: the value is then the mean over forces that differ in the
  /// last digits.  NaN elsewhere.
  double force_sensitivity = std::numeric_limits<double>::quiet_NaN();
};

struct DescribingFunctionSweep {
  TwoMassSystem system;
  double force_amplitude;  // N
  SweepOptions options;
  std::vector<DescribingFunctionPoint> points;  // omega rising

  [[nodiscard]] frac::FrequencyResponseData data() const;
};

/// N(F, omega) = phasor of the output position over that of the force, on a grid.
/// @param force_amplitude  N, > 0
/// @param omega            rad/s, positive, strictly increasing, not empty
/// @throws std::invalid_argument  naming the quantity, its value, index and what is allowed.
[[nodiscard]] DescribingFunctionSweep describing_function_sweep(const TwoMassSystem& system, double force_amplitude,
                                                                const std::vector<double>& omega,
                                                                const SweepOptions& options = {});

/// One curve of a family.
struct SweepScene {
  TwoMassSystem system;
  double force_amplitude;  // N
};

/// A family of curves over one grid, computed in parallel; the result does not depend on options.threads.
/// @param progress  counts points, if given
/// @throws std::invalid_argument  as describing_function_sweep; the text names the scene.
[[nodiscard]] std::vector<DescribingFunctionSweep> describing_function_sweeps(const std::vector<SweepScene>& scenes,
                                                                              const std::vector<double>& omega,
                                                                              const SweepOptions& options = {},
                                                                              frac::Progress* progress = nullptr);

}  // namespace backlash
