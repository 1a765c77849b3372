// SPDX-License-Identifier: BSD-3-Clause
#include <cstddef>
#include <stdexcept>
#include <string>
#include <vector>

#include "c_text.hpp"
#include "runtime_text.hpp"
#include "tuned_header.hpp"

namespace frac {
namespace {

std::string pair_arrays(const DigitalFilterDesign& design, const detail::CText& c) {
  if (design.pair_rates.empty()) return {};
  std::vector<double> rate_re, rate_im, weight_re, weight_im;
  for (std::size_t i = 0; i < design.pair_rates.size(); ++i) {
    rate_re.push_back(design.pair_rates[i].real());
    rate_im.push_back(design.pair_rates[i].imag());
    weight_re.push_back(design.pair_weights[i].real());
    weight_im.push_back(design.pair_weights[i].imag());
  }
  return c.array("pair_rate_re", rate_re) + c.array("pair_rate_im", rate_im) + c.array("pair_weight_re", weight_re) +
         c.array("pair_weight_im", weight_im) + "\n";
}

template <typename Real>
std::string text_of(const DigitalFilterDesign& design, const CHeaderOptions& options, bool has_vectors) {
  // Checks the design.
  [[maybe_unused]] const DigitalFilter<Real> checked(design);
  constexpr std::size_t most_dead = 100'000;
  if (design.dead_samples > most_dead) {
    throw std::invalid_argument("c_header: dead time of " + std::to_string(design.dead_samples) +
                                " samples; allowed is up to " + std::to_string(most_dead));
  }
  const detail::CText c(options);
  const bool has_taps = design.taps != std::vector<double>{1};
  const detail::CSections sections =
      detail::c_sections("section", has_taps ? design.taps : std::vector<double>{}, design.sections);
  const std::size_t pairs = design.pair_rates.size();
  const bool loops = pairs > 0 || design.differences > 0 || design.integrators > 0;
  const bool has_arrays = loops || sections.has_state() || design.dead_samples > 0;
  detail::CWords words{{"PAIRS", std::to_string(pairs)},
                       {"DIFFERENCES", std::to_string(design.differences)},
                       {"INTEGRATORS", std::to_string(design.integrators)},
                       {"DEAD_SAMPLES", std::to_string(design.dead_samples)},
                       {"PRESENT_SHARE", c.literal(design.rule == IntegratorRule::held ? 0 : design.sample_time / 2)},
                       {"TIME", c.literal(design.sample_time)},
                       {"INVERSE_TIME", c.literal(1 / design.sample_time)}};
  detail::CConditions conditions{{"HAS_PAIRS", pairs > 0},
                                 {"HAS_DIFFERENCES", design.differences > 0},
                                 {"HAS_INTEGRATORS", design.integrators > 0},
                                 {"HAS_DEAD_TIME", design.dead_samples > 0},
                                 {"HAS_LOOPS", loops},
                                 {"HAS_ARRAYS", has_arrays},
                                 {"HAS_NOTHING", !has_arrays}};
  describe(sections, words, conditions);
  return c.closed(c.opening(options.comment) + c.filled(detail::runtime::filter_state, words, conditions) +
                  c.section_functions(sections, has_vectors) + pair_arrays(design, c) +
                  c.filled(detail::runtime::filter, words, conditions));
}

std::string text_of(const DigitalFilterDesign& design, const CHeaderOptions& options, bool has_vectors) {
  return options.precision == Precision::float_type ? text_of<float>(design, options, has_vectors)
                                                    : text_of<double>(design, options, has_vectors);
}

}  // namespace

std::string c_header(const DigitalFilterDesign& design, const CHeaderOptions& options) {
  return text_of(design, options, false);
}

std::string detail::vector_c_header(const DigitalFilterDesign& design, const CHeaderOptions& options) {
  return text_of(design, options, true);
}

}  // namespace frac
