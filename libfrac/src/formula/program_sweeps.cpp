// SPDX-License-Identifier: BSD-3-Clause
// Values forwards and gradients backwards through the steps of a program, on one block of frequencies.
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "program.hpp"
#include "program_workspace.hpp"
#include "special/complex_functions.hpp"

namespace frac::detail {
namespace {

using Complex = std::complex<double>;

void exact_power(const ScaledPower& power, const PowerGrid& grid, std::size_t first, std::size_t n, Lanes& out,
                 Lanes* by_left, Lanes* by_right) {
  std::array<double, block_size> size;
  grid.powers(power.of_s.order(), first, {size.data(), n});
  const Complex phase = power.conjugate ? std::conj(power.of_s.phase()) : power.of_s.phase();
  const Complex scale = power.factor * phase;
  for (std::size_t i = 0; i < n; ++i) out.re[i] = scale.real() * size[i];
  for (std::size_t i = 0; i < n; ++i) out.im[i] = scale.imag() * size[i];
  if (by_left) {
    const Complex slope = power.factor_by_coefficient * phase;
    for (std::size_t i = 0; i < n; ++i) by_left->re[i] = slope.real() * size[i];
    for (std::size_t i = 0; i < n; ++i) by_left->im[i] = slope.imag() * size[i];
  }
  if (by_right) {
    // d/dq of |c|^q omega^q e^{+-j q pi/2}.
    const double angle = power.conjugate ? -std::numbers::pi / 2 : std::numbers::pi / 2;
    const Complex constant = power.factor_by_order * phase;
    const double* log_omega = grid.log_omega().data() + first;
    for (std::size_t i = 0; i < n; ++i) {
      by_right->re[i] = out.re[i] * log_omega[i] - out.im[i] * angle + constant.real() * size[i];
      by_right->im[i] = out.im[i] * log_omega[i] + out.re[i] * angle + constant.imag() * size[i];
    }
  }
}

}  // namespace

void Program::forward(std::span<const double> omega, std::size_t first, bool with_gradient, Workspace& work) const {
  const std::size_t n = omega.size();
  const double* const log_omega = power_count_ > 0 ? work.grid.log_omega().data() + first : nullptr;
  for (std::size_t index = 0; index < complex_steps_.size(); ++index) {
    const ComplexStep& step = complex_steps_[index];
    Lanes& out = work.value[index];
    const auto left = [&]() -> const Lanes& { return work.value[static_cast<std::size_t>(step.left)]; };
    const auto right = [&]() -> const Lanes& { return work.value[static_cast<std::size_t>(step.right)]; };
    const auto real_left = [&] { return work.real[static_cast<std::size_t>(step.left)]; };
    const auto real_right = [&] { return work.real[static_cast<std::size_t>(step.right)]; };
    const auto set_sum = [&](const Lanes& a, double sign, const Lanes& b) {
      for (std::size_t i = 0; i < n; ++i) out.re[i] = a.re[i] + sign * b.re[i];
      for (std::size_t i = 0; i < n; ++i) out.im[i] = a.im[i] + sign * b.im[i];
    };
    const auto set_shifted = [&](double shift, double sign, const Lanes& a) {
      for (std::size_t i = 0; i < n; ++i) out.re[i] = shift + sign * a.re[i];
      for (std::size_t i = 0; i < n; ++i) out.im[i] = sign * a.im[i];
    };
    const auto set_scaled = [&](const Lanes& a, double factor) {
      for (std::size_t i = 0; i < n; ++i) out.re[i] = a.re[i] * factor;
      for (std::size_t i = 0; i < n; ++i) out.im[i] = a.im[i] * factor;
    };
    const bool by_left = with_gradient && step.left_active;
    const bool by_right = with_gradient && step.right_active;
    switch (step.code) {
      case Code::laplace: {
        const PreparedPower& power = work.powers[static_cast<std::size_t>(step.power)].of_s;
        for (std::size_t i = 0; i < n; ++i) out.set(i, power.value(omega[i]));
        break;
      }
      case Code::exact_laplace:
        for (std::size_t i = 0; i < n; ++i) out.set(i, {0, omega[i]});
        break;
      case Code::add_cc:
        set_sum(left(), 1, right());
        break;
      case Code::add_cr:
        set_shifted(real_right(), 1, left());
        break;
      case Code::subtract_cc:
        set_sum(left(), -1, right());
        break;
      case Code::subtract_cr:
        set_shifted(-real_right(), 1, left());
        break;
      case Code::subtract_rc:
        set_shifted(real_left(), -1, right());
        break;
      case Code::multiply_cc: {
        const Lanes& a = left();
        const Lanes& b = right();
        for (std::size_t i = 0; i < n; ++i) {
          out.re[i] = a.re[i] * b.re[i] - a.im[i] * b.im[i];
          out.im[i] = a.re[i] * b.im[i] + a.im[i] * b.re[i];
        }
        break;
      }
      case Code::multiply_cr:
        set_scaled(left(), real_right());
        break;
      case Code::divide_cc:
        for (std::size_t i = 0; i < n; ++i) out.set(i, product(left().get(i), reciprocal(right().get(i))));
        break;
      case Code::divide_cr: {
        const Lanes& a = left();
        const double b = real_right();
        for (std::size_t i = 0; i < n; ++i) out.re[i] = a.re[i] / b;
        for (std::size_t i = 0; i < n; ++i) out.im[i] = a.im[i] / b;
        break;
      }
      case Code::divide_rc:
        for (std::size_t i = 0; i < n; ++i) out.set(i, real_left() * reciprocal(right().get(i)));
        break;
      case Code::negate:
        set_scaled(left(), -1);
        break;
      case Code::power_of_s: {
        const ScaledPower& power = work.powers[static_cast<std::size_t>(step.power)];
        if (power.of_s.is_exact()) {
          exact_power(power, work.grid, first, n, out, by_left ? &work.by_left[index] : nullptr,
                      by_right ? &work.by_right[index] : nullptr);
          break;
        }
        for (std::size_t i = 0; i < n; ++i) {
          PowerResponse of_s{};
          if (by_right) {
            of_s = power.of_s.response(omega[i], log_omega[i]);
          } else {
            of_s.value = power.of_s.value(omega[i]);
          }
          if (power.conjugate) of_s = {std::conj(of_s.value), std::conj(of_s.by_order)};
          out.set(i, power.factor * of_s.value);
          if (by_left) work.by_left[index].set(i, power.factor_by_coefficient * of_s.value);
          if (by_right) {
            work.by_right[index].set(i, power.factor * of_s.by_order + power.factor_by_order * of_s.value);
          }
        }
        break;
      }
      case Code::whole_power: {
        const Lanes& a = left();
        for (std::size_t i = 0; i < n; ++i) {
          if (by_left) {
            const Complex below = whole_power(a.get(i), step.whole - 1);
            out.set(i, product(below, a.get(i)));
            work.by_left[index].set(i, static_cast<double>(step.whole) * below);
          } else {
            out.set(i, whole_power(a.get(i), step.whole));
          }
        }
        break;
      }
      case Code::general_power: {
        const Lanes& a = left();
        const double order = real_right();
        for (std::size_t i = 0; i < n; ++i) {
          const Complex base = a.get(i);
          const Complex log_base = principal_log(base);
          const Complex value = exponential(order * log_base);
          out.set(i, value);
          if (by_left) work.by_left[index].set(i, order * product(value, reciprocal(base)));
          if (by_right) work.by_right[index].set(i, product(value, log_base));
        }
        break;
      }
      case Code::exp:
        for (std::size_t i = 0; i < n; ++i) out.set(i, exponential(left().get(i)));
        if (by_left) work.by_left[index] = out;
        break;
      case Code::sqrt: {
        const Lanes& a = left();
        for (std::size_t i = 0; i < n; ++i) {
          const Complex root = std::sqrt(a.get(i));
          out.set(i, root);
          if (by_left) work.by_left[index].set(i, 0.5 * reciprocal(root));
        }
        break;
      }
      case Code::tanh:
      case Code::coth:
      case Code::sinh:
      case Code::cosh:
      case Code::sech:
      case Code::log: {
        const Lanes& a = left();
        for (std::size_t i = 0; i < n; ++i) {
          const ValueAndDerivative result = step.code == Code::tanh   ? hyperbolic_tangent(a.get(i))
                                            : step.code == Code::coth ? hyperbolic_cotangent(a.get(i))
                                            : step.code == Code::sinh ? hyperbolic_sine(a.get(i))
                                            : step.code == Code::cosh ? hyperbolic_cosine(a.get(i))
                                            : step.code == Code::sech ? hyperbolic_secant(a.get(i))
                                                                      : logarithm(a.get(i));
          out.set(i, result.value);
          if (by_left) work.by_left[index].set(i, result.derivative);
        }
        break;
      }
    }
  }
}

void Program::backward(std::size_t n, Workspace& work) const {
  for (std::size_t i = 0; i < real_steps_.size(); ++i) work.real_adjoint[i].clear(n);
  for (std::size_t i = 0; i < complex_steps_.size(); ++i) work.adjoint[i].clear(n);
  if (complex_steps_.empty()) {
    for (std::size_t i = 0; i < n; ++i) work.real_adjoint[real_steps_.size() - 1].set(i, 1);
  } else {
    for (std::size_t i = 0; i < n; ++i) work.adjoint[complex_steps_.size() - 1].set(i, 1);
  }

  const auto add_product = [n](Lanes& sum, const Lanes& a, const Lanes& b) {
    for (std::size_t i = 0; i < n; ++i) {
      sum.re[i] += a.re[i] * b.re[i] - a.im[i] * b.im[i];
      sum.im[i] += a.re[i] * b.im[i] + a.im[i] * b.re[i];
    }
  };
  const auto add_scaled = [n](Lanes& sum, const Lanes& a, double factor) {
    for (std::size_t i = 0; i < n; ++i) sum.re[i] += a.re[i] * factor;
    for (std::size_t i = 0; i < n; ++i) sum.im[i] += a.im[i] * factor;
  };
  for (std::size_t index = complex_steps_.size(); index-- > 0;) {
    const ComplexStep& step = complex_steps_[index];
    if (!step.left_active && !step.right_active) continue;
    const Lanes& adjoint = work.adjoint[index];
    const Lanes& out = work.value[index];
    const auto value = [&](int slot) -> const Lanes& { return work.value[static_cast<std::size_t>(slot)]; };
    const auto real = [&](int slot) { return work.real[static_cast<std::size_t>(slot)]; };
    const bool has_real_left =
        step.code == Code::subtract_rc || step.code == Code::divide_rc || step.code == Code::power_of_s;
    const bool has_real_right = step.code == Code::add_cr || step.code == Code::subtract_cr ||
                                step.code == Code::multiply_cr || step.code == Code::divide_cr ||
                                step.code == Code::power_of_s || step.code == Code::general_power;
    const auto of_left = [&]() -> Lanes& {
      return (has_real_left ? work.real_adjoint : work.adjoint)[static_cast<std::size_t>(step.left)];
    };
    const auto of_right = [&]() -> Lanes& {
      return (has_real_right ? work.real_adjoint : work.adjoint)[static_cast<std::size_t>(step.right)];
    };
    switch (step.code) {
      case Code::laplace:
      case Code::exact_laplace:
        break;
      case Code::add_cc:
      case Code::add_cr:
        if (step.left_active) add_scaled(of_left(), adjoint, 1);
        if (step.right_active) add_scaled(of_right(), adjoint, 1);
        break;
      case Code::subtract_cc:
      case Code::subtract_cr:
      case Code::subtract_rc:
        if (step.left_active) add_scaled(of_left(), adjoint, 1);
        if (step.right_active) add_scaled(of_right(), adjoint, -1);
        break;
      case Code::multiply_cc:
        if (step.left_active) add_product(of_left(), adjoint, value(step.right));
        if (step.right_active) add_product(of_right(), adjoint, value(step.left));
        break;
      case Code::multiply_cr:
        if (step.left_active) add_scaled(of_left(), adjoint, real(step.right));
        if (step.right_active) add_product(of_right(), adjoint, value(step.left));
        break;
      case Code::divide_cc:
      case Code::divide_rc: {
        const Lanes& denominator = value(step.right);
        for (std::size_t i = 0; i < n; ++i) {
          const Complex share = product(adjoint.get(i), reciprocal(denominator.get(i)));
          if (step.left_active) of_left().add(i, share.real(), share.imag());
          if (step.right_active) {
            const Complex loss = product(share, out.get(i));
            of_right().add(i, -loss.real(), -loss.imag());
          }
        }
        break;
      }
      case Code::divide_cr: {
        const double inverse = 1 / real(step.right);
        if (step.left_active) add_scaled(of_left(), adjoint, inverse);
        if (step.right_active) {
          for (std::size_t i = 0; i < n; ++i) {
            const Complex loss = product(adjoint.get(i), out.get(i)) * inverse;
            of_right().add(i, -loss.real(), -loss.imag());
          }
        }
        break;
      }
      case Code::negate:
        add_scaled(of_left(), adjoint, -1);
        break;
      case Code::power_of_s:
      case Code::whole_power:
      case Code::general_power:
      case Code::exp:
      case Code::sqrt:
      case Code::tanh:
      case Code::coth:
      case Code::sinh:
      case Code::cosh:
      case Code::sech:
      case Code::log:
        if (step.left_active) add_product(of_left(), adjoint, work.by_left[index]);
        if (step.right_active) add_product(of_right(), adjoint, work.by_right[index]);
        break;
    }
  }
  for (std::size_t index = real_steps_.size(); index-- > 0;) {
    const RealStep& step = real_steps_[index];
    const Lanes& adjoint = work.real_adjoint[index];
    if (step.left_active) {
      add_scaled(work.real_adjoint[static_cast<std::size_t>(step.left)], adjoint, work.real_by_left[index]);
    }
    if (step.right_active) {
      add_scaled(work.real_adjoint[static_cast<std::size_t>(step.right)], adjoint, work.real_by_right[index]);
    }
  }
}

}  // namespace frac::detail
