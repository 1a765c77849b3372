#include "program.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <numbers>
#include <tuple>
#include <utility>

#include "complex_functions.hpp"
#include "power_grid.hpp"
#include "prepared_power.hpp"

namespace frac::detail {
namespace {

using Complex = std::complex<double>;

constexpr std::size_t block =
    16;  // frequencies per pass: long enough to amortise the dispatch, short enough for the cache
constexpr double largest_whole_exponent = 1000;

// Values of one slot at the frequencies of a block.
struct Lanes {
  std::array<double, block> re;
  std::array<double, block> im;

  [[nodiscard]] Complex get(std::size_t i) const { return {re[i], im[i]}; }
  void set(std::size_t i, Complex value) {
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

// (c s)^q for real c: |c|^q H(s) for c >= 0 and |c|^q H(-s) = |c|^q conj(H(s)) for c < 0, which is the principal value
// where H is exact, and the natural reading where it is not.
struct ScaledPower {
  PreparedPower of_s;
  bool conjugate = false;
  double factor = 1;  // |c|^q
  double factor_by_coefficient = 0;
  double factor_by_order = 0;

  void prepare_scale(double coefficient, double order) {
    conjugate = coefficient < 0;
    const double size = std::abs(coefficient);
    factor = coefficient == 1 ? 1 : std::pow(size, order);
    factor_by_coefficient = order == 0 ? 0 : std::copysign(order * std::pow(size, order - 1), order * coefficient);
    factor_by_order = factor == 0 ? 0 : factor * std::log(size);
  }
};

void exact_power(const ScaledPower& power, const PowerGrid& grid, std::size_t first, std::size_t n, Lanes& out,
                 Lanes* by_left, Lanes* by_right) {
  std::array<double, block> size;
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

struct Program::Workspace {
  std::vector<double> real, real_by_left, real_by_right;
  std::vector<ScaledPower> powers;
  std::vector<Lanes> value, adjoint, real_adjoint;
  std::vector<Lanes> by_left, by_right;  // stored derivatives of the steps that are no plain arithmetic
  PowerGrid grid;
};

Program::Program(const Expression& expression) : parameter_count_(expression.parameter_names.size()) {
  std::vector<int> slot;
  slot.reserve(expression.nodes.size());
  for (const Node& node : expression.nodes) {
    slot.push_back(static_cast<int>(node.has_s ? complex_steps_.size() : real_steps_.size()));
    if (node.has_s) {
      add_complex_step(expression, node, slot);
    } else {
      add_real_step(node, slot, expression.nodes);
    }
  }
}

void Program::add_real_step(const Node& node, const std::vector<int>& slot, const std::vector<Node>& nodes) {
  const auto slot_of = [&](int index) { return index < 0 ? -1 : slot[static_cast<std::size_t>(index)]; };
  const auto active = [&](int index) { return index >= 0 && nodes[static_cast<std::size_t>(index)].has_parameter; };
  real_steps_.push_back({node.operation, slot_of(node.left), slot_of(node.right), node.number, node.parameter,
                         node.has_parameter, active(node.left), active(node.right)});
}

void Program::add_complex_step(const Expression& expression, const Node& node, const std::vector<int>& slot) {
  const auto at = [&](int index) -> const Node& { return expression.nodes[static_cast<std::size_t>(index)]; };
  const auto slot_of = [&](int index) { return index < 0 ? -1 : slot[static_cast<std::size_t>(index)]; };
  const auto active = [&](int index) { return index >= 0 && at(index).has_parameter; };
  ComplexStep step{
      Code::laplace, slot_of(node.left), slot_of(node.right), active(node.left), active(node.right), -1, 0};
  const auto choose = [&](Code both, Code complex_real, Code real_complex) {
    if (at(node.left).has_s && at(node.right).has_s) {
      step.code = both;
    } else {
      step.code = at(node.left).has_s ? complex_real : real_complex;
    }
  };
  const auto complex_operand_first = [&] {
    if (at(node.left).has_s) return;
    std::swap(step.left, step.right);
    std::swap(step.left_active, step.right_active);
  };
  switch (node.operation) {
    case Operation::laplace:
      step.power = static_cast<int>(power_count_++);
      break;
    case Operation::exact_laplace:
      step.code = Code::exact_laplace;
      break;
    case Operation::add:
      choose(Code::add_cc, Code::add_cr, Code::add_cr);
      complex_operand_first();
      break;
    case Operation::subtract:
      choose(Code::subtract_cc, Code::subtract_cr, Code::subtract_rc);
      break;
    case Operation::multiply:
      choose(Code::multiply_cc, Code::multiply_cr, Code::multiply_cr);
      complex_operand_first();
      break;
    case Operation::divide:
      choose(Code::divide_cc, Code::divide_cr, Code::divide_rc);
      break;
    case Operation::negate:
      step.code = Code::negate;
      break;
    case Operation::power_of_s:
      step.code = Code::power_of_s;
      step.power = static_cast<int>(power_count_++);
      break;
    case Operation::power: {
      const auto exponent = literal_value(expression.nodes, node.right);
      if (exponent && *exponent == std::nearbyint(*exponent) && std::abs(*exponent) <= largest_whole_exponent) {
        step.code = Code::whole_power;
        step.whole = static_cast<int>(*exponent);
      } else {
        step.code = Code::general_power;
        if (unrealisable_power_.empty()) unrealisable_power_ = expression.text_of(node);
      }
      break;
    }
    case Operation::exp:
      step.code = Code::exp;
      break;
    case Operation::sqrt:
      step.code = Code::sqrt;
      if (unrealisable_power_.empty()) unrealisable_power_ = expression.text_of(node);
      break;
    case Operation::tanh:
      step.code = Code::tanh;
      break;
    case Operation::coth:
      step.code = Code::coth;
      break;
    case Operation::number:
    case Operation::parameter:
      assert(false);
      break;
  }
  complex_steps_.push_back(step);
}

void Program::evaluate(std::span<const double> parameters, std::span<const double> omega,
                       const Realisation& realisation, std::span<Complex> value, std::span<Complex> gradient) const {
  // Kept per thread, so that a call allocates nothing once the vectors have grown to the formula.
  thread_local Workspace work;
  const bool with_gradient = !gradient.empty();
  prepare(parameters, realisation, with_gradient, work);
  if (power_count_ > 0) work.grid.prepare(omega);
  for (std::size_t start = 0; start < omega.size(); start += block) {
    const std::size_t count = std::min(block, omega.size() - start);
    forward(omega.subspan(start, count), start, with_gradient, work);
    for (std::size_t i = 0; i < count; ++i) {
      value[start + i] =
          complex_steps_.empty() ? Complex(work.real.back()) : work.value[complex_steps_.size() - 1].get(i);
    }
    if (!with_gradient) continue;
    backward(count, work);
    for (std::size_t slot = 0; slot < real_steps_.size(); ++slot) {
      if (real_steps_[slot].operation != Operation::parameter) continue;
      const auto column = static_cast<std::size_t>(real_steps_[slot].parameter);
      Complex* const to = gradient.data() + column * omega.size() + start;
      for (std::size_t i = 0; i < count; ++i) to[i] = work.real_adjoint[slot].get(i);
    }
  }
}

void Program::prepare(std::span<const double> parameters, const Realisation& realisation, bool with_gradient,
                      Workspace& work) const {
  const std::size_t reals = real_steps_.size();
  const std::size_t complexes = complex_steps_.size();
  const auto at_least = [](auto& vector, std::size_t size) {
    if (vector.size() < size) vector.resize(size);
  };
  work.real.resize(reals);
  at_least(work.value, complexes);
  at_least(work.powers, power_count_);
  if (with_gradient) {
    work.real_by_left.resize(reals);
    work.real_by_right.resize(reals);
    at_least(work.adjoint, complexes);
    at_least(work.by_left, complexes);
    at_least(work.by_right, complexes);
    at_least(work.real_adjoint, reals);
  }

  const auto operand = [&](int slot) { return slot < 0 ? 0.0 : work.real[static_cast<std::size_t>(slot)]; };
  for (std::size_t i = 0; i < reals; ++i) {
    const RealStep& step = real_steps_[i];
    const double left = operand(step.left);
    const double right = operand(step.right);
    double& value = work.real[i];
    if (step.operation == Operation::number) {
      value = step.number;
    } else if (step.operation == Operation::parameter) {
      value = parameters[static_cast<std::size_t>(step.parameter)];
    } else {
      value = real_operation(step.operation, left, right);
    }
    if (with_gradient && step.active) {
      std::tie(work.real_by_left[i], work.real_by_right[i]) =
          real_derivatives(step.operation, left, right, value, step.right_active);
    }
  }
  for (const ComplexStep& step : complex_steps_) {
    if (step.power < 0) continue;
    ScaledPower& power = work.powers[static_cast<std::size_t>(step.power)];
    if (step.code == Code::laplace) {
      power.of_s.prepare(realisation, 1);
    } else {
      power.of_s.prepare(realisation, operand(step.right));
      power.prepare_scale(operand(step.left), operand(step.right));
    }
  }
}

void Program::forward(std::span<const double> omega, std::size_t first, bool with_gradient, Workspace& work) const {
  const std::size_t n = omega.size();
  const double* const log_omega = power_count_ > 0 ? work.grid.log_omega().data() + first : nullptr;
  for (std::size_t index = 0; index < complex_steps_.size(); ++index) {
    const ComplexStep& step = complex_steps_[index];
    Lanes& out = work.value[index];
    const auto complex_operand = [&](int slot) -> const Lanes& { return work.value[static_cast<std::size_t>(slot)]; };
    const auto real_operand = [&](int slot) { return work.real[static_cast<std::size_t>(slot)]; };
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
      case Code::add_cc: {
        const Lanes& a = complex_operand(step.left);
        const Lanes& b = complex_operand(step.right);
        for (std::size_t i = 0; i < n; ++i) out.re[i] = a.re[i] + b.re[i];
        for (std::size_t i = 0; i < n; ++i) out.im[i] = a.im[i] + b.im[i];
        break;
      }
      case Code::add_cr: {
        const Lanes& a = complex_operand(step.left);
        const double b = real_operand(step.right);
        for (std::size_t i = 0; i < n; ++i) out.re[i] = a.re[i] + b;
        for (std::size_t i = 0; i < n; ++i) out.im[i] = a.im[i];
        break;
      }
      case Code::subtract_cc: {
        const Lanes& a = complex_operand(step.left);
        const Lanes& b = complex_operand(step.right);
        for (std::size_t i = 0; i < n; ++i) out.re[i] = a.re[i] - b.re[i];
        for (std::size_t i = 0; i < n; ++i) out.im[i] = a.im[i] - b.im[i];
        break;
      }
      case Code::subtract_cr: {
        const Lanes& a = complex_operand(step.left);
        const double b = real_operand(step.right);
        for (std::size_t i = 0; i < n; ++i) out.re[i] = a.re[i] - b;
        for (std::size_t i = 0; i < n; ++i) out.im[i] = a.im[i];
        break;
      }
      case Code::subtract_rc: {
        const double a = real_operand(step.left);
        const Lanes& b = complex_operand(step.right);
        for (std::size_t i = 0; i < n; ++i) out.re[i] = a - b.re[i];
        for (std::size_t i = 0; i < n; ++i) out.im[i] = -b.im[i];
        break;
      }
      case Code::multiply_cc: {
        const Lanes& a = complex_operand(step.left);
        const Lanes& b = complex_operand(step.right);
        for (std::size_t i = 0; i < n; ++i) {
          out.re[i] = a.re[i] * b.re[i] - a.im[i] * b.im[i];
          out.im[i] = a.re[i] * b.im[i] + a.im[i] * b.re[i];
        }
        break;
      }
      case Code::multiply_cr: {
        const Lanes& a = complex_operand(step.left);
        const double b = real_operand(step.right);
        for (std::size_t i = 0; i < n; ++i) out.re[i] = a.re[i] * b;
        for (std::size_t i = 0; i < n; ++i) out.im[i] = a.im[i] * b;
        break;
      }
      case Code::divide_cc: {
        const Lanes& a = complex_operand(step.left);
        const Lanes& b = complex_operand(step.right);
        for (std::size_t i = 0; i < n; ++i) out.set(i, product(a.get(i), reciprocal(b.get(i))));
        break;
      }
      case Code::divide_cr: {
        const Lanes& a = complex_operand(step.left);
        const double b = real_operand(step.right);
        for (std::size_t i = 0; i < n; ++i) out.re[i] = a.re[i] / b;
        for (std::size_t i = 0; i < n; ++i) out.im[i] = a.im[i] / b;
        break;
      }
      case Code::divide_rc: {
        const double a = real_operand(step.left);
        const Lanes& b = complex_operand(step.right);
        for (std::size_t i = 0; i < n; ++i) out.set(i, a * reciprocal(b.get(i)));
        break;
      }
      case Code::negate: {
        const Lanes& a = complex_operand(step.left);
        for (std::size_t i = 0; i < n; ++i) out.re[i] = -a.re[i];
        for (std::size_t i = 0; i < n; ++i) out.im[i] = -a.im[i];
        break;
      }
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
        const Lanes& a = complex_operand(step.left);
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
        const Lanes& a = complex_operand(step.left);
        const double order = real_operand(step.right);
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
      case Code::exp: {
        const Lanes& a = complex_operand(step.left);
        for (std::size_t i = 0; i < n; ++i) out.set(i, exponential(a.get(i)));
        if (by_left) work.by_left[index] = out;
        break;
      }
      case Code::sqrt: {
        const Lanes& a = complex_operand(step.left);
        for (std::size_t i = 0; i < n; ++i) {
          const Complex root = std::sqrt(a.get(i));
          out.set(i, root);
          if (by_left) work.by_left[index].set(i, 0.5 * reciprocal(root));
        }
        break;
      }
      case Code::tanh:
      case Code::coth: {
        const Lanes& a = complex_operand(step.left);
        for (std::size_t i = 0; i < n; ++i) {
          const ValueAndDerivative result =
              step.code == Code::tanh ? hyperbolic_tangent(a.get(i)) : hyperbolic_cotangent(a.get(i));
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
    const auto adjoint_of = [&](int slot) -> Lanes& { return work.adjoint[static_cast<std::size_t>(slot)]; };
    const auto real_adjoint_of = [&](int slot) -> Lanes& { return work.real_adjoint[static_cast<std::size_t>(slot)]; };
    switch (step.code) {
      case Code::laplace:
      case Code::exact_laplace:
        break;
      case Code::add_cc:
        if (step.left_active) add_scaled(adjoint_of(step.left), adjoint, 1);
        if (step.right_active) add_scaled(adjoint_of(step.right), adjoint, 1);
        break;
      case Code::add_cr:
        if (step.left_active) add_scaled(adjoint_of(step.left), adjoint, 1);
        if (step.right_active) add_scaled(real_adjoint_of(step.right), adjoint, 1);
        break;
      case Code::subtract_cc:
        if (step.left_active) add_scaled(adjoint_of(step.left), adjoint, 1);
        if (step.right_active) add_scaled(adjoint_of(step.right), adjoint, -1);
        break;
      case Code::subtract_cr:
        if (step.left_active) add_scaled(adjoint_of(step.left), adjoint, 1);
        if (step.right_active) add_scaled(real_adjoint_of(step.right), adjoint, -1);
        break;
      case Code::subtract_rc:
        if (step.left_active) add_scaled(real_adjoint_of(step.left), adjoint, 1);
        if (step.right_active) add_scaled(adjoint_of(step.right), adjoint, -1);
        break;
      case Code::multiply_cc:
        if (step.left_active) add_product(adjoint_of(step.left), adjoint, value(step.right));
        if (step.right_active) add_product(adjoint_of(step.right), adjoint, value(step.left));
        break;
      case Code::multiply_cr:
        if (step.left_active) add_scaled(adjoint_of(step.left), adjoint, real(step.right));
        if (step.right_active) add_product(real_adjoint_of(step.right), adjoint, value(step.left));
        break;
      case Code::divide_cc:
      case Code::divide_rc: {
        Lanes& left_adjoint = step.code == Code::divide_cc ? adjoint_of(step.left) : real_adjoint_of(step.left);
        const Lanes& denominator = value(step.right);
        for (std::size_t i = 0; i < n; ++i) {
          const Complex share = product(adjoint.get(i), reciprocal(denominator.get(i)));
          if (step.left_active) left_adjoint.add(i, share.real(), share.imag());
          if (step.right_active) {
            const Complex loss = product(share, out.get(i));
            adjoint_of(step.right).add(i, -loss.real(), -loss.imag());
          }
        }
        break;
      }
      case Code::divide_cr: {
        const double inverse = 1 / real(step.right);
        if (step.left_active) add_scaled(adjoint_of(step.left), adjoint, inverse);
        if (step.right_active) {
          for (std::size_t i = 0; i < n; ++i) {
            const Complex loss = product(adjoint.get(i), out.get(i)) * inverse;
            real_adjoint_of(step.right).add(i, -loss.real(), -loss.imag());
          }
        }
        break;
      }
      case Code::negate:
        add_scaled(adjoint_of(step.left), adjoint, -1);
        break;
      case Code::power_of_s:
        if (step.left_active) add_product(real_adjoint_of(step.left), adjoint, work.by_left[index]);
        if (step.right_active) add_product(real_adjoint_of(step.right), adjoint, work.by_right[index]);
        break;
      case Code::whole_power:
      case Code::exp:
      case Code::sqrt:
      case Code::tanh:
      case Code::coth:
        add_product(adjoint_of(step.left), adjoint, work.by_left[index]);
        break;
      case Code::general_power:
        if (step.left_active) add_product(adjoint_of(step.left), adjoint, work.by_left[index]);
        if (step.right_active) add_product(real_adjoint_of(step.right), adjoint, work.by_right[index]);
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
