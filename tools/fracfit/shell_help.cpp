// SPDX-License-Identifier: BSD-3-Clause
#include <CLI/CLI.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "choice.hpp"
#include "exit_code.hpp"
#include "io/output_file.hpp"
#include "io/sweep_file.hpp"
#include "subcommand.hpp"

namespace fracfit {
namespace {

// Both pages are made from the same description of the program that parses its arguments, and so cannot drift from it.
std::vector<const CLI::App*> subcommands_of(const CLI::App& program) {
  return program.get_subcommands([](const CLI::App*) { return true; });
}

std::vector<const CLI::Option*> options_of(const CLI::App& app) {
  return app.get_options([](const CLI::Option*) { return true; });
}

std::string completion_script(const CLI::App& program) {
  std::string names, options, choices;
  for (const CLI::App* subcommand : subcommands_of(program)) {
    const std::string& name = subcommand->get_name();
    names += (names.empty() ? "" : " ") + name;
    std::string words;
    for (const CLI::Option* option : options_of(*subcommand)) {
      for (const std::string& word : option->get_lnames()) {
        words += (words.empty() ? "--" : " --") + word;
        std::string values;
        for (const std::string& value : choice_of(*option).words) values += (values.empty() ? "" : " ") + value;
        if (!values.empty()) choices += "    " + name + "/--" + word + ") words='" + values + "' ;;\n";
      }
    }
    options += "    " + name + ") options='" + words + "' ;;\n";
  }
  return "# bash completion of fracfit " + std::string(io::version()) +
         ":  source <(fracfit completion)\n"
         "_fracfit() {\n"
         "  local current=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD - 1]} command=${COMP_WORDS[1]}\n"
         "  local options='' words=''\n"
         "  if ((COMP_CWORD == 1)); then\n"
         "    mapfile -t COMPREPLY < <(compgen -W '" +
         names +
         " --help --version' -- \"$current\")\n"
         "    return\n"
         "  fi\n"
         "  case $command in\n" +
         options +
         "  esac\n"
         "  case $command/$before in\n" +
         choices +
         "  esac\n"
         "  [[ -z $words && $current == -* ]] && words=$options\n"
         "  mapfile -t COMPREPLY < <(compgen -W \"$words\" -- \"$current\")\n"
         "  ((${#COMPREPLY[@]})) || mapfile -t COMPREPLY < <(compgen -f -- \"$current\")\n"
         "}\n"
         "complete -o filenames -F _fracfit fracfit\n";
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

std::string option_entries(const CLI::App& app) {
  std::string text;
  for (const CLI::Option* option : options_of(app)) {
    const bool named = option->nonpositional();
    std::string heading = named ? "" : option->get_name(true);
    for (const std::string& name : option->get_snames()) heading += "-" + name + ", ";
    for (const std::string& name : option->get_lnames()) heading += "--" + name;
    if (named && option->get_items_expected_max() > 0) heading += " " + type_name_of(*option);
    text += ".TP\n.B " + troff(heading) + "\n" + troff(description_of(*option));
    if (!option->get_default_str().empty()) text += " (default " + troff(option->get_default_str()) + ")";
    text += "\n";
  }
  return text;
}

std::string verbatim(const std::string& text) {
  return ".PP\n.nf\n" + troff(text) + "\n.fi\n";
}

std::string manual_page(const CLI::App& program) {
  std::string text = ".TH FRACFIT 1 \"" FRACFIT_DATE "\" \"fracfit " + std::string(io::version()) +
                     "\"\n.SH NAME\nfracfit \\- fractional\\-order modelling and fitting\n"
                     ".SH SYNOPSIS\n.B fracfit\n.I SUBCOMMAND\n[options]\n.SH DESCRIPTION\n" +
                     troff(program.get_description()) + "\n" + verbatim(program.get_footer());
  text += ".SH SUBCOMMANDS\n";
  for (const CLI::App* subcommand : subcommands_of(program)) {
    text += ".SS " + troff(subcommand->get_name()) + "\n" + troff(subcommand->get_description()) + ".\n" +
            option_entries(*subcommand);
    if (!subcommand->get_footer().empty()) text += verbatim(subcommand->get_footer());
  }
  return text;
}

void add_page(CLI::App& program, Run& run, const std::string& name, const std::string& description,
              const std::string& footer, std::string (*page)(const CLI::App&)) {
  auto* subcommand = program.add_subcommand(name, description);
  subcommand->footer(footer);
  subcommand->callback([&program, &run, page] {
    run = [&program, page] {
      io::OutputFile("").write(page(program));
      return usable_result;
    };
  });
}

}  // namespace

void add_shell_help(CLI::App& program, Run& run) {
  add_page(program, run, "completion", "Prints the completion script for bash",
           "Example:\n  source <(fracfit completion)", completion_script);
  add_page(program, run, "man", "Prints the manual page",
           "Examples:\n  man <(fracfit man)\n  fracfit man > ~/.local/share/man/man1/fracfit.1", manual_page);
}

}  // namespace fracfit
