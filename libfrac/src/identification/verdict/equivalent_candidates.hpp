// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "identification/data/fit_data.hpp"
#include "identification/verdict/competitor.hpp"

namespace frac::detail {

/// Keeps one of the candidates that are the same model in several spellings, such as two arcs as a preset and as the
/// member of a family, and puts the names of the others into its RankedFit::also.  A preset goes before the member of a
/// family.  Sums of passive elements are merged with presets only, since members of families do not stand for them.
/// @param competitors  in the order of the candidates; the sums of passive elements stand behind afterwards
template <class Data>
void merge_equivalent(std::vector<Competitor>& competitors, std::vector<Competitor> passive, const Data& data,
                      const OptionsOf<Data>& options);

}  // namespace frac::detail
