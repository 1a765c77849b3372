// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "gap_motion.hpp"

namespace backlash::detail {

/// A flight up to its impact, or a rest in contact up to the release.
struct MotionPiece {
  bool is_rest;
  GapState begin;
  Flight flight;     // of a flight
  GapState end;      // after the impact or at the release; as begin for a flight that hits nothing
  double tail_loss;  // of a rest: energy lost in the last impacts before it, per unit of reduced mass
};

/// The piece that begins at a state.  A chatter whose remaining effect on the integral of u is below `neglected_tail`
/// counts as rest.
[[nodiscard]] inline MotionPiece piece_from(const GapMotion& motion, const GapState& state, double neglected_tail) {
  const ChatterTail tail = motion.chatter_tail(state);
  if (motion.rests(state) || tail.negligible(neglected_tail)) {
    return {true, state, {}, motion.release_after(state), tail.loss};
  }
  MotionPiece piece{false, state, {}, {}, 0};
  piece.flight = motion.next_flight(piece.begin);
  piece.end = piece.flight.hits ? motion.after_impact(piece.begin, piece.flight) : piece.begin;
  return piece;
}

}  // namespace backlash::detail
