// SPDX-License-Identifier: BSD-3-Clause
#include "free_masses.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "base/check.hpp"
#include "base/median.hpp"
#include "contact_response.hpp"
#include "free_motions.hpp"
#include "scene_uncertainty.hpp"

namespace backlash::detail {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr std::array<const char*, scene_size> units = {"kg", "kg", "m", "1", "s", "N", "N"};

// Factor by which masses and clearance may differ from what the data suggest.
const double default_range = std::log(1e6);
std::string allowed_range(std::size_t k) {
  return k >= 4 ? "0 or greater and finite" : k == 3 ? "in [0, 1]" : "positive and finite";
}

// A value the user gives for a parameter, as a coordinate of the search.
double coordinate(std::size_t k, const char* what, double value, const SceneData& data) {
  const bool allowed = k >= 4   ? value >= 0 && std::isfinite(value)
                       : k == 3 ? value >= 0 && value <= 1
                                : value > 0 && std::isfinite(value);
  if (!allowed) {
    throw std::invalid_argument(std::string(scene_names[k]) + ": " + what + " is " + text(value) + "; it must be " +
                                allowed_range(k));
  }
  if (k >= first_friction) return value / data.force_unit;
  return k == 4 ? value / data.time_unit : k == 3 ? value : std::log(value);
}

// Sum of the masses, product of mass 2 and clearance, ratio of the masses.
std::array<Quantity, 3> combinations_of(const std::vector<Quantity>& of) {
  const double mass1 = of[0].value, mass2 = of[1].value, product = of[1].value * of[2].value, ratio = mass1 / mass2;
  return {{{"mass1 + mass2", "kg", mass1 + mass2, {mass1, mass2, 0, 0, 0, 0, 0}},
           {"mass2 clearance", "kg m", product, {0, product, product, 0, 0, 0, 0}},
           {"mass1/mass2", "1", ratio, {ratio, -ratio, 0, 0, 0, 0, 0}}}};
}

// With m the reduced mass, and zeta and a the damping ratio and the angle of a free contact of that restitution and the
// duration t,
//   k = m a^2/t^2,   c = 2 zeta a m/t.
// 1/sqrt(k) and 1/c go smoothly to 0 at the hard contact, so that their intervals give those of k and c, which have no
// upper end where the contact may be hard.
std::vector<SceneEstimate> contact_estimates(const SceneUncertainty& uncertainty, const std::vector<Quantity>& of,
                                             SceneEstimate restitution) {
  constexpr double difference = 1e-6;
  const double mass1 = of[0].value, mass2 = of[1].value, mass = mass1 / (mass1 + mass2) * mass2;
  const SceneEstimate time = uncertainty.estimate(of[4]);
  restitution.name = "contact_restitution";
  const auto inverse_roots = [&](double of_restitution) {
    const ContactShape shape = contact_shape(of_restitution);
    return std::array{1 / (shape.angle * std::sqrt(mass)), 1 / (2 * shape.damping_ratio * shape.angle * mass)};
  };
  const double before = std::max(0.0, of[3].value - difference), after = std::min(1.0, of[3].value + difference);
  const auto here = inverse_roots(of[3].value), low = inverse_roots(before), high = inverse_roots(after);
  constexpr std::array<double, 2> power = {2, 1}, power_of_mass = {0.5, 1};
  constexpr std::array<const char*, 2> contact_names = {"contact_stiffness", "contact_damping"};
  constexpr std::array<const char*, 2> contact_units = {"N/m", "N s/m"};
  std::vector<SceneEstimate> result = {time};
  for (std::size_t i = 0; i < 2; ++i) {
    const double inverse = of[4].value * here[i];
    const SceneEstimate root = uncertainty.open_estimate(
        {"",
         "",
         inverse,
         {-power_of_mass[i] * inverse * mass2 / (mass1 + mass2), -power_of_mass[i] * inverse * mass1 / (mass1 + mass2),
          0, of[4].value * (high[i] - low[i]) / (after - before), here[i] * of[4].gradient[4], 0, 0}});
    SceneEstimate made{};
    made.name = contact_names[i];
    made.unit = contact_units[i];
    made.value = std::pow(inverse, -power[i]);
    made.standard_error = power[i] * made.value * root.standard_error / inverse;
    made.ci95_lower = std::pow(root.ci95_upper, -power[i]);
    made.ci95_upper = root.ci95_lower > 0 ? std::pow(root.ci95_lower, -power[i]) : nan;
    made.fixed = time.fixed && restitution.fixed;
    made.at_bound = time.at_bound || restitution.at_bound || !std::isfinite(inverse);
    made.identified = !made.at_bound && is_narrow(made);
    if (!std::isfinite(made.standard_error)) made.standard_error = nan;
    result.push_back(made);
  }
  result.push_back(restitution);
  return result;
}

}  // namespace

bool has_friction(const SceneBounds& bounds) {
  return bounds.upper[first_friction] > 0 || bounds.upper[first_friction + 1] > 0;
}

KnownScene known_scene(const SceneData& data, const SceneIdentificationOptions& options) {
  std::vector<double> masses, amplitudes;
  for (const MeasuredPoint& point : data.points) {
    const double size = std::abs(point.value);
    if (!(size > 0) || point.harmonic != 1) continue;
    masses.push_back(-std::log(size) - 2 * std::log(point.omega));
    amplitudes.push_back(std::log(point.force) + std::log(size));
  }
  const double mass = frac::detail::median(masses);
  const double amplitude = frac::detail::median(amplitudes);
  KnownScene known{};
  known.bounds.lower = {mass - default_range, mass - default_range, amplitude - default_range, 0, 0, 0, 0};
  known.bounds.upper = {mass + default_range,
                        mass + default_range,
                        amplitude + default_range,
                        1,
                        options.contact == ContactModel::hard ? 0 : std::numbers::pi,
                        options.friction == FrictionModel::none ? 0.0 : 1.0,
                        options.friction == FrictionModel::none ? 0.0 : 1.0};
  std::array<bool, scene_size> seen{};
  for (const frac::ParameterConstraint& constraint : options.constraints) {
    const auto name = std::find(scene_names.begin(), scene_names.end(), constraint.name);
    if (name == scene_names.end()) {
      throw std::invalid_argument(
          "constraint of '" + constraint.name +
          "': the scene has mass1, mass2, clearance, restitution, contact_time, friction1 and friction2 only");
    }
    const auto k = static_cast<std::size_t>(name - scene_names.begin());
    if (k == 4 && options.contact == ContactModel::hard)
      throw std::invalid_argument("contact_time is constrained, but the contact is hard, which is contact time 0");
    if (k >= first_friction && options.friction == FrictionModel::none)
      throw std::invalid_argument(constraint.name + " is constrained, but there is to be no friction");
    if (seen[k]) throw std::invalid_argument(constraint.name + " is constrained twice");
    seen[k] = true;
    if (constraint.fixed) {
      if (constraint.lower || constraint.upper || constraint.start) {
        throw std::invalid_argument(constraint.name + " is fixed; limits or a start beside that have no meaning");
      }
      if (k < known.fixed.size()) known.fixed[k] = *constraint.fixed;
      known.bounds.lower[k] = known.bounds.upper[k] = coordinate(k, "the fixed value", *constraint.fixed, data);
      continue;
    }
    if (constraint.lower) {
      known.bounds.lower[k] = coordinate(k, "the lower limit", *constraint.lower, data);
      if (!constraint.upper) known.bounds.upper[k] = std::max(known.bounds.upper[k], known.bounds.lower[k] + 1);
    }
    if (constraint.upper) {
      known.bounds.upper[k] = coordinate(k, "the upper limit", *constraint.upper, data);
      if (!constraint.lower) known.bounds.lower[k] = std::min(known.bounds.lower[k], known.bounds.upper[k] - 1);
    }
    if (k >= 3) known.bounds.lower[k] = std::max(known.bounds.lower[k], 0.0);
    if (k == 3) {
      known.bounds.upper[k] = std::min(known.bounds.upper[k], 1.0);
    }
    if (!known.bounds.is_free(k)) {
      throw std::invalid_argument(constraint.name + ": the lower limit " +
                                  (constraint.lower ? text(*constraint.lower) : std::string("by default")) +
                                  " is not below the upper limit " +
                                  (constraint.upper ? text(*constraint.upper) : std::string("by default")));
    }
    if (constraint.start) {
      const double start = coordinate(k, "the start", *constraint.start, data);
      if (start < known.bounds.lower[k] || start > known.bounds.upper[k]) {
        throw std::invalid_argument(constraint.name + ": the start " + text(*constraint.start) +
                                    " lies outside the limits");
      }
      if (k < known.start.size()) known.start[k] = start;
    }
  }
  return known;
}

KnownScene frictionless(KnownScene known) {
  for (std::size_t k = first_friction; k < scene_size; ++k) known.bounds.lower[k] = known.bounds.upper[k] = 0;
  return known;
}

KnownScene with_hard_contacts(KnownScene known) {
  known.bounds.lower[4] = known.bounds.upper[4] = 0;
  return known;
}

std::shared_ptr<SceneMotions> FreeMasses::motions(Effort effort, Motions which) const {
  return free_motions(data(), bounds().upper[4] > 0, has_friction(bounds()), effort, which);
}

bool FreeMasses::agree(const Coordinates& one, const Coordinates& other, double within) const {
  return std::abs(one[1] + one[2] - other[1] - other[2]) < within && std::abs(one[3] - other[3]) < within &&
         std::abs(one[4] - other[4]) < within && std::abs(one[5] - other[5]) < within &&
         std::abs(one[6] - other[6]) < within;
}

std::string FreeMasses::coordinate_name(std::size_t k) const {
  if (k == 4) return "contact time";
  return (k < 3 ? "ln " : "") + std::string(scene_names[k]);
}

std::vector<Quantity> FreeMasses::parameters(const Coordinates& theta) const {
  const Coordinates unit = {1, 1, 1, 1, data().time_unit, data().force_unit, data().force_unit};
  std::vector<Quantity> result;
  for (std::size_t k = 0; k < scene_size; ++k) {
    // A fixed value is given back as it was, not through its logarithm.
    const double value = k < fixed_.size() && fixed_[k] ? *fixed_[k] : k < 3 ? std::exp(theta[k]) : theta[k] * unit[k];
    result.push_back({std::string(scene_names[k]), units[k], value, std::vector<double>(scene_size), k >= 4});
    result.back().gradient[k] = k < 3 ? value : unit[k];
  }
  return result;
}

std::vector<SceneEstimate> FreeMasses::estimates(const SceneUncertainty& uncertainty) const {
  const std::vector<Quantity> of = parameters(uncertainty.theta());
  std::vector<SceneEstimate> result;
  for (std::size_t k = 0; k < 4; ++k) result.push_back(uncertainty.estimate(of[k]));
  for (const Quantity& combination : combinations_of(of)) result.push_back(uncertainty.estimate(combination));
  if (bounds().upper[4] > 0) {
    const auto contact = contact_estimates(uncertainty, of, result[3]);
    result.insert(result.end(), contact.begin(), contact.end());
  }
  for (std::size_t k = first_friction; k < scene_size && has_friction(bounds()); ++k)
    result.push_back(uncertainty.estimate(of[k]));
  return result;
}

FreeMasses::Estimates FreeMasses::sorted(const std::vector<SceneEstimate>& estimates) {
  Estimates result;
  const auto combinations = estimates.begin() + 4, further = combinations + 3;
  std::copy(estimates.begin(), combinations, result.parameters.begin());
  std::copy(combinations, further, result.combinations.begin());
  const auto friction = std::find_if(further, estimates.end(),
                                     [](const SceneEstimate& each) { return each.name.starts_with("friction"); });
  result.contact.assign(further, friction);
  result.friction.assign(friction, estimates.end());
  return result;
}

}  // namespace backlash::detail
