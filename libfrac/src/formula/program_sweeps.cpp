// SPDX-License-Identifier: BSD-3-Clause
// Values forwards and gradients backwards through the steps of a program, on one block of frequencies.
#include <algorithm>
#include <array>
#include <cmath>

#include "base/wide_vectors.hpp"
#include "program.hpp"
#include "program_workspace.hpp"
#include "special/complex_functions.hpp"

namespace frac::detail {
namespace {

using Complex = std::complex<double>;

FRACFIT_INLINE inline void set_exact_laplace(Complex direction, std::span<const double> modulus, Lanes& out) {
  for (std::size_t i = 0; i < modulus.size(); ++i) out.set(i, modulus[i] * direction);
}

FRACFIT_INLINE inline void set_laplace(const PreparedPower& power, Complex direction, std::span<const double> modulus,
                                       Lanes& out) {
  if (power.is_exact()) {
    set_exact_laplace(direction, modulus, out);
  } else {
    for (std::size_t i = 0; i < modulus.size(); ++i) out.set(i, power.value(modulus[i]));
  }
}

// Plain arithmetic goes through n vectors, functions through `count` values.

FRACFIT_INLINE inline void set_constant(double value, std::size_t n, Lanes& out) {
  for (std::size_t v = 0; v < n; ++v) {
    out.re(v) = value - Lanes::Vector{};
    out.im(v) = Lanes::Vector{};
  }
}

// out = a + sign b
FRACFIT_INLINE inline void set_sum(const Lanes& a, double sign, const Lanes& b, std::size_t n, Lanes& out) {
  for (std::size_t v = 0; v < n; ++v) {
    out.re(v) = a.re(v) + sign * b.re(v);
    out.im(v) = a.im(v) + sign * b.im(v);
  }
}

// out = shift + sign a
FRACFIT_INLINE inline void set_shifted(double shift, double sign, const Lanes& a, std::size_t n, Lanes& out) {
  for (std::size_t v = 0; v < n; ++v) {
    out.re(v) = shift + sign * a.re(v);
    out.im(v) = sign * a.im(v);
  }
}

FRACFIT_INLINE inline void set_scaled(const Lanes& a, double factor, std::size_t n, Lanes& out) {
  for (std::size_t v = 0; v < n; ++v) {
    out.re(v) = a.re(v) * factor;
    out.im(v) = a.im(v) * factor;
  }
}

FRACFIT_INLINE inline void set_product(const Lanes& a, const Lanes& b, std::size_t n, Lanes& out) {
  for (std::size_t v = 0; v < n; ++v) {
    out.re(v) = a.re(v) * b.re(v) - a.im(v) * b.im(v);
    out.im(v) = a.re(v) * b.im(v) + a.im(v) * b.re(v);
  }
}

FRACFIT_INLINE inline void set_reciprocal(const Lanes& a, std::size_t n, Lanes& out) {
  using Truth = decltype(Lanes::Vector{} < Lanes::Vector{});
  Truth extreme = {};  // squares that leave the range of double
  for (std::size_t v = 0; v < n; ++v) {
    const Lanes::Vector square = a.re(v) * a.re(v) + a.im(v) * a.im(v);
    out.re(v) = a.re(v) / square;
    out.im(v) = -a.im(v) / square;
    extreme |= ~((square > 1e-280) & (square < 1e280));
  }
  for (std::size_t lane = 0; lane < Lanes::width; ++lane) {
    if (extreme[lane] == 0) continue;
    for (std::size_t i = lane; i < n * Lanes::width; i += Lanes::width) out.set(i, reciprocal(a.get(i)));
  }
}

FRACFIT_INLINE inline void set_quotient(const Lanes& a, const Lanes& b, std::size_t n, Lanes& out) {
  Lanes inverse;
  set_reciprocal(b, n, inverse);
  set_product(a, inverse, n, out);
}

FRACFIT_INLINE inline void set_quotient(const Lanes& a, double b, std::size_t n, Lanes& out) {
  for (std::size_t v = 0; v < n; ++v) {
    out.re(v) = a.re(v) / b;
    out.im(v) = a.im(v) / b;
  }
}

FRACFIT_INLINE inline void set_quotient(double a, const Lanes& b, std::size_t n, Lanes& out) {
  Lanes inverse;
  set_reciprocal(b, n, inverse);
  set_scaled(inverse, a, n, out);
}

// The functions below also set the derivatives by their operands, unless these are null.

FRACFIT_INLINE inline void set_exact_power_of_s(const ScaledPower& power, const PowerGrid& grid, std::size_t first,
                                                std::size_t count, Lanes& out, Lanes* by_left, Lanes* by_right) {
  using Block = std::array<double, block_size>;
  const auto at = [](const Block& values, std::size_t v) FRACFIT_INLINE -> const Lanes::Vector& {
    return Doubles<Lanes::width>::at(&values[v * Lanes::width]);
  };
  // The last vector is filled up with the last value.
  Block size, log_omega;
  const std::size_t n = vectors_of(count);
  grid.powers(power.of_s.order(), first, {size.data(), count});
  std::fill(size.begin() + count, size.begin() + n * Lanes::width, size[count - 1]);
  const Complex scale = power.factor * power.phase;
  for (std::size_t v = 0; v < n; ++v) {
    out.re(v) = scale.real() * at(size, v);
    out.im(v) = scale.imag() * at(size, v);
  }
  if (by_left) {
    const Complex slope = power.factor_by_coefficient * power.phase;
    for (std::size_t v = 0; v < n; ++v) {
      by_left->re(v) = slope.real() * at(size, v);
      by_left->im(v) = slope.imag() * at(size, v);
    }
  }
  if (by_right) {
    // d/dq of |c|^q omega^q e^{j q angle}.
    std::copy_n(grid.log_omega().begin() + first, count, log_omega.begin());
    std::fill(log_omega.begin() + count, log_omega.begin() + n * Lanes::width, log_omega[count - 1]);
    const double angle = power.angle;
    const Complex constant = power.factor_by_order * power.phase;
    for (std::size_t v = 0; v < n; ++v) {
      by_right->re(v) = out.re(v) * at(log_omega, v) - out.im(v) * angle + constant.real() * at(size, v);
      by_right->im(v) = out.im(v) * at(log_omega, v) + out.re(v) * angle + constant.imag() * at(size, v);
    }
  }
}

void set_realised_power_of_s(const ScaledPower& power, std::span<const double> omega, const double* log_omega,
                             Lanes& out, Lanes* by_left, Lanes* by_right) {
  for (std::size_t i = 0; i < omega.size(); ++i) {
    PowerResponse of_s{};
    if (by_right) {
      of_s = power.of_s.response(omega[i], log_omega[i]);
    } else {
      of_s.value = power.of_s.value(omega[i]);
    }
    if (power.conjugate) of_s = {std::conj(of_s.value), std::conj(of_s.by_order)};
    out.set(i, power.factor * of_s.value);
    if (by_left) by_left->set(i, power.factor_by_coefficient * of_s.value);
    if (by_right) by_right->set(i, power.factor * of_s.by_order + power.factor_by_order * of_s.value);
  }
}

/// @param first  place of the first frequency on the grid
FRACFIT_INLINE inline void set_power_of_s(const ScaledPower& power, const PowerGrid& grid, std::size_t first,
                                          std::span<const double> omega, Lanes& out, Lanes* by_left, Lanes* by_right) {
  if (power.of_s.is_exact()) {
    set_exact_power_of_s(power, grid, first, omega.size(), out, by_left, by_right);
  } else {
    set_realised_power_of_s(power, omega, grid.log_omega().data() + first, out, by_left, by_right);
  }
}

void set_whole_power(const Lanes& a, int exponent, std::size_t count, Lanes& out, Lanes* by_left) {
  for (std::size_t i = 0; i < count; ++i) {
    if (by_left) {
      const Complex below = whole_power(a.get(i), exponent - 1);
      out.set(i, product(below, a.get(i)));
      by_left->set(i, static_cast<double>(exponent) * below);
    } else {
      out.set(i, whole_power(a.get(i), exponent));
    }
  }
}

void set_general_power(const Lanes& a, double order, std::size_t count, Lanes& out, Lanes* by_left, Lanes* by_right) {
  for (std::size_t i = 0; i < count; ++i) {
    const Complex base = a.get(i);
    const Complex log_base = principal_log(base);
    const Complex value = exponential(order * log_base);
    out.set(i, value);
    if (by_left) by_left->set(i, order * product(value, reciprocal(base)));
    if (by_right) by_right->set(i, product(value, log_base));
  }
}

void set_exponential(const Lanes& a, std::size_t count, Lanes& out, Lanes* by_left) {
  for (std::size_t i = 0; i < count; ++i) out.set(i, exponential(a.get(i)));
  if (by_left) *by_left = out;
}

void set_square_root(const Lanes& a, std::size_t count, Lanes& out, Lanes* by_left) {
  for (std::size_t i = 0; i < count; ++i) {
    const Complex root = std::sqrt(a.get(i));
    out.set(i, root);
    if (by_left) by_left->set(i, 0.5 * reciprocal(root));
  }
}

void set_function(ValueAndDerivative (&function)(Complex), const Lanes& a, std::size_t count, Lanes& out,
                  Lanes* by_left) {
  for (std::size_t i = 0; i < count; ++i) {
    const ValueAndDerivative result = function(a.get(i));
    out.set(i, result.value);
    if (by_left) by_left->set(i, result.derivative);
  }
}

FRACFIT_INLINE inline void add_product(Lanes& sum, const Lanes& a, const Lanes& b, std::size_t n) {
  for (std::size_t v = 0; v < n; ++v) {
    sum.re(v) += a.re(v) * b.re(v) - a.im(v) * b.im(v);
    sum.im(v) += a.re(v) * b.im(v) + a.im(v) * b.re(v);
  }
}

FRACFIT_INLINE inline void subtract_product(Lanes& sum, const Lanes& a, const Lanes& b, std::size_t n) {
  for (std::size_t v = 0; v < n; ++v) {
    sum.re(v) -= a.re(v) * b.re(v) - a.im(v) * b.im(v);
    sum.im(v) -= a.re(v) * b.im(v) + a.im(v) * b.re(v);
  }
}

FRACFIT_INLINE inline void add_scaled(Lanes& sum, const Lanes& a, double factor, std::size_t n) {
  for (std::size_t v = 0; v < n; ++v) {
    sum.re(v) += a.re(v) * factor;
    sum.im(v) += a.im(v) * factor;
  }
}

// The adjoints of the operands of a quotient, unless these are null.
FRACFIT_INLINE inline void add_quotient(Lanes* of_left, Lanes* of_right, const Lanes& adjoint, const Lanes& quotient,
                                        const Lanes& denominator, std::size_t n) {
  Lanes share;
  set_quotient(adjoint, denominator, n, share);
  if (of_left) add_scaled(*of_left, share, 1, n);
  if (of_right) subtract_product(*of_right, share, quotient, n);
}

FRACFIT_INLINE inline void add_quotient(Lanes* of_left, Lanes* of_right, const Lanes& adjoint, const Lanes& quotient,
                                        double denominator, std::size_t n) {
  Lanes share;
  set_scaled(adjoint, 1 / denominator, n, share);
  if (of_left) add_scaled(*of_left, share, 1, n);
  if (of_right) subtract_product(*of_right, share, quotient, n);
}

}  // namespace

void Program::forward(std::span<const double> omega, std::size_t first, bool with_gradient, Workspace& work) const {
  const std::size_t count = omega.size(), n = vectors_of(count);
  with_wide_vectors([&]() FRACFIT_INLINE {
    for (std::size_t index = 0; index < complex_steps_.size(); ++index) {
      const ComplexStep& step = complex_steps_[index];
      Lanes& out = work.value[index];
      Lanes* const by_left = with_gradient && step.left_active ? &work.by_left[index] : nullptr;
      Lanes* const by_right = with_gradient && step.right_active ? &work.by_right[index] : nullptr;
      const auto left = [&]() -> const Lanes& { return work.value[static_cast<std::size_t>(step.left)]; };
      const auto right = [&]() -> const Lanes& { return work.value[static_cast<std::size_t>(step.right)]; };
      const auto real_left = [&] { return work.real[static_cast<std::size_t>(step.left)]; };
      const auto real_right = [&] { return work.real[static_cast<std::size_t>(step.right)]; };
      const auto power = [&]() -> const ScaledPower& { return work.powers[static_cast<std::size_t>(step.power)]; };
      // clang-format off
      switch (step.code) {
        case Code::laplace:       set_laplace(power().of_s, work.direction, omega, out); break;
        case Code::exact_laplace: set_exact_laplace(work.direction, omega, out); break;
        case Code::add_cc:        set_sum(left(), 1, right(), n, out); break;
        case Code::add_cr:        set_shifted(real_right(), 1, left(), n, out); break;
        case Code::subtract_cc:   set_sum(left(), -1, right(), n, out); break;
        case Code::subtract_cr:   set_shifted(-real_right(), 1, left(), n, out); break;
        case Code::subtract_rc:   set_shifted(real_left(), -1, right(), n, out); break;
        case Code::multiply_cc:   set_product(left(), right(), n, out); break;
        case Code::multiply_cr:   set_scaled(left(), real_right(), n, out); break;
        case Code::divide_cc:     set_quotient(left(), right(), n, out); break;
        case Code::divide_cr:     set_quotient(left(), real_right(), n, out); break;
        case Code::divide_rc:     set_quotient(real_left(), right(), n, out); break;
        case Code::negate:        set_scaled(left(), -1, n, out); break;
        case Code::power_of_s:    set_power_of_s(power(), work.grid, first, omega, out, by_left, by_right); break;
        case Code::whole_power:   set_whole_power(left(), step.whole, count, out, by_left); break;
        case Code::general_power: set_general_power(left(), real_right(), count, out, by_left, by_right); break;
        case Code::exp:           set_exponential(left(), count, out, by_left); break;
        case Code::sqrt:          set_square_root(left(), count, out, by_left); break;
        case Code::tanh:          set_function(hyperbolic_tangent, left(), count, out, by_left); break;
        case Code::coth:          set_function(hyperbolic_cotangent, left(), count, out, by_left); break;
        case Code::sinh:          set_function(hyperbolic_sine, left(), count, out, by_left); break;
        case Code::cosh:          set_function(hyperbolic_cosine, left(), count, out, by_left); break;
        case Code::sech:          set_function(hyperbolic_secant, left(), count, out, by_left); break;
        case Code::log:           set_function(logarithm, left(), count, out, by_left); break;
      }
      // clang-format on
    }
  });
}

bool Program::left_is_real(Code code) {
  return code == Code::subtract_rc || code == Code::divide_rc || code == Code::power_of_s;
}

bool Program::right_is_real(Code code) {
  return code == Code::add_cr || code == Code::subtract_cr || code == Code::multiply_cr || code == Code::divide_cr ||
         code == Code::power_of_s || code == Code::general_power;
}

FRACFIT_INLINE inline void Program::pass_back(std::size_t index, std::size_t n, Workspace& work) const {
  const ComplexStep& step = complex_steps_[index];
  if (!step.left_active && !step.right_active) return;
  const Lanes& adjoint = work.adjoint[index];
  const auto adjoint_of = [&](bool real, bool active, int slot) {
    return active ? &(real ? work.real_adjoint : work.adjoint)[static_cast<std::size_t>(slot)] : nullptr;
  };
  Lanes* const of_left = adjoint_of(left_is_real(step.code), step.left_active, step.left);
  Lanes* const of_right = adjoint_of(right_is_real(step.code), step.right_active, step.right);
  const auto value = [&](int slot) -> const Lanes& { return work.value[static_cast<std::size_t>(slot)]; };
  const auto real = [&](int slot) { return work.real[static_cast<std::size_t>(slot)]; };
  switch (step.code) {
    case Code::laplace:
    case Code::exact_laplace:
      break;
    case Code::add_cc:
    case Code::add_cr:
      if (of_left) add_scaled(*of_left, adjoint, 1, n);
      if (of_right) add_scaled(*of_right, adjoint, 1, n);
      break;
    case Code::subtract_cc:
    case Code::subtract_cr:
    case Code::subtract_rc:
      if (of_left) add_scaled(*of_left, adjoint, 1, n);
      if (of_right) add_scaled(*of_right, adjoint, -1, n);
      break;
    case Code::multiply_cc:
      if (of_left) add_product(*of_left, adjoint, value(step.right), n);
      if (of_right) add_product(*of_right, adjoint, value(step.left), n);
      break;
    case Code::multiply_cr:
      if (of_left) add_scaled(*of_left, adjoint, real(step.right), n);
      if (of_right) add_product(*of_right, adjoint, value(step.left), n);
      break;
    case Code::divide_cc:
    case Code::divide_rc:
      add_quotient(of_left, of_right, adjoint, work.value[index], value(step.right), n);
      break;
    case Code::divide_cr:
      add_quotient(of_left, of_right, adjoint, work.value[index], real(step.right), n);
      break;
    case Code::negate:
      add_scaled(*of_left, adjoint, -1, n);
      break;
    default:  // functions and powers, whose derivatives the forward sweep has kept
      if (of_left) add_product(*of_left, adjoint, work.by_left[index], n);
      if (of_right) add_product(*of_right, adjoint, work.by_right[index], n);
      break;
  }
}

void Program::backward(std::size_t count, Workspace& work) const {
  const std::size_t n = vectors_of(count);
  with_wide_vectors([&]() FRACFIT_INLINE {
    for (std::size_t i = 0; i < real_steps_.size(); ++i) set_constant(0, n, work.real_adjoint[i]);
    for (std::size_t i = 0; i < complex_steps_.size(); ++i) set_constant(0, n, work.adjoint[i]);
    set_constant(
        1, n,
        complex_steps_.empty() ? work.real_adjoint[real_steps_.size() - 1] : work.adjoint[complex_steps_.size() - 1]);

    for (std::size_t index = complex_steps_.size(); index-- > 0;) pass_back(index, n, work);
    for (std::size_t index = real_steps_.size(); index-- > 0;) {
      const RealStep& step = real_steps_[index];
      const Lanes& adjoint = work.real_adjoint[index];
      const auto of = [&](int slot) -> Lanes& { return work.real_adjoint[static_cast<std::size_t>(slot)]; };
      if (step.left_active) add_scaled(of(step.left), adjoint, work.real_by_left[index], n);
      if (step.right_active) add_scaled(of(step.right), adjoint, work.real_by_right[index], n);
    }
  });
}

}  // namespace frac::detail
