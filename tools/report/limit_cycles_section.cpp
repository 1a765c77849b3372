// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "frac/parallel_for.hpp"
#include "report/grid.hpp"
#include "report/html.hpp"
#include "report/loop_figures.hpp"
#include "report/prose.hpp"
#include "report/sections.hpp"

namespace report {
namespace {

constexpr int drawn_harmonics = 400;

// C = (M1 + M2)(1 + gain s^order)
backlash::ControlLoop loop_of(const Work& work, double gain, double order) {
  const double mass = work.scene.mass1 + work.scene.mass2;
  return {work.system(), frac::FractionalTransferFunction({{mass * gain, order}, {mass, 0}}, {{1, 0}})};
}

LoopPicture picture_of(const backlash::ControlLoop& loop, int harmonics) {
  backlash::LimitCycleOptions options;
  options.harmonics = harmonics;
  return {loop, backlash::symmetric_cycles(loop, options), backlash::predicted_limit_cycles(loop)};
}

Figure order_figure(const Work& work) {
  LoopFamilyPicture family{"q", linear_grid(0.05, 1.5, 59), {}, {}};
  for (const double order : family.values) family.loops.push_back(picture_of(loop_of(work, 1, order), 1));
  family.events =
      backlash::continue_cycles([&](double order) { return loop_of(work, 1, order); }, family.values).events;
  return frequencies_figure(family, "cycles-over-order", prose("limit-cycles", "order"));
}

Figure map_figure(const Work& work) {
  const std::vector<double> order = linear_grid(0.05, 1.6, 94);
  const std::vector<double> log_gain = linear_grid(-1.5, 1.5, 61);
  CellMap cells{order.front(),
                order.back(),
                log_gain.front(),
                log_gain.back(),
                order.size(),
                std::vector<std::size_t>(order.size() * log_gain.size()),
                {{"stable cycle", "#0072b2"}, {"unstable cycle", "#e69f00"}, {"no such motion", "#eeeeee"}}};
  frac::parallel_for(cells.cells.size(), work.threads, [&](std::size_t i) {
    const backlash::ControlLoop loop = loop_of(work, std::pow(10, log_gain[i / order.size()]), order[i % order.size()]);
    std::size_t kind = 2;
    for (const backlash::SymmetricCycle& cycle : backlash::symmetric_cycles(loop).cycles) {
      if (cycle.admissible) kind = cycle.stability.stable ? 0 : std::min<std::size_t>(kind, 1);
    }
    cells.cells[i] = kind;
  });
  const std::string points = std::to_string(cells.cells.size());
  Panel panel{"", {"q", false, order.front(), order.back()}, {"log_{10} k", false, log_gain.front(), log_gain.back()}};
  panel.key = true;
  panel.map = std::move(cells);
  return {"cycles-map", prose("limit-cycles", "map", {{"points", points}}), {std::move(panel)}, 1, 360};
}

}  // namespace

LoopPicture example_loop(const Work& work) {
  return picture_of(loop_of(work, 1, 0.5), drawn_harmonics);
}

Section limit_cycles_section(const Work& work) {
  Section section = open_section("limit-cycles");
  const LoopPicture picture = example_loop(work);
  const backlash::SymmetricCycle* cycle = nullptr;
  for (const backlash::SymmetricCycle& each : picture.exact.cycles) {
    if (each.admissible) cycle = &each;
  }
  const auto symmetric = std::find_if(picture.predicted.begin(), picture.predicted.end(),
                                      [](const backlash::PredictedCycle& each) { return each.symmetric; });
  if (cycle != nullptr && symmetric != picture.predicted.end()) {
    const double predicted = symmetric->omega;
    const std::string exact_text = html_number(cycle->omega, 5), predicted_text = html_number(predicted, 5);
    section.add(nyquist_figure(picture, "cycles-nyquist",
                               prose("limit-cycles", "nyquist",
                                     {{"restitution", html_number(work.scene.restitution, 3)},
                                      {"exact", exact_text},
                                      {"predicted", predicted_text}})));
    section.add(cycle_figure(picture.loop, *cycle, "cycles-motion", prose("limit-cycles", "motion")));
    section.add(start_figure(picture.loop, *cycle, "cycles-start", prose("limit-cycles", "start")));
    section.fact("limit_cycle_omega", cycle->omega);
    section.fact("limit_cycle_omega_predicted", predicted);
  }
  if (work.scene.of_the_paper) {
    section.add(order_figure(work));
    section.add(map_figure(work));
  }
  return section;
}

}  // namespace report
