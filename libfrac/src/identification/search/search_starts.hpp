// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <random>
#include <vector>

#include "identification/residuals/residuals.hpp"

namespace frac::detail {

/// The starts of a round, each the best of a few draws: screening all draws together would send every solve into the
/// one basin that looks best from afar.
[[nodiscard]] std::vector<std::vector<double>> screened_draws(const Residuals& residuals,
                                                              const std::vector<double>& suggested_orders,
                                                              std::mt19937_64& generator, bool from_given_starts);

/// Starts by linear least squares for the coefficients, at orders and delays drawn like those of the others: the best
/// few of several draws.
[[nodiscard]] std::vector<std::vector<double>> linear_starts(const Residuals& residuals,
                                                             const std::vector<double>& suggested_orders,
                                                             std::mt19937_64& generator);

/// Starts with every order at a whole number: integer-order structures are contained in fractional ones, and their
/// optimum is a place of its own.
[[nodiscard]] std::vector<std::vector<double>> whole_order_starts(const Residuals& residuals,
                                                                  const std::vector<double>& suggested_orders,
                                                                  std::mt19937_64& generator);

/// Multiplies the whole model by the factor that brings it nearest the data: by homogeneity, each parameter times the
/// factor to the power of its dimension.
/// @return what the model costs then, but for rounding and priors, or 0 where that is not known: where a bound holds a
/// parameter back, or the parameters do not scale the model as a whole
double match_magnitude(const Residuals& residuals, std::vector<double>& theta);

/// A random place about another one: `reach` e-folds away in coefficients, a third of `reach` in orders.  A coefficient
/// that has fallen so far that its part of the model has vanished, from where no step leads back, is put that far from
/// the size natural to the data instead.
/// @param delay_step  what a dead time changes by, of a normal number times `reach`
[[nodiscard]] std::vector<double> drawn_about(
    const ParameterMap& map, std::vector<double> theta, double reach, std::mt19937_64& generator,
    const std::function<double(const ParameterMap::Free&, double)>& delay_step);

/// Best point of NLopt's CRS2 over a box six natural units (e-folds) around the data, for models no start agrees on.
[[nodiscard]] std::vector<double> controlled_random_search(const Residuals& residuals, const std::vector<double>& start,
                                                           std::uint64_t seed);

}  // namespace frac::detail
