// SPDX-License-Identifier: BSD-3-Clause
#include "report/fixed_step_jump.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

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
  // The instants within a period are the same in each.
  std::vector<double> cosine;
  cosine.reserve(steps);
  for (int p = 0; p < periods; ++p) {
    state.time = 0;
    for (std::size_t k = 0; k < steps; ++k) {
      if (k == cosine.size()) cosine.push_back(std::cos(omega * state.time));
      fixed_step(scene, cosine[k], step, state);
      // The correction of an impact puts the gap at the clearance, up to rounding.
      if (state.position2 - state.position1 > scene.clearance * (1 - 1e-9)) return true;
    }
  }
  return false;
}

// Constants for rising numbers of periods.  What meets the wall within fewer does so within more, so that each scan
// goes on where the one before it ended.
std::vector<double> jump_constants(const FixedStepScene& scene, const std::vector<int>& periods) {
  const double scale = std::sqrt(scene.force_amplitude / (scene.mass2 * scene.clearance));
  std::vector<double> constants;
  double coarse = scan_from, c = scan_from;
  for (const int count : periods) {
    while (coarse < scan_to && meets_second_wall(scene, coarse * coarse_ratio * scale, count)) coarse *= coarse_ratio;
    c = std::max(c, coarse);
    while (c < scan_to && meets_second_wall(scene, c * scale, count)) c *= fine_ratio;
    constants.push_back(c);
  }
  return constants;
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
               {"b_at_largest_clearance", "b at the largest Δ"}}};
  const auto [smallest, largest] = std::minmax_element(clearances.begin(), clearances.end());
  const std::vector<int> periods = {10, 20, 50};
  std::vector<std::vector<double>> found(forces.size() * clearances.size());
  frac::parallel_for(found.size(), threads, [&](std::size_t i) {
    const FixedStepScene scene{1, 1, clearances[i / forces.size()], 0.6, forces[i % forces.size()]};
    found[i] = jump_constants(scene, periods);
  });
  for (std::size_t row = 0; row < periods.size(); ++row) {
    std::vector<double> constants, a, b;
    for (const std::vector<double>& each : found) constants.push_back(each[row]);
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
    table.rows.push_back({"fixed step, " + std::to_string(periods[row]) + " periods", *lowest, *highest,
                          a_law.coefficient, a_law.exponent, b[static_cast<std::size_t>(smallest - clearances.begin())],
                          b[static_cast<std::size_t>(largest - clearances.begin())]});
  }
  return table;
}

}  // namespace report
