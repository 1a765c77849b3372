// SPDX-License-Identifier: BSD-3-Clause
#include "backlash/identification/jump_law.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

#include "backlash/compliant/compliant_jump.hpp"
#include "base/check.hpp"
#include "base/counted.hpp"
#include "base/short_text.hpp"

namespace backlash {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

void require_list(const std::string& name, const std::vector<double>& values, std::size_t least) {
  if (values.size() < least) {
    throw std::invalid_argument(name + " has " + frac::detail::counted(values.size(), "value") + "; at least " +
                                std::to_string(least) + (least == 1 ? " is needed" : " different ones are needed"));
  }
}

// A power law needs two different places.
void require_different(const std::string& name, const std::vector<double>& values) {
  require_list(name, values, 2);
  if (std::all_of(values.begin(), values.end(), [&](double value) { return value == values.front(); })) {
    throw std::invalid_argument("every " + name + " is " + detail::text(values.front()) +
                                "; a law needs at least 2 different ones");
  }
}

void check(double mass1, double mass2, const std::vector<double>& force, const std::vector<double>& clearance,
           const std::vector<double>& restitution) {
  detail::require_positive("mass1", "kg", mass1);
  detail::require_positive("mass2", "kg", mass2);
  require_list("force", force, 1);
  require_list("clearance", clearance, 1);
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

struct Mean {
  double sum = 0;
  std::size_t count = 0;
  void add(double value) {
    sum += value;
    ++count;
  }
  [[nodiscard]] double value() const { return count > 0 ? sum / static_cast<double>(count) : nan; }
};

// The constant of each restitution or contact: the mean over its scenes.
void take_means(JumpGrid& grid, double mass2) {
  const std::size_t restitutions = grid.constants.size();
  Mean overall;
  for (std::size_t i = 0; i < restitutions; ++i) {
    Mean mean;
    for (std::size_t k = i; k < grid.points.size(); k += restitutions) {
      const JumpPoint& point = grid.points[k];
      if (!point.omega_jump) continue;
      const double c = *point.omega_jump / std::sqrt(point.force / mass2 / point.clearance);
      mean.add(c);
      overall.add(c);
    }
    if (mean.count > 0) grid.constants[i].similarity_constant = mean.value();
    grid.constants[i].message =
        std::to_string(mean.count) + " of " + std::to_string(grid.points.size() / restitutions) + " ";
  }
  grid.mean_similarity_constant = overall.value();
}

// Jumps of sweeps, each from its values alone.
void jumps_of_sweeps(JumpGrid& grid, double mass1, double mass2, int threads, frac::Progress* progress) {
  if (progress != nullptr) progress->total += grid.points.size();
  frac::parallel_for(grid.points.size(), threads, [&](std::size_t i) {
    JumpPoint& point = grid.points[i];
    point.omega_jump =
        largest_discontinuity(TwoMassSystem(mass1, mass2, point.clearance, point.restitution), point.force);
    if (progress != nullptr) ++progress->done;
  });
  take_means(grid, mass2);
  for (JumpConstant& constant : grid.constants) constant.message += "sweeps have a discontinuity";
}

// Jumps of the physics: c depends on restitution alone.
void jumps_of_physics(JumpGrid& grid, double mass2, int threads, frac::Progress* progress) {
  if (progress != nullptr) progress->total += grid.constants.size();
  frac::parallel_for(grid.constants.size(), threads, [&](std::size_t i) {
    JumpConstant& constant = grid.constants[i];
    const JumpFrequency jump = jump_similarity_constant(constant.restitution, grid.criterion);
    constant.similarity_constant = jump.similarity_constant;
    constant.message = jump.message;
    if (progress != nullptr) ++progress->done;
  });
  for (std::size_t i = 0; i < grid.points.size(); ++i) {
    const std::optional<double>& c = grid.constants[i % grid.constants.size()].similarity_constant;
    if (c) grid.points[i].omega_jump = *c * std::sqrt(grid.points[i].force / mass2 / grid.points[i].clearance);
  }
  Mean mean;
  for (const JumpConstant& constant : grid.constants) {
    if (constant.similarity_constant) mean.add(*constant.similarity_constant);
  }
  grid.mean_similarity_constant = mean.value();
}

}  // namespace

double PublishedJumpLaw::omega_jump(double force, double clearance) const {
  return a_coefficient * std::pow(clearance, a_exponent) *
         std::pow(force, b_coefficient * std::pow(clearance, b_exponent));
}

JumpGrid jump_grid(double mass1, double mass2, const std::vector<double>& force, const std::vector<double>& clearance,
                   const std::vector<double>& restitution, JumpCriterion criterion, int threads,
                   frac::Progress* progress) {
  check(mass1, mass2, force, clearance, restitution);
  JumpGrid result{criterion, points_of(force, clearance, restitution), {}, nan};
  for (const double e : restitution) result.constants.push_back({e, std::nullopt, {}});
  if (criterion == JumpCriterion::largest_discontinuity) {
    jumps_of_sweeps(result, mass1, mass2, threads, progress);
  } else {
    jumps_of_physics(result, mass2, threads, progress);
  }
  return result;
}

JumpGrid contact_jump_grid(double mass1, double mass2, const std::vector<double>& force,
                           const std::vector<double>& clearance, const std::vector<CompliantContact>& contact,
                           JumpCriterion criterion, int threads, frac::Progress* progress,
                           const CoulombFriction& friction) {
  if (contact.empty()) throw std::invalid_argument("contact is empty; at least 1 contact is needed");
  std::vector<double> restitution;
  for (const CompliantContact& each : contact) {
    detail::require_positive("contact_damping", "N s/m", each.damping());
    restitution.push_back(free_contact(each, mass1, mass2).restitution);
  }
  check(mass1, mass2, force, clearance, restitution);
  JumpGrid result{criterion, points_of(force, clearance, restitution), {}, nan};
  for (const double e : restitution) result.constants.push_back({e, std::nullopt, {}});
  if (progress != nullptr) progress->total += result.points.size();
  frac::parallel_for(result.points.size(), threads, [&](std::size_t i) {
    JumpPoint& point = result.points[i];
    const CompliantBodies bodies(free_mass(mass1), free_mass(mass2), point.clearance, contact[i % contact.size()],
                                 friction);
    const CompliantJump jump = compliant_jump(bodies, point.force, criterion, false);
    if (jump.similarity_constant)
      point.omega_jump = *jump.similarity_constant * std::sqrt(point.force / mass2 / point.clearance);
    if (progress != nullptr) ++progress->done;
  });
  take_means(result, mass2);
  for (JumpConstant& constant : result.constants)
    constant.message += friction.body1 == 0 && friction.body2 == 0
                            ? "scenes have a jump; c depends on the stiffness beside the force"
                            : "scenes have a jump; c depends on stiffness and dry friction beside the force";
  return result;
}

std::string JumpLaw::summary() const {
  using frac::detail::short_text;
  if (!usable()) return message;
  const auto of_clearance = [](const frac::PowerLaw& law) {
    return short_text(law.coefficient) + " Delta^" + short_text(law.exponent);
  };
  return "w_J = a F^b by " + std::string(to_string(criterion)) + ", a = " + of_clearance(a_of_clearance) +
         ", b = " + of_clearance(b_of_clearance);
}

namespace {

JumpLaw law_of(JumpGrid grid, const std::vector<double>& force, const std::vector<double>& clearance) {
  const JumpCriterion criterion = grid.criterion;
  JumpLaw result{std::move(grid), {}, {}, {}, {}};
  std::vector<double> fitted_clearance;
  std::vector<double> a;
  std::vector<double> b;
  auto point = result.points.begin();
  for (const double d : clearance) {
    std::vector<double> fitted_force;
    std::vector<double> omega;
    for (const double f : force) {
      Mean mean;
      for (std::size_t i = 0; i < result.constants.size(); ++i, ++point) {
        if (point->omega_jump) mean.add(*point->omega_jump);
      }
      if (mean.count == 0) continue;
      fitted_force.push_back(f);
      omega.push_back(mean.value());
    }
    if (fitted_force.size() < 2) continue;
    const frac::PowerLaw law = frac::fit_power_law(fitted_force, omega);
    result.laws.push_back({d, law});
    fitted_clearance.push_back(d);
    a.push_back(law.coefficient);
    b.push_back(law.exponent);
  }
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

}  // namespace

JumpLaw fit_jump_law(double mass1, double mass2, const std::vector<double>& force, const std::vector<double>& clearance,
                     const std::vector<double>& restitution, JumpCriterion criterion, int threads,
                     frac::Progress* progress) {
  require_different("force", force);
  require_different("clearance", clearance);
  return law_of(jump_grid(mass1, mass2, force, clearance, restitution, criterion, threads, progress), force, clearance);
}

JumpLaw fit_contact_jump_law(double mass1, double mass2, const std::vector<double>& force,
                             const std::vector<double>& clearance, const std::vector<CompliantContact>& contact,
                             JumpCriterion criterion, int threads, frac::Progress* progress,
                             const CoulombFriction& friction) {
  require_different("force", force);
  require_different("clearance", clearance);
  return law_of(contact_jump_grid(mass1, mass2, force, clearance, contact, criterion, threads, progress, friction),
                force, clearance);
}

}  // namespace backlash
