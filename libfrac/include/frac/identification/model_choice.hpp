// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "frac/identification/identify.hpp"
#include "frac/identification/time_fit.hpp"

namespace frac {

/// Whether residuals look like noise along the axis of frequency or time.
struct ResidualWhiteness {
  /// 0: unrelated neighbours; towards 1: the model misses a shape.
  double lag_one_correlation;
  /// Of the Ljung-Box statistic over min(10, n/5) lags: small means not white; NaN below 10 points.
  double p_value;
};

/// Whiteness of the weighted residuals of a fit, both parts together (Ljung, Box 1978).
[[nodiscard]] ResidualWhiteness residual_whiteness(const FrequencyResponseData& data, const FitOptions& options,
                                                   const FitResult& result);

/// Whiteness of the residuals of a fit over time, at the instants that count.
[[nodiscard]] ResidualWhiteness residual_whiteness(const TimeResponseData& data, const TimeFitOptions& options,
                                                   const FitResult& result);

struct FTest {
  /// Improvement of the cost per parameter added, over the residual variance of the full fit.
  double statistic;
  /// Chance of so large a statistic if the simple structure is true.
  double p_value;
};
/// F test of a structure, `full`, against one that it contains, `simple`.
/// @throws std::invalid_argument  the full fit has no more free parameters, or no degree of freedom is left.
[[nodiscard]] FTest f_test(const FitResult& simple, const FitResult& full);

/// k-fold cross-validation over blocks of neighbouring frequencies: each block is predicted by a fit to the others.
/// @return rms of the weighted residuals of the predictions; infinity where a fold could not be fitted
/// @throws std::invalid_argument  folds < 2, or a fold would leave fewer residuals than free parameters.
[[nodiscard]] double cross_validation(const FrequencyResponseData& data, const Structure& structure,
                                      const FitOptions& options, std::size_t folds);
/// The same over blocks of neighbouring outputs; the input drives the system throughout.
[[nodiscard]] double cross_validation(const TimeResponseData& data, const Structure& structure,
                                      const TimeFitOptions& options, std::size_t folds);

/// A family of structures in which each member contains the one before.
enum class GrowthFamily {
  powers,        // K1 s^a1 + K2 s^a2 + ...
  denominator,   // 1/(b0 + b1 s^a1 + b2 s^a2 + ...)
  arcs,          // R0 + R1/(1 + R1 Q1 s^n1) + R2/(1 + R2 Q2 s^n2) + ...
  rational,      // b(s)/a(s) with one pole more each time, see RationalFamily
  commensurate,  // the same in s^a
  terms,         // powers and arcs, whichever pays most each time, see TermFamily
  elements,      // passive elements with positive gains, see ElementFamily
};
/// "powers", "denominator", ...
[[nodiscard]] std::string_view to_string(GrowthFamily family);
/// @throws std::invalid_argument  unknown name; the text lists the known ones.
[[nodiscard]] GrowthFamily growth_family_from_string(std::string_view text);
[[nodiscard]] std::span<const GrowthFamily> growth_families();

/// Whether each member has the parameters of the one before under the same names, so that FitOptions::constraints may
/// name them.
[[nodiscard]] bool names_persist(GrowthFamily family);

/// The member of a family with that many terms (at least 1), and the ranges of its parameters.
/// @throws std::invalid_argument  for rational, commensurate, terms and elements, whose form follows from data
[[nodiscard]] NamedModel grown_model(GrowthFamily family, std::size_t terms);

/// The fits of a growing structure, simplest first; the one behind the chosen one did not pay for its term.
struct Growth {
  std::vector<FitResult> fits;
  std::vector<NamedModel> models;  // of the fits
  std::size_t chosen;              // index into fits
  std::string reason;              // one sentence: why it went no further
};

/// Starts from one term and adds another only while the data pay for it: AICc must fall by more than 2 in the measure
/// of identify(), the F test must reject the smaller one at 1 %, and every parameter of the larger one must be
/// identified or at its bound unless AICc falls by more than 10.  Families whose form follows from data grow until BIC,
/// with the search for places paid for, has risen twice, and `most_terms` does not count there.  Structures are compared
/// under one weight: where Weight::learned has no floor, that which the structure grown with none tells.
/// @param options  its constraints hold for each member that has the parameter
/// @throws std::invalid_argument  as fit(), and for constraints of a family whose names do not persist
[[nodiscard]] Growth grow(const FrequencyResponseData& data, GrowthFamily family, const FitOptions& options,
                          std::size_t most_terms = 4);
[[nodiscard]] Growth grow(const TimeResponseData& data, GrowthFamily family, const TimeFitOptions& options,
                          std::size_t most_terms = 4);

}  // namespace frac
