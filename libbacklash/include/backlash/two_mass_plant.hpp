// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "backlash/two_mass_system.hpp"

namespace backlash {

/// Positions in m, velocities in m/s.
struct TwoMassState {
  double position1 = 0;
  double velocity1 = 0;
  double position2 = 0;  // in [position1, position1 + clearance]
  double velocity2 = 0;
};

/// The two masses in a sampled control loop: the force on mass 2 is constant between samples, so flights are parabolas,
/// impacts (eqs. 2-4) are met at exact instants, and a chattering sequence of hops is a geometric series, followed to
/// its end in closed form, after which the masses rest in contact until the force turns.
class TwoMassPlant {
 public:
  /// @throws std::invalid_argument  a number not finite, or the masses further apart than the clearance allows.
  explicit TwoMassPlant(const TwoMassSystem& system, const TwoMassState& start = {});

  /// Follows the masses for `duration` seconds under a force (N) on mass 2.
  /// @throws std::invalid_argument  force not finite, duration negative or not finite, or speed and duration such that
  ///                                the clearance could be crossed more than 10^7 times.
  void advance(double force, double duration);

  [[nodiscard]] TwoMassState state() const noexcept;
  /// position2 - position1, in [0, clearance], m, and its rate, m/s.
  [[nodiscard]] double gap() const noexcept;
  [[nodiscard]] double gap_rate() const noexcept;
  /// The masses touch and do not part under the last force.
  [[nodiscard]] bool in_contact() const noexcept { return is_joined_; }
  [[nodiscard]] double momentum() const noexcept;        // kg m/s
  [[nodiscard]] double kinetic_energy() const noexcept;  // J
  /// Since the start: J lost in impacts, and their number; a completed chatter counts as one.
  [[nodiscard]] double energy_loss() const noexcept { return energy_loss_; }
  [[nodiscard]] std::uint64_t impacts() const noexcept { return impacts_; }
  [[nodiscard]] const TwoMassSystem& system() const noexcept { return system_; }

 private:
  void move_gap(double acceleration, double duration);
  void hit(double speed) noexcept;
  double hop_along_wall(double pressure, double duration) noexcept;

  TwoMassSystem system_;
  double total_mass_;
  double reduced_mass_;
  double centre_ = 0;       // of mass, m
  double centre_rate_ = 0;  // m/s
  // The gap is measured from the wall last touched, so that short hops keep relative precision at either wall.
  bool at_far_ = false;
  double distance_ = 0;  // m, in [0, clearance]
  double rate_ = 0;      // m/s, of the distance
  bool is_joined_ = false;
  double energy_loss_ = 0;
  std::uint64_t impacts_ = 0;
};

}  // namespace backlash
