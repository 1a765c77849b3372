// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <complex>
#include <cstddef>
#include <deque>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "io/number.hpp"
#include "io/shard.hpp"
#include "io/text_table.hpp"

namespace fracfit {

/// "a, b or c".
[[nodiscard]] std::string either(const std::vector<std::string>& words);

/// How enumerators are spelled, see the to_string beside each enumeration.
template <class Enumerators>
std::vector<std::string> spellings(const Enumerators& enumerators) {
  std::vector<std::string> words;
  words.reserve(std::size(enumerators));
  for (const auto enumerator : enumerators) words.emplace_back(to_string(enumerator));
  return words;
}

// Texts of options as values.  Each throws std::invalid_argument that names the option.
[[nodiscard]] double number_of(std::string_view name, const std::string& text);
/// Rows of one table, or samples, that are no mistake and fit into the memory of a small computer.
constexpr std::size_t largest_table = 10'000'000;
[[nodiscard]] std::size_t count_of(std::string_view name, const std::string& text, std::size_t lowest,
                                   std::size_t highest = largest_table);
/// A number, a list a,b,c or a grid FROM:TO:COUNT[log].
[[nodiscard]] std::vector<double> numbers_of(std::string_view name, const std::string& text);
/// RE or RE,IM.
[[nodiscard]] std::complex<double> complex_of(std::string_view name, const std::string& text);
/// Two texts with a colon between them.
/// @param form  how the message writes them, e.g. LOW:HIGH
[[nodiscard]] std::pair<std::string, std::string> pair_of(std::string_view name, const std::string& text,
                                                          const char* form = "LOW:HIGH");
/// i/n with 1 <= i <= n; auto, as the environment says, or auto/n; empty: all.
[[nodiscard]] io::Shard shard_of(std::string_view name, const std::string& text);
/// Rows of a table that goes to a file piece by piece.
constexpr std::size_t largest_stream = 10'000'000'000;
/// @throws std::invalid_argument  the product of these counts, each with the option it comes from, is above the limit.
void require_table_size(std::initializer_list<std::pair<std::string_view, std::size_t>> counts,
                        std::size_t most = largest_table);

/// The text as one word of a shell, in quotes where it needs them.
[[nodiscard]] std::string shell_quoted(const std::string& text);

/// An option that was given, or whose text, default included, is one of these.
struct Condition {
  std::string option;
  std::vector<std::string> texts{};
};

/// One option, or one argument without a name.  It is declared once: check, help, manual page, completion, refusals and
/// the command line that makes a result again all follow from the declaration.
class Option {
 public:
  using Take = std::function<void(const Option& option, const std::string& text)>;
  enum class Kind { flag, value, list };

  Option(Kind kind, std::string name, const std::string& help, const std::string& type, Take take);

  // Declaration.
  Option& required();
  Option& otherwise(std::string text);       ///< its default
  Option& default_is(std::string in_words);  ///< told by the help alone, where the default depends on other things
  Option& also(std::string short_name);      ///< such as -o
  Option& one_of(std::vector<std::string> words);
  Option& suggest(std::vector<std::string> words);  ///< words that have a meaning beside other text
  Option& only_with(Condition condition, std::string why = {});
  Option& not_with(Condition condition, std::string why = {});
  Option& needed_with(Condition condition);
  Option& only_for(std::string kind_of_data);  ///< see Options::settle
  Option& or_argument();                       ///< its value may stand without the name
  Option& names_input();  ///< a file that the command reads, which --out must not replace; suggested words are none
  Option& unsaid();       ///< has no influence on the result, and so no place in its command line

  // After parsing.
  [[nodiscard]] bool is_given() const { return !given.empty(); }
  /// As given, else the default; empty where there is neither.
  [[nodiscard]] const std::string& text() const;
  /// What the command line says instead of what was given, e.g. what a choice left to the program came out as.
  void say(std::string text) { said_ = std::move(text); }

  // What the pages of help tell.
  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] const std::string& type() const { return type_; }
  [[nodiscard]] std::string description() const;
  [[nodiscard]] const std::vector<std::string>& words() const { return words_; }
  [[nodiscard]] const std::string& short_name() const { return short_name_; }
  [[nodiscard]] Kind kind() const { return kind_; }
  [[nodiscard]] bool is_argument() const { return name_.front() != '-'; }
  [[nodiscard]] bool is_required() const { return required_; }
  [[nodiscard]] bool takes_argument() const { return or_argument_; }

  std::vector<std::string> given;  ///< texts of the command line; one empty text for a flag

 private:
  friend class Options;
  struct Rule {
    enum class Kind { only_with, not_with, needed_with } kind;
    Condition condition;
    std::string why;
  };
  Kind kind_;
  std::string name_, type_, help_, default_, default_in_words_, short_name_, kind_of_data_;
  std::optional<std::string> said_;
  std::vector<std::string> words_;
  std::vector<Rule> rules_;
  Take take_;
  bool required_ = false, only_words_ = false, or_argument_ = false, names_input_ = false, echoed_ = true;
};

/// The options of one command, in the order in which help and command line show them.
class Options {
 public:
  // Each declares an option with the variable that it sets.  The variable's value is the default; none where it is NaN,
  // empty or unset.  Without `type` the option is one of the common vocabulary, and `help` adds to what that says.
  Option& flag(const std::string& name, bool& target, const std::string& help = {});
  Option& text(const std::string& name, std::string& target, const std::string& help = {},
               const std::string& type = {});
  /// May be given several times.
  Option& texts(const std::string& name, std::vector<std::string>& target, const std::string& help = {},
                const std::string& type = {});
  Option& number(const std::string& name, double& target, const std::string& help = {}, const std::string& type = {});
  Option& number(const std::string& name, std::optional<double>& target, const std::string& help = {},
                 const std::string& type = {});
  /// List or grid.
  Option& numbers(const std::string& name, std::vector<double>& target, const std::string& help = {},
                  const std::string& type = {});
  /// A list or grid of which this command takes one value.
  Option& one_number(const std::string& name, double& target, const std::string& help = {},
                     const std::string& type = {});
  template <class Count>
  Option& count(const std::string& name, Count& target, std::size_t lowest, std::size_t highest = largest_table,
                const std::string& help = {}, const std::string& type = {}) {
    Option& option = parsed(
        name, target,
        [lowest, highest](std::string_view of, const std::string& text) {
          return static_cast<plain<Count>>(count_of(of, text, lowest, highest));
        },
        help, type);
    if constexpr (std::is_same_v<plain<Count>, Count>) option.otherwise(std::to_string(target));
    return option;
  }
  /// One of these enumerators by its spelling.
  template <class Choice, class Enumerators>
  Option& choice(const std::string& name, Choice& target, const Enumerators& all, const std::string& help = {},
                 const std::string& type = {}) {
    const std::vector<plain<Choice>> list(std::begin(all), std::end(all));
    Option& option = parsed(
        name, target,
        [list](std::string_view, const std::string& text) {
          for (const auto each : list)
            if (to_string(each) == text) return each;
          return list.front();  // not reached: the words below are checked first
        },
        help, type);
    option.one_of(spellings(all));
    if constexpr (std::is_same_v<plain<Choice>, Choice>) option.otherwise(std::string(to_string(target)));
    return option;
  }
  /// @param parse  makes the value from option name and text
  template <class Target, class Parse>
  Option& parsed(const std::string& name, Target& target, Parse parse, const std::string& help = {},
                 const std::string& type = {}) {
    return add(Option::Kind::value, name, help, type, [&target, parse](const Option& option, const std::string& text) {
      target = parse(option.name(), text);
    });
  }
  void exactly_one(std::vector<std::string> names, std::string why);
  void at_most_one(std::vector<std::string> names);

  [[nodiscard]] Option& operator[](std::string_view name);
  [[nodiscard]] const Option& operator[](std::string_view name) const;
  [[nodiscard]] const std::deque<Option>& all() const { return options_; }
  [[nodiscard]] std::deque<Option>& all() { return options_; }

  /// Sets every variable from what was given. @throws std::invalid_argument  naming the option.
  void interpret();
  /// The files that were given to options that name inputs; "-" is standard input.
  [[nodiscard]] std::vector<std::string> input_files() const;
  /// Says of which kind the data are. @throws std::invalid_argument  an option was given that is for another kind only.
  void settle(const std::string& kind_of_data);

  /// The command line with every default spelled out, such that it can be pasted into a shell.
  [[nodiscard]] std::string command_line(const std::string& command) const;
  /// A message of the libraries with the names of their parameters, e.g. force_amplitude, replaced by those of options.
  [[nodiscard]] std::string in_their_words(std::string message) const;
  /// Option names without dashes, and texts, of those that have one.
  [[nodiscard]] io::Metadata entries(std::initializer_list<std::string_view> names) const;

 private:
  template <class Target>
  struct Plain {
    using type = Target;
  };
  template <class Target>
  struct Plain<std::optional<Target>> {
    using type = Target;
  };
  template <class Target>
  using plain = typename Plain<Target>::type;
  struct Group {
    std::vector<std::string> names;
    std::string why;
    bool one_is_needed;
  };
  Option& add(Option::Kind kind, const std::string& name, const std::string& help, const std::string& type,
              Option::Take take);
  [[nodiscard]] bool holds(const Condition& condition) const;
  [[nodiscard]] bool has_meaning(const Option& option) const;
  void check_rules(const Option& option) const;
  void check_no_value_is_an_option() const;
  void check_groups() const;

  std::deque<Option> options_;  // references to them stay valid
  std::vector<Group> groups_;
  std::string kind_of_data_;
};

}  // namespace fracfit
