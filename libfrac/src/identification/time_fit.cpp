#include "frac/identification/time_fit.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>
#include <numeric>
#include <stdexcept>

#include "autocorrelation.hpp"
#include "confidence.hpp"
#include "global_search.hpp"
#include "information.hpp"
#include "interchange.hpp"
#include "laplace_residuals.hpp"
#include "time_residuals.hpp"

namespace frac {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
// Simulations of the searches, far below any noise, and of the final solve, at rounding.
constexpr double coarse = 1e-8;
constexpr double fine = 1e-13;
constexpr const char* offset_name = "offset";

double length_of(const TimeResponseData& data) {
  return data.time().back() - data.time().front();
}

double root_mean_square(std::vector<double> values, double base) {
  double sum = 0;
  for (const double value : values) sum += (value - base) * (value - base);
  return std::sqrt(sum / static_cast<double>(values.size()));
}

// Gains about what the spread of the output is to the input, frequencies from a third of the record's inverse to three
// times the sampling rate.
detail::DataScale data_scale(const TimeResponseData& data, std::optional<double> offset) {
  const double mean =
      std::accumulate(data.output().begin(), data.output().end(), 0.0) / static_cast<double>(data.size());
  const double spread = root_mean_square(data.output(), offset.value_or(mean));
  const double gain = spread > 0 ? spread / root_mean_square(data.input(), data.input_at_rest()) : 1;
  constexpr double margin = 3;
  const double slow = 1 / length_of(data);
  const double fast = 1 / (data.time()[1] - data.time()[0]);
  return {gain, gain / 30, gain * 30, std::sqrt(slow * fast), slow / margin, fast * margin};
}

// A dead time beyond the record would leave nothing to fit.
std::vector<ParameterConstraint> with_delay_limits(const Structure& structure,
                                                   std::vector<ParameterConstraint> constraints, double length) {
  for (std::size_t i = 0; i < structure.parameter_names().size(); ++i) {
    if (structure.parameter_roles()[i] != ParameterRole::delay) continue;
    const std::string& name = structure.parameter_names()[i];
    const auto given = std::find_if(constraints.begin(), constraints.end(),
                                    [&](const ParameterConstraint& each) { return each.name == name; });
    if (given == constraints.end()) {
      constraints.push_back({name, {}, {}, length, {}});
    } else if (!given->fixed && !given->upper) {
      given->upper = std::max(length, 2 * given->start.value_or(0));
    }
  }
  return constraints;
}

void check(const TimeResponseData& data, const Structure& structure, const TimeFitOptions& options,
           const detail::ParameterMap& map) {
  for (const std::string& name : structure.parameter_names()) {
    if (name == offset_name) {
      throw std::invalid_argument(
          "parameter 'offset': the name stands for the output at rest; rename it in the formula");
    }
  }
  if (options.offset && !std::isfinite(*options.offset)) {
    throw std::invalid_argument("offset = " + std::to_string(*options.offset) + "; allowed is a finite number");
  }
  // Whether it reduces does not depend on the values; those of a start may be missing.
  std::vector<double> values;
  for (std::size_t i = 0; i < structure.parameter_names().size(); ++i) {
    const bool is_order = structure.parameter_roles()[i] == ParameterRole::order;
    const double known = map.start()[i];
    values.push_back(std::isnan(known) ? (is_order ? 0.7 + 0.01 * static_cast<double>(i) : 0.5) : known);
  }
  static_cast<void>(detail::reduce(structure.expression(), values, detail::Sensitivity::all));
  const std::size_t free = map.free().size() + (options.offset ? 0 : 1);
  if (data.size() < free) {
    throw std::invalid_argument(std::to_string(data.size()) + " samples cannot determine " + std::to_string(free) +
                                " free parameters" + (options.offset ? "" : ", the offset among them"));
  }
}

std::vector<std::size_t> every_nth(std::size_t count, std::size_t enough) {
  const std::size_t stride = (count + enough - 1) / enough;
  std::vector<std::size_t> index;
  for (std::size_t i = 0; i < count; i += stride) index.push_back(i);
  if (index.back() + 1 != count) index.push_back(count - 1);
  return index;
}

bool is_complete(const std::vector<double>& start, const detail::ParameterMap& map) {
  return std::none_of(map.free().begin(), map.free().end(),
                      [&](const auto& entry) { return std::isnan(start[entry.parameter]); });
}

// Standard deviation of the weighted output: the unit of the residuals the solvers see.
double unit_of(const TimeResponseData& data, std::optional<double> offset) {
  double weights = 0, mean = 0;
  const auto weight = [&](std::size_t i) { return data.sigma().empty() ? 1 : 1 / data.sigma()[i]; };
  for (std::size_t i = 0; i < data.size(); ++i) {
    weights += weight(i) * weight(i);
    mean += weight(i) * weight(i) * data.output()[i];
  }
  mean = offset.value_or(mean / weights);
  double sum = 0;
  for (std::size_t i = 0; i < data.size(); ++i) sum += std::pow(weight(i) * (data.output()[i] - mean), 2);
  const double unit = std::sqrt(sum / static_cast<double>(data.size()));
  return unit > 0 ? unit : 1;
}

// From start values in the domain of Laplace, or given ones, to the best of their minima in time.
class TimeSearch {
 public:
  TimeSearch(const TimeResponseData& data, const Structure& structure, const detail::ParameterMap& map,
             const TimeFitOptions& options, double unit)
      : data_(data), structure_(structure), map_(map), options_(options), unit_(unit) {
    result_.best.cost = std::numeric_limits<double>::infinity();
  }

  detail::GlobalSolution run() {
    constexpr std::size_t enough = 500;
    const detail::TimeResiduals few = residuals(every_nth(data_.size(), enough), coarse);
    if (is_complete(map_.start(), map_)) try_from(few, map_.to_theta(map_.start()));
    if (options_.global_start && !map_.free().empty() && !is_exact(few)) {
      search_transforms(few);
      if (at_best() < 2 && !is_exact(few)) {
        // The transform misled, or the two best differ: search among simulations, of few points.
        constexpr std::size_t very_few = 120;
        const detail::TimeResiduals sparse = residuals(every_nth(data_.size(), very_few), 1e-5);
        const detail::GlobalSolution found = detail::global_search(sparse, sparse, {}, options_.seed);
        if (found.starts_at_best > 0) try_from(few, found.best.theta);
        result_.starts += found.starts;
      }
    }
    if (!std::isfinite(result_.best.cost)) return {};
    const detail::TimeResiduals all = residuals(every_nth(data_.size(), data_.size()), fine);
    result_.starts_at_best = at_best();
    result_.best.theta =
        map_.to_theta(detail::with_labels_in_order(structure_, options_.constraints, map_.to_user(result_.best.theta)));
    result_.best = local_solve(all, result_.best.theta, {});
    if (!result_.best.converged) {
      detail::LocalOptions patient;
      patient.iterations = 1000;
      result_.best = local_solve(all, result_.best.theta, patient);
    }
    return result_;
  }

  [[nodiscard]] detail::TimeResiduals residuals(std::vector<std::size_t> index, double tolerance) const {
    return {data_, structure_, map_, options_.offset, std::move(index), tolerance, unit_};
  }

 private:
  void try_from(const detail::Residuals& few, const std::vector<double>& theta) {
    ++result_.starts;
    if (!std::isfinite(few.cost(theta))) return;
    const detail::LocalSolution found = local_solve(few, theta, {});
    ends_.push_back(found.cost);
    floor_ = few.rounding_cost();
    // Of equal minima the first counts: the user's start names the parameters.
    if (found.cost + floor_ < result_.best.cost || ends_.size() == 1) result_.best = found;
  }

  [[nodiscard]] bool is_exact(const detail::Residuals& few) const { return result_.best.cost <= few.rounding_cost(); }

  [[nodiscard]] std::size_t at_best() const {
    return static_cast<std::size_t>(std::count_if(
        ends_.begin(), ends_.end(), [&](double cost) { return cost <= result_.best.cost * (1 + 1e-6) + floor_; }));
  }

  // What weighs the end of the record more sees slow modes better and is cut off more: their minima differ, and those
  // that agree in time agree for a reason.
  void search_transforms(const detail::TimeResiduals& few) {
    for (const double decay : {8.0, 4.0, 2.0}) {
      const detail::LaplaceResiduals transformed(data_, structure_, map_, options_.offset, decay);
      if (transformed.points() < map_.free().size()) continue;
      const detail::GlobalSolution found = detail::global_search(
          transformed, transformed, detail::suggested_orders(transformed.quotient()), options_.seed);
      result_.starts += found.starts;
      if (found.starts_at_best > 0) try_from(few, found.best.theta);
      if (is_exact(few)) return;
    }
  }

  const TimeResponseData& data_;
  const Structure& structure_;
  const detail::ParameterMap& map_;
  const TimeFitOptions& options_;
  double unit_;
  detail::GlobalSolution result_;
  std::vector<double> ends_;
  double floor_ = 0;
};

std::vector<std::size_t> outliers(std::vector<double> residual) {
  std::vector<double> size = residual;
  for (double& each : size) each = std::abs(each);
  const auto middle = size.begin() + static_cast<std::ptrdiff_t>(size.size() / 2);
  std::nth_element(size.begin(), middle, size.end());
  // Five robust standard deviations: one in two million of normal residuals.
  const double limit = 5 * 1.4826 * *middle;
  std::vector<std::size_t> found;
  for (std::size_t i = 0; i < residual.size(); ++i) {
    if (std::abs(residual[i]) > limit) found.push_back(i);
  }
  return found;
}

// The offset as one more parameter: the mean of what the model leaves, with the spread of that mean and, through the
// model, that of the parameters.
void append_offset(FitResult& result, const detail::TimeResiduals& residuals, const std::vector<double>& theta,
                   const TimeResponseData& data, double deviation, double t) {
  const auto [value, mean_gradient] = residuals.offset(theta);
  double information = 0;
  for (std::size_t i = 0; i < data.size(); ++i) {
    information += data.sigma().empty() ? 1 : 1 / (data.sigma()[i] * data.sigma()[i]);
  }
  const std::size_t count = result.covariance.size();
  std::vector<double> covariance(count + 1, 0.0);
  double variance = deviation * deviation / information;
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t j = 0; j < count; ++j) {
      const double both = result.covariance[i][j];
      if (std::isnan(both)) continue;
      covariance[i] -= mean_gradient[static_cast<Eigen::Index>(j)] * both;
      variance += mean_gradient[static_cast<Eigen::Index>(i)] * mean_gradient[static_cast<Eigen::Index>(j)] * both;
    }
    if (std::isnan(result.covariance[i][i])) covariance[i] = nan;
  }
  covariance[count] = variance;
  for (std::size_t i = 0; i < count; ++i) result.covariance[i].push_back(covariance[i]);
  result.covariance.push_back(covariance);
  const double error = std::sqrt(variance);
  // An offset of nothing is identified as well: there is no relative width to judge.
  result.parameters.push_back(
      {offset_name, value, error, value - t * error, value + t * error, false, false, true, value, error, false});
}

std::string ending(const detail::GlobalSolution& solution, bool is_exact) {
  if (!solution.best.converged) return "The solver stopped before the cost settled; the best point found is returned.";
  const std::string solves =
      std::to_string(solution.starts) + (solution.starts == 1 ? " solve" : " solves") + " in all.";
  if (is_exact) return "The model meets every sample to rounding; " + solves;
  return std::to_string(solution.starts_at_best) + (solution.starts_at_best == 1 ? " start" : " starts") +
         " ended at the lowest cost; " + solves;
}

}  // namespace

FitResult fit(const TimeResponseData& data, const Structure& structure, const TimeFitOptions& options) {
  const auto begin = std::chrono::steady_clock::now();
  const detail::ParameterMap map(structure, with_delay_limits(structure, options.constraints, length_of(data)),
                                 data_scale(data, options.offset));
  check(data, structure, options, map);
  if (!options.global_start && !is_complete(map.start(), map)) {
    for (const auto& entry : map.free()) {
      if (!std::isnan(map.start()[entry.parameter])) continue;
      throw std::invalid_argument("parameter '" + structure.parameter_names()[entry.parameter] +
                                  "' has no start value, and the search for one is switched off");
    }
  }
  const double unit = unit_of(data, options.offset);
  TimeSearch search(data, structure, map, options, unit);
  const detail::GlobalSolution solution = search.run();
  const auto& names = structure.parameter_names();

  FitResult result{};
  result.model = structure.formula();
  result.residuals = data.size();
  result.free_parameters = map.free().size() + (options.offset ? 0 : 1);
  result.starts = solution.starts;
  result.starts_at_best = solution.starts_at_best;
  result.distinct_minima = 1;
  result.confidence_of_optimum = nan;
  result.centre_omega = map.scale().omega;
  const auto seconds = [&] { return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count(); };
  if (solution.starts_at_best == 0) {
    result.cost = result.rms = result.max_residual = result.aicc = result.bic = result.condition = nan;
    result.termination = FitTermination::no_usable_start;
    result.message = "The model has no finite response to this input anywhere it was tried.";
    for (std::size_t i = 0; i < names.size(); ++i) {
      result.parameters.push_back({names[i], nan, nan, nan, nan, map.is_fixed(i), false, false, nan, nan, false});
    }
    result.seconds = seconds();
    return result;
  }

  const detail::TimeResiduals residuals = search.residuals(every_nth(data.size(), data.size()), fine);
  const detail::Confidence found = confidence(residuals, solution.best, {});
  const std::vector<double> values = map.to_user(solution.best.theta);
  for (std::size_t i = 0; i < names.size(); ++i) {
    const bool fixed = map.is_fixed(i);
    const double half_width = found.t * found.standard_error[i];
    result.parameters.push_back({names[i], values[i], fixed ? 0 : found.standard_error[i],
                                 fixed ? nan : values[i] - half_width, fixed ? nan : values[i] + half_width, fixed,
                                 found.at_bound[i], found.identified[i] && !found.at_bound[i], values[i],
                                 fixed ? 0 : found.centre_standard_error[i], false});
  }
  for (std::size_t k = 0; k < map.free().size(); ++k) {
    result.parameters[map.free()[k].parameter].centre_value = map.centre_value(k, values);
  }
  result.covariance = found.covariance;

  std::vector<double> residual(data.size());
  residuals.evaluate(solution.best.theta, residual.data(), nullptr);
  for (double& each : residual) each *= unit;
  const std::size_t rank = found.rank + residuals.eliminated();
  const detail::Information information = detail::information(residual, rank, unit);
  result.cost = information.cost;
  result.rms = information.rms;
  result.max_residual = information.max_residual;
  result.aicc = information.aicc;
  result.bic = information.bic;
  result.condition = found.condition;
  result.outliers = outliers(std::move(residual));
  if (!options.offset) {
    const double degrees_of_freedom = static_cast<double>(data.size()) - static_cast<double>(rank);
    const double deviation = degrees_of_freedom > 0 ? std::sqrt(result.cost / degrees_of_freedom) : nan;
    append_offset(result, residuals, solution.best.theta, data, deviation, found.t);
  }
  result.termination = solution.best.converged ? FitTermination::converged : FitTermination::not_converged;
  result.message = ending(solution, solution.best.cost <= residuals.rounding_cost());
  if (found.condition > detail::flat_condition) {
    char text[128];
    std::snprintf(text, sizeof text,
                  " The scaled Fisher condition is %.1e, beyond %.0e: some parameters only trade off.", found.condition,
                  detail::flat_condition);
    result.message += text;
  }
  result.seconds = seconds();
  return result;
}

std::vector<double> fitted_output(const FitResult& result, const TimeResponseData& data,
                                  const TimeFitOptions& options) {
  const Structure structure(result.model);
  std::vector<double> parameters;
  double offset = options.offset.value_or(0);
  for (const ParameterEstimate& estimate : result.parameters) {
    if (estimate.name == offset_name) {
      offset = estimate.value;
    } else {
      parameters.push_back(estimate.value);
    }
  }
  std::vector<double> output(data.size(), nan);
  const auto events = detail::event_response(data, every_nth(data.size(), data.size()));
  detail::EventResponse::Result model;
  if (!events.evaluate(detail::reduce(structure.expression(), parameters), fine, model)) return output;
  for (std::size_t i = 0; i < output.size(); ++i) output[i] = model.value[static_cast<Eigen::Index>(i)] + offset;
  return output;
}

ResidualWhiteness residual_whiteness(const TimeResponseData& data, const TimeFitOptions& options,
                                     const FitResult& result) {
  std::vector<double> residual = fitted_output(result, data, options);
  for (std::size_t i = 0; i < residual.size(); ++i) {
    residual[i] = (data.output()[i] - residual[i]) / (data.sigma().empty() ? 1 : data.sigma()[i]);
  }
  return detail::whiteness(residual, 1);
}

}  // namespace frac
