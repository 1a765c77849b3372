#include "frac/identification/uncertainty.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>
#include <string>

#include "curvature_fit.hpp"
#include "frac/parallel_for.hpp"
#include "profile.hpp"
#include "robust_loss.hpp"

namespace frac {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// Options of a refit that starts where another fit ended.
FitOptions warm(const FitOptions& options, const std::vector<ParameterEstimate>& from) {
  FitOptions result = options;
  result.global_start = false;
  for (const ParameterEstimate& estimate : from) {
    if (estimate.fixed) continue;
    const auto known =
        std::find_if(result.constraints.begin(), result.constraints.end(),
                     [&](const ParameterConstraint& constraint) { return constraint.name == estimate.name; });
    if (known == result.constraints.end()) {
      result.constraints.push_back({estimate.name, {}, {}, {}, estimate.value});
    } else {
      known->start = std::clamp(estimate.value, known->lower.value_or(-infinity), known->upper.value_or(infinity));
    }
  }
  return result;
}

const ParameterEstimate& estimate_of(const FitResult& result, std::string_view name) {
  const Structure structure(result.model);
  return result.parameters[structure.parameter_index(name)];
}

}  // namespace

ProfileInterval profile_interval(const FrequencyResponseData& data, const FitOptions& options, const FitResult& result,
                                 std::string_view parameter) {
  const ParameterEstimate& estimate = estimate_of(result, parameter);
  if (estimate.fixed)
    throw std::invalid_argument("parameter '" + std::string(parameter) + "' is fixed, it has no interval");
  if (estimate.from_other_component || !(std::isfinite(estimate.value))) {
    throw std::invalid_argument("parameter '" + std::string(parameter) + "' is not seen by the fitted component");
  }
  const double degrees = static_cast<double>(result.residuals) - static_cast<double>(result.free_parameters);
  if (!(degrees >= 1)) throw std::invalid_argument("a profile needs more residuals than free parameters");

  const Structure structure(result.model);
  const detail::FitProblem problem(data, structure, options);
  std::vector<double> values;
  for (const ParameterEstimate& each : result.parameters) values.push_back(each.value);
  const std::vector<double> theta = problem.map.to_theta(values);
  const detail::LocalOptions local = detail::robust_options(problem.residuals, theta, options.loss);
  const detail::LocalSolution solution = detail::solution_at(problem.residuals, theta, local);
  const detail::Confidence found = confidence(problem.residuals, solution, local);
  const detail::ProfileEnds ends =
      profile_ends(problem, solution, local, found, structure.parameter_index(parameter), 1e-6, 60);
  return {ends.lower, ends.upper, ends.below_minimum};
}

std::vector<BootstrapInterval> bootstrap(const FrequencyResponseData& data, const FitOptions& options,
                                         const FitResult& result, std::size_t samples, int threads) {
  if (samples < 20) {
    throw std::invalid_argument("a bootstrap of " + std::to_string(samples) +
                                " samples has no percentiles; use at least 20");
  }
  const std::size_t count = data.size();
  const bool only_one_part = options.component == Component::imaginary || options.component == Component::real;
  const std::vector<std::complex<double>> model = fitted_response(result, options.realisation, data.omega());
  // In units of the noise: relative to the model and turned with it, or in the unit of sigma or of the data.
  std::vector<std::complex<double>> unit(count, 1.0);
  std::vector<std::complex<double>> residual(count);
  // Residuals are smaller than the noise, because parameters have followed it.
  const double degrees = static_cast<double>(result.residuals) - static_cast<double>(result.free_parameters);
  const double inflation = degrees > 0 ? std::sqrt(static_cast<double>(result.residuals) / degrees) : 1;
  std::complex<double> mean_residual = 0;
  for (std::size_t i = 0; i < count; ++i) {
    if (options.weight == Weight::given) {
      unit[i] = data.sigma()[i];
    } else if (options.weight != Weight::absolute) {
      unit[i] = only_one_part ? std::abs(data.value()[i]) : model[i];
    }
    residual[i] = inflation * (data.value()[i] - model[i]) / unit[i];
    mean_residual += residual[i] / static_cast<double>(count);
  }
  // Resampling must not add the mean of the residuals once more (Freedman 1981).
  for (std::complex<double>& each : residual) each -= mean_residual;

  const Structure structure(result.model);
  const FitOptions refit = warm(options, result.parameters);
  std::vector<std::vector<double>> values(result.parameters.size(), std::vector<double>(samples));
  parallel_for(samples, threads, [&](std::size_t sample) {
    std::seed_seq seed{options.seed, static_cast<std::uint64_t>(sample)};
    std::mt19937_64 generator(seed);
    std::vector<std::complex<double>> value(count);
    for (std::size_t i = 0; i < count; ++i) {
      value[i] = model[i] + unit[i] * residual[generator() % count];
      // The part that was not fitted follows no model and stays as it is.
      if (options.component == Component::imaginary) value[i].real(data.value()[i].real());
      if (options.component == Component::real) value[i].imag(data.value()[i].imag());
    }
    const FitResult again = detail::curvature_fit({data.omega(), value, data.sigma()}, structure, refit);
    for (std::size_t k = 0; k < values.size(); ++k) values[k][sample] = again.parameters[k].value;
  });

  std::vector<BootstrapInterval> intervals;
  for (std::vector<double>& each : values) {
    std::sort(each.begin(), each.end());
    double mean = 0, square = 0;
    for (const double value : each) mean += value / static_cast<double>(samples);
    for (const double value : each) square += (value - mean) * (value - mean);
    const auto percentile = [&](double share) {
      const double place = share * static_cast<double>(samples - 1);
      const auto below = static_cast<std::size_t>(place);
      const double part = place - static_cast<double>(below);
      return each[below] + (below + 1 < samples ? part * (each[below + 1] - each[below]) : 0);
    };
    intervals.push_back({percentile(0.025), percentile(0.975), std::sqrt(square / static_cast<double>(samples - 1))});
  }
  return intervals;
}

std::vector<ResponseDeviation> response_deviation(const FitResult& result, const Realisation& realisation,
                                                  const std::vector<double>& omega) {
  const Structure structure(result.model);
  const std::size_t count = result.parameters.size();
  std::vector<double> parameters;
  for (const ParameterEstimate& estimate : result.parameters) parameters.push_back(estimate.value);
  std::vector<ResponseDeviation> deviations;
  std::vector<std::complex<double>> gradient(count);
  for (const double each : omega) {
    const std::complex<double> value = structure.response_and_gradient(parameters, each, realisation, gradient);
    double real = 0, imaginary = 0, log_magnitude = 0, phase = 0;
    for (std::size_t i = 0; i < count; ++i) {
      for (std::size_t j = 0; j < count; ++j) {
        const double covariance = result.covariance[i][j];
        if (std::isnan(covariance)) continue;
        real += gradient[i].real() * covariance * gradient[j].real();
        imaginary += gradient[i].imag() * covariance * gradient[j].imag();
        // d ln G = dG/G: its parts are those of ln|G| and of the phase.
        const std::complex<double> left = gradient[i] / value, right = gradient[j] / value;
        log_magnitude += left.real() * covariance * right.real();
        phase += left.imag() * covariance * right.imag();
      }
    }
    const auto root = [](double variance) { return std::sqrt(std::max(variance, 0.0)); };
    deviations.push_back({root(real), root(imaginary), root(log_magnitude), root(phase)});
  }
  return deviations;
}

}  // namespace frac
