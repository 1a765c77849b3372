// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "batch/sweep_stream.hpp"
#include "options/command.hpp"

namespace fracfit {

/// A command that writes a table of many curves.
class SweepCommand : public Command {
 protected:
  using Command::Command;

  /// Rows reach the disk as they come.
  [[nodiscard]] bool streams() const { return writes_file() && format() == "csv"; }
  /// Computes, writes, and says what of the points a user should know. @return the exit code
  int write_points(const backlash::SweepPieces& pieces, const SweepTable& table);
  [[nodiscard]] int exit_code_of(const PointCounts& counts, PointColumns columns) const;
};

}  // namespace fracfit
