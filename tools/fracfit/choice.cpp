// SPDX-License-Identifier: BSD-3-Clause
#include "choice.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <sstream>

#include "io/data_error.hpp"

namespace fracfit {
namespace {

// CLI11 appends the description of a validator to the type name of its option, and that can be read back.
constexpr std::string_view others = "...";

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ",") + word;
  return text;
}

}  // namespace

CLI::Validator one_of(std::vector<std::string> words) {
  std::string name = "{" + joined(words) + "}";
  return {[words = std::move(words)](const std::string& text) {
            if (std::find(words.begin(), words.end(), text) != words.end()) return std::string();
            return io::quoted(text) + " is not allowed; expected " + either(words);
          },
          std::move(name)};
}

CLI::Validator suggest(std::vector<std::string> words) {
  words.emplace_back(others);
  return {[](const std::string&) { return std::string(); }, "{" + joined(words) + "}"};
}

Choice choice_of(const CLI::Option& option) {
  const std::string type = option.get_type_name();
  const auto open = type.find('{');
  Choice choice;
  if (open == std::string::npos) return choice;
  std::istringstream list(type.substr(open + 1, type.find('}') - open - 1));
  choice.exclusive = true;
  for (std::string word; std::getline(list, word, ',');) {
    if (word == others) {
      choice.exclusive = false;
    } else {
      choice.words.push_back(word);
    }
  }
  return choice;
}

std::string type_name_of(const CLI::Option& option) {
  const std::string type = option.get_type_name();
  const auto open = type.find(":{");
  return open == std::string::npos ? type : type.substr(0, open);
}

std::string description_of(const CLI::Option& option) {
  const Choice choice = choice_of(option);
  const std::string& text = option.get_description();
  return choice.exclusive ? text + ": " + either(choice.words) : text;
}

std::string either(const std::vector<std::string>& words) {
  std::string text;
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (i > 0) text += i + 1 == words.size() ? " or " : ", ";
    text += words[i];
  }
  return text;
}

}  // namespace fracfit
