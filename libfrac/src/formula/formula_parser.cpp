// SPDX-License-Identifier: BSD-3-Clause
#include "formula_parser.hpp"

#include <charconv>
#include <optional>
#include <string>

#include "expression_builder.hpp"
#include "frac/structure.hpp"
#include "function_names.hpp"
#include "spelling_hints.hpp"

namespace frac::detail {
namespace {

constexpr std::size_t longest_formula = 10'000;
constexpr int deepest_nesting = 200;

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}
bool is_name_start(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
}
bool is_blank(char c) {
  return c == ' ' || c == '\t' || c == '\n' || c == '\r';
}

std::optional<Operation> function_named(std::string_view name) {
  for (const auto& [known, operation] : function_names)
    if (known == name) return operation;
  return std::nullopt;
}

// Recursive descent over
//   sum     = product { (+|-) product }
//   product = signed { (*|/) signed | power }        the bare power is a product by juxtaposition
//   signed  = { +|- } power
//   power   = primary [ ^ { +|- } (number | name | "(" sum ")") ]
//   primary = number | name | s | function "(" sum ")" | "(" sum ")"
class Parser {
 public:
  explicit Parser(std::string_view formula) : formula_(formula), builder_(formula) {}

  Expression parse() && {
    if (formula_.size() > longest_formula) {
      fail("the formula is longer than " + std::to_string(longest_formula) + " characters", longest_formula);
    }
    skip_blanks();
    if (at_end()) fail("the formula is empty", 0);
    const int root = sum();
    if (peek() == ')') fail("no parenthesis is open that this one could close", position_);
    if (!at_end()) fail_at_unexpected();
    return std::move(builder_).finish(root);
  }

 private:
  [[noreturn]] void fail(const std::string& reason, std::size_t column) const {
    throw FormulaError(reason, formula_, column);
  }

  [[noreturn]] void fail_at_unexpected() const {
    if (at_end()) fail("an operand is missing at the end", formula_.size());
    const char c = peek();
    if (c == ')' || c == '*' || c == '/' || c == '^') fail("an operand is missing here", position_);
    if (c == '(' || c == '+' || c == '-' || c == '.' || is_digit(c) || is_name_start(c)) {
      fail("this is not expected here", position_);
    }
    if (c == ',') fail("a comma has no meaning here; decimals are written with a point", position_);
    const std::string hint = spelling_hint(formula_, position_);
    if (!hint.empty()) fail("unknown character: " + hint, position_);
    fail("unknown character", position_);
  }

  [[nodiscard]] bool at_end() const { return position_ >= formula_.size(); }
  [[nodiscard]] char peek() const { return at_end() ? '\0' : formula_[position_]; }
  void skip_blanks() {
    while (!at_end() && is_blank(peek())) ++position_;
  }
  [[nodiscard]] bool accept(char c) {
    if (at_end() || peek() != c) return false;
    previous_end_ = ++position_;
    skip_blanks();
    return true;
  }
  // From `begin` to the end of the last token read.
  [[nodiscard]] ExpressionBuilder::Range since(std::size_t begin) const { return {begin, previous_end_}; }

  int sum() {
    const std::size_t begin = position_;
    int left = product();
    for (;;) {
      if (accept('+')) {
        const int right = product();
        left = builder_.binary(Operation::add, left, right, since(begin));
      } else if (accept('-')) {
        const int right = product();
        left = builder_.binary(Operation::subtract, left, right, since(begin));
      } else {
        return left;
      }
    }
  }

  int product() {
    const std::size_t begin = position_;
    int left = signed_power();
    bool below_the_line = false;  // behind a division by something without parentheses
    for (;;) {
      if (accept('*')) {
        if (peek() == '*') fail("for a power write ^ instead of **", position_);
        below_the_line = false;
        const int right = signed_power();
        left = builder_.binary(Operation::multiply, left, right, since(begin));
      } else if (accept('/')) {
        below_the_line = peek() != '(';
        const int right = signed_power();
        left = builder_.binary(Operation::divide, left, right, since(begin));
      } else if (starts_juxtaposed_factor()) {
        if (below_the_line) {
          fail("a/b c can be read as (a/b) c and as a/(b c); write * or put the divisor in parentheses", position_);
        }
        const int right = power();
        left = builder_.binary(Operation::multiply, left, right, since(begin));
      } else {
        return left;
      }
    }
  }

  [[nodiscard]] bool starts_juxtaposed_factor() const {
    if (is_digit(peek()) || peek() == '.') {
      fail("a number cannot follow without an operator; write * if a product is meant", position_);
    }
    return peek() == '(' || is_name_start(peek());
  }

  // Reads signs; true when they make a minus.
  bool signs() {
    bool minus = false;
    for (;;) {
      if (accept('-')) {
        minus = !minus;
      } else if (!accept('+')) {
        return minus;
      }
    }
  }

  int signed_power() {
    const std::size_t begin = position_;
    const bool minus = signs();
    const int operand = power();
    return minus ? builder_.unary(Operation::negate, operand, since(begin)) : operand;
  }

  int power() {
    const std::size_t begin = position_;
    const int base = primary();
    const bool base_is_e = previous_end_ == begin + 1 && formula_[begin] == 'e';
    if (!accept('^')) return base;
    if (base_is_e) {
      fail("for the exponential function write exp( ); a parameter in a power needs another name than e", begin);
    }
    const bool was_in_exponent = in_exponent_;
    in_exponent_ = true;
    const std::size_t exponent_begin = position_;
    const bool minus = signs();
    if (at_end()) fail("the exponent is missing at the end", formula_.size());
    int exponent = primary();
    if (minus) exponent = builder_.unary(Operation::negate, exponent, since(exponent_begin));
    in_exponent_ = was_in_exponent;
    if (peek() == '^') fail("a^b^c can be read in two ways; write parentheses", position_);
    return builder_.power(base, exponent, since(begin));
  }

  int primary() {
    if (is_digit(peek()) || peek() == '.') return number();
    if (is_name_start(peek())) return name();
    if (peek() == '(') return parenthesised();
    fail_at_unexpected();
  }

  int parenthesised() {
    const std::size_t opening = position_;
    if (!accept('(')) fail_at_unexpected();
    if (++depth_ > deepest_nesting) {
      fail("parentheses are nested deeper than " + std::to_string(deepest_nesting), opening);
    }
    if (at_end()) fail("this parenthesis is not closed", opening);
    const int inner = sum();
    if (at_end()) fail("this parenthesis is not closed", opening);
    if (!accept(')')) fail_at_unexpected();
    --depth_;
    return inner;
  }

  int number() {
    const std::size_t begin = position_;
    double value = 0;
    const char* const first = formula_.data() + begin;
    const auto [end, error] = std::from_chars(first, formula_.data() + formula_.size(), value);
    if (error == std::errc::result_out_of_range) {
      fail("this number is out of the range of double precision (about 1e-308 to 1e308)", begin);
    }
    if (error != std::errc{}) fail("this is no number", begin);
    position_ += static_cast<std::size_t>(end - first);
    previous_end_ = position_;
    skip_blanks();
    return builder_.number(value, since(begin));
  }

  int name() {
    const std::size_t begin = position_;
    while (!at_end() && (is_name_start(peek()) || is_digit(peek()))) ++position_;
    const std::string_view text = formula_.substr(begin, position_ - begin);
    const bool parenthesis_follows_at_once = peek() == '(';
    previous_end_ = position_;
    skip_blanks();
    if (text == "s") {
      if (in_exponent_) fail("an exponent must not contain s", begin);
      return builder_.laplace(exp_depth_ > 0, since(begin));
    }
    if (const auto function = function_named(text)) return call(*function, text, begin);
    const std::string quoted = std::string("'").append(text).append("'");
    if (text == "pi" || text == "inf" || text == "nan") {
      fail(quoted + " is not a parameter name; write the number", begin);
    }
    if (parenthesis_follows_at_once) {
      fail("unknown function " + quoted +
               " (known are exp, log, sqrt, sinh, cosh, tanh, coth, sech); for a product with a parameter write * or "
               "a blank",
           begin);
    }
    return builder_.parameter(text, since(begin));
  }

  int call(Operation function, std::string_view text, std::size_t begin) {
    if (peek() != '(') fail(std::string(text) + " needs its argument in parentheses", position_);
    if (function == Operation::exp) ++exp_depth_;
    const int argument = parenthesised();
    if (function == Operation::exp) --exp_depth_;
    if (function == Operation::sqrt) return builder_.square_root(argument, since(begin));
    return builder_.unary(function, argument, since(begin));
  }

  std::string_view formula_;
  std::size_t position_ = 0;
  std::size_t previous_end_ = 0;
  int depth_ = 0;
  int exp_depth_ = 0;
  bool in_exponent_ = false;
  ExpressionBuilder builder_;
};

}  // namespace

Expression parse_formula(std::string_view formula) {
  return Parser(formula).parse();
}

}  // namespace frac::detail
