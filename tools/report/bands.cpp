// SPDX-License-Identifier: BSD-3-Clause
#include "report/bands.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
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

backlash::SweepOptions two_impact_sweep(const Work& work) {
  backlash::SweepOptions options;
  options.threads = work.threads;
  options.protocol = backlash::Protocol::two_impact;
  return options;
}

std::vector<backlash::DescribingFunctionSweep> whole_curve(const Work& work) {
  const Scene& scene = work.scene;
  const auto system = work.system();
  const auto lower = backlash::jump_frequency(system, scene.force, backlash::JumpCriterion::two_impact_loss);
  const auto upper = backlash::jump_frequency(system, scene.force, backlash::JumpCriterion::saddle_node);
  std::vector<backlash::DescribingFunctionSweep> sweeps;
  const auto add = [&](double from, double to, std::size_t count) {
    sweeps.push_back(backlash::describing_function_sweep(system, scene.force, logarithmic_grid(from, to, count),
                                                         two_impact_sweep(work)));
  };
  // Figures may begin far above the jump: with little loss two impacts per period reach high up.
  const double end = lower ? *lower : scene.omega_bode.back();
  add(std::min(scene.omega_bode.front() / 6, end / 2), end, 300);
  if (lower) add(*lower * 1.0001, upper ? *upper * 0.9999 : 4 * *lower, 200);
  return sweeps;
}

}  // namespace

Bands smooth_bands(const Work& work, const Curves& curves) {
  const Scene& scene = work.scene;
  const auto& coarse = curves.bode.sweeps.front().points;
  const backlash::SweepOptions options = two_impact_sweep(work);
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
  for (auto* band : {&bands.chatter, &bands.two_impact}) {
    if (band->size() < fewest_points) band->clear();
  }
  if (!bands.chatter.empty() && !bands.two_impact.empty()) {
    std::copy_if(coarse.begin(), coarse.end(), std::back_inserter(bands.between), [&bands](const auto& point) {
      return point.omega > bands.chatter.back().omega && point.omega < bands.two_impact.front().omega;
    });
    if (bands.between.size() < fewest_points) bands.between.clear();
  }
  if (!bands.chatter.empty() || !bands.two_impact.empty()) bands.whole = whole_curve(work);
  return bands;
}

std::vector<double> omega_of(const std::vector<DescribingFunctionPoint>& points) {
  std::vector<double> omega;
  for (const auto& point : points) omega.push_back(point.omega);
  return omega;
}

std::vector<double> imaginary_of(const std::vector<DescribingFunctionPoint>& points) {
  std::vector<double> imaginary;
  for (const auto& point : points) imaginary.push_back(point.value.imag());
  return imaginary;
}

frac::FrequencyResponseData relative_imaginary_data(const std::vector<DescribingFunctionPoint>& points) {
  std::vector<std::complex<double>> value;
  for (const auto& point : points) value.push_back(point.value);
  std::vector<double> sigma = imaginary_of(points);
  for (double& imaginary : sigma) imaginary = std::abs(imaginary);
  return {omega_of(points), std::move(value), std::move(sigma)};
}

}  // namespace report
