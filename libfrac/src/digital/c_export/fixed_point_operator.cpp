// SPDX-License-Identifier: BSD-3-Clause
#include "fixed_point_operator.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "base/short_text.hpp"

namespace frac::detail::fixed_point {
namespace {

Taps taps_of(const std::vector<double>& taps) {
  if (taps == std::vector<double>{1}) return {};
  Taps result;
  double largest = 0;
  for (const double tap : taps) largest += std::abs(tap);
  result.head = largest > 0 ? static_cast<int>(std::ceil(std::log2(largest))) : 0;
  constexpr std::int64_t one = std::int64_t{1} << 30;
  for (std::int64_t sum = 2 * one; sum > one; ++result.head) {
    result.taps.clear();
    sum = 0;
    for (const double tap : taps) {
      result.taps.push_back(std::llround(std::ldexp(tap, 30 - result.head)));
      sum += std::abs(result.taps.back());
    }
    result.swing = static_cast<double>(sum) / one;
  }
  --result.head;
  // Rounded taps, and the rounded sum.
  result.error = std::ldexp(1.0, -31);
  for (std::size_t k = 0; k < taps.size(); ++k)
    result.error += std::abs(std::ldexp(static_cast<double>(result.taps[k]), -30) - std::ldexp(taps[k], -result.head));
  return result;
}

Section section_of(double rate, double weight) {
  Section s{};
  // Sum of the magnitudes of the impulse response of r/(z - 1 + r), which changes sign where r > 1.
  const double decay = 1 - std::abs(1 - rate);
  const double largest = rate / decay;
  s.head = std::max(0, static_cast<int>(std::ceil(std::log2(largest) - 1e-12)));
  s.slower = -static_cast<int>(std::floor(std::log2(rate)));
  s.rate = std::llround(std::ldexp(rate, 30 + s.slower));
  if (s.rate >= std::int64_t{1} << 31) s.rate = (std::int64_t{1} << 31) - 1;
  s.gain = std::ldexp(weight / rate, s.head);
  // The recursion of the error: input and present value are rounded, the product by a rounded rate is cut.
  const double input = s.head > 0 ? std::ldexp(1.0, -30) : 0;
  const double of_rate = std::abs(std::ldexp(static_cast<double>(s.rate), -30 - s.slower) - rate);
  s.error = (rate * input + (rate + of_rate) * std::ldexp(1.0, -31) + 2 * of_rate + std::ldexp(1.0, -60)) / decay +
            std::ldexp(1.0, -31);
  s.swing = std::ldexp(largest, -s.head);
  return s;
}

Pair pair_of(std::complex<double> rate, std::complex<double> weight) {
  Pair p{};
  const double size = std::abs(rate), factor = std::abs(1.0 - rate);
  // 1 - |1 - r|, of the low-pass r/(z - 1 + r), whose impulse response falls as |1 - r|^n.
  const double decay = (2 * rate.real() - size * size) / (1 + factor);
  const double largest = size / decay;
  const double larger = std::max(std::abs(rate.real()), std::abs(rate.imag()));
  p.slower = -static_cast<int>(std::floor(std::log2(larger)));
  const auto whole = [&](double part) { return std::llround(std::ldexp(part, 29 + p.slower)); };
  const auto held = [&](std::int64_t part) { return std::ldexp(static_cast<double>(part), -29 - p.slower); };
  p.rate_re = whole(rate.real());
  p.rate_im = whole(rate.imag());
  const double of_rate = std::abs(std::complex<double>(held(p.rate_re), held(p.rate_im)) - rate);
  // The recursion of the error: the input is cut, both parts of the present value are rounded and both products cut.
  // A rounded rate acts on the present value with its error.
  constexpr double root = std::numbers::sqrt2;
  const double rounded = root * std::ldexp(1.0, -31), cut = root * std::ldexp(1.0, -59);
  const double rest = decay - of_rate;
  constexpr double most_lost = 1U << 20U;
  if (!(rest > 0 && largest < most_lost))
    throw std::invalid_argument(
        "fixed_point_header: a pair of complex poles is damped too little: |r|/(1 - |1 - r|) = " + short_text(largest) +
        " of its rate r; allowed is above 0, up to 1e6");
  p.head = std::max(0, static_cast<int>(std::ceil(std::log2(largest) - 1e-12)));
  const double input = p.head > 0 ? std::ldexp(1.0, -30) : 0;
  p.gain = std::ldexp(1.0, p.head) * weight / rate;
  p.error = (size * input + (size + of_rate) * rounded + 2 * of_rate + cut) / rest + rounded;
  p.swing = std::ldexp(largest, -p.head);
  return p;
}

}  // namespace

Operator operator_of(const ParallelSections& parallel, const Others& others, double scale) {
  Operator result;
  if (others.taps.size() == 1)
    scale *= others.taps.front();
  else
    result.taps = taps_of(others.taps);
  scale = std::ldexp(scale, result.taps.head);
  double direct = parallel.direct * scale;
  for (std::size_t i = 0; i < parallel.rates.size(); ++i) {
    if (parallel.weights[i] == 0) continue;
    // weight (x - r v) is weight x less weight p.
    const bool is_change = parallel.output == SectionOutput::change;
    const double weight = is_change ? -parallel.weights[i] * parallel.rates[i] : parallel.weights[i];
    result.sections.push_back(section_of(parallel.rates[i], weight * scale));
    if (is_change) direct += parallel.weights[i] * scale;
  }
  for (std::size_t i = 0; i < others.pair_rates.size(); ++i)
    if (others.pair_weights[i] != 0.0)
      result.pairs.push_back(pair_of(others.pair_rates[i], others.pair_weights[i] * scale));
  result.largest = std::abs(direct);
  for (const Section& each : result.sections) result.largest = std::max(result.largest, std::abs(each.gain));
  for (const Pair& each : result.pairs)
    result.largest = std::max({result.largest, std::abs(each.gain.real()), std::abs(each.gain.imag())});
  // Gains times 2^bits fit into 31 bits, and the sum of all products into 61.  Beyond some bits nothing is left of a
  // product in the output.
  constexpr double least = 1e-9;
  result.bits = 30 - static_cast<int>(std::ceil(std::log2(std::max(result.largest, least))));
  const auto products = static_cast<double>(result.sections.size() + 2 * result.pairs.size() + 1);
  result.guard = static_cast<int>(std::ceil(std::log2(products + 1)));
  const auto rounded = [&](double gain) { return std::llround(std::ldexp(gain, result.bits)); };
  const auto rounding = [&](double gain) {
    return std::abs(std::ldexp(static_cast<double>(rounded(gain)), -result.bits) - gain);
  };
  result.direct = rounded(direct);
  result.error = rounding(direct) + products * std::ldexp(1.0, -result.scale());
  result.swing = std::abs(direct);
  for (const Section& each : result.sections) {
    result.gains.push_back(rounded(each.gain));
    result.error += std::abs(each.gain) * each.error + rounding(each.gain);
    result.swing += std::abs(each.gain) * each.swing;
  }
  for (const Pair& each : result.pairs) {
    const auto [re, im] = std::pair(each.gain.real(), each.gain.imag());
    result.pair_gains_re.push_back(rounded(re));
    result.pair_gains_im.push_back(rounded(im));
    result.error += std::abs(each.gain) * each.error + rounding(re) + rounding(im);
    result.swing += std::abs(each.gain) * each.swing;
  }
  return result;
}

Operator operator_of(const PidFilter& from, double scale) {
  Others others;
  if (!from.taps.empty()) others.taps = from.taps;
  while (others.taps.size() > 1 && others.taps.back() == 0) others.taps.pop_back();
  return operator_of(from.sections, others, scale);
}

Product product_of(double gain) {
  constexpr int longest = 62;
  if (gain == 0) return {};
  int exponent = 0;
  static_cast<void>(std::frexp(gain, &exponent));
  Product product;
  product.shift = 29 - exponent;
  if (product.shift < 0) refuse_gain(gain);
  if (product.shift > longest) return {0, 0, std::abs(gain)};
  product.number = std::llround(std::ldexp(gain, product.shift));
  product.rounding = std::abs(std::ldexp(static_cast<double>(product.number), -product.shift) - gain);
  return product;
}

void refuse_gain(double gain) {
  throw std::invalid_argument("fixed_point_header: gains up to " + short_text(gain) +
                              " times the output range; a larger range is needed");
}

}  // namespace frac::detail::fixed_point
