// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <complex>
#include <cstdint>
#include <optional>
#include <vector>

#include "compliant_orbit.hpp"
#include "loops/motions/forced_motion.hpp"
#include "steady_state/window_mean.hpp"

namespace backlash::detail {

/// Tolerance of fractional powers under a sine force.
inline constexpr double compliant_realisation = 1e-9;

/// What a motion under a sine force comes to, with the state at its last peak of the force.
struct CompliantReached {
  DescribingFunctionPoint point;
  /// Second harmonic of the position over the force, m/N: opposite of the mirror image, 0 of a symmetric motion.
  std::complex<double> second;
  bool is_symmetric;  // of a mean: second is within its half width
  Eigen::VectorXd state;
  CompliantMode mode;
};

/// Long-run motions of one scene at one frequency.
class CompliantPoint {
 public:
  /// @param tells_twins  whether `second` of means is wanted
  CompliantPoint(const CompliantBodies& bodies, double force, double omega, const SweepOptions& options,
                 bool tells_twins = false);

  /// The stable orbit of one period near a motion that begins there, if Newton's method finds one.
  [[nodiscard]] std::optional<CompliantReached> near(const LoopStart& start) const;
  /// Follows the motion until it is decided what it comes to.
  [[nodiscard]] CompliantReached follow(const LoopStart& start);

 private:
  struct Peak {
    Eigen::VectorXd state;                      // those that repeat
    std::int64_t contacts;                      // until then
    bool is_in_contact;                         // there
    std::vector<std::complex<double>> phasors;  // harmonics of that period, m/N
  };

  [[nodiscard]] Eigen::VectorXd repeating(const Eigen::VectorXd& state) const;
  [[nodiscard]] const Peak& back(std::size_t periods) const { return peaks_[peaks_.size() - 1 - periods]; }
  [[nodiscard]] std::optional<int> returns_after() const;
  [[nodiscard]] bool is_quiet() const;
  [[nodiscard]] CompliantReached quiet(const CompliantRun& run) const;
  [[nodiscard]] PeriodMean mean_of_last(std::size_t periods, std::size_t harmonic = 0) const;
  [[nodiscard]] CompliantReached reached(const CompliantOrbit& orbit) const;
  [[nodiscard]] bool is_known(const CompliantRun& run) const;
  [[nodiscard]] CompliantReached mean(const CompliantRun& run) const;

  const CompliantBodies& bodies_;
  SineForce force_;
  const SweepOptions& options_;
  CompliantFlow flow_;
  std::vector<Peak> peaks_;
};

}  // namespace backlash::detail
