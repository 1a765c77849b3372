// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <complex>
#include <vector>

#include "frac/identification/tune.hpp"
#include "frac/time_response/respond.hpp"

namespace frac::detail {

/// ln|s| derivative of ln G at s = j omega: its imaginary part is d arg G/d ln omega.
[[nodiscard]] std::complex<double> log_slope(const FractionalTransferFunction& model, double omega);

/// What the three terms of a controller, for unit gains, and their derivatives by ln s are at s = j omega.
struct ControllerTerms {
  std::complex<double> value[3];  // 1, s^-lambda, s^mu/(1 + filter_time s)
  std::complex<double> slope[3];
};
[[nodiscard]] ControllerTerms controller_terms(double lambda, double mu, double filter_time, double omega);

/// The plant on a grid about a frequency, for thousands of controllers.  Around undamped poles the grid leaves the axis
/// to the right, so that they are not among the poles that the turns of 1 + L count.
class LoopGrid {
 public:
  /// @param bounds  frequencies that must be on the grid.
  LoopGrid(const FractionalTransferFunction& plant, double centre, const std::vector<double>& bounds);

  struct Peaks {
    double sensitivity;
    double complementary_sensitivity;
    double high_frequency;  // largest |T| from `high` on
    double low_frequency;   // largest |S| up to `low`
    double unstable_poles;  // of the closed loop, from the turns of 1 + L; whole up to what the grid misses
  };
  [[nodiscard]] Peaks peaks(const FractionalPidGains& gains, double filter_time, double high, double low) const;
  /// |G| at high frequency where the plant keeps a gain there, else 0.
  [[nodiscard]] double gain_at_infinity() const { return order_at_infinity_ == 0 ? std::abs(gain_at_infinity_) : 0; }

 private:
  struct Point {
    double omega;  // |s|, rad/s
    double angle;  // arg s, rad; pi/2 on the axis
    std::complex<double> value{};
  };
  void go_around(double pole);

  const FractionalTransferFunction& plant_;
  std::vector<Point> points_;  // in the order in which they are passed
  double order_at_origin_;
  double order_at_infinity_;
  double gain_at_origin_;  // leading coefficients
  double gain_at_infinity_;
  int unstable_plant_poles_ = 0;
};

/// Integrals of |e| and t |e| up to the horizon for a unit step, by sampling the loop at `samples` instants: first
/// order accurate in the step.  Infinite where the output runs away.
struct ErrorIntegrals {
  double iae;
  double itae;
};
class LoopSimulation {
 public:
  LoopSimulation(const FractionalTransferFunction& plant, double horizon, bool load_step, int samples);
  [[nodiscard]] ErrorIntegrals operator()(const FractionalPidGains& gains, double filter_time);

 private:
  double step_;
  bool load_step_;
  int samples_;
  ResponseFilter filter_;
};

}  // namespace frac::detail
