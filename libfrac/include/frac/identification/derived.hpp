// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "frac/identification/fit.hpp"
#include "frac/structure.hpp"

namespace frac {

/// Estimate of a derived quantity.
struct DerivedEstimate {
  std::string name;
  std::string formula;
  double value;  // NaN where the formula has no real value at the estimates
  /// NaN where they hang on a parameter without a standard error, or on parameters that only trade off, so that no
  /// digit of the quantity's own is left in their covariance.
  double standard_error, ci95_lower, ci95_upper;
};

/// A quantity computed from the parameters of a fit, "f1 = (R1 Q1)^(-1/n1)/(2 pi)": a formula as of Structure, free of
/// s.  `pi` is the number.
class DerivedQuantity {
 public:
  /// @throws std::invalid_argument  no name before =, s in the formula, or a name that is no parameter.
  /// @throws FormulaError
  DerivedQuantity(std::string_view definition, std::span<const std::string> parameter_names);

  [[nodiscard]] const std::string& name() const noexcept { return name_; }

  /// Value, and its error by linear propagation of the covariance.
  /// @param covariance  one row per parameter, as FitResult::covariance
  /// @param half_width  of a 95 % interval in standard errors
  [[nodiscard]] DerivedEstimate at(std::span<const double> parameters,
                                   const std::vector<std::vector<double>>& covariance, double half_width) const;

 private:
  std::string name_, text_;
  Structure formula_;                   // the text with the number for pi
  std::vector<std::size_t> parameter_;  // of each name in the formula
};

/// Quantities at the estimates of a fit, with Student's t of its degrees of freedom.
[[nodiscard]] std::vector<DerivedEstimate> derived_estimates(const FitResult& result,
                                                             std::span<const DerivedQuantity> quantities);

}  // namespace frac
