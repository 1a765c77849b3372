// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <complex>
#include <span>
#include <vector>

#include "identification/data/residual_rule.hpp"
#include "parameter_map.hpp"
#include "priors.hpp"
#include "residual_axis.hpp"

namespace frac::detail {

/// Residuals of a model and their Jacobian by theta, as solvers see them: points in order, each with the same number of
/// residuals.  Not thread-safe: implementations keep buffers between calls.
class Residuals {
 public:
  virtual ~Residuals() = default;
  Residuals(const Residuals&) = delete;
  Residuals& operator=(const Residuals&) = delete;

  [[nodiscard]] virtual std::size_t points() const noexcept = 0;
  [[nodiscard]] virtual std::size_t per_point() const noexcept = 0;
  [[nodiscard]] std::size_t count() const noexcept { return points() * per_point(); }
  /// Their places, for a model at theta.
  [[nodiscard]] virtual ResidualAxis axis(std::span<const double>) const { return {per_point()}; }
  [[nodiscard]] const ParameterMap& map() const noexcept { return map_; }

  /// Residuals at theta and, unless null, their Jacobian, one column of count() entries for each entry of theta.  False
  /// where one of them is not finite.
  virtual bool evaluate(std::span<const double> theta, double* residual, double* jacobian) const = 0;

  /// Lets priors count with the residuals: each by the square of its distance times that of `noise`, the standard
  /// deviation that a residual is taken to have.
  /// @param priors  stay with the caller
  void set_priors(const Priors& priors, double noise) {
    priors_ = priors.empty() ? nullptr : &priors;
    prior_weight_ = noise;
  }
  /// Null where there are none.
  [[nodiscard]] const Priors* priors() const noexcept { return priors_; }
  [[nodiscard]] double prior_weight() const noexcept { return prior_weight_; }
  /// Their part of the cost.
  [[nodiscard]] double prior_cost(std::span<const double> theta) const {
    return priors_ ? prior_weight_ * prior_weight_ * priors_->cost(map_.to_user(theta)) : 0;
  }

  /// Sum of squares over all points and priors; infinity where the model is not finite.
  [[nodiscard]] double cost(std::span<const double> theta) const;

  /// Costs below this are rounding: all of them are zero.
  [[nodiscard]] virtual double rounding_cost() const noexcept { return static_cast<double>(count()) * 1e-28; }

  /// Factor by which the whole model is to be multiplied to come nearest the data; 1 where there is no positive one or
  /// where the residuals are blind to it (phase).
  struct BestFactor {
    double factor = 1;
    double cost = 0;  // of the model times the factor, but for priors; 0 where it is not known
  };
  [[nodiscard]] virtual BestFactor best_factor(std::span<const double> theta) const = 0;

  /// Parameters whose coefficients come from linear least squares at the orders and delays of `near`, one per weighting
  /// that gives an answer.  None where the residuals are not linear in coefficients.
  [[nodiscard]] virtual std::vector<std::vector<double>> linear_fits(std::span<const double> near) const;

  /// Linear parameters the residuals are projected free of: they cost degrees of freedom too.
  [[nodiscard]] virtual std::size_t eliminated() const noexcept { return 0; }
  /// Their derivatives of the residuals: count() x eliminated().
  [[nodiscard]] virtual Eigen::MatrixXd eliminated_columns() const {
    return Eigen::MatrixXd(static_cast<Eigen::Index>(count()), 0);
  }
  /// Loss under which those are chosen from now on, and the residual at which it turns robust.
  virtual void set_loss(Loss, double) {}

 protected:
  explicit Residuals(const ParameterMap& map) : map_(map) {}
  /// Residuals of all points at theta; false where the model is not finite.
  bool evaluate_all(std::span<const double> theta, std::vector<double>& residual) const;
  mutable std::vector<double> scratch_;  // residuals

 private:
  const ParameterMap& map_;
  const Priors* priors_ = nullptr;
  double prior_weight_ = 0;
};

/// Residuals of a structure to a frequency response, in units of the rule.
class FrequencyResiduals final : public Residuals {
 public:
  /// @param only_stable  whether unstable models cost a million times as much, squared
  FrequencyResiduals(const FrequencyResponseData& data, const Structure& structure, const Realisation& realisation,
                     const ParameterMap& map, const ResidualRule& rule, bool only_stable = false);

  [[nodiscard]] std::size_t points() const noexcept override { return data_.size(); }
  [[nodiscard]] std::size_t per_point() const noexcept override { return rule_.per_point(); }
  [[nodiscard]] ResidualAxis axis(std::span<const double> theta) const override;
  bool evaluate(std::span<const double> theta, double* residual, double* jacobian) const override;
  [[nodiscard]] BestFactor best_factor(std::span<const double> theta) const override;
  /// Only with both parts of the response, and for ratios of sums of powers; see linear_start.hpp.
  [[nodiscard]] std::vector<std::vector<double>> linear_fits(std::span<const double> near) const override;

 private:
  /// What residuals are multiplied by for the sake of stability.
  [[nodiscard]] double wall(std::span<const double> parameters) const;

  const FrequencyResponseData& data_;
  const Structure& structure_;
  const Realisation& realisation_;
  const ResidualRule& rule_;
  bool only_stable_;
  mutable std::vector<std::complex<double>> value_;
  mutable std::vector<std::complex<double>> gradient_;
  mutable std::vector<std::complex<double>> by_theta_;  // a column
};

}  // namespace frac::detail
