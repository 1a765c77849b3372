// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "backlash/jump_frequency.hpp"
#include "backlash/static_backlash.hpp"
#include "frac/identification/power_law.hpp"
#include "io/number.hpp"
#include "report/bands.hpp"
#include "report/grid.hpp"
#include "report/html.hpp"
#include "report/prose.hpp"
#include "report/sections.hpp"
#include "report/sweep_curves.hpp"

namespace report {

namespace {

using backlash::DescribingFunctionPoint;

struct Slopes {
  std::vector<double> omega, slope;  // NaN between branches
};

// Central difference over ln omega within a branch.
Slopes local_slopes(const std::vector<DescribingFunctionPoint>& points) {
  Slopes slopes;
  for (std::size_t i = 1; i + 1 < points.size(); ++i) {
    slopes.omega.push_back(points[i].omega);
    const double before = points[i - 1].value.imag();
    const double after = points[i + 1].value.imag();
    const bool smooth = on_one_branch(points[i - 1], points[i]) && on_one_branch(points[i], points[i + 1]);
    slopes.slope.push_back(smooth && before > 0 && after > 0
                               ? std::log(after / before) / std::log(points[i + 1].omega / points[i - 1].omega)
                               : std::nan(""));
  }
  return slopes;
}

Slopes static_slopes(const Scene& scene, const std::vector<double>& omega) {
  const auto values =
      backlash::static_describing_function(scene.mass1, scene.mass2, scene.clearance, scene.force, omega);
  Slopes slopes;
  for (std::size_t i = 1; i + 1 < omega.size(); ++i) {
    const double before = values[i - 1].imag();
    const double after = values[i + 1].imag();
    slopes.omega.push_back(omega[i]);
    slopes.slope.push_back(before > 0 && after > 0 ? std::log(after / before) / std::log(omega[i + 1] / omega[i - 1])
                                                   : std::nan(""));
  }
  return slopes;
}

frac::PowerLaw band_law(const std::vector<DescribingFunctionPoint>& points) {
  std::vector<double> omega, imaginary;
  for (const auto& point : points) {
    omega.push_back(point.omega);
    imaginary.push_back(point.value.imag());
  }
  return frac::fit_power_law(omega, imaginary);
}

struct Band {
  std::string name;
  std::string file_name;
  const std::vector<DescribingFunctionPoint>* points;
};

}  // namespace

Section slope_section(const Work& work, const Bands& bands) {
  const Scene& scene = work.scene;
  Section section = open_section("slope");
  const auto system = work.system();
  const auto lower = backlash::jump_frequency(system, scene.force, backlash::JumpCriterion::two_impact_loss);
  const auto upper = backlash::jump_frequency(system, scene.force, backlash::JumpCriterion::saddle_node);
  if (bands.two_impact.empty() && bands.chatter.empty()) {
    section.blocks.emplace_back(paragraph("slope", "no-band"));
    return section;
  }

  backlash::SweepOptions options;
  options.threads = work.threads;
  options.protocol = backlash::Protocol::two_impact;
  std::vector<backlash::DescribingFunctionSweep> sweeps;
  // Goes down to a sixth of the lowest frequency of the figures, where the asymptote shows, and up to the end of the
  // impacting motion.
  const double lowest = scene.omega_bode.front() / 6;
  const double middle = lower ? *lower : scene.omega_bode.back();
  sweeps.push_back(
      backlash::describing_function_sweep(system, scene.force, logarithmic_grid(lowest, middle, 300), options));
  if (lower) {
    const double highest = upper ? *upper * 0.9999 : 4 * *lower;
    sweeps.push_back(backlash::describing_function_sweep(system, scene.force,
                                                         logarithmic_grid(*lower * 1.0001, highest, 200), options));
  }

  Panel panel;
  panel.title = "Local slope of Im N";
  panel.x = {"ω in rad/s", true, {}, {}};
  panel.y = {"d ln|Im N| / d ln ω", false, -1.0, 2.2};
  panel.key = true;
  Table table{"slopes", prose("slope", "slopes"), {{"omega_rad_s", "ω"}, {"slope", "slope"}}, {}, false};
  bool first = true;
  std::vector<double> grid;
  for (const auto& sweep : sweeps) {
    const Slopes slopes = local_slopes(sweep.points);
    panel.curves.push_back(make_curve(first ? "ε = " + io::format_number(scene.restitution) + ", all motions" : "",
                                      category_colour(0), Mark::line, slopes.omega, slopes.slope));
    first = false;
    for (std::size_t i = 0; i < slopes.omega.size(); ++i) {
      if (std::isfinite(slopes.slope[i])) table.rows.push_back({slopes.omega[i], slopes.slope[i]});
    }
    for (const auto& point : sweep.points) grid.push_back(point.omega);
  }
  const std::vector<double> static_grid = grid;
  // Repeats it for higher restitutions: the closer to 1, the wider the band and the closer its slope comes to 2.
  std::size_t shade = 0;
  for (const double restitution : {0.8, 0.95}) {
    if (restitution == scene.restitution) continue;
    const backlash::TwoMassSystem harder(scene.mass1, scene.mass2, scene.clearance, restitution);
    const auto from = backlash::jump_frequency(harder, scene.force, backlash::JumpCriterion::symmetry_loss);
    const auto to = backlash::jump_frequency(harder, scene.force, backlash::JumpCriterion::saddle_node);
    if (!from || !to) continue;
    const auto sweep = backlash::describing_function_sweep(
        harder, scene.force, logarithmic_grid(*from * 1.0001, *to * 0.9999, 200), options);
    const Slopes slopes = local_slopes(sweep.points);
    panel.curves.push_back(make_curve("ε = " + io::format_number(restitution) + ", symmetric orbit",
                                      shade++ == 0 ? "#7fb5d8" : "#b5d3e7", Mark::line, slopes.omega, slopes.slope));
    grid.push_back(*to);
  }
  const Slopes model = static_slopes(scene, static_grid);
  panel.curves.push_back(make_curve("static backlash", category_colour(1), Mark::dashed, model.omega, model.slope));
  panel.curves.push_back(
      make_curve("2/3, exact limit ω → 0", "#222222", Mark::dotted, {grid.front(), grid.back()}, {2.0 / 3, 2.0 / 3}));
  panel.curves.push_back(make_curve("2, limit ε → 1", "#888888", Mark::dotted, {grid.front(), grid.back()}, {2, 2}));

  Table orders{"band-orders",
               prose("slope", "orders"),
               {{"band", "band"},
                {"omega_from_rad_s", "from / (rad/s)"},
                {"omega_to_rad_s", "to / (rad/s)"},
                {"order", "fitted order", 5},
                {"order_ci95_lower", "95 % from", 5},
                {"order_ci95_upper", "to", 5},
                {"slope_at_start", "local slope at the lower end", 4},
                {"slope_at_end", "at the upper end", 4},
                {"rms_log_residual", "rms residual of ln Im N", 3}},
               {}};
  const Band all[] = {{"chatter", "chatter", &bands.chatter}, {"two impacts", "two-impact", &bands.two_impact}};
  std::size_t colour = 2;
  std::string spans;
  for (const Band& band : all) {
    if (band.points->empty()) continue;
    const frac::PowerLaw law = band_law(*band.points);
    const Slopes slopes = local_slopes(*band.points);
    orders.rows.push_back({band.name, band.points->front().omega, band.points->back().omega, law.exponent,
                           law.exponent_ci95_lower, law.exponent_ci95_upper, slopes.slope.front(), slopes.slope.back(),
                           law.rms_log_residual});
    Curve fitted = make_curve("fitted order, " + band.name, category_colour(colour++), Mark::line,
                              {band.points->front().omega, band.points->back().omega}, {law.exponent, law.exponent});
    panel.curves.push_back(std::move(fitted));
    spans += (spans.empty() ? "" : "; ") + prose("slope", "span",
                                                 {{"band", band.name},
                                                  {"order", html_number(law.exponent, 3)},
                                                  {"first", html_number(slopes.slope.front(), 3)},
                                                  {"last", html_number(slopes.slope.back(), 3)}});
    section.facts.emplace_back("fitted_order_" + band.file_name, law.exponent);
  }
  const Slopes low = local_slopes(sweeps.front().points);
  section.findings.push_back(prose(
      "slope", "finding",
      {{"slope", html_number(low.slope.front())}, {"omega", html_number(low.omega.front(), 3)}, {"spans", spans}}));
  section.facts.emplace_back("lowest_local_slope", low.slope.front());
  Figure figure;
  figure.name = "local-slope";
  figure.caption = prose("slope", "figure",
                         {{"force", html_number(scene.force)},
                          {"clearance", html_number(scene.clearance)},
                          {"restitution", html_number(scene.restitution)}});
  figure.panels = {std::move(panel)};
  figure.panel_height = 380;
  section.blocks.emplace_back(std::move(figure));
  section.blocks.emplace_back(std::move(orders));
  section.blocks.emplace_back(std::move(table));
  section.blocks.emplace_back(Html{paragraph("slope", "consequences")});
  return section;
}

}  // namespace report
