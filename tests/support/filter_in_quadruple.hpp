// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <boost/multiprecision/float128.hpp>
#include <cmath>
#include <cstddef>
#include <vector>

#include "frac/approximation/zero_pole_gain.hpp"
#include "frac/digital/digital_filter.hpp"

namespace support {

using Quad = boost::multiprecision::float128;

/// gain prod (s + z)/(s + p) by the bilinear rule as it is defined, with the roots as stored and poles in z:
///   y_n = a y_(n-1) + (b0 x_n - b1 x_(n-1)) per section, all in quadruple precision.
inline std::vector<Quad> filter_in_quadruple(const frac::ZeroPoleGain& system, double sample_time,
                                             const std::vector<double>& samples) {
  std::vector<Quad> signal(samples.begin(), samples.end());
  const Quad rate = 2 / Quad(sample_time);
  for (std::size_t i = 0; i < system.poles.size(); ++i) {
    const Quad zero = -Quad(system.zeros[i]), pole = -Quad(system.poles[i]);
    const Quad a = (rate - pole) / (rate + pole);
    const Quad b0 = (rate + zero) / (rate + pole);
    const Quad b1 = (rate - zero) / (rate + pole);
    Quad x1 = 0, y1 = 0;
    for (Quad& value : signal) {
      const Quad x = value;
      value = y1 = a * y1 + b0 * x - b1 * x1;
      x1 = x;
    }
  }
  for (Quad& value : signal) value *= Quad(system.gain);
  return signal;
}

/// Taps and sections of a design as stored, without its differences, integrators and pairs, in quadruple precision.
inline std::vector<Quad> design_in_quadruple(const frac::DigitalFilterDesign& design,
                                             const std::vector<double>& samples) {
  const auto& sections = design.sections;
  const bool of_states = sections.output == frac::SectionOutput::state;
  const std::vector<Quad> taps(design.taps.begin(), design.taps.end());
  const std::vector<Quad> rates(sections.rates.begin(), sections.rates.end());
  const std::vector<Quad> weights(sections.weights.begin(), sections.weights.end());
  std::vector<Quad> result, state(rates.size(), 0);
  result.reserve(samples.size());
  for (std::size_t n = 0; n < samples.size(); ++n) {
    Quad x = 0;
    for (std::size_t k = 0; k < taps.size() && k <= n; ++k) x += taps[k] * samples[n - k];
    Quad sum = Quad(sections.direct) * x;
    for (std::size_t i = 0; i < state.size(); ++i) {
      const Quad change = x - rates[i] * state[i];
      sum += weights[i] * (of_states ? state[i] : change);
      state[i] += change;
    }
    result.push_back(sum);
  }
  return result;
}

/// Bound on the rounding errors in every output of a DigitalFilter<double> that has taps and sections only, to first
/// order in u = 2^-53.  `coefficients`: by how many u the rates, the weights and the direct term are off themselves.
//
// A section holds T = state + lost.  One step takes T to (1 - c) T + x but for one u each of the product c v, of the
// change x - c v and of the increment, one u of c v because the product leaves `lost` out, the error of c, and one u
// of the increment where that exceeds the state, because the compensation is exact only where it does not.  These
// errors die away as |1 - c|^n: slowly near c = 0, and near c = 2, where the bilinear rule makes fast poles ring.  The
// output takes v for T, multiplies, and adds up over the groups, over the 8 lanes of a group (3 additions) and the
// direct term; no partial sum exceeds the sum of magnitudes.  The sum over taps is two sums of half the length.
inline std::vector<double> rounding_bound(const frac::DigitalFilterDesign& design, const std::vector<double>& samples,
                                          double coefficients) {
  constexpr double u = 0x1p-53;
  const auto& sections = design.sections;
  const bool of_states = sections.output == frac::SectionOutput::state;
  const std::size_t size = sections.rates.size();
  const double additions = static_cast<double>((size + 7) / 8 - 1 + 3);
  const double tap_roundings = design.taps.size() == 1 ? 0 : 1 + static_cast<double>((design.taps.size() + 1) / 2);
  std::vector<double> state(size, 0), error(size, 0), result;
  for (std::size_t n = 0; n < samples.size(); ++n) {
    double x = 0, size_of_x = 0;
    for (std::size_t k = 0; k < design.taps.size() && k <= n; ++k) {
      x += design.taps[k] * samples[n - k];
      size_of_x += std::abs(design.taps[k] * samples[n - k]);
    }
    const double error_of_x = tap_roundings * u * size_of_x;
    double sum = sections.direct * x;
    double bound = std::abs(sections.direct) * (error_of_x + (1 + coefficients) * u * std::abs(x));
    for (std::size_t i = 0; i < size; ++i) {
      const double rate = sections.rates[i], weight = sections.weights[i], v = state[i];
      const double change = x - rate * v;
      const double of_product = rate * std::abs(v), of_change = std::abs(change);
      const double term = of_states ? v : change;
      sum += weight * term;
      const double of_term = of_states
                                 ? error[i] + u * std::abs(v)
                                 : error_of_x + rate * error[i] + u * ((2 + coefficients) * of_product + of_change);
      bound += std::abs(weight) * (of_term + (1 + coefficients + additions) * u * std::abs(term));
      const double of_compensation = of_change > std::abs(v) ? of_change : 0;
      error[i] = std::abs(1 - rate) * error[i] + error_of_x +
                 u * ((2 + coefficients) * of_product + 2 * of_change + of_compensation);
      state[i] += change;
    }
    result.push_back(bound + u * std::abs(sum));
  }
  return result;
}

/// Largest |exact - output| as a share of what is allowed.
inline double worst_share(const std::vector<Quad>& exact, const std::vector<double>& output,
                          const std::vector<double>& allowed) {
  double worst = 0;
  for (std::size_t n = 0; n < exact.size(); ++n) {
    worst = std::max(worst, static_cast<double>(abs(exact[n] - output[n])) / allowed[n]);
  }
  return worst;
}

/// Largest difference relative to the largest value.
inline double worst_difference(const std::vector<Quad>& exact, const std::vector<double>& output) {
  Quad worst = 0, scale = 0;
  for (std::size_t n = 0; n < exact.size(); ++n) {
    worst = std::max<Quad>(worst, abs(exact[n] - output[n]));
    scale = std::max<Quad>(scale, abs(exact[n]));
  }
  return static_cast<double>(worst / scale);
}

}  // namespace support
