// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "frac/describe.hpp"

namespace frac {

struct DerivedEstimate;
struct Economy;
struct EconomyCurve;
struct EconomyPoint;
struct Finalist;
struct FitResult;
struct IdentificationResult;
struct JointCurveResult;
struct JointFitResult;
struct LackOfFit;
struct NextMeasurement;
struct ParameterEstimate;
struct PriorEstimate;
struct RankedFit;

// Descriptions of the results of identification, see frac/describe.hpp.  Units: "residual" is that of a weighted
// residual, 1 or that of the data by FitOptions::weight; "value" that of the data; "parameter" that of the parameter.

template <ResultOf<ParameterEstimate> Result, class Visit>
void describe(Result& result, const Visit& visit) {
  visit("name", "", "name in the formula", result.name);
  visit("value", "parameter", "estimate", result.value);
  visit("standard_error", "parameter", "standard error: 0 where fixed, none where unseen or at a bound",
        result.standard_error);
  visit("ci95", "parameter", "interval of 95 %",
        NumberPair("ci95_lower", result.ci95_lower, "ci95_upper", result.ci95_upper));
  visit("interval", "", "curvature or profile: what the interval follows", result.interval);
  visit("widening", "1", "factor on the errors for the correlation of neighbouring residuals", result.widening);
  visit("identified", "", "whether the data tell the parameter", result.identified);
  visit("at_bound", "", "whether the estimate lies at a limit", result.at_bound);
  visit("fixed", "", "whether it was held and not estimated", result.fixed);
  visit("limits", "parameter", "limits in force, given or by default",
        NumberPair("lower_limit", result.lower_limit, "upper_limit", result.upper_limit));
  visit("limits_given", "", "whether limits were given", result.limits_given);
  visit("from_other_component", "", "whether it is estimated from the part of the response that is not fitted",
        result.from_other_component);
  visit("centre", "", "value and standard error with frequency in units of centre_omega, where it is least correlated",
        NumberPair("centre_value", result.centre_value, "centre_standard_error", result.centre_standard_error, "value",
                   "standard_error"));
}

template <ResultOf<PriorEstimate> Result, class Visit>
void describe(Result& result, const Visit& visit) {
  visit("name", "", "parameter that the prior is of", result.name);
  visit("value", "parameter", "middle of the prior", result.prior.value);
  visit("deviation", "parameter", "standard deviation, of the logarithm where relative", result.prior.deviation);
  visit("relative", "", "whether the prior is of the logarithm of the parameter", result.prior.relative);
  visit("distance", "1", "distance of the estimate from the prior, in its standard deviations", result.distance);
  visit("conflict", "1", "distance between prior and data, in standard deviations of both together", result.conflict);
  visit("share", "1", "part of what is known of the parameter that the prior has told", result.share);
}

template <ResultOf<DerivedEstimate> Result, class Visit>
void describe(Result& result, const Visit& visit) {
  visit("name", "", "name of the quantity", result.name);
  visit("formula", "", "formula of the parameters", result.formula);
  visit("value", "", "value at the estimates", result.value);
  visit("standard_error", "", "standard error, by the covariance of the parameters", result.standard_error);
  visit("ci95", "", "interval of 95 %", NumberPair("ci95_lower", result.ci95_lower, "ci95_upper", result.ci95_upper));
}

template <ResultOf<LackOfFit> Result, class Visit>
void describe(Result& result, const Visit& visit) {
  visit("noise_from", "", "sigma, repeats or data: what tells the noise", result.source);
  visit("noise", "residual", "standard deviation of the noise", result.noise);
  visit("misfit", "1", "rms of the residuals, by degrees of freedom, over the noise", result.misfit);
  visit("p_value", "1", "chance of such a misfit by noise alone", result.p_value);
  visit("correlation", "1", "correlation of neighbouring residuals", result.correlation);
  visit("correlation_p_value", "1", "chance of so much correlation in white noise", result.correlation_p_value);
  visit("adequate", "", "whether the fit follows the data to within their noise", result.adequate);
  visit("misses", "rad/s", "bands that the fit misses (over time in s)", result.misses);
}

template <ResultOf<FitResult> Result, class Visit>
void describe(Result& result, const Visit& visit) {
  visit({"model", "formula"}, "", "formula that was fitted", result.model);
  visit("parameters", "", "estimates, see parameter", result.parameters);
  visit("cost", "residual^2", "sum of squared residuals, without loss and priors", result.cost);
  visit("rms", "residual", "root mean square of the residuals", result.rms);
  visit("relative_rms", "1", "rms over that of the data under the same weights", result.relative_rms);
  visit("gain_factor", "1", "factor that undoes the bias of relative weight by noise in its divisor",
        result.gain_factor);
  visit("max_residual", "residual", "largest residual", result.max_residual);
  visit("aicc", "1", "Akaike's criterion, corrected for few residuals", result.aicc);
  visit("bic", "1", "Schwarz's criterion", result.bic);
  visit("termination", "", "converged, not-converged or no-usable-start", result.termination);
  visit("message", "", "what became of the search", result.message);
  visit("residuals", "1", "number of residuals", result.residuals);
  visit("free_parameters", "1", "number of free parameters", result.free_parameters);
  visit("starts", "1", "local searches", result.starts);
  visit("starts_at_best", "1", "searches that ended at the least cost", result.starts_at_best);
  visit("distinct_minima", "1", "different ends of the seeded starts", result.distinct_minima);
  visit("confidence_of_optimum", "1", "probability that no start would have ended lower", result.confidence_of_optimum);
  visit("condition", "1", "condition of the scaled Fisher matrix", result.condition);
  visit("noise_correlation", "1", "correlation of neighbouring values of the noise, which intervals allow for",
        result.noise_correlation);
  visit("noise_floor", "value", "floor of weight learned, below which the noise is additive; 0 without one",
        result.noise_floor);
  visit("seconds", "s", "time that the fit took", result.seconds);
  visit("centre_omega", "rad/s", "geometric middle of the band", result.centre_omega);
  visit("loss_cost", "residual^2", "sum of the robust loss, what was made least", result.loss_cost);
  visit("loss_scale", "residual", "residual at which the loss turns from quadratic to robust", result.loss_scale);
  visit("loss_unit", "residual^2", "rise of loss_cost by a parameter without meaning", result.loss_unit);
  visit("effective_parameters", "1", "free parameters but for what priors tell", result.effective_parameters);
  visit("outliers", "", "points whose residual exceeds five robust standard deviations", result.outliers);
  visit("earlier_input", "", "estimated steps of the input before the record", result.earlier_input);
  visit("covariance", "", "covariance of the parameters, row by row", result.covariance);
  visit("priors", "", "what became of each prior, see prior", result.priors);
}

template <ResultOf<JointCurveResult> Result, class Visit>
void describe(Result& result, const Visit& visit) {
  visit("name", "", "name of the curve", result.name);
  visit("parameters", "", "estimates that hold for the curve, shared ones too, see parameter", result.parameters);
  visit("covariance", "", "covariance of the parameters, row by row", result.covariance);
  visit("residuals", "1", "number of residuals", result.residuals);
  visit("rms", "residual", "root mean square of the residuals", result.rms);
  visit("rms_alone", "residual", "root mean square where the curve shares nothing", result.rms_alone);
  visit("max_residual", "residual", "largest residual", result.max_residual);
  visit("noise", "residual", "standard deviation by which the curve counts", result.noise);
}

template <ResultOf<JointFitResult> Result, class Visit>
void describe(Result& result, const Visit& visit) {
  visit("model", "", "formula that was fitted, with the shift factors", result.model);
  visit("shared", "", "parameters of all curves and of the laws, see parameter", result.shared);
  visit("curves", "", "results of each curve, see joint-curve", result.curves);
  visit("cost", "1", "sum of squared residuals, each over the noise of its curve", result.cost);
  visit("residuals", "1", "number of residuals", result.residuals);
  visit("free_parameters", "1", "number of free parameters, over all curves", result.free_parameters);
  visit("starts", "1", "joint searches", result.starts);
  visit("starts_at_best", "1", "searches that ended at the least cost", result.starts_at_best);
  visit("sharing_p_value", "1", "chance of curves that share to differ as these do", result.sharing_p_value);
  visit("condition", "1", "condition of the scaled Fisher matrix of the shared parameters", result.condition);
  visit("termination", "", "converged, not-converged or no-usable-start", result.termination);
  visit("message", "", "what became of the search", result.message);
  visit("seconds", "s", "time that the fit took", result.seconds);
  visit("loss_cost", "1", "sum of the robust loss, what was made least", result.loss_cost);
  visit("effective_parameters", "1", "free parameters but for what priors tell", result.effective_parameters);
}

template <ResultOf<RankedFit> Result, class Visit>
void describe(Result& result, const Visit& visit) {
  visit("name", "", "preset, formula, member of a family or given curve", result.name);
  visit({"class", "model_class"}, "", "fractional, integer-order or fixed-curve", result.model_class);
  visit("also", "", "candidates that came to the same model in another spelling", result.also);
  visit("fit", "", "fit of the candidate, see fit", result.fit);
  visit("delta_aicc", "1", "aicc above the least", result.delta_aicc);
  visit("akaike_weight", "1", "share of evidence among the ranked", result.akaike_weight);
  visit("lack_of_fit", "", "whether it follows the data to within their noise", result.lack_of_fit);
  visit("from_family", "", "whether it is the member of a family that the data chose", result.from_family);
}

template <ResultOf<Finalist> Result, class Visit>
void describe(Result& result, const Visit& visit) {
  visit("parameters", "1", "number of parameters adjusted to the data", result.parameters);
  visit("prediction_rms", "residual", "rms of predictions of blocks of points from fits to the rest",
        result.prediction_rms);
  visit("extrapolation_rms", "residual", "rms of predictions of half a decade at either end", result.extrapolation_rms);
}

template <ResultOf<NextMeasurement> Result, class Visit>
void describe(Result& result, const Visit& visit) {
  visit("lower", "rad/s", "where the measurement begins", result.lower);
  visit("upper", "rad/s", "where the measurement ends", result.upper);
  visit("points", "1", "number of points, even in the logarithm", result.points);
  visit("accuracy", "residual", "standard deviation of a residual that the measurement needs", result.accuracy);
  visit("relative_accuracy", "1", "standard deviation over the response that it needs", result.relative_accuracy);
  visit("expected_evidence", "1", "change of evidence to expect, in favour of the true model",
        result.expected_evidence);
}

template <ResultOf<IdentificationResult> Result, class Visit>
void describe(Result& result, const Visit& visit) {
  visit("ranking", "", "candidates, best first, see candidate", result.ranking);
  visit("skipped", "", "candidates that could not be fitted, with the reason", result.skipped);
  visit("verdict", "", "supported, not-supported, undecided or no-adequate-model", result.verdict);
  visit("evidence", "1", "twice the logarithm of the odds of fractional to integer order, by these data",
        result.evidence);
  visit("departure_evidence", "1", "evidence for an order at least 0.1 from every whole number",
        result.departure_evidence);
  visit("verdict_sentence", "", "the verdict in words", result.verdict_sentence);
  visit("notes", "", "what else is to be known of verdict and choice, a sentence each", result.notes);
  visit("log10_odds", "1",
        "decimal logarithm of the odds of fractional to integer order; both may be far from the truth",
        result.log10_odds);
  visit("model_error", "", "whether no candidate follows the data to within their noise", result.model_error);
  visit("noise_floor", "value", "floor of weight learned, which all candidates share; 0 without one",
        result.noise_floor);
}

template <ResultOf<EconomyPoint> Result, class Visit>
void describe(Result& result, const Visit& visit) {
  visit("parameters", "1", "adjusted numbers", result.parameters);
  visit("error", "1", "root mean square of |model - data|/|data| of the component", result.error);
  visit("proven", "", "whether the error is the least of all beyond doubt; else the least found, which suffices",
        result.proven);
  visit("fractional", "", "whether an order is not whole", result.fractional);
  visit("model", "", "formula with its numbers", result.model);
}

[[nodiscard]] std::span<const double> economy_errors();

template <ResultOf<EconomyCurve> Result, class Visit>
void describe(Result& result, const Visit& visit) {
  std::vector<std::optional<std::size_t>> needs;
  for (const double error : economy_errors()) {
    const auto* const point = result.within(error);
    needs.push_back(point ? std::optional(point->parameters) : std::nullopt);
  }
  visit("name", "", "name of the class, or of the given curve", result.name);
  visit("class", "", "class of models", result.model_class);
  visit("description", "", "class in words", description(result.model_class));
  visit("needs", "1", "fewest parameters for each of the errors; none where no number suffices", needs);
  visit("points", "", "least errors by number of parameters, see economy-point", result.points);
}

template <ResultOf<Economy> Result, class Visit>
void describe(Result& result, const Visit& visit) {
  visit("component", "", "part of the response: imaginary, real or both", result.component);
  visit("most_parameters", "1", "as many as were asked for, or as the data can tell, less one", result.most_parameters);
  visit("rounding", "1", "errors below it are rounding", result.rounding);
  visit("errors", "1", "errors that the needs of the curves are about", economy_errors());
  visit("verdict", "", "fractional-cheaper, integer-cheaper, equal, depends-on-error or neither", result.verdict);
  visit("sentence", "", "the verdict in words", result.sentence);
  visit("curves", "", "one for each class and one for each curve given, see economy-curve", result.curves);
}

}  // namespace frac
