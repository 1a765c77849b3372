// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
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

// Central differences over ln omega.  NaN where a neighbour is not positive or `joined(i)` is false.
template <typename Joined>
Slopes slopes_of(const std::vector<double>& omega, const std::vector<double>& imaginary, Joined joined) {
  Slopes slopes;
  for (std::size_t i = 1; i + 1 < omega.size(); ++i) {
    const double before = imaginary[i - 1];
    const double after = imaginary[i + 1];
    slopes.omega.push_back(omega[i]);
    slopes.slope.push_back(joined(i) && before > 0 && after > 0
                               ? std::log(after / before) / std::log(omega[i + 1] / omega[i - 1])
                               : std::nan(""));
  }
  return slopes;
}

Slopes local_slopes(const std::vector<DescribingFunctionPoint>& points) {
  return slopes_of(omega_of(points), imaginary_of(points), [&points](std::size_t i) {
    return on_one_branch(points[i - 1], points[i]) && on_one_branch(points[i], points[i + 1]);
  });
}

Slopes static_slopes(const Scene& scene, const std::vector<double>& omega) {
  std::vector<double> imaginary;
  for (const auto& value :
       backlash::static_describing_function(scene.mass1, scene.mass2, scene.clearance, scene.force, omega)) {
    imaginary.push_back(value.imag());
  }
  return slopes_of(omega, imaginary, [](std::size_t) { return true; });
}

struct Band {
  std::string name;
  std::string file_name;
  const std::vector<DescribingFunctionPoint>* points;
};

backlash::SweepOptions sweep_options(const Work& work) {
  backlash::SweepOptions options;
  options.threads = work.threads;
  options.protocol = backlash::Protocol::two_impact;
  return options;
}

/// From a sixth of the lowest frequency of the figures, where the asymptote shows, up to the end of the impacting
/// motion; a second sweep begins where two impacts per period do.
std::vector<backlash::DescribingFunctionSweep> sweeps_of_scene(const Work& work) {
  const Scene& scene = work.scene;
  const auto system = work.system();
  const auto lower = backlash::jump_frequency(system, scene.force, backlash::JumpCriterion::two_impact_loss);
  const auto upper = backlash::jump_frequency(system, scene.force, backlash::JumpCriterion::saddle_node);
  std::vector<backlash::DescribingFunctionSweep> sweeps;
  const auto add = [&](double from, double to, std::size_t count) {
    sweeps.push_back(backlash::describing_function_sweep(system, scene.force, logarithmic_grid(from, to, count),
                                                         sweep_options(work)));
  };
  add(scene.omega_bode.front() / 6, lower ? *lower : scene.omega_bode.back(), 300);
  if (lower) add(*lower * 1.0001, upper ? *upper * 0.9999 : 4 * *lower, 200);
  return sweeps;
}

void add_scene(const Scene& scene, const std::vector<backlash::DescribingFunctionSweep>& sweeps, Panel& panel,
               Table& table) {
  for (const auto& sweep : sweeps) {
    const Slopes slopes = local_slopes(sweep.points);
    const bool first = &sweep == &sweeps.front();
    panel.curves.push_back(make_curve(first ? "ε = " + io::format_number(scene.restitution) + ", all motions" : "",
                                      category_colour(0), Mark::line, slopes.omega, slopes.slope));
    for (std::size_t i = 0; i < slopes.omega.size(); ++i) {
      if (std::isfinite(slopes.slope[i])) table.rows.push_back({slopes.omega[i], slopes.slope[i]});
    }
  }
}

/// The closer the restitution to 1, the wider the band and the closer its slope comes to 2.
/// @return  the highest frequency drawn
double add_higher_restitutions(const Work& work, double highest, Panel& panel) {
  const Scene& scene = work.scene;
  std::size_t shade = 0;
  for (const double restitution : {0.8, 0.95}) {
    if (restitution == scene.restitution) continue;
    const backlash::TwoMassSystem harder(scene.mass1, scene.mass2, scene.clearance, restitution);
    const auto from = backlash::jump_frequency(harder, scene.force, backlash::JumpCriterion::symmetry_loss);
    const auto to = backlash::jump_frequency(harder, scene.force, backlash::JumpCriterion::saddle_node);
    if (!from || !to) continue;
    const auto sweep = backlash::describing_function_sweep(
        harder, scene.force, logarithmic_grid(*from * 1.0001, *to * 0.9999, 200), sweep_options(work));
    const Slopes slopes = local_slopes(sweep.points);
    panel.curves.push_back(make_curve("ε = " + io::format_number(restitution) + ", symmetric orbit",
                                      shade++ == 0 ? "#7fb5d8" : "#b5d3e7", Mark::line, slopes.omega, slopes.slope));
    highest = *to;
  }
  return highest;
}

Table table_of_orders() {
  return {"band-orders",
          prose("slope", "orders"),
          {{"band", "band"},
           {"omega_from_rad_s", "from / (rad/s)"},
           {"omega_to_rad_s", "to / (rad/s)"},
           {"order", "fitted order", 5},
           {"order_ci95_lower", "95 % from", 5},
           {"order_ci95_upper", "to", 5},
           {"slope_at_start", "local slope at the lower end", 4},
           {"slope_at_end", "at the upper end", 4},
           {"rms_log_residual", "rms residual of ln Im N", 3}}};
}

/// @return  the band's order and slopes in words
std::string add_band(const Band& band, std::size_t colour, Panel& panel, Table& orders, Section& section) {
  const std::vector<DescribingFunctionPoint>& points = *band.points;
  const frac::PowerLaw law = frac::fit_power_law(omega_of(points), imaginary_of(points));
  const Slopes slopes = local_slopes(points);
  orders.rows.push_back({band.name, points.front().omega, points.back().omega, law.exponent, law.exponent_ci95_lower,
                         law.exponent_ci95_upper, slopes.slope.front(), slopes.slope.back(), law.rms_log_residual});
  panel.curves.push_back(make_curve("fitted order, " + band.name, category_colour(colour), Mark::line,
                                    {points.front().omega, points.back().omega}, {law.exponent, law.exponent}));
  section.fact("fitted_order_" + band.file_name, law.exponent);
  return prose("slope", "span",
               {{"band", band.name},
                {"order", html_number(law.exponent, 3)},
                {"first", html_number(slopes.slope.front(), 3)},
                {"last", html_number(slopes.slope.back(), 3)}});
}

}  // namespace

Section slope_section(const Work& work, const Bands& bands) {
  const Scene& scene = work.scene;
  Section section = open_section("slope");
  if (bands.two_impact.empty() && bands.chatter.empty()) {
    section.add(paragraph("slope", "no-band"));
    return section;
  }
  const std::vector<backlash::DescribingFunctionSweep> sweeps = sweeps_of_scene(work);
  std::vector<double> grid;
  for (const auto& sweep : sweeps)
    for (const auto& point : sweep.points) grid.push_back(point.omega);

  Panel panel{"Local slope of Im N", {"ω in rad/s", true}, {"d ln|Im N| / d ln ω", false, -1.0, 2.2}};
  panel.key = true;
  Table table{"slopes", prose("slope", "slopes"), {{"omega_rad_s", "ω"}, {"slope", "slope"}}, {}, false};
  add_scene(scene, sweeps, panel, table);
  const double lowest = grid.front(), highest = add_higher_restitutions(work, grid.back(), panel);
  const Slopes model = static_slopes(scene, grid);
  panel.curves.push_back(make_curve("static backlash", category_colour(1), Mark::dashed, model.omega, model.slope));
  panel.curves.push_back(
      make_curve("2/3, exact limit ω → 0", "#222222", Mark::dotted, {lowest, highest}, {2.0 / 3, 2.0 / 3}));
  panel.curves.push_back(make_curve("2, limit ε → 1", "#888888", Mark::dotted, {lowest, highest}, {2, 2}));

  Table orders = table_of_orders();
  std::size_t colour = 2;
  std::string spans;
  for (const Band& band :
       {Band{"chatter", "chatter", &bands.chatter}, Band{"two impacts", "two-impact", &bands.two_impact}}) {
    if (band.points->empty()) continue;
    spans += (spans.empty() ? "" : "; ") + add_band(band, colour++, panel, orders, section);
  }
  const Slopes low = local_slopes(sweeps.front().points);
  section.finding(prose(
      "slope", "finding",
      {{"slope", html_number(low.slope.front())}, {"omega", html_number(low.omega.front(), 3)}, {"spans", spans}}));
  section.fact("lowest_local_slope", low.slope.front());
  section.add(
      Figure{"local-slope", prose("slope", "figure", {{"scene", base_scene_text(scene)}}), {std::move(panel)}, 1, 380});
  section.add(std::move(orders));
  section.add(std::move(table));
  section.add(Html{paragraph("slope", "consequences")});
  return section;
}

}  // namespace report
