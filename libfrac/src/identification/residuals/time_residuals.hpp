// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "frac/model/time_response_data.hpp"
#include "residuals.hpp"
#include "time_response/event_response.hpp"

namespace frac::detail {

/// The input of the data from rest, and an output at the instants given by index.
[[nodiscard]] EventResponse event_response(const TimeResponseData& data, const std::vector<std::size_t>& index);

/// The model as a ratio of sums of powers with derivatives; empty where it has no finite value.
[[nodiscard]] std::optional<RatioOfPowerSums> ratio_at(const Structure& structure, std::span<const double> parameters);

/// Residuals (model + offset - output)/sigma in units of `unit`.  A free offset is projected out: at every theta it is
/// the value that makes the loss least, the weighted mean of what the model leaves for least squares.
class TimeResiduals final : public Residuals {
 public:
  /// @param index      outputs used
  /// @param tolerance  of the simulation
  /// @param unit       of the residuals: about the size of the output over sigma
  TimeResiduals(const TimeResponseData& data, const Structure& structure, const ParameterMap& map,
                std::optional<double> offset, std::vector<std::size_t> index, double tolerance, double unit);

  [[nodiscard]] std::size_t points() const noexcept override { return index_.size(); }
  [[nodiscard]] std::size_t per_point() const noexcept override { return 1; }
  [[nodiscard]] std::size_t eliminated() const noexcept override { return fixed_offset_ ? 0 : 1; }
  [[nodiscard]] Eigen::MatrixXd eliminated_columns() const override;
  bool evaluate(std::span<const double> theta, double* residual, double* jacobian) const override;
  void set_loss(Loss loss, double scale) override;
  [[nodiscard]] double best_factor(std::span<const double> theta) const override;
  /// Simulation errors, correlated from point to point, decide where rounding would not yet.
  [[nodiscard]] double rounding_cost() const noexcept override;

  /// The offset that goes with theta, and the weighted mean of the model's derivatives by each parameter.
  struct Offset {
    double value;
    Eigen::VectorXd mean_gradient;
  };
  [[nodiscard]] Offset offset(std::span<const double> theta) const;
  /// Residuals of a model whose output is the offset.
  [[nodiscard]] std::vector<double> without_response() const;

 private:
  bool simulate(std::span<const double> theta) const;
  /// Of values with the weights of the residuals, what is to be subtracted to make the loss least.
  [[nodiscard]] double location(const Eigen::VectorXd& values) const;

  const TimeResponseData& data_;
  const Structure& structure_;
  std::optional<double> fixed_offset_;
  std::vector<std::size_t> index_;
  double tolerance_;
  Loss loss_ = Loss::none;
  double loss_scale_ = 1;
  EventResponse events_;
  Eigen::VectorXd weight_;   // of the residuals
  Eigen::VectorXd average_;  // weights of the mean that the offset is, sum 1
  Eigen::VectorXd output_;
  mutable EventResponse::Result model_;
  mutable std::optional<std::vector<double>> theta_;  // that model_ belongs to
};

}  // namespace frac::detail
