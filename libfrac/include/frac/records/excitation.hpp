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

/// Samples after which the beginning of a signal comes back at its end, where that is more than half of it: the period
/// of a record that holds less than two.  Nothing where two stretches of normal noise may look so alike with a chance
/// of 1e-6, and of signals of more than 131 072 samples.
[[nodiscard]] std::optional<double> repeats_once_after(const std::vector<double>& signal);

/// Runs of cycles of constant length and height between rising passages of a signal through its mean; cycles that
/// differ by more than their scatter begin a new segment.  The first and the last cycle of a run beside another one are
/// left out, and so are runs of which fewer than three cycles remain.
[[nodiscard]] std::vector<SineSegment> sine_segments(const std::vector<double>& signal);

/// What drove a record: periodic where period_of() finds a period, a stepped sine where sine_segments() hold more than
/// half of it, else arbitrary.
[[nodiscard]] Excitation excitation_of(const Record& record);

/// Instants, in samples, at which a trigger rises through the middle between its smallest and its largest value, as
/// pulses of an encoder, one in each period, or a sine of reference do.  From one to the next it has been in the lower
/// and in the upper quarter, so that noise makes none.  That of a pulse is known to half a sample.
/// @throws std::invalid_argument  fewer than three of them.
[[nodiscard]] std::vector<double> trigger_instants(const std::vector<double>& trigger);

/// Period of a signal that a trigger tells, in samples, refined by the signal as period_of() does; nothing where the
/// instants stand a sample or more beside a straight line.
[[nodiscard]] std::optional<double> period_of(const std::vector<double>& signal, const std::vector<double>& instants);

/// A cosine of amplitude 1 with a summit at each instant of a trigger, whose phase between two of them, before the
/// first and after the last runs evenly.  Instants within a sample of a straight line are taken as that line, of the
/// period that the answer tells, because a pulse is known to half a sample.
/// @param answer  of the machine, as many samples as are wanted
[[nodiscard]] std::vector<double> cosine_of(std::vector<double> instants, const std::vector<double>& answer);

}  // namespace frac
