#pragma once

#include <complex>
#include <cstddef>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "frac/realisation.hpp"

namespace frac {

/// A formula that does not parse.  what() is three lines: the reason, the formula, a caret under the place.
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
class Expression;
}

/// A model given as a formula of s with named parameters, e.g. "K exp(-L s)/(T s^a + 1)".
///
/// Grammar: numbers, parameter names, s, + - * / ^, parentheses, exp( ), sqrt( ), tanh( ), coth( ), products by
/// juxtaposition ("R1 Q1 s^n1").  The exponent after ^ is a number, a name, or a parenthesised expression of those, with an
/// optional sign; it must not contain s.  Juxtaposition binds like *; "1/Q s^n", which readers take both ways, is refused.
/// Powers are principal values.  Parameters are numbered in order of appearance.
class Structure {
 public:
  /// @throws FormulaError  with the place.
  explicit Structure(std::string_view formula);

  [[nodiscard]] const std::string& formula() const noexcept { return formula_; }
  [[nodiscard]] const std::vector<std::string>& parameter_names() const noexcept { return names_; }
  [[nodiscard]] const std::vector<ParameterRole>& parameter_roles() const noexcept { return roles_; }
  /// Index of a parameter. @throws std::invalid_argument  naming the known ones.
  [[nodiscard]] std::size_t parameter_index(std::string_view name) const;

  /// Model value at s = j omega.  Not finite where the model has a pole or overflows.
  /// @throws std::invalid_argument  wrong number of parameters, or a power that the realisation cannot express.
  [[nodiscard]] std::complex<double> response(std::span<const double> parameters, double omega,
                                              const Realisation& realisation = ExactRealisation{}) const;

  /// The same with the derivative by each parameter (reverse accumulation: the cost does not grow with their number).
  /// gradient has one entry per parameter.
  std::complex<double> response_and_gradient(std::span<const double> parameters, double omega, const Realisation& realisation,
                                             std::span<std::complex<double>> gradient) const;

  [[nodiscard]] const detail::Expression& expression() const noexcept { return *expression_; }

 private:
  std::string formula_;
  std::vector<std::string> names_;
  std::vector<ParameterRole> roles_;
  std::shared_ptr<const detail::Expression> expression_;
};

}  // namespace frac
