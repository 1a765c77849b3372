// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "backlash/jump_frequency.hpp"
#include "backlash/regime_map.hpp"
#include "report/grid.hpp"
#include "report/html.hpp"
#include "report/prose.hpp"
#include "report/sections.hpp"

namespace report {

namespace {

using backlash::DescribingFunctionPoint;
using backlash::JumpCriterion;
using backlash::Regime;

const std::vector<CellMap::Kind>& kinds() {
  static const std::vector<CellMap::Kind> all = {{"symmetric, two impacts", "#0072b2"},
                                                 {"asymmetric, two impacts", "#56b4e9"},
                                                 {"more impacts, one period", "#009e73"},
                                                 {"several periods", "#e69f00"},
                                                 {"rest in contact", "#cc79a7"},
                                                 {"irregular: mean", "#444444"},
                                                 {"no impacts", "#eeeeee"}};
  return all;
}

std::size_t kind_of(const DescribingFunctionPoint& point) {
  switch (point.regime) {
    case Regime::symmetric:
      return 0;
    case Regime::chatter:
      return 4;
    case Regime::averaged:
      return 5;
    case Regime::rigid:
    case Regime::free:
      return 6;
    case Regime::periodic:
      break;
  }
  if (point.period > 1) return 3;
  if (point.impacts_per_period != 2) return 2;
  // At restitution 0 the symmetric orbit of two impacts contains rests.  The solver has no closed form for it and
  // reports it as periodic.
  return point.even_harmonic_ratio > 1e-9 ? 1 : 0;
}

Curve boundary(JumpCriterion criterion, const std::string& label, Mark mark, double highest) {
  std::vector<double> constant, restitution;
  for (const double value : linear_grid(0, 1, 201)) {
    const auto jump = backlash::jump_similarity_constant(value, criterion);
    if (!jump.similarity_constant || *jump.similarity_constant > highest) continue;
    constant.push_back(*jump.similarity_constant);
    restitution.push_back(value);
  }
  return make_curve(label, "#ffffff", mark, constant, restitution);
}

}  // namespace

Section map_section(const Work& work) {
  Section section = open_section("map");
  backlash::MapScene scene;
  const std::vector<double> restitution = linear_grid(0, 1, 250);
  const std::vector<double> omega = linear_grid(0.2, 3, 400);
  auto options = backlash::map_options();
  options.threads = work.threads;
  const auto map = backlash::regime_map(scene, restitution, omega, options, work.progress);

  CellMap cells{omega.front(), omega.back(), restitution.front(), restitution.back(), omega.size(), {}, kinds()};
  std::vector<std::size_t> count(kinds().size());
  double narrow_means = 0;
  for (const auto& point : map.points) {
    cells.cells.push_back(kind_of(point));
    ++count[cells.cells.back()];
    narrow_means +=
        point.regime == Regime::averaged && point.uncertainty <= options.mean_tolerance * std::abs(point.value);
  }
  Panel panel;
  panel.title = "Steady motion, ω rising";
  panel.x = {"ω / (F/(M_2 Δ))^{1/2}", false, omega.front(), omega.back()};
  panel.y = {"ε", false, 0.0, 1.0};
  panel.key = true;
  panel.map = std::move(cells);
  panel.curves = {boundary(JumpCriterion::two_impact_loss, "", Mark::line, omega.back()),
                  boundary(JumpCriterion::symmetry_loss, "", Mark::dashed, omega.back()),
                  boundary(JumpCriterion::saddle_node, "", Mark::dotted, omega.back())};
  Figure figure;
  figure.name = "regime-map";
  figure.caption = prose("map", "figure", {{"points", std::to_string(map.points.size())}});
  figure.panels = {std::move(panel)};
  figure.panel_height = 460;
  section.blocks.emplace_back(std::move(figure));

  Table table{"regime-shares", prose("map", "shares"), {{"motion", "motion"}, {"share", "share", 3}}, {}};
  for (std::size_t k = 0; k < kinds().size(); ++k) {
    table.rows.push_back({kinds()[k].label, static_cast<double>(count[k]) / static_cast<double>(map.points.size())});
  }
  section.blocks.emplace_back(std::move(table));
  section.facts.emplace_back("map_points", static_cast<double>(map.points.size()));
  section.facts.emplace_back("map_irregular_share",
                             static_cast<double>(count[5]) / static_cast<double>(map.points.size()));
  section.findings.push_back(prose(
      "map", "finding",
      {{"points", std::to_string(map.points.size())},
       {"closed", html_number(100 * (1 - static_cast<double>(count[5]) / static_cast<double>(map.points.size())), 3)},
       {"tolerance", html_number(100 * options.mean_tolerance, 2)},
       {"narrow", html_number(100 * narrow_means / static_cast<double>(std::max<std::size_t>(count[5], 1)), 2)}}));
  return section;
}

}  // namespace report
