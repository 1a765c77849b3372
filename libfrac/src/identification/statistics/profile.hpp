// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <string>

#include "confidence.hpp"

namespace frac::detail {

/// How a profile is followed along a coordinate: the parameter, or its logarithm.
struct ProfileLine {
  double centre;        // where the cost is least
  double step;          // distance at which an end is first looked for, > 0
  double lower, upper;  // limits
  bool logarithmic;     // a coefficient many e-folds away is not bounded by the data
};

/// Where `rise`, the square root of the rise of the cost in units of that for one standard error, reaches `wanted` on
/// one side of the centre: by secant steps, since it is linear where the model is.
/// @param tolerance  of an end, relative to its distance from the centre
/// @param steps      at most; an end not bracketed by then counts as open
/// @return -infinity or infinity where there is none
[[nodiscard]] double profile_end(const std::function<double(double)>& rise, const ProfileLine& line, int side,
                                 double wanted, double tolerance, int steps);

/// Where the least cost with one parameter held reaches what a 95 % interval allows.
struct ProfileEnds {
  double lower, upper;              // -infinity, infinity where the limits come first
  double lower_limit, upper_limit;  // of the parameter
  bool below_minimum;               // a lower cost than that of the solution was met: it is no minimum
  /// At an end nearer than the curvature says the cost, followed there in small steps, is lower: solves of the other
  /// parameters stuck in one leap, so that it rose too fast.
  bool stuck;
};

/// Where a profile starts: a parameter of the structure, or one that the residuals are projected free of.
struct ProfileCentre {
  std::string name;
  double value;
  double error;  // standard, in white noise
  double widening;
};
/// A parameter of the structure.
[[nodiscard]] ProfileCentre profile_centre(const Problem& problem, const LocalSolution& solution,
                                           const Confidence& confidence, std::size_t parameter);

/// Its 95 % interval; tolerance and steps as of profile_end().
[[nodiscard]] ProfileEnds profile_ends(Problem& problem, const LocalSolution& solution, const LocalOptions& options,
                                       const Confidence& confidence, const ProfileCentre& centre, double tolerance,
                                       int steps);

}  // namespace frac::detail
