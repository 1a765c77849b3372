// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <cstddef>
#include <numbers>
#include <vector>

#include "program.hpp"
#include "realisation/power_grid.hpp"
#include "realisation/prepared_power.hpp"

namespace frac::detail {

/// Frequencies per pass: long enough to amortise the dispatch, short enough for the cache.
constexpr std::size_t block_size = 16;

/// Values of one slot at the frequencies of a block.
struct Lanes {
  std::array<double, block_size> re;
  std::array<double, block_size> im;

  [[nodiscard]] std::complex<double> get(std::size_t i) const { return {re[i], im[i]}; }
  void set(std::size_t i, std::complex<double> value) {
    re[i] = value.real();
    im[i] = value.imag();
  }
  void clear(std::size_t count) {
    std::fill_n(re.begin(), count, 0.0);
    std::fill_n(im.begin(), count, 0.0);
  }
  void add(std::size_t i, double real, double imaginary) {
    re[i] += real;
    im[i] += imaginary;
  }
};

/// (c s)^q for real c: |c|^q H(s) for c >= 0 and |c|^q H(-s) = |c|^q conj(H(s)) for c < 0, which is the principal value
/// where H is exact, and the natural reading where it is not.
struct ScaledPower {
  PreparedPower of_s;
  bool conjugate = false;
  // Where exact, of +-s = |s| e^{j angle}: its argument, and e^{j q angle}.
  double angle = 0;
  std::complex<double> phase = 1;
  double factor = 1;  // |c|^q
  double factor_by_coefficient = 0;
  double factor_by_order = 0;

  /// @param angle_of_s  0 to pi/2
  void prepare_scale(double coefficient, double order, double angle_of_s) {
    conjugate = coefficient < 0;
    angle = conjugate ? angle_of_s - std::numbers::pi : angle_of_s;
    const bool on_axis = angle_of_s == std::numbers::pi / 2;
    phase = !on_axis ? std::polar(1.0, order * angle) : conjugate ? std::conj(of_s.phase()) : of_s.phase();
    const double size = std::abs(coefficient);
    factor = coefficient == 1 ? 1 : std::pow(size, order);
    factor_by_coefficient = order == 0 ? 0 : std::copysign(order * std::pow(size, order - 1), order * coefficient);
    factor_by_order = factor == 0 ? 0 : factor * std::log(size);
  }
};

struct Program::Workspace {
  std::vector<double> real, real_by_left, real_by_right;
  std::vector<ScaledPower> powers;
  std::vector<Lanes> value, adjoint, real_adjoint;
  std::vector<Lanes> by_left, by_right;  // stored derivatives of the steps that are no plain arithmetic
  PowerGrid grid;
  std::complex<double> direction;  // of s
};

}  // namespace frac::detail
