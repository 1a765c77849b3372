// SPDX-License-Identifier: BSD-3-Clause
#include "report/bands.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "backlash/jump_frequency.hpp"
#include "report/grid.hpp"

namespace report {

namespace {

using backlash::DescribingFunctionPoint;
using backlash::Regime;

constexpr std::size_t fewest_points = 10;
constexpr std::size_t points_per_band = 160;

bool is_symmetric(const DescribingFunctionPoint& point) {
  return point.regime == Regime::symmetric;
}

bool is_chatter(const DescribingFunctionPoint& point) {
  return point.regime == Regime::chatter;
}

// The points from the low end of the curve up to the first one that does not belong or has no imaginary part to fit.
template <typename Belongs>
std::vector<DescribingFunctionPoint> leading_run(const std::vector<DescribingFunctionPoint>& points, Belongs belongs) {
  std::vector<DescribingFunctionPoint> run;
  for (const auto& point : points) {
    if (!belongs(point) || point.value.imag() == 0) break;
    run.push_back(point);
  }
  return run;
}

}  // namespace

Bands smooth_bands(const Work& work, const Curves& curves) {
  const Scene& scene = work.scene;
  const auto& coarse = curves.bode.sweeps.front().points;
  backlash::SweepOptions options;
  options.threads = work.threads;
  options.protocol = backlash::Protocol::two_impact;
  Bands bands;

  const auto sticking = leading_run(coarse, is_chatter);
  if (sticking.size() >= 2) {
    const auto grid = logarithmic_grid(sticking.front().omega, sticking.back().omega, points_per_band);
    bands.chatter =
        leading_run(backlash::describing_function_sweep(work.system(), scene.force, grid, options).points, is_chatter);
  }

  const auto system = work.system();
  const auto lower = backlash::jump_frequency(system, scene.force, backlash::JumpCriterion::symmetry_loss);
  const auto upper = backlash::jump_frequency(system, scene.force, backlash::JumpCriterion::saddle_node);
  if (lower) {
    // Stays one part in a thousand inside the ends, where the orbit vanishes.
    const double highest = std::max(coarse.back().omega, scene.omega_family.back());
    const double from = std::max(*lower * 1.001, coarse.front().omega);
    const double to = std::min(upper ? *upper * 0.999 : highest, highest);
    if (from < to) {
      const auto grid = logarithmic_grid(from, to, points_per_band);
      bands.two_impact =
          leading_run(backlash::describing_function_sweep(system, scene.force, grid, options).points, is_symmetric);
    }
  }
  if (bands.chatter.size() < fewest_points) bands.chatter.clear();
  if (bands.two_impact.size() < fewest_points) bands.two_impact.clear();
  return bands;
}

frac::FrequencyResponseData relative_imaginary_data(const std::vector<DescribingFunctionPoint>& points) {
  std::vector<double> omega, sigma;
  std::vector<std::complex<double>> value;
  for (const auto& point : points) {
    omega.push_back(point.omega);
    value.push_back(point.value);
    sigma.push_back(std::abs(point.value.imag()));
  }
  return {std::move(omega), std::move(value), std::move(sigma)};
}

}  // namespace report
