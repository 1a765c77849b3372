// SPDX-License-Identifier: BSD-3-Clause
#include "report/fixed_step_jump.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "frac/identification/power_law.hpp"
#include "frac/parallel_for.hpp"
#include "report/fixed_step_reference.hpp"
#include "report/prose.hpp"

namespace report {

namespace {

constexpr double step_seconds = 1e-4;
// The scan over c starts below sqrt 2: up to there the exact motion meets the wall in its first period.
constexpr double scan_from = 1.38;
constexpr double scan_to = 4;
constexpr double coarse_ratio = 1.016;
constexpr double fine_ratio = 1.001;

bool meets_second_wall(const FixedStepScene& scene, double omega, int periods) {
  FixedStepState state = fixed_step_start(scene, omega, 0);
  const double period = 2 * std::numbers::pi / omega;
  const auto steps = static_cast<std::size_t>(std::max(8L, std::lround(period / step_seconds)));
  const double step = period / static_cast<double>(steps);
  for (int p = 0; p < periods; ++p) {
    state.time = 0;
    for (std::size_t k = 0; k < steps; ++k) {
      fixed_step(scene, omega, step, state);
      // The correction of an impact puts the gap at the clearance, up to rounding.
      if (state.position2 - state.position1 > scene.clearance * (1 - 1e-9)) return true;
    }
  }
  return false;
}

double jump_constant(const FixedStepScene& scene, int periods) {
  const double scale = std::sqrt(scene.force_amplitude / (scene.mass2 * scene.clearance));
  double c = scan_from;
  while (c < scan_to && meets_second_wall(scene, c * coarse_ratio * scale, periods)) c *= coarse_ratio;
  while (c < scan_to && meets_second_wall(scene, c * scale, periods)) c *= fine_ratio;
  return c;
}

}  // namespace

Table fixed_step_jumps(const std::vector<double>& forces, const std::vector<double>& clearances, int threads) {
  Table table{"fixed-step-jumps",
              prose("jumps", "fixed-step"),
              {{"source", "source"},
               {"c_lowest", "c, lowest"},
               {"c_highest", "c, highest"},
               {"a_coefficient", "a: coefficient"},
               {"a_exponent", "a: exponent of Δ"},
               {"b_at_smallest_clearance", "b at the smallest Δ"},
               {"b_at_largest_clearance", "b at the largest Δ"}},
              {}};
  const auto [smallest, largest] = std::minmax_element(clearances.begin(), clearances.end());
  for (const int periods : {10, 20, 50}) {
    std::vector<double> constants(forces.size() * clearances.size());
    frac::parallel_for(constants.size(), threads, [&](std::size_t i) {
      const FixedStepScene scene{1, 1, clearances[i / forces.size()], 0.6, forces[i % forces.size()]};
      constants[i] = jump_constant(scene, periods);
    });
    std::vector<double> a, b;
    for (std::size_t k = 0; k < clearances.size(); ++k) {
      std::vector<double> omega;
      for (std::size_t i = 0; i < forces.size(); ++i) {
        omega.push_back(constants[k * forces.size() + i] * std::sqrt(forces[i] / clearances[k]));
      }
      const frac::PowerLaw law = frac::fit_power_law(forces, omega);
      a.push_back(law.coefficient);
      b.push_back(law.exponent);
    }
    const frac::PowerLaw a_law = frac::fit_power_law(clearances, a);
    const auto [lowest, highest] = std::minmax_element(constants.begin(), constants.end());
    table.rows.push_back({"fixed step, " + std::to_string(periods) + " periods", *lowest, *highest, a_law.coefficient,
                          a_law.exponent, b[static_cast<std::size_t>(smallest - clearances.begin())],
                          b[static_cast<std::size_t>(largest - clearances.begin())]});
  }
  return table;
}

}  // namespace report
