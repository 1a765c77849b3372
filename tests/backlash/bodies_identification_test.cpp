// SPDX-License-Identifier: BSD-3-Clause
#include "backlash/identification/bodies_identification.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <cstddef>
#include <string>
#include <vector>

#include "backlash/loops/forced_bodies.hpp"
#include "support/expect_invalid_argument.hpp"
#include "support/random.hpp"

namespace {

using backlash::BodiesIdentification;
using backlash::BodiesStructure;
using backlash::identify_bodies;
using backlash::LinearBodies;
using backlash::MeasuredDescribingFunction;
using backlash::Output;
using backlash::PointStatus;
using backlash::SceneIdentificationOptions;
using support::expect_invalid_argument;
using Complex = std::complex<double>;

// The motion followed from event to event and closed by Newton's method on instants and impulses of each impact: other
// equations than those of the symmetric orbit, which the fit uses.  It begins at `first`, where the driven body swings
// wider than the clearance and meets the other one; the sweep then keeps the impacts up.
std::vector<MeasuredDescribingFunction> simulated(const LinearBodies& bodies, const std::vector<double>& forces,
                                                  double first, double lowest, double highest, int count,
                                                  Output output = Output::x1) {
  std::vector<MeasuredDescribingFunction> curves;
  for (const double force : forces) {
    std::vector<double> omega{first};
    for (int i = 0; i < count; ++i) {
      omega.push_back(lowest + (highest - lowest) * i / (count - 1));
    }
    // The same ratios of force to inertia at each force.
    for (double& each : omega) each *= std::sqrt(force / forces.back());
    backlash::SweepOptions options;
    options.output = output;
    options.protocol = backlash::Protocol::sweep_up;
    curves.push_back({bodies_describing_function(bodies, force, omega, options).data(), force});
  }
  return curves;
}

void add_noise(std::vector<MeasuredDescribingFunction>& curves, double noise, support::Random& random) {
  for (MeasuredDescribingFunction& curve : curves) {
    std::vector<Complex> value = curve.data.value();
    for (Complex& z : value) {
      const double real = random.normal();
      z += noise * std::abs(z) * Complex(real, random.normal());
    }
    curve.data = {curve.data.omega(), value};
  }
}

SceneIdentificationOptions one_thread() {
  SceneIdentificationOptions options;
  options.threads = 1;
  return options;
}

const BodiesStructure viscous{frac::Structure("1/(m1 s^2 + b1 s)"), frac::Structure("1/(1.5 s^2 + b2 s)")};
const std::vector<double> viscous_values = {1, 0.4, 0.8, 0.3, 0.6};  // m1, b1, b2, clearance, restitution

// The orbits are closed to 1e-12 of instants and impulses and the sums are good to 1e-13; the condition of the scaled
// Fisher matrix, 5e3 in squares, leaves 1e-10.
TEST(BodiesIdentification, FindsFrictionOfBothBodiesToRounding) {
  const auto curves = simulated(viscous.bodies(viscous_values), {20, 40}, 12.5, 20, 36, 8);
  const BodiesIdentification found = identify_bodies(curves, viscous, one_thread());
  ASSERT_TRUE(found.usable()) << found.message;
  for (std::size_t i = 0; i < viscous_values.size(); ++i) {
    EXPECT_NEAR(found.parameters[i].value, viscous_values[i], 1e-9) << found.parameters[i].name;
    EXPECT_TRUE(found.parameters[i].identified) << found.parameters[i].name;
  }
  ASSERT_TRUE(found.bodies);
  EXPECT_NEAR(found.bodies->system().clearance(), 0.3, 1e-9);
}

// 1/(m2 s^2) looks like a gain, which may have either sign; a mass has one.  Fewer parameters than above, and no worse
// a condition.
TEST(BodiesIdentification, FindsAMassThatStandsAlone) {
  const BodiesStructure structure{frac::Structure("1/(s^2 + b1 s)"), frac::Structure("1/(m2 s^2)")};
  const std::vector<double> values = {0.4, 1.2, 0.3, 0.6};
  const BodiesIdentification found =
      identify_bodies(simulated(structure.bodies(values), {20, 40}, 12.5, 20, 36, 8), structure, one_thread());
  ASSERT_TRUE(found.usable()) << found.message;
  for (std::size_t i = 0; i < values.size(); ++i)
    EXPECT_NEAR(found.parameters[i].value, values[i], 1e-9) << found.parameters[i].name;
}

// A load without friction: its estimate ends at 0, which is no limit of the scene, and the others have intervals. Exact
// data to rounding as above; 1 % noise to 4.5 standard errors as below.
TEST(BodiesIdentification, FrictionMayVanish) {
  const std::vector<double> values = {1, 0, 0.8, 0.3, 0.6};
  auto curves = simulated(viscous.bodies(values), {20, 40}, 12.5, 20, 36, 8);
  const BodiesIdentification exact = identify_bodies(curves, viscous, one_thread());
  ASSERT_TRUE(exact.usable()) << exact.message;
  for (std::size_t i = 0; i < values.size(); ++i)
    EXPECT_NEAR(exact.parameters[i].value, values[i], 1e-9) << exact.parameters[i].name;
  support::Random random(7002);
  add_noise(curves, 0.01, random);
  const BodiesIdentification found = identify_bodies(curves, viscous, one_thread());
  ASSERT_TRUE(found.usable()) << found.message;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const backlash::SceneEstimate& estimate = found.parameters[i];
    EXPECT_FALSE(estimate.at_bound) << estimate.name;
    EXPECT_LT(std::abs(estimate.value - values[i]), 4.5 * estimate.standard_error) << estimate.name;
  }
  EXPECT_EQ(found.parameters[1].ci95_lower, 0);
  for (const std::size_t i : {0, 3, 4}) EXPECT_TRUE(found.parameters[i].identified) << found.parameters[i].name;
}

// A spring that is not there, and may be below 0: beside it the drive has an orbit that nothing holds, so that the
// search may find none that is settled on.  Rounding as in the first test.
TEST(BodiesIdentification, LimitsBelowZeroLeaveAStart) {
  const BodiesStructure structure{frac::Structure("1/(m1 s^2 + b1 s)"), frac::Structure("1/(1.5 s^2 + 0.8 s + k2)")};
  const std::vector<double> values = {1, 0.4, 0, 0.3, 0.6};
  const auto curves = simulated(structure.bodies(values), {20, 40}, 12.5, 20, 36, 8);
  for (const double upper : {1.0, 1.5}) {
    auto options = one_thread();
    options.constraints.push_back({"k2", {}, -1.0, upper, {}});
    const BodiesIdentification found = identify_bodies(curves, structure, options);
    ASSERT_TRUE(found.usable()) << found.message;
    for (std::size_t i = 0; i < values.size(); ++i) {
      EXPECT_NEAR(found.parameters[i].value, values[i], 1e-9) << found.parameters[i].name;
      EXPECT_EQ(found.parameters[i].identified, i != 2) << found.parameters[i].name;
    }
  }
}

TEST(BodiesIdentification, RefusesLimitsOfWhatCannotBeNegative) {
  const auto curves = simulated(viscous.bodies(viscous_values), {40}, 12.5, 25, 35, 4);
  const auto expect_refused = [&](const frac::ParameterConstraint& constraint, const std::vector<std::string>& parts) {
    auto options = one_thread();
    options.constraints.push_back(constraint);
    expect_invalid_argument([&] { static_cast<void>(identify_bodies(curves, viscous, options)); }, parts);
  };
  expect_refused({"m1", {}, -1.0, 3.0, {}}, {"m1", "lower limit is -1", "0 or greater"});
  expect_refused({"m1", {}, {}, -1.0, {}}, {"m1", "upper limit is -1", "positive"});
  expect_refused({"clearance", {}, -1.0, 1.0, {}}, {"clearance", "lower limit is -1", "0 or greater"});
  expect_refused({"clearance", 0.0, {}, {}, {}}, {"clearance", "fixed value is 0", "positive"});
  expect_refused({"restitution", {}, {}, 1.5, {}}, {"restitution", "upper limit is 1.5", "[0, 1]"});
}

// Viscous friction that is allowed an order of 1.2 at least ends there: the order alone is at a limit, and the others,
// whose units move with it, have the intervals that they have where it is fixed at that.
TEST(BodiesIdentification, AnOrderAtItsLimitLimitsNothingElse) {
  const BodiesStructure structure{frac::Structure("1/(m1 s^2 + b1 s^a)"), frac::Structure("1/(1.5 s^2 + 0.8 s)")};
  auto curves = simulated(structure.bodies({1, 0.4, 1, 0.3, 0.6}), {20, 40}, 12.5, 20, 36, 8);
  support::Random random(7003);
  add_noise(curves, 0.001, random);
  SceneIdentificationOptions options = one_thread();
  options.constraints.push_back({"a", {}, 1.2, 1.8, {}});
  const BodiesIdentification limited = identify_bodies(curves, structure, options);
  options.constraints.back() = {"a", 1.2, {}, {}, {}};
  const BodiesIdentification fixed = identify_bodies(curves, structure, options);
  ASSERT_EQ(limited.parameters[2].name, "a");
  EXPECT_TRUE(limited.parameters[2].at_bound);
  for (const std::size_t i : {0, 1, 3, 4}) {
    const backlash::SceneEstimate &own = limited.parameters[i], &other = fixed.parameters[i];
    EXPECT_FALSE(own.at_bound) << own.name;
    // Both searches end where a step is below a hundredth of a standard error.
    EXPECT_NEAR(own.value, other.value, 0.02 * other.standard_error) << own.name;
    // One degree of freedom of 28 and what it widens.
    EXPECT_NEAR(own.standard_error / other.standard_error, 1, 0.1) << own.name;
  }
}

// A spring with a damper, and friction of a fractional order, from the motion of the driven body.
TEST(BodiesIdentification, FindsASpringAndFractionalFriction) {
  const BodiesStructure structure{frac::Structure("1/(2 s^2 + 3 s + k)"), frac::Structure("1/(m2 s^2 + c s^a)")};
  const std::vector<double> values = {30, 1, 1.2, 0.5, 0.3, 0.5};
  const auto curves = simulated(structure.bodies(values), {25, 40}, 11, 18, 30, 8, Output::x2);
  SceneIdentificationOptions options = one_thread();
  options.output = Output::x2;
  options.constraints.push_back({"a", 0.5, {}, {}, {}});
  const BodiesIdentification found = identify_bodies(curves, structure, options);
  ASSERT_TRUE(found.usable()) << found.message;
  // As above, at a condition of 1e5 in squares.
  for (std::size_t i = 0; i < values.size(); ++i) {
    EXPECT_NEAR(found.parameters[i].value / values[i], 1, 1e-9) << found.parameters[i].name;
  }
  EXPECT_TRUE(found.parameters[3].fixed);
}

// 1 % noise.  Student's t of 27 degrees of freedom exceeds 4.5 once in ten thousand.
TEST(BodiesIdentification, ErrorsAreOfTheSizeOfTheIntervals) {
  auto curves = simulated(viscous.bodies(viscous_values), {20, 40}, 12.5, 20, 36, 8);
  support::Random random(7001);
  add_noise(curves, 0.01, random);
  const BodiesIdentification found = identify_bodies(curves, viscous, one_thread());
  ASSERT_TRUE(found.usable()) << found.message;
  EXPECT_TRUE(found.misfits.empty());
  EXPECT_NEAR(found.rms, 0.01, 0.005);
  for (std::size_t i = 0; i < viscous_values.size(); ++i) {
    const backlash::SceneEstimate& estimate = found.parameters[i];
    EXPECT_LT(std::abs(estimate.value - viscous_values[i]), 4.5 * estimate.standard_error) << estimate.name;
    EXPECT_LT(estimate.standard_error, viscous_values[i]) << estimate.name;
  }
}

// Below 15 rad/s these bodies have no symmetric orbit of two impacts: nothing is made of what they do there.
TEST(BodiesIdentification, LeavesOutOtherMotions) {
  auto curves = simulated(viscous.bodies(viscous_values), {40}, 12.5, 20, 36, 11);
  std::vector<double> omega = curves[0].data.omega();
  std::vector<Complex> value = curves[0].data.value();
  omega.insert(omega.begin(), {8, 9, 10});
  value.insert(value.begin(), {Complex(-.01, .002), Complex(-.008, .001), Complex(-.006, .001)});
  curves[0].data = {omega, value};
  const BodiesIdentification found = identify_bodies(curves, viscous, one_thread());
  ASSERT_TRUE(found.usable()) << found.message;
  EXPECT_GE(found.points_used, 8U);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(found.points[i].status, PointStatus::irregular) << i;
  EXPECT_NEAR(found.parameters[1].value, 0.4, 1e-8);
}

TEST(BodiesIdentification, RefusesWhatItCannotFit) {
  const auto curves = simulated(viscous.bodies(viscous_values), {40}, 12.5, 25, 35, 2);
  const frac::Structure mass("1/(m s^2)");
  expect_invalid_argument(
      [&] {
        static_cast<void>(identify_bodies(curves, {frac::Structure("1/(m s^2 + clearance)"), mass}));
      },
      {"clearance", "another name"});
  expect_invalid_argument(
      [&] {
        static_cast<void>(identify_bodies(curves, {frac::Structure("1/(m s + b)"), mass}));
      },
      {"load", "1/(M s^2)"});
  expect_invalid_argument([&] { static_cast<void>(identify_bodies({}, viscous)); }, {"curves"});
  backlash::SceneIdentificationOptions options;
  options.friction = backlash::FrictionModel::estimate;
  expect_invalid_argument([&] { static_cast<void>(identify_bodies(curves, viscous, options)); },
                          {"friction is estimate", "only none"});
  options.friction = backlash::FrictionModel::none;
  options.contact = backlash::ContactModel::compliant;
  expect_invalid_argument([&] { static_cast<void>(identify_bodies(curves, viscous, options)); },
                          {"contact is compliant", "auto or hard"});
  expect_invalid_argument(
      [&] {
        static_cast<void>(
            identify_bodies(curves, {frac::Structure("1/(m1 s^2 + b1 s + k1)"), frac::Structure("1/(m2 s^2 + b2 s)")}));
      },
      {"6 residuals", "7 free parameters"});
}

}  // namespace
