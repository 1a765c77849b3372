// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <complex>
#include <span>
#include <vector>

#include "formula/expression.hpp"

namespace frac::detail {

/// A formula on the upper side of the cut along the negative real axis, at given parameters.
class CutValue {
 public:
  CutValue(const Expression& expression, std::span<const double> parameters);

  /// At s = -rate + j 0, rate > 0.
  [[nodiscard]] std::complex<double> operator()(double rate);

 private:
  // The value of a node that depends on s, those before it being known.
  [[nodiscard]] std::complex<double> of(const Node& node, double rate) const;

  const Expression& expression_;
  std::vector<double> real_;
  std::vector<std::complex<double>> value_;
};

}  // namespace frac::detail
