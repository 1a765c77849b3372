// SPDX-License-Identifier: BSD-3-Clause
#include "loop_stepper.hpp"

#include <cmath>
#include <optional>

#include "base/impact_law.hpp"
#include "frac/fractional_derivative.hpp"

namespace backlash::detail {
namespace {

constexpr double tolerance = 1e-6;

// Position and speed of a body, 1/G = M s^2 + sum of c s^a.
class Body {
 public:
  Body(const frac::FractionalTransferFunction& receptance, double step, double horizon) : step_(step) {
    const double scale = receptance.numerator().front().coefficient;
    for (const frac::PowerTerm& term : receptance.denominator()) {
      const double coefficient = term.coefficient / scale;
      if (term.order == 2) {
        mass_ = coefficient;
      } else {
        resistance_.push_back({coefficient, term.order, std::nullopt});
        if (term.order != 0 && term.order != 1)
          resistance_.back().derivative.emplace(term.order, step, tolerance, horizon);
      }
    }
  }

  [[nodiscard]] double position() const { return position_; }
  [[nodiscard]] double speed() const { return speed_; }
  void hit(double impulse) { speed_ += impulse / mass_; }
  void push(double force) {
    for (Resistance& each : resistance_) {
      force -= each.coefficient * (each.order == 0   ? position_
                                   : each.order == 1 ? speed_
                                                     : each.derivative->step(position_));
    }
    speed_ += step_ * force / mass_;
    position_ += step_ * speed_;
  }

 private:
  struct Resistance {
    double coefficient, order;
    std::optional<frac::FractionalDerivative<double>> derivative;
  };
  double step_, mass_ = 0, position_ = 0, speed_ = 0;
  std::vector<Resistance> resistance_;
};

class Controller {
 public:
  Controller(const SteppedLoop& loop, double step, double horizon)
      : gains_(loop.gains), share_(step / (loop.derivative_filter_time + step)) {
    if (gains_.ki != 0) integral_.emplace(-gains_.lambda, step, tolerance, horizon);
    if (gains_.kd != 0) derivative_.emplace(gains_.mu, step, tolerance, horizon);
  }
  [[nodiscard]] double operator()(double error) {
    double force = gains_.kp * error;
    if (integral_) force += gains_.ki * integral_->step(error);
    if (derivative_) {
      filtered_ += share_ * (derivative_->step(error) - filtered_);
      force += gains_.kd * filtered_;
    }
    return force;
  }

 private:
  frac::FractionalPidGains gains_;
  double share_, filtered_ = 0;
  std::optional<frac::FractionalDerivative<double>> integral_, derivative_;
};

bool is_inverse_of_powers(const frac::FractionalTransferFunction& receptance) {
  return receptance.numerator().size() == 1 && receptance.numerator().front().order == 0 &&
         receptance.denominator().front().order == 2;
}

}  // namespace

bool can_be_stepped(const LinearBodies& bodies) {
  return is_inverse_of_powers(bodies.load()) && is_inverse_of_powers(bodies.drive());
}

std::vector<double> step_loop(const SteppedLoop& loop, double speed, double step, std::size_t steps) {
  const TwoMassSystem& system = loop.bodies.system();
  const double wall = system.clearance() / 2;
  const double away = 1e6 * system.clearance();
  const auto horizon = static_cast<double>(steps);
  Body load(loop.bodies.load(), step, horizon), drive(loop.bodies.drive(), step, horizon);
  Controller controller(loop, step, horizon);
  drive.hit(speed * system.mass2());
  std::vector<double> positions;
  positions.reserve(steps);
  for (std::size_t i = 0; i < steps; ++i) {
    positions.push_back((loop.measured == Output::x1 ? load : drive).position());
    if (!(std::abs(positions.back()) < away)) break;
    const double gap = drive.position() - load.position();
    const double closing = drive.speed() - load.speed();
    if ((gap >= wall && closing > 0) || (gap <= -wall && closing < 0)) {
      const double impulse = impulse_per_speed(system) * closing;
      load.hit(impulse);
      drive.hit(-impulse);
    }
    load.push(0);
    drive.push(controller(-positions.back()));
  }
  return positions;
}

}  // namespace backlash::detail
