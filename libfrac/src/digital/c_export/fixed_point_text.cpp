// SPDX-License-Identifier: BSD-3-Clause
#include "fixed_point_text.hpp"

#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <utility>
#include <vector>

#include "base/bound_text.hpp"
#include "base/number_text.hpp"
#include "base/short_text.hpp"
#include "runtime_text.hpp"

namespace frac::detail::fixed_point {
namespace {

std::string integers(const char* type, const std::string& name, const std::vector<std::int64_t>& values) {
  std::string text = std::string("static const ") + type + " " + name + "[" + std::to_string(values.size()) + "] = {";
  for (std::size_t i = 0; i < values.size(); ++i) text += (i == 0 ? "" : ", ") + std::to_string(values[i]);
  return text + "};\n";
}

}  // namespace

void check(const FixedPointRanges& ranges) {
  for (const auto& [name, value] : {std::pair("input range", ranges.input), std::pair("output range", ranges.output)}) {
    if (!(value > 0 && std::isfinite(value)))
      throw std::invalid_argument("fixed_point_header: " + std::string(name) + " = " + number_text(value) +
                                  "; needed is a positive, finite number");
  }
}

std::string in_brackets(std::int64_t number) {
  return number < 0 ? "(" + std::to_string(number) + ")" : std::to_string(number);
}

void describe(const Operator& from, const std::string& prefix, CWords& words, CConditions& conditions) {
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

std::string functions_of(const Operator& from, const CText& c, const std::string& name, const std::string& prefix,
                         int tap_bits) {
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
  CWords words{{"PREFIX", prefix}, {"PREFIX_TAP_BITS", std::to_string(tap_bits)}};
  CConditions conditions;
  describe(from, "PREFIX", words, conditions);
  return arrays + (arrays.empty() ? "" : "\n") + c.filled(runtime::q31_section, words, conditions);
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
  result.comment +=
      "\nFixed point: inputs are fractions of " + number_text(ranges.input) + " times 2^31, outputs of " +
      number_text(ranges.output) + ";\nan output differs from the exact one by " + bound_text(header.error_bound) +
      (header.error_per_sample > 0 ? " and " + bound_text(header.error_per_sample) + " per sample since the start"
                                   : "") +
      " at most.";
  if (std::isfinite(header.exact_excess))
    result.comment += "\nAt a limit the integral is drawn back as in the exact one as long as the sum exceeds it by " +
                      short_text(header.exact_excess) +
                      " at most;\nbeyond, less in a sample, and later outputs differ by more.";
  return result;
}

}  // namespace frac::detail::fixed_point
