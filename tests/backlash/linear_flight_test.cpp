// SPDX-License-Identifier: BSD-3-Clause
#include "loops/motions/linear_flight.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <limits>

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

// A mass on a spring, damped by s^(1/2) as a sum of exponentials with rates from .01 to 1e8 of the motion, whose
// rounding in numbers of 53 bits is as large as 1e-8 of the slow motion.  The reference is Taylor's series of 2^-h t
// with h squares in long double, which errs by 2^-62 ||A t|| at most where nothing grows.
TEST(LinearFlight, OfRatesFarAboveTheMotionKeepsTheDigitsOfTheBodies) {
  if (std::numeric_limits<long double>::digits < 64) GTEST_SKIP() << "long double has no more digits than double";
  using Extended = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;
  constexpr Eigen::Index rates = 50, size = 2 + rates;
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(size, size);
  Eigen::VectorXd sizes = Eigen::VectorXd::Ones(size);
  a(0, 1) = 1;
  a(1, 0) = -1;
  for (Eigen::Index i = 0; i < rates; ++i) {
    const double rate = std::pow(10.0, -2 + 10.0 * static_cast<double>(i) / (rates - 1));
    a(2 + i, 2 + i) = -rate;
    a(2 + i, 1) = 1;
    a(1, 2 + i) = -0.15 * std::sqrt(rate);
    sizes[2 + i] = 1 / std::max(rate, 1.0);
  }
  for (const double t : {0.01, 0.5}) {
    const int halvings = static_cast<int>(std::ceil(std::log2(a.norm() * t))) + 2;
    const Extended part = a.cast<long double>() * std::ldexp(static_cast<long double>(t), -halvings);
    const Extended one = Extended::Identity(size, size);
    Extended expected = one;
    for (int j = 20; j > 0; --j) expected = one + part * expected / static_cast<long double>(j);
    for (int i = 0; i < halvings; ++i) expected = (expected * expected).eval();
    const Eigen::MatrixXd found = backlash::detail::LinearFlight(a, 1, sizes).transition(t);
    const double tolerance = std::ldexp(a.norm() * t, -62) + 1e-13;
    for (Eigen::Index i = 0; i < 2; ++i) {
      for (Eigen::Index k = 0; k < 2; ++k)
        EXPECT_NEAR(found(i, k), static_cast<double>(expected(i, k)), tolerance) << t << ' ' << i << ' ' << k;
    }
  }
}
