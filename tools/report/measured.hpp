// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "frac/identification/identify.hpp"
#include "frac/identification/model_library.hpp"
#include "frac/identification/validate.hpp"
#include "io/frequency_response_file.hpp"
#include "report/figure.hpp"
#include "report/section.hpp"

/// Parts that the chapters of measured files share, whether they hold frequency responses or samples over time.
namespace report {

/// Indices of the points to fit: all of them, or at most 2000 taken evenly.  More points do not change a ranking but
/// make every fit slower in proportion.
[[nodiscard]] std::vector<std::size_t> evenly_chosen(std::size_t points);

/// Candidates with few enough free parameters for AICc, which needs three residuals more than parameters.
/// @param further_parameters  fitted beside those of the structure
[[nodiscard]] std::vector<frac::NamedModel> that_suit(std::vector<frac::NamedModel> candidates, std::size_t residuals,
                                                      std::size_t further_parameters = 0);

/// One of the best fits as it is drawn over the data.
struct DrawnFit {
  const frac::RankedFit& ranked;
  std::string label;  // enhanced text for the key
  std::string colour;
  Mark mark;
};

/// The chosen fit, the best of another class, and the best that misses the data, as an example of what that looks like.
[[nodiscard]] std::vector<DrawnFit> drawn_fits(const frac::IdentificationResult& result);

/// The chapter of a measured file with the title and the reading.
[[nodiscard]] Section open_measured(std::string_view chapter, const std::string& file, std::size_t number);

/// The judgement for people, with what to write where the sign of the imaginary part looks reversed.
[[nodiscard]] std::string validity_sentence(const frac::ValidationResult& result,
                                            const io::FrequencyResponseFile& file);

/// Adds what there is to say where nothing could be fitted.
/// @param why      HTML
/// @param verdict  for results.json
void add_no_verdict(Section& section, const std::string& why, const std::string& verdict);

/// Adds verdict, ranking, parameters and the finding they come to.
void add_verdict(Section& section, const std::string& file, const frac::IdentificationResult& result);

}  // namespace report
