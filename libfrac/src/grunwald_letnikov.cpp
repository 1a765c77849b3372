#include "frac/grunwald_letnikov.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "detail/grunwald_letnikov_sum.hpp"
#include "detail/number_text.hpp"
#include "detail/realisation_checks.hpp"
#include "frac/realisation.hpp"

namespace frac {

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
  for (std::size_t n = 0; n < samples.size(); ++n) {
    if (!std::isfinite(samples[n])) {
      throw std::invalid_argument("grunwald_letnikov_derivative: samples[" + std::to_string(n) +
                                  "] = " + detail::number_text(samples[n]) + " is not finite");
    }
  }
  const double scale = std::pow(sample_time, -order);
  if (!std::isfinite(scale) || scale == 0) {
    throw std::invalid_argument("grunwald_letnikov_derivative: sample_time = " + detail::number_text(sample_time) +
                                " s to the power " + detail::number_text(-order) +
                                " is out of the range of double precision");
  }
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

}  // namespace frac
