// SPDX-License-Identifier: BSD-3-Clause
#include "backlash/compliant/compliant_bodies.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>
#include <string>
#include <vector>

#include "backlash/compliant/compliant_history.hpp"
#include "backlash/loops/forced_bodies.hpp"
#include "compliant/compliant_orbit.hpp"
#include "compliant/symmetric_compliant_orbit.hpp"
#include "support/compliant_integration.hpp"
#include "support/expect_invalid_argument.hpp"
#include "support/random.hpp"

namespace {

using backlash::CompliantBodies;
using backlash::CompliantContact;
using backlash::DescribingFunctionPoint;
using backlash::Protocol;
using backlash::Regime;
using backlash::SweepOptions;
using compliant_test::Integration;
using compliant_test::Machine;

// All kinds: free, viscous, springs, dry friction on the load, on the drive, on both.
constexpr std::size_t kinds = 6;

/// Contacts of 3 to 60 times the frequency of the force, forces around those that cross the gap.
Machine random_machine(support::Random& random, std::size_t kind) {
  Machine m;
  m.mass1 = random.log_uniform(0.4, 3);
  m.mass2 = random.log_uniform(0.4, 3);
  m.clearance = random.log_uniform(0.01, 1);
  m.omega = random.log_uniform(3, 30);
  const double reduced = m.mass1 * m.mass2 / (m.mass1 + m.mass2);
  const CompliantContact contact = CompliantContact::from_frequency(m.omega * random.log_uniform(3, 60),
                                                                    random.log_uniform(0.03, 1.5), m.mass1, m.mass2);
  m.stiffness = contact.stiffness();
  m.damping = contact.damping();
  m.force = random.log_uniform(0.15, 3) * m.mass2 * m.clearance * m.omega * m.omega;
  if (kind == 1 || kind == 2) {
    m.viscous1 = reduced * m.omega * random.uniform(0.02, 0.5);
    m.viscous2 = reduced * m.omega * random.uniform(0.02, 0.5);
  }
  if (kind == 2) {
    m.spring1 = m.mass1 * m.omega * m.omega * random.uniform(0.02, 0.5);
    m.spring2 = m.mass2 * m.omega * m.omega * random.uniform(0.02, 0.5);
  }
  if (kind == 3 || kind == 5) m.coulomb1 = m.force * random.uniform(0.02, 0.3);
  if (kind == 4 || kind == 5) m.coulomb2 = m.force * random.uniform(0.02, 0.3);
  return m;
}

DescribingFunctionPoint point_of(const Machine& m, Protocol protocol) {
  SweepOptions options;
  options.protocol = protocol;
  options.threads = 1;
  return backlash::bodies_describing_function(m.bodies(), m.force, {m.omega}, options).points.front();
}

using History = backlash::CompliantHistory;

DescribingFunctionPoint point_of_drive(const Machine& m) {
  SweepOptions options;
  options.output = backlash::Output::x2;
  return backlash::bodies_describing_function(m.bodies(), m.force, {m.omega}, options).points.front();
}

/// Six periods with samples at eighths of them.
History history_of(const Machine& m, const backlash::LoopStart& start) {
  History history = backlash::compliant_history(m.bodies(), m.force, m.omega, start, 0, 6, 8);
  EXPECT_TRUE(history.complete);
  std::erase_if(history.rows, [](const auto& row) { return row.event != backlash::CompliantEvent::sample; });
  return history;
}

/// Largest difference of positions from an integration, over the clearance.
double difference_from_integration(const Machine& m, const History& history, const backlash::LoopStart& start) {
  Integration motion(m, start);
  double largest = 0;
  for (const auto& row : history.rows) {
    motion.advance(static_cast<compliant_test::Real>(row.time));
    const auto& z = motion.state();
    largest = std::max({largest, std::abs(row.x1 - static_cast<double>(z[Integration::x1])),
                        std::abs(row.x2 - static_cast<double>(z[Integration::x2]))});
  }
  return largest / m.clearance;
}

/// By which the motion magnifies a change of its start.
double growth_of(const Machine& m, const History& history, const backlash::LoopStart& start) {
  constexpr double change = 1e-9;
  backlash::LoopStart beside = start;
  beside.x2 += change * m.clearance;
  const History other = history_of(m, beside);
  double largest = 1;
  for (std::size_t i = 0; i < history.rows.size(); ++i) {
    const auto &a = history.rows[i], &b = other.rows[i];
    largest = std::max(
        {largest, std::abs(a.x1 - b.x1) / (change * m.clearance), std::abs(a.x2 - b.x2) / (change * m.clearance)});
  }
  return largest;
}

void expect_motions_of_an_integration(std::size_t count, std::uint64_t seed) {
  support::Random random(seed);
  for (std::size_t i = 0; i < count; ++i) {
    const Machine m = random_machine(random, i % kinds);
    const double rate = m.clearance * m.omega * random.uniform(-1, 1);
    const double y = m.clearance * random.uniform(-0.5, 0.5);
    const backlash::LoopStart start{0, 0.1 * rate, y, 1.1 * rate};
    const History history = history_of(m, start);
    // A flight in contact rounds speeds at 1e-16 of the clearance times its frequency, up to 60 times that of the
    // force; until the end that moves positions by 2e-13 of the clearance, some hundred flights by 1e-11 at most.
    // Roundings of positions are magnified.
    EXPECT_LT(difference_from_integration(m, history, start), 1e-11 + 1e-14 * growth_of(m, history, start))
        << "scene " << i;
  }
}

TEST(CompliantBodies, MotionsAreThoseOfAnIntegration) {
  expect_motions_of_an_integration(36, 20);
}

TEST(CompliantBodies, TwoHundredRandomMotionsAreThoseOfAnIntegration) {
  expect_motions_of_an_integration(204, 21);
}

// The integration begins on what the motion has come to, needs no Newton step, and finds that it repeats.
TEST(CompliantBodies, DescribingFunctionIsThePhasorOfAnIntegration) {
  support::Random random(5);
  std::array<int, kinds> compared{};
  for (std::size_t i = 0; i < 60; ++i) {
    const Machine m = random_machine(random, i % kinds);
    const DescribingFunctionPoint point = point_of(m, Protocol::contact_at_rest);
    if (point.regime != Regime::symmetric && point.regime != Regime::periodic) continue;
    // Near a bifurcation transients take longer than the test.
    if (!(point.lyapunov_exponent < -1e-3)) continue;
    // Irregular transients take some hundred periods, regular ones then leave e^-40.
    const int transient = 600 + static_cast<int>(std::ceil(40 / -std::max(-40.0, point.lyapunov_exponent)));
    const backlash::LoopStart rest{0.25 * m.clearance, 0, -0.25 * m.clearance, 0};
    const auto end = backlash::compliant_history(m.bodies(), m.force, m.omega, rest, transient, 1, 1).end;
    Integration motion(m, end);
    const long double period = 2 * std::numbers::pi_v<long double> / m.omega;
    motion.advance(point.period * period);
    const std::complex<double> value = motion.take_value(point.period);
    ++compared[i % kinds];
    // Dry friction lets bodies drift, and the gap is known to the rounding of the distance from the start.
    const double rounding = 1e-15 * (1 + std::abs(end.x1) / m.clearance);
    EXPECT_LT(std::abs(point.value - value), (1e-12 + 1e3 * rounding) * std::abs(value)) << "scene " << i;
  }
  for (std::size_t kind = 0; kind < kinds; ++kind) EXPECT_GE(compared[kind], 2) << "kind " << kind;
}

TEST(CompliantBodies, TakeFromTheForceWhatContactsAndFrictionCost) {
  support::Random random(6);
  int orbits = 0;
  for (std::size_t i = 0; i < 120; ++i) {
    const Machine m = random_machine(random, i % kinds);
    const DescribingFunctionPoint point = point_of(m, Protocol::two_impact);
    if (point.impacts_per_period == 0 || !(point.energy_defect >= 0)) continue;
    ++orbits;
    // Rounding of some thousand pieces, and of the orbit's closure.
    EXPECT_LT(point.energy_defect, 1e-12) << "scene " << i;
  }
  EXPECT_GT(orbits, 60);
}

// The damping of a heavily damped contact stops the bodies within a time of m/c, long before the force turns.
TEST(CompliantBodies, KeepEnergyWhereDampingStopsThemAtOnce) {
  Machine m;
  for (const double damping : {1e3, 1e5, 1e7}) {
    m.damping = damping;
    const DescribingFunctionPoint point = point_of(m, Protocol::two_impact);
    EXPECT_GT(point.impacts_per_period, 0);
    // The speed is rounded at 1e-16 of the sizes of states, and the damping multiplies it.
    EXPECT_LT(point.energy_defect, 1e-12 + 1e-16 * damping) << damping;
  }
}

// A load that only the contact moves takes energy from it, and gives it to friction alone.
TEST(CompliantBodies, AreDrivenNeverDrivers) {
  support::Random random(7);
  for (std::size_t i = 0; i < 60; ++i) {
    const Machine m = random_machine(random, i % kinds);
    const DescribingFunctionPoint point = point_of(m, Protocol::two_impact);
    SweepOptions options;
    options.protocol = Protocol::two_impact;
    options.output = backlash::Output::x2;
    const auto drive = backlash::bodies_describing_function(m.bodies(), m.force, {m.omega}, options).points.front();
    // Mean power of the force, omega F^2/2 Im(-N2), is what is lost.
    EXPECT_LE(drive.value.imag(), drive.uncertainty + 1e-14 * std::abs(drive.value)) << "scene " << i;
    EXPECT_EQ(drive.period, point.period);
    // Free bodies share the force's power: M1 x1 + M2 x2 = -F/omega^2, so that Im N1 = -M2/M1 Im N2.
    if (m.bodies().are_free() && point.regime != Regime::averaged) {
      EXPECT_NEAR(point.value.imag(), -m.mass2 / m.mass1 * drive.value.imag(), 1e-12 * std::abs(drive.value));
    }
  }
}

// N of bodies whose contacts take no time is the limit of stiff ones at one damping ratio, in first order of 1/wc:
// differences halve with it, and 2 N(2 wc) - N(wc) is in second order.
TEST(CompliantBodies, TendToHardOnesInFirstOrder) {
  struct Case {
    double mass1, mass2, viscous1, viscous2, clearance, force, omega, zeta;
  };
  for (const Case& c : {Case{1, 1, 0.2, 0.3, 0.3, 40, 21, 0.180858308}, Case{2, 1, 1, 0.5, 0.3, 40, 20, 0.35},
                        Case{1, 1.5, 0.1, 2, 0.2, 30, 22, 0.12}, Case{1, 1, 0, 0, 0.3, 40, 20, 0.180858308}}) {
    Machine m;
    m.mass1 = c.mass1;
    m.mass2 = c.mass2;
    m.viscous1 = c.viscous1;
    m.viscous2 = c.viscous2;
    m.clearance = c.clearance;
    m.force = c.force;
    m.omega = c.omega;
    SweepOptions options;
    options.protocol = Protocol::two_impact;
    std::complex<double> hard;
    std::vector<std::complex<double>> values;
    for (double ratio = 64; ratio <= 1024; ratio *= 2) {
      const CompliantContact contact = CompliantContact::from_frequency(ratio * c.omega, c.zeta, c.mass1, c.mass2);
      m.stiffness = contact.stiffness();
      m.damping = contact.damping();
      hard = backlash::bodies_describing_function(m.bodies().hard(), c.force, {c.omega}, options).points.front().value;
      values.push_back(point_of(m, Protocol::two_impact).value);
    }
    for (std::size_t i = 0; i + 1 < values.size(); ++i) {
      // The next term moves the ratio 2 of differences by about twice the difference itself.
      const double share = std::abs(values[i] - hard) / std::abs(hard);
      EXPECT_NEAR(std::abs(values[i] - hard) / std::abs(values[i + 1] - hard), 2, 4 * share);
      // What extrapolation leaves is of the size of the share squared.
      EXPECT_LT(std::abs(2.0 * values[i + 1] - values[i] - hard), 8 * share * share * std::abs(hard));
    }
  }
}

// gamma, zeta and kappa are all that N (M1 + M2) omega^2 depends on for free bodies of one ratio of masses.
TEST(CompliantBodies, OfTheSameGroupsHaveTheSameDescribingFunction) {
  support::Random random(8);
  for (int i = 0; i < 12; ++i) {
    const Machine m = random_machine(random, 0);
    Machine other = m;
    const double mass = 1.7, time = 0.3, length = 5;
    other.mass1 *= mass;
    other.mass2 *= mass;
    other.clearance *= length;
    other.omega /= time;
    other.stiffness *= mass / (time * time);
    other.damping *= mass / time;
    other.force *= mass * length / (time * time);
    const DescribingFunctionPoint one = point_of(m, Protocol::two_impact), two = point_of(other, Protocol::two_impact);
    if (one.impacts_per_period == 0 || one.regime == Regime::averaged) continue;
    EXPECT_LT(std::abs(two.value * mass / (time * time) - one.value), 1e-11 * std::abs(one.value)) << i;
  }
}

// Momentum: M1 X1 + M2 X2 = -(F - R1 - R2)/omega^2, R the fundamental of the dry friction, which is +-Fc between the
// reversals that the motion tells.  The force's work -pi F Im X2 then is what N of body 1 shows of all losses.
TEST(CompliantBodies, ShowInNWhatContactsAndFrictionTake) {
  for (const auto& [friction1, friction2] : {std::pair{2.0, 0.0}, {0.0, 2.0}, {4.0, 1.0}}) {
    Machine m;
    m.stiffness = 2e4;
    m.damping = 50;
    m.coulomb1 = friction1;
    m.coulomb2 = friction2;
    SweepOptions options;
    options.protocol = Protocol::two_impact;
    const auto phasor = [&](backlash::Output output) {
      options.output = output;
      const auto point = backlash::bodies_describing_function(m.bodies(), m.force, {m.omega}, options).points.front();
      EXPECT_EQ(point.period, 1);
      EXPECT_GT(point.impacts_per_period, 0);
      return point.value * m.force;
    };
    const std::complex<double> x1 = phasor(backlash::Output::x1), x2 = phasor(backlash::Output::x2);
    const backlash::LoopStart fast{0, 0, 0, m.clearance * m.omega};
    const History history = backlash::compliant_history(m.bodies(), m.force, m.omega, fast, 2500, 1, 1);
    const auto resisted = [&](double friction, bool is_first) {
      const auto turned = [&](double time) { return std::polar(1.0, -m.omega * time); };
      double from = 0, sign = (is_first ? history.rows.front().v1 : history.rows.front().v2) > 0 ? 1 : -1;
      std::complex<double> sum = 0;
      for (const auto& row : history.rows) {
        EXPECT_NE(row.event, backlash::CompliantEvent::stick1);
        EXPECT_NE(row.event, backlash::CompliantEvent::stick2);
        if (row.event != (is_first ? backlash::CompliantEvent::reversal1 : backlash::CompliantEvent::reversal2))
          continue;
        sum += sign * (turned(row.time) - turned(from));
        from = row.time;
        sign = -sign;
      }
      sum += sign * (1.0 - turned(from));
      // 2/T times the integral of e^{-j omega t}.
      return friction * sum / std::complex<double>(0, -std::numbers::pi);
    };
    const std::complex<double> friction = resisted(friction1, true) + resisted(friction2, false);
    const double square = m.omega * m.omega;
    // Times of events are known to rounding, as orbits are.
    EXPECT_LT(std::abs(m.mass1 * x1 + m.mass2 * x2 + (m.force - friction) / square), 1e-11 * m.force / square);
    const double work = -std::numbers::pi * m.force * x2.imag();
    const double loss =
        (m.mass2 * work / std::numbers::pi + m.force * friction.imag() / square) / (m.mass1 * std::norm(x1));
    const double found = (-m.force / x1).imag();
    EXPECT_NEAR(loss, found, 1e-11 * std::abs(m.force / x1));
  }
}

// Little dry friction moves N in first order.
TEST(CompliantBodies, LoseDryFrictionInFirstOrder) {
  Machine m;
  m.viscous1 = 0.4;
  const std::complex<double> without = point_of(m, Protocol::two_impact).value;
  std::vector<double> differences;
  for (const double share : {2e-3, 1e-3, 5e-4}) {
    m.coulomb1 = m.coulomb2 = share * m.force;
    differences.push_back(std::abs(point_of(m, Protocol::two_impact).value - without) / std::abs(without));
  }
  ASSERT_LT(differences.back(), 0.01);
  ASSERT_GT(differences.back(), 1e-6);
  for (std::size_t i = 0; i + 1 < differences.size(); ++i)
    EXPECT_NEAR(differences[i] / differences[i + 1], 2, 4 * differences[i] + 0.02);
}

using backlash::detail::CompliantFlow;
using backlash::detail::CompliantMode;
using backlash::detail::CompliantRun;

// Of the map of (gap, rate) over `periods` from mid-gap.
double determinant(const Machine& m, double rate, int periods, double* rounding, double* time_in_contact = nullptr) {
  const CompliantFlow flow(m.bodies(), {m.force, m.omega}, backlash::Output::x1, 1e-9, 1);
  const Eigen::VectorXd state = flow.start({0, -0.5 * rate, 0, 0.5 * rate});
  CompliantRun run(flow, state, flow.mode_of(state));
  run.begin_transition();
  if (time_in_contact != nullptr)
    run.visit_pieces([&](const CompliantFlow::Regime&, const CompliantMode& mode, const auto&, double length) {
      if (mode.contact != 0) *time_in_contact += length;
    });
  EXPECT_TRUE(run.follow(periods));
  EXPECT_GT(run.contacts(), 2);
  const Eigen::MatrixXd& map = run.transition();
  // Each of the two products is rounded.
  *rounding = 1e-14 * std::abs(map(0, 0) * map(1, 1));
  return map(0, 0) * map(1, 1) - map(0, 1) * map(1, 0);
}

// Without damping and friction the map keeps areas; with damping it shrinks them by exp(-c/m t), t the time in contact,
// as contacts and separations keep areas themselves.
TEST(CompliantBodies, MapsKeepAreasButForTheTimeInDampedContact) {
  Machine m;
  m.damping = 0;
  double rounding = 0;
  for (const double rate : {0.0, 1.0, 3.0}) {
    const double found = determinant(m, rate, 2, &rounding);
    EXPECT_NEAR(found, 1, 1e-12 + rounding) << rate;
  }
  m.damping = 8;
  for (const double rate : {0.0, 1.0, 3.0}) {
    double time = 0;
    const double found = determinant(m, rate, 2, &rounding, &time);
    EXPECT_NEAR(std::log(found), -m.damping * (1 / m.mass1 + 1 / m.mass2) * time, 1e-12 + rounding / found) << rate;
  }
}

// Three equations in closed form against the flow from event to event, whose contacts are steps of a polynomial.
TEST(CompliantBodies, SymmetricOrbitsOfTwoContactsAreThoseOfTheFlow) {
  support::Random random(11);
  int compared = 0, refused = 0;
  for (int i = 0; i < 60; ++i) {
    const Machine m = random_machine(random, 0);
    const CompliantBodies bodies = m.bodies();
    const CompliantFlow flow(bodies, {m.force, m.omega}, backlash::Output::x1, 1e-9, 1);
    const Eigen::VectorXd start = flow.start({0, 0, 0, m.clearance * m.omega});
    CompliantRun run(flow, start, flow.mode_of(start));
    ASSERT_TRUE(run.follow(200));
    const auto orbit = backlash::detail::closed_orbit(flow, run.state(), run.mode(), 1);
    if (!orbit || orbit->contacts != 2 || !(orbit->largest_multiplier < 0.999)) continue;
    const auto reading = backlash::detail::read_orbit(*orbit, bodies, {m.force, m.omega}, backlash::Output::x1, 1e-9);
    if (!reading.is_symmetric) continue;
    const DescribingFunctionPoint point = point_of(m, Protocol::two_impact);
    const auto free = backlash::free_contact(bodies.contact(), m.mass1, m.mass2);
    // Gap and wall differ by little, and are rounded before the stiffness multiplies them.
    const double rounding = 1e-13 + 5e-16 * std::pow(free.frequency / m.omega, 2);
    // The flow gives its harmonics by integrals, the closed form by parts.
    if (std::abs(point.value - reading.value) > 0.01 * std::abs(reading.value)) {
      ++refused;  // another orbit attracts too, or the sufficient conditions of the closed form do not hold
      continue;
    }
    ++compared;
    EXPECT_LT(std::abs(point.value - reading.value), 10 * rounding * std::abs(reading.value)) << i;
    EXPECT_NEAR(point.third_harmonic_ratio, reading.third_ratio, 1e3 * rounding) << i;
    EXPECT_NEAR(std::exp(point.lyapunov_exponent), orbit->largest_multiplier, 1e-8) << i;
    EXPECT_LT(point.energy_defect, 1e-12) << i;
  }
  EXPECT_GT(compared, 10);
  EXPECT_LT(refused, 3);
}

// An orbit that is given presses all the time of its contacts: by its solution in complex exponentials, sampled.
TEST(CompliantBodies, SymmetricOrbitsPressThroughoutTheirContacts) {
  using Long = std::complex<long double>;
  support::Random random(12);
  int orbits = 0;
  for (int i = 0; i < 400; ++i) {
    const backlash::detail::CompliantGroups groups{random.log_uniform(0.05, 2), random.log_uniform(1.5, 60),
                                                   random.log_uniform(0.01, 0.95)};
    const auto orbit = backlash::detail::symmetric_compliant_orbit_from_hard(groups);
    if (!orbit) continue;
    ++orbits;
    const long double nu = groups.nu, zeta = groups.zeta, gamma = groups.gamma;
    const Long one(0, 1), root = nu * Long(-zeta, std::sqrt(1 - zeta * zeta));
    const Long amplitude = gamma / Long(nu * nu - 1, 2 * zeta * nu);
    const Long turn = std::exp(one * Long(orbit->angle));
    // delta = Re(A e^{j tau} + B e^{root t}) is 0 at first, with the rate of the orbit.
    const long double value = -(amplitude * turn).real(), rate = orbit->speed - (one * amplitude * turn).real();
    const Long b(value, (root.real() * value - rate) / root.imag());
    double least = 0;
    for (int k = 0; k <= 400; ++k) {
      const long double t = orbit->duration * static_cast<long double>(k) / 400;
      const Long forced = amplitude * turn * std::exp(one * Long(t)), free = b * std::exp(root * t);
      const long double push = nu * nu * (forced + free).real() + 2 * zeta * nu * (one * forced + root * free).real();
      least = std::min(least, static_cast<double>(push / (nu * orbit->speed)));
    }
    // 0 at the end but for rounding of the orbit: of angles, by the frequency of the contact.
    EXPECT_GT(least, -1e-13 * groups.nu) << groups.gamma << " " << groups.nu << " " << groups.zeta;
  }
  EXPECT_GT(orbits, 100);
}

// Of every kind, through contacts, separations, sticks, reversals and slides: columns against central differences.
TEST(CompliantBodies, DerivativesAreThoseOfDifferences) {
  support::Random random(9);
  for (std::size_t i = 0; i < 4 * kinds; ++i) {
    const Machine m = random_machine(random, i % kinds);
    const CompliantFlow flow(m.bodies(), {m.force, m.omega}, backlash::Output::x1, 1e-9, 1);
    const double rate = m.clearance * m.omega * random.uniform(0.3, 1);
    const Eigen::VectorXd start = flow.start({0, 0.1 * rate, 0, 1.1 * rate});
    const auto after = [&](const Eigen::VectorXd& from) {
      CompliantRun run(flow, from, flow.mode_of(from));
      EXPECT_TRUE(run.follow(1));
      return run.state();
    };
    CompliantRun run(flow, start, flow.mode_of(start));
    run.begin_transition();
    ASSERT_TRUE(run.follow(1));
    const Eigen::MatrixXd& map = run.transition();
    for (const Eigen::Index k : {CompliantFlow::gap, CompliantFlow::rate, CompliantFlow::x1, CompliantFlow::v1}) {
      // A change by h errs by h^2 of what bends over an event, and by 1e-16/h.
      const double h = 1e-7 * flow.sizes()[k];
      Eigen::VectorXd less = start, more = start;
      less[k] -= h;
      more[k] += h;
      const Eigen::VectorXd column = (after(more) - after(less)) / (2 * h);
      for (const Eigen::Index r : {CompliantFlow::gap, CompliantFlow::rate, CompliantFlow::x1, CompliantFlow::v1}) {
        const double unit = flow.sizes()[r] / flow.sizes()[k];
        const double size = map.col(k).cwiseQuotient(flow.sizes()).head(4).cwiseAbs().maxCoeff() * flow.sizes()[k];
        EXPECT_NEAR(column[r] / unit, map(r, k) / unit, 1e-5 * (1 + size)) << "scene " << i << ": " << r << ", " << k;
      }
    }
  }
}

// A drive whose dry friction exceeds the force stands still, and one that just slides does not reach the walls.
TEST(CompliantBodies, RestWhereDryFrictionHoldsThem) {
  Machine m;
  m.coulomb2 = 1.1 * m.force;
  SweepOptions options;
  options.output = backlash::Output::x2;
  const auto at = [&] {
    return backlash::bodies_describing_function(m.bodies(), m.force, {m.omega}, options).points.front();
  };
  EXPECT_EQ(at().value, 0.0);
  EXPECT_EQ(at().regime, Regime::free);
  // A load that friction holds is a wall: the drive meets it on both sides, and body 1 does not move.
  m.coulomb2 = 0;
  m.coulomb1 = 1e3 * m.force;
  options.output = backlash::Output::x1;
  EXPECT_EQ(at().regime, Regime::symmetric);
  // Rounding of what the force alone would move the body by.
  EXPECT_LT(std::abs(at().value), 1e-14 / (m.mass1 * m.omega * m.omega));
  options.output = backlash::Output::x2;
  Machine wall = m;
  wall.coulomb1 = 0;
  wall.mass1 = 1e12;
  // A load of 10^12 times the mass moves by that share.
  const DescribingFunctionPoint held = at(), heavy = point_of_drive(wall);
  EXPECT_LT(std::abs(held.value - heavy.value), 1e-9 * std::abs(held.value));
  m.coulomb1 = 0;
  // Without rests the friction is a square wave s(angle) that begins to oppose at the angle where the speed is 0, and
  // half a period later is again: sin(angle) = -pi Fc/(2 F).  Its fundamental is 4/pi e^{-j (angle + pi/2)}.
  const double share = 0.3;
  m.coulomb2 = share * m.force;
  m.clearance = 10;
  m.stiffness = 1e3;
  const double angle = -std::asin(std::numbers::pi / 2 * share);
  const std::complex<double> square = 4 / std::numbers::pi * std::polar(1.0, -angle - std::numbers::pi / 2);
  const std::complex<double> expected = -(1.0 - share * square) / (m.mass2 * m.omega * m.omega);
  // Its transient decays by a constant factor in each of the 64 periods.
  EXPECT_LT(std::abs(at().value - expected), 1e-9 * std::abs(expected));
  EXPECT_LT(std::abs(at().value - expected), at().uncertainty + 1e-12 * std::abs(expected));
}

TEST(CompliantBodies, RefuseWhatTheyCannotBe) {
  using support::expect_invalid_argument;
  const CompliantContact contact(1e4, 20);
  const auto free = backlash::free_mass(1);
  expect_invalid_argument([&] { CompliantBodies(free, free, 0, contact); }, {"clearance is 0", "positive"});
  expect_invalid_argument(
      [&] {
        CompliantBodies(free, free, 1, contact, {-1, 0});
      },
      {"friction1 is -1", "not negative"});
  expect_invalid_argument([&] { CompliantBodies(free, free, 1, contact, {0, NAN}); }, {"friction2 is nan"});
  const CompliantBodies fast(free, free, 1, CompliantContact(1e13, 20));
  const CompliantBodies damped(free, free, 1, CompliantContact(1, 1e10));
  for (const auto* each : {&fast, &damped})
    expect_invalid_argument(
        [&] {
          (void)backlash::bodies_describing_function(*each, 1, {1, 2}, {});
        },
        {"contact_stiffness is ", "contact_damping ", "at most 1e6 times omega = 1"});
  const CompliantBodies bodies(free, free, 1, contact);
  expect_invalid_argument([&] { (void)backlash::bodies_describing_function(bodies, 0, {1}, {}); }, {"force_amplitude"});
  expect_invalid_argument([&] { (void)backlash::bodies_describing_function(bodies, 1, {2, 1}, {}); }, {"omega[1]"});
  expect_invalid_argument([&] { (void)backlash::compliant_history(bodies, 1, 1, {}, -1, 1, 1); }, {"skip is -1"});
  expect_invalid_argument([&] { (void)backlash::compliant_history(bodies, 1, 1, {}, 0, 0, 1); }, {"periods is 0"});
  expect_invalid_argument(
      [&] {
        (void)backlash::compliant_history(bodies, 1, 1, {0, NAN}, 0, 1, 1);
      },
      {"start v1 is nan"});
}

}  // namespace
