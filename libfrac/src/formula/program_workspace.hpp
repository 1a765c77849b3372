// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cmath>
#include <complex>
#include <cstddef>
#include <numbers>
#include <vector>

#include "base/wide_vectors.hpp"
#include "program.hpp"
#include "realisation/power_grid.hpp"
#include "realisation/prepared_power.hpp"

namespace frac::detail {

/// Frequencies per pass: long enough to amortise the dispatch, short enough for the cache.
constexpr std::size_t block_size = 16;

/// Values of one slot at the frequencies of a block, one by one or several at once.
struct Lanes {
  static constexpr std::size_t width = 4;
  using Vector = Doubles<width>::Type;

  [[nodiscard]] std::complex<double> get(std::size_t i) const { return {re_[i], im_[i]}; }
  void set(std::size_t i, std::complex<double> value) {
    re_[i] = value.real();
    im_[i] = value.imag();
  }
  void copy_to(std::complex<double>* values, std::size_t count) const {
    double* const pairs = reinterpret_cast<double*>(values);
    for (std::size_t i = 0; i < count; ++i) {
      pairs[2 * i] = re_[i];
      pairs[2 * i + 1] = im_[i];
    }
  }
  [[nodiscard]] FRACFIT_INLINE Vector& re(std::size_t v) { return Doubles<width>::at(&re_[v * width]); }
  [[nodiscard]] FRACFIT_INLINE Vector& im(std::size_t v) { return Doubles<width>::at(&im_[v * width]); }
  [[nodiscard]] FRACFIT_INLINE const Vector& re(std::size_t v) const { return Doubles<width>::at(&re_[v * width]); }
  [[nodiscard]] FRACFIT_INLINE const Vector& im(std::size_t v) const { return Doubles<width>::at(&im_[v * width]); }

 private:
  std::array<double, block_size> re_, im_;
};

/// How many vectors hold that many values; what the last one holds beyond them is never read one by one.
[[nodiscard]] constexpr std::size_t vectors_of(std::size_t count) {
  return (count + Lanes::width - 1) / Lanes::width;
}

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
