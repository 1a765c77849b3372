// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <complex>
#include <cstddef>
#include <vector>

#include "projection.hpp"

namespace frac::detail {

inline constexpr double least_arc_order = 0.1, most_power = 2;

/// One term of a sum, with x = s T and T = exp(-log_size).  An order that is held takes no part in the search.
struct Term {
  enum class Kind {
    power,            // s^order
    arc,              // 1/(1 + x^order)
    mode,             // x^order/(1 + 2 z x + x^2), z = exp(log_damping), a held order of 0 or 1
    rise,             // x^order/(1 + x^order): 1 less an arc
    gerischer,        // 1/sqrt(1 + x), like all below with a held order
    layer_short,      // tanh(sqrt(x))/sqrt(x)
    layer_open,       // coth(sqrt(x))/sqrt(x)
    structural_mode,  // x^order/(x^q + x^2), q = exp(log_damping): a constant loss angle of q pi/2
    normal_spread,    // mean of 1/(1 + s t), ln t normal about ln T with deviation exp(log_width)
    even_spread,      // the same, ln t even within exp(log_width) on either side of ln T
  } kind = Kind::power;
  double order = 0;
  bool held = false;
  double log_size = 0;  // of all but powers: frequency at the top, in units of the middle of the band
  double log_damping = 0;
  double least_order = -most_power, most_order = most_power;  // of a power
  double log_width = 0;                                       // of a spread

  [[nodiscard]] bool is_mode() const { return kind == Kind::mode || kind == Kind::structural_mode; }
  [[nodiscard]] bool is_spread() const { return kind == Kind::normal_spread || kind == Kind::even_spread; }
  [[nodiscard]] std::size_t nonlinear() const {
    return (kind == Kind::power ? 0u : is_mode() || is_spread() ? 2u : 1u) + (held ? 0u : 1u);
  }
};
using TermSum = std::vector<Term>;

/// Whether the two stand for the same power.
[[nodiscard]] bool same_power(const Term& a, const Term& b);
/// The power of an order that is held.
[[nodiscard]] constexpr Term whole_power(double order) {
  return {Term::Kind::power, order, true};
}
/// The sum with one term more, and without its k-th.
[[nodiscard]] TermSum with_term(TermSum sum, const Term& term);
[[nodiscard]] TermSum without_term(TermSum sum, std::size_t k);

/// A sum at its least cost.
struct TermFit {
  TermSum sum;
  double cost = 0;             // sum of squared residuals in the unit of the rule
  std::size_t parameters = 0;  // that the residuals can tell apart, coefficients included
};

[[nodiscard]] bool costs_less(const TermFit& a, const TermFit& b);

/// Weighted least squares of sums of terms: coefficients of either sign by projection, places and orders by search.
class TermProblem : public ProjectedData {
 public:
  using ProjectedData::ProjectedData;

  /// The sum with each of the terms, at its cost as it is; parameters are not counted.
  [[nodiscard]] std::vector<TermFit> along(const TermSum& sum, const std::vector<Term>& terms) const;
  /// along() where only terms whose coefficient is positive count; the cost with any other is infinite.
  /// @param linear   of the sum
  /// @param further  columns of the terms as weighted() gives them
  [[nodiscard]] std::vector<TermFit> along_gaining(const TermSum& sum, const Linear& linear,
                                                   const std::vector<Term>& terms, Eigen::MatrixXd further) const;
  [[nodiscard]] TermFit refine(TermSum sum, const Effort& effort) const;
  /// Appends the `count` starts of least cost, each refined a little.
  void refine_best(std::vector<TermFit> starts, std::size_t count, std::vector<TermFit>& refined) const;
  /// At each point; empty where a number overflows.
  [[nodiscard]] std::vector<std::complex<double>> response(const TermSum& sum) const;
  /// Coefficients, for s in rad/s.
  [[nodiscard]] std::vector<double> coefficients(const TermSum& sum) const;

  /// For gauss_newton().
  [[nodiscard]] Eigen::MatrixXcd columns(const TermSum& sum) const;
  [[nodiscard]] Eigen::MatrixXcd derivatives(const TermSum& sum, const Linear& linear) const;
  [[nodiscard]] StepBounds step_bounds(const TermSum& sum) const;
  [[nodiscard]] TermSum stepped(const TermSum& sum, const Eigen::VectorXd& step) const;
};

}  // namespace frac::detail
