// SPDX-License-Identifier: BSD-3-Clause
#include "bodies_model.hpp"

#include <cmath>
#include <stdexcept>

#include "frac/parallel_for.hpp"
#include "loops/equations/forced_orbits.hpp"
#include "loops/equations/gap_response.hpp"
#include "loops/motions/symmetric_forced_orbit.hpp"
#include "scene_evidence.hpp"

namespace backlash::detail {
namespace {

using Complex = std::complex<double>;

// Of central differences: the third derivative and the rounding of N, 1e-13, then leave about eight digits.
constexpr double difference_step = 1e-4;

Complex read(const ForcedOrbits::Orbit& orbit, Output output) {
  return (output == Output::x1 ? orbit.x1 : orbit.x2) / orbit.force;
}

class OrbitModel {
 public:
  OrbitModel(const LinearBodies& bodies, Output output)
      : bodies_(bodies), response_(gap_response(bodies)), output_(output) {}

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
  [[nodiscard]] bool has_orbit(const MeasuredPoint& point, OrbitCheck check) const {
    if (check == OrbitCheck::existence) {
      const ForcedOrbits orbits(bodies_, response_, point.omega);
      return point.force >= orbits.least_force() && orbits.at(point.force, true).impulse > 0;
    }
    const SymmetricForcedOrbit orbit(bodies_, response_, point.force, point.omega);
    return orbit.exists() && orbit.is_stable();
  }

 private:
  const LinearBodies& bodies_;
  ImpulseAnswer response_;
  Output output_;
};

}  // namespace

frac::Structure joint_structure(const BodiesStructure& structure) {
  // Sums tell that coefficients are positive; products, that restitution has no unit.
  return frac::Structure("((" + structure.load.formula() + ") + (" + structure.drive.formula() +
                         ") + clearance) (1 + restitution)");
}

std::vector<PointChoice> choose_orbits(const LinearBodies& bodies, const SceneData& data, std::size_t parameters,
                                       OrbitCheck check, int threads) {
  const OrbitModel model(bodies, data.output);
  std::vector<PointChoice> choices(data.points.size());
  frac::parallel_for(choices.size(), threads, [&](std::size_t i) {
    const MeasuredPoint& point = data.points[i];
    PointChoice& choice = choices[i];
    const auto offer = [&](PointChoice::Kind kind, Complex value) {
      const double deviation = data.deviation(point, value);
      if (!(deviation > 0)) return;
      const double misfit = data.size(value - point.value) / deviation;
      if (choice.kind != PointChoice::Kind::none && choice.misfit <= misfit) return;
      choice.kind = kind;
      choice.model = value;
      choice.misfit = misfit;
    };
    if (model.has_orbit(point, check)) offer(PointChoice::Kind::two_impact, model.value(point));
    if (model.moves_freely(point)) offer(PointChoice::Kind::free, model.free_value(point));
  });
  use_by_evidence(data, choices, parameters, Effort::settle);
  return choices;
}

BodiesResiduals::BodiesResiduals(const BodiesStructure& structure, const SceneData& data,
                                 const frac::detail::ParameterMap& map, const std::vector<PointChoice>& choices)
    : Residuals(map), structure_(structure), data_(data) {
  for (std::size_t i = 0; i < choices.size(); ++i) {
    if (!choices[i].used) continue;
    used_.push_back({i, choices[i].kind, data.deviation(data.points[i], choices[i].model)});
  }
}

bool BodiesResiduals::residuals_at(std::span<const double> theta, double* residual) const {
  try {
    const LinearBodies bodies = structure_.bodies(map().to_user(theta));
    const OrbitModel model(bodies, data_.output);
    for (const Used& used : used_) {
      const MeasuredPoint& point = data_.points[used.point];
      const Complex value = used.kind == PointChoice::Kind::free ? model.free_value(point) : model.value(point);
      const auto parts = data_.parts((value - point.value) / used.deviation);
      for (std::size_t part = 0; part < per_point(); ++part) {
        if (!std::isfinite(parts[part])) return false;
        *residual++ = parts[part];
      }
    }
  } catch (const std::invalid_argument&) {
    // An order that leaves no mass, or poles that could not be counted.
    return false;
  }
  return true;
}

bool BodiesResiduals::evaluate(std::span<const double> theta, double* residual, double* jacobian) const {
  if (!residuals_at(theta, residual)) return false;
  if (!jacobian) return true;
  std::vector<double> moved(theta.begin(), theta.end()), above(count()), below(count());
  for (std::size_t k = 0; k < moved.size(); ++k) {
    const auto& free = map().free()[k];
    const double step = difference_step * std::max(1e-3, free.logarithmic ? 1 : std::abs(theta[k]));
    const double high = std::min(theta[k] + step, free.upper), low = std::max(theta[k] - step, free.lower);
    moved[k] = high;
    if (!residuals_at(moved, above.data())) return false;
    moved[k] = low;
    if (!residuals_at(moved, below.data())) return false;
    moved[k] = theta[k];
    for (std::size_t i = 0; i < count(); ++i) jacobian[k * count() + i] = (above[i] - below[i]) / (high - low);
  }
  return true;
}

}  // namespace backlash::detail
