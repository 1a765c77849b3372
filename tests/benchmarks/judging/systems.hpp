// SPDX-License-Identifier: BSD-3-Clause
// The systems of the judging population.  Each kind draws a system whose action lies around 1 rad/s with a gain near 1;
// the population moves it to its band and unit.  Nothing here comes from the library that is judged.
#pragma once

#include <complex>
#include <functional>
#include <string>
#include <vector>

#include "benchmarks/judging/random_numbers.hpp"

namespace judging {

using Complex = std::complex<double>;

/// A drawn system.  `response(p, a, s)` is its transfer function; `a` is the order of one of its factors, which the
/// system itself has at `order`.  An integer-order system freed of `a` = 1 is its nearest fractional rival.
struct System {
  std::function<Complex(const std::vector<double>&, double, Complex)> response;
  /// Names of the parameters, separated by blanks.
  std::string names;
  std::vector<double> parameters;
  double order = 1;
  /// Dead time, 1/(rad/s), 0 without.
  double delay = 0;
  /// False where the response does not hold `a` at all.
  bool has_order = true;

  [[nodiscard]] Complex operator()(Complex s) const { return response(parameters, order, s); }

  /// Free parameters of the system as someone who knew its structure would fit it: gain, parameters and fractional
  /// order.
  [[nodiscard]] int free_parameters(bool fractional) const {
    return static_cast<int>(parameters.size()) + 1 + (fractional && has_order ? 1 : 0);
  }
};

struct Kind {
  std::string name;
  bool fractional;
  /// Whether a list of structures can be expected to hold it.  Integer order: a ratio of polynomials of order 12 at
  /// most, with or without a dead time in front, writes it exactly.  Fractional: it has a common name.
  bool within_family;
  std::function<System(RandomNumbers&)> draw;
};

/// All kinds; the order is that of the tables.
const std::vector<Kind>& kinds();

}  // namespace judging
