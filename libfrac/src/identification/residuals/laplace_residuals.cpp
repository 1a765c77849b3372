// SPDX-License-Identifier: BSD-3-Clause
#include "laplace_residuals.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "identification/data/neighbour_noise.hpp"
#include "special/complex_functions.hpp"

namespace frac::detail {
namespace {

using Complex = std::complex<double>;

// Transform of a straight line from a to b over a step of length h, z = s h: h (a w0 + b w1).
struct LineWeights {
  Complex first, last;
};
LineWeights line_weights(Complex z) {
  if (std::abs(z) < 0.1) {
    // Series of the expressions below.
    return {0.5 - z / 6.0 + z * z / 24.0 - z * z * z / 120.0 + z * z * z * z / 720.0,
            0.5 - z / 3.0 + z * z / 8.0 - z * z * z / 30.0 + z * z * z * z / 144.0};
  }
  const Complex end = std::exp(-z);
  const Complex mean = (1.0 - end) / z;
  const Complex last = (mean - end) / z;
  return {mean - last, last};
}

// Samples with what goes on between them, time counted from the first sample of the record.
struct Samples {
  std::vector<double> since, value, variance;
  bool steps = false;  // holds its value up to the next; otherwise straight lines
};

Samples input_of(const TimeResponseData& data) {
  Samples input;
  input.steps = data.hold() == Hold::zero_order;
  for (std::size_t i = 0; i < data.size(); ++i) {
    input.since.push_back(data.time()[i] - data.time().front());
    input.value.push_back(data.input()[i] - data.input_at_rest());
    input.variance.push_back(0);
  }
  return input;
}

// Outputs that count, the first of them also for what was before it.
Samples output_of(const TimeResponseData& data, double base) {
  Samples output;
  for (const std::size_t i : data.observed()) {
    output.since.push_back(data.time()[i] - data.time().front());
    output.value.push_back(data.output()[i] - base);
    if (!data.sigma().empty()) output.variance.push_back(data.sigma()[i] * data.sigma()[i]);
  }
  if (data.sigma().empty())
    output.variance.assign(output.since.size(), std::pow(neighbour_noise(output.since, output.value), 2));
  if (output.since.front() > 0) {
    output.since.insert(output.since.begin(), 0);
    output.value.insert(output.value.begin(), output.value.front());
    output.variance.insert(output.variance.begin(), output.variance.front());
  }
  return output;
}

// Integral of the samples times e^-st, as far as that counts.
struct Transform {
  Complex value = 0;
  double variance = 0;
};
Transform transform(const Samples& samples, Complex s) {
  Transform result;
  double last_step = -1;
  LineWeights weights{};
  Complex decay = 0, now = 1;
  for (std::size_t i = 0; i + 1 < samples.since.size(); ++i) {
    if (s.real() * samples.since[i] > 40) break;
    const double step = samples.since[i + 1] - samples.since[i];
    // Times of even steps differ by rounding.
    if (!(std::abs(step - last_step) <= 1e-9 * step)) {
      last_step = step;
      weights = line_weights(s * step);
      decay = std::exp(-s * step);
      now = std::exp(-s * samples.since[i]);
    }
    const Complex factor = step * now;
    const double first = samples.value[i];
    const double last = samples.steps ? first : samples.value[i + 1];
    result.value += factor * (first * weights.first + last * weights.last);
    result.variance += std::norm(factor) * samples.variance[i];
    now *= decay;
  }
  return result;
}

}  // namespace

LaplaceResiduals::LaplaceResiduals(const TimeResponseData& data, const Structure& structure, const ParameterMap& map,
                                   std::optional<double> offset, double decay)
    : Residuals(map), program_(structure.expression()), free_offset_(!offset) {
  const Samples input_samples = input_of(data), output_samples = output_of(data, offset.value_or(0));
  const double length = output_samples.since.back();
  const double reach = output_samples.since[std::min<std::size_t>(4, output_samples.since.size() - 1)];
  constexpr std::size_t radii = 20;
  std::vector<double> constant;
  for (const double angle : {0.0, 0.8, 1.2}) {
    const double lowest = decay / (length * std::cos(angle));
    const double highest = std::max(4 * lowest, 2 / reach);
    const double spacing = std::log(highest / lowest) / (radii - 1);
    Ray ray{angle, {}};
    for (std::size_t k = 0; k < radii; ++k) {
      const double modulus = lowest * std::exp(spacing * static_cast<double>(k));
      const Complex s = std::polar(modulus, angle);
      const Complex input = transform(input_samples, s).value;
      const auto [output, variance] = transform(output_samples, s);
      // Straight lines between samples leave errors of about a percent, and so does the cut end of the record.
      const double model_error = 0.01 + std::exp(-s.real() * length);
      const double spread = std::sqrt(variance + model_error * model_error * std::norm(output));
      if (!(spread > 0) || input == 0.0 || output == 0.0) continue;
      ray.modulus.push_back(modulus);
      input_.push_back(input / spread);
      output_.push_back(output / spread);
      const Complex one = (1.0 - std::exp(-s * length)) / (s * spread);
      constant.insert(constant.end(), {one.real(), one.imag()});
    }
    rays_.push_back(std::move(ray));
  }
  constant_ = Eigen::Map<const Eigen::VectorXd>(constant.data(), static_cast<Eigen::Index>(constant.size()));
  if (constant_.size() > 0) constant_.normalize();
  value_.resize(radii);
  gradient_.resize(radii * map.parameter_count());
}

bool LaplaceResiduals::evaluate(std::span<const double> theta, double* residual, double* jacobian) const {
  const std::vector<double> parameters = map().to_user(theta);
  const auto rows = static_cast<Eigen::Index>(count());
  const auto width = jacobian ? static_cast<Eigen::Index>(theta.size()) : 0;
  Eigen::Map<Eigen::VectorXd> rest(residual, rows);
  Eigen::Map<Eigen::MatrixXd> by_theta(jacobian, rows, width);
  by_theta.setZero();
  const std::vector<ParameterMap::Entry> entries =
      jacobian ? map().jacobian_entries(parameters) : std::vector<ParameterMap::Entry>();
  std::size_t first = 0;
  for (const Ray& ray : rays_) {
    const std::size_t radii = ray.modulus.size();
    const std::size_t slopes = jacobian ? radii * parameters.size() : 0;
    program_.evaluate_on_ray(parameters, ray.angle, ray.modulus, {value_.data(), radii}, {gradient_.data(), slopes});
    for (std::size_t k = 0; k < radii; ++k) {
      const auto row = static_cast<Eigen::Index>(2 * (first + k));
      const Complex input = input_[first + k];
      const Complex difference = product(input, value_[k]) - output_[first + k];
      rest[row] = difference.real();
      rest[row + 1] = difference.imag();
      for (const ParameterMap::Entry& entry : entries) {
        const Complex slope = entry.derivative * product(input, gradient_[entry.parameter * radii + k]);
        const auto column = static_cast<Eigen::Index>(entry.free);
        by_theta(row, column) += slope.real();
        by_theta(row + 1, column) += slope.imag();
      }
    }
    first += radii;
  }
  if (!rest.allFinite() || !by_theta.allFinite()) return false;
  if (free_offset_) {
    rest -= constant_ * constant_.dot(rest);
    for (auto column : by_theta.colwise()) column -= constant_ * constant_.dot(column);
  }
  return true;
}

Residuals::BestFactor LaplaceResiduals::best_factor(std::span<const double> theta) const {
  std::vector<double> rest;
  if (!evaluate_all(theta, rest)) return {};
  // The residual is model - data: the factor of the model by least squares, the offset left aside.
  double both = 0, power = 0;
  for (std::size_t i = 0; i < points(); ++i) {
    const Complex model = Complex(rest[2 * i], rest[2 * i + 1]) + output_[i];
    both += (std::conj(model) * output_[i]).real();
    power += std::norm(model);
  }
  const double factor = both / power;
  if (!(factor > 0 && std::isfinite(factor))) return {};
  return {factor};
}

FrequencyResponseData LaplaceResiduals::quotient() const {
  const std::vector<double>& s = rays_.front().modulus;
  std::vector<Complex> value;
  for (std::size_t i = 0; i < s.size(); ++i) value.push_back(output_[i] / input_[i]);
  return {s, std::move(value)};
}

}  // namespace frac::detail
