// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <string>

#include "confidence.hpp"
#include "frac/identification/fit.hpp"
#include "frac/structure.hpp"
#include "identification/search/global_search.hpp"

namespace frac::detail {

/// What fits of every kind of data say alike of what they found.

/// A result that knows how it was searched for, and nothing else yet.
[[nodiscard]] FitResult describe_search(const Structure& structure, const Residuals& residuals,
                                        const GlobalSolution& solution);

/// Makes it one of a search that found nothing, and why.
void describe_failure(FitResult& result, const Structure& structure, const ParameterMap& map, std::string message);

/// Fills in estimates, covariance and condition, and adds to the message what the data or the limits leave open.
void describe_estimates(FitResult& result, const Structure& structure, const Residuals& residuals,
                        std::span<const ParameterConstraint> constraints, const Confidence& found,
                        std::span<const double> theta);

/// What became of a prior, by the estimate that it had a share in.
[[nodiscard]] PriorEstimate prior_estimate(const std::string& name, const ParameterPrior& prior,
                                           const ParameterEstimate& estimate);
/// Sentences on priors that the data contradict and on those that tell all; empty without any.
[[nodiscard]] std::string remark_on_priors(std::span<const PriorEstimate> priors);

/// Fills in cost, rms, criteria, outliers and loss.
/// @param unit  of the residuals: the size of the weighted data
void describe_residuals(FitResult& result, const Residuals& residuals, const LocalOptions& options,
                        const Confidence& found, std::span<const double> theta, double unit);

/// "  K = 2, 95 % within 1.9 .. 2.1", a line of a summary.
[[nodiscard]] std::string summary_line(const ParameterEstimate& estimate, bool without_noise);

}  // namespace frac::detail
