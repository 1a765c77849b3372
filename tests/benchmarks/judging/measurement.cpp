// SPDX-License-Identifier: BSD-3-Clause
#include "benchmarks/judging/measurement.hpp"

#include <algorithm>
#include <cmath>

namespace judging {
namespace {

/// Without noise a value still carries the rounding of double and of the arithmetic before it.
constexpr double kArithmeticNoise = 1e-12;
constexpr double kShareOfOutliers = 0.05;

std::vector<double> draw_frequencies(const System& system, const Setting& setting, RandomNumbers& random) {
  const double step = setting.decades * std::log(10.0) / (setting.points - 1);
  double centre = std::log(10.0) * random.uniform(-0.4, 0.4);
  if (system.delay > 0) {
    // Nobody measures a dead time with neighbours more than a third of a turn apart.
    const double top = std::log(2.0 / (system.delay * std::expm1(step)));
    centre = std::min(centre, top - step * (setting.points - 1) / 2.0);
  }
  const bool jittered = random.chance(0.3);
  std::vector<double> omega;
  for (int i = 0; i < setting.points; ++i) {
    const double shift = jittered ? random.uniform(-0.4, 0.4) : 0.0;
    omega.push_back(std::exp(centre + step * (i - 0.5 * (setting.points - 1) + shift)));
  }
  return omega;
}

double median_magnitude(std::vector<Complex> values) {
  auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end(),
                   [](const Complex& a, const Complex& b) { return std::abs(a) < std::abs(b); });
  return std::abs(*middle);
}

/// `x` to `digits` significant digits, and the standard deviation of what that adds.
double rounded(double x, int digits, double* sigma) {
  if (x == 0) return 0;
  const double unit = std::pow(10.0, std::floor(std::log10(std::abs(x))) - digits + 1);
  *sigma = std::hypot(*sigma, unit / std::sqrt(12.0));
  return std::round(x / unit) * unit;
}

/// A complex function of ln omega as cables, calibration and drift leave it, of unit root mean square over many draws:
/// it changes over a factor of 2 to 20 in frequency.
std::vector<Complex> smooth_error(const std::vector<double>& omega, RandomNumbers& random) {
  constexpr int waves = 30;
  const double length = random.log_uniform(std::log(2.0), std::log(20.0));
  std::vector<Complex> error(omega.size());
  for (int k = 0; k < waves; ++k) {
    const Complex size(random.normal(), random.normal());
    const double number = random.normal() / length, phase = random.uniform(0, 6.283185307179586);
    for (std::size_t i = 0; i < omega.size(); ++i)
      error[i] += size * std::cos(number * std::log(omega[i]) + phase) / std::sqrt(static_cast<double>(waves));
  }
  return error;
}

}  // namespace

Curve measure(const System& system, const Setting& setting, RandomNumbers& random) {
  Curve curve;
  curve.setting = setting;
  curve.omega = draw_frequencies(system, setting, random);
  for (const double w : curve.omega) curve.exact.push_back(system(Complex(0, w)));

  const double typical = median_magnitude(curve.exact);
  if (setting.noise == "correlated") curve.correlation = random.uniform(0.5, 0.9);
  if (setting.noise == "outliers") curve.sound = 1 - kShareOfOutliers;
  Complex previous(random.normal(), random.normal());
  std::vector<Complex> smooth(curve.exact.size());
  if (setting.noise == "smooth") smooth = smooth_error(curve.omega, random);
  for (std::size_t i = 0; i < curve.exact.size(); ++i) {
    const Complex value = curve.exact[i];
    const double size = std::abs(value);
    double relative = setting.noise == "smooth" ? setting.beside : setting.level;
    double floor = 0;
    if (setting.noise == "additive") {
      relative = 0;
      floor = setting.level * typical;
    } else if (setting.noise == "mixed") {
      floor = 0.3 * setting.level * typical;
    } else if (setting.noise == "rounded") {
      // Two digits are noise of up to 3 %; above that an instrument's own noise comes first.
      relative = setting.level >= 0.03 ? setting.level : 0;
    }
    double sigma = std::max(std::hypot(relative * size, floor) / std::sqrt(2.0), kArithmeticNoise * size);
    const Complex fresh(random.normal(), random.normal());
    previous = curve.correlation * previous + std::sqrt(1 - curve.correlation * curve.correlation) * fresh;
    Complex measured = setting.noise == "none" ? value : value + sigma * previous;
    double sigma_real = sigma;
    double sigma_imaginary = sigma;
    if (setting.noise == "rounded") {
      const int digits = setting.level < 0.005 ? 3 : 2;
      measured = {rounded(measured.real(), digits, &sigma_real), rounded(measured.imag(), digits, &sigma_imaginary)};
    }
    if (setting.noise == "outliers" && random.chance(kShareOfOutliers)) {
      const double turn = random.uniform(0, 6.283185307179586);
      measured += size * random.uniform(0.15, 0.6) * Complex(std::cos(turn), std::sin(turn));
    }
    curve.measured.push_back(measured + value * setting.level * smooth[i]);
    curve.sigma_real.push_back(sigma_real);
    curve.sigma_imaginary.push_back(sigma_imaginary);
  }
  return curve;
}

}  // namespace judging
