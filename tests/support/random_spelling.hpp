// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "base/number_text.hpp"
#include "formula/expression.hpp"
#include "formula/function_names.hpp"
#include "frac/structure.hpp"
#include "support/random.hpp"

namespace support {

/// A formula written another way: terms and factors in another order, other blanks, parentheses that change nothing,
/// other names.
class RandomSpelling {
 public:
  RandomSpelling(const frac::Structure& structure, std::uint64_t seed, bool other_names = true)
      : expression_(structure.expression()), random_(seed) {
    for (const std::string& name : structure.parameter_names()) names_.push_back(other_names ? new_name() : name);
    text_ = blank() + sum(static_cast<int>(expression_.nodes.size()) - 1) + blank();
  }

  [[nodiscard]] const std::string& text() const { return text_; }
  /// Of the parameters, in their order in the given structure.
  [[nodiscard]] const std::vector<std::string>& names() const { return names_; }

 private:
  using Operation = frac::detail::Operation;

  std::string new_name() {
    for (;;) {
      // None of these is s, e, or the name of a function.
      std::string name(1, "abcdfghkmnoqrtuvwxyzABCDEFGHKMNOQRTUVWXYZ"[random_.below(41)]);
      if (random_.below(2) == 0) name += std::to_string(random_.below(30));
      if (used_.insert(name).second) return name;
    }
  }

  std::string blank() { return std::string(random_.below(3), ' '); }
  bool sometimes() { return random_.below(4) == 0; }
  template <class Entries>
  void shuffle(Entries& entries) {
    for (std::size_t i = entries.size(); i > 1; --i) std::swap(entries[i - 1], entries[random_.below(i)]);
  }

  [[nodiscard]] const frac::detail::Node& node(int index) const {
    return expression_.nodes[static_cast<std::size_t>(index)];
  }

  /// The terms of a sum by sign and node.
  void collect_terms(int index, bool minus, std::vector<std::pair<bool, int>>& terms) {
    const auto& at = node(index);
    if (at.operation == Operation::add || at.operation == Operation::subtract) {
      collect_terms(at.left, minus, terms);
      collect_terms(at.right, minus != (at.operation == Operation::subtract), terms);
    } else if (at.operation == Operation::negate) {
      collect_terms(at.left, !minus, terms);
    } else {
      terms.emplace_back(minus, index);
    }
  }

  std::string sum(int index) {
    std::vector<std::pair<bool, int>> terms;
    collect_terms(index, false, terms);
    shuffle(terms);
    std::string text;
    for (const auto& [minus, term] : terms) {
      if (!text.empty() || minus) text += blank() + (minus ? "-" : "+") + blank();
      text += product(term);
    }
    return sometimes() ? "(" + blank() + text + blank() + ")" : text;
  }

  void collect_factors(int index, bool below, std::vector<int>& above_line, std::vector<int>& below_line) {
    const auto& at = node(index);
    if (at.operation == Operation::multiply || at.operation == Operation::divide) {
      collect_factors(at.left, below, above_line, below_line);
      collect_factors(at.right, below != (at.operation == Operation::divide), above_line, below_line);
    } else {
      (below ? below_line : above_line).push_back(index);
    }
  }

  std::string joined(std::vector<int> factors) {
    shuffle(factors);
    std::string text;
    for (const int each : factors) {
      const std::string next = factor(each);
      // A number behind a blank is refused, and so is a name with ( right behind it.
      const bool is_number = (next[0] >= '0' && next[0] <= '9') || next[0] == '.';
      if (!text.empty()) text += is_number || sometimes() ? blank() + "*" + blank() : " " + blank();
      text += next;
    }
    return text;
  }

  std::string product(int index) {
    std::vector<int> above_line, below_line;
    collect_factors(index, false, above_line, below_line);
    std::string text = above_line.empty() ? "1" : joined(std::move(above_line));
    if (!below_line.empty()) text += blank() + "/" + blank() + "(" + joined(std::move(below_line)) + ")";
    return sometimes() ? "(" + text + ")" : text;
  }

  std::string factor(int index) {
    const auto& at = node(index);
    switch (at.operation) {
      case Operation::number:
        return frac::detail::number_text(at.number);
      case Operation::parameter:
        return names_[static_cast<std::size_t>(at.parameter)];
      case Operation::laplace:
      case Operation::exact_laplace:
        return "s";
      case Operation::add:
      case Operation::subtract:
      case Operation::multiply:
      case Operation::divide:
      case Operation::negate:
        return "(" + sum(index) + ")";
      case Operation::power:
        return "(" + sum(at.left) + ")" + blank() + "^" + blank() + "(" + sum(at.right) + ")";
      case Operation::power_of_s: {
        const bool plain = node(at.left).operation == Operation::number && node(at.left).number == 1;
        const std::string first = random_.below(2) == 0 ? "(s (" + sum(at.left) + "))" : "((" + sum(at.left) + ") s)";
        return (plain ? "s" : first) + blank() + "^" + blank() + "(" + sum(at.right) + ")";
      }
      default:
        break;
    }
    const auto* name = std::find_if(std::begin(frac::detail::function_names), std::end(frac::detail::function_names),
                                    [&](const auto& known) { return known.second == at.operation; });
    return std::string(name->first) + "(" + sum(at.left) + ")";
  }

  const frac::detail::Expression& expression_;
  Random random_;
  std::set<std::string> used_;
  std::vector<std::string> names_;
  std::string text_;
};

}  // namespace support
