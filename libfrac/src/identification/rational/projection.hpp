// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <complex>
#include <cstddef>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "base/gram_schmidt.hpp"
#include "frac/model/frequency_response_data.hpp"
#include "identification/data/first_order_whitening.hpp"
#include "identification/data/residual_rule.hpp"
#include "realisation/power_grid.hpp"

namespace frac::detail {

/// How far what acts nonlinearly may change at once.
struct StepBounds {
  std::vector<double> moderate;      // either way: beyond, the linear picture seldom holds
  std::vector<double> lower, upper;  // what the limits leave

  /// @param most  that are added
  explicit StepBounds(std::size_t most) {
    for (std::vector<double>* const each : {&moderate, &lower, &upper}) each->reserve(most);
  }
  /// Adds the bounds of one more, whose value stays between `least` and `most`.
  void add(double moderate_change, double value, double least, double most) {
    moderate.push_back(moderate_change);
    lower.push_back(std::min(least - value, 0.0));
    upper.push_back(std::max(most - value, 0.0));
  }
};

/// Normal equations of what acts nonlinearly.
struct NormalEquations {
  Eigen::MatrixXd matrix;
  Eigen::VectorXd gradient;

  /// The step between the bounds, which enclose 0, that lowers the linearised cost most.
  [[nodiscard]] Eigen::VectorXd step(const Eigen::VectorXd& lower, const Eigen::VectorXd& upper) const;
  /// The amount by which a step lowers the linearised cost.
  [[nodiscard]] double gain(const Eigen::VectorXd& step) const;
};

/// Outputs of a record as residuals see them: weighted, freed of the correlation of their noise and of what offset and
/// drift explain.
struct RecordRows {
  Eigen::VectorXd time;  // s, from the first sample
  Eigen::VectorXd weight, output;
  FirstOrderWhitening whitening;
  Eigen::MatrixXd background;  // orthonormal, of weighted and whitened offset and drift
  double slow, fast;           // rad/s: the band that the record resolves
  bool coloured;               // whether the noise may be of first order, with a correlation that nobody told

  void put(const Eigen::Ref<const Eigen::VectorXd>& values, Eigen::Ref<Eigen::VectorXd> column) const;
};

/// Data and weights of residuals that are linear in the coefficients of a model: sum c_k column_k at the frequencies of
/// a response, or at the outputs of a record.  Frequencies are in units of the middle of the band.
class ProjectedData {
 public:
  /// @param rule  of the imaginary, the real, or both parts
  ProjectedData(const FrequencyResponseData& data, const ResidualRule& rule);
  /// Columns are the real parts of values at the outputs of a record; s runs over the band that it resolves, with as
  /// many frequencies as the outputs tell apart.
  explicit ProjectedData(RecordRows record);

  [[nodiscard]] std::size_t rows() const { return static_cast<std::size_t>(target_.size()); }
  /// Frequencies of a response or outputs of a record.
  [[nodiscard]] std::size_t points() const { return record_ ? rows() : log_omega_.size(); }
  /// Whether residuals are of the real or of the imaginary part alone.
  [[nodiscard]] bool one_part() const { return form_ != ResidualForm::cartesian; }
  [[nodiscard]] double centre_omega() const { return centre_; }
  [[nodiscard]] double log_lower() const { return log_lower_; }  // of the band
  [[nodiscard]] double log_upper() const { return -log_lower_; }
  [[nodiscard]] const std::vector<double>& log_omega() const { return log_omega_; }
  [[nodiscard]] const Eigen::VectorXcd& s() const { return s_; }
  [[nodiscard]] const Eigen::VectorXcd& log_s() const { return log_s_; }
  /// |s|^order
  void power_sizes(double order, double* sizes) const { grid_.powers(order, 0, {sizes, log_omega_.size()}); }
  /// (s e^shift)^order, all of one phase.
  [[nodiscard]] Eigen::ArrayXcd power(double order, double shift = 0) const;
  /// e^{-s time}
  [[nodiscard]] Eigen::ArrayXcd delayed(double time) const;
  /// d ln|value| / d ln omega of the data at the upper end of the band, over half a decade or three points.  A record
  /// hardly shows that end, where the response may fall as steeply as any.
  [[nodiscard]] double end_slope() const { return end_slope_; }
  /// The weighted data, as the residuals hold them.
  [[nodiscard]] const Eigen::VectorXd& target() const { return target_; }
  /// The cost that white noise would have where it is as likely as what a model leaves: `cost`, or less of a record in
  /// coloured noise.
  [[nodiscard]] double likely_cost(const Eigen::VectorXd& residual, double cost) const;
  /// Sum of the squared weighted data.
  [[nodiscard]] double data_power() const { return target_.squaredNorm(); }
  /// Costs below it are rounding.
  [[nodiscard]] double rounding_cost() const { return 1e-28 * static_cast<double>(rows()); }
  /// Costs below it, residuals of 1e-9 of the data, are no reason to grow: the data themselves are seldom better.
  [[nodiscard]] double negligible_cost() const { return 1e-18 * static_cast<double>(rows()); }

  /// Columns as the residuals see them.
  struct Weighted {
    Eigen::MatrixXd matrix;  // over their lengths; zeros where the fitted part is blind to a column
    Eigen::VectorXd length;
  };
  /// The residual that the best coefficients of given columns leave.
  struct Projection {
    Orthonormalised columns;  // over their lengths, and the data
    Eigen::VectorXd length;   // of the columns
    double cost;
  };
  /// Nothing where a number overflows or no column is seen.
  [[nodiscard]] std::optional<Projection> project(const Eigen::MatrixXcd& columns) const;
  /// Nothing where a number overflows.
  [[nodiscard]] std::optional<Weighted> weighted(const Eigen::MatrixXcd& columns) const;

  /// The best coefficients of given columns.
  struct Linear {
    Eigen::MatrixXd orthonormal;  // of the column space
    Eigen::VectorXd residual;
    Eigen::VectorXcd model;
    Eigen::VectorXd coefficients;
    Eigen::MatrixXcd columns;
    double cost = std::numeric_limits<double>::infinity();
  };
  /// False where a number overflows.
  bool complete(Eigen::MatrixXcd columns, Projection&& projection, Linear& linear) const;
  /// Projects and completes at once; false where a number overflows or no column is seen.
  bool solve(Eigen::MatrixXcd columns, Linear& linear) const;
  /// Cost with further columns beside those of a solution; infinite where a number overflows.
  [[nodiscard]] double cost_with(const Linear& linear, const Eigen::MatrixXcd& further) const;
  /// Normal equations from derivatives at fixed coefficients, less what new coefficients take up (Kaufman 1975).
  [[nodiscard]] NormalEquations normal_equations(const Eigen::MatrixXcd& derivatives, const Linear& linear) const;
  /// Rows of complex values, as the residuals hold them.
  void put(const Eigen::Ref<const Eigen::VectorXcd>& values, Eigen::Ref<Eigen::VectorXd> column) const;
  /// Size of the residual at each frequency: of its Fourier sum over a record.
  [[nodiscard]] std::vector<double> sizes(const Linear& linear) const;

 private:
  /// Frequencies in units of the middle of the band.
  void take_band(const std::vector<double>& omega);
  /// The same of a response, with the weighted part that is not fitted where one is.
  void put(const std::complex<double>* values, double* seen, double* unseen) const;

  std::optional<RecordRows> record_;
  ResidualForm form_;
  double centre_, log_lower_, end_slope_;
  std::vector<double> log_omega_;
  Eigen::VectorXd weight_, target_;
  Eigen::VectorXcd s_, log_s_;
  PowerGrid grid_;  // of |s|
};

/// Twice as fast as division, which also avoids overflow of the squares: for values between e^-200 and e^200.
[[nodiscard]] inline Eigen::ArrayXcd reciprocal(const Eigen::ArrayXcd& values) {
  return values.conjugate() * values.abs2().inverse().cast<std::complex<double>>();
}

/// n ln(cost/n) and price_of_parameters().  Negligible costs are equally good.
[[nodiscard]] double schwarz(const ProjectedData& data, double cost, std::size_t parameters);

/// Logarithms of places where a search starts, evenly over the band and its margins.
[[nodiscard]] std::vector<double> places(const ProjectedData& data, int count);

/// When a search for the least cost ends.
struct Effort {
  int iterations;
  double tolerance;  // gains below this fraction of the cost are none
  /// The cost that is of use: after its first few steps, which bounds may hold, a search ends where it would stay above
  /// if each step left took twice the share of the cost that the next one promises.
  double below = std::numeric_limits<double>::infinity();

  [[nodiscard]] Effort in_reach_of(double cost) const { return {iterations, tolerance, cost}; }
};
/// Effort of a fit that is to show whether a place is worth more, and of one that is to converge.
inline constexpr Effort scouting{12, 1e-5}, thorough{60, 1e-6};

/// Appends to `starts` each finite local minimum of the cost among fits along a line of places.
template <class Fit>
void add_local_minima(std::vector<Fit> along, std::vector<Fit>& starts) {
  for (std::size_t i = 0; i < along.size(); ++i) {
    const bool below_left = i == 0 || along[i].cost <= along[i - 1].cost;
    const bool below_right = i + 1 == along.size() || along[i].cost < along[i + 1].cost;
    if (below_left && below_right && std::isfinite(along[i].cost)) starts.push_back(along[i]);
  }
}

/// How far beyond the band poles and arcs are looked for: half a decade, in e-folds.
inline constexpr double search_margin = 1.2;
/// The price of the search for the place of a pole or an arc beside schwarz(), whose k ln n knows of one place only: 2
/// ln of the number of places that the data tell apart, the e-folds of the band and its margins.
[[nodiscard]] double price_of_place(const ProjectedData& data);
/// The price for a pair of poles or a mode, which can be as narrow as the distance between two points and then meets
/// their noise: its places are the points.
[[nodiscard]] double price_of_point(const ProjectedData& data);

/// Gauss-Newton in what acts nonlinearly, the coefficients following by projection (Golub, Pereyra 1973).  A box holds
/// the steps: what the data hardly see goes no further than its edge and does not keep the other parameters from going
/// there. Ceres is not used here: setting up one of its problems takes longer than one of these solves, of which a
/// growth makes hundreds.
/// @param problem  gives columns(shape), derivatives(shape, linear) of the model at fixed coefficients, one column for
///                 each of what step_bounds(shape) has, and stepped(shape, step)
/// @return whether the start has a finite cost
template <class Problem, class Shape>
bool gauss_newton(const Problem& problem, const ProjectedData& data, Shape& shape, ProjectedData::Linear& linear,
                  const Effort& effort) {
  if (!data.solve(problem.columns(shape), linear)) return false;
  double size = 1;  // of the box, over what is moderate
  int small_gains = 0;
  for (int iteration = 0; iteration < effort.iterations && linear.cost > data.rounding_cost(); ++iteration) {
    const Eigen::MatrixXcd derivatives = problem.derivatives(shape, linear);
    if (derivatives.cols() == 0 || !derivatives.allFinite()) break;
    const NormalEquations normal = data.normal_equations(derivatives, linear);
    const StepBounds bounds = problem.step_bounds(shape);
    const Eigen::Map<const Eigen::VectorXd> moderate(bounds.moderate.data(), derivatives.cols());
    const Eigen::Map<const Eigen::VectorXd> lower(bounds.lower.data(), derivatives.cols());
    const Eigen::Map<const Eigen::VectorXd> upper(bounds.upper.data(), derivatives.cols());
    bool stepped = false;
    for (int attempt = 0; attempt < 8 && !stepped; ++attempt) {
      const Eigen::VectorXd step = normal.step(lower.cwiseMax(-size * moderate), upper.cwiseMin(size * moderate));
      const double expected = normal.gain(step);
      if (!(expected > effort.tolerance * linear.cost)) break;
      constexpr int first_steps = 4;
      const double kept = std::max(1 - expected / linear.cost, 0.0);
      const int left = effort.iterations - iteration;
      if (attempt == 0 && iteration >= first_steps && linear.cost * std::pow(kept, 2 * left) > effort.below) break;
      Shape next = problem.stepped(shape, step);
      Eigen::MatrixXcd columns = problem.columns(next);
      auto projection = data.project(columns);
      const double gain = projection ? linear.cost - projection->cost : -expected;
      // The picture holds as far as the gain is what it lets expect.
      const double used = step.cwiseQuotient(moderate).lpNorm<Eigen::Infinity>();
      if (gain < 0.25 * expected) {
        size = used / 4;
      } else if (gain > 0.75 * expected) {
        size = std::min(std::max(size, 2 * used), 1.0);
      }
      ProjectedData::Linear there;
      if (!(gain > 0) || !data.complete(std::move(columns), std::move(*projection), there)) continue;
      small_gains = gain < effort.tolerance * linear.cost ? small_gains + 1 : 0;
      shape = std::move(next);
      linear = std::move(there);
      stepped = true;
    }
    if (!stepped || small_gains >= 2) break;
  }
  return true;
}

}  // namespace frac::detail
