// SPDX-License-Identifier: BSD-3-Clause
#include "bodies_model.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <utility>

#include "loops/equations/forced_orbits.hpp"
#include "loops/equations/gap_response.hpp"
#include "loops/motions/symmetric_forced_orbit.hpp"
#include "scene_uncertainty.hpp"

namespace backlash::detail {
namespace {

using Complex = std::complex<double>;
using Kind = PointChoice::Kind;

// Of central differences: the third derivative and the rounding of N, 1e-13, then leave about eight digits.
constexpr double difference_step = 1e-4;

Complex read(const ForcedOrbits::Orbit& orbit, Output output) {
  return (output == Output::x1 ? orbit.x1 : orbit.x2) / orbit.force;
}

class OrbitModel {
 public:
  OrbitModel(LinearBodies bodies, Output output)
      : bodies_(std::move(bodies)), response_(gap_response(bodies_)), output_(output) {}

  // Where the force is too small, the orbit of the least force continues it smoothly enough for a search.
  [[nodiscard]] Complex value(const MeasuredPoint& point) const {
    return read(ForcedOrbits(bodies_, response_, point.omega).at(point.force, true), output_);
  }
  [[nodiscard]] Complex free_value(const MeasuredPoint& point) const {
    return output_ == Output::x1 ? 0.0 : bodies_.drive().response(point.omega);
  }
  [[nodiscard]] bool moves_freely(const MeasuredPoint& point) const {
    return output_ == Output::x2 && point.force * std::abs(free_value(point)) < 0.5 * bodies_.system().clearance();
  }
  // That is enough to compare places.
  [[nodiscard]] bool has_orbit(const MeasuredPoint& point) const {
    const ForcedOrbits orbits(bodies_, response_, point.omega);
    return point.force >= orbits.least_force() && orbits.at(point.force, true).impulse > 0;
  }
  // Bodies follow the orbit: it stays off the walls and is stable.
  [[nodiscard]] bool has_motion(const MeasuredPoint& point) const {
    const SymmetricForcedOrbit orbit(bodies_, response_, point.force, point.omega);
    return orbit.exists() && orbit.is_stable();
  }

 private:
  LinearBodies bodies_;
  ImpulseAnswer response_;
  Output output_;
};

class BodiesMotions final : public SceneMotions {
 public:
  BodiesMotions(const BodiesStructure& structure, const SceneData& data, const frac::detail::ParameterMap& map,
                Effort effort)
      : structure_(structure), data_(data), map_(map), effort_(effort) {}

  [[nodiscard]] Pace pace() const override {
    if (effort_ == Effort::glance) return {rounds_of_a_glance, iterations_of_a_glance};
    return {most_rounds, most_iterations, 0, near_step};
  }

  void choose(const Coordinates& theta, int, PointChoices& choices) override {
    std::fill(choices.begin(), choices.end(), PointChoice{});
    const std::optional<OrbitModel> model = model_at(theta);
    for (std::size_t i = 0; i < choices.size() && model; ++i) {
      const MeasuredPoint& point = data_.points[i];
      if (effort_ == Effort::settle ? model->has_motion(point) : model->has_orbit(point))
        choices[i].offer(data_, point, Kind::two_impact, model->value(point));
      if (model->moves_freely(point)) choices[i].offer(data_, point, Kind::free, model->free_value(point));
    }
  }

  [[nodiscard]] PointValues values(const Coordinates& theta, const PointChoices& choices, bool all) const override {
    const std::optional<OrbitModel> model = model_at(theta);
    return of_used(choices, all, [&](std::size_t i) -> std::optional<Complex> {
      if (!model) return std::nullopt;
      const MeasuredPoint& point = data_.points[i];
      const Complex value = choices[i].kind == Kind::free ? model->free_value(point) : model->value(point);
      if (!std::isfinite(std::abs(value))) return std::nullopt;
      return value;
    });
  }

  [[nodiscard]] PointGradients gradients(const Coordinates& theta, const PointChoices& choices) const override {
    const auto here = values(theta, choices, true);
    auto result = of_used(choices, true, [&](std::size_t i) -> std::optional<PointGradient> {
      if (!here[i]) return std::nullopt;
      return PointGradient{*here[i], std::vector<Complex>(theta.size())};
    });
    Coordinates moved = theta;
    for (std::size_t k = 0; k < theta.size(); ++k) {
      const auto& free = map_.free()[k];
      const double step = difference_step * std::max(1e-3, free.logarithmic ? 1 : std::abs(theta[k]));
      const double high = std::min(theta[k] + step, free.upper), low = std::max(theta[k] - step, free.lower);
      moved[k] = high;
      const auto above = values(moved, choices, true);
      moved[k] = low;
      const auto below = values(moved, choices, true);
      moved[k] = theta[k];
      for (std::size_t i = 0; i < result.size(); ++i) {
        if (!result[i]) continue;
        if (above[i] && below[i])
          result[i]->gradient[k] = (*above[i] - *below[i]) / (high - low);
        else
          result[i].reset();
      }
    }
    return result;
  }

  [[nodiscard]] Regime regime(const Coordinates&, const MeasuredPoint&, const PointChoice& choice) const override {
    return choice.kind == Kind::none ? Regime::averaged : choice.kind == Kind::free ? Regime::free : Regime::symmetric;
  }

 private:
  // Empty where an order leaves no mass, or poles could not be counted.
  [[nodiscard]] std::optional<OrbitModel> model_at(const Coordinates& theta) const {
    try {
      return OrbitModel(structure_.bodies(values_at(map_, theta)), data_.output);
    } catch (const std::invalid_argument&) {
      return std::nullopt;
    }
  }

  const BodiesStructure& structure_;
  const SceneData& data_;
  const frac::detail::ParameterMap& map_;
  Effort effort_;
};

SceneBounds bounds_of(const frac::detail::ParameterMap& map) {
  SceneBounds bounds;
  for (const auto& free : map.free()) {
    bounds.lower.push_back(free.lower);
    bounds.upper.push_back(free.upper);
  }
  return bounds;
}

}  // namespace

frac::Structure joint_structure(const BodiesStructure& structure) {
  // Sums tell that coefficients are positive; products, that restitution has no unit.
  return frac::Structure("((" + structure.load.formula() + ") + (" + structure.drive.formula() +
                         ") + clearance) (1 + restitution)");
}

std::vector<double> values_at(const frac::detail::ParameterMap& map, const Coordinates& theta) {
  std::vector<double> values = map.to_user(theta);
  values.back() = std::min(values.back(), 1.0);
  return values;
}

Bodies::Bodies(const BodiesStructure& structure, const SceneData& data, const frac::Structure& joint,
               const frac::detail::ParameterMap& map)
    : SceneFamily(data, bounds_of(map)), structure_(structure), joint_(joint), map_(map) {}

std::shared_ptr<SceneMotions> Bodies::motions(Effort effort, Motions) const {
  return std::make_shared<BodiesMotions>(structure_, data(), map_, effort);
}

bool Bodies::agree(const Coordinates& one, const Coordinates& other, double within) const {
  return std::equal(one.begin(), one.end(), other.begin(),
                    [&](double a, double b) { return std::abs(a - b) < within; });
}

bool Bodies::is_ideal(std::size_t k) const {
  const auto& free = map_.free()[k];
  const std::string& name = joint_.parameter_names()[free.parameter];
  return free.role == frac::ParameterRole::coefficient && free.least == 0 && !free.logarithmic && name != "clearance" &&
         name != "restitution";
}

std::string Bodies::coordinate_name(std::size_t k) const {
  return (map_.free()[k].logarithmic ? "ln " : "") + joint_.parameter_names()[parameter_of(k)];
}

std::vector<Quantity> Bodies::parameters(const Coordinates& theta) const {
  const std::vector<double> values = values_at(map_, theta);
  std::vector<Quantity> result;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const bool is_clearance = i + 2 == values.size(), is_restitution = i + 1 == values.size();
    result.push_back({joint_.parameter_names()[i],
                      is_clearance     ? "m"
                      : is_restitution ? "1"
                                       : "",
                      values[i], std::vector<double>(theta.size())});
  }
  for (const auto& entry : map_.jacobian_entries(values))
    result[entry.parameter].gradient[entry.free] += entry.derivative;
  for (std::size_t k = 0; k < theta.size(); ++k) {
    result[parameter_of(k)].own_coordinate = k;
    if (is_ideal(k)) result[parameter_of(k)].from_zero = true;
  }
  return result;
}

std::vector<SceneEstimate> Bodies::estimates(const SceneUncertainty& uncertainty) const {
  std::vector<SceneEstimate> result;
  for (const Quantity& parameter : parameters(uncertainty.theta())) result.push_back(uncertainty.estimate(parameter));
  return result;
}

}  // namespace backlash::detail
