// SPDX-License-Identifier: BSD-3-Clause
#include "backlash/identification/bodies_identification.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>

#include "base/check.hpp"
#include "bodies_model.hpp"
#include "frac/identification/constraints.hpp"
#include "scene_answer.hpp"
#include "scene_data.hpp"
#include "scene_search.hpp"
#include "scene_start.hpp"
#include "scene_uncertainty.hpp"

namespace backlash {
namespace {

using frac::detail::ParameterMap;
using Values = std::vector<double>;
constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();

// Places of the grid of masses, clearance and restitution, and what share of the forces of inertia friction and springs
// begin with.
constexpr std::size_t grid_places = 8;
constexpr std::array<double, 2> shares = {0.01, 0.2};
// Points that tell places apart, and places of which the estimate is looked for.
constexpr std::size_t scouting_points = 24;
constexpr std::size_t settled_places = 4;
constexpr double default_range = 13.8;  // ln 1e6, of masses and clearance about what the data suggest
constexpr double largest_order = 2;     // from there on a term would count as mass

frac::detail::DataScale scale_of(const detail::SceneData& data) {
  const auto [low, high] =
      std::minmax_element(data.points.begin(), data.points.end(),
                          [](const auto& one, const auto& other) { return one.omega < other.omega; });
  return {data.typical, data.typical, data.typical, std::sqrt(low->omega * high->omega), low->omega, high->omega};
}

double mass_of(const BodiesStructure& structure, std::size_t body, const Values& values) {
  const TwoMassSystem system = structure.bodies(values).system();
  return body == 0 ? system.mass1() : system.mass2();
}

// x of mass ~ parameter^x; 0 of friction and springs.
double mass_exponent(const BodiesStructure& structure, std::size_t body, const Values& values, std::size_t parameter) {
  Values doubled = values;
  doubled[parameter] *= 2;
  const double exponent = std::log2(mass_of(structure, body, doubled) / mass_of(structure, body, values));
  return std::abs(exponent) > 1e-9 ? exponent : 0;
}

// Whether the mass of a body goes with a power of a parameter, of which 0 and less are then no body.
bool is_mass(const BodiesStructure& structure, std::size_t body, const Values& values, std::size_t parameter) {
  const double exponent = mass_exponent(structure, body, values, parameter);
  if (exponent == 0) return false;
  Values doubled = values;
  doubled[parameter] *= 2;
  return std::abs(mass_exponent(structure, body, doubled, parameter) - exponent) < 1e-9;
}

// Of a quantity that cannot be negative; limits without end say nothing.
void check_values(frac::ParameterConstraint& constraint, bool may_vanish, double most, const char* allowed) {
  const auto check = [&](const char* what, std::optional<double>& value, bool from_zero) {
    if (value && std::isinf(*value)) value.reset();
    if (!value || (*value <= most && (from_zero ? *value >= 0 : *value > 0))) return;
    throw std::invalid_argument(constraint.name + ": " + what + " is " + detail::text(*value) + "; it must be " +
                                (from_zero && !may_vanish ? "0 or greater" : allowed));
  };
  check("the fixed value", constraint.fixed, may_vanish);
  check("the start", constraint.start, may_vanish);
  check("the lower limit", constraint.lower, true);
  check("the upper limit", constraint.upper, may_vanish);
}

// Of what it is not to lie beyond, or 1, where bodies can be looked at.
double example_value(const frac::ParameterConstraint& constraint) {
  if (constraint.fixed || constraint.start) return constraint.fixed ? *constraint.fixed : *constraint.start;
  const double lower = std::max(0.0, constraint.lower.value_or(0)), upper = constraint.upper.value_or(infinity);
  return upper > lower ? std::min(std::max(1.0, lower), upper) : 1;
}

std::vector<frac::ParameterConstraint> with_defaults(const BodiesStructure& structure, const frac::Structure& joint,
                                                     std::vector<frac::ParameterConstraint> constraints) {
  check_values(frac::constraint_of(constraints, "restitution"), true, 1, "in [0, 1]");
  check_values(frac::constraint_of(constraints, "clearance"), false, infinity, "positive");
  const auto limit = [&](const std::string& name, double lower, double upper) {
    frac::ParameterConstraint& each = frac::constraint_of(constraints, name);
    if (each.fixed) return;
    each.lower = std::max(each.lower.value_or(lower), lower);
    each.upper = std::min(each.upper.value_or(upper), upper);
  };
  limit("restitution", 0, 1);
  const std::vector<std::string>& names = joint.parameter_names();
  Values values;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (joint.parameter_roles()[i] == frac::ParameterRole::order) limit(names[i], 0, largest_order);
    values.push_back(example_value(frac::constraint_of(constraints, names[i])));
  }
  // Masses and the clearance are positive; a mass that stands alone, in 1/(m s^2), looks like a gain, which may have
  // either sign.  Friction and springs may vanish, so that they are estimated from 0 on; a limit below it allows for
  // more.
  for (std::size_t i = 0; i < names.size(); ++i) {
    frac::ParameterConstraint& each = frac::constraint_of(constraints, names[i]);
    if (joint.parameter_roles()[i] != frac::ParameterRole::coefficient || names[i] == "restitution" || each.fixed)
      continue;
    const bool is_power = is_mass(structure, 0, values, i) || is_mass(structure, 1, values, i);
    if (is_power) check_values(each, false, infinity, "positive");
    if (is_power || names[i] == "clearance") {
      each.positive = true;
      if (each.lower == 0.0) each.lower.reset();
    } else if (!each.lower) {
      const bool moves_mass =
          mass_exponent(structure, 0, values, i) != 0 || mass_exponent(structure, 1, values, i) != 0;
      if (moves_mass)
        each.positive = true;
      else
        each.lower = 0;
    }
  }
  return constraints;
}

bool may_be_negative(const frac::Structure& joint, std::size_t i, const frac::ParameterConstraint& constraint) {
  return joint.parameter_roles()[i] == frac::ParameterRole::coefficient && constraint.lower && *constraint.lower < 0 &&
         !(constraint.upper && *constraint.upper <= 0);
}

void check_names(const BodiesStructure& structure) {
  for (const frac::Structure* formula : {&structure.load, &structure.drive}) {
    for (const std::string& name : formula->parameter_names()) {
      if (name == "clearance" || name == "restitution") {
        throw std::invalid_argument("receptance " + formula->formula() + ": " + name +
                                    " is that of the gap; give what the formula means another name");
      }
    }
  }
}

// Where to begin: the masses, clearance and restitution of free masses, and something of all else.
class Starts {
 public:
  Starts(const BodiesStructure& structure, const frac::Structure& joint, const ParameterMap& map,
         const detail::SceneData& data, std::vector<double> jumps)
      : structure_(structure), joint_(joint), map_(map), data_(data), jumps_(std::move(jumps)) {
    Values theta;
    // In their natural units, away from the limits, and above 0 where they may be.
    for (const ParameterMap::Free& free : map.free()) {
      const double lower = free.logarithmic || !(free.upper > 0) ? free.lower : std::max(free.lower, 0.0);
      theta.push_back(std::clamp(free.logarithmic ? 0.0 : 1.0, lower, 0.5 * (lower + free.upper)));
    }
    base_ = detail::values_at(map, theta);
    for (std::size_t i = 0; i < base_.size(); ++i) {
      if (joint.parameter_roles()[i] == frac::ParameterRole::order) base_[i] = 1;
      if (std::isfinite(map.start()[i])) base_[i] = map.start()[i];
    }
    bodies_[0] = body_of(structure.load, 0);
    bodies_[1] = body_of(structure.drive, 1);
  }

  [[nodiscard]] std::vector<Values> all() const {
    std::vector<Values> starts;
    for (const detail::Coordinates& scene : scenes()) {
      for (const double share : shares) {
        starts.push_back(map_.to_theta(values(scene, share)));
        if (bodies_[0].others.empty() && bodies_[1].others.empty()) break;
      }
    }
    return starts;
  }

 private:
  struct Body {
    const frac::Structure* formula = nullptr;
    std::size_t number = 0;
    std::optional<std::size_t> mass;  // parameter that it goes with
    double exponent = 1;              // mass ~ parameter^exponent
    std::vector<std::size_t> others;  // friction, springs
  };

  [[nodiscard]] bool is_open(std::size_t parameter) const {
    return !map_.is_fixed(parameter) && !std::isfinite(map_.start()[parameter]) &&
           joint_.parameter_roles()[parameter] == frac::ParameterRole::coefficient;
  }
  [[nodiscard]] Body body_of(const frac::Structure& formula, std::size_t number) const {
    Body body{&formula, number, {}, 1, {}};
    for (const std::string& name : formula.parameter_names()) {
      const std::size_t parameter = joint_.parameter_index(name);
      if (!is_open(parameter)) continue;
      const double exponent = mass_exponent(structure_, number, base_, parameter);
      if (exponent == 0) {
        body.others.push_back(parameter);
      } else if (!body.mass) {
        body.mass = parameter;
        body.exponent = exponent;
      }
    }
    return body;
  }

  [[nodiscard]] std::vector<detail::Coordinates> scenes() const {
    const auto mass = [](const detail::MeasuredPoint& point) {
      return -std::log(std::abs(point.value)) - 2 * std::log(point.omega);
    };
    double lowest = std::numeric_limits<double>::infinity(), highest = -lowest, amplitude = 0;
    for (const detail::MeasuredPoint& point : data_.points) {
      if (!(std::abs(point.value) > 0)) continue;
      lowest = std::min(lowest, mass(point));
      highest = std::max(highest, mass(point));
      amplitude = std::max(amplitude, point.force * std::abs(point.value));
    }
    detail::SceneBounds bounds{};
    bounds.lower = {lowest - default_range, lowest - default_range, std::log(amplitude) - default_range, 0};
    bounds.upper = {highest + default_range, highest + default_range, std::log(amplitude) + default_range, 1};
    detail::FixedScene fixed;
    for (const Body& body : bodies_) {
      if (!body.mass) fixed[body.number] = mass_of(structure_, body.number, base_);
    }
    const std::size_t clearance = base_.size() - 2, restitution = base_.size() - 1;
    if (!is_open(clearance)) fixed[2] = base_[clearance];
    if (!is_open(restitution)) fixed[3] = base_[restitution];
    for (std::size_t k = 0; k < 4; ++k) {
      if (fixed[k]) bounds.lower[k] = bounds.upper[k] = k == 3 ? *fixed[k] : std::log(*fixed[k]);
    }
    return scene_starts(data_, bounds, fixed, jumps_, false, grid_places);
  }

  [[nodiscard]] Values values(const detail::Coordinates& scene, double share) const {
    Values values = base_;
    const std::size_t clearance = base_.size() - 2, restitution = base_.size() - 1;
    if (is_open(clearance)) values[clearance] = std::exp(scene[2]);
    if (is_open(restitution)) values[restitution] = scene[3];
    const double omega = map_.scale().omega;
    for (const Body& body : bodies_) {
      const double wanted = std::exp(scene[body.number]);
      if (body.mass)
        values[*body.mass] *= std::pow(wanted / mass_of(structure_, body.number, values), 1 / body.exponent);
      for (const std::size_t other : body.others) {
        const auto stiffness = [&](double factor) {
          Values scaled = values;
          scaled[other] *= factor;
          const LinearBodies bodies = structure_.bodies(scaled);
          return 1.0 / (body.number == 0 ? bodies.load() : bodies.drive()).response(omega);
        };
        const double rise = 2 * std::abs(stiffness(1) - stiffness(0.5));
        if (rise > 0) values[other] *= share * mass_of(structure_, body.number, values) * omega * omega / rise;
      }
    }
    return values;
  }

  const BodiesStructure& structure_;
  const frac::Structure& joint_;
  const ParameterMap& map_;
  const detail::SceneData& data_;
  std::vector<double> jumps_;
  Values base_;
  std::array<Body, 2> bodies_;
};

// The estimate within constraints.
class BodiesSearch {
 public:
  BodiesSearch(const BodiesStructure& structure, const frac::Structure& joint, const detail::SceneData& data,
               const std::vector<frac::ParameterConstraint>& constraints)
      : map_(joint, constraints, scale_of(data)), bodies_(structure, data, joint, map_) {
    detail::require_residuals(data, map_.free().size());
  }
  BodiesSearch(const BodiesSearch&) = delete;
  BodiesSearch& operator=(const BodiesSearch&) = delete;

  // Places are compared over some of the points and with every orbit that exists, since motions cost much.
  void run(const BodiesStructure& structure, const frac::Structure& joint, const std::vector<double>& jumps,
           int threads) {
    const std::vector<Values> starts = Starts(structure, joint, map_, bodies_.data(), jumps).all();
    const detail::SceneData few = detail::thinned(bodies_.data(), scouting_points);
    const detail::Bodies scouted(structure, few, joint, map_);
    const detail::SceneSearcher scouts(scouted, threads), searcher(bodies_, threads);
    const std::vector<Values> places = scouts.places_of(
        scouts.solve(starts, detail::Effort::glance, detail::Motions::all), settled_places, detail::worth_settling);
    found_ =
        searcher.best_of(searcher.solve(places, detail::Effort::settle, detail::Motions::all), detail::rival_deviance);
    found_.starts = starts.size();
  }

  [[nodiscard]] const ParameterMap& map() const noexcept { return map_; }
  [[nodiscard]] const detail::Bodies& bodies() const noexcept { return bodies_; }
  [[nodiscard]] const detail::SceneSearch& found() const noexcept { return found_; }

 private:
  ParameterMap map_;
  detail::Bodies bodies_;
  detail::SceneSearch found_;
};

BodiesIdentification nothing_found(const frac::Structure& joint, bool is_given) {
  BodiesIdentification result{};
  result.termination = frac::FitTermination::no_usable_start;
  result.message = is_given ? "No point lies on a symmetric orbit of two impacts of the given scene, with which alone "
                              "points are compared."
                            : "nowhere that was tried do enough points lie on a symmetric orbit of two impacts; give "
                              "starts by what is known";
  for (const std::string& name : joint.parameter_names()) {
    result.parameters.push_back({name, "", nan, nan, nan, nan, false, false, false});
  }
  result.condition = result.cost = result.rms = nan;
  return result;
}

}  // namespace

LinearBodies BodiesStructure::bodies(const std::vector<double>& values) const {
  const frac::Structure joint = detail::joint_structure(*this);
  const auto body = [&](const frac::Structure& formula) {
    std::vector<double> own;
    for (const std::string& name : formula.parameter_names()) own.push_back(values[joint.parameter_index(name)]);
    return frac::to_transfer_function(formula, own);
  };
  return {body(load), body(drive), values[values.size() - 2], values[values.size() - 1]};
}

std::string BodiesIdentification::summary() const {
  return detail::summary_of(parameters, message);
}

BodiesIdentification identify_bodies(const std::vector<MeasuredDescribingFunction>& curves,
                                     const BodiesStructure& structure, const SceneIdentificationOptions& options) {
  const auto begin = std::chrono::steady_clock::now();
  detail::check_curves(curves, options);
  if (std::any_of(curves.begin(), curves.end(), [](const auto& curve) { return curve.harmonic != 1; }))
    throw std::invalid_argument("a curve is of a harmonic above the first, which is followed for free masses only");
  check_names(structure);
  if (options.friction != FrictionModel::none)
    throw std::invalid_argument("friction is " + std::string(to_string(options.friction)) +
                                "; of bodies with receptances dry friction is not estimated, and only none is allowed");
  if (options.contact == ContactModel::compliant)
    throw std::invalid_argument(
        "contact is compliant; of bodies with receptances contacts take no time, and only auto or hard is allowed");
  const detail::SceneData data = detail::scene_data(curves, options, detail::LoadAtRest::kept);
  const frac::Structure joint = detail::joint_structure(structure);
  const std::vector<double> jumps = detail::products_from_jumps(curves);
  std::vector<frac::ParameterConstraint> constraints = with_defaults(structure, joint, options.constraints);
  BodiesSearch as_given(structure, joint, data, constraints);
  as_given.run(structure, joint, jumps, options.threads);
  // Bodies with friction or springs below 0 may have an orbit that none settles on.  Where the search goes there and
  // finds no motion, those from 0 on are what is left.
  std::optional<BodiesSearch> from_zero;
  if (!as_given.found().best.usable) {
    bool is_other = false;
    for (std::size_t i = 0; i < joint.parameter_names().size(); ++i) {
      frac::ParameterConstraint& each = frac::constraint_of(constraints, joint.parameter_names()[i]);
      if (!may_be_negative(joint, i, each)) continue;
      each.lower = 0;
      is_other = true;
    }
    if (is_other) {
      from_zero.emplace(structure, joint, data, constraints);
      from_zero->run(structure, joint, jumps, options.threads);
    }
  }
  const BodiesSearch& search = from_zero ? *from_zero : as_given;
  const detail::SceneSearch& found = search.found();

  BodiesIdentification result = nothing_found(joint, search.map().free().empty());
  result.starts = found.starts;
  if (found.best.usable) {
    detail::SceneAnswer answer = detail::answer_of(search.bodies(), found, options.sigma_is_measured);
    const bool at_limit = std::any_of(answer.estimates.begin(), answer.estimates.end(),
                                      [](const SceneEstimate& estimate) { return estimate.at_bound; });
    if (!answer.misfits.empty() || !answer.converged || at_limit) detail::take_back(answer.estimates);
    detail::fill_in(answer, found, result);
    result.parameters = answer.estimates;
    result.covariance = answer.covariance;
    result.bodies = structure.bodies(detail::values_at(search.map(), found.best.theta));
    detail::MessageParts parts;
    if (answer.points_used < answer.points.size())
      parts.of_family = " Points are compared with the symmetric orbit of two impacts alone.";
    if (from_zero) parts.of_family += " With friction or springs below 0 no steady motion was found.";
    result.message = detail::message_of(answer, result.parameters, parts);
  }
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return result;
}

}  // namespace backlash
