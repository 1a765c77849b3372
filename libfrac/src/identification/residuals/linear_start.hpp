// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <complex>
#include <optional>
#include <span>
#include <vector>

#include "coefficient_form.hpp"

namespace frac::detail {

/// Weights of the linear residuals N(j omega) - D(j omega) G.
enum class LinearWeights {
  levy,                // 1 (Levy 1959)
  vinagre,             // (omega_{i+1} - omega_{i-1})/(2 omega_i^2) (Vinagre; Valerio, Sa da Costa 2005, eq. 31)
  sanathanan_koerner,  // 1/|D|^2 of the pass before, five passes (Sanathanan, Koerner 1963)
};

/// Coefficients of a ratio of sums of powers by linear least squares.
struct LinearFit {
  std::vector<double> numerator, denominator;  // of the terms of the form, constants included
  std::size_t unknowns;
  std::size_t rank;  // below unknowns: the data do not tell the coefficients apart, and the shortest solution is given
};

/// @param weight  factor of the residual of each point beside the linear weights
/// Empty where no coefficient is unknown, none is a constant (so that the scale is open), or the numbers overflow.
[[nodiscard]] std::optional<LinearFit> linear_fit(const CoefficientForm& form, std::span<const double> omega,
                                                  std::span<const std::complex<double>> value,
                                                  std::span<const double> weight, LinearWeights weights);

/// Parameters whose coefficients come nearest (relatively) to those of the fit: by logarithms where each coefficient is
/// one product of parameters, by Gauss-Newton steps from `near` where it is a sum of them.  Orders, delays and fixed
/// parameters keep their values in `near`.  Empty where coefficients have the wrong sign.
[[nodiscard]] std::optional<std::vector<double>> parameters_from(const CoefficientForm& form, const LinearFit& fit,
                                                                 std::span<const double> near,
                                                                 const std::vector<std::size_t>& wanted);

}  // namespace frac::detail
