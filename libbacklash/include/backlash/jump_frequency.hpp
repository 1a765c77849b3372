#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "backlash/describing_function.hpp"
#include "frac/frequency_response_data.hpp"

namespace backlash {

enum class JumpCriterion {
  two_impact_loss,        // low-frequency end of the stable two-impact orbit, asymmetric branch included
  symmetry_loss,          // low-frequency end of the symmetric one (pitchfork)
  saddle_node,            // high-frequency end of the impacting motion
  contact_at_rest,        // start in contact at rest: w_L exactly
  mid_gap_at_rest,        // start at mid-gap at rest
  sweep_up,               // visible jump met with omega rising
  sweep_down,             // visible jump met with omega falling
  largest_discontinuity,  // of a sweep, from its values alone
};
[[nodiscard]] std::string_view to_string(JumpCriterion criterion);
[[nodiscard]] JumpCriterion jump_criterion_from_string(std::string_view text);

/// A jump of the physics: c = omega_jump / sqrt(F/(M2 clearance)) depends on restitution only.
struct JumpFrequency {
  std::optional<double> similarity_constant;  // c; empty when there is none at this restitution
  std::string message;                        // why there is none, or where the branch ends (grazing, period doubling, ...)
};

/// c(restitution) for a criterion of the physics (all but largest_discontinuity).
/// @throws std::invalid_argument  restitution outside [0, 1], or criterion largest_discontinuity.
[[nodiscard]] JumpFrequency jump_similarity_constant(double restitution, JumpCriterion criterion);

/// omega_jump in rad/s; empty when there is none.
[[nodiscard]] std::optional<double> jump_frequency(const TwoMassSystem& system, double force_amplitude, JumpCriterion criterion);

/// A discontinuity seen in data: between two neighbouring samples.
struct Discontinuity {
  double omega_lower, omega_upper;  // bracket, rad/s
  double omega;                     // its geometric middle
  double size;                      // |step of Im G| beyond the local trend, relative to |Im G| there
};

/// The discontinuities of the imaginary part of a sampled curve, largest first: steps in ln|Im G| that stand out of their
/// neighbourhood by a robust test.  Empty when none does.
/// @throws std::invalid_argument  fewer than 5 samples.
[[nodiscard]] std::vector<Discontinuity> find_discontinuities(const frac::FrequencyResponseData& data);

}  // namespace backlash
