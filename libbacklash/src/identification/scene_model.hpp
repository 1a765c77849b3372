// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <complex>
#include <cstddef>
#include <optional>
#include <vector>

#include "backlash/identification/scene_identification.hpp"
#include "friction_response.hpp"
#include "scene_response.hpp"

namespace backlash::detail {

/// ln mass1, ln mass2, ln clearance, restitution, the time of a free contact in units of SceneData::time_unit, 0 of
/// hard ones, and the dry friction of both masses in units of SceneData::force_unit.
constexpr std::size_t scene_size = 7;
constexpr std::size_t first_friction = 5;
using SceneVector = std::array<double, scene_size>;

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
  /// ln(1 + (misfit/(tolerable misfit))^2): rates places that fit only part of the data.  `model` empty: no steady
  /// motion, at the price of a value of which only the size is known.
  [[nodiscard]] double robust_cost(const MeasuredPoint& point, std::optional<std::complex<double>> model) const;
};

/// A point as masses without dry friction would have it, by harmonic balance: the fundamental 4/pi f of each friction,
/// against the velocity of its mass, acts beside the force, so that force and value of the point change.
/// @param masses  kg, of which only friction on mass 1 and that of what is not measured take notice
/// @param friction  of both masses, N
[[nodiscard]] MeasuredPoint without_friction(const MeasuredPoint& point, Output output,
                                             const std::array<double, 2>& masses,
                                             const std::array<double, 2>& friction);

/// N = (rigid + moving h)/omega^2; of a harmonic above the first without the rigid term.
struct OutputCoefficients {
  double rigid, moving;
  std::array<double, 2> rigid_by_log_mass, moving_by_log_mass;
};
[[nodiscard]] OutputCoefficients output_coefficients(const SceneVector& theta, Output output);

[[nodiscard]] double gamma_at(const SceneVector& theta, const MeasuredPoint& point);

struct PointGradient {
  std::complex<double> value;
  std::array<std::complex<double>, scene_size> gradient;
};
/// omega times the time of a free contact.
[[nodiscard]] double contact_angle(const SceneVector& theta, const SceneData& data, const MeasuredPoint& point);

[[nodiscard]] PointGradient point_gradient(const OutputCoefficients& coefficients, const SceneData& data,
                                           const MeasuredPoint& point, const GapResponse& response);
[[nodiscard]] std::complex<double> point_value(const OutputCoefficients& coefficients, const MeasuredPoint& point,
                                               std::complex<double> h);

[[nodiscard]] FrictionGroups friction_groups(const SceneVector& theta, const SceneData& data,
                                             const MeasuredPoint& point);
/// N of n = m omega^2 N, m the reduced mass.
[[nodiscard]] std::complex<double> friction_value(const SceneVector& theta, const MeasuredPoint& point,
                                                  std::complex<double> n);
[[nodiscard]] PointGradient friction_gradient(const SceneVector& theta, const SceneData& data,
                                              const MeasuredPoint& point, const FrictionResponse& response);

}  // namespace backlash::detail
