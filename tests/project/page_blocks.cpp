// SPDX-License-Identifier: BSD-3-Clause
#include "project/page_blocks.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <regex>
#include <sstream>
#include <stdexcept>

namespace {

std::vector<std::string> lines_of(const std::filesystem::path& path) {
  std::ifstream file(path);
  if (!file) throw std::runtime_error("cannot read " + path.string());
  std::vector<std::string> lines;
  for (std::string line; std::getline(file, line);) lines.push_back(line);
  return lines;
}

bool in_a_name(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_';
}

/// Length of the number that starts at `at`, 0 where none does.
std::size_t number_length(const std::string& text, std::size_t at) {
  static const std::regex number(R"([-+]?[0-9]+(\.[0-9]+)?([eE][-+]?[0-9]+)?)");
  if (at > 0 && (in_a_name(text[at - 1]) || text[at - 1] == '.')) return 0;
  std::smatch match;
  const auto begin = text.begin() + static_cast<std::ptrdiff_t>(at);
  if (!std::regex_search(begin, text.end(), match, number, std::regex_constants::match_continuous)) return 0;
  return static_cast<std::size_t>(match.length());
}

bool has_decimals(const std::string& number) {
  return number.find_first_of(".eE") != std::string::npos;
}

std::size_t significant_digits(const std::string& number) {
  const std::string mantissa = number.substr(0, number.find_first_of("eE"));
  const std::size_t first = mantissa.find_first_of("123456789");
  if (first == std::string::npos) return 0;
  return static_cast<std::size_t>(std::count_if(mantissa.begin() + static_cast<std::ptrdiff_t>(first), mantissa.end(),
                                                [](char c) { return c != '.'; }));
}

PrintedNumber printed_number(const std::string& text) {
  const std::size_t exponent = text.find_first_of("eE");
  const std::size_t point = text.find('.');
  const std::size_t end = exponent == std::string::npos ? text.size() : exponent;
  const double decimals = point == std::string::npos ? 0 : static_cast<double>(end - point - 1);
  const double power = exponent == std::string::npos ? 0 : std::strtod(text.c_str() + exponent + 1, nullptr);
  return {text, std::strtod(text.c_str(), nullptr), std::pow(10.0, power - decimals)};
}

/// A word of a page as a regular expression, with a group for each number that is compared by its value.
class ShownWord {
 public:
  ShownWord(const std::string& text, std::size_t line, double tolerance)
      : line_(line), is_gap_(text == "..."), tolerance_(tolerance) {
    std::string pattern;
    for (std::size_t at = 0; at < text.size();) {
      if (text.compare(at, 3, "...") == 0) {
        pattern += ".*";
        at += 3;
      } else if (const std::size_t length = number_length(text, at); length > 0) {
        const std::string number = text.substr(at, length);
        at += length;
        if (has_decimals(number)) {
          numbers_.push_back(printed_number(number));
          // Few digits are those of an input or of a rounded judgement, which no processor changes.
          if (significant_digits(number) < 4 && text.compare(at, 3, "...") != 0) numbers_.back().unit = 0;
          pattern += R"(([-+]?[0-9]+(?:\.[0-9]+)?(?:[eE][-+]?[0-9]+)?))";
        } else {
          for (const char c : number) append(pattern, c);
        }
      } else {
        append(pattern, text[at++]);
      }
    }
    pattern_ = std::regex(pattern);
  }

  [[nodiscard]] std::size_t line() const noexcept { return line_; }
  /// Whether any words may stand here, or none.
  [[nodiscard]] bool is_gap() const noexcept { return is_gap_; }

  [[nodiscard]] bool matches(const std::string& printed) const {
    std::smatch match;
    if (!std::regex_match(printed, match, pattern_)) return false;
    for (std::size_t k = 0; k < numbers_.size(); ++k) {
      const double value = std::strtod(match[k + 1].str().c_str(), nullptr);
      // The factor covers the rounding of the subtraction.
      const double allowed = std::max(1.0001 * numbers_[k].unit, tolerance_ * std::abs(numbers_[k].value));
      if (!(std::abs(value - numbers_[k].value) <= allowed)) return false;
    }
    return true;
  }

 private:
  static void append(std::string& pattern, char c) {
    if (std::ispunct(static_cast<unsigned char>(c)) != 0) pattern += '\\';
    pattern += c;
  }

  std::size_t line_;
  bool is_gap_;
  double tolerance_;
  std::regex pattern_;
  std::vector<PrintedNumber> numbers_;
};

struct Word {
  std::string text;
  std::size_t line;
};

std::vector<Word> words_of(const std::vector<std::string>& lines) {
  std::vector<Word> words;
  for (std::size_t line = 0; line < lines.size(); ++line) {
    std::istringstream stream(lines[line]);
    for (std::string text; stream >> text;) words.push_back({text, line});
  }
  return words;
}

}  // namespace

Page read_page(const std::filesystem::path& path) {
  const std::vector<std::string> lines = lines_of(path);
  static const std::regex numbers_to("<!-- numbers to ([0-9.e-]+): .+ -->");
  const double usual = PageStep{}.tolerance;
  Page page;
  double tolerance = usual;
  for (std::size_t at = 0; at < lines.size(); ++at) {
    if (!lines[at].starts_with("```")) {
      std::smatch match;
      if (std::regex_match(lines[at], match, numbers_to)) {
        tolerance = std::stod(match[1].str());
      } else {
        page.prose.emplace_back(static_cast<int>(at) + 1, lines[at]);
      }
      continue;
    }
    const std::string fence = lines[at].substr(0, lines[at].find_first_not_of('`'));
    const bool console = lines[at] == fence + "console";
    const bool code = lines[at].starts_with(fence + "{code-block}");
    std::string caption, content;
    for (++at; at < lines.size() && lines[at] != fence; ++at) {
      const std::string& line = lines[at];
      const bool continues = line.starts_with("> ") && !page.steps.empty() && page.steps.back().expected.empty();
      if (console && continues) {
        page.steps.back().command += "\n" + line.substr(2);
      } else if (console && line.starts_with("$ ")) {
        page.steps.push_back({.line = static_cast<int>(at) + 1, .command = line.substr(2), .tolerance = tolerance});
      } else if (console) {
        if (page.steps.empty()) throw std::runtime_error(path.string() + ": output without a command");
        page.steps.back().expected.push_back(line);
      } else if (code && content.empty() && line.starts_with(":caption: ")) {
        caption = line.substr(10);
      } else if (!content.empty() || !(line.empty() || line.starts_with(":"))) {
        content += line + "\n";
      }
    }
    if (!caption.empty()) {
      page.steps.push_back({.line = static_cast<int>(at) + 1, .file = caption, .content = content});
    }
    tolerance = usual;
  }
  for (PageStep& step : page.steps) {
    while (!step.expected.empty() && step.expected.back().empty()) step.expected.pop_back();
  }
  return page;
}

std::vector<std::string> shell_commands(const std::filesystem::path& path, const std::string& program) {
  std::vector<std::string> commands;
  bool in_block = false, continued = false;
  for (const std::string& line : lines_of(path)) {
    if (line.starts_with("```")) {
      in_block = line == "```sh";
      continue;
    }
    if (!in_block) continue;
    if (continued) {
      commands.back() += "\n" + line;
    } else if (line.starts_with(program + " ")) {
      commands.push_back(line);
    } else {
      continue;
    }
    continued = line.ends_with("\\");
  }
  return commands;
}

std::string difference(const std::vector<std::string>& shown, const std::vector<std::string>& printed,
                       double tolerance) {
  std::vector<ShownWord> expected;
  for (const Word& word : words_of(shown)) expected.emplace_back(word.text, word.line, tolerance);
  const std::vector<Word> words = words_of(printed);
  constexpr std::size_t none = std::numeric_limits<std::size_t>::max();
  // `gap` is the last gap met; where its words end too early, it takes one more.
  std::size_t at = 0, next = 0, gap = none, taken = 0, furthest = 0, reached = 0;
  while (next < words.size()) {
    if (at < expected.size() && expected[at].is_gap()) {
      gap = at++;
      taken = next;
    } else if (at < expected.size() && expected[at].matches(words[next].text)) {
      ++at;
      ++next;
    } else if (gap != none) {
      at = gap + 1;
      next = ++taken;
    } else {
      break;
    }
    if (at > furthest) {
      furthest = at;
      reached = next;
    }
  }
  while (next == words.size() && at < expected.size() && expected[at].is_gap()) ++at;
  if (next == words.size() && at == expected.size()) return {};
  if (furthest == expected.size()) return "the page does not show\n  " + printed[words[reached].line] + "\n";
  return "the page shows\n  " + shown[expected[furthest].line()] + "\nbut the program prints\n  " +
         (reached < words.size() ? printed[words[reached].line] : "nothing more") + "\n";
}

std::vector<PrintedNumber> decimal_numbers(const std::string& text) {
  std::vector<PrintedNumber> numbers;
  for (std::size_t at = 0; at < text.size(); ++at) {
    const std::size_t length = number_length(text, at);
    if (length == 0) continue;
    const std::string number = text.substr(at, length);
    if (number.find('.') != std::string::npos) numbers.push_back(printed_number(number));
    at += length - 1;
  }
  return numbers;
}
