// SPDX-License-Identifier: BSD-3-Clause
#include "frac/identification/joint_fit.hpp"

#include <chrono>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "identification/data/formula_checks.hpp"
#include "identification/statistics/prior_weight.hpp"
#include "joint_confidence.hpp"
#include "joint_result.hpp"
#include "joint_search.hpp"
#include "laid_curves.hpp"

namespace frac {
namespace {

/// The errors at the solution, and the solution, once the priors are weighed; in units of the noise of the fits alone.
detail::JointConfidence weighed_confidence(std::vector<detail::CurveResiduals>& curves,
                                           const detail::JointLayout& layout, detail::JointPoint& point) {
  detail::JointConfidence found = joint_confidence(curves, layout, point);
  if (layout.shared_priors.empty() && layout.own_priors.empty()) return found;
  return detail::weighed_by_noise(std::move(found), curves.front().prior_weight(), [&](double noise) {
    for (detail::CurveResiduals& curve : curves) curve.set_prior_weight(noise);
    constexpr double cost_tolerance = 1e-14;
    point = joint_solve(curves, layout, std::move(point), cost_tolerance);
    return joint_confidence(curves, layout, point);
  });
}

JointFitResult fitted(const std::vector<JointCurve>& curves, const Structure& master, const JointFitOptions& given) {
  JointFitOptions options = given;
  if (given.shift) detail::keep_shifts_positive(options.fit.constraints, *given.shift);
  const Structure structure = given.shift ? shifted(master, *given.shift) : master;
  const detail::Laws laws(structure, given, curves);

  JointFitOptions without_laws = options;
  static_cast<void>(detail::taken_out(without_laws.fit.constraints, laws));
  detail::free_driven(without_laws.fit.constraints, structure, laws);

  const detail::LaidCurves laid =
      given.shift ? detail::lay_curves(curves, master, structure, options, without_laws, laws)
                  : detail::LaidCurves{detail::from_fits_alone(curves, structure, without_laws), std::nullopt};
  const detail::Preparation& known = laid.known;
  detail::JointSearch search(curves, structure, options, known, laws);
  JointFitResult result{};
  result.model = structure.formula();
  result.without_noise =
      given.fit.without_noise ||
      std::all_of(known.alone.begin(), known.alone.end(), [](const auto& fit) { return fit && fit->without_noise; });
  search.run(options, known, result);
  if (!std::isfinite(search.point.cost)) {
    detail::describe_failure(search.point.cost, result);
    return result;
  }
  const detail::JointConfidence found = weighed_confidence(search.problem(), search.layout(), search.point);
  for (const JointCurve& curve : curves) result.curves.emplace_back().name = curve.name;
  detail::describe({structure, search.layout(), laws, search.point, found, known.alone}, search.problem(), result);
  const bool has_priors = !search.layout().shared_priors.empty() || !search.layout().own_priors.empty();
  if (laid.free && laws.drive_shifts() && given.fit.loss == Loss::none && !has_priors)
    detail::compare_with_free(*laid.free, search.squares_at_known_noise, result);
  return result;
}

}  // namespace

JointFitResult joint_fit(const std::vector<JointCurve>& curves, const Structure& master, const JointFitOptions& given) {
  const auto begin = std::chrono::steady_clock::now();
  if (curves.empty()) throw std::invalid_argument("there is no curve to fit");
  detail::require_function_of_s(master);
  validate(given.fit.realisation);
  for (const JointCurve& curve : curves)
    if (given.shift && curve.record())
      throw std::invalid_argument("curve '" + curve.name + "' is over time, and a shift lays frequency responses");
  JointFitResult result = fitted(curves, master, given);
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return result;
}

}  // namespace frac
