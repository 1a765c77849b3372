// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <complex>
#include <cstddef>

#include "friction_response.hpp"
#include "scene_family.hpp"
#include "scene_response.hpp"

namespace backlash::detail {

/// Coordinates of free masses: ln mass1, ln mass2, ln clearance, restitution, the time of a free contact in units of
/// SceneData::time_unit, 0 of hard ones, and the dry friction of both masses in units of SceneData::force_unit.
constexpr std::size_t scene_size = 7;
constexpr std::size_t first_friction = 5;

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
[[nodiscard]] OutputCoefficients output_coefficients(const Coordinates& theta, Output output);

[[nodiscard]] double gamma_at(const Coordinates& theta, const MeasuredPoint& point);

/// omega times the time of a free contact.
[[nodiscard]] double contact_angle(const Coordinates& theta, const SceneData& data, const MeasuredPoint& point);

[[nodiscard]] PointGradient point_gradient(const OutputCoefficients& coefficients, const SceneData& data,
                                           const MeasuredPoint& point, const GapResponse& response);
[[nodiscard]] std::complex<double> point_value(const OutputCoefficients& coefficients, const MeasuredPoint& point,
                                               std::complex<double> h);

[[nodiscard]] FrictionGroups friction_groups(const Coordinates& theta, const SceneData& data,
                                             const MeasuredPoint& point);
/// N of n = m omega^2 N, m the reduced mass.
[[nodiscard]] std::complex<double> friction_value(const Coordinates& theta, const MeasuredPoint& point,
                                                  std::complex<double> n);
[[nodiscard]] PointGradient friction_gradient(const Coordinates& theta, const SceneData& data,
                                              const MeasuredPoint& point, const FrictionResponse& response);

}  // namespace backlash::detail
