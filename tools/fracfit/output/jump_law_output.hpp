// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "backlash/compliant/compliant_jump.hpp"
#include "backlash/identification/jump_law.hpp"

namespace fracfit {

/// What a jump law was made from.
struct JumpLawRun {
  std::string command;
  double mass1, mass2;  // kg
  /// Of contacts that take time the names and values of the two options that give them, in the order of the points; of
  /// others none.
  std::array<std::string, 2> contact_columns{};
  std::vector<std::array<double, 2>> contacts{};
  backlash::CoulombFriction friction{};
};

/// The similarity law a = c (Delta M2)^-1/2, b = 1/2 at mean c.
struct SimilarityLaw {
  double a_coefficient, a_exponent, b_coefficient, b_exponent;
};
[[nodiscard]] SimilarityLaw similarity_law(const JumpLawRun& run, const backlash::JumpLaw& law);

/// 100 (value/reference - 1).
[[nodiscard]] double percent_difference(double value, double reference);

/// Restitutions that have a jump and enter the averages.
[[nodiscard]] std::size_t averaged_count(const backlash::JumpGrid& grid);

/// c over restitution, with what happens at each jump or why there is none.
[[nodiscard]] std::string jump_constants_table(const backlash::JumpGrid& grid);
[[nodiscard]] std::string jump_constants_csv(const std::string& command, const backlash::JumpGrid& grid);
[[nodiscard]] std::string jump_constants_json(const std::string& command, const backlash::JumpGrid& grid);

/// A row for each force, clearance and contact: c and the exponents with contacts that take time.
struct ContactJump {
  double force, clearance;        // N, m
  std::array<double, 2> contact;  // as JumpLawRun::contacts
  backlash::CompliantJump jump;
};
[[nodiscard]] std::string contact_jumps_text(const JumpLawRun& run, backlash::JumpCriterion criterion,
                                             const std::vector<ContactJump>& jumps, const std::string& format);

[[nodiscard]] std::string jump_law_table(const JumpLawRun& run, const backlash::JumpLaw& law);
/// One row per point; the laws stand in "# key: value" lines.
[[nodiscard]] std::string jump_law_csv(const JumpLawRun& run, const backlash::JumpLaw& law);
[[nodiscard]] std::string jump_law_json(const JumpLawRun& run, const backlash::JumpLaw& law);

}  // namespace fracfit
