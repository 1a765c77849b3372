// SPDX-License-Identifier: BSD-3-Clause
#include "backlash/loops/predicted_cycles.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "backlash/describing_function.hpp"
#include "backlash/orbit_continuation.hpp"
#include "support/random.hpp"

namespace backlash {
namespace {

using Complex = std::complex<double>;

// Frequency and gamma = F/(M2 clearance w^2) of the balance, solved apart from this code, to the digits given.
struct KnownPrediction {
  const char* controller;
  double restitution, omega, gamma;
};
constexpr KnownPrediction known_predictions[] = {{"1 + s", .6, 2.546479, .091193},
                                                 {"5 + s", .6, 2.546479, .255050},
                                                 {"1 + s^0.5", .6, 1.480074, .289083},
                                                 {"0.5 + s^0.7", .3, 1.040853, .390371},
                                                 {"2 + 1.5 s^0.9", .8, 6.98866753, .03908766}};

TEST(PredictedCycles, AreThoseOfTheTable) {
  for (const KnownPrediction& known : known_predictions) {
    const ControlLoop loop({1, 1, 1, known.restitution}, frac::FractionalTransferFunction::parse(known.controller));
    std::vector<PredictedCycle> found = predicted_limit_cycles(loop);
    std::erase_if(found, [](const PredictedCycle& cycle) { return !cycle.symmetric; });
    ASSERT_EQ(found.size(), 1U) << known.controller;
    EXPECT_NEAR(found[0].omega, known.omega, 6e-7) << known.controller;
    EXPECT_NEAR(found[0].force_amplitude / (found[0].omega * found[0].omega), known.gamma, 6e-7) << known.controller;
  }
}

// Of gains beyond 1e16 the balance of an asymmetric cycle lies at an angle that is pi to rounding.
// The answer of undamped bodies has poles, at which the search for frequencies meets infinite values.
TEST(PredictedCycles, BearTheResonancesOfUndampedBodies) {
  const backlash::LinearBodies bodies(frac::FractionalTransferFunction::parse("1/(s^2 + 1)"),
                                      frac::FractionalTransferFunction::parse("1/(s^2 + 0.3 s + 2)"), 0.01, 0.5);
  const backlash::ControlLoop loop(bodies, frac::FractionalTransferFunction::parse("18.2 + 3.05 s"));
  for (const auto& cycle : backlash::predicted_limit_cycles(loop)) {
    EXPECT_TRUE(std::isfinite(cycle.omega) && std::isfinite(cycle.force_amplitude)) << cycle.omega;
  }
}

TEST(PredictedCycles, AreNumbersAtAnyGain) {
  for (const char* controller : {"1e20", "1e30/(1e-3 s^2 + s + 1)", "1e200/(1e-200 s^2 + 1)", "1 + s^1.999"}) {
    const ControlLoop loop({1, 1, 1, 0.3}, frac::FractionalTransferFunction::parse(controller));
    for (const PredictedCycle& cycle : predicted_limit_cycles(loop)) {
      EXPECT_TRUE(std::isfinite(cycle.omega) && cycle.omega > 0) << controller;
      EXPECT_TRUE(std::isfinite(cycle.force_amplitude)) << controller;
    }
  }
}

// N of the forced masses from the sweep, which follows their motion.
Complex describing_function_of(const TwoMassSystem& system, Output output, double force, double omega) {
  SweepOptions options;
  options.protocol = Protocol::two_impact;
  options.output = output;
  return describing_function_sweep(system, force, {omega}, options).points.front().value;
}

// The controller c0 + c1 s that makes 1 + C N = 0 there, or a gain with the dead time that does.
frac::FractionalTransferFunction balancing(Complex describing_function, double omega, bool is_delayed = false) {
  const Complex wanted = -1.0 / describing_function;
  if (!is_delayed) return {{{wanted.imag() / omega, 1}, {wanted.real(), 0}}, {{1, 0}}};
  const double turn = std::arg(std::conj(wanted));
  return {{{std::abs(wanted), 0}}, {{1, 0}}, (turn < 0 ? turn + 2 * std::numbers::pi : turn) / omega};
}

// The sign of Loeb's U_F V_w - V_F U_w by differences of the sweep.
bool is_stable_by_differences(const ControlLoop& loop, double force, double omega) {
  constexpr double step = 1e-5;
  const auto defect = [&](double of_force, double of_omega) {
    return loop.controller().response(of_omega) *
           describing_function_of(loop.system(), loop.measured(), of_force, of_omega);
  };
  const Complex by_force = defect(force * (1 + step), omega) - defect(force * (1 - step), omega);
  const Complex by_omega = defect(force, omega * (1 + step)) - defect(force, omega * (1 - step));
  return (std::conj(by_force) * by_omega).imag() > 0;
}

const PredictedCycle* at_frequency(const std::vector<PredictedCycle>& cycles, double omega) {
  for (const PredictedCycle& cycle : cycles) {
    if (std::abs(cycle.omega / omega - 1) < 1e-7) return &cycle;
  }
  return nullptr;
}

// 1 + C N = 0 with N of the existing sweep of describing functions, where it shows the same orbit: stable and
// symmetric.
TEST(PredictedCycles, BalanceTheDescribingFunctionOfTheForcedMasses) {
  support::Random random(4);
  int compared = 0;
  for (int i = 0; i < 60; ++i) {
    const TwoMassSystem system(random.log_uniform(.5, 2), random.log_uniform(.5, 2), random.log_uniform(.1, 10),
                               random.uniform(.2, .9));
    const frac::FractionalTransferFunction controller(
        {{random.log_uniform(.3, 3), random.uniform(.3, 1)}, {random.log_uniform(.3, 3), 0}}, {{1, 0}},
        i % 3 == 0 ? random.uniform(.01, .3) : 0);
    const Output measured = i % 2 == 0 ? Output::x1 : Output::x2;
    const ControlLoop loop(system, controller, measured);
    for (const PredictedCycle& cycle : predicted_limit_cycles(loop)) {
      if (!cycle.faster_orbit || !cycle.symmetric) continue;
      SweepOptions options;
      options.protocol = Protocol::two_impact;
      options.output = measured;
      const std::vector<DescribingFunctionPoint> points =
          describing_function_sweep(system, cycle.force_amplitude, {cycle.omega}, options).points;
      if (points.front().regime != Regime::symmetric) continue;
      EXPECT_LT(std::abs(1.0 + controller.response(cycle.omega) * points.front().value), 1e-8);
      EXPECT_EQ(cycle.stable, is_stable_by_differences(loop, cycle.force_amplitude, cycle.omega));
      ++compared;
    }
  }
  EXPECT_GT(compared, 20);
}

// Ratios F/(M2 clearance w^2) between the loss of symmetry and that of the two-impact orbit.
struct AsymmetricOrbit {
  double restitution, ratio;
};
constexpr AsymmetricOrbit asymmetric_orbits[] = {{.4, .42}, {.4, .5}, {.6, .38}, {.6, .45},
                                                 {.6, .5},  {.8, .4}, {.8, .45}};

TEST(PredictedCycles, BalanceTheAsymmetricOrbitsOfTheForcedMasses) {
  int stable = 0, unstable = 0;
  for (const AsymmetricOrbit& orbit : asymmetric_orbits) {
    for (const auto& [measured, is_delayed] :
         {std::pair(Output::x1, false), {Output::x2, false}, {Output::x1, true}, {Output::x2, true}}) {
      const TwoMassSystem system(1.3, .8, .4, orbit.restitution);
      const double omega = 3, force = orbit.ratio * .8 * .4 * 9;
      const Complex n = describing_function_of(system, measured, force, omega);
      const ControlLoop loop(system, balancing(n, omega, is_delayed), measured);
      const std::vector<PredictedCycle> cycles = predicted_limit_cycles(loop, FrequencyRange{1, 9});
      const PredictedCycle* found = at_frequency(cycles, omega);
      ASSERT_NE(found, nullptr) << orbit.restitution << " " << orbit.ratio;
      EXPECT_FALSE(found->symmetric);
      EXPECT_EQ(found->impacts, 2);
      EXPECT_TRUE(found->admissible);
      // The sweep closes its orbits to 1e-10.
      EXPECT_NEAR(found->force_amplitude, force, 1e-8 * force);
      EXPECT_GT(found->second_harmonic, 0);
      const bool by_differences = is_stable_by_differences(loop, force, omega);
      EXPECT_EQ(found->stable, by_differences) << orbit.restitution << " " << orbit.ratio;
      ++(by_differences ? stable : unstable);
    }
  }
  EXPECT_GT(stable, 2);
  EXPECT_GT(unstable, 2);
}

// Orbits of more impacts: of the first ones that a sweep settles on, each makes a loop in which it is predicted.
TEST(PredictedCycles, BalanceTheOrbitsOfADiagram) {
  const TwoMassSystem system(1, 1, 1, .6);
  // Ratios .5 to 2 at force 1.
  const OrbitDiagram diagram = orbit_diagram(system, 1, std::sqrt(.5), std::sqrt(2.0));
  int compared = 0;
  for (const double ratio : {.6, .7, .8, .95, 1.1, 1.3, 1.5, 1.8}) {
    const double omega = 2, force = ratio * 2 * .7 * omega * omega;
    const TwoMassSystem other(.5, 2, .7, .6);
    SweepOptions options;
    options.protocol = Protocol::two_impact;
    const DescribingFunctionPoint point = describing_function_sweep(other, force, {omega}, options).points.front();
    if (point.regime != Regime::periodic || point.impacts_per_period == 2) continue;
    const ControlLoop loop(other, balancing(point.value, omega));
    const std::vector<PredictedCycle> cycles = predicted_limit_cycles(loop, diagram, FrequencyRange{.5, 8});
    const PredictedCycle* found = at_frequency(cycles, omega);
    ASSERT_NE(found, nullptr) << ratio << ": " << point.impacts_per_period << " impacts";
    EXPECT_NEAR(found->force_amplitude, force, 1e-7 * force);
    EXPECT_EQ(found->impacts, static_cast<int>(std::lround(point.impacts_per_period * point.period)));
    EXPECT_EQ(found->period, point.period);
    EXPECT_TRUE(found->admissible);
    EXPECT_EQ(found->stable, is_stable_by_differences(loop, force, omega)) << ratio;
    ++compared;
  }
  EXPECT_GT(compared, 2);
}

TEST(PredictedCycles, RefuseADiagramOfAnotherRestitution) {
  const OrbitDiagram diagram{{1, 1, 1, .5}, 1, 1, OrbitParameter::omega, 1, 2, {}, {}};
  const ControlLoop loop({1, 1, 1, .6}, frac::FractionalTransferFunction::parse("1 + s"));
  EXPECT_THROW((void)predicted_limit_cycles(loop, diagram), std::invalid_argument);
}

}  // namespace
}  // namespace backlash
