// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <complex>
#include <cstddef>
#include <vector>

#include "projection.hpp"

namespace frac::detail {

/// One term of a sum: s^order, an arc 1/(1 + (s T)^order) with T = exp(-log_size), a mode x^order/(1 + 2 z x + x^2)
/// with x = s T, z = exp(log_damping) and a held order of 0 or 1, or lags 1/(1 + s t) with times t spread about T: ln t
/// has the standard deviation exp(log_width) of a normal distribution, or is even within exp(log_width) on either side.
/// An order that is held takes no part in the search.
struct Term {
  enum class Kind { power, arc, mode, normal_spread, even_spread } kind = Kind::power;
  double order = 0;
  bool held = false;
  double log_size = 0;  // of all but powers: frequency at the top, in units of the middle of the band
  double log_damping = 0;
  double log_width = 0;

  [[nodiscard]] bool is_spread() const { return kind == Kind::normal_spread || kind == Kind::even_spread; }
  [[nodiscard]] std::size_t nonlinear() const {
    return (kind == Kind::power ? 0u : kind == Kind::arc ? 1u : 2u) + (held ? 0u : 1u);
  }
};
using TermSum = std::vector<Term>;

/// Whether the two stand for the same power.
[[nodiscard]] bool same_power(const Term& a, const Term& b);

/// A sum at its least cost.
struct TermFit {
  TermSum sum;
  double cost = 0;             // sum of squared residuals in the unit of the rule
  std::size_t parameters = 0;  // that the residuals can tell apart, coefficients included
};

/// Weighted least squares of sums of terms: coefficients of either sign by projection, places and orders by search.
class TermProblem : public ProjectedData {
 public:
  using ProjectedData::ProjectedData;

  /// The sum with each of the terms, at its cost as it is; parameters are not counted.
  [[nodiscard]] std::vector<TermFit> along(const TermSum& sum, const std::vector<Term>& terms) const;
  [[nodiscard]] TermFit refine(TermSum sum, const Effort& effort) const;
  /// At each point; empty where a number overflows.
  [[nodiscard]] std::vector<std::complex<double>> response(const TermSum& sum) const;
  /// Coefficients, for s in rad/s.
  [[nodiscard]] std::vector<double> coefficients(const TermSum& sum) const;

  /// For gauss_newton().
  [[nodiscard]] Eigen::MatrixXcd columns(const TermSum& sum) const;
  [[nodiscard]] Eigen::MatrixXcd derivatives(const TermSum& sum, const Linear& linear) const;
  [[nodiscard]] Reach reach(const TermSum& sum) const;
  [[nodiscard]] TermSum stepped(const TermSum& sum, const Eigen::VectorXd& step) const;
};

inline constexpr double least_arc_order = 0.1, most_power = 2;

}  // namespace frac::detail
