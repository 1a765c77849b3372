// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "backlash/identification/jump_law.hpp"
#include "backlash/jump_frequency.hpp"
#include "io/number.hpp"
#include "report/fixed_step_jump.hpp"
#include "report/grid.hpp"
#include "report/html.hpp"
#include "report/jump_constants.hpp"
#include "report/prose.hpp"
#include "report/sections.hpp"

namespace report {

namespace {

using backlash::JumpCriterion;
using backlash::JumpLaw;

constexpr double none = std::numeric_limits<double>::quiet_NaN();

// Mean over restitution at each force, for one clearance: the average of the paper.
std::map<double, double> mean_over_restitution(const JumpLaw& law, double clearance) {
  std::map<double, std::pair<double, int>> sums;
  for (const auto& point : law.points) {
    if (point.clearance != clearance || !point.omega_jump) continue;
    auto& [sum, count] = sums[point.force];
    sum += *point.omega_jump;
    ++count;
  }
  std::map<double, double> means;
  for (const auto& [force, sum] : sums) means[force] = sum.first / sum.second;
  return means;
}

Figure force_figure(const Scene& scene, const JumpLaw& law) {
  Panel panel{"Jump frequency against force", {"F in N", true}, {"ω_J in rad/s", true}};
  panel.key = true;
  for (std::size_t i = 0; i < law.laws.size(); ++i) {
    const double clearance = law.laws[i].clearance;
    const std::string colour = family_colour(i, law.laws.size());
    std::vector<double> force, omega, fitted;
    for (const auto& [f, w] : mean_over_restitution(law, clearance)) {
      force.push_back(f);
      omega.push_back(w);
      fitted.push_back(law.laws[i].law(f));
    }
    panel.curves.push_back(make_curve("Δ = " + io::format_number(clearance) + " m", colour, Mark::line, force, fitted));
    panel.curves.push_back(make_curve("", colour, Mark::points, force, omega));
  }
  return {
      "fig9-jump-frequency",
      numbered_caption(
          scene, 9, prose("jumps", "force-figure", {{"restitutions", std::to_string(scene.jump_restitutions.size())}})),
      {std::move(panel)},
      1,
      400};
}

double similarity_coefficient(const Scene& scene, const JumpLaw& law, double clearance) {
  return law.mean_similarity_constant / std::sqrt(clearance * scene.mass2);
}

Figure clearance_figure(const Scene& scene, const JumpLaw& law) {
  const backlash::PublishedJumpLaw published;
  const double from = law.laws.front().clearance;
  const double to = law.laws.back().clearance;
  const std::vector<double> grid = logarithmic_grid(std::min(from, to), std::max(from, to), 60);
  std::vector<double> clearance, a, b, a_fit, a_published, a_similar, b_fit, b_published;
  for (const auto& entry : law.laws) {
    clearance.push_back(entry.clearance);
    a.push_back(entry.law.coefficient);
    b.push_back(entry.law.exponent);
  }
  for (const double x : grid) {
    a_fit.push_back(law.a_of_clearance(x));
    b_fit.push_back(law.b_of_clearance(x));
    a_similar.push_back(similarity_coefficient(scene, law, x));
    a_published.push_back(published.a_coefficient * std::pow(x, published.a_exponent));
    b_published.push_back(published.b_coefficient * std::pow(x, published.b_exponent));
  }
  Panel coefficient, exponent;
  coefficient.title = "Coefficient a(Δ)";
  coefficient.x = exponent.x = {"Δ in m", true};
  coefficient.y = {"a in rad s^{-1} N^{-b}", true};
  exponent.title = "Exponent b(Δ)";
  exponent.y = {"b", false, 0.44, 0.6};
  exponent.key = true;
  coefficient.curves = {make_curve("", category_colour(1), Mark::line, grid, a_published),
                        make_curve("", "#222222", Mark::line, grid, a_similar),
                        make_curve("", category_colour(5), Mark::dashed, grid, a_fit),
                        make_curve("", category_colour(0), Mark::points, clearance, a)};
  exponent.curves = {
      make_curve("published (8)", category_colour(1), Mark::line, grid, b_published),
      make_curve("similarity, exact", "#222222", Mark::line, grid, std::vector<double>(grid.size(), 0.5)),
      make_curve("power law fitted to ours", category_colour(5), Mark::dashed, grid, b_fit),
      make_curve("ours, per clearance", category_colour(0), Mark::points, clearance, b)};
  return {"fig10-jump-law",
          numbered_caption(scene, 10, prose("jumps", "clearance-figure")),
          {std::move(coefficient), std::move(exponent)},
          2,
          340};
}

Table law_table(const Scene& scene, const JumpLaw& law) {
  const backlash::PublishedJumpLaw published;
  Table table{"jump-laws",
              prose("jumps", "laws", {{"force", html_number(scene.force)}}),
              {{"clearance_m", "Δ / m"},
               {"a", "a, ours", 5},
               {"b", "b, ours", 5},
               {"b_ci95_lower", "95 % from", 5, false},
               {"b_ci95_upper", "to", 5, false},
               {"a_published", "a, published"},
               {"b_published", "b, published"},
               {"a_similarity", "a, similarity", 5},
               {"b_similarity", "b, similarity"},
               {"omega_jump_rad_s", "ω<sub>J</sub>, ours / (rad/s)"},
               {"omega_jump_published_rad_s", "ω<sub>J</sub>, published / (rad/s)"}}};
  for (const auto& entry : law.laws) {
    table.rows.push_back({entry.clearance, entry.law.coefficient, entry.law.exponent, entry.law.exponent_ci95_lower,
                          entry.law.exponent_ci95_upper,
                          published.a_coefficient * std::pow(entry.clearance, published.a_exponent),
                          published.b_coefficient * std::pow(entry.clearance, published.b_exponent),
                          similarity_coefficient(scene, law, entry.clearance), 0.5, entry.law(scene.force),
                          published.omega_jump(scene.force, entry.clearance)});
  }
  return table;
}

Table clearance_table(const Scene& scene, const JumpLaw& law) {
  const backlash::PublishedJumpLaw published;
  Table table{"jump-law-of-clearance",
              prose("jumps", "laws-of-clearance"),
              {{"quantity", "quantity"},
               {"source", "source"},
               {"coefficient", "coefficient", 5},
               {"coefficient_ci95_lower", "95 % from", 5, false},
               {"coefficient_ci95_upper", "to", 5, false},
               {"exponent", "exponent", 5, true, false, 1e-12},
               {"exponent_ci95_lower", "95 % from", 5, false, false, 1e-12},
               {"exponent_ci95_upper", "to", 5, false, false, 1e-12}}};
  const auto ours = [&table](const std::string& quantity, const frac::PowerLaw& fitted) {
    table.rows.push_back({quantity, std::string("ours"), fitted.coefficient, fitted.coefficient_ci95_lower,
                          fitted.coefficient_ci95_upper, fitted.exponent, fitted.exponent_ci95_lower,
                          fitted.exponent_ci95_upper});
  };
  const auto other = [&table](const std::string& quantity, const std::string& source, double coefficient,
                              double exponent) {
    table.rows.push_back({quantity, source, coefficient, none, none, exponent, none, none});
  };
  ours("a", law.a_of_clearance);
  other("a", "published", published.a_coefficient, published.a_exponent);
  other("a", "similarity, exact", law.mean_similarity_constant / std::sqrt(scene.mass2), -0.5);
  ours("b", law.b_of_clearance);
  other("b", "published", published.b_coefficient, published.b_exponent);
  other("b", "similarity, exact", 0.5, 0);
  return table;
}

struct CriterionText {
  JumpCriterion criterion;
  std::string meaning;
};

const std::vector<CriterionText>& criteria() {
  static const std::vector<CriterionText> all = {
      {JumpCriterion::two_impact_loss, "two-impact orbit ends, seen with ω falling"},
      {JumpCriterion::symmetry_loss, "symmetric orbit ends (pitchfork)"},
      {JumpCriterion::saddle_node, "impacting motion collapses, ω rising"},
      {JumpCriterion::contact_at_rest, "start in contact at rest: equation (6)"},
      {JumpCriterion::mid_gap_at_rest, "start at mid-gap at rest"},
      {JumpCriterion::sweep_up, "visible jump of a sweep with ω rising"},
      {JumpCriterion::sweep_down, "visible jump of a sweep with ω falling"},
  };
  return all;
}

struct Constants {
  Table table;
  std::map<JumpCriterion, double> mean;
};

Constants constants_table(const Work& work) {
  std::vector<double> restitutions = {0, 0.2, 0.4, 0.6, 0.8, 0.95, 1};
  if (!work.scene.of_the_paper) restitutions = work.scene.restitutions;
  Constants result;
  Table& table = result.table;
  table.name = "jump-constants";
  table.caption = prose("jumps", "constants");
  table.columns = {{"criterion", "criterion"}, {"meaning", "what it marks"}};
  for (const double restitution : restitutions) {
    const std::string value = io::format_number(restitution);
    table.columns.push_back({"c_at_restitution_" + value, "ε = " + value, 5});
  }
  table.columns.push_back({"mean", "mean", 5});
  for (const auto& [criterion, meaning] : criteria()) {
    const std::vector<double> constants = jump_constants(criterion, restitutions, work.threads);
    const double mean = mean_of(constants).value;
    std::vector<Cell> row = {std::string(backlash::to_string(criterion)), meaning};
    row.insert(row.end(), constants.begin(), constants.end());
    row.emplace_back(mean);
    result.mean[criterion] = mean;
    table.rows.push_back(std::move(row));
  }
  return result;
}

struct PublishedRange {
  double lowest, highest, mean;
};

PublishedRange published_constants(const Scene& scene) {
  const backlash::PublishedJumpLaw published;
  double lowest = std::numeric_limits<double>::infinity();
  double highest = 0, sum = 0;
  for (const double force : scene.jump_forces) {
    for (const double clearance : scene.jump_clearances) {
      const double c = published.omega_jump(force, clearance) / std::sqrt(force / (scene.mass2 * clearance));
      lowest = std::min(lowest, c);
      highest = std::max(highest, c);
      sum += c;
    }
  }
  return {lowest, highest, sum / static_cast<double>(scene.jump_forces.size() * scene.jump_clearances.size())};
}

Table discontinuity_table(const Scene& scene, const Family& family) {
  Table table{"discontinuities",
              prose("jumps", "discontinuities"),
              {{"restitution", "ε"},
               {"rank", "rank"},
               {"omega_lower_rad_s", "bracket from / (rad/s)", 5},
               {"omega_upper_rad_s", "to / (rad/s)", 5},
               {"omega_rad_s", "ω<sub>J</sub> / (rad/s)", 5},
               {"similarity_constant", "c", 4},
               {"size", "relative size of the step", 3}}};
  for (const auto& sweep : family.sweeps) {
    if (sweep.system.clearance() == 0) continue;
    std::vector<double> uncertainty;
    for (const auto& point : sweep.points) uncertainty.push_back(point.uncertainty);
    const auto found = backlash::find_discontinuities(sweep.data(), uncertainty);
    const double scale = std::sqrt(sweep.force_amplitude / (scene.mass2 * sweep.system.clearance()));
    for (std::size_t i = 0; i < std::min<std::size_t>(found.size(), 3); ++i) {
      table.rows.push_back({sweep.system.restitution(), static_cast<double>(i + 1), found[i].omega_lower,
                            found[i].omega_upper, found[i].omega, found[i].omega / scale, found[i].size});
    }
    if (found.empty()) table.rows.push_back({sweep.system.restitution(), 0.0, none, none, none, none, none});
  }
  return table;
}

Table fixed_step_table(const Scene& scene, const PublishedRange& range, int threads) {
  const backlash::PublishedJumpLaw published;
  Table table = fixed_step_jumps(scene.jump_forces, scene.jump_clearances, threads);
  const auto b = [&published](double clearance) {
    return published.b_coefficient * std::pow(clearance, published.b_exponent);
  };
  const auto [smallest, largest] = std::minmax_element(scene.jump_clearances.begin(), scene.jump_clearances.end());
  table.rows.push_back({std::string("published law"), range.lowest, range.highest, published.a_coefficient,
                        published.a_exponent, b(*smallest), b(*largest)});
  return table;
}

}  // namespace

Section jump_section(const Work& work, const Curves& curves) {
  const Scene& scene = work.scene;
  Section section = open_section("jumps");
  const Constants constants = constants_table(work);
  const PublishedRange published = published_constants(scene);
  const bool has_grid = scene.jump_forces.size() >= 2 && scene.jump_clearances.size() >= 2;
  if (has_grid) {
    const JumpLaw law =
        backlash::fit_jump_law(scene.mass1, scene.mass2, scene.jump_forces, scene.jump_clearances,
                               scene.jump_restitutions, JumpCriterion::two_impact_loss, work.threads, work.progress);
    section.add(force_figure(scene, law));
    section.add(clearance_figure(scene, law));
    section.add(law_table(scene, law));
    section.add(clearance_table(scene, law));
    section.fact("a_coefficient", law.a_of_clearance.coefficient);
    section.fact("a_exponent", law.a_of_clearance.exponent);
    section.fact("b_coefficient", law.b_of_clearance.coefficient);
    section.fact("b_exponent", law.b_of_clearance.exponent);
    section.fact("mean_similarity_constant", law.mean_similarity_constant);
  } else {
    section.add(Html{paragraph("jumps", "too-few",
                               {{"forces", std::to_string(scene.jump_forces.size())},
                                {"clearances", std::to_string(scene.jump_clearances.size())}})});
  }
  if (const auto c =
          backlash::jump_similarity_constant(scene.restitution, JumpCriterion::two_impact_loss).similarity_constant)
    section.fact("similarity_constant", *c);
  section.add(constants.table);
  if (scene.clearance > 0) section.add(discontinuity_table(scene, curves.restitutions));
  if (has_grid && scene.of_the_paper) section.add(fixed_step_table(scene, published, work.threads));
  const auto mean_constant = [&constants](JumpCriterion criterion) {
    return html_number(constants.mean.at(criterion));
  };
  section.add(Html{prose("jumps", "difference-heading")});
  section.add(paragraph("jumps", "difference",
                        {{"lowest", html_number(published.lowest)},
                         {"highest", html_number(published.highest)},
                         {"mean", html_number(published.mean)},
                         {"two_impact_loss", mean_constant(JumpCriterion::two_impact_loss)},
                         {"symmetry_loss", mean_constant(JumpCriterion::symmetry_loss)}}));
  section.add(
      paragraph("jumps", "further-scale",
                {{"measured", scene.of_the_paper ? " " + prose("jumps", "fixed-step-effect") : std::string()}}));
  section.fact("published_similarity_constant_mean", published.mean);
  for (const auto& [criterion, mean] : constants.mean) {
    section.fact("mean_constant_" + std::string(backlash::to_string(criterion)), mean);
  }
  return section;
}

}  // namespace report
