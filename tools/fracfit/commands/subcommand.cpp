// SPDX-License-Identifier: BSD-3-Clause
#include "commands/subcommand.hpp"

#include "options/completion.hpp"
#include "options/pages.hpp"

namespace fracfit {
namespace {

class Man : public Command {
 public:
  Man() : Command("man", "Prints the manual page") {
    set_footer("Examples:\n  man <(fracfit man)\n  fracfit man > ~/.local/share/man/man1/fracfit.1");
  }

 private:
  int run() override {
    write(manual_page(all_commands()));
    return usable_result;
  }
};

class Completion : public Command {
 public:
  Completion() : Command("completion", "Prints the completion script of a shell") {
    options().text("--shell", shell_, "Shell it is for", "SHELL").one_of({"bash", "zsh", "fish"}).or_argument();
    set_footer(
        "Examples:\n"
        "  source <(fracfit completion)\n"
        "  fracfit completion zsh > ~/.zfunc/_fracfit\n"
        "  fracfit completion fish > ~/.config/fish/completions/fracfit.fish");
  }

 private:
  int run() override {
    const auto script = shell_ == "zsh" ? zsh_completion : shell_ == "fish" ? fish_completion : bash_completion;
    write(script(all_commands()));
    return usable_result;
  }

  std::string shell_ = "bash";
};

template <class... Makers>
CommandGroup group(std::string name, Makers... makers) {
  CommandGroup made{std::move(name), {}};
  (made.commands.push_back(makers()), ...);
  return made;
}

}  // namespace

std::unique_ptr<Command> make_completion() {
  return std::make_unique<Completion>();
}

std::unique_ptr<Command> make_man() {
  return std::make_unique<Man>();
}

std::vector<CommandGroup> all_commands() {
  std::vector<CommandGroup> groups;
  groups.push_back(group("Backlash", make_simulate, make_jump_law, make_orbits, make_map, make_history, make_basins,
                         make_limit_cycles, make_loop));
  groups.push_back(group("Fitting", make_multisine, make_response, make_validate, make_fit, make_identify,
                         make_identify_scene, make_batch, make_joint_fit, make_report));
  groups.push_back(group("Models", make_analyse, make_evaluate, make_drt, make_respond, make_approximate, make_realise,
                         make_mittag_leffler));
  groups.push_back(group("Controllers", make_controller, make_tune));
#ifdef FRACFIT_HAS_EXPORTS
  groups.push_back(
      group("Exports", make_export_c99, make_export_arduino, make_export_fmu, make_export_spice, make_cluster_script));
#endif
  groups.push_back(group("Files and shell", make_convert, make_merge, make_describe, make_completion, make_man));
  return groups;
}

}  // namespace fracfit
