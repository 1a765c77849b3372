// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <complex>
#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "frac/identification/joint_fit.hpp"
#include "identification/data/residual_rule.hpp"
#include "laws.hpp"

namespace frac::detail {

/// What the solver works on: the logarithm of a positive parameter, or the parameter itself.
struct JointVariable {
  std::string name;
  bool logarithmic;
  double lower, upper;  // of the variable

  [[nodiscard]] double parameter(double variable) const;
  [[nodiscard]] double variable(double parameter) const;   // within the limits
  [[nodiscard]] double derivative(double variable) const;  // d parameter / d variable
};

/// Which parameters of the structure are fixed, common to all curves, or of each curve.  The variables have no unit of
/// their own: those of a shared coefficient must not move with the orders of single curves.
struct JointLayout {
  /// @throws std::invalid_argument  as joint_fit() says of names and constraints.
  /// @param laws           stay with the caller
  /// @param law_variables  those of the parameters of the laws, which are shared and follow the shared parameters
  JointLayout(const Structure& structure, const JointFitOptions& options, const Laws& laws,
              std::vector<JointVariable> law_variables, double omega_lower, double omega_upper);

  struct Place {
    std::size_t parameter;
    bool shared;
    std::size_t index;  // among the shared or own variables
  };
  std::vector<double> fixed;  // of every parameter; NaN: free
  std::vector<Place> free;
  std::vector<JointVariable> shared, own;

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
  /// In rising order of the variables.
  [[nodiscard]] std::vector<Slope> slopes(std::span<const double> shared_values, std::span<const double> own_values,
                                          std::size_t curve) const;

 private:
  [[nodiscard]] std::vector<double> of_laws(std::span<const double> shared_values) const;
  const Laws& laws_;
};

/// Residuals of one curve, each divided by the noise of the curve, and their derivatives.  Not thread-safe: it keeps
/// buffers between calls.
class CurveResiduals {
 public:
  /// @param index  of the curve
  /// @param noise  standard deviation of a residual
  CurveResiduals(const FrequencyResponseData& data, const Structure& structure, const Realisation& realisation,
                 const JointLayout& layout, std::size_t index, ResidualRule rule, double noise);

  [[nodiscard]] std::size_t count() const { return data_.size() * rule_.per_point(); }
  [[nodiscard]] std::size_t per_point() const { return rule_.per_point(); }
  [[nodiscard]] double noise() const { return noise_; }

  /// False where one is not finite.
  /// @param jacobian  a column of count() for each own variable, then for each shared one; or null
  bool evaluate(std::span<const double> shared, std::span<const double> own, double* residual, double* jacobian);

 private:
  const FrequencyResponseData& data_;
  const Structure& structure_;
  const Realisation& realisation_;
  const JointLayout& layout_;
  std::size_t index_;
  ResidualRule rule_;
  double noise_;
  std::vector<std::complex<double>> value_, gradient_, column_;
};

}  // namespace frac::detail
