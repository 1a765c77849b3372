// SPDX-License-Identifier: BSD-3-Clause
#include "identification/search/interchange.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <string>
#include <vector>

#include "frac/identification/fit.hpp"
#include "support/noisy_response.hpp"

namespace {

using frac::ParameterConstraint;
using frac::Structure;

/// Parameters by name, after ordering.
std::vector<double> ordered(const char* formula, const std::vector<double>& parameters,
                            const std::vector<ParameterConstraint>& constraints = {}) {
  return frac::detail::with_labels_in_order(Structure(formula), constraints, parameters);
}

using Values = std::vector<double>;

TEST(Interchange, SortsArcsByTimeConstant) {
  const char* const arcs = "R0 + R1/(1 + R1 Q1 s^n1) + R2/(1 + R2 Q2 s^n2)";
  // (R Q)^(1/n): 1000^(1/0.9) = 2154 s and 0.01^(1/0.8) = 0.003 s.
  EXPECT_EQ(ordered(arcs, {1, 10, 100, 0.9, 0.1, 0.1, 0.8}), (Values{1, 0.1, 0.1, 0.8, 10, 100, 0.9}));
  EXPECT_EQ(ordered(arcs, {1, 0.1, 0.1, 0.8, 10, 100, 0.9}), (Values{1, 0.1, 0.1, 0.8, 10, 100, 0.9}));
  // The formula may name the second arc first.
  EXPECT_EQ(ordered("R2/(1 + R2 C2 s) + R1/(1 + R1 C1 s)", {2, 3, 5, 7}), (Values{5, 7, 2, 3}));
}

TEST(Interchange, SortsThreeArcs) {
  const char* const arcs = "R1/(1 + R1 C1 s) + R2/(1 + R2 C2 s) + R3/(1 + R3 C3 s)";
  Values parts{3, 2, 1};
  do {
    Values parameters;
    for (const double each : parts) parameters.insert(parameters.end(), {each, 10});
    EXPECT_EQ(ordered(arcs, parameters), (Values{1, 10, 2, 10, 3, 10}));
  } while (std::prev_permutation(parts.begin(), parts.end()));
}

TEST(Interchange, SortsPowersByOrder) {
  EXPECT_EQ(ordered("1/(b2 s^a2 + b1 s^a1 + b0)", {0.5, 0.9, 0.8, 2.2, 1}), (Values{0.8, 2.2, 0.5, 0.9, 1}));
  EXPECT_EQ(ordered("K/(b2 s^a2 + b1 s^a1 + 1)", {4, 0.5, 0.9, 80, 2.2}), (Values{4, 80, 2.2, 0.5, 0.9}));
  EXPECT_EQ(ordered("K1 s^a1 + K2 s^a2", {3, 0.5, 2, -1}), (Values{2, -1, 3, 0.5}));
  EXPECT_EQ(ordered("K/((1 + T1 s)(1 + T2 s))", {1, 5, 2}), (Values{1, 2, 5}));
}

// As in a preset whose orders have limits of their own.
TEST(Interchange, SortsAcrossLimitsThatAllowBothPlaces) {
  const char* const oscillator = "K/(b2 s^a2 + b1 s^a1 + 1)";
  const std::vector<frac::ParameterConstraint> limits{{"a1", {}, 0.0, 2.0, {}}, {"a2", {}, 0.0, 4.0, {}}};
  EXPECT_EQ(ordered(oscillator, {3, 0.4, 0.7, 9, 1.8}, limits), (Values{3, 9, 1.8, 0.4, 0.7}));
  // The order that would go to a1 lies beyond its limit.
  const std::vector<frac::ParameterConstraint> narrow{{"a1", {}, 1.0, 2.0, {}}, {"a2", {}, 0.0, 4.0, {}}};
  EXPECT_EQ(ordered(oscillator, {3, 0.4, 0.7, 9, 1.8}, narrow), (Values{3, 0.4, 0.7, 9, 1.8}));
}

TEST(Interchange, LeavesWhatIsNoSymmetry) {
  EXPECT_TRUE(frac::detail::interchanges(Structure("K/(T s^a + 1)")).empty());
  // Two parts of the same shape in places that differ.
  EXPECT_TRUE(frac::detail::interchanges(Structure("(1 + T1 s)/(1 + T2 s)")).empty());
  EXPECT_TRUE(frac::detail::interchanges(Structure("A/(1 + T1 s) + 2 B/(1 + T2 s)")).empty());
}

TEST(Interchange, KeepsLabelsTheUserToldApart) {
  const char* const furnace = "1/(b2 s^a2 + b1 s^a1 + b0)";
  const Values found{0.5, 0.9, 0.8, 2.2, 1};
  EXPECT_EQ(ordered(furnace, found, {{"a2", {}, 0, 1, {}}}), found);
  EXPECT_EQ(ordered(furnace, found, {{"b1", {}, {}, {}, 0.7}}), found);
  EXPECT_NE(ordered(furnace, found, {{"b0", 1, {}, {}, {}}}), found);
}

// Any seed ends with the labels of the truth, which is in order.
TEST(Interchange, EverySeedGivesTheSameLabels) {
  const std::vector<double> truth{0.8, 2.2, 0.5, 0.9, 1};
  const auto data = support::noisy_response("1/(b2 s^a2 + b1 s^a1 + b0)", truth, 0.01, 3, 100);
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    frac::FitOptions options;
    options.component = frac::Component::both;
    options.seed = seed;
    const frac::FitResult result = frac::fit(data, Structure("1/(b2 s^a2 + b1 s^a1 + b0)"), options);
    for (std::size_t i = 0; i < truth.size(); ++i) {
      EXPECT_NEAR(result.parameters[i].value, truth[i], 6 * result.parameters[i].standard_error);
    }
  }
}

}  // namespace
