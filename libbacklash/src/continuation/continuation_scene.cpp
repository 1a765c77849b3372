// SPDX-License-Identifier: BSD-3-Clause
#include "continuation_scene.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "return_map.hpp"

namespace backlash::detail {
namespace {

constexpr double pi = std::numbers::pi;

Bifurcation kind(const SegmentEventAt& event) {
  switch (event.kind) {
    case SegmentEvent::fold:
      return Bifurcation::saddle_node;
    case SegmentEvent::grazing:
      return Bifurcation::grazing;
    case SegmentEvent::flip:
    case SegmentEvent::birth:
      break;
  }
  return event.orbit.symmetric() ? Bifurcation::symmetry_breaking : Bifurcation::period_doubling;
}

BranchEnd end(const SegmentBranch& segments, SegmentEnd end) {
  switch (end) {
    case SegmentEnd::range:
      return BranchEnd::range;
    case SegmentEnd::grazing:
      return BranchEnd::grazing;
    case SegmentEnd::birth:
      return segments.points.front().orbit.half_periods / 2 % 2 != 0 ? BranchEnd::symmetry_breaking
                                                                     : BranchEnd::period_doubling;
    case SegmentEnd::closed:
      return BranchEnd::closed;
    case SegmentEnd::lost:
      return BranchEnd::lost;
    case SegmentEnd::too_long:
      break;
  }
  return BranchEnd::too_long;
}

double log_gamma(const TwoMassSystem& system, double force, double omega) {
  return std::log(force / system.mass2() / system.clearance()) - 2 * std::log(omega);
}

}  // namespace

ParameterRange ContinuationScene::range(double from, double to) const {
  const double a = branch_parameter(from);
  const double b = branch_parameter(to);
  return {std::min(a, b), std::max(a, b)};
}

OrbitSegment ContinuationScene::motion_at(double branch_parameter) const {
  OrbitSegment segment;
  segment.along = parameter_ == OrbitParameter::restitution ? BranchParameter::restitution : BranchParameter::log_gamma;
  segment.restitution = system_.restitution();
  if (parameter_ == OrbitParameter::restitution) segment.log_gamma = log_gamma(system_, force_, omega_);
  segment.set_parameter(branch_parameter);
  return segment;
}

PeriodicOrbit ContinuationScene::orbit(const OrbitSegment& segment) const {
  const auto [omega, clearance] = scales(segment);
  PeriodicOrbit result{};
  result.parameter = parameter(segment);
  result.omega = omega;
  const double inertia = (system_.mass1() + system_.mass2()) * result.omega * result.omega;
  const std::complex<double> u = harmonic(segment, 1) / segment.gamma();
  result.value = (output_ == Output::x1 ? -(1.0 + u) : -1.0 + system_.mass1() / system_.mass2() * u) / inertia;
  result.multipliers = multipliers(segment);
  result.stable = return_map(segment).stable();
  const std::size_t count = segment.impacts.size() * (segment.symmetric() ? 2 : 1);
  const double unit = clearance * result.omega;
  const double begin = 2 * pi * std::floor(segment.impacts.front().phase / (2 * pi));
  for (std::size_t i = 0; i < count; ++i) {
    const SegmentImpact impact = segment.impact(i);
    result.impacts.push_back({impact.phase - begin, impact.wall == 0 ? Wall::near : Wall::far, impact.speed * unit});
  }
  return result;
}

OrbitBranch ContinuationScene::branch(const SegmentBranch& segments) const {
  const OrbitSegment& first = segments.points.front().orbit;
  OrbitBranch result{};
  result.symmetric = first.symmetric();
  result.period = result.symmetric ? first.half_periods : first.half_periods / 2;
  result.impacts = static_cast<int>(first.impacts.size()) * (result.symmetric ? 2 : 1);
  for (const auto& point : segments.points) result.orbits.push_back(orbit(point.orbit));
  for (const auto& event : segments.events) {
    result.bifurcations.push_back({kind(event), orbit(event.orbit), event.after});
  }
  result.begin = end(segments, segments.begin);
  result.end = end(segments, segments.end);
  return result;
}

double ContinuationScene::branch_parameter(double value) const {
  switch (parameter_) {
    case OrbitParameter::omega:
      return log_gamma(system_, force_, value);
    case OrbitParameter::force:
      return log_gamma(system_, value, omega_);
    case OrbitParameter::clearance:
      return log_gamma({system_.mass1(), system_.mass2(), value, system_.restitution()}, force_, omega_);
    case OrbitParameter::restitution:
    case OrbitParameter::contact_frequency:  // refused before
      break;
  }
  return value;
}

double ContinuationScene::parameter(const OrbitSegment& segment) const {
  switch (parameter_) {
    case OrbitParameter::omega:
      return scales(segment).omega;
    case OrbitParameter::force:
      return segment.gamma() * system_.mass2() * system_.clearance() * omega_ * omega_;
    case OrbitParameter::clearance:
      return scales(segment).clearance;
    case OrbitParameter::restitution:
    case OrbitParameter::contact_frequency:  // refused before
      break;
  }
  // The end of a range is met to rounding, also from outside.
  return std::clamp(segment.restitution, 0.0, 1.0);
}

ContinuationScene::Scales ContinuationScene::scales(const OrbitSegment& segment) const {
  const double mass = system_.mass2();
  if (parameter_ == OrbitParameter::omega) {
    return {std::sqrt(force_ / mass / system_.clearance()) * std::exp(-0.5 * segment.log_gamma), system_.clearance()};
  }
  if (parameter_ == OrbitParameter::clearance) return {omega_, force_ / mass / (omega_ * omega_) / segment.gamma()};
  return {omega_, system_.clearance()};
}

}  // namespace backlash::detail
