// SPDX-License-Identifier: BSD-3-Clause
#include "frac/digital/fixed_point.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "base/number_text.hpp"
#include "base/short_text.hpp"
#include "c_text.hpp"
#include "runtime_text.hpp"

namespace frac {
namespace {

using detail::number_text;

void check(const FixedPointRanges& ranges) {
  for (const auto& [name, value] : {std::pair("input range", ranges.input), std::pair("output range", ranges.output)}) {
    if (!(value > 0 && std::isfinite(value)))
      throw std::invalid_argument("fixed_point_header: " + std::string(name) + " = " + number_text(value) +
                                  "; needed is a positive, finite number");
  }
}

[[noreturn]] void refuse_gain(double gain) {
  throw std::invalid_argument("fixed_point_header: gains up to " + detail::short_text(gain) +
                              " times the output range; a larger range is needed");
}

void check(const DigitalFilterDesign& design) {
  if (design.integrators > 1)
    throw std::invalid_argument("fixed_point_header: the filter has " + std::to_string(design.integrators) +
                                " integrators; fixed point takes one, as rounding adds up faster in more");
  constexpr std::size_t most_dead = 100'000;
  if (design.dead_samples > most_dead)
    throw std::invalid_argument("fixed_point_header: dead time of " + std::to_string(design.dead_samples) +
                                " samples; allowed is up to " + std::to_string(most_dead));
  // Checks the rest.
  [[maybe_unused]] const DigitalFilter<double> checked(design);
}

// sum tap_k x_(n-k) over 2^head, within -1 .. 1 for inputs that are.
struct Taps {
  int head = 0;
  std::vector<std::int64_t> taps;  // times 2^(30 - head); empty: x itself
  double swing = 1;                // largest output for inputs up to 1
  double error = 0;                // of the output for exact inputs

  [[nodiscard]] double error_with(double of_input) const { return swing * of_input + error; }
};

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

// (1 - 1/z)^differences times the taps.
std::vector<double> with_differences(std::vector<double> taps, int differences) {
  for (int i = 0; i < differences; ++i) {
    taps.push_back(0);
    for (std::size_t k = taps.size() - 1; k > 0; --k) taps[k] -= taps[k - 1];
  }
  return taps;
}

// v += x - r v as p = r v/2^head: p += r (x/2^head - p), which stays within -1 .. 1 for inputs that do.
struct Section {
  int head;
  int slower;         // r = rate/2^(30 + slower)
  std::int64_t rate;  // 2^30 to below 2^31
  double gain;        // of p in the output, both as fractions of their ranges
  double error;       // of p as the output takes it, its largest over all time, for an exact input
  double swing;       // largest p for inputs up to 1
};

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

// The same with a complex rate, p += r (x/2^head - p), |p| <= 1.
struct Pair {
  int head;
  int slower;                     // r = rate/2^(29 + slower)
  std::int64_t rate_re, rate_im;  // the larger 2^29 to 2^30
  std::complex<double> gain;      // the output is Re(gain p), both as fractions of their ranges
  double error;                   // of |p| as the output takes it, its largest over all time, for an exact input
  double swing;                   // largest |p| for inputs up to 1
};

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
        "fixed_point_header: a pair of complex poles is damped too little: |r|/(1 - |1 - r|) = " +
        detail::short_text(largest) + " of its rate r; allowed is above 0, up to 1e6");
  p.head = std::max(0, static_cast<int>(std::ceil(std::log2(largest) - 1e-12)));
  const double input = p.head > 0 ? std::ldexp(1.0, -30) : 0;
  p.gain = std::ldexp(1.0, p.head) * weight / rate;
  p.error = (size * input + (size + of_rate) * rounded + 2 * of_rate + cut) / rest + rounded;
  p.swing = std::ldexp(largest, -p.head);
  return p;
}

// Taps, sections and pairs in whole numbers.  Inputs are fractions of their range times 2^30; sums are those of the
// output range times 2^(bits + 30 - guard).
struct Operator {
  Taps taps;
  std::vector<Section> sections;
  std::vector<Pair> pairs;
  std::int64_t direct = 0;
  std::vector<std::int64_t> gains;
  std::vector<std::int64_t> pair_gains_re, pair_gains_im;
  int bits = 0;
  int guard = 0;
  double largest = 0;  // gain
  double error = 0;    // of the output for exact values behind the taps, over its range
  double swing = 0;    // output over the largest value behind the taps, both over their ranges

  [[nodiscard]] int scale() const { return bits + 30 - guard; }
  [[nodiscard]] double error_with(double of_input) const { return error + swing * taps.error_with(of_input); }
};

// What a filter has beside its sections.
struct Others {
  std::vector<double> taps = {1};
  std::vector<std::complex<double>> pair_rates = {}, pair_weights = {};
};

// @param scale  input range over output range, times a gain in front
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

std::string integers(const char* type, const std::string& name, const std::vector<std::int64_t>& values) {
  std::string text = std::string("static const ") + type + " " + name + "[" + std::to_string(values.size()) + "] = {";
  for (std::size_t i = 0; i < values.size(); ++i) text += (i == 0 ? "" : ", ") + std::to_string(values[i]);
  return text + "};\n";
}

std::string in_brackets(std::int64_t number) {
  return number < 0 ? "(" + std::to_string(number) + ")" : std::to_string(number);
}

// What the C text needs of an operator, under its prefix in capitals or as PREFIX.
void describe(const Operator& from, const std::string& prefix, detail::CWords& words, detail::CConditions& conditions) {
  const bool has_taps = !from.taps.taps.empty(), has_sections = !from.sections.empty();
  words[prefix + "_DIRECT"] = in_brackets(from.direct);
  words[prefix + "_GUARD"] = std::to_string(from.guard);
  words[prefix + "_SIZE"] = std::to_string(from.sections.size());
  words[prefix + "_TAPS"] = std::to_string(from.taps.taps.size());
  words[prefix + "_PAST"] = std::to_string(has_taps ? from.taps.taps.size() - 1 : 0);
  conditions["HAS_" + prefix + "_TAPS"] = has_taps;
  conditions["HAS_" + prefix + "_SECTIONS"] = has_sections;
  conditions["HAS_" + prefix + "_STATE"] = has_taps || has_sections;
  conditions["HAS_" + prefix + "_TAPS_ALONE"] = has_taps && !has_sections;
}

// Arrays and functions.
// @param tap_bits  input of the taps over what they give, in bits, and 30
std::string functions_of(const Operator& from, const detail::CText& c, const std::string& name,
                         const std::string& prefix, int tap_bits) {
  const std::string start = name + "_" + prefix;
  std::string arrays;
  if (!from.taps.taps.empty()) arrays += integers("int32_t", start + "_tap", from.taps.taps);
  if (!from.sections.empty()) {
    std::vector<std::int64_t> rates, slower, heads;
    for (const Section& each : from.sections) {
      rates.push_back(each.rate);
      slower.push_back(each.slower);
      heads.push_back(each.head);
    }
    arrays += integers("int32_t", start + "_rate", rates) + integers("uint8_t", start + "_slower", slower) +
              integers("uint8_t", start + "_head", heads) + integers("int32_t", start + "_gain", from.gains);
  }
  detail::CWords words{{"PREFIX", prefix}, {"PREFIX_TAP_BITS", std::to_string(tap_bits)}};
  detail::CConditions conditions;
  describe(from, "PREFIX", words, conditions);
  return arrays + (arrays.empty() ? "" : "\n") + c.filled(detail::runtime::q31_section, words, conditions);
}

std::string pair_arrays(const Operator& from, const std::string& name) {
  if (from.pairs.empty()) return {};
  std::vector<std::int64_t> re, im, slower, heads;
  for (const Pair& each : from.pairs) {
    re.push_back(each.rate_re);
    im.push_back(each.rate_im);
    slower.push_back(each.slower);
    heads.push_back(each.head);
  }
  const std::string start = name + "_pair_";
  return integers("int32_t", start + "rate_re", re) + integers("int32_t", start + "rate_im", im) +
         integers("uint8_t", start + "slower", slower) + integers("uint8_t", start + "head", heads) +
         integers("int32_t", start + "gain_re", from.pair_gains_re) +
         integers("int32_t", start + "gain_im", from.pair_gains_im) + "\n";
}

// The sum of direct term and sections for an input of that name.
std::string output_of(const Operator& from, const std::string& name, const std::string& prefix,
                      const std::string& input) {
  return from.sections.empty()
             ? "((int64_t)" + in_brackets(from.direct) + " * " + input + " >> " + std::to_string(from.guard) + ")"
             : name + "_" + prefix + "_output(s, " + input + ")";
}

CHeaderOptions described(const CHeaderOptions& options, const FixedPointRanges& ranges,
                         const FixedPointHeader& header) {
  CHeaderOptions result = options;
  result.precision = Precision::float_type;
  result.comment += "\nFixed point: inputs are fractions of " + number_text(ranges.input) + " times 2^31, outputs of " +
                    number_text(ranges.output) + ";\nan output differs from the exact one by " +
                    detail::short_text(header.error_bound) +
                    (header.error_per_sample > 0
                         ? " and " + detail::short_text(header.error_per_sample) + " per sample since the start"
                         : "") +
                    " at most.";
  return result;
}

// A gain as a whole number below 2^30 and a shift to the right.
struct Product {
  std::int64_t number = 0;
  int shift = 0;
  double rounding = 0;  // of the gain
};

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

Operator operator_of(const PidFilter& from, double scale) {
  Others others;
  if (!from.taps.empty()) others.taps = from.taps;
  while (others.taps.size() > 1 && others.taps.back() == 0) others.taps.pop_back();
  return operator_of(from.sections, others, scale);
}

}  // namespace

FixedPointHeader fixed_point_header(const DigitalFilterDesign& design, const FixedPointRanges& ranges,
                                    const CHeaderOptions& options) {
  check(ranges);
  check(design);
  const bool integrates = design.integrators > 0, is_trapezoidal = design.rule == IntegratorRule::trapezoidal;
  const double scale =
      ranges.input / ranges.output * std::pow(design.sample_time, design.integrators - design.differences);
  const Operator parts =
      operator_of(design.sections,
                  {with_differences(design.taps, design.differences), design.pair_rates, design.pair_weights}, scale);
  constexpr int most_integrator_bits = 58, least_bits = 8;
  const int integrator_bits = std::min(parts.scale(), most_integrator_bits);
  const int output_bits = (integrates ? integrator_bits : parts.scale()) - 31;
  if (output_bits < least_bits) refuse_gain(parts.largest);
  FixedPointHeader result;
  // Taps take samples as they come; without them samples are halved.
  const bool has_taps = !parts.taps.taps.empty();
  const double error = parts.error_with(has_taps ? 0 : std::ldexp(1.0, -31));
  const double rounding = std::ldexp(1.0, -32);
  if (integrates) {
    // The error of each increment, in its last bit too, stays in the integral; half of the present one is added.
    const double of_increment = error + std::ldexp(1.0, -integrator_bits);
    result.error_per_sample = of_increment * ranges.output;
    result.error_bound =
        ((is_trapezoidal ? of_increment / 2 + std::ldexp(1.0, -integrator_bits) : 0) + rounding) * ranges.output;
  } else {
    result.error_bound = (error + rounding) * ranges.output;
  }
  detail::CWords words{{"SECTION_OUTPUT", output_of(parts, options.name, "section", "x")},
                       {"PAIRS", std::to_string(parts.pairs.size())},
                       {"DEAD_SAMPLES", std::to_string(design.dead_samples)},
                       {"INTEGRAL_SHIFT", std::to_string(parts.scale() - integrator_bits)},
                       {"INTEGRAL_LIMIT_BITS", std::to_string(integrator_bits + 4)},
                       {"OUTPUT_BITS", std::to_string(output_bits)}};
  const bool has_dead_time = design.dead_samples > 0;
  const bool has_arrays = has_taps || !parts.sections.empty() || !parts.pairs.empty() || has_dead_time;
  detail::CConditions conditions{{"HAS_PAIRS", !parts.pairs.empty()}, {"HAS_INTEGRATOR", integrates},
                                 {"IS_TRAPEZOIDAL", is_trapezoidal},  {"HAS_DEAD_TIME", has_dead_time},
                                 {"HAS_ARRAYS", has_arrays},          {"HAS_NOTHING", !has_arrays && !integrates}};
  describe(parts, "SECTION", words, conditions);
  const detail::CText c(described(options, ranges, result));
  result.text = c.closed(c.opening(described(options, ranges, result).comment) + "#include <stdint.h>\n\n" +
                         c.filled(detail::runtime::q31_filter_state, words, conditions) +
                         functions_of(parts, c, options.name, "section", 31) + pair_arrays(parts, options.name) +
                         c.filled(detail::runtime::q31_filter, words, conditions));
  return result;
}

FixedPointHeader fixed_point_header(const FractionalPidDesign& design, const FixedPointRanges& ranges,
                                    const CHeaderOptions& options) {
  check(ranges);
  const PidCoefficients<double> k(design);
  if (k.anti_windup == AntiWindup::conditional_integration)
    throw std::invalid_argument("fixed_point_header: fixed point has no conditional integration; back calculation is");
  for (const double weight : {k.setpoint_weight, k.derivative_setpoint_weight}) {
    if (!(weight >= 0 && weight <= 1))
      throw std::invalid_argument("fixed_point_header: a set-point weight of " + number_text(weight) +
                                  "; fixed point takes 0 to 1");
  }
  const bool integrates = k.ki != 0, differs = k.kd != 0;
  const double ratio = ranges.input / ranges.output;
  // Errors are fractions of 4 input ranges; the sum has 48 bits below the output range, the integrator up to 58.
  constexpr double room = 4;
  constexpr int sum_bits = 48, most_integrator_bits = 58, input_bits = 30;
  const double of_input = std::ldexp(1.0, -input_bits);
  const Product kp = product_of(std::ldexp(k.kp * ratio, sum_bits - input_bits));
  Operator integral, derivative;
  if (integrates) integral = operator_of(design.integral(), k.sample_time * k.ki * room * ratio);
  if (differs) {
    const double gain = k.kd * (k.differentiates ? k.inverse_lag_time : 1);
    derivative = operator_of(design.derivative(), gain * room * ratio);
  }
  const int integrator_bits = integrates ? std::min(integral.scale(), most_integrator_bits) : most_integrator_bits;
  const int derivative_shift = derivative.scale() - sum_bits;
  if (integrator_bits < sum_bits) refuse_gain(integral.largest);
  if (differs && derivative_shift < 0) refuse_gain(derivative.largest);
  const bool tracks = integrates && k.anti_windup == AntiWindup::back_calculation;
  Product tracking, high;
  if (tracks) {
    tracking = product_of(k.tracking_share * k.inverse_tracking / (k.ki * room * ratio));
    high = product_of(
        std::ldexp(k.sample_time * k.ki * design.integral().high_gain * room * ratio, integrator_bits - input_bits));
  }

  // In units of 2^-30 of the input range: half a bit lost by halving each of two numbers, and, with a weight, half of
  // its rounding, half of what it weighs and one of the product.
  const double of_error = 1, of_weighted = of_error + 2;
  const double p = of_weighted * of_input * std::abs(k.kp) * ratio +
                   2 * std::ldexp(kp.rounding, input_bits - sum_bits) + std::ldexp(1.0, -sum_bits);
  // Cut to fractions of 4 input ranges.
  const double error = (of_error / room + 1) * of_input, weighted = (of_weighted / room + 1) * of_input;
  double d = 0, i = 0;
  if (differs) {
    // The lag follows what it is given with gain 1; its own value is rounded, and so is its share.
    const double half = of_input / 2;
    const double lag = weighted + half + half / k.lag_share;
    const double given = k.differentiates ? weighted + lag + half : lag + half;
    d = derivative.error_with(given) + std::ldexp(1.0, -sum_bits);
  }
  if (integrates) i = integral.error_with(error) + std::ldexp(1.0, -integrator_bits);
  FixedPointHeader result;
  result.error_bound = (p + d + i / 2 + std::ldexp(1.0, 2 - sum_bits) + std::ldexp(1.0, -32)) * ranges.output;
  result.error_per_sample = i * ranges.output;

  const auto whole = [](double value) {
    const double most = std::ldexp(1.0, 31);
    return std::clamp<std::int64_t>(std::llround(std::clamp(value * most, -most, most)), INT32_MIN, INT32_MAX);
  };
  const auto share = [](double value) { return std::to_string(std::llround(std::ldexp(value, 30))); };
  const std::int64_t minimum = whole(k.minimum / ranges.output), maximum = whole(k.maximum / ranges.output);
  // The least of 32 bits has no number of its own in C.
  const auto limit = [](std::int64_t value) {
    return value == INT32_MIN ? std::string("INT32_MIN") : in_brackets(value);
  };
  const auto sum_of = [&](const Operator& parts, const std::string& prefix) {
    return output_of(parts, options.name, prefix, prefix + (parts.taps.taps.empty() ? "_input" : "_x"));
  };
  detail::CWords words{{"INTEGRAL_OUTPUT", sum_of(integral, "integral")},
                       {"DERIVATIVE_OUTPUT", sum_of(derivative, "derivative")},
                       {"INTEGRAL_SHIFT", std::to_string(integral.scale() - integrator_bits)},
                       {"INTEGRATOR_BITS", std::to_string(integrator_bits)},
                       {"INTEGRATOR_EXTRA", std::to_string(integrator_bits - sum_bits)},
                       {"INTEGRATOR_HALVED", std::to_string(integrator_bits - sum_bits + 1)},
                       {"INTEGRATOR_LIMIT_BITS", std::to_string(integrator_bits + 4)},
                       {"DERIVATIVE_SHIFT", std::to_string(derivative_shift)},
                       {"KP", in_brackets(kp.number)},
                       {"KP_SHIFT", std::to_string(kp.shift)},
                       {"SETPOINT_GAP", share(1 - k.setpoint_weight)},
                       {"DERIVATIVE_SETPOINT_GAP", share(1 - k.derivative_setpoint_weight)},
                       {"LAG_SHARE", share(k.lag_share)},
                       {"TRACKING", in_brackets(tracking.number)},
                       {"TRACKING_SHIFT", std::to_string(tracking.shift)},
                       {"HIGH_GAIN", in_brackets(high.number)},
                       {"HIGH_GAIN_SHIFT", std::to_string(high.shift)},
                       {"MINIMUM", limit(minimum)},
                       {"MAXIMUM", limit(maximum)},
                       {"REST_OUTPUT", limit(std::clamp<std::int64_t>(0, minimum, maximum))}};
  detail::CConditions conditions{{"HAS_INTEGRAL", integrates},
                                 {"HAS_DERIVATIVE", differs},
                                 {"FOLLOWS_LAG", !k.differentiates},
                                 {"BACK_CALCULATION", tracks}};
  describe(integral, "INTEGRAL", words, conditions);
  describe(derivative, "DERIVATIVE", words, conditions);
  conditions["HAS_ANY_STATE"] = conditions["HAS_INTEGRAL_STATE"] || conditions["HAS_DERIVATIVE_STATE"];
  const detail::CText c(described(options, ranges, result));
  result.text = c.closed(c.opening(described(options, ranges, result).comment) + "#include <stdint.h>\n\n" +
                         c.filled(detail::runtime::q31_pid_state, words, conditions) +
                         functions_of(integral, c, options.name, "integral", 30) +
                         functions_of(derivative, c, options.name, "derivative", 30) +
                         c.filled(detail::runtime::q31_pid, words, conditions));
  return result;
}

}  // namespace frac
