// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <thread>

#include "frac/parallel_for.hpp"

namespace io {

enum class ProgressStyle {
  none,
  bar,    // drawn where standard error is a terminal
  lines,  // for programs: one JSON object per second
};

/// Shows progress on standard error from a thread of its own until destroyed, with rate and an estimate of the time
/// left; on a terminal, while the total is 0, from two seconds on for how long the work has gone on.  Of several bars
/// the last one made is drawn.
class ProgressBar {
 public:
  ProgressBar(std::string label, const frac::Progress& progress, ProgressStyle style);
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

 private:
  std::jthread thread_;
};

}  // namespace io
