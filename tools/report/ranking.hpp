// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "frac/identification/identify.hpp"
#include "report/section.hpp"
#include "report/table.hpp"

namespace report {

/// A structure in words for readers: its formula, with fixed curves named as such.
[[nodiscard]] std::string described(const frac::RankedFit& fit);

/// Formula with the names of its parameters, as enhanced text for keys; the name of the structure if it is too long.
[[nodiscard]] std::string key_label(const frac::RankedFit& fit);

/// Remark on an estimate: "fixed", "from the other part" (the fitted part does not depend on it), "at bound", "not
/// identified" or nothing.
[[nodiscard]] std::string remark(const frac::ParameterEstimate& parameter);

/// "0.667 (0.661 … 0.673)", plain text.
[[nodiscard]] std::string estimate_text(const frac::ParameterEstimate& parameter);

/// The sentence of the verdict and what was left out, HTML.
[[nodiscard]] std::string verdict_html(const frac::IdentificationResult& result);

/// Parameters of the chosen structure with their intervals.
/// @param unit  of the value, as people write it; empty where it is not known
[[nodiscard]] Table chosen_table(const std::string& name, const frac::IdentificationResult& result,
                                 const std::string& unit);

/// Ranking with AICc, evidence and rms; CSV also has the parameters in one cell each.
[[nodiscard]] Table ranking_table(const std::string& name, const std::string& caption,
                                  const frac::IdentificationResult& result);

/// One row per parameter of every structure, folded on the page.
[[nodiscard]] Table parameter_table(const std::string& name, const std::string& caption,
                                    const frac::IdentificationResult& result);

/// Names and words, HTML, that the tables of one identification carry.
struct RankingWords {
  std::string ranking_name, ranking_caption;
  std::string parameters_name, parameters_caption;
};

/// Adds the tables and the facts of an identification; its verdict stands with its picture.
/// @param id  ends the names of the facts
void add_ranking(Section& section, const std::string& id, const frac::IdentificationResult& result,
                 const RankingWords& words);

/// Parameter of that name, or null.
[[nodiscard]] const frac::ParameterEstimate* find_parameter(const frac::FitResult& fit, const std::string& name);

}  // namespace report
