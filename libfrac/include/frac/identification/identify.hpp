// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <complex>
#include <stdexcept>
#include <string>
#include <vector>

#include "frac/identification/fit.hpp"
#include "frac/identification/model_library.hpp"
#include "frac/identification/time_fit.hpp"

namespace frac {

/// A model given by its values at the frequencies of the data, e.g. the static-backlash curve.
struct FixedCurve {
  std::string name;
  std::vector<std::complex<double>> value;
  std::size_t fitted_parameters = 0;  // that were adjusted to these data elsewhere and are charged in AICc and BIC
};

struct RankedFit {
  std::string name;
  ModelClass model_class;
  FitResult fit;
  double delta_aicc;     // aicc minus the best one; 0 for the best
  double akaike_weight;  // share of evidence among the ranked; they sum to 1
};

enum class Verdict { fractional_supported, fractional_not_supported, undecided };
[[nodiscard]] std::string_view to_string(Verdict verdict);

/// Structures ranked by AICc on the same residuals, best first.  The chosen one is, of those whose fit converged, the
/// simplest (fewest free parameters) with an AICc within 2 of the best.
///
/// The verdict compares the best fractional candidate with the best of the others.  Where the best fit leaves residuals
/// that follow each other along the axis of frequency or time (the model, not noise, is what is left), the points count
/// for less: differences of AICc are multiplied by (1 - r)/(1 + r), r the lag-1 autocorrelation.  Supported: evidence
/// above 10 and an order whose interval excludes every whole number; not supported: evidence below 2; undecided
/// between.
struct IdentificationResult {
  std::vector<RankedFit> ranking;
  std::vector<std::string> skipped;  // candidates that could not be fitted, with the reason
  std::size_t chosen;                // index into ranking
  Verdict verdict;
  double evidence;  // AICc of the best integer-order or fixed candidate minus that of the best fractional one, so
                    // multiplied; NaN when one side has no candidate
  std::string verdict_sentence;
};

/// None of the candidates could be fitted; what() gives the reason of the first.
class NoCandidateFits : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// @throws std::invalid_argument  no candidate, a curve of another length than the data, or a weight that does not go
///     with the data (see fit()).
/// @throws NoCandidateFits
[[nodiscard]] IdentificationResult identify(const FrequencyResponseData& data, const std::vector<NamedModel>& models,
                                            const std::vector<FixedCurve>& curves, const FitOptions& options,
                                            int threads = 0);
/// The same on samples of input and output.  A candidate that is no ratio of sums of powers is skipped, and so is one
/// without a finite response to the input, such as a differentiator under a step.
[[nodiscard]] IdentificationResult identify(const TimeResponseData& data, const std::vector<NamedModel>& models,
                                            const TimeFitOptions& options, int threads = 0);

}  // namespace frac
