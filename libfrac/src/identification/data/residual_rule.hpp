// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <complex>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "frac/identification/fit.hpp"

namespace frac::detail {

/// The numbers that are compared at each frequency.
enum class ResidualForm {
  imaginary,
  real,
  cartesian,      // real and imaginary part: two residuals
  logarithmic,    // ln|model/data| and the angle between them: two residuals
  magnitude,      // |model| - |data|
  log_magnitude,  // ln|model/data|
  phase,          // angle from data to model, in (-pi, pi]
};

[[nodiscard]] inline std::size_t residuals_per_point(ResidualForm form) noexcept {
  return form == ResidualForm::cartesian || form == ResidualForm::logarithmic ? 2 : 1;
}

/// The model as far as residuals see it: a part that they leave out is that of the datum.
[[nodiscard]] inline std::complex<double> seen_of(ResidualForm form, std::complex<double> model,
                                                  std::complex<double> datum) noexcept {
  return {form == ResidualForm::imaginary ? datum.real() : model.real(),
          form == ResidualForm::real ? datum.imag() : model.imag()};
}

/// @throws std::invalid_argument  the weight does not go with the component.
[[nodiscard]] ResidualForm residual_form(Component component, Weight weight);

/// Form and weights of the residuals of one fit.
struct ResidualRule {
  ResidualForm form;
  std::vector<double> weight;  // of each point, divided by unit
  /// Root mean square of the weighted data (1 where the residual is a pure number).  Residuals are computed in this
  /// unit, so that solver tolerances mean the same for data of 1e-18 and of 1e18.
  double unit;
  /// Set where weights are 1/hypot(|datum|, floor), which the noise of the datum moves.
  std::optional<double> floor = {};

  [[nodiscard]] std::size_t per_point() const noexcept { return residuals_per_point(form); }
  /// Residual(s) of one point; false where they do not exist.
  bool residual(std::size_t point, std::complex<double> model, std::complex<double> data, double* result) const;
  /// Residuals of all points in order, and their derivatives from those of the model by one variable.  False where one
  /// is not finite.
  bool residuals(std::span<const std::complex<double>> model, std::span<const std::complex<double>> data,
                 double* result) const;
  bool derivatives(std::span<const std::complex<double>> model, std::span<const std::complex<double>> of_model,
                   double* result) const;
};

/// @throws std::invalid_argument  the weight does not go with the component or with the data, as fit.hpp says.
/// @param floor  of weight `learned`, >= 0
[[nodiscard]] ResidualRule residual_rule(const FrequencyResponseData& data, Component component, Weight weight,
                                         double floor = 0);
/// The rule of a fit with these options; an unset floor counts as 0.
[[nodiscard]] ResidualRule residual_rule(const FrequencyResponseData& data, const FitOptions& options);

/// Which values are 0 and what they weigh, in one sentence with a blank before it; empty where none is or the weight
/// does not depend on it.
[[nodiscard]] std::string remark_on_zeros(const FrequencyResponseData& data, const FitOptions& options);

/// Weighted residuals of given model values, in the unit fit.hpp defines them in.
/// @throws std::invalid_argument  naming the frequency at which one does not exist.
[[nodiscard]] std::vector<double> curve_residuals(const FrequencyResponseData& data, const ResidualRule& rule,
                                                  const std::vector<std::complex<double>>& model);

}  // namespace frac::detail
