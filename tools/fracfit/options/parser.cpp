// SPDX-License-Identifier: BSD-3-Clause
#include "options/parser.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <deque>
#include <optional>
#include <stdexcept>

#include "io/data_error.hpp"
#include "io/version.hpp"
#include "options/misspelling.hpp"
#include "options/pages.hpp"
#include "options/scene_options.hpp"

namespace fracfit {
namespace {

[[noreturn]] void refuse(const std::string& message, const std::string& command = {}) {
  throw std::invalid_argument(message + "\nSee 'fracfit " + (command.empty() ? "" : command + " ") + "--help'.");
}

Command* find_command(const std::vector<CommandGroup>& groups, const std::string& name) {
  for (const auto& group : groups)
    for (const auto& command : group.commands)
      if (command->name() == name) return command.get();
  return nullptr;
}

Command& command_named(const std::vector<CommandGroup>& groups, const std::string& name) {
  if (Command* found = find_command(groups, name)) return *found;
#ifndef FRACFIT_HAS_EXPORTS
  if (name == "export" || name == "cluster-script")
    refuse(name +
           " is no part of this program, which was built without it; ./tools/check builds it, or cmake with "
           "-DFRACFIT_EXPORTS=ON");
#endif
  std::vector<std::string> names;
  for (const auto& group : groups)
    for (const auto& command : group.commands) names.push_back(command->name());
  refuse("unknown subcommand or option " + io::quoted(name) + suggestion(name, names) + "; expected one of " +
         either(names));
}

// The name of a subcommand at the head of some words, of one word or of two such as "export spice".
// @param words  at least one
std::string name_in(const std::vector<CommandGroup>& groups, const std::string* words, std::size_t count) {
  const std::string head = words[0] + " ";
  std::vector<std::string> seconds;
  for (const auto& group : groups)
    for (const auto& command : group.commands)
      if (command->name().starts_with(head)) seconds.push_back(command->name().substr(head.size()));
  if (seconds.empty()) return words[0];
  if (count > 1 && std::find(seconds.begin(), seconds.end(), words[1]) != seconds.end()) return head + words[1];
  refuse("'fracfit " + words[0] + "' expects one of " + either(seconds) +
         (count > 1 ? ", not " + io::quoted(words[1]) + suggestion(words[1], seconds) : ""));
}

// What CLI11 fills for one option: it splits the arguments, and all checks are ours.
struct Slot {
  Option* option;
  std::vector<std::string> texts;
  CLI::Option* flag = nullptr;
};

void add_slots(CLI::App& app, Option& option, std::deque<Slot>& slots) {
  const auto add = [&](const std::string& names, bool stands_alone) {
    Slot& slot = slots.emplace_back(Slot{&option, {}});
    if (option.kind() == Option::Kind::flag) {
      slot.flag = app.add_flag(names);
      return;
    }
    CLI::Option* added = app.add_option(names, slot.texts);
    if (stands_alone && option.kind() == Option::Kind::list) return;
    // Takes one text each time; our own check refuses an option that is given twice.
    added->expected(1)->take_all()->allow_extra_args(false);
  };
  add(option.short_name().empty() ? option.name() : option.short_name() + "," + option.name(), option.is_argument());
  if (option.takes_argument()) add(option.type(), true);
}

void check_extras(const Command& command, const std::vector<std::string>& extra) {
  if (extra.empty()) return;
  const auto unknown =
      std::find_if(extra.begin(), extra.end(), [](const std::string& word) { return word.starts_with('-'); });
  if (unknown == extra.end()) refuse("unexpected argument " + io::quoted(extra.front()), command.name());
  std::vector<std::string> names;
  for (const Option& option : command.options().all())
    if (!option.is_argument()) names.push_back(option.name());
  const std::string name = unknown->substr(0, unknown->find('='));
  const auto takes = [&](const char* option) { return std::find(names.begin(), names.end(), option) != names.end(); };
  if (takes("--restitution") && is_compliant_option(name))
    refuse(command.name() + " does not take " + name +
               ": its contacts have a restitution and take no time, and its bodies no dry friction; simulate, map, "
               "history, orbits, basins, jump-law, loop, limit-cycles and tune take it",
           command.name());
  refuse("unknown option " + io::quoted(name) + suggestion(name, names), command.name());
}

void hand_over(std::deque<Slot>& slots) {
  for (Slot& slot : slots) {
    if (slot.flag != nullptr && slot.flag->count() > 0) slot.texts.emplace_back();
    if (slot.texts.empty()) continue;
    slot.option->given.insert(slot.option->given.end(), slot.texts.begin(), slot.texts.end());
  }
}

}  // namespace

Request parse(const std::vector<CommandGroup>& groups, const std::vector<std::string>& arguments) {
  if (arguments.empty()) refuse("no subcommand; 'fracfit --help' lists them");
  const std::string& first = arguments.front();
  if (first == "--version" || first == "-V") return {nullptr, "fracfit " + std::string(io::version()) + "\n"};
  if (first == "--help" || first == "-h" || first == "help") {
    if (arguments.size() == 1) return {nullptr, program_help(groups)};
    if (std::string page = arguments.size() == 2 ? first_word_help(groups, arguments[1]) : ""; !page.empty())
      return {nullptr, std::move(page)};
    return {nullptr, command_help(command_named(groups, name_in(groups, &arguments[1], arguments.size() - 1)))};
  }
  if (arguments.size() == 2 && (arguments[1] == "--help" || arguments[1] == "-h"))
    if (std::string page = first_word_help(groups, first); !page.empty()) return {nullptr, std::move(page)};
  const std::string name = name_in(groups, arguments.data(), arguments.size());
  Command& command = command_named(groups, name);
  CLI::App app;
  app.allow_extras();
  app.prefix_command(command.takes_command());
  std::deque<Slot> slots;
  for (Option& option : command.options().all()) add_slots(app, option, slots);
  try {
    const std::ptrdiff_t words = name == first ? 1 : 2;
    app.parse(std::vector<std::string>(arguments.rbegin(), arguments.rend() - words));
  } catch (const CLI::CallForHelp&) {
    return {nullptr, command_help(command)};
  } catch (const CLI::ArgumentMismatch& error) {
    const std::string text = error.what();
    refuse(text.substr(0, text.find(':')) + " needs a value", command.name());
  } catch (const CLI::ParseError& error) {
    refuse(error.what(), command.name());
  }
  if (command.takes_command())
    command.set_words(app.remaining());
  else
    check_extras(command, app.remaining());
  hand_over(slots);
  return {&command, {}};
}

}  // namespace fracfit
