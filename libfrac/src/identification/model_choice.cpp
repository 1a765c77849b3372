// SPDX-License-Identifier: BSD-3-Clause
#include "frac/identification/model_choice.hpp"

#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/fisher_f.hpp>
#include <cmath>
#include <cstdio>
#include <limits>
#include <stdexcept>
#include <string>

#include "identification/data/fit_data.hpp"
#include "identification/rational/rational_model.hpp"
#include "identification/statistics/autocorrelation.hpp"
#include "identification/statistics/curvature_fit.hpp"

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
    std::snprintf(text, sizeof text, "Another term does not pay: it lowers AICc by %.2g, and 2 is asked.", gain);
    return text;
  }
  const double chance = f_test(simple, full).p_value;
  if (!(chance < 0.01)) {
    std::snprintf(text, sizeof text, "Another term may be noise: so large an improvement has a chance of %.2g.",
                  chance);
    return text;
  }
  std::string unknown;
  for (const ParameterEstimate& estimate : full.parameters) {
    if (!estimate.identified) unknown += (unknown.empty() ? "" : ", ") + estimate.name;
  }
  if (unknown.empty()) return {};
  std::snprintf(text, sizeof text,
                "Another term lowers AICc by %.3g, but the data do not tell its part from the others: ", gain);
  return text + unknown + " would not be identified.";
}

template <class Data, class Options>
Growth grown(const Data& data, GrowthFamily family, const Options& options, std::size_t most_terms) {
  const std::string enough = "The structure has as many terms as were allowed.";
  Growth growth{{}, {}, 0, enough};
  const std::size_t residuals = detail::points(data) * detail::residuals_per_point(data, options);
  for (std::size_t terms = 1; terms <= most_terms; ++terms) {
    const NamedModel model = grown_model(family, terms);
    const Structure structure(model.formula);
    if (terms > 1 && structure.parameter_names().size() >= residuals) {
      growth.reason = "Another term would have as many parameters as there are residuals.";
      break;
    }
    Options of_model = options;
    of_model.constraints.insert(of_model.constraints.end(), model.constraints.begin(), model.constraints.end());
    growth.fits.push_back(fit(data, structure, of_model));
    growth.models.push_back(model);
    if (terms == 1) continue;
    const FitResult& simple = growth.fits[growth.chosen];
    const FitResult& full = growth.fits.back();
    const double correlation = full.termination == FitTermination::converged
                                   ? std::max(0.0, residual_whiteness(data, options, full).lag_one_correlation)
                                   : 0;
    const double gain = (simple.aicc - full.aicc) * (1 - correlation) / (1 + correlation);
    growth.reason = reason_against(simple, full, gain);
    if (!growth.reason.empty()) break;
    growth.reason = enough;
    growth.chosen = growth.fits.size() - 1;
  }
  return growth;
}

Growth grown_rational(const FrequencyResponseData& data, const FitOptions& options) {
  const detail::RationalMembers members = detail::rational_members(data, {}, options);
  Growth growth{{}, members.models, members.chosen, ""};
  for (const NamedModel& model : members.models) {
    FitOptions of_model = options;
    of_model.constraints = model.constraints;
    of_model.global_start = false;
    growth.fits.push_back(detail::curvature_fit(data, Structure(model.formula), of_model));
  }
  growth.reason = members.chosen + 1 < members.models.size()
                      ? "Further poles do not pay: BIC rises with them."
                      : "The model has as many poles as were allowed, or meets the data to rounding.";
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
  const boost::math::fisher_f distribution(extra, degrees);
  return {statistic, boost::math::cdf(boost::math::complement(distribution, statistic))};
}

double cross_validation(const FrequencyResponseData& data, const Structure& structure, const FitOptions& options,
                        std::size_t folds) {
  return rms_of_predictions(data, structure, options, folds);
}

double cross_validation(const TimeResponseData& data, const Structure& structure, const TimeFitOptions& options,
                        std::size_t folds) {
  return rms_of_predictions(data, structure, options, folds);
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
      case GrowthFamily::rational:
        throw std::invalid_argument(
            "grown_model: the form of a rational model follows from data, see resolved_model()");
    }
  }
  if (family == GrowthFamily::denominator) formula = "1/(b0" + formula + ")";
  if (family == GrowthFamily::arcs) formula = "R0" + formula;
  model.name = model.formula = formula;
  return model;
}

Growth grow(const FrequencyResponseData& data, GrowthFamily family, const FitOptions& options, std::size_t most_terms) {
  if (family == GrowthFamily::rational) return grown_rational(data, options);
  return grown(data, family, options, most_terms);
}

Growth grow(const TimeResponseData& data, GrowthFamily family, const TimeFitOptions& options, std::size_t most_terms) {
  if (family == GrowthFamily::rational) {
    throw std::invalid_argument("grow: rational models are grown on frequency responses only");
  }
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
  const boost::math::chi_squared distribution(static_cast<double>(lags));
  result.p_value = boost::math::cdf(boost::math::complement(distribution, statistic));
  return result;
}

}  // namespace frac
