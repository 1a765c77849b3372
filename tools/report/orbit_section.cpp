// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "backlash/jump_frequency.hpp"
#include "backlash/orbit_continuation.hpp"
#include "report/grid.hpp"
#include "report/html.hpp"
#include "report/jump_constants.hpp"
#include "report/prose.hpp"
#include "report/sections.hpp"
#include "report/sweep_curves.hpp"

namespace report {

namespace {

using backlash::JumpCriterion;
using backlash::OrbitBranch;
using backlash::PeriodicOrbit;

// The name of a branch in the key: n impacts in m force periods.
struct Pattern {
  int impacts, period;
  bool symmetric;
  bool operator==(const Pattern&) const = default;
};

Pattern pattern_of(const OrbitBranch& branch) {
  return {branch.impacts, branch.period, branch.symmetric};
}

std::string pattern_label(const Pattern& pattern) {
  return std::to_string(pattern.impacts) + " impacts in " + std::to_string(pattern.period) +
         (pattern.period == 1 ? " period" : " periods") + (pattern.symmetric ? "" : ", asymmetric");
}

using Height = double (*)(const PeriodicOrbit&, const OrbitBranch&);

double imaginary_part(const PeriodicOrbit& orbit, const OrbitBranch&) {
  return orbit.value.imag();
}

double impacts_per_period(const PeriodicOrbit&, const OrbitBranch& branch) {
  return static_cast<double>(branch.impacts) / branch.period;
}

// The pieces of branches of these patterns that have one stability.  A piece begins at the last orbit of the other
// stability, so that stable and unstable pieces meet.
Curve stretches(const std::vector<OrbitBranch>& branches, std::span<const Pattern> patterns, bool stable,
                Height height) {
  Curve curve;
  for (const OrbitBranch& branch : branches) {
    if (std::find(patterns.begin(), patterns.end(), pattern_of(branch)) == patterns.end()) continue;
    bool open = false;
    const PeriodicOrbit* before = nullptr;
    for (const PeriodicOrbit& orbit : branch.orbits) {
      if (orbit.stable == stable) {
        if (!open) {
          curve.segments.emplace_back();
          if (before != nullptr) {
            const double y = height(*before, branch);
            curve.segments.back().push_back({before->omega, y, y, y});
          }
        }
        const double y = height(orbit, branch);
        curve.segments.back().push_back({orbit.omega, y, y, y});
      }
      open = orbit.stable == stable;
      before = &orbit;
    }
  }
  return curve;
}

std::vector<Pattern> patterns_of(const std::vector<OrbitBranch>& branches) {
  std::vector<Pattern> patterns;
  for (const OrbitBranch& branch : branches) {
    if (std::find(patterns.begin(), patterns.end(), pattern_of(branch)) == patterns.end()) {
      patterns.push_back(pattern_of(branch));
    }
  }
  return patterns;
}

Curve sweep_points(const backlash::DescribingFunctionSweep& sweep, const std::string& label, Mark mark,
                   const std::string& colour, bool impacts) {
  std::vector<double> omega, y;
  for (const auto& point : sweep.points) {
    if (impacts && !std::isfinite(point.impacts_per_period)) continue;
    omega.push_back(point.omega);
    y.push_back(impacts ? point.impacts_per_period : point.value.imag());
  }
  Curve curve{label, colour, mark, {}};
  for (std::size_t i = 0; i < omega.size(); ++i) curve.segments.push_back({{omega[i], y[i], y[i], y[i]}});
  return curve;
}

Curve bifurcation_marks(const std::vector<OrbitBranch>& branches, backlash::Bifurcation kind, Height height,
                        const std::string& label, const std::string& colour) {
  Curve curve{label, colour, Mark::open_points, {}};
  for (const OrbitBranch& branch : branches) {
    for (const auto& point : branch.bifurcations) {
      if (point.kind != kind) continue;
      const double y = height(point.orbit, branch);
      curve.segments.push_back({{point.orbit.omega, y, y, y}});
    }
  }
  return curve;
}

struct Kind {
  backlash::Bifurcation kind;
  std::string label, colour;
};

const std::array<Kind, 4>& kinds() {
  static const std::array<Kind, 4> all = {{{backlash::Bifurcation::saddle_node, "saddle-node", "#d00000"},
                                           {backlash::Bifurcation::symmetry_breaking, "symmetry breaking", "#7a3db8"},
                                           {backlash::Bifurcation::period_doubling, "period doubling", "#b8860b"},
                                           {backlash::Bifurcation::grazing, "grazing", "#555555"}}};
  return all;
}

// Number of patterns that get a colour of their own.  All others share one.
constexpr std::size_t told_apart = 4;

void add_branches(Panel& panel, const std::vector<OrbitBranch>& branches, std::span<const Pattern> patterns,
                  const std::string& label, const std::string& colour, Height height) {
  Curve unstable = stretches(branches, patterns, false, height);
  Curve stable = stretches(branches, patterns, true, height);
  stable.colour = unstable.colour = colour;
  stable.mark = Mark::line;
  unstable.mark = Mark::dotted;
  (stable.segments.empty() ? unstable : stable).label = label;
  panel.curves.push_back(std::move(unstable));
  panel.curves.push_back(std::move(stable));
}

struct Sweeps {
  backlash::DescribingFunctionSweep up, down;
};

// Sets vertical limits that hold the motions of the sweeps.  Unstable orbits far away may leave the panel.
void fit_height(Axis& axis, const Sweeps& sweeps, bool impacts) {
  double lowest = std::numeric_limits<double>::infinity();
  double highest = -lowest;
  for (const auto* sweep : {&sweeps.up, &sweeps.down}) {
    for (const auto& point : sweep->points) {
      const double y = impacts ? point.impacts_per_period : point.value.imag();
      if (!std::isfinite(y)) continue;
      lowest = std::min(lowest, y);
      highest = std::max(highest, y);
    }
  }
  if (lowest > highest) return;
  const double pad = std::max(0.5 * (highest - lowest), 1e-3 * std::abs(highest));
  axis.from = lowest - pad;
  axis.to = highest + pad;
}

Panel bifurcation_panel(const backlash::OrbitDiagram& diagram, const Sweeps& sweeps, bool impacts) {
  const Height height = impacts ? impacts_per_period : imaginary_part;
  Panel panel{"",
              {"ω in rad/s", false, diagram.from, diagram.to},
              {impacts ? "impacts per period" : "Im N in m/N", false, {}, {}}};
  const std::vector<Pattern> patterns = patterns_of(diagram.branches);
  const std::span<const Pattern> all(patterns);
  const std::size_t named = std::min(told_apart, patterns.size());
  for (std::size_t i = 0; i < named; ++i) {
    add_branches(panel, diagram.branches, all.subspan(i, 1), pattern_label(patterns[i]),
                 category_colour(i == 0 ? 0 : i + 1), height);
  }
  if (named < patterns.size()) {
    add_branches(panel, diagram.branches, all.subspan(named), "longer orbits", "#999999", height);
  }
  for (const Kind& kind : kinds()) {
    Curve marks = bifurcation_marks(diagram.branches, kind.kind, height, kind.label, kind.colour);
    if (!marks.segments.empty()) panel.curves.push_back(std::move(marks));
  }
  panel.curves.push_back(sweep_points(sweeps.up, "sweep, ω rising", Mark::open_points, "#000000", impacts));
  panel.curves.push_back(sweep_points(sweeps.down, "sweep, ω falling", Mark::points, category_colour(1), impacts));
  return panel;
}

Table bifurcation_table(const backlash::OrbitDiagram& diagram, double scale) {
  Table table{"bifurcations",
              prose("orbits", "bifurcations"),
              {{"branch", "branch"},
               {"impacts", "impacts"},
               {"period", "force periods"},
               {"symmetry", "symmetry"},
               {"bifurcation", "bifurcation"},
               {"omega_rad_s", "ω / (rad/s)", 8},
               {"similarity_constant", "c", 8},
               {"im_m_per_n", "Im N / (m/N)", 6}},
              {},
              true,
              40};
  for (std::size_t b = 0; b < diagram.branches.size(); ++b) {
    const OrbitBranch& branch = diagram.branches[b];
    for (const auto& point : branch.bifurcations) {
      table.rows.push_back(
          {static_cast<double>(b + 1), static_cast<double>(branch.impacts), static_cast<double>(branch.period),
           std::string(branch.symmetric ? "symmetric" : "asymmetric"), std::string(backlash::to_string(point.kind)),
           point.orbit.omega, point.orbit.omega / scale, point.orbit.value.imag()});
    }
  }
  return table;
}

void add_jump_constants(const Work& work, Section& section) {
  const std::vector<double> restitution = linear_grid(0, 1, 201);
  // The criteria that are bifurcations of the two-impact orbit.
  const std::pair<JumpCriterion, std::string> criteria[] = {{JumpCriterion::saddle_node, "saddle-node"},
                                                            {JumpCriterion::symmetry_loss, "symmetry loss"},
                                                            {JumpCriterion::two_impact_loss, "two-impact loss"}};
  const std::vector<double>& averaged = work.scene.jump_restitutions;

  Panel panel{"Similarity constant of the jumps against restitution",
              {"ε", false, 0.0, 1.0},
              {"c = ω_J / (F/(M_2 Δ))^{1/2}", true, 1.0, 10.0}};
  panel.key = true;
  Table table{"jump-criteria", prose("orbits", "criteria"), {{"restitution", "ε"}}, {}, false};
  for (const double value : restitution) table.rows.push_back({value});
  std::string means;
  for (std::size_t k = 0; k < std::size(criteria); ++k) {
    const auto& [criterion, label] = criteria[k];
    const std::string colour = category_colour(k);
    const std::string name(backlash::to_string(criterion));
    const std::vector<double> constants = jump_constants(criterion, restitution, work.threads);
    table.columns.push_back({"c_" + name, label, 10});
    for (std::size_t i = 0; i < constants.size(); ++i) table.rows[i].emplace_back(constants[i]);
    panel.curves.push_back(make_curve(label, colour, Mark::line, restitution, constants));
    const Mean mean = mean_of(jump_constants(criterion, averaged, work.threads));
    if (mean.used == 0) continue;
    panel.curves.push_back(make_curve("its mean over ε", colour, Mark::dotted, {averaged.front(), averaged.back()},
                                      {mean.value, mean.value}));
    means += (means.empty() ? "" : ", ") + prose("orbits", "mean",
                                                 {{"criterion", label},
                                                  {"mean", html_number(mean.value, 6)},
                                                  {"used", std::to_string(mean.used)},
                                                  {"all", std::to_string(averaged.size())}});
    section.fact("mean_c_" + name, mean.value);
  }
  section.add(Figure{"jump-constants", prose("orbits", "constants"), {std::move(panel)}, 1, 380});
  section.add(std::move(table));
  section.add(paragraph("orbits", "means", {{"means", means}}));
}

}  // namespace

Section orbit_section(const Work& work) {
  const Scene& scene = work.scene;
  Section section = open_section("orbits");
  const auto system = work.system();
  const double scale = std::sqrt(scene.force / (scene.mass2 * scene.clearance));
  const auto upper = backlash::jump_frequency(system, scene.force, JumpCriterion::saddle_node);
  const double from = scale;
  const double to = std::min(upper.value_or(4 * scale), 4 * scale) * 1.04;
  const auto diagram = backlash::orbit_diagram(system, scene.force, from, to, {.threads = work.threads}, work.progress);
  const auto sweeps_on = [&](double first, double last) {
    const std::vector<double> grid = logarithmic_grid(first, last, 90);
    backlash::SweepOptions options;
    options.threads = work.threads;
    auto up = backlash::describing_function_sweep(system, scene.force, grid, options);
    options.protocol = backlash::Protocol::sweep_down;
    return Sweeps{std::move(up), backlash::describing_function_sweep(system, scene.force, grid, options)};
  };
  Figure figure;
  figure.name = "bifurcations";
  figure.caption =
      prose("orbits", "figure",
            {{"period", std::to_string(diagram.options.longest_period)}, {"scene", base_scene_text(scene)}});
  Panel whole = bifurcation_panel(diagram, sweeps_on(from, to), false);
  whole.title = "Imaginary part of N";
  whole.key = true;
  const double enlarged_to = std::min(1.75 * scale, to);
  const Sweeps enlarged = sweeps_on(from, enlarged_to);
  Panel detail = bifurcation_panel(diagram, enlarged, false);
  detail.title = "The same, low frequencies";
  Panel counts = bifurcation_panel(diagram, enlarged, true);
  counts.title = "Impacts per force period, low frequencies";
  detail.x.to = counts.x.to = enlarged_to;
  fit_height(detail.y, enlarged, false);
  fit_height(counts.y, enlarged, true);
  figure.panels = {std::move(whole), std::move(detail), std::move(counts)};
  figure.panel_height = 360;
  section.add(std::move(figure));
  section.add(bifurcation_table(diagram, scale));
  add_jump_constants(work, section);
  section.fact("orbit_branches", static_cast<double>(diagram.branches.size()));
  return section;
}

}  // namespace report
