// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <complex>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "backlash/compliant/compliant_bodies.hpp"
#include "backlash/compliant/compliant_loop.hpp"
#include "backlash/loops/limit_cycles.hpp"
#include "backlash/loops/simulate_loop.hpp"
#include "loops/motions/linear_flight.hpp"
#include "loops/motions/placed_operator.hpp"
#include "loops/motions/realised_loop.hpp"

namespace backlash::detail {

/// Which linear piece of the motion holds.
struct CompliantMode {
  int contact = 0;  // wall that presses: 1 where x2 - x1 = clearance/2, -1, or 0
  int left = 0;     // wall that presses no more, while the bodies still overlap
  /// Sign of the velocity of each body that slides, 0 of one that sticks; 1 of one without dry friction.
  std::array<int, 2> slide = {1, 1};
  /// A body that has just begun to slide rests at first: its end is not looked for before its acceleration turns.
  std::array<bool, 2> is_starting = {false, false};
  int limit = 0;  // sign of the force that the actuator is held at, 0 while it gives what the controller asks for

  bool operator==(const CompliantMode&) const = default;
};

/// Gap and speeds are rounded before stiffness and damping multiply them: between contacts that are faster than this
/// only rounding would be left of the forces, and a restitution, to which they tend in first order, is as good.
/// @throws std::invalid_argument  sqrt(k/m) above 10^6 omega, or c/m above 10^9 omega.
void require_followed(const CompliantBodies& bodies, double omega, const char* meaning = "omega");

/// A force on body 2 that is held for a while each, what moves fast with it, and how far.
struct HeldForce {
  double size;   // N
  double pace;   // rad/s
  double swing;  // m
};

/// The bodies as z' = A z, one A for each combination of contact, sliding and limit of the force: z holds gap and its
/// rate, position and velocity of body 1, cos and sin of the angle of the force or of the set-point, 1, what friction
/// and springs remember, and W' = j k omega W + v for the harmonics k of a force that are asked for, or the set-point
/// and what the controller remembers.
class CompliantFlow {
 public:
  enum : Eigen::Index { gap, rate, x1, v1, cosine, sine, one, first_memory };

  /// @param harmonics  0: W of the fundamental of the velocity read; else orders 1 to harmonics
  CompliantFlow(const CompliantBodies& bodies, const SineForce& force, Output output, double tolerance, int harmonics);
  /// Of a loop.
  /// @param tolerance  of fractional powers, relative over the frequencies of motion and contacts
  /// @param fastest    rad/s, of contacts whose frequencies are to be among them
  CompliantFlow(const CompliantLoop& loop, const SetPoint& set_point, double force_limit, double tolerance,
                double fastest = 0, const Disturbance& disturbance = {});

  /// Under hold_force().
  CompliantFlow(const CompliantBodies& bodies, const HeldForce& force, const Disturbance& disturbance);

  using Row = Eigen::RowVectorXd;
  struct Linear {
    Row row;
    LinearFlight::Form form;
  };
  /// Of each body.
  struct Body {
    Linear velocity;
    Linear acceleration;
    Linear others;  // the force on it but for dry friction, N
    Row resisted;   // of it that of friction and springs, N, against the motion
  };
  struct Regime {
    Eigen::MatrixXd a;
    LinearFlight flight;
    Linear gap;
    std::array<Linear, 2> press;  // k d + c d' at the walls -1 and 1
    std::array<Body, 2> bodies;
    Linear wanted;  // force on body 2 before its limit
  };
  [[nodiscard]] const Regime& regime(const CompliantMode& mode) const;
  [[nodiscard]] const Linear& press(const Regime& regime, int wall) const { return regime.press[wall > 0 ? 1 : 0]; }

  /// At a peak of the force or where the set-point begins, rested at the start's positions until its velocities come.
  [[nodiscard]] Eigen::VectorXd start(const LoopStart& at) const;
  /// Of a loop, as bodies meet at +half_gap() in a motion whose impacts take no time.
  [[nodiscard]] Eigen::VectorXd meeting(const SymmetricCycle& cycle) const;
  /// The slope of the set-point changes.
  void set_point_bends(Eigen::VectorXd& state, double change_of_slope) const;
  void hold_force(Eigen::VectorXd& state, double force) const;
  /// Of the force wanted in that state.
  [[nodiscard]] int limit_of(const Eigen::VectorXd& state) const;
  [[nodiscard]] static LoopStart positions(const Eigen::VectorXd& state);
  /// The bodies at a peak, with whatever contact and sliding goes with the state.
  [[nodiscard]] CompliantMode mode_of(const Eigen::VectorXd& state) const;
  /// Of the mirror image.
  [[nodiscard]] CompliantMode turned_over(CompliantMode mode) const;
  /// Puts the force at its peak exactly and W to 0. @return 2/T times the integral of v e^{-j k omega t}
  std::vector<std::complex<double>> take_phasors(Eigen::VectorXd& state, double periods) const;

  [[nodiscard]] const CompliantBodies& bodies() const noexcept { return bodies_; }
  [[nodiscard]] double force() const noexcept { return force_.amplitude; }
  /// N, of the actuator.
  [[nodiscard]] double force_limit() const noexcept { return force_limit_; }
  /// rad/s, of the motion.
  [[nodiscard]] double pace() const noexcept { return pace_; }
  [[nodiscard]] double omega() const noexcept { return force_.omega; }
  [[nodiscard]] double half_gap() const noexcept { return half_gap_; }
  [[nodiscard]] double friction(int body) const noexcept {
    return body == 0 ? bodies_.friction().body1 : bodies_.friction().body2;
  }
  [[nodiscard]] const Eigen::VectorXd& sizes() const noexcept { return sizes_; }
  /// States that an orbit must repeat: without the place of bodies that nothing holds, and the speed of their centre of
  /// mass where nothing else acts on them.
  [[nodiscard]] const std::vector<Eigen::Index>& repeating() const noexcept { return repeating_; }
  /// Largest of fractional powers.
  [[nodiscard]] double error() const noexcept { return error_; }

 private:
  [[nodiscard]] Row unit(Eigen::Index i) const;
  [[nodiscard]] std::unique_ptr<Regime> make(const CompliantMode& mode) const;
  [[nodiscard]] std::optional<PlacedOperator> place(const frac::FractionalTransferFunction& receptance, double mass,
                                                    double tolerance, double shift);
  [[nodiscard]] PlacedOperator place(const frac::FractionalTransferFunction& operand, double tolerance, double shift);
  void choose_sizes(double swing, double force);
  /// A jump of the velocity of body 2.
  void strike_drive(Eigen::VectorXd& state, double velocity) const;

  CompliantBodies bodies_;
  SineForce force_;
  Output output_;  // read, or followed by the controller
  SetPoint set_point_;
  double force_limit_ = std::numeric_limits<double>::infinity();
  Disturbance disturbance_;
  double pace_;
  double fastest_ = 0;
  double half_gap_;
  double gap_size_ = 0;
  Eigen::Index size_ = first_memory;
  Eigen::Index phasors_ = -1;
  int harmonics_;
  double error_ = 0;
  std::array<std::optional<PlacedOperator>, 2> memory_;
  std::optional<PlacedOperator> controller_;  // in place of the sine force
  Eigen::Index reference_ = -1, lagged_ = -1;
  Eigen::VectorXd sizes_;
  std::vector<Eigen::Index> repeating_;
  mutable std::array<std::unique_ptr<Regime>, 81> regimes_;
};

}  // namespace backlash::detail
