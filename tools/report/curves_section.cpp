// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <complex>
#include <iterator>
#include <limits>
#include <utility>

#include "backlash/minus_inverse.hpp"
#include "backlash/static_backlash.hpp"
#include "io/number.hpp"
#include "report/html.hpp"
#include "report/prose.hpp"
#include "report/sections.hpp"
#include "report/sweep_curves.hpp"

namespace report {

namespace {

using backlash::DescribingFunctionPoint;
using backlash::DescribingFunctionSweep;
using backlash::SweepScene;
using backlash::TwoMassSystem;

std::string number_label(const std::string& symbol, double value, const std::string& unit) {
  return symbol + " = " + io::format_number(value) + (unit.empty() ? "" : " " + unit);
}

struct FamilyScenes {
  std::vector<SweepScene> scenes;
  std::vector<std::string> labels;
};

FamilyScenes over_forces(const Scene& scene) {
  FamilyScenes family;
  const TwoMassSystem system(scene.mass1, scene.mass2, scene.clearance, scene.restitution);
  for (const double force : scene.forces) {
    family.scenes.push_back({system, force});
    family.labels.push_back(number_label("F", force, "N"));
  }
  return family;
}

FamilyScenes over_clearances(const Scene& scene) {
  FamilyScenes family;
  for (const double clearance : scene.clearances) {
    family.scenes.push_back({TwoMassSystem(scene.mass1, scene.mass2, clearance, scene.restitution), scene.force});
    family.labels.push_back(number_label("Δ", clearance, "m") + (clearance == 0 ? " (rigid)" : ""));
  }
  return family;
}

FamilyScenes over_restitutions(const Scene& scene) {
  FamilyScenes family;
  for (const double restitution : scene.restitutions) {
    family.scenes.push_back({TwoMassSystem(scene.mass1, scene.mass2, scene.clearance, restitution), scene.force});
    family.labels.push_back(number_label("ε", restitution, ""));
  }
  return family;
}

std::optional<PlotPoint> nichols_place(const DescribingFunctionPoint& point) {
  const auto inverse = backlash::minus_inverse(point);
  if (!inverse) return std::nullopt;
  const double level = decibel(inverse->value);
  return PlotPoint{phase_degrees(inverse->value), level, level, level};
}

// Cuts error bars at 1 % of the value, because a logarithmic axis has no zero.
PlotPoint with_bars(double x, double y, double uncertainty) {
  return {x, y, std::max(y - uncertainty, 0.01 * y), y + uncertainty};
}

std::optional<PlotPoint> part_place(const DescribingFunctionPoint& point, bool imaginary) {
  const auto inverse = backlash::minus_inverse(point);
  if (!inverse) return std::nullopt;
  const double value = imaginary ? inverse->value.imag() : inverse->value.real();
  // Leaves out a mean that is smaller than its uncertainty: it may be zero, which a logarithmic axis cannot show.
  if (!(value > inverse->uncertainty)) return std::nullopt;
  return with_bars(point.omega, value, inverse->uncertainty);
}

struct StaticCurve {
  std::vector<double> omega;
  std::vector<std::complex<double>> minus_inverse;  // N/m
};

// Leaves out frequencies at which the backlash transmits no motion: N = 0 there, and -1/N is infinite.
StaticCurve static_curve(const Scene& scene, double force, std::vector<double> omega) {
  const double first = omega.front();
  const double end = std::sqrt(2 * force / ((scene.mass1 + scene.mass2) * scene.clearance));
  if (omega.front() < end && end < omega.back()) {
    // -1/N grows without limit towards the end.  Points close to it let the curve leave the chart.
    for (double distance = 0.1; distance > 1e-5; distance /= 1.3) omega.push_back(end * (1 - distance));
    std::sort(omega.begin(), omega.end());
    omega.erase(std::unique(omega.begin(), omega.end()), omega.end());
    omega.erase(omega.begin(), std::lower_bound(omega.begin(), omega.end(), first));
  }
  const auto values = backlash::static_describing_function(scene.mass1, scene.mass2, scene.clearance, force, omega);
  StaticCurve curve;
  for (std::size_t i = 0; i < omega.size(); ++i) {
    const auto inverse = backlash::minus_inverse(values[i], 0);
    if (!inverse) continue;
    curve.omega.push_back(omega[i]);
    curve.minus_inverse.push_back(inverse->value);
  }
  return curve;
}

std::vector<double> mapped(const std::vector<std::complex<double>>& values, double (*map)(std::complex<double>)) {
  std::vector<double> result;
  std::transform(values.begin(), values.end(), std::back_inserter(result), map);
  return result;
}

Panel nichols_panel() {
  Panel panel{"", {.label = "phase of −1/N in degrees", .degrees = true}, {"|−1/N| in dB re 1 N/m"}};
  panel.key = true;
  return panel;
}

void append(std::vector<Curve>& curves, std::vector<Curve> more) {
  std::move(more.begin(), more.end(), std::back_inserter(curves));
}

Figure static_nichols(const Scene& scene) {
  Panel panel = nichols_panel();
  panel.title = "Static backlash";
  for (std::size_t i = 0; i < scene.forces.size(); ++i) {
    const StaticCurve curve = static_curve(scene, scene.forces[i], scene.omega_nichols);
    panel.curves.push_back(make_curve(number_label("F", scene.forces[i], "N"), family_colour(i, scene.forces.size()),
                                      Mark::line, mapped(curve.minus_inverse, phase_degrees),
                                      mapped(curve.minus_inverse, decibel)));
  }
  Figure figure;
  figure.name = "fig3-nichols-static";
  figure.caption = numbered_caption(scene, 3,
                                    prose("curves", "nichols-static",
                                          {{"scene", base_scene_text(scene, false, true, false)},
                                           {"from", html_number(scene.omega_nichols.front())},
                                           {"to", html_number(scene.omega_nichols.back())}}));
  panel.y.to = 100;
  figure.panels = {std::move(panel)};
  figure.panel_height = 400;
  return figure;
}

Figure dynamic_nichols(const Scene& scene, const Family& family) {
  Panel panel = nichols_panel();
  panel.title = "Two masses with impacts";
  for (std::size_t i = 0; i < family.sweeps.size(); ++i) {
    append(panel.curves,
           sweep_curves(family.sweeps[i], family.labels[i], family_colour(i, family.sweeps.size()), nichols_place));
  }
  return {"fig4-nichols-dynamic",
          numbered_caption(scene, 4,
                           prose("curves", "nichols-dynamic", {{"scene", base_scene_text(scene, false, true, true)}})),
          {std::move(panel)},
          1,
          400};
}

Figure bode(const Scene& scene, const Family& family) {
  Panel magnitude, phase;
  magnitude.title = "Magnitude of −1/N";
  magnitude.x = phase.x = {"ω in rad/s", true};
  const double highest_omega = scene.omega_bode.back();
  magnitude.y = {"dB re 1 N/m", false, {}, decibel((scene.mass1 + scene.mass2) * highest_omega * highest_omega) + 15};
  magnitude.key = true;
  phase.title = "Phase of −1/N";
  phase.y = {.label = "degrees", .degrees = true};
  const StaticCurve model = static_curve(scene, scene.force, scene.omega_bode);
  const DescribingFunctionSweep& sweep = family.sweeps.front();
  append(magnitude.curves, sweep_curves(sweep, "two masses, impacts", category_colour(0), [](const auto& point) {
           auto place = nichols_place(point);
           if (place) place->x = point.omega;
           return place;
         }));
  append(phase.curves, sweep_curves(sweep, "", category_colour(0),
                                    [](const DescribingFunctionPoint& point) -> std::optional<PlotPoint> {
                                      const auto inverse = backlash::minus_inverse(point);
                                      if (!inverse) return std::nullopt;
                                      const double degrees = phase_degrees(inverse->value);
                                      return PlotPoint{point.omega, degrees, degrees, degrees};
                                    }));
  magnitude.curves.push_back(make_curve("static backlash", category_colour(1), Mark::dashed, model.omega,
                                        mapped(model.minus_inverse, decibel)));
  phase.curves.push_back(
      make_curve("", category_colour(1), Mark::dashed, model.omega, mapped(model.minus_inverse, phase_degrees)));
  std::vector<double> rigid;
  for (const double omega : scene.omega_bode) rigid.push_back(decibel((scene.mass1 + scene.mass2) * omega * omega));
  magnitude.curves.push_back(make_curve("rigid: (M_1+M_2)ω^2", "#777777", Mark::dotted, scene.omega_bode, rigid));
  return {"fig5-bode",
          numbered_caption(scene, 5, prose("curves", "bode", {{"scene", base_scene_text(scene, true, true, true)}})),
          {std::move(magnitude), std::move(phase)},
          1,
          270};
}

// Lower end of the vertical axis: half of the value with which the lowest curve starts.  A curve that passes through
// zero further on would otherwise stretch the axis over empty decades.
std::optional<double> floor_of(const Panel& panel) {
  std::optional<double> lowest;
  double first = std::numeric_limits<double>::infinity();
  for (const Curve& curve : panel.curves) {
    for (const auto& segment : curve.segments) {
      if (segment.empty() || segment.front().x > 1.2 * first) continue;
      if (segment.front().x < first / 1.2) lowest.reset();
      first = std::min(first, segment.front().x);
      lowest = std::min(lowest.value_or(segment.front().y), segment.front().y);
    }
  }
  if (lowest) *lowest /= 2;
  return lowest;
}

Figure parts_figure(const std::string& name, const std::string& caption, const Family& family) {
  Figure figure;
  figure.name = name;
  figure.caption = caption;
  figure.columns = 2;
  figure.panel_height = 400;
  for (const bool imaginary : {false, true}) {
    Panel panel{imaginary ? "Im(−1/N)" : "Re(−1/N)", {"ω in rad/s", true}, {"N/m", true}};
    panel.key = imaginary;
    for (std::size_t i = 0; i < family.sweeps.size(); ++i) {
      append(panel.curves, sweep_curves(family.sweeps[i], family.labels[i], family_colour(i, family.sweeps.size()),
                                        [imaginary](const auto& point) { return part_place(point, imaginary); }));
    }
    panel.y.from = floor_of(panel);
    figure.panels.push_back(std::move(panel));
  }
  return figure;
}

std::vector<DescribingFunctionSweep> computed(const std::vector<SweepScene>& scenes, const std::vector<double>& omega,
                                              const Work& work) {
  backlash::SweepOptions options;
  options.threads = work.threads;
  return backlash::describing_function_sweeps(scenes, omega, options, work.progress);
}

}  // namespace

Curves compute_curves(const Work& work) {
  const Scene& scene = work.scene;
  const FamilyScenes forces = over_forces(scene);
  const FamilyScenes clearances = over_clearances(scene);
  const FamilyScenes restitutions = over_restitutions(scene);
  // One call computes the three families that share a grid, which loads the threads evenly.
  std::vector<SweepScene> all;
  for (const FamilyScenes* family : {&restitutions, &clearances, &forces}) {
    all.insert(all.end(), family->scenes.begin(), family->scenes.end());
  }
  std::vector<DescribingFunctionSweep> sweeps = computed(all, scene.omega_family, work);
  auto next = sweeps.begin();
  const auto taken = [&next](const FamilyScenes& family) {
    const auto end = next + static_cast<std::ptrdiff_t>(family.scenes.size());
    Family result{family.labels, {std::make_move_iterator(next), std::make_move_iterator(end)}};
    next = end;
    return result;
  };
  Curves curves;
  curves.restitutions = taken(restitutions);
  curves.clearances = taken(clearances);
  curves.forces = taken(forces);
  curves.nichols_forces = {forces.labels, computed(forces.scenes, scene.omega_nichols, work)};
  curves.bode = {{"two masses"}, computed({{work.system(), scene.force}}, scene.omega_bode, work)};
  return curves;
}

Section curves_section(const Work& work, const Curves& curves) {
  const Scene& scene = work.scene;
  Section section = open_section("curves");
  section.add(static_nichols(scene));
  section.add(dynamic_nichols(scene, curves.nichols_forces));
  section.add(bode(scene, curves.bode));
  if (scene.restitutions.size() > 1) {
    section.add(parts_figure(
        "fig6-restitution",
        numbered_caption(scene, 6,
                         prose("curves", "restitutions", {{"scene", base_scene_text(scene, true, true, false)}})),
        curves.restitutions));
  }
  if (scene.clearances.size() > 1) {
    section.add(parts_figure(
        "fig7-clearance",
        numbered_caption(scene, 7,
                         prose("curves", "clearances", {{"scene", base_scene_text(scene, true, false, true)}})),
        curves.clearances));
  }
  if (scene.forces.size() > 1) {
    section.add(parts_figure(
        "fig8-force",
        numbered_caption(scene, 8, prose("curves", "forces", {{"scene", base_scene_text(scene, false, true, true)}})),
        curves.forces));
  }
  section.add(sweep_table("nichols", prose("curves", "nichols-table"), curves.nichols_forces.sweeps));
  section.add(sweep_table("bode", prose("curves", "bode-table"), curves.bode.sweeps));
  const auto add_family = [&section](const std::string& name, const std::string& caption, const Family& family) {
    if (family.sweeps.size() > 1) section.add(sweep_table(name, caption, family.sweeps));
  };
  add_family("restitution-family", prose("curves", "restitution-table"), curves.restitutions);
  add_family("clearance-family", prose("curves", "clearance-table"), curves.clearances);
  add_family("force-family", prose("curves", "force-table"), curves.forces);
  double points = 0, closed = 0;
  for (const Family* family :
       {&curves.nichols_forces, &curves.bode, &curves.restitutions, &curves.clearances, &curves.forces}) {
    for (const DescribingFunctionSweep& sweep : family->sweeps) {
      points += static_cast<double>(sweep.points.size());
      closed += static_cast<double>(std::count_if(sweep.points.begin(), sweep.points.end(), [](const auto& point) {
        return point.regime != backlash::Regime::averaged;
      }));
    }
  }
  section.fact("curve_points", points);
  section.fact("curve_points_exact", closed);
  return section;
}

}  // namespace report
