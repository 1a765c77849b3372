// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <string_view>

#include "compliant_flow.hpp"

namespace backlash::detail {

/// A motion of bodies with compliant contacts, event by event.
class CompliantRun {
 public:
  enum class Event {
    none,           // the time asked for has come
    contact,        // a wall begins to press
    separation,     // it presses no more; the bodies still overlap
    parting,        // they overlap no more
    stick,          // a body comes to rest
    slide,          // a body that rested begins to move
    reversal,       // a body turns without rest
    turn_of_force,  // nothing to be seen
    limit,          // the force reaches the actuator's limit or leaves it; nothing to be seen
  };

  /// Of one force period: ten times those of a contact that rings at 10^4 times the force and bounces each time.
  static constexpr int most_events = 100'000;

  /// @param state  at a peak of the force
  CompliantRun(const CompliantFlow& flow, const Eigen::VectorXd& state, const CompliantMode& mode);

  /// To the next event, or to `until`, s since the last peak that take_phasors() counts from.
  Event advance(double until);
  /// To a peak of the force `periods` after the last one; state and time then begin anew. @return false where it has no
  /// end: more events than a motion that is not computed by rounding alone would have
  bool follow(int periods);
  /// Of a run that has reached that peak: as follow() ends.
  void begin_anew(int periods);

  [[nodiscard]] const CompliantFlow& flow() const noexcept { return *flow_; }
  [[nodiscard]] const Eigen::VectorXd& state() const noexcept { return state_; }
  [[nodiscard]] const CompliantMode& mode() const noexcept { return mode_; }
  [[nodiscard]] double time() const noexcept { return time_; }
  /// Wall of the last contact, separation or parting, body of the others.
  [[nodiscard]] int subject() const noexcept { return subject_; }
  /// Since the start.
  [[nodiscard]] std::int64_t contacts() const noexcept { return contacts_; }
  [[nodiscard]] std::int64_t sticks() const noexcept { return sticks_; }
  /// Velocity phasors of the periods followed last, m/s.
  [[nodiscard]] const std::vector<std::complex<double>>& phasors() const noexcept { return phasors_; }
  /// The state has left the range of numbers, or speeds their bound.
  [[nodiscard]] bool has_escaped() const noexcept;
  /// Of the speeds of both bodies, m/s.
  void set_bound(double speed) { bound_ = speed; }
  /// So many flights without an event that no more are followed.
  [[nodiscard]] bool is_spent() const noexcept { return flights_ >= most_flights; }
  /// The slope of a loop's set-point changes.
  void bend_set_point(double change_of_slope);
  /// Of a flow with a HeldForce.
  void hold_force(double force);

  /// From now on: d state/d state then, over flights and events, for changes that leave bodies at rest where they
  /// stick.
  void begin_transition();
  [[nodiscard]] const Eigen::MatrixXd& transition() const noexcept { return transition_; }
  /// Is called with each piece of a flight.
  using Visit = std::function<void(const CompliantFlow::Regime&, const CompliantMode&, const FlightPath&, double)>;
  void visit_pieces(Visit visit) { visit_ = std::move(visit); }

 private:
  static constexpr std::int64_t most_flights = 20'000'000;

  void press(int wall);
  /// Slides and rests that go with forces that have changed at once.
  void settle_slides();
  void stop(std::size_t body);
  void release(std::size_t body, int sign);
  void hold_still(double place, double gap);
  /// The jump of a disturbance at an event of the surface row * state = const.
  void jump(const CompliantFlow::Row& surface, const CompliantFlow::Regime& before);

  const CompliantFlow* flow_;
  Eigen::VectorXd state_;
  CompliantMode mode_;
  double time_ = 0;
  int subject_ = 0;
  std::int64_t contacts_ = 0, sticks_ = 0;
  std::vector<std::complex<double>> phasors_;
  Eigen::MatrixXd transition_;
  Visit visit_;
  double bound_ = std::numeric_limits<double>::infinity();
  std::int64_t flights_ = 0;  // since the last event
};

/// A motion at the first peak of the force after a contact, when the force is at `angle`, rad from its peak; the force
/// has the angular frequency 1.
[[nodiscard]] CompliantRun at_next_peak(const CompliantFlow& flow, const LoopStart& at_contact, double angle);

}  // namespace backlash::detail
