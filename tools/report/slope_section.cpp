// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <complex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "backlash/jump_frequency.hpp"
#include "backlash/minus_inverse.hpp"
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
using backlash::DescribingFunctionSweep;
using backlash::Quantity;

struct Slopes {
  std::vector<double> omega, slope;  // NaN between branches
};

// NaN where -1/N is infinite.
double imaginary_of(Quantity quantity, std::complex<double> value) {
  if (quantity == Quantity::n) return value.imag();
  const auto inverse = backlash::minus_inverse(value, 0);
  return inverse ? inverse->value.imag() : std::nan("");
}

std::vector<double> imaginary_of(Quantity quantity, const std::vector<DescribingFunctionPoint>& points) {
  std::vector<double> imaginary;
  for (const auto& point : points) imaginary.push_back(imaginary_of(quantity, point.value));
  return imaginary;
}

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

Slopes local_slopes(Quantity quantity, const std::vector<DescribingFunctionPoint>& points) {
  return slopes_of(omega_of(points), imaginary_of(quantity, points), [&points](std::size_t i) {
    return on_one_branch(points[i - 1], points[i]) && on_one_branch(points[i], points[i + 1]);
  });
}

Slopes static_slopes(Quantity quantity, const Scene& scene, const std::vector<double>& omega) {
  std::vector<double> imaginary;
  for (const auto& value :
       backlash::static_describing_function(scene.mass1, scene.mass2, scene.clearance, scene.force, omega)) {
    imaginary.push_back(imaginary_of(quantity, value));
  }
  return slopes_of(omega, imaginary, [](std::size_t) { return true; });
}

// The curves of a quantity, and the slopes that theory gives it.
struct Exponents {
  Quantity quantity;
  std::string symbol;
  std::string suffix;  // of names of facts
  double low;          // omega -> 0
  std::string low_label;
  std::string high_label;  // of slope 2
  double from, to;         // of the axis
};

const std::vector<Exponents>& both_quantities() {
  static const std::vector<Exponents> both = {
      {Quantity::minus_inverse, "Im(−1/N)", "_minus-inverse", 14.0 / 3, "14/3, exact limit ω → 0",
       "2, exact: two symmetric impacts", -2.0, 7.0},
      {Quantity::n, "Im N", "", 2.0 / 3, "2/3, exact limit ω → 0", "2, limit ε → 1", -1.0, 2.2}};
  return both;
}

struct Band {
  std::string name;
  std::string file_name;
  const std::vector<DescribingFunctionPoint>* points;
};

/// The closer the restitution to 1, the wider the band of two impacts.
std::vector<DescribingFunctionSweep> higher_restitutions(const Work& work) {
  const Scene& scene = work.scene;
  std::vector<DescribingFunctionSweep> sweeps;
  backlash::SweepOptions options;
  options.threads = work.threads;
  options.protocol = backlash::Protocol::two_impact;
  for (const double restitution : {0.8, 0.95}) {
    if (restitution == scene.restitution) continue;
    const backlash::TwoMassSystem harder(scene.mass1, scene.mass2, scene.clearance, restitution);
    const auto from = backlash::jump_frequency(harder, scene.force, backlash::JumpCriterion::symmetry_loss);
    const auto to = backlash::jump_frequency(harder, scene.force, backlash::JumpCriterion::saddle_node);
    if (!from || !to) continue;
    sweeps.push_back(backlash::describing_function_sweep(harder, scene.force,
                                                         logarithmic_grid(*from * 1.0001, *to * 0.9999, 200), options));
  }
  return sweeps;
}

Table table_of_orders() {
  return {"band-orders",
          prose("slope", "orders"),
          {{"quantity", "of"},
           {"band", "band"},
           {"omega_from_rad_s", "from / (rad/s)"},
           {"omega_to_rad_s", "to / (rad/s)"},
           {"order", "fitted order", 5},
           {"slope_at_start", "local slope at the lower end", 4},
           {"slope_at_end", "at the upper end", 4},
           {"rms_log_residual", "rms residual of its logarithm", 3, true, false, 1e-12}}};
}

void add_band(const Exponents& of, const Band& band, std::size_t colour, Panel& panel, Table& orders,
              Section& section) {
  const std::vector<DescribingFunctionPoint>& points = *band.points;
  const frac::PowerLaw law = frac::fit_power_law(omega_of(points), imaginary_of(of.quantity, points));
  const Slopes slopes = local_slopes(of.quantity, points);
  orders.rows.push_back({of.symbol, band.name, points.front().omega, points.back().omega, law.exponent,
                         slopes.slope.front(), slopes.slope.back(), law.rms_log_residual});
  panel.curves.push_back(make_curve("fitted order, " + band.name, category_colour(colour), Mark::line,
                                    {points.front().omega, points.back().omega}, {law.exponent, law.exponent}));
  const std::string name = band.file_name + of.suffix;
  section.fact("fitted_order_" + name, law.exponent);
  section.fact("first_slope_" + name, slopes.slope.front());
  section.fact("last_slope_" + name, slopes.slope.back());
}

Panel panel_of(const Exponents& of, const Scene& scene, const std::vector<DescribingFunctionSweep>& whole,
               const std::vector<DescribingFunctionSweep>& higher) {
  Panel panel{
      "Local slope of " + of.symbol, {"ω in rad/s", true}, {"d ln|" + of.symbol + "| / d ln ω", false, of.from, of.to}};
  panel.key = true;
  std::vector<double> grid;
  for (const auto& sweep : whole) {
    const Slopes slopes = local_slopes(of.quantity, sweep.points);
    panel.curves.push_back(
        make_curve(&sweep == &whole.front() ? "ε = " + io::format_number(scene.restitution) + ", all motions" : "",
                   category_colour(0), Mark::line, slopes.omega, slopes.slope));
    for (const auto& point : sweep.points) grid.push_back(point.omega);
  }
  double highest = grid.back();
  std::size_t shade = 0;
  for (const auto& sweep : higher) {
    const Slopes slopes = local_slopes(of.quantity, sweep.points);
    panel.curves.push_back(make_curve("ε = " + io::format_number(sweep.system.restitution()) + ", symmetric orbit",
                                      shade++ == 0 ? "#7fb5d8" : "#b5d3e7", Mark::line, slopes.omega, slopes.slope));
    highest = std::max(highest, sweep.points.back().omega);
  }
  const Slopes model = static_slopes(of.quantity, scene, grid);
  panel.curves.push_back(make_curve("static backlash", category_colour(1), Mark::dashed, model.omega, model.slope));
  panel.curves.push_back(make_curve(of.low_label, "#222222", Mark::dotted, {grid.front(), highest}, {of.low, of.low}));
  panel.curves.push_back(make_curve(of.high_label, "#888888", Mark::dotted, {grid.front(), highest}, {2, 2}));
  return panel;
}

// Slopes of both quantities at the frequencies where one of them exists.
Table slope_table(const std::vector<DescribingFunctionSweep>& whole) {
  Table table{"slopes",
              prose("slope", "slopes"),
              {{"omega_rad_s", "ω"}, {"slope_minus_inverse", "of Im(−1/N)"}, {"slope_n", "of Im N"}},
              {},
              false};
  for (const auto& sweep : whole) {
    const Slopes inverse = local_slopes(Quantity::minus_inverse, sweep.points);
    const Slopes direct = local_slopes(Quantity::n, sweep.points);
    for (std::size_t i = 0; i < direct.omega.size(); ++i) {
      if (std::isfinite(direct.slope[i])) table.rows.push_back({direct.omega[i], inverse.slope[i], direct.slope[i]});
    }
  }
  return table;
}

}  // namespace

Section slope_section(const Work& work, const Bands& bands) {
  const Scene& scene = work.scene;
  Section section = open_section("slope");
  if (bands.whole.empty()) {
    section.add(paragraph("slope", "no-band"));
    return section;
  }
  const std::vector<DescribingFunctionSweep> higher = higher_restitutions(work);
  Figure figure{"local-slope", prose("slope", "figure", {{"scene", base_scene_text(scene)}}), {}, 1, 300};
  Table orders = table_of_orders();
  const DescribingFunctionSweep& low = bands.whole.front();
  for (const Exponents& of : both_quantities()) {
    Panel panel = panel_of(of, scene, bands.whole, higher);
    std::size_t colour = 2;
    for (const Band& band :
         {Band{"chatter", "chatter", &bands.chatter}, Band{"two impacts", "two-impact", &bands.two_impact}}) {
      if (!band.points->empty()) add_band(of, band, colour++, panel, orders, section);
    }
    figure.panels.push_back(std::move(panel));
    if (low.points.front().regime != backlash::Regime::chatter) continue;
    const Slopes slopes = local_slopes(of.quantity, low.points);
    section.fact("lowest_local_slope" + of.suffix, slopes.slope.front());
    if (&of == &both_quantities().front()) section.fact("lowest_local_slope_omega", slopes.omega.front());
  }
  section.add(std::move(figure));
  section.add(std::move(orders));
  section.add(slope_table(bands.whole));
  section.add(Html{paragraph("slope", "consequences")});
  return section;
}

}  // namespace report
