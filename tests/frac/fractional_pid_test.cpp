// SPDX-License-Identifier: BSD-3-Clause
#include "frac/digital/fractional_pid.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cfenv>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <vector>

#include "frac/model/fractional_transfer_function.hpp"
#include "frac/time_response/reference_response.hpp"
#include "support/expect_invalid_argument.hpp"
#include "support/random.hpp"

namespace {

using frac::AntiWindup;
using frac::Discretisation;
using frac::FractionalPid;
using frac::FractionalPidConfig;
using frac::FractionalPidDesign;
using Complex = std::complex<double>;

constexpr double pi = std::numbers::pi;
constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();

FractionalPidConfig usual(double lambda = 0.8, double mu = 0.6) {
  FractionalPidConfig config;
  config.gains = {.kp = 2, .ki = 3, .kd = 0.05, .lambda = lambda, .mu = mu};
  config.sample_time = 1e-3;
  config.band = {0.1, 300};
  return config;
}

// The textbook controller with the trapezoidal integral and the filtered backward difference.
struct ClassicalPid {
  double kp, ki, kd, time, filter;
  double integral = 0, derivative = 0, last_error = 0;
  double operator()(double error) {
    integral += ki * time / 2 * (error + last_error);
    derivative = filter / (filter + time) * derivative + kd / (filter + time) * (error - last_error);
    last_error = error;
    return kp * error + integral + derivative;
  }
};

TEST(FractionalPid, IsTheClassicalPidAtOrdersOne) {
  FractionalPidConfig config = usual(1, 1);
  config.derivative_filter_time = 0.01;
  config.band = {};
  FractionalPid<double> pid(config);
  ClassicalPid classical{2, 3, 0.05, 1e-3, 0.01};
  support::Random random(1);
  for (int n = 0; n < 10'000; ++n) {
    const double error = random.normal();
    const double expected = classical(error);
    // The recursion of the reference forgets with factor 10/11, so some ten roundings of terms of size kd/Tf stay.
    EXPECT_NEAR(pid.step(error, 0), expected, 1e-13 * (1 + std::abs(expected)));
  }
}

// Response of the running controller at omega: the error is a sine, the output is projected on 1, cos and sin over
// whole periods once the slow modes have died out.
Complex measured_response(FractionalPid<double>& pid, double sample_time, int samples_per_period, int settle,
                          int periods) {
  const double turn = 2 * pi / samples_per_period;
  Complex sum = 0;
  (void)sample_time;
  for (int n = 0; n < settle + periods * samples_per_period; ++n) {
    const double u = pid.step(std::sin(turn * (n % samples_per_period)), 0);
    if (n >= settle) sum += u * std::polar(1.0, -turn * (n % samples_per_period));
  }
  return sum * (2.0 / (periods * samples_per_period)) * Complex(0, 1);
}

TEST(FractionalPid, RunsWithTheResponseOfItsDesign) {
  for (const double lambda : {0.3, 0.9, 1.0, 1.4}) {
    for (const double mu : {0.4, 1.0, 1.5}) {
      FractionalPidConfig config = usual(lambda, mu);
      config.band = {5, 300};
      FractionalPid<double> pid(config);
      const FractionalPidDesign design(config);
      const int period = 200;
      const int settle = 20'000;  // the slowest pole lies near 1/s: e^-20
      const Complex running = measured_response(pid, config.sample_time, period, settle, 10);
      const Complex designed = design.response(2 * pi / (period * config.sample_time));
      EXPECT_LT(std::abs(running / designed - 1.0), 1e-7) << lambda << " " << mu;
    }
  }
}

TEST(FractionalPid, DesignFollowsTheExactOperatorsOnTheBand) {
  for (const double lambda : {0.1, 0.5, 0.9, 1.0, 1.1, 1.9}) {
    for (const double mu : {0.1, 0.5, 0.9}) {
      FractionalPidConfig config = usual(lambda, mu);
      config.goal = frac::Tolerance{2e-4};
      config.derivative_filter_time = 5e-3;
      const FractionalPidDesign design(config);
      EXPECT_EQ(design.note(), "");
      EXPECT_LE(design.integral_error(), 2e-4);
      EXPECT_LE(design.derivative_error(), 2e-4);
      for (const double omega : {0.1, 1.0, 10.0, 60.0, 300.0}) {
        const Complex s(0, omega);
        const Complex integral = 3.0 * std::pow(s, -lambda);
        // The lag is by the backward rule, as documented.
        const Complex lag = 1.0 / (1.0 + 5.0 * (1.0 - std::exp(-s * config.sample_time)));
        const Complex derivative = 0.05 * std::pow(s, mu) * lag;
        // Filters within 2e-4; at lambda = 1 there is none, and the trapezoidal rule is x^2/3 off, x = omega T/2, with
        // 2 x^4/45 to follow.
        const double x = omega * config.sample_time / 2;
        const double trapezoidal = x * x / 3 + 2 * x * x * x * x / 45;
        const double allowed = (lambda == 1 ? trapezoidal : 2e-4) * std::abs(integral) + 2e-4 * std::abs(derivative);
        EXPECT_LT(std::abs(design.response(omega) - (2.0 + integral + derivative)), 1.0001 * allowed + 1e-12)
            << lambda << " " << mu << " " << omega;
      }
    }
  }
}

// The answer of the derivative alone to a step of the set-point: how far it rises again after its peak, over the peak.
double swing_of(const FractionalPidConfig& asked) {
  FractionalPidConfig config = asked;
  config.gains.kp = config.gains.ki = 0;
  FractionalPid<double> pid(config);
  double sum = 0, peak = 0, least = 0, swing = 0;
  for (int n = 0; n < 100; ++n) {
    const double u = pid.step(1, 0);
    sum += u;
    const double answer = config.gains.mu < 1 ? u : sum;  // s^mu of a step falls for mu < 1 only
    if (answer > peak) {
      peak = least = answer;
      swing = 0;
    }
    least = std::min(least, answer);
    swing = std::max(swing, answer - least);
  }
  return swing / peak;
}

TEST(FractionalPid, StepOfTheSetPointDoesNotRingUnlessTheNoteSaysSo) {
  for (const double mu : {0.1, 0.3, 0.5, 0.7, 0.9, 1.2, 1.5, 1.8}) {
    for (const double upper : {60.0, 300.0, 600.0, 1500.0}) {
      for (const double filter_time : {0.0, 1e-3, 1e-2}) {
        FractionalPidConfig config = usual(1, mu);
        config.band = {0.1, upper};
        config.derivative_filter_time = filter_time;
        const FractionalPidDesign design(config);
        const bool is_said = design.note().find("swings") != std::string::npos;
        if (!is_said) {
          EXPECT_LE(swing_of(config), 0.15 + 1e-9) << mu << " " << upper << " " << filter_time;
        }
        // A lag of a sample is enough up to a tenth of the sampling frequency, and costs no accuracy at a twentieth.
        if (filter_time > 0 && upper <= 600) {
          EXPECT_FALSE(is_said) << design.note();
        }
        if (filter_time > 0 && upper <= 300) {
          EXPECT_EQ(design.note(), "");
        }
        // What is asked for and not reached is said.
        EXPECT_EQ(design.derivative_error() > 1e-3, design.note().find("above the tolerance") != std::string::npos);
      }
    }
  }
}

TEST(FractionalPid, MoreSwingBuysAccuracyAtTheEdgeOfTheBand) {
  FractionalPidConfig config = usual(1, 0.9);
  const FractionalPidDesign calm(config);
  config.most_swing = 1;
  const FractionalPidDesign accurate(config);
  EXPECT_EQ(accurate.note(), "");
  EXPECT_LE(accurate.derivative_error(), 1e-3);
  EXPECT_GT(calm.derivative_error(), 1e-3);
  EXPECT_GT(swing_of(accurate.config()), swing_of(calm.config()));
}

// (tan x/x)^lambda at x = pi/4 is the bilinear rule's error there; the direct design is to leave a tenth of it.
TEST(FractionalPid, FractionalIntegralHoldsUpToAQuarterOfTheSamplingFrequency) {
  for (const double lambda : {0.2, 0.6, 0.9, 1.3}) {
    FractionalPidConfig config = usual(lambda, 1);
    config.gains = {.kp = 0, .ki = 1, .kd = 0, .lambda = lambda, .mu = 1};
    config.band = {1, pi / (2 * config.sample_time)};
    const double bilinear = 1 - std::pow(4 / pi, -lambda);
    EXPECT_LT(FractionalPidDesign(config).error(), 0.1 * bilinear);
    config.discretisation = Discretisation::tustin;
    // The sections add their tolerance of 1e-3.
    EXPECT_NEAR(FractionalPidDesign(config).error(), bilinear, 1e-3);
  }
}

TEST(FractionalPid, ErrorVanishesAtRestExactly) {
  for (const double lambda : {0.4, 0.9, 1.3}) {
    FractionalPidConfig config = usual(lambda, 0.5);
    config.band = {5, 300};
    FractionalPid<double> pid(config);
    // Plant y' = u + 0.7 - y by its exact recursion.
    double y = 0;
    const double keep = std::exp(-config.sample_time);
    for (int n = 0; n < 200'000; ++n) y = keep * y + (1 - keep) * (pid.step(2, y) + 0.7);
    // The slowest pole of the filters lies a decade below the band, at 0.5 rad/s, and the slowest of the loop
    // above half of that: 200 s leave e^-50.
    EXPECT_NEAR(y, 2, 1e-12) << lambda;
  }
}

// kp + ki/s^lambda about the plant 1/(s + 1), sampled, against the exact step response of the closed loop
// (kp s^lambda + ki)/(s^(lambda + 1) + (1 + kp) s^lambda + ki).
double loop_error(double lambda, double sample_time) {
  FractionalPidConfig config;
  config.gains = {.kp = 2, .ki = 3, .kd = 0, .lambda = lambda, .mu = 1};
  config.sample_time = sample_time;
  config.band = {1e-3, 200};
  config.goal = frac::Tolerance{1e-6};
  FractionalPid<double> pid(config);
  const std::string l = std::to_string(lambda);
  const auto loop =
      frac::FractionalTransferFunction::parse("(2 s^" + l + " + 3)/(s^(" + l + "+1) + 3 s^" + l + " + 3)");
  const frac::ReferenceResponse exact(loop, {frac::ResponseInput::Kind::step, 0});
  double y = 0, worst = 0;
  const double keep = std::exp(-sample_time);
  const int samples = static_cast<int>(std::lround(8 / sample_time));
  for (int n = 0; n < samples; ++n) {
    y = keep * y + (1 - keep) * pid.step(1, y);
    if ((n + 1) % (samples / 16) == 0) worst = std::max(worst, std::abs(y - exact((n + 1) * sample_time).value));
  }
  return worst;
}

TEST(FractionalPid, ClosedLoopFollowsTheExactFractionalOne) {
  for (const double lambda : {0.5, 0.9, 1.3}) {
    // The control is held for a sample, half a sample late on average, which shifts the path by at most that times its
    // slope, 2 at the start.  First order in T: the filters' 1e-6 are 0.3 % of the smaller error, and the next order
    // adds T times a loop bandwidth of 3 rad/s, 1 % of the larger one.
    const double coarse = loop_error(lambda, 4e-3), fine = loop_error(lambda, 1e-3);
    EXPECT_LT(fine, 1e-3) << lambda;
    EXPECT_NEAR(std::log2(coarse / fine) / 2, 1, 0.02) << lambda;
  }
}

struct Return {
  double below;        // how far the output of the plant falls below the later set-point
  int at_limit_after;  // samples for which the control stays at its limit after the change
};

// A plant of gain 1 and time constant 0.2 s is asked for `first`, then for 0.5; the control is limited to +-1.
// With `fresh` the controller starts anew at the change.
Return back_to_half(AntiWindup method, double lambda, double first, bool fresh = false) {
  FractionalPidConfig config = usual(lambda, 0.5);
  config.minimum = -1;
  config.maximum = 1;
  config.anti_windup = method;
  FractionalPid<double> pid(config);
  double y = 0;
  const double keep = std::exp(-config.sample_time / 0.2);
  const auto run = [&](double setpoint) { return y = keep * y + (1 - keep) * pid.step(setpoint, y); };
  for (int n = 0; n < 100'000; ++n) run(first);
  if (fresh) pid.reset(first, y);
  Return result{0, 0};
  bool left = false;
  for (int n = 0; n < 20'000; ++n) {
    run(0.5);
    if (!left && pid.output() == 1) {
      ++result.at_limit_after;
    } else {
      left = true;
    }
    result.below = std::max(result.below, 0.5 - y);
  }
  return result;
}

TEST(FractionalPid, ComesBackFromLongSaturationWithoutWindup) {
  for (const double lambda : {0.6, 0.9, 1.0, 1.2}) {
    // From 0.99 the control never saturates for long: what the loop does by itself.
    const double natural = back_to_half(AntiWindup::none, lambda, 0.99).below;
    // A controller whose proportional part alone saturates has integrated nothing yet.
    const double uncharged = back_to_half(AntiWindup::none, lambda, 3, true).below;
    const Return without = back_to_half(AntiWindup::none, lambda, 3);
    EXPECT_GT(without.at_limit_after, 10'000) << lambda;
    for (const AntiWindup method : {AntiWindup::back_calculation, AntiWindup::conditional_integration}) {
      const Return result = back_to_half(method, lambda, 3);
      EXPECT_LE(result.at_limit_after, 1) << lambda << " " << to_string(method);
      const double own = method == AntiWindup::back_calculation ? natural : uncharged;
      EXPECT_LT(result.below, own + 0.02) << lambda << " " << to_string(method);
    }
  }
}

TEST(FractionalPid, BackCalculationSolvesItsEquationWithinTheSample) {
  FractionalPidConfig config = usual(1, 1);
  config.gains.kd = 0;
  config.maximum = 1;
  config.tracking_time = 0.02;
  FractionalPid<double> pid(config);
  double integrator = 0, last = 0;
  for (int n = 0; n < 500; ++n) {
    const double error = n < 250 ? 1.5 : -0.5;
    const double u = pid.step(error, 0);
    // I' = ki e + (limit - sum)/Tt by the trapezoidal rule, the sum being that of this sample.
    const double rate = 3 * error + (u - pid.unlimited_output()) / 0.02;
    integrator += 0.5e-3 * (rate + last);
    last = rate;
    EXPECT_NEAR(pid.unlimited_output(), 2 * error + integrator, 1e-12);
    EXPECT_EQ(pid.saturated(), u != pid.unlimited_output());
  }
}

TEST(FractionalPid, RefusesWhatIsNotANumberAndGoesOnAsIfItHadNotBeen) {
  FractionalPid<double> pid(usual());
  FractionalPid<double> undisturbed(usual());
  support::Random random(2);
  double last = 0;
  for (int n = 0; n < 1000; ++n) {
    const double r = random.normal(), y = random.normal();
    last = pid.step(r, y);
    ASSERT_EQ(last, undisturbed.step(r, y));
    ASSERT_FALSE(pid.bad_input());
    for (const double bad : {nan, infinity, -infinity, 1e300}) {
      EXPECT_EQ(pid.step(r, bad), last);
      EXPECT_TRUE(pid.bad_input());
      EXPECT_EQ(pid.step(bad, y), last);
      EXPECT_TRUE(pid.bad_input());
    }
  }
  pid.track(nan);
  EXPECT_TRUE(pid.bad_input());
  EXPECT_NE(pid.step(1, 0), 0);
  EXPECT_TRUE(std::isfinite(pid.output()));
}

TEST(FractionalPid, OutputObeysTheLimitsFromTheFirstRefusedInputOn) {
  FractionalPidConfig config = usual();
  config.minimum = 1;
  config.maximum = 5;
  FractionalPid<double> pid(config);
  EXPECT_EQ(pid.step(0, nan), 1);
  (void)pid.step(100, 0);
  EXPECT_EQ(pid.output(), 5);
  config.maximum = 3;
  pid.adopt(FractionalPidDesign(config));
  EXPECT_EQ(pid.step(nan, 0), 3);
}

TEST(FractionalPid, TakesOverFromManualWithoutABump) {
  FractionalPidConfig config = usual();
  config.maximum = 5;
  config.minimum = -5;
  FractionalPid<double> pid(config);
  double manual = 0;
  for (int n = 0; n < 2000; ++n) {
    manual = 2 * std::sin(1e-3 * n);
    pid.track(manual);
    EXPECT_EQ(pid.step(1, 0.3 * std::cos(2e-3 * n)), manual);
  }
  // The measurement moves by 6e-4 per sample; kp and the derivative answer with some hundredths, not with a jump.
  EXPECT_NEAR(pid.step(1, 0.3 * std::cos(4.0)), manual, 0.05);
  pid.track(7);
  EXPECT_EQ(pid.step(1, 0), 5);
}

TEST(FractionalPid, RetuneGivesWhatRepeatedInputsWouldHaveGiven) {
  for (const double lambda : {0.5, 1.0, 1.3}) {
    for (const double mu : {0.3, 1.0, 1.4}) {
      FractionalPid<double> pid(usual());
      support::Random random(3);
      double r = 0, y = 0;
      for (int n = 0; n < 3000; ++n) {
        r = n < 1000 ? 0 : 1;
        y = std::sin(3e-3 * n) + 0.01 * random.normal();
        (void)pid.step(r, y);
      }
      FractionalPid<double> as_before = pid;
      FractionalPidConfig config = usual(lambda, mu);
      config.gains.kp = 5;
      config.gains.ki = 1;
      config.gains.kd = 0.1;
      config.setpoint_weight = 0.6;
      config.derivative_setpoint_weight = 0;
      config.goal = frac::PoleCount{7};
      pid.adopt(FractionalPidDesign(config));
      const double expected = as_before.step(r, y);
      EXPECT_NEAR(pid.step(r, y), expected, 1e-12 * (1 + std::abs(expected))) << lambda << " " << mu;
    }
  }
}

TEST(FractionalPid, RetuneInMotionCarriesTheHistoryOver) {
  // Orders a little changed on a smooth path: a controller that had run with the new orders all along gives nearly the
  // same increments afterwards; one that forgets would be off by the order of the increment itself.
  const auto path = [](int n) { return std::sin(2e-3 * n); };
  FractionalPid<double> changed(usual(0.70, 0.60));
  FractionalPid<double> always(usual(0.72, 0.62));
  FractionalPid<double> forgets(usual(0.72, 0.62));
  for (int n = 0; n < 5000; ++n) {
    (void)changed.step(0, path(n));
    (void)always.step(0, path(n));
  }
  changed.adopt(FractionalPidDesign(usual(0.72, 0.62)));
  forgets.track(always.output());
  double moved = 0, missed = 0, lost = 0;
  const double before = always.output(), before_changed = changed.output();
  for (int n = 5000; n < 5500; ++n) {
    const double expected = always.step(0, path(n)) - before;
    const double got = changed.step(0, path(n)) - before_changed;
    const double without = forgets.step(0, path(n)) - before;
    moved = std::max(moved, std::abs(expected));
    missed = std::max(missed, std::abs(got - expected));
    lost = std::max(lost, std::abs(without - expected));
  }
  EXPECT_LT(missed, 0.02 * moved);
  EXPECT_GT(lost, 0.1 * moved);
}

// Another ki scales what the integral's filter has taken in, and the integrator takes up the difference: from there on
// the output moves as that of a controller that has had the new gain all along, but for rounding of the states.
TEST(FractionalPid, RetuneOfTheIntegralGainGoesOnAsIfItHadAlwaysBeen) {
  const auto path = [](int n) { return std::sin(2e-3 * n); };
  FractionalPidConfig stronger = usual(0.7, 0.6);
  stronger.gains.ki *= 2;
  FractionalPid<double> changed(usual(0.7, 0.6)), always(stronger);
  for (int n = 0; n < 3000; ++n) {
    (void)changed.step(0, path(n));
    (void)always.step(0, path(n));
  }
  changed.adopt(FractionalPidDesign(stronger));
  // The sample after the change still rises by the old gain where the inputs repeat.
  const double before = always.step(0, path(3000)), before_changed = changed.step(0, path(3000));
  double moved = 0, missed = 0;
  for (int n = 3001; n < 3500; ++n) {
    const double expected = always.step(0, path(n)) - before;
    moved = std::max(moved, std::abs(expected));
    missed = std::max(missed, std::abs(changed.step(0, path(n)) - before_changed - expected));
  }
  EXPECT_LT(missed, 1e-10 * moved);
}

TEST(FractionalPid, TracksWithinTheSampleAtLeast) {
  FractionalPidConfig config = usual(1, 1);
  config.tracking_time = 1e-6;
  EXPECT_EQ(FractionalPidDesign(config).tracking_time(), config.sample_time);
  config.tracking_time = 0;
  config.gains = {.kp = 2, .ki = 3, .kd = 0, .lambda = 0.8, .mu = 1};
  EXPECT_NEAR(FractionalPidDesign(config).tracking_time(), std::pow(2.0 / 3, 1 / 0.8), 1e-15);
  // Without kp the times in which the other two terms are equal, or ten samples.
  config.gains = {.kp = 0, .ki = 3, .kd = 2, .lambda = 0.8, .mu = 0.7};
  EXPECT_NEAR(FractionalPidDesign(config).tracking_time(), std::pow(2.0 / 3, 1 / 1.5), 1e-15);
  config.gains.kd = 0;
  EXPECT_EQ(FractionalPidDesign(config).tracking_time(), 10 * config.sample_time);
}

TEST(FractionalPid, RetuneInEverySituationKeepsTheOutputFinite) {
  support::Random random(11);
  FractionalPidConfig config = usual();
  config.minimum = -4;
  config.maximum = 3;
  FractionalPid<float> pid(config);
  for (int change = 0; change < 60; ++change) {
    config.gains.lambda = change % 4 == 0 ? 1 : random.uniform(0.05, 1.95);
    config.gains.mu = change % 5 == 0 ? 1 : random.uniform(0.05, 1.95);
    config.gains.ki = change % 7 == 0 ? 0 : random.uniform(0.1, 5);
    config.gains.kd = change % 6 == 0 ? 0 : random.uniform(0.001, 0.05);
    config.sample_time = change % 3 == 0 ? 1e-3 : 2e-3;
    config.derivative_filter_time = change % 2 == 0 ? 0 : 0.02;
    config.anti_windup = change % 2 == 0 ? AntiWindup::back_calculation : AntiWindup::conditional_integration;
    pid.adopt(FractionalPidDesign(config));
    if (change % 9 == 0) pid.track(1);
    for (int n = 0; n < 200; ++n) {
      const auto y = static_cast<float>(random.normal());
      const float u = pid.step(change % 2 == 0 ? 1.0F : 50.0F, y);
      ASSERT_TRUE(u >= -4 && u <= 3) << change << " " << n;
      ASSERT_FALSE(pid.bad_input()) << change << " " << n;
    }
  }
}

TEST(FractionalPid, ResetAtASignalStartsWithoutAKick) {
  FractionalPidConfig config = usual(0.9, 1);
  config.derivative_setpoint_weight = 0;
  FractionalPid<double> pid(config);
  (void)pid.step(1, 20);
  pid.reset(20, 20);
  EXPECT_EQ(pid.step(20, 20), 0);
  pid.reset();
  // The difference of 20 within 1 ms.
  EXPECT_NEAR(pid.step(20, 20), -0.05 * 20 / 1e-3, 1e-9);
}

// A sum of 10^7 equal increments in float, added plainly, stops growing at 2^24 increments' worth of digits.
TEST(FractionalPid, IntegralDoesNotDriftInFloat) {
  FractionalPidConfig config = usual(1, 1);
  config.gains = {.kp = 0, .ki = 1, .kd = 0, .lambda = 1, .mu = 1};
  FractionalPid<float> pid(config);
  const int samples = 5'000'000;
  for (int n = 0; n < samples; ++n) (void)pid.step(0.1F, 0);
  const double exact = (samples - 0.5) * static_cast<double>(0.1F) * static_cast<double>(1e-3F);
  EXPECT_NEAR(pid.output() / exact, 1, 4 * 6e-8);
}

TEST(FractionalPid, FloatFollowsDouble) {
  FractionalPidConfig config = usual(0.7, 0.5);
  config.minimum = -20;
  config.maximum = 20;
  FractionalPid<double> wide(config);
  FractionalPid<float> narrow(config);
  support::Random random(5);
  double worst = 0;
  for (int n = 0; n < 100'000; ++n) {
    const auto r = static_cast<float>(n / 5000 % 2);
    const auto y = static_cast<float>(0.5 * std::sin(1e-3 * n) + 0.01 * random.normal());
    worst = std::max(worst, std::abs(wide.step(r, y) - static_cast<double>(narrow.step(r, y))));
  }
  // Rates and weights are rounded to 6e-8, some twenty of them, on outputs of up to 20.
  EXPECT_LT(worst, 20 * 1e-5);
}

TEST(FractionalPid, StatesThatDieOutAreFlushed) {
  FractionalPidConfig config = usual(0.7, 0.5);
  config.derivative_filter_time = 0.01;
  config.band = {50, 300};
  FractionalPid<float> pid(config);
  (void)pid.step(1, 0);
  for (int n = 0; n < 20'000; ++n) (void)pid.step(0, 0);
  std::feclearexcept(FE_ALL_EXCEPT);
  for (int n = 0; n < 20'000; ++n) (void)pid.step(0, 0);
  EXPECT_EQ(std::fetestexcept(FE_UNDERFLOW), 0);
}

TEST(FractionalPid, BandMeetingNyquistIsCutWithAStatementOrRefused) {
  FractionalPidConfig config = usual();
  config.band = {0.1, 1e6};
  const FractionalPidDesign design(config);
  EXPECT_NE(design.note().find("cut from 1e+06 to 1.57e+03 rad/s"), std::string::npos) << design.note();
  EXPECT_NEAR(design.config().band.upper, pi / (2 * 1e-3), 1e-9);
  config.band = {1500, 1e6};
  EXPECT_NE(frac::validate(config).find("begins where sample time 0.001 s ends"), std::string::npos)
      << frac::validate(config);
}

TEST(FractionalPid, SaysWhatIsWrongWithAConfiguration) {
  const auto expect_refusal = [](auto change, const std::string& part) {
    FractionalPidConfig config = usual();
    change(config);
    const std::string why = frac::validate(config);
    EXPECT_NE(why.find(part), std::string::npos) << why;
    std::string same;
    EXPECT_FALSE(FractionalPid<double>::try_make(config, same));
    EXPECT_EQ(same, why);
    support::expect_invalid_argument([&] { FractionalPid<float> pid(config); }, {part});
  };
  expect_refusal([](auto& c) { c.gains.kp = nan; }, "kp = nan");
  expect_refusal([](auto& c) { c.gains.ki = infinity; }, "ki = inf");
  expect_refusal([](auto& c) { c.gains.lambda = 0; }, "lambda = 0; allowed is 0.001 to 1.999");
  // Told from a gain or a double integrator by no device.
  expect_refusal([](auto& c) { c.gains.lambda = 1e-300; }, "lambda = 1e-300; allowed is 0.001 to 1.999");
  expect_refusal([](auto& c) { c.gains.mu = 2 - 1e-12; }, "allowed is 0.001 to 1.999");
  expect_refusal([](auto& c) { c.gains.mu = 2; }, "mu = 2");
  expect_refusal([](auto& c) { c.sample_time = 0; }, "sample_time = 0 s");
  expect_refusal([](auto& c) { c.band = {}; }, "band = 0 to 0 rad/s");
  expect_refusal([](auto& c) { c.band = {3, 1}; }, "band = 3 to 1 rad/s");
  expect_refusal([](auto& c) { c.minimum = c.maximum = 1; }, "limits = 1 to 1");
  expect_refusal([](auto& c) { c.maximum = nan; }, "limits");
  expect_refusal([](auto& c) { c.tracking_time = -1; }, "tracking_time = -1 s");
  expect_refusal([](auto& c) { c.derivative_filter_time = nan; }, "derivative_filter_time = nan s");
  expect_refusal([](auto& c) { c.most_swing = -1; }, "most_swing = -1; allowed is 0 to 10");
  expect_refusal([](auto& c) { c.setpoint_weight = infinity; }, "setpoint_weight = inf");
  expect_refusal([](auto& c) { c.goal = frac::Tolerance{2}; }, "tolerance");
  expect_refusal([](auto& c) { c.goal = frac::PoleCount{0}; }, "poles = 0");
  expect_refusal([](auto& c) { c.goal = frac::PoleCount{100}; }, "sections are needed; allowed are up to 64");
  expect_refusal([](auto& c) { c.discretisation = Discretisation::grunwald_letnikov; }, "grunwald-letnikov");
  EXPECT_EQ(frac::validate(usual()), "");
  std::string why;
  EXPECT_TRUE(FractionalPid<double>::try_make(usual(), why));
}

TEST(FractionalPid, AntiWindupNamesReadBack) {
  for (const auto method : {AntiWindup::none, AntiWindup::back_calculation, AntiWindup::conditional_integration})
    EXPECT_EQ(frac::anti_windup_from_string(to_string(method)), method);
  support::expect_invalid_argument([] { (void)frac::anti_windup_from_string("clamp"); }, {"clamp", "back-calculation"});
}

}  // namespace
