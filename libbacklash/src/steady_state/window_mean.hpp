// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <complex>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "long_run_motion.hpp"
#include "motion/gap_motion.hpp"
#include "motion/harmonics.hpp"

namespace backlash::detail {

/// State at a peak of the force with what was counted up to it.
struct Strobe {
  double position = 0;
  double position_rate = 0;
  std::int64_t impacts = 0;
};

/// State at the end of each period of the window that is averaged.
struct WindowRecord {
  Strobe strobe;
  std::int64_t period = 0;
  JumpSum jumps;
  double log_growth = 0;  // of a small disturbance since the beginning of the window
};

/// Records of a window that is averaged when no orbit has closed.
inline constexpr std::size_t window_records = 1024;

/// Records of the motion at peaks of the force, from the end of the transient on.  When they are full but shorter than
/// asked for, or hold few impacts, every second one is dropped and the window goes on at twice the stride.
class Window {
 public:
  [[nodiscard]] bool empty() const noexcept { return records_.empty(); }
  [[nodiscard]] const std::vector<WindowRecord>& records() const noexcept { return records_; }
  void clear() {
    records_.clear();
    stride_ = 1;
  }
  /// True where the next record is that of this period; those between are dropped.
  [[nodiscard]] bool takes(std::int64_t period) const noexcept {
    return records_.empty() || (period - records_.front().period) % stride_ == 0;
  }
  /// Takes the record of a peak.  False when the window is complete.
  /// @param wanted  force periods that the window lasts at least
  bool add(const WindowRecord& record, std::int64_t wanted);

 private:
  std::vector<WindowRecord> records_;
  std::int64_t stride_ = 1;
};

/// A window with fewer impacts than this is lengthened.
inline constexpr std::int64_t enough_impacts = 512;

/// 95 % half width of a mean from the deviations of its 8 or 16 batches.
[[nodiscard]] double half_width_of_mean(std::span<const std::complex<double>> deviations);

/// The mean of neighbouring periods with its 95 % half width, the wider of two batch sizes as in averaged().
struct PeriodMean {
  std::complex<double> value;
  double half_width;
};
/// @param periods  at least 8, in either order of time
[[nodiscard]] PeriodMean mean_of_periods(std::span<const std::complex<double>> periods);

/// Long-time mean with the 95 % half width of batch means; the wider of two batch sizes, since short batches of a
/// slowly varying motion are correlated and give too narrow a width.  `end` is left at its default.
[[nodiscard]] SteadyState averaged(const std::vector<WindowRecord>& window, const GapMotion& motion);

}  // namespace backlash::detail
