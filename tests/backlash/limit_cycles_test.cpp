// SPDX-License-Identifier: BSD-3-Clause
#include "backlash/loops/limit_cycles.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <complex>
#include <numbers>
#include <string>
#include <vector>

#include "loops/equations/gap_response.hpp"
#include "loops/equations/power_train.hpp"
#include "support/expect_invalid_argument.hpp"
#include "support/expected_stability.hpp"
#include "support/random.hpp"

namespace backlash {
namespace {

using Complex = std::complex<double>;
constexpr double pi = std::numbers::pi;

ControlLoop loop_of(const std::string& controller, double restitution, double clearance = 1, double mass1 = 1,
                    double mass2 = 1) {
  return {TwoMassSystem(mass1, mass2, clearance, restitution), frac::FractionalTransferFunction::parse(controller)};
}

SymmetricCycle only_admissible_cycle(const ControlLoop& loop) {
  std::vector<SymmetricCycle> found;
  for (const SymmetricCycle& cycle : symmetric_cycles(loop).cycles) {
    if (cycle.admissible) found.push_back(cycle);
  }
  EXPECT_EQ(found.size(), 1U);
  return found.empty() ? SymmetricCycle{} : found.front();
}

// Cycles whose frequency, impulse and amplitudes were found apart from this code and confirmed by an event-driven
// simulation with full memory.  The digits given are all right, so that they bound the difference.
struct KnownCycle {
  const char* controller;
  double restitution, omega, impulse, amplitude_x1, amplitude_force;
};
constexpr KnownCycle known_cycles[] = {
    {"1 + s", .6, pi, 1.04347826087, .211452904993, .697140839533},
    {"5 + s", .6, pi, 1.26315789474, .255969306044, 1.51151131004},
    {"1 + s^0.5", .6, 1.58131922051927, .732128806289, .294746100569, .615426757265},
    {"0.5 + s^0.7", .3, 1.15243212901326, .534099050233, .295043853101, .414231056033},
    {"1 + s^0.5 + 0.3/s^0.6", .6, 1.32422402744822, .784011240865, .37691285413, .77451732802},
    {"2 + 1.5 s^0.9", .8, 8.22531524987729, 2.67694931805, .207189489244, 2.17429098489}};

TEST(LimitCycles, AreThoseOfTheTable) {
  for (const KnownCycle& known : known_cycles) {
    const SymmetricCycle cycle = only_admissible_cycle(loop_of(known.controller, known.restitution));
    EXPECT_NEAR(cycle.omega, known.omega, 1e-14 * known.omega * 4) << known.controller;
    EXPECT_NEAR(cycle.impulse, known.impulse, 6e-12 * known.impulse) << known.controller;
    EXPECT_NEAR(std::abs(cycle.harmonics[0].x1), known.amplitude_x1, 2e-11 * known.amplitude_x1) << known.controller;
    EXPECT_NEAR(std::abs(cycle.harmonics[0].force), known.amplitude_force, 2e-11 * known.amplitude_force)
        << known.controller;
    EXPECT_TRUE(cycle.stability.stable) << known.controller;
  }
}

TEST(LimitCycles, RootOfNegativeImpulseIsListedWithTheReason) {
  const LimitCycles found = symmetric_cycles(loop_of("1 + s^0.5 + 0.3/s^0.6", .6));
  ASSERT_EQ(found.cycles.size(), 2U);
  EXPECT_NEAR(found.cycles[0].omega, .399582568845, 1e-12);
  EXPECT_FALSE(found.cycles[0].admissible);
  EXPECT_NE(found.cycles[0].reason.find("pull"), std::string::npos);
  EXPECT_TRUE(found.certain);
}

TEST(LimitCycles, MultipliersAreThoseOfTheTable) {
  const Complex well_damped = only_admissible_cycle(loop_of("1 + s", .6)).stability.dominant;
  EXPECT_NEAR(well_damped.real(), -.627123, 1e-6);
  EXPECT_NEAR(std::abs(well_damped.imag()), .483350, 1e-6);
  const Complex stiff = only_admissible_cycle(loop_of("5 + s", .6)).stability.dominant;
  EXPECT_NEAR(stiff.real(), -.230280, 1e-6);
  EXPECT_NEAR(std::abs(stiff.imag()), .793594, 1e-6);
  const CycleStability lost = symmetric_cycles(loop_of("20 + s", .6)).cycles[0].stability;
  EXPECT_FALSE(lost.stable);
  EXPECT_EQ(lost.unstable_multipliers, 1);
  EXPECT_NEAR(lost.dominant.real(), -5.637, 5e-4);
  EXPECT_EQ(lost.loss, StabilityLoss::symmetry_breaking);
}

// w = (pi/2) kd (1 + eps)/((M1 + M2)(1 - eps)), whatever kp.  The frequency is one root of two terms: a few roundings.
TEST(LimitCycles, OfProportionalAndDerivativeActionHaveTheFrequencyInClosedForm) {
  support::Random random(1);
  for (int i = 0; i < 100; ++i) {
    const double mass1 = random.log_uniform(.01, 100), mass2 = random.log_uniform(.01, 100);
    const double restitution = random.uniform(0, .99), kp = random.log_uniform(.01, 100);
    const double kd = random.log_uniform(.01, 100);
    const ControlLoop loop(TwoMassSystem(mass1, mass2, 1, restitution),
                           frac::FractionalTransferFunction({{kd, 1}, {kp, 0}}, {{1, 0}}));
    const LimitCycles found = symmetric_cycles(loop);
    ASSERT_EQ(found.cycles.size(), 1U);
    const double omega = pi / 2 * kd * (1 + restitution) / ((mass1 + mass2) * (1 - restitution));
    EXPECT_NEAR(found.cycles[0].omega, omega, 1e-13 * omega);
  }
}

TEST(LimitCycles, ScaleWithTheClearance) {
  const SymmetricCycle one = only_admissible_cycle(loop_of("1 + s^0.5", .6));
  const SymmetricCycle other = only_admissible_cycle(loop_of("1 + s^0.5", .6, 1e-5));
  EXPECT_EQ(other.omega, one.omega);
  EXPECT_EQ(other.stability.dominant, one.stability.dominant);
  EXPECT_NEAR(other.impulse, 1e-5 * one.impulse, 1e-20);
  EXPECT_NEAR(std::abs(other.harmonics[2].force), 1e-5 * std::abs(one.harmonics[2].force), 1e-19);
}

std::string random_controller(support::Random& random, double delay) {
  std::string formula = std::to_string(random.log_uniform(.1, 10)) + " + " +
                        std::to_string(random.log_uniform(.1, 10)) + " s^" + std::to_string(random.uniform(.2, .7)) +
                        " + " + std::to_string(random.log_uniform(.01, .1)) + "/s^" +
                        std::to_string(random.uniform(.1, 1.2));
  if (delay > 0) formula = "exp(-" + std::to_string(delay) + " s) (" + formula + ")";
  return formula;
}

// Sums over odd harmonics as they stand, for h = G1 + G2 + C G1 G2.  The parts without C are sums in closed form; those
// with C fall as k^(q - 3) and alternate or turn with the dead time.
struct PlainSums {
  double s = 0;  // Re h
  double v = 0;  // k w Im h
};
PlainSums plain_sums(const ControlLoop& loop, double omega, int count) {
  const double mass1 = loop.system().mass1(), mass2 = loop.system().mass2();
  PlainSums sums;
  for (int k = 2 * count - 1; k > 0; k -= 2) {
    const double w = k * omega;
    const Complex part = loop.controller().response(w) / (mass1 * mass2 * w * w * w * w);
    sums.s += part.real();
    sums.v += w * part.imag();
  }
  sums.s -= (1 / mass1 + 1 / mass2) * pi * pi / (8 * omega * omega);
  return sums;
}

// Orders up to 0.7 less one of up to 1.2 of the other terms: what 40 000 harmonics leave out of the sum of k^(q - 3) is
// (80 000)^(q - 2)/2, below 1e-6, and of that of k^(q - 4) next to nothing.
TEST(LimitCycles, MeetTheSumsOverHarmonicsTermByTerm) {
  support::Random random(2);
  int cycles = 0;
  for (int i = 0; i < 12; ++i) {
    const double delay = i % 2 == 0 ? 0 : random.log_uniform(.02, 3);
    const double restitution = random.uniform(0, .9);
    const ControlLoop loop =
        loop_of(random_controller(random, delay), restitution, 1, random.log_uniform(.5, 2), random.log_uniform(.5, 2));
    const double jump = 1 / loop.system().mass1() + 1 / loop.system().mass2();
    for (const SymmetricCycle& cycle : symmetric_cycles(loop).cycles) {
      // Roots of very low frequency, which are no cycles, leave the plain sums to rounding: 1/w^3 of it.
      if (cycle.omega < 1e-2) continue;
      const PlainSums sums = plain_sums(loop, cycle.omega, 40'000);
      const double asked = jump * (1 - restitution) / (2 * (1 + restitution));
      EXPECT_NEAR(2 * cycle.omega / pi * sums.v, asked, 1e-5 * jump) << loop.controller().formula();
      EXPECT_NEAR(cycle.impulse * (-4 * cycle.omega / pi * sums.s), 1, 1e-8);
      ++cycles;
    }
  }
  EXPECT_GT(cycles, 10);
}

// Dead time to 1e-12: for a controller s^0.3 its sums fall as k^-2.7 and turn, so 2 000 000 harmonics leave out less
// than 1e-16.
TEST(LimitCycles, WithDeadTimeMeetTheSumsToTwelveDigits) {
  const ControlLoop loop = loop_of("exp(-0.7 s) (2 + s^0.3)", .5);
  const LimitCycles found = symmetric_cycles(loop);
  ASSERT_FALSE(found.cycles.empty());
  for (const SymmetricCycle& cycle : found.cycles) {
    const PlainSums sums = plain_sums(loop, cycle.omega, 100'000);
    // The equation for the frequency, over its own slope.
    const double step = 1e-6 * cycle.omega;
    const double slope = (plain_sums(loop, cycle.omega + step, 20'000).v * (cycle.omega + step) -
                          plain_sums(loop, cycle.omega - step, 20'000).v * (cycle.omega - step)) /
                         (2 * step);
    const double defect = cycle.omega * sums.v - pi / 2 * (2 * .5 / (2 * 1.5));
    EXPECT_LT(std::abs(defect / slope), 1e-12 * cycle.omega);
    EXPECT_NEAR(cycle.impulse * (-4 * cycle.omega / pi * sums.s), 1, 1e-12);
  }
}

// Per half period the force gives what an impact takes: (1 - eps^2)/2 mu v^2, with mu the reduced mass.  The work is
// the sum over harmonics of Re(force conj(velocity))/2 per unit of time, which fall as k^(q - 3), q the highest order:
// the sum over 4000 of them errs by about 1/8000^(2 - q).
TEST(LimitCycles, TakeFromTheControllerWhatTheImpactsCost) {
  for (const KnownCycle& known : known_cycles) {
    LimitCycleOptions options;
    options.harmonics = 4000;
    const ControlLoop loop = loop_of(known.controller, known.restitution);
    for (const SymmetricCycle& cycle : symmetric_cycles(loop, options).cycles) {
      double power = 0;
      for (const CycleHarmonic& harmonic : cycle.harmonics) {
        const Complex velocity = Complex(0, harmonic.order * cycle.omega) * harmonic.x2;
        power += 0.5 * (harmonic.force * std::conj(velocity)).real();
      }
      const double loss = impact_energy_loss(loop.system(), cycle.impact_speed);
      EXPECT_NEAR(power * pi / cycle.omega, loss, 1e-4 * loss) << known.controller;
    }
  }
}

// Half-period map of a PID loop by the saltation matrix: state (x1, x1', x2, x2', integral of the measured position).
std::vector<Complex> multipliers_by_saltation(const ControlLoop& loop, double kp, double ki, double kd, double omega) {
  const double mass1 = loop.system().mass1(), mass2 = loop.system().mass2(), eps = loop.system().restitution();
  using Matrix = Eigen::Matrix<double, 5, 5>;
  const int measured = loop.measured() == Output::x1 ? 0 : 2;
  Matrix a = Matrix::Zero();
  a(0, 1) = a(2, 3) = a(4, measured) = 1;
  a(3, measured) = -kp / mass2;
  a(3, measured + 1) = -kd / mass2;
  a(3, 4) = -ki / mass2;
  // e^{a tau} by its series over a 256th of it, squared eight times.
  Matrix flight = Matrix::Identity();
  Matrix power = flight;
  for (int i = 1; i < 20; ++i) {
    power = power * a * (pi / omega / 256 / i);
    flight += power;
  }
  for (int i = 0; i < 8; ++i) flight = (flight * flight).eval();
  const double m = mass1 * mass2 / (mass1 + mass2);
  Matrix impact = Matrix::Identity();
  impact(1, 1) -= (1 + eps) * m / mass1;
  impact(1, 3) += (1 + eps) * m / mass1;
  impact(3, 1) += (1 + eps) * m / mass2;
  impact(3, 3) -= (1 + eps) * m / mass2;
  // State before the impact: the flight after it gives its mirror image.
  Eigen::FullPivLU<Matrix> repeat(flight * impact + Matrix::Identity());
  repeat.setThreshold(1e-9);
  const Eigen::Matrix<double, 5, 1> before = repeat.kernel().col(0);
  Eigen::Matrix<double, 1, 5> gap;
  gap << -1, 0, 1, 0, 0;
  const Eigen::Matrix<double, 5, 1> rate = a * before;
  const Matrix saltation = impact + (a * (impact * before) - impact * rate) * gap / (gap * rate).value();
  const Eigen::VectorXcd all = (-(flight * saltation)).eval().eigenvalues();
  return {all.data(), all.data() + all.size()};
}

TEST(LimitCycles, StabilityIsThatOfTheSaltationMatrix) {
  support::Random random(3);
  int unstable = 0, stable = 0;
  for (int i = 0; i < 500; ++i) {
    const double kp = random.log_uniform(.1, 30), kd = random.log_uniform(.3, 3);
    const double ki = i % 3 == 0 ? 0 : random.log_uniform(.001, 1);
    std::vector<frac::PowerTerm> terms{{kd, 1}, {kp, 0}};
    if (ki > 0) terms.push_back({ki, -1});
    const ControlLoop loop(
        TwoMassSystem(random.log_uniform(.3, 3), random.log_uniform(.3, 3), 1, random.uniform(0, .9)),
        frac::FractionalTransferFunction(terms, {{1, 0}}));
    for (const SymmetricCycle& cycle : symmetric_cycles(loop).cycles) {
      // The shift in time has multiplier 1; the integral of a loop without one has -1.
      const std::vector<Complex> all = multipliers_by_saltation(loop, kp, ki, kd, cycle.omega);
      const auto [outside, largest, next_to_circle] =
          ki == 0 ? support::expected_stability(all, {1, -1}) : support::expected_stability(all, {1});
      if (next_to_circle < 3e-3) continue;  // beyond what the path tells from the circle
      EXPECT_EQ(cycle.stability.unstable_multipliers, outside) << i << ": " << loop.controller().formula();
      EXPECT_NEAR(std::abs(cycle.stability.dominant), std::abs(largest), 1e-6 * std::abs(largest)) << i;
      (outside > 0 ? unstable : stable) += 1;
    }
  }
  EXPECT_GT(unstable, 50);
  EXPECT_GT(stable, 50);
}

// The half periods of this loop are known from det(exp(A T/2) R + I) = 0, R the matrix of an impact, to the digits
// given.
TEST(LimitCycles, WithTheDrivenBodyMeasuredAreThoseOfTheImpactMatrix) {
  const ControlLoop loop({1, 1, 1, .9}, frac::FractionalTransferFunction::parse("4 + 3/s + s"), Output::x2);
  const LimitCycles found = symmetric_cycles(loop);
  ASSERT_EQ(found.cycles.size(), 2U);
  EXPECT_NEAR(pi / found.cycles[0].omega, 2.331220, 5e-7);
  EXPECT_NEAR(pi / found.cycles[1].omega, 1.881119, 5e-7);
  for (const SymmetricCycle& cycle : found.cycles) {
    std::vector<Complex> expected = multipliers_by_saltation(loop, 4, 3, 1, cycle.omega);
    std::sort(expected.begin(), expected.end(), [](Complex a, Complex b) { return std::abs(a) > std::abs(b); });
    EXPECT_LT(std::abs(cycle.stability.dominant - expected.front()), 1e-7);
    const auto outside = std::count_if(expected.begin(), expected.end(),
                                       [](Complex multiplier) { return std::abs(multiplier) > 1 + 1e-6; });
    EXPECT_EQ(cycle.stability.unstable_multipliers, outside);
  }
}

// A factor that cancels sends the same controller through the inverse Laplace transform, which is asked for 1e-12.
TEST(LimitCycles, OfARatioAreThoseOfTheSumOfPowersThatItIs) {
  for (const double delay : {0.0, 0.05}) {
    const std::vector<frac::PowerTerm> sum{{1, .5}, {1, 0}};
    const ControlLoop plain({1, 2, 1, .6}, frac::FractionalTransferFunction(sum, {{1, 0}}, delay));
    const ControlLoop ratio(
        {1, 2, 1, .6}, frac::FractionalTransferFunction({{1, 1.5}, {1, 1}, {2, .5}, {2, 0}}, {{1, 1}, {2, 0}}, delay));
    LimitCycleOptions options;
    options.range = FrequencyRange{.1, 10};
    const LimitCycles expected = symmetric_cycles(plain, options);
    const LimitCycles found = symmetric_cycles(ratio, options);
    ASSERT_EQ(found.cycles.size(), expected.cycles.size());
    ASSERT_FALSE(found.cycles.empty());
    for (std::size_t i = 0; i < found.cycles.size(); ++i) {
      EXPECT_NEAR(found.cycles[i].omega, expected.cycles[i].omega, 1e-12 * expected.cycles[i].omega);
      EXPECT_NEAR(found.cycles[i].impulse, expected.cycles[i].impulse, 1e-12 * expected.cycles[i].impulse);
      EXPECT_EQ(found.cycles[i].admissible, expected.cycles[i].admissible);
      EXPECT_EQ(found.cycles[i].stability.unstable_multipliers, expected.cycles[i].stability.unstable_multipliers);
      EXPECT_NEAR(std::abs(found.cycles[i].stability.dominant), std::abs(expected.cycles[i].stability.dominant), 1e-8);
    }
  }
}

TEST(LimitCycles, HardCasesAreSaid) {
  // Nothing makes up for the loss: proportional action and pure integral action have no cycle.
  EXPECT_TRUE(symmetric_cycles(loop_of("3", .6)).cycles.empty());
  EXPECT_TRUE(symmetric_cycles(loop_of("3/s", .6)).cycles.empty());
  // No loss and a controller in phase: any frequency; with derivative action none.
  EXPECT_TRUE(symmetric_cycles(loop_of("3", 1)).any_frequency);
  EXPECT_TRUE(symmetric_cycles(loop_of("3 + s", 1)).cycles.empty());
  EXPECT_FALSE(symmetric_cycles(loop_of("3 + s", 1)).any_frequency);
  support::expect_invalid_argument([] { (void)loop_of("s^2 + 1", .6); }, {"s^2", "slower"});
  support::expect_invalid_argument([] { (void)loop_of("s + 1", .6, 0); }, {"clearance"});
  const ControlLoop late({1, 1, 1, .6}, frac::FractionalTransferFunction::parse("exp(-s) (1 + s)"), Output::x2);
  support::expect_invalid_argument([&] { (void)symmetric_cycles(late); }, {"x2", "dead time"});
  LimitCycleOptions backwards;
  backwards.range = FrequencyRange{2, 1};
  support::expect_invalid_argument([&] { (void)symmetric_cycles(loop_of("1 + s", .6), backwards); }, {"from 2 to 1"});
}

// A controller that answers in phase with the load but for a narrow band, and impacts that lose nothing: the equation
// of the frequency is 0 to rounding over decades, which are no roots; without restitution its terms leave the range of
// numbers, which is none either.
TEST(LimitCycles, RoundingIsNoRoot) {
  for (const double restitution : {0.0, 0.6, 1.0}) {
    const ControlLoop loop({1, 1, 1e200, restitution}, frac::FractionalTransferFunction::parse("s^20/(s^20 + 1)"));
    EXPECT_LE(symmetric_cycles(loop).cycles.size(), 40U) << restitution;
  }
}

// Springs without damping make poles of the sums where an odd harmonic meets a resonance, which are no roots: every
// root that is listed keeps the equation of the frequency when 4000 harmonics are added up as they stand.  What these
// leave out falls as k^-2, to kd/(8000 w) over the masses, and in the figures below to less than 1e-2.
TEST(LimitCycles, ResonancesAreNoRoots) {
  for (const auto& [spring1, spring2] : {std::pair{1.3, 2.1}, {0.4, 0.0}, {0.0, 5.0}}) {
    const double mass1 = 1.1, mass2 = 0.9, restitution = 0.5;
    const auto body = [](double mass, double spring) {
      std::vector<frac::PowerTerm> terms{{mass, 2}};
      if (spring > 0) terms.push_back({spring, 0});
      return frac::FractionalTransferFunction({{1, 0}}, terms);
    };
    const ControlLoop loop({body(mass1, spring1), body(mass2, spring2), 0.02, restitution},
                           frac::FractionalTransferFunction::parse("15 + 2.5 s"));
    LimitCycleOptions options;
    options.range = FrequencyRange{0.05, 20};
    const LimitCycles found = symmetric_cycles(loop, options);
    int cycles = 0;
    for (const SymmetricCycle& cycle : found.cycles) {
      const double kept = (1 - restitution) / (1 + restitution);
      double sum = 0;
      for (int k = 7999; k > 0; k -= 2) {
        const double w = k * cycle.omega;
        const Complex load = loop.bodies().load().response(w), drive = loop.bodies().drive().response(w);
        sum += w * (load + drive + loop.controller().response(w) * load * drive).imag();
      }
      const double jump = 1 / mass1 + 1 / mass2;
      EXPECT_NEAR(2 * cycle.omega / pi * sum, jump * kept / 2, 1e-2 * jump)
          << spring1 << ' ' << spring2 << " at " << cycle.omega;
      cycles += cycle.admissible && cycle.stability.stable;
    }
    EXPECT_EQ(cycles, 1) << spring1 << ' ' << spring2;
  }
}

TEST(LimitCycles, HoldAtExtremeMassesAndOrders) {
  for (const double ratio : {1e-6, 1e6}) {
    const LimitCycles found = symmetric_cycles(loop_of("1 + s^0.5", .6, 1, 1, ratio));
    ASSERT_EQ(found.cycles.size(), 1U);
    EXPECT_TRUE(std::isfinite(found.cycles[0].impulse));
  }
  // Orders next to 0 and 2 against the equation solved by hand: c sin(q pi/2) lambda(3 - q) w^(q - 2) = pi/8.
  for (const double order : {1e-6, 1.9}) {
    const LimitCycles found = symmetric_cycles(loop_of("s^" + std::to_string(order), .6));
    ASSERT_EQ(found.cycles.size(), 1U);
    double lambda = 0;
    constexpr int last = 400'001;  // the rest is an integral, to 1e-9 of it
    for (int k = last; k > 0; k -= 2) lambda += std::pow(k, order - 3);
    lambda += std::pow(last + 1.0, order - 2) / (2 * (2 - order));
    const double omega = std::pow(std::sin(order * pi / 2) * lambda * 8 / pi, 1 / (2 - order));
    EXPECT_NEAR(found.cycles[0].omega, omega, 1e-6 * omega);
  }
}

// The sums over a train of pulses against themselves: the first pulse taken out shifts all others, P(v) = v^a + e^u P(v
// + 1), at points on both sides of the seam between its two methods.
// What a grid is searched by is the exact sum to a thousandth, however near its poles are to the path.
TEST(ImageTrain, RoughRatesAreThoseOfTheExactSums) {
  support::Random random(11);
  for (int i = 0; i < 40; ++i) {
    const std::string damping = std::to_string(random.log_uniform(1e-4, 3));
    const std::string lag = std::to_string(random.log_uniform(1e-3, 10));
    const std::string late = i % 3 == 0 ? "exp(-" + std::to_string(random.log_uniform(.01, 3)) + " s) " : "";
    const std::string order = i % 2 == 0 ? "" : "^" + std::to_string(random.uniform(.3, 1.5));
    const backlash::LinearBodies bodies(frac::FractionalTransferFunction::parse("1/(s^2 + " + damping + " s + 1)"),
                                        backlash::free_mass(1), 1, .5);
    const ControlLoop loop(bodies,
                           frac::FractionalTransferFunction::parse(late + "(2 + s" + order + ")/(1 + " + lag + " s)"));
    const backlash::detail::ImpulseAnswer answer = backlash::detail::gap_response(loop);
    for (int k = 0; k < 20; ++k) {
      const double half_period = random.log_uniform(.03, 30);
      const double exact = backlash::detail::rate_before_impact(answer, half_period);
      EXPECT_NEAR(backlash::detail::rough_rate_before_impact(answer, half_period), exact,
                  1e-3 * (std::abs(exact) + answer.jump))
          << loop.controller().formula() << ' ' << damping << ' ' << half_period;
    }
  }
}

TEST(PowerTrain, IsTheSumOfItsFirstPulseAndTheRest) {
  for (const double a : {1.0, 2.0, 2.5, 3.6}) {
    for (const Complex u : {Complex(-.3, .2), Complex(0, 3), Complex(-1, 3.1), Complex(-2, .5), Complex(-3, 2)}) {
      // e^{n u} (n + 1)^(a - j) as they stand; at Re u < 0 four hundred are enough where they decay.
      const detail::PowerTrain train(a, 1);
      if (u.real() > -.25) continue;
      std::array<Complex, 3> plain{};
      for (int n = 400; n >= 0; --n) {
        for (std::size_t j = 0; j < 3; ++j) {
          plain[j] += std::exp(static_cast<double>(n) * u) * std::pow(n + 1.0, a - static_cast<double>(j));
        }
      }
      for (std::size_t j = 0; j < (a == 1 ? 2U : 3U); ++j) {
        EXPECT_LT(std::abs(train(u)[j] - plain[j]), 1e-12 * std::max(1.0, std::abs(plain[j])))
            << a << ' ' << u << ' ' << j;
      }
    }
  }
}

}  // namespace
}  // namespace backlash
