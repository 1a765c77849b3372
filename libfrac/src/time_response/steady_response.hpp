// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <complex>
#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include "cut_plane_model.hpp"
#include "event_response.hpp"
#include "records/line_sum.hpp"

namespace frac::detail {

/// An input under Hold::band_limited: the lines of its period.
class PeriodicInput {
 public:
  /// @param time   at even steps
  /// @param input  that changes
  PeriodicInput(const std::vector<double>& time, const std::vector<double>& input);

  /// In samples; all of the record where nothing repeats.
  [[nodiscard]] double period() const noexcept { return period_.samples; }
  [[nodiscard]] bool repeats() const noexcept { return period_.repeats; }
  [[nodiscard]] std::size_t samples() const noexcept { return samples_; }
  [[nodiscard]] double first_time() const noexcept { return first_time_; }
  /// rad/s, between lines.
  [[nodiscard]] double spacing() const noexcept { return spacing_; }
  /// From 0 on: the signal is the real part of their sum, each times e^{j omega (t - first_time)}.
  [[nodiscard]] const std::vector<std::complex<double>>& line() const noexcept { return line_; }
  /// Rising, without 0: those above the noise and the widest gap, or all above rounding where nothing repeats.
  [[nodiscard]] const std::vector<std::size_t>& excited() const noexcept { return excited_; }
  [[nodiscard]] double omega(std::size_t line) const noexcept { return spacing_ * static_cast<double>(line); }

 private:
  InputPeriod period_;
  std::size_t samples_;
  double first_time_, spacing_;
  std::vector<std::complex<double>> line_;
  std::vector<std::size_t> excited_;
};

/// The output of a ratio of sums of powers in the periodic steady state, exact: sum over the lines of the input of
/// H(j omega_k) U_k e^{j omega_k t} over those excited, with its derivatives by the parameters.  A system that
/// integrates has no steady state for the mean of its input, which is left out.
class SteadyResponse {
 public:
  /// @param index  samples of the record, rising
  SteadyResponse(std::shared_ptr<const PeriodicInput> input, std::vector<std::size_t> index);

  /// False where the model is zero or not finite on a line.
  [[nodiscard]] bool evaluate(const RatioOfPowerSums& ratio, EventResponse::Result& result) const;
  [[nodiscard]] bool evaluate(CutPlaneModel model, EventResponse::Result& result) const;

 private:
  /// @param origin  at s = 0
  /// @param image   without the dead time, at ln s
  template <typename Image>
  [[nodiscard]] bool respond(const ComplexRow& origin, Image& image, double delay, const Slope& delay_slope,
                             EventResponse::Result& result) const;

  std::shared_ptr<const PeriodicInput> input_;
  std::vector<std::size_t> row_;  // of each output in what `sum_` computes: one period where that is whole
  LineSum sum_;
};

/// The same at any instants.
/// @throws std::domain_error  not finite on a line of the input
[[nodiscard]] std::vector<double> steady_response(const FractionalTransferFunction& model, const PeriodicInput& input,
                                                  std::span<const double> time);

}  // namespace frac::detail
