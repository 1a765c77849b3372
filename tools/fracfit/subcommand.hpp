// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>

namespace CLI {
class App;
}

namespace fracfit {

/// What the chosen subcommand does once its options are parsed; returns the exit code.
using Run = std::function<int()>;

/// Each adds one subcommand, which stores its work in `run` when it is chosen.
void add_analyse(CLI::App& program, Run& run);
void add_approximate(CLI::App& program, Run& run);
void add_basins(CLI::App& program, Run& run);
void add_batch(CLI::App& program, Run& run);
void add_controller(CLI::App& program, Run& run);
void add_simulate(CLI::App& program, Run& run);
void add_fit(CLI::App& program, Run& run);
void add_history(CLI::App& program, Run& run);
void add_identify(CLI::App& program, Run& run);
void add_identify_scene(CLI::App& program, Run& run);
void add_jump_law(CLI::App& program, Run& run);
void add_map(CLI::App& program, Run& run);
void add_merge(CLI::App& program, Run& run);
void add_mittag_leffler(CLI::App& program, Run& run);
void add_orbits(CLI::App& program, Run& run);
void add_realise(CLI::App& program, Run& run);
void add_report(CLI::App& program, Run& run);
void add_respond(CLI::App& program, Run& run);
void add_tune(CLI::App& program, Run& run);
/// Adds `completion` and `man`.
void add_shell_help(CLI::App& program, Run& run);

}  // namespace fracfit
