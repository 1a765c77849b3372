// SPDX-License-Identifier: BSD-3-Clause
#include "frac/digital/fixed_point.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <stdexcept>
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
  const auto refuse = [](const std::string& what) {
    throw std::invalid_argument("fixed_point_header: the filter has " + what + "; fixed point takes sections alone");
  };
  if (design.taps != std::vector<double>{1}) refuse(std::to_string(design.taps.size()) + " taps");
  if (!design.pair_rates.empty()) refuse(std::to_string(design.pair_rates.size()) + " pairs of complex poles");
  if (design.differences > 0) refuse(std::to_string(design.differences) + " differences");
  if (design.integrators > 0) refuse(std::to_string(design.integrators) + " integrators");
  if (design.dead_samples > 0) refuse(std::to_string(design.dead_samples) + " samples of dead time");
  if (design.sections.rates.empty()) refuse("no section");
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
  // Of the low-pass r/(z - 1 + r), whose impulse response changes sign where r > 1.
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

// Sections in whole numbers.  Inputs are fractions of their range times 2^30; sums are those of the output range times
// 2^(bits + 30 - guard).
struct Operator {
  std::vector<Section> sections;
  std::int64_t direct = 0;
  std::vector<std::int64_t> gains;
  int bits = 0;
  int guard = 0;
  double largest = 0;  // gain
  double error = 0;    // of the output for exact inputs, over its range
  double swing = 0;    // output over the largest input, both over their ranges

  [[nodiscard]] int scale() const { return bits + 30 - guard; }
};

// @param scale  input range over output range, times a gain in front
Operator operator_of(const ParallelSections& parallel, double scale) {
  Operator result;
  double direct = parallel.direct * scale;
  for (std::size_t i = 0; i < parallel.rates.size(); ++i) {
    if (parallel.weights[i] == 0) continue;
    // weight (x - r v) is weight x less weight p.
    const bool is_change = parallel.output == SectionOutput::change;
    const double weight = is_change ? -parallel.weights[i] * parallel.rates[i] : parallel.weights[i];
    result.sections.push_back(section_of(parallel.rates[i], weight * scale));
    if (is_change) direct += parallel.weights[i] * scale;
  }
  result.largest = std::abs(direct);
  for (const Section& each : result.sections) result.largest = std::max(result.largest, std::abs(each.gain));
  // Gains times 2^bits fit into 31 bits, and the sum of all products into 63.
  result.bits = 30 - static_cast<int>(std::ceil(std::log2(result.largest)));
  result.guard = static_cast<int>(std::ceil(std::log2(static_cast<double>(result.sections.size()) + 2)));
  const auto rounded = [&](double gain) { return std::llround(std::ldexp(gain, result.bits)); };
  const auto rounding = [&](double gain) {
    return std::abs(std::ldexp(static_cast<double>(rounded(gain)), -result.bits) - gain);
  };
  result.direct = rounded(direct);
  result.error = rounding(direct) + static_cast<double>(result.sections.size() + 1) * std::ldexp(1.0, -result.scale());
  result.swing = std::abs(direct);
  for (const Section& each : result.sections) {
    result.gains.push_back(rounded(each.gain));
    result.error += std::abs(each.gain) * each.error + rounding(each.gain);
    result.swing += std::abs(each.gain) * each.swing;
  }
  return result;
}

std::string integers(const char* type, const std::string& name, const std::vector<std::int64_t>& values) {
  std::string text = std::string("static const ") + type + " " + name + "[" + std::to_string(values.size()) + "] = {";
  for (std::size_t i = 0; i < values.size(); ++i) text += (i == 0 ? "" : ", ") + std::to_string(values[i]);
  return text + "};\n";
}

// The arrays of an operator and, under its prefix, what else its text needs.
std::string arrays_of(const Operator& from, const std::string& name, const std::string& prefix) {
  if (from.sections.empty()) return {};
  std::vector<std::int64_t> rates, slower, heads;
  for (const Section& each : from.sections) {
    rates.push_back(each.rate);
    slower.push_back(each.slower);
    heads.push_back(each.head);
  }
  const std::string start = name + "_" + prefix;
  return integers("int32_t", start + "_rate", rates) + integers("uint8_t", start + "_slower", slower) +
         integers("uint8_t", start + "_head", heads) + integers("int32_t", start + "_gain", from.gains) + "\n";
}

std::string in_brackets(std::int64_t number) {
  return number < 0 ? "(" + std::to_string(number) + ")" : std::to_string(number);
}

std::string functions_of(const Operator& from, const detail::CText& c, const std::string& prefix) {
  return c.filled(detail::runtime::q31_section,
                  {{"PREFIX", prefix},
                   {"PREFIX_DIRECT", in_brackets(from.direct)},
                   {"PREFIX_GUARD", std::to_string(from.guard)},
                   {"PREFIX_SIZE", std::to_string(from.sections.size())}},
                  {{"HAS_PREFIX_SECTIONS", !from.sections.empty()}});
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

const ParallelSections& sections_of(const PidFilter& filter) {
  if (!filter.taps.empty())
    throw std::invalid_argument("fixed_point_header: the controller has " + std::to_string(filter.taps.size()) +
                                " taps; fixed point takes sections alone, such as those of --discretisation tustin");
  return filter.sections;
}

}  // namespace

FixedPointHeader fixed_point_header(const DigitalFilterDesign& design, const FixedPointRanges& ranges,
                                    const CHeaderOptions& options) {
  check(ranges);
  check(design);
  const Operator parts = operator_of(design.sections, ranges.input / ranges.output);
  const int output_bits = parts.bits - 1 - parts.guard;
  constexpr int least_bits = 8;
  if (output_bits < least_bits) refuse_gain(parts.largest);
  FixedPointHeader result;
  // Halved samples, and the rounded output.
  result.error_bound = (parts.error + parts.swing * std::ldexp(1.0, -31) + std::ldexp(1.0, -32)) * ranges.output;
  const detail::CText c(described(options, ranges, result));
  const detail::CWords words{{"SECTION_SIZE", std::to_string(parts.sections.size())},
                             {"OUTPUT_BITS", std::to_string(output_bits)}};
  result.text =
      c.closed(c.opening(described(options, ranges, result).comment) + "#include <stdint.h>\n\n" +
               c.filled(detail::runtime::q31_filter_state, words, {}) + arrays_of(parts, options.name, "section") +
               functions_of(parts, c, "section") + c.filled(detail::runtime::q31_filter, words, {}));
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
  // Errors are fractions of 4 input ranges; the sum has 48 bits below the output range, the integrator 58.
  constexpr double room = 4;
  constexpr int sum_bits = 48, integrator_bits = 58, input_bits = 30;
  const double of_input = std::ldexp(1.0, -input_bits);
  const Product kp = product_of(std::ldexp(k.kp * ratio, sum_bits - input_bits));
  Operator integral, derivative;
  if (integrates) integral = operator_of(sections_of(design.integral()), k.sample_time * k.ki * room * ratio);
  if (differs) {
    const double gain = k.kd * (k.differentiates ? k.inverse_lag_time : 1);
    derivative = operator_of(sections_of(design.derivative()), gain * room * ratio);
  }
  const int integral_shift = integral.scale() - integrator_bits, derivative_shift = derivative.scale() - sum_bits;
  if (integrates && integral_shift < 0) refuse_gain(integral.largest);
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
    d = derivative.error + derivative.swing * given + std::ldexp(1.0, -sum_bits);
  }
  if (integrates) i = integral.error + integral.swing * error + std::ldexp(1.0, -integrator_bits);
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
  const auto output_of = [&](const Operator& parts, const std::string& prefix) {
    return parts.sections.empty() ? "((int64_t)" + in_brackets(parts.direct) + " * " + prefix + "_input >> " +
                                        std::to_string(parts.guard) + ")"
                                  : options.name + "_" + prefix + "_output(s, " + prefix + "_input)";
  };
  const detail::CWords words{{"INTEGRAL_SIZE", std::to_string(integral.sections.size())},
                             {"DERIVATIVE_SIZE", std::to_string(derivative.sections.size())},
                             {"INTEGRAL_OUTPUT", output_of(integral, "integral")},
                             {"DERIVATIVE_OUTPUT", output_of(derivative, "derivative")},
                             {"INTEGRAL_SHIFT", std::to_string(integral_shift)},
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
  const detail::CConditions conditions{{"HAS_INTEGRAL", integrates},
                                       {"HAS_DERIVATIVE", differs},
                                       {"HAS_INTEGRAL_SECTIONS", !integral.sections.empty()},
                                       {"HAS_DERIVATIVE_SECTIONS", !derivative.sections.empty()},
                                       {"HAS_ANY_SECTIONS", !integral.sections.empty() || !derivative.sections.empty()},
                                       {"FOLLOWS_LAG", !k.differentiates},
                                       {"BACK_CALCULATION", tracks}};
  const detail::CText c(described(options, ranges, result));
  result.text = c.closed(c.opening(described(options, ranges, result).comment) + "#include <stdint.h>\n\n" +
                         c.filled(detail::runtime::q31_pid_state, words, conditions) +
                         arrays_of(integral, options.name, "integral") + functions_of(integral, c, "integral") +
                         arrays_of(derivative, options.name, "derivative") + functions_of(derivative, c, "derivative") +
                         c.filled(detail::runtime::q31_pid, words, conditions));
  return result;
}

}  // namespace frac
