// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "frac/identification/identify.hpp"
#include "frac/identification/time_fit.hpp"

namespace frac::detail {

/// What speaks against the hold of a record, in a sentence, with what would help.
struct HoldAdvice {
  std::string sentence;
  std::vector<Advice> advice;
};

/// The hold under which the same model, refitted, explains the record with odds of more than e^10
/// to 1 against the one it was fitted under; none where there is no such hold.  Likelihoods are those of noise of first
/// order; each hold may have an input before the record too, which pays Schwarz's price.  The odds are against what is
/// then true with a chance below e^-10, since a likelihood ratio has the mean 1 there (Markov's inequality); the
/// parameters, alike in number, are fitted under both.  A band-limited input is thought of where it repeats itself.
/// @param options  of the fit
[[nodiscard]] std::optional<HoldAdvice> hold_advice(const TimeResponseData& data, const Structure& structure,
                                                    const TimeFitOptions& options, const FitResult& result);

/// Adds what is not yet among the advice.
void add_advice(const std::vector<Advice>& more, std::vector<Advice>& advice);

/// Says it in the notes and as advice where a preset with a drift of the output, or with an input before
/// the record, describes the record better than the ratio that was chosen without: poles of a ratio can follow a drift,
/// which then stands in no residual.  Nothing where none does, or where a preset was chosen, whose own residuals would
/// show it.
void add_background_advice(const TimeResponseData& data, const TimeFitOptions& options, IdentificationResult& result);

}  // namespace frac::detail
