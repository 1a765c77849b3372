// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <complex>
#include <cstddef>
#include <optional>
#include <vector>

#include "motion/gap_motion.hpp"

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

/// Direction in the space of unknowns: d phase, d speed of each impact, then d parameter.
using Direction = std::vector<double>;
[[nodiscard]] Direction parameter_direction(const OrbitSegment& segment);
[[nodiscard]] Direction difference(const OrbitSegment& to, const OrbitSegment& from);
[[nodiscard]] OrbitSegment moved(const OrbitSegment& from, const Direction& direction, double length);
[[nodiscard]] double dot(const Direction& a, const Direction& b) noexcept;

/// Newton's iteration from a guess in the hyperplane through it normal to `normal`; with parameter_direction
/// at a fixed parameter. Empty when it does not converge.
[[nodiscard]] std::optional<OrbitSegment> corrected(const OrbitSegment& guess, const Direction& normal);
/// Unit tangent of the branch of orbits, on the side of `along`.  Empty where the branch is not regular.
[[nodiscard]] std::optional<Direction> tangent(const OrbitSegment& orbit, const Direction& along);

/// Map from the first impact to its next (mirrored) return, times the product of all speeds, which keeps it finite at
/// grazing.
struct ScaledReturnMap {
  std::array<double, 4> matrix;  // (phase, speed) by (phase, speed), row by row
  double scale;                  // product of the speeds
  double determinant;            // of the map itself: restitution^(2 impacts), exact
  [[nodiscard]] double trace() const noexcept { return (matrix[0] + matrix[3]) / scale; }
  /// Vanishes with 1 + trace + determinant: a multiplier -1.
  [[nodiscard]] double flip() const noexcept { return matrix[0] + matrix[3] + scale * (1 + determinant); }
  [[nodiscard]] bool stable() const noexcept;
};
[[nodiscard]] ScaledReturnMap return_map(const OrbitSegment& orbit);
/// Multipliers of the whole orbit, both halves of a symmetric one; the larger modulus first.
[[nodiscard]] std::array<std::complex<double>, 2> multipliers(const OrbitSegment& orbit);

/// How far the orbit is from losing or gaining a contact: the least of the impact speeds and of the distances of the
/// turning points from the walls, negative where the motion would leave the gap.
struct ContactMargin {
  double margin;
  bool is_speed;        // which of both
  std::size_t index;    // of the impact, or of the one before the turning point
  SegmentImpact touch;  // the contact of speed 0 that the turning point would be
};
[[nodiscard]] ContactMargin contact_margin(const OrbitSegment& orbit);

/// Phasor U_k of u for k = 1, 2, ...; even ones vanish for symmetric orbits.
[[nodiscard]] std::complex<double> harmonic(const OrbitSegment& orbit, int k);
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
/// Direction in the doubled space in which the halves part at a multiplier -1.
[[nodiscard]] Direction flip_direction(const OrbitSegment& orbit);

[[nodiscard]] OrbitSegment with_impact(const OrbitSegment& orbit, std::size_t before, const SegmentImpact& impact);
[[nodiscard]] OrbitSegment without_impact(const OrbitSegment& orbit, std::size_t index);

/// The orbit near a guess at its parameter, reduced to its mirror half or to one of several repeats.  Empty when
/// Newton's iteration finds none there.
[[nodiscard]] std::optional<OrbitSegment> corrected_to_shortest(const OrbitSegment& guess);
/// Same, from a state on the orbit, followed for that many half periods.
[[nodiscard]] std::optional<OrbitSegment> orbit_through(const GapMotion& motion, const GapState& on_orbit, int impacts,
                                                        int half_periods);

}  // namespace backlash::detail
