#include "frac/identification/fit.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "confidence.hpp"
#include "global_search.hpp"
#include "information.hpp"
#include "interchange.hpp"
#include "local_solve.hpp"
#include "parameter_map.hpp"
#include "residuals.hpp"

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

std::vector<double> residuals_at(const detail::Residuals& residuals, const std::vector<double>& theta) {
  std::vector<double> residual(residuals.count());
  residuals.evaluate(theta, residual.data(), nullptr);
  return residual;
}

/// 1.4826 times the median absolute residual: the standard deviation of the well-behaved part (normal residuals).
double robust_spread(std::vector<double> residual) {
  for (double& value : residual) value = std::abs(value);
  const auto middle = residual.begin() + static_cast<std::ptrdiff_t>(residual.size() / 2);
  std::nth_element(residual.begin(), middle, residual.end());
  return 1.4826 * *middle;
}

/// Residuals below this, in units of the data, are rounding.
constexpr double rounding = 1e-13;

/// Points with a residual beyond five robust standard deviations: one in two million of normal residuals.
std::vector<std::size_t> outliers(const std::vector<double>& residual, std::size_t per_point) {
  std::vector<std::size_t> points;
  const double limit = std::max(5 * robust_spread(residual), rounding);
  for (std::size_t i = 0; i < residual.size(); ++i) {
    const std::size_t point = i / per_point;
    if (std::abs(residual[i]) > limit && (points.empty() || points.back() != point)) points.push_back(point);
  }
  return points;
}

/// Loss scales that keep 95 % efficiency on normal residuals (Huber 1981; Holland, Welsch 1977).
double tuning_constant(Loss loss) {
  return loss == Loss::huber ? 1.345 : 2.385;
}

/// Refines a least-squares solution under a robust loss whose scale follows the residuals until it settles.
detail::LocalOptions robust_refinement(const detail::Residuals& residuals, Loss loss, detail::LocalSolution& solution) {
  detail::LocalOptions options;
  options.loss = loss;
  double spread = robust_spread(residuals_at(residuals, solution.theta));
  for (int pass = 0; pass < 30 && spread > 0; ++pass) {
    options.loss_scale = tuning_constant(loss) * spread;
    solution = local_solve(residuals, solution.theta, options);
    const double next = robust_spread(residuals_at(residuals, solution.theta));
    const bool settled = std::abs(next - spread) <= 1e-3 * spread;
    spread = next;
    if (settled) break;
  }
  return options;
}

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

/// Points of the data, at most `count`: half of them spread evenly, half by the length of the curve in logarithms, so
/// that a resonance keeps its points.
struct Thinned {
  FrequencyResponseData data;
  detail::ResidualRule rule;
};
Thinned thinned(const FrequencyResponseData& data, const detail::ResidualRule& rule, std::size_t count) {
  const std::size_t size = data.size();
  std::vector<double> length(size, 0.0);
  for (std::size_t i = 1; i < size; ++i) {
    const std::complex<double> before = data.value()[i - 1], after = data.value()[i];
    const double mean = (std::abs(before) + std::abs(after)) / 2;
    length[i] = length[i - 1] + (mean > 0 ? std::abs(after - before) / mean : 0);  // at most 2: also of an outlier
  }
  std::vector<double> omega;
  std::vector<std::complex<double>> value;
  detail::ResidualRule thin{rule.form, {}, rule.unit};
  const double total = length.back() > 0 ? length.back() : 1;
  double next = 0;
  for (std::size_t i = 0; i < size; ++i) {
    const double place = 0.5 * static_cast<double>(i) / static_cast<double>(size) + 0.5 * length[i] / total;
    if (count < size && place < next && i + 1 < size) continue;
    next = (std::floor(place * static_cast<double>(count)) + 1) / static_cast<double>(count);
    omega.push_back(data.omega()[i]);
    value.push_back(data.value()[i]);
    thin.weight.push_back(rule.weight[i]);
  }
  return {{std::move(omega), std::move(value)}, std::move(thin)};
}

detail::GlobalSolution search(const detail::Residuals& residuals, const detail::ResidualRule& rule,
                              const FrequencyResponseData& data, const Structure& structure,
                              const FitOptions& options) {
  // So few that scouting is quick and so many that they show the shape of most curves; see global_search().
  const std::size_t scouted = std::max<std::size_t>(64, 8 * residuals.map().free().size());
  const std::vector<double> orders = detail::suggested_orders(data);
  if (2 * data.size() < 3 * scouted) return global_search(residuals, residuals, orders, options.seed);
  const Thinned few = thinned(data, rule, scouted);
  const detail::FrequencyResiduals scouting(few.data, structure, options.realisation, residuals.map(), few.rule);
  return global_search(scouting, residuals, orders, options.seed);
}

detail::GlobalSolution solve(const detail::Residuals& residuals, const detail::ResidualRule& rule,
                             const FrequencyResponseData& data, const Structure& structure, const FitOptions& options) {
  // First iterations stay quick on so many points, and see the same shape.
  const Thinned thin = thinned(data, rule, 500);
  const detail::FrequencyResiduals few(thin.data, structure, options.realisation, residuals.map(), thin.rule);
  detail::GlobalSolution result;
  if (options.global_start && !residuals.map().free().empty()) {
    result = search(few, thin.rule, thin.data, structure, options);
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

/// Two like parts of which one is not identified, and whose share in their sum is all that is unknown, are neither:
/// what one has the other lacks.
void refuse_inseparable_parts(FitResult& result, const Structure& structure) {
  constexpr double inseparable = 0.98;  // correlation
  for (const detail::Interchange& parts : detail::interchanges(structure)) {
    for (const auto& [a, b] : parts.pairs) {
      ParameterEstimate &first = result.parameters[a], &second = result.parameters[b];
      if (first.identified == second.identified || first.fixed || second.fixed) continue;
      const double correlation = result.covariance[a][b] / (first.standard_error * second.standard_error);
      if (std::abs(correlation) > inseparable) first.identified = second.identified = false;
    }
  }
}

std::string listed(const std::vector<std::string>& names) {
  std::string text;
  for (std::size_t i = 0; i < names.size(); ++i) {
    text += (i == 0 ? "" : i + 1 == names.size() ? " and " : ", ") + names[i];
  }
  return text;
}

/// What limits say about the result: parameters that ended at one, and residuals as many as parameters.
std::string remarks_on_limits(const FitResult& result, const Structure& structure, const FitOptions& options,
                              bool degrees_left) {
  std::vector<std::string> at_bound;
  bool held_positive = false;
  for (std::size_t i = 0; i < result.parameters.size(); ++i) {
    if (!result.parameters[i].at_bound) continue;
    const std::string& name = result.parameters[i].name;
    at_bound.push_back(name);
    const bool limited =
        std::any_of(options.constraints.begin(), options.constraints.end(),
                    [&](const ParameterConstraint& each) { return each.name == name && each.lower.has_value(); });
    held_positive = held_positive || (structure.parameter_roles()[i] == ParameterRole::coefficient &&
                                      structure.parameter_in_sum()[i] && !limited);
  }
  std::string text;
  if (!at_bound.empty()) {
    text += " At a bound: " + listed(at_bound) + ".";
    if (held_positive) {
      text += " Coefficients in sums are taken as positive unless a lower limit below 0 is given for them.";
    }
  }
  if (!degrees_left) {
    text += " The residuals are no more than the parameters, so there are no intervals.";
  }
  return text;
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
  const detail::FrequencyResiduals residuals(data, structure, options.realisation, map, rule);
  if (residuals.count() < map.free().size()) {
    refuse_count(residuals.count(), map.free().size());
  }

  const bool empty = is_empty(data, options.component);
  detail::GlobalSolution solution = empty ? detail::GlobalSolution{} : solve(residuals, rule, data, structure, options);
  FitResult result{};
  result.model = structure.formula();
  result.residuals = residuals.count();
  result.free_parameters = map.free().size();
  result.starts = solution.starts;
  result.starts_at_best = solution.starts_at_best;
  result.distinct_minima = solution.minima;
  result.confidence_of_optimum = solution.confidence;
  const auto& names = structure.parameter_names();

  if (solution.starts_at_best == 0) {
    result.cost = result.rms = result.max_residual = result.aicc = result.bic = result.condition = nan;
    result.termination = FitTermination::no_usable_start;
    result.message = empty ? "The " + std::string(to_string(options.component)) +
                                 " part of the data is 0 everywhere: there is nothing to fit."
                           : "The model is not finite on these frequencies anywhere it was tried.";
    for (std::size_t i = 0; i < names.size(); ++i) {
      result.parameters.push_back({names[i], nan, nan, nan, nan, map.is_fixed(i), false, false, nan, nan, false});
    }
    result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
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
  if (options.loss != Loss::none) local = robust_refinement(residuals, options.loss, solution.best);
  const detail::Confidence found = confidence(residuals, solution.best, local);
  const std::vector<double> values = map.to_user(solution.best.theta);
  for (std::size_t i = 0; i < names.size(); ++i) {
    const double half_width = found.t * found.standard_error[i];
    ParameterEstimate estimate{};
    estimate.name = names[i];
    estimate.value = estimate.centre_value = values[i];
    estimate.fixed = map.is_fixed(i);
    estimate.standard_error = estimate.fixed ? 0 : found.standard_error[i];
    estimate.centre_standard_error = estimate.fixed ? 0 : found.centre_standard_error[i];
    estimate.ci95_lower = estimate.fixed ? nan : values[i] - half_width;
    estimate.ci95_upper = estimate.fixed ? nan : values[i] + half_width;
    estimate.at_bound = found.at_bound[i];
    estimate.identified = found.identified[i] && !found.at_bound[i];
    result.parameters.push_back(std::move(estimate));
  }
  for (std::size_t k = 0; k < map.free().size(); ++k) {
    result.parameters[map.free()[k].parameter].centre_value = map.centre_value(k, values);
  }
  result.covariance = found.covariance;
  refuse_inseparable_parts(result, structure);
  result.centre_omega = map.scale().omega;
  result.message = ending(solution);
  if (found.condition > detail::flat_condition) {
    char text[128];
    std::snprintf(text, sizeof text,
                  " The scaled Fisher condition is %.1e, beyond %.0e: some parameters only trade off.", found.condition,
                  detail::flat_condition);
    result.message += text;
  }
  result.message += remarks_on_limits(result, structure, options, residuals.count() > map.free().size());
  if (recover) recover_unseen(result, found, residuals, solution.best.cost, data, structure, options);
  refuse_whole_orders(result, structure, options.realisation);

  std::vector<double> residual = residuals_at(residuals, solution.best.theta);
  result.outliers = outliers(residual, residuals.per_point());
  for (double& value : residual) value *= rule.unit;
  const detail::Information information = detail::information(residual, found.rank, rule.unit);
  result.cost = information.cost;
  result.rms = information.rms;
  result.max_residual = information.max_residual;
  result.aicc = information.aicc;
  result.bic = information.bic;
  if (options.weight == Weight::relative && options.component != Component::magnitude &&
      options.component != Component::phase && result.rms > noisy_divisor && result.rms < plain_misfit) {
    char text[192];
    std::snprintf(text, sizeof text,
                  " With residuals of %.2g |data| is a noisy divisor, which biases gains by about %.1g %%; weight "
                  "smoothed-relative does not.",
                  result.rms, 200 * result.rms * result.rms);
    result.message += text;
  }
  result.condition = found.condition;
  result.termination = solution.best.converged ? FitTermination::converged : FitTermination::not_converged;
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
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
