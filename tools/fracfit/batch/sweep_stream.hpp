// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "backlash/sweep_pieces.hpp"
#include "frac/parallel_for.hpp"
#include "io/output_file.hpp"
#include "output/sweep_output.hpp"

namespace fracfit {

/// Numbers of points that a user is told about.
struct PointCounts {
  std::size_t not_finite = 0, transient_possible = 0, decided_by_rounding = 0;
  std::size_t without_inverse = 0;  // N = 0 where -1/N is written
  std::size_t all = 0;
  std::size_t of_earlier_run = 0;  // that an interrupted run has left, which count above as well

  void add(const std::vector<backlash::DescribingFunctionPoint>& points, backlash::Quantity quantity);
  PointCounts& operator+=(const PointCounts& other);
};

/// Of each curve, for sharing them out.
[[nodiscard]] std::vector<double> expected_costs(const std::vector<backlash::SweepScene>& scenes);

/// Where a table goes.
struct SweepTarget {
  const io::OutputFile& file;
  std::string stream_path;  ///< of the file, where rows shall reach the disk as they come; else empty
  std::string format;       ///< csv where there is a stream_path
  std::string command;      ///< command line, for the head
};

/// Computes a family of curves and writes its table.  With a stream_path, FILE.partial holds the finished pieces until
/// FILE stands; the same request goes on with it after an interruption, and FILE is the same for any number of threads
/// and interruptions.  Memory then holds one curve per thread, or some hundred points where each starts anew, and the
/// place of each piece.
/// @param table  of the curves of the pieces
/// @throws std::invalid_argument  FILE.partial belongs to another request;  std::runtime_error  the disk is full
PointCounts write_sweep(const backlash::SweepPieces& pieces, const SweepTable& table, const SweepTarget& target,
                        frac::Progress& progress);

}  // namespace fracfit
