// SPDX-License-Identifier: BSD-3-Clause
#include "frac/time_response/reference_response.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "frac/mittag_leffler.hpp"
#include "support/expect_invalid_argument.hpp"
#include "support/relative_error.hpp"
#include "support/step_systems.hpp"

namespace {

using frac::FractionalTransferFunction;
using frac::ReferenceResponse;
using frac::ResponseInput;
using frac::ResponseStatus;
using support::expect_invalid_argument;
constexpr ResponseInput step{ResponseInput::Kind::step};
constexpr ResponseInput impulse{ResponseInput::Kind::impulse};
constexpr ResponseInput ramp{ResponseInput::Kind::ramp};

}  // namespace

TEST(ReferenceResponse, AgreesWithTheTable) {
  const auto systems = support::step_systems();
  const auto values = support::step_values();
  ASSERT_EQ(values.size(), 105u);
  for (const auto& [system, t, y] : values) {
    const frac::ReferenceValue value = ReferenceResponse(systems.at(system).model)(t);
    EXPECT_EQ(value.status, ResponseStatus::exact) << system << " " << t;
    EXPECT_NEAR(value.value / y, 1, 1e-12) << system << " " << t;
    EXPECT_LE(value.error_estimate, 1e-12 * std::abs(y)) << system << " " << t;
  }
}

// 15 digits are known.
TEST(ReferenceResponse, OfTheFurnace) {
  const ReferenceResponse response(FractionalTransferFunction::parse("1/(0.8 s^2.2 + 0.5 s^0.9 + 1)"));
  EXPECT_NEAR(response(1).value, 0.423976252450147, 1e-15);
  EXPECT_NEAR(response(5).value, 0.585082992742685, 1e-15);
  EXPECT_NEAR(response(20).value, 0.991079096205464, 1e-15);
  EXPECT_NEAR(response(30).value, 1.014164778110849, 2e-15);
}

// 1/(s^a - c) answers t^k with k! t^(a+k) E_{a,a+k+1}(c t^a); the impulse is k = -1.
TEST(ReferenceResponse, OfTwoTermsIsAMittagLefflerFunction) {
  struct Case {
    double order, pole;
  };
  for (const auto& [a, c] :
       {Case{0.3, -1}, {0.5, -2}, {0.9, -1}, {0.99, -1}, {1.3, -1}, {1.9, -1}, {1.2, 2}, {0.5, 1}}) {
    const FractionalTransferFunction model({{1, 0}}, {{1, a}, {-c, 0}});
    for (const ResponseInput input : {impulse, step, ramp}) {
      const double k = input.kind == impulse.kind ? -1 : (input.kind == step.kind ? 0 : 1);
      const ReferenceResponse response(model, input);
      for (double t = 1e-9; t < 30; t *= 3.7) {
        const double z = c * std::pow(t, a);
        const double exact = std::pow(t, a + k) * frac::mittag_leffler(a, a + k + 1, z);
        const double conditioned =
            1e-14 * (1 + std::abs(z / exact * std::pow(t, a + k) * frac::mittag_leffler_derivative(a, a + k + 1, z)));
        const frac::ReferenceValue value = response(t);
        EXPECT_EQ(value.status, ResponseStatus::exact) << a << " " << c << " " << k << " " << t;
        EXPECT_LE(std::abs(value.value - exact), 3e-14 * std::pow(t, a + k) + 3 * conditioned * std::abs(exact))
            << a << " " << c << " " << k << " " << t;
      }
    }
  }
}

TEST(ReferenceResponse, OfIntegerOrdersIsClassical) {
  struct Case {
    const char* model;
    ResponseInput input;
    std::function<double(double)> exact;
  };
  const ResponseInput sine{ResponseInput::Kind::sine, 1};
  const Case cases[] = {
      {"1/(s + 1)", step, [](double t) { return -std::expm1(-t); }},
      {"1/(s + 1)", impulse, [](double t) { return std::exp(-t); }},
      {"1/(s + 1)", ramp, [](double t) { return t + std::expm1(-t); }},
      {"1/(s + 1)", sine, [](double t) { return (std::exp(-t) - std::cos(t) + std::sin(t)) / 2; }},
      {"1/(s^2 + 2 s + 1)", impulse, [](double t) { return t * std::exp(-t); }},
      {"1/(s^2 + 2 s + 1)", step, [](double t) { return 1 - (1 + t) * std::exp(-t); }},
      {"1/(s^3 + 3 s^2 + 3 s + 1)", impulse, [](double t) { return t * t / 2 * std::exp(-t); }},
      {"1/(s^2 + 1)", step, [](double t) { return 1 - std::cos(t); }},
      {"1/(s^2 + 1)", sine, [](double t) { return (std::sin(t) - t * std::cos(t)) / 2; }},
      {"1/(s - 1)", impulse, [](double t) { return std::exp(t); }},
      {"1/s", step, [](double t) { return t; }},
      {"1/s^2.5", step, [](double t) { return std::pow(t, 2.5) / std::tgamma(3.5); }},
      {"s^0.5", step, [](double t) { return std::pow(t, -0.5) / std::tgamma(0.5); }},
      {"3", step, [](double) { return 3.0; }},
      {"exp(-2 s)/(s + 1)", step, [](double t) { return t < 2 ? 0 : -std::expm1(2 - t); }},
  };
  for (const auto& [model, input, exact] : cases) {
    const ReferenceResponse response(FractionalTransferFunction::parse(model), input);
    for (const double t : {0.5, 1.0, 2.5, 7.0, 20.0}) {
      const frac::ReferenceValue value = response(t);
      EXPECT_EQ(value.status, ResponseStatus::exact) << model << " " << t;
      EXPECT_NEAR(value.value, exact(t), 1e-12 * std::max(1.0, std::abs(exact(t)))) << model << " " << t;
      EXPECT_LE(std::abs(value.value - exact(t)), value.error_estimate + 1e-15 * (1 + std::abs(exact(t))))
          << model << " " << t;
    }
  }
}

// A pole of order two on the imaginary axis: the phase omega t is known to eps omega t, and the amplitude grows with t,
// so that a few eps t of it is what doubles allow.  The estimate is to bound the error and to stay within a thousand of
// these.
TEST(ReferenceResponse, OfADoublePoleOnTheImaginaryAxisGrowsLinearly) {
  struct Case {
    const char* model;
    ResponseInput input;
    double omega;
    std::function<double(double)> exact;
    double growth;  // of the amplitude
  };
  const ResponseInput sine{ResponseInput::Kind::sine, 1};
  const ResponseInput sine_two{ResponseInput::Kind::sine, 2};
  const Case cases[] = {
      {"1/(s^2 + 1)", sine, 1, [](double t) { return (std::sin(t) - t * std::cos(t)) / 2; }, 0.5},
      {"1/(s^2 + 1)^2", step, 1, [](double t) { return 1 - std::cos(t) - t * std::sin(t) / 2; }, 0.5},
      {"1/(s^2 + 1)^2", impulse, 1, [](double t) { return (std::sin(t) - t * std::cos(t)) / 2; }, 0.5},
      {"1/(s^2 + 4)", sine_two, 2, [](double t) { return (std::sin(2 * t) - 2 * t * std::cos(2 * t)) / 8; }, 0.25},
  };
  constexpr double eps = std::numeric_limits<double>::epsilon();
  for (const auto& [model, input, omega, exact, growth] : cases) {
    const ReferenceResponse response(FractionalTransferFunction::parse(model), input);
    for (const double t : {10.0, 1e3, 1e5, 1e6, 1e9}) {
      const frac::ReferenceValue value = response(t);
      const double allowed = 4 * eps * (1 + omega * t) * (1 + growth * t);
      EXPECT_EQ(value.status, ResponseStatus::exact) << model << " " << t;
      EXPECT_NEAR(value.value, exact(t), allowed) << model << " " << t;
      EXPECT_LE(std::abs(value.value - exact(t)), value.error_estimate) << model << " " << t;
      EXPECT_LE(value.error_estimate, 1e3 * allowed) << model << " " << t;
    }
  }
}

// Poles at distance d from each other on the axis, told apart or not by e^{st} at time t: 1/(s^2 + 1) to sin(w t) is
// (w sin t - sin(w t))/(w^2 - 1), here by w = 1 + d and sum-to-product formulas without cancellation.
// 1/(s^2 + a)^2, its poles not on the grid of doubles and, time and again, beside a node of the parabola.  The rounding
// of 2 a and a^2 splits them by 1e-8, which after 100 s changes the response by 1e-12 of itself.
TEST(ReferenceResponse, OfADoublePoleBesideANodeIsConfirmed) {
  const ReferenceResponse response(FractionalTransferFunction::parse("1/(s^2 + 0.3)^2"));
  const double omega = std::sqrt(0.3);
  for (double t = 1; t < 100; t *= 1.01) {
    const double exact = (1 - std::cos(omega * t) - omega * t / 2 * std::sin(omega * t)) / 0.09;
    const double size = (2 + omega * t / 2) / 0.09;
    const frac::ReferenceValue value = response(t);
    EXPECT_EQ(value.status, ResponseStatus::exact) << t;
    EXPECT_NEAR(value.value, exact, 1e-12 * size) << t;
    EXPECT_LE(value.error_estimate, 1e-10 * size) << t;
  }
}

TEST(ReferenceResponse, OfPolesThatNearlyCoincideIsWithinItsEstimate) {
  for (const double d : {1e-10, 1e-8, 1e-6, 1e-5, 1e-4, 3e-4}) {
    const ResponseInput sine{ResponseInput::Kind::sine, 1 + d};
    const double near = (1 + d) - 1;
    const ReferenceResponse response(FractionalTransferFunction::parse("1/(s^2 + 1)"), sine);
    for (const double t : {10.0, 1e3, 1e5, 1e7, 1e9}) {
      const double difference = -2 * std::cos(t + near * t / 2) * std::sin(near * t / 2);  // sin t - sin(w t)
      const double exact = (difference + near * std::sin(t)) / (near * (2 + near));
      const frac::ReferenceValue value = response(t);
      EXPECT_TRUE(std::isfinite(value.value)) << d << " " << t;
      EXPECT_LE(std::abs(value.value - exact), value.error_estimate + 1e-15 * std::abs(exact)) << d << " " << t;
    }
  }
}

// No closed form: what is tested is that residues with the turned cut and the parabola agree within their rounding.
TEST(ReferenceResponse, OfHardSystemsIsConfirmedByTheSecondContour) {
  for (const std::string& model : support::hard_systems()) {
    for (const ResponseInput input : {step, impulse, ramp, ResponseInput{ResponseInput::Kind::sine, 0.7}}) {
      const ReferenceResponse response(FractionalTransferFunction::parse(model), input);
      for (double t = 1e-9; t < 2e9; t *= 21) {
        const frac::ReferenceValue value = response(t);
        EXPECT_NE(value.status, ResponseStatus::inaccurate) << model << " " << static_cast<int>(input.kind) << " " << t;
        EXPECT_FALSE(std::isnan(value.value)) << model << " " << t;
        if (t < 100 && value.status == ResponseStatus::exact && input.kind != impulse.kind) {
          EXPECT_LE(value.error_estimate, 3e-11 * std::abs(value.value)) << model << " " << t;
        }
      }
    }
  }
}

TEST(ReferenceResponse, AtAndBeforeItsStart) {
  const auto at = [](const char* model, ResponseInput input, double t) {
    return ReferenceResponse(FractionalTransferFunction::parse(model), input)(t);
  };
  EXPECT_EQ(at("1/(s^0.5 + 1)", step, 0).value, 0);
  EXPECT_EQ(at("(2 s^0.5 + 1)/(s^0.5 + 1)", step, 0).value, 2);
  EXPECT_EQ(at("4/(2 s + 1)", impulse, 0).value, 2);
  EXPECT_EQ(at("exp(-3 s)/(s + 1)", impulse, 3).value, 1);
  EXPECT_EQ(at("exp(-3 s)/(s + 1)", step, 2.9).value, 0);
  EXPECT_EQ(at("s^0.5", step, 0).status, ResponseStatus::infinite);
  EXPECT_EQ(at("1/(s^1.2 - 2)", step, 1e5).value, std::numeric_limits<double>::infinity());
}

TEST(ReferenceResponse, RefusesWhatItCannotEvaluate) {
  const FractionalTransferFunction model({{1, 0}}, {{1, 0.5}, {1, 0}});
  const ReferenceResponse response(model);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  expect_invalid_argument([&] { (void)response(-1); }, {"t = -1 s"});
  expect_invalid_argument([&] { (void)response(nan); }, {"t = nan s"});
  expect_invalid_argument([&] { ReferenceResponse(model, {ResponseInput::Kind::sine, 0}); }, {"omega = 0 rad/s"});
  const std::vector<double> t{0, 1, nan};
  expect_invalid_argument([&] { (void)frac::reference_response(model, step, t); }, {"t[2] = nan"});
}
