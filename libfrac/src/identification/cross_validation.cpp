// SPDX-License-Identifier: BSD-3-Clause
#include "frac/identification/cross_validation.hpp"

#include <limits>
#include <stdexcept>

#include "frac/parallel_for.hpp"
#include "frac/structure.hpp"
#include "identification/data/fit_data.hpp"

namespace frac {
namespace {

template <class Data, class Options>
CandidatePredictions predictions(const Data& data, const Options& options, const IdentificationResult& ranking,
                                 std::size_t folds, int threads) {
  const std::size_t points = detail::points(data);
  if (folds < 2 || folds > points)
    throw std::invalid_argument("folds = " + std::to_string(folds) + "; allowed are 2 to the number of points, " +
                                std::to_string(points));
  const std::size_t candidates = ranking.ranking.size();
  std::vector<double> rms(candidates, std::numeric_limits<double>::quiet_NaN());
  std::vector<std::string> reasons(candidates);
  parallel_for(candidates, threads, [&](std::size_t i) {
    const RankedFit& candidate = ranking.ranking[i];
    if (candidate.model_class == ModelClass::fixed_curve) {
      rms[i] = candidate.fit.rms;
      return;
    }
    Options of_model = options;
    of_model.constraints = candidate.model.constraints;
    // The member of a family stands where its search ended.
    of_model.global_start = !candidate.from_family;
    try {
      rms[i] = cross_validation(data, Structure(candidate.fit.model), of_model, folds);
    } catch (const std::invalid_argument& error) {
      reasons[i] = "no cross-validation of " + candidate.name + ": " + error.what();
    }
  });
  CandidatePredictions found{rms, {}};
  for (const auto& reason : reasons)
    if (!reason.empty()) found.notes.push_back(reason);
  return found;
}

}  // namespace

CandidatePredictions cross_validations(const FrequencyResponseData& data, const FitOptions& options,
                                       const IdentificationResult& ranking, std::size_t folds, int threads) {
  return predictions(data, options, ranking, folds, threads);
}

CandidatePredictions cross_validations(const TimeResponseData& data, const TimeFitOptions& options,
                                       const IdentificationResult& ranking, std::size_t folds, int threads) {
  return predictions(data, options, ranking, folds, threads);
}

}  // namespace frac
