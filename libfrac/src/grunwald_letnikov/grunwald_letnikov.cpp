// SPDX-License-Identifier: BSD-3-Clause
#include "frac/grunwald_letnikov.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "approximation/realised_order.hpp"
#include "base/number_text.hpp"
#include "fft_convolution.hpp"
#include "frac/realisation.hpp"
#include "realisation/grunwald_letnikov_sum.hpp"
#include "realisation/realisation_checks.hpp"
#include "special/reciprocal_gamma.hpp"

namespace frac {
namespace {

constexpr std::uint64_t largest_index = std::uint64_t{1} << 53;

void check_samples(const std::vector<double>& samples, const std::string& where) {
  for (std::size_t n = 0; n < samples.size(); ++n) {
    if (!std::isfinite(samples[n])) {
      throw std::invalid_argument(where + ": samples[" + std::to_string(n) + "] = " + detail::number_text(samples[n]) +
                                  " is not finite");
    }
  }
}

double checked_scale(double order, double sample_time, const std::string& where) {
  const double scale = std::pow(sample_time, -order);
  if (!std::isfinite(scale) || scale == 0) {
    throw std::invalid_argument(where + ": sample_time = " + detail::number_text(sample_time) + " s to the power " +
                                detail::number_text(-order) + " is out of the range of double precision");
  }
  return scale;
}

// ln(Gamma(k - q)/Gamma(k + 1)) with w = k - q/2, r = (q + 1)/2:
//   -2 r ln w + sum_{n = 3, 5, ..} 2 B_n(r + 1/2)/(n (n - 1) w^(n-1))
// from the series of ln Gamma(w + 1/2 +- r).  B_n(r + 1/2) is odd in r.  Four terms at w >= 990 and r <= 10.5 leave
// below 1e-17.
double log_correction(double r, double w) {
  const double square = r * r;
  const double b3 = r * (square - 1.0 / 4);
  const double b5 = r * (square * (square - 5.0 / 6) + 7.0 / 48);
  const double b7 = r * (square * (square * (square - 7.0 / 4) + 49.0 / 48) - 31.0 / 192);
  const double b9 = r * (square * (square * (square * (square - 3.0) + 147.0 / 40) - 31.0 / 16) + 381.0 / 1280);
  const double u = 1 / (w * w);
  return u * (b3 / 3 + u * (b5 / 10 + u * (b7 / 21 + u * (b9 / 36))));
}

double weight_at(double order, std::uint64_t index) {
  constexpr std::uint64_t asymptotic = 1000;
  if (index < asymptotic) return detail::grunwald_letnikov_weight(order, static_cast<std::size_t>(index)).value;
  const double w = static_cast<double>(index) - order / 2;
  return std::pow(w, -order - 1) * std::exp(log_correction((order + 1) / 2, w)) * detail::reciprocal_gamma(-order);
}

}  // namespace

double grunwald_letnikov_weight(double order, std::uint64_t index) {
  detail::check_realised_order(order, "grunwald_letnikov_weight");
  if (index > largest_index) {
    throw std::invalid_argument("grunwald_letnikov_weight: index = " + std::to_string(index) +
                                "; allowed are 0 to 2^53");
  }
  return weight_at(order, index);
}

std::vector<double> grunwald_letnikov_weights(double order, std::size_t memory_length) {
  detail::check_realised_order(order, "grunwald_letnikov_weights");
  detail::check_memory_length(memory_length, "grunwald_letnikov_weights");
  return detail::grunwald_letnikov_weights(order, memory_length);
}

std::complex<double> grunwald_letnikov_response(double order, double sample_time, std::size_t memory_length,
                                                double omega) {
  return power_response(GrunwaldLetnikovRealisation{sample_time, memory_length}, order, omega).value;
}

std::vector<double> grunwald_letnikov_derivative(const std::vector<double>& samples, double order, double sample_time,
                                                 std::size_t memory_length) {
  detail::check_realised_order(order, "grunwald_letnikov_derivative");
  validate(GrunwaldLetnikovRealisation{sample_time, memory_length});
  check_samples(samples, "grunwald_letnikov_derivative");
  const double scale = checked_scale(order, sample_time, "grunwald_letnikov_derivative");
  if (samples.empty()) return {};
  const std::size_t memory = memory_length == 0 ? samples.size() - 1 : std::min(memory_length, samples.size() - 1);

  // Summation by parts: the difference of order q is the difference of order q - 1 of the first differences, plus the
  // last weight of order q - 1 times the sample that just left the memory.  Down to an order in (-1, 0], where all
  // weights are positive and nothing cancels.
  std::vector<double> difference = samples;
  std::vector<double> result(samples.size(), 0.0);
  double remaining = order;
  while (remaining > 0) {
    remaining -= 1;
    const double end_weight = detail::grunwald_letnikov_weight(remaining, memory).value;
    for (std::size_t n = memory + 1; n < samples.size(); ++n) result[n] += end_weight * difference[n - memory - 1];
    for (std::size_t n = samples.size() - 1; n > 0; --n) difference[n] -= difference[n - 1];
  }
  const std::vector<double> weights = detail::grunwald_letnikov_weights(remaining, memory);
  for (std::size_t n = 0; n < samples.size(); ++n) {
    double sum = 0;
    for (std::size_t k = std::min(n, memory) + 1; k-- > 0;) sum += weights[k] * difference[n - k];
    result[n] = scale * (result[n] + sum);
  }
  return result;
}

std::vector<double> grunwald_letnikov_derivative_by_fft(const std::vector<double>& samples, double order,
                                                        double sample_time) {
  const std::string where = "grunwald_letnikov_derivative_by_fft";
  detail::check_realised_order(order, where);
  validate(GrunwaldLetnikovRealisation{sample_time, 0});
  detail::check_memory_length(samples.size(), where);
  check_samples(samples, where);
  const double scale = checked_scale(order, sample_time, where);
  if (samples.empty()) return {};
  std::vector<double> difference = samples;
  double remaining = order;
  for (; remaining > 0; remaining -= 1) {
    for (std::size_t n = samples.size() - 1; n > 0; --n) difference[n] -= difference[n - 1];
  }
  std::vector<double> result =
      detail::fft_convolution(detail::grunwald_letnikov_weights(remaining, samples.size() - 1), difference);
  for (double& each : result) each *= scale;
  return result;
}

}  // namespace frac
