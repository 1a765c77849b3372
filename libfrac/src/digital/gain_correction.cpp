#include "gain_correction.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace frac::detail {
namespace {

using Complex = std::complex<double>;

// More of them cancel each other in the parallel form.
constexpr int most_corners = 6;
constexpr int points = 48;

// What has to be extrapolated from the band's arc is singular along the negative real axis of z; poles between z = 0
// and z = -0.6 serve it: the wider they are spread, the fewer it takes and the more they amplify beyond the band.
constexpr double spreads[] = {4, 2};

std::vector<double> corners(int count, double spread, const std::vector<double>& occupied) {
  std::vector<double> result;
  for (int j = 0; j < count; ++j) {
    double corner = std::pow(spread, count == 1 ? 0.5 : static_cast<double>(j) / (count - 1));
    // Poles close to each other would leave large terms of opposite sign in the parallel form: at this distance they
    // cost a digit or two of the filter's sixteen, and little of the correction.
    const auto is_close = [&](double other) { return std::abs(std::log(corner / other)) < 0.25; };
    while (std::any_of(occupied.begin(), occupied.end(), is_close) ||
           std::any_of(result.begin(), result.end(), is_close)) {
      corner *= 1.05;
    }
    result.push_back(corner);
  }
  return result;
}

// Least largest |C/target - 1| by Lawson's weights: each point's weight is multiplied by the error it is left with.
GainCorrection fitted(const CorrectionTarget& target, double edge, std::vector<double> at) {
  const auto count = static_cast<Eigen::Index>(at.size());
  Eigen::MatrixXd basis(2 * points, count + 1);
  for (int i = 0; i < points; ++i) {
    const double x = edge * std::sin(std::numbers::pi / 2 * (i + 0.5) / points);
    const Complex w(0, std::tan(x));
    const Complex wanted = target(x);
    for (Eigen::Index j = 0; j <= count; ++j) {
      const Complex value = (j == 0 ? 1 : w / (w + at[static_cast<std::size_t>(j - 1)])) / wanted;
      basis(2 * i, j) = value.real();
      basis(2 * i + 1, j) = value.imag();
    }
  }
  Eigen::VectorXd right(2 * points);
  for (int i = 0; i < points; ++i) right.segment<2>(2 * i) << 1, 0;
  Eigen::VectorXd weight = Eigen::VectorXd::Ones(points);
  Eigen::VectorXd best;
  double least = INFINITY;
  for (int iteration = 0; iteration < 30; ++iteration) {
    Eigen::MatrixXd weighted = basis;
    Eigen::VectorXd weighted_right = right;
    for (int i = 0; i < points; ++i) {
      const double root = std::sqrt(weight[i]);
      weighted.middleRows<2>(2 * i) *= root;
      weighted_right.segment<2>(2 * i) *= root;
    }
    const Eigen::VectorXd coefficients = weighted.householderQr().solve(weighted_right);
    const Eigen::VectorXd residual = basis * coefficients - right;
    Eigen::VectorXd error(points);
    for (int i = 0; i < points; ++i) error[i] = residual.segment<2>(2 * i).norm();
    const double largest = error.maxCoeff();
    if (largest < least) {
      least = largest;
      best = coefficients;
    }
    if (!(largest > 0)) break;
    weight.array() *= error.array() / largest + 1e-6;
    weight *= points / weight.sum();
  }
  GainCorrection result;
  result.constant = best[0];
  result.weights.assign(best.data() + 1, best.data() + best.size());
  result.corners = std::move(at);
  result.error = least;
  return result;
}

double largest_gain(const GainCorrection& correction, double edge) {
  double largest = std::abs(correction.constant);
  double at_nyquist = correction.constant;
  for (const double weight : correction.weights) at_nyquist += weight;
  largest = std::max(largest, std::abs(at_nyquist));
  for (int i = 0; i < points; ++i) {
    const double x = edge + (std::numbers::pi / 2 - edge) * i / points;
    largest = std::max(largest, std::abs(correction.response({0, std::tan(x)})));
  }
  return largest;
}

}  // namespace

Complex GainCorrection::response(Complex w) const {
  Complex sum = constant;
  for (std::size_t j = 0; j < corners.size(); ++j) sum += weights[j] * w / (w + corners[j]);
  return sum;
}

Complex CorrectionTarget::operator()(double x) const {
  return std::polar(std::pow(x / std::tan(x), gain_order) * std::pow(x / std::sin(x), differences), differences * x);
}

GainCorrection gain_correction(const CorrectionTarget& target, double edge, double tolerance, double most_gain,
                               const std::vector<double>& occupied) {
  GainCorrection best;
  if (target.gain_order == 0 && target.differences == 0) return best;
  best.error = INFINITY;
  for (int count = 0; count <= most_corners; ++count) {
    for (const double spread : spreads) {
      GainCorrection correction = fitted(target, edge, corners(count, spread, occupied));
      const bool is_allowed = count == 0 || largest_gain(correction, edge) <= most_gain;
      if (is_allowed && correction.error < best.error) best = std::move(correction);
      if (best.error <= tolerance) return best;
      if (count < 2) break;
    }
  }
  return best;
}

}  // namespace frac::detail
