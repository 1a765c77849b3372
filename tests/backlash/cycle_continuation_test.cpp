// SPDX-License-Identifier: BSD-3-Clause
#include "backlash/loops/cycle_continuation.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <boost/math/special_functions/zeta.hpp>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include "support/expect_invalid_argument.hpp"

namespace backlash {
namespace {

using frac::FractionalTransferFunction;
constexpr double pi = std::numbers::pi;

std::vector<double> grid(double from, double to, int count) {
  std::vector<double> values;
  for (int i = 0; i < count; ++i) values.push_back(from + (to - from) * i / (count - 1));
  return values;
}

ControlLoop loop_of(const std::vector<frac::PowerTerm>& terms, double restitution) {
  return {TwoMassSystem(1, 1, 1, restitution), FractionalTransferFunction(terms, {{1, 0}})};
}

std::vector<CycleEvent> of_kind(const CycleContinuation& all, CycleEventKind kind) {
  std::vector<CycleEvent> found;
  for (const CycleEvent& event : all.events) {
    if (event.kind == kind) found.push_back(event);
  }
  return found;
}

double lambda(double p) {
  return (1 - std::pow(2, -p)) * boost::math::zeta(p);
}

// a w^0.5 = b k w^-0.6 + c w^2 has two roots up to the k at which both sides touch, which is solved by hand.
TEST(CycleContinuation, FoldsLieWhereTwoRootsMeet) {
  const double a = std::sin(.25 * pi) * lambda(2.5), b = std::sin(.3 * pi) * lambda(3.6);
  const double c = pi / 2 * .4 / 1.6;
  const double omega = std::pow(1.1 * a / (2.6 * c), 1 / 1.5);
  const double gain = (a * std::pow(omega, .5) - c * omega * omega) / (b * std::pow(omega, -.6));
  const auto loop_at = [](double k) { return loop_of({{1, .5}, {1, 0}, {k, -.6}}, .6); };
  const CycleContinuation found = continue_cycles(loop_at, grid(.2, 2, 7));
  const std::vector<CycleEvent> folds = of_kind(found, CycleEventKind::fold);
  ASSERT_EQ(folds.size(), 1U);
  EXPECT_NEAR(folds[0].parameter, gain, 1e-10 * gain);
  EXPECT_NEAR(folds[0].omega, omega, 1e-6 * omega);  // a minimum is known to the root of the rounding
  ASSERT_FALSE(found.without_cycles.empty());
  EXPECT_EQ(found.without_cycles.back().to, 2);
  EXPECT_LE(found.without_cycles.back().from, folds[0].parameter);
  // The same from the other side.
  const CycleContinuation back = continue_cycles(loop_at, grid(2, .2, 7));
  ASSERT_EQ(of_kind(back, CycleEventKind::fold).size(), 1U);
  EXPECT_NEAR(of_kind(back, CycleEventKind::fold)[0].parameter, gain, 1e-10 * gain);
}

// The largest real multiplier below 0 of the half period of a loop with proportional and derivative action, by the
// saltation matrix of its four states.
double lowest_multiplier(double kp, double kd, double restitution) {
  const double tau = 4 * (1 - restitution) / (kd * (1 + restitution));
  using Matrix = Eigen::Matrix4d;
  Matrix a = Matrix::Zero();
  a(0, 1) = a(2, 3) = 1;
  a(3, 0) = -kp;
  a(3, 1) = -kd;
  Matrix flight = Matrix::Identity();
  Matrix power = flight;
  for (int i = 1; i < 40; ++i) {
    power = power * a * (tau / i);
    flight += power;
  }
  Matrix impact = Matrix::Identity();
  const double share = (1 + restitution) / 2;
  impact(1, 1) -= share;
  impact(1, 3) += share;
  impact(3, 1) += share;
  impact(3, 3) -= share;
  Eigen::JacobiSVD<Matrix> repeat(flight * impact + Matrix::Identity(), Eigen::ComputeFullV);
  const Eigen::Vector4d before = repeat.matrixV().col(3);
  Eigen::RowVector4d gap(-1, 0, 1, 0);
  const Eigen::Vector4d rate = a * before;
  const Matrix saltation = impact + (a * (impact * before) - impact * rate) * gap / (gap * rate).value();
  double lowest = 0;
  for (const std::complex<double>& z : (-(flight * saltation)).eval().eigenvalues()) {
    if (std::abs(z.imag()) < 1e-9) lowest = std::min(lowest, z.real());
  }
  return lowest;
}

TEST(CycleContinuation, SymmetryBreaksWhereAMultiplierIsMinusOne) {
  double low = 8, high = 20;
  for (int i = 0; i < 60; ++i) {
    const double middle = .5 * (low + high);
    (lowest_multiplier(middle, 1, .6) < -1 ? high : low) = middle;
  }
  const CycleContinuation found = continue_cycles(
      [](double kp) {
        return loop_of({{1, 1}, {kp, 0}}, .6);
      },
      grid(1, 22, 8));
  const std::vector<CycleEvent> breaks = of_kind(found, CycleEventKind::symmetry_breaking);
  ASSERT_EQ(breaks.size(), 1U);
  EXPECT_NEAR(breaks[0].parameter, low, 1e-8 * low);
  EXPECT_NEAR(breaks[0].omega, pi, 1e-12);
  ASSERT_EQ(found.without_stable_cycles.size(), 1U);
  EXPECT_EQ(found.without_stable_cycles[0].from, breaks[0].parameter);
  EXPECT_EQ(found.without_stable_cycles[0].to, 22);
}

// With "kp + s" and restitution .6 the half period is 1 and the gap a cubic of time: after the impact at +1/2 mass 1
// has the speed I/2, so y = 1/2 - .6 v t - kp (I/2) (t^3/6 - t^2/4) - (I/2) t^2/2 with v = 2 I/1.6, and I follows from
// y(1) = -1/2.  The largest kp for which y stays between the walls.
double largest_stiffness() {
  const auto stays_inside = [](double kp) {
    const double impulse = 1 / (1.2 / 1.6 - kp / 24 + .25);
    const auto y = [&](double t) {
      return .5 - 1.2 * impulse / 1.6 * t - kp * impulse / 2 * (t * t * t / 6 - t * t / 4) - impulse / 4 * t * t;
    };
    for (int i = 1; i < 20'000; ++i) {
      if (std::abs(y(i / 20'000.)) > .5) return false;
    }
    return true;
  };
  double low = 10, high = 20;
  for (int i = 0; i < 40; ++i) {
    const double middle = .5 * (low + high);
    (stays_inside(middle) ? low : high) = middle;
  }
  return low;
}

// The cubic is looked at in steps of 1/20 000: next to an end it leaves the walls by the square of that.
TEST(CycleContinuation, CyclesEndWhereTheyReachAWallBetweenImpacts) {
  const CycleContinuation found = continue_cycles(
      [](double kp) {
        return loop_of({{1, 1}, {kp, 0}}, .6);
      },
      grid(5, 20, 5));
  const std::vector<CycleEvent> ends = of_kind(found, CycleEventKind::admissibility);
  ASSERT_EQ(ends.size(), 1U);
  EXPECT_NEAR(ends[0].parameter, largest_stiffness(), 2e-3);
  EXPECT_NE(ends[0].reason.find("beyond the walls"), std::string::npos);
  ASSERT_EQ(found.without_cycles.size(), 1U);
  EXPECT_EQ(found.without_cycles[0].from, ends[0].parameter);
}

// The size of that cycle has the sign of 24 - kp: at 25 impacts would have to pull, but what ends the motion is the
// wall, long before.
TEST(CycleContinuation, TheReasonIsThatRightBeyondTheEnd) {
  const CycleContinuation found = continue_cycles([](double kp) { return loop_of({{1, 1}, {kp, 0}}, .6); }, {19, 25});
  const std::vector<CycleEvent> ends = of_kind(found, CycleEventKind::admissibility);
  ASSERT_EQ(ends.size(), 1U);
  EXPECT_NE(ends[0].reason.find("beyond the walls"), std::string::npos) << ends[0].reason;
}

// Viscous friction of both bodies slows the cycle down until it leaves the range: the least that leaves none, against a
// plain search beside it.
TEST(CycleContinuation, FindsTheLeastFrictionThatLeavesNoCycle) {
  const auto loop_at = [](double friction) {
    const FractionalTransferFunction body({{1, 0}}, {{1, 2}, {friction, 1}});
    return ControlLoop(LinearBodies(body, body, 1, .6), FractionalTransferFunction::parse("2 + s"));
  };
  LimitCycleOptions options;
  options.range = FrequencyRange{.2, 10};
  const CycleContinuation found = continue_cycles(loop_at, grid(0, 2, 5), options);
  ASSERT_EQ(found.without_cycles.size(), 1U);
  const double limit = found.without_cycles[0].from;
  EXPECT_EQ(found.without_cycles[0].to, 2);
  const auto has_cycle = [&](double friction) {
    for (const SymmetricCycle& cycle : symmetric_cycles(loop_at(friction), options).cycles) {
      if (cycle.admissible) return true;
    }
    return false;
  };
  EXPECT_TRUE(has_cycle(limit * (1 - 1e-8)));
  EXPECT_FALSE(has_cycle(limit * (1 + 1e-8)));
}

// With "kp + s", masses 1 and restitution .6 the sums over the impacts of an asymmetric cycle are Bernoulli
// polynomials: its parts d and 1 - d of the period T meet kp T^2 d (1 - d) = 12 and T d (1 - d) = 1/2, so that T =
// 24/kp and d (1 - d) = kp/48.  It begins at kp = 12 and exists below.
TEST(CycleContinuation, FollowsAsymmetricCyclesFromWhereSymmetryBreaks) {
  const CycleContinuation found = continue_cycles(
      [](double kp) {
        return loop_of({{1, 1}, {kp, 0}}, .6);
      },
      {5, 8, 9, 10, 11, 13});
  ASSERT_EQ(found.branches.size(), 1U);
  const CycleBranch& branch = found.branches[0];
  EXPECT_NEAR(branch.born_at, 12, 1e-9);
  ASSERT_EQ(branch.samples.size(), 5U);
  for (const CycleBranch::Sample& sample : branch.samples) {
    EXPECT_NEAR(sample.cycle.period, 24 / sample.parameter, 1e-9);
    ASSERT_EQ(sample.cycle.impacts.size(), 2U);
    const double share = sample.cycle.impacts[1].time / sample.cycle.period;
    EXPECT_NEAR(share * (1 - share), sample.parameter / 48, 1e-8);
    EXPECT_FALSE(sample.cycle.stability.stable);
    EXPECT_TRUE(sample.cycle.admissible);
  }
  EXPECT_EQ(branch.samples.back().parameter, 8);
  ASSERT_EQ(branch.events.size(), 1U);
  EXPECT_EQ(branch.events[0].kind, CycleEventKind::admissibility);
  EXPECT_FALSE(branch.events[0].reason.empty());
  const double kp = branch.events[0].parameter;
  EXPECT_NEAR(2 * pi / branch.events[0].omega, 24 / kp, 1e-8);
  EXPECT_LT(kp, 8);
  // Beside it the same cycle, closed anew from its closed form, is a motion on the one side and none on the other.
  for (const double side : {1.0, -1.0}) {
    const double at = kp * (1 + side * 1e-8), period = 24 / at, share = .5 + std::sqrt(.25 - at / 48);
    const double impulse = branch.samples.back().cycle.impacts[0].impulse;
    const auto cycle =
        close_cycle(loop_of({{1, 1}, {at, 0}}, .6), {period, {{0, impulse, 0}, {share * period, -impulse, 0}}});
    ASSERT_TRUE(cycle.has_value());
    EXPECT_EQ(cycle->admissible, side > 0);
  }
}

TEST(CycleContinuation, RefusesValuesWithoutOrder) {
  const auto loop_at = [](double kp) { return loop_of({{1, 1}, {kp, 0}}, .6); };
  for (const std::vector<double>& values : {std::vector<double>{1}, {1, 2, 2}, {1, 3, 2}})
    support::expect_invalid_argument([&] { (void)continue_cycles(loop_at, values); }, {"strictly"});
}

}  // namespace
// Beyond kp = 12 the symmetric cycle of "kp + s" is unstable, and so is the asymmetric one, which lies below; a motion
// simulated from another start than those of the search settles all the same.
TEST(CycleContinuation, StableCyclesOfMoreImpactsCount) {
  const auto loop_at = [](double kp) { return loop_of({{1, 1}, {kp, 0}}, .6); };
  const std::vector<double> values{13, 17, 21};
  const auto holds = [](const std::vector<backlash::ParameterInterval>& intervals, double value) {
    return std::any_of(intervals.begin(), intervals.end(),
                       [&](const auto& each) { return each.from <= value && value <= each.to; });
  };
  const CycleContinuation without = continue_cycles(loop_at, values);
  EXPECT_TRUE(without.simulated.empty());
  for (const double kp : values) EXPECT_TRUE(holds(without.without_stable_cycles, kp)) << kp;
  const CycleContinuation found = continue_cycles(loop_at, values, {}, 2);
  EXPECT_FALSE(found.simulated.empty());
  int settled = 0;
  for (const double kp : values) {
    backlash::LoopSimulationOptions options;
    options.duration = 1e5;
    options.most_impacts = 3000;
    const auto history = simulate_loop(loop_at(kp), {0, .1, 0, 2}, {}, options);
    const auto pattern = repeated_pattern(loop_at(kp), history.impacts, 12, 1e-6);
    if (!pattern) continue;
    ++settled;
    EXPECT_FALSE(holds(found.without_stable_cycles, kp)) << kp;
    EXPECT_TRUE(std::any_of(found.branches.begin(), found.branches.end(), [&](const CycleBranch& branch) {
      return holds(branch.stable, kp) && branch.samples.front().cycle.impacts.size() == pattern->impacts.size();
    })) << kp;
  }
  EXPECT_GT(settled, 0);
  // The cycle of four impacts turns back below 13.7.  Both sides of the fold part as the root of the distance from it:
  // their difference over distances of 1 and 4 tells where it is to a few per cent of these.
  const auto turned = std::find_if(found.branches.begin(), found.branches.end(),
                                   [](const CycleBranch& branch) { return std::isfinite(branch.born_at); });
  ASSERT_NE(turned, found.branches.end());
  const CycleBranch& before = *(turned - 1);
  ASSERT_EQ(before.events.front().kind, CycleEventKind::fold);
  const double fold = before.events.front().parameter;
  EXPECT_EQ(turned->born_at, fold);
  EXPECT_EQ(turned->samples.front().cycle.impacts.size(), 4U);
  EXPECT_TRUE(holds(turned->admissible, 17));
  double width[2];
  for (const int i : {0, 1}) {
    const double kp = fold + 1e-6 * (i == 0 ? 1 : 4);
    const auto at = [&](const backlash::ImpactCycle& near) {
      return backlash::close_cycle(loop_at(kp), {near.period, near.impacts}, 1).value();
    };
    const double from = before.samples.front().parameter;
    backlash::ImpactCycle side = before.samples.front().cycle;
    for (double distance = 1; distance > 0.5e-6; distance /= 2) {
      side = backlash::close_cycle(loop_at(kp + (from - kp) * distance), {side.period, side.impacts}, 1).value();
    }
    width[i] = at(side).impacts[1].time - at(turned->samples.front().cycle).impacts[1].time;
  }
  EXPECT_NEAR(std::pow(width[1] / width[0], 2), 4, 0.1);
}

}  // namespace backlash
