// SPDX-License-Identifier: BSD-3-Clause
// Scenes whose contacts take time, identified from N.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include "backlash/compliant/compliant_bodies.hpp"
#include "backlash/identification/scene_identification.hpp"
#include "identification/contact_response.hpp"
#include "identification/scene_response.hpp"
#include "steady_state/two_impact_orbit.hpp"
#include "support/expect_invalid_argument.hpp"
#include "support/random.hpp"
#include "support/relative_error.hpp"

namespace {

using backlash::CompliantBodies;
using backlash::CompliantContact;
using backlash::ContactModel;
using backlash::identify_scene;
using backlash::MeasuredDescribingFunction;
using backlash::detail::contact_h;
using backlash::detail::ContactMotions;
using backlash::detail::ContactResponses;
using backlash::detail::FoundMotions;
using backlash::detail::harmonic_place;
using support::expect_invalid_argument;
using support::log_grid;
using Complex = std::complex<double>;

// Orbits of two contacts of free masses by another program, in extended precision with events bisected: N1 is known to
// 7e-14.
struct ReferencePoint {
  double mass1, mass2, clearance, stiffness, damping, force, omega;
  Complex n1;
};
const std::array<ReferencePoint, 4> reference = {{
    {1.15, 1.03, 0.112, 45017.0, 15.64, 16.57, 17.99, {-0.002420293111498762, 0.0002888293346759604}},
    {0.551, 2.6, 0.0406, 319820.0, 91.517, 13.48, 26.21, {-0.00127467635410127, 0.000559793743931302}},
    {1.38, 1.71, 0.027, 16468.0, 26.915, 1.126, 9.178, {-0.008482496695281255, 0.002640048911902226}},
    {1.04, 1.06, 0.0195, 920450.0, 1390.2, 3.896, 20.69, {-0.0008787216130394511, 0.001275074713542215}},
}};

// The damping ratio goes through the restitution and back, which keeps it to some roundings; nu^2, up to 4000,
// amplifies these in the force of the contact.
TEST(ContactMotions, AreThoseOfAnotherProgram) {
  int compared = 0;
  for (const ReferencePoint& point : reference) {
    const auto free =
        backlash::free_contact(CompliantContact(point.stiffness, point.damping), point.mass1, point.mass2);
    const double gamma = point.force / (point.mass2 * point.clearance * point.omega * point.omega);
    const ContactMotions motions(free.restitution);
    const double inertia = (point.mass1 + point.mass2) * point.omega * point.omega;
    // The asymmetric orbit of the first point is found beside the symmetric one.
    FoundMotions found;
    for (const bool is_followed : {false, true}) {
      const auto h = contact_h(motions, gamma, point.omega * free.duration, is_followed, found, true)[0];
      // From rest the motion may come to another orbit.
      const bool is_other =
          !h || (is_followed ? found.followed->contacts != 2 : found.symmetric->largest_multiplier >= 1);
      if (is_other) continue;
      ++compared;
      EXPECT_LT(support::relative_error(-*h / inertia, point.n1), 1e-11) << point.stiffness << " " << is_followed;
    }
  }
  EXPECT_GE(compared, 3);
}

// The closed form of two contacts per period and the flow of the same orbit, and, of both, harmonics of contacts that
// take nearly no time and those of impacts, which they tend to in first order.
TEST(ContactMotions, HarmonicsAreThoseOfTheFlowAndTendToThoseOfTheImpact) {
  for (const double restitution : {0.3, 0.6, 0.9}) {
    const double gamma = 0.85 * backlash::detail::symmetry_breaking_gamma(restitution);
    const ContactMotions motions(restitution, 5);
    for (const int k : {1, 3, 5}) {
      for (const double tau : {0.02, 0.2}) {
        FoundMotions found;
        const auto closed = contact_h(motions, gamma, tau, false, found, true)[harmonic_place(k)];
        const auto flow = contact_h(motions, gamma, tau, true, found, true)[harmonic_place(k)];
        ASSERT_TRUE(closed) << restitution << " " << tau;
        // From rest the motion may come to another orbit.
        if (!flow || found.followed->contacts != 2 || found.symmetric->largest_multiplier >= 1) continue;
        EXPECT_LT(std::abs(*closed - *flow), 1e-9) << restitution << " " << tau << " " << k;
      }
      FoundMotions found;
      const double tau = 1e-4;
      const Complex hard = backlash::detail::two_impact_response(gamma, restitution, k)->h;
      EXPECT_LT(std::abs(*contact_h(motions, gamma, tau, false, found, true)[harmonic_place(k)] - hard), 20 * k * tau)
          << restitution << k;
    }
  }
}

// h(tau) = h(0) + a tau + b tau^2 + ...: twice the angle makes twice the change, but for b tau/a.  Differences of h
// lose what its rounding, 1e-13, is of a tau.
TEST(ContactMotions, TendToTheImpactInFirstOrderOfTheirTime) {
  for (const double restitution : {0.2, 0.6, 0.9}) {
    const double gamma = 0.8 * backlash::detail::symmetry_breaking_gamma(restitution);
    const Complex hard = backlash::detail::two_impact_response(gamma, restitution)->h;
    const ContactMotions motions(restitution);
    const auto change = [&](double tau) {
      FoundMotions found;
      return *contact_h(motions, gamma, tau, false, found, true)[0] - hard;
    };
    for (const double tau : {1e-6, 4e-6, 1e-4, 1e-3, 1e-2}) {
      EXPECT_LT(std::abs(change(2 * tau) / change(tau) - 2.0), 10 * tau + 1e-12 / std::abs(change(tau)))
          << restitution << " " << tau;
    }
    EXPECT_EQ(change(0), Complex(0));
  }
}

// Forward differences of 1e-5 against central ones of 1e-3, which err by 1e-6 times third derivatives; near the
// saddle-node derivatives grow, so that 1e-3 covers both here.
TEST(ContactMotions, DerivativesAreThoseOfDifferences) {
  constexpr double step = 1e-3;
  for (const double tau : {0.02, 0.2, 0.6}) {
    for (const bool is_followed : {false, true}) {
      const double restitution = 0.5;
      const double gamma = (is_followed ? 4 : 0.85) * backlash::detail::symmetry_breaking_gamma(restitution);
      FoundMotions found;
      const ContactMotions motions(restitution);
      if (!contact_h(motions, gamma, tau, is_followed, found, true)[0]) {
        EXPECT_TRUE(is_followed) << tau;
        continue;
      }
      const auto h = [&](double log_gamma, double change, double longer) {
        FoundMotions near = found;
        return *contact_h(ContactMotions(restitution + change), gamma * std::exp(log_gamma), tau + longer, is_followed,
                          near, false)[0];
      };
      const auto response = ContactResponses(restitution).at(gamma, tau, is_followed, found)[0];
      ASSERT_TRUE(response);
      const auto near = [&](Complex derivative, Complex above, Complex below, double width) {
        EXPECT_LT(std::abs(derivative - (above - below) / (2 * width)), 1e-3 * (1 + std::abs(derivative)))
            << tau << " " << is_followed;
      };
      near(response->by_log_gamma, h(step, 0, 0), h(-step, 0, 0), step);
      near(response->by_restitution, h(0, step, 0), h(0, -step, 0), step);
      near(response->by_contact, h(0, 0, step * tau), h(0, 0, -step * tau), step * tau);
    }
  }
}

struct Scene {
  double mass1 = 1.5, mass2 = 0.8, clearance = 0.3, restitution = 0.6;
  double contact_time = 0;
};
const std::array<double, 2> forces = {10, 40};

// The middle of the band at the first force.
double period(const Scene& scene, double lower, double upper) {
  return 2 * std::numbers::pi / std::sqrt(lower * upper * forces[0] / (scene.mass2 * scene.clearance));
}

CompliantContact contact_of(const Scene& scene) {
  const auto shape = backlash::detail::contact_shape(scene.restitution);
  return CompliantContact::from_frequency(shape.angle / scene.contact_time, shape.damping_ratio, scene.mass1,
                                          scene.mass2);
}

// Frequencies in units of sqrt(F/(mass2 clearance)), with relative noise in both parts; motions followed from event to
// event, not by the closed form that the identification compares with.
std::vector<MeasuredDescribingFunction> measured(const Scene& scene, double lower, double upper, int count,
                                                 double noise, support::Random& random) {
  std::vector<MeasuredDescribingFunction> curves;
  const CompliantBodies bodies(backlash::free_mass(scene.mass1), backlash::free_mass(scene.mass2), scene.clearance,
                               contact_of(scene));
  for (const double force : forces) {
    const double unit = std::sqrt(force / scene.mass2 / scene.clearance);
    const auto data = bodies_describing_function(bodies, force, log_grid(lower * unit, upper * unit, count), {}).data();
    std::vector<Complex> value = data.value();
    for (Complex& z : value) {
      const double real = random.normal();
      z += noise * std::abs(z) * Complex(real, random.normal());
    }
    curves.push_back({{data.omega(), value}, force});
  }
  return curves;
}

backlash::SceneIdentificationOptions with_mass1(const Scene& scene, ContactModel contact = ContactModel::automatic) {
  backlash::SceneIdentificationOptions options;
  options.constraints.push_back({"mass1", scene.mass1, {}, {}, {}});
  options.contact = contact;
  return options;
}

// Data are exact to 1e-13; the ratio of the largest to the smallest singular value, in the thousands here, and what the
// time adds to that where it is short, leave more than 1e-7 of the others and of the period.
TEST(ContactIdentification, RecoversExactScenes) {
  support::Random random(1);
  for (const double share : {0.0003, 0.003, 0.03, 0.1}) {
    Scene scene;
    scene.contact_time = share * period(scene, 1.8, 2.6);
    const auto result = identify_scene(measured(scene, 1.8, 2.6, 12, 0, random), with_mass1(scene));
    ASSERT_TRUE(result.usable()) << share << result.message;
    EXPECT_EQ(result.contact_verdict, backlash::ContactVerdict::compliant) << share << result.message;
    const std::array<double, 4> truth = {scene.mass1, scene.mass2, scene.clearance, scene.restitution};
    for (std::size_t k = 0; k < truth.size(); ++k)
      EXPECT_NEAR(result.parameters[k].value, truth[k], 1e-5 * truth[k]) << share << " " << k << result.message;
    ASSERT_EQ(result.contact.size(), 4u);
    EXPECT_NEAR(result.contact[0].value, scene.contact_time, 1e-6 * scene.contact_time / share) << share;
    const CompliantContact contact = contact_of(scene);
    // Stiffness goes with the square of the time.
    EXPECT_NEAR(result.contact[1].value / contact.stiffness(), 1, 1e-5 + 3e-6 / share) << share;
    EXPECT_NEAR(result.contact[2].value / contact.damping(), 1, 1e-5 + 2e-6 / share) << share;
    ASSERT_TRUE(result.compliant_contact());
    EXPECT_EQ(result.compliant_contact()->stiffness(), result.contact[1].value);
  }
}

// Exact data of hard contacts: what is left of the time is rounding, and the intervals hold for none at all.
TEST(ContactIdentification, HardContactsAreScenesOfContactTimeZero) {
  const Scene scene;
  std::vector<MeasuredDescribingFunction> curves;
  for (const double force : forces) {
    const double unit = std::sqrt(force / scene.mass2 / scene.clearance);
    const auto omega = log_grid(1.8 * unit, 3 * unit, 15);
    const backlash::TwoMassSystem system(scene.mass1, scene.mass2, scene.clearance, scene.restitution);
    curves.push_back({describing_function_sweep(system, force, omega, {}).data(), force});
  }
  const auto result = identify_scene(curves, with_mass1(scene));
  ASSERT_TRUE(result.usable()) << result.message;
  EXPECT_LT(result.contact[0].value, 1e-6 * period(scene, 1.8, 3)) << result.message;
  EXPECT_EQ(result.contact[0].ci95_lower, 0) << result.message;
  EXPECT_NEAR(result.parameters[3].value, scene.restitution, 1e-6) << result.message;
  EXPECT_TRUE(result.parameters[3].identified) << result.message;
  EXPECT_TRUE(std::isnan(result.contact[1].ci95_upper));
}

// Binomial(40, 0.95): 33 or fewer have a chance of 0.2 %.
TEST(ContactIdentification, IntervalsHoldMassesGapRestitutionAndTime) {
  constexpr int trials = 40;
  support::Random random(3);
  Scene scene;
  scene.contact_time = 0.01 * period(scene, 1.8, 2.6);
  const std::array<double, 4> truth = {scene.mass1, scene.mass2, scene.clearance, scene.restitution};
  std::array<int, 5> held{};
  for (int trial = 0; trial < trials; ++trial) {
    const auto result = identify_scene(measured(scene, 1.8, 2.6, 15, 0.01, random), with_mass1(scene));
    ASSERT_TRUE(result.usable()) << result.message;
    const auto holds = [](const backlash::SceneEstimate& estimate, double value) {
      return estimate.ci95_lower <= value && value <= estimate.ci95_upper;
    };
    for (std::size_t k = 1; k < truth.size(); ++k) held[k] += holds(result.parameters[k], truth[k]) ? 1 : 0;
    held[4] += holds(result.contact[0], scene.contact_time) ? 1 : 0;
  }
  for (std::size_t k = 1; k < held.size(); ++k) EXPECT_GE(held[k], 34) << k;
}

TEST(ContactIdentification, AFixedTimeIsHeldAndBadOnesAreRefused) {
  support::Random random(4);
  Scene scene;
  scene.contact_time = 0.02 * period(scene, 1.8, 2.6);
  const auto curves = measured(scene, 1.8, 2.6, 10, 0, random);
  auto options = with_mass1(scene);
  options.constraints.push_back({"contact_time", scene.contact_time, {}, {}, {}});
  const auto result = identify_scene(curves, options);
  EXPECT_TRUE(result.contact[0].fixed);
  EXPECT_NEAR(result.contact[0].value, scene.contact_time, 1e-15);
  EXPECT_NEAR(result.parameters[3].value, scene.restitution, 1e-5) << result.message;
  options.contact = ContactModel::hard;
  expect_invalid_argument([&] { return identify_scene(curves, options); }, {"contact_time", "hard"});
  options.contact = ContactModel::automatic;
  options.constraints.back().fixed = -1;
  expect_invalid_argument([&] { return identify_scene(curves, options); }, {"contact_time", "-1", "0 or greater"});
  expect_invalid_argument([] { return backlash::contact_model_from_string("soft"); }, {"soft", "hard", "auto"});
}

}  // namespace
