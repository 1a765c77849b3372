// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <complex>
#include <cstddef>
#include <memory>
#include <vector>

#include "projection.hpp"
#include "record_answers.hpp"

namespace frac::detail {

/// One factor of a denominator in z = s^order: z/p^order + 1 with p = sign exp(log_size), or
/// (s/w)^(2 order) + 2 sinh(damping) (s/w)^order + 1 with w = exp(log_size).  The hyperbolic sine lets a pair run from
/// undamped to two distant real poles, and into the right half plane of z, without a seam.  Sizes are frequencies, in
/// units of the middle of the band, whatever the order.
struct PoleFactor {
  bool pair = false;
  double log_size = 0;
  double damping = 0;  // of a pair
  double sign = 1;     // of a single pole: -1 in the right half plane
};

/// exp(-L s) (c_low z^low + ... + c_degree z^degree)/(z^integrators * factors), z = s^order, without its coefficients
/// c, which follow from linear least squares wherever the other parameters are known.
struct RationalShape {
  std::vector<PoleFactor> factors;
  std::size_t integrators = 0;
  std::size_t low = 0;
  std::size_t degree = 0;
  bool delayed = false;
  double delay = 0;  // in units of 1/(middle of the band)
  bool free_order = false;
  double order = 1;  // of s in z

  /// Poles in z, integrators included.
  [[nodiscard]] std::size_t poles() const;
  /// Whether the order makes a difference and is searched for.
  [[nodiscard]] bool searches_order() const { return free_order && (poles() > 0 || degree > 0); }
  /// Stable real poles, and a dead time as one: what approximations of fractional systems consist of.
  [[nodiscard]] std::size_t relaxations() const;
  /// Parameters that act nonlinearly.
  [[nodiscard]] std::size_t nonlinear() const {
    return poles() - integrators + (delayed ? 1 : 0) + (searches_order() ? 1 : 0);
  }
};

/// A shape at its least cost.
struct RationalFit {
  RationalShape shape;
  double cost = 0;             // sum of squared residuals in the unit of the rule
  std::size_t parameters = 0;  // that the residuals can tell apart, coefficients included
  double likely_cost = cost;   // ProjectedData::likely_cost()
};

/// The region where poles in z may lie.
enum class Poles {
  anywhere,
  left_half_plane,  // of z, which is stable for orders up to 1 and leaves some stable ones out below
  /// |arg z| >= order pi/2: the s-plane's left half and its axis, on the principal sheet.
  stable,
};

/// The distance that a pair keeps from the edge of the stable sector, as sinh(damping): at 1e-8 of its frequency the
/// edge is met to the rounding of any data, so that a free pair is on it, and a held one strictly inside.
inline constexpr double at_the_edge = 1e-8;
/// sinh(damping) of a pair of poles on the imaginary axis: z^2 + 2 sinh(damping) z + 1 has roots of the argument order
/// pi/2 there.
[[nodiscard]] double least_sinh_damping(double order);
/// Whether a pole lies right of the imaginary axis.
[[nodiscard]] bool is_unstable(const RationalShape& shape);

/// Weighted least squares of rational functions of z = s^order by variable projection: the residuals are linear in the
/// numerator, so only poles, delay and order are searched for.
class RationalProblem : public ProjectedData {
 public:
  /// @param rule  see ProjectedData
  RationalProblem(const FrequencyResponseData& data, const ResidualRule& rule, Poles poles = Poles::anywhere);
  /// Of a record at so many of its outputs that they tell members of a family apart.  No shape has more zeros than
  /// poles there.
  RationalProblem(const TimeResponseData& data, const TimeFitOptions& options, Poles poles = Poles::anywhere);

  /// The problem at so few of its points that scouting is quick, or itself.
  [[nodiscard]] const RationalProblem& few() const { return few_ ? *few_ : *this; }

  /// Cost at the shape as it is; infinite where the model overflows.
  [[nodiscard]] RationalFit at(const RationalShape& shape) const;
  /// Columns that, beside those of a shape, span what it becomes with one factor more and as many zeros more as that
  /// has poles: a part of its expansion in partial fractions.
  [[nodiscard]] Eigen::MatrixXcd columns_of(const PoleFactor& factor, const RationalShape& shape) const;
  /// Searches from the shape.  Poles change kind on the way.
  [[nodiscard]] RationalFit refine(const RationalShape& start, const Effort& effort) const;
  [[nodiscard]] Poles poles() const { return poles_; }
  /// In units of 1/(middle of the band): a turn at the lower end, or as far as the spacing of the points tells.
  [[nodiscard]] double longest_delay() const { return longest_delay_; }
  /// Correlation of neighbouring residuals.
  [[nodiscard]] double correlation(const RationalShape& shape) const;
  /// Size of the residual at each point.
  [[nodiscard]] std::vector<double> residual_sizes(const RationalShape& shape) const;
  /// Values at the frequencies of the data; empty where the model overflows.
  [[nodiscard]] std::vector<std::complex<double>> response(const RationalShape& shape) const;
  /// Coefficients of z^low .. z^degree, s in rad/s, of the numerator; the shortest where some are not seen.
  [[nodiscard]] std::vector<double> numerator(const RationalShape& shape) const;

  /// For gauss_newton().
  [[nodiscard]] Eigen::MatrixXcd columns(const RationalShape& shape) const;
  [[nodiscard]] Eigen::MatrixXcd derivatives(const RationalShape& shape, const Linear& linear) const;
  [[nodiscard]] StepBounds step_bounds(const RationalShape& shape) const;
  [[nodiscard]] RationalShape stepped(const RationalShape& shape, const Eigen::VectorXd& step) const;

 private:
  /// @param outputs  of a record that are to be used at most
  RationalProblem(const TimeResponseData& data, const TimeFitOptions& options, Poles poles, std::size_t outputs);
  [[nodiscard]] std::size_t parameter_count(const RationalShape& shape, Eigen::Index rank) const;
  /// Values of the columns at s.
  [[nodiscard]] Eigen::MatrixXcd frequency_columns(const RationalShape& shape) const;
  /// Pairs beyond the stable sector go to its edge.
  void keep_in_sector(RationalShape& shape) const;
  [[nodiscard]] RationalFit searched(RationalShape shape, const Effort& effort) const;

  Poles poles_;
  std::shared_ptr<const RecordAnswers> record_;  // none for a frequency response
  double longest_delay_;
  std::shared_ptr<const RationalProblem> few_;
};

/// Orders of s in which a rational function is searched for.  Above 1 the poles of a stable system of order 1 and less
/// would lie on the next sheet; below the lower end a power changes by 3 % in an e-fold of frequency.
inline constexpr double least_order = 0.1, most_order = 1.5;

}  // namespace frac::detail
