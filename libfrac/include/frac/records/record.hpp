// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

namespace frac {

/// Samples that are missing in a record, as a logger drops them.
struct RecordGap {
  std::size_t before = 0;   // index of the first sample after it
  std::size_t missing = 0;  // samples
};

/// Samples of one experiment at equal steps of time: an input, one or more outputs, and, where the input is itself the
/// answer of a loop, the signal from outside that drives the loop.
class Record {
 public:
  /// @param sample_time  s, > 0
  /// @param reference    driving signal of a closed loop; empty: the input is free of what disturbs the outputs
  /// @param gaps       where samples are missing, rising
  /// @throws std::invalid_argument  sample time not positive and finite, no output, lengths that differ, fewer than 16
  ///                                samples, a sample not finite, an input that does not change; the text names the
  ///                                signal and the first index concerned.  Gaps that do not rise, or not within it.
  Record(double sample_time, std::vector<double> input, std::vector<std::vector<double>> outputs,
         std::vector<double> reference = {}, std::vector<RecordGap> gaps = {});

  [[nodiscard]] std::size_t size() const noexcept { return input_.size(); }
  [[nodiscard]] double sample_time() const noexcept { return sample_time_; }
  [[nodiscard]] const std::vector<double>& input() const noexcept { return input_; }
  [[nodiscard]] const std::vector<std::vector<double>>& outputs() const noexcept { return outputs_; }
  [[nodiscard]] const std::vector<double>& reference() const noexcept { return reference_; }
  [[nodiscard]] const std::vector<RecordGap>& gaps() const noexcept { return gaps_; }
  /// What drives the experiment: the reference where there is one, else the input.
  [[nodiscard]] const std::vector<double>& drive() const noexcept { return reference_.empty() ? input_ : reference_; }
  /// Samples first to first + count - 1, as if none of them were missing.
  [[nodiscard]] Record part(std::size_t first, std::size_t count) const;

 private:
  double sample_time_;
  std::vector<double> input_;
  std::vector<std::vector<double>> outputs_;
  std::vector<double> reference_;
  std::vector<RecordGap> gaps_;
};

/// The limits at which a sensor or an amplifier has cut off a signal: it stays at its largest or at its smallest value
/// more often than a sinusoid does at the outermost step of a converter.  A signal of a few levels, such as a square
/// wave, is not cut off.
[[nodiscard]] bool is_clipped(const std::vector<double>& signal);

/// Samples that repeat one value.
struct Standstill {
  std::size_t first = 0, count = 0;
};
/// The longest of the runs in which a sensor or a logger repeats a reading while the signal moves on: 14 samples or
/// more of one value, at which the signal rests nowhere else, and then a jump of four steps of the converter or more.
/// Noise that once keeps to a step of the converter for so long and then jumps so far has a chance of 7e-10 at most at
/// each sample, whatever its size.  Nothing is said of a run with which the signal begins or ends, nor of a signal that
/// makes a quarter of its way or more in jumps out of rest, as a command that is held does: of a reading that share is
/// the time for which it is stuck.
[[nodiscard]] std::optional<Standstill> stuck_samples(const std::vector<double>& signal);

}  // namespace frac
