// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "backlash/compliant/compliant_bodies.hpp"
#include "backlash/compliant/compliant_jump.hpp"
#include "backlash/loss_factor.hpp"
#include "backlash/minus_inverse.hpp"
#include "io/number.hpp"
#include "report/html.hpp"
#include "report/prose.hpp"
#include "report/sections.hpp"
#include "report/sweep_curves.hpp"

namespace report {

namespace {

using backlash::DescribingFunctionPoint;
using backlash::DescribingFunctionSweep;
using backlash::Regime;

std::vector<backlash::CompliantScene> scenes_of(const Scene& scene) {
  std::vector<backlash::CompliantScene> scenes;
  for (const double clearance : scene.clearances)
    for (const double force : scene.forces)
      scenes.push_back({{backlash::free_mass(scene.mass1), backlash::free_mass(scene.mass2), clearance, *scene.contact,
                         scene.friction},
                        force});
  return scenes;
}

std::optional<double> loss_factor_of(const DescribingFunctionSweep& sweep, const DescribingFunctionPoint& point) {
  const auto inverse = backlash::minus_inverse(point);
  if (!inverse) return std::nullopt;
  return backlash::loss_factor(sweep.system, inverse->value, point.omega);
}

PlotPoint plain(double x, double y) {
  return {x, y, y, y};
}

void add(Panel& panel, std::vector<Curve> curves) {
  panel.curves.insert(panel.curves.end(), std::make_move_iterator(curves.begin()),
                      std::make_move_iterator(curves.end()));
}

bool is_closed(const DescribingFunctionPoint& point) {
  return point.regime == Regime::symmetric || point.regime == Regime::periodic;
}

Table regime_table(const std::vector<DescribingFunctionSweep>& sweeps) {
  Table table{"contact-regimes",
              prose("compliant", "regimes"),
              {{"force_n", "F / N"},
               {"clearance_m", "Δ / m"},
               {"regime", "regime"},
               {"points", "points"},
               {"lowest_omega_rad_s", "lowest ω / (rad/s)"},
               {"highest_omega_rad_s", "highest ω / (rad/s)"},
               {"energy_defect", "energy defect", 2}}};
  for (const auto& sweep : sweeps)
    for (const Regime regime :
         {Regime::rigid, Regime::free, Regime::symmetric, Regime::periodic, Regime::chatter, Regime::averaged}) {
      double points = 0, lowest = NAN, highest = NAN, defect = 0;
      for (const auto& point : sweep.points) {
        if (point.regime != regime) continue;
        if (points++ == 0) lowest = point.omega;
        highest = point.omega;
        defect = is_closed(point) ? std::max(defect, point.energy_defect) : NAN;
      }
      if (points > 0)
        table.rows.push_back({sweep.force_amplitude, sweep.system.clearance(), std::string(backlash::to_string(regime)),
                              points, lowest, highest, defect});
    }
  return table;
}

Table jump_table(const std::vector<backlash::CompliantScene>& scenes, const Work& work, Section& section) {
  struct Row {
    backlash::JumpCriterion criterion;
    const backlash::CompliantScene* scene;
    backlash::CompliantJump jump;
  };
  std::vector<Row> rows;
  for (const auto& scene : scenes)
    for (const auto criterion : {backlash::JumpCriterion::symmetry_loss, backlash::JumpCriterion::saddle_node})
      rows.push_back({criterion, &scene, {}});
  frac::parallel_for(rows.size(), work.threads, [&](std::size_t i) {
    rows[i].jump = backlash::compliant_jump(rows[i].scene->bodies, rows[i].scene->force_amplitude, rows[i].criterion);
  });
  Table table{"contact-jumps",
              prose("compliant", "jumps"),
              {{"force_n", "F / N"},
               {"clearance_m", "Δ / m"},
               {"criterion", "end"},
               {"omega_jump_rad_s", "ω<sub>J</sub> / (rad/s)", 6},
               {"similarity_constant", "c", 6},
               {"exponent", "exponent of F"},
               {"clearance_exponent", "exponent of Δ"},
               {"meaning", "what happens there"}}};
  bool is_first = true;
  for (const auto& [criterion, scene, jump] : rows) {
    const auto& system = scene->bodies.system();
    const double omega = jump.similarity_constant.value_or(NAN) *
                         std::sqrt(scene->force_amplitude / system.mass2() / system.clearance());
    table.rows.push_back({scene->force_amplitude, system.clearance(), std::string(backlash::to_string(criterion)),
                          omega, jump.similarity_constant.value_or(NAN), jump.exponent, jump.clearance_exponent,
                          jump.message});
    if (!jump.similarity_constant || !std::exchange(is_first, false)) continue;
    section.fact("contact_jump_rad_s", omega);
    section.fact("contact_jump_exponent", jump.exponent);
    section.finding(prose("compliant", "found-jump",
                          {{"omega", html_number(omega)},
                           {"force", html_number(scene->force_amplitude)},
                           {"clearance", html_number(system.clearance())},
                           {"exponent", html_number(jump.exponent)},
                           {"clearance_exponent", html_number(jump.clearance_exponent)}}));
  }
  return table;
}

}  // namespace

Section compliant_section(const Work& work) {
  const Scene& scene = work.scene;
  Section section = open_section("compliant");
  const auto scenes = scenes_of(scene);
  backlash::SweepOptions options;
  options.threads = work.threads;
  const auto sweeps = backlash::bodies_describing_functions(scenes, scene.omega_family, options, work.progress);
  const backlash::FreeContact free = backlash::free_contact(*scene.contact, scene.mass1, scene.mass2);
  section.add(paragraph("compliant", "scene",
                        {{"mass1", html_number(scene.mass1)},
                         {"mass2", html_number(scene.mass2)},
                         {"stiffness", html_number(scene.contact->stiffness())},
                         {"damping", html_number(scene.contact->damping())},
                         {"frequency", html_number(free.frequency)},
                         {"ratio", html_number(free.damping_ratio)},
                         {"duration", html_number(free.duration)},
                         {"restitution", html_number(free.restitution)},
                         {"friction1", html_number(scene.friction.body1)},
                         {"friction2", html_number(scene.friction.body2)}}));

  Panel size{"Magnitude", {"ω / (rad/s)", true}, {"|N| / dB (m/N)"}},
      phase{"Phase", {"ω / (rad/s)", true}, {"arg N / °"}};
  phase.y.degrees = true;
  Panel law{"Loss factor", {"ω/√(F/(M_2Δ))", true}, {"y = Im(−1/N)/((M_1+M_2)ω^2)", true}};
  size.key = law.key = true;
  Table readings{"contact-readings",
                 prose("compliant", "readings"),
                 {{"force_n", "F / N"},
                  {"clearance_m", "Δ / m"},
                  {"omega_rad_s", "ω / (rad/s)"},
                  {"loss_factor", "y", 6},
                  {"restitution", "of a free contact"},
                  {"restitution_read", "taken for", 6}}};
  double closed = 0, points = 0, defect = 0;
  for (std::size_t i = 0; i < sweeps.size(); ++i) {
    const DescribingFunctionSweep& sweep = sweeps[i];
    const std::string label = "F = " + io::format_number(sweep.force_amplitude) +
                              " N, Δ = " + io::format_number(sweep.system.clearance()) + " m";
    const std::string colour = family_colour(i, sweeps.size());
    add(size, sweep_curves(sweep, label, colour, [](const auto& point) -> std::optional<PlotPoint> {
          return plain(point.omega, decibel(point.value));
        }));
    add(phase, sweep_curves(sweep, "", colour, [](const auto& point) -> std::optional<PlotPoint> {
          // A load that nothing touches has no phase.
          if (point.regime == Regime::free) return std::nullopt;
          return plain(point.omega, phase_degrees(point.value));
        }));
    add(law, sweep_curves(sweep, label, colour, [&](const auto& point) -> std::optional<PlotPoint> {
          const auto y = loss_factor_of(sweep, point);
          // A logarithmic axis has no place for others.
          if (!y || !(*y > 0)) return std::nullopt;
          return plain(backlash::frequency_ratio(sweep.system, sweep.force_amplitude, point.omega), *y);
        }));
    bool is_first = true;
    for (const auto& point : sweep.points) {
      ++points;
      if (!is_closed(point)) continue;
      ++closed;
      defect = std::max(defect, point.energy_defect);
      // The law is one of two contacts half a period apart.
      if (point.regime != Regime::symmetric || point.impacts_per_period != 2 || !is_first) continue;
      const auto y = loss_factor_of(sweep, point);
      const auto read = y ? backlash::restitution_from_loss_factor(*y) : std::nullopt;
      if (!read) continue;
      is_first = false;
      if (readings.rows.empty()) {
        section.fact("contact_loss_factor", *y);
        section.finding(prose("compliant", "found-law",
                              {{"omega", html_number(point.omega)},
                               {"read", html_number(*read)},
                               {"restitution", html_number(free.restitution)},
                               {"duration", html_number(free.duration * point.omega / (2 * std::numbers::pi))}}));
      }
      readings.rows.push_back(
          {sweep.force_amplitude, sweep.system.clearance(), point.omega, *y, free.restitution, *read});
    }
  }
  const double lowest =
      backlash::frequency_ratio(sweeps.front().system, sweeps.front().force_amplitude, scene.omega_family.front());
  const double highest =
      backlash::frequency_ratio(sweeps.front().system, sweeps.front().force_amplitude, scene.omega_family.back());
  const double level = backlash::symmetric_loss_factor(free.restitution);
  law.curves.push_back(
      make_curve("no duration, no friction", "#888888", Mark::dotted, {lowest, highest}, {level, level}));
  section.fact("contact_points", points);
  section.fact("contact_closed_orbits", closed);
  if (closed > 0) {
    section.fact("contact_energy_defect", defect);
    section.findings.insert(
        section.findings.begin(),
        prose("compliant", "found-orbits",
              {{"closed", html_number(closed)}, {"points", html_number(points)}, {"defect", html_number(defect, 2)}}));
  }
  section.add(Figure{"contact-curves", prose("compliant", "curves"), {std::move(size), std::move(phase)}, 1, 300});
  section.add(sweep_table("contact-sweeps", prose("compliant", "curves"), sweeps));
  section.add(regime_table(sweeps));
  section.add(Figure{"contact-loss-factor", prose("compliant", "law"), {std::move(law)}, 1, 400});
  if (!readings.rows.empty()) section.add(std::move(readings));
  section.add(jump_table(scenes, work, section));
  return section;
}

}  // namespace report
