// SPDX-License-Identifier: BSD-3-Clause
#include "series_split.hpp"

#include <algorithm>
#include <cmath>

#include "formula/whole_orders.hpp"

namespace frac::detail {
namespace {

using Sum = std::vector<PowerTerm>;

struct Stage {
  std::vector<Sum> numerator;
  std::vector<Sum> denominator;
  double growth = 0;  // as s^growth at high frequency
  bool has_whole_orders = true;
};

// Lists every copy of every factor; a power of s becomes s, s, ... and what is left of it.
std::vector<Sum> copies(const std::vector<PowerFactor>& factors, double& gain) {
  std::vector<Sum> list;
  for (const auto& [sum, power] : factors) {
    for (int i = 0; i < power; ++i) {
      if (sum.size() > 1) {
        list.push_back(sum);
        continue;
      }
      gain *= sum[0].coefficient;
      double left = sum[0].order;
      for (; left >= 1; --left) list.push_back({{1, 1}});
      if (left > 0) list.push_back({{1, left}});
    }
  }
  return list;
}

std::vector<PowerFactor> as_factors(const std::vector<Sum>& sums) {
  std::vector<PowerFactor> factors;
  factors.reserve(sums.size() + 1);
  for (const Sum& sum : sums) factors.push_back({sum, 1});
  if (factors.empty()) factors.push_back({{{1, 0}}, 1});
  return factors;
}

// The stage that falls fastest among those that the sum leaves at `most` growth, of its own kind if one does.
Stage* place(std::vector<Stage>& stages, const Sum& sum, double most) {
  for (const bool own_kind : {true, false}) {
    Stage* best = nullptr;
    for (Stage& stage : stages) {
      if (own_kind && stage.has_whole_orders != has_whole_orders(sum)) continue;
      if (!(stage.growth + sum.front().order <= most)) continue;
      if (best == nullptr || stage.growth < best->growth) best = &stage;
    }
    if (best != nullptr) return best;
  }
  return nullptr;
}

}  // namespace

SeriesStages series_stages(const FractionalTransferFunction& model, SeriesSplit split) {
  double gain = 1;
  double divisor = 1;
  std::vector<Sum> above = copies(model.numerator_factors(), gain);
  const std::vector<Sum> below = copies(model.denominator_factors(), divisor);
  std::vector<Stage> stages;
  Stage* together = nullptr;  // the fractional factors that make one stage
  stages.reserve(below.size() + 1);
  for (const Sum& sum : below) {
    const bool whole = has_whole_orders(sum);
    if (split == SeriesSplit::whole_orders && !whole && together != nullptr) {
      together->denominator.push_back(sum);
      together->growth -= sum.front().order;
      continue;
    }
    stages.push_back({{}, {sum}, -sum.front().order, whole});
    if (!whole) together = &stages.back();
  }
  if (stages.size() < 2) return {};
  std::sort(above.begin(), above.end(), [](const Sum& a, const Sum& b) { return a.front().order > b.front().order; });
  for (const Sum& sum : above) {
    Stage* stage = place(stages, sum, 0);
    if (stage == nullptr) stage = place(stages, sum, 0.99);
    if (stage == nullptr) return {};
    stage->numerator.push_back(sum);
    stage->growth += sum.front().order;
    stage->has_whole_orders = stage->has_whole_orders && has_whole_orders(sum);
  }
  SeriesStages result{gain / divisor, {}};
  for (const Stage& stage : stages) {
    result.stages.push_back(
        FractionalTransferFunction::from_factors(as_factors(stage.numerator), as_factors(stage.denominator)));
  }
  return result;
}

}  // namespace frac::detail
