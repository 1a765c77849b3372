// SPDX-License-Identifier: BSD-3-Clause
#include "preparation.hpp"

#include <algorithm>
#include <stdexcept>

#include "frac/parallel_for.hpp"
#include "identification/data/fit_data.hpp"
#include "identification/search/robust.hpp"
#include "identification/statistics/curvature_fit.hpp"
#include "noise_levels.hpp"

namespace frac::detail {
namespace {

/// The result, where it is one of a curve that has more residuals than parameters.
/// @param near  where the search is to start, or null
std::optional<FitResult> fit_one(const JointCurve& curve, const Structure& structure, const JointFitOptions& options,
                                 const FitResult* near) {
  const std::size_t most = structure.parameter_names().size();
  const CurveOptions own = options_of(curve, options);
  const auto fitted = [&](const auto& data, const auto& given) -> std::optional<FitResult> {
    if (residuals_per_point(data, given) * points(data) <= most) return std::nullopt;
    FitResult result = curvature_fit(data, structure, near ? started_at(given, *near) : given);
    if (!result.usable()) return std::nullopt;
    return result;
  };
  if (const FrequencyResponseData* response = curve.response()) return fitted(*response, std::get<FitOptions>(own));
  return fitted(*curve.record(), std::get<TimeFitOptions>(own));
}

/// The fits of curves of one kind, whose residuals compare.
/// @param of_kind  their indices
void fit_kind(const std::vector<JointCurve>& curves, const std::vector<std::size_t>& of_kind,
              const Structure& structure, const JointFitOptions& options, Alone& results) {
  if (of_kind.empty()) return;
  constexpr std::size_t searched_everywhere = 3;
  std::vector<std::size_t> first, others;
  const std::size_t spread = std::min(searched_everywhere, of_kind.size());
  for (std::size_t k = 0; k < spread; ++k)
    first.push_back(of_kind[spread > 1 ? k * (of_kind.size() - 1) / (spread - 1) : 0]);
  for (const std::size_t c : of_kind)
    if (std::find(first.begin(), first.end(), c) == first.end()) others.push_back(c);

  parallel_for(first.size(), options.threads,
               [&](std::size_t k) { results[first[k]] = fit_one(curves[first[k]], structure, options, nullptr); });
  double largest = 0;
  for (const std::size_t c : first)
    if (results[c]) largest = std::max(largest, results[c]->rms);
  // Noise levels of curves differ by a few; a search that ended in another minimum leaves more.
  constexpr double suspicious = 4;
  parallel_for(others.size(), options.threads, [&](std::size_t k) {
    const JointCurve& curve = curves[others[k]];
    std::optional<FitResult>& best = results[others[k]];
    // The nearest first: neighbours in a series are alike.
    std::vector<std::size_t> order = first;
    const auto distance = [&](std::size_t c) { return c > others[k] ? c - others[k] : others[k] - c; };
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return distance(a) < distance(b); });
    for (const std::size_t c : order) {
      if (!results[c]) continue;
      auto result = fit_one(curve, structure, options, &*results[c]);
      if (result && (!best || result->rms < best->rms)) best = std::move(result);
      if (best && best->rms <= largest) return;
    }
    if (best && best->rms <= suspicious * largest) return;
    auto result = fit_one(curve, structure, options, nullptr);
    if (result && (!best || result->rms < best->rms)) best = std::move(result);
  });
}

/// A fit of each curve alone, one entry per curve; none where a curve does not determine all parameters or the search
/// found nothing.  A few curves are searched from everywhere, the others from where those ended, and from everywhere
/// only where that leaves far more than it did in those.
Alone fit_alone(const std::vector<JointCurve>& curves, const Structure& structure, const JointFitOptions& options) {
  Alone results(curves.size());
  std::vector<std::size_t> responses, records;
  for (std::size_t c = 0; c < curves.size(); ++c) (curves[c].response() ? responses : records).push_back(c);
  fit_kind(curves, responses, structure, options, results);
  fit_kind(curves, records, structure, options, results);
  return results;
}

/// The variance of a residual that the fit of a curve alone leaves, of the well-behaved ones under a loss.
CurveVariance variance_left(const FitResult& alone, double unit, Loss loss) {
  const double degrees = static_cast<double>(alone.residuals) - static_cast<double>(alone.free_parameters);
  if (!(degrees > 0)) return {0, 0};
  // An exact fit leaves rounding, of which no less than this is meant.
  const double rounding = 1e-14 * unit;
  const double spread = alone.loss_scale / tuning_constant(loss);
  const double variance = loss == Loss::none ? alone.cost / degrees : spread * spread;
  return {std::max(variance, rounding * rounding), degrees};
}

/// Standard deviation of a residual of each curve.  Levels are drawn together among curves of one kind.
std::vector<double> noise_of(const std::vector<JointCurve>& curves, const Structure& structure,
                             const std::vector<CurveOptions>& settled, const Alone& alone, const FitOptions& options) {
  std::vector<double> noise(curves.size(), 1.0);
  if (options.weight == Weight::given || options.weight == Weight::repeats) return noise;
  for (const bool over_time : {false, true}) {
    std::vector<std::size_t> of_kind;
    std::vector<CurveVariance> estimated;
    for (std::size_t c = 0; c < curves.size(); ++c) {
      if ((curves[c].record() != nullptr) != over_time) continue;
      of_kind.push_back(c);
      estimated.push_back(
          alone[c] ? variance_left(*alone[c], problem_of(curves[c], structure, settled[c])->unit, options.loss)
                   : CurveVariance{0, 0});
    }
    const std::vector<double> levels = moderated_deviations(estimated);
    for (std::size_t k = 0; k < of_kind.size(); ++k) noise[of_kind[k]] = levels[k];
  }
  return noise;
}

StartValues start_values(const Structure& structure, const JointFitOptions& options, const Alone& alone) {
  std::vector<double> otherwise;
  const auto best = std::min_element(alone.begin(), alone.end(), [](const auto& a, const auto& b) {
    return a.has_value() && (!b.has_value() || a->rms < b->rms);
  });
  if (best->has_value()) {
    for (std::size_t i = 0; i < structure.parameter_names().size(); ++i)
      otherwise.push_back((*best)->parameters[i].value);
  } else {
    for (const std::string& name : structure.parameter_names()) {
      const auto known = std::find_if(options.fit.constraints.begin(), options.fit.constraints.end(),
                                      [&](const ParameterConstraint& each) { return each.name == name; });
      if (known == options.fit.constraints.end() || !(known->start || known->fixed || known->prior))
        throw std::invalid_argument("no curve alone determines all parameters of " + structure.formula() +
                                    "; give a start value for '" + name + "'");
      otherwise.push_back(known->start ? *known->start : known->fixed ? *known->fixed : known->prior->value);
    }
  }
  StartValues result;
  for (const auto& fit : alone) {
    result.from_curve.push_back(fit.has_value());
    std::vector<double>& values = result.parameters.emplace_back(otherwise);
    for (std::size_t i = 0; fit && i < values.size(); ++i) values[i] = fit->parameters[i].value;
  }
  result.lead_laws.assign(result.from_curve.begin(), result.from_curve.end());
  return result;
}

}  // namespace

CurveOptions options_of(const JointCurve& curve, const JointFitOptions& options) {
  const TimeResponseData* const record = curve.record();
  if (!record) return options.fit;
  if (options.fit.weight == Weight::given && record->sigma().empty())
    throw std::invalid_argument("curve '" + curve.name + "': weight given needs the sigma of its samples");
  TimeFitOptions of_record = options.over_time;
  of_record.constraints = options.fit.constraints;
  of_record.loss = options.fit.loss;
  of_record.loss_scale = options.fit.loss_scale;
  of_record.seed = options.fit.seed;
  of_record.global_start = options.fit.global_start;
  return of_record;
}

Preparation from_fits_alone(const std::vector<JointCurve>& curves, const Structure& structure,
                            const JointFitOptions& options) {
  JointFitOptions without_priors = options;
  for (ParameterConstraint& each : without_priors.fit.constraints) each.prior = std::nullopt;
  Preparation result{fit_alone(curves, structure, without_priors), {}, {}, {}};
  result.values = start_values(structure, options, result.alone);
  for (std::size_t c = 0; c < curves.size(); ++c) {
    CurveOptions& own = result.settled.emplace_back(options_of(curves[c], options));
    if (result.alone[c]) std::visit([&](auto& known) { known = settled(known, *result.alone[c]); }, own);
  }
  result.noise = noise_of(curves, structure, result.settled, result.alone, options.fit);
  return result;
}

}  // namespace frac::detail
