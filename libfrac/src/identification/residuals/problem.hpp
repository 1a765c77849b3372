// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string_view>
#include <vector>

#include "residuals.hpp"

namespace frac::detail {

/// Marks problems whose theta are the parameters of the structure themselves, free of limits.
struct ByParameters {};

/// The problem of a fit, whatever its data are: residuals of a structure to them, under what is known of its parameters
/// beforehand.
class Problem {
 public:
  virtual ~Problem() = default;
  Problem(const Problem&) = delete;
  Problem& operator=(const Problem&) = delete;

  const Structure& structure;
  const std::vector<ParameterConstraint> constraints;
  const ParameterMap map;
  const Priors priors;
  double unit;  // of the residuals: the size of the weighted data

  /// At all data and to all digits, with the priors.
  [[nodiscard]] virtual Residuals& residuals() = 0;
  /// This problem with one of its parameters held, in the same unit.
  [[nodiscard]] virtual std::unique_ptr<Problem> held(std::string_view parameter, double value) const = 0;

 protected:
  /// @throws std::invalid_argument  constraints that do not go with the structure, as fit() says.
  Problem(const Structure& model, std::vector<ParameterConstraint> known, const DataScale& scale, bool blind_to_sign)
      : structure(model),
        constraints(std::move(known)),
        map(model, constraints, scale, blind_to_sign),
        priors(model, constraints, map),
        unit(1) {}
  Problem(const Structure& model, ByParameters);
};

/// Constraints with an upper limit for each delay that has none.
[[nodiscard]] std::vector<ParameterConstraint> with_longest_delay(const Structure& structure,
                                                                  std::vector<ParameterConstraint> constraints,
                                                                  double longest);

/// Noise in residuals until they tell: a hundredth of the data.
inline constexpr double expected_noise = 0.01;

}  // namespace frac::detail
