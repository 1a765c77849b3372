// SPDX-License-Identifier: BSD-3-Clause
#include "jump_law_output.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "aligned_table.hpp"
#include "io/csv_line.hpp"
#include "io/number.hpp"
#include "io/sweep_file.hpp"

namespace fracfit {
namespace {

frac::PowerLaw power_law(double coefficient, double exponent) {
  frac::PowerLaw law{};
  law.coefficient = coefficient;
  law.exponent = exponent;
  return law;
}

std::string with_interval(double value, double lower, double upper) {
  return short_number(value) + " [" + short_number(lower) + ", " + short_number(upper) + "]";
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

std::string formula(const char* name, const frac::PowerLaw& law) {
  return std::string(name) + " = " +
         with_interval(law.coefficient, law.coefficient_ci95_lower, law.coefficient_ci95_upper) + " Delta^" +
         with_interval(without_rounding_noise(law.exponent), without_rounding_noise(law.exponent_ci95_lower),
                       without_rounding_noise(law.exponent_ci95_upper));
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
  std::string text = "# fracfit: " + std::string(io::version()) + "\n# command: " + command +
                     "\n# criterion: " + std::string(backlash::to_string(grid.criterion)) +
                     "\n# averaged: " + std::to_string(averaged_count(grid)) +
                     "\n# left_out: " + std::to_string(grid.constants.size() - averaged_count(grid)) +
                     "\n# mean_similarity_constant: " + io::format_number(grid.mean_similarity_constant) +
                     "\nrestitution,similarity_constant,meaning\n";
  for (const auto& [restitution, constant, message] : grid.constants)
    text += io::format_number(restitution) + "," + (constant ? io::format_number(*constant) : "nan") + "," +
            io::csv_field(message) + "\n";
  return text;
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
                std::string(backlash::to_string(law.criterion)) + ", averaged over restitution") +
      "\n";
  AlignedTable table({"Delta/m", "a", "b", "R^2", "a paper", "", "b paper", "", "a exact", ""});
  for (const auto& [clearance, force_law] : law.laws)
    table.add({short_number(clearance), short_number(force_law.coefficient), short_number(force_law.exponent),
               short_number(force_law.r_squared), short_number(published_a(clearance)),
               percent(force_law.coefficient, published_a(clearance)), short_number(published_b(clearance)),
               percent(force_law.exponent, published_b(clearance)), short_number(similarity_a(clearance)),
               percent(force_law.coefficient, similarity_a(clearance))});
  text += table.text() + "\nwith 95 % intervals:\n  " + formula("a", law.a_of_clearance) + "\n  " +
          formula("b", law.b_of_clearance) + "\n";
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
  std::string text = "# fracfit: " + std::string(io::version()) + "\n# command: " + run.command +
                     "\n# mass1_kg: " + io::format_number(run.mass1) + "\n# mass2_kg: " + io::format_number(run.mass2) +
                     "\n# criterion: " + std::string(backlash::to_string(law.criterion)) + "\n";
  const auto entry = [&](const char* key, double value) {
    text += std::string("# ") + key + ": " + io::format_number(value) + "\n";
  };
  entry("a_coefficient", law.a_of_clearance.coefficient);
  entry("a_exponent", law.a_of_clearance.exponent);
  entry("b_coefficient", law.b_of_clearance.coefficient);
  entry("b_exponent", law.b_of_clearance.exponent);
  entry("mean_similarity_constant", law.mean_similarity_constant);
  text += "force_n,clearance_m,restitution,omega_jump_rad_s\n";
  for (const auto& point : law.points)
    text += io::format_number(point.force) + "," + io::format_number(point.clearance) + "," +
            io::format_number(point.restitution) + "," +
            (point.omega_jump ? io::format_number(*point.omega_jump) : "nan") + "\n";
  return text;
}

}  // namespace fracfit
