// SPDX-License-Identifier: BSD-3-Clause
#include "backlash/compliant/compliant_jump.hpp"

#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <tuple>

#include "base/check.hpp"
#include "steady_state/two_impact_orbit.hpp"
#include "symmetric_compliant_orbit.hpp"

namespace backlash {
namespace {

using detail::CompliantGroups;
using detail::SymmetricCompliantOrbit;

// The symmetric orbits of one contact over w = omega/sqrt(F/(M2 clearance)).
class OrbitsOverFrequency {
 public:
  OrbitsOverFrequency(double stiffness_group, double damping_ratio) : lambda_(stiffness_group), zeta_(damping_ratio) {}

  struct End {
    double frequency;
    bool breaks;  // beyond it there is an orbit that does not attract
  };
  /// Of the orbits that attract, downwards or upwards. Empty where there are none.
  [[nodiscard]] std::optional<End> end(bool is_low) const {
    std::optional<double> w = somewhere();
    if (!w) return std::nullopt;
    SymmetricCompliantOrbit orbit = *detail::symmetric_compliant_orbit_from_hard(groups(*w));
    // Steps that lead to no orbit are halved until they are rounding.
    constexpr double first_step = 0.02, last_step = 1e-14;
    for (double step = first_step; step > last_step;) {
      const double next = *w * std::exp(is_low ? -step : step);
      const auto found = near(next, orbit);
      if (!found || !(found->largest_multiplier < 1)) {
        step /= 2;
        continue;
      }
      w = next;
      orbit = *found;
    }
    // Far enough that its multiplier is known to lie beyond 1.
    constexpr double beyond = 1e-6;
    const auto after = near(*w * std::exp(is_low ? -beyond : beyond), orbit);
    return End{*w, after.has_value()};
  }

 private:
  [[nodiscard]] CompliantGroups groups(double w) const { return {1 / (w * w), std::sqrt(lambda_) / w, zeta_}; }
  [[nodiscard]] std::optional<SymmetricCompliantOrbit> near(double w, const SymmetricCompliantOrbit& orbit) const {
    return detail::symmetric_compliant_orbit(groups(w), orbit.angle, orbit.speed, orbit.duration);
  }
  // Contacts that take time have their orbits lower than hard ones, by a share of the order of w/sqrt(Lambda).
  [[nodiscard]] std::optional<double> somewhere() const {
    const double restitution = restitution_of_damping_ratio(zeta_);
    const double low = 1 / std::sqrt(detail::symmetry_breaking_gamma(restitution));
    constexpr double finest = 0.02;
    for (double w = 1.2 * low; w > 0.3 * low; w *= 1 - finest) {
      const auto found = detail::symmetric_compliant_orbit_from_hard(groups(w));
      if (found && found->largest_multiplier < 1) return w;
    }
    return std::nullopt;
  }

  double lambda_, zeta_;
};

std::string meaning(bool is_low, bool breaks) {
  if (!is_low) return "the symmetric orbit of two contacts meets its unstable partner (saddle-node)";
  return breaks ? "the symmetric orbit of two contacts breaks its symmetry (pitchfork)"
                : "the symmetric orbit of two contacts meets a wall once more";
}

}  // namespace

double stiffness_group(const CompliantContact& contact, double mass1, double mass2, double clearance,
                       double force_amplitude) {
  for (const auto& [name, unit, value] :
       {std::tuple{"mass1", "kg", mass1}, std::tuple{"mass2", "kg", mass2}, std::tuple{"clearance", "m", clearance},
        std::tuple{"force_amplitude", "N", force_amplitude}})
    detail::require_positive(name, unit, value);
  // M2/m = 1 + M2/M1.
  return contact.stiffness() * clearance / force_amplitude * (1 + mass2 / mass1);
}

CompliantJump compliant_jump(double stiffness_group, double damping_ratio, JumpCriterion criterion) {
  detail::require_positive("stiffness_group", "", stiffness_group);
  detail::require_positive("damping_ratio", "", damping_ratio);
  if (criterion != JumpCriterion::symmetry_loss && criterion != JumpCriterion::saddle_node)
    throw std::invalid_argument("criterion is " + std::string(to_string(criterion)) +
                                "; with contacts that take time it must be symmetry-loss or saddle-node");
  const bool is_low = criterion == JumpCriterion::symmetry_loss;
  CompliantJump jump{{}, stiffness_group, std::numeric_limits<double>::quiet_NaN()};
  const auto end = OrbitsOverFrequency(stiffness_group, damping_ratio).end(is_low);
  if (!end) {
    jump.message = "no symmetric orbit of two contacts that attracts was found from that of the restitution";
    return jump;
  }
  jump.similarity_constant = end->frequency;
  jump.message = meaning(is_low, end->breaks);
  // c is known to 1e-13, and bends by about its size over a unit of ln Lambda.
  constexpr double step = 1e-4;
  const auto less = OrbitsOverFrequency(stiffness_group * std::exp(-step), damping_ratio).end(is_low);
  const auto more = OrbitsOverFrequency(stiffness_group * std::exp(step), damping_ratio).end(is_low);
  if (less && more) jump.exponent = 0.5 - std::log(more->frequency / less->frequency) / (2 * step);
  return jump;
}

}  // namespace backlash
