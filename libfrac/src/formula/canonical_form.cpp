// SPDX-License-Identifier: BSD-3-Clause
#include "canonical_form.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <numeric>
#include <utility>

#include "base/number_text.hpp"

namespace frac::detail {
namespace {

class Writer {
 public:
  Writer(const std::vector<Node>& nodes, std::span<const std::string> labels) : nodes_(nodes), labels_(labels) {}

  /// A node as a sum, which most are of one term.
  [[nodiscard]] std::string sum(int index) const {
    Terms terms;
    add_terms(index, 1, terms);
    if (terms.constant != 0 || terms.texts.empty()) terms.texts.push_back(number_text(terms.constant));
    return listed("+", std::move(terms.texts));
  }

 private:
  struct Terms {
    double constant = 0;
    std::vector<std::string> texts;
  };
  struct Factors {
    double number = 1;
    std::vector<std::string> texts;
  };

  [[nodiscard]] const Node& node(int index) const { return nodes_[static_cast<std::size_t>(index)]; }

  static std::string listed(const char* sign, std::vector<std::string> parts) {
    if (parts.size() == 1) return std::move(parts.front());
    std::sort(parts.begin(), parts.end());
    std::string text = std::string("(") + sign;
    for (const std::string& part : parts) text += " " + part;
    return text + ")";
  }

  void add_terms(int index, double sign, Terms& terms) const {
    const Node& at = node(index);
    switch (at.operation) {
      case Operation::add:
      case Operation::subtract:
        add_terms(at.left, sign, terms);
        add_terms(at.right, at.operation == Operation::add ? sign : -sign, terms);
        return;
      case Operation::negate:
        add_terms(at.left, -sign, terms);
        return;
      default:
        break;
    }
    if (const auto literal = literal_value(nodes_, index)) {
      terms.constant += sign * *literal;
      return;
    }
    Factors factors{sign, {}};
    add_factors(index, 1, factors);
    if (factors.number != 1) factors.texts.push_back(number_text(factors.number));
    terms.texts.push_back(listed("*", std::move(factors.texts)));
  }

  /// @param exponent  1 above the line, -1 below it
  void add_factors(int index, double exponent, Factors& factors) const {
    if (const auto literal = literal_value(nodes_, index)) {
      factors.number *= exponent > 0 ? *literal : 1 / *literal;
      return;
    }
    const Node& at = node(index);
    switch (at.operation) {
      case Operation::multiply:
      case Operation::divide:
        add_factors(at.left, exponent, factors);
        add_factors(at.right, at.operation == Operation::multiply ? exponent : -exponent, factors);
        return;
      case Operation::negate:
        factors.number = -factors.number;
        add_factors(at.left, exponent, factors);
        return;
      case Operation::power:
        add_power(sum(at.left), at.right, exponent, factors);
        return;
      case Operation::power_of_s:
        add_power(literal_value(nodes_, at.left) == 1.0 ? "s" : "(s " + sum(at.left) + ")", at.right, exponent,
                  factors);
        return;
      case Operation::sqrt:
        factors.texts.push_back(raised(sum(at.left), exponent / 2));
        return;
      case Operation::parameter:
        factors.texts.push_back(raised(labels_[static_cast<std::size_t>(at.parameter)], exponent));
        return;
      case Operation::laplace:
        factors.texts.push_back(raised("s", exponent));
        return;
      case Operation::exact_laplace:
        factors.texts.push_back(raised("exact-s", exponent));
        return;
      case Operation::number:
      case Operation::add:
      case Operation::subtract:
        factors.texts.push_back(raised(sum(index), exponent));
        return;
      default:  // a function
        factors.texts.push_back(
            raised("(f" + std::to_string(static_cast<int>(at.operation)) + " " + sum(at.left) + ")", exponent));
        return;
    }
  }

  /// 1/x^q is x^-q for principal values; x^a with a that is no number stays one factor.
  void add_power(const std::string& base, int exponent, double sign, Factors& factors) const {
    if (const auto literal = literal_value(nodes_, exponent)) {
      factors.texts.push_back(raised(base, sign * *literal));
    } else {
      factors.texts.push_back(raised("(^ " + base + " " + sum(exponent) + ")", sign));
    }
  }

  static std::string raised(const std::string& base, double exponent) {
    return exponent == 1 ? base : "(^ " + base + " " + number_text(exponent) + ")";
  }

  const std::vector<Node>& nodes_;
  std::span<const std::string> labels_;
};

// Neither is a name.
const std::string unmatched = "?";
std::string label(std::size_t number) {
  return "#" + std::to_string(number);
}

/// Matches parameters one by one, each with the first that leaves the texts equal; what cannot be completed is taken
/// back, which needs parameters of equal surroundings that are nevertheless told apart by others.
class Matching {
 public:
  Matching(const Expression& expression, const Expression& other)
      : one_(expression), other_(other), size_(expression.parameter_names.size()) {
    one_labels_.assign(size_, unmatched);
    other_labels_.assign(size_, unmatched);
    matched_.resize(size_);
    sequence_.resize(size_);
    std::iota(sequence_.begin(), sequence_.end(), std::size_t{0});
    const auto& names = one_.parameter_names;
    std::sort(sequence_.begin(), sequence_.end(),
              [&](std::size_t a, std::size_t b) { return named_before(names[a], names[b]); });
  }

  [[nodiscard]] std::optional<std::vector<std::size_t>> found() {
    if (canonical_text(one_, one_labels_) != canonical_text(other_, other_labels_) || !complete(0)) return std::nullopt;
    return matched_;
  }

 private:
  bool complete(std::size_t next) {
    if (next == size_) return true;
    const std::size_t parameter = sequence_[next];
    one_labels_[parameter] = label(next);
    const std::string wanted = canonical_text(one_, one_labels_);
    for (const std::size_t candidate : candidates(one_.parameter_names[parameter])) {
      other_labels_[candidate] = label(next);
      matched_[parameter] = candidate;
      if (canonical_text(other_, other_labels_) == wanted && complete(next + 1)) return true;
      other_labels_[candidate] = unmatched;
    }
    one_labels_[parameter] = unmatched;
    return false;
  }

  /// Those that are free, the one of that name first.
  [[nodiscard]] std::vector<std::size_t> candidates(const std::string& name) const {
    const auto& names = other_.parameter_names;
    std::vector<std::size_t> free;
    for (std::size_t i = 0; i < size_; ++i)
      if (other_labels_[i] == unmatched) free.push_back(i);
    std::sort(free.begin(), free.end(), [&](std::size_t a, std::size_t b) {
      const bool first = names[a] == name, second = names[b] == name;
      return first != second ? first : named_before(names[a], names[b]);
    });
    return free;
  }

  const Expression& one_;
  const Expression& other_;
  std::size_t size_;
  std::vector<std::string> one_labels_, other_labels_;
  std::vector<std::size_t> matched_, sequence_;
};

bool starts_name(char c) {
  return std::isalpha(static_cast<unsigned char>(c)) != 0 || c == '_';
}
bool continues_name(char c) {
  return starts_name(c) || std::isdigit(static_cast<unsigned char>(c)) != 0;
}

}  // namespace

std::string canonical_text(const Expression& expression, std::span<const std::string> labels) {
  return Writer(expression.nodes, labels).sum(static_cast<int>(expression.nodes.size()) - 1);
}

std::string shape_of(const Expression& expression) {
  return canonical_text(expression, std::vector<std::string>(expression.parameter_names.size(), unmatched));
}

std::optional<std::vector<std::size_t>> matched_parameters(const Expression& expression, const Expression& other) {
  if (expression.parameter_names.size() != other.parameter_names.size()) return std::nullopt;
  return Matching(expression, other).found();
}

std::string with_names(const Expression& expression, std::span<const std::string> names) {
  const std::string& formula = expression.formula;
  std::string text;
  for (std::size_t begin = 0; begin < formula.size();) {
    std::size_t end = begin + 1;
    if (starts_name(formula[begin])) {
      while (end < formula.size() && continues_name(formula[end])) ++end;
    } else {
      // The letter in a number such as 1e3 starts no name.
      double ignored = 0;
      const auto [stop, error] = std::from_chars(formula.data() + begin, formula.data() + formula.size(), ignored);
      const bool is_number = formula[begin] != '-' && error == std::errc{};
      if (is_number) end = static_cast<std::size_t>(stop - formula.data());
    }
    const std::string word = formula.substr(begin, end - begin);
    const auto& known = expression.parameter_names;
    const auto place = std::find(known.begin(), known.end(), word);
    text += place == known.end() ? word : names[static_cast<std::size_t>(place - known.begin())];
    begin = end;
  }
  return text;
}

bool named_before(const std::string& a, const std::string& b) {
  const auto split = [](const std::string& name) {
    std::size_t end = name.size();
    while (end > 0 && std::isdigit(static_cast<unsigned char>(name[end - 1]))) --end;
    return std::pair(name.substr(0, end), name.substr(end));
  };
  const auto [letters_a, digits_a] = split(a);
  const auto [letters_b, digits_b] = split(b);
  if (letters_a != letters_b) return letters_a < letters_b;
  return digits_a.size() != digits_b.size() ? digits_a.size() < digits_b.size() : digits_a < digits_b;
}

}  // namespace frac::detail
