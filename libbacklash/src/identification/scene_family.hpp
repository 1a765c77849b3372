// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <complex>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "scene_data.hpp"

namespace backlash::detail {

/// What the search moves: one number for each parameter of a family of scenes, its logarithm or itself.
using Coordinates = std::vector<double>;

struct SceneBounds {
  Coordinates lower, upper;  // equal where fixed
  [[nodiscard]] bool is_free(std::size_t k) const { return lower[k] < upper[k]; }
  [[nodiscard]] std::size_t free_count() const {
    std::size_t count = 0;
    for (std::size_t k = 0; k < lower.size(); ++k) count += is_free(k) ? 1 : 0;
    return count;
  }
};

enum class Effort {
  glance,  // a few steps with cheap motions, to see whether the place is worth more
  rough,   // with cheap motions until nothing changes
  settle,  // with exact motions until nothing changes
};

/// Motions that points may be compared with.
enum class Motions {
  all,
  two_impact,  // in closed form, so that many starts cost little
};

/// How a local search goes on with the motions of a scene.
struct Pace {
  int rounds;
  int iterations;              // of least squares in a round
  int rounds_that_differ = 0;  // the first ones, which may count motions that the others do not
  double last_step = 1e-4;     // a round that moves the estimate by less, in standard errors, is the last
  /// Kinks of N, or ends of motions nearby, stop the steps but not the estimate.
  bool has_kinks = false;
};
constexpr int most_rounds = 20;
constexpr int most_iterations = 12;
constexpr int rounds_of_a_glance = 2;
constexpr int iterations_of_a_glance = 6;
/// The last step where motions cost more or are known to fewer digits; far below what the intervals tell.
constexpr double near_step = 1e-2;

/// N of a point and its derivatives by the coordinates.
struct PointGradient {
  std::complex<double> value;
  std::vector<std::complex<double>> gradient;
};

/// A value of each point, empty where there is none.
using PointValues = std::vector<std::optional<std::complex<double>>>;
using PointGradients = std::vector<std::optional<PointGradient>>;
using PointChoices = std::vector<PointChoice>;

/// What a scene settles on at a point, as simulations from a dozen starts tell.
struct SettledMotion {
  std::complex<double> value;
  bool closes;      // an orbit, not a long mean
  double accuracy;  // to which share of it the simulated scene has the value of the scene
};

/// Steady motions of the scenes of a family, as one local search follows them.
class SceneMotions {
 public:
  virtual ~SceneMotions() = default;
  SceneMotions(const SceneMotions&) = delete;
  SceneMotions& operator=(const SceneMotions&) = delete;

  [[nodiscard]] virtual Pace pace() const = 0;
  /// Accuracy of the motions themselves, as a share of N.
  [[nodiscard]] virtual double accuracy() const { return 1e-7; }

  /// Finds the motion of each point that lies nearest; the scene may have none.
  /// @param round    of the search, from 0 on
  /// @param choices  as the last round left them
  virtual void choose(const Coordinates& theta, int round, PointChoices& choices) = 0;
  /// Lets choose() look again for motions that it has given up on the way.  False where it gives up none.
  virtual bool look_again() { return false; }

  /// N of the points that are used, each by its motion; empty where that has ended, and at points that are not used.
  /// @param all  else the points after the first that has ended are not looked at
  [[nodiscard]] virtual PointValues values(const Coordinates& theta, const PointChoices& choices, bool all) const = 0;
  [[nodiscard]] virtual PointGradients gradients(const Coordinates& theta, const PointChoices& choices) const = 0;

  [[nodiscard]] virtual Regime regime(const Coordinates& theta, const MeasuredPoint& point,
                                      const PointChoice& choice) const = 0;
  /// Motions at a point that is left out; none where nothing is simulated.
  [[nodiscard]] virtual std::vector<SettledMotion> settled(const Coordinates&, const MeasuredPoint&) const {
    return {};
  }

 protected:
  SceneMotions() = default;
};

/// A value of each point that is used, from value_of(point), empty where that is, and at points that are not used.
/// @param all  else the points after the first one without a value are not looked at
template <typename ValueOf>
auto of_used(const PointChoices& choices, bool all, const ValueOf& value_of) {
  std::vector<decltype(value_of(0))> values(choices.size());
  for (std::size_t i = 0; i < choices.size(); ++i) {
    if (!choices[i].used) continue;
    values[i] = value_of(i);
    if (!values[i] && !all) break;
  }
  return values;
}

/// A value that follows from the coordinates, and its derivatives by them.
struct Quantity {
  std::string name, unit;
  double value;
  std::vector<double> gradient;
  bool from_zero = false;  // no less than 0, where its interval ends
  /// Whose limits are its own; without one, of all that it follows from.  A coefficient moves with an order too, in the
  /// natural unit, and is at no limit where that is.
  std::optional<std::size_t> own_coordinate = {};
};

class SceneUncertainty;

/// Scenes that differ in the values of some parameters: what the search is to know of them.
class SceneFamily {
 public:
  virtual ~SceneFamily() = default;
  SceneFamily(const SceneFamily&) = delete;
  SceneFamily& operator=(const SceneFamily&) = delete;

  [[nodiscard]] const SceneData& data() const noexcept { return data_; }
  [[nodiscard]] const SceneBounds& bounds() const noexcept { return bounds_; }
  [[nodiscard]] std::size_t free_count() const { return bounds_.free_count(); }

  [[nodiscard]] virtual std::shared_ptr<SceneMotions> motions(Effort effort, Motions which) const = 0;
  /// Fewest residuals that make an estimate.
  [[nodiscard]] virtual std::size_t least_residuals() const = 0;
  /// Whether places are so near that they count as one, or lead to one estimate.
  [[nodiscard]] virtual bool agree(const Coordinates& one, const Coordinates& other, double within) const = 0;
  /// Whether a coordinate at its lower limit is an ideal that its scenes tend to, which widens the intervals of others,
  /// and no limit of the scene.
  [[nodiscard]] virtual bool is_ideal(std::size_t) const { return false; }
  /// As sentences name it.
  [[nodiscard]] virtual std::string coordinate_name(std::size_t k) const = 0;
  /// All parameters, those that are fixed too, and of a coordinate the place of its own among them.
  [[nodiscard]] virtual std::vector<Quantity> parameters(const Coordinates& theta) const = 0;
  [[nodiscard]] virtual std::size_t parameter_of(std::size_t k) const = 0;
  /// What is stated of an estimate, each with its interval; the parameters come first.
  [[nodiscard]] virtual std::vector<SceneEstimate> estimates(const SceneUncertainty& uncertainty) const = 0;

 protected:
  /// @param data  stays with the caller
  SceneFamily(const SceneData& data, SceneBounds bounds) : data_(data), bounds_(std::move(bounds)) {}

 private:
  const SceneData& data_;
  SceneBounds bounds_;
};

}  // namespace backlash::detail
