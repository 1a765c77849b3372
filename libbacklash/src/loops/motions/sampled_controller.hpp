// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <deque>

#include "backlash/loops/simulate_sampled_loop.hpp"

namespace backlash::detail {

/// The computer of a sampled loop: what it reads, and the force that it holds.
class SampledController {
 public:
  /// @throws std::invalid_argument  as simulate_sampled_loop(), but for the bodies.
  SampledController(const ControlLoop& loop, const SampledLoopOptions& options);

  /// After the first, at t = 0.
  [[nodiscard]] std::size_t samples() const noexcept { return samples_; }
  /// s, of a sample.
  [[nodiscard]] double time(std::size_t sample) const { return static_cast<double>(sample) * options_.sample_time; }
  /// Of each sample in turn. @return the force that is held from there on, N
  [[nodiscard]] double step(std::size_t sample, double x1, double x2);

 private:
  SampledLoopOptions options_;
  Output measured_;
  frac::FractionalPid<double> pid_;
  std::deque<double> waiting_;  // for the dead time to pass
  std::size_t samples_;
};

}  // namespace backlash::detail
