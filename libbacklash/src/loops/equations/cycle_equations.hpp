// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <complex>
#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "backlash/loops/impact_cycles.hpp"
#include "excursion.hpp"
#include "gap_response.hpp"

namespace backlash::detail {

/// close_cycle() of a guess that is valid.
/// @param judges  else the stability is left out, which is most of the work
[[nodiscard]] std::optional<ImpactCycle> closed_cycle(const ControlLoop& loop, const CycleGuess& guess, int harmonics,
                                                      bool judges);

/// A periodic motion by the instants and impulses of its impacts.
struct ClosedMotion {
  double period;
  std::vector<double> shares;  // of the period, at which the impacts happen; the first is 0
  std::vector<double> impulses;
  double middle;     // mean of x2 - x1
  double phase = 0;  // under a sine force: of what it does to x2 - x1, at the first impact
};

/// The effect of a sine force of its own on x2 - x1: amplitude cos(force_periods 2 pi t/period + phase).
struct ForcedGap {
  double amplitude;   // m
  int force_periods;  // per period of the motion
};

/// The addition of a sine force that answers to the fundamental of the impulses: F G2 = answer times it.
struct FundamentalAnswer {
  std::function<std::complex<double>(double omega)> answer;
  int force_periods = 1;  // per period of the motion
};

/// Sums over all earlier impacts at distances of whole periods: those of ImpulseTrain, and of the force that answers.
class AnsweredTrain {
 public:
  AnsweredTrain(const ImpulseAnswer& response, double period, const std::optional<FundamentalAnswer>& answer);
  /// As ImpulseTrain::repeated.
  [[nodiscard]] std::array<double, 3> repeated(double t) const;
  [[nodiscard]] const ImpulseTrain& train() const noexcept { return train_; }

 private:
  ImpulseTrain train_;
  double omega_ = 0;
  std::complex<double> answer_ = 0;  // per impulse
};

/// The conditions on a periodic motion with impacts at given walls:
///   y(t_a) = +-clearance/2,   y'(t_a) = h1 I_a/(1 + restitution),   h1 = 1/M1 + 1/M2,
///   y(t) = middle - sum_b I_b sum_l g(t - t_b + l period).
class CycleEquations {
 public:
  /// Equations of the cycles of a loop.
  CycleEquations(const ControlLoop& loop, const CycleGuess& guess);
  /// Equations of a loop whose controller answers to the mean and the fundamental alone.
  CycleEquations(const ControlLoop& loop, const CycleGuess& guess, FundamentalAnswer answer);
  /// Equations of bodies under a sine force: the period is that of the guess, and the phase of the force takes its
  /// place.
  CycleEquations(const LinearBodies& bodies, const CycleGuess& guess, const ForcedGap& forced);

  /// The motion next to the guess by Newton's method, if that settles.
  struct Solution {
    ClosedMotion motion;
    double error;  // largest relative change of the last step
  };
  [[nodiscard]] std::optional<Solution> solve(const CycleGuess& guess, double phase = 0) const;

  /// Derivatives of angular frequency and impulses by the answer's real and imaginary part, at a solution.
  struct Sensitivity {
    std::complex<double> omega;  // by the real part + j times by the imaginary part
    std::vector<std::complex<double>> shares;
    std::vector<std::complex<double>> impulses;
  };
  [[nodiscard]] std::optional<Sensitivity> sensitivity(const ClosedMotion& motion) const;

  /// Why the motion does not exist; empty where it does.
  [[nodiscard]] std::string reason_against(const ClosedMotion& motion) const;
  /// The j-th derivative of x2 - x1 just before each impact; of the position without the middle.
  [[nodiscard]] std::vector<double> gap(const ClosedMotion& motion, std::size_t derivative) const;
  /// Fundamental of the impulses: sum_b I_b e^{-j omega t_b} 2/period at `turns` times the frequency of the motion.
  [[nodiscard]] static std::complex<double> strength(const ClosedMotion& motion, int turns);

  [[nodiscard]] const ImpulseAnswer& response() const noexcept { return response_; }
  /// Speed of the masses towards each other per impulse.
  [[nodiscard]] double exchange() const noexcept { return exchange_; }
  [[nodiscard]] double half_clearance() const noexcept { return half_clearance_; }
  [[nodiscard]] const std::vector<double>& walls() const noexcept { return walls_; }

 private:
  CycleEquations(const TwoMassSystem& system, const CycleGuess& guess, ImpulseAnswer response,
                 std::optional<double> static_gap);
  [[nodiscard]] ClosedMotion start(const CycleGuess& guess, double phase) const;
  // x2 - x1 and its derivatives by the force, a time after the first impact.
  [[nodiscard]] std::array<double, 3> forced_at(const ClosedMotion& motion, double time) const;
  [[nodiscard]] GapSample gap_at(const ClosedMotion& motion, const AnsweredTrain& train, double time) const;
  [[nodiscard]] double improve(ClosedMotion& motion) const;
  [[nodiscard]] std::vector<double> residuals(const ClosedMotion& motion, double scale) const;
  [[nodiscard]] std::vector<double> derivatives(const ClosedMotion& motion, double scale) const;

  ImpulseAnswer response_;
  std::optional<FundamentalAnswer> answer_;
  std::optional<ForcedGap> forced_;
  std::optional<double> static_gap_;  // of a constant force between the bodies, m/N, if they settle
  double half_clearance_;
  double exchange_;
  std::size_t count_;
  std::vector<double> walls_;  // 1: +clearance/2
};

}  // namespace backlash::detail
