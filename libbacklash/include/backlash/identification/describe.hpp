// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "frac/describe.hpp"

namespace backlash {

struct BodiesIdentification;
struct ExplanationFit;
struct ForceLaw;
struct JumpConstant;
struct JumpLaw;
struct JumpPoint;
struct RivalScene;
struct SceneComparison;
struct SceneEstimate;
struct SceneIdentification;
struct ScenePoint;

// Descriptions of what is identified from measured describing functions, see frac/describe.hpp.

template <frac::ResultOf<SceneEstimate> Result, class Visit>
void describe(Result& result, const Visit& visit) {
  visit("name", "", "name of a parameter or of a combination of them", result.name);
  visit("unit", "", "unit of its value", result.unit);
  visit("value", "parameter", "estimate", result.value);
  visit("standard_error", "parameter",
        "standard error: 0 where fixed, none at a bound or where no value is better than another",
        result.standard_error);
  visit("ci95", "parameter", "interval of 95 %, over the values of rivals too",
        frac::NumberPair("ci95_lower", result.ci95_lower, "ci95_upper", result.ci95_upper));
  visit("identified", "", "whether the data tell the parameter", result.identified);
  visit("at_bound", "", "whether the estimate lies at a limit", result.at_bound);
  visit("fixed", "", "whether it was held and not estimated", result.fixed);
}

template <frac::ResultOf<RivalScene> Result, class Visit>
void describe(Result& result, const Visit& visit) {
  visit("mass1", "kg", "mass 1 of a scene that explains the data nearly as well", result.parameters[0]);
  visit("mass2", "kg", "mass 2", result.parameters[1]);
  visit("clearance", "m", "clearance", result.parameters[2]);
  visit("restitution", "1", "coefficient of restitution", result.parameters[3]);
  visit("contact_time", "s", "time of a free contact, 0 of hard ones", result.contact_time);
  visit("friction1", "N", "dry friction of mass 1", result.friction[0]);
  visit("friction2", "N", "dry friction of mass 2", result.friction[1]);
  visit("odds_against", "1", "evidence of the estimate over that of this scene", result.odds);
}

template <frac::ResultOf<ScenePoint> Result, class Visit>
void describe(Result& result, const Visit& visit) {
  visit("curve", "1", "index of the curve", result.curve);
  visit("omega_rad_s", "rad/s", "angular frequency", result.omega);
  visit("status", "", "used, off-branch or irregular", result.status);
  visit("regime", "", "regime of the steady motion that the point is compared with", result.regime);
  visit("model_re_m_per_n", "m/N", "real part of N of the estimate", result.model.real());
  visit("model_im_m_per_n", "m/N", "imaginary part of N of the estimate", result.model.imag());
  visit("residual_re", "1", "real part of the weighted residual", result.residual.real());
  visit("residual_im", "1", "imaginary part of the weighted residual", result.residual.imag());
}

template <class Result, class Visit>
requires frac::ResultOf<Result, SceneIdentification> || frac::ResultOf<Result, BodiesIdentification>
void describe(Result& result, const Visit& visit) {
  constexpr bool of_two_masses = frac::ResultOf<Result, SceneIdentification>;
  visit("parameters", "", "masses, clearance and restitution, see scene-estimate", result.parameters);
  if constexpr (of_two_masses) {
    visit("combinations", "", "combinations of parameters that x1 tells, see scene-estimate", result.combinations);
    visit("contact", "", "time, stiffness, damping and restitution of a free contact, see scene-estimate",
          result.contact);
    visit("contact_verdict", "",
          "compliant where the data tell contacts from hard ones, else undecided; hard where that was asked for",
          result.contact_verdict);
    visit("contact_evidence", "1",
          "twice the logarithm of the likelihood ratio of contacts that take time over hard ones",
          result.contact_evidence);
    visit("friction", "", "friction1 and friction2, see scene-estimate; empty of a scene without", result.friction);
    visit("friction_verdict", "",
          "present where the data tell friction from none, else undecided; none where that was asked for",
          result.friction_verdict);
    visit("friction_evidence", "1",
          "twice the logarithm of the likelihood ratio of scenes with friction over those without",
          result.friction_evidence);
    visit("free_directions", "", "what the data leave free, a sentence each", result.free_directions);
  }
  visit("misfits", "", "how the data contradict the scene, a sentence each", result.misfits);
  visit("residual_correlation", "1", "correlation of neighbouring residuals; 0 where it may be chance",
        result.residual_correlation);
  if constexpr (of_two_masses)
    visit("rivals", "", "other scenes that explain the data nearly as well, see rival-scene", result.rivals);
  visit("cost", "1", "sum of squared residuals of the points used", result.cost);
  visit("rms", "1", "root mean square of the residuals", result.rms);
  visit("max_residual", "1", "largest part of a residual", result.max_residual);
  visit("termination", "", "converged, not-converged or no-usable-start", result.termination);
  visit("message", "", "what became of the search", result.message);
  visit("residuals", "1", "number of residuals", result.residuals);
  visit("free_parameters", "1", "number of parameters that the data determine", result.free_parameters);
  visit("condition", "1", "condition of the scaled Fisher matrix", result.condition);
  visit("starts", "1", "local searches", result.starts);
  visit("starts_at_best", "1", "searches that ended at the same estimate", result.starts_at_best);
  visit("seconds", "s", "time that the search took", result.seconds);
  visit("points_used", "1", "number of points used", result.points_used);
  visit("points", "", "points of all curves, see scene-point", result.points);
  visit("covariance", "", "covariance of the parameters, row by row", result.covariance);
}

template <frac::ResultOf<ExplanationFit> Result, class Visit>
void describe(Result& result, const Visit& visit) {
  visit("explanation", "", "what explains the data", result.explanation);
  visit("name", "", "name of the structure", result.name);
  visit("cost", "1", "sum of squared residuals over all curves", result.cost);
  visit("rms", "1", "root mean square of the residuals", result.rms);
  visit("free_parameters", "1", "number of free parameters over all curves", result.free_parameters);
  visit("aicc", "1", "Akaike's criterion, corrected for few residuals", result.aicc);
  visit("delta_aicc", "1", "aicc above the least", result.delta_aicc);
}

template <frac::ResultOf<SceneComparison> Result, class Visit>
void describe(Result& result, const Visit& visit) {
  visit("ranking", "", "the best of each explanation, best first, see explanation", result.ranking);
  visit("points", "1", "number of points compared, the same for all", result.points);
  visit("residuals", "1", "number of residuals", result.residuals);
  visit("skipped", "", "what could not be compared, with the reason", result.skipped);
  visit("sentence", "", "which explanation the data support", result.sentence);
}

template <frac::ResultOf<JumpPoint> Result, class Visit>
void describe(Result& result, const Visit& visit) {
  visit("force", "N", "force amplitude", result.force);
  visit("clearance", "m", "clearance", result.clearance);
  visit("restitution", "1", "coefficient of restitution", result.restitution);
  visit("omega_jump", "rad/s", "jump frequency; none where the criterion gives none", result.omega_jump);
}

template <frac::ResultOf<JumpConstant> Result, class Visit>
void describe(Result& result, const Visit& visit) {
  visit("restitution", "1", "coefficient of restitution", result.restitution);
  visit("similarity_constant", "1", "jump frequency over sqrt(F/(M2 Delta)); none where there is no jump",
        result.similarity_constant);
  visit("message", "", "what happens at the jump, or why there is none", result.message);
}

template <frac::ResultOf<ForceLaw> Result, class Visit>
void describe(Result& result, const Visit& visit) {
  visit("clearance", "m", "clearance", result.clearance);
  visit("law", "", "jump frequency over force, a power law", result.law);
}

template <frac::ResultOf<JumpLaw> Result, class Visit>
void describe(Result& result, const Visit& visit) {
  visit("criterion", "", "what counts as the jump", result.criterion);
  visit("points", "", "jump frequencies of the scenes, see jump-point", result.points);
  visit("constants", "", "similarity constants over restitution, see jump-constant", result.constants);
  visit("mean_similarity_constant", "1", "mean of the similarity constant", result.mean_similarity_constant);
  visit("message", "", "why there is no law; empty where there is one", result.message);
  visit("laws", "", "power law of the force at each clearance, see force-law", result.laws);
  visit("a_of_clearance", "", "coefficient of these laws as a power law of the clearance", result.a_of_clearance);
  visit("b_of_clearance", "", "exponent of these laws as a power law of the clearance", result.b_of_clearance);
}

}  // namespace backlash
