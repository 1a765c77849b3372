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

void check(const DigitalFilterDesign& design, const FixedPointRanges& ranges) {
  for (const auto& [name, value] : {std::pair("input range", ranges.input), std::pair("output range", ranges.output)}) {
    if (!(value > 0 && std::isfinite(value)))
      throw std::invalid_argument("fixed_point_header: " + std::string(name) + " = " + number_text(value) +
                                  "; needed is a positive, finite number");
  }
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
  double error;       // of p as the output takes it, its largest over all time
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
  const double input = std::ldexp(1.0, -31 - s.head) + (s.head > 0 ? std::ldexp(1.0, -30) : 0);
  const double of_rate = std::abs(std::ldexp(static_cast<double>(s.rate), -30 - s.slower) - rate);
  s.error = (rate * input + (rate + of_rate) * std::ldexp(1.0, -31) + 2 * of_rate + std::ldexp(1.0, -60)) / decay +
            std::ldexp(1.0, -31);
  return s;
}

std::string integers(const char* type, const std::string& name, const std::vector<std::int64_t>& values) {
  std::string text = std::string("static const ") + type + " " + name + "[" + std::to_string(values.size()) + "] = {";
  for (std::size_t i = 0; i < values.size(); ++i) text += (i == 0 ? "" : ", ") + std::to_string(values[i]);
  return text + "};\n";
}

}  // namespace

FixedPointHeader fixed_point_header(const DigitalFilterDesign& design, const FixedPointRanges& ranges,
                                    const CHeaderOptions& options) {
  check(design, ranges);
  const ParallelSections& parallel = design.sections;
  const double scale = ranges.input / ranges.output;
  std::vector<Section> sections;
  double direct = parallel.direct * scale;
  for (std::size_t i = 0; i < parallel.rates.size(); ++i) {
    if (parallel.weights[i] == 0) continue;
    // weight (x - r v) is weight x less weight p.
    const bool is_change = parallel.output == SectionOutput::change;
    const double weight = is_change ? -parallel.weights[i] * parallel.rates[i] : parallel.weights[i];
    sections.push_back(section_of(parallel.rates[i], weight * scale));
    if (is_change) direct += parallel.weights[i] * scale;
  }
  double largest = std::abs(direct);
  for (const Section& each : sections) largest = std::max(largest, std::abs(each.gain));
  // Gains times 2^bits fit into 31 bits, and the sum of all products into 63.
  const int bits = 30 - static_cast<int>(std::ceil(std::log2(largest)));
  const int guard = static_cast<int>(std::ceil(std::log2(static_cast<double>(sections.size()) + 2)));
  const int output_bits = bits - 1 - guard;
  constexpr int least_bits = 8;
  if (output_bits < least_bits) {
    throw std::invalid_argument("fixed_point_header: gains up to " + detail::short_text(largest) +
                                " times the output range; a larger range is needed");
  }
  const auto rounded = [&](double gain) { return std::llround(std::ldexp(gain, bits)); };
  const auto rounding = [&](double gain) {
    return std::abs(std::ldexp(static_cast<double>(rounded(gain)), -bits) - gain);
  };
  double bound = std::abs(direct) * std::ldexp(1.0, -31) + rounding(direct) + std::ldexp(1.0, -32) +
                 static_cast<double>(sections.size() + 1) * std::ldexp(1.0, guard - 30 - bits);
  std::vector<std::int64_t> rates, slower, heads, gains;
  for (const Section& each : sections) {
    bound += std::abs(each.gain) * each.error + rounding(each.gain);
    rates.push_back(each.rate);
    slower.push_back(each.slower);
    heads.push_back(each.head);
    gains.push_back(rounded(each.gain));
  }
  FixedPointHeader result;
  result.error_bound = bound * ranges.output;
  CHeaderOptions described = options;
  described.precision = Precision::float_type;
  described.comment += "\nFixed point: inputs are fractions of " + number_text(ranges.input) +
                       " times 2^31, outputs of " + number_text(ranges.output) +
                       ";\nan output differs from the exact one by " + detail::short_text(result.error_bound) +
                       " at most.";
  const detail::CText c(described);
  const std::string& name = options.name;
  result.text =
      c.closed(c.opening(described.comment) + "#include <stdint.h>\n\n" + integers("int32_t", name + "_rate", rates) +
               integers("uint8_t", name + "_slower", slower) + integers("uint8_t", name + "_head", heads) +
               integers("int32_t", name + "_gain", gains) + "\n" +
               c.filled(detail::runtime::q31_filter,
                        {{"SECTIONS", std::to_string(sections.size())},
                         {"DIRECT", "(" + std::to_string(rounded(direct)) + ")"},
                         {"GUARD_BITS", std::to_string(guard)},
                         {"OUTPUT_BITS", std::to_string(output_bits)}},
                        {}));
  return result;
}

}  // namespace frac
