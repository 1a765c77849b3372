// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <vector>

#include "frac/identification/fit.hpp"
#include "identification/verdict/competitor.hpp"

namespace frac::detail {

/// Keeps one of the candidates that are the same model in several spellings, such as two arcs as a preset and as the
/// member of a family, and puts the names of the others into its RankedFit::also.  A preset goes before the member of a
/// family.  Sums of passive elements are merged with presets only, since members of families do not stand for them.
/// @param competitors  in the order of the candidates; the sums of passive elements stand behind afterwards
/// @param size         of the weighted data
/// @param one_beyond  whether two fits that are alike on the data are one model beyond them as well
void merge_equivalent(std::vector<Competitor>& competitors, std::vector<Competitor> passive, double size,
                      const std::function<bool(const FitResult&, const FitResult&)>& one_beyond);

/// Whether two models are one a decade beyond the data, which those that are alike on the data seldom are.
[[nodiscard]] bool same_beyond(const FrequencyResponseData& data, const FitOptions& options, const FitResult& one,
                               const FitResult& other);

}  // namespace frac::detail
