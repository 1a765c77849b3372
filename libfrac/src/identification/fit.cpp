#include "frac/identification/fit.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "confidence.hpp"
#include "estimates.hpp"
#include "global_search.hpp"
#include "interchange.hpp"
#include "local_solve.hpp"
#include "parameter_map.hpp"
#include "residuals.hpp"
#include "robust.hpp"

namespace frac {

namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

detail::DataScale data_scale(const FrequencyResponseData& data) {
  double sum = 0, lower = std::numeric_limits<double>::infinity(), upper = 0;
  std::size_t nonzero = 0;
  for (const std::complex<double> value : data.value()) {
    const double magnitude = std::abs(value);
    if (!(magnitude > 0)) continue;
    sum += std::log(magnitude);
    lower = std::min(lower, magnitude);
    upper = std::max(upper, magnitude);
    ++nonzero;
  }
  // Half a decade beyond the data on either side, so that constant data leave room too.
  constexpr double margin = 3;
  const double first = data.omega().front(), last = data.omega().back();
  if (nonzero == 0) return {1, 1 / margin, margin, std::sqrt(first) * std::sqrt(last), first / margin, last * margin};
  return {std::exp(sum / static_cast<double>(nonzero)), lower / margin, upper * margin,
          std::sqrt(first) * std::sqrt(last),           first / margin, last * margin};
}

void check_coverage(const FrequencyResponseData& data, const Realisation& realisation) {
  validate(realisation);
  const auto* difference = std::get_if<GrunwaldLetnikovRealisation>(&realisation);
  if (!difference) return;
  constexpr std::size_t longest_memory = 100'000;
  if (difference->memory_length > longest_memory) {
    throw std::invalid_argument("a memory of " + std::to_string(difference->memory_length) +
                                " samples is too long to be summed in every step of a fit; allowed are 1 to " +
                                std::to_string(longest_memory) + ", and 0 for all samples");
  }
  const double nyquist = std::numbers::pi / difference->sample_time;
  if (data.omega().back() > nyquist) {
    throw std::invalid_argument("the data reach omega = " + std::to_string(data.omega().back()) +
                                " rad/s, beyond the Nyquist frequency " + std::to_string(nyquist) +
                                " rad/s of the Gruenwald-Letnikov realisation");
  }
}

/// Under relative weight noise of standard deviation r also sits in the divisor |data|, which biases gains by 2 r^2: as
/// much as their standard error for r sqrt(n) around 1.
constexpr double noisy_divisor = 0.05;
constexpr double plain_misfit = 0.3;

[[noreturn]] void refuse_count(std::size_t residuals, std::size_t parameters) {
  throw std::invalid_argument(std::to_string(residuals) + " residuals cannot determine " + std::to_string(parameters) +
                              " free parameters");
}

/// Whether the fitted part of the data is 0 everywhere.
bool is_empty(const FrequencyResponseData& data, Component component) {
  if (component != Component::imaginary && component != Component::real) return false;
  return std::all_of(data.value().begin(), data.value().end(), [&](std::complex<double> value) {
    return (component == Component::real ? value.real() : value.imag()) == 0;
  });
}

void check_start(const detail::ParameterMap& map, const Structure& structure) {
  for (const auto& entry : map.free()) {
    if (std::isnan(map.start()[entry.parameter])) {
      throw std::invalid_argument("parameter '" + structure.parameter_names()[entry.parameter] +
                                  "' has no start value, and the search for one is switched off");
    }
  }
}

/// Every n-th point, so few that searches and first iterations stay quick and so many that they see the same shape.
struct Thinned {
  FrequencyResponseData data;
  detail::ResidualRule rule;
};
Thinned thinned(const FrequencyResponseData& data, const detail::ResidualRule& rule) {
  constexpr std::size_t enough = 500;
  const std::size_t stride = (data.size() + enough - 1) / enough;
  std::vector<double> omega;
  std::vector<std::complex<double>> value;
  detail::ResidualRule thin{rule.form, {}, rule.unit};
  for (std::size_t i = 0; i < data.size(); i += stride) {
    omega.push_back(data.omega()[i]);
    value.push_back(data.value()[i]);
    thin.weight.push_back(rule.weight[i]);
  }
  return {{std::move(omega), std::move(value)}, std::move(thin)};
}

detail::GlobalSolution solve(const detail::Residuals& residuals, const detail::ResidualRule& rule,
                             const FrequencyResponseData& data, const Structure& structure, const FitOptions& options) {
  const Thinned thin = thinned(data, rule);
  const detail::FrequencyResiduals few(thin.data, structure, options.realisation, residuals.map(), thin.rule);
  detail::GlobalSolution result;
  if (options.global_start && !residuals.map().free().empty()) {
    result = global_search(few, detail::suggested_orders(thin.data), options.seed);
    if (result.starts_at_best == 0) return result;
  } else {
    check_start(residuals.map(), structure);
    result.starts = 1;
    result.minima = 1;
    result.confidence = nan;
    result.best.theta = residuals.map().to_theta(residuals.map().start());
    if (!std::isfinite(residuals.cost(result.best.theta))) return result;
    result.best = local_solve(few, result.best.theta, {});
  }
  if (thin.data.size() < data.size()) result.best = local_solve(residuals, result.best.theta, {});
  if (!std::isfinite(result.best.cost)) return {};
  result.starts_at_best = std::max<std::size_t>(result.starts_at_best, 1);
  return result;
}

std::string ending(const detail::GlobalSolution& solution) {
  if (!solution.best.converged) return "The solver stopped before the cost settled; the best point found is returned.";
  std::string text = std::to_string(solution.starts_at_best) + " of " + std::to_string(solution.starts) +
                     " local solves ended at the best cost";
  if (std::isnan(solution.confidence)) return text + ".";
  if (solution.confidence == 1) return text + ", which is zero but for rounding.";
  char sure[64];
  std::snprintf(sure, sizeof sure, "; no lower one exists with probability %.2f.", solution.confidence);
  return text + sure;
}

/// A fit through Oustaloup's ladder can end on a whole order, where the realisation jumps: a corner, not a minimum.
void refuse_whole_orders(FitResult& result, const Structure& structure, const Realisation& realisation) {
  if (!std::holds_alternative<OustaloupRealisation>(realisation)) return;
  for (std::size_t i = 0; i < result.parameters.size(); ++i) {
    ParameterEstimate& estimate = result.parameters[i];
    if (structure.parameter_roles()[i] != ParameterRole::order || estimate.fixed || estimate.at_bound) continue;
    if (std::abs(estimate.value - std::round(estimate.value)) > 1e-4) continue;
    estimate.identified = false;
    result.message += " Order " + estimate.name +
                      " ended on a whole number, where the Oustaloup realisation jumps: widen its band or add poles.";
  }
}

Component other_component(Component component) {
  return component == Component::imaginary ? Component::real : Component::imaginary;
}

/// fit() with or without a look at the other component for what this one is blind to.
FitResult fit_component(const FrequencyResponseData& data, const Structure& structure, const FitOptions& options,
                        bool recover);

/// What the fitted component is blind to (a real constant in an imaginary part) is estimated from the other one, the
/// rest held.
void recover_unseen(FitResult& result, const detail::Confidence& found, const detail::Residuals& residuals, double cost,
                    const FrequencyResponseData& data, const Structure& structure, const FitOptions& options) {
  if (options.component != Component::imaginary && options.component != Component::real) return;
  const bool all_seen = std::find(found.seen.begin(), found.seen.end(), false) == found.seen.end();
  const bool none_seen = std::find(found.seen.begin(), found.seen.end(), true) == found.seen.end();
  if (all_seen || none_seen) return;
  FitOptions rest = options;
  rest.component = other_component(options.component);
  rest.constraints.clear();
  for (std::size_t i = 0; i < result.parameters.size(); ++i) {
    const std::string& name = result.parameters[i].name;
    if (found.seen[i]) {
      rest.constraints.push_back({name, result.parameters[i].value, {}, {}, {}});
      continue;
    }
    for (const ParameterConstraint& constraint : options.constraints) {
      if (constraint.name == name) rest.constraints.push_back(constraint);
    }
  }
  const FitResult recovered = fit_component(data, structure, rest, false);
  std::vector<double> values;
  for (const ParameterEstimate& estimate : recovered.parameters) values.push_back(estimate.value);
  // The fitted component must not notice: blindness at the minimum alone is not enough.
  if (!(residuals.cost(residuals.map().to_theta(values)) <= cost * (1 + 1e-6) + residuals.rounding_cost())) return;
  for (std::size_t i = 0; i < result.parameters.size(); ++i) {
    if (found.seen[i]) continue;
    result.parameters[i] = recovered.parameters[i];
    result.parameters[i].from_other_component = recovered.parameters[i].identified || recovered.parameters[i].at_bound;
  }
}

FitResult fit_component(const FrequencyResponseData& data, const Structure& structure, const FitOptions& options,
                        bool recover) {
  const auto begin = std::chrono::steady_clock::now();
  check_coverage(data, options.realisation);
  const std::size_t most_residuals = 2 * data.size();
  const std::size_t least_free =
      structure.parameter_names().size() - std::min(structure.parameter_names().size(), options.constraints.size());
  if (least_free > most_residuals) refuse_count(most_residuals, least_free);
  const detail::ParameterMap map(structure, options.constraints, data_scale(data),
                                 options.component == Component::magnitude);
  const detail::ResidualRule rule = detail::residual_rule(data, options.component, options.weight);
  detail::FrequencyResiduals residuals(data, structure, options.realisation, map, rule);
  if (residuals.count() < map.free().size()) {
    refuse_count(residuals.count(), map.free().size());
  }

  const bool empty = is_empty(data, options.component);
  detail::GlobalSolution solution = empty ? detail::GlobalSolution{} : solve(residuals, rule, data, structure, options);
  FitResult result = describe_search(structure, residuals, solution);
  const auto seconds = [&] { return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count(); };
  if (solution.starts_at_best == 0) {
    describe_failure(result, structure, map,
                     empty ? "The " + std::string(to_string(options.component)) +
                                 " part of the data is 0 everywhere: there is nothing to fit."
                           : "The model is not finite on these frequencies anywhere it was tried.");
    result.seconds = seconds();
    return result;
  }

  detail::LocalOptions local;
  if (!solution.best.converged) {
    detail::LocalOptions patient;
    patient.iterations = 1000;
    solution.best = local_solve(residuals, solution.best.theta, patient);
  }
  solution.best.theta =
      map.to_theta(detail::with_labels_in_order(structure, options.constraints, map.to_user(solution.best.theta)));
  if (options.loss != Loss::none) {
    const auto scale = options.loss_scale ? std::optional(*options.loss_scale / rule.unit) : std::nullopt;
    local = robust_refinement(residuals, options.loss, scale, solution.best);
  }
  const detail::Confidence found = confidence(residuals, solution.best, local);
  result.message = ending(solution);
  describe_estimates(result, structure, residuals, options.constraints, found, solution.best.theta);
  if (recover) recover_unseen(result, found, residuals, solution.best.cost, data, structure, options);
  refuse_whole_orders(result, structure, options.realisation);

  describe_residuals(result, residuals, local, found, solution.best.theta, rule.unit);
  if (options.weight == Weight::relative && options.component != Component::magnitude &&
      options.component != Component::phase && result.rms > noisy_divisor && result.rms < plain_misfit) {
    char text[192];
    std::snprintf(text, sizeof text,
                  " With residuals of %.2g |data| is a noisy divisor, which biases gains by about %.1g %%; weight "
                  "smoothed-relative does not.",
                  result.rms, 200 * result.rms * result.rms);
    result.message += text;
  }
  result.termination = solution.best.converged ? FitTermination::converged : FitTermination::not_converged;
  result.seconds = seconds();
  return result;
}

}  // namespace

FitResult fit(const FrequencyResponseData& data, const Structure& structure, const FitOptions& options) {
  return fit_component(data, structure, options, true);
}

std::vector<std::complex<double>> fitted_response(const FitResult& result, const Realisation& realisation,
                                                  const std::vector<double>& omega) {
  const Structure structure(result.model);
  std::vector<double> parameters;
  for (const ParameterEstimate& estimate : result.parameters) parameters.push_back(estimate.value);
  std::vector<std::complex<double>> value(omega.size());
  structure.response(parameters, omega, realisation, value);
  return value;
}

}  // namespace frac
