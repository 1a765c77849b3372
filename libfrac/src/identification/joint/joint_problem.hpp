// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "frac/identification/joint_fit.hpp"
#include "identification/residuals/problem.hpp"
#include "laws.hpp"

namespace frac::detail {

/// A variable of the solver: the logarithm of a positive parameter, or the parameter itself.  Of one that is not to be
/// below another it is the way up from that one, as ParameterMap has it; JointLayout knows the other one.
struct JointVariable {
  std::string name;
  bool logarithmic;
  double lower, upper;    // of the variable
  bool in_order = false;  // above another one
  // Limits of the parameter; infinite where there are none.
  double least = -std::numeric_limits<double>::infinity();
  double most = std::numeric_limits<double>::infinity();

  [[nodiscard]] double parameter(double variable) const;
  [[nodiscard]] double variable(double parameter) const;   // within the limits
  [[nodiscard]] double derivative(double variable) const;  // d parameter / d variable
};

/// A prior of a parameter of the structure, or of a variable of the laws.
struct JointPrior {
  std::string name;
  ParameterPrior prior;
  std::size_t parameter;     // of the structure; no_place where it is one of a law
  std::size_t law_variable;  // among the shared variables; no_place where it is not
};

/// Which parameters of the structure are fixed, common to all curves, or of each curve.  The variables have no unit of
/// their own: those of a shared coefficient must not move with the orders of single curves.
struct JointLayout {
  /// @throws std::invalid_argument  as joint_fit() says of names and constraints.
  /// @param laws           stay with the caller
  /// @param law_constraints  on parameters of the laws
  /// @param law_variables  those of the parameters of the laws, which are shared and follow the shared parameters
  JointLayout(const Structure& structure, const JointFitOptions& options, const Laws& laws,
              std::vector<JointVariable> law_variables, const std::vector<ParameterConstraint>& law_constraints,
              double omega_lower, double omega_upper);

  static constexpr std::size_t no_place = static_cast<std::size_t>(-1);
  struct Place {
    std::size_t parameter;
    bool shared;
    std::size_t index;  // among the shared or own variables
    std::size_t above;  // entry of `free` that it is not below, which stands before it; or no_place
    double most;        // of the parameter, where it is above another one
  };
  std::vector<double> fixed;  // of every parameter; NaN: free
  std::vector<Place> free;
  std::vector<JointVariable> shared, own;
  std::vector<JointPrior> shared_priors, own_priors;
  std::size_t reference = no_place;  // curve in which the own variables of a shift are held

  [[nodiscard]] const JointVariable& variable(const Place& place) const {
    return place.shared ? shared[place.index] : own[place.index];
  }
  /// Values of the structure's parameters in one curve.
  [[nodiscard]] std::vector<double> parameters(std::span<const double> shared_values,
                                               std::span<const double> own_values, std::size_t curve) const;

  /// Derivatives of the parameters of the structure by the variables: own ones first, then shared ones.
  struct Slope {
    std::size_t parameter, variable;
    double slope;
  };
  /// In rising order of the variables; one pair may have several, which add up.
  [[nodiscard]] std::vector<Slope> slopes(std::span<const double> shared_values, std::span<const double> own_values,
                                          std::size_t curve) const;
  /// Variables from those they would be without an order of parameters.
  void take_order(std::vector<double>& shared_values, std::vector<double>& own_values) const;
  [[nodiscard]] bool is_held(std::size_t curve, std::size_t own_index) const;

  /// Distance of the estimate from the value of a prior, and its derivatives by all variables: own, then shared ones.
  struct Pull {
    double distance;
    std::vector<double> by_variable;
  };
  [[nodiscard]] Pull pull(const JointPrior& prior, std::span<const double> shared_values,
                          std::span<const double> own_values, std::size_t curve) const;

 private:
  void put_in_order(const Structure& structure, const std::vector<ParameterConstraint>& constraints);
  [[nodiscard]] double way_up(const Place& place, std::span<const double> parameters) const;
  void add_slopes(const Place& place, double factor, std::size_t of_parameter, std::span<const double> parameters,
                  std::span<const double> shared_values, std::span<const double> own_values, std::size_t curve,
                  std::vector<Slope>& all) const;
  [[nodiscard]] std::vector<double> of_laws(std::span<const double> shared_values) const;
  const Laws& laws_;
};

/// Options of a fit of one curve by itself, of its kind.
using CurveOptions = std::variant<FitOptions, TimeFitOptions>;

/// The problem of a curve, by the parameters of the structure themselves.
/// @param curve, structure  stay with the caller
/// @param settled           with what the fit of the curve alone has learned
[[nodiscard]] std::unique_ptr<Problem> problem_of(const JointCurve& curve, const Structure& structure,
                                                  const CurveOptions& settled);

/// Residuals of one curve, each divided by the noise of the curve, and their derivatives; behind them the priors of its
/// own parameters, in units of the residuals.  Not thread-safe: it keeps buffers between calls.
class CurveResiduals {
 public:
  /// @param problem  by the parameters
  /// @param index    of the curve
  /// @param noise    standard deviation of a residual
  CurveResiduals(std::unique_ptr<Problem> problem, const JointLayout& layout, std::size_t index, double noise);

  /// Residuals of the data.
  [[nodiscard]] std::size_t count() const { return residuals_.count(); }
  /// These and the priors.
  [[nodiscard]] std::size_t rows() const { return count() + layout_.own_priors.size(); }
  [[nodiscard]] std::size_t per_point() const { return residuals_.per_point(); }
  [[nodiscard]] ResidualAxis axis(std::span<const double> shared, std::span<const double> own) const {
    return residuals_.axis(layout_.parameters(shared, own, index_));
  }
  /// Linear parameters of the curve, such as an offset, which the residuals are projected free of.
  [[nodiscard]] std::size_t eliminated() const { return residuals_.eliminated(); }
  /// Their derivatives of the residuals: count() x eliminated().
  [[nodiscard]] Eigen::MatrixXd eliminated_columns() const { return residuals_.eliminated_columns(); }
  [[nodiscard]] double noise() const { return noise_; }
  void set_noise(double noise) { noise_ = noise; }
  /// Standard deviation that a residual is taken to have where priors are weighed against it.
  void set_prior_weight(double weight) { prior_weight_ = weight; }
  [[nodiscard]] double prior_weight() const { return prior_weight_; }
  void set_loss(Loss loss, double scale) {
    loss_ = loss;
    loss_scale_ = scale;
    residuals_.set_loss(loss, scale * noise_ / problem_->unit);
  }
  [[nodiscard]] Loss loss() const { return loss_; }
  /// In units of the noise.
  [[nodiscard]] double loss_scale() const { return loss_scale_; }

  /// False where one is not finite.
  /// @param residual  rows() of them
  /// @param jacobian  a column of rows() for each own variable, then for each shared one; or null
  bool evaluate(std::span<const double> shared, std::span<const double> own, double* residual, double* jacobian);
  /// Those of the data.
  [[nodiscard]] std::vector<double> of_data(std::span<const double> shared, std::span<const double> own);

 private:
  std::unique_ptr<Problem> problem_;
  Residuals& residuals_;
  const JointLayout& layout_;
  std::size_t index_;
  double noise_;
  double prior_weight_ = 1;
  Loss loss_ = Loss::none;
  double loss_scale_ = 1;
  std::vector<double> by_parameters_;  // a column for each
};

}  // namespace frac::detail
