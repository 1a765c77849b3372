// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "backlash/describing_function.hpp"
#include "frac/parallel_for.hpp"

namespace backlash {

/// Points of one curve that follow each other.
struct SweepPiece {
  std::size_t scene;  // which curve
  std::size_t first;  // index of its first frequency
  std::size_t count;
};

/// A family of curves over one grid that is computed piece by piece, in any order: for results that do not fit into
/// memory or have to survive an interruption.  A piece is a whole curve where the state is carried from point to
/// point, and a part of one where every point starts anew.  Together the pieces are what describing_function_sweeps
/// gives, to the bit.
class SweepPieces {
 public:
  /// @throws std::invalid_argument  as describing_function_sweeps.
  SweepPieces(std::vector<SweepScene> scenes, std::vector<double> omega, const SweepOptions& options);
  /// Computes a piece; safe to call from several threads.
  using Compute =
      std::function<std::vector<DescribingFunctionPoint>(const SweepPiece& piece, frac::Progress* progress)>;
  /// Of bodies of another kind, which `compute` knows, see bodies_sweep_pieces().
  /// @param scenes  what is told of each curve
  /// @throws std::invalid_argument  for the grid and the options.
  SweepPieces(std::vector<SweepScene> scenes, std::vector<double> omega, const SweepOptions& options, Compute compute);

  [[nodiscard]] std::size_t count() const noexcept { return scenes_.size() * per_scene_; }
  /// Place of a piece among the points; pieces are numbered from 0 in the order of scenes and frequencies.
  [[nodiscard]] SweepPiece piece(std::size_t number) const noexcept;
  /// Computes a piece; safe to call from several threads.
  /// @param progress  counts points, if given
  [[nodiscard]] std::vector<DescribingFunctionPoint> points(std::size_t number,
                                                            frac::Progress* progress = nullptr) const;

  /// Computes the pieces in parallel on the threads of the options, the last ones first.
  /// @param is_there  whether a piece is known already and is passed over
  /// @param take  is given each piece on the thread that computed it, several at a time
  /// @param progress  counts points, those passed over included
  void compute(const std::function<bool(std::size_t number)>& is_there,
               const std::function<void(std::size_t number, std::vector<DescribingFunctionPoint> points)>& take,
               frac::Progress* progress = nullptr) const;
  /// Computes all pieces.
  /// @param progress  counts points, if given
  [[nodiscard]] std::vector<DescribingFunctionSweep> sweeps(frac::Progress* progress = nullptr) const;

  [[nodiscard]] const std::vector<SweepScene>& scenes() const noexcept { return scenes_; }
  [[nodiscard]] const std::vector<double>& omega() const noexcept { return omega_; }
  [[nodiscard]] const SweepOptions& options() const noexcept { return options_; }

 private:
  std::vector<SweepScene> scenes_;
  std::vector<double> omega_;
  SweepOptions options_;
  Compute compute_;        // none: two masses with a restitution
  std::size_t width_;      // frequencies of a piece; the last one of a scene may have fewer
  std::size_t per_scene_;  // pieces of a scene
};

/// Time that a curve takes, about, in a unit of its own: for sharing curves out before they are computed.  An impact
/// takes the share 1 - restitution of the relative speed, so the impacts until a transient has died away, or a mean is
/// known, grow as its inverse, up to the periods that a point is followed at most.  The same number on every machine.
/// @param restitution  in [0, 1]
[[nodiscard]] double expected_cost(double restitution);

}  // namespace backlash
