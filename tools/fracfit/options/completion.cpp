// SPDX-License-Identifier: BSD-3-Clause
#include "options/completion.hpp"

#include <map>
#include <string_view>

#include "io/version.hpp"

namespace fracfit {
namespace {

std::string completion_of(const Command& command, std::string& choices) {
  std::string words;
  for (const Option& option : command.options().all()) {
    if (option.is_argument()) continue;
    words += (words.empty() ? "" : " ") + option.name();
    std::string values;
    for (const std::string& value : option.words()) values += (values.empty() ? "" : " ") + value;
    if (!values.empty()) choices += "    '" + command.name() + "/" + option.name() + "') words='" + values + "' ;;\n";
  }
  return "    '" + command.name() + "') options='" + words + (words.empty() ? "" : " ") + "--help' ;;\n";
}

// In single quotes, for zsh and fish.
std::string quoted(std::string_view text) {
  std::string result = "'";
  for (const char c : text) result += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return result + "'";
}

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : " ") + word;
  return text;
}

bool takes_file(const Option& option) {
  return option.type().find("FILE") != std::string::npos || option.type().find("DIR") != std::string::npos;
}

// First words of commands, and below those of two words, such as "export spice", the second ones.
struct Name {
  std::string about;
  std::map<std::string, std::string> seconds;
};
std::map<std::string, Name> names_of(const std::vector<CommandGroup>& groups) {
  std::map<std::string, Name> names;
  for (const auto& group : groups) {
    for (const auto& command : group.commands) {
      const std::string& name = command->name();
      const std::size_t space = name.find(' ');
      if (space == std::string::npos)
        names[name].about = command->about();
      else
        names[name.substr(0, space)].seconds[name.substr(space + 1)] = command->about();
    }
  }
  names["help"].about = "Help on a subcommand";
  for (auto& [name, entry] : names) {
    if (!entry.about.empty()) continue;
    for (const auto& [second, about] : entry.seconds) entry.about += (entry.about.empty() ? "One of " : ", ") + second;
  }
  return names;
}

}  // namespace

std::string bash_completion(const std::vector<CommandGroup>& groups) {
  std::string names, options, choices;
  std::map<std::string, std::string> seconds;  // by first word, of names such as "export spice"
  for (const auto& group : groups) {
    for (const auto& command : group.commands) {
      const std::string& name = command->name();
      const std::size_t space = name.find(' ');
      const bool is_new = space == std::string::npos || !seconds.contains(name.substr(0, space));
      if (is_new) names += (names.empty() ? "" : " ") + name.substr(0, space);
      if (space != std::string::npos) seconds[name.substr(0, space)] += name.substr(space) + " ";
      options += completion_of(*command, choices);
    }
  }
  std::string two_words;
  for (const auto& [first, rest] : seconds) {
    two_words += "  if [[ $command == " + first + " ]]; then\n    if ((COMP_CWORD == 2)); then\n" +
                 "      mapfile -t COMPREPLY < <(compgen -W '" + rest + "' -- \"$current\")\n      return\n    fi\n" +
                 "    command=\"$command ${COMP_WORDS[2]}\"\n  fi\n";
  }
  return "# bash completion of fracfit " + std::string(io::version()) +
         ":  source <(fracfit completion)\n"
         "_fracfit() {\n"
         "  local current=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD - 1]} command=${COMP_WORDS[1]}\n"
         "  local options='' words=''\n"
         "  if ((COMP_CWORD == 1)) || [[ $COMP_CWORD == 2 && $command == help ]]; then\n"
         "    mapfile -t COMPREPLY < <(compgen -W '" +
         names +
         " help --help --version' -- \"$current\")\n"
         "    return\n"
         "  fi\n" +
         two_words + "  case $command in\n" + options +
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

std::string zsh_completion(const std::vector<CommandGroup>& groups) {
  const auto described = [](const std::string& name, const std::string& about) {
    return " " + quoted(name + ":" + about);
  };
  std::string names, seconds, commands;
  for (const auto& [name, entry] : names_of(groups)) {
    names += described(name, entry.about);
    if (entry.seconds.empty()) continue;
    std::string list;
    for (const auto& [second, about] : entry.seconds) list += described(second, about);
    seconds += "    " + name + ")\n      if (( CURRENT == 3 )); then names=(" + list +
               " ); _describe command names; return; fi\n      command=\"$command $words[3]\"; used=3 ;;\n";
  }
  for (const auto& group : groups) {
    for (const auto& command : group.commands) {
      commands += "    " + quoted(command->name()) + ") _arguments";
      for (const Option& option : command->options().all()) {
        if (option.is_argument()) continue;
        std::string spec = (option.kind() == Option::Kind::list ? "*" : "") + option.name() + "[";
        for (const char c : option.description()) spec += (c == '[' || c == ']' ? "\\" : "") + std::string(1, c);
        spec += "]";
        if (option.kind() != Option::Kind::flag) {
          std::string type;
          for (const char c : option.type()) type += (c == ':' ? "\\" : "") + std::string(1, c);
          spec += ":" + type + ":";
          if (!option.words().empty())
            spec += "(" + joined(option.words()) + ")";
          else if (takes_file(option))
            spec += "_files";
        }
        commands += " \\\n      " + quoted(spec);
      }
      commands += " \\\n      '--help[Help]' '*:file:_files' ;;\n";
    }
  }
  return "#compdef fracfit\n# zsh completion of fracfit " + std::string(io::version()) +
         "\n_fracfit() {\n  local -a names\n  local command=$words[2] used=2\n  if (( CURRENT == 2 )); then\n    "
         "names=(" +
         names + " )\n    _describe command names\n    return\n  fi\n  case $command in\n" + seconds +
         "  esac\n  words=(fracfit \"${(@)words[used+1,-1]}\")\n  (( CURRENT -= used - 1 ))\n  case $command in\n" +
         commands + "  esac\n}\n_fracfit \"$@\"\n";
}

std::string fish_completion(const std::vector<CommandGroup>& groups) {
  std::string text = "# fish completion of fracfit " + std::string(io::version()) + "\n";
  const std::string start = "complete -c fracfit -n ";
  for (const auto& [name, entry] : names_of(groups)) {
    text += start + "__fish_use_subcommand -f -a " + name + " -d " + quoted(entry.about) + "\n";
    for (const auto& [second, about] : entry.seconds)
      text +=
          start + quoted("__fish_seen_subcommand_from " + name) + " -f -a " + second + " -d " + quoted(about) + "\n";
  }
  for (const auto& group : groups) {
    for (const auto& command : group.commands) {
      const std::size_t space = command->name().find(' ');
      std::string condition = "__fish_seen_subcommand_from " + command->name().substr(0, space);
      if (space != std::string::npos)
        condition += "; and __fish_seen_subcommand_from " + command->name().substr(space + 1);
      for (const Option& option : command->options().all()) {
        if (option.is_argument()) continue;
        text += start + quoted(condition) + " -l " + option.name().substr(2);
        if (option.kind() != Option::Kind::flag) text += takes_file(option) ? " -r" : " -x";
        if (!option.words().empty()) text += " -a " + quoted(joined(option.words()));
        text += " -d " + quoted(option.description()) + "\n";
      }
    }
  }
  return text;
}

}  // namespace fracfit
