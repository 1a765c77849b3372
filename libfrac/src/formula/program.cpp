// SPDX-License-Identifier: BSD-3-Clause
#include "program.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>
#include <tuple>
#include <utility>

#include "bounded_reciprocals.hpp"
#include "program_workspace.hpp"
#include "special/complex_functions.hpp"

namespace frac::detail {
namespace {

using Complex = std::complex<double>;

constexpr double largest_whole_exponent = 1000;

}  // namespace

Program::Program(const Expression& given) : parameter_count_(given.parameter_names.size()) {
  const Expression expression = with_bounded_reciprocals(given);
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

Program::Code Program::code_of(Operation operation, bool left_has_s, bool right_has_s) {
  const bool both = left_has_s && right_has_s;
  // clang-format off
  switch (operation) {
    case Operation::laplace:       return Code::laplace;
    case Operation::exact_laplace: return Code::exact_laplace;
    case Operation::add:           return both ? Code::add_cc : Code::add_cr;
    case Operation::subtract:      return both ? Code::subtract_cc : left_has_s ? Code::subtract_cr : Code::subtract_rc;
    case Operation::multiply:      return both ? Code::multiply_cc : Code::multiply_cr;
    case Operation::divide:        return both ? Code::divide_cc : left_has_s ? Code::divide_cr : Code::divide_rc;
    case Operation::negate:        return Code::negate;
    case Operation::power_of_s:    return Code::power_of_s;
    case Operation::power:         return Code::general_power;
    case Operation::exp:           return Code::exp;
    case Operation::sqrt:          return Code::sqrt;
    case Operation::tanh:          return Code::tanh;
    case Operation::coth:          return Code::coth;
    case Operation::sinh:          return Code::sinh;
    case Operation::cosh:          return Code::cosh;
    case Operation::sech:          return Code::sech;
    case Operation::log:           return Code::log;
    case Operation::number:
    case Operation::parameter:     break;
  }
  // clang-format on
  assert(false && "numbers and parameters hold no s");
  return Code::laplace;
}

void Program::add_complex_step(const Expression& expression, const Node& node, const std::vector<int>& slot) {
  const auto at = [&](int index) -> const Node& { return expression.nodes[static_cast<std::size_t>(index)]; };
  const auto slot_of = [&](int index) { return index < 0 ? -1 : slot[static_cast<std::size_t>(index)]; };
  const auto active = [&](int index) { return index >= 0 && at(index).has_parameter; };
  const auto has_s = [&](int index) { return index >= 0 && at(index).has_s; };
  ComplexStep step{code_of(node.operation, has_s(node.left), has_s(node.right)),
                   slot_of(node.left),
                   slot_of(node.right),
                   active(node.left),
                   active(node.right),
                   -1,
                   0};
  const bool commutes = node.operation == Operation::add || node.operation == Operation::multiply;
  if (commutes && !has_s(node.left)) {
    std::swap(step.left, step.right);
    std::swap(step.left_active, step.right_active);
  }
  if (step.code == Code::laplace || step.code == Code::power_of_s) step.power = static_cast<int>(power_count_++);
  if (step.code == Code::general_power) {
    const auto exponent = literal_value(expression.nodes, node.right);
    if (exponent && *exponent == std::nearbyint(*exponent) && std::abs(*exponent) <= largest_whole_exponent) {
      step.code = Code::whole_power;
      step.whole = static_cast<int>(*exponent);
    }
  }
  const bool is_unrealisable = step.code == Code::general_power || step.code == Code::sqrt;
  if (is_unrealisable && unrealisable_power_.empty()) unrealisable_power_ = expression.text_of(node);
  complex_steps_.push_back(step);
}

void Program::evaluate(std::span<const double> parameters, std::span<const double> omega,
                       const Realisation& realisation, std::span<Complex> value, std::span<Complex> gradient) const {
  evaluate(parameters, std::numbers::pi / 2, omega, realisation, value, gradient);
}

void Program::evaluate_on_ray(std::span<const double> parameters, double angle, std::span<const double> modulus,
                              std::span<Complex> value, std::span<Complex> gradient) const {
  evaluate(parameters, angle, modulus, ExactRealisation{}, value, gradient);
}

void Program::evaluate(std::span<const double> parameters, double angle, std::span<const double> omega,
                       const Realisation& realisation, std::span<Complex> value, std::span<Complex> gradient) const {
  // Kept per thread, so that a call allocates nothing once the vectors have grown to the formula.
  thread_local Workspace work;
  const bool with_gradient = !gradient.empty();
  prepare(parameters, angle, realisation, with_gradient, work);
  if (power_count_ > 0) work.grid.prepare(omega);
  for (std::size_t start = 0; start < omega.size(); start += block_size) {
    const std::size_t count = std::min(block_size, omega.size() - start);
    forward(omega.subspan(start, count), start, with_gradient, work);
    if (complex_steps_.empty()) {
      std::fill_n(value.data() + start, count, work.real.back());
    } else {
      work.value[complex_steps_.size() - 1].copy_to(value.data() + start, count);
    }
    if (!with_gradient) continue;
    backward(count, work);
    for (std::size_t slot = 0; slot < real_steps_.size(); ++slot) {
      if (real_steps_[slot].operation != Operation::parameter) continue;
      const auto column = static_cast<std::size_t>(real_steps_[slot].parameter);
      work.real_adjoint[slot].copy_to(gradient.data() + column * omega.size() + start, count);
    }
  }
}

void Program::prepare(std::span<const double> parameters, double angle, const Realisation& realisation,
                      bool with_gradient, Workspace& work) const {
  const std::size_t reals = real_steps_.size();
  const std::size_t complexes = complex_steps_.size();
  const auto at_least = [](auto& vector, std::size_t size) {
    if (vector.size() < size) vector.resize(size);
  };
  work.real.resize(reals);
  const bool on_axis = angle == std::numbers::pi / 2;
  work.direction = on_axis ? Complex(0, 1) : std::polar(1.0, angle);
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
      power.prepare_scale(operand(step.left), operand(step.right), angle);
    }
  }
}

}  // namespace frac::detail
