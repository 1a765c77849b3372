// SPDX-License-Identifier: BSD-3-Clause
#include "backlash/loops/linear_bodies.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <string>
#include <vector>

#include "backlash/loops/forced_bodies.hpp"
#include "backlash/loops/limit_cycles.hpp"
#include "backlash/loops/predicted_cycles.hpp"
#include "loops/equations/forced_orbits.hpp"
#include "loops/motions/loop_run.hpp"
#include "loops/motions/realised_loop.hpp"
#include "support/expect_invalid_argument.hpp"
#include "support/expected_stability.hpp"
#include "support/random.hpp"

namespace backlash {
namespace {

using Complex = std::complex<double>;
using frac::FractionalTransferFunction;
constexpr double pi = std::numbers::pi;

FractionalTransferFunction parsed(const std::string& formula) {
  return FractionalTransferFunction::parse(formula);
}

LimitCycleOptions within(double from, double to) {
  LimitCycleOptions options;
  options.range = FrequencyRange{from, to};
  return options;
}

TEST(LinearBodies, AreRefusedWhereAnImpactIsNotDecidedByMasses) {
  const FractionalTransferFunction mass = free_mass(1);
  const auto refuse = [&](const std::string& receptance, const std::vector<std::string>& parts) {
    support::expect_invalid_argument([&] { (void)LinearBodies(parsed(receptance), mass, 1, .5); }, parts);
    support::expect_invalid_argument([&] { (void)LinearBodies(mass, parsed(receptance), 1, .5); }, parts);
  };
  refuse("1/(s + 1)", {"s^-1", "1/(M s^2)", "infinite speed"});
  refuse("1/(s^2.2 + 1)", {"s^-2.2", "no impulse"});
  refuse("-1/(s^2 + 1)", {"M = -1"});
  refuse("exp(-0.1 s)/(s^2 + s)", {"dead time"});
  refuse("1", {"s^0"});
  EXPECT_EQ(LinearBodies(parsed("2/(3 s^2 + s)"), mass, 1, .5).system().mass1(), 1.5);
}

// The receptance of a free mass with a factor that cancels goes the way of all others, through the inverse Laplace
// transform, which is asked for 1e-12 of what the closed forms give; a plain one is the free mass itself.
TEST(LinearBodies, FreeOnesAreTheFreeMasses) {
  const struct {
    const char* controller;
    Output measured;
  } cases[] = {{"1 + s^0.5", Output::x1},
               {"exp(-0.05 s) (1 + s^0.5)", Output::x1},
               {"(1 + s)/(1 + 0.1 s)", Output::x1},
               {"4 + 3/s + s", Output::x2}};
  int asymmetric = 0;
  for (const auto& each : cases) {
    const ControlLoop masses({1, 2, 1, .6}, parsed(each.controller), each.measured);
    const ControlLoop plain(LinearBodies(parsed("1/s^2"), parsed("1/(2 s^2)"), 1, .6), parsed(each.controller),
                            each.measured);
    const ControlLoop detour(LinearBodies(parsed("(s + 3)/(s^3 + 3 s^2)"), parsed("(s + 2)/(2 s^3 + 4 s^2)"), 1, .6),
                             parsed(each.controller), each.measured);
    EXPECT_TRUE(plain.bodies().are_free());
    EXPECT_FALSE(detour.bodies().are_free());
    const LimitCycles expected = symmetric_cycles(masses, within(.1, 10));
    const LimitCycles same = symmetric_cycles(plain, within(.1, 10));
    const LimitCycles found = symmetric_cycles(detour, within(.1, 10));
    ASSERT_FALSE(expected.cycles.empty()) << each.controller;
    ASSERT_EQ(same.cycles.size(), expected.cycles.size()) << each.controller;
    ASSERT_EQ(found.cycles.size(), expected.cycles.size()) << each.controller;
    for (std::size_t i = 0; i < found.cycles.size(); ++i) {
      const SymmetricCycle& known = expected.cycles[i];
      const SymmetricCycle& cycle = found.cycles[i];
      EXPECT_EQ(same.cycles[i].omega, known.omega);
      EXPECT_EQ(same.cycles[i].impulse, known.impulse);
      EXPECT_NEAR(cycle.omega, known.omega, 1e-12 * known.omega) << each.controller;
      EXPECT_NEAR(cycle.impulse, known.impulse, 4e-12 * known.impulse) << each.controller;
      EXPECT_EQ(cycle.admissible, known.admissible) << each.controller << cycle.reason << known.reason;
      EXPECT_EQ(cycle.stability.unstable_multipliers, known.stability.unstable_multipliers) << each.controller;
      EXPECT_NEAR(std::abs(cycle.stability.dominant), std::abs(known.stability.dominant), 1e-8) << each.controller;
    }
    const std::vector<PredictedCycle> predicted = predicted_limit_cycles(masses, FrequencyRange{.1, 10});
    const std::vector<PredictedCycle> as_bodies = predicted_limit_cycles(detour, FrequencyRange{.1, 10});
    ASSERT_EQ(as_bodies.size(), predicted.size()) << each.controller;
    for (std::size_t i = 0; i < predicted.size(); ++i) {
      EXPECT_NEAR(as_bodies[i].omega, predicted[i].omega, 1e-11 * predicted[i].omega);
      EXPECT_NEAR(as_bodies[i].force_amplitude, predicted[i].force_amplitude, 1e-10 * predicted[i].force_amplitude);
      EXPECT_EQ(as_bodies[i].faster_orbit, predicted[i].faster_orbit);
      EXPECT_EQ(as_bodies[i].stable, predicted[i].stable);
      EXPECT_NEAR(as_bodies[i].third_harmonic, predicted[i].third_harmonic, 1e-10);
      EXPECT_EQ(as_bodies[i].symmetric, predicted[i].symmetric);
      EXPECT_EQ(as_bodies[i].admissible, predicted[i].admissible);
      asymmetric += predicted[i].symmetric ? 0 : 1;
    }
  }
  EXPECT_GT(asymmetric, 0);
}

// Bodies with friction b and a spring k to ground under PID action: state (x1, x1', x2, x2', integral of x).
struct DampedLoop {
  double mass1, b1, k1, mass2, b2, k2, restitution, kp, ki, kd;
  Output measured;

  using Matrix = Eigen::Matrix<double, 5, 5>;

  [[nodiscard]] ControlLoop loop() const {
    std::vector<frac::PowerTerm> terms{{kd, 1}, {kp, 0}};
    if (ki > 0) terms.push_back({ki, -1});
    const auto body = [](double mass, double b, double k) {
      return FractionalTransferFunction({{1, 0}}, {{mass, 2}, {b, 1}, {k, 0}});
    };
    return {LinearBodies(body(mass1, b1, k1), body(mass2, b2, k2), 1, restitution),
            FractionalTransferFunction(terms, {{1, 0}}), measured};
  }
  [[nodiscard]] Matrix rates() const {
    Matrix a = Matrix::Zero();
    const int read = measured == Output::x1 ? 0 : 2;
    a(0, 1) = a(2, 3) = a(4, read) = 1;
    a(1, 0) = -k1 / mass1;
    a(1, 1) = -b1 / mass1;
    a(3, 2) = -k2 / mass2;
    a(3, 3) = -b2 / mass2;
    a(3, read) -= kp / mass2;
    a(3, read + 1) -= kd / mass2;
    a(3, 4) = -ki / mass2;
    return a;
  }
  // e^{A t} by its series over a 1024th of it.
  [[nodiscard]] Matrix flight(double time) const {
    const Matrix step = rates() * (time / 1024);
    Matrix sum = Matrix::Identity();
    Matrix power = sum;
    for (int i = 1; i < 20; ++i) {
      power = power * step / i;
      sum += power;
    }
    for (int i = 0; i < 10; ++i) sum = (sum * sum).eval();
    return sum;
  }
  [[nodiscard]] Matrix impact() const {
    const double m = mass1 * mass2 / (mass1 + mass2);
    Matrix impact = Matrix::Identity();
    impact(1, 1) -= (1 + restitution) * m / mass1;
    impact(1, 3) += (1 + restitution) * m / mass1;
    impact(3, 1) += (1 + restitution) * m / mass2;
    impact(3, 3) -= (1 + restitution) * m / mass2;
    return impact;
  }
};

DampedLoop random_loop(support::Random& random, int i) {
  DampedLoop each{};
  each.mass1 = random.log_uniform(.3, 3);
  each.mass2 = random.log_uniform(.3, 3);
  each.b1 = i % 4 == 0 ? 0 : random.log_uniform(.003, .3);
  each.b2 = random.log_uniform(.003, .3);
  each.k1 = i % 2 == 0 ? 0 : random.log_uniform(.1, 3);
  each.k2 = i % 3 == 0 ? 0 : random.log_uniform(.1, 3);
  each.restitution = random.uniform(.1, .9);
  each.kp = random.log_uniform(.1, 30);
  each.ki = i % 5 == 0 ? random.log_uniform(.001, 1) : 0;
  each.kd = random.log_uniform(.3, 3);
  each.measured = i % 7 == 0 ? Output::x2 : Output::x1;
  return each;
}

// A cycle is a state that an impact and the flight of a half period turn into its opposite, and the state before the
// impact says how large it is; its multipliers are those of the saltation matrix.
TEST(LinearBodies, WithFrictionAndSpringsHaveTheCyclesOfTheStateSpace) {
  support::Random random(21);
  int unstable = 0, stable = 0, left = 0;
  for (int i = 0; i < 50; ++i) {
    const DampedLoop each = random_loop(random, i);
    const ControlLoop loop = each.loop();
    for (const SymmetricCycle& cycle : symmetric_cycles(loop, within(.3, 60)).cycles) {
      const double tau = pi / cycle.omega;
      const DampedLoop::Matrix flight = each.flight(tau);
      const DampedLoop::Matrix repeat = flight * each.impact() + DampedLoop::Matrix::Identity();
      Eigen::JacobiSVD<DampedLoop::Matrix> decomposition(repeat, Eigen::ComputeFullV);
      const auto values = decomposition.singularValues();
      // Without integral action its state has the multiplier -1 too: it is left out of the state.
      Eigen::Matrix<double, 5, 1> before = decomposition.matrixV().col(4);
      if (each.ki == 0) {
        const Eigen::Matrix4d small = repeat.topLeftCorner<4, 4>();
        Eigen::JacobiSVD<Eigen::Matrix4d> four(small, Eigen::ComputeFullV);
        EXPECT_LT(four.singularValues()(3), 1e-9 * four.singularValues()(0)) << i;
        before << four.matrixV().col(3), 0;
      } else {
        EXPECT_LT(values(4), 1e-9 * values(0)) << i;
      }
      Eigen::Matrix<double, 1, 5> gap;
      gap << -1, 0, 1, 0, 0;
      before *= .5 / (gap * before).value();
      EXPECT_NEAR(before(3) - before(1), cycle.impulse * (1 / each.mass1 + 1 / each.mass2) / (1 + each.restitution),
                  1e-7 * std::abs(before(3) - before(1)))
          << i;
      const Eigen::Matrix<double, 5, 1> rate = each.rates() * before;
      const DampedLoop::Matrix saltation =
          each.impact() + (each.rates() * (each.impact() * before) - each.impact() * rate) * gap / (gap * rate).value();
      const Eigen::VectorXcd all = (-(flight * saltation)).eval().eigenvalues();
      const std::vector<Complex> multipliers(all.data(), all.data() + all.size());
      const auto [outside, largest, next_to_circle] = each.ki == 0 ? support::expected_stability(multipliers, {1, -1})
                                                                   : support::expected_stability(multipliers, {1});
      // Too near the circle, too small to be looked for, or said not to be told.
      if (next_to_circle < 3e-3 || std::abs(largest) < .06 || cycle.stability.unstable_multipliers < 0) {
        ++left;
        continue;
      }
      EXPECT_EQ(cycle.stability.unstable_multipliers, outside) << i;
      EXPECT_NEAR(std::abs(cycle.stability.dominant), std::abs(largest), 1e-5 * std::abs(largest))
          << i << ' ' << cycle.stability.dominant << ' ' << largest;
      (outside > 0 ? unstable : stable) += 1;
    }
  }
  EXPECT_GT(unstable, 10);
  EXPECT_GT(stable, 20);
  EXPECT_LT(left, 10);
}

// A spring without damping vibrates for ever in flight: its poles lie on the circle along which multipliers are
// counted.  Damping of 1e-3 moves them off it and the multipliers by less than that times the half period, here 0.12 s,
// times their slope, so that the verdict stays and moduli agree to 1e-3.
TEST(LinearBodies, WithoutDampingAreJudgedAsThoseWithLittle) {
  for (const char* controller : {"18 + 3 s^1.3", "25 + 3.5 s^1.45"}) {
    const auto stable_of = [&](const std::string& damping) {
      const ControlLoop loop(LinearBodies(parsed("1/(s^2 + " + damping + " s + 1.3)"),
                                          parsed("1/(s^2 + " + damping + " s + 2.1)"), .01, .5),
                             parsed(controller));
      const auto found = backlash::symmetric_cycles(loop, {backlash::FrequencyRange{15, 60}, 1});
      std::vector<double> moduli;
      for (const auto& cycle : found.cycles)
        if (cycle.admissible && cycle.stability.stable) moduli.push_back(std::abs(cycle.stability.dominant));
      return moduli;
    };
    const std::vector<double> without = stable_of("0"), with = stable_of("0.001");
    ASSERT_EQ(without.size(), 1U) << controller;
    ASSERT_EQ(with.size(), 1U) << controller;
    EXPECT_NEAR(without[0], with[0], 1e-3) << controller;
  }
}

// Fractional friction: the equations of the cycle in sums over odd harmonics, term by term.  h falls as k^-2 like free
// masses, whose sums are pi^2/8, and what friction c s^a adds as k^(a - 4): 40 000 harmonics leave out less than 1e-8.
TEST(LinearBodies, WithFractionalFrictionMeetTheSumsOverHarmonics) {
  const LinearBodies bodies(parsed("1/(s^2 + 0.2 s^0.5)"), parsed("1/(1.5 s^2 + 0.1 s^0.8 + 0.3)"), 1, .7);
  int cycles = 0;
  for (const char* controller : {"2 + s^0.6", "exp(-0.1 s) (2 + s^0.6)", "(3 + s)/(1 + 0.05 s)"}) {
    const ControlLoop loop(bodies, parsed(controller));
    for (const SymmetricCycle& cycle : symmetric_cycles(loop, within(.3, 20)).cycles) {
      double s = 0, v = 0;
      for (int k = 79'999; k > 0; k -= 2) {
        const double w = k * cycle.omega;
        const Complex g1 = bodies.load().response(w), g2 = bodies.drive().response(w);
        const Complex h = g1 + g2 + loop.controller().response(w) * g1 * g2;
        s += h.real() + (1 + 1 / 1.5) / (w * w);
        v += w * h.imag();
      }
      s -= (1 + 1 / 1.5) * pi * pi / (8 * cycle.omega * cycle.omega);
      const double jump = 1 + 1 / 1.5;
      EXPECT_NEAR(2 * cycle.omega / pi * v, jump * .3 / (2 * 1.7), 1e-5 * jump) << controller;
      EXPECT_NEAR(cycle.impulse * (-4 * cycle.omega / pi * s), 1, 1e-7) << controller;
      ++cycles;
    }
  }
  EXPECT_GE(cycles, 3);
}

// Per period the controller's work is what the impacts and the friction take.  The work of a harmonic of the force is
// pi Re(force conj(velocity))/omega; friction takes the work that a body gets and keeps: that of all forces on it, the
// impulses among them, as springs and masses give theirs back.  Harmonics fall as k^(q - 3): 4000 of them leave out
// about 1/8000^(2 - q).
TEST(LinearBodies, TakeFromTheControllerWhatImpactsAndFrictionCost) {
  const ControlLoop loops[] = {
      {LinearBodies(parsed("1/(s^2 + 0.1 s)"), parsed("1/(2 s^2 + 0.2 s)"), 1, .6), parsed("3 + 2 s^0.7")},
      {LinearBodies(parsed("1/(s^2 + 0.1 s^0.4 + 0.5)"), free_mass(1), 1, .6), parsed("3 + s^0.8")},
      {LinearBodies(parsed("1/(s^2 + 0.01 s)"), parsed("1/(s^2 + 0.01 s)"), .1, .9), parsed("4 + 3/s + s"),
       Output::x2}};
  for (const ControlLoop& loop : loops) {
    LimitCycleOptions options = within(.1, 30);
    options.harmonics = 4000;
    const LimitCycles found = symmetric_cycles(loop, options);
    EXPECT_FALSE(found.cycles.empty());
    for (const SymmetricCycle& cycle : found.cycles) {
      double given = 0, taken = 0;
      const double kick = 2 * cycle.omega / pi * cycle.impulse;
      for (const CycleHarmonic& harmonic : cycle.harmonics) {
        const Complex turn(0, harmonic.order * cycle.omega);
        given += (harmonic.force * std::conj(turn * harmonic.x2)).real();
        taken += (kick * std::conj(turn * harmonic.x1)).real();
        taken += ((harmonic.force - kick) * std::conj(turn * harmonic.x2)).real();
      }
      const double share = pi / (2 * cycle.omega);
      const double impacts = impact_energy_loss(loop.system(), cycle.impact_speed);
      EXPECT_GT(taken, 0);
      EXPECT_NEAR(given * share, impacts + taken * share, 1e-3 * impacts);
    }
  }
}

// N of bodies with viscous friction under a sine force, from event-driven simulations with exact flights, to the digits
// that those agree in.
TEST(LinearBodies, ForcedOrbitsAreThoseOfTheSimulation) {
  const struct {
    double mass1, mass2, b1, b2, clearance, restitution, force, omega, impulse;
    Complex describing_function;
  } known[] = {
      {1, 1, .2, .3, .3, .6, 40, 21, 3.09640424, {-.0021346597, .0009745525}},
      {2, 1, 1, .5, .3, .4, 40, 20, 3.81034854, {-.0011761839, .0009558678}},
      {1, 1.5, .1, 2, .2, .7, 30, 22, 2.29839538, {-.0020289609, .0008934188}},
  };
  for (const auto& each : known) {
    const LinearBodies bodies(FractionalTransferFunction({{1, 0}}, {{each.mass1, 2}, {each.b1, 1}}),
                              FractionalTransferFunction({{1, 0}}, {{each.mass2, 2}, {each.b2, 1}}), each.clearance,
                              each.restitution);
    const detail::ForcedOrbits orbits(bodies, each.omega);
    const detail::ForcedOrbits::Orbit orbit = orbits.at(each.force, true);
    EXPECT_NEAR(orbit.impulse, each.impulse, 6e-9 * each.impulse);
    EXPECT_NEAR(std::abs(orbit.force), each.force, 1e-12 * each.force);
    EXPECT_LT(std::abs(orbit.x1 / orbit.force - each.describing_function), 7e-11);  // half a digit in both parts
  }
}

SweepOptions two_impact(Output output) {
  SweepOptions options;
  options.protocol = Protocol::two_impact;
  options.output = output;
  return options;
}

// Bodies whose factor cancels are free masses that go the way of all others: where the sweep of the free masses follows
// the symmetric orbit, N and stability agree, to the 1e-11 of the inverse transform.
TEST(ForcedBodies, AreTheFreeMassesWhereTheyAreFree) {
  const TwoMassSystem masses(1, 2, .3, .6);
  const LinearBodies detour(parsed("(s + 3)/(s^3 + 3 s^2)"), parsed("(s + 2)/(2 s^3 + 4 s^2)"), .3, .6);
  std::vector<double> omega;
  for (int i = 0; i < 30; ++i) omega.push_back(8 + i);
  SweepOptions options;
  options.protocol = Protocol::two_impact;
  for (const Output output : {Output::x1, Output::x2}) {
    options.output = output;
    const DescribingFunctionSweep known = describing_function_sweep(masses, 40, omega, options);
    const DescribingFunctionSweep found = bodies_describing_function(detour, 40, omega, two_impact(output));
    const DescribingFunctionSweep plain =
        bodies_describing_function(LinearBodies(free_mass(1), free_mass(2), .3, .6), 40, omega, two_impact(output));
    int compared = 0;
    for (std::size_t i = 0; i < omega.size(); ++i) {
      EXPECT_EQ(plain.points[i].value, known.points[i].value);
      EXPECT_EQ(known.points[i].regime == Regime::symmetric, found.points[i].regime == Regime::symmetric) << omega[i];
      if (known.points[i].regime != Regime::symmetric || !found.points[i].usable()) continue;
      const double size = std::abs(known.points[i].value);
      EXPECT_LT(std::abs(found.points[i].value - known.points[i].value), 1e-11 * size);
      EXPECT_NEAR(found.points[i].third_harmonic_ratio, known.points[i].third_harmonic_ratio, 1e-11);
      EXPECT_NEAR(found.points[i].lyapunov_exponent, known.points[i].lyapunov_exponent, 1e-6);
      ++compared;
    }
    EXPECT_GT(compared, 10);
  }
}

// A run of bodies with friction and springs, flight by flight with matrix exponentials and impacts found on a fine grid
// of each period, settles on the orbit: amplitude and phase of the fundamental of both bodies.
TEST(ForcedBodies, AreWhatASimulationSettlesOn) {
  for (const bool has_springs : {false, true}) {
    const double m1 = 1, m2 = 1.5, b1 = .4, b2 = .6, k1 = has_springs ? 30 : 0, k2 = has_springs ? 12 : 0;
    const double restitution = .6, force = 60, omega = 20, half = .15;
    const LinearBodies bodies(FractionalTransferFunction({{1, 0}}, {{m1, 2}, {b1, 1}, {k1, 0}}),
                              FractionalTransferFunction({{1, 0}}, {{m2, 2}, {b2, 1}, {k2, 0}}), 2 * half, restitution);
    const DescribingFunctionPoint x1 =
        bodies_describing_function(bodies, force, {omega}, two_impact(Output::x1)).points[0];
    const DescribingFunctionPoint x2 =
        bodies_describing_function(bodies, force, {omega}, two_impact(Output::x2)).points[0];
    ASSERT_EQ(x1.regime, Regime::symmetric);
    // State (x1, x1', x2, x2', cos, sin) of the force; steps of a 4096th of a period.
    using Matrix = Eigen::Matrix<double, 6, 6>;
    using State = Eigen::Matrix<double, 6, 1>;
    Matrix a = Matrix::Zero();
    a(0, 1) = a(2, 3) = 1;
    a(1, 0) = -k1 / m1;
    a(1, 1) = -b1 / m1;
    a(3, 2) = -k2 / m2;
    a(3, 3) = -b2 / m2;
    a(3, 4) = force / m2;
    a(4, 5) = -omega;
    a(5, 4) = omega;
    const auto flight = [&](double time) {
      Matrix sum = Matrix::Identity(), power = sum;
      for (int i = 1; i < 12; ++i) {
        power = power * a * (time / i);
        sum += power;
      }
      return sum;
    };
    constexpr int steps = 4096, periods = 400, read = 8;
    const double step = 2 * pi / omega / steps;
    const Matrix whole = flight(step);
    State state = State::Zero();
    state(4) = 1;
    state(3) = 1;
    Complex sum1 = 0, sum2 = 0;
    for (int i = 0; i < periods * steps; ++i) {
      State next = whole * state;
      double left = step;
      while (std::abs(next(2) - next(0)) > half && std::abs(state(2) - state(0)) <= half * (1 + 1e-12)) {
        double low = 0, high = left;
        for (int k = 0; k < 50; ++k) {
          const double middle = .5 * (low + high);
          const State there = flight(middle) * state;
          (std::abs(there(2) - there(0)) > half ? high : low) = middle;
        }
        if (low == 0) break;
        state = flight(low) * state;
        const double common = (m1 * state(1) + m2 * state(3)) / (m1 + m2), rate = state(3) - state(1);
        state(1) = common + restitution * rate * m2 / (m1 + m2);
        state(3) = common - restitution * rate * m1 / (m1 + m2);
        left -= low;
        next = flight(left) * state;
      }
      state = next;
      if (i < (periods - read) * steps) continue;
      // The means of the bodies, which drift without springs, leave the fundamental over whole periods.
      const Complex turn(state(4), -state(5));
      sum1 += state(0) * turn;
      sum2 += state(2) * turn;
    }
    const double count = .5 * read * steps;
    // The rule over a kink errs by the square of the step, and so do rests of the transient of that length.
    EXPECT_LT(std::abs(sum1 / count / force - x1.value), 2e-5 * std::abs(x1.value)) << has_springs;
    EXPECT_LT(std::abs(sum2 / count / force - x2.value), 2e-5 * std::abs(x2.value)) << has_springs;
  }
}

// The same bodies on the way from event to event meet the sweep of the free masses in every kind of motion: orbits of
// four and of 14 impacts, of two periods, in contact every period, symmetric, free and chaotic.  Frequencies and starts
// are such that both know but one long-run motion.
TEST(ForcedBodies, FollowEveryMotionOfTheFreeMasses) {
  const TwoMassSystem masses(1, 2, .3, .6);
  const LinearBodies detour(parsed("(s + 3)/(s^3 + 3 s^2)"), parsed("(s + 2)/(2 s^3 + 4 s^2)"), .3, .6);
  const std::vector<double> omega{.5, 2, 3.1, 3.7, 5.4, 7, 7.3, 8.8, 10.5, 12, 16, 20};
  std::vector<Regime> regimes;
  for (const Output output : {Output::x1, Output::x2}) {
    for (const Protocol protocol : {Protocol::mid_gap_at_rest, Protocol::contact_at_rest}) {
      SweepOptions options;
      options.protocol = protocol;
      options.output = output;
      const DescribingFunctionSweep known = describing_function_sweep(masses, 40, omega, options);
      const DescribingFunctionSweep found = bodies_describing_function(detour, 40, omega, options);
      for (std::size_t i = 0; i < omega.size(); ++i) {
        const DescribingFunctionPoint& point = found.points[i];
        const DescribingFunctionPoint& other = known.points[i];
        ASSERT_EQ(point.regime, other.regime) << omega[i];
        regimes.push_back(point.regime);
        const double size = std::abs(other.value);
        if (point.regime == Regime::averaged) {
          // Both are means with 95 % half widths, of motions that are independent of each other.
          EXPECT_LT(std::abs(point.value - other.value), 2 * std::hypot(point.uncertainty, other.uncertainty))
              << omega[i];
          EXPECT_LT(point.uncertainty, .02 * size);
          EXPECT_NEAR(point.impacts_per_period, other.impacts_per_period, .1);
          continue;
        }
        // The inverse transform is known to 1e-11; rests are followed for a period, flight by flight.
        EXPECT_LE(std::abs(point.value - other.value), 2e-11 * size) << omega[i];
        EXPECT_EQ(point.period, other.period) << omega[i];
        EXPECT_EQ(point.impacts_per_period, other.impacts_per_period) << omega[i];
        if (point.regime == Regime::chatter || point.regime == Regime::free) continue;
        EXPECT_NEAR(point.third_harmonic_ratio, other.third_harmonic_ratio, 1e-10) << omega[i];
        // Of more than six impacts it is not said where it is not certain.
        if (point.impacts_per_period > 6 && std::isnan(point.lyapunov_exponent)) continue;
        EXPECT_NEAR(point.lyapunov_exponent, other.lyapunov_exponent, 1e-6) << omega[i];
      }
    }
  }
  for (const Regime regime : {Regime::chatter, Regime::periodic, Regime::averaged, Regime::symmetric, Regime::free}) {
    EXPECT_NE(std::find(regimes.begin(), regimes.end(), regime), regimes.end()) << to_string(regime);
  }
}

// Friction that is fractional: closed orbits of the whole memory against a mean of the simulated motion, whose powers
// are sums of exponentials.
TEST(ForcedBodies, ClosedOrbitsWithFractionalFrictionAreWhatTheMotionSettlesOn) {
  const LinearBodies bodies(parsed("1/(s^2 + 0.4 s^0.5)"), parsed("1/(1.5 s^2 + 0.3 s)"), .3, .6);
  const double force = 40, omega = 8;
  SweepOptions options;
  options.protocol = Protocol::mid_gap_at_rest;
  const DescribingFunctionPoint point = bodies_describing_function(bodies, force, {omega}, options).points.front();
  ASSERT_EQ(point.regime, Regime::periodic);
  EXPECT_EQ(point.impacts_per_period, 4);
  const detail::RealisedLoop loop(bodies, {force, omega}, Output::x1, 1e-9);
  detail::LoopRun run(loop, {});
  Complex sum = 0;
  constexpr int settle = 400, read = 40;
  for (int i = 1; i <= settle + read; ++i) {
    const double until = i * 2 * pi / omega;
    while (run.time() < until) run.advance(until);
    const Complex phasor = run.take_phasor();
    if (i > settle) sum += phasor;
  }
  // The memory of the start decays as t^-1.5, in 400 periods below 1e-6 of the motion.
  EXPECT_LT(std::abs(sum / (read * force) - point.value), 1e-5 * std::abs(point.value));
}

TEST(ForcedBodies, FollowWhatTheSymmetricOrbitIsNot) {
  const LinearBodies bodies(parsed("1/(s^2 + 0.2 s)"), parsed("1/(s^2 + 0.3 s)"), .3, .6);
  const DescribingFunctionSweep found = bodies_describing_function(bodies, 1, {.5, 20}, two_impact(Output::x1));
  EXPECT_TRUE(found.points[0].usable());
  EXPECT_NE(found.points[0].regime, Regime::symmetric);
  EXPECT_EQ(found.points[1].regime, Regime::free);
  EXPECT_EQ(found.points[1].value, Complex(0));
  support::expect_invalid_argument([&] { (void)bodies_describing_function(bodies, -1, {1}, {}); }, {"force"});
  support::expect_invalid_argument([&] { (void)bodies_describing_function(bodies, 1, {2, 1}, {}); }, {"omega"});
}

}  // namespace
}  // namespace backlash
