// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string_view>
#include <vector>

#include "frac/records/record.hpp"

namespace frac {

enum class Excitation {
  periodic,      // repeats itself, with one line or many
  stepped_sine,  // one sine after the other, each of constant frequency and amplitude
  arbitrary      // random, swept, a step, an impulse
};
[[nodiscard]] constexpr std::array<Excitation, 3> excitations() {
  return {Excitation::periodic, Excitation::stepped_sine, Excitation::arbitrary};
}
/// "periodic", "stepped-sine", "arbitrary".
[[nodiscard]] std::string_view to_string(Excitation excitation);

/// Samples during which a stepped sine keeps frequency and amplitude.
struct SineSegment {
  std::size_t first = 0, count = 0;
  double period = 0;  // samples, not necessarily whole
};

/// Period of a signal in samples, to a small fraction of one; nothing where no lag up to a third of the signal repeats
/// the larger share of its power.
/// The period is the lag of largest correlation, refined over as many periods as half of the signal holds.
[[nodiscard]] std::optional<double> period_of(const std::vector<double>& signal);

/// Runs of cycles of constant length and height between rising passages of a signal through its mean; cycles that
/// differ by more than their scatter begin a new segment.  The first and the last cycle of a run beside another one are
/// left out, and so are runs of which fewer than three cycles remain.
[[nodiscard]] std::vector<SineSegment> sine_segments(const std::vector<double>& signal);

/// What drove a record: periodic where period_of() finds a period, a stepped sine where sine_segments() hold more than
/// half of it, else arbitrary.
[[nodiscard]] Excitation excitation_of(const Record& record);

}  // namespace frac
