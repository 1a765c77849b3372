// SPDX-License-Identifier: BSD-3-Clause
#include "frac/structure.hpp"

#include <algorithm>
#include <cmath>

#include "canonical_form.hpp"
#include "expression.hpp"
#include "formula_parser.hpp"
#include "grouped_text.hpp"
#include "parameter_roles.hpp"
#include "program.hpp"
#include "realisation/realisation_checks.hpp"

namespace frac {
namespace {

constexpr std::size_t longest_shown = 100;

// The formula, or where it is long the part around the column, on one line; and the caret under the column.
std::string with_caret(std::string_view formula, std::size_t column) {
  std::size_t begin = 0;
  std::size_t end = formula.size();
  std::string before;
  std::string after;
  if (formula.size() > longest_shown) {
    begin = std::min(column, formula.size()) - std::min(column, longest_shown / 2);
    end = std::min(formula.size(), begin + longest_shown);
    if (begin > 0) before = "...";
    if (end < formula.size()) after = "...";
  }
  std::string shown(formula.substr(begin, end - begin));
  for (char& c : shown) {
    if (static_cast<unsigned char>(c) < ' ' || c == '\x7f') c = ' ';
  }
  return before + shown + after + "\n" + std::string(before.size() + column - begin, ' ') + "^";
}

void check_length(std::size_t length, std::size_t wanted, const char* what) {
  if (length != wanted) {
    throw std::invalid_argument("formula: " + std::to_string(length) + " " + what + " where " + std::to_string(wanted) +
                                " are needed");
  }
}

}  // namespace

FormulaError::FormulaError(const std::string& reason, std::string_view formula, std::size_t column)
    : std::invalid_argument(reason + "\n" + with_caret(formula, column)), column_(column) {}

Structure::Structure(std::string_view formula)
    : formula_(formula), expression_(std::make_shared<detail::Expression>(detail::parse_formula(formula))) {
  names_ = expression_->parameter_names;
  detail::ParameterUse use = detail::parameter_use(*expression_);
  roles_ = std::move(use.roles);
  in_sum_ = std::move(use.in_sum);
  keeps_sign_ = std::move(use.keeps_sign);
  program_ = std::make_shared<detail::Program>(*expression_);
}

std::string Structure::grouped() const {
  return detail::grouped_text(*expression_);
}

bool Structure::depends_on_s() const {
  return expression_->nodes.back().has_s;
}

bool Structure::has_fractional_order() const {
  const std::vector<detail::Node>& nodes = expression_->nodes;
  return std::any_of(nodes.begin(), nodes.end(), [&](const detail::Node& node) {
    if (!node.has_s) return false;
    if (node.operation == detail::Operation::sqrt) return true;
    if (node.operation != detail::Operation::power && node.operation != detail::Operation::power_of_s) return false;
    const std::optional<double> exponent = detail::literal_value(nodes, node.right);
    return !exponent || *exponent != std::round(*exponent);
  });
}

std::optional<std::vector<std::size_t>> Structure::correspondence(const Structure& other) const {
  return detail::matched_parameters(*expression_, *other.expression_);
}

Structure Structure::renamed(std::span<const std::string> names) const {
  check_length(names.size(), names_.size(), "names");
  return Structure(detail::with_names(*expression_, names));
}

std::size_t Structure::parameter_index(std::string_view name) const {
  const auto place = std::find(names_.begin(), names_.end(), name);
  if (place != names_.end()) return static_cast<std::size_t>(place - names_.begin());
  std::string known;
  for (const std::string& each : names_) known += (known.empty() ? "" : ", ") + each;
  throw std::invalid_argument("'" + std::string(name) + "' is no parameter of \"" + formula_ + "\"" +
                              (known.empty() ? "; it has none" : "; it has " + known));
}

void Structure::evaluate(std::span<const double> parameters, std::span<const double> omega,
                         const Realisation& realisation, std::span<std::complex<double>> value,
                         std::span<std::complex<double>> gradient) const {
  check_length(parameters.size(), names_.size(), "parameter values");
  validate(realisation);
  detail::check_omega(realisation, omega, "formula");
  if (!std::holds_alternative<ExactRealisation>(realisation) && !program_->unrealisable_power().empty()) {
    throw std::invalid_argument("formula: the power " + program_->unrealisable_power() + " in \"" + formula_ +
                                "\" is not one of s, so " + to_string(realisation) +
                                " cannot express it; only the exact realisation can");
  }
  program_->evaluate(parameters, omega, realisation, value, gradient);
}

std::complex<double> Structure::response(std::span<const double> parameters, double omega,
                                         const Realisation& realisation) const {
  std::complex<double> value;
  evaluate(parameters, {&omega, 1}, realisation, {&value, 1}, {});
  return value;
}

void Structure::response(std::span<const double> parameters, std::span<const double> omega,
                         const Realisation& realisation, std::span<std::complex<double>> value) const {
  check_length(value.size(), omega.size(), "places for values");
  evaluate(parameters, omega, realisation, value, {});
}

std::complex<double> Structure::response_and_gradient(std::span<const double> parameters, double omega,
                                                      const Realisation& realisation,
                                                      std::span<std::complex<double>> gradient) const {
  std::complex<double> value;
  response_and_gradient(parameters, {&omega, 1}, realisation, {&value, 1}, gradient);
  return value;
}

void Structure::response_and_gradient(std::span<const double> parameters, std::span<const double> omega,
                                      const Realisation& realisation, std::span<std::complex<double>> value,
                                      std::span<std::complex<double>> gradient) const {
  check_length(value.size(), omega.size(), "places for values");
  check_length(gradient.size(), omega.size() * names_.size(), "places for derivatives");
  evaluate(parameters, omega, realisation, value, gradient);
}

}  // namespace frac
