// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <string>
#include <vector>

#include "fixed_point_text.hpp"
#include "frac/digital/fixed_point.hpp"
#include "runtime_text.hpp"

namespace frac {
namespace fixed_point = detail::fixed_point;
namespace {

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

// (1 - 1/z)^differences times the taps.
std::vector<double> with_differences(std::vector<double> taps, int differences) {
  for (int i = 0; i < differences; ++i) {
    taps.push_back(0);
    for (std::size_t k = taps.size() - 1; k > 0; --k) taps[k] -= taps[k - 1];
  }
  return taps;
}

}  // namespace

FixedPointHeader fixed_point_header(const DigitalFilterDesign& design, const FixedPointRanges& ranges,
                                    const CHeaderOptions& options) {
  fixed_point::check(ranges);
  check(design);
  const bool integrates = design.integrators > 0, is_trapezoidal = design.rule == IntegratorRule::trapezoidal;
  const double scale =
      ranges.input / ranges.output * std::pow(design.sample_time, design.integrators - design.differences);
  const fixed_point::Operator parts = fixed_point::operator_of(
      design.sections, {with_differences(design.taps, design.differences), design.pair_rates, design.pair_weights},
      scale);
  constexpr int most_integrator_bits = 58, least_bits = 8;
  const int integrator_bits = std::min(parts.scale(), most_integrator_bits);
  const int output_bits = (integrates ? integrator_bits : parts.scale()) - 31;
  if (output_bits < least_bits) fixed_point::refuse_gain(parts.largest);
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
  detail::CWords words{{"SECTION_OUTPUT", fixed_point::output_of(parts, options.name, "section", "x")},
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
  fixed_point::describe(parts, "SECTION", words, conditions);
  const CHeaderOptions stated = fixed_point::described(options, ranges, result);
  const detail::CText c(stated);
  result.text = c.closed(c.opening(stated.comment) + "#include <stdint.h>\n\n" +
                         c.filled(detail::runtime::q31_filter_state, words, conditions) +
                         fixed_point::functions_of(parts, c, options.name, "section", 31) +
                         fixed_point::pair_arrays(parts, options.name) +
                         c.filled(detail::runtime::q31_filter, words, conditions));
  return result;
}

}  // namespace frac
