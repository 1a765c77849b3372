// SPDX-License-Identifier: BSD-3-Clause
#include "output/jump_law_output.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <utility>

#include "io/number.hpp"
#include "output/aligned_table.hpp"
#include "output/document.hpp"
#include "output/json.hpp"
#include "output/sweep_output.hpp"

namespace fracfit {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

frac::PowerLaw power_law(double coefficient, double exponent) {
  frac::PowerLaw law{};
  law.coefficient = coefficient;
  law.exponent = exponent;
  return law;
}

// Six decimals: where the law is exact, what remains is rounding.
double without_rounding_noise(double value) {
  return std::round(value * 1e6) / 1e6 + 0.0;
}

std::string percent(double value, double reference) {
  char text[32];
  std::snprintf(text, sizeof text, "%+.1f%%", without_rounding_noise(percent_difference(value, reference)));
  return text;
}

std::string formula(const frac::PowerLaw& law) {
  return short_number(law.coefficient) + " Delta^" + short_number(without_rounding_noise(law.exponent));
}

Json power_law_json(const frac::PowerLaw& law) {
  return {{"coefficient", law.coefficient},
          {"exponent", law.exponent},
          {"coefficient_ci95", {law.coefficient_ci95_lower, law.coefficient_ci95_upper}},
          {"exponent_ci95", {law.exponent_ci95_lower, law.exponent_ci95_upper}},
          {"r_squared", law.r_squared}};
}

Json laws_json(double a_coefficient, double a_exponent, double b_coefficient, double b_exponent) {
  return {{"a_of_clearance", {{"coefficient", a_coefficient}, {"exponent", a_exponent}}},
          {"b_of_clearance", {{"coefficient", b_coefficient}, {"exponent", b_exponent}}}};
}

std::string friction_words(const backlash::CoulombFriction& friction) {
  if (friction.body1 == 0 && friction.body2 == 0) return {};
  return "; dry friction " + short_number(friction.body1) + " N on M1, " + short_number(friction.body2) + " N on M2";
}

io::Metadata scene_entries(const JumpLawRun& run, backlash::JumpCriterion criterion) {
  io::Metadata entries{{"mass1_kg", io::format_number(run.mass1)}, {"mass2_kg", io::format_number(run.mass2)}};
  if (!run.contacts.empty())
    for (auto& entry : friction_entries(run.friction)) entries.push_back(std::move(entry));
  entries.emplace_back("criterion", std::string(backlash::to_string(criterion)));
  return entries;
}

Json constants_json(const backlash::JumpGrid& grid) {
  return Json::list(grid.constants, [](const auto& constant) {
    return Json{{"restitution", constant.restitution},
                {"similarity_constant", constant.similarity_constant},
                {"averaged", constant.similarity_constant.has_value()},
                {"meaning", constant.message}};
  });
}

}  // namespace

SimilarityLaw similarity_law(const JumpLawRun& run, const backlash::JumpLaw& law) {
  return {law.mean_similarity_constant / std::sqrt(run.mass2), -0.5, 0.5, 0};
}

double percent_difference(double value, double reference) {
  return 100 * (value / reference - 1);
}

std::size_t averaged_count(const backlash::JumpGrid& grid) {
  return static_cast<std::size_t>(std::count_if(grid.constants.begin(), grid.constants.end(), [](const auto& constant) {
    return constant.similarity_constant.has_value();
  }));
}

std::string jump_constants_table(const backlash::JumpGrid& grid) {
  std::string text =
      "c = w_J / sqrt(F/(M2 Delta)), criterion " + std::string(backlash::to_string(grid.criterion)) + "\n\n";
  AlignedTable table({"restitution", "c", "what happens there"}, AlignedTable::Last::remark);
  for (const auto& [restitution, constant, message] : grid.constants)
    table.add({short_number(restitution), constant ? io::format_number(*constant) : "none", message});
  return text + table.text() + "\nmean over " + std::to_string(averaged_count(grid)) + " of " +
         std::to_string(grid.constants.size()) + " restitutions: " + short_number(grid.mean_similarity_constant) + "\n";
}

std::string jump_constants_csv(const std::string& command, const backlash::JumpGrid& grid) {
  const auto fill = [&](std::size_t i, std::vector<Cell>& cells) {
    const auto& [restitution, constant, message] = grid.constants[i];
    cells.emplace_back(restitution);
    cells.emplace_back(constant.value_or(nan));
    cells.emplace_back(message);
  };
  return text_of({{{"criterion", std::string(backlash::to_string(grid.criterion))},
                   {"averaged", std::to_string(averaged_count(grid))},
                   {"left_out", std::to_string(grid.constants.size() - averaged_count(grid))},
                   {"mean_similarity_constant", io::format_number(grid.mean_similarity_constant)}},
                  {{"restitution", "similarity_constant", "meaning"}, grid.constants.size(), fill}},
                 "csv", command);
}

std::string contact_jumps_text(const JumpLawRun& run, backlash::JumpCriterion criterion,
                               const std::vector<ContactJump>& jumps, const std::string& format) {
  const auto fill = [&](std::size_t i, std::vector<Cell>& cells) {
    const auto& [force, clearance, contact, jump] = jumps[i];
    for (const double value : {force, clearance, contact[0], contact[1], jump.stiffness_group,
                               jump.similarity_constant.value_or(nan), jump.exponent, jump.clearance_exponent})
      cells.emplace_back(value);
    cells.emplace_back(jump.message);
  };
  return text_of({scene_entries(run, criterion),
                  {{"force_n", "clearance_m", run.contact_columns[0], run.contact_columns[1], "stiffness_group",
                    "similarity_constant", "exponent", "clearance_exponent", "meaning"},
                   jumps.size(),
                   fill}},
                 format, run.command);
}

std::string jump_law_table(const JumpLawRun& run, const backlash::JumpLaw& law) {
  const backlash::PublishedJumpLaw published;
  const auto published_a = power_law(published.a_coefficient, published.a_exponent);
  const auto published_b = power_law(published.b_coefficient, published.b_exponent);
  const SimilarityLaw similarity = similarity_law(run, law);
  const auto similarity_a = power_law(similarity.a_coefficient, similarity.a_exponent);

  std::string text =
      paragraph("jump frequency w_J = a F^b (rad/s; F in N, Delta in m), M1 = " + short_number(run.mass1) +
                " kg, M2 = " + short_number(run.mass2) + " kg, criterion " +
                std::string(backlash::to_string(law.criterion)) + ", averaged over " +
                (run.contacts.empty() ? "restitution" : "contacts") + friction_words(run.friction)) +
      "\n";
  AlignedTable table({"Delta/m", "a", "b", "R^2", "a paper", "", "b paper", "", "a exact", ""});
  for (const auto& [clearance, force_law] : law.laws)
    table.add({short_number(clearance), short_number(force_law.coefficient), short_number(force_law.exponent),
               short_number(force_law.r_squared), short_number(published_a(clearance)),
               percent(force_law.coefficient, published_a(clearance)), short_number(published_b(clearance)),
               percent(force_law.exponent, published_b(clearance)), short_number(similarity_a(clearance)),
               percent(force_law.coefficient, similarity_a(clearance))});
  text +=
      table.text() + "\nfitted:\n  a = " + formula(law.a_of_clearance) + ",  b = " + formula(law.b_of_clearance) + "\n";
  text += "paper (Duarte, Tenreiro Machado 2009, eq. 8):\n  a = " + short_number(published.a_coefficient) + " Delta^" +
          short_number(published.a_exponent) + ",  b = " + short_number(published.b_coefficient) + " Delta^" +
          short_number(published.b_exponent) + "\n";
  text += "exact (similarity of the ideal model):\n  a = " + short_number(similarity.a_coefficient) +
          " Delta^-0.5,  b = 0.5\n";
  for (const auto& [restitution, constant, message] : law.constants)
    if (!constant)
      text += paragraph("restitution " + short_number(restitution) + " is left out of the averages: " + message, 2);
  return text;
}

std::string jump_law_csv(const JumpLawRun& run, const backlash::JumpLaw& law) {
  const auto fill = [&](std::size_t i, std::vector<Cell>& cells) {
    const auto& point = law.points[i];
    for (const double value : {point.force, point.clearance, point.restitution, point.omega_jump.value_or(nan)})
      cells.emplace_back(value);
    if (run.contacts.empty()) return;
    for (const double value : run.contacts[i % run.contacts.size()]) cells.emplace_back(value);
  };
  std::vector<std::string> columns{"force_n", "clearance_m", "restitution", "omega_jump_rad_s"};
  if (!run.contacts.empty()) columns.insert(columns.end(), run.contact_columns.begin(), run.contact_columns.end());
  io::Metadata head = scene_entries(run, law.criterion);
  for (const auto& [key, value] : {std::pair{"a_coefficient", law.a_of_clearance.coefficient},
                                   std::pair{"a_exponent", law.a_of_clearance.exponent},
                                   std::pair{"b_coefficient", law.b_of_clearance.coefficient},
                                   std::pair{"b_exponent", law.b_of_clearance.exponent},
                                   std::pair{"mean_similarity_constant", law.mean_similarity_constant}})
    head.emplace_back(key, io::format_number(value));
  return text_of({std::move(head), {std::move(columns), law.points.size(), fill}}, "csv", run.command);
}

std::string jump_constants_json(const std::string& command, const backlash::JumpGrid& grid) {
  Json json = origin(command);
  json["criterion"] = backlash::to_string(grid.criterion);
  json["mean_similarity_constant"] = grid.mean_similarity_constant;
  json["averaged"] = averaged_count(grid);
  json["left_out"] = grid.constants.size() - averaged_count(grid);
  json["constants"] = constants_json(grid);
  return json.dump() + "\n";
}

std::string jump_law_json(const JumpLawRun& run, const backlash::JumpLaw& law) {
  Json json = origin(run.command);
  json["scene"] = {{"mass1_kg", run.mass1}, {"mass2_kg", run.mass2}, {"criterion", backlash::to_string(law.criterion)}};
  if (!run.contacts.empty()) {
    json["scene"]["friction1_n"] = run.friction.body1;
    json["scene"]["friction2_n"] = run.friction.body2;
  }
  json["criterion"] = backlash::to_string(law.criterion);
  json["mean_similarity_constant"] = law.mean_similarity_constant;
  // Names with units, as in every other output, beside those without, which older readers know.
  json["points"] = Json::list(law.points, [&](const auto& point) {
    Json each{{"force", point.force},
              {"clearance", point.clearance},
              {"restitution", point.restitution},
              {"omega_jump", point.omega_jump},
              {"force_n", point.force},
              {"clearance_m", point.clearance},
              {"omega_jump_rad_s", point.omega_jump}};
    if (run.contacts.empty()) return each;
    const auto at = static_cast<std::size_t>(&point - law.points.data()) % run.contacts.size();
    for (std::size_t k = 0; k < 2; ++k) each[run.contact_columns[k]] = run.contacts[at][k];
    return each;
  });
  json["constants"] = constants_json(law);
  json["averaged"] = averaged_count(law);
  json["left_out"] = law.constants.size() - averaged_count(law);
  if (!law.message.empty()) json["message"] = law.message;
  json["laws"] = Json::list(law.laws, [](const auto& entry) {
    const auto& [clearance, force_law] = entry;
    return Json{{"clearance", clearance},
                {"clearance_m", clearance},
                {"a", force_law.coefficient},
                {"b", force_law.exponent},
                {"a_ci95", {force_law.coefficient_ci95_lower, force_law.coefficient_ci95_upper}},
                {"b_ci95", {force_law.exponent_ci95_lower, force_law.exponent_ci95_upper}},
                {"r_squared", force_law.r_squared}};
  });
  json["a_of_clearance"] = power_law_json(law.a_of_clearance);
  json["b_of_clearance"] = power_law_json(law.b_of_clearance);

  const auto differences = [&](double a_coefficient, double a_exponent, double b_coefficient) {
    return Json{{"a_coefficient", percent_difference(law.a_of_clearance.coefficient, a_coefficient)},
                {"a_exponent", percent_difference(law.a_of_clearance.exponent, a_exponent)},
                {"b_coefficient", percent_difference(law.b_of_clearance.coefficient, b_coefficient)}};
  };
  const backlash::PublishedJumpLaw published;
  json["published"] =
      laws_json(published.a_coefficient, published.a_exponent, published.b_coefficient, published.b_exponent);
  json["published"]["source"] = "Duarte, Tenreiro Machado (2009), eq. (8), masses 1 kg";
  json["published"]["difference_percent"] =
      differences(published.a_coefficient, published.a_exponent, published.b_coefficient);
  json["published"]["b_exponent_difference"] = law.b_of_clearance.exponent - published.b_exponent;
  const SimilarityLaw similarity = similarity_law(run, law);
  json["similarity"] =
      laws_json(similarity.a_coefficient, similarity.a_exponent, similarity.b_coefficient, similarity.b_exponent);
  json["similarity"]["mean_constant"] = law.mean_similarity_constant;
  json["similarity"]["difference_percent"] =
      differences(similarity.a_coefficient, similarity.a_exponent, similarity.b_coefficient);
  json["similarity"]["b_exponent_difference"] = law.b_of_clearance.exponent - similarity.b_exponent;
  return json.dump() + "\n";
}

}  // namespace fracfit
