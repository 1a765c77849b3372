// SPDX-License-Identifier: BSD-3-Clause
#include <cstddef>
#include <stdexcept>
#include <string>
#include <utility>

#include "c_text.hpp"
#include "digital/section_kernel.hpp"
#include "digital/tap_line.hpp"

namespace frac {
namespace {

detail::CSections sections_of(const DigitalFilterDesign& filter) {
  const ParallelSections& design = filter.sections;
  detail::CSections sections{"section", {}, design.output, design.direct, design.rates, design.weights};
  if (filter.taps != std::vector<double>{1}) {
    sections.taps = filter.taps;
    sections.taps.resize(detail::even_count(sections.taps.size()), 0);
  }
  const std::size_t size = detail::whole_groups(design.rates.size());
  sections.rates.resize(size, 1);
  sections.weights.resize(size, 0);
  return sections;
}

template <typename Real>
std::string text_of(const DigitalFilterDesign& design, const CHeaderOptions& options) {
  // Checks the design.
  [[maybe_unused]] const DigitalFilter<Real> checked(design);
  constexpr std::size_t most_dead = 100'000;
  if (design.dead_samples > most_dead) {
    throw std::invalid_argument("c_header: dead time of " + std::to_string(design.dead_samples) +
                                " samples; allowed is up to " + std::to_string(most_dead));
  }
  const detail::CText c(options);
  const detail::CSections sections = sections_of(design);
  const std::string pairs = std::to_string(design.pair_rates.size());
  const std::string differences = std::to_string(design.differences);
  const std::string integrators = std::to_string(design.integrators);
  const std::string dead = std::to_string(design.dead_samples);
  const bool has_pairs = !design.pair_rates.empty();
  const bool has_dead = design.dead_samples > 0;

  std::string members = c.section_members(sections);
  std::string clear = c.section_rest(sections, c.literal(0));
  const auto member = [&](const std::string& name, const std::string& count) {
    members += "  REAL " + name + "[" + count + "];\n";
    clear += "  for (i = 0; i < " + count + "; ++i) s->" + name + "[i] = @zero@;\n";
  };
  if (has_pairs) {
    member("pair_re", pairs);
    member("pair_im", pairs);
  }
  if (design.differences > 0) member("previous", differences);
  if (design.integrators > 0) {
    member("integral", integrators);
    member("integral_lost", integrators);
  }
  if (has_dead) {
    member("waiting", dead);
    members += "  int oldest;\n";
    clear += "  s->oldest = 0;\n";
  }
  if (members.empty()) {
    members = "  int nothing;\n";
    clear = "  s->nothing = 0;\n";
  }

  std::string text = c.opening(options.comment);
  text += c.filled("typedef struct {\n" + members + "} NAME_state;\n\n");
  text += c.section_functions(sections);
  if (has_pairs) {
    std::vector<double> rate_re, rate_im, weight_re, weight_im;
    for (std::size_t i = 0; i < design.pair_rates.size(); ++i) {
      rate_re.push_back(design.pair_rates[i].real());
      rate_im.push_back(design.pair_rates[i].imag());
      weight_re.push_back(design.pair_weights[i].real());
      weight_im.push_back(design.pair_weights[i].imag());
    }
    text += c.array("pair_rate_re", rate_re) + c.array("pair_rate_im", rate_im) + c.array("pair_weight_re", weight_re) +
            c.array("pair_weight_im", weight_im) + "\n";
  }
  const bool clears_arrays = clear.find("for (") != std::string::npos;
  std::string body = std::string("/* At rest. */\nstatic inline void NAME_reset(NAME_state *s)\n{\n") +
                     (clears_arrays ? "  int i;\n" : "") + clear + R"(}

/* Call once before the first step. */
static inline void NAME_init(NAME_state *s)
{
  NAME_reset(s);
}

static inline REAL NAME_step(NAME_state *s, REAL sample)
{
  REAL x = sample, y;
)";
  if (!sections.taps.empty()) body += "  REAL input;\n";
  const bool loops = has_pairs || design.differences > 0 || design.integrators > 0;
  if (loops) body += "  int i;\n";
  if (has_dead) {
    body += R"(  x = s->waiting[s->oldest];
  s->waiting[s->oldest] = sample;
  s->oldest = s->oldest + 1 == @dead@ ? 0 : s->oldest + 1;
)";
  }
  if (design.differences > 0) {
    body += R"(  for (i = 0; i < @differences@; ++i) {
    const REAL change = (x - s->previous[i]) * @inverse_time@;
    s->previous[i] = x;
    x = change;
  }
)";
  }
  if (!sections.taps.empty()) body += "  input = x;\n  x = NAME_section_tapped(s, input);\n";
  body += "  y = NAME_section_output(s, x);\n";
  if (sections.has_state())
    body += std::string("  NAME_section_advance(s, ") + (sections.taps.empty() ? "x" : "input") + ", x);\n";
  if (has_pairs) {
    body += R"(  for (i = 0; i < @pairs@; ++i) {
    const REAL re = s->pair_re[i] + (x - (NAME_pair_rate_re[i] * s->pair_re[i] - NAME_pair_rate_im[i] * s->pair_im[i]));
    const REAL im = s->pair_im[i] - (NAME_pair_rate_re[i] * s->pair_im[i] + NAME_pair_rate_im[i] * s->pair_re[i]);
    y += NAME_pair_weight_re[i] * s->pair_re[i] - NAME_pair_weight_im[i] * s->pair_im[i];
    s->pair_re[i] = re > @tiny@ || re < -@tiny@ ? re : @zero@;
    s->pair_im[i] = im > @tiny@ || im < -@tiny@ ? im : @zero@;
  }
)";
  }
  if (design.integrators > 0) {
    body += R"(  for (i = 0; i < @integrators@; ++i) {
    const REAL output = s->integral[i] + @now@ * y;
    const REAL increment = @time@ * y + s->integral_lost[i];
    const REAL next = s->integral[i] + increment;
    s->integral_lost[i] = increment - (next - s->integral[i]);
    s->integral[i] = next;
    y = output;
  }
)";
  }
  body += "  return y;\n}\n";
  const double now = design.rule == IntegratorRule::held ? 0 : design.sample_time / 2;
  text += c.filled(body, {{"zero", c.literal(0)},
                          {"tiny", c.literal(static_cast<double>(detail::negligible_state<Real>))},
                          {"dead", dead},
                          {"differences", differences},
                          {"integrators", integrators},
                          {"pairs", pairs},
                          {"now", c.literal(now)},
                          {"time", c.literal(design.sample_time)},
                          {"inverse_time", c.literal(1 / design.sample_time)}});
  return c.closed(std::move(text));
}

}  // namespace

std::string c_header(const DigitalFilterDesign& design, const CHeaderOptions& options) {
  return options.precision == Precision::float_type ? text_of<float>(design, options)
                                                    : text_of<double>(design, options);
}

}  // namespace frac
