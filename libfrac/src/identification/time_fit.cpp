// SPDX-License-Identifier: BSD-3-Clause
#include "frac/identification/time_fit.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numeric>
#include <stdexcept>

#include "base/counted.hpp"
#include "base/gram_schmidt.hpp"
#include "base/linear_algebra.hpp"
#include "base/number_text.hpp"
#include "base/short_text.hpp"
#include "frac/identification/model_choice.hpp"
#include "identification/contained_optimum.hpp"
#include "identification/data/fit_data.hpp"
#include "identification/data/formula_checks.hpp"
#include "identification/search/linearisation.hpp"
#include "identification/search/robust.hpp"
#include "identification/search/start_values.hpp"
#include "identification/search/time_search.hpp"
#include "identification/statistics/confidence.hpp"
#include "identification/statistics/curvature_fit.hpp"
#include "identification/statistics/estimates.hpp"
#include "identification/statistics/first_order_likelihood.hpp"
#include "identification/statistics/restricted_likelihood.hpp"
#include "identification/time_advice.hpp"
#include "identification/time_noise.hpp"
#include "special/distributions.hpp"

namespace frac {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
using detail::length_of;
using detail::offset_name;

// Costs are sums of squares of the weighted output, and scales are taken from squares of the output itself.
void require_squares(const TimeResponseData& data) {
  constexpr double largest_root = 1e140, smallest_root = 1e-140;
  double output = 0;
  for (const std::size_t i : data.observed()) output = std::max(output, std::abs(data.output()[i]));
  for (const double size : {output, detail::weighted_size(data, TimeFitOptions{})}) {
    if (size == 0 || (size >= smallest_root && size <= largest_root)) continue;
    throw std::invalid_argument("the output reaches " + detail::number_text(size) +
                                (size == output ? "" : " times its sigma") +
                                "; sums of squares of that size leave double precision, so give it in another unit");
  }
}

void check(const TimeResponseData& data, const Structure& structure, const TimeFitOptions& options,
           const detail::ParameterMap& map) {
  for (const std::string& name : structure.parameter_names()) {
    if (name == offset_name || name == detail::drift_name) {
      throw std::invalid_argument("parameter '" + name + "': the name stands for the output at rest or its drift; " +
                                  "rename it in the formula");
    }
  }
  for (const ParameterConstraint& known : options.constraints) {
    if (known.fixed || known.upper || !(known.lower > length_of(data))) continue;
    const auto& names = structure.parameter_names();
    const auto at = std::find(names.begin(), names.end(), known.name);  // the offset is none of them
    if (at == names.end()) continue;
    if (structure.parameter_roles()[static_cast<std::size_t>(at - names.begin())] != ParameterRole::delay) continue;
    throw std::invalid_argument("parameter '" + known.name + "': lower limit " + detail::number_text(*known.lower) +
                                " s of a dead time; allowed is less than the record of " +
                                detail::number_text(length_of(data)) + " s");
  }
  if (options.offset && !std::isfinite(*options.offset)) {
    throw std::invalid_argument("offset = " + std::to_string(*options.offset) + "; allowed is a finite number");
  }
  if (!(options.noise_correlation >= 0 && options.noise_correlation < 1)) {
    throw std::invalid_argument("noise_correlation = " + detail::number_text(options.noise_correlation) +
                                "; allowed is 0 (white noise) to below 1");
  }
  // Start values may be missing.  A ratio of sums of powers is one at all values; other formulas may be fitted at some
  // values only, as tanh((T s)^n) is at n up to a half.
  const auto guess = [&](double order) {
    std::vector<double> values;
    for (std::size_t i = 0; i < structure.parameter_names().size(); ++i) {
      const bool is_order = structure.parameter_roles()[i] == ParameterRole::order;
      const double known = map.start()[i];
      values.push_back(std::isnan(known) ? (is_order ? order + 0.01 * static_cast<double>(i) : 0.5) : known);
    }
    return values;
  };
  if (!detail::time_model_if_any(structure, guess(0.3)))
    static_cast<void>(detail::time_model(structure, guess(0.7), detail::Sensitivity::all));
  const std::size_t free = map.free().size() + (options.offset ? 0 : 1);
  if (data.observed().size() < free) {
    throw std::invalid_argument(detail::counted(data.observed().size(), "sample") + " cannot determine " +
                                detail::counted(free, "free parameter") +
                                (options.offset ? "" : ", the offset among them"));
  }
}

// Names and order of what is free of the background.
std::vector<std::string> background_names(const TimeFitOptions& options) {
  std::vector<std::string> names;
  if (!options.offset) names.emplace_back(offset_name);
  if (options.trend) names.emplace_back(detail::drift_name);
  return names;
}

// Offset and drift as more parameters: least squares of what the model leaves, so that they take the noise that the
// columns' pseudo-inverse C gives them, less what the parameters take of it (A, their influence): C - C J A.
void append_background(FitResult& result, const detail::TimeResiduals& residuals, const std::vector<double>& theta,
                       const TimeResponseData& data, const TimeFitOptions& options, const detail::Confidence& found) {
  const std::vector<std::string> names = background_names(options);
  if (residuals.eliminated() == 0) return;
  const detail::TimeResiduals::Eliminated eliminated = residuals.eliminated_at(theta);
  for (Eigen::Index k = static_cast<Eigen::Index>(names.size()); k < eliminated.coefficient.size(); ++k) {
    result.earlier_input.push_back(eliminated.coefficient[k]);
  }
  if (names.empty()) return;
  const Eigen::MatrixXd columns = residuals.eliminated_columns();
  const Eigen::MatrixXd inverse = detail::PlainQr(columns).dual();
  Eigen::MatrixXd influence = inverse;
  const bool known_influence = found.spread.size() > 0;
  if (known_influence)
    influence -= found.directions * (found.spread.transpose() * eliminated.gradient.transpose() * inverse);
  const std::size_t modelled = result.covariance.size();
  const Eigen::Index known = found.directions.cols();
  Eigen::MatrixXd all(influence.rows(), known + influence.cols());
  if (known > 0) all.leftCols(known) = found.directions;
  all.rightCols(influence.cols()) = influence;
  const Eigen::MatrixXd scatter = found.deviation * found.deviation * found.noise.covariance(all);
  const std::vector<double> output = detail::observed(data, data.output());
  const auto [least, largest] = std::minmax_element(output.begin(), output.end());
  // A parameter that the rest of the residuals does not see may stand for the background, unless it moves nothing at
  // all.
  bool alone = true;
  for (std::size_t i = 0; i < modelled; ++i) {
    if (found.seen[i]) continue;
    constexpr double nothing = 1e-6;  // of what the output does
    const double size = std::abs(result.parameters[i].value);
    const double moved = size * eliminated.gradient.col(static_cast<Eigen::Index>(i)).norm();
    alone = alone && size > 0 && moved <= nothing * (*largest - *least) * columns.col(0).norm();
  }
  for (std::size_t k = 0; k < names.size(); ++k) {
    const Eigen::Index place = known + static_cast<Eigen::Index>(k);
    std::vector<double> covariance;
    for (std::size_t i = 0; i < modelled; ++i) {
      const double both =
          known_influence ? found.spread.row(static_cast<Eigen::Index>(i)).dot(scatter.col(place).head(known)) : 0;
      covariance.push_back(std::isnan(result.covariance[i][i]) ? nan : both);
    }
    for (Eigen::Index j = known; j <= place; ++j) covariance.push_back(scatter(place, j));
    for (std::size_t i = 0; i < result.covariance.size(); ++i) result.covariance[i].push_back(covariance[i]);
    result.covariance.push_back(covariance);
    const double value = eliminated.coefficient[static_cast<Eigen::Index>(k)], error = std::sqrt(covariance.back());
    // Nothing is known of it as well as any value: what counts is its interval beside what the output does.
    const double reach = names[k] == offset_name ? 1 : length_of(data);
    const bool narrow = !(2 * found.t * error * reach > *largest - *least);
    result.parameters.push_back({names[k], value, error, value - found.t * error, value + found.t * error, false, false,
                                 narrow && alone, value, error, false});
    const double white = found.deviation * influence.col(static_cast<Eigen::Index>(k)).stableNorm();
    result.parameters.back().widening = white > 0 ? error / white : 1;
  }
}

// Where no response to the input can be told from noise, no parameter of one can.
void refuse_unseen_response(FitResult& result, const detail::TimeResiduals& residuals,
                            const detail::LocalOptions& local, std::size_t rank, double unit) {
  const std::size_t eliminated = residuals.eliminated();
  if (rank == 0 || result.residuals <= rank + eliminated) return;
  const std::vector<double> silent = residuals.without_response();
  FitResult with = result, without = result;
  with.cost = result.loss_cost;
  with.free_parameters = rank + eliminated;
  without.cost = detail::loss_cost(silent, 1, local) * unit * unit;
  without.free_parameters = residuals.silent_parameters();
  const FTest test = f_test(without, with);
  if (test.p_value < 0.01) return;
  for (ParameterEstimate& estimate : result.parameters) {
    if (estimate.name != offset_name && estimate.name != detail::drift_name && !estimate.fixed) {
      estimate.identified = false;
    }
  }
  char text[160];
  std::snprintf(text, sizeof text,
                " Without any response to the input the output is explained as well (F test, p = %.2g): nothing of the "
                "model is identified.",
                test.p_value);
  result.message += text;
}

// Why there is nothing to fit, if so.
std::string explained_by_offset(const TimeResponseData& data, std::optional<double> offset) {
  const std::vector<double> output = detail::observed(data, data.output());
  const double rest = offset.value_or(output.front());
  if (std::any_of(output.begin(), output.end(), [&](double value) { return value != rest; })) return {};
  return "The output is " + detail::number_text(rest) +
         " throughout: its offset alone explains it, and a response to the input is not identifiable.";
}

// Why no parameter changes the output at the instants that count, if so.
std::string unseen_model(const Structure& structure, const detail::ParameterMap& map, const TimeResponseData& data,
                         const detail::Confidence& found, const std::vector<double>& theta) {
  if (map.free().empty()) return {};
  const double length = data.time()[data.observed().back()] - data.time().front();
  const std::optional<detail::TimeModel> model = detail::time_model_if_any(structure, map.to_user(theta));
  const double delay = model ? dead_time(*model) : 0;
  if (delay >= length) {
    return "The dead time of the model is " + detail::number_text(delay) + " s, no less than the record of " +
           detail::number_text(length) + " s: nothing of the input reaches the output.";
  }
  const bool seen =
      std::any_of(map.free().begin(), map.free().end(), [&](const auto& entry) { return found.seen[entry.parameter]; });
  return seen ? "" : "No parameter of the model changes the output within the record: none is identifiable.";
}

// The offset as a parameter that was not estimated, and why.
void append_held_offset(FitResult& result, const Structure& structure, const std::string& constant) {
  for (std::vector<double>& row : result.covariance) row.push_back(0);
  result.covariance.emplace_back(structure.parameter_names().size() + 1, 0.0);
  result.parameters.push_back({offset_name, 0, 0, nan, nan, true, false, true, 0, 0, false});
  result.message += " The input does not change within the record, so that " + constant +
                    " and the offset are one constant: the offset is held at 0, unless another value is given.";
  result.parameters.back().lower_limit = result.parameters.back().upper_limit = 0;
}

// What a constant of the model is called that acts on every output as the offset does, under this input and wherever
// the parameters are.
std::optional<std::string> constant_of_model(const TimeResponseData& data, const Structure& structure,
                                             const TimeFitOptions& options) {
  const bool changes =
      std::any_of(data.input().begin(), data.input().end(), [&](double each) { return each != data.input().front(); });
  if (changes || data.observed().size() <= structure.parameter_names().size() + 1) return std::nullopt;
  TimeFitOptions plain = options;
  plain.trend = plain.earlier_input = false;
  plain.noise_correlation = 0;
  const auto problem = detail::TimeProblem(data, structure, plain).with_offset(0);
  const detail::ParameterMap& map = problem->map;
  const detail::TimeResiduals residuals = problem->residuals_at(data.observed(), 1e-10);
  if (map.free().empty()) return std::nullopt;
  Eigen::VectorXd weight(static_cast<Eigen::Index>(residuals.count()));
  for (Eigen::Index i = 0; i < weight.size(); ++i) {
    const std::size_t point = data.observed()[static_cast<std::size_t>(i)];
    weight[i] = data.sigma().empty() ? 1 : 1 / data.sigma()[point];
  }
  std::optional<std::string> name;
  int places = 0;
  for (const double shift : {0.0, 0.7, -0.6}) {
    std::vector<double> theta;
    for (std::size_t k = 0; k < map.free().size(); ++k) {
      const auto& free = map.free()[k];
      const double varied = shift * (k % 2 == 0 ? 1 : -1) * (1 + 0.1 * static_cast<double>(k));
      const double start = free.role == ParameterRole::order   ? 0.75 + 0.2 * varied
                           : free.role == ParameterRole::delay ? 0.05 * free.upper * (1 + varied)
                           : free.logarithmic                  ? varied
                                                               : 1 + 0.5 * varied;
      theta.push_back(std::clamp(start, free.lower, free.upper));
    }
    const auto at = detail::linearised(residuals, theta);
    if (!at) continue;
    const Eigen::MatrixXd& jacobian = at->jacobian;
    const Eigen::VectorXd shares = detail::PivotedQr(jacobian).solve(weight);
    constexpr double same = 1e-7;  // the simulation is good to 1e-10
    if (!((jacobian * shares - weight).norm() <= same * weight.norm())) return std::nullopt;
    Eigen::Index largest = 0;
    (jacobian.colwise().norm().transpose().array() * shares.array().abs()).maxCoeff(&largest);
    if (!name) name = structure.parameter_names()[map.free()[static_cast<std::size_t>(largest)].parameter];
    ++places;
  }
  return places >= 2 ? name : std::nullopt;
}

// Chance of so much less cost by more columns, and that share, in residuals freed of the correlation that neighbours
// still have with these columns.
struct Explained {
  double p_value, share;
};
Explained explained(const Eigen::VectorXd& residual, const Eigen::MatrixXd& fitted, const Eigen::MatrixXd& added) {
  Eigen::MatrixXd all(fitted.rows(), fitted.cols() + added.cols());
  all << fitted, added;
  // Columns of equal length: their rank is then seen whatever their units.
  all.colwise().normalize();
  const auto rest_beyond = [](const Eigen::MatrixXd& basis, Eigen::MatrixXd values) -> Eigen::VectorXd {
    detail::remove_span(basis, values);
    return values;
  };
  const auto least_squares = [&](const Eigen::MatrixXd& columns, const Eigen::VectorXd& values) {
    const Eigen::MatrixXd basis = detail::PivotedQr(columns).basis();
    return std::pair{rest_beyond(basis, values), static_cast<double>(basis.cols())};
  };
  const Eigen::MatrixXd basis = detail::PivotedQr(all).basis();
  const Eigen::VectorXd last = rest_beyond(basis, residual);
  const double correlation =
      detail::CorrelatedNoise({last.data(), static_cast<std::size_t>(last.size())}, basis, {1}).correlation();
  const auto freed = [&](const Eigen::MatrixXd& values) -> Eigen::MatrixXd {
    Eigen::MatrixXd result = values;
    result.bottomRows(values.rows() - 1) -= correlation * values.topRows(values.rows() - 1);
    return result;
  };
  const Eigen::VectorXd values = freed(residual);
  const auto [without, few] = least_squares(freed(all.leftCols(fitted.cols())), values);
  const auto [with, many] = least_squares(freed(all), values);
  const double before = without.squaredNorm(), after = with.squaredNorm();
  const double degrees = static_cast<double>(values.size()) - many;
  if (!(many > few) || !(degrees >= 5) || !(after > 0)) return {1, 0};
  const double statistic = (before - after) / (many - few) / (after / degrees);
  return {detail::fisher_f_above(std::clamp(statistic, 0.0, 1e12), many - few, degrees), 1 - after / before};
}

Eigen::MatrixXd with_eliminated(const detail::Linearisation& at, const detail::TimeResiduals& residuals) {
  Eigen::MatrixXd columns(at.jacobian.rows(), at.jacobian.cols() + static_cast<Eigen::Index>(residuals.eliminated()));
  columns << at.jacobian, residuals.eliminated_columns();
  return columns;
}

// Says it where the residuals show a drift, or a start in motion.
void remark_on_background(FitResult& result, const detail::TimeResiduals& residuals, const std::vector<double>& theta,
                          const detail::Confidence& found) {
  if (residuals.cost(theta) <= residuals.rounding_cost() || theta.empty()) return;
  const auto at = detail::linearised(residuals, theta);
  if (!at) return;
  const Eigen::MatrixXd fitted = with_eliminated(*at, residuals);
  const Eigen::MatrixXd more = residuals.possible_background(theta);
  if (more.cols() == 0) return;
  const Eigen::VectorXd rest = at->residuals();
  const Explained drift = explained(rest, fitted, more.leftCols(1));
  const Explained motion = explained(rest, fitted, more.rightCols(more.cols() - 1));
  constexpr double least_chance = 1e-4, worth_saying = 0.05;
  const auto shown = [&](const Explained& each) { return each.p_value < least_chance && each.share > worth_saying; };
  char text[240];
  if (shown(drift) && (!shown(motion) || drift.share > 0.7 * motion.share)) {
    std::snprintf(text, sizeof text, " A steady drift would explain %.0f %% of the cost (F test, p = %.1g).",
                  100 * drift.share, drift.p_value);
    result.message += text;
    result.advice.push_back({Remedy::estimate_trend});
    return;
  }
  if (!shown(motion)) {
    // Far from the truth neither column need explain much by itself.
    constexpr double smooth = 0.9;
    if (!(found.noise.correlation() > smooth)) return;
    result.message +=
        " What is left is smooth, not noise: the model misses a shape, or the record drifts or starts in motion.";
    result.advice.push_back({Remedy::estimate_trend});
  } else {
    std::snprintf(text, sizeof text,
                  " The record seems to start in motion: an input before it would explain %.0f %% of the cost (F test, "
                  "p = %.1g).",
                  100 * motion.share, motion.p_value);
    result.message += text;
  }
  result.advice.push_back({Remedy::estimate_earlier_input});
}

std::string ending(const detail::GlobalSolution& solution, bool is_exact) {
  if (!solution.best.converged) return "The solver stopped before the cost settled; the best point found is returned.";
  const std::string solves = detail::counted(solution.starts, "solve") + " in all.";
  if (is_exact) return "The model meets every sample to rounding; " + solves;
  return detail::counted(solution.starts_at_best, "start") + " ended at the lowest cost; " + solves;
}

// What was taken as the period of the input.
std::string steady_state_text(const detail::PeriodicInput& input, const TimeResponseData& data) {
  if (!input.repeats()) return " Nothing in the input repeats itself: the record counts as one period.";
  const double step = length_of(data) / static_cast<double>(data.size() - 1);
  return " Steady state of an input that repeats itself every " + detail::four_digits(input.period() * step) + " s.";
}

/// @param hopeless  see time_search()
FitResult fit_record(const TimeResponseData& data, const Structure& structure, const TimeFitOptions& wanted,
                     double hopeless, double settled = detail::LocalOptions{}.cost_tolerance) {
  const auto begin = std::chrono::steady_clock::now();
  detail::require_function_of_s(structure);
  require_squares(data);
  const std::optional<std::string> constant = wanted.offset ? std::nullopt : constant_of_model(data, structure, wanted);
  const bool offset_is_held = constant.has_value();
  TimeFitOptions options = wanted;
  if (offset_is_held) options.offset = 0;
  detail::TimeProblem problem(data, structure, options);
  const detail::ParameterMap& map = problem.map;
  const double unit = problem.unit;
  check(data, structure, options, map);
  if (!options.global_start) detail::require_start_values(map, structure);
  const std::string silence = explained_by_offset(data, options.offset);
  const detail::GlobalSolution solution =
      silence.empty() ? time_search(problem, hopeless, settled) : detail::GlobalSolution{};
  detail::LocalSolution best = solution.best;
  detail::TimeResiduals& residuals = problem.residuals();
  FitResult result = describe_search(structure, residuals, solution);
  result.distinct_minima = 1;
  result.confidence_of_optimum = nan;
  const auto seconds = [&] { return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count(); };
  if (solution.starts_at_best == 0) {
    describe_failure(
        result, structure, map,
        silence.empty() ? "The model has no finite response to this input anywhere it was tried." : silence);
    result.seconds = seconds();
    return result;
  }

  detail::LocalOptions local;
  if (options.loss != Loss::none) {
    const auto scale = options.loss_scale ? std::optional(*options.loss_scale / unit) : std::nullopt;
    local = options.global_start ? robust_search(residuals, options.loss, scale, options.seed, best)
                                 : robust_refinement(residuals, options.loss, scale, best);
  }
  // The search simulates to fewer digits than the answer, which some models reach nowhere near their optimum.
  if (!std::isfinite(residuals.cost(best.theta))) {
    describe_failure(result, structure, map,
                     "The best point found has no finite response to this input to the accuracy of the answer.");
    result.seconds = seconds();
    return result;
  }
  const detail::Confidence found = weighed_confidence(problem, best, local);
  result.message = ending(solution, best.cost <= residuals.rounding_cost());
  if (problem.periodic()) result.message += steady_state_text(*problem.periodic(), data);
  const std::string unseen = unseen_model(structure, map, data, found, best.theta);
  if (!unseen.empty()) {
    describe_failure(result, structure, map, unseen);
    result.seconds = seconds();
    return result;
  }
  describe_estimates(result, structure, residuals, options.constraints, found, best.theta);
  if (options.noise_correlation > 0) result.noise_correlation = options.noise_correlation;
  describe_residuals(result, residuals, local, found, best.theta, unit);
  // The misfit is a share of the same deviation whether an offset or a constant of the model takes up the mean.
  if (offset_is_held) result.relative_rms = result.rms / detail::output_deviation(data, wanted.offset);
  for (std::size_t& point : result.outliers) point = data.observed()[point];
  append_background(result, residuals, best.theta, data, options, found);
  if (offset_is_held) append_held_offset(result, structure, *constant);
  if (options.loss == Loss::none && !options.trend && !options.earlier_input) {
    remark_on_background(result, residuals, best.theta, found);
  }
  refuse_unseen_response(result, residuals, local, found.rank, unit);
  for (std::size_t i = 0; i < structure.parameter_names().size(); ++i) {
    // What answers before its input is no model over time.
    double& lower = result.parameters[i].ci95_lower;
    if (structure.parameter_roles()[i] == ParameterRole::delay && lower < 0) lower = 0;
  }
  result.termination = best.converged ? FitTermination::converged : FitTermination::not_converged;
  result.seconds = seconds();
  return result;
}

/// Correlation of noise of first order that is the most likely beside the parameters of a fit.
double correlation_left_by(const FitResult& fit, const TimeResponseData& data, const Structure& structure,
                           const TimeFitOptions& white) {
  const TimeFitOptions known = detail::in_noise(white, 0);
  const detail::TimeProblem problem(data, structure, detail::started_at(detail::settled(known, fit), fit));
  const detail::TimeResiduals residuals = problem.residuals_at(data.observed(), 1e-10);
  const auto at = detail::linearised(residuals, problem.map.to_theta(problem.map.start()));
  if (!at) return 0;
  const Eigen::MatrixXd basis = detail::PivotedQr(with_eliminated(*at, residuals)).basis();
  const detail::RestrictedLikelihood likelihood(at->residual, basis, 1);
  return detail::likeliest_noise(static_cast<double>(at->residual.size()),
                                 [&](double r) { return likelihood.at(r).logarithm; })
      .correlation;
}

}  // namespace

bool detail::same_correlation(double one, double other, double count) {
  return std::abs(one - other) < 0.5 * std::sqrt((1 - one * one) / count);
}

// Parameters and correlation in turn, each the most likely beside the other (Cochrane and Orcutt 1949).  Least squares
// in white noise take a share of slow noise for a response; each round takes less, and the restricted likelihood allows
// for what they take.
double detail::likely_noise_correlation(const TimeResponseData& data, const TimeFitOptions& white,
                                        const FitResult& fit) {
  const Structure structure(fit.model);
  constexpr int most_rounds = 5;
  double r = 0;
  FitResult last = fit;
  for (int round = 0; round < most_rounds; ++round) {
    const double before = r;
    r = correlation_left_by(last, data, structure, white);
    if (round > 0 && same_correlation(r, before, static_cast<double>(points(data)))) break;
    last = refit(data, structure, started_at(in_noise(white, r), last));
    if (last.termination == FitTermination::no_usable_start) break;
  }
  return r;
}

FitResult fit(const TimeResponseData& data, const Structure& structure, const TimeFitOptions& options) {
  if (detail::noise_is_open(options)) {
    return detail::made_in_likely_noise(
        data, options, [&](const TimeFitOptions& told) { return fit(data, structure, told); },
        [](FitResult& made) -> FitResult& { return made; },
        [](const FitResult&, const TimeFitOptions& told) { return told; });
  }
  FitResult result = fit_record(data, structure, options, std::numeric_limits<double>::infinity());
  if (!options.global_start) return result;
  result = detail::no_worse_than_contained(data, structure, options, std::move(result));
  if (std::optional<detail::HoldAdvice> other = detail::hold_advice(data, structure, options, result)) {
    result.message += " " + other->sentence;
    detail::add_advice(other->advice, result.advice);
  }
  return result;
}

FitResult detail::refit(const TimeResponseData& data, const Structure& structure, const TimeFitOptions& options) {
  return fit_record(data, structure, options, std::numeric_limits<double>::infinity(), settled_refit);
}

double detail::scouted_cost(const TimeResponseData& data, const Structure& structure, const TimeFitOptions& options) {
  const TimeProblem problem(data, structure, options);
  const TimeResiduals residuals = problem.residuals_at(data.observed(), 1e-6);
  const std::vector<double> theta = problem.map.to_theta(problem.map.start());
  if (!std::isfinite(residuals.cost(theta))) return std::numeric_limits<double>::infinity();
  LocalOptions quick;
  quick.iterations = 30;
  quick.cost_tolerance = 1e-5;
  return local_solve(residuals, theta, quick).cost * problem.unit * problem.unit;
}

FitResult detail::fit_in_reach(const TimeResponseData& data, const Structure& structure, const TimeFitOptions& options,
                               double hopeless, Profiled) {
  return fit_record(data, structure, options, hopeless);
}

std::vector<double> fitted_output(const FitResult& result, const TimeResponseData& data,
                                  const TimeFitOptions& options) {
  const Structure structure(result.model);
  std::vector<double> parameters;
  double offset = options.offset.value_or(0), drift = 0;
  for (const ParameterEstimate& estimate : result.parameters) {
    if (estimate.name == offset_name) {
      offset = estimate.value;
    } else if (estimate.name == detail::drift_name) {
      drift = estimate.value;
    } else {
      parameters.push_back(estimate.value);
    }
  }
  std::vector<double> output(data.size(), nan);
  std::vector<std::size_t> all(data.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  const detail::RecordResponse response(data, all, detail::periodic_input(data));
  const detail::TimeModel of_parameters = detail::time_model(structure, parameters);
  detail::EventResponse::Result model;
  if (!response.evaluate(of_parameters, detail::finest_simulation, model)) return output;
  for (std::size_t i = 0; i < output.size(); ++i) {
    output[i] = model.value[static_cast<Eigen::Index>(i)] + offset + drift * (data.time()[i] - data.time().front());
  }
  if (result.earlier_input.empty()) return output;
  const std::vector<detail::EventResponse> steps = detail::earlier_steps(data, all);
  for (std::size_t k = 0; k < result.earlier_input.size(); ++k) {
    if (!respond_to(of_parameters, steps[k], detail::finest_simulation, model)) break;
    for (std::size_t i = 0; i < output.size(); ++i) {
      output[i] += result.earlier_input[k] * model.value[static_cast<Eigen::Index>(i)];
    }
  }
  return output;
}

}  // namespace frac
