// SPDX-License-Identifier: BSD-3-Clause
#include "output/fitted_stability.hpp"

#include <stdexcept>

#include "frac/identification/robust_tune.hpp"
#include "output/aligned_table.hpp"

namespace fracfit {

std::optional<frac::StabilityAnalysis> fitted_stability(const frac::FitResult& fit) {
  try {
    return frac::analyse_stability(frac::fitted_plant(fit));
  } catch (const std::invalid_argument&) {
    return std::nullopt;
  }
}

std::string remark_on_stability(const std::optional<frac::StabilityAnalysis>& analysis) {
  if (!analysis || analysis->stability != frac::Stability::unstable) return "";
  std::string poles;
  for (const frac::Pole& pole : analysis->poles) {
    if (!(pole.value.real() > 0) || pole.cancelled) continue;
    poles += (poles.empty() ? "" : ", ") + short_number(pole.value.real(), 4);
    if (pole.value.imag() != 0) poles += " +- " + short_number(pole.value.imag(), 4) + "i";
  }
  return poles.empty() ? "" : "The model is unstable: poles at s = " + poles + " rad/s.";
}

}  // namespace fracfit
