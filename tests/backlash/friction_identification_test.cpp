// SPDX-License-Identifier: BSD-3-Clause
// Scenes whose masses rub on the ground, identified from N.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "backlash/compliant/compliant_bodies.hpp"
#include "backlash/identification/scene_identification.hpp"
#include "identification/contact_response.hpp"
#include "identification/friction_response.hpp"
#include "identification/scene_data.hpp"
#include "identification/scene_start.hpp"
#include "support/expect_invalid_argument.hpp"
#include "support/random.hpp"
#include "support/relative_error.hpp"

namespace {

using backlash::CompliantBodies;
using backlash::CompliantContact;
using backlash::CoulombFriction;
using backlash::FrictionModel;
using backlash::FrictionVerdict;
using backlash::identify_scene;
using backlash::MeasuredDescribingFunction;
using backlash::Output;
using backlash::detail::FoundOrbit;
using backlash::detail::friction_n;
using backlash::detail::friction_response;
using backlash::detail::FrictionGroups;
using backlash::detail::FrictionStart;
using support::expect_invalid_argument;
using support::log_grid;
using Complex = std::complex<double>;

struct Scene {
  double mass1 = 1.5, mass2 = 0.8, clearance = 0.3, restitution = 0.6;
  double contact_time = 0.004;
  CoulombFriction friction{};

  [[nodiscard]] CompliantBodies bodies() const {
    const auto shape = backlash::detail::contact_shape(restitution);
    const auto contact =
        CompliantContact::from_frequency(shape.angle / contact_time, shape.damping_ratio, mass1, mass2);
    return {backlash::free_mass(mass1), backlash::free_mass(mass2), clearance, contact, friction};
  }
  [[nodiscard]] FrictionGroups groups(double force, double omega) const {
    return {force / (mass2 * clearance * omega * omega),
            omega * contact_time,
            restitution,
            mass1 / mass2,
            {friction.body1 / force, friction.body2 / force}};
  }
};

// bodies_describing_function() follows the motion of the bodies in their units until it closes; here the orbit is that
// of groups.  Each rounds to 1e-12 or so of N, more at 60 times the frequency of the force.
TEST(FrictionResponse, IsTheDescribingFunctionOfTheBodies) {
  const double force = 40;
  int compared = 0;
  for (const CoulombFriction& friction : {CoulombFriction{2, 0}, {0, 2}, {4, 1}, {0.4, 8}}) {
    for (const double omega : {19.0, 21.0, 24.0}) {
      for (const Output output : {Output::x1, Output::x2}) {
        Scene scene;
        scene.friction = friction;
        backlash::SweepOptions sweep;
        sweep.output = output;
        const auto point = backlash::bodies_describing_function(scene.bodies(), force, {omega}, sweep).points.front();
        if (point.period != 1) continue;
        FoundOrbit found;
        const auto n = friction_n(scene.groups(force, omega), output, FrictionStart::symmetric, found);
        ASSERT_TRUE(n) << omega << " " << friction.body1 << " " << friction.body2;
        const double inertia = scene.mass1 * scene.mass2 / (scene.mass1 + scene.mass2) * omega * omega;
        EXPECT_LT(support::relative_error(*n / inertia, point.value), 1e-10)
            << omega << " " << friction.body1 << " " << friction.body2;
        ++compared;
      }
    }
  }
  EXPECT_GE(compared, 16);
}

// Without friction n_k = -(mass1 mass2/(mass1 + mass2)^2) h_k, and friction of 2 % of the force moves it by about that
// share of the fundamental, a fifth of the third harmonic; derivatives as below.
TEST(FrictionResponse, HarmonicsAreNearThoseWithoutFriction) {
  const double gamma = 0.3, tau = 0.08, restitution = 0.6, ratio = 1.9, share = ratio / ((1 + ratio) * (1 + ratio));
  const FrictionGroups groups{gamma, tau, restitution, ratio, {0.02, 0}};
  const backlash::detail::ContactMotions contact(restitution, 5);
  backlash::detail::FoundMotions motions;
  const double size = std::abs(*backlash::detail::contact_h(contact, gamma, tau, false, motions, true)[0]) * share;
  for (const int k : {3, 5}) {
    FoundOrbit found;
    const auto n = friction_n(groups, Output::x1, FrictionStart::symmetric, found, k);
    const auto h =
        backlash::detail::contact_h(contact, gamma, tau, false, motions, true)[backlash::detail::harmonic_place(k)];
    ASSERT_TRUE(n && h);
    EXPECT_LT(std::abs(*n + *h * share), 0.02 * size) << k;
    const auto response = friction_response(groups, Output::x1, found, k);
    ASSERT_TRUE(response);
    const auto beside = [&](double by) {
      FrictionGroups other = groups;
      other.gamma *= std::exp(by);
      FoundOrbit near = found;
      return friction_n(other, Output::x1, FrictionStart::found, near, k).value();
    };
    const Complex central = (beside(1e-4) - beside(-1e-4)) / 2e-4;
    EXPECT_LT(std::abs(response->by_log_gamma - central), 1e-4 * (size + std::abs(central))) << k;
  }
}

// Central differences of 1e-4 err by 1e-8 times third derivatives, forward ones of 1e-6 by 1e-6 times second ones; both
// are of the order of ten times N, in the time a hundred.  From no friction on one-sided differences of second order
// do.
TEST(FrictionResponse, DerivativesAreThoseOfDifferences) {
  constexpr double step = 1e-4;
  int backwards = 0;  // bodies without friction whose velocity is negative where the orbit begins
  for (const auto& friction : {std::array{0.05, 0.0}, {0.02, 0.1}, {0.0, 0.2}}) {
    const FrictionGroups here{0.45, 0.08, 0.6, 1.9, friction};
    FoundOrbit found;
    ASSERT_TRUE(friction_n(here, Output::x1, FrictionStart::symmetric, found));
    const auto response = friction_response(here, Output::x1, found);
    ASSERT_TRUE(response);
    const auto n = [&](auto change, double by) {
      FrictionGroups other = here;
      change(other, by);
      FoundOrbit near = found;
      return friction_n(other, Output::x1, FrictionStart::found, near).value();
    };
    const auto compare = [&](Complex derivative, auto change, const char* name) {
      const Complex central = (n(change, step) - n(change, -step)) / (2 * step);
      EXPECT_LT(std::abs(derivative - central), 1e-4 * (std::abs(response->n) + std::abs(central))) << name;
    };
    compare(
        response->by_log_gamma, [](auto& g, double by) { g.gamma *= std::exp(by); }, "gamma");
    compare(
        response->by_tau, [](auto& g, double by) { g.tau += by; }, "tau");
    compare(
        response->by_restitution, [](auto& g, double by) { g.restitution += by; }, "restitution");
    compare(
        response->by_log_mass_ratio, [](auto& g, double by) { g.mass_ratio *= std::exp(by); }, "mass ratio");
    for (const std::size_t i : {0u, 1u}) {
      const auto change = [i](auto& g, double by) { g.friction[i] += by; };
      if (friction[i] != 0) {
        compare(response->by_friction[i], change, "friction");
        continue;
      }
      const auto at = backlash::detail::CompliantFlow::positions(found->state);
      backwards += (i == 0 ? at.v1 : at.v2) < 0 ? 1 : 0;
      const Complex ahead = (4.0 * n(change, step) - n(change, 2 * step) - 3.0 * response->n) / (2 * step);
      EXPECT_LT(std::abs(response->by_friction[i] - ahead), 1e-4 * (std::abs(response->n) + std::abs(ahead))) << i;
    }
  }
  EXPECT_GE(backwards, 1);
}

// A light load of a heavy drive, which turns at each impact: friction of it alone does not hold the masses, and nearly
// none has to.  n = -(mass1 mass2/(mass1 + mass2)^2) h without friction, which a millionth of the force on a load of a
// twentieth of the drive moves by some twenty times itself.
TEST(FrictionResponse, MassesWithoutFrictionHaveTheOrbitThatTheyHave) {
  for (const double ratio : {0.05, 0.22, 1.0, 5.0}) {
    for (const double restitution : {0.4, 0.6, 0.8}) {
      const double gamma = 0.2, tau = 0.02;
      FoundOrbit found;
      const auto n = friction_n({gamma, tau, restitution, ratio, {0, 0}}, Output::x1, FrictionStart::symmetric, found);
      backlash::detail::FoundMotions motions;
      const auto h = backlash::detail::contact_h(backlash::detail::ContactMotions(restitution, 1), gamma, tau, false,
                                                 motions, true)[0];
      ASSERT_TRUE(n && h) << ratio << " " << restitution;
      const Complex expected = -ratio / ((1 + ratio) * (1 + ratio)) * *h;
      EXPECT_LT(support::relative_error(*n, expected), 1e-4) << ratio << " " << restitution;
    }
  }
}

// A free mass under F cos wt and friction f turns at the phase whose sine is -(pi/2) f/F: over half a period the
// impulse of both is 0.  So the square wave's fundamental has the phase of that and not of the position's fundamental,
// which differs by third harmonics: the error of the balance is of second order in f, without it of first.
TEST(WithoutFriction, ErrsInSecondOrderOfTheFrictionOfAFreeMass) {
  const double mass = 0.8, omega = 20, force = 10;
  const auto error_at = [&](double friction, bool balanced) {
    const double turn = -std::asin(std::numbers::pi / 2 * friction / force);
    const Complex resisted = 4 / std::numbers::pi * friction * Complex(0, -1) * std::polar(1.0, -turn);
    backlash::detail::MeasuredPoint point{0, 0, force, omega, -(force - resisted) / (mass * omega * omega) / force, 0};
    if (balanced) point = backlash::detail::without_friction(point, Output::x2, {1, mass}, {0, friction});
    return std::abs(-point.value * mass * omega * omega - 1.0);
  };
  for (const double share : {0.02, 0.05, 0.1}) {
    EXPECT_LT(error_at(share * force, true), share * error_at(share * force, false)) << share;
    EXPECT_NEAR(error_at(share * force, true) / error_at(share * force / 2, true), 4, 40 * share * share) << share;
  }
}

const std::array<double, 2> forces = {10, 40};

// Frequencies in units of sqrt(F/(mass2 clearance)), with relative noise in both parts; motions followed in the units
// of the bodies.
std::vector<MeasuredDescribingFunction> measured(const Scene& scene, int count, double noise, support::Random& random) {
  std::vector<MeasuredDescribingFunction> curves;
  for (const double force : forces) {
    const double unit = std::sqrt(force / scene.mass2 / scene.clearance);
    const auto data =
        backlash::bodies_describing_function(scene.bodies(), force, log_grid(1.7 * unit, 2.5 * unit, count), {}).data();
    std::vector<Complex> value = data.value();
    for (Complex& z : value) {
      const double real = random.normal();
      z += noise * std::abs(z) * Complex(real, random.normal());
    }
    curves.push_back({{data.omega(), value}, force});
  }
  return curves;
}

backlash::SceneIdentificationOptions with_mass1(const Scene& scene) {
  backlash::SceneIdentificationOptions options;
  options.constraints.push_back({"mass1", scene.mass1, {}, {}, {}});
  options.friction = FrictionModel::automatic;
  return options;
}

// Friction of a fifth of the lower force on either mass: the balance errs by the square of its fundamental, 1.27^2/25 =
// 0.065, and twice that in what follows of two points.
TEST(RubbingStarts, AreNearTheScene) {
  support::Random random(5);
  for (const CoulombFriction& friction : {CoulombFriction{2, 0}, {0, 2}}) {
    Scene scene;
    scene.friction = friction;
    const auto data = backlash::detail::scene_data(measured(scene, 8, 0, random), {});
    const double known = std::log(scene.mass1);
    const backlash::detail::SceneBounds bounds{{known, -20, -20, 0}, {known, 20, 20, 1}};
    const backlash::detail::FixedScene fixed = {scene.mass1, {}, {}, {}};
    const auto error_of = [&](const std::vector<backlash::detail::Coordinates>& starts) {
      double least = 1;
      for (const auto& start : starts) {
        const double product = std::exp(start[1] + start[2]) / (scene.mass2 * scene.clearance);
        least = std::min(least, std::max(std::abs(product - 1), std::abs(start[3] - scene.restitution)));
      }
      return least;
    };
    const double error = error_of(backlash::detail::rubbing_starts(data, bounds, fixed, 6));
    EXPECT_LT(error, 0.14) << friction.body1 << " " << friction.body2;
  }
}

// Data are exact to 1e-12; the least squares end where a step moves the estimate by less than 1e-2 of standard errors
// that are as small as the residuals are, which with a condition in the thousands leaves 1e-5 of each value.
TEST(FrictionIdentification, RecoversExactScenes) {
  support::Random random(1);
  for (const CoulombFriction& friction : {CoulombFriction{0.5, 0}, {0, 0.5}, {0.3, 1}}) {
    Scene scene;
    scene.friction = friction;
    const auto result = identify_scene(measured(scene, 8, 0, random), with_mass1(scene));
    ASSERT_TRUE(result.usable()) << result.message;
    EXPECT_EQ(result.friction_verdict, FrictionVerdict::present) << result.message;
    const std::array<double, 4> truth = {scene.mass1, scene.mass2, scene.clearance, scene.restitution};
    for (std::size_t k = 0; k < truth.size(); ++k)
      EXPECT_NEAR(result.parameters[k].value, truth[k], 1e-5 * truth[k]) << k << result.message;
    ASSERT_EQ(result.friction.size(), 2u);
    EXPECT_NEAR(result.friction[0].value, friction.body1, 1e-5 * forces[0]) << result.message;
    EXPECT_NEAR(result.friction[1].value, friction.body2, 1e-5 * forces[0]) << result.message;
  }
}

// Noise of 1 %, friction of 5 % of the lower force.  Binomial(6, 0.95): more than 2 misses have a chance of 0.2 %.  A
// search that has not settled says so and states nothing; most settle.
TEST(FrictionIdentification, IntervalsHoldMassesGapRestitutionAndFriction) {
  constexpr int trials = 6;
  support::Random random(2);
  Scene scene;
  scene.friction = {0.5, 0.5};
  std::array<int, 5> missed{};
  int unsettled = 0;
  for (int trial = 0; trial < trials; ++trial) {
    auto options = with_mass1(scene);
    options.friction = FrictionModel::estimate;
    const auto result = identify_scene(measured(scene, 8, 0.01, random), options);
    if (!result.usable()) {
      ++unsettled;
      for (const auto& estimate : result.parameters) EXPECT_EQ(estimate.identified, estimate.fixed) << result.message;
      continue;
    }
    const auto misses = [](const backlash::SceneEstimate& estimate, double value) {
      return !(estimate.ci95_lower <= value && value <= estimate.ci95_upper);
    };
    const std::array<double, 4> truth = {scene.mass1, scene.mass2, scene.clearance, scene.restitution};
    for (std::size_t k = 1; k < truth.size(); ++k) missed[k - 1] += misses(result.parameters[k], truth[k]) ? 1 : 0;
    missed[3] += misses(result.friction[0], scene.friction.body1) ? 1 : 0;
    missed[4] += misses(result.friction[1], scene.friction.body2) ? 1 : 0;
  }
  for (std::size_t k = 0; k < missed.size(); ++k) EXPECT_LE(missed[k], 2) << k;
  EXPECT_LE(unsettled, trials / 2);
}

TEST(FrictionIdentification, WithoutFrictionTheAnswerIsOneWithoutWhoseIntervalsAllowForIt) {
  support::Random random(3);
  const Scene scene;
  const auto curves = measured(scene, 8, 0.01, random);
  auto options = with_mass1(scene);
  const auto result = identify_scene(curves, options);
  EXPECT_EQ(result.friction_verdict, FrictionVerdict::undecided) << result.message;
  EXPECT_TRUE(result.friction.empty());
  options.friction = FrictionModel::none;
  const auto without = identify_scene(curves, options);
  EXPECT_EQ(without.friction_verdict, FrictionVerdict::none);
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_EQ(result.parameters[k].value, without.parameters[k].value);
    EXPECT_GE(result.parameters[k].ci95_upper, without.parameters[k].ci95_upper);
    EXPECT_LE(result.parameters[k].ci95_lower, without.parameters[k].ci95_lower);
  }
}

// N of x1 of the scene above with hard contacts and without friction, three points at each force with noise of 1 % in
// both parts.  The scene without friction leaves out so many of the first ones that six parameters meet the rest; of
// the second ones it stands at another estimate than the scene with friction, which ends at none.
TEST(FrictionIdentification, ThreePointsAtEachForceDoNotTellFriction) {
  const std::vector<MeasuredDescribingFunction> few = {
      {{{7, 9.1, 11.2}, {{-0.0110866, 0.00302799}, {-0.00639737, 0.00299752}, {-0.00630841, 0.00261734}}}, 10},
      {{{14, 17.5, 21}, {{-0.002743, 0.000717011}, {-0.00205265, 0.000699068}, {-0.00164604, 0.000664432}}}, 40}};
  const std::vector<MeasuredDescribingFunction> astray = {
      {{{9, 11.7, 14.4}, {{-0.00645223, 0.00295055}, {-0.00602995, 0.0026457}, {-0.00474956, 0.0030136}}}, 10},
      {{{18, 22.5, 27}, {{-0.00161351, 0.000736609}, {-0.00158463, 0.000641749}, {-0.00127193, 0.000706378}}}, 40}};
  const auto compared = identify_scene(few, with_mass1({}));
  EXPECT_EQ(compared.friction_verdict, FrictionVerdict::undecided) << compared.message;
  EXPECT_TRUE(std::isnan(compared.friction_evidence)) << compared.friction_evidence;
  EXPECT_NE(compared.message.find("Too few points"), std::string::npos) << compared.message;
  const auto beside = identify_scene(astray, with_mass1({}));
  EXPECT_EQ(beside.friction_verdict, FrictionVerdict::undecided) << beside.message;
  EXPECT_TRUE(beside.friction.empty());
}

// Six residuals for mass2, clearance, restitution, contact time and both frictions: any friction may be, so that
// nothing is known of the others either.
TEST(FrictionIdentification, AsManyParametersAsResidualsAreSaid) {
  support::Random random(6);
  auto curves = measured({}, 3, 0, random);
  curves.erase(curves.begin() + 1, curves.end());
  const auto result = identify_scene(curves, with_mass1({}));
  EXPECT_EQ(result.friction_verdict, FrictionVerdict::undecided) << result.message;
  EXPECT_NE(result.message.find("6 parameters that are free, the data have 6 residuals"), std::string::npos)
      << result.message;
  for (std::size_t k = 1; k < 4; ++k) EXPECT_FALSE(result.parameters[k].identified) << result.message;
}

TEST(FrictionIdentification, AFixedFrictionIsHeldAndBadOnesAreRefused) {
  support::Random random(4);
  Scene scene;
  scene.friction = {0.4, 0};
  const auto curves = measured(scene, 6, 0, random);
  auto options = with_mass1(scene);
  options.constraints.push_back({"friction1", 0.4, {}, {}, {}});
  options.constraints.push_back({"friction2", 0.0, {}, {}, {}});
  const auto result = identify_scene(curves, options);
  ASSERT_EQ(result.friction.size(), 2u);
  EXPECT_TRUE(result.friction[0].fixed);
  EXPECT_NEAR(result.friction[0].value, 0.4, 1e-15);
  EXPECT_NEAR(result.parameters[3].value, scene.restitution, 1e-5) << result.message;
  options.friction = FrictionModel::none;
  expect_invalid_argument([&] { return identify_scene(curves, options); }, {"friction1", "no friction"});
  options.friction = FrictionModel::automatic;
  options.constraints.back().fixed = -1;
  expect_invalid_argument([&] { return identify_scene(curves, options); }, {"friction2", "-1", "0 or greater"});
  expect_invalid_argument([] { return backlash::friction_model_from_string("dry"); }, {"dry", "none", "estimate"});
}

}  // namespace
