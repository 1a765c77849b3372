// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <complex>
#include <cstdint>
#include <deque>
#include <optional>

#include "backlash/loops/simulate_loop.hpp"
#include "realised_loop.hpp"

namespace backlash::detail {

/// A motion of a realised loop from event to event: impacts, rests in contact, the limit of the force, points of the
/// set-point, and what comes to the controller after its dead time.
class LoopRun {
 public:
  /// @param loop  outlives the run
  LoopRun(const RealisedLoop& loop, const LoopStart& start, const SetPoint& set_point);
  /// A motion of bodies under a sine force.
  LoopRun(const RealisedLoop& loop, const LoopStart& start) : LoopRun(loop, start, {}) {}

  enum class Event { none, impact, contact, release };
  /// To the next event or to `until`, whichever comes first. @return what happened; none at `until`
  Event advance(double until);

  [[nodiscard]] double time() const noexcept { return time_; }
  [[nodiscard]] LoopRow row(LoopEvent event) const { return row_of(state_, time_, event); }
  /// At an event: just before it.
  [[nodiscard]] LoopRow row_before(LoopEvent event) const { return row_of(before_, time_, event); }
  [[nodiscard]] const LoopImpact& last_impact() const noexcept { return last_impact_; }
  /// As RealisedLoop's.
  [[nodiscard]] std::complex<double> take_phasor() { return loop_->take_phasor(state_); }
  /// Impacts follow each other without end, or rest where that is not followed.
  [[nodiscard]] bool is_stuck() const noexcept { return is_stuck_; }
  /// So many flights without an end that no more are followed.
  [[nodiscard]] bool is_spent() const noexcept { return flights_ >= most_flights; }
  [[nodiscard]] bool has_diverged() const;
  [[nodiscard]] bool is_in_contact() const noexcept { return mode_.contact; }
  /// 1 at +clearance/2, -1 at the other: of the contact, or of the last release.
  [[nodiscard]] double wall() const noexcept { return wall_; }
  /// N, on mass 1, in contact.
  [[nodiscard]] double contact_force() const;
  [[nodiscard]] const Eigen::VectorXd& state() const noexcept { return state_; }
  /// Right after a release: one of the same kind.
  void set_state(const Eigen::VectorXd& state) { state_ = state; }

  /// Takes the state of a motion at the same time with its relative velocity changed by a share of the pace.
  void displace(const LoopRun& from, double share);
  /// Moves by a share of the way to another motion of the same time.
  void displace_towards(const LoopRun& other, double share);
  /// Over the sizes of the states.
  [[nodiscard]] double distance(const LoopRun& other) const;

 private:
  static constexpr std::int64_t most_flights = 20'000'000;

  // Events at a time that is known.
  struct Planned {
    double time;
    enum class Kind { twin_starts, twin_jumps, set_point_starts, set_point_bends } kind;
    double value;
  };
  void plan(const Planned& planned);
  void apply(const Planned& planned);
  [[nodiscard]] LoopRow row_of(const Eigen::VectorXd& state, double time, LoopEvent event) const;
  void choose_limit();
  Event strike(double wall);
  Event touch(double wall);

  TwoMassSystem system_;
  const RealisedLoop* loop_;
  double force_limit_;
  double half_clearance_;
  double fastest_;  // m/s: beyond it the motion has diverged
  std::deque<Planned> planned_;
  RealisedLoop::Mode mode_;
  double wall_ = 0;  // in contact: 1 at +clearance/2
  Eigen::VectorXd state_;
  Eigen::VectorXd before_;
  double time_ = 0;
  double step_;
  double free_until_ = 0;  // the wall just left cannot be met before
  double left_wall_ = 0;
  double last_event_ = 0;
  LoopImpact last_impact_{};
  int crowded_ = 0;
  bool is_stuck_ = false;
  bool is_lost_ = false;      // beyond the range of numbers
  std::int64_t flights_ = 0;  // since the last event
};

/// Refuses arguments of simulate_loop().
void require_simulated(const ControlLoop& loop, const LoopStart& start, const SetPoint& set_point,
                       const LoopSimulationOptions& options);

/// simulate_loop() but for whole_memory, of arguments that are valid.
[[nodiscard]] LoopHistory run_loop(const ControlLoop& loop, const LoopStart& start, const SetPoint& set_point,
                                   const LoopSimulationOptions& options);

}  // namespace backlash::detail
