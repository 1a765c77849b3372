// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "identification/data/fit_data.hpp"
#include "identification/verdict/competitor.hpp"

namespace frac::detail {

/// Fills in the verdict of a ranking as IdentificationResult defines it.
/// @param competitors  in the order of the ranking
/// @param skipped_rivals  names of the candidates of integer order that could not be fitted
template <class Data>
void judge(IdentificationResult& result, const Data& data, const OptionsOf<Data>& options,
           const std::vector<Competitor>& competitors, const std::vector<std::string>& skipped_rivals);

}  // namespace frac::detail
