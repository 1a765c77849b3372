// SPDX-License-Identifier: BSD-3-Clause
#include "laplace_residuals.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "identification/data/neighbour_noise.hpp"
#include "time_residuals.hpp"

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

/// Without the checks for infinite parts of the operator: what is not finite is found at the end.
Complex times(Complex a, Complex b) {
  return {a.real() * b.real() - a.imag() * b.imag(), a.real() * b.imag() + a.imag() * b.real()};
}

/// A sum of powers of s at points s of one argument and evenly growing modulus.
class SumOnRay {
 public:
  explicit SumOnRay(const SensitiveSum& terms) : terms_(terms), power_(terms.size()), growth_(terms.size()) {
    for (std::size_t i = 0; i < terms.size(); ++i) {
      for (std::size_t p = 0; p < terms[i].by_coefficient.size(); ++p) {
        if (terms[i].by_coefficient[p] != 0 || terms[i].by_order[p] != 0) sensitive_.emplace_back(i, p);
      }
    }
  }

  void start(double angle, double lowest, double spacing) {
    step_ = 0;
    for (std::size_t i = 0; i < terms_.size(); ++i) {
      power_[i] = std::polar(std::exp(terms_[i].order * lowest), terms_[i].order * angle);
      growth_[i] = std::exp(terms_[i].order * spacing);
    }
  }
  void go_to(std::size_t step) {
    for (; step_ < step; ++step_) {
      for (std::size_t i = 0; i < power_.size(); ++i) power_[i] *= growth_[i];
    }
  }

  [[nodiscard]] Complex value() const {
    Complex sum = 0;
    for (std::size_t i = 0; i < power_.size(); ++i) sum += terms_[i].coefficient * power_[i];
    return sum;
  }
  void slopes(Complex log_s, std::vector<Complex>& by) const {
    std::fill(by.begin(), by.end(), 0.0);
    for (const auto& [i, p] : sensitive_) {
      by[p] += times(terms_[i].by_coefficient[p] + terms_[i].by_order[p] * log_s, power_[i]);
    }
  }

 private:
  const SensitiveSum& terms_;
  std::vector<Complex> power_;
  std::vector<double> growth_;
  std::vector<std::pair<std::size_t, std::size_t>> sensitive_;  // term, parameter
  std::size_t step_ = 0;
};

}  // namespace

LaplaceResiduals::LaplaceResiduals(const TimeResponseData& data, const Structure& structure, const ParameterMap& map,
                                   std::optional<double> offset, double decay)
    : Residuals(map), structure_(structure), free_offset_(!offset) {
  const Samples input_samples = input_of(data), output_samples = output_of(data, offset.value_or(0));
  length_ = output_samples.since.back();
  const double reach = output_samples.since[std::min<std::size_t>(4, output_samples.since.size() - 1)];
  for (const double angle : {0.0, 0.8, 1.2}) {
    constexpr std::size_t radii = 20;
    const double lowest = decay / (length_ * std::cos(angle));
    const double highest = std::max(4 * lowest, 2 / reach);
    Ray ray{angle, std::log(lowest), std::log(highest / lowest) / (radii - 1), {}};
    for (std::size_t k = 0; k < radii; ++k) {
      const Complex log_s(ray.lowest + ray.spacing * static_cast<double>(k), angle);
      const Complex s = std::exp(log_s);
      const Complex input = transform(input_samples, s).value;
      const auto [output, variance] = transform(output_samples, s);
      // Straight lines between samples leave errors of about a percent, and so does the cut end of the record.
      const double model_error = 0.01 + std::exp(-s.real() * length_);
      const double spread = std::sqrt(variance + model_error * model_error * std::norm(output));
      if (!(spread > 0) || input == 0.0 || output == 0.0) continue;
      ray.steps.push_back(k);
      log_s_.push_back(log_s);
      input_.push_back(input);
      output_.push_back(output);
      constant_.push_back((1.0 - std::exp(-s * length_)) / s);
      weight_.push_back(1 / spread);
    }
    rays_.push_back(std::move(ray));
  }
}

bool LaplaceResiduals::evaluate(std::span<const double> theta, double* residual, double* jacobian) const {
  const std::vector<double> parameters = map().to_user(theta);
  const std::optional<RatioOfPowerSums> ratio =
      ratio_at(structure_, parameters, jacobian ? Sensitivity::all : Sensitivity::none);
  if (!ratio || ratio->numerator.empty() || ratio->denominator.empty() || !(ratio->delay >= 0)) return false;
  const auto rows = static_cast<Eigen::Index>(count());
  const auto all = jacobian ? static_cast<Eigen::Index>(map().parameter_count()) : 0;
  // Column 0 the residual, then its derivatives; real and imaginary parts in turn.
  Eigen::MatrixXd rest(rows, 1 + all);
  Eigen::VectorXd constant(rows);
  std::vector<Complex> by(static_cast<std::size_t>(all)), bottom_by(static_cast<std::size_t>(all));
  SumOnRay top(ratio->numerator), bottom(ratio->denominator);
  std::size_t i = 0;
  for (const Ray& ray : rays_) {
    top.start(ray.angle, ray.lowest, ray.spacing);
    bottom.start(ray.angle, ray.lowest, ray.spacing);
    for (const std::size_t step : ray.steps) {
      top.go_to(step);
      bottom.go_to(step);
      const Complex s = std::exp(log_s_[i]);
      const Complex late = ratio->delay > 0 ? std::exp(-ratio->delay * s) : 1.0;
      const Complex inverse = 1.0 / bottom.value();
      const Complex factor = times(times(weight_[i] * input_[i], late), inverse);
      const Complex model = times(factor, top.value());
      const auto row = static_cast<Eigen::Index>(2 * i);
      const auto put = [&](Eigen::Index column, Complex value) {
        rest(row, column) = value.real();
        rest(row + 1, column) = value.imag();
      };
      put(0, model - weight_[i] * output_[i]);
      if (jacobian) {
        top.slopes(log_s_[i], by);
        bottom.slopes(log_s_[i], bottom_by);
        for (std::size_t p = 0; p < by.size(); ++p) {
          const Complex relative = times(bottom_by[p], inverse) + ratio->delay_slope[p] * s;
          put(static_cast<Eigen::Index>(1 + p), times(factor, by[p]) - times(model, relative));
        }
      }
      constant[row] = weight_[i] * constant_[i].real();
      constant[row + 1] = weight_[i] * constant_[i].imag();
      ++i;
    }
  }
  if (!rest.allFinite()) return false;
  if (free_offset_) {
    const Eigen::RowVectorXd share = constant.transpose() * rest / constant.squaredNorm();
    rest -= constant * share;
  }
  Eigen::Map<Eigen::VectorXd>(residual, rows) = rest.col(0);
  if (!jacobian) return true;
  Eigen::Map<Eigen::MatrixXd> by_theta(jacobian, rows, static_cast<Eigen::Index>(map().free().size()));
  by_theta.noalias() = rest.rightCols(all).lazyProduct(map().jacobian(parameters));
  return by_theta.allFinite();
}

double LaplaceResiduals::best_factor(std::span<const double> theta) const {
  std::vector<double> rest;
  if (!evaluate_all(theta, rest)) return 1;
  // The residual is model - data: the factor of the model by least squares, the offset left aside.
  double product = 0, power = 0;
  for (std::size_t i = 0; i < log_s_.size(); ++i) {
    const Complex data = weight_[i] * output_[i];
    const Complex model = Complex(rest[2 * i], rest[2 * i + 1]) + data;
    product += (std::conj(model) * data).real();
    power += std::norm(model);
  }
  const double factor = product / power;
  return factor > 0 && std::isfinite(factor) ? factor : 1;
}

FrequencyResponseData LaplaceResiduals::quotient() const {
  std::vector<double> s;
  std::vector<Complex> value;
  for (std::size_t i = 0; i < log_s_.size(); ++i) {
    if (log_s_[i].imag() != 0) continue;
    s.push_back(std::exp(log_s_[i].real()));
    value.push_back(output_[i] / input_[i]);
  }
  return {std::move(s), std::move(value)};
}

}  // namespace frac::detail
