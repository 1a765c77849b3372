// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "frac/describe.hpp"

namespace frac {

struct Crossover;
struct DerivedEstimate;
struct DistributionRival;
struct Economy;
struct EconomyCurve;
struct EconomyPoint;
struct Finalist;
struct FeasibleNearby;
struct FitResult;
struct IdentificationResult;
struct JointCurveResult;
struct JointFitResult;
struct LackOfFit;
struct NextMeasurement;
struct ParameterEstimate;
struct PowerLaw;
struct PriorEstimate;
struct RankedFit;
struct ReachedSpecification;
struct RobustTuningResult;
struct TimesDistribution;
struct TimesLine;
struct TimesPeak;
struct TuningResult;
struct ValidationResult;
struct ValidityFinding;

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
  visit("relative_rms", "1", "rms over that of the data, both parts, under the same weights", result.relative_rms);
  visit("gain_factor", "1", "factor that undoes the bias of relative weight by noise in its divisor",
        result.gain_factor);
  visit("max_residual", "residual", "largest residual", result.max_residual);
  visit("aicc", "1", "Akaike's criterion, corrected for few residuals", result.aicc);
  visit("bic", "1", "Schwarz's criterion", result.bic);
  visit("termination", "", "converged, not-converged or no-usable-start", result.termination);
  visit("message", "", "what became of the search", result.message);
  visit({"residuals", "residual_count"}, "1", "number of residuals", result.residuals);
  visit("free_parameters", "1", "number of free parameters", result.free_parameters);
  visit("starts", "1", "local searches", result.starts);
  visit("starts_at_best", "1", "searches that ended at the least cost", result.starts_at_best);
  visit("distinct_minima", "1", "different ends of the seeded starts", result.distinct_minima);
  visit("confidence_of_optimum", "1", "probability that no start would have ended lower", result.confidence_of_optimum);
  visit("condition", "1", "condition of the scaled Fisher matrix", result.condition);
  visit("noise_correlation", "1", "correlation of neighbouring values of the noise, which intervals allow for",
        result.noise_correlation);
  visit("smooth_error", "residual", "smooth part of the residuals, which intervals allow for", result.smooth_error);
  visit("noise_floor", "value", "floor of weight learned, below which the noise is additive; 0 without one",
        result.noise_floor);
  visit("seconds", "s", "time that the fit took", result.seconds);
  visit("centre_omega", "rad/s", "geometric middle of the band", result.centre_omega);
  visit("loss_cost", "residual^2", "sum of the robust loss, what was made least", result.loss_cost);
  visit("loss_scale", "residual", "residual at which the loss turns from quadratic to robust", result.loss_scale);
  visit("loss_unit", "residual^2", "rise of loss_cost by a parameter without meaning", result.loss_unit);
  visit("effective_parameters", "1", "free parameters but for what priors tell", result.effective_parameters);
  visit("without_noise", "", "whether the data carry no noise, where intervals and criteria mean nothing",
        result.without_noise);
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
  visit("without_noise", "", "whether the data carry no noise, where intervals and chances mean nothing",
        result.without_noise);
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

template <ResultOf<DistributionRival> Result, class Visit>
void describe(Result& result, const Visit& visit) {
  visit("model", "", "lags with distributed times, in words", result.model);
  visit("parameters", "1", "number of parameters adjusted to the data", result.parameters);
  visit("relative_rms", "1", "rms of the weighted residuals over that of the data", result.relative_rms);
  visit("evidence", "1", "evidence of the fractional finalist against it", result.evidence);
}

template <ResultOf<IdentificationResult> Result, class Visit>
void describe(Result& result, const Visit& visit) {
  visit("ranking", "", "candidates, best first, see candidate", result.ranking);
  visit("skipped", "", "candidates that could not be fitted, with the reason", result.skipped);
  visit("verdict", "", "supported, fractional-or-distribution, not-supported, undecided or no-adequate-model",
        result.verdict);
  visit("evidence", "1", "twice the logarithm of the odds of fractional to integer order, by these data",
        result.evidence);
  visit("departure_evidence", "1", "evidence for an order at least 0.1 from every whole number that shows in the data",
        result.departure_evidence);
  visit("evidence_beside_smooth_error", "1", "evidence where the data may hold a smooth error of usual size",
        result.evidence_beside_smooth_error);
  visit("departure_beside_smooth_error", "1", "departure evidence where the data may hold such an error",
        result.departure_beside_smooth_error);
  visit("verdict_sentence", "", "the verdict in words", result.verdict_sentence);
  visit("notes", "", "what else is to be known of verdict and choice, a sentence each", result.notes);
  visit("log10_odds", "1",
        "decimal logarithm of the odds of fractional to integer order; both may be far from the truth",
        result.log10_odds);
  visit("model_error", "", "whether no candidate follows the data to within their noise", result.model_error);
  visit("noise_correlation", "1",
        "over time, correlation of neighbouring values of the noise that all candidates were fitted with",
        result.noise_correlation);
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

template <ResultOf<ValidityFinding> Result, class Visit>
void describe(Result& result, const Visit& visit) {
  visit("test", "", "what was tested", result.test);
  visit("p_value", "1", "chance of as much by noise alone; none where the test does not apply", result.p_value);
  visit("alarm", "", "whether the test speaks against the data", result.alarm);
}

template <ResultOf<ValidationResult> Result, class Visit>
void describe(Result& result, const Visit& visit) {
  visit("validity", "", "valid, suspect, invalid or undecided", result.validity);
  visit("level", "1", "chance that data without a fault are not called valid", result.level);
  visit("accuracy", "1", "share of the response within which departures are no fault", result.accuracy);
  visit("tolerance", "1", "share of the response within which significant departures do not matter", result.tolerance);
  visit("findings", "", "one for each test, see finding", result.findings);
  visit("departs", "", "whether the points as a whole depart by more than noise explains", result.departs);
  visit("consistent_to", "1", "how far they may depart, share of the response, noise included", result.consistent_to);
  visit("largest_residual", "1", "largest residual of the judged points, share of the model", result.largest_residual);
  visit("every", "1", "one point in so many was judged", result.every);
  visit("real_poles", "1", "real poles of the consistent model", result.real_poles);
  visit("pole_pairs", "1", "pairs of poles of the consistent model", result.pole_pairs);
  visit("dead_time", "s", "dead time of the consistent model; 0 where none is needed", result.dead_time);
  visit("model", "value", "consistent model at each point; none where a point was not judged or set aside",
        result.model);
  visit("deviation", "value", "standard deviation of the noise of real and imaginary part each, at each point",
        result.deviation);
  visit("noise", "1", "noise over the model, root mean square over the points", result.noise);
  visit("noise_floor", "1", "additive part of the noise relative to the model; 0 without one", result.noise_floor);
  visit("noise_slope", "1", "slope of ln noise over ln omega beside the floor; 0 where none is clear",
        result.noise_slope);
  visit("correlation", "1", "correlation of neighbouring residuals, less what white noise would show",
        result.correlation);
  visit("drift", "1", "change of the response during the sweep, share of its size, towards low frequencies",
        result.drift);
  visit("drift_deviation", "1", "standard deviation of the drift", result.drift_deviation);
  visit("drift_law", "", "drift-even or drift-periods: how long each point is taken to last", result.drift_law);
  visit("drift_explains", "", "whether no residuals follow each other without the drift", result.drift_explains);
  visit("detectable_drift", "1", "drift that is found in nine of ten such measurements", result.detectable_drift);
  visit("step", "1", "change of the response between two points, share of its size, upwards", result.step);
  visit("step_deviation", "1", "standard deviation of the step", result.step_deviation);
  visit("step_below", "rad/s", "point below the step", result.step_below);
  visit("step_above", "rad/s", "point above the step", result.step_above);
  visit("step_explains", "", "whether no residuals follow each other without the step", result.step_explains);
  visit("drift_share", "1", "share of the squared residuals that goes with the drift", result.drift_share);
  visit("step_share", "1", "share of the squared residuals that goes with the step", result.step_share);
  visit("reversed_sign", "", "whether the points are consistent with imaginary parts reversed", result.reversed_sign);
  visit("freedom", "1", "residuals less parameters", result.freedom);
  visit("outliers", "", "indices of the points that are outliers", result.outliers);
  visit("mains", "", "indices of the points at a mains frequency that speaks against the data", result.mains);
  visit("frequency_unit", "", "unit in which the summary gives frequencies", result.frequency_unit);
}

template <class Result, class Visit>
requires ResultOf<Result, TimesLine> || ResultOf<Result, TimesPeak>
void describe(Result& result, const Visit& visit) {
  visit("tau", "s", "relaxation time", result.tau);
  visit("area", "value", "strength of the line, or area of the peak between its minima", result.area);
  visit("tau_ci95", "s", "interval of 95 %", NumberPair("tau_lower", result.tau_lower, "tau_upper", result.tau_upper));
  visit("area_ci95", "value", "interval of 95 %",
        NumberPair("area_lower", result.area_lower, "area_upper", result.area_upper));
}

template <ResultOf<TimesDistribution> Result, class Visit>
void describe(Result& result, const Visit& visit) {
  visit("kernel", "", "falling or rising: what a relaxation time contributes", result.kernel);
  visit("tau", "s", "relaxation times, rising", result.tau);
  visit("density", "value", "density per e-fold of the relaxation time", result.density);
  visit("lower", "value", "lower end of the range of 95 % of the density; empty where unknown", result.lower);
  visit("upper", "value", "upper end of the range of 95 % of the density; empty where unknown", result.upper);
  visit("lines", "", "relaxation times of their own, see relaxation-time", result.lines);
  visit("peaks", "", "maxima of the density, see relaxation-time", result.peaks);
  visit("lines_left_off", "1", "lines of a series, shorter than those listed", result.lines_left_off);
  visit("constant", "value", "constant beside the density; none of a formula", result.constant);
  visit("constant_ci95", "value", "interval of 95 % of it",
        NumberPair("constant_lower", result.constant_lower, "constant_upper", result.constant_upper));
  visit("inductance", "value s", "coefficient of s beside the density; none of a formula", result.inductance);
  visit("inductance_ci95", "value s", "interval of 95 % of it",
        NumberPair("inductance_lower", result.inductance_lower, "inductance_upper", result.inductance_upper));
  visit("elastance", "value/s", "coefficient of 1/s beside the density; none of a formula", result.elastance);
  visit("elastance_ci95", "value/s", "interval of 95 % of it",
        NumberPair("elastance_lower", result.elastance_lower, "elastance_upper", result.elastance_upper));
  visit("smoothness", "1", "weight of the roughness; none of a formula", result.smoothness);
  visit("misfit", "1", "rms of what the distribution leaves of the data, relative to them; none of a formula",
        result.misfit);
  visit("misfit_in_noise", "1", "rms of what it leaves, in standard deviations of the noise; none of a formula",
        result.misfit_in_noise);
}

template <ResultOf<PowerLaw> Result, class Visit>
void describe(Result& result, const Visit& visit) {
  visit("coefficient", "", "factor of the power", result.coefficient);
  visit("exponent", "1", "exponent of the power", result.exponent);
  visit("coefficient_ci95", "", "interval of 95 %",
        NumberPair("coefficient_ci95_lower", result.coefficient_ci95_lower, "coefficient_ci95_upper",
                   result.coefficient_ci95_upper));
  visit("exponent_standard_error", "1", "standard error of the exponent", result.exponent_standard_error);
  visit(
      "exponent_ci95", "1", "interval of 95 %",
      NumberPair("exponent_ci95_lower", result.exponent_ci95_lower, "exponent_ci95_upper", result.exponent_ci95_upper));
  visit("r_squared", "1", "share of the variance of the logarithm that the law explains", result.r_squared);
  visit("rms_log_residual", "1", "root mean square of the residuals of the logarithm", result.rms_log_residual);
}

template <ResultOf<ReachedSpecification> Result, class Visit>
void describe(Result& result, const Visit& visit) {
  visit("name", "", "what was asked for", result.name);
  visit("asked", "", "value asked for", result.asked);
  visit("reached", "", "value reached", result.reached);
  visit("met", "", "whether it is kept", result.met);
}

template <ResultOf<Crossover> Result, class Visit>
void describe(Result& result, const Visit& visit) {
  visit("omega", "rad/s", "where the loop crosses", result.omega);
  visit("margin", "", "factor or angle (rad) that is left there", result.margin);
}

template <ResultOf<FeasibleNearby> Result, class Visit>
void describe(Result& result, const Visit& visit) {
  visit("phase_margin", "rad", "nearest margin within reach at the crossover asked for", result.phase_margin);
  visit("lower_crossover", "rad/s", "nearest crossover below, at the margin asked for", result.lower_crossover);
  visit("higher_crossover", "rad/s", "nearest crossover above, at the margin asked for", result.higher_crossover);
}

template <ResultOf<TuningResult> Result, class Visit>
void describe(Result& result, const Visit& visit) {
  visit("kp", "", "proportional gain", result.gains.kp);
  visit("ki", "", "integral gain", result.gains.ki);
  visit("kd", "", "derivative gain", result.gains.kd);
  visit({"lambda", "lambda_"}, "1", "order of integration", result.gains.lambda);
  visit("mu", "1", "order of differentiation", result.gains.mu);
  visit("derivative_filter_time", "s", "time of the derivative's filter, as given", result.derivative_filter_time);
  visit("status", "", "met or not-met", result.status);
  visit("message", "", "what became of the search", result.message);
  visit("mu_limit", "1", "order of differentiation with which the loop still falls at high frequency", result.mu_limit);
  visit("mu_at_limit", "", "whether that limit holds back the order of differentiation", result.mu_at_limit);
  visit("specification", "", "what was asked for and reached, see specification", result.specification);
  visit("nearby", "", "what is within reach where the crossover or margin asked for is not", result.nearby);
  visit("closed_loop", "", "stability of the closed loop", result.closed_loop);
  visit("crossover", "rad/s", "where the loop has the gain 1, nearest to what was asked; none: nowhere",
        result.crossover);
  visit("phase_margin", "rad", "phase margin at the crossover", result.phase_margin);
  visit("other_crossovers", "", "further crossovers, see crossover", result.other_crossovers);
  visit("phase_slope", "rad", "slope of the phase at the crossover, per e-fold", result.phase_slope);
  visit("gain_margin", "1", "smallest factor above 1 that makes the loop unstable", result.gain_margin);
  visit("max_sensitivity", "1", "largest |S| over all frequencies", result.max_sensitivity);
  visit("omega_max_sensitivity", "rad/s", "where |S| is largest", result.omega_max_sensitivity);
  visit("max_complementary_sensitivity", "1", "largest |T| over all frequencies", result.max_complementary_sensitivity);
  visit("omega_max_complementary_sensitivity", "rad/s", "where |T| is largest",
        result.omega_max_complementary_sensitivity);
  visit("iae", "s", "integral of the modulus of the error after a step", result.iae);
  visit("itae", "s^2", "integral of that times the time", result.itae);
  visit("evaluations", "1", "controllers that were tried", result.evaluations);
}

template <ResultOf<RobustTuningResult> Result, class Visit>
void describe(Result& result, const Visit& visit) {
  visit("nominal", "", "controller, and what the fitted plant makes of it, see tuning", result.nominal);
  visit("status", "", "met or not-met, over all plants of the region", result.status);
  visit("message", "", "what became of the search", result.message);
  visit("plants", "1", "plants of the region that were looked at", result.plants);
  visit("not_stable", "1", "plants of the region whose loop is not stable", result.not_stable);
  visit("max_sensitivity", "1", "largest |S| over the region", result.max_sensitivity);
  visit("max_complementary_sensitivity", "1", "largest |T| over the region", result.max_complementary_sensitivity);
  visit("least_phase_margin", "rad", "least phase margin over the region", result.least_phase_margin);
  visit("lowest_crossover", "rad/s", "lowest crossover over the region", result.lowest_crossover);
  visit("highest_crossover", "rad/s", "highest crossover over the region", result.highest_crossover);
}

}  // namespace frac
