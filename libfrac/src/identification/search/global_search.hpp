// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "local_solve.hpp"

namespace frac::detail {

struct GlobalSolution {
  LocalSolution best;
  std::size_t starts = 0;          // local solves made
  std::size_t starts_at_best = 0;  // of which ended at the best cost; 0: the model was finite nowhere it was tried
  std::size_t minima = 0;          // distinct ends of the independent starts
  double confidence = 0;           // probability that no lower minimum exists, NaN where nothing was searched
  bool left_early = false;         // as hopeless, without walks to a lower minimum
};

/// What a global search is for: the optimum, with how sure that is, or a place to start other solves from, where it is
/// enough that some scouts agree, and none is followed to the end.
enum class SearchAim { optimum, start };

/// Local slopes d ln|G|/d ln omega at the lower end, the upper end and the extremes: orders the data suggest.
[[nodiscard]] std::vector<double> suggested_orders(const FrequencyResponseData& data);

/// Probability that the lowest minimum is among the `minima` distinct ones that `starts` independent solves ended at,
/// when nothing is known beforehand of their number and of the shares of their basins (uniform priors) and the lowest
/// is as likely as any to be hidden: 1 - minima/(starts - 1).  It is the mean of minima/all minima over the posterior
/// of Boender, Rinnooy Kan (1987), eq. 9.  0 where there are too few starts to say.
[[nodiscard]] double confidence_of_optimum(std::size_t starts, std::size_t minima);

/// Seeded multi-start: each round draws coefficients from the magnitudes and frequencies the data span (their dimension
/// says how), orders from the suggested ones and from their ranges, keeps the few draws of lowest cost and scouts from
/// each; linear least squares for the coefficients gives two more starts, and so do draws with every order whole, where
/// an integer-order structure lies inside.  Scouts that come near the best are finished on all residuals.  It ends when
/// enough of them agree on the best cost and confidence_of_optimum() is high, after walks from the best minimum along
/// the directions the data hardly resist have led nowhere lower.  Parameters of either sign are then tried with the
/// other one.  If no two ever agree, NLopt's controlled random search tries the whole box.
/// @param scouting  residuals of the same kind at fewer points, or `residuals` itself.  Where what it leaves out turns
///                  out to be fitted worse than what it has, it misses a feature, and the search is made again without.
/// @param hopeless  cost above which a minimum that enough agree on is left at that, without walks: something else
///                  follows the data far better.  An end from which the cost still falls is no minimum, and costs that
///                  differ by 2 % are the same.
[[nodiscard]] GlobalSolution global_search(const Residuals& scouting, const Residuals& residuals,
                                           const std::vector<double>& suggested_orders, std::uint64_t seed,
                                           double hopeless = std::numeric_limits<double>::infinity(),
                                           SearchAim aim = SearchAim::optimum);

}  // namespace frac::detail
