// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <vector>

#include "parameter_map.hpp"

namespace frac::detail {

/// The priors of a fit as residuals: distances of parameters from their values in standard deviations.
class Priors {
 public:
  struct Entry {
    std::size_t parameter;
    ParameterPrior prior;
  };

  Priors() = default;
  /// @throws std::invalid_argument  as fit() says of priors.
  Priors(const Structure& structure, std::span<const ParameterConstraint> constraints, const ParameterMap& map);

  [[nodiscard]] bool empty() const noexcept { return entries_.empty(); }
  [[nodiscard]] const std::vector<Entry>& entries() const noexcept { return entries_; }

  /// Sum of squares of the distances; infinite where a relative one has no logarithm.
  [[nodiscard]] double cost(std::span<const double> parameters) const;
  /// Distances, and unless null their derivatives by theta, row by row.  False where one is not finite.
  bool evaluate(const ParameterMap& map, std::span<const double> theta, double* distance, double* jacobian) const;

 private:
  std::vector<Entry> entries_;
};

/// @throws std::invalid_argument  naming the parameter, where the deviation is not positive or a relative prior has no
///     positive value.
void check_prior(const std::string& name, const ParameterPrior& prior);

}  // namespace frac::detail
