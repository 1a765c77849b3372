#include "backlash/jump_law.hpp"

#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "detail/check.hpp"

namespace backlash {
namespace {

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
  const std::vector<Discontinuity> found =
      find_discontinuities(describing_function_sweep(system, force, omega, options).data());
  if (found.empty()) return std::nullopt;
  return found.front().omega;
}

// Points in the order clearance, force, restitution.
std::vector<JumpPoint> jump_points(double mass1, double mass2, const std::vector<double>& force,
                                   const std::vector<double>& clearance, const std::vector<double>& restitution,
                                   JumpCriterion criterion, int threads, frac::Progress* progress) {
  std::vector<JumpPoint> points;
  points.reserve(force.size() * clearance.size() * restitution.size());
  for (const double d : clearance) {
    for (const double f : force) {
      for (const double e : restitution) points.push_back({f, d, e, std::nullopt});
    }
  }
  if (criterion == JumpCriterion::largest_discontinuity) {
    if (progress != nullptr) progress->total += points.size();
    frac::parallel_for(points.size(), threads, [&](std::size_t i) {
      JumpPoint& point = points[i];
      point.omega_jump =
          largest_discontinuity(TwoMassSystem(mass1, mass2, point.clearance, point.restitution), point.force);
      if (progress != nullptr) ++progress->done;
    });
    return points;
  }
  // c depends on restitution alone.
  if (progress != nullptr) progress->total += restitution.size();
  std::vector<std::optional<double>> constant(restitution.size());
  frac::parallel_for(restitution.size(), threads, [&](std::size_t i) {
    constant[i] = jump_similarity_constant(restitution[i], criterion).similarity_constant;
    if (progress != nullptr) ++progress->done;
  });
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::optional<double>& c = constant[i % restitution.size()];
    if (c) points[i].omega_jump = *c * std::sqrt(points[i].force / mass2 / points[i].clearance);
  }
  return points;
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
  result.points = jump_points(mass1, mass2, force, clearance, restitution, criterion, threads, progress);

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
  if (fitted_clearance.size() < 2) {
    throw std::invalid_argument("criterion " + std::string(to_string(criterion)) + " gives a jump at two forces for " +
                                std::to_string(fitted_clearance.size()) + " of the clearances; at least 2 are needed");
  }
  result.a_of_clearance = frac::fit_power_law(fitted_clearance, a);
  result.b_of_clearance = frac::fit_power_law(fitted_clearance, b);
  result.mean_similarity_constant = constant_sum / static_cast<double>(constant_count);
  return result;
}

}  // namespace backlash
