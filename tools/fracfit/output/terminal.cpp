// SPDX-License-Identifier: BSD-3-Clause
#include "output/terminal.hpp"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <string_view>

namespace fracfit {
namespace {

constexpr std::string_view bold = "\x1b[1m", red = "\x1b[31m", plain = "\x1b[0m";

struct Marked {
  std::string_view word, colour;
};
// What a reader must not miss.
constexpr std::array words{Marked{"verdict:", bold},       Marked{"chosen", bold},
                           Marked{"misses the data", red}, Marked{"no-adequate-model", red},
                           Marked{"not-converged", red},   Marked{"no-usable-start", red},
                           Marked{"not identified", red},  Marked{"invalid-data", red},
                           Marked{"invalid", red},         Marked{"unstable", red}};

bool is_letter(char each) {
  return (each >= 'a' && each <= 'z') || (each >= 'A' && each <= 'Z') || each == '-' || each == '_';
}

}  // namespace

bool output_is_terminal() {
  return ::isatty(STDOUT_FILENO) != 0;
}

std::size_t terminal_width() {
  constexpr std::size_t usual = 80, narrowest = 40;
  winsize size{};
  if (!output_is_terminal() || ::ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) != 0 || size.ws_col == 0) return usual;
  return std::max<std::size_t>(narrowest, size.ws_col);
}

bool shows_colours() {
  const char* const none = std::getenv("NO_COLOR");
  const char* const terminal = std::getenv("TERM");
  return output_is_terminal() && (none == nullptr || *none == '\0') && terminal != nullptr &&
         std::string_view(terminal) != "dumb";
}

std::string in_colours(std::string_view text) {
  std::string result;
  for (std::size_t i = 0; i < text.size();) {
    const auto* const found = std::find_if(words.begin(), words.end(), [&](const Marked& each) {
      if (!text.substr(i).starts_with(each.word) || (i > 0 && is_letter(text[i - 1]))) return false;
      const std::size_t end = i + each.word.size();
      return end == text.size() || !is_letter(text[end]);
    });
    if (found == words.end()) {
      result += text[i++];
      continue;
    }
    result.append(found->colour).append(found->word).append(plain);
    i += found->word.size();
  }
  return result;
}

}  // namespace fracfit
