#pragma once

#include <algorithm>
#include <boost/multiprecision/float128.hpp>
#include <cstddef>
#include <vector>

#include "frac/digital_filter.hpp"
#include "frac/zero_pole_gain.hpp"

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
