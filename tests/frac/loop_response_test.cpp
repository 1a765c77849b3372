// SPDX-License-Identifier: BSD-3-Clause
#include "frac/time_response/loop_response.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <boost/math/special_functions/gamma.hpp>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "frac/mittag_leffler.hpp"
#include "frac/model/algebra.hpp"
#include "frac/stability.hpp"
#include "support/expect_invalid_argument.hpp"
#include "support/random.hpp"

namespace {

using frac::FractionalTransferFunction;
using frac::Hold;
using frac::LoopResponse;
using frac::ResponseInput;
using frac::SampledInput;
using frac::TimeInput;
using support::expect_invalid_argument;
using Kind = ResponseInput::Kind;

FractionalTransferFunction model(const std::string& formula) {
  return FractionalTransferFunction::parse(formula);
}

std::vector<double> even_times(double end, std::size_t steps) {
  std::vector<double> time;
  for (std::size_t n = 0; n <= steps; ++n) time.push_back(end * static_cast<double>(n) / static_cast<double>(steps));
  return time;
}

double largest(const std::vector<double>& values) {
  double size = 0;
  for (const double value : values) size = std::max(size, std::abs(value));
  return size;
}

LoopResponse step_of(const FractionalTransferFunction& loop, const std::vector<double>& time) {
  return frac::respond_closed_loop(loop, loop, ResponseInput{}, time);
}

// Every value within the stated error, which keeps the tolerance of 1e-9.  `own` is the error of what is compared with.
template <typename Exact>
void expect_exact(const LoopResponse& response, const std::vector<double>& time, const Exact& exact, double own) {
  EXPECT_TRUE(response.meets_tolerance) << response.summary();
  EXPECT_LE(response.error_estimate, 1e-9 * largest(response.output));
  for (std::size_t i = 0; i < time.size(); ++i) {
    EXPECT_NEAR(response.output[i], exact(time[i]), response.error_estimate + own)
        << "t = " << time[i] << " s, " << response.summary();
  }
}

// The sum over the passages (-1)^k p(k, t - (k + 1) delay), with its largest term.
struct Series {
  double value, largest;
};
template <typename Passage>
Series alternating(double t, double delay, const Passage& passage) {
  long double sum = 0, most = 0;
  for (int k = 0; t - (k + 1) * delay > 0; ++k) {
    const long double term = passage(k, t - (k + 1) * delay);
    sum += k % 2 == 0 ? term : -term;
    most = std::max(most, std::abs(term));
  }
  return {static_cast<double>(sum), static_cast<double>(most)};
}

// y' = gain (1 - y(t - delay)): polynomials (gain t)^(k+1)/(k+1)! from (k + 1) delay on.
double integrator(double gain, double delay, double t) {
  return alternating(t, delay,
                     [gain](int k, long double since) {
                       long double power = 1;
                       for (int i = 1; i <= k + 1; ++i) power *= gain * since / i;
                       return power;
                     })
      .value;
}

}  // namespace

// gain delay = 0.1 creeps, 1/e is critically damped, 1.5 rings, pi/2 is marginal, 2.5 grows.
TEST(LoopResponse, OfAnIntegratorIsItsPolynomials) {
  for (const double gain_delay : {0.1, std::exp(-1.0), 1.0, 1.5, 0.5 * std::numbers::pi, 2.5}) {
    const double delay = 0.7;
    const double gain = gain_delay / delay;
    const FractionalTransferFunction loop({{gain, 0}}, {{1, 1}}, delay);
    const std::vector<double> time = even_times(16 / gain_delay * delay, 40);
    // The largest polynomial stays below e^(gain t) = e^16, so that long double leaves 1e-12.
    expect_exact(
        step_of(loop, time), time, [&](double t) { return integrator(gain, delay, t); }, 1e-12);
  }
}

// K^(k+1)/(tau s + 1)^(k+1)/s is K^(k+1) P(k + 1, t/tau), P the incomplete gamma ratio.
TEST(LoopResponse, OfALagIsASumOfIncompleteGammaRatios) {
  for (const double gain : {0.4, 1.3, 2.2}) {
    const double delay = 0.5, lag = 1.7;
    const FractionalTransferFunction loop({{gain, 0}}, {{lag, 1}, {1, 0}}, delay);
    const std::vector<double> time = even_times(12, 60);
    const auto exact = [&](double t) {
      return alternating(t, delay,
                         [&](int k, long double since) {
                           return std::pow(static_cast<long double>(gain), k + 1) *
                                  boost::math::gamma_p(static_cast<long double>(k + 1), since / lag);
                         })
          .value;
    };
    expect_exact(step_of(loop, time), time, exact, 1e-13);
  }
}

// K^(k+1)/(s^a + 1)^(k+1)/s is K^(k+1) t^(a (k+1)) E^(k+1)_{a, a (k+1) + 1}(-t^a), the function of Prabhakar.
TEST(LoopResponse, OfAFractionalLagIsASumOfPrabhakarFunctions) {
  for (const double order : {0.3, 0.5, 0.8, 1.2}) {
    for (const double gain : {0.5, 1.4}) {
      const double delay = 0.6;
      const FractionalTransferFunction loop({{gain, 0}}, {{1, order}, {1, 0}}, delay);
      // Eight passages at most: beyond, the indices leave the range of the function's bound.
      const std::vector<double> time{0.1, 0.59, 0.7, 1.3, 2.0, 3.1, 4.1, 4.7};
      const auto exact = [&](double t) {
        return alternating(t, delay,
                           [&](int k, long double since) {
                             const double tau = static_cast<double>(since);
                             return std::pow(gain * std::pow(tau, order), k + 1) *
                                    frac::prabhakar(order, order * (k + 1) + 1, k + 1, -std::pow(tau, order));
                           })
            .value;
      };
      // Each function errs by 1e-12 (1 + |E|); the factors (1.4 4.1^1.2)^8 of the late ones meet small E.
      expect_exact(step_of(loop, time), time, exact, 3e-10);
    }
  }
}

// A gain alone: 1 passes as a staircase of partial sums of a geometric series, the neutral loop's jumps never smooth.
TEST(LoopResponse, OfAGainIsAStaircase) {
  for (const double gain : {0.5, 1.0, 1.5}) {
    const FractionalTransferFunction loop({{gain, 0}}, {{1, 0}}, 2.0);
    std::vector<double> time;
    std::vector<double> expected;
    double partial = 0;
    for (int k = 0; k < 25; ++k) {
      time.push_back(2.0 * k + 1);
      expected.push_back(partial);
      partial += std::pow(-gain, k) * gain;
    }
    const LoopResponse response = step_of(loop, time);
    for (std::size_t i = 0; i < time.size(); ++i) {
      EXPECT_NEAR(response.output[i], expected[i], 1e-12 * std::pow(std::max(1.0, gain), 25)) << time[i];
    }
  }
}

// y'' + 2 y' + y = u(t - delay) under a PI controller, integrated by the method of steps with Runge and Kutta's rule of
// fourth order: the delayed error is kept with its slope and interpolated cubically, of the same order, and two steps
// extrapolated to the fifth.  Both input of the reference and of a disturbance.
TEST(LoopResponse, OfAnIntegerLoopIsItsMethodOfSteps) {
  const double delay = 0.8, kp = 0.9, ki = 0.5;
  for (const bool is_disturbance : {false, true}) {
    const auto integrate = [&](int per_delay, double end) {
      const double h = delay / per_delay;
      const int steps = static_cast<int>(std::lround(end / h));
      // State: y, y', integral of the error.  The controller's output at t is used at t + delay.
      std::vector<double> control, control_slope;
      double y = 0, v = 0, integral = 0;
      const auto u_at = [&](int n, double share) {
        const int m = n - per_delay;
        if (m < 0) return 0.0;
        const auto i = static_cast<std::size_t>(m);
        if (share == 0) return control[i];
        if (share == 1 && i + 1 < control.size()) return control[i + 1];
        const double a = control[i], b = control[i + 1];
        return 0.5 * (a + b) + 0.125 * h * (control_slope[i] - control_slope[i + 1]);
      };
      for (int n = 0; n < steps; ++n) {
        const double load = is_disturbance ? 1 : 0, reference = is_disturbance ? 0 : 1;
        control.push_back(kp * (reference - y) + ki * integral);
        control_slope.push_back(-kp * v + ki * (reference - y));
        const auto slope = [&](double share, double y0, double v0) {
          // The load passes the dead time too.
          const double late = n >= per_delay ? load : 0;
          return std::array<double, 3>{v0, u_at(n, share) + late - 2 * v0 - y0, reference - y0};
        };
        const auto a = slope(0, y, v);
        const auto b = slope(0.5, y + 0.5 * h * a[0], v + 0.5 * h * a[1]);
        const auto c = slope(0.5, y + 0.5 * h * b[0], v + 0.5 * h * b[1]);
        const auto d = slope(1, y + h * c[0], v + h * c[1]);
        y += h / 6 * (a[0] + 2 * b[0] + 2 * c[0] + d[0]);
        v += h / 6 * (a[1] + 2 * b[1] + 2 * c[1] + d[1]);
        integral += h / 6 * (a[2] + 2 * b[2] + 2 * c[2] + d[2]);
      }
      return y;
    };
    const double end = 24 * delay;
    const double coarse = integrate(100, end), fine = integrate(200, end);
    const double exact = fine + (fine - coarse) / 15;
    const auto plant = model("exp(-0.8 s)/(s^2 + 2 s + 1)");
    const auto loop = plant * model("0.9 + 0.5/s");
    const LoopResponse response = frac::respond_closed_loop(is_disturbance ? plant : loop, loop, ResponseInput{},
                                                            std::vector<double>{delay, 3 * delay, end});
    EXPECT_NEAR(response.output[2], exact, response.error_estimate + std::abs(fine - coarse));
    EXPECT_LT(std::abs(fine - coarse), 1e-8);
    EXPECT_TRUE(response.meets_tolerance) << response.summary();
  }
}

// Gruenwald-Letnikov differences of T D^a y + y = K u(t - L), u = kp (1 - y) + ki D^-l (1 - y) at steps that divide the
// dead time.  The first-order error, extrapolated twice, leaves the next powers of the step.
TEST(LoopResponse, OfAFractionalPiLoopIsTheLimitOfGruenwaldAndLetnikov) {
  const double lag = 4, order = 0.9, gain = 1.5, delay = 1, kp = 1, ki = 0.4, lambda = 0.8, end = 12;
  const auto by_differences = [&](int per_delay) {
    const double h = delay / per_delay;
    const auto steps = static_cast<std::size_t>(std::lround(end / h));
    const auto weights = [&](double power) {
      std::vector<double> w{1};
      for (std::size_t j = 1; j <= steps; ++j) w.push_back(w.back() * (1 - (power + 1) / static_cast<double>(j)));
      return w;
    };
    const std::vector<double> of_output = weights(order), of_integral = weights(-lambda);
    std::vector<double> y(steps + 1, 0.0), u(steps + 1, 0.0);
    for (std::size_t n = 0; n <= steps; ++n) {
      const auto wait = static_cast<std::size_t>(per_delay);
      if (n > 0) {
        double past = 0;
        for (std::size_t j = 1; j <= n; ++j) past += of_output[j] * y[n - j];
        const double factor = lag * std::pow(h, -order);
        y[n] = (gain * (n >= wait ? u[n - wait] : 0) - factor * past) / (factor + 1);
      }
      double sum = 0;
      for (std::size_t j = 0; j <= n; ++j) sum += of_integral[j] * (1 - y[n - j]);
      u[n] = kp * (1 - y[n]) + ki * std::pow(h, lambda) * sum;
    }
    return y[steps];
  };
  const double a = by_differences(100), b = by_differences(200), c = by_differences(400);
  const double once = 2 * b - a, twice = 2 * c - b;
  const auto loop = model("exp(-1 s) (1 + 0.4/s^0.8)*1.5/(4 s^0.9 + 1)");
  const LoopResponse response = step_of(loop, {end});
  EXPECT_TRUE(response.meets_tolerance) << response.summary();
  // The extrapolations tend to the limit at least as the first order: the last is off by no more than its change.
  EXPECT_NEAR(response.output[0], twice, std::abs(twice - once) + response.error_estimate);
  EXPECT_LT(std::abs(twice - once), 1e-5);
}

// A held input is a sum of steps at its samples, a straight one of ramps at its corners.
TEST(LoopResponse, ToSamplesIsTheSumOfItsStepsAndRamps) {
  const auto loop = model("exp(-0.4 s)*0.8/(s^0.7 (0.5 s + 1))");
  support::Random random(20);
  for (const Hold hold : {Hold::zero_order, Hold::first_order}) {
    SampledInput input{{}, {}, hold};
    double t = -1;
    for (int n = 0; n < 12; ++n) {
      input.time.push_back(t);
      input.value.push_back(random.uniform(-1, 1));
      t += random.uniform(0.1, 0.9);
    }
    std::vector<double> time;
    for (int n = 0; n < 30; ++n) time.push_back(-1 + 0.37 * n);
    const LoopResponse response = frac::respond_closed_loop(loop, loop, input, time);
    EXPECT_TRUE(response.meets_tolerance) << response.summary();
    std::vector<double> expected(time.size(), 0.0);
    const auto add = [&](Kind kind, double since, double factor) {
      std::vector<double> lags;
      for (const double each : time)
        if (each >= since) lags.push_back(each - since);
      if (lags.empty()) return;
      const LoopResponse part = frac::respond_closed_loop(loop, loop, ResponseInput{kind, 0}, lags, 1e-11);
      for (std::size_t i = 0; i < lags.size(); ++i) expected[time.size() - lags.size() + i] += factor * part.output[i];
    };
    double before = 0, slope = 0;
    for (std::size_t n = 0; n < input.time.size(); ++n) {
      if (hold == Hold::zero_order || n == 0) add(Kind::step, input.time[n], input.value[n] - before);
      if (hold == Hold::first_order) {
        const double next =
            n + 1 < input.time.size() ? (input.value[n + 1] - input.value[n]) / (input.time[n + 1] - input.time[n]) : 0;
        add(Kind::ramp, input.time[n], next - slope);
        slope = next;
      }
      before = input.value[n];
    }
    // Some 24 parts of about 1 to 5, each to 1e-11 of its largest.
    for (std::size_t i = 0; i < time.size(); ++i)
      EXPECT_NEAR(response.output[i], expected[i], response.error_estimate + 1e-9) << time[i];
  }
}

TEST(LoopResponse, WithoutDeadTimeIsThatOfTheRatio) {
  const auto forward = model("2/(s^0.8 + 1)"), loop = model("(1 + 0.5/s)*2/(s^0.8 + 1)");
  const std::vector<double> time = even_times(10, 20);
  const LoopResponse response = frac::respond_closed_loop(forward, loop, ResponseInput{}, time);
  const auto expected = frac::respond(frac::feedback(forward, model("1 + 0.5/s")), ResponseInput{}, time);
  for (std::size_t i = 0; i < time.size(); ++i) {
    EXPECT_NEAR(response.output[i], expected.output[i], response.error_estimate + expected.error_estimate);
  }
}

// Of random loops, stable or not, under every input: the stated error is never exceeded, and the tolerance of 1e-9 is
// kept.  The truth is the sum over all passages, each by the reference; it is taken where its terms are no larger than
// 1e3 times the sum, so that their rounding stays below 1e-11 of it.
TEST(LoopResponse, KeepsTheStatedErrorOnRandomLoops) {
  support::Random random(6);
  int judged = 0;
  for (int draw = 0; draw < 40; ++draw) {
    const double delay = random.log_uniform(0.1, 3);
    const double order = random.uniform(0.4, 1.4), lambda = random.uniform(0.4, 1.2);
    const FractionalTransferFunction plant({{1, 0}}, {{random.log_uniform(0.3, 5), order}, {1, 0}}, delay);
    const FractionalTransferFunction controller({{random.log_uniform(0.2, 2), lambda}, {random.log_uniform(0.1, 1), 0}},
                                                {{1, lambda}});
    const auto loop = controller * plant;
    const Kind kind = std::array{Kind::step, Kind::impulse, Kind::ramp, Kind::sine}[random.below(4)];
    const ResponseInput input{kind, kind == Kind::sine ? random.log_uniform(0.1, 3) : 0};
    std::vector<double> time;
    for (int i = 1; i <= 5; ++i) time.push_back(delay * (0.9 + 2 * i));
    const auto forward = random.below(2) == 0 ? loop : plant;
    const LoopResponse response = frac::respond_closed_loop(forward, loop, input, time);
    std::vector<double> exact(time.size(), 0.0);
    double most = 0, own = 0;
    FractionalTransferFunction passage = forward;
    for (int k = 0; k <= 10; ++k) {
      const std::vector<frac::ReferenceValue> part = frac::reference_response(passage, input, time);
      for (std::size_t i = 0; i < time.size(); ++i) {
        exact[i] += part[i].value;
        most = std::max(most, std::abs(part[i].value));
        own = std::max(own, 11 * part[i].error_estimate);
      }
      passage = passage * -loop;
    }
    if (most > 1e3 * largest(exact)) continue;
    ++judged;
    EXPECT_TRUE(response.meets_tolerance) << loop.formula() << ": " << response.summary();
    for (std::size_t i = 0; i < time.size(); ++i) {
      EXPECT_NEAR(response.output[i], exact[i], response.error_estimate + own) << loop.formula() << " at " << time[i];
    }
  }
  EXPECT_GE(judged, 20);
}

TEST(LoopResponse, RefusesWhatHasNoResponse) {
  const std::vector<double> time{1, 2};
  expect_invalid_argument([&] { (void)step_of(model("exp(-0.1 s)*s^0.5"), time); }, {"omega^0.5", "dead time"});
  expect_invalid_argument(
      [&] { (void)frac::respond_closed_loop(model("1"), model("exp(-s)/s"), ResponseInput{}, time, 1); },
      {"tolerance = 1", "0.1"});
  expect_invalid_argument([&] { (void)step_of(model("exp(-s)/s"), {2, 1}); }, {"time[1]"});
  EXPECT_THROW((void)step_of(model("exp(-0.001 s)*0.5"), time), std::domain_error);
}
