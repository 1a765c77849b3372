#include "residuals.hpp"

#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

namespace frac::detail {

namespace {

/// 1/scale of the residual at each point; relative magnitude and phase are pure numbers already.
std::vector<double> point_weights(const FrequencyResponseData& data, Component component, Weight weight) {
  if (weight == Weight::given && data.sigma().empty()) {
    throw std::invalid_argument("weight 'given' needs a standard deviation for each value, the data have none");
  }
  const bool needs_magnitude = component == Component::phase || (weight == Weight::relative);
  std::vector<double> result(data.size(), 1.0);
  for (std::size_t i = 0; i < data.size(); ++i) {
    const double magnitude = std::abs(data.value()[i]);
    if (needs_magnitude && !(magnitude > 0)) {
      throw std::invalid_argument("the value at omega = " + std::to_string(data.omega()[i]) +
                                  " rad/s is 0, which has no phase and no relative residual; use absolute weight");
    }
    switch (weight) {
      case Weight::relative:
        if (component != Component::phase && component != Component::magnitude) result[i] = 1 / magnitude;
        break;
      case Weight::absolute:
        break;
      case Weight::given:
        // The phase of a value with standard deviation sigma is known to sigma/|value|.
        result[i] = component == Component::phase ? magnitude / data.sigma()[i] : 1 / data.sigma()[i];
        break;
    }
  }
  return result;
}

bool is_finite(std::complex<double> value) {
  return std::isfinite(value.real()) && std::isfinite(value.imag());
}

/// Residual of one point; false where the component of the model does not exist.
bool point_residual(Component component, bool logarithmic_magnitude, double weight, std::complex<double> model,
                    std::complex<double> data, double* residual) {
  switch (component) {
    case Component::imaginary:
      residual[0] = weight * (model.imag() - data.imag());
      return true;
    case Component::real:
      residual[0] = weight * (model.real() - data.real());
      return true;
    case Component::both:
      residual[0] = weight * (model.real() - data.real());
      residual[1] = weight * (model.imag() - data.imag());
      return true;
    case Component::magnitude:
      if (logarithmic_magnitude) {
        residual[0] = weight * std::log(std::abs(model) / std::abs(data));
      } else {
        residual[0] = weight * (std::abs(model) - std::abs(data));
      }
      return std::isfinite(residual[0]);
    case Component::phase:
      residual[0] = weight * std::arg(model / data);
      return model != 0.0;
  }
  return false;
}

/// Derivative of the residual from that of the model.
void point_derivative(Component component, bool logarithmic_magnitude, double weight, std::complex<double> model,
                      std::complex<double> derivative, double* first, double* second) {
  switch (component) {
    case Component::imaginary:
      *first = weight * derivative.imag();
      break;
    case Component::real:
      *first = weight * derivative.real();
      break;
    case Component::both:
      *first = weight * derivative.real();
      *second = weight * derivative.imag();
      break;
    case Component::magnitude: {
      const double relative = (derivative / model).real();
      *first = weight * (logarithmic_magnitude ? relative : std::abs(model) * relative);
      break;
    }
    case Component::phase:
      *first = weight * (derivative / model).imag();
      break;
  }
}

}  // namespace

double residual_unit(const FrequencyResponseData& data, Component component, Weight weight) {
  const std::vector<double> weights = point_weights(data, component, weight);
  if (component == Component::phase || weight == Weight::relative) return 1;
  double sum = 0;
  for (std::size_t i = 0; i < data.size(); ++i) sum += std::norm(weights[i] * data.value()[i]);
  return sum > 0 ? std::sqrt(sum / static_cast<double>(data.size())) : 1;
}

std::size_t residuals_per_point(Component component) {
  return component == Component::both ? 2 : 1;
}

Residuals::Residuals(const FrequencyResponseData& data, const Structure& structure, const FitOptions& options,
                     const ParameterMap& map)
    : data_(data),
      structure_(structure),
      map_(map),
      component_(options.component),
      realisation_(options.realisation),
      logarithmic_magnitude_(options.weight == Weight::relative),
      weight_(point_weights(data, options.component, options.weight)),
      unit_(residual_unit(data, options.component, options.weight)),
      value_(data.size()),
      gradient_(data.size() * map.parameter_count()),
      scratch_(count()) {
  for (double& weight : weight_) weight /= unit_;
}

bool Residuals::evaluate(std::span<const double> theta, std::size_t first, std::size_t points, double* residual,
                         double* jacobian_row_major) const {
  const std::vector<double> parameters = map_.to_user(theta);
  const std::span omega(data_.omega().data() + first, points);
  const std::span value(value_.data(), points);
  const std::size_t all = map_.parameter_count();
  if (jacobian_row_major) {
    structure_.response_and_gradient(parameters, omega, realisation_, value, std::span(gradient_.data(), points * all));
  } else {
    structure_.response(parameters, omega, realisation_, value);
  }

  for (std::size_t i = 0; i < points; ++i) {
    if (!is_finite(value[i]) || !point_residual(component_, logarithmic_magnitude_, weight_[first + i], value[i],
                                                data_.value()[first + i], residual + i * per_point())) {
      return false;
    }
  }
  if (!jacobian_row_major) return true;

  RowMajorMatrix by_parameter(static_cast<Eigen::Index>(points * per_point()), static_cast<Eigen::Index>(all));
  for (std::size_t i = 0; i < points; ++i) {
    double* row = by_parameter.data() + i * per_point() * all;
    for (std::size_t j = 0; j < all; ++j) {
      point_derivative(component_, logarithmic_magnitude_, weight_[first + i], value[i], gradient_[i * all + j],
                       row + j, per_point() == 2 ? row + j + all : nullptr);
    }
  }
  Eigen::Map<RowMajorMatrix> jacobian(jacobian_row_major, by_parameter.rows(),
                                      static_cast<Eigen::Index>(map_.free().size()));
  jacobian.noalias() = by_parameter.lazyProduct(map_.jacobian(parameters));
  return jacobian.allFinite();
}

double Residuals::cost(std::span<const double> theta) const {
  if (!evaluate(theta, 0, points(), scratch_.data(), nullptr)) return std::numeric_limits<double>::infinity();
  double sum = 0;
  for (const double residual : scratch_) sum += residual * residual;
  return std::isfinite(sum) ? sum : std::numeric_limits<double>::infinity();
}

double Residuals::best_factor(std::span<const double> theta) const {
  if (component_ == Component::phase || !std::isfinite(cost(theta))) return 1;
  double product = 0, power = 0, sum = 0;
  for (std::size_t i = 0; i < points(); ++i) {
    const std::complex<double> datum = weight_[i] * data_.value()[i];
    switch (component_) {
      case Component::imaginary:
      case Component::real: {
        const double target = component_ == Component::real ? datum.real() : datum.imag();
        const double model = scratch_[i] + target;
        product += model * target;
        power += model * model;
        break;
      }
      case Component::both: {
        const std::complex<double> model = std::complex<double>(scratch_[2 * i], scratch_[2 * i + 1]) + datum;
        product += (std::conj(model) * datum).real();
        power += std::norm(model);
        break;
      }
      default:
        sum += scratch_[i];
        product += (scratch_[i] + std::abs(datum)) * std::abs(datum);
        power += (scratch_[i] + std::abs(datum)) * (scratch_[i] + std::abs(datum));
    }
  }
  const bool logarithmic = component_ == Component::magnitude && logarithmic_magnitude_;
  const double factor = logarithmic ? std::exp(-sum / static_cast<double>(points())) : product / power;
  return factor > 0 && std::isfinite(factor) ? factor : 1;
}

std::vector<double> curve_residuals(const FrequencyResponseData& data, const std::vector<std::complex<double>>& model,
                                    Component component, Weight weight) {
  const std::vector<double> weights = point_weights(data, component, weight);
  std::vector<double> residual(data.size() * residuals_per_point(component));
  for (std::size_t i = 0; i < data.size(); ++i) {
    if (!is_finite(model[i]) ||
        !point_residual(component, weight == Weight::relative, weights[i], model[i], data.value()[i],
                        residual.data() + i * residuals_per_point(component))) {
      throw std::invalid_argument("the curve has no finite residual at omega = " + std::to_string(data.omega()[i]) +
                                  " rad/s");
    }
  }
  return residual;
}

}  // namespace frac::detail
