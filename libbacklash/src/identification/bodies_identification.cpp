// SPDX-License-Identifier: BSD-3-Clause
#include "backlash/identification/bodies_identification.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "base/short_text.hpp"
#include "bodies_model.hpp"
#include "frac/identification/constraints.hpp"
#include "frac/parallel_for.hpp"
#include "identification/statistics/confidence.hpp"
#include "scene_adequacy.hpp"
#include "scene_data.hpp"
#include "scene_evidence.hpp"
#include "scene_start.hpp"
#include "scene_uncertainty.hpp"

namespace backlash {
namespace {

using frac::detail::ParameterMap;
using Values = std::vector<double>;
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

// Places of the grid of masses, clearance and restitution, and what share of the forces of inertia friction and springs
// begin with.
constexpr std::size_t grid_places = 8;
constexpr std::array<double, 2> shares = {0.01, 0.2};
// Points that tell places apart, rounds from each, and places of which the estimate is looked for.
constexpr std::size_t scouting_points = 24;
constexpr int scouting_rounds = 2;
constexpr std::size_t settled_places = 4;
// Evidence, as -2 ln of odds: of a place worth an estimate against the best one; of a rival, 150 to 1; of one estimate
// reached twice.
constexpr double worth_settling = 100;
constexpr double rival_deviance = 10;
constexpr double same_deviance = 0.01;
// Places whose coordinates lie this near to an estimate lead to it.
constexpr double same_place = 0.05;
constexpr int most_rounds = 15;
constexpr double default_range = 13.8;  // ln 1e6, of masses and clearance about what the data suggest
constexpr double largest_order = 2;     // from there on a term would count as mass

struct Place {
  Values theta;
  std::vector<detail::PointChoice> choices;
  double deviance = std::numeric_limits<double>::infinity();
  bool converged = false;
  std::size_t reached = 1;  // from how many starts
};

frac::detail::DataScale scale_of(const detail::SceneData& data) {
  const auto [low, high] =
      std::minmax_element(data.points.begin(), data.points.end(),
                          [](const auto& one, const auto& other) { return one.omega < other.omega; });
  return {data.typical, data.typical, data.typical, std::sqrt(low->omega * high->omega), low->omega, high->omega};
}

std::vector<frac::ParameterConstraint> with_defaults(const frac::Structure& joint,
                                                     std::vector<frac::ParameterConstraint> constraints) {
  const auto limit = [&](const std::string& name, double lower, double upper) {
    for (frac::ParameterConstraint& each : constraints) {
      if (each.name != name) continue;
      if (each.fixed) return;
      each.lower = std::max(each.lower.value_or(lower), lower);
      each.upper = std::min(each.upper.value_or(upper), upper);
      return;
    }
    constraints.push_back({name, {}, lower, upper, {}});
  };
  limit("restitution", 0, 1);
  for (std::size_t i = 0; i < joint.parameter_names().size(); ++i) {
    if (joint.parameter_roles()[i] == frac::ParameterRole::order) {
      limit(joint.parameter_names()[i], 0, largest_order);
    }
  }
  // A mass that stands alone, in 1/(m s^2), looks like a gain, which may have either sign.
  for (std::size_t i = 0; i < joint.parameter_names().size(); ++i) {
    if (joint.parameter_roles()[i] != frac::ParameterRole::coefficient) continue;
    frac::ParameterConstraint& each = frac::constraint_of(constraints, joint.parameter_names()[i]);
    if (!each.lower && !each.fixed) each.positive = true;
  }
  return constraints;
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
    for (const ParameterMap::Free& free : map.free()) theta.push_back(std::clamp(0.0, free.lower, free.upper));
    base_ = map.to_user(theta);
    for (std::size_t i = 0; i < base_.size(); ++i) {
      if (joint.parameter_roles()[i] == frac::ParameterRole::order) base_[i] = 1;
      if (std::isfinite(map.start()[i])) base_[i] = map.start()[i];
    }
    bodies_[0] = body_of(structure.load, 0);
    bodies_[1] = body_of(structure.drive, 1);
  }

  [[nodiscard]] std::vector<Values> all() const {
    std::vector<Values> starts;
    for (const detail::SceneVector& scene : scenes()) {
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
  [[nodiscard]] double mass_of(const Body& body, const Values& values) const {
    const TwoMassSystem system = structure_.bodies(values).system();
    return body.number == 0 ? system.mass1() : system.mass2();
  }
  [[nodiscard]] Body body_of(const frac::Structure& formula, std::size_t number) const {
    Body body{&formula, number, {}, 1, {}};
    for (const std::string& name : formula.parameter_names()) {
      const std::size_t parameter = joint_.parameter_index(name);
      if (!is_open(parameter)) continue;
      Values doubled = base_;
      doubled[parameter] *= 2;
      const double exponent = std::log2(mass_of(body, doubled) / mass_of(body, base_));
      if (std::abs(exponent) > 1e-9 && !body.mass) {
        body.mass = parameter;
        body.exponent = exponent;
      } else if (std::abs(exponent) <= 1e-9) {
        body.others.push_back(parameter);
      }
    }
    return body;
  }

  [[nodiscard]] std::vector<detail::SceneVector> scenes() const {
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
      if (!body.mass) fixed[body.number] = mass_of(body, base_);
    }
    const std::size_t clearance = base_.size() - 2, restitution = base_.size() - 1;
    if (!is_open(clearance)) fixed[2] = base_[clearance];
    if (!is_open(restitution)) fixed[3] = base_[restitution];
    for (std::size_t k = 0; k < 4; ++k) {
      if (fixed[k]) bounds.lower[k] = bounds.upper[k] = k == 3 ? *fixed[k] : std::log(*fixed[k]);
    }
    return scene_starts(data_, bounds, fixed, jumps_, false, grid_places);
  }

  [[nodiscard]] Values values(const detail::SceneVector& scene, double share) const {
    Values values = base_;
    const std::size_t clearance = base_.size() - 2, restitution = base_.size() - 1;
    if (is_open(clearance)) values[clearance] = std::exp(scene[2]);
    if (is_open(restitution)) values[restitution] = scene[3];
    const double omega = map_.scale().omega;
    for (const Body& body : bodies_) {
      const double wanted = std::exp(scene[body.number]);
      if (body.mass) values[*body.mass] *= std::pow(wanted / mass_of(body, values), 1 / body.exponent);
      for (const std::size_t other : body.others) {
        const auto stiffness = [&](double factor) {
          Values scaled = values;
          scaled[other] *= factor;
          const LinearBodies bodies = structure_.bodies(scaled);
          return 1.0 / (body.number == 0 ? bodies.load() : bodies.drive()).response(omega);
        };
        const double rise = 2 * std::abs(stiffness(1) - stiffness(0.5));
        if (rise > 0) values[other] *= share * mass_of(body, values) * omega * omega / rise;
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

// Every n-th point.
detail::SceneData thinned(const detail::SceneData& data) {
  detail::SceneData few = data;
  few.points.clear();
  const std::size_t stride = (data.points.size() + scouting_points - 1) / scouting_points;
  for (std::size_t i = 0; i < data.points.size(); i += stride) few.points.push_back(data.points[i]);
  return few;
}

class Searcher {
 public:
  Searcher(const BodiesStructure& structure, const detail::SceneData& data, const ParameterMap& map)
      : structure_(structure), data_(data), few_(thinned(data)), map_(map) {}

  // A few rounds with some of the points and every orbit that exists.
  [[nodiscard]] Place scout(const Values& start) const {
    constexpr frac::detail::LocalOptions rough{8, 1e-3};
    Place place{start, {}};
    for (int round = 0; round < scouting_rounds; ++round) {
      if (!choose(few_, detail::OrbitCheck::existence, 1, place)) break;
      solve(few_, rough, place);
    }
    return choose(few_, detail::OrbitCheck::existence, 1, place) ? place : unusable();
  }

  // The estimate next to a place: motions and least squares in turn, until neither changes.
  [[nodiscard]] Place settle(Place place, int threads) const {
    constexpr frac::detail::LocalOptions fine{};
    std::vector<bool> used_before;
    for (int round = 0; round < most_rounds; ++round) {
      if (!choose(data_, detail::OrbitCheck::motion, threads, place)) return unusable();
      std::vector<bool> used;
      for (const detail::PointChoice& choice : place.choices) used.push_back(choice.used);
      const double before = place.deviance;
      place.converged = solve(data_, fine, place) && used == used_before;
      if (!choose(data_, detail::OrbitCheck::motion, threads, place)) return unusable();
      if (place.converged && std::abs(place.deviance - before) < 1e-6) break;
      used_before = std::move(used);
    }
    return place;
  }

  [[nodiscard]] detail::BodiesResiduals residuals(const Place& place) const {
    return {structure_, data_, map_, place.choices};
  }

 private:
  // Its evidence is none.
  [[nodiscard]] static Place unusable() { return {}; }

  // False where too few points are left to say anything.
  bool choose(const detail::SceneData& data, detail::OrbitCheck check, int threads, Place& place) const {
    const std::size_t parameters = map_.free().size();
    place.deviance = std::numeric_limits<double>::infinity();
    try {
      place.choices = choose_orbits(structure_.bodies(map_.to_user(place.theta)), data, parameters, check, threads);
    } catch (const std::invalid_argument&) {
      return false;
    }
    const detail::SceneEvidence evidence = scene_evidence(data, place.choices, parameters, detail::Effort::settle);
    place.deviance = evidence.deviance;
    // Fewer residuals than twice the parameters can be met by nearly anything.
    return evidence.used * data.residuals_per_point() >= 2 * parameters && std::isfinite(evidence.deviance);
  }
  bool solve(const detail::SceneData& data, const frac::detail::LocalOptions& options, Place& place) const {
    const detail::BodiesResiduals residuals(structure_, data, map_, place.choices);
    const frac::detail::LocalSolution solution = local_solve(residuals, place.theta, options);
    if (!std::isfinite(solution.cost)) return false;
    place.theta = solution.theta;
    return solution.converged;
  }

  const BodiesStructure& structure_;
  const detail::SceneData& data_;
  detail::SceneData few_;
  const ParameterMap& map_;
};

bool is_better(const Place& one, const Place& other) {
  return one.deviance < other.deviance;
}

struct Found {
  std::vector<Place> settled;  // best first
  std::size_t starts;
};

bool is_near(const Place& one, const Place& other) {
  for (std::size_t k = 0; k < one.theta.size(); ++k) {
    if (!(std::abs(one.theta[k] - other.theta[k]) < same_place)) return false;
  }
  return true;
}

Found search(const Searcher& searcher, const std::vector<Values>& starts, int threads) {
  std::vector<Place> places(starts.size());
  frac::parallel_for(starts.size(), threads, [&](std::size_t i) { places[i] = searcher.scout(starts[i]); });
  std::stable_sort(places.begin(), places.end(), is_better);
  Found found{{}, starts.size()};
  for (const Place& place : places) {
    if (!std::isfinite(place.deviance)) break;
    if (found.settled.size() == settled_places || !(place.deviance <= places.front().deviance + worth_settling)) break;
    const auto known = std::find_if(found.settled.begin(), found.settled.end(),
                                    [&](const Place& settled) { return is_near(place, settled); });
    if (known != found.settled.end()) {
      ++known->reached;
      continue;
    }
    Place settled = searcher.settle(place, threads);
    if (std::isfinite(settled.deviance)) found.settled.push_back(std::move(settled));
  }
  std::stable_sort(found.settled.begin(), found.settled.end(), is_better);
  return found;
}

std::vector<SceneEstimate> estimates_of(const frac::Structure& joint, const ParameterMap& map,
                                        const frac::detail::Confidence& confidence, const Values& values) {
  std::vector<SceneEstimate> estimates;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const bool is_gap = i + 2 >= values.size();
    SceneEstimate estimate{joint.parameter_names()[i],
                           !is_gap                  ? ""
                           : i + 2 == values.size() ? "m"
                                                    : "1",
                           values[i],
                           map.is_fixed(i) ? 0 : confidence.widening[i] * confidence.standard_error[i],
                           nan,
                           nan,
                           map.is_fixed(i),
                           confidence.at_bound[i],
                           false};
    estimate.ci95_lower = values[i] - (estimate.fixed ? 0 : confidence.t * estimate.standard_error);
    estimate.ci95_upper = values[i] + (estimate.fixed ? 0 : confidence.t * estimate.standard_error);
    estimate.identified = estimate.fixed || detail::is_narrow(estimate);
    estimates.push_back(std::move(estimate));
  }
  return estimates;
}

std::string message_of(const BodiesIdentification& result, bool has_rivals) {
  std::string text = std::to_string(result.points_used) + " of " + std::to_string(result.points.size()) +
                     " points lie on the symmetric orbit of two impacts, rms " + frac::detail::short_text(result.rms) +
                     ".";
  for (const SceneEstimate& estimate : result.parameters) {
    if (estimate.at_bound) text += " " + estimate.name + " is at a limit: fix what is known to lie there.";
  }
  if (result.termination != frac::FitTermination::converged) {
    text += " The search had not settled when it was ended.";
  }
  if (has_rivals) text += " Other values explain the data nearly as well, and the intervals reach over them.";
  for (const std::string& misfit : result.misfits) text += " " + misfit;
  if (!result.misfits.empty()) text += " The model does not describe the data, so that nothing counts as identified.";
  return text;
}

ScenePoint report_of(const detail::SceneData& data, std::size_t i, const detail::PointChoice& choice) {
  const detail::MeasuredPoint& point = data.points[i];
  ScenePoint reported{point.curve,      point.index, point.omega, detail::status_of(choice),
                      Regime::averaged, {nan, nan},  {nan, nan}};
  if (choice.kind == detail::PointChoice::Kind::none) return reported;
  reported.regime = choice.kind == detail::PointChoice::Kind::free ? Regime::free : Regime::symmetric;
  reported.model = choice.model;
  reported.residual = (choice.model - point.value) / data.deviation(point, choice.model);
  return reported;
}

void describe(const BodiesStructure& structure, const frac::Structure& joint, const detail::SceneData& data,
              const ParameterMap& map, const Searcher& searcher, const Found& found, BodiesIdentification& result) {
  const Place& best = found.settled.front();
  const auto confidence_at = [&](const Place& place) {
    const detail::BodiesResiduals residuals = searcher.residuals(place);
    return frac::detail::confidence(residuals, solution_at(residuals, place.theta, {}), {});
  };
  const frac::detail::Confidence confidence = confidence_at(best);
  const Values values = map.to_user(best.theta);
  result.bodies = structure.bodies(values);
  result.parameters = estimates_of(joint, map, confidence, values);
  result.condition = confidence.condition;
  result.free_parameters = confidence.rank;
  result.covariance = confidence.covariance;
  for (std::size_t i = 0; i < values.size(); ++i) {
    for (std::size_t k = 0; k < values.size(); ++k) {
      result.covariance[i][k] *= confidence.widening[i] * confidence.widening[k];
    }
  }
  bool has_rivals = false;
  for (const Place& other : found.settled) {
    if (other.deviance - best.deviance < same_deviance) {
      result.starts_at_best += other.reached;
    } else if (other.deviance - best.deviance < rival_deviance) {
      has_rivals = true;
      const auto rivals = estimates_of(joint, map, confidence_at(other), map.to_user(other.theta));
      for (std::size_t i = 0; i < rivals.size(); ++i) detail::stretch_over(rivals[i], result.parameters[i]);
    }
  }
  const detail::SceneAdequacy adequacy = scene_adequacy(data, best.choices, map.free().size());
  result.misfits = adequacy.misfits;
  result.residual_correlation = adequacy.correlation;
  for (std::size_t i = 0; i < data.points.size(); ++i) {
    result.points.push_back(report_of(data, i, best.choices[i]));
    if (!best.choices[i].used) continue;
    ++result.points_used;
    for (const double part : data.parts(result.points.back().residual)) {
      result.max_residual = std::max(result.max_residual, std::abs(part));
      result.cost += part * part;
    }
  }
  result.residuals = result.points_used * data.residuals_per_point();
  result.rms = std::sqrt(result.cost / static_cast<double>(result.residuals));
  result.termination = best.converged ? frac::FitTermination::converged : frac::FitTermination::not_converged;
  const bool at_limit = std::any_of(result.parameters.begin(), result.parameters.end(),
                                    [](const SceneEstimate& estimate) { return estimate.at_bound; });
  if (!result.misfits.empty() || !best.converged || at_limit) {
    for (SceneEstimate& estimate : result.parameters) estimate.identified = estimate.fixed;
  }
  result.message = message_of(result, has_rivals);
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
  const ParameterMap map(joint, with_defaults(joint, options.constraints), scale_of(data));
  detail::require_residuals(data, map.free().size());
  const Starts starts(structure, joint, map, data, detail::products_from_jumps(curves));
  const Searcher searcher(structure, data, map);
  const Found found = search(searcher, starts.all(), options.threads);

  BodiesIdentification result{};
  result.starts = found.starts;
  if (found.settled.empty()) {
    result.termination = frac::FitTermination::no_usable_start;
    result.message =
        "nowhere that was tried do enough points lie on a symmetric orbit of two impacts; give starts by what is known";
    for (const std::string& name : joint.parameter_names()) {
      result.parameters.push_back({name, "", nan, nan, nan, nan, false, false, false});
    }
    result.condition = result.cost = result.rms = nan;
  } else {
    describe(structure, joint, data, map, searcher, found, result);
  }
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return result;
}

}  // namespace backlash
