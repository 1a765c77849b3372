// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <complex>
#include <vector>

#include "unit_design.hpp"

namespace frac::detail {

/// Logarithms of the poles of a ladder of which zeros_i = 1/poles_i and gain = prod poles_i, rising.
using LogPoles = std::vector<long double>;

/// Poles by the equilibrium distribution: the largest error is then within a factor of about ten of the optimum.
[[nodiscard]] LogPoles starting_log_poles(const UnitProblem& problem, int poles);

/// Poles p and zeros 1/p alternate, a zero being the smallest.
[[nodiscard]] bool interlaced(const LogPoles& log_poles);

[[nodiscard]] LogPoles moved(const LogPoles& log_poles, const std::vector<double>& change, double share);

/// Errors of a ladder on a grid of half the band (the other half mirrors it), E = ln(H/(j omega)^order), and the steps
/// that lessen them.  Errors are evaluated in extended precision, steps solved in double: what a step leaves is removed
/// by the next.
class LogPoleProblem {
 public:
  LogPoleProblem(const UnitProblem& problem, int poles);

  void evaluate(const LogPoles& log_poles);
  /// Largest of max(|e^E - 1|, |e^-E - 1|), which is the relative error over the whole band.
  [[nodiscard]] double largest() const { return largest_; }
  /// Root of the weighted mean of the squares of that error.
  [[nodiscard]] double weighted_mean() const;
  /// (mean |E|^power)^(1/power) without weights.
  [[nodiscard]] double power_mean(int power) const;

  /// Lawson (1961): the weights that make weighted least squares a minimax solution are met by multiplying them with
  /// the errors; a power above 1 hastens the first steps.
  void sharpen(double power);

  struct Step {
    std::vector<double> change;  // of the logarithms of the poles; empty when it is not finite
    double predicted;            // weighted mean after it, to first order: no ladder nearby has a smaller largest error
  };
  /// Gauss-Newton step of weighted least squares.  With more poles than the error needs, some displacements hardly
  /// change it and would be driven far by rounding and curvature; a ridge of `damping` times the error (Yamashita,
  /// Fukushima 2001) holds them back.
  [[nodiscard]] Step weighted_step(const LogPoles& log_poles, double damping) const;
  /// Newton step of power_mean(power), without the second derivatives of E, which are multiplied with E.
  [[nodiscard]] std::vector<double> power_step(const LogPoles& log_poles, int power, double damping) const;

 private:
  double order_;
  int poles_;
  std::vector<double> log_omega_;
  std::vector<long double> omega_;
  std::vector<std::complex<long double>> error_;
  std::vector<double> measure_;
  double largest_ = 0;
  std::vector<double> weight_;
};

}  // namespace frac::detail
