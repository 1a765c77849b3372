// SPDX-License-Identifier: BSD-3-Clause
#include "frac/identification/power_law.hpp"

#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "base/number_text.hpp"
#include "frac/identification/statistics.hpp"

namespace frac {

namespace {

void require_positive(std::span<const double> values, const char* name) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!(values[i] > 0) || !std::isfinite(values[i])) {
      throw std::invalid_argument("fit_power_law: " + std::string(name) + "[" + std::to_string(i) +
                                  "] = " + detail::number_text(values[i]) + " must be positive and finite");
    }
  }
}

}  // namespace

double PowerLaw::operator()(double x) const {
  return coefficient * std::pow(x, exponent);
}

PowerLaw fit_power_law(std::span<const double> x, std::span<const double> y) {
  const std::size_t count = x.size();
  if (count != y.size()) {
    throw std::invalid_argument("fit_power_law: " + std::to_string(count) + " x values but " +
                                std::to_string(y.size()) + " y values");
  }
  if (count < 2)
    throw std::invalid_argument("fit_power_law: " + std::to_string(count) + " point(s), at least 2 are needed");
  require_positive(x, "x");
  require_positive(y, "y");

  const auto n = static_cast<double>(count);
  double mean_x = 0, mean_y = 0;
  for (std::size_t i = 0; i < count; ++i) {
    mean_x += std::log(x[i]) / n;
    mean_y += std::log(y[i]) / n;
  }
  // Centred abscissae decorrelate the exponent from the coefficient.
  double sxx = 0, sxy = 0, syy = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const double dx = std::log(x[i]) - mean_x, dy = std::log(y[i]) - mean_y;
    sxx += dx * dx;
    sxy += dx * dy;
    syy += dy * dy;
  }
  if (!(sxx > 0)) throw std::invalid_argument("fit_power_law: all x are equal, the exponent is undetermined");

  PowerLaw law{};
  law.exponent = sxy / sxx;
  const double intercept = mean_y - law.exponent * mean_x;
  law.coefficient = std::exp(intercept);

  double sum_of_squares = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const double residual = std::log(y[i]) - mean_y - law.exponent * (std::log(x[i]) - mean_x);
    sum_of_squares += residual * residual;
  }
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  law.r_squared = syy > 0 ? 1 - sum_of_squares / syy : nan;
  law.rms_log_residual = count > 2 ? std::sqrt(sum_of_squares / (n - 2)) : nan;
  const double t = student_t_95(n - 2);
  law.exponent_standard_error = law.rms_log_residual / std::sqrt(sxx);
  law.exponent_ci95_lower = law.exponent - t * law.exponent_standard_error;
  law.exponent_ci95_upper = law.exponent + t * law.exponent_standard_error;
  const double log_coefficient_error = law.rms_log_residual * std::sqrt(1 / n + mean_x * mean_x / sxx);
  law.coefficient_ci95_lower = law.coefficient * std::exp(-t * log_coefficient_error);
  law.coefficient_ci95_upper = law.coefficient * std::exp(t * log_coefficient_error);
  return law;
}

}  // namespace frac
