// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <complex>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "backlash/loops/control_loop.hpp"
#include "backlash/loops/simulate_loop.hpp"
#include "linear_flight.hpp"
#include "placed_operator.hpp"

namespace backlash::detail {

/// F cos(omega t) on body 2.
struct SineForce {
  double amplitude;  // N
  double omega;      // rad/s
};

/// Frequency at which the rigid loop crosses over, from above, rad/s; 1 where it never does.
[[nodiscard]] double crossover(const ControlLoop& loop);

/// The loop as x' = A x between impacts, with one A for each combination of limited force and contact.  The bodies are
/// masses under the force of their friction and springs, R(s) = 1/G - M s^2 of their own position, so that an impact
/// acts on velocities alone.  With a dead time the controller follows a twin of the load, to which everything happens
/// that much later.
class RealisedLoop {
 public:
  /// @param tolerance  of fractional powers, relative over the frequencies of the motion
  /// @throws std::invalid_argument  dead time with the driven body measured.
  RealisedLoop(const ControlLoop& loop, const SetPoint& set_point, double force_limit, double tolerance,
               const Disturbance& disturbance = {});
  /// The bodies under a force, without a controller.
  /// @param output  whose phasor is formed
  RealisedLoop(const LinearBodies& bodies, const SineForce& force, Output output, double tolerance);

  enum class Limit { none, low, high };
  struct Mode {
    Limit limit = Limit::none;
    bool contact = false;
  };
  struct Regime {
    LinearFlight flight;
    LinearFlight::Form gap;               // x2 - x1
    LinearFlight::Form wanted_force;      // of the controller, before the limit
    LinearFlight::Form contact_force;     // on mass 1
    Eigen::RowVectorXd gap_acceleration;  // in flight, of the present state
    Eigen::RowVectorXd wanted_force_row;
  };
  [[nodiscard]] const Regime& regime(Mode mode) const;

  /// Rested at the start's positions until its velocities come at t = 0.
  [[nodiscard]] Eigen::VectorXd rest(const LoopStart& start) const;
  /// Velocities jump, and with them what the operators see of it; with a dead time the controller only in twin_jumps().
  void jump(Eigen::VectorXd& state, double velocity1, double velocity2) const;
  void twin_jumps(Eigen::VectorXd& state, double velocity1) const;
  /// The position of a load that starts elsewhere than at 0 comes to the twin.
  void twin_starts(Eigen::VectorXd& state, double position) const;
  void set_point_starts(Eigen::VectorXd& state) const;
  void set_point_bends(Eigen::VectorXd& state, double change_of_slope) const;

  /// Under a sine force: 2/T times the integral of the output times e^{-j omega t} since the last call, for a time that
  /// is a multiple of the period T.
  [[nodiscard]] std::complex<double> take_phasor(Eigen::VectorXd& state) const;

  [[nodiscard]] const TwoMassSystem& system() const noexcept { return system_; }
  [[nodiscard]] double force_limit() const noexcept { return force_limit_; }
  /// m/s^2, of forces that disturb.
  [[nodiscard]] double push() const noexcept {
    return std::abs(disturbance_.body1) / system_.mass1() + std::abs(disturbance_.body2) / system_.mass2();
  }
  [[nodiscard]] double delay() const noexcept { return delay_; }
  [[nodiscard]] bool has_twin() const noexcept { return twin_ >= 0; }
  /// rad/s, at which the rigid loop crosses over, or of the sine force: of the motion.
  [[nodiscard]] double pace() const noexcept { return pace_; }
  /// Largest of its operators.
  [[nodiscard]] double error() const noexcept { return error_; }
  /// Rough sizes of the states.
  [[nodiscard]] const Eigen::VectorXd& sizes() const noexcept { return scale_; }

 private:
  using Row = Eigen::RowVectorXd;
  void place_bodies(const LinearBodies& bodies, double tolerance);
  void choose_scale();
  [[nodiscard]] PlacedOperator place(const frac::FractionalTransferFunction& operand, double shift, double tolerance);
  [[nodiscard]] Row unit(Eigen::Index i) const;
  [[nodiscard]] std::unique_ptr<Regime> make(Mode mode) const;

  TwoMassSystem system_;
  SetPoint set_point_;
  double force_limit_;
  Disturbance disturbance_;
  double delay_ = 0;
  bool is_driven_;  // x2 is measured or read
  double pace_;
  frac::FrequencyBand band_;
  double error_ = 0;
  Eigen::Index size_ = 0;
  Eigen::Index one_ = -1, reference_ = -1, sine_ = -1, lagged_ = -1, twin_ = -1, phasor_ = -1;
  std::optional<PlacedOperator> load_, drive_, twin_load_;
  std::optional<PlacedOperator> controller_;
  double sine_force_ = 0;  // N, in place of the controller
  Eigen::VectorXd scale_;
  mutable std::array<std::unique_ptr<Regime>, 6> regimes_;
};

}  // namespace backlash::detail
