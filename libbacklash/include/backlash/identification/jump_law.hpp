// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "backlash/compliant/compliant_bodies.hpp"
#include "backlash/compliant_contact.hpp"
#include "backlash/jump_frequency.hpp"
#include "frac/identification/power_law.hpp"

namespace backlash {

struct JumpPoint {
  double force;                      // N
  double clearance;                  // m
  double restitution;                // of a free contact where contacts take time
  std::optional<double> omega_jump;  // rad/s; empty when the criterion gives none
};

/// Similarity constant of the jump at one restitution.
struct JumpConstant {
  double restitution;
  std::optional<double> similarity_constant;  // c, of a sweep the mean over forces and clearances; empty: left out
  std::string message;                        // what happens at the jump, or why there is none
};

/// w_J = a F^b at one clearance (eq. 7), w_J averaged first over the restitutions that have a jump.
struct ForceLaw {
  double clearance;    // m
  frac::PowerLaw law;  // coefficient a, exponent b
};

/// Jumps over a grid of forces, clearances and restitutions.
struct JumpGrid {
  JumpCriterion criterion;
  std::vector<JumpPoint> points;        // clearance slowest, restitution fastest
  std::vector<JumpConstant> constants;  // one per restitution
  double mean_similarity_constant;      // mean of c over the points that have a jump; NaN where none has
};

/// Eqs. (7) and (8): a(Delta) and b(Delta) as power laws of the clearance.  Similarity says a = c Delta^-1/2 M2^-1/2
/// and b = 1/2.
struct JumpLaw : JumpGrid {
  /// There is a law.
  [[nodiscard]] bool usable() const noexcept { return message.empty(); }
  /// Both power laws, or why there are none.
  [[nodiscard]] std::string summary() const;

  std::string message;  // why there is no law, and its numbers are NaN; empty where there is one
  std::vector<ForceLaw> laws;
  frac::PowerLaw a_of_clearance;
  frac::PowerLaw b_of_clearance;
};

/// The constants printed in Duarte, Tenreiro Machado (2009), eq. (8).
struct PublishedJumpLaw {
  double a_coefficient = 1.193;
  double a_exponent = -0.564;
  double b_coefficient = 0.565;
  double b_exponent = 0.024;
  [[nodiscard]] double omega_jump(double force, double clearance) const;
};

/// Jump frequencies on a grid of scenes; the same for any number of threads.  largest_discontinuity takes each from a
/// sweep upwards over 1.2 to 1.75 sqrt(F/(M2 clearance)), 116 points; by every other criterion the constants depend on
/// restitution alone.
/// @param mass1,mass2  kg;  @param force  N, > 0;  @param clearance  m, > 0;  @param restitution  in [0, 1]
/// @param progress  counts what is computed, if given
/// @throws std::invalid_argument  a list empty, or an entry out of range.
[[nodiscard]] JumpGrid jump_grid(double mass1, double mass2, const std::vector<double>& force,
                                 const std::vector<double>& clearance, const std::vector<double>& restitution,
                                 JumpCriterion criterion, int threads = 0, frac::Progress* progress = nullptr);

/// Of masses whose contacts take time, also with dry friction, by symmetry_loss or saddle_node, see compliant_jump(): c
/// depends on stiffness and friction beside the force too, and the constant of a contact is the mean over the scenes.
/// @param contact  each with a damping > 0
[[nodiscard]] JumpGrid contact_jump_grid(double mass1, double mass2, const std::vector<double>& force,
                                         const std::vector<double>& clearance,
                                         const std::vector<CompliantContact>& contact, JumpCriterion criterion,
                                         int threads = 0, frac::Progress* progress = nullptr,
                                         const CoulombFriction& friction = {});

/// The power laws of such a grid.  Where fewer than two clearances have a jump at two forces there is none, and
/// `message` says so.
/// @throws std::invalid_argument  as jump_grid, or fewer than 2 different forces or clearances.
[[nodiscard]] JumpLaw fit_jump_law(double mass1, double mass2, const std::vector<double>& force,
                                   const std::vector<double>& clearance, const std::vector<double>& restitution,
                                   JumpCriterion criterion, int threads = 0, frac::Progress* progress = nullptr);
[[nodiscard]] JumpLaw fit_contact_jump_law(double mass1, double mass2, const std::vector<double>& force,
                                           const std::vector<double>& clearance,
                                           const std::vector<CompliantContact>& contact, JumpCriterion criterion,
                                           int threads = 0, frac::Progress* progress = nullptr,
                                           const CoulombFriction& friction = {});

}  // namespace backlash
