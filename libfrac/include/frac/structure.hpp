// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <complex>
#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "frac/realisation.hpp"

namespace frac {

/// A formula that does not parse.  what() is three lines: the reason, the formula (the part around the place if it is
/// long), and a caret under the place.
class FormulaError : public std::invalid_argument {
 public:
  FormulaError(const std::string& reason, std::string_view formula, std::size_t column);
  /// Zero-based byte offset of the place in the formula.
  [[nodiscard]] std::size_t column() const noexcept { return column_; }

 private:
  std::size_t column_;
};

/// What a parameter does in a formula; decides its default range and scale in a fit.
enum class ParameterRole {
  coefficient,  // gain, time constant, resistance ...
  order,        // stands in an exponent
  delay,        // L of exp(-L s), seconds
};

namespace detail {
struct Expression;
class Program;
}  // namespace detail

/// A model given as a formula of s with named parameters, e.g. "K exp(-L s)/(T s^a + 1)".
///
/// Grammar: numbers, parameter names, s, + - * / ^, parentheses, exp( ), log( ), sqrt( ), sinh( ), cosh( ), tanh( ),
/// coth( ), sech( ), products by juxtaposition ("R1 Q1 s^n1").  The exponent after ^ is a number, a name, or a
/// parenthesised expression of those, with an optional sign; it must not contain s.  Juxtaposition binds like *, so
/// "K/(T s + 1) exp(-L s)" is the lag with a delay; "1/Q s^n", which readers take both ways, is refused, and so is
/// a^b^c.  A name with ( right behind it is refused as an unknown function: write "K (s + 1)" or "K*(s + 1)".  At most
/// 10000 characters and 200 open parentheses.
///
/// Powers are principal values; (c s)^q and sqrt(c s) count as the power s^q times |c|^q, everything free of s is real.
/// Through a realisation each power of s, and s itself, is replaced by its realised response; functions stay exact, and
/// so does s inside exp( ), a delay.  Parameters are numbered in order of appearance.
class Structure {
 public:
  /// @throws FormulaError  with the place.
  explicit Structure(std::string_view formula);

  [[nodiscard]] const std::string& formula() const noexcept { return formula_; }
  /// The formula as it was understood: products with blanks, quotients and powers in parentheses where they are parts
  /// of others.
  [[nodiscard]] std::string grouped() const;
  /// Whether s stands in it.
  [[nodiscard]] bool depends_on_s() const;
  [[nodiscard]] const std::vector<std::string>& parameter_names() const noexcept { return names_; }
  [[nodiscard]] const std::vector<ParameterRole>& parameter_roles() const noexcept { return roles_; }
  /// For each parameter whether it, or the power whose exponent it belongs to, is part of a term of a sum:
  /// a in K/(T s^a + 1) is, p in K s^p is not.
  [[nodiscard]] const std::vector<bool>& parameter_in_sum() const noexcept { return in_sum_; }
  /// For each parameter whether it is a coefficient that a fit takes as positive unless told otherwise: one of a sum of
  /// several terms in a divisor, of the base of a power, or of an argument of a function.  T, Q1, b2 and R1 in
  /// K/(T s^a + 1), R0 + R1/(1 + R1 Q1 s^n1) and K/(b2 s^2 + 1) are.  There another sign moves poles across the
  /// imaginary axis, by way of an infinite response on it, or leaves no real value: time constants, capacities and
  /// the like, which stable systems have positive.  Every other coefficient is a gain: the factor of a term of the
  /// numerator, such as R0, or of the whole, such as K.  The response goes smoothly through 0 with it, and a sum with a
  /// negative term is a model like any other.
  [[nodiscard]] const std::vector<bool>& parameter_keeps_sign() const noexcept { return keeps_sign_; }
  /// Whether s stands under a root or a power that is no whole number, or whose order is a parameter.
  [[nodiscard]] bool has_fractional_order() const;
  /// Where two formulas are the same structure, the index in the other one of each parameter of this one; empty where
  /// they are not.  They are the same where they differ only in the names of parameters, the order of terms and
  /// factors, blanks, redundant parentheses, and in how numbers and signs are written (K s^-1 is K/s, -(a - b) is
  /// b - a).  Of several ways to match the parameters, as with two like arcs, equal names are matched first, then the
  /// others by their names (R2 before R10), so that the answer does not depend on the order of terms.
  [[nodiscard]] std::optional<std::vector<std::size_t>> correspondence(const Structure& other) const;
  /// The formula with other names for its parameters, in their order.
  /// @throws std::invalid_argument  not one name for each parameter
  /// @throws FormulaError  a name that is none
  [[nodiscard]] Structure renamed(std::span<const std::string> names) const;
  /// Index of a parameter. @throws std::invalid_argument  naming the known ones.
  [[nodiscard]] std::size_t parameter_index(std::string_view name) const;

  /// Model value at s = j omega.  Not finite where the model has a pole or overflows, or where a part free of s has no
  /// real value (the root of a negative parameter).
  /// @throws std::invalid_argument  wrong number of parameters; omega not positive and finite, or beyond what the
  ///     realisation covers; a realisation that is not valid, or that cannot express a power: one of a sum that is not
  ///     whole, or one of order beyond 20.
  [[nodiscard]] std::complex<double> response(std::span<const double> parameters, double omega,
                                              const Realisation& realisation = ExactRealisation{}) const;
  /// On a grid, which costs less per frequency: value has one entry per omega.
  void response(std::span<const double> parameters, std::span<const double> omega, const Realisation& realisation,
                std::span<std::complex<double>> value) const;

  /// The same with the derivative by each parameter (reverse accumulation: the cost does not grow with their number).
  /// gradient has one entry per parameter.
  std::complex<double> response_and_gradient(std::span<const double> parameters, double omega,
                                             const Realisation& realisation,
                                             std::span<std::complex<double>> gradient) const;
  /// On a grid: value has one entry per omega, gradient one column per parameter of one entry per omega.
  void response_and_gradient(std::span<const double> parameters, std::span<const double> omega,
                             const Realisation& realisation, std::span<std::complex<double>> value,
                             std::span<std::complex<double>> gradient) const;

  [[nodiscard]] const detail::Expression& expression() const noexcept { return *expression_; }

 private:
  void evaluate(std::span<const double> parameters, std::span<const double> omega, const Realisation& realisation,
                std::span<std::complex<double>> value, std::span<std::complex<double>> gradient) const;

  std::string formula_;
  std::vector<std::string> names_;
  std::vector<ParameterRole> roles_;
  std::vector<bool> in_sum_;
  std::vector<bool> keeps_sign_;
  std::shared_ptr<const detail::Expression> expression_;
  std::shared_ptr<const detail::Program> program_;
};

}  // namespace frac
