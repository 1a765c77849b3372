// SPDX-License-Identifier: BSD-3-Clause
#include "definition.hpp"

#include <cctype>
#include <stdexcept>

namespace frac::detail {
namespace {

std::string trimmed(std::string_view text) {
  constexpr const char* blanks = " \t";
  const auto first = text.find_first_not_of(blanks);
  if (first == std::string_view::npos) return {};
  return std::string(text.substr(first, text.find_last_not_of(blanks) - first + 1));
}

}  // namespace

Definition split_definition(std::string_view text) {
  const auto equals = text.find('=');
  Definition made{trimmed(text.substr(0, equals)), {}};
  if (equals == std::string_view::npos || made.name.empty())
    throw std::invalid_argument("'" + std::string(text) + "' is no definition; expected NAME = FORMULA");
  made.formula = trimmed(text.substr(equals + 1));
  return made;
}

std::string with_pi(std::string_view formula) {
  const auto in_name = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; };
  std::string text;
  for (std::size_t i = 0; i < formula.size();) {
    if (!in_name(formula[i])) {
      text += formula[i++];
      continue;
    }
    std::size_t end = i;
    while (end < formula.size() && in_name(formula[end])) ++end;
    const std::string_view word = formula.substr(i, end - i);
    text += word == "pi" ? "(3.1415926535897932)" : word;
    i = end;
  }
  return text;
}

}  // namespace frac::detail
