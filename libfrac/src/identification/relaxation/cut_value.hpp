// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <complex>
#include <cstddef>
#include <span>
#include <vector>

#include "formula/expression.hpp"

namespace frac::detail {

/// A formula on the upper side of the cut along the negative real axis, at given parameters.
class CutValue {
 public:
  CutValue(const Expression& expression, std::span<const double> parameters);

  /// One of its operations at s = -rate + j 0, rate > 0.
  [[nodiscard]] std::complex<double> of(int node, double rate);

 private:
  const Expression& expression_;
  std::vector<double> real_;
  std::vector<std::complex<double>> value_;
};

/// Values at many rates, and with single parameters moved: only what depends on these is computed anew.
class CutValues {
 public:
  CutValues(const Expression& expression, std::span<const double> parameters, std::vector<double> rates);

  [[nodiscard]] const std::vector<std::complex<double>>& values() const { return value_.back(); }
  [[nodiscard]] std::vector<std::complex<double>> moved(std::size_t parameter, double to) const;

 private:
  const Expression& expression_;
  std::vector<double> parameters_, rates_, real_;
  std::vector<std::vector<std::complex<double>>> value_;  // of each node at each rate
};

}  // namespace frac::detail
