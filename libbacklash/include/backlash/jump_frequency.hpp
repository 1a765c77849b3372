// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "backlash/describing_function.hpp"
#include "frac/model/frequency_response_data.hpp"

namespace backlash {

enum class JumpCriterion {
  two_impact_loss,        // low-frequency end of the stable two-impact orbit, asymmetric branch included
  symmetry_loss,          // low-frequency end of the symmetric one (pitchfork, or an extra impact at small restitution)
  saddle_node,            // high-frequency end of the impacting motion
  contact_at_rest,        // start in contact at rest: w_L exactly
  mid_gap_at_rest,        // start at mid-gap at rest
  sweep_up,               // visible jump met with omega rising: the motion becomes one of two impacts per period
  sweep_down,             // visible jump met with omega falling: it ceases to be one
  largest_discontinuity,  // of a sweep, from its values alone
};
[[nodiscard]] std::string_view to_string(JumpCriterion criterion);
/// @throws std::invalid_argument  naming the allowed spellings.
[[nodiscard]] JumpCriterion jump_criterion_from_string(std::string_view text);
[[nodiscard]] std::span<const JumpCriterion> jump_criteria();

/// A jump of the physics: c = omega_jump / sqrt(F/(M2 clearance)) depends on restitution only.
struct JumpFrequency {
  std::optional<double> similarity_constant;  // c; empty when there is none at this restitution
  std::string message;  // why there is none, or what happens there (grazing, period doubling, ...)
};

/// c(restitution) for a criterion of the physics (all but largest_discontinuity).
/// @throws std::invalid_argument  restitution outside [0, 1], or criterion largest_discontinuity.
[[nodiscard]] JumpFrequency jump_similarity_constant(double restitution, JumpCriterion criterion);

/// omega_jump in rad/s; empty when there is none.
/// @param force_amplitude  N, > 0
/// @throws std::invalid_argument  as above, or force_amplitude not positive and finite, or clearance 0.
[[nodiscard]] std::optional<double> jump_frequency(const TwoMassSystem& system, double force_amplitude,
                                                   JumpCriterion criterion);

/// A discontinuity seen in data: between two neighbouring samples.
struct Discontinuity {
  double omega_lower, omega_upper;  // bracket, rad/s
  double omega;                     // its geometric middle
  double size;  // |step of Im G beyond the local trend| over the larger |Im G| of the two, in (0, 1]
};

/// The discontinuities of the imaginary part of a sampled curve, largest first.  Robust lines (Theil, Sen) through up
/// to six samples of ln|Im G| over ln omega on either side of a step must miss each other there by five standard
/// deviations of the scatter about them and by 2 %, and the step itself must carry at least half of that.  Empty when
/// none does.  Steps of the size of the scatter, as in chaotic parts of a response, and steps next to the first or last
/// sample stay hidden.
/// @param uncertainty  95 % half width of each value of data, or empty where it is not known: a step must also exceed
///                     five standard deviations of what the samples are uncertain by
/// @throws std::invalid_argument  fewer than 5 different frequencies, or uncertainty of another length, negative or
/// NaN.
[[nodiscard]] std::vector<Discontinuity> find_discontinuities(const frac::FrequencyResponseData& data,
                                                              const std::vector<double>& uncertainty = {});

}  // namespace backlash
