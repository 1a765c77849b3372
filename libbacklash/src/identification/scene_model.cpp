// SPDX-License-Identifier: BSD-3-Clause
#include "scene_model.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace backlash::detail {
namespace {

using Complex = std::complex<double>;

}  // namespace

MeasuredPoint without_friction(const MeasuredPoint& point, Output output, const std::array<double, 2>& masses,
                               const std::array<double, 2>& friction) {
  if (friction[0] == 0 && friction[1] == 0) return point;
  constexpr double fundamental = 4 / std::numbers::pi;
  const double square = point.omega * point.omega;
  const std::size_t read = output == Output::x1 ? 0 : 1, other = 1 - read;
  const std::array<double, 2> most = {fundamental * friction[0], fundamental * friction[1]};
  const Complex position = point.force * point.value;
  std::array<Complex, 2> resisted;  // along the velocity, j times the position
  resisted[read] = Complex(0, most[read]) * position / std::abs(position);
  // Of the other mass R - M omega^2 X = (j |R| - M omega^2 |X|) X/|X| is what else acts on it, contact and force.
  const Complex of_read = resisted[read] - masses[read] * square * position;
  const Complex acting = point.force - of_read;
  const Complex turned(-std::sqrt(std::max(0.0, std::norm(acting) - most[other] * most[other])), most[other]);
  resisted[other] = Complex(0, most[other]) * (acting / turned) / std::abs(acting / turned);
  const Complex force = point.force - resisted[1] + masses[1] / masses[0] * resisted[0];
  MeasuredPoint result = point;
  result.force = std::abs(force);
  result.value = (position - resisted[0] / (masses[0] * square)) / force;
  return result;
}

OutputCoefficients output_coefficients(const Coordinates& theta, Output output) {
  const double mass1 = std::exp(theta[0]);
  const double mass2 = std::exp(theta[1]);
  const double total = mass1 + mass2;
  if (output == Output::x1) return {0, -1 / total, {0, 0}, {mass1 / total / total, mass2 / total / total}};
  const double moving = mass1 / mass2 / total;
  return {-1 / mass2, moving, {0, 1 / mass2}, {moving * mass2 / total, -moving * (1 + mass2 / total)}};
}

double gamma_at(const Coordinates& theta, const MeasuredPoint& point) {
  return std::exp(std::log(point.force) - theta[1] - theta[2] - 2 * std::log(point.omega));
}

Complex point_value(const OutputCoefficients& coefficients, const MeasuredPoint& point, Complex h) {
  const double rigid = point.harmonic == 1 ? coefficients.rigid : 0;
  return (rigid + coefficients.moving * h) / (point.omega * point.omega);
}

double contact_angle(const Coordinates& theta, const SceneData& data, const MeasuredPoint& point) {
  return theta[4] * data.time_unit * point.omega;
}

PointGradient point_gradient(const OutputCoefficients& coefficients, const SceneData& data, const MeasuredPoint& point,
                             const GapResponse& response) {
  const double scale = 1 / (point.omega * point.omega);
  const Complex by_log_gamma = scale * coefficients.moving * response.by_log_gamma;
  const auto by_mass = [&](std::size_t i) {
    const double rigid = point.harmonic == 1 ? coefficients.rigid_by_log_mass[i] : 0;
    return scale * (rigid + coefficients.moving_by_log_mass[i] * response.h);
  };
  return {point_value(coefficients, point, response.h),
          {by_mass(0), by_mass(1) - by_log_gamma, -by_log_gamma, scale * coefficients.moving * response.by_restitution,
           scale * coefficients.moving * data.time_unit * point.omega * response.by_contact, 0, 0}};
}

FrictionGroups friction_groups(const Coordinates& theta, const SceneData& data, const MeasuredPoint& point) {
  const double scale = data.force_unit / point.force;
  return {gamma_at(theta, point),
          contact_angle(theta, data, point),
          theta[3],
          std::exp(theta[0] - theta[1]),
          {theta[first_friction] * scale, theta[first_friction + 1] * scale}};
}

Complex friction_value(const Coordinates& theta, const MeasuredPoint& point, Complex n) {
  const double inverse_mass = std::exp(-theta[0]) + std::exp(-theta[1]);
  return n * inverse_mass / (point.omega * point.omega);
}

PointGradient friction_gradient(const Coordinates& theta, const SceneData& data, const MeasuredPoint& point,
                                const FrictionResponse& response) {
  const double scale = data.force_unit / point.force, share = 1 / (1 + std::exp(theta[0] - theta[1]));
  const auto value = [&](Complex n) { return friction_value(theta, point, n); };
  // 1/m = 1/mass1 + 1/mass2, of which the first is mass2/(mass1 + mass2).
  return {value(response.n),
          {value(response.by_log_mass_ratio - share * response.n),
           value(-response.by_log_gamma - response.by_log_mass_ratio - (1 - share) * response.n),
           value(-response.by_log_gamma), value(response.by_restitution),
           value(data.time_unit * point.omega * response.by_tau), value(scale * response.by_friction[0]),
           value(scale * response.by_friction[1])}};
}

}  // namespace backlash::detail
