// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "backlash/describing_function.hpp"
#include "backlash/two_mass_system.hpp"
#include "frac/parallel_for.hpp"

namespace backlash {

/// A long-run motion that starts lead to.
struct Attractor {
  DescribingFunctionPoint point;  // describing function, regime, period, impacts per period, uncertainty
  bool symmetric;                 // equal to its mirror image (see mirror_twin); of a mean: within its uncertainty
  std::size_t starts;             // of the grid that lead to it
};

/// Which attractor each start of a grid leads to.
struct BasinMap {
  TwoMassSystem system;
  double force_amplitude;  // N
  double omega;            // rad/s
  std::vector<double> position;
  std::vector<double> velocity;
  std::vector<Attractor> attractors;   // of many starts first
  std::vector<std::size_t> attractor;  // index into attractors, position slowest
  bool has_friction = false;           // besides the loss of impacts

  /// Whether energy is lost.  At restitution 1 without friction it is not, and nothing attracts: the entries of
  /// `attractors` are then motions that starts stay in, and other starts give others.
  [[nodiscard]] bool attracts() const { return system.restitution() < 1 || has_friction; }
  [[nodiscard]] const Attractor& at(std::size_t position_index, std::size_t velocity_index) const {
    return attractors.at(attractor.at(position_index * velocity.size() + velocity_index));
  }
};

/// Follows each start, where the force is at its peak, to its attractor.  Closed orbits are one when their phasors
/// agree to 1e-6; an asymmetric orbit and its mirror twin, of equal describing function, are two.  Long-time means are
/// one when they agree within the sum of their uncertainties, so that attractors of nearly equal mean, and the
/// continuum of motions without dissipation, count as one.  Motions without impacts are one.
/// @param force_amplitude  N, > 0;  @param omega  rad/s, > 0
/// @param position  of x2 - x1, m, in [0, clearance], not empty
/// @param velocity  of x2 - x1, m/s, not empty; at a wall and into it: as it is before the impact
/// @param options   output, tolerances and threads; protocol has no meaning here
/// @param progress  counts starts, if given
/// @throws std::invalid_argument  naming the quantity, its value, index and what is allowed; clearance 0 has no
///                                impacts, F/(M2 clearance omega^2) must be in (1e-30, 1e30).
[[nodiscard]] BasinMap basins(const TwoMassSystem& system, double force_amplitude, double omega,
                              const std::vector<double>& position, const std::vector<double>& velocity,
                              const SweepOptions& options = {}, frac::Progress* progress = nullptr);

/// Where one start leads: numbers that, kept elsewhere, bring a search back to the bit.
using StartOutcome = std::array<double, 27>;

/// Keeps what a search for basins has found so far; a store that survives an interruption lets the same search go on.
/// Called from several threads.
class OutcomeStore {
 public:
  OutcomeStore() = default;
  OutcomeStore(const OutcomeStore&) = delete;
  OutcomeStore& operator=(const OutcomeStore&) = delete;
  virtual ~OutcomeStore() = default;

  /// @param key  of some starts, without blanks
  [[nodiscard]] virtual bool contains(const std::string& key) const = 0;
  /// What was kept under a key that is there.
  [[nodiscard]] virtual std::vector<StartOutcome> outcomes(const std::string& key) const = 0;
  /// Keeps outcomes under a new key.
  virtual void keep(const std::string& key, const std::vector<StartOutcome>& outcomes) = 0;
};

/// The same with a store of the caller's, which holds all outcomes: memory then holds 8 bytes per start.
[[nodiscard]] BasinMap basins(const TwoMassSystem& system, double force_amplitude, double omega,
                              const std::vector<double>& position, const std::vector<double>& velocity,
                              const SweepOptions& options, frac::Progress* progress, OutcomeStore& store);

}  // namespace backlash
