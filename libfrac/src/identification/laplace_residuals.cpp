#include "laplace_residuals.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

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

// Standard deviation of the noise from second differences, which leave little of a smooth output.
double noise_level(const TimeResponseData& data) {
  std::vector<double> difference;
  for (std::size_t i = 2; i < data.size(); ++i) {
    const double before = data.time()[i - 1] - data.time()[i - 2];
    const double after = data.time()[i] - data.time()[i - 1];
    const double share = before / (before + after);
    const double line = data.output()[i - 2] * (1 - share) + data.output()[i] * share;
    const double variance = 1 + share * share + (1 - share) * (1 - share);
    difference.push_back(std::abs(data.output()[i - 1] - line) / std::sqrt(variance));
  }
  if (difference.empty()) return 0;
  const auto middle = difference.begin() + static_cast<std::ptrdiff_t>(difference.size() / 2);
  std::nth_element(difference.begin(), middle, difference.end());
  return 1.4826 * *middle;
}

}  // namespace

LaplaceResiduals::LaplaceResiduals(const TimeResponseData& data, const Structure& structure, const ParameterMap& map,
                                   std::optional<double> offset, double decay)
    : Residuals(map), structure_(structure), free_offset_(!offset) {
  const std::vector<double>& time = data.time();
  length_ = time.back() - time.front();
  const double reach = time[std::min<std::size_t>(4, data.size() - 1)] - time.front();
  const double noise = data.sigma().empty() ? noise_level(data) : 0;
  for (const double angle : {0.0, 0.8, 1.2}) {
    constexpr int radii = 20;
    const double lowest = decay / (length_ * std::cos(angle));
    const double highest = std::max(4 * lowest, 2 / reach);
    for (int k = 0; k < radii; ++k) {
      const Complex log_s(std::log(lowest) + std::log(highest / lowest) * k / (radii - 1), angle);
      const Complex s = std::exp(log_s);
      Complex input = 0;
      Complex output = 0;
      double variance = 0;
      for (std::size_t i = 0; i + 1 < data.size(); ++i) {
        const double since = time[i] - time.front();
        if (s.real() * since > 40) break;
        const double step = time[i + 1] - time[i];
        const LineWeights weights = line_weights(s * step);
        const Complex factor = step * std::exp(-s * since);
        const double u0 = data.input()[i] - data.input_at_rest();
        const double u1 = data.hold() == Hold::zero_order ? u0 : data.input()[i + 1] - data.input_at_rest();
        const double base = offset.value_or(0);
        input += factor * (u0 * weights.first + u1 * weights.last);
        output += factor * ((data.output()[i] - base) * weights.first + (data.output()[i + 1] - base) * weights.last);
        const double sigma = data.sigma().empty() ? noise : data.sigma()[i];
        variance += std::norm(factor) * sigma * sigma;
      }
      // Straight lines between samples leave errors of about a percent, and so does the cut end of the record.
      const double model_error = 0.01 + std::exp(-s.real() * length_);
      const double spread = std::sqrt(variance + model_error * model_error * std::norm(output));
      if (!(spread > 0) || input == 0.0 || output == 0.0) continue;
      log_s_.push_back(log_s);
      input_.push_back(input);
      output_.push_back(output);
      constant_.push_back((1.0 - std::exp(-s * length_)) / s);
      weight_.push_back(1 / spread);
    }
  }
}

bool LaplaceResiduals::evaluate(std::span<const double> theta, double* residual, double* jacobian) const {
  const std::vector<double> parameters = map().to_user(theta);
  const std::optional<RatioOfPowerSums> ratio = ratio_at(structure_, parameters);
  if (!ratio || !(ratio->delay >= 0)) return false;
  const auto rows = static_cast<Eigen::Index>(count());
  const auto all = static_cast<Eigen::Index>(map().parameter_count());
  // Column 0 the residual, then its derivatives; real and imaginary parts in turn.
  Eigen::MatrixXd rest(rows, 1 + all);
  Eigen::VectorXd constant(rows);
  for (std::size_t i = 0; i < log_s_.size(); ++i) {
    const Complex s = std::exp(log_s_[i]);
    Complex top = 0, bottom = 0;
    std::vector<Complex> by(static_cast<std::size_t>(all), 0);
    std::vector<Complex> bottom_by(static_cast<std::size_t>(all), 0);
    const auto add = [&](const SensitiveSum& terms, Complex& sum, std::vector<Complex>& slopes) {
      for (const SensitiveTerm& term : terms) {
        const Complex power = std::exp(term.order * log_s_[i]);
        sum += term.coefficient * power;
        for (std::size_t p = 0; p < slopes.size(); ++p) {
          slopes[p] += (term.by_coefficient[p] + term.by_order[p] * log_s_[i]) * power;
        }
      }
    };
    add(ratio->numerator, top, by);
    add(ratio->denominator, bottom, bottom_by);
    const Complex late = std::exp(-ratio->delay * s);
    const Complex factor = weight_[i] * input_[i] * late / bottom;
    const Complex model = factor * top;
    const auto row = static_cast<Eigen::Index>(2 * i);
    const auto put = [&](Eigen::Index column, Complex value) {
      rest(row, column) = value.real();
      rest(row + 1, column) = value.imag();
    };
    put(0, model - weight_[i] * output_[i]);
    for (std::size_t p = 0; p < by.size(); ++p) {
      put(static_cast<Eigen::Index>(1 + p),
          factor * by[p] - model * (bottom_by[p] / bottom + ratio->delay_slope[p] * s));
    }
    constant[row] = weight_[i] * constant_[i].real();
    constant[row + 1] = weight_[i] * constant_[i].imag();
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
