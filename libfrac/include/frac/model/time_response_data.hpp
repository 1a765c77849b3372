// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "frac/model/hold.hpp"

namespace frac {

/// Samples of the input and the output of a system over time: time in s, strictly increasing, steps of any length.  The
/// system is at rest before the first sample; between samples the input runs as `hold` says.  Under
/// Hold::band_limited the steps are even, and the system has run with the same input for ever.
class TimeResponseData {
 public:
  /// @param sigma  standard deviation of each output, > 0, in its unit; empty: unknown and equal.
  /// @throws std::invalid_argument  lengths differ, fewer than 2 samples, time not increasing, an entry not finite, the
  ///                                input equal to `input_at_rest` throughout, under Hold::band_limited steps that
  ///                                differ or an input that does not change; the text names the first index concerned.
  TimeResponseData(std::vector<double> time, std::vector<double> input, std::vector<double> output,
                   std::vector<double> sigma = {}, Hold hold = Hold::zero_order, double input_at_rest = 0);

  [[nodiscard]] const std::vector<double>& time() const noexcept { return time_; }
  [[nodiscard]] const std::vector<double>& input() const noexcept { return input_; }
  [[nodiscard]] const std::vector<double>& output() const noexcept { return output_; }
  [[nodiscard]] const std::vector<double>& sigma() const noexcept { return sigma_; }
  [[nodiscard]] Hold hold() const noexcept { return hold_; }
  /// The value the input had before the first sample, long enough for the output to have settled.
  [[nodiscard]] double input_at_rest() const noexcept { return input_at_rest_; }
  [[nodiscard]] std::size_t size() const noexcept { return time_.size(); }

  /// The same record, of which these outputs alone count; the input drives the system throughout.
  /// @throws std::invalid_argument  no index, or indices that do not rise or lie beyond the record.
  [[nodiscard]] TimeResponseData observed_at(std::vector<std::size_t> index) const;
  /// Indices of the outputs that count: all, unless observed_at() said otherwise.
  [[nodiscard]] const std::vector<std::size_t>& observed() const noexcept { return observed_; }

 private:
  void check_repeating() const;

  std::vector<double> time_, input_, output_, sigma_;
  Hold hold_;
  double input_at_rest_;
  std::vector<std::size_t> observed_;
};

}  // namespace frac
