// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <complex>
#include <optional>
#include <vector>

#include "formula/program.hpp"
#include "frac/model/frequency_response_data.hpp"
#include "frac/model/time_response_data.hpp"
#include "residuals.hpp"

namespace frac::detail {

/// Residuals of G(s) U(s) + offset/s to Y(s), the Laplace transforms of input and output over the record, at points s
/// with Re s >= decay/length, where what lies beyond its end weighs e^-decay: good for start values, at a tenth of the
/// cost of a simulation and without its many local minima.  Between samples the output is taken as straight.
class LaplaceResiduals final : public Residuals {
 public:
  LaplaceResiduals(const TimeResponseData& data, const Structure& structure, const ParameterMap& map,
                   std::optional<double> offset, double decay);

  [[nodiscard]] std::size_t points() const noexcept override { return input_.size(); }
  [[nodiscard]] std::size_t per_point() const noexcept override { return 2; }
  [[nodiscard]] std::size_t eliminated() const noexcept override { return free_offset_ ? 1 : 0; }
  bool evaluate(std::span<const double> theta, double* residual, double* jacobian) const override;
  [[nodiscard]] BestFactor best_factor(std::span<const double> theta) const override;

  /// Y/U at real s, in place of a frequency response: its slopes suggest orders.
  [[nodiscard]] FrequencyResponseData quotient() const;

 private:
  /// Points of one argument; the first ray is the real axis.
  struct Ray {
    double angle;
    std::vector<double> modulus;
  };
  Program program_;
  bool free_offset_;
  std::vector<Ray> rays_;
  std::vector<std::complex<double>> input_, output_;            // over the spread of the output
  Eigen::VectorXd constant_;                                    // transform of 1 over the record, likewise, of length 1
  mutable std::vector<std::complex<double>> value_, gradient_;  // on a ray
};

}  // namespace frac::detail
