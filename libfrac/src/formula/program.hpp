// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <complex>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "expression.hpp"
#include "frac/realisation.hpp"

namespace frac::detail {

/// An expression compiled for evaluation at many frequencies: what is free of s is computed once per call in real
/// arithmetic, the rest operation by operation on blocks of frequencies.  Gradients by reverse accumulation.
class Program {
 public:
  explicit Program(const Expression& given);

  /// The first power that only the exact realisation can express: of a base that holds s and is no multiple of s, with
  /// an exponent that is no whole number.  Empty when there is none.
  [[nodiscard]] const std::string& unrealisable_power() const noexcept { return unrealisable_power_; }

  /// Values at s = j omega and, unless `gradient` is empty, their derivatives, one column per parameter.  Arguments
  /// have been checked.
  void evaluate(std::span<const double> parameters, std::span<const double> omega, const Realisation& realisation,
                std::span<std::complex<double>> value, std::span<std::complex<double>> gradient) const;
  /// The same at s = modulus e^{j angle}, powers exact and of principal values.
  /// @param angle  0 to below pi
  void evaluate_on_ray(std::span<const double> parameters, double angle, std::span<const double> modulus,
                       std::span<std::complex<double>> value, std::span<std::complex<double>> gradient) const;

 private:
  // c: complex operand, r: real operand, in the order left, right.
  enum class Code {
    laplace,
    exact_laplace,
    add_cc,
    add_cr,
    subtract_cc,
    subtract_cr,
    subtract_rc,
    multiply_cc,
    multiply_cr,
    divide_cc,
    divide_cr,
    divide_rc,
    negate,
    power_of_s,     // (left s)^right
    whole_power,    // left^whole
    general_power,  // left^right
    exp,
    sqrt,
    tanh,
    coth,
    sinh,
    cosh,
    sech,
    log,
  };
  struct RealStep {
    Operation operation;
    int left, right;  // slots of real values, -1: none
    double number;
    int parameter;
    bool active;  // depends on a parameter
    bool left_active, right_active;
  };
  struct ComplexStep {
    Code code;
    int left, right;  // slots, of real or complex values as the code says
    bool left_active, right_active;
    int power;  // index of the prepared power, -1: none
    int whole;  // exponent of whole_power
  };
  struct Workspace;

  /// What an operation becomes, given whether its operands hold s.
  [[nodiscard]] static Code code_of(Operation operation, bool left_has_s, bool right_has_s);
  [[nodiscard]] static bool left_is_real(Code code);
  [[nodiscard]] static bool right_is_real(Code code);
  void add_real_step(const Node& node, const std::vector<int>& slot, const std::vector<Node>& nodes);
  void add_complex_step(const Expression& expression, const Node& node, const std::vector<int>& slot);

  /// At s = modulus e^{j angle}; on other rays than the imaginary axis the realisation is the exact one.
  void evaluate(std::span<const double> parameters, double angle, std::span<const double> modulus,
                const Realisation& realisation, std::span<std::complex<double>> value,
                std::span<std::complex<double>> gradient) const;
  void prepare(std::span<const double> parameters, double angle, const Realisation& realisation, bool with_gradient,
               Workspace& work) const;
  /// Frequencies omega, which are those of the grid from `first` on.
  void forward(std::span<const double> omega, std::size_t first, bool with_gradient, Workspace& work) const;
  void backward(std::size_t count, Workspace& work) const;
  /// Adds the adjoint of a complex step to those of its operands.
  void pass_back(std::size_t index, std::size_t count, Workspace& work) const;

  std::vector<RealStep> real_steps_;        // step i fills real slot i
  std::vector<ComplexStep> complex_steps_;  // step i fills complex slot i
  std::size_t parameter_count_;
  std::size_t power_count_ = 0;
  std::string unrealisable_power_;
};

}  // namespace frac::detail
