// SPDX-License-Identifier: BSD-3-Clause
#include "frac/identification/model_choice.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>

#include "base/short_text.hpp"
#include "frac/identification/constraints.hpp"
#include "identification/data/fit_data.hpp"
#include "identification/rational/family_members.hpp"
#include "identification/rational/rational_growth.hpp"
#include "identification/statistics/autocorrelation.hpp"
#include "identification/statistics/curvature_fit.hpp"
#include "identification/time_noise.hpp"
#include "special/distributions.hpp"

namespace frac {

namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();

// rms of the weighted residuals a fit to the other points leaves at each block.
template <class Data, class Options>
double rms_of_predictions(const Data& data, const Structure& structure, const Options& options, std::size_t folds) {
  const std::size_t points = detail::points(data);
  if (folds < 2 || folds > points) {
    throw std::invalid_argument("cross_validation: " + std::to_string(folds) +
                                " folds; allowed are 2 to the number of points, " + std::to_string(points));
  }
  const std::size_t per_point = detail::residuals_per_point(data, options);
  double square = 0;
  for (std::size_t fold = 0; fold < folds; ++fold) {
    const std::size_t first = fold * points / folds, last = (fold + 1) * points / folds;
    const FitResult result = detail::curvature_fit(detail::part_of(data, first, last, false), structure, options);
    if (result.termination == FitTermination::no_usable_start) return infinity;
    const std::vector<double> residual = detail::weighted_residuals(data, options, result);
    for (std::size_t i = first * per_point; i < last * per_point; ++i) square += residual[i] * residual[i];
  }
  if (!std::isfinite(square)) return infinity;
  return std::sqrt(square / static_cast<double>(points * per_point));
}

/// What speaks against a structure with one term more; empty where nothing does.
/// @param gain  by which it lowers AICc, in the measure of identify()
std::string reason_against(const FitResult& simple, const FitResult& full, double gain) {
  char text[160];
  if (full.termination != FitTermination::converged) return "With another term the solver did not settle.";
  if (!(gain > 2)) {
    std::snprintf(text, sizeof text, "Another term does not pay: it %s AICc by %.2g, where it must lower it by 2.",
                  gain < 0 ? "raises" : "lowers", std::abs(gain));
    return text;
  }
  const double chance = f_test(simple, full).p_value;
  if (!(chance < 0.01)) {
    std::snprintf(text, sizeof text, "Another term may be noise: so large an improvement has a chance of %.2g.",
                  chance);
    return text;
  }
  // A term that pays so clearly is there, even if its part cannot be told exactly from the others'.
  constexpr double clear_gain = 10;
  if (gain > clear_gain) return {};
  std::string unknown;
  for (const ParameterEstimate& estimate : full.parameters) {
    // One at its bound is told by the bound.
    if (!estimate.identified && !estimate.at_bound) unknown += (unknown.empty() ? "" : ", ") + estimate.name;
  }
  if (unknown.empty()) return {};
  std::snprintf(text, sizeof text,
                "Another term lowers AICc by %.3g, but the data do not tell its part from the others: ", gain);
  return text + unknown + " would not be identified.";
}

/// The constraints of a member with those of the caller over them, as far as it has the parameters.
std::vector<ParameterConstraint> merged(const NamedModel& model, const Structure& structure,
                                        const std::vector<ParameterConstraint>& given) {
  std::vector<ParameterConstraint> result = model.constraints;
  for (const ParameterConstraint& constraint : given) {
    const auto& names = structure.parameter_names();
    if (std::find(names.begin(), names.end(), constraint.name) == names.end()) continue;
    ParameterConstraint& own = constraint_of(result, constraint.name);
    if (constraint.fixed) {
      own = constraint;
      continue;
    }
    if (constraint.lower) own.lower = constraint.lower;
    if (constraint.upper) own.upper = constraint.upper;
    own.start = constraint.start;
  }
  return result;
}

void check_names(GrowthFamily family, std::size_t most_terms, const std::vector<ParameterConstraint>& given) {
  const Structure largest(grown_model(family, most_terms).formula);
  for (const ParameterConstraint& constraint : given) static_cast<void>(largest.parameter_index(constraint.name));
}

/// The fit of a member, from starts of its own and from the optimum of the smaller one with little of the new term, so
/// that it never ends above that.
template <class Data, class Options>
FitResult fit_of_member(const Data& data, const Structure& structure, const Options& options,
                        const FitResult* smaller) {
  FitResult best = fit(data, structure, options);
  if (!smaller || !(best.cost > smaller->cost)) return best;
  Options started = detail::started_at(options, *smaller);
  for (std::size_t i = 0; i < structure.parameter_names().size(); ++i) {
    ParameterConstraint& own = constraint_of(started.constraints, structure.parameter_names()[i]);
    if (own.fixed || own.start) continue;
    // Little of any dimension: the member before is the limit of small gains.
    const double gain = 1e-3 * best.rms / (1 + best.rms);
    own.start = structure.parameter_roles()[i] == ParameterRole::order ? 0.7 : gain;
  }
  FitResult from_smaller = fit(data, structure, started);
  return from_smaller.cost < best.cost ? from_smaller : best;
}

template <class Data, class Options>
Growth grown(const Data& data, GrowthFamily family, const Options& options, std::size_t most_terms) {
  const std::string enough = "The structure has as many terms as were allowed.";
  check_names(family, most_terms, options.constraints);
  Growth growth{{}, {}, 0, enough};
  const std::size_t residuals = detail::points(data) * detail::residuals_per_point(data, options);
  for (std::size_t terms = 1; terms <= most_terms; ++terms) {
    NamedModel model = grown_model(family, terms);
    const Structure structure(model.formula);
    if (terms > 1 && structure.parameter_names().size() >= residuals) {
      growth.reason = "Another term would have as many parameters as there are residuals.";
      break;
    }
    Options of_model = options;
    of_model.constraints = model.constraints = merged(model, structure, options.constraints);
    growth.fits.push_back(
        fit_of_member(data, structure, of_model, terms > 1 ? &growth.fits.at(growth.chosen) : nullptr));
    growth.models.push_back(std::move(model));
    if (terms == 1) continue;
    const FitResult& simple = growth.fits[growth.chosen];
    const FitResult& full = growth.fits.back();
    const double correlation =
        full.termination == FitTermination::converged ? residual_whiteness(data, options, full).lag_one_correlation : 0;
    const double gain = (simple.aicc - full.aicc) * detail::independent_share(correlation);
    growth.reason = reason_against(simple, full, gain);
    if (!growth.reason.empty()) break;
    growth.reason = enough;
    growth.chosen = growth.fits.size() - 1;
  }
  return growth;
}

/// The family of models whose form follows from data, see resolved_model(); none for those that are grown term by term.
std::optional<NamedModel> family_from_data(GrowthFamily family) {
  switch (family) {
    case GrowthFamily::rational:
    case GrowthFamily::commensurate:
    case GrowthFamily::terms:
    case GrowthFamily::elements:
      return find_model(to_string(family));
    default:
      return std::nullopt;
  }
}

template <class Data, class Options>
Growth grown_from_data(const Data& data, const NamedModel& family, const Options& options) {
  if (!options.constraints.empty()) {
    throw std::invalid_argument("grow: parameters of the family " + family.name +
                                " differ from member to member, so none can be held or bounded");
  }
  detail::RatioGrowths ratios;
  const detail::FamilyMembers members = detail::family_members(data, family, options, ratios);
  Growth growth{{}, members.models, members.chosen, ""};
  for (std::size_t i = 0; i < members.models.size(); ++i) {
    Options of_model = options;
    of_model.constraints = members.models[i].constraints;
    of_model.global_start = false;
    const Structure structure(members.models[i].formula);
    growth.fits.push_back(i == members.chosen ? fit(data, structure, of_model)
                                              : detail::curvature_fit(data, structure, of_model));
    if (!members.models[i].remark.empty()) growth.fits.back().message += " " + members.models[i].remark;
  }
  growth.reason = members.chosen + 1 < members.models.size()
                      ? "Further growth does not pay: BIC, with the search paid for, rises."
                      : "The model has grown as far as was allowed, or meets the data to rounding.";
  if (members.passive && !members.exact) {
    growth.reason =
        "Neither a further element nor another kind in the place of one pays: BIC, with the search paid for, rises.";
  }
  return growth;
}

}  // namespace

ResidualWhiteness residual_whiteness(const FrequencyResponseData& data, const FitOptions& options,
                                     const FitResult& result) {
  return detail::whiteness(detail::weighted_residuals(data, options, result),
                           detail::residuals_per_point(data, options));
}

ResidualWhiteness residual_whiteness(const TimeResponseData& data, const TimeFitOptions& options,
                                     const FitResult& result) {
  return detail::whiteness(detail::weighted_residuals(data, options, result), 1);
}

FTest f_test(const FitResult& simple, const FitResult& full) {
  if (full.free_parameters <= simple.free_parameters) {
    throw std::invalid_argument("f_test: the full structure has " + std::to_string(full.free_parameters) +
                                " free parameters, the simple one " + std::to_string(simple.free_parameters) +
                                "; it must have more");
  }
  if (full.residuals <= full.free_parameters) throw std::invalid_argument("f_test: no degree of freedom is left");
  const auto extra = static_cast<double>(full.free_parameters - simple.free_parameters);
  const auto degrees = static_cast<double>(full.residuals - full.free_parameters);
  if (!(simple.cost > full.cost)) return {0, 1};
  const double statistic = (simple.cost - full.cost) / extra / (full.cost / degrees);
  if (!std::isfinite(statistic)) return {infinity, 0};
  return {statistic, detail::fisher_f_above(statistic, extra, degrees)};
}

double cross_validation(const FrequencyResponseData& data, const Structure& structure, const FitOptions& options,
                        std::size_t folds) {
  return rms_of_predictions(data, structure, options, folds);
}

double cross_validation(const TimeResponseData& data, const Structure& structure, const TimeFitOptions& options,
                        std::size_t folds) {
  if (!detail::noise_is_open(options)) return rms_of_predictions(data, structure, options, folds);
  const double r = fit(data, structure, options).noise_correlation;
  return rms_of_predictions(data, structure, detail::in_noise(options, r), folds);
}

bool names_persist(GrowthFamily family) {
  return !family_from_data(family);
}

NamedModel grown_model(GrowthFamily family, std::size_t terms) {
  std::string formula;
  NamedModel model{"", "", ModelClass::fractional, "", {}};
  for (std::size_t i = 1; i <= terms; ++i) {
    const std::string n = std::to_string(i);
    switch (family) {
      case GrowthFamily::powers:
        formula += (i > 1 ? " + " : "") + ("K" + n) + " s^a" + n;
        model.constraints.push_back({"K" + n, {}, -infinity, {}, {}});
        model.constraints.push_back({"a" + n, {}, -4, 4, {}});
        break;
      case GrowthFamily::denominator:
        formula += " + b" + n + " s^a" + n;
        break;
      case GrowthFamily::arcs:
        formula += " + R" + n + "/(1 + R" + n + " Q" + n + " s^n" + n + ")";
        model.constraints.push_back({"n" + n, {}, 0, 1, {}});
        break;
      default:
        throw std::invalid_argument("grown_model: the form of a model of the family " + std::string(to_string(family)) +
                                    " follows from data, see resolved_model()");
    }
  }
  if (family == GrowthFamily::denominator) formula = "1/(b0" + formula + ")";
  if (family == GrowthFamily::arcs) {
    formula = "R0" + formula;
    ParameterConstraint series{"R0", {}, {}, {}, {}};
    series.positive = true;
    model.constraints.push_back(series);
  }
  model.name = model.formula = formula;
  return model;
}

Growth grow(const FrequencyResponseData& data, GrowthFamily family, const FitOptions& options, std::size_t most_terms) {
  if (options.weight == Weight::learned && !options.noise_floor) {
    FitOptions weighted = options;
    weighted.noise_floor = 0;
    Growth growth = grow(data, family, weighted, most_terms);
    FitOptions telling = options;
    telling.constraints = growth.models[growth.chosen].constraints;
    const FitResult& chosen = growth.fits[growth.chosen];
    weighted.noise_floor = fit(data, Structure(chosen.model), detail::started_at(telling, chosen)).noise_floor;
    return *weighted.noise_floor > 0 ? grow(data, family, weighted, most_terms) : growth;
  }
  const auto from_data = family_from_data(family);
  if (!from_data) return grown(data, family, options, most_terms);
  Growth growth = grown_from_data(data, *from_data, options);
  if (family != GrowthFamily::elements) return growth;
  const std::optional<double> least = detail::least_rms_of_relaxations(data, options);
  if (least && *least < growth.fits.at(growth.chosen).rms) {
    growth.reason.back() = ';';
    growth.reason += " no sum of passive elements without resonance, however many, comes below rms " +
                     detail::short_text(*least) + ".";
  }
  return growth;
}

Growth grow(const TimeResponseData& data, GrowthFamily family, const TimeFitOptions& options, std::size_t most_terms) {
  if (detail::noise_is_open(options)) {
    return detail::made_in_likely_noise(
        data, options, [&](const TimeFitOptions& told) { return grow(data, family, told, most_terms); },
        [](Growth& made) -> FitResult& { return made.fits.at(made.chosen); },
        [](const Growth& made, TimeFitOptions told) {
          told.constraints = made.models.at(made.chosen).constraints;
          return told;
        });
  }
  if (const auto from_data = family_from_data(family)) return grown_from_data(data, *from_data, options);
  return grown(data, family, options, most_terms);
}

ResidualWhiteness detail::whiteness(std::span<const double> residual, std::size_t stride) {
  const std::size_t points = residual.size() / stride;
  ResidualWhiteness result{autocorrelation(residual, stride, 1), nan};
  if (points < 10) return result;
  const std::size_t lags = std::min<std::size_t>(10, points / 5);
  // Pooled over the parts, a correlation of white residuals has the variance 1/(stride n).
  const auto n = static_cast<double>(points);
  double statistic = 0;
  for (std::size_t lag = 1; lag <= lags; ++lag) {
    const double correlation = autocorrelation(residual, stride, lag);
    statistic += static_cast<double>(stride) * n * (n + 2) * correlation * correlation / (n - static_cast<double>(lag));
  }
  result.p_value = detail::chi_squared_above(statistic, static_cast<double>(lags));
  return result;
}

}  // namespace frac
