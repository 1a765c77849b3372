// SPDX-License-Identifier: BSD-3-Clause
#include "commands/subcommand.hpp"

#include "options/pages.hpp"

namespace fracfit {
namespace {

// Prints a page about the whole program.
class Page : public Command {
 public:
  Page(std::string name, std::string about, std::string footer, std::string (*page)(const std::vector<CommandGroup>&))
      : Command(std::move(name), std::move(about)), page_(page) {
    set_footer(std::move(footer));
  }

 private:
  int run() override {
    write(page_(all_commands()));
    return usable_result;
  }
  std::string (*page_)(const std::vector<CommandGroup>&);
};

template <class... Makers>
CommandGroup group(std::string name, Makers... makers) {
  CommandGroup made{std::move(name), {}};
  (made.commands.push_back(makers()), ...);
  return made;
}

}  // namespace

std::unique_ptr<Command> make_completion() {
  return std::make_unique<Page>("completion", "Prints the completion script for bash",
                                "Example:\n  source <(fracfit completion)", completion_script);
}

std::unique_ptr<Command> make_man() {
  return std::make_unique<Page>("man", "Prints the manual page",
                                "Examples:\n  man <(fracfit man)\n  fracfit man > ~/.local/share/man/man1/fracfit.1",
                                manual_page);
}

std::vector<CommandGroup> all_commands() {
  std::vector<CommandGroup> groups;
  groups.push_back(group("Backlash", make_simulate, make_jump_law, make_orbits, make_map, make_history, make_basins,
                         make_limit_cycles, make_loop));
  groups.push_back(group("Fitting", make_validate, make_fit, make_identify, make_identify_scene, make_batch,
                         make_joint_fit, make_report));
  groups.push_back(
      group("Models", make_analyse, make_evaluate, make_respond, make_approximate, make_realise, make_mittag_leffler));
  groups.push_back(group("Controllers", make_controller, make_tune));
  groups.push_back(group("Exports", make_export_c99, make_export_arduino, make_export_fmu, make_export_spice));
  groups.push_back(group("Files and shell", make_convert, make_merge, make_cluster_script, make_completion, make_man));
  return groups;
}

}  // namespace fracfit
