// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace CLI {
class Option;
class Validator;
}  // namespace CLI

namespace fracfit {

// What an option may be given, told once: its check, the help, the manual page and the completion all take it from
// here.

/// A check that the text is one of these words.
[[nodiscard]] CLI::Validator one_of(std::vector<std::string> words);
/// No check: words that have a meaning beside other text, such as a file or a formula.
[[nodiscard]] CLI::Validator suggest(std::vector<std::string> words);

/// The words of an option made so; empty where it has none.
struct Choice {
  std::vector<std::string> words;
  bool exclusive = false;  // nothing else is allowed
};
[[nodiscard]] Choice choice_of(const CLI::Option& option);
/// What kind of text the option takes, in capitals, without the words.
[[nodiscard]] std::string type_name_of(const CLI::Option& option);
/// What the option is for and, unless they are told there, its words.
[[nodiscard]] std::string description_of(const CLI::Option& option);

/// "a, b or c".
[[nodiscard]] std::string either(const std::vector<std::string>& words);

/// How enumerators are spelled, see the to_string beside each enumeration.
template <class Enumerators>
std::vector<std::string> spellings(const Enumerators& enumerators) {
  std::vector<std::string> words;
  for (const auto enumerator : enumerators) words.emplace_back(to_string(enumerator));
  return words;
}

}  // namespace fracfit
