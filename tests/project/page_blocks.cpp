// SPDX-License-Identifier: BSD-3-Clause
#include "project/page_blocks.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <regex>
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

/// A line of a page as a regular expression, with a group for each number that may differ in its last digit.
class ShownLine {
 public:
  explicit ShownLine(const std::string& text) {
    std::string pattern = R"(\s*)";
    for (std::size_t at = 0; at < text.size();) {
      if (text.compare(at, 3, "...") == 0) {
        pattern += ".*";
        at += 3;
      } else if (std::isspace(static_cast<unsigned char>(text[at])) != 0) {
        while (at < text.size() && std::isspace(static_cast<unsigned char>(text[at])) != 0) ++at;
        pattern += R"(\s+)";
      } else if (const std::size_t length = number_length(text, at); length > 0) {
        const std::string number = text.substr(at, length);
        at += length;
        if (has_decimals(number) && (significant_digits(number) >= 4 || text.compare(at, 3, "...") == 0)) {
          numbers_.push_back(printed_number(number));
          pattern += R"(([-+]?[0-9]+(?:\.[0-9]+)?(?:[eE][-+]?[0-9]+)?))";
        } else {
          for (const char c : number) append(pattern, c);
        }
      } else {
        append(pattern, text[at++]);
      }
    }
    pattern_ = std::regex(pattern + R"(\s*)");
  }

  [[nodiscard]] bool matches(const std::string& printed) const {
    std::smatch match;
    if (!std::regex_match(printed, match, pattern_)) return false;
    for (std::size_t k = 0; k < numbers_.size(); ++k) {
      const double value = std::strtod(match[k + 1].str().c_str(), nullptr);
      // The factor covers the rounding of the subtraction.
      if (!(std::abs(value - numbers_[k].value) <= 1.0001 * numbers_[k].unit)) return false;
    }
    return true;
  }

 private:
  static void append(std::string& pattern, char c) {
    if (std::ispunct(static_cast<unsigned char>(c)) != 0) pattern += '\\';
    pattern += c;
  }

  std::regex pattern_;
  std::vector<PrintedNumber> numbers_;
};

}  // namespace

Page read_page(const std::filesystem::path& path) {
  const std::vector<std::string> lines = lines_of(path);
  Page page;
  for (std::size_t at = 0; at < lines.size(); ++at) {
    if (!lines[at].starts_with("```")) {
      page.prose.emplace_back(static_cast<int>(at) + 1, lines[at]);
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
        page.steps.push_back({.line = static_cast<int>(at) + 1, .command = line.substr(2)});
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

std::string difference(const std::vector<std::string>& shown, const std::vector<std::string>& printed) {
  std::size_t next = 0;
  bool gap = false;  // whether any lines may stand before the next one shown
  for (const std::string& text : shown) {
    if (text == "...") {
      gap = true;
      continue;
    }
    const ShownLine line(text);
    const std::size_t first = next;
    while (gap && next < printed.size() && !line.matches(printed[next])) ++next;
    if (next == printed.size() || !line.matches(printed[next])) {
      return "the page shows\n  " + text + "\nbut the program prints\n  " +
             (first < printed.size() ? printed[first] : "nothing more") + "\n";
    }
    ++next;
    gap = false;
  }
  if (!gap && next < printed.size()) return "the page does not show\n  " + printed[next] + "\n";
  return {};
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
