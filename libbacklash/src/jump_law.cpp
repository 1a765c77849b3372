#include "backlash/jump_law.hpp"

#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "detail/check.hpp"

namespace backlash {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

void require_list(const std::string& name, const std::vector<double>& values, std::size_t least) {
  if (values.size() < least) {
    throw std::invalid_argument(name + " has " + std::to_string(values.size()) + " entries; at least " +
                                std::to_string(least) + " are needed");
  }
}

void check(double mass1, double mass2, const std::vector<double>& force, const std::vector<double>& clearance,
           const std::vector<double>& restitution) {
  detail::require_positive("mass1", "kg", mass1);
  detail::require_positive("mass2", "kg", mass2);
  require_list("force", force, 2);
  require_list("clearance", clearance, 2);
  require_list("restitution", restitution, 1);
  const auto item = [](const char* name, std::size_t i) { return std::string(name) + "[" + std::to_string(i) + "]"; };
  for (std::size_t i = 0; i < force.size(); ++i) detail::require_positive(item("force", i), "N", force[i]);
  for (std::size_t i = 0; i < clearance.size(); ++i) detail::require_positive(item("clearance", i), "m", clearance[i]);
  for (std::size_t i = 0; i < restitution.size(); ++i) {
    if (!(restitution[i] >= 0 && restitution[i] <= 1)) {
      throw std::invalid_argument(item("restitution", i) + " is " + detail::text(restitution[i]) +
                                  "; it must be in [0, 1]");
    }
  }
}

// Grid on which a curve is searched for its largest discontinuity: c = omega/sqrt(F/(M2 clearance)) from below the
// visible jumps to above them, a third of a percent apart.
constexpr double grid_from = 1.2;
constexpr double grid_to = 1.75;
constexpr std::size_t grid_points = 116;

std::optional<double> largest_discontinuity(const TwoMassSystem& system, double force) {
  const double unit = std::sqrt(force / system.mass2() / system.clearance());
  std::vector<double> omega(grid_points);
  for (std::size_t i = 0; i < grid_points; ++i) {
    omega[i] =
        unit * grid_from * std::pow(grid_to / grid_from, static_cast<double>(i) / static_cast<double>(grid_points - 1));
  }
  SweepOptions options;
  options.threads = 1;
  const DescribingFunctionSweep sweep = describing_function_sweep(system, force, omega, options);
  std::vector<double> uncertainty;
  for (const DescribingFunctionPoint& point : sweep.points) uncertainty.push_back(point.uncertainty);
  const std::vector<Discontinuity> found = find_discontinuities(sweep.data(), uncertainty);
  if (found.empty()) return std::nullopt;
  return found.front().omega;
}

// Points in the order clearance, force, restitution.
std::vector<JumpPoint> points_of(const std::vector<double>& force, const std::vector<double>& clearance,
                                 const std::vector<double>& restitution) {
  std::vector<JumpPoint> points;
  points.reserve(force.size() * clearance.size() * restitution.size());
  for (const double d : clearance) {
    for (const double f : force) {
      for (const double e : restitution) points.push_back({f, d, e, std::nullopt});
    }
  }
  return points;
}

// Jumps of sweeps, each from its values alone.
void jumps_of_sweeps(JumpLaw& law, double mass1, double mass2, int threads, frac::Progress* progress) {
  if (progress != nullptr) progress->total += law.points.size();
  frac::parallel_for(law.points.size(), threads, [&](std::size_t i) {
    JumpPoint& point = law.points[i];
    point.omega_jump =
        largest_discontinuity(TwoMassSystem(mass1, mass2, point.clearance, point.restitution), point.force);
    if (progress != nullptr) ++progress->done;
  });
  const std::size_t restitutions = law.constants.size();
  const std::size_t sweeps = law.points.size() / restitutions;
  for (std::size_t i = 0; i < restitutions; ++i) {
    double sum = 0;
    std::size_t count = 0;
    for (std::size_t k = i; k < law.points.size(); k += restitutions) {
      const JumpPoint& point = law.points[k];
      if (!point.omega_jump) continue;
      sum += *point.omega_jump / std::sqrt(point.force / mass2 / point.clearance);
      ++count;
    }
    if (count > 0) law.constants[i].similarity_constant = sum / static_cast<double>(count);
    law.constants[i].message = std::to_string(count) + " of " + std::to_string(sweeps) + " sweeps have a discontinuity";
  }
}

// Jumps of the physics: c depends on restitution alone.
void jumps_of_physics(JumpLaw& law, double mass2, int threads, frac::Progress* progress) {
  if (progress != nullptr) progress->total += law.constants.size();
  frac::parallel_for(law.constants.size(), threads, [&](std::size_t i) {
    JumpConstant& constant = law.constants[i];
    const JumpFrequency jump = jump_similarity_constant(constant.restitution, law.criterion);
    constant.similarity_constant = jump.similarity_constant;
    constant.message = jump.message;
    if (progress != nullptr) ++progress->done;
  });
  for (std::size_t i = 0; i < law.points.size(); ++i) {
    const std::optional<double>& c = law.constants[i % law.constants.size()].similarity_constant;
    if (c) law.points[i].omega_jump = *c * std::sqrt(law.points[i].force / mass2 / law.points[i].clearance);
  }
}

}  // namespace

double PublishedJumpLaw::omega_jump(double force, double clearance) const {
  return a_coefficient * std::pow(clearance, a_exponent) *
         std::pow(force, b_coefficient * std::pow(clearance, b_exponent));
}

JumpLaw fit_jump_law(double mass1, double mass2, const std::vector<double>& force, const std::vector<double>& clearance,
                     const std::vector<double>& restitution, JumpCriterion criterion, int threads,
                     frac::Progress* progress) {
  check(mass1, mass2, force, clearance, restitution);
  JumpLaw result{};
  result.criterion = criterion;
  result.points = points_of(force, clearance, restitution);
  for (const double e : restitution) result.constants.push_back({e, std::nullopt, {}});
  if (criterion == JumpCriterion::largest_discontinuity) {
    jumps_of_sweeps(result, mass1, mass2, threads, progress);
  } else {
    jumps_of_physics(result, mass2, threads, progress);
  }

  double constant_sum = 0;
  std::size_t constant_count = 0;
  std::vector<double> fitted_clearance;
  std::vector<double> a;
  std::vector<double> b;
  auto point = result.points.begin();
  for (const double d : clearance) {
    std::vector<double> fitted_force;
    std::vector<double> omega;
    for (const double f : force) {
      double sum = 0;
      std::size_t count = 0;
      for (std::size_t i = 0; i < restitution.size(); ++i, ++point) {
        if (!point->omega_jump) continue;
        sum += *point->omega_jump;
        ++count;
        constant_sum += *point->omega_jump / std::sqrt(f / mass2 / d);
        ++constant_count;
      }
      if (count == 0) continue;
      fitted_force.push_back(f);
      omega.push_back(sum / static_cast<double>(count));
    }
    if (fitted_force.size() < 2) continue;
    const frac::PowerLaw law = frac::fit_power_law(fitted_force, omega);
    result.laws.push_back({d, law});
    fitted_clearance.push_back(d);
    a.push_back(law.coefficient);
    b.push_back(law.exponent);
  }
  result.mean_similarity_constant = constant_count > 0 ? constant_sum / static_cast<double>(constant_count) : nan;
  if (fitted_clearance.size() < 2) {
    result.message = "criterion " + std::string(to_string(criterion)) + " gives a jump at two forces for " +
                     std::to_string(fitted_clearance.size()) + " of " + std::to_string(clearance.size()) +
                     " clearances; a law needs at least 2";
    result.a_of_clearance = result.b_of_clearance = {nan, nan, nan, nan, nan, nan, nan, nan, nan};
    return result;
  }
  result.a_of_clearance = frac::fit_power_law(fitted_clearance, a);
  result.b_of_clearance = frac::fit_power_law(fitted_clearance, b);
  return result;
}

}  // namespace backlash
