// SPDX-License-Identifier: BSD-3-Clause
#include "options/options.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <stdexcept>

#include "io/data_error.hpp"
#include "io/number_list.hpp"
#include "options/misspelling.hpp"
#include "options/vocabulary.hpp"

namespace fracfit {
namespace {

[[noreturn]] void refuse(const std::string& message) {
  throw std::invalid_argument(message);
}

[[noreturn]] void refuse(std::string_view name, const std::string& text, const std::string& message) {
  refuse(std::string(name) + " " + io::quoted(text) + ": " + message);
}

std::string with_reason(const std::string& text, const std::string& why) {
  return why.empty() ? text : text + ", " + why;
}

}  // namespace

std::string either(const std::vector<std::string>& words) {
  std::string text;
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (i > 0) text += i + 1 == words.size() ? " or " : ", ";
    text += words[i];
  }
  return text;
}

double number_of(std::string_view name, const std::string& text) {
  const auto value = io::parse_number(text);
  if (!value || !std::isfinite(*value)) refuse(name, text, "expected a finite number");
  return *value;
}

std::size_t count_of(std::string_view name, const std::string& text, std::size_t lowest, std::size_t highest) {
  const auto value = io::parse_count(text);
  if (!value || *value < lowest || *value > highest)
    refuse(name, text, "expected a whole number from " + std::to_string(lowest) + " to " + std::to_string(highest));
  return *value;
}

std::vector<double> numbers_of(std::string_view name, const std::string& text) {
  return io::parse_grid(text, name);
}

std::complex<double> complex_of(std::string_view name, const std::string& text) {
  const std::vector<double> parts = io::parse_list(text, name);
  if (parts.size() > 2) refuse(name, text, "expected RE or RE,IM");
  return {parts[0], parts.size() == 2 ? parts[1] : 0};
}

std::pair<std::string, std::string> pair_of(std::string_view name, const std::string& text, const char* form) {
  const auto colon = text.find(':');
  if (colon == std::string::npos || text.find(':', colon + 1) != std::string::npos)
    refuse(name, text, std::string("expected ") + form);
  return {text.substr(0, colon), text.substr(colon + 1)};
}

// What bash reads as this text, in one line: the heads of files have one line per entry.
std::string shell_quoted(const std::string& text) {
  if (text.find_first_of("\n\r\t") != std::string::npos) {
    std::string quoted = "$'";
    for (const char c : text) {
      if (c == '\'' || c == '\\') quoted += '\\';
      quoted += c == '\n' ? "\\n" : c == '\r' ? "\\r" : c == '\t' ? "\\t" : std::string(1, c);
    }
    return quoted + "'";
  }
  constexpr std::string_view harmless = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-+=:,./%@";
  if (!text.empty() && text.find_first_not_of(harmless) == std::string::npos) return text;
  std::string quoted = "'";
  for (const char c : text) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

io::Shard shard_of(std::string_view name, const std::string& text) {
  const auto slash = text.find('/');
  if (text.substr(0, slash) == "auto") {
    try {
      return io::shard_of_environment(slash == std::string::npos ? 0 : count_of(name, text.substr(slash + 1), 1));
    } catch (const std::invalid_argument& error) {
      refuse(name, text, error.what());
    }
  }
  if (slash == std::string::npos) refuse(name, text, "expected i/n, such as 1/4, or auto");
  const io::Shard shard{count_of(name, text.substr(0, slash), 1), count_of(name, text.substr(slash + 1), 1)};
  if (shard.index > shard.count) refuse(name, text, "expected i/n with 1 <= i <= n");
  return shard;
}

void require_table_size(std::initializer_list<std::pair<std::string_view, std::size_t>> counts, std::size_t most) {
  std::string product;
  double rows = 1;
  for (const auto& [name, count] : counts) {
    product += (product.empty() ? "" : " times ") + std::to_string(count) + " (" + std::string(name) + ")";
    rows *= static_cast<double>(count);
  }
  if (rows > static_cast<double>(most)) refuse(product + " rows: expected at most " + std::to_string(most));
}

Option::Option(Kind kind, std::string name, const std::string& help, const std::string& type, Take take)
    : kind_(kind), name_(std::move(name)), type_(type), help_(help), take_(std::move(take)) {
  // Flags that one command has say themselves what they are.
  if (!type_.empty() || (kind_ == Kind::flag && !help.empty())) return;
  const Meaning& meaning = meaning_of(name_);
  type_ = meaning.type;
  help_ = meaning.text + (help.empty() ? "" : "; " + help);
}

Option& Option::required() {
  required_ = true;
  default_.clear();
  default_in_words_.clear();
  return *this;
}

Option& Option::otherwise(std::string text) {
  default_ = std::move(text);
  return *this;
}

Option& Option::default_is(std::string in_words) {
  default_.clear();
  default_in_words_ = std::move(in_words);
  return *this;
}

Option& Option::also(std::string short_name) {
  short_name_ = std::move(short_name);
  return *this;
}

Option& Option::one_of(std::vector<std::string> words) {
  only_words_ = true;
  return suggest(std::move(words));
}

Option& Option::suggest(std::vector<std::string> words) {
  words_ = std::move(words);
  return *this;
}

Option& Option::only_with(Condition condition, std::string why) {
  rules_.push_back({Rule::Kind::only_with, std::move(condition), std::move(why)});
  return *this;
}

Option& Option::not_with(Condition condition, std::string why) {
  rules_.push_back({Rule::Kind::not_with, std::move(condition), std::move(why)});
  return *this;
}

Option& Option::needed_with(Condition condition) {
  rules_.push_back({Rule::Kind::needed_with, std::move(condition), {}});
  return *this;
}

Option& Option::only_for(std::string kind_of_data) {
  kind_of_data_ = std::move(kind_of_data);
  return *this;
}

Option& Option::or_argument() {
  or_argument_ = true;
  return *this;
}

Option& Option::names_input() {
  names_input_ = true;
  return *this;
}

Option& Option::unsaid() {
  echoed_ = false;
  return *this;
}

const std::string& Option::text() const {
  if (said_) return *said_;
  return given.empty() ? default_ : given.back();
}

std::string Option::description() const {
  std::string text = help_;
  if (only_words_) text += ": " + either(words_);
  if (!default_in_words_.empty()) return text + " (default " + default_in_words_ + ")";
  return default_.empty() ? text : text + " (default " + default_ + ")";
}

Option& Options::add(Option::Kind kind, const std::string& name, const std::string& help, const std::string& type,
                     Option::Take take) {
  return options_.emplace_back(kind, name, help, type, std::move(take));
}

Option& Options::flag(const std::string& name, bool& target, const std::string& help) {
  return add(Option::Kind::flag, name, help, {}, [&target](const Option&, const std::string&) { target = true; });
}

Option& Options::text(const std::string& name, std::string& target, const std::string& help, const std::string& type) {
  return parsed(
             name, target, [](std::string_view, const std::string& text) { return text; }, help, type)
      .otherwise(target);
}

Option& Options::texts(const std::string& name, std::vector<std::string>& target, const std::string& help,
                       const std::string& type) {
  return add(Option::Kind::list, name, help, type,
             [&target](const Option&, const std::string& text) { target.push_back(text); });
}

Option& Options::number(const std::string& name, double& target, const std::string& help, const std::string& type) {
  return parsed(name, target, number_of, help, type).otherwise(std::isnan(target) ? "" : io::format_number(target));
}

Option& Options::number(const std::string& name, std::optional<double>& target, const std::string& help,
                        const std::string& type) {
  return parsed(name, target, number_of, help, type);
}

Option& Options::numbers(const std::string& name, std::vector<double>& target, const std::string& help,
                         const std::string& type) {
  return parsed(name, target, numbers_of, help, type);
}

Option& Options::one_number(const std::string& name, double& target, const std::string& help, const std::string& type) {
  const auto parse = [](std::string_view of, const std::string& text) {
    if (text.find_first_of(":,") != std::string::npos)
      refuse(of, text, "expected a single number; this command takes no grid or list of it");
    return number_of(of, text);
  };
  return parsed(name, target, parse, help, type).otherwise(std::isnan(target) ? "" : io::format_number(target));
}

void Options::exactly_one(std::vector<std::string> names, std::string why) {
  groups_.push_back({std::move(names), std::move(why), true});
}

void Options::at_most_one(std::vector<std::string> names) {
  groups_.push_back({std::move(names), {}, false});
}

Option& Options::operator[](std::string_view name) {
  return const_cast<Option&>(std::as_const(*this)[name]);
}

const Option& Options::operator[](std::string_view name) const {
  const auto found =
      std::find_if(options_.begin(), options_.end(), [&](const Option& option) { return option.name() == name; });
  if (found == options_.end()) throw std::logic_error("no option " + std::string(name) + " is declared");
  return *found;
}

bool Options::holds(const Condition& condition) const {
  const Option& option = (*this)[condition.option];
  if (condition.texts.empty()) return option.is_given();
  return std::find(condition.texts.begin(), condition.texts.end(), option.text()) != condition.texts.end();
}

bool Options::has_meaning(const Option& option) const {
  if (!kind_of_data_.empty() && !option.kind_of_data_.empty() && option.kind_of_data_ != kind_of_data_) return false;
  return std::all_of(option.rules_.begin(), option.rules_.end(), [&](const Option::Rule& rule) {
    return rule.kind == Option::Rule::Kind::needed_with ||
           holds(rule.condition) == (rule.kind == Option::Rule::Kind::only_with);
  });
}

void Options::check_rules(const Option& option) const {
  for (const auto& [kind, condition, why] : option.rules_) {
    const Option& other = (*this)[condition.option];
    const bool met = holds(condition);
    // For a choice the message names the value that was chosen.
    const std::string chosen =
        condition.option + (condition.texts.empty() || other.text().empty() ? "" : " " + other.text());
    if (kind == Option::Rule::Kind::needed_with && met && !option.is_given() && option.default_.empty())
      refuse(chosen + " needs " + option.name());
    if (kind == Option::Rule::Kind::not_with && met && option.is_given())
      refuse(with_reason(option.name() + " has no meaning with " + chosen, why));
    if (kind == Option::Rule::Kind::only_with && !met && option.is_given())
      refuse(with_reason(
          option.name() + " has no meaning " + (other.text().empty() ? "without " : "with ") + chosen +
              (condition.texts.empty() || other.text().empty() ? "" : ", only with " + either(condition.texts)),
          why));
  }
}

void Options::check_groups() const {
  for (const auto& [names, why, one_is_needed] : groups_) {
    const auto count =
        std::count_if(names.begin(), names.end(), [&](const std::string& name) { return (*this)[name].is_given(); });
    const std::string list = either(names);
    if (count > 1) refuse("give either " + list + ", not both");
    if (one_is_needed && count == 0) refuse("give either " + list + ": " + why);
  }
}

// Where a value was forgotten, the next option would be taken for it, and the value of that for an argument.
void Options::check_no_value_is_an_option() const {
  for (const Option& option : options_) {
    if (option.kind_ == Option::Kind::flag) continue;
    for (const std::string& text : option.given) {
      const std::string name = text.substr(0, text.find('='));
      const bool is_option =
          name.starts_with("--") &&
          std::any_of(options_.begin(), options_.end(), [&](const Option& other) { return other.name() == name; });
      if (is_option) refuse(option.name() + " lacks its value: " + name + " is an option; expected " + option.type_);
    }
  }
}

void Options::interpret() {
  check_no_value_is_an_option();
  for (Option& option : options_) {
    if (option.kind_ == Option::Kind::value && option.given.size() > 1) refuse(option.name() + " is given twice");
    for (const std::string& text : option.given) {
      // As from a variable of a script that is not set: left out without a word, the result would be another one.
      if (text.empty() && option.kind_ != Option::Kind::flag)
        refuse(option.name() + " '': the value is empty; expected " + option.type_);
      if (option.only_words_ && std::find(option.words_.begin(), option.words_.end(), text) == option.words_.end())
        refuse(option.name() + ": " + io::quoted(text) + " is not allowed; expected " + either(option.words_) +
               suggestion(text, option.words_));
      try {
        option.take_(option, text);
      } catch (const std::invalid_argument& error) {
        const std::string message = error.what();
        refuse(message.starts_with(option.name()) ? message : option.name() + ": " + message);
      }
    }
    if (!option.is_given() && !option.default_.empty()) option.take_(option, option.default_);
  }
  for (const Option& option : options_)
    if (option.required_ && !option.is_given() && has_meaning(option))
      refuse(option.name() + " is required: " + option.help_);
  for (const Option& option : options_) check_rules(option);
  check_groups();
}

std::vector<std::string> Options::input_files() const {
  std::vector<std::string> files;
  for (const Option& option : options_) {
    if (!option.names_input_) continue;
    std::copy_if(option.given.begin(), option.given.end(), std::back_inserter(files), [&](const std::string& text) {
      return std::find(option.words_.begin(), option.words_.end(), text) == option.words_.end();
    });
  }
  return files;
}

void Options::settle(const std::string& kind_of_data) {
  kind_of_data_ = kind_of_data;
  for (const Option& option : options_)
    if (option.is_given() && !option.kind_of_data_.empty() && option.kind_of_data_ != kind_of_data)
      refuse(option.name() + " has no meaning with " + kind_of_data + ", only with " + option.kind_of_data_);
}

std::string Options::command_line(const std::string& command) const {
  std::string line = "fracfit " + command;
  for (const Option& option : options_) {
    if (!option.echoed_ || !has_meaning(option)) continue;
    const std::string start = option.is_argument() ? " " : " " + option.name() + " ";
    if (option.kind_ == Option::Kind::flag) {
      if (option.is_given()) line += " " + option.name();
    } else if (option.kind_ == Option::Kind::list && !option.said_) {
      for (const std::string& text : option.given) line += start + shell_quoted(text);
    } else if (!option.text().empty()) {
      line += start + shell_quoted(option.text());
    }
  }
  return line;
}

std::string Options::in_their_words(std::string message) const {
  const auto is_of_name = [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '-';
  };
  for (const Option& option : options_) {
    std::string name = option.name_.substr(option.name_.find_first_not_of('-'));
    std::replace(name.begin(), name.end(), '-', '_');
    for (const std::string& parameter : {name, name == "force" ? std::string("force_amplitude") : name + "_time"}) {
      // A word without underscore may as well be plain English.
      if (parameter.find('_') == std::string::npos) continue;
      for (std::size_t at = 0; (at = message.find(parameter, at)) != std::string::npos; at += option.name_.size()) {
        const std::size_t end = at + parameter.size();
        if ((at > 0 && is_of_name(message[at - 1])) || (end < message.size() && is_of_name(message[end]))) continue;
        message.replace(at, parameter.size(), option.name_);
      }
    }
  }
  return message;
}

io::Metadata Options::entries(std::initializer_list<std::string_view> names) const {
  io::Metadata entries;
  for (const std::string_view name : names) {
    const Option& option = (*this)[name];
    if (has_meaning(option) && !option.text().empty())
      entries.emplace_back(std::string(name.substr(name.find_first_not_of('-'))), option.text());
  }
  return entries;
}

}  // namespace fracfit
