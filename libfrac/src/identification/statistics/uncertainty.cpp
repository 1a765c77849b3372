// SPDX-License-Identifier: BSD-3-Clause
#include "frac/identification/uncertainty.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <random>
#include <stdexcept>
#include <string>
#include <utility>

#include "carried_variance.hpp"
#include "curvature_fit.hpp"
#include "frac/identification/statistics.hpp"
#include "frac/parallel_for.hpp"
#include "identification/data/fit_data.hpp"
#include "identification/residuals/frequency_problem.hpp"
#include "identification/residuals/time_problem.hpp"
#include "profile.hpp"

namespace frac {

namespace {

const ParameterEstimate& estimate_of(const FitResult& result, std::string_view name) {
  const auto found = std::find_if(result.parameters.begin(), result.parameters.end(),
                                  [&](const ParameterEstimate& each) { return each.name == name; });
  if (found == result.parameters.end()) {
    throw std::invalid_argument("unknown parameter '" + std::string(name) + "'");
  }
  return *found;
}

/// Estimate of a parameter that can be profiled. @throws std::invalid_argument  as profile_interval().
const ParameterEstimate& profiled(const FitResult& result, std::string_view parameter) {
  const ParameterEstimate& estimate = estimate_of(result, parameter);
  if (estimate.fixed)
    throw std::invalid_argument("parameter '" + std::string(parameter) + "' is fixed, it has no interval");
  if (estimate.from_other_component || !(std::isfinite(estimate.value))) {
    throw std::invalid_argument("parameter '" + std::string(parameter) + "' is not seen by the fitted component");
  }
  if (result.residuals <= result.free_parameters)
    throw std::invalid_argument("a profile needs more residuals than free parameters");
  return estimate;
}

// To this share of an interval, within so many refits.
constexpr double profile_tolerance = 1e-6;
constexpr int profile_steps = 60;

/// Residuals drawn anew.  Of first-order noise with correlation r it is the fresh part e_i - r e_(i-1) that is drawn.
template <class Value>
class Redrawn {
 public:
  Redrawn(std::vector<Value> residual, double correlation) : residual_(std::move(residual)), correlation_(correlation) {
    for (std::size_t i = 1; i < residual_.size(); ++i) fresh_.push_back(residual_[i] - correlation * residual_[i - 1]);
    if (fresh_.empty()) fresh_ = residual_;
  }

  [[nodiscard]] std::vector<Value> draw(std::mt19937_64& generator) const {
    std::vector<Value> result(residual_.size());
    Value last = residual_[generator() % residual_.size()];
    for (Value& each : result) {
      each = last;
      last = correlation_ * last + fresh_[generator() % fresh_.size()];
    }
    return result;
  }

 private:
  std::vector<Value> residual_, fresh_;
  double correlation_;
};

/// Data made of the fitted curve and residuals drawn from those left, for the bootstrap.
class FrequencyResampling {
 public:
  FrequencyResampling(const FrequencyResponseData& data, const FitOptions& options, const FitResult& result,
                      double inflation)
      : data_(data),
        component_(options.component),
        model_(fitted_response(result, options.realisation, data.omega())),
        unit_(data.size(), 1.0) {
    std::vector<std::complex<double>> residual(data.size());
    const bool only_one_part = component_ == Component::imaginary || component_ == Component::real;
    const std::size_t count = data.size();
    std::complex<double> mean = 0;
    for (std::size_t i = 0; i < count; ++i) {
      // In units of the noise: relative to the model and turned with it, or in the unit of sigma or of the data.
      if (options.weight == Weight::given) {
        unit_[i] = data.sigma()[i];
      } else if (options.weight == Weight::learned && options.noise_floor.value_or(0) > 0) {
        unit_[i] = std::hypot(std::abs(model_[i]), *options.noise_floor);
      } else if (options.weight != Weight::absolute) {
        unit_[i] = only_one_part ? std::abs(data.value()[i]) : model_[i];
      }
      residual[i] = inflation * (data.value()[i] - model_[i]) / unit_[i];
      mean += residual[i] / static_cast<double>(count);
    }
    // Outliers move the mean, and a robust fit cares for neither.
    if (options.loss == Loss::none) {
      for (std::complex<double>& each : residual) each -= mean;
    }
    residual_.emplace(std::move(residual), result.noise_correlation);
  }

  [[nodiscard]] FrequencyResponseData draw(std::mt19937_64& generator) const {
    std::vector<std::complex<double>> value = residual_->draw(generator);
    for (std::size_t i = 0; i < value.size(); ++i) {
      value[i] = model_[i] + unit_[i] * value[i];
      // The part that was not fitted follows no model and stays as it is.
      if (component_ == Component::imaginary) value[i].real(data_.value()[i].real());
      if (component_ == Component::real) value[i].imag(data_.value()[i].imag());
    }
    return {data_.omega(), std::move(value), data_.sigma()};
  }

 private:
  const FrequencyResponseData& data_;
  Component component_;
  std::vector<std::complex<double>> model_, unit_;
  std::optional<Redrawn<std::complex<double>>> residual_;
};

class TimeResampling {
 public:
  TimeResampling(const TimeResponseData& data, const TimeFitOptions& options, const FitResult& result, double inflation)
      : data_(data), model_(fitted_output(result, data, options)) {
    // Those of the output itself: the correlation they are redrawn with is told beside them.
    TimeFitOptions white = options;
    white.noise_correlation = 0;
    std::vector<double> residual = detail::weighted_residuals(data, white, result);
    double mean = 0;
    if (options.loss == Loss::none) {
      for (const double each : residual) mean += each / static_cast<double>(residual.size());
    }
    for (double& each : residual) each = -inflation * (each - mean);
    residual_.emplace(std::move(residual), result.noise_correlation);
  }

  [[nodiscard]] TimeResponseData draw(std::mt19937_64& generator) const {
    std::vector<double> output = model_;
    const std::vector<double> noise = residual_->draw(generator);
    for (std::size_t i = 0; i < noise.size(); ++i) {
      const std::size_t point = data_.observed()[i];
      output[point] += (data_.sigma().empty() ? 1 : data_.sigma()[point]) * noise[i];
    }
    return TimeResponseData(data_.time(), data_.input(), std::move(output), data_.sigma(), data_.hold(),
                            data_.input_at_rest())
        .observed_at(data_.observed());
  }

 private:
  const TimeResponseData& data_;
  std::vector<double> model_;
  std::optional<Redrawn<double>> residual_;
};

double inflation(const FitResult& result) {
  // Residuals are smaller than the noise, because parameters have followed it.
  const double degrees = static_cast<double>(result.residuals) - static_cast<double>(result.free_parameters);
  return degrees > 0 ? std::sqrt(static_cast<double>(result.residuals) / degrees) : 1;
}

BootstrapInterval percentiles(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const auto samples = static_cast<double>(values.size());
  double mean = 0, square = 0;
  // From the first: values that are all alike spread by nothing.
  for (const double value : values) mean += (value - values.front()) / samples;
  mean += values.front();
  for (const double value : values) square += (value - mean) * (value - mean);
  const auto percentile = [&](double share) {
    const double place = share * (samples - 1);
    const auto below = static_cast<std::size_t>(place);
    const double part = place - static_cast<double>(below);
    return values[below] + (below + 1 < values.size() ? part * (values[below + 1] - values[below]) : 0);
  };
  return {percentile(0.025), percentile(0.975), std::sqrt(square / (samples - 1))};
}

template <class Resampling, class Options>
std::function<std::vector<double>(std::size_t)> refit_of(Resampling resampling, const Options& options,
                                                         const FitResult& result) {
  const Structure structure(result.model);
  return
      [resampling = std::move(resampling), structure, refit = detail::started_at(options, result)](std::size_t sample) {
        std::seed_seq seed{refit.seed, static_cast<std::uint64_t>(sample)};
        std::mt19937_64 generator(seed);
        std::vector<double> values;
        for (const auto& parameter : detail::curvature_fit(resampling.draw(generator), structure, refit).parameters)
          values.push_back(parameter.value);
        return values;
      };
}

void check_samples(std::size_t samples) {
  if (samples < 20) {
    throw std::invalid_argument("a bootstrap of " + std::to_string(samples) +
                                " samples has no percentiles; use at least 20");
  }
}

std::vector<BootstrapInterval> bootstrap_of(const BootstrapRefits& refits, std::size_t samples, int threads) {
  check_samples(samples);
  std::vector<std::vector<double>> values(samples);
  parallel_for(samples, threads, [&](std::size_t sample) { values[sample] = refits.parameters(sample); });
  return bootstrap_intervals(values);
}

/// The interval of an estimate, as the problem whose solution the result is has it.
ProfileInterval interval_in(detail::Problem& problem, Loss loss, const FitResult& result,
                            const ParameterEstimate& estimate) {
  detail::Residuals& residuals = problem.residuals();
  if (result.loss_unit > 0) residuals.set_priors(problem.priors, std::sqrt(result.loss_unit) / problem.unit);
  detail::LocalOptions local;
  if (std::isfinite(result.loss_scale)) {
    local.loss = loss;
    local.loss_scale = result.loss_scale / problem.unit;
  }
  residuals.set_loss(local.loss, local.loss_scale);
  std::vector<double> values;
  for (std::size_t i = 0; i < problem.structure.parameter_names().size(); ++i)
    values.push_back(result.parameters[i].value);
  const detail::LocalSolution solution = detail::solution_at(residuals, problem.map.to_theta(values), local);
  const detail::Confidence found = confidence(residuals, solution, local);
  const auto& names = problem.structure.parameter_names();
  const auto place = std::find(names.begin(), names.end(), estimate.name);
  const detail::ProfileCentre centre =
      place != names.end() ? profile_centre(problem, solution, found, static_cast<std::size_t>(place - names.begin()))
                           : detail::ProfileCentre{estimate.name, estimate.value,
                                                   estimate.standard_error / estimate.widening, estimate.widening};
  const detail::ProfileEnds ends =
      profile_ends(problem, solution, local, found, centre, profile_tolerance, profile_steps);
  return {ends.lower, ends.upper, ends.below_minimum};
}

template <class Problem, class Data, class Options>
ProfileInterval interval_of(const Data& data, const Options& options, const FitResult& result,
                            std::string_view parameter) {
  const ParameterEstimate& estimate = profiled(result, parameter);
  const Structure structure(result.model);
  Problem problem(data, structure, detail::settled(options, result));
  return interval_in(problem, options.loss, result, estimate);
}

}  // namespace

ProfileInterval profile_interval(const FrequencyResponseData& data, const FitOptions& options, const FitResult& result,
                                 std::string_view parameter) {
  return interval_of<detail::FrequencyProblem>(data, options, result, parameter);
}

ProfileInterval profile_interval(const TimeResponseData& data, const TimeFitOptions& options, const FitResult& result,
                                 std::string_view parameter) {
  return interval_of<detail::TimeProblem>(data, options, result, parameter);
}

BootstrapRefits::BootstrapRefits(const FrequencyResponseData& data, const FitOptions& options,
                                 const FitResult& result) {
  const FitOptions known = detail::settled(options, result);
  refit_ = refit_of(FrequencyResampling(data, known, result, inflation(result)), known, result);
}

BootstrapRefits::BootstrapRefits(const TimeResponseData& data, const TimeFitOptions& options, const FitResult& result) {
  const TimeFitOptions known = detail::settled(options, result);
  refit_ = refit_of(TimeResampling(data, known, result, inflation(result)), known, result);
}

std::vector<BootstrapInterval> bootstrap_intervals(const std::vector<std::vector<double>>& refits) {
  check_samples(refits.size());
  std::vector<BootstrapInterval> intervals;
  intervals.reserve(refits.front().size());
  for (std::size_t k = 0; k < refits.front().size(); ++k) {
    std::vector<double> values;
    values.reserve(refits.size());
    for (const std::vector<double>& refit : refits) values.push_back(refit.at(k));
    intervals.push_back(percentiles(std::move(values)));
  }
  return intervals;
}

std::vector<BootstrapInterval> bootstrap(const FrequencyResponseData& data, const FitOptions& options,
                                         const FitResult& result, std::size_t samples, int threads) {
  return bootstrap_of(BootstrapRefits(data, options, result), samples, threads);
}

std::vector<BootstrapInterval> bootstrap(const TimeResponseData& data, const TimeFitOptions& options,
                                         const FitResult& result, std::size_t samples, int threads) {
  return bootstrap_of(BootstrapRefits(data, options, result), samples, threads);
}

std::vector<ResponseDeviation> response_deviation(const FitResult& result, const Realisation& realisation,
                                                  const std::vector<double>& omega) {
  const Structure structure(result.model);
  // Parameters of a record over time, its offset and drift, stand behind those of the model.
  const std::size_t count = structure.parameter_names().size();
  std::vector<double> parameters;
  for (std::size_t i = 0; i < count; ++i) parameters.push_back(result.parameters.at(i).value);
  std::vector<ResponseDeviation> deviations;
  std::vector<std::complex<double>> gradient(count);
  for (const double each : omega) {
    const std::complex<double> value = structure.response_and_gradient(parameters, each, realisation, gradient);
    const auto deviation_of = [&](const auto& derivative) {
      std::vector<double> derivatives;
      for (const std::complex<double> each : gradient) derivatives.push_back(derivative(each));
      return std::sqrt(detail::carried_variance(result.covariance, derivatives));
    };
    // d ln G = dG/G: its parts are those of ln|G| and of the phase.
    deviations.push_back({deviation_of([](std::complex<double> each) { return each.real(); }),
                          deviation_of([](std::complex<double> each) { return each.imag(); }),
                          deviation_of([&](std::complex<double> each) { return (each / value).real(); }),
                          deviation_of([&](std::complex<double> each) { return (each / value).imag(); })});
  }
  return deviations;
}

}  // namespace frac
