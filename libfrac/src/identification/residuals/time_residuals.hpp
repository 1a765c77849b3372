// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <variant>
#include <vector>

#include "frac/model/time_response_data.hpp"
#include "identification/data/first_order_whitening.hpp"
#include "residuals.hpp"
#include "time_response/event_response.hpp"
#include "time_response/steady_response.hpp"
#include "time_response/time_model.hpp"

namespace frac::detail {

/// The lines of the input under Hold::band_limited; null under any other.
[[nodiscard]] std::shared_ptr<const PeriodicInput> periodic_input(const TimeResponseData& data);

/// The answer of a model to the input of a record at the instants given by index: from rest, or in the periodic steady
/// state where the input is a periodic one.
class RecordResponse {
 public:
  /// @param periodic  of the data, see periodic_input()
  RecordResponse(const TimeResponseData& data, const std::vector<std::size_t>& index,
                 std::shared_ptr<const PeriodicInput> periodic);
  /// As EventResponse::evaluate(); a steady state is exact.
  [[nodiscard]] bool evaluate(const TimeModel& model, double tolerance, EventResponse::Result& result) const;

 private:
  std::variant<EventResponse, SteadyResponse> response_;
};

/// Parts of the output besides the response to the input, and how its noise follows itself; see TimeFitOptions.
struct Background {
  std::optional<double> offset;  // unset: estimated
  bool trend = false;
  bool earlier_input = false;
  double noise_correlation = 0;
};

/// Responses to unit steps of the input before the record, an eighth and a sixty-fourth of its length before the first
/// sample and, where the input changes within the record, at the first sample.
[[nodiscard]] std::vector<EventResponse> earlier_steps(const TimeResponseData& data,
                                                       const std::vector<std::size_t>& index);

/// Residuals (model + background - output)/sigma in units of `unit`.  What is free of the background is linear and
/// projected out: at every theta it has the values that make the loss least.  The derivatives of its columns by theta
/// are kept along the columns' complement only (Kaufman 1975), which leaves gradient and covariance exact.  Residuals,
/// columns and derivatives are freed of the noise's correlation alike (FirstOrderWhitening).
class TimeResiduals final : public Residuals {
 public:
  /// @param index      outputs used
  /// @param tolerance  of the simulation
  /// @param unit       of the residuals: about the size of the output over sigma
  /// @param priors     weighed by the noise to expect until another is set; they stay with the caller
  /// @param periodic   of the data, see periodic_input()
  TimeResiduals(const TimeResponseData& data, const Structure& structure, const ParameterMap& map,
                const Background& background, std::vector<std::size_t> index, double tolerance, double unit,
                const Priors& priors, std::shared_ptr<const PeriodicInput> periodic);

  [[nodiscard]] std::size_t points() const noexcept override { return index_.size(); }
  [[nodiscard]] std::size_t per_point() const noexcept override { return 1; }
  [[nodiscard]] std::size_t eliminated() const noexcept override {
    return static_cast<std::size_t>(fixed_columns_.cols()) + earlier_.size();
  }
  /// At the theta evaluated last: offset, trend and earlier steps, as far as they are free.
  [[nodiscard]] Eigen::MatrixXd eliminated_columns() const override;
  bool evaluate(std::span<const double> theta, double* residual, double* jacobian) const override;
  void set_loss(Loss loss, double scale) override;
  [[nodiscard]] BestFactor best_factor(std::span<const double> theta) const override;
  /// Simulation errors, correlated from point to point, decide where rounding would not yet.
  [[nodiscard]] double rounding_cost() const noexcept override;

  /// The coefficients of eliminated_columns() at theta, and the derivatives by each parameter of residuals with those
  /// coefficients held.
  struct Eliminated {
    Eigen::VectorXd coefficient;
    Eigen::MatrixXd gradient;
  };
  [[nodiscard]] Eliminated eliminated_at(std::span<const double> theta) const;
  /// Weighted columns of a background that these residuals do not have: a trend first, then earlier steps of the input.
  /// Empty where the model has no response to them.
  [[nodiscard]] Eigen::MatrixXd possible_background(std::span<const double> theta) const;
  /// Residuals of a model whose output is offset and trend, and how many of these are free.
  [[nodiscard]] std::vector<double> without_response() const;
  [[nodiscard]] std::size_t silent_parameters() const { return static_cast<std::size_t>(fixed_columns_.cols()); }

 private:
  bool simulate(std::span<const double> theta) const;
  /// Whether the offset alone is free of the background, as in most fits.
  [[nodiscard]] bool only_offset() const {
    return !fixed_offset_ && !trend_ && earlier_.empty() && whitening_.changes_nothing();
  }
  /// Columns of values at the outputs, freed of the noise's correlation.
  void whiten(Eigen::Ref<Eigen::MatrixXd> columns) const;
  /// Weighted residuals of a model with the fixed offset, and what is free of the background at 0.
  [[nodiscard]] Eigen::VectorXd without_background(const Eigen::VectorXd& model) const;
  /// The constant to subtract from values with the weights of the residuals to make the loss least.
  [[nodiscard]] double location(const Eigen::VectorXd& values) const;
  /// Coefficients of `columns` that, added to weighted residuals, make the loss least.
  [[nodiscard]] Eigen::VectorXd coefficients(const Eigen::MatrixXd& columns, const Eigen::VectorXd& residual) const;
  /// Weighted derivatives by the parameters, those of the earlier steps with their coefficients included.
  [[nodiscard]] Eigen::MatrixXd weighted_gradient(const Eigen::VectorXd& coefficient) const;

  const TimeResponseData& data_;
  const Structure& structure_;
  std::optional<double> fixed_offset_;
  bool trend_;
  std::vector<std::size_t> index_;
  double tolerance_;
  FirstOrderWhitening whitening_;
  Loss loss_ = Loss::none;
  double loss_scale_ = 1;
  RecordResponse response_;
  Eigen::VectorXd weight_;   // of the residuals
  Eigen::VectorXd average_;  // weights of the mean that the offset is, sum 1
  Eigen::VectorXd output_;
  double largest_model_;           // beyond which an offset would have to cancel the model and leave rounding
  Eigen::MatrixXd fixed_columns_;  // weighted and whitened, of offset and trend
  std::vector<EventResponse> earlier_;
  mutable std::vector<EventResponse::Result> earlier_model_;
  mutable EventResponse::Result model_;
  mutable std::optional<std::vector<double>> theta_;  // that model_ belongs to
};

}  // namespace frac::detail
