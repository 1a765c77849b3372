// SPDX-License-Identifier: BSD-3-Clause
#include "backlash/loops/impact_cycles.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <string>
#include <utility>

#include "backlash/loops/limit_cycles.hpp"
#include "support/expect_invalid_argument.hpp"
#include "support/random.hpp"

namespace backlash {
namespace {

using Complex = std::complex<double>;
constexpr double pi = std::numbers::pi;

frac::FractionalTransferFunction formula(const std::string& text) {
  return frac::FractionalTransferFunction::parse(text);
}

ControlLoop free_loop(const std::string& controller, double restitution) {
  return {{1, 1, 1, restitution}, formula(controller)};
}

// The motion after 300 impacts, and the cycle that it is next to.
struct Settled {
  LoopHistory history;
  std::optional<ImpactCycle> cycle;
};
Settled settled(const ControlLoop& loop, double velocity, int harmonics = 5) {
  LoopSimulationOptions options;
  options.duration = 1e5;
  options.most_impacts = 300;
  options.whole_memory = true;
  Settled result{simulate_loop(loop, {0, .1, 0, velocity}, {}, options), {}};
  if (const auto guess = repeated_pattern(loop, result.history.impacts)) {
    result.cycle = close_cycle(loop, *guess, harmonics);
  }
  return result;
}

// Sums over impulses of one sign and of alternating ones are different series, continued differently: a cycle that is
// symmetric must come out of both.  Newton's last step leaves about 1e-13; the multiplier of a period is the square of
// that of half of it.
TEST(ImpactCycles, OfTwoImpactsAreTheSymmetricOnes) {
  const struct {
    ControlLoop loop;
  } cases[] = {
      {free_loop("1 + s", .6)},
      {free_loop("1 + s^0.5 + 0.3/s^0.6", .6)},
      {free_loop("2 + 1.5 s^0.9", .8)},
      {free_loop("exp(-0.1 s) (1 + s^0.5)", .6)},
      {free_loop("(2 + s + 0.1 s^0.5)/(0.05 s + 1)", .6)},
      {{{1, 1, 1, .9}, formula("4 + 3/s + s"), Output::x2}},
      {{LinearBodies(formula("1/(s^2 + 0.1 s + 0.3)"), formula("1/(s^2 + 0.2 s)"), 1, .6), formula("2 + s")}},
      {{LinearBodies(formula("1/(s^2 + 0.2 s^0.5)"), free_mass(2), .5, .7), formula("3 + s^0.8")}},
  };
  for (const auto& [loop] : cases) {
    int checked = 0;
    for (const SymmetricCycle& cycle : symmetric_cycles(loop).cycles) {
      if (!cycle.admissible) continue;
      ++checked;
      const double period = 2 * pi / cycle.omega;
      const auto closed =
          close_cycle(loop, {period * 1.01, {{0, cycle.impulse, 0}, {period * .49, -cycle.impulse * 1.02, 0}}});
      ASSERT_TRUE(closed.has_value()) << loop.controller().formula();
      EXPECT_TRUE(closed->symmetric);
      EXPECT_TRUE(closed->admissible) << closed->reason;
      EXPECT_LT(closed->error, 1e-9);
      EXPECT_NEAR(closed->period / period, 1, 1e-11) << loop.controller().formula();
      EXPECT_NEAR(closed->impacts[0].impulse / cycle.impulse, 1, 1e-10);
      EXPECT_NEAR(closed->impacts[1].impulse / cycle.impulse, -1, 1e-10);
      EXPECT_NEAR(closed->impacts[1].time / period, .5, 1e-11);
      EXPECT_NEAR(closed->impacts[0].speed / cycle.impact_speed, 1, 1e-10);
      EXPECT_NEAR(closed->middle, 0, 1e-10);
      EXPECT_EQ(closed->stability.unstable_multipliers, cycle.stability.unstable_multipliers)
          << loop.controller().formula();
      const Complex squared = cycle.stability.dominant * cycle.stability.dominant;
      // A multiplier of the period on the positive axis lies on the cut that fractional powers have there.
      const bool lies_on_cut = squared.imag() == 0 && loop.controller().formula().find('.') != std::string::npos;
      if (!lies_on_cut) {
        EXPECT_NEAR(std::abs(closed->stability.dominant), std::abs(squared), 1e-5 * std::abs(squared) + 1e-9)
            << loop.controller().formula() << ' ' << closed->stability.dominant << ' ' << cycle.stability.dominant;
      }
      for (std::size_t k = 0; k < cycle.harmonics.size() && k < 2; ++k) {
        const CycleHarmonic& expected = cycle.harmonics[k];
        const CycleHarmonic& found = closed->harmonics[static_cast<std::size_t>(expected.order - 1)];
        EXPECT_NEAR(std::abs(found.x1 - expected.x1), 0, 1e-10 * std::abs(expected.x1));
        EXPECT_NEAR(std::abs(found.force - expected.force), 0, 1e-10 * std::abs(expected.force));
      }
    }
    EXPECT_GT(checked, 0) << loop.controller().formula();
  }
}

// Where the symmetric cycle of two impacts is not stable, motions settle on others.  A simulation that adds up the
// answers to all impacts knows nothing of periods; after 300 impacts it is as near to the cycle as its rounding at t =
// 100 lets it, and as disturbances have faded: by 0.978 per period of the second one, and in the third as the memory of
// fractional powers does, from one half of the period to the other by as much as the tolerance; which half has the
// hardest impact is a matter of rounding.
TEST(ImpactCycles, AreWhatSimulationsSettleOn) {
  const struct {
    const char* controller;
    double velocity;
    std::size_t impacts;
    bool symmetric;
    double tolerance;
  } cases[] = {{"20 + s", 5, 4, true, 3e-7}, {"40 + s", 5, 7, false, 3e-3}, {"12 + s^0.7", 3, 6, true, 2e-3}};
  for (const auto& each : cases) {
    const Settled motion = settled(free_loop(each.controller, .6), each.velocity);
    ASSERT_TRUE(motion.cycle.has_value()) << each.controller;
    const ImpactCycle& cycle = *motion.cycle;
    EXPECT_EQ(cycle.impacts.size(), each.impacts) << each.controller;
    EXPECT_EQ(cycle.symmetric, each.symmetric) << each.controller;
    EXPECT_TRUE(cycle.admissible) << cycle.reason;
    EXPECT_TRUE(cycle.stability.stable) << each.controller;
    EXPECT_LT(cycle.error, 1e-9);
    // The cycle begins with its hardest impact; so does the last period of the simulation.
    const std::vector<LoopImpact>& all = motion.history.impacts;
    std::size_t first = all.size() - 2 * each.impacts;
    for (std::size_t i = first; i < all.size() - each.impacts; ++i) {
      if (all[i].speed > all[first].speed) first = i;
    }
    for (std::size_t a = 0; a < each.impacts; ++a) {
      EXPECT_NEAR(all[first + a].time - all[first].time, cycle.impacts[a].time, each.tolerance) << each.controller;
      EXPECT_NEAR(all[first + a].speed, cycle.impacts[a].speed, 20 * each.tolerance) << each.controller;
    }
    EXPECT_NEAR(all[first + each.impacts].time - all[first].time, cycle.period, each.tolerance);
  }
  // The two intervals that are known of the first one.
  const Settled known = settled(free_loop("20 + s", .6), 5);
  EXPECT_NEAR(known.cycle->impacts[1].time, .38239689, 6e-9);
  EXPECT_NEAR(known.cycle->impacts[2].time - known.cycle->impacts[1].time, .51285064, 6e-9);
}

// Proportional and derivative action has four states, and flights that are polynomials: multipliers of the period as
// those of the product of flights and saltation matrices, from states that satisfy the cycle on their own.
TEST(ImpactCycles, StabilityIsThatOfTheSaltationMatrices) {
  using Matrix = Eigen::Matrix4d;
  using Vector = Eigen::Vector4d;  // x1, v1, x2, v2
  support::Random random(11);
  int stable = 0, unstable = 0;
  for (int i = 0; i < 12; ++i) {
    const double kp = random.log_uniform(15, 45), kd = random.uniform(.8, 1.2), restitution = random.uniform(.5, .7);
    const ControlLoop loop(TwoMassSystem(1, 1, 1, restitution),
                           frac::FractionalTransferFunction({{kd, 1}, {kp, 0}}, {{1, 0}}));
    const Settled motion = settled(loop, 5);
    if (!motion.cycle) continue;
    std::vector<ImpactCycle> cycles{*motion.cycle};
    // The symmetric cycle of two impacts, which is not stable here, taken as one of two or of four.
    for (const SymmetricCycle& symmetric : symmetric_cycles(loop).cycles) {
      const double tau = pi / symmetric.omega, impulse = symmetric.impulse;
      const auto twice = close_cycle(loop, {2 * tau, {{0, impulse, 0}, {tau, -impulse, 0}}});
      const auto four_times = close_cycle(
          loop, {4 * tau, {{0, impulse, 0}, {tau, -impulse, 0}, {2 * tau, impulse, 0}, {3 * tau, -impulse, 0}}});
      ASSERT_EQ(twice.has_value(), four_times.has_value());
      // Not where its impulses are negative.
      EXPECT_EQ(twice.has_value(), impulse > 0) << kp << ' ' << kd << ' ' << restitution;
      if (twice) cycles.insert(cycles.end(), {*twice, *four_times});
    }
    for (const ImpactCycle& cycle : cycles) {
      const auto flight = [&](double t) {
        Matrix a = Matrix::Identity();
        a(0, 1) = t;
        a(2, 3) = t;
        // v2' = -kp x1 - kd v1
        a(3, 0) = -kp * t;
        a(3, 1) = -kd * t - kp * t * t / 2;
        a(2, 0) = -kp * t * t / 2;
        a(2, 1) = -kd * t * t / 2 - kp * t * t * t / 6;
        return a;
      };
      const auto rate = [&](const Vector& x) { return Vector(x(1), 0, x(3), -kp * x(0) - kd * x(1)); };
      Matrix impact = Matrix::Identity();
      impact(1, 1) = impact(3, 3) = 1 - (1 + restitution) / 2;
      impact(1, 3) = impact(3, 1) = (1 + restitution) / 2;
      // The state just before the first impact: of all linear relations of the period, the one that stays itself.
      const std::size_t n = cycle.impacts.size();
      const auto length = [&](std::size_t a) {
        return (a + 1 < n ? cycle.impacts[a + 1].time : cycle.period) - cycle.impacts[a].time;
      };
      Matrix period = Matrix::Identity();
      for (std::size_t a = 0; a < n; ++a) period = flight(length(a)) * impact * period;
      // x2 may be anywhere in a flight, so that the wall and the speed say which of them it is.
      Eigen::Matrix<double, 6, 4> conditions;
      conditions << period - Matrix::Identity(), -1, 0, 1, 0, 0, -1, 0, 1;
      Eigen::Matrix<double, 6, 1> wanted = Eigen::Matrix<double, 6, 1>::Zero();
      wanted(4) = .5;
      wanted(5) = cycle.impacts[0].speed;
      Vector before = conditions.colPivHouseholderQr().solve(wanted);
      Matrix whole = Matrix::Identity();
      Vector state = before;
      for (std::size_t a = 0; a < n; ++a) {
        const double wall = cycle.impacts[a].impulse > 0 ? .5 : -.5;
        ASSERT_NEAR(state(2) - state(0), wall, 1e-8);
        ASSERT_NEAR(std::abs(state(3) - state(1)), cycle.impacts[a].speed, 1e-8 * cycle.impacts[a].speed);
        Eigen::RowVector4d gap(-1, 0, 1, 0);
        const Vector after = impact * state;
        const Vector arrival = rate(state);
        const Matrix saltation = impact + (rate(after) - impact * arrival) * gap / (gap * arrival).value();
        whole = flight(length(a)) * saltation * whole;
        state = flight(length(a)) * after;
      }
      const Eigen::VectorXcd eigenvalues = whole.eigenvalues();
      std::vector<Complex> expected(eigenvalues.data(), eigenvalues.data() + 4);
      std::erase(expected, *std::min_element(expected.begin(), expected.end(), [](Complex a, Complex b) {
                   return std::abs(a - 1.0) < std::abs(b - 1.0);
                 }));
      int outside = 0;
      double largest = 0, nearest = 1;
      for (const Complex& multiplier : expected) {
        outside += std::abs(multiplier) > 1;
        largest = std::max(largest, std::abs(multiplier));
        nearest = std::min(nearest, std::abs(std::abs(multiplier) - 1));
      }
      if (nearest < 3e-3) continue;
      EXPECT_EQ(cycle.stability.unstable_multipliers, outside) << loop.controller().formula() << " of " << n;
      // Of more impacts it is not said where it is not certain.
      if (largest > .05 && (n <= 6 || !std::isnan(std::abs(cycle.stability.dominant)))) {
        EXPECT_NEAR(std::abs(cycle.stability.dominant), largest, 1e-6 * largest)
            << loop.controller().formula() << " of " << n;
      }
      (outside > 0 ? unstable : stable) += 1;
    }
  }
  EXPECT_GT(stable, 8);
  EXPECT_GT(unstable, 5);
}

// Over a period the controller gives what the impacts take.  Harmonics of force and velocity fall as k^-1.3 and 1/k, so
// that the work of those left out after 3000 is about 3000^-1.3/1.3 = 2e-5 of the whole.
TEST(ImpactCycles, TakeFromTheControllerWhatTheImpactsCost) {
  const ControlLoop loop = free_loop("12 + s^0.7", .6);
  const Settled motion = settled(loop, 3, 3000);
  ASSERT_TRUE(motion.cycle.has_value());
  const double omega = 2 * pi / motion.cycle->period;
  double work = 0;
  for (const CycleHarmonic& harmonic : motion.cycle->harmonics) {
    const Complex velocity = Complex(0, harmonic.order * omega) * harmonic.x2;
    work += 0.5 * (harmonic.force * std::conj(velocity)).real() * motion.cycle->period;
  }
  double loss = 0;
  for (const CycleImpact& impact : motion.cycle->impacts) loss += 0.25 * (1 - .36) * impact.speed * impact.speed;
  EXPECT_NEAR(work / loss, 1, 1e-4);
}

TEST(ImpactCycles, ScaleWithTheClearance) {
  const ControlLoop wide({1, 1, 3, .6}, formula("20 + s"));
  const ImpactCycle small = settled(free_loop("20 + s", .6), 5).cycle.value();
  CycleGuess guess{small.period, small.impacts};
  for (CycleImpact& impact : guess.impacts) impact.impulse *= 2.9;
  const ImpactCycle large = close_cycle(wide, guess).value();
  EXPECT_NEAR(large.period, small.period, 1e-11);
  EXPECT_NEAR(large.impacts[1].impulse, 3 * small.impacts[1].impulse, 1e-10);
}

// Each motion that settles does so on a cycle that is stable, and one that was simulated with the whole memory is among
// them.  The chaotic loop was found by its exponent, which is that of its largest multiplier over long times.
TEST(ImpactCycles, AreFoundFromSeededStarts) {
  const ImpactCycles found = impact_cycles(free_loop("20 + s", .6));
  ASSERT_EQ(found.cycles.size(), 1U);
  EXPECT_EQ(found.cycles[0].impacts.size(), 4U);
  EXPECT_NEAR(found.cycles[0].impacts[1].time, .38239689, 6e-9);
  ASSERT_EQ(found.motions.size(), 3U);
  for (const LoopMotion& motion : found.motions) {
    EXPECT_EQ(motion.regime, LoopRegime::cycle);
    EXPECT_EQ(motion.cycle, 0U);
    EXPECT_TRUE(std::isnan(motion.lyapunov_exponent));
  }
  // Friction of the bodies alone leaves no motion; a pure integral drives it apart.
  const ControlLoop damped(LinearBodies(formula("1/(s^2 + s)"), formula("1/(s^2 + s)"), 1, .3),
                           formula("0.05 + 0.01 s"));
  for (const LoopMotion& motion : impact_cycles(damped).motions) EXPECT_EQ(motion.regime, LoopRegime::quiet);
  for (const LoopMotion& motion : impact_cycles(free_loop("3/s", .6)).motions) {
    EXPECT_EQ(motion.regime, LoopRegime::diverged);
  }
  EXPECT_TRUE(impact_cycles(free_loop("1 + s", .6), {.starts = 0}).motions.empty());
  support::expect_invalid_argument([] { (void)impact_cycles(free_loop("1 + s", .6), {.starts = -1}); }, {"starts"});
}

// Motions of these loops turn about their cycle by about a third of a circle in each period, so that they repeat after
// three periods long before they do after one.
TEST(ImpactCycles, AreListedWithTheirLeastPeriod) {
  for (const double ki : {.96, .965}) {
    const ControlLoop loop(TwoMassSystem(1, 1, 1, .6),
                           frac::FractionalTransferFunction::parse("(s^2 + 2 s + " + std::to_string(ki) + ")/s"));
    const backlash::ImpactCycles found = backlash::impact_cycles(loop);
    const auto two = std::count_if(found.cycles.begin(), found.cycles.end(), [](const ImpactCycle& cycle) {
      return cycle.rests.empty() && cycle.impacts.size() == 2 && cycle.symmetric;
    });
    EXPECT_EQ(two, 1) << ki;
    for (const ImpactCycle& cycle : found.cycles) {
      if (!cycle.rests.empty()) continue;
      // No other impact of the period is as the first one and followed by the same interval.
      const std::size_t count = cycle.impacts.size();
      const auto until_next = [&](std::size_t a) {
        return (a + 1 < count ? cycle.impacts[a + 1].time : cycle.period) - cycle.impacts[a].time;
      };
      for (std::size_t a = 1; a < count; ++a)
        EXPECT_GT(std::abs(cycle.impacts[a].impulse / cycle.impacts[0].impulse - 1) +
                      std::abs(until_next(a) / until_next(0) - 1),
                  1e-6)
            << ki << ", impact " << a << " of " << count;
    }
  }
}

// Of a chaotic loop of four states the exponent is the mean growth of a tangent that flights and saltation matrices
// carry along a motion.  Over 3000 impacts, 900 s, such means scatter by a few per cent; those beside motions are over
// 150 s.
TEST(ImpactCycles, LyapunovExponentIsThatOfTheTangent) {
  const double kp = 30, kd = 1, restitution = .6;
  const ControlLoop loop = free_loop("30 + s", restitution);
  ImpactCycleOptions request;
  request.starts = 4;
  double mean = 0;
  for (const LoopMotion& motion : impact_cycles(loop, request).motions) {
    ASSERT_EQ(motion.regime, LoopRegime::irregular);
    EXPECT_TRUE(motion.chaotic);
    mean += motion.lyapunov_exponent / 4;
  }
  LoopSimulationOptions options;
  options.duration = 1e5;
  options.most_impacts = 3000;
  const LoopHistory history = simulate_loop(loop, {0, .1, 0, 5}, {}, options);
  const auto rate = [&](double x1, double v1, double v2) { return Eigen::Vector4d(v1, 0, v2, -kp * x1 - kd * v1); };
  Eigen::Matrix4d impact = Eigen::Matrix4d::Identity();
  impact(1, 1) = impact(3, 3) = 1 - (1 + restitution) / 2;
  impact(1, 3) = impact(3, 1) = (1 + restitution) / 2;
  Eigen::Vector4d tangent(0, 1, 0, -1);
  double logarithm = 0;
  // Rows come in pairs, before and after an impact.
  for (std::size_t i = 0; i + 2 < history.rows.size(); i += 2) {
    const LoopRow& before = history.rows[i];
    const LoopRow& after = history.rows[i + 1];
    const double late = -(tangent(2) - tangent(0)) / (before.v2 - before.v1);
    tangent = impact * tangent;
    tangent += (impact * rate(before.x1, before.v1, before.v2) - rate(after.x1, after.v1, after.v2)) * late;
    const double t = history.rows[i + 2].time - after.time;
    const double force = -kp * tangent(0) - kd * tangent(1), jerk = -kp * tangent(1);
    tangent(2) += tangent(3) * t + force * t * t / 2 + jerk * t * t * t / 6;
    tangent(3) += force * t + jerk * t * t / 2;
    tangent(0) += tangent(1) * t;
    logarithm += std::log(tangent.norm());
    tangent.normalize();
  }
  const double expected = logarithm / history.end_time;
  EXPECT_GT(expected, .3);
  EXPECT_NEAR(mean / expected, 1, .2);
}

// Nothing is lost and nothing made up for: neighbours part in proportion to time.  Between 100 s and 800 s they do so
// by about 8; an exponent above that of a regular motion, 0.03 of the crossover of 0.7 rad/s, would part them by e^14.
TEST(ImpactCycles, RegularMotionsAreNotCalledChaotic) {
  const ControlLoop loop = free_loop("1", 1);
  ImpactCycleOptions request;
  request.starts = 2;
  LoopSimulationOptions options;
  options.duration = 800;
  options.sample_time = 100;
  options.rows_at_impacts = false;
  options.most_impacts = 1'000'000;
  for (const LoopMotion& motion : impact_cycles(loop, request).motions) {
    LoopStart beside = motion.start;
    beside.v2 += 1e-9;
    const LoopHistory one = simulate_loop(loop, motion.start, {}, options);
    const LoopHistory other = simulate_loop(loop, beside, {}, options);
    ASSERT_EQ(one.rows.size(), other.rows.size());
    const auto apart = [&](std::size_t i) {
      return std::hypot(one.rows[i].x1 - other.rows[i].x1, one.rows[i].x2 - other.rows[i].x2);
    };
    EXPECT_LT(apart(8), 100 * apart(1));
    EXPECT_FALSE(motion.chaotic);
  }
}

// Of C = kp + kd s, equal masses M = 1 and restitution 0 the motion with one impact and one rest per half period is
// known but for one root: joined masses keep 2 x'' = -(kp x + kd x') until the right-hand side is 0 at speed -v; load 1
// then flies with that speed, mass 2 falls back as kp v t^3/6 and meets the far wall when that is the clearance, at the
// relative speed kp v t^2/2.  All lengths are v times a function of the time t of flight.
TEST(ImpactCycles, RestInContactAsTheJoinedMassesDo) {
  const struct { double kp, kd; } cases[] = {{1, 1}, {3, 1}, {20, 1}};
  for (const auto& [kp, kd] : cases) {
    // Joined motion begins at x = t - kd/kp and x' = 1 - kp t^2/4, v = 1; its time until kp x + kd x' = 0, and x'
    // there.
    const auto joined = [&](double t) {
      const Complex root = std::sqrt(Complex(kd * kd / 16 - kp / 2, 0));
      const double x = t - kd / kp, rate = 1 - kp * t * t / 4;
      const auto motion = [&](double s) {
        const double decay = std::exp(-kd * s / 4);
        const double even = std::cosh(root * s).real(), odd = (std::sinh(root * s) / root).real();
        const double at = decay * (x * even + (rate + kd / 4 * x) * odd);
        const double speed = -kd / 4 * at + decay * (x * (root * root).real() * odd + (rate + kd / 4 * x) * even);
        return std::pair(at, speed);
      };
      double low = 0, high = 0;
      const auto force = [&](double s) { return kp * motion(s).first + kd * motion(s).second; };
      while (force(high) > 0) low = std::exchange(high, high + 1e-3);
      for (int i = 0; i < 60; ++i) (force(0.5 * (low + high)) > 0 ? low : high) = 0.5 * (low + high);
      return std::pair(high, motion(high).second);
    };
    double low = 0.2 / std::sqrt(kp), high = 6 / std::sqrt(kp);
    while (kp * (low - kd / kp) + kd * (1 - kp * low * low / 4) < 0) low *= 1.01;
    const auto defect = [&](double t) { return joined(t).second + 1; };
    const bool rises = defect(high) > 0;
    ASSERT_NE(defect(low) > 0, rises);
    for (int i = 0; i < 60; ++i) ((defect(0.5 * (low + high)) > 0) == rises ? high : low) = 0.5 * (low + high);
    const double flight = high, rest = joined(flight).first, v = 6 / (kp * std::pow(flight, 3));
    for (const double restitution : {0.0, 0.02}) {
      const ImpactCycles found =
          impact_cycles(free_loop(std::to_string(kp) + " + " + std::to_string(kd) + " s", restitution));
      ASSERT_EQ(found.cycles.size(), 1U) << kp;
      const ImpactCycle& cycle = found.cycles[0];
      EXPECT_TRUE(cycle.symmetric);
      EXPECT_TRUE(cycle.stability.stable);
      ASSERT_EQ(cycle.rests.size(), 2U);
      if (restitution > 0) {
        // Bounces take some of the rest, and change the motion by the square of their loss of time.
        EXPECT_GT(cycle.impacts.size(), 8U);
        EXPECT_LT(cycle.rests[0].duration, rest);
        EXPECT_NEAR(cycle.period, 2 * (flight + rest), 0.01 * cycle.period);
        continue;
      }
      ASSERT_EQ(cycle.impacts.size(), 2U);
      EXPECT_NEAR(cycle.period, 2 * (flight + rest), 1e-11 * cycle.period);
      EXPECT_NEAR(cycle.rests[0].duration, rest, 1e-11 * cycle.period);
      EXPECT_NEAR(cycle.impacts[0].speed, kp * v * flight * flight / 2, 1e-10 * cycle.impacts[0].speed);
      // Over a half period the walls turn mass 1 around, which flies at v on both sides.
      EXPECT_NEAR(cycle.impacts[0].impulse + cycle.rests[0].impulse, 2 * v, 1e-10 * v);
      EXPECT_LT(cycle.error, 1e-12);
    }
  }
}

// What the impulses and the force of the walls make of the bodies through their receptances and the controller, with
// its whole memory, is the motion that rests: the gap stays closed at a rest, the rest of the time it is open, and the
// controller supplies what impacts and friction take.  Of 400 harmonics the series of the gap leaves out
// 1e-5 of the impacts over the share of the period since the last one, that of the power 1e-3.
TEST(ImpactCycles, WithRestsMeetTheirWholeMemory) {
  const struct {
    ControlLoop loop;
    bool has_friction;
  } cases[] = {
      {free_loop("1 + s^0.5", 0), false},
      {free_loop("1 + s^0.5", .1), false},
      {free_loop("1 + s^0.5 + 0.3/s^0.6", .05), false},
      {{LinearBodies(formula("1/(s^2 + 0.1 s^0.5)"), formula("1/(2 s^2 + 0.1 s)"), .3, .02), formula("3 + s")}, true}};
  for (const auto& [loop, has_friction] : cases) {
    const std::string name = loop.controller().formula();
    const ImpactCycles found = impact_cycles(loop, {.starts = 1, .harmonics = 400});
    ASSERT_EQ(found.cycles.size(), 1U) << name;
    const ImpactCycle& cycle = found.cycles[0];
    ASSERT_EQ(cycle.rests.size(), 2U) << name;
    EXPECT_LT(cycle.error, 2e-9);
    const double omega = 2 * pi / cycle.period, half = 0.5 * loop.system().clearance();
    const auto gap = [&](double time) {
      double sum = cycle.middle;
      for (const CycleHarmonic& harmonic : cycle.harmonics) {
        sum += ((harmonic.x2 - harmonic.x1) * std::polar(1.0, harmonic.order * omega * time)).real();
      }
      return sum;
    };
    for (const CycleRest& rest : cycle.rests) {
      const double side = rest.impulse > 0 ? half : -half;
      for (const double share : {.1, .5, .9}) {
        EXPECT_NEAR(gap(rest.time + share * rest.duration), side, 5e-4 * half) << name;
      }
      EXPECT_LT(std::abs(gap(rest.time + rest.duration + 0.3 * (0.5 * cycle.period - rest.duration))), 0.999 * half);
    }
    double work = 0;
    for (const CycleHarmonic& harmonic : cycle.harmonics) {
      const Complex velocity = Complex(0, harmonic.order * omega) * harmonic.x2;
      work += 0.5 * (harmonic.force * std::conj(velocity)).real() * cycle.period;
    }
    const TwoMassSystem& system = loop.system();
    const double mass = 1 / (1 / system.mass1() + 1 / system.mass2()), e = system.restitution();
    double loss = 0;
    for (const CycleImpact& impact : cycle.impacts) loss += 0.5 * mass * (1 - e * e) * impact.speed * impact.speed;
    if (has_friction) {
      EXPECT_GT(work / loss, 1.01) << name;
    } else {
      EXPECT_NEAR(work / loss, 1, 2e-3) << name;
    }
  }
}

TEST(ImpactCycles, RefuseAGuessThatIsNone) {
  const ControlLoop loop = free_loop("1 + s", .6);
  support::expect_invalid_argument([&] { (void)close_cycle(loop, {2, {}}); }, {"no impacts"});
  support::expect_invalid_argument([&] { (void)close_cycle(loop, {2, {{.1, 1, 0}}}); }, {"not at time 0"});
  support::expect_invalid_argument([&] { (void)close_cycle(loop, {2, {{0, 1, 0}, {2.5, -1, 0}}}); }, {"2.5"});
  support::expect_invalid_argument([&] { (void)close_cycle(loop, {2, {{0, 1, 0}, {1, 0, 0}}}); }, {"impulse 2"});
  support::expect_invalid_argument([&] { (void)close_cycle(loop, {-2, {{0, 1, 0}}}); }, {"period"});
  // Impulses of one sign drive free masses away.
  EXPECT_FALSE(close_cycle(loop, {2, {{0, 1, 0}}}).has_value());
}

}  // namespace
}  // namespace backlash
