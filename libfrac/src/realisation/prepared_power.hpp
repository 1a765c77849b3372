// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <complex>
#include <optional>
#include <vector>

#include "frac/realisation.hpp"
#include "grunwald_letnikov_sum.hpp"

namespace frac::detail {

/// s^order through a realisation, prepared once for many frequencies.
class PreparedPower {
 public:
  /// @throws std::invalid_argument  |order| > 20 or not finite with a realisation other than the exact one.  An exact
  ///                                power of
  ///                                an order that is not finite gives values that are not finite.
  void prepare(const Realisation& realisation, double order);

  [[nodiscard]] bool is_exact() const noexcept { return method_ == Method::exact; }
  /// s^order = omega^order() phase() where is_exact().
  [[nodiscard]] double order() const noexcept { return order_; }
  [[nodiscard]] std::complex<double> phase() const noexcept { return exact_phase_; }

  /// log_omega = ln omega.
  [[nodiscard]] std::complex<double> value(double omega) const;
  [[nodiscard]] PowerResponse response(double omega, double log_omega) const;

 private:
  enum class Method { exact, oustaloup, all_samples, finite_memory, smooth_ladder };

  [[nodiscard]] std::complex<double> ladder(double omega) const;
  [[nodiscard]] std::complex<double> ladder_log_derivative(double omega) const;
  [[nodiscard]] std::complex<double> smooth_ladder(double omega) const;
  [[nodiscard]] std::complex<double> smooth_ladder_log_derivative(double omega) const;
  [[nodiscard]] PowerResponse all_samples(double omega) const;
  [[nodiscard]] PowerResponse finite_memory(double omega) const;

  Method method_ = Method::exact;
  double order_ = 0;
  // exact, and the whole part of oustaloup and ladder
  double exact_order_ = 0;
  std::complex<double> exact_phase_ = 1;
  // oustaloup, H = gain prod (s + z_i)/(s + p_i): z_i/p_i is the same for all i
  double gain_ = 1;
  double log_upper_ = 0;
  double rung_ = 0;  // ln(upper/lower)/poles
  double zero_by_pole_ = 1;
  std::vector<double> poles_;  // p_i > 0
  // ladder, on the band scaled to centre 1: H = gain centre^order prod (s + 1/p)/(s + p), poles_ rising, reciprocal
  // where the fractional part of the order is negative
  bool reciprocal_ = false;
  double centre_ = 1;
  double log_centre_ = 0;
  std::vector<double> log_poles_;
  std::vector<double> log_poles_by_order_;
  // grunwald-letnikov
  double sample_time_ = 0;
  double scale_ = 1;  // sample_time^-order
  std::optional<GrunwaldLetnikovSum> sum_;
};

}  // namespace frac::detail
