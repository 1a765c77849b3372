// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <thread>

#include "frac/parallel_for.hpp"

namespace io {

/// Draws progress on standard error from a thread of its own until destroyed, with an estimate of the time left.
/// Silent when not wanted or when standard error is no terminal.
class ProgressBar {
 public:
  ProgressBar(std::string label, const frac::Progress& progress, bool wanted);

 private:
  std::jthread thread_;
};

}  // namespace io
