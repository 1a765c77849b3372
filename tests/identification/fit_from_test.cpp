// SPDX-License-Identifier: BSD-3-Clause
#include "frac/identification/fit_from.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "support/both_parts.hpp"
#include "support/noisy_response.hpp"

namespace {

constexpr const char* two_arcs = "R0 + R1/(1 + R1 Q1 s^n1) + R2/(1 + R2 Q2 s^n2)";

frac::FitOptions bounded() {
  frac::FitOptions options = support::both_parts();
  for (const char* order : {"n1", "n2"}) options.constraints.push_back({order, {}, 0.0, 1.0, {}});
  return options;
}

// Two arcs that drift, jump at every tenth spectrum to quite another cell, and merge at some so that they are not told
// apart: each answer is that of the search.  Both ends are solved until the cost changes by less than 1e-14 of itself,
// so that costs agree to 1e-9 and parameters to a thousandth of their standard errors.
TEST(FitFrom, EndsWhereTheSearchEnds) {
  std::mt19937_64 generator(5);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform;
  const frac::Structure structure(two_arcs);
  std::vector<double> cell{1, 2, 0.05, 0.85, 3, 5, 0.8};
  frac::FitResult first;
  int at_once = 0;
  constexpr int spectra = 30;
  for (int i = 0; i < spectra; ++i) {
    if (i % 10 == 9) {
      const double apart = i % 20 == 9 ? 1 : 100;
      cell = {0.5 + uniform(generator), 2, 0.05, 0.7 + 0.2 * uniform(generator), 3, 0.05 * apart, 0.85};
    }
    for (double& value : cell) value *= std::exp(0.01 * normal(generator));
    const auto data = support::noisy_response(two_arcs, cell, 0.005, generator, 70);
    const auto searched = frac::fit(data, structure, bounded());
    if (i == 0) {
      first = searched;
      continue;
    }
    const auto result = frac::fit_from(first, data, structure, bounded());
    at_once += result.starts == 1;
    EXPECT_NEAR(result.cost / searched.cost, 1, 1e-9) << i;
    for (std::size_t k = 0; k < cell.size(); ++k) {
      const auto& expected = searched.parameters[k];
      if (!expected.identified) continue;
      EXPECT_NEAR(result.parameters[k].value, expected.value, 1e-3 * expected.standard_error) << i << expected.name;
    }
  }
  // All but those of the merged arcs.
  EXPECT_GE(at_once, 15);
  EXPECT_LT(at_once, spectra - 1);
}

// A start of no use, of another structure or far away, costs a search and spoils nothing.
TEST(FitFrom, SearchesWhereTheStartIsOfNoUse) {
  const frac::Structure structure(two_arcs);
  const auto data = support::noisy_response(two_arcs, {1, 2, 0.05, 0.85, 3, 5, 0.8}, 0.005, 3u, 70);
  const auto searched = frac::fit(data, structure, bounded());
  const auto other = frac::fit(data, frac::Structure("R0 + R1/(1 + R1 Q1 s^n1)"), support::both_parts());
  auto far = searched;
  for (auto& parameter : far.parameters) parameter.value = parameter.name[0] == 'n' ? 0.5 : 1e-6;
  for (const auto& start : {other, far}) {
    const auto result = frac::fit_from(start, data, structure, bounded());
    EXPECT_NEAR(result.cost / searched.cost, 1, 1e-9);
  }
}

}  // namespace
