// SPDX-License-Identifier: BSD-3-Clause
#include "noise_levels.hpp"

#include <boost/math/special_functions/digamma.hpp>
#include <boost/math/special_functions/trigamma.hpp>
#include <cmath>

namespace frac::detail {
namespace {

/// x with trigamma(x) = value, for value > 0: the reciprocal is nearly linear, so Newton's steps on it settle at once.
double inverse_trigamma(double value) {
  double x = 0.5 + 1 / value;
  for (int step = 0; step < 50; ++step) {
    const double here = boost::math::trigamma(x), h = 1e-4 * x;
    const double slope = (boost::math::trigamma(x + h) - boost::math::trigamma(x - h)) / (2 * h);
    const double change = here * (1 - here / value) / slope;
    x += change;
    if (std::abs(change) < 1e-8 * x) break;
  }
  return x;
}

}  // namespace

std::vector<double> moderated_variances(std::span<const CurveVariance> estimated) {
  // ln of a variance estimated with d degrees of freedom lies around that of the truth by digamma(d/2) - ln(d/2), with
  // variance trigamma(d/2).
  double sum = 0, expected = 0, count = 0;
  const auto centred = [](const CurveVariance& each) {
    return std::log(each.variance) - boost::math::digamma(each.degrees / 2) + std::log(each.degrees / 2);
  };
  for (const CurveVariance& each : estimated) {
    if (!(each.degrees > 0)) continue;
    sum += centred(each);
    expected += boost::math::trigamma(each.degrees / 2);
    ++count;
  }
  if (count == 0) return std::vector<double>(estimated.size(), 1.0);
  const double mean = sum / count;
  double square = 0;
  for (const CurveVariance& each : estimated)
    if (each.degrees > 0) square += (centred(each) - mean) * (centred(each) - mean);
  const double excess = count > 1 ? square / (count - 1) - expected / count : 0;

  std::vector<double> result;
  if (!(excess > 0)) {
    result.assign(estimated.size(), std::exp(mean));
    return result;
  }
  const double prior = 2 * inverse_trigamma(excess);  // degrees of freedom that the common level is worth
  const double level = std::exp(mean + boost::math::digamma(prior / 2) - std::log(prior / 2));
  for (const CurveVariance& each : estimated) {
    result.push_back(each.degrees > 0 ? (prior * level + each.degrees * each.variance) / (prior + each.degrees)
                                      : level);
  }
  return result;
}

std::vector<double> moderated_deviations(std::span<const CurveVariance> estimated) {
  std::vector<double> deviation = moderated_variances(estimated);
  for (double& each : deviation) each = std::sqrt(each);
  return deviation;
}

}  // namespace frac::detail
