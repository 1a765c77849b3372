#pragma once

#include <vector>

#include "confidence.hpp"
#include "fit_problem.hpp"

namespace frac::detail {

/// Where the least cost with one parameter held reaches what a 95 % interval allows.
struct ProfileEnds {
  double lower, upper;              // -infinity, infinity where the limits come first
  double lower_limit, upper_limit;  // of the parameter
  bool below_minimum;               // a lower cost than that of the solution was met: it is no minimum
};

/// The 95 % interval of a free parameter, by secant steps on the square root of the rise of the
/// cost, which is linear where the model is.
/// @param tolerance  of an end, relative to its distance from the estimate
/// @param steps      at most, on either side; an end not bracketed by then counts as open
[[nodiscard]] ProfileEnds profile_ends(const FitProblem& problem, const LocalSolution& solution,
                                       const LocalOptions& options, const Confidence& confidence, std::size_t parameter,
                                       double tolerance, int steps);

}  // namespace frac::detail
