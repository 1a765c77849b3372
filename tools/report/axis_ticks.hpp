// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace report {

/// An axis as it is drawn.
struct DrawnAxis {
  double from, to;  // from < to; both positive where logarithmic
  bool logarithmic = false;
  bool degrees = false;   // ticks at parts of a right angle; linear axes only
  bool vertical = false;  // labels stand above each other instead of side by side
  double length = 300;    // px
};

struct Tick {
  double value;
  std::string label;  // gnuplot's enhanced text; empty: a small tick without a label
};

/// Distance of the labelled ticks of a linear axis, mantissa 10^exponent.
struct TickStep {
  int mantissa, exponent;
  [[nodiscard]] double value() const;
};

/// The finest step of round numbers whose labels stand free of each other.
[[nodiscard]] TickStep tick_step(const DrawnAxis& axis);

/// Ticks at all multiples of step on a linear axis.
[[nodiscard]] std::vector<Tick> ticks_at(const DrawnAxis& axis, const TickStep& step);

/// Ticks from left to right: powers of ten over many decades, round numbers over few, equal steps within a part of one
/// decade.  At least two have labels, and each label is the exact decimal number of its value: gnuplot would count the
/// ticks of a logarithmic axis from where the axis begins and print them with six digits.
[[nodiscard]] std::vector<Tick> axis_ticks(const DrawnAxis& axis);

}  // namespace report
