// SPDX-License-Identifier: BSD-3-Clause
#include "loops/motions/linear_flight.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>

// A mass pushed by two filters in series with the same rate, 1e7 rad/s: a double eigenvalue with one vector.  A flight
// lasts as long as the mass flies, and is p, v and the filters in closed form.  Rates are moved by parts in 1e11, which
// moves x e^-x, x = rate t, by 4e-12; weights of the parted modes, coupling/(1e-11 rate) = 600 at most, bring 600
// roundings.
TEST(LinearFlight, OfRatesThatCoincideLastsAsLongAsTheMotion) {
  constexpr double rate = 1e7, coupling = 0.06;
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(4, 4);
  a(0, 1) = 1;
  a(1, 2) = 1;
  a(2, 2) = a(3, 3) = -rate;
  a(2, 3) = coupling;
  const Eigen::VectorXd start = (Eigen::VectorXd(4) << 0.2, -0.5, 0.7, 0.9).finished();
  const backlash::detail::LinearFlight flight(a, 4, Eigen::VectorXd::Ones(4));
  const backlash::detail::FlightPath path(flight, start);
  EXPECT_GT(path.horizon(), 0.1);
  for (const double t : {1e-8, 1e-7, 3e-7, 1e-5, 0.1}) {
    const double decay = std::exp(-rate * t);
    const double second = start[3] * decay;
    const double first = (start[2] + coupling * t * start[3]) * decay;
    const double gained = -std::expm1(-rate * t) / rate;  // integral of the decay
    const double of_ramp = (gained - t * decay) / rate;   // integral of t times it
    const double v = start[1] + start[2] * gained + coupling * start[3] * of_ramp;
    const double p = start[0] + start[1] * t + start[2] * (t - gained) / rate +
                     coupling * start[3] * (t - gained - (gained - t * decay)) / (rate * rate);
    const Eigen::VectorXd state = path.state(t);
    EXPECT_NEAR(state[0], p, 1e-14) << t;
    EXPECT_NEAR(state[1], v, 1e-14) << t;
    EXPECT_NEAR(state[2], first, 5e-12) << t;
    EXPECT_NEAR(state[3], second, 5e-12) << t;
  }
}
