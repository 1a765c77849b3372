// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <limits>
#include <vector>

#include "fitted_points.hpp"
#include "frac/identification/validate.hpp"
#include "level_share.hpp"
#include "projected_residual.hpp"

namespace frac::detail {

inline constexpr std::array all_tests{
    ValidityTest::neighbours, ValidityTest::neighbourhoods, ValidityTest::drift_even, ValidityTest::drift_periods,
    ValidityTest::step,       ValidityTest::outliers,       ValidityTest::mains_50,   ValidityTest::mains_60};
inline constexpr std::array mains_frequencies{50.0, 60.0};

[[nodiscard]] inline std::size_t index_of(ValidityTest test) {
  return static_cast<std::size_t>(test);
}
[[nodiscard]] inline std::size_t mains_index(ValidityTest test) {
  return test == ValidityTest::mains_50 ? 0 : 1;
}
[[nodiscard]] inline bool is_of_points(ValidityTest test) {
  return test == ValidityTest::outliers || test == ValidityTest::mains_50 || test == ValidityTest::mains_60;
}

/// Findings about one model, and the point of the largest residual.
struct Tested {
  std::array<double, all_tests.size()> p_value;
  std::array<bool, all_tests.size()> counts;  // the departure is not negligible
  double correlation = 0;
  AddedColumn drift;
  ValidityTest drift_law = ValidityTest::drift_even;
  LargestColumn step;
  // The least of both neighbour tests, drift or step taken out.
  double chance_beside_drift = std::numeric_limits<double>::quiet_NaN();
  double chance_beside_step = std::numeric_limits<double>::quiet_NaN();
  double square_beside_drift, square_beside_step;                            // what is left then
  std::vector<double> point_chance;                                          // of each residual
  std::array<std::vector<Eigen::Index>, mains_frequencies.size()> at_mains;  // that stand out most together

  [[nodiscard]] bool alarm(ValidityTest test, double level) const {
    const std::size_t i = index_of(test);
    return counts[i] && p_value[i] < level * share_of_level;
  }
  /// Every point whose residual is an alarm by itself.
  [[nodiscard]] std::vector<Eigen::Index> standing_out(double level) const {
    std::vector<Eigen::Index> points;
    const double limit = level * share_of_level / static_cast<double>(point_chance.size());
    for (std::size_t i = 0; i < point_chance.size(); ++i)
      if (point_chance[i] < limit) points.push_back(static_cast<Eigen::Index>(i));
    return points;
  }
};

[[nodiscard]] Tested tested(const FrequencyResponseData& data, const Fitted& fitted, double accuracy);

[[nodiscard]] AddedColumn drift_of(const FrequencyResponseData& data, const Fitted& fitted, ValidityTest law);

/// Points of a neighbourhood: a twelfth of all, within reason.
[[nodiscard]] Eigen::Index neighbourhood(Eigen::Index points);

/// Position among the kept points of the first one behind a step.
[[nodiscard]] std::size_t first_beyond(Eigen::Index step_column);

/// Positions among the kept points that lie at a harmonic of the mains, three at most at each: the first, and every
/// `step`-th after it up to the one numbered `highest`.
[[nodiscard]] std::vector<Eigen::Index> at_mains(const Fitted& fitted, double mains, int highest, int step);

}  // namespace frac::detail
