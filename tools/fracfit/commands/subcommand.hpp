// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <vector>

#include "options/command.hpp"

namespace fracfit {

// Each makes one subcommand.
[[nodiscard]] std::unique_ptr<Command> make_analyse();
[[nodiscard]] std::unique_ptr<Command> make_approximate();
[[nodiscard]] std::unique_ptr<Command> make_basins();
[[nodiscard]] std::unique_ptr<Command> make_batch();
[[nodiscard]] std::unique_ptr<Command> make_cluster_script();
[[nodiscard]] std::unique_ptr<Command> make_controller();
[[nodiscard]] std::unique_ptr<Command> make_convert();
[[nodiscard]] std::unique_ptr<Command> make_describe();
[[nodiscard]] std::unique_ptr<Command> make_evaluate();
[[nodiscard]] std::unique_ptr<Command> make_drt();
[[nodiscard]] std::unique_ptr<Command> make_export_arduino();
[[nodiscard]] std::unique_ptr<Command> make_export_c99();
[[nodiscard]] std::unique_ptr<Command> make_export_fmu();
[[nodiscard]] std::unique_ptr<Command> make_export_spice();
[[nodiscard]] std::unique_ptr<Command> make_fit();
[[nodiscard]] std::unique_ptr<Command> make_history();
[[nodiscard]] std::unique_ptr<Command> make_identify();
[[nodiscard]] std::unique_ptr<Command> make_identify_scene();
[[nodiscard]] std::unique_ptr<Command> make_joint_fit();
[[nodiscard]] std::unique_ptr<Command> make_jump_law();
[[nodiscard]] std::unique_ptr<Command> make_limit_cycles();
[[nodiscard]] std::unique_ptr<Command> make_loop();
[[nodiscard]] std::unique_ptr<Command> make_map();
[[nodiscard]] std::unique_ptr<Command> make_merge();
[[nodiscard]] std::unique_ptr<Command> make_mittag_leffler();
[[nodiscard]] std::unique_ptr<Command> make_multisine();
[[nodiscard]] std::unique_ptr<Command> make_orbits();
[[nodiscard]] std::unique_ptr<Command> make_realise();
[[nodiscard]] std::unique_ptr<Command> make_report();
[[nodiscard]] std::unique_ptr<Command> make_respond();
[[nodiscard]] std::unique_ptr<Command> make_response();
[[nodiscard]] std::unique_ptr<Command> make_simulate();
[[nodiscard]] std::unique_ptr<Command> make_tune();
[[nodiscard]] std::unique_ptr<Command> make_validate();
[[nodiscard]] std::unique_ptr<Command> make_completion();
[[nodiscard]] std::unique_ptr<Command> make_man();

/// All of them, in the groups and the order of the help.
[[nodiscard]] std::vector<CommandGroup> all_commands();

}  // namespace fracfit
