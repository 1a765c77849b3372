// SPDX-License-Identifier: BSD-3-Clause
#include "resonance_axis.hpp"

#include <algorithm>
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <cmath>
#include <limits>
#include <utility>

namespace frac::detail {
namespace {

using Quad = boost::multiprecision::cpp_bin_float_quad;

// (cos, sin) of order pi/2, of whole orders exactly.
std::pair<Quad, Quad> phase(double order) {
  const double turn = std::fmod(order, 4);
  if (turn == std::floor(turn)) {
    const int quarter = static_cast<int>(turn) & 3;
    return {quarter == 0 ? 1 : quarter == 2 ? -1 : 0, quarter == 1 ? 1 : quarter == 3 ? -1 : 0};
  }
  const Quad angle = turn * boost::math::constants::half_pi<Quad>();
  return {cos(angle), sin(angle)};
}

}  // namespace

ResonanceAxis::ResonanceAxis(const LaplaceImage& image, double middle) : middle_(middle) {
  const auto add = [&](const PowerProduct& product, int sign) {
    product.for_each_sum([&](const std::vector<PowerTerm>& terms, int power) {
      Sum sum{0, {}, -std::numeric_limits<double>::infinity(), sign * power};
      for (const PowerTerm& term : terms) {
        sum.scale = std::max(sum.scale, std::log(std::abs(term.coefficient)) + term.order * middle);
      }
      Quad real = 0;
      Quad imaginary = 0;
      for (const PowerTerm& term : terms) {
        const Quad size = term.coefficient * exp(Quad(term.order) * Quad(middle) - sum.scale);
        const auto [cosine, sine] = phase(term.order);
        real += size * cosine;
        imaginary += size * sine;
        sum.terms.push_back(
            {{static_cast<long double>(size * cosine), static_cast<long double>(size * sine)}, term.order});
      }
      sum.value = {static_cast<long double>(real), static_cast<long double>(imaginary)};
      sums_.push_back(std::move(sum));
    });
  };
  add(image.numerator(), 1);
  add(image.denominator(), -1);
}

long double ResonanceAxis::log_gain(double offset) const {
  long double sum_of_logs = 0;
  for (const Sum& sum : sums_) {
    std::complex<long double> value = sum.value;
    for (const Term& term : sum.terms) {
      value += term.value * std::expm1(static_cast<long double>(term.order) * static_cast<long double>(offset));
    }
    sum_of_logs += sum.power * (std::log(std::abs(value)) + sum.scale);
  }
  return sum_of_logs;
}

}  // namespace frac::detail
