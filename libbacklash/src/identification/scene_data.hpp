// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <complex>
#include <cstddef>
#include <optional>
#include <vector>

#include "backlash/identification/scene_identification.hpp"

namespace backlash::detail {

/// Standard deviations that chance exceeds on one side once in a thousand.
constexpr double significant = 3.09;

struct MeasuredPoint {
  std::size_t curve, index;
  double force, omega;
  std::complex<double> value;
  double sigma;            // NaN when unknown
  int harmonic = 1;        // 1, 3 or 5
  std::size_t motion = 0;  // place of the first point of this force and frequency, whose motion it is
};

/// All points of all curves, in the order of the curves and of rising omega, and how residuals are formed of them.
struct SceneData {
  std::vector<MeasuredPoint> points;
  std::vector<std::size_t> curve_begin;  // and the end of the last curve
  Output output;
  frac::Component component;
  frac::Weight weight;
  double typical;         // median |value|
  double typical_misfit;  // median of |value| over its deviation
  double time_unit;       // s, 1 over the median omega
  double force_unit;      // N, the least force amplitude
  int harmonics = 1;      // the highest of the points

  [[nodiscard]] std::size_t residuals_per_point() const { return component == frac::Component::both ? 2 : 1; }
  /// The parts of a complex number that form residuals; the second one is 0 when there is only one.
  [[nodiscard]] std::array<double, 2> parts(std::complex<double> z) const;
  /// Modulus of the fitted parts.
  [[nodiscard]] double size(std::complex<double> z) const;
  /// Standard deviation, up to a common factor, of a point at which the model has this value.
  [[nodiscard]] double deviation(const MeasuredPoint& point, std::complex<double> model) const;
  /// Variance below which residuals over their deviations are rounding errors, which may be correlated and mean
  /// nothing.
  [[nodiscard]] double rounding_variance() const;
  /// ln(1 + (misfit/(tolerable misfit))^2): rates places that fit only part of the data.  `model` empty: no steady
  /// motion, at the price of a value of which only the size is known.
  [[nodiscard]] double robust_cost(const MeasuredPoint& point, std::optional<std::complex<double>> model) const;
};

/// The steady motion a point is compared with.
struct PointChoice {
  /// two_impact: also the symmetric orbit of contacts that take time; sticking: also any other orbit of one period of
  /// these, and any of masses with friction.
  enum class Kind { none, two_impact, sticking, free };
  Kind kind = Kind::none;
  bool used = false;           // forms residuals, see scene_evidence
  std::complex<double> model;  // at the estimate; of kind none: about where an irregular motion has its mean
  int means = 0;               // of kind none: motions it may have, of which model is the nearest; 0: not known
  double accuracy = 0.03;      // of kind none: to which share N of such a motion is known; here means of a table, of
                               // which half lie within that of the irregular points, one in ten beyond 10 %
  double misfit = 0;           // |model - data| of the fitted parts over its deviation; 0 of kind none

  /// Takes a motion when it lies nearer to the data than what is there.
  /// @return whether it was taken
  bool offer(const SceneData& data, const MeasuredPoint& point, Kind kind, std::complex<double> model);
};

/// @throws std::invalid_argument  what identify_scene() says of curves, component and weight.
void check_curves(const std::vector<MeasuredDescribingFunction>& curves, const SceneIdentificationOptions& options);

/// Points of x1 with N = 0.
enum class LoadAtRest {
  left_out,  // it tells no more than that the masses do not touch
  kept,      // to speak against bodies that would have an orbit there
};

/// @throws std::invalid_argument  all data zero.
[[nodiscard]] SceneData scene_data(const std::vector<MeasuredDescribingFunction>& curves,
                                   const SceneIdentificationOptions& options,
                                   LoadAtRest at_rest = LoadAtRest::left_out);

/// Every n-th of the points, about so many.
[[nodiscard]] SceneData thinned(const SceneData& data, std::size_t points);

/// @throws std::invalid_argument  fewer residuals than parameters.
void require_residuals(const SceneData& data, std::size_t parameters);

/// mass2 clearance = F/(gamma omega_J^2) with the jumps of the data at omega_J.
[[nodiscard]] std::vector<double> products_from_jumps(const std::vector<MeasuredDescribingFunction>& curves);

[[nodiscard]] PointStatus status_of(const PointChoice& choice);

}  // namespace backlash::detail
