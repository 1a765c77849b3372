// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <complex>
#include <cstddef>
#include <optional>
#include <vector>

namespace backlash::detail {

struct SegmentImpact {
  double phase;  // tau = omega t
  double speed;  // before the impact, into the wall; negative on the virtual side of a grazing
  int wall;      // 0 or 1
};

/// The quantity that changes along a branch of orbits.
enum class BranchParameter { log_gamma, restitution };

/// A periodic orbit as the impacts of one period, or of one half of it where the second half is its mirror image
/// (half_periods odd: u(tau + half_periods pi) = 1 - u(tau)).  With phases and speeds of the impacts as unknowns the
/// flights give equations without any time of impact to be found,
///   u_i + (w_i - gamma sin tau_i)(tau_{i+1} - tau_i) - gamma (cos tau_{i+1} - cos tau_i) = u_{i+1},
///   w_i + gamma (sin tau_{i+1} - sin tau_i) = velocity before impact i+1,
/// w_i the velocity after impact i.  They are smooth through grazing, where the impact map has a square root.
struct OrbitSegment {
  double log_gamma = 0;
  double restitution = 0;
  int half_periods = 2;
  std::vector<SegmentImpact> impacts;  // phases rise; never empty
  BranchParameter along = BranchParameter::log_gamma;

  [[nodiscard]] double gamma() const noexcept;
  /// Value of the quantity that changes along the branch.
  [[nodiscard]] double parameter() const noexcept {
    return along == BranchParameter::log_gamma ? log_gamma : restitution;
  }
  void set_parameter(double value) noexcept { (along == BranchParameter::log_gamma ? log_gamma : restitution) = value; }
  [[nodiscard]] bool symmetric() const noexcept { return (half_periods & 1) != 0; }
  /// Impact i for i up to impacts.size(): the last one is the first one again.
  [[nodiscard]] SegmentImpact impact(std::size_t i) const noexcept;
};

/// 1 at the near wall u = 0, -1 at the far wall u = 1: the sign of the velocity after an impact.
[[nodiscard]] constexpr double side_of(int wall) noexcept {
  return wall == 0 ? 1 : -1;
}

/// Direction in the space of unknowns: d phase, d speed of each impact, then d parameter.
using Direction = std::vector<double>;
[[nodiscard]] Direction parameter_direction(const OrbitSegment& segment);
[[nodiscard]] Direction difference(const OrbitSegment& to, const OrbitSegment& from);
[[nodiscard]] OrbitSegment moved(const OrbitSegment& from, const Direction& direction, double length);
[[nodiscard]] double dot(const Direction& a, const Direction& b) noexcept;

/// Phasor U_k of u for k = 1, 2, ...; even ones vanish for symmetric orbits.
[[nodiscard]] std::complex<double> harmonic(const OrbitSegment& orbit, int k);
/// The orbit with the phase of its first impact in [0, 2 pi).
[[nodiscard]] OrbitSegment with_reduced_phase(OrbitSegment orbit);
/// The twin 1 - u(tau + pi).
[[nodiscard]] OrbitSegment mirror_image(const OrbitSegment& orbit);

/// Two rounds (or the two mirror halves) as one orbit, and back: empty when the halves have no common pattern.
[[nodiscard]] OrbitSegment doubled(const OrbitSegment& orbit);
/// Differences between the two halves of an orbit that may be a doubled one, and the mean of both.
struct Halves {
  Direction difference;
  OrbitSegment mean;
};
[[nodiscard]] std::optional<Halves> halves(const OrbitSegment& orbit);

[[nodiscard]] OrbitSegment with_impact(const OrbitSegment& orbit, std::size_t before, const SegmentImpact& impact);
[[nodiscard]] OrbitSegment without_impact(const OrbitSegment& orbit, std::size_t index);

/// One round of an orbit that goes several times through the same motion, or through it and its mirror image in turn;
/// empty for any other orbit.
[[nodiscard]] std::optional<OrbitSegment> repeated_round(const OrbitSegment& orbit);

}  // namespace backlash::detail
