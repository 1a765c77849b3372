#pragma once

#include <vector>

#include "backlash/jump_frequency.hpp"
#include "frac/identification/power_law.hpp"

namespace backlash {

struct JumpPoint {
  double force;      // N
  double clearance;  // m
  double restitution;
  std::optional<double> omega_jump;  // rad/s; empty when the criterion gives none
};

/// w_J = a F^b at one clearance (eq. 7), w_J averaged over restitution first.
struct ForceLaw {
  double clearance;
  frac::PowerLaw law;  // coefficient a, exponent b
};

/// Eqs. (7) and (8): a(Delta) and b(Delta) as power laws of the clearance.
struct JumpLaw {
  JumpCriterion criterion;
  std::vector<JumpPoint> points;
  std::vector<ForceLaw> laws;
  frac::PowerLaw a_of_clearance;
  frac::PowerLaw b_of_clearance;
  double mean_similarity_constant;  // mean of c over restitution: similarity says a = c Delta^-1/2 M2^-1/2, b = 1/2
};

/// The constants printed in Duarte, Tenreiro Machado (2009), eq. (8).
struct PublishedJumpLaw {
  double a_coefficient = 1.193;
  double a_exponent = -0.564;
  double b_coefficient = 0.565;
  double b_exponent = 0.024;
  [[nodiscard]] double omega_jump(double force, double clearance) const;
};

/// @throws std::invalid_argument  a list empty, fewer than 2 forces or 2 clearances, an entry out of range, or no jump
/// anywhere.
[[nodiscard]] JumpLaw fit_jump_law(double mass1, double mass2, const std::vector<double>& force,
                                   const std::vector<double>& clearance, const std::vector<double>& restitution,
                                   JumpCriterion criterion, int threads = 0, frac::Progress* progress = nullptr);

}  // namespace backlash
