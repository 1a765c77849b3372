// SPDX-License-Identifier: BSD-3-Clause
#include <stdexcept>
#include <string>

#include "base/dead_time.hpp"
#include "base/number_text.hpp"
#include "frac/digital/digital_filter.hpp"
#include "special/phi_functions.hpp"

namespace frac {
namespace {

[[noreturn]] void refuse(const std::string& why) {
  throw std::invalid_argument("filter_design: " + why);
}

std::size_t whole_dead_time(double delay, double sample_time) {
  const auto [samples, whole, rest] = detail::sampled_dead_time(delay, sample_time);
  if (rest > 0 || !(whole <= 1e9)) {
    refuse("dead time of " + detail::number_text(samples) + " samples; allowed is a whole number of samples up to 1e9");
  }
  return static_cast<std::size_t>(whole);
}

}  // namespace

DigitalFilterDesign filter_design(const RationalModel& system, double sample_time) {
  if (!(sample_time > 0 && std::isfinite(sample_time)))
    refuse("sample_time = " + detail::number_text(sample_time) + " s; allowed is above 0, finite");
  DigitalFilterDesign design;
  design.sample_time = sample_time;
  design.dead_samples = whole_dead_time(system.delay, sample_time);
  design.rule = IntegratorRule::held;
  design.sections.direct = system.direct;
  if (!system.series.empty()) refuse("stages in series; allowed is one sum of modes");
  for (const Mode& mode : system.modes) {
    const std::string place = detail::number_text(mode.pole.real()) +
                              (mode.pole.imag() == 0 ? "" : " +- " + detail::number_text(mode.pole.imag()) + " i") +
                              " rad/s";
    if (!(mode.pole.real() < 0)) refuse("pole at " + place + "; allowed are poles left of the imaginary axis");
    if (mode.residues.size() != 1) refuse("multiple pole at " + place + "; allowed are simple poles");
    // residue/(s - pole) answers a held input by v += x - (1 - e^{pole T}) v and residue (e^{pole T} - 1)/pole v.
    const std::complex<double> rate = -detail::expm1(mode.pole * sample_time);
    const std::complex<double> weight = -mode.residues[0] * rate / mode.pole;
    if (mode.pole.imag() == 0) {
      design.sections.rates.push_back(rate.real());
      design.sections.weights.push_back(weight.real());
    } else {
      design.pair_rates.push_back(rate);
      design.pair_weights.push_back(2.0 * weight);
    }
  }
  return design;
}

}  // namespace frac
