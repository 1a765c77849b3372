// SPDX-License-Identifier: BSD-3-Clause
#include "curves_alone.hpp"

#include <algorithm>

#include "frac/parallel_for.hpp"
#include "identification/data/fit_data.hpp"
#include "identification/statistics/curvature_fit.hpp"
#include "preparation.hpp"

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
              const Structure& structure, const JointFitOptions& options,
              std::vector<std::optional<FitResult>>& results) {
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

}  // namespace

std::vector<std::optional<FitResult>> fit_alone(const std::vector<JointCurve>& curves, const Structure& structure,
                                                const JointFitOptions& options) {
  std::vector<std::optional<FitResult>> results(curves.size());
  std::vector<std::size_t> responses, records;
  for (std::size_t c = 0; c < curves.size(); ++c) (curves[c].response() ? responses : records).push_back(c);
  fit_kind(curves, responses, structure, options, results);
  fit_kind(curves, records, structure, options, results);
  return results;
}

}  // namespace frac::detail
