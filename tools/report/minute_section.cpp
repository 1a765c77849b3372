// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <numbers>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "backlash/identification/jump_law.hpp"
#include "backlash/impact_simulation.hpp"
#include "backlash/jump_frequency.hpp"
#include "backlash/loss_factor.hpp"
#include "backlash/minus_inverse.hpp"
#include "backlash/static_backlash.hpp"
#include "backlash/time_history.hpp"
#include "io/number.hpp"
#include "report/bands.hpp"
#include "report/html.hpp"
#include "report/loop_figures.hpp"
#include "report/prose.hpp"
#include "report/sections.hpp"
#include "report/sweep_curves.hpp"

namespace report {

namespace {

using backlash::DescribingFunctionPoint;
using backlash::DescribingFunctionSweep;
using backlash::JumpCriterion;

struct Motion {
  double omega;
  std::string name;
};

// One of each band.
std::vector<Motion> shown_motions(const Scene& scene, const Bands& bands) {
  std::vector<Motion> motions;
  if (!bands.chatter.empty()) motions.push_back({bands.chatter.back().omega, "chatter and rest"});
  if (!bands.between.empty())
    motions.push_back({std::sqrt(bands.between.front().omega * bands.between.back().omega), "in between"});
  if (!bands.two_impact.empty()) {
    const double from = bands.two_impact.front().omega;
    motions.push_back({std::min(1.1 * from, std::sqrt(from * bands.two_impact.back().omega)), "two impacts a period"});
  }
  if (motions.empty()) motions = {{scene.omega_bode.front(), ""}, {scene.omega_bode.back(), ""}};
  return motions;
}

// The gap over three periods of the force, as an experimenter sees it who raises the frequency slowly.
Figure motion_figure(const Work& work, const Bands& bands) {
  constexpr int settling_periods = 30, steps = 8, drawn_periods = 3, samples = 200;
  const auto system = work.system();
  const double force = work.scene.force;
  const std::vector<Motion> motions = shown_motions(work.scene, bands);
  Figure figure{"minute-motion", prose("minute", "motion"), {}, static_cast<int>(motions.size()), 170};
  backlash::RelativeState state{0.5 * system.clearance(), 0};
  double before = motions.front().omega;
  for (const Motion& motion : motions) {
    for (int step = 1; step <= steps; ++step) {
      const double omega = before * std::pow(motion.omega / before, static_cast<double>(step) / steps);
      state = backlash::simulate_impacts(system, force, omega, state, settling_periods).end;
    }
    before = motion.omega;
    const auto history = backlash::time_history(system, force, motion.omega, state, drawn_periods, samples);
    std::vector<double> time, gap;
    for (const auto& row : history.rows) {
      time.push_back(row.time * motion.omega / (2 * std::numbers::pi));
      gap.push_back((row.x2 - row.x1) / system.clearance());
    }
    Panel panel{html_number(motion.omega, 2) + " rad/s" + (motion.name.empty() ? "" : ": " + motion.name),
                {"periods of the force", false, 0.0, static_cast<double>(drawn_periods)},
                {&motion == &motions.front() ? "place in the gap" : "", false, -0.05, 1.05}};
    panel.curves.push_back(make_curve("", category_colour(0), Mark::line, time, gap));
    figure.panels.push_back(std::move(panel));
  }
  return figure;
}

std::optional<PlotPoint> loss_place(const DescribingFunctionPoint& point) {
  const auto inverse = backlash::minus_inverse(point);
  if (!inverse || !(inverse->value.imag() > inverse->uncertainty)) return std::nullopt;
  const double loss = inverse->value.imag();
  return PlotPoint{point.omega, loss, std::max(loss - inverse->uncertainty, 0.01 * loss), loss + inverse->uncertainty};
}

// Im(-1/N) over frequency with the two exact laws and the static model.
Figure loss_figure(const Work& work, const Bands& bands) {
  const Scene& scene = work.scene;
  Panel panel{"Loss Im(−1/N)", {"ω in rad/s", true}, {"N/m", true}};
  panel.key = true;
  std::string label = "two masses, impacts";
  std::vector<double> grid;
  for (const DescribingFunctionSweep& sweep : bands.whole) {
    auto curves = sweep_curves(sweep, std::exchange(label, ""), category_colour(0), loss_place);
    std::move(curves.begin(), curves.end(), std::back_inserter(panel.curves));
    for (const auto& point : sweep.points) grid.push_back(point.omega);
  }
  const auto values =
      backlash::static_describing_function(scene.mass1, scene.mass2, scene.clearance, scene.force, grid);
  std::vector<double> omega, loss;
  for (std::size_t i = 0; i < grid.size(); ++i) {
    if (const auto inverse = backlash::minus_inverse(values[i], 0)) {
      omega.push_back(grid[i]);
      loss.push_back(inverse->value.imag());
    }
  }
  panel.curves.push_back(make_curve("static backlash", category_colour(1), Mark::dashed, omega, loss));
  const auto law = [&](const std::string& name, std::size_t colour, double from, double to, auto value) {
    panel.curves.push_back(
        make_curve(name, category_colour(colour), Mark::dotted, {from, to}, {value(from), value(to)}));
  };
  const auto first = loss_place(bands.whole.front().points.front());
  if (first && bands.whole.front().points.front().regime == backlash::Regime::chatter) {
    const auto asymptote = [&](double w) { return first->y * std::pow(w / first->x, 14.0 / 3); };
    law("ω^{14/3}, fractional", 2, first->x, bands.chatter.empty() ? 4 * first->x : 3 * bands.chatter.back().omega,
        asymptote);
    panel.x.from = scene.omega_bode.front();
    panel.y.from = asymptote(scene.omega_bode.front()) / 2;
  }
  if (!bands.two_impact.empty()) {
    const double level = backlash::symmetric_loss_factor(scene.restitution) * (scene.mass1 + scene.mass2);
    const double from = bands.two_impact.front().omega;
    law("ω^2, exact", 3, 0.2 * from, 1.5 * bands.whole.back().points.back().omega,
        [&](double w) { return level * w * w; });
    panel.y.to = 10 * level * std::pow(bands.whole.back().points.back().omega, 2);
  }
  return {"minute-loss", prose("minute", "loss", {{"scene", base_scene_text(scene)}}), {std::move(panel)}, 1, 330};
}

// All jumps on one line, and the cycle of a loop.
Figure jump_figure(const Work& work, const std::optional<double>& constant) {
  const Scene& scene = work.scene;
  Figure figure{"minute-jump",
                scene.of_the_paper ? prose("minute", "jump-and-loop-of-the-paper") : prose("minute", "jump-and-loop"),
                {},
                2,
                300};
  if (constant) {
    Panel panel{"Jump frequency ω_J in rad/s", {"√(F/(M_2Δ)) in rad/s", true}, {"", true}};
    const backlash::PublishedJumpLaw published;
    std::vector<double> scale, exact, printed;
    for (const double force : scene.jump_forces) {
      for (const double clearance : scene.jump_clearances) {
        scale.push_back(std::sqrt(force / (scene.mass2 * clearance)));
        exact.push_back(*constant * scale.back());
        printed.push_back(published.omega_jump(force, clearance));
      }
    }
    if (scene.of_the_paper)
      panel.curves.push_back(make_curve("", category_colour(1), Mark::open_points, scale, printed));
    panel.curves.push_back(make_curve("", category_colour(0), Mark::points, scale, exact));
    figure.panels.push_back(std::move(panel));
  }
  Figure loop = nyquist_figure(example_loop(work), "", "");
  loop.panels.front().title = "A loop around the masses";
  figure.panels.push_back(std::move(loop.panels.front()));
  return figure;
}

// Numbers that the chapters found.
class Facts {
 public:
  explicit Facts(const std::vector<Section>& chapters) : chapters_(chapters) {}

  [[nodiscard]] std::optional<double> operator()(std::string_view name) const {
    for (const Section& chapter : chapters_) {
      for (const auto& [key, cell] : chapter.facts) {
        const double* const number = std::get_if<double>(&cell);
        if (key == name && number != nullptr && std::isfinite(*number)) return *number;
      }
    }
    return std::nullopt;
  }

 private:
  const std::vector<Section>& chapters_;
};

std::string percent(double share) {
  return html_number(100 * share, 2) + " %";
}

std::string masses(const Scene& scene) {
  if (scene.mass1 == scene.mass2) return "Two masses of " + html_number(scene.mass1) + " kg";
  return "Masses of " + html_number(scene.mass1) + " kg and " + html_number(scene.mass2) + " kg";
}

std::string what_was_computed(const Scene& scene, const Facts& facts) {
  const double points = facts("curve_points").value_or(0);
  if (!(scene.clearance > 0))
    return prose("minute", "computed-rigid", {{"masses", masses(scene)}, {"points", html_number(points)}});
  return prose("minute", "computed",
               {{"masses", masses(scene)},
                {"clearance", html_number(scene.clearance)},
                {"force", html_number(scene.force)},
                {"points", html_number(points)},
                {"exact", percent(facts("curve_points_exact").value_or(0) / points)}});
}

// "3 parameters"
std::string parameters(double count) {
  return html_number(count) + (count == 1 ? " parameter" : " parameters");
}

std::string what_is_fractional(const Facts& facts, const Bands& bands) {
  const auto slope = facts("lowest_local_slope_minus-inverse"), omega = facts("lowest_local_slope_omega");
  if (!slope || !omega) return prose("minute", "fractional-absent");
  const auto fractional = facts("fractional_parameters_chatter_minus-inverse"),
             whole = facts("whole_parameters_chatter_minus-inverse");
  std::string price;
  if (fractional && whole && *fractional < *whole) {
    price = prose("minute", "fractional-shorter",
                  {{"from", html_number(bands.chatter.front().omega, 3)},
                   {"to", html_number(bands.chatter.back().omega, 3)},
                   {"fractional", parameters(*fractional)},
                   {"whole", html_number(*whole)}});
  }
  return prose("minute", "fractional",
               {{"slope", html_number(*slope, 4)}, {"omega", html_number(*omega, 2)}, {"price", price}});
}

std::string what_is_not(const Scene& scene, const Facts& facts) {
  const auto points = facts("loss_factor_points"), spread = facts("loss_factor_spread");
  if (!points || !spread) return prose("minute", "whole-absent");
  const auto first = facts("first_slope_two-impact"), last = facts("last_slope_two-impact");
  std::string artefact;
  if (first && last)
    artefact = prose("minute", "artefact", {{"first", html_number(*first, 2)}, {"last", html_number(*last, 2)}});
  const double factor = backlash::symmetric_loss_factor(scene.restitution) * (scene.mass1 + scene.mass2);
  return prose("minute", "whole",
               {{"factor", html_number(factor)},
                {"points", html_number(*points)},
                {"spread", html_number(*spread, 2)},
                {"artefact", artefact}});
}

std::string what_static_misses(const Work& work, const Facts& facts) {
  const Scene& scene = work.scene;
  std::string error, upper;
  if (const auto found = facts("static_error_chatter_minus-inverse"))
    error = prose("minute", "static-error", {{"error", percent(*found)}});
  if (const auto end = backlash::jump_frequency(work.system(), scene.force, JumpCriterion::saddle_node))
    upper = prose("minute", "static-upper", {{"omega", html_number(*end, 3)}});
  const double standstill = std::sqrt(2 * scene.force / ((scene.mass1 + scene.mass2) * scene.clearance));
  return prose("minute", "static", {{"error", error}, {"standstill", html_number(standstill, 3)}, {"upper", upper}});
}

std::string what_jumps(const Scene& scene, const Facts& facts) {
  const auto constant = facts("similarity_constant");
  if (!constant) return prose("minute", "jump-absent", {{"restitution", html_number(scene.restitution)}});
  return prose("minute", "jump",
               {{"constant", html_number(*constant)},
                {"omega", html_number(*constant * std::sqrt(scene.force / (scene.mass2 * scene.clearance)), 3)},
                {"published", scene.of_the_paper ? prose("minute", "jump-published") : std::string()}});
}

std::string what_a_controller_meets(const Facts& facts) {
  const auto exact = facts("limit_cycle_omega"), predicted = facts("limit_cycle_omega_predicted");
  if (!exact || !predicted) return prose("minute", "controller-without-cycle");
  return prose("minute", "controller",
               {{"exact", html_number(*exact, 3)},
                {"predicted", html_number(*predicted, 3)},
                {"percent", percent(std::abs(*predicted / *exact - 1))}});
}

}  // namespace

Section minute_section(const Work& work, const Bands& bands) {
  Section section;
  section.id = "minute";
  section.title = prose("minute", "title");
  if (!(work.scene.clearance > 0)) return section;
  section.add(motion_figure(work, bands));
  if (!bands.whole.empty()) section.add(loss_figure(work, bands));
  section.add(jump_figure(
      work,
      backlash::jump_similarity_constant(work.scene.restitution, JumpCriterion::two_impact_loss).similarity_constant));
  return section;
}

void add_sentences(Section& minute, const Work& work, const Bands& bands, const std::vector<Section>& chapters) {
  const Scene& scene = work.scene;
  const Facts facts(chapters);
  const auto add = [](std::vector<Block>& blocks, const std::string& sentence) {
    blocks.emplace_back(Html{"<p>" + sentence + "</p>"});
  };
  std::vector<Block> blocks;
  auto picture = minute.blocks.begin();
  const auto add_picture = [&](std::string_view name) {
    if (picture != minute.blocks.end() && std::get<Figure>(*picture).name == name)
      blocks.push_back(std::move(*picture++));
  };
  add(blocks, what_was_computed(scene, facts));
  if (scene.clearance > 0) {
    add_picture("minute-motion");
    if (scene.restitution < 1) {
      add(blocks, what_is_fractional(facts, bands));
      add(blocks, what_is_not(scene, facts));
      add(blocks, what_static_misses(work, facts));
    } else {
      add(blocks, prose("minute", "lossless"));
    }
    add_picture("minute-loss");
    add(blocks, what_jumps(scene, facts));
    add(blocks, what_a_controller_meets(facts));
    add_picture("minute-jump");
  }
  minute.blocks = std::move(blocks);
}

}  // namespace report
