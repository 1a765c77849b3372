// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "backlash/loss_factor.hpp"
#include "backlash/minus_inverse.hpp"
#include "backlash/static_backlash.hpp"
#include "io/number.hpp"
#include "report/grid.hpp"
#include "report/html.hpp"
#include "report/prose.hpp"
#include "report/sections.hpp"
#include "report/sweep_curves.hpp"

namespace report {

namespace {

using backlash::DescribingFunctionPoint;
using backlash::DescribingFunctionSweep;

struct LossFactor {
  double ratio, value, uncertainty;
};

// None where x1 stands still, and without clearance, which has no place on a logarithmic axis.
std::optional<LossFactor> loss_factor_of(const DescribingFunctionSweep& sweep, const DescribingFunctionPoint& point) {
  const auto inverse = backlash::minus_inverse(point);
  const double ratio = backlash::frequency_ratio(sweep.system, sweep.force_amplitude, point.omega);
  if (!inverse || !(ratio > 0)) return std::nullopt;
  const double inertia = (sweep.system.mass1() + sweep.system.mass2()) * point.omega * point.omega;
  return LossFactor{ratio, backlash::loss_factor(sweep.system, inverse->value, point.omega),
                    inverse->uncertainty / inertia};
}

void add_curves(Panel& panel, const DescribingFunctionSweep& sweep, const std::string& label,
                const std::string& colour) {
  auto curves = sweep_curves(sweep, label, colour, [&](const auto& point) -> std::optional<PlotPoint> {
    const auto loss = loss_factor_of(sweep, point);
    // A mean that may be zero has no place on a logarithmic axis.
    if (!loss || !(loss->value > loss->uncertainty)) return std::nullopt;
    return PlotPoint{loss->ratio, loss->value, std::max(loss->value - loss->uncertainty, 0.01 * loss->value),
                     loss->value + loss->uncertainty};
  });
  panel.curves.insert(panel.curves.end(), std::make_move_iterator(curves.begin()),
                      std::make_move_iterator(curves.end()));
}

// How far the points of two symmetric impacts are from the law, and restitution as the first of them tells it.
struct Check {
  double spread = 0;
  double points = 0;
};

void check_law(const DescribingFunctionSweep& sweep, Check& check, Table& table) {
  const double restitution = sweep.system.restitution();
  bool is_first = true;
  for (const auto& point : sweep.points) {
    if (point.regime != backlash::Regime::symmetric || restitution == 1) continue;
    const auto loss = loss_factor_of(sweep, point);
    if (!loss) continue;
    ++check.points;
    check.spread = std::max(check.spread, std::abs(loss->value / backlash::symmetric_loss_factor(restitution) - 1));
    const auto read = backlash::restitution_from_loss_factor(loss->value);
    if (std::exchange(is_first, false) && read)
      table.rows.push_back({sweep.force_amplitude, sweep.system.clearance(), point.omega, loss->value, restitution,
                            *read, *read - restitution});
  }
}

}  // namespace

Section loss_factor_section(const Work& work, const Curves& curves) {
  const Scene& scene = work.scene;
  Section section = open_section("loss-factor");
  Panel panel{"Loss factor", {"x = ω/√(F/(M_2Δ))", true}, {"y = Im(−1/N)/((M_1+M_2)ω^2)", true}};
  panel.key = true;
  Table points{"restitution-from-one-point",
               prose("loss-factor", "points"),
               {{"force_n", "F / N"},
                {"clearance_m", "Δ / m"},
                {"omega_rad_s", "ω / (rad/s)"},
                {"loss_factor", "y", 6},
                {"restitution", "ε"},
                {"restitution_read", "ε read", 6},
                {"error", "error", 2}}};
  Check check;
  // Curves over clearance and force have the restitution of the scene, and its colour.
  const std::string common = "#222222";
  std::size_t shade = 0;
  for (const DescribingFunctionSweep& sweep : curves.restitutions.sweeps) {
    const double restitution = sweep.system.restitution();
    const std::size_t own = shade++;
    check_law(sweep, check, points);
    if (restitution == scene.restitution || restitution == 1) continue;
    add_curves(panel, sweep, "ε = " + io::format_number(restitution),
               family_colour(own, curves.restitutions.sweeps.size()));
  }
  std::string label = "ε = " + io::format_number(scene.restitution) + ", all F and Δ";
  for (const Family* family : {&curves.clearances, &curves.forces, &curves.bode}) {
    for (const DescribingFunctionSweep& sweep : family->sweeps) {
      if (sweep.system.clearance() == 0) continue;
      if (family != &curves.bode) check_law(sweep, check, points);
      add_curves(panel, sweep, std::exchange(label, ""), common);
    }
  }
  double lowest = 1, highest = 1;
  for (const Curve& curve : panel.curves) {
    for (const auto& segment : curve.segments) {
      for (const PlotPoint& point : segment) {
        lowest = std::min(lowest, point.x);
        highest = std::max(highest, point.x);
      }
    }
  }
  label = "(π/4)(1−ε)/(1+ε), exact";
  for (const double restitution : scene.restitutions) {
    if (restitution == 1) continue;
    const double level = backlash::symmetric_loss_factor(restitution);
    panel.curves.push_back(
        make_curve(std::exchange(label, ""), "#888888", Mark::dotted, {1.2, highest}, {level, level}));
  }
  // Static backlash with the mass ratio of the scene: a function of x as well.
  const backlash::TwoMassSystem plain(scene.mass1, scene.mass2, 1 / scene.mass2, 1);
  const auto grid = logarithmic_grid(lowest, 1.4, 200);
  const auto values = backlash::static_describing_function(plain.mass1(), plain.mass2(), plain.clearance(), 1, grid);
  std::vector<double> x, y;
  for (std::size_t i = 0; i < grid.size(); ++i) {
    if (const auto inverse = backlash::minus_inverse(values[i], 0)) {
      x.push_back(grid[i]);
      y.push_back(backlash::loss_factor(plain, inverse->value, grid[i]));
    }
  }
  panel.curves.push_back(make_curve("static backlash", category_colour(1), Mark::dashed, x, y));
  // The asymptote through the lowest point of the scene.
  for (const auto& sweep : curves.bode.sweeps) {
    const auto low = loss_factor_of(sweep, sweep.points.front());
    if (!low || !(low->value > 0)) continue;
    const double end = 0.7;
    panel.curves.push_back(make_curve("slope 8/3", category_colour(2), Mark::dotted, {low->ratio, end},
                                      {low->value, low->value * std::pow(end / low->ratio, 8.0 / 3)}));
    panel.y.from = low->value / 2;
  }
  panel.y.to = 4;
  section.fact("loss_factor_points", check.points);
  if (check.points > 0) section.fact("loss_factor_spread", check.spread);
  section.add(Figure{"loss-factor",
                     prose("loss-factor", "figure", {{"restitution", html_number(scene.restitution)}}),
                     {std::move(panel)},
                     1,
                     460});
  if (!points.rows.empty()) section.add(std::move(points));
  return section;
}

}  // namespace report
