// SPDX-License-Identifier: BSD-3-Clause
#include "frac/identification/fit.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "base/counted.hpp"
#include "base/short_text.hpp"
#include "frac/identification/constraints.hpp"
#include "frac/identification/fit_from.hpp"
#include "identification/contained_optimum.hpp"
#include "identification/data/fit_data.hpp"
#include "identification/data/formula_checks.hpp"
#include "identification/data/neighbour_noise.hpp"
#include "identification/data/noise_floor.hpp"
#include "identification/data/physical_properties.hpp"
#include "identification/data/residual_rule.hpp"
#include "identification/residuals/frequency_problem.hpp"
#include "identification/search/frequency_search.hpp"
#include "identification/search/interchange.hpp"
#include "identification/search/robust.hpp"
#include "identification/search/thinned.hpp"
#include "identification/statistics/assumption_evidence.hpp"
#include "identification/statistics/autocorrelation.hpp"
#include "identification/statistics/confidence.hpp"
#include "identification/statistics/curvature_fit.hpp"
#include "identification/statistics/estimates.hpp"
#include "identification/statistics/profile.hpp"
#include "identification/statistics/unseen_parameters.hpp"

namespace frac {

namespace {

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

/// Under relative weight noise of standard deviation r on either part also sits in the divisor |data|.  With data
/// G (1 + e) the fit comes to G E[1/(1 + conj e)]/E[1/|1 + e|^2] = G/(1 + 2 r^2) to order r^4, whichever part is
/// fitted: as much as the standard error of a gain for r sqrt(n) around 1.
constexpr double noisy_divisor = 0.05;
constexpr double plain_misfit = 0.3;  // correlation of neighbouring residuals

[[noreturn]] void refuse_count(std::size_t residuals, std::size_t parameters) {
  throw std::invalid_argument(detail::counted(residuals, "residual") + " cannot determine " +
                              detail::counted(parameters, "free parameter"));
}

std::string ending(const detail::GlobalSolution& solution) {
  if (!solution.best.converged) return "The solver stopped before the cost settled; the best point found is returned.";
  std::string text = std::to_string(solution.starts_at_best) + " of " + std::to_string(solution.starts) +
                     " local solves ended at the best cost";
  if (std::isnan(solution.confidence)) return text + ".";
  if (solution.confidence == 1) return text + ", which is zero but for rounding.";
  if (solution.left_early) return text + "; not searched further, as another candidate follows the data far better.";
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

constexpr double everything = std::numeric_limits<double>::infinity();

/// Parts of fit() that some of its callers go without.
struct Extent {
  bool recover;   // looks at the other component for what the fitted one is blind to
  bool profiles;  // follows the cost where intervals are wide
  /// Cost, in the unit of FitResult, above which nobody looks closely: the search ends early, and without profiles.
  double hopeless = everything;
  detail::Profiled profiled = detail::Profiled::all;
  double settled = detail::LocalOptions{}.cost_tolerance;  // see frequency_search()
  /// Where given, very many points are fitted no worse than by structures contained under these options.
  const FitOptions* compared = nullptr;
};

/// An interval up to this share of the value on either side is left as the curvature gives it: where parameters act
/// through their logarithms, the next term moves an end by half that share of the half width, and coverage by some
/// tenths of a per cent.
constexpr double narrow = 0.1;

/// Wide intervals follow the cost instead of its curvature at the minimum.
void follow_cost(FitResult& result, detail::FrequencyProblem& problem, const detail::LocalSolution& solution,
                 const detail::Confidence& found, detail::Profiled profiled) {
  if (problem.options.loss != Loss::none || found.condition > detail::flat_condition || !(found.loss_unit > 0)) return;
  // A profile takes some hundred solves, of more points some minutes.
  if (problem.data.size() > detail::many_points) return;
  for (std::size_t i = 0; i < result.parameters.size(); ++i) {
    const bool is_order = problem.structure.parameter_roles()[i] == ParameterRole::order;
    if (profiled == detail::Profiled::orders && !is_order) continue;
    ParameterEstimate& estimate = result.parameters[i];
    const double half_width = found.t * estimate.standard_error;
    if (estimate.fixed || !std::isfinite(half_width) || half_width <= narrow * std::abs(estimate.value)) continue;
    // An end to half a per cent of the half width, or none within 15 steps.
    const detail::ProfileEnds ends =
        profile_ends(problem, solution, {}, found, profile_centre(problem, solution, found, i), 5e-3, 15);
    if (ends.below_minimum || ends.stuck) continue;
    estimate.ci95_lower = std::max(ends.lower, ends.lower_limit);
    estimate.ci95_upper = std::min(ends.upper, ends.upper_limit);
    estimate.interval = IntervalKind::profile;
    const double widest = std::max(estimate.value - ends.lower, ends.upper - estimate.value);
    estimate.identified = estimate.identified && widest <= 0.5 * std::abs(estimate.value);
  }
}

/// Whether |data| scatters from point to point about as much as residuals do; a model that goes another way leaves
/// large residuals of smooth data.
bool magnitude_scatters(const FrequencyResponseData& data, double deviation) {
  std::vector<double> log_omega, log_size;
  for (std::size_t i = 0; i < data.size(); ++i) {
    if (data.value()[i] == 0.0) continue;
    log_omega.push_back(std::log(data.omega()[i]));
    log_size.push_back(std::log(std::abs(data.value()[i])));
  }
  return log_size.size() > 2 && detail::neighbour_noise(log_omega, log_size) > deviation / 2;
}

void remark_on_noisy_divisor(FitResult& result, detail::FrequencyProblem& problem, std::span<const double> theta) {
  const FitOptions& options = problem.options;
  if (options.component == Component::magnitude || options.component == Component::phase) return;
  const std::vector<double> residual = residuals_at(problem.residuals(), theta);
  const double deviation = options.loss == Loss::none ? result.rms : detail::robust_spread(residual);
  const double correlation = detail::autocorrelation(residual, problem.residuals().per_point(), 1);
  if (!(deviation > noisy_divisor) || std::abs(correlation) > plain_misfit) return;
  if (!magnitude_scatters(problem.data, deviation)) return;
  result.gain_factor = 1 + 2 * deviation * deviation;
  char text[256];
  std::snprintf(text, sizeof text,
                " Residuals of %.2g are noise that the divisor |data| has too, which lowers the fitted response by "
                "%.1f %%: multiply it by %.4f, or take weight smoothed-relative, which has no such bias.",
                deviation, 100 * (1 - 1 / result.gain_factor), result.gain_factor);
  result.message += text;
}

/// Says where a fit of one part ends at a model that consists of the other part, which no data hold: K s^a with a near
/// 2, whose imaginary part is K sin(a pi/2) omega^a.
std::string remark_on_the_part_unseen(const FitResult& result, const std::vector<double>& omega,
                                      const FitOptions& options) {
  const bool real = options.component == Component::real;
  if (!real && options.component != Component::imaginary) return {};
  double most = 0;
  for (const std::complex<double> each : fitted_response(result, options.realisation, omega))
    most = std::max(most, std::abs(real ? each.real() : each.imag()) / std::abs(each));
  // Errors of what is seen come back in the gain this many times larger.
  constexpr double of_the_whole = 1e-3;
  if (!(most < of_the_whole)) return {};
  char text[240];
  std::snprintf(
      text, sizeof text,
      " The %s part is at most %.1g of this model, whose gain therefore says nothing: component-power-law is the "
      "law of that part alone.",
      real ? "real" : "imaginary", most);
  return text;
}

/// robust_search(), of very many points on some of them: its minima are the same, and only the lowest is refined on
/// all.
detail::LocalOptions robust_search_of_many(detail::FrequencyProblem& problem, std::optional<double> scale,
                                           detail::LocalSolution& solution) {
  const FitOptions& options = problem.options;
  if (problem.data.size() <= 2 * detail::many_points) {
    return robust_search(problem.residuals(), options.loss, scale, options.seed, solution);
  }
  const detail::Thinned points = detail::thinned(problem.data, problem.rule, detail::many_points);
  detail::FrequencyResiduals some(points.data, problem.structure, options.realisation, problem.map, points.rule);
  some.set_priors(problem.priors, detail::expected_noise);
  static_cast<void>(robust_search(some, options.loss, scale, options.seed, solution));
  return robust_refinement(problem.residuals(), options.loss, scale, solution);
}

/// A fit of one component under one weight: searched for when it is made, described when it is asked for.
class ComponentFit {
 public:
  ComponentFit(const FrequencyResponseData& data, const Structure& structure, const FitOptions& options, Extent extent)
      : extent_(extent),
        problem_(problem_of(data, structure, options)),
        empty_(detail::is_empty(data, options.component)) {
    const std::size_t residuals = problem_.residuals().count();
    if (residuals < problem_.map.free().size()) refuse_count(residuals, problem_.map.free().size());
    const double unit = problem_.rule.unit;
    if (!empty_) solution_ = frequency_search(problem_, extent.hopeless / (unit * unit), extent.settled);
    if (!(solution_.means && options.loss == Loss::none)) finish();
    seconds_ = since(begin_);
  }

  /// What the search has found: parameters and how it ended.  Errors are left out unless parameters depend on them; of
  /// very many points the parameters are those of their means.
  [[nodiscard]] FitResult found() {
    const bool by_errors =
        !problem_.priors.empty() || (extent_.recover && problem_.options.component != Component::both);
    return solution_.starts_at_best == 0 || by_errors ? described() : estimates();
  }

  /// The whole result.
  [[nodiscard]] FitResult described() {
    if (!described_) {
      if (extent_.compared && problem_.data.size() > detail::many_points) compare_with_contained(*extent_.compared);
      described_ = describe();
    }
    return *described_;
  }

 private:
  using Clock = std::chrono::steady_clock;
  [[nodiscard]] static double since(Clock::time_point begin) {
    return std::chrono::duration<double>(Clock::now() - begin).count();
  }

  [[nodiscard]] static detail::FrequencyProblem problem_of(const FrequencyResponseData& data,
                                                           const Structure& structure, const FitOptions& options) {
    check_coverage(data, options.realisation);
    const std::size_t most_residuals = 2 * data.size();
    const std::size_t least_free =
        structure.parameter_names().size() - std::min(structure.parameter_names().size(), options.constraints.size());
    if (least_free > most_residuals) refuse_count(most_residuals, least_free);
    return detail::FrequencyProblem(data, structure, options);
  }

  /// Parameters that the search has found, without errors.
  [[nodiscard]] FitResult estimates() {
    FitResult result = describe_search(problem_.structure, problem_.residuals(), solution_);
    const std::vector<double> values = problem_.map.to_user(solution_.best.theta);
    for (std::size_t i = 0; i < values.size(); ++i) {
      ParameterEstimate estimate{};
      estimate.name = problem_.structure.parameter_names()[i];
      estimate.value = values[i];
      estimate.fixed = problem_.map.is_fixed(i);
      result.parameters.push_back(std::move(estimate));
    }
    result.termination = solution_.best.converged ? FitTermination::converged : FitTermination::not_converged;
    result.seconds = seconds_;
    return result;
  }

  /// Starts also from optima of contained structures that are lower on means of the points or, where residuals have no
  /// means, on some of them.
  void compare_with_contained(FitOptions options) {
    if (solution_.starts_at_best == 0 || options.loss != Loss::none) return;
    const FrequencyResponseData& data = problem_.data;
    const detail::ResidualRule& rule = problem_.rule;
    std::optional<FrequencyResponseData> few;
    options.noise_floor = problem_.options.noise_floor;
    if (const auto means = binned(data, rule, detail::means_of_many)) {
      std::vector<double> sigma;
      for (const double weight : means->rule.weight) sigma.push_back(1 / (weight * rule.unit));
      few.emplace(means->data.omega(), means->data.value(), std::move(sigma));
      options.weight = Weight::given;
    } else {
      few = detail::chosen_points(data, [&](std::size_t i) { return i % (data.size() / detail::means_of_many) == 0; });
    }
    const Structure& structure = problem_.structure;
    const FitResult here = detail::refit(*few, structure, detail::started_at(options, estimates()));
    const FitResult lower = detail::no_worse_than_contained(*few, structure, options, here);
    if (!(lower.cost < here.cost)) return;
    std::vector<double> values;
    for (std::size_t i = 0; i < problem_.map.parameter_count(); ++i) values.push_back(lower.parameters[i].value);
    solve_also_from(problem_.map.to_theta(values), problem_, solution_);
    order_parts();
  }

  /// Ends the search at the optimum of all points, with parts in order and under the loss.
  void finish() {
    const FitOptions& options = problem_.options;
    if (solution_.means) refine_on_all(problem_, extent_.settled, solution_);
    if (solution_.starts_at_best == 0) return;
    detail::LocalSolution& best = solution_.best;
    if (!best.converged) {
      detail::LocalOptions patient;
      patient.iterations = 1000;
      best = local_solve(problem_.residuals(), best.theta, patient);
    }
    order_parts();
    if (options.loss == Loss::none) return;
    const auto scale = options.loss_scale ? std::optional(*options.loss_scale / problem_.rule.unit) : std::nullopt;
    if (options.global_start) {
      local_ = robust_search_of_many(problem_, scale, best);
      order_parts();
    } else {
      local_ = robust_refinement(problem_.residuals(), options.loss, scale, best);
    }
  }

  /// Of parts that can be interchanged the first is the one whose labels say so.
  void order_parts() {
    const detail::ParameterMap& map = problem_.map;
    std::vector<double>& theta = solution_.best.theta;
    theta = map.to_theta(
        detail::with_labels_in_order(problem_.structure, problem_.options.constraints, map.to_user(theta)));
  }

  [[nodiscard]] FitResult describe() {
    const Clock::time_point begin = Clock::now();
    if (solution_.means) finish();
    const FrequencyResponseData& data = problem_.data;
    const Structure& structure = problem_.structure;
    const FitOptions& options = problem_.options;
    const detail::ResidualRule& rule = problem_.rule;
    detail::Residuals& residuals = problem_.residuals();
    FitResult result = describe_search(structure, residuals, solution_);
    if (solution_.starts_at_best == 0) {
      describe_failure(result, structure, problem_.map,
                       empty_ ? "The " + std::string(to_string(options.component)) +
                                    " part of the data is 0 everywhere: there is nothing to fit."
                              : "The model is not finite on these frequencies anywhere it was tried.");
      result.seconds = seconds_ + since(begin);
      return result;
    }

    detail::LocalSolution& best = solution_.best;
    const detail::Confidence found = weighed_confidence(problem_, best, local_);
    result.message = ending(solution_);
    result.without_noise = options.without_noise;
    describe_estimates(result, structure, residuals, options.constraints, found, best.theta);
    const bool closely = best.cost * rule.unit * rule.unit <= extent_.hopeless;
    if (extent_.profiles && closely) follow_cost(result, problem_, best, found, extent_.profiled);
    if (extent_.recover) {
      recover_unseen(result, found, problem_, best.cost, [&](const FitOptions& rest) {
        return ComponentFit(data, structure, rest, {false, extent_.profiles && closely, closely ? everything : 0})
            .described();
      });
    }
    refuse_whole_orders(result, structure, options.realisation);

    describe_residuals(result, residuals, local_, found, best.theta, rule.unit);
    const bool relative = options.weight == Weight::relative ||
                          (options.weight == Weight::learned && !(options.noise_floor.value_or(0) > 0));
    result.message += detail::remark_on_zeros(data, options);
    if (relative && !result.without_noise) remark_on_noisy_divisor(result, problem_, best.theta);
    result.message += remark_on_the_part_unseen(result, data.omega(), options);
    result.termination = best.converged ? FitTermination::converged : FitTermination::not_converged;
    result.seconds = seconds_ + since(begin);
    return result;
  }

  const Clock::time_point begin_ = Clock::now();
  const Extent extent_;
  detail::FrequencyProblem problem_;
  const bool empty_;  // the fitted component of the data
  detail::FrequencySolution solution_;
  detail::LocalOptions local_;
  double seconds_ = 0;  // of the search
  std::optional<FitResult> described_;
};

/// Says of a fit from the end of a search how that search ended.
void count_search_of(const FitResult& search, FitResult& result) {
  result.starts = search.starts;
  result.starts_at_best = search.starts_at_best;
  result.distinct_minima = search.distinct_minima;
  result.confidence_of_optimum = search.confidence_of_optimum;
}

/// Of very many points stretches of neighbours, evenly over all, that tell a floor: 40 000 changes know it to 1 %.
std::optional<FrequencyResponseData> stretches_of_many(const FrequencyResponseData& data) {
  constexpr std::size_t stretch = 64, enough = 2 * detail::many_points;
  if (data.size() <= 2 * enough) return std::nullopt;
  const std::size_t every = data.size() / enough;
  return detail::chosen_points(data, [&](std::size_t i) { return i / stretch % every == 0; });
}

/// ComponentFit, with a floor told by the residuals of the fit before where one is wanted.
FitResult fit_with_floor(const FrequencyResponseData& data, const Structure& structure, const FitOptions& options,
                         Extent extent) {
  detail::require_function_of_s(structure);
  if (options.weight != Weight::learned || options.noise_floor) {
    FitResult result = ComponentFit(data, structure, options, extent).described();
    if (options.weight == Weight::learned) result.noise_floor = *options.noise_floor;
    return result;
  }
  ComponentFit relative(data, structure, options, extent);
  if (options.without_noise) return relative.described();
  FitResult result = relative.found();
  const std::optional<FrequencyResponseData> stretches = stretches_of_many(data);
  const FrequencyResponseData& told = stretches ? *stretches : data;
  const auto floor_of = [&](const FitResult& of) {
    return of.termination == FitTermination::no_usable_start
               ? 0
               : detail::noise_floor(told, fitted_response(of, options.realisation, told.omega()), options.component);
  };
  double floor = floor_of(result);
  if (floor == 0) return relative.described();
  // What relative weight has made of noise below the floor may be anything, so the first fit with one searches anew.
  constexpr double settled = 0.1;
  constexpr int most_rounds = 4;
  FitOptions next = options;
  for (int round = 0; round < most_rounds; ++round) {
    next.noise_floor = floor;
    const FitResult quick = ComponentFit(data, structure, next, {false, false}).found();
    const double seconds = result.seconds + quick.seconds;
    if (quick.termination == FitTermination::no_usable_start) break;
    result = quick;
    result.seconds = seconds;
    const double again = floor_of(quick);
    next = detail::started_at(options, quick);
    if (std::abs(again - floor) <= settled * floor) break;
    floor = again;
    if (floor == 0) return relative.described();
  }
  next.noise_floor = floor;
  FitResult last = ComponentFit(data, structure, next, extent).described();
  if (last.termination != FitTermination::converged && relative.described().termination == FitTermination::converged) {
    return relative.described();
  }
  last.noise_floor = floor;
  if (last.starts == 1) count_search_of(result, last);
  last.seconds += result.seconds;
  char text[200];
  std::snprintf(text, sizeof text,
                " The noise does not fall with the data: residuals are divided by sqrt(|data|^2 + floor^2) with a "
                "floor of %.3g, told by the residuals.",
                floor);
  last.message += text;
  return last;
}

std::string share_of_data(const FitResult& result) {
  return detail::four_digits(100 * result.relative_rms) + " %";
}

/// The best stable model of a formula.  With positive coefficients orders less than 2 apart are stable, so that one
/// search goes as far as that; the other one goes wherever the stability of each model can be told.
/// @param enough  cost that need not be beaten
FitResult stable_fit(const FrequencyResponseData& data, const Structure& structure, const FitOptions& options,
                     double enough) {
  constexpr Extent whole{true, true};
  FitOptions wide = options, narrow = options;
  wide.assumptions.stable = true;
  narrow.assumptions.stable = false;
  constexpr double below_two = 2 - 1e-8;
  for (std::size_t i = 0; i < structure.parameter_names().size(); ++i) {
    if (structure.parameter_roles()[i] != ParameterRole::order || !structure.parameter_in_sum()[i]) continue;
    ParameterConstraint& own = constraint_of(narrow.constraints, structure.parameter_names()[i]);
    if (!own.fixed && own.lower.value_or(0) < below_two) own.upper = std::min(own.upper.value_or(below_two), below_two);
    if (own.start && own.upper && *own.start > *own.upper) own.start.reset();
  }
  const auto is_stable = [](const FitResult& result) {
    return result.usable() && detail::is_unstable(result) == false;
  };
  FitResult result = fit_with_floor(data, structure, narrow, whole);
  // The other one takes some milliseconds for each model that it looks at.
  if (is_stable(result) && !(result.cost > enough)) return result;
  FitResult other = fit_with_floor(data, structure, wide, whole);
  if (!is_stable(result) || other.cost < result.cost) result = std::move(other);
  if (detail::is_unstable(result).value_or(true)) result.termination = FitTermination::no_usable_start;
  return result;
}

/// fit_with_floor() that is no worse than structures contained in this one, where it is searched for.
FitResult best_fit(const FrequencyResponseData& data, const Structure& structure, const FitOptions& options,
                   bool profiles) {
  Extent extent{true, profiles};
  if (options.global_start) extent.compared = &options;
  FitResult result = fit_with_floor(data, structure, options, extent);
  if (!options.global_start || data.size() > detail::many_points) return result;
  const FitResult lower = detail::no_worse_than_contained(data, structure, options, result);
  if (!(lower.cost < result.cost)) return result;
  result = fit_with_floor(data, structure, detail::started_at(options, lower), extent);
  count_search_of(lower, result);
  result.seconds += lower.seconds;
  return result;
}

/// The search, and where it ends at an unstable model another one among stable ones, which is taken unless the data
/// speak against it.
FitResult fit_as_assumed(const FrequencyResponseData& data, const Structure& structure, const FitOptions& options,
                         bool profiles) {
  const std::optional<bool>& stable = options.assumptions.stable;
  FitOptions any = options;
  any.assumptions.stable = false;
  FitResult free = best_fit(data, structure, any, profiles);
  if (stable == false || !detail::is_unstable(free).value_or(false)) return free;
  // The member of a family stands where it has been chosen.
  if (!options.global_start && !stable) return free;
  if (options.weight == Weight::learned && !options.noise_floor) any.noise_floor = free.noise_floor;
  // What noise may make of the cost once in a thousand times.
  const double enough = free.cost * (1 + 10.8 / static_cast<double>(free.residuals));
  FitResult held = stable_fit(data, structure, any, enough);
  held.noise_floor = free.noise_floor;
  held.seconds += free.seconds;
  if (!held.usable()) {
    if (stable) held.message = "No stable model of this formula was found.";
    free.message += " No stable model of this formula was found.";
    return stable ? held : free;
  }
  const auto leftover = [&](const FitResult& result) {
    const std::vector<double> residual = detail::weighted_residuals(data, any, result);
    return detail::Leftover{result.relative_rms,
                            detail::autocorrelation(residual, detail::residuals_per_point(data, any), 1), 0};
  };
  const double evidence = detail::evidence_against(leftover(held), leftover(free), free.residuals);
  if (!stable && evidence > detail::price_of_assumption) {
    free.message += " The data speak against a stable system: the best stable model of this formula leaves " +
                    share_of_data(held) + " of the data (rms), this one " + share_of_data(free) + ".";
    free.seconds = held.seconds;
    return free;
  }
  held.message += " The system is taken to be stable: an unstable model of this formula leaves " + share_of_data(free) +
                  " of the data (rms), this one " + share_of_data(held) + ".";
  return held;
}

/// Whether a minimum reached from the answer to similar data needs no search: it follows the data to within noise (the
/// residuals are as small as the similar ones, or smaller, and neighbours are unlike), so that another could be lower
/// by no more than noise allows, and it pins every parameter down, so that no other parameters do the same.  A cost
/// that is zero but for rounding cannot be beaten.
bool is_surely_lowest(const FitResult& result, const FitResult& similar, const FrequencyResponseData& data,
                      const FitOptions& options) {
  if (!result.usable() || result.residuals == 0 || similar.residuals == 0) return false;
  constexpr double rounding = 1e-9;
  if (result.rms < rounding) return true;
  // Mean squares of 130 residuals each of the same noise differ by more once in 1000 data sets.
  constexpr double follows_alike = 1.7;
  if (result.rms * result.rms > follows_alike * similar.rms * similar.rms) return false;
  // Of 140 residuals of white noise it is beyond once in 1000.
  constexpr double alike = 0.28;
  const std::vector<double> residual = detail::weighted_residuals(data, options, result);
  if (std::abs(detail::autocorrelation(residual, detail::residuals_per_point(data, options), 1)) > alike) return false;
  constexpr double pinned_down = 0.1;
  return std::all_of(result.parameters.begin(), result.parameters.end(), [](const ParameterEstimate& estimate) {
    if (estimate.fixed) return true;
    return estimate.identified && !estimate.at_bound &&
           estimate.standard_error <= pinned_down * std::abs(estimate.value);
  });
}

/// A result of the same structure, however it is written, with the parameters' names in this one; empty for another.
std::optional<FitResult> in_names_of(const Structure& structure, FitResult result) {
  if (result.model == structure.formula()) return result;
  const Structure fitted(result.model);
  const auto place = fitted.correspondence(structure);
  if (!place) return std::nullopt;
  for (std::size_t i = 0; i < place->size(); ++i) result.parameters[i].name = structure.parameter_names()[(*place)[i]];
  return result;
}

}  // namespace

FitResult fit(const FrequencyResponseData& data, const Structure& structure, const FitOptions& options) {
  if (options.assumptions.dead_time == false && detail::has_dead_time(structure)) {
    throw std::invalid_argument("the formula has a dead time, and the system is said to have none");
  }
  FitResult result = fit_as_assumed(data, structure, options, true);
  if (options.assumptions.passive && result.usable()) result.message += detail::remark_on_passivity(result, data);
  return result;
}

FitResult fit_from(const FitResult& similar, const FrequencyResponseData& data, const Structure& structure,
                   const FitOptions& options) {
  if (similar.usable() && options.loss == Loss::none && options.global_start) {
    if (const std::optional<FitResult> known = in_names_of(structure, similar)) {
      FitResult result = fit_with_floor(data, structure, detail::started_at(options, *known), {true, true});
      if (is_surely_lowest(result, similar, data, options)) return result;
    }
  }
  return fit(data, structure, options);
}

FitResult detail::response_fit_without_profiles(const FrequencyResponseData& data, const Structure& structure,
                                                const FitOptions& options, bool as_assumed) {
  return as_assumed ? fit_as_assumed(data, structure, options, false)
                    : fit_with_floor(data, structure, options, {true, false});
}

FitResult detail::refit(const FrequencyResponseData& data, const Structure& structure, const FitOptions& options) {
  return fit_with_floor(data, structure, options, {false, false, everything, Profiled::all, settled_refit});
}

FitResult detail::fit_in_reach(const FrequencyResponseData& data, const Structure& structure, const FitOptions& options,
                               double hopeless, Profiled profiled) {
  return ComponentFit(data, structure, options, {true, true, hopeless, profiled}).described();
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
