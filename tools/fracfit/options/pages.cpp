// SPDX-License-Identifier: BSD-3-Clause
#include "options/pages.hpp"

#include <sstream>
#include <string_view>

#include "io/version.hpp"

namespace fracfit {
namespace {

constexpr const char* program_about =
    "Fractional-order modelling and fitting; describing functions of two masses with backlash.";

constexpr const char* program_footer =
    "Examples:\n"
    "  fracfit simulate --force 40 --clearance 0.3 --restitution 0.6 --omega 0.5:25:200 --out curve.csv\n"
    "  fracfit fit curve.csv --model power-law --where 'omega<4'\n"
    "  fracfit identify curve.csv --where 'omega<4'\n"
    "  fracfit report --out report\n"
    "Help on one subcommand: 'fracfit help fit' or 'fracfit fit --help'.\n"
    "Exit codes: 0 usable result, 1 no usable result, 2 wrong usage, 3 unreadable or invalid data.";

// A name, and what it is for in a column beside it, broken between words.
std::string entry(const std::string& name, const std::string& description) {
  constexpr std::size_t column = 30, page_width = 100;
  std::string text = "  " + name;
  text += text.size() < column ? std::string(column - text.size(), ' ') : "\n" + std::string(column, ' ');
  std::istringstream words(description);
  std::size_t used = column;
  for (std::string word; words >> word;) {
    if (used > column && used + 1 + word.size() > page_width) {
      text += "\n" + std::string(column, ' ');
      used = column;
    }
    text += (used > column ? " " : "") + word;
    used += word.size() + (used > column ? 1 : 0);
  }
  return text + "\n";
}

std::string heading_of(const Option& option) {
  std::string heading = option.short_name().empty() ? option.name() : option.short_name() + "," + option.name();
  if (!option.type().empty()) heading += " " + option.type();
  return heading;
}

// Text for troff: backslashes and dashes as such, no line that begins a request.
std::string troff(std::string_view text) {
  std::string safe;
  for (const char c : text) {
    if ((c == '.' || c == '\'') && (safe.empty() || safe.back() == '\n')) safe += "\\&";
    if (c == '\\') {
      safe += "\\e";
    } else if (c == '-') {
      safe += "\\-";
    } else {
      safe += c;
    }
  }
  return safe;
}

std::string verbatim(const std::string& text) {
  return ".PP\n.nf\n" + troff(text) + "\n.fi\n";
}

}  // namespace

std::string program_help(const std::vector<CommandGroup>& groups) {
  std::string text = std::string(program_about) + "\nUsage: fracfit SUBCOMMAND [OPTIONS]\n\nOptions:\n" +
                     entry("-h,--help", "Print this help and exit") +
                     entry("-V,--version", "Print the version and exit");
  for (const auto& group : groups) {
    text += "\n" + group.name + ":\n";
    for (const auto& command : group.commands) text += entry(command->name(), command->about());
  }
  return text + "\n" + program_footer + "\n";
}

std::string first_word_help(const std::vector<CommandGroup>& groups, const std::string& word) {
  std::string entries;
  for (const auto& group : groups)
    for (const auto& command : group.commands)
      if (command->name().starts_with(word + " ")) entries += entry(command->name(), command->about());
  if (entries.empty()) return {};
  return "Usage: fracfit " + word + " WHAT [OPTIONS]\n\n" + entries +
         "\nEach tells its options by --help after both words.\n";
}

std::string command_help(const Command& command) {
  std::string arguments, options, usage = "Usage: fracfit " + command.name() + " [OPTIONS]";
  for (const Option& option : command.options().all()) {
    const std::string required = option.is_required() ? " REQUIRED" : "";
    if (option.is_argument()) {
      const std::string name = option.name() + (option.kind() == Option::Kind::list ? "..." : "");
      usage += option.is_required() ? " " + name : " [" + name + "]";
      arguments += entry(heading_of(option) + (option.kind() == Option::Kind::list ? "..." : "") + required,
                         option.description());
      continue;
    }
    if (option.takes_argument()) {
      const std::string name = option.type() + (option.kind() == Option::Kind::list ? "..." : "");
      usage += " [" + name + "]";
      arguments += entry(name, "The same as " + option.name() + " " + option.type());
    }
    options += entry(heading_of(option) + required, option.description());
  }
  std::string text = command.about() + "\n" + usage + "\n\n";
  if (!arguments.empty()) text += "Arguments:\n" + arguments + "\n";
  text += "Options:\n" + entry("-h,--help", "Print this help and exit") + options;
  return command.footer().empty() ? text : text + "\n" + command.footer() + "\n";
}

std::string manual_page(const std::vector<CommandGroup>& groups) {
  std::string text = ".TH FRACFIT 1 \"" FRACFIT_DATE "\" \"fracfit " + std::string(io::version()) +
                     "\"\n.SH NAME\nfracfit \\- fractional\\-order modelling and fitting\n"
                     ".SH SYNOPSIS\n.B fracfit\n.I SUBCOMMAND\n[options]\n.SH DESCRIPTION\n" +
                     troff(program_about) + "\n" + verbatim(program_footer);
  for (const auto& group : groups) {
    std::string title = group.name;
    for (char& c : title) c = c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
    text += ".SH " + title + "\n";
    for (const auto& command : group.commands) {
      text += ".SS " + troff(command->name()) + "\n" + troff(command->about()) + ".\n.TP\n.B " + troff("-h,--help") +
              "\nPrint the help of this subcommand and exit\n";
      for (const Option& option : command->options().all())
        text += ".TP\n.B " + troff(heading_of(option)) + "\n" + troff(option.description()) + "\n";
      if (!command->footer().empty()) text += verbatim(command->footer());
    }
  }
  return text;
}

}  // namespace fracfit
