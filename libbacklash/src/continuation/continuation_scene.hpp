// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "backlash/orbit_continuation.hpp"
#include "orbit_branch.hpp"

namespace backlash::detail {

/// @throws std::invalid_argument  as orbit_diagram(), of what every kind of contact has.
void require_diagram(const TwoMassSystem& system, double force_amplitude, double omega, OrbitParameter parameter,
                     double from, double to, const OrbitContinuationOptions& options);

/// The scene of a continuation in the units of the gap motion, gamma = F/(M2 clearance omega^2) and restitution, and
/// back.
class ContinuationScene {
 public:
  ContinuationScene(const TwoMassSystem& system, double force_amplitude, double omega, OrbitParameter parameter,
                    Output output)
      : system_(system), force_(force_amplitude), omega_(omega), parameter_(parameter), output_(output) {}

  [[nodiscard]] ParameterRange range(double from, double to) const;
  /// An orbit with no impacts yet, of the motion at a value of the branch parameter.
  [[nodiscard]] OrbitSegment motion_at(double branch_parameter) const;
  [[nodiscard]] OrbitBranch branch(const SegmentBranch& segments) const;

 private:
  struct Scales {
    double omega, clearance;
  };
  [[nodiscard]] PeriodicOrbit orbit(const OrbitSegment& segment) const;
  [[nodiscard]] double branch_parameter(double value) const;
  [[nodiscard]] double parameter(const OrbitSegment& segment) const;
  [[nodiscard]] Scales scales(const OrbitSegment& segment) const;

  TwoMassSystem system_;
  double force_, omega_;
  OrbitParameter parameter_;
  Output output_;
};

}  // namespace backlash::detail
