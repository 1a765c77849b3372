// SPDX-License-Identifier: BSD-3-Clause
#include "profile.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>

namespace frac::detail {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
// A coefficient that may be this many e-folds away from its estimate is not bounded by the data.
constexpr double open_reach = 60;

/// One parameter along its interval.  Positive coefficients are followed as logarithms, in which intervals are nearly
/// symmetric.
class Profile {
 public:
  Profile(Problem& problem, const LocalSolution& solution, const LocalOptions& options, const Confidence& confidence,
          const ProfileCentre& centre)
      : problem_(problem),
        options_(options),
        confidence_(confidence),
        of_(centre),
        wanted_(confidence.t * centre.widening),
        best_(problem.map.to_user(solution.theta)),
        best_objective_(solution.objective) {
    options_.cost_tolerance = 1e-10;
    for (const ParameterMap::Free& entry : problem.map.free()) {
      if (problem.structure.parameter_names()[entry.parameter] != centre.name) continue;
      parameter_ = entry.parameter;
      logarithmic_ = entry.logarithmic;
      lower_ = entry.least;
      upper_ = entry.most;
    }
    if (logarithmic_) {
      lower_ = lower_ > 0 ? std::log(lower_) : -infinity;
      upper_ = std::log(upper_);
    }
  }

  [[nodiscard]] bool below_minimum() const { return below_minimum_; }
  [[nodiscard]] bool stuck() const { return stuck_; }
  [[nodiscard]] double lower_limit() const { return user(lower_); }
  [[nodiscard]] double upper_limit() const { return user(upper_); }

  /// -infinity or infinity where there is none.
  double end(int side, double tolerance, int steps) {
    double error = of_.error;
    if (!(error > 0)) error = 0.01 * std::abs(of_.value) + 1e-300;  // at a bound
    const double centre = logarithmic_ ? std::log(of_.value) : of_.value;
    const double step = wanted_ * (logarithmic_ ? error / of_.value : error);
    inside_ = best_;
    const double found = profile_end([this](double coordinate) { return rise_at(coordinate, wanted_); },
                                     {centre, step, lower_, upper_, logarithmic_}, side, wanted_, tolerance, steps);
    if (!std::isfinite(found)) return found;
    constexpr double suspiciously_near = 0.7;  // in units of what the curvature says
    if (std::abs(found - centre) < suspiciously_near * step)
      stuck_ = stuck_ || walked_to(found, centre) < 0.9 * wanted_;
    return user(found);
  }

 private:
  [[nodiscard]] double user(double coordinate) const { return logarithmic_ ? std::exp(coordinate) : coordinate; }

  /// The rise at a coordinate after small steps, each from where the last one ended: where solves of the other
  /// parameters stick in one leap, these go on.
  double walked_to(double coordinate, double centre) {
    inside_ = best_;
    constexpr int steps = 8;
    double rise = 0;
    for (int i = 1; i <= steps; ++i) rise = rise_at(centre + (coordinate - centre) * i / steps, infinity);
    return rise;
  }

  /// Square root of the rise of the objective above its minimum, in units of that of one standard error.
  /// @param outside  rise from which on the next solve does not start from this one
  double rise_at(double coordinate, double outside) {
    const double value = user(coordinate);
    if (!std::isfinite(value) || (logarithmic_ && !(value > 0))) return infinity;
    const std::unique_ptr<Problem> held = problem_.held(of_.name, value);
    Residuals& residuals = held->residuals();
    residuals.set_priors(problem_.priors, problem_.residuals().prior_weight());
    residuals.set_loss(options_.loss, options_.loss_scale);
    const ParameterMap& map = held->map;
    // From the farthest point inside: one outside may lie in another valley.
    std::vector<double> start = map.to_theta(predicted(user(coordinate)));
    const std::vector<double> unmoved = map.to_theta(inside_);
    if (!(residuals.cost(start) < residuals.cost(unmoved))) start = unmoved;
    if (!std::isfinite(residuals.cost(start))) return infinity;
    const LocalSolution solution = local_solve(residuals, start, options_);
    if (!std::isfinite(solution.objective)) return infinity;
    // Costs at rounding are all the same.
    below_minimum_ = below_minimum_ || solution.objective + residuals.rounding_cost() < best_objective_ * (1 - 1e-6);
    const double rise = std::sqrt(std::max(0.0, solution.objective - best_objective_) / confidence_.loss_unit);
    if (rise < outside) inside_ = map.to_user(solution.theta);
    return rise;
  }

  /// The other parameters moved along with the held one as their covariance in white noise says, positive ones as
  /// logarithms: in relative terms of the estimates, in which the covariance holds farthest.
  [[nodiscard]] std::vector<double> predicted(double value) const {
    std::vector<double> result = inside_;
    if (!parameter_) return result;
    const std::size_t held = *parameter_;
    const auto spread_of = [&](std::size_t i) { return confidence_.spread.row(static_cast<Eigen::Index>(i)); };
    const double change = logarithmic_ ? best_[held] * std::log(value / inside_[held]) : value - inside_[held];
    for (const ParameterMap::Free& entry : problem_.map.free()) {
      const std::size_t i = entry.parameter;
      if (i == held || !std::isfinite(confidence_.covariance[i][held])) continue;
      const double shift = spread_of(i).dot(spread_of(held)) / spread_of(held).squaredNorm() * change;
      if (entry.logarithmic) {
        result[i] *= std::exp(std::clamp(shift / best_[i], -3.0, 3.0));
      } else {
        result[i] += shift;
      }
    }
    result[held] = value;
    return result;
  }

  Problem& problem_;
  LocalOptions options_;
  const Confidence& confidence_;
  ProfileCentre of_;
  std::optional<std::size_t> parameter_;  // of the structure
  double wanted_;                         // standard errors to an end, in white noise
  std::vector<double> best_;
  double best_objective_;
  std::vector<double> inside_;  // parameters at the farthest point within the interval
  bool logarithmic_ = false;
  double lower_ = -infinity, upper_ = infinity;  // of the coordinate
  bool below_minimum_ = false, stuck_ = false;
};

}  // namespace

double profile_end(const std::function<double(double)>& rise, const ProfileLine& line, int side, double wanted,
                   double tolerance, int steps) {
  const double limit = side < 0 ? line.lower : line.upper;
  double inside = line.centre, inside_rise = 0, outside = side * infinity, outside_rise = infinity;
  // A standard error of many e-folds says no more than that the interval is wide, and would overflow.
  const double widest_step = line.logarithmic ? open_reach / 4 : infinity;
  double at = line.centre + side * std::min(line.step, widest_step);
  for (int step = 0; step < steps; ++step) {
    if (side * at >= side * limit) at = limit;
    const double here = rise(at);
    if (here < wanted * (1 - tolerance)) {
      if (at == limit) return side * infinity;
      inside = at;
      inside_rise = here;
    } else {
      outside = at;
      outside_rise = here;
    }
    if (std::isfinite(here) && std::abs(here - wanted) <= tolerance * wanted) return at;
    if (std::isinf(outside)) {
      const double factor = here > 0 ? std::clamp(1.1 * wanted / here, 1.2, 3.0) : 3.0;
      at = line.centre + factor * (at - line.centre);
      if (line.logarithmic && std::abs(at - line.centre) > open_reach) return side * infinity;
      continue;
    }
    if (std::abs(outside - inside) <= tolerance * std::abs(inside - line.centre)) return inside;
    // The secant through both, but no small step from within: a point far outside says little of the way there.
    const double share = std::isfinite(outside_rise) ? (wanted - inside_rise) / (outside_rise - inside_rise) : 0.5;
    at = inside + std::clamp(share, 0.25, 0.95) * (outside - inside);
  }
  return outside;
}

ProfileCentre profile_centre(const Problem& problem, const LocalSolution& solution, const Confidence& confidence,
                             std::size_t parameter) {
  return {problem.structure.parameter_names()[parameter], problem.map.to_user(solution.theta)[parameter],
          confidence.standard_error[parameter], confidence.widening[parameter]};
}

ProfileEnds profile_ends(Problem& problem, const LocalSolution& solution, const LocalOptions& options,
                         const Confidence& confidence, const ProfileCentre& centre, double tolerance, int steps) {
  Profile profile(problem, solution, options, confidence, centre);
  const double lower = profile.end(-1, tolerance, steps);
  const double upper = profile.end(1, tolerance, steps);
  return {lower, upper, profile.lower_limit(), profile.upper_limit(), profile.below_minimum(), profile.stuck()};
}

}  // namespace frac::detail
