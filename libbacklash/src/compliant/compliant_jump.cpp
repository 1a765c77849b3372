// SPDX-License-Identifier: BSD-3-Clause
#include "backlash/compliant/compliant_jump.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <tuple>
#include <utility>

#include "base/check.hpp"
#include "compliant_family.hpp"
#include "steady_state/two_impact_orbit.hpp"
#include "symmetric_compliant_orbit.hpp"

namespace backlash {
namespace {

using detail::ClosedMotion;
using detail::CompliantFamily;
using detail::CompliantGroups;
using detail::SymmetricCompliantOrbit;

constexpr const char* const saddle_node =
    "the symmetric orbit of two contacts meets its unstable partner (saddle-node)";
constexpr const char* const pitchfork = "the symmetric orbit of two contacts breaks its symmetry (pitchfork)";
constexpr const char* const meets_wall = "the symmetric orbit of two contacts meets a wall once more";
constexpr const char* const none_found =
    "no symmetric orbit of two contacts that attracts was found from that of the restitution";

// The symmetric orbits of two contacts of one scene over w = omega/sqrt(F/(M2 clearance)): of free masses in closed
// form.
class ClosedFormOrbits {
 public:
  using Orbit = SymmetricCompliantOrbit;

  ClosedFormOrbits(double stiffness_group, double damping_ratio) : lambda_(stiffness_group), zeta_(damping_ratio) {}

  [[nodiscard]] double restitution() const { return restitution_of_damping_ratio(zeta_); }
  [[nodiscard]] std::optional<Orbit> at(double w) const {
    return detail::symmetric_compliant_orbit_from_hard(groups(w));
  }
  [[nodiscard]] std::optional<Orbit> near(double w, const Orbit& orbit) const {
    return detail::symmetric_compliant_orbit(groups(w), orbit.angle, orbit.speed, orbit.duration);
  }
  static bool attracts(const Orbit& orbit) { return orbit.largest_multiplier < 1; }
  static std::string meaning(bool is_low, const Orbit&, const std::optional<Orbit>& beyond) {
    return !is_low ? saddle_node : beyond ? pitchfork : meets_wall;
  }

 private:
  [[nodiscard]] CompliantGroups groups(double w) const { return {1 / (w * w), std::sqrt(lambda_) / w, zeta_}; }

  double lambda_, zeta_;
};

// With dry friction: closed motions of the flow over half a period, so that -1 is the multiplier of a broken symmetry
// and 1 that of a fold.
class FrictionOrbits {
 public:
  using Orbit = ClosedMotion;

  FrictionOrbits(const CompliantBodies& bodies, double force)
      : restitution_(bodies.system().restitution()),
        unit_(std::sqrt(force / bodies.system().mass2() / bodies.system().clearance())),
        family_(bodies, force, unit_, OrbitParameter::omega, Output::x1) {}

  [[nodiscard]] double restitution() const { return restitution_; }
  [[nodiscard]] std::optional<Orbit> at(double w) const { return of_two(family_.from_hard(std::log(w * unit_))); }
  [[nodiscard]] std::optional<Orbit> near(double w, const Orbit& orbit) const {
    return of_two(detail::closed_motion(family_.map(), orbit.state(), orbit.mode, std::log(w * unit_), 1));
  }
  static bool attracts(const Orbit& orbit) { return std::abs(orbit.multipliers().front()) < 1; }
  static std::string meaning(bool, const Orbit& last, const std::optional<Orbit>& beyond) {
    // A multiplier reaches 1 as the square root of the distance from a fold, which is left at 1e-12.
    constexpr double near_one = 1e-3;
    const auto is_near = [](double value) {
      return [value](const std::complex<double>& each) { return std::abs(each - value) < near_one; };
    };
    const auto multipliers = last.multipliers();
    if (std::any_of(multipliers.begin(), multipliers.end(), is_near(1))) return saddle_node;
    if (!beyond) return meets_wall;
    return is_near(-1)(beyond->multipliers().front())
               ? pitchfork
               : "a rest of dry friction begins or ends, beyond which the symmetric orbit does not attract";
  }

 private:
  static std::optional<Orbit> of_two(std::optional<Orbit> orbit) {
    if (orbit && orbit->map.pattern.contacts != 1) orbit.reset();
    return orbit;
  }

  double restitution_, unit_;
  CompliantFamily family_;
};

struct End {
  double frequency;
  std::string meaning;
};

// Contacts that take time have their orbits lower than hard ones, by a share of the order of w/sqrt(Lambda).
template <class Orbits>
std::optional<std::pair<double, typename Orbits::Orbit>> somewhere(const Orbits& orbits) {
  const double low = 1 / std::sqrt(detail::symmetry_breaking_gamma(orbits.restitution()));
  constexpr double finest = 0.02;
  for (double w = 1.2 * low; w > 0.3 * low; w *= 1 - finest) {
    auto found = orbits.at(w);
    if (found && Orbits::attracts(*found)) return std::pair{w, std::move(*found)};
  }
  return std::nullopt;
}

// Of the orbits that attract, downwards or upwards. Empty where there are none.
template <class Orbits>
std::optional<End> end_of(const Orbits& orbits, bool is_low, double last_step) {
  auto begin = somewhere(orbits);
  if (!begin) return std::nullopt;
  auto& [w, orbit] = *begin;
  // Steps that lead to no orbit are halved until they are rounding.
  constexpr double first_step = 0.02;
  for (double step = first_step; step > last_step;) {
    const double next = w * std::exp(is_low ? -step : step);
    auto found = orbits.near(next, orbit);
    if (!found || !Orbits::attracts(*found)) {
      step /= 2;
      continue;
    }
    w = next;
    orbit = std::move(*found);
  }
  // Far enough that its multiplier is known to lie beyond 1.
  constexpr double beyond = 1e-6;
  const auto after = orbits.near(w * std::exp(is_low ? -beyond : beyond), orbit);
  return End{w, Orbits::meaning(is_low, orbit, after)};
}

bool is_low_end(JumpCriterion criterion) {
  if (criterion != JumpCriterion::symmetry_loss && criterion != JumpCriterion::saddle_node)
    throw std::invalid_argument("criterion is " + std::string(to_string(criterion)) +
                                "; with contacts that take time it must be symmetry-loss or saddle-node");
  return criterion == JumpCriterion::symmetry_loss;
}

std::optional<End> end_of(double stiffness_group, double damping_ratio, bool is_low) {
  return end_of(ClosedFormOrbits(stiffness_group, damping_ratio), is_low, 1e-14);
}
std::optional<End> end_of(const CompliantBodies& bodies, double force, bool is_low) {
  // Newton's method on the flow leaves 1e-10 of the state, which is 1e-12 of w or less where the multiplier passes 1.
  return end_of(FrictionOrbits(bodies, force), is_low, 1e-12);
}

CompliantJump jump_at(const std::optional<End>& end, double stiffness_group) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  CompliantJump jump{{}, stiffness_group, nan, nan};
  jump.message = end ? end->meaning : none_found;
  if (end) jump.similarity_constant = end->frequency;
  return jump;
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

CompliantJump compliant_jump(double stiffness_group, double damping_ratio, JumpCriterion criterion,
                             bool with_exponents) {
  detail::require_positive("stiffness_group", "", stiffness_group);
  detail::require_positive("damping_ratio", "", damping_ratio);
  const bool is_low = is_low_end(criterion);
  CompliantJump jump = jump_at(end_of(stiffness_group, damping_ratio, is_low), stiffness_group);
  if (!jump.similarity_constant || !with_exponents) return jump;
  // c is known to 1e-13, and bends by about its size over a unit of ln Lambda.
  constexpr double step = 1e-4;
  const auto less = end_of(stiffness_group * std::exp(-step), damping_ratio, is_low);
  const auto more = end_of(stiffness_group * std::exp(step), damping_ratio, is_low);
  if (less && more) jump.exponent = 0.5 - std::log(more->frequency / less->frequency) / (2 * step);
  jump.clearance_exponent = -jump.exponent;
  return jump;
}

CompliantJump compliant_jump(const CompliantBodies& bodies, double force_amplitude, JumpCriterion criterion,
                             bool with_exponents) {
  const TwoMassSystem& system = bodies.system();
  const double group =
      stiffness_group(bodies.contact(), system.mass1(), system.mass2(), system.clearance(), force_amplitude);
  if (!bodies.hard().are_free())
    throw std::invalid_argument(
        "bodies have receptances other than those of free masses; a jump is one of free masses");
  if (bodies.are_free())
    return compliant_jump(group, free_contact(bodies.contact(), system.mass1(), system.mass2()).damping_ratio,
                          criterion, with_exponents);
  detail::require_positive("contact_damping", "N s/m", bodies.contact().damping());
  const bool is_low = is_low_end(criterion);
  CompliantJump jump = jump_at(end_of(bodies, force_amplitude, is_low), group);
  if (!jump.similarity_constant || !with_exponents) return jump;
  // c is known to 1e-11, and bends by about its size over a unit of the logarithms.
  constexpr double step = 1e-3;
  const auto slope = [&](double of_force, double of_clearance) {
    const auto logarithm = [&](double sign) {
      const CompliantBodies there(bodies.hard().load(), bodies.hard().drive(),
                                  system.clearance() * std::exp(sign * of_clearance), bodies.contact(),
                                  bodies.friction());
      const auto end = end_of(there, force_amplitude * std::exp(sign * of_force), is_low);
      return end ? std::log(end->frequency) : std::numeric_limits<double>::quiet_NaN();
    };
    return (logarithm(1) - logarithm(-1)) / (2 * step);
  };
  jump.exponent = 0.5 + slope(step, 0);
  jump.clearance_exponent = -0.5 + slope(0, step);
  return jump;
}

}  // namespace backlash
