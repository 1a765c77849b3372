// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <complex>
#include <cstddef>
#include <vector>

#include "frac/frequency_unit.hpp"

namespace frac {

/// Samples of a frequency response G(j omega), omega in rad/s, positive and in increasing order; equal neighbours are
/// repeats of one measurement.  The unit of the values is output per input: m/N for a describing function from force to
/// position.
class FrequencyResponseData {
 public:
  /// @param sigma  standard deviation of each value, in the unit of the values (of the real and of the imaginary part
  ///               alike); empty when unknown.
  /// @param shown_in  what sentences about these data name frequencies in
  /// @throws std::invalid_argument  lengths differ or are 0, omega not positive, finite and in increasing order,
  ///                                a value not finite, a sigma not positive and finite; the text names
  ///                                the first index
  ///                                concerned.
  FrequencyResponseData(std::vector<double> omega, std::vector<std::complex<double>> value,
                        std::vector<double> sigma = {}, FrequencyUnit shown_in = FrequencyUnit::rad_per_s);

  [[nodiscard]] std::size_t size() const noexcept { return omega_.size(); }
  [[nodiscard]] const std::vector<double>& omega() const noexcept { return omega_; }
  [[nodiscard]] const std::vector<std::complex<double>>& value() const noexcept { return value_; }
  [[nodiscard]] const std::vector<double>& sigma() const noexcept { return sigma_; }
  [[nodiscard]] FrequencyUnit frequency_unit() const noexcept { return frequency_unit_; }

 private:
  std::vector<double> omega_;
  std::vector<std::complex<double>> value_;
  std::vector<double> sigma_;
  FrequencyUnit frequency_unit_;
};

}  // namespace frac
